!> Nonlinear Gauss-Seidel: sweeps over the contacts until the stopping criterion holds (doc/theory/nlgs.md).
!!
!! The errors are always those of all contacts. Sweeps visit those that carry an impulse and the open ones that may
!! close; who they are is looked up again as the errors fall.
module sg_nlgs
  use sg_active_set, only: active_set_t
  use sg_compact, only: add_impulses
  use sg_convergence, only: convergence_t, looks_at_errors, scales_of
  use sg_increments, only: increment_value, increments_t, n_increment_maxima, n_increment_sums
  use sg_kinds, only: wp, i8
  use sg_problem, only: bytes_per_contact, problem_t
  use sg_report, only: report_t
  use sg_residuals, only: find_worst, measure_errors
  use sg_run_options, only: criterion_e1, criterion_e2, solver_options_t
  use sg_solved_clusters, only: solved_clusters_t
  use sg_solver, only: solver_t
  use sg_sweep_order, only: give_impulses, list_order, set_order, sweep_order_t, update_order
  use sg_sweeps, only: sweep
  use sg_tables, only: tables_t
  use sg_trace, only: point_of, trace_t
  implicit none
  private
  public :: nlgs_t

  !> A test is likely to be the last one when the criterion of the one before is below so many tolerances
  real(wp), parameter :: likely_last = 3

  !> The Gauss-Seidel solver
  type, extends(solver_t) :: nlgs_t
    !> Options of the deck
    type(solver_options_t) :: options
    !> Contacts in the order of the sweep
    type(sweep_order_t), private :: order
    !> Active set
    type(active_set_t), private :: active_set
    !> Tests of this solve
    type(convergence_t), private :: convergence
    !> For criteria that look at increments
    type(increments_t), private :: increments
    !> Clusters that are solved before the others
    type(solved_clusters_t), private :: clusters
    !> History of the errors of this solve
    type(trace_t), private :: trace
  contains
    procedure :: solve => nlgs_solve
    procedure :: list_tables => nlgs_list_tables
  end type nlgs_t

