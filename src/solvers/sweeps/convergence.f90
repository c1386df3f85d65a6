!> Convergence of sweeps, and when to choose the active set again: the same judgement for one rank and for many.
module sg_convergence
  use sg_kinds, only: wp
  use sg_law_violation, only: most_hidden
  use sg_lists, only: reserve
  use sg_problem, only: problem_t
  use sg_records, only: is_in_space, velocity_y, velocity_z
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e1, criterion_e2, criterion_e8, criterion_estimate, criterion_violation, solver_options_t
  implicit none
  private
  public :: convergence_t, scales_t, looks_at_errors, scales_of

  !> The active set is chosen again when the sweeps have doubled, or when a test finds the criterion above this share
  !! of the last one
  real(wp), parameter :: stalled = 0.95_wp
  !> Share of the scale of a step that a single contact may break its law by where a solve counts as converged
  real(wp), parameter :: most_broken = 0.5_wp

  !> Scales of the problem of a step, over all ranks
  type :: scales_t
    !> Contacts
    integer :: contacts = 0
    !> Largest velocity component of all bodies, velocity scale of the violation, and the largest relative velocity of contacts
    !! that need an impulse [m/s]
    real(wp) :: fastest = 0, velocity = 0, closing = 0
    !> Largest friction
    real(wp) :: friction = 0
  end type scales_t

  !> The tests of one solve so far
  type :: convergence_t
    !> Is a new choice of the active set due?
    logical :: is_choice_due = .false.
    !> Did a contact break its law by too much where the criterion was reached? Then no cluster counts as solved by the criterion
    logical :: is_contested = .false.
    !> Is nothing left but rounding, while the criterion is above its tolerance?
    logical, private :: is_rounding = .false.
    !> Scales of the problem, and the velocity error that rounding leaves [m/s]
    type(scales_t), private :: scales
    real(wp), private :: rounding = 0
    !> Sweeps at which the active set was last chosen, and the criterion of the last test
    integer, private :: last_choice = 0
    real(wp), private :: last_criterion = huge(1.0_wp)
    !> Test at which e8 was last found not to fall
    integer, private :: last_stuck = 0
    !> e8 at each test so far
    real(wp), allocatable, private :: past_e8(:)
  contains
    procedure :: begin => convergence_begin
    procedure :: judge => convergence_judge
    procedure :: decide => convergence_decide
    procedure :: must_look => convergence_must_look
    procedure :: confirm => convergence_confirm
    procedure :: finish => convergence_finish
    procedure :: find_stuck => convergence_find_stuck
  end type convergence_t

