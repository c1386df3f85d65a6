!> When sweeps have converged, and when to look up again whom they visit: the same judgement for one rank and for many.
module sg_convergence
  use sg_kinds, only: wp
  use sg_lists, only: reserve
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e1, criterion_e2, criterion_e8, criterion_estimate, criterion_violation, solver_options_t
  implicit none
  private
  public :: convergence_t, criterion_value, looks_at_errors, rounding_of

  !> Who is visited is looked up again when the sweeps have doubled, or when a test finds the criterion above this share
  !! of the last one
  real(wp), parameter :: stalled = 0.95_wp

  !> The tests of one solve so far
  type :: convergence_t
    !> Velocity error that rounding leaves [m/s]
    real(wp) :: rounding = 0
    !> Is it time to look up whom to visit?
    logical :: is_choice_due = .false.
    !> Sweeps when that was looked up, and the criterion of the last test
    integer, private :: last_choice = 0
    real(wp), private :: last_criterion = huge(1.0_wp)
    !> e8 at each test so far
    real(wp), allocatable, private :: past_e8(:)
  contains
    procedure :: begin => convergence_begin
    procedure :: judge => convergence_judge
  end type convergence_t

contains

  !> Does a criterion look at the errors of a report, not at the increments of a sweep?
  pure logical function looks_at_errors(criterion)
    integer, intent(in) :: criterion !! one of `criterion_*`

    looks_at_errors = any(criterion == [criterion_e1, criterion_e2, criterion_e8, criterion_violation, criterion_estimate])
  end function looks_at_errors

  !> Begin a solve.
  pure subroutine convergence_begin(self, fastest)
    class(convergence_t), intent(inout) :: self
    real(wp), intent(in) :: fastest !! largest velocity component of all bodies [m/s]

    self%last_choice = 0
    self%last_criterion = huge(1.0_wp)
    self%rounding = rounding_of(fastest)
    self%is_choice_due = .false.
  end subroutine convergence_begin

  !> Velocity error that rounding leaves [m/s].
  pure real(wp) function rounding_of(fastest)
    real(wp), intent(in) :: fastest !! largest velocity component of all bodies [m/s]

    rounding_of = 16*epsilon(1.0_wp)*fastest
  end function rounding_of

  !> Judge a test: sets the estimate, the criterion and whether it is reached.
  subroutine convergence_judge(self, options, velocity_scale, report, increments)
    class(convergence_t), intent(inout) :: self
    type(solver_options_t), intent(in) :: options !! criterion, tolerance, sweeps between two tests
    real(wp), intent(in) :: velocity_scale !! of the violation [m/s]
    type(report_t), intent(inout) :: report !! its errors are measured
    real(wp), intent(in) :: increments !! value of a criterion that looks at increments; not used for others

    report%checks = report%checks + 1
    call reserve(self%past_e8, report%checks)
    self%past_e8(report%checks) = report%e8
    report%estimate = estimated_error(self%past_e8(:report%checks), options%check_every)
    report%criterion = criterion_value(options%criterion, report, increments)
    report%is_converged = report%criterion <= options%tolerance .or. report%violation*velocity_scale <= self%rounding
    self%is_choice_due = .not. report%is_converged .and. &
                         (report%sweeps >= 2*self%last_choice .or. (report%criterion > stalled*self%last_criterion .and. &
                                                                    report%sweeps >= self%last_choice + self%last_choice/4))
    if (self%is_choice_due) self%last_choice = report%sweeps
    self%last_criterion = report%criterion
  end subroutine convergence_judge

  !> Value of a stopping criterion, from a report whose errors are measured.
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
end module sg_convergence
