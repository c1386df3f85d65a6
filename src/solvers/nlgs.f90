!> Nonlinear Gauss-Seidel: sweeps over the contacts until the stopping criterion holds (doc/theory/nlgs.md).
module sg_nlgs
  use sg_compact, only: add_impulses
  use sg_increments, only: increment_criterion
  use sg_kinds, only: wp, i8
  use sg_lanes, only: build_lanes, lanes_t, load_lanes, store_lanes, sweep_lanes
  use sg_problem, only: arm_frictional, arm_frictionless, bytes_per_contact, problem_t, round_frictional, round_frictionless
  use sg_report, only: report_t
  use sg_residuals, only: measure_errors
  use sg_run_options, only: criterion_e1, criterion_e2, criterion_e8, criterion_violation, solver_options_t
  use sg_solver, only: solver_t
  use sg_sweep_arm, only: sweep_arm_frictional, sweep_arm_frictionless
  use sg_sweep_round, only: sweep_round_frictional, sweep_round_frictionless
  use sg_timers, only: timer_t
  implicit none
  private
  public :: nlgs_t

  !> The Gauss-Seidel solver
  type, extends(solver_t) :: nlgs_t
    !> Options of the deck
    type(solver_options_t) :: options
    !> Contacts in vector groups, where the problem allows it
    type(lanes_t) :: lanes
    !> Impulses of one sweep ago, for criteria that look at increments
    real(wp), allocatable :: before(:, :)
    !> Bodies with a slot 0 for empty lanes
    real(wp), allocatable :: body(:, :)
  contains
    procedure :: solve => nlgs_solve
  end type nlgs_t

contains

  !> Solve a problem by sweeps.
  subroutine nlgs_solve(self, problem, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    type(timer_t) :: sweeps, checks

    report%bytes_per_contact = bytes_per_contact(problem)
    if (problem%n_contacts == 0) return
    if (.not. self%options%warm_start) problem%impulse = 0
    call add_impulses(problem)
    report%is_converged = .false.
    if (uses_lanes(self, problem)) then
      call build_lanes(self%lanes, problem%n_contacts, problem%pair, problem%body)
      call load_lanes(self%lanes, problem%pair, problem%record, problem%impulse)
      allocate (self%body(size(problem%body, 1), 0:problem%n_bodies))
      self%body(:, 0) = 0
      self%body(:, 1:) = problem%body
    end if
    do while (report%sweeps < self%options%maximum_sweeps .and. .not. report%is_converged)
      call sweeps%start()
      call sweep_until_check(self, problem, report)
      call sweeps%stop()
      call checks%start()
      call check(self, problem, report)
      call checks%stop()
    end do
    if (allocated(self%body)) deallocate (self%body)
    report%contact_updates = int(report%sweeps, i8)*int(problem%n_contacts, i8)
    report%cpu_sweeps = sweeps%cpu
    report%cpu_checks = checks%cpu
  end subroutine nlgs_solve

  !> May this problem be swept in vector groups?
  pure logical function uses_lanes(self, problem)
    class(nlgs_t), intent(in) :: self
    type(problem_t), intent(in) :: problem

    uses_lanes = problem%kind == round_frictional .and. self%options%order == 'groups'
  end function uses_lanes

  !> Sweep as often as the options say between two tests; before the last one, note the impulses where wanted.
  subroutine sweep_until_check(self, problem, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(report_t), intent(inout) :: report
    integer :: i, n

    n = min(self%options%check_every, self%options%maximum_sweeps - report%sweeps)
    do i = 1, n
      if (i == n .and. looks_at_increments(self)) then
        if (uses_lanes(self, problem)) call store_lanes(self%lanes, problem%impulse)
        self%before = problem%impulse(:, :problem%n_contacts)
      end if
      call sweep(self, problem)
    end do
    report%sweeps = report%sweeps + n
    if (.not. uses_lanes(self, problem)) return
    call store_lanes(self%lanes, problem%impulse)
    problem%body = self%body(:, 1:)
  end subroutine sweep_until_check

  !> One sweep by the kernel of the problem's kind.
  subroutine sweep(self, problem)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem

    associate (n => problem%n_contacts, pair => problem%pair, record => problem%record, r => problem%impulse, &
               body => problem%body, relaxation => self%options%relaxation)
      select case (problem%kind)
      case (round_frictionless)
        call sweep_round_frictionless(n, problem%n_bodies, pair, record, relaxation, r, body)
      case (round_frictional)
        if (uses_lanes(self, problem)) then
          call sweep_lanes(self%lanes%n_groups, problem%n_bodies, self%lanes%pair, self%lanes%record, relaxation, &
                           self%lanes%impulse, self%body)
        else
          call sweep_round_frictional(n, problem%n_bodies, pair, record, relaxation, r, body)
        end if
      case (arm_frictionless)
        call sweep_arm_frictionless(n, problem%n_bodies, pair, record, relaxation, r, body)
      case (arm_frictional)
        call sweep_arm_frictional(n, problem%n_bodies, pair, record, relaxation, r, body)
      end select
    end associate
  end subroutine sweep

  !> Does the stopping criterion look at what the last sweep changed?
  pure logical function looks_at_increments(self)
    class(nlgs_t), intent(in) :: self

    looks_at_increments = all(self%options%criterion /= [criterion_e1, criterion_e2, criterion_e8, criterion_violation])
  end function looks_at_increments

  !> Measure the errors, and compare the criterion with its tolerance.
  subroutine check(self, problem, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    type(report_t), intent(inout) :: report

    report%checks = report%checks + 1
    if (looks_at_increments(self)) then
      report%criterion = increment_criterion(problem, self%before, self%options%criterion)
      report%is_converged = report%criterion <= self%options%tolerance
      if (report%is_converged .or. report%sweeps >= self%options%maximum_sweeps) call measure_errors(problem, report)
      return
    end if
    call measure_errors(problem, report)
    select case (self%options%criterion)
    case (criterion_e1)
      report%criterion = report%e1
    case (criterion_e2)
      report%criterion = report%e2
    case (criterion_violation)
      report%criterion = report%violation
    case default
      report%criterion = report%e8
    end select
    report%is_converged = report%criterion <= self%options%tolerance
  end subroutine check
end module sg_nlgs
