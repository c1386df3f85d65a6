!> Nonlinear Gauss-Seidel: sweeps over the contacts until the stopping criterion holds (doc/theory/nlgs.md).
!!
!! The errors are always those of all contacts. Sweeps visit those that carry an impulse and the open ones that may
!! close; who they are is looked up again as the errors fall.
module sg_nlgs
  use sg_compact, only: add_impulses
  use sg_increments, only: increment_criterion
  use sg_kinds, only: wp, i8
  use sg_lists, only: reserve
  use sg_problem, only: arm_frictional, arm_frictionless, ball_frictional, ball_frictionless, bytes_per_contact, &
                        first_inverse, is_in_space, problem_t, round_frictional, round_frictionless, solid_frictional, &
                        solid_frictionless
  use sg_report, only: report_t
  use sg_residuals, only: choose_visited, measure_errors
  use sg_run_options, only: criterion_e1, criterion_e2, criterion_e8, criterion_estimate, criterion_violation, solver_options_t
  use sg_solver, only: solver_t
  use sg_sweep_arm, only: sweep_arm_frictional, sweep_arm_frictionless
  use sg_sweep_ball, only: sweep_ball_frictional, sweep_ball_frictionless
  use sg_sweep_ball_lanes, only: sweep_ball_lanes
  use sg_sweep_order, only: give_impulses, set_order, sweep_order_t
  use sg_sweep_round, only: sweep_round_frictional, sweep_round_frictionless
  use sg_sweep_solid, only: sweep_solid_frictional, sweep_solid_frictionless
  use sg_timers, only: cpu_now
  implicit none
  private
  public :: nlgs_t

  !> Open contacts that part faster than this many rms errors of velocity are not visited
  real(wp), parameter :: speed_limit = 30
  !> Who is visited is looked up again when the sweeps have doubled, or when a test finds the criterion above this share
  !! of the last one
  real(wp), parameter :: stalled = 0.95_wp

  !> The Gauss-Seidel solver
  type, extends(solver_t) :: nlgs_t
    !> Options of the deck
    type(solver_options_t) :: options
    !> Contacts in the order of the sweep
    type(sweep_order_t), private :: order
    !> Which contacts are visited
    logical, allocatable, private :: is_wanted(:)
    !> Sweeps when this was looked up, and the criterion of the last test
    integer, private :: last_choice = 0
    real(wp), private :: last_criterion = 0
    !> e8 at each test so far
    real(wp), allocatable, private :: past_e8(:)
    !> Velocity error that rounding leaves [m/s]
    real(wp), private :: rounding = 0
    !> For criteria that look at increments: what each contact asks, and bodies that nothing moves
    real(wp), allocatable, private :: asked(:, :), still(:, :)
  contains
    procedure :: solve => nlgs_solve
  end type nlgs_t

