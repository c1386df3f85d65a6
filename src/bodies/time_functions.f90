!> A value that changes with time: constant plus cosine times a clipped ramp, or a table.
!!
!! value(t) = (constant + amplitude cos(omega t + phase)) min(1, ramp_start + ramp_rate t), the form of LMGC90's
!! DRV_DOF.DAT; with a table, linear between its points, and beyond its ends constant or on along its first and last line.
module sg_time_functions
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
    !> Table: times [s] and values; replaces the formula when allocated
    real(wp), allocatable :: times(:), values(:)
    !> Table: does it go on linearly beyond its ends, as evolution files of LMGC90 do? Else it holds its end values
    logical :: goes_on = .false.
  contains
    procedure :: at => value_at
    procedure :: largest => largest_value
    procedure :: is_zero => value_is_zero
  end type time_function_t

contains

  !> The value at a time.
  pure real(wp) function value_at(self, time) result(value)
    class(time_function_t), intent(in) :: self
    real(wp), intent(in) :: time !! [s]

    if (allocated(self%times)) then
      value = interpolated(self%times, self%values, self%goes_on, time)
    else
      value = (self%constant + self%amplitude*cos(self%omega*time + self%phase)) &
              *min(1.0_wp, self%ramp_start + self%ramp_rate*time)
    end if
  end function value_at

  !> A bound of the size of the value at all times: of the formula with its full ramp, or of the table.
  pure real(wp) function largest_value(self) result(value)
    class(time_function_t), intent(in) :: self

    if (allocated(self%times)) then
      value = maxval(abs(self%values))
    else
      value = abs(self%constant) + abs(self%amplitude)
    end if
  end function largest_value

  !> Is the value zero at all times?
  pure logical function value_is_zero(self)
    class(time_function_t), intent(in) :: self

    if (allocated(self%times)) then
      value_is_zero = .not. any(abs(self%values) > 0)
    else
      value_is_zero = .not. max(abs(self%constant), abs(self%amplitude)) > 0
    end if
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
