!> Convergence of sweeps, and when to choose the active set again: the same judgement for one rank and for many.
module sg_convergence
  use sg_kinds, only: wp
  use sg_law_violation, only: most_hidden
  use sg_problem, only: problem_t
  use sg_problem_bodies, only: fastest_of
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e1, criterion_e2, criterion_e8, criterion_estimate, criterion_violation, solver_options_t
  use sg_check_history, only: check_history_t
  implicit none
  private
  public :: convergence_t, scales_t, looks_at_errors, scales_of

  !> The active set is chosen again when the sweeps have doubled, or when a test finds the criterion above this share
  !! of the last one
  real(wp), parameter :: stalled = 0.95_wp
  !> Share of the scale of a step that a single contact may break its law by where a solve counts as converged
  real(wp), parameter :: most_broken = 0.5_wp

  !> Estimate that a solve without a guess has to reach whatever the criterion: the default of decks
  real(wp), parameter :: cold_tolerance = 2e-2_wp
  !> Fewest sweeps before the first choice after that of the guess, where tests adapt
  integer, parameter :: first_choice = 20

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
    !> Has the estimate to be small whatever the criterion?
    logical, private :: is_cold = .false.
    !> Scales of the problem, and the velocity error that rounding leaves [m/s]
    type(scales_t), private :: scales
    real(wp), private :: rounding = 0
    !> Sweeps at which the active set was last chosen, and the criterion of the last test
    integer, private :: last_choice = 0
    real(wp), private :: last_criterion = huge(1.0_wp)
    !> Sweeps at which e8 was last found not to fall
    integer, private :: last_stuck = 0
    !> The tests so far, what the last one found over what is asked for, and the sweeps at which the next one is due
    type(check_history_t), private :: history
    real(wp), private :: last_excess = huge(1.0_wp)
    integer :: next_test = 0
  contains
    procedure :: begin => convergence_begin
    procedure, private :: plan_test => convergence_plan_test
    procedure :: asked => convergence_asked
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

    scales%contacts = problem%n_contacts
    scales%velocity = problem%velocity_scale
    scales%closing = problem%closing_speed
    if (problem%n_contacts > 0) scales%friction = problem%most_friction
    if (allocated(problem%moves)) then
      scales%fastest = problem%fastest
    else
      scales%fastest = fastest_of(problem%n_bodies, problem%kind, problem%body)
    end if
  end function scales_of

  !> Begin a solve.
  pure subroutine convergence_begin(self, options, is_cold, scales)
    class(convergence_t), intent(inout) :: self
    type(solver_options_t), intent(in) :: options !! sweeps between two tests, or none for those that the errors ask for
    logical, intent(in) :: is_cold !! no impulse is guessed, and the estimate has to be small whatever the criterion
    type(scales_t), intent(in) :: scales !! of the problem

    self%is_cold = is_cold
    self%last_choice = 0
    if (options%check_every == 0) self%last_choice = first_choice/2
    self%last_criterion = huge(1.0_wp)
    self%scales = scales
    self%rounding = 16*epsilon(1.0_wp)*max(scales%fastest, scales%velocity)
    self%is_choice_due = .false.
    self%is_contested = .false.
    self%last_stuck = 0
    self%is_rounding = .false.
    self%history%n = 0
    self%last_excess = huge(1.0_wp)
    call self%plan_test(options, 0, huge(1.0_wp))
  end subroutine convergence_begin

  !> Judge a test of sweeps: sets the estimate, the criterion, and whether that is reached. Where `must_look` is true, `confirm`
  !! decides.
  subroutine convergence_judge(self, options, gain, report, increments)
    class(convergence_t), intent(inout) :: self
    type(solver_options_t), intent(in) :: options !! criterion, tolerance, sweeps between two tests
    real(wp), intent(in) :: gain !! plain sweeps that those done are worth beyond their number
    type(report_t), intent(inout) :: report !! its errors are measured
    real(wp), intent(in) :: increments !! value of a criterion that looks at increments; not used for others

    report%checks = report%checks + 1
    call self%history%add(report%sweeps, real(report%sweeps, wp) + gain, report%e8)
    report%estimate = self%history%estimate(report%change)
    call self%decide(options, report, increments)
    self%is_choice_due = .not. report%is_converged .and. &
                         (report%sweeps >= 2*self%last_choice .or. (report%criterion > stalled*self%last_criterion .and. &
                                                                    report%sweeps >= self%last_choice + self%last_choice/4))
    if (self%is_choice_due) self%last_choice = report%sweeps
    call self%plan_test(options, report%sweeps, excess(self, options, report))
    self%last_criterion = report%criterion
  end subroutine convergence_judge

  !> Plan the next test: as many sweeps on as the options ask for, or where the criterion is expected to reach its tolerance.
  pure subroutine convergence_plan_test(self, options, sweeps, now)
    class(convergence_t), intent(inout) :: self
    type(solver_options_t), intent(in) :: options !! sweeps between two tests
    integer, intent(in) :: sweeps !! done before the last test
    real(wp), intent(in) :: now !! excess there

    if (options%check_every > 0) then
      self%next_test = sweeps + options%check_every
    else
      self%next_test = self%history%next_test(now, self%last_excess)
    end if
    self%last_excess = now
  end subroutine convergence_plan_test

  !> Value of the criterion over its tolerance; where no impulse was guessed, of the estimate over its tolerance where that is more.
  !!
  !! Other criteria hardly weigh the slow modes of a tall packing: at an e8 of 1e-4 the floor may miss half of its weight.
  pure real(wp) function excess(self, options, report)
    type(convergence_t), intent(in) :: self
    type(solver_options_t), intent(in) :: options
    type(report_t), intent(in) :: report

    ! A tolerance of 0 is never reached: benchmarks sweep to their last.
    excess = huge(1.0_wp)
    if (report%criterion < min(1.0_wp, options%tolerance)*huge(1.0_wp)) excess = report%criterion/options%tolerance
    if (must_be_small(self, options)) excess = max(excess, report%estimate/cold_tolerance)
  end function excess

  !> Tolerance of the criterion over its value, or of the estimate where that asks for more.
  pure real(wp) function convergence_asked(self, options, report) result(asked)
    class(convergence_t), intent(in) :: self
    type(solver_options_t), intent(in) :: options !! criterion and tolerance
    type(report_t), intent(in) :: report !! judged, and not converged

    asked = options%tolerance/report%criterion
    if (must_be_small(self, options)) asked = min(asked, cold_tolerance/report%estimate)
  end function convergence_asked

  !> Has the estimate to be small, while another criterion is asked for?
  pure logical function must_be_small(self, options)
    type(convergence_t), intent(in) :: self
    type(solver_options_t), intent(in) :: options

    must_be_small = self%is_cold .and. options%criterion /= criterion_estimate
  end function must_be_small

  !> Set the criterion of a report with measured errors, and whether it is reached, or nothing but rounding is left.
  pure subroutine convergence_decide(self, options, report, increments)
    class(convergence_t), intent(inout) :: self
    type(solver_options_t), intent(in) :: options !! criterion and tolerance
    type(report_t), intent(inout) :: report !! errors and estimate are set
    real(wp), intent(in) :: increments !! value of a criterion that looks at increments

    report%criterion = criterion_value(options%criterion, report, increments)
    report%is_converged = report%criterion <= options%tolerance .and. &
                          (report%estimate <= cold_tolerance .or. .not. must_be_small(self, options))
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

  !> Is e8 no less than two tests, or their sweeps, before, and was that not so in the sweeps between?
  pure subroutine convergence_find_stuck(self, options, sweeps, is_stuck)
    class(convergence_t), intent(inout) :: self
    type(solver_options_t), intent(in) :: options !! sweeps between two tests
    integer, intent(in) :: sweeps !! done before the last test
    logical, intent(out) :: is_stuck !! does the error not fall?
    integer :: gap

    gap = 2*options%typical_gap()
    is_stuck = sweeps > self%last_stuck + gap
    if (is_stuck) is_stuck = self%history%has_not_fallen(gap)
    if (is_stuck) self%last_stuck = sweeps
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
end module sg_convergence