contains

  !> Solve a problem by sweeps.
  subroutine nlgs_solve(self, problem, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    real(wp) :: now

    report%bytes_per_contact = bytes_per_contact(problem)
    if (problem%n_contacts == 0) return
    if (.not. self%options%warm_start) problem%impulse = 0
    call add_impulses(problem)
    report%is_converged = .false.
    call start_order(self, problem)
    now = cpu_now()
    do while (report%sweeps < self%options%maximum_sweeps .and. .not. report%is_converged)
      call sweep_until_check(self, problem, report)
      call lap(report%cpu_sweeps, now)
      call check(self, problem, report)
      call lap(report%cpu_checks, now)
    end do
    call measure_errors(problem, report, with_e1=.true.)
    call lap(report%cpu_checks, now)
  end subroutine nlgs_solve

  !> Add the CPU time since `now` to a phase. Asking for the time costs as much as a small sweep: once a phase is enough.
  subroutine lap(phase, now)
    real(wp), intent(inout) :: phase, now
    real(wp) :: before

    before = now
    now = cpu_now()
    phase = phase + now - before
  end subroutine lap

  !> Begin with all contacts.
  subroutine start_order(self, problem)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem

    if (allocated(self%is_wanted)) then
      if (size(self%is_wanted) < problem%n_contacts) deallocate (self%is_wanted)
    end if
    if (.not. allocated(self%is_wanted)) allocate (self%is_wanted(problem%n_contacts + problem%n_contacts/8))
    self%is_wanted(:problem%n_contacts) = .true.
    call set_order(self%order, problem, self%is_wanted, self%options%order == 'groups')
    self%last_choice = 0
    self%last_criterion = huge(1.0_wp)
    self%rounding = 16*epsilon(1.0_wp)*maxval(abs(problem%body(1:merge(3, 2, is_in_space(problem%kind)), :)))
  end subroutine start_order

  !> Sweep as often as the options say between two tests.
  subroutine sweep_until_check(self, problem, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(report_t), intent(inout) :: report
    integer :: i, n

    n = min(self%options%check_every, self%options%maximum_sweeps - report%sweeps)
    do i = 1, n
      if (self%order%n_groups > 0) then
        call sweep_ball_lanes(self%order%n_groups, problem%n_bodies, self%order%lane_pair, self%order%lane_record, &
                              self%options%relaxation, self%order%lane_impulse, problem%body)
        cycle
      end if
      call sweep(problem%kind, self%order, problem%n_bodies, self%options%relaxation, self%order%impulse, problem%body)
    end do
    report%sweeps = report%sweeps + n
    report%contact_updates = report%contact_updates + int(n, i8)*int(self%order%n, i8)
    call give_impulses(self%order, problem)
  end subroutine sweep_until_check

  !> One sweep by the kernel of the problem's kind.
  subroutine sweep(kind, order, n_bodies, relaxation, impulse, body)
    integer, intent(in) :: kind, n_bodies
    type(sweep_order_t), intent(in) :: order
    real(wp), intent(in) :: relaxation
    real(wp), intent(inout) :: impulse(:, :), body(:, :)

    select case (kind)
    case (round_frictionless)
      call sweep_round_frictionless(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (round_frictional)
      call sweep_round_frictional(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (arm_frictionless)
      call sweep_arm_frictionless(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (arm_frictional)
      call sweep_arm_frictional(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (ball_frictionless)
      call sweep_ball_frictionless(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (ball_frictional)
      call sweep_ball_frictional(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (solid_frictionless)
      call sweep_solid_frictionless(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    case (solid_frictional)
      call sweep_solid_frictional(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    end select
  end subroutine sweep

  !> Measure the errors, compare the criterion with its tolerance, and choose anew whom to visit when it is time.
  subroutine check(self, problem, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    type(report_t), intent(inout) :: report
    integer :: visited, missed

    report%checks = report%checks + 1
    call measure_errors(problem, report, any(self%options%criterion == [criterion_e1, criterion_e2]))
    call reserve(self%past_e8, report%checks)
    self%past_e8(report%checks) = report%e8
    report%estimate = estimated_error(self%past_e8(:report%checks), self%options%check_every)
    report%criterion = criterion_value(self, problem, report)
    report%is_converged = report%criterion <= self%options%tolerance &
                          .or. report%violation*problem%velocity_scale <= self%rounding
    if (.not. report%is_converged .and. (report%sweeps >= 2*self%last_choice &
                                         .or. (report%criterion > stalled*self%last_criterion &
                                               .and. report%sweeps >= self%last_choice + self%last_choice/4))) then
      self%last_choice = report%sweeps
      call choose_visited(problem, report, speed_limit, self%is_wanted, visited, missed)
      if (missed > 0 .or. visited < self%order%n - self%order%n/16) then
        call set_order(self%order, problem, self%is_wanted, self%options%order == 'groups')
      end if
    end if
    self%last_criterion = report%criterion
  end subroutine check

  !> Value of the stopping criterion.
  real(wp) function criterion_value(self, problem, report) result(value)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    type(report_t), intent(in) :: report

    select case (self%options%criterion)
    case (criterion_estimate)
      value = report%estimate
    case (criterion_e1)
      value = report%e1
    case (criterion_e2)
      value = report%e2
    case (criterion_e8)
      value = report%e8
    case (criterion_violation)
      value = report%violation
    case default
      call ask_all(self, problem)
      value = increment_criterion(problem%kind, self%order, self%asked, self%options%criterion)
    end select
  end function criterion_value

  !> What each contact asks while all others stay: a sweep over bodies that nothing moves, as LMGC90 tests.
  subroutine ask_all(self, problem)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    self%asked = self%order%impulse
    self%still = problem%body
    self%still(first_inverse(problem%kind):, :) = 0
    call sweep(problem%kind, self%order, problem%n_bodies, 1.0_wp, self%asked, self%still)
  end subroutine ask_all

  !> Error of the impulses, estimated from e8 and the rate at which it falls (doc/theory/errors.md).
  !!
  !! e8 is about what one more sweep would change. Where it falls by the factor s a sweep, all sweeps to come change
  !! e8/(1 - s): on tall packings thousands of times more. The rate is taken over the last half of the sweeps. It is
  !! never taken for faster than one over the number of sweeps, nor than one over `fewest`: the fall after a cold start is
  !! that of the grains' neighbourhoods, not of the whole, and a few sweeps tell nothing, however often they are tested.
  pure real(wp) function estimated_error(past_e8, check_every) result(estimate)
    real(wp), intent(in) :: past_e8(:) !! e8 at each test, the last one now
    integer, intent(in) :: check_every !! sweeps between two tests
    real(wp), parameter :: fewest = 100
    integer :: n, base
    real(wp) :: sweeps_to_fall

    n = size(past_e8)
    base = n/2
    sweeps_to_fall = max(fewest, real(check_every*n, wp))
    if (base > 0) then
      if (past_e8(n) > 0 .and. past_e8(base) > past_e8(n)) then
        sweeps_to_fall = max(sweeps_to_fall, real(check_every*(n - base), wp)/log(past_e8(base)/past_e8(n)))
      else if (past_e8(n) > 0) then
        sweeps_to_fall = 100*sweeps_to_fall
      end if
    end if
    estimate = past_e8(n)*sweeps_to_fall
  end function estimated_error
end module sg_nlgs
