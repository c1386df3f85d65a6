!> A value that changes with time: constant or expression plus cosine times a clipped ramp, a table, or the sum of both.
!!
!! value(t) = (constant + amplitude cos(omega t + phase)) min(1, ramp_start + ramp_rate t), the form of LMGC90's
!! DRV_DOF.DAT, where an expression may stand in place of the constant; a table is linear between its points, and beyond its ends
!! constant or on along its first and last line. What it drives acts from `start` until `finish`.
module sg_time_functions
  use sg_expressions, only: expression_t
  use sg_kinds, only: wp
  implicit none
  private
  public :: time_function_t

  !> A function of time
  type :: time_function_t
    !> Constant part and amplitude of the cosine, in the unit of the value
    real(wp) :: constant = 0, amplitude = 0
    !> Pulsation [rad/s] and phase [rad] of the cosine
    real(wp) :: omega = 0, phase = 0
    !> Ramp: value at time zero and growth [1/s]; a constant has ramp_start 1
    real(wp) :: ramp_start = 1, ramp_rate = 0
    !> Expression of time that replaces the constant, and a bound of its size
    type(expression_t), allocatable :: expression
    real(wp) :: expression_bound = 0
    !> Table: times [s] and values
    real(wp), allocatable :: times(:), values(:)
    !> Table: does it go on linearly beyond its ends, as evolution files of LMGC90 do? Else it holds its end values
    logical :: goes_on = .false.
    !> Does the formula add to the table? Else the table replaces it
    logical :: is_sum = .false.
    !> When it begins and ends to act [s]
    real(wp) :: start = -huge(1.0_wp), finish = huge(1.0_wp)
    !> Time from which the function counts its own [s]: the start of a stage
    real(wp) :: origin = 0
  contains
    procedure :: at => value_at
    procedure :: largest => largest_value
    procedure :: is_zero => value_is_zero
    procedure :: is_timed => value_is_timed
    procedure :: acts => value_acts
  end type time_function_t

contains

  !> The value at a time, whether it acts or not.
  pure real(wp) function value_at(self, time) result(value)
    class(time_function_t), intent(in) :: self
    real(wp), intent(in) :: time !! [s]
    real(wp) :: own

    own = time - self%origin
    if (allocated(self%times)) then
      value = interpolated(self%times, self%values, self%goes_on, own)
      if (self%is_sum) value = value + formula_at(self, own)
    else
      value = formula_at(self, own)
    end if
  end function value_at

  !> The value of the formula at a time.
  pure real(wp) function formula_at(self, time) result(value)
    class(time_function_t), intent(in) :: self
    real(wp), intent(in) :: time
    real(wp) :: constant

    constant = self%constant
    if (allocated(self%expression)) constant = self%expression%at([time])
    value = (constant + self%amplitude*cos(self%omega*time + self%phase))*min(1.0_wp, self%ramp_start + self%ramp_rate*time)
  end function formula_at

  !> Does it have a beginning or an end?
  pure logical function value_is_timed(self)
    class(time_function_t), intent(in) :: self

    value_is_timed = self%start > -huge(1.0_wp) .or. self%finish < huge(1.0_wp)
  end function value_is_timed

  !> Does it act in a step? The middle of the step decides, which no rounding brings to the other side of a beginning or an end
  !! that falls on a step.
  pure logical function value_acts(self, middle)
    class(time_function_t), intent(in) :: self
    real(wp), intent(in) :: middle !! of the step [s]

    value_acts = middle >= self%start .and. middle < self%finish
  end function value_acts

  !> A bound of the size of the value at all times: of the formula with its full ramp, of the table, or of both.
  pure real(wp) function largest_value(self) result(value)
    class(time_function_t), intent(in) :: self

    value = 0
    if (allocated(self%times)) value = maxval(abs(self%values))
    if (allocated(self%times) .and. .not. self%is_sum) return
    if (allocated(self%expression)) then
      value = value + self%expression_bound + abs(self%amplitude)
    else
      value = value + abs(self%constant) + abs(self%amplitude)
    end if
  end function largest_value

  !> Is the value zero at all times?
  pure logical function value_is_zero(self)
    class(time_function_t), intent(in) :: self

    value_is_zero = .not. self%largest() > 0 .and. .not. allocated(self%expression)
  end function value_is_zero

  !> Linear interpolation in a table, found by bisection, and extrapolation where it goes on.
  pure real(wp) function interpolated(times, values, goes_on, time) result(value)
    real(wp), intent(in) :: times(:), values(:), time
    logical, intent(in) :: goes_on
    integer :: low, high, middle

    low = 1
    high = size(times)
    if (time <= times(low) .and. .not. goes_on) then
      value = values(low)
    else if (time >= times(high) .and. .not. goes_on) then
      value = values(high)
    else
      do while (high - low > 1)
        middle = (low + high)/2
        if (times(middle) <= time) then
          low = middle
        else
          high = middle
        end if
      end do
      value = values(low) + (values(high) - values(low))*(time - times(low))/(times(high) - times(low))
    end if
  end function interpolated
end module sg_time_functions