contains

  !> Solve a problem by sweeps.
  subroutine nlgs_solve(self, problem, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    real(wp) :: now
    logical :: has_e1

    report%bytes_per_contact = bytes_per_contact(problem)
    if (problem%n_contacts == 0) return
    call self%trace%begin(self%with_trace)
    if (.not. self%options%warm_start) problem%impulse = 0
    call add_impulses(problem)
    report%is_converged = .false.
    if (self%trace%is_on) call note(self, problem, report, 0)
    call start_order(self, problem, report)
    now = self%trace%seconds()
    has_e1 = .false.
    do while (report%sweeps < self%options%maximum_sweeps .and. .not. report%is_converged)
      call sweep_until_check(self, problem, report)
      call lap(self, report%cpu_sweeps, now)
      call check(self, problem, report, has_e1)
      call lap(self, report%cpu_checks, now)
    end do
    if (.not. has_e1) then
      call measure_errors(problem, report, with_e1=.true.)
      call lap(self, report%cpu_checks, now)
    end if
    if (.not. report%is_converged) call find_worst(problem, report%worst_contact, report%worst_speed)
    call self%convergence%finish(report)
    call self%trace%finish(report%sweeps, report)
  end subroutine nlgs_solve

  !> Measure errors for the history, after some sweeps of a batch.
  subroutine note(self, problem, report, sweeps)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(report_t), intent(in) :: report
    integer, intent(in) :: sweeps !! since the last test
    type(report_t) :: here

    call self%trace%pause()
    if (sweeps > 0) call give_impulses(self%order, problem)
    call measure_errors(problem, here, with_e1=.true.)
    here%contact_updates = report%contact_updates + int(sweeps, i8)*int(self%order%n, i8)
    call self%trace%add(point_of(report%sweeps + sweeps, here))
  end subroutine note

  !> Add the CPU time since `now` to a phase. Asking for the time costs as much as a small sweep: once a phase is enough.
  subroutine lap(self, phase, now)
    class(nlgs_t), intent(in) :: self
    real(wp), intent(inout) :: phase, now
    real(wp) :: before

    before = now
    now = self%trace%seconds()
    phase = phase + now - before
  end subroutine lap

  !> Begin with all contacts; or, where impulses are guessed, leave out those that the guess opens for good. The first test
  !! brings back contacts that it missed; increments are of no contact left out, so criteria that look at them begin with all.
  subroutine start_order(self, problem, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    type(report_t), intent(inout) :: report

    call self%active_set%begin(problem%n_contacts)
    if (looks_at_errors(self%options%criterion) .and. any(abs(problem%impulse(:, :problem%n_contacts)) > 0)) then
      call measure_errors(problem, report, with_e1=.false., closing=self%active_set%closing)
      call self%active_set%choose(problem%n_contacts, report, problem%velocity_scale)
      self%active_set%is_ordered(:problem%n_contacts) = self%active_set%is_wanted(:problem%n_contacts)
    end if
    call set_order(self%order, problem, self%active_set%is_ordered, self%options)
    call self%clusters%begin()
    call self%convergence%begin(scales_of(problem))
  end subroutine start_order

  !> Sweep as often as the options say between two tests.
  subroutine sweep_until_check(self, problem, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(report_t), intent(inout) :: report
    integer :: i, n

    n = min(self%options%check_every, self%options%maximum_sweeps - report%sweeps)
    do i = 1, n
      call sweep(problem%kind, self%order, problem%n_bodies, self%options%relaxation, problem%body)
      if (self%trace%is_due(report%sweeps + i)) call note(self, problem, report, i)
    end do
    report%sweeps = report%sweeps + n
    report%contact_updates = report%contact_updates + int(n, i8)*int(self%order%n, i8)
    call give_impulses(self%order, problem)
  end subroutine sweep_until_check

  !> Measure the errors, judge them, and choose the active set again when it is due.
  subroutine check(self, problem, report, has_e1)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    type(report_t), intent(inout) :: report
    logical, intent(out) :: has_e1
    real(wp) :: increments, sums(n_increment_sums), maxima(n_increment_maxima), asked
    logical :: is_last

    is_last = report%sweeps >= self%options%maximum_sweeps
    ! e1 is measured beside the others where this may be the last test: measuring all once more would cost far more.
    has_e1 = is_last .or. any(self%options%criterion == [criterion_e1, criterion_e2]) .or. report%checks == 0 .or. &
             report%criterion <= likely_last*self%options%tolerance
    call self%clusters%prepare(problem, self%options, report%sweeps)
    if (self%clusters%are_sought) then
      call measure_errors(problem, report, has_e1, self%clusters%squares, self%active_set%closing)
    else
      call measure_errors(problem, report, has_e1, closing=self%active_set%closing)
    end if
    increments = 0
    if (.not. looks_at_errors(self%options%criterion)) then
      call self%increments%measure(problem, self%order, sums, maxima)
      increments = increment_value(self%options%criterion, sums, maxima)
    end if
    call self%convergence%judge(self%options, report, increments)
    if (self%convergence%must_look(report)) then
      call find_worst(problem, report%worst_contact, report%worst_speed)
      call self%convergence%confirm(report%worst_speed, report)
    end if
    if (is_last .or. .not. self%convergence%is_choice_due) return
    associate (n => problem%n_contacts)
      call self%active_set%choose(n, report, problem%velocity_scale)
      if (self%clusters%are_sought .and. .not. self%convergence%is_contested) then
        asked = (self%options%tolerance/report%criterion)**2*sum(self%clusters%squares(:n))/real(n, wp)
        call self%clusters%leave_out(problem, report%sweeps, asked, self%active_set%is_wanted(:n))
      end if
      call update_order(self%order, problem, self%active_set%is_wanted(:n), self%active_set%is_ordered(:n), self%options)
    end associate
  end subroutine check

  !> List the tables of the sweeps.
  subroutine nlgs_list_tables(self, tables)
    class(nlgs_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call list_order(self%order, tables)
    call self%active_set%list_tables(tables)
    call self%increments%list_tables(tables)
    call self%clusters%list_tables(tables)
  end subroutine nlgs_list_tables
end module sg_nlgs
