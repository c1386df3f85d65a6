!> What all solvers of decomposed contact problems share: each rank brings its part of one problem, rounds of sweeps and
!! gluings go on until the errors of the whole problem are small enough (doc/theory/decomposition.md).
!!
!! A method says how a solve is opened, what a round is, what a test needs before it, and how copies get the result.
module sg_glued_solver
  use sg_comm, only: comm_t, traffic_t
  use sg_convergence, only: convergence_t, looks_at_errors
  use sg_delassus, only: share_mass
  use sg_kinds, only: wp, i4
  use sg_parts, only: parts_t
  use sg_problem, only: bytes_per_contact, problem_t
  use sg_records, only: first_inverse
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e1, criterion_e2, partition_options_t, solver_options_t
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: per_body, tables_t
  use sg_trace, only: point_of, trace_t
  use sg_whole_errors, only: whole_errors_t
  implicit none
  private
  public :: glued_solver_t

  !> Least share of its relaxation that a method is damped to
  real(wp), parameter :: least_damping = 1.0_wp/16

  !> A solver of decomposed problems, chosen once a run
  type, abstract :: glued_solver_t
    !> Options of the deck
    type(solver_options_t) :: options
    type(partition_options_t) :: partition
    !> Keep the history of errors of the next solves?
    logical :: with_trace = .false.
    !> This rank's contacts, part by part
    type(parts_t) :: parts
    !> Share of its relaxation that a method takes which may diverge: halved where the error does not fall
    real(wp) :: damping = 1
    !> Components of a velocity
    integer :: width = 0
    !> Errors of the whole problem
    type(whole_errors_t) :: errors
    type(convergence_t), private :: convergence
    type(trace_t), private :: trace
    !> Slots of bodies whose masses are divided among copies, and their inverse masses when whole
    integer, allocatable, private :: divided(:)
    real(wp), allocatable, private :: whole(:, :)
  contains
    procedure :: solve => glued_solve
    procedure :: divide_masses => glued_divide_masses
    procedure :: list_tables => glued_list_tables
    procedure(open_solve), deferred :: open
    procedure(begin_round), deferred :: begin_round
    procedure(finish_round), deferred :: finish_round
    procedure(begin_test), deferred :: begin_test
    procedure(tell_result), deferred :: tell_result
    procedure(list_shared), deferred :: list_shared
  end type glued_solver_t

  abstract interface
    !> Find who shares what, let the guess act, and take the parts of the contacts.
    subroutine open_solve(self, problem, subdomain, slot_of, comm)
      import :: glued_solver_t, problem_t, subdomain_t, comm_t, i4
      class(glued_solver_t), intent(inout) :: self
      type(problem_t), intent(inout) :: problem !! this rank's part: the guess and free velocities; then its velocities
      type(subdomain_t), intent(in) :: subdomain !! who holds which body
      integer(i4), intent(in) :: slot_of(:) !! slot of each local body
      type(comm_t), intent(inout) :: comm !! the ranks
    end subroutine open_solve
    !> Sweep contacts of shared bodies: the first thing that a round does.
    subroutine begin_round(self, problem, report)
      import :: glued_solver_t, problem_t, report_t
      class(glued_solver_t), intent(inout) :: self
      type(problem_t), intent(inout) :: problem !! this rank's part
      type(report_t), intent(inout) :: report !! contact updates are counted
    end subroutine begin_round
    !> Sweep the others, and glue; or glue what has been swept, where the round goes no further.
    subroutine finish_round(self, problem, is_cut, comm, report)
      import :: glued_solver_t, problem_t, comm_t, report_t
      class(glued_solver_t), intent(inout) :: self
      type(problem_t), intent(inout) :: problem !! this rank's part
      logical, intent(in) :: is_cut !! only glue
      type(comm_t), intent(inout) :: comm !! the ranks
      type(report_t), intent(inout) :: report !! contact updates are counted
    end subroutine finish_round
    !> Put impulses and velocities in the problem, where those of a round may lie about in orders and copies, and begin to sum
    !! their errors.
    subroutine begin_test(self, problem, with_e1, comm)
      import :: glued_solver_t, problem_t, comm_t
      class(glued_solver_t), intent(inout) :: self
      type(problem_t), intent(inout) :: problem !! this rank's part
      logical, intent(in) :: with_e1 !! measure e1 and e2 too
      type(comm_t), intent(inout) :: comm !! the ranks
    end subroutine begin_test
    !> Give the velocities found to all copies.
    subroutine tell_result(self, problem, subdomain, slot_of, comm)
      import :: glued_solver_t, problem_t, subdomain_t, comm_t, i4
      class(glued_solver_t), intent(inout) :: self
      type(problem_t), intent(inout) :: problem !! this rank's part
      type(subdomain_t), intent(in) :: subdomain !! who holds which body
      integer(i4), intent(in) :: slot_of(:) !! slot of each local body
      type(comm_t), intent(inout) :: comm !! the ranks
    end subroutine tell_result
    !> List the tables of what the method shares with other ranks.
    subroutine list_shared(self, tables)
      import :: glued_solver_t, tables_t
      class(glued_solver_t), intent(in) :: self
      type(tables_t), intent(inout) :: tables !! list to add to
    end subroutine list_shared
  end interface