contains

  !> Does a criterion look at the errors of a report, not at the increments of a sweep?
  pure logical function looks_at_errors(criterion)
    integer, intent(in) :: criterion !! one of `criterion_*`

    looks_at_errors = any(criterion == [criterion_e1, criterion_e2, criterion_e8, criterion_violation, criterion_estimate])
  end function looks_at_errors

  !> Scales of a problem, or of a rank's part of it, with the velocities to start from.
  pure type(scales_t) function scales_of(problem) result(scales)
    type(problem_t), intent(in) :: problem !! problem
    integer :: last

    scales%contacts = problem%n_contacts
    scales%velocity = problem%velocity_scale
    scales%closing = problem%closing_speed
    if (problem%n_contacts > 0) scales%friction = problem%most_friction
    last = merge(velocity_z, velocity_y, is_in_space(problem%kind))
    if (problem%n_bodies > 0) scales%fastest = maxval(abs(problem%body(:last, :)))
  end function scales_of

  !> Begin a solve.
  pure subroutine convergence_begin(self, scales)
    class(convergence_t), intent(inout) :: self
    type(scales_t), intent(in) :: scales !! of the problem

    self%last_choice = 0
    self%last_criterion = huge(1.0_wp)
    self%scales = scales
    self%rounding = 16*epsilon(1.0_wp)*max(scales%fastest, scales%velocity)
    self%is_choice_due = .false.
    self%is_contested = .false.
    self%last_stuck = 0
    self%is_rounding = .false.
  end subroutine convergence_begin

  !> Judge a test of sweeps: sets the estimate, the criterion, and whether that is reached. Where `must_look` is true, `confirm`
  !! decides.
  subroutine convergence_judge(self, options, report, increments)
    class(convergence_t), intent(inout) :: self
    type(solver_options_t), intent(in) :: options !! criterion, tolerance, sweeps between two tests
    type(report_t), intent(inout) :: report !! its errors are measured
    real(wp), intent(in) :: increments !! value of a criterion that looks at increments; not used for others

    report%checks = report%checks + 1
    call reserve(self%past_e8, report%checks)
    self%past_e8(report%checks) = report%e8
    report%estimate = estimated_error(self%past_e8(:report%checks), options%check_every)
    call self%decide(options, report, increments)
    self%is_choice_due = .not. report%is_converged .and. &
                         (report%sweeps >= 2*self%last_choice .or. (report%criterion > stalled*self%last_criterion .and. &
                                                                    report%sweeps >= self%last_choice + self%last_choice/4))
    if (self%is_choice_due) self%last_choice = report%sweeps
    self%last_criterion = report%criterion
  end subroutine convergence_judge

  !> Set the criterion of a report with measured errors, and whether it is reached, or nothing but rounding is left.
  pure subroutine convergence_decide(self, options, report, increments)
    class(convergence_t), intent(inout) :: self
    type(solver_options_t), intent(in) :: options !! criterion and tolerance
    type(report_t), intent(inout) :: report !! errors and estimate are set
    real(wp), intent(in) :: increments !! value of a criterion that looks at increments

    report%criterion = criterion_value(options%criterion, report, increments)
    report%is_converged = report%criterion <= options%tolerance
    self%is_rounding = .not. report%is_converged .and. report%violation*self%scales%velocity <= self%rounding
    report%is_converged = report%is_converged .or. self%is_rounding
  end subroutine convergence_decide

  !> Must the contacts be looked at one by one before a solve counts as converged? Not where the rms error bounds that of each.
  pure logical function convergence_must_look(self, report) result(must_look)
    class(convergence_t), intent(in) :: self
    type(report_t), intent(in) :: report !! judged
    real(wp) :: bound

    bound = report%violation*self%scales%velocity*sqrt(real(self%scales%contacts, wp))*most_hidden(self%scales%friction)
    must_look = report%is_converged .and. .not. bound <= most_allowed(self)
  end function convergence_must_look

  !> Velocity by which a single contact may break its law [m/s]: half of what a step of free fall brings, or of what contacts close
  !! with where that is more. Where nothing but rounding may be left, as much as the rms of rounding leaves room for.
  pure real(wp) function most_allowed(self)
    type(convergence_t), intent(in) :: self

    if (self%is_rounding) then
      most_allowed = self%rounding*sqrt(real(self%scales%contacts, wp))*most_hidden(1.0_wp)
    else
      most_allowed = most_broken*max(self%scales%velocity, self%scales%closing)
    end if
  end function most_allowed

  !> Take back that a solve has converged where a contact breaks its law by too much.
  pure subroutine convergence_confirm(self, speed, report)
    class(convergence_t), intent(inout) :: self
    real(wp), intent(in) :: speed !! largest velocity by which a contact breaks its law [m/s]
    type(report_t), intent(inout) :: report !! judged

    report%is_converged = speed <= most_allowed(self)
    self%is_rounding = self%is_rounding .and. report%is_converged
    if (report%is_converged) return
    self%is_choice_due = .not. self%is_contested .or. report%sweeps >= 2*self%last_choice
    self%is_contested = .true.
    if (self%is_choice_due) self%last_choice = report%sweeps
  end subroutine convergence_confirm

  !> Is e8 no less than two tests before, and was that not so in the last two?
  pure subroutine convergence_find_stuck(self, report, is_stuck)
    class(convergence_t), intent(inout) :: self
    type(report_t), intent(in) :: report !! judged
    logical, intent(out) :: is_stuck !! does the error not fall?

    is_stuck = report%checks > self%last_stuck + 2
    if (is_stuck) is_stuck = .not. self%past_e8(report%checks) < self%past_e8(report%checks - 2)
    if (is_stuck) self%last_stuck = report%checks
  end subroutine convergence_find_stuck

  !> End a solve: errors that are nothing but rounding are none, since what they are relative to is rounding as well.
  pure subroutine convergence_finish(self, report)
    class(convergence_t), intent(in) :: self
    type(report_t), intent(inout) :: report !! errors of the solution are measured

    if (.not. self%is_rounding) return
    report%e1 = 0
    report%e2 = 0
    report%e8 = 0
    report%violation = 0
    report%estimate = 0
    report%criterion = 0
  end subroutine convergence_finish

  !> Value of a stopping criterion, from a report with measured errors.
  pure real(wp) function criterion_value(criterion, report, increments) result(value)
    integer, intent(in) :: criterion !! one of `criterion_*`
    type(report_t), intent(in) :: report !! errors and estimate
    real(wp), intent(in) :: increments !! value for criteria that look at increments

    select case (criterion)
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
      value = increments
    end select
  end function criterion_value

  !> Error of the impulses, estimated from e8 and the rate at which it falls (doc/theory/errors.md).
  !!
  !! e8 is about what one more sweep would change. Where it falls by the factor s a sweep, all sweeps to come change
  !! e8/(1 - s): on tall packings thousands of times more. The rate is taken over the last half of the sweeps. It is
  !! never taken for faster than one over the number of sweeps, nor than one over `fewest`: the fall after a cold start is
  !! that of the grains' neighbourhoods, not of the whole, and a few sweeps carry no information, however often they are tested.
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
end module sg_convergence