contains

  !> Solve a problem of which each rank holds some contacts and the bodies that they touch. Impulses hold the guess, bodies
  !! their free velocities (the same in all copies); both are replaced by the solution, on all copies of a body. The errors
  !! reported are those of the whole, undecomposed problem; sweeps and updates are those of this rank. Collective.
  subroutine glued_solve(self, problem, subdomain, slot_of, comm, report)
    class(glued_solver_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's contacts, its bodies and the copies that they touch
    type(subdomain_t), intent(in) :: subdomain !! who shares which body
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(out) :: report !! effort and errors

    report%bytes_per_contact = bytes_per_contact(problem)
    self%errors%criterion = self%options%criterion
    call self%errors%prepare(problem, comm)
    if (self%errors%contacts == 0) return
    call self%trace%begin(self%with_trace)
    self%width = first_inverse(problem%kind) - 1
    if (.not. self%options%warm_start) problem%impulse = 0
    report%is_converged = .false.
    self%damping = 1
    call self%open(problem, subdomain, slot_of, comm)
    if (self%trace%is_on) call note(self, problem, comm, report)
    call choose_first(self, problem, comm, report)
    call self%convergence%begin(self%errors%scales)
    do
      call rounds(self, problem, comm, report)
      ! What is handed over is judged itself: the round that was cut short has changed it since its last test.
      call self%begin_test(problem, .true., comm)
      call finish_test(self, comm, report)
      if (self%convergence%must_look(report)) then
        call self%errors%find_worst(problem, comm, report)
        call self%convergence%confirm(report%worst_speed, report)
      end if
      if (report%is_converged .or. report%sweeps >= self%options%maximum_sweeps) exit
    end do
    if (.not. report%is_converged) call self%errors%find_worst(problem, comm, report)
    call self%convergence%finish(report)
    problem%body(self%width + 1:, self%divided) = self%whole
    call self%tell_result(problem, subdomain, slot_of, comm)
    report%cpu_seconds = self%trace%seconds()
    call self%trace%finish(report%sweeps, report)
  end subroutine glued_solve

  !> Measure the errors of the whole problem for the history; what is sent for it does not count. Collective.
  subroutine note(self, problem, comm, report)
    class(glued_solver_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(in) :: report
    type(report_t) :: here
    type(traffic_t) :: before
    real(wp), allocatable :: impulse(:, :)

    call self%trace%pause()
    before = comm%traffic
    ! A test may drop what is left of a guess.
    allocate (impulse, source=problem%impulse)
    call self%begin_test(problem, .true., comm)
    call self%errors%finish(here, comm)
    here%contact_updates = report%contact_updates
    call move_alloc(impulse, problem%impulse)
    comm%traffic = before
    call self%trace%add(point_of(report%sweeps, here))
  end subroutine note

  !> Begin with all contacts; or, where impulses are guessed, without those that the guess opens for good, as on one rank.
  subroutine choose_first(self, problem, comm, report)
    class(glued_solver_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report

    if (self%errors%is_guessed .and. looks_at_errors(self%options%criterion)) then
      call self%begin_test(problem, .false., comm)
      call self%errors%finish(report, comm)
      call self%parts%choose(problem, report, 0.0_wp)
    else
      call self%parts%arrange(problem)
    end if
  end subroutine choose_first

  !> Rounds until the criterion holds. The sum of a test travels while the next round begins, which is cut short if the test
  !! passes.
  subroutine rounds(self, problem, comm, report)
    class(glued_solver_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report
    logical :: is_tested, is_choosing, is_stuck
    integer :: since_test

    is_tested = .false.
    is_choosing = self%convergence%is_choice_due
    since_test = 0
    do while (report%sweeps < self%options%maximum_sweeps)
      call self%begin_round(problem, report)
      if (is_tested) then
        call finish_test(self, comm, report)
        is_choosing = self%convergence%is_choice_due
        call self%convergence%find_stuck(report, is_stuck)
        if (is_stuck) self%damping = max(least_damping, self%damping/2)
      end if
      call self%finish_round(problem, report%is_converged, comm, report)
      if (report%is_converged) return
      report%sweeps = report%sweeps + self%partition%most_sweeps()
      report%gluings = report%gluings + 1
      if (self%trace%is_due(report%sweeps)) call note(self, problem, comm, report)
      since_test = since_test + self%partition%most_sweeps()
      is_tested = is_choosing .or. since_test >= self%options%check_every
      if (.not. is_tested) cycle
      since_test = 0
      if (is_choosing .and. .not. self%convergence%is_contested) &
        call self%parts%clusters%prepare(problem, self%options, report%sweeps)
      call self%begin_test(problem, any(self%options%criterion == [criterion_e1, criterion_e2]), comm)
      ! Errors, criterion and squares are those of the test that asked for the choice, a round ago.
      if (is_choosing) call self%parts%choose(problem, report, &
                                              (self%options%tolerance/report%criterion)**2*self%errors%mean_square)
      is_choosing = .false.
    end do
    if (is_tested) call finish_test(self, comm, report)
  end subroutine rounds

  !> Take the errors of the whole problem from the sums under way, and judge them.
  subroutine finish_test(self, comm, report)
    class(glued_solver_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report

    call self%errors%finish(report, comm)
    call self%convergence%judge(self%options, report, self%errors%increments)
  end subroutine finish_test

  !> Take one of equal parts of the masses of shared bodies until the end of the solve.
  pure subroutine glued_divide_masses(self, problem, slot, parts)
    class(glued_solver_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! inverse masses of these bodies grow
    integer, intent(in) :: slot(:) !! the bodies
    integer, intent(in) :: parts(:) !! copies of each; 0 and 1 leave it whole
    integer :: i

    self%divided = slot
    self%whole = problem%body(self%width + 1:, slot)
    do i = 1, size(slot)
      call share_mass(problem%kind, max(1, parts(i)), problem%body(:, slot(i)))
    end do
  end subroutine glued_divide_masses

  !> List the tables that are kept from one problem to the next: the same ones on all ranks.
  subroutine glued_list_tables(self, tables)
    class(glued_solver_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%parts%list_tables(tables)
    call self%errors%list_tables(tables)
    call self%list_shared(tables)
    call tables%begin('masses', per_body)
    call tables%note('divided', self%divided)
    call tables%note('whole', self%whole)
  end subroutine glued_list_tables
end module sg_glued_solver
