!> Largest and lowest values of long lists. Places that lie a fixed number apart have one of their own, so that no comparison waits
!! for the one before; the results are those of `maxval` and `minval`, which take a value at a time.
module sg_extremes
  use sg_kinds, only: wp
  implicit none
  private
  public :: are_finite, largest_magnitude, lowest_value

  !> Values that are compared at once: two vector registers of the widest kind
  integer, parameter :: lanes = 16

contains

  !> Are all values finite numbers?
  pure logical function are_finite(n, values)
    integer, intent(in) :: n !! number of values
    real(wp), intent(in) :: values(n) !! the values
    real(wp) :: broken(lanes)
    integer :: i, j

    broken = 0
    do i = 0, n - lanes, lanes
      do j = 1, lanes
        broken(j) = merge(broken(j), 1.0_wp, abs(values(i + j)) <= huge(1.0_wp))
      end do
    end do
    are_finite = .not. any(broken > 0)
    do i = n - modulo(n, lanes) + 1, n
      are_finite = are_finite .and. abs(values(i)) <= huge(1.0_wp)
    end do
  end function are_finite

  !> Largest absolute value; zero of an empty list. Values that are not numbers are passed over.
  pure real(wp) function largest_magnitude(n, values) result(largest)
    integer, intent(in) :: n !! number of values
    real(wp), intent(in) :: values(n) !! the values
    real(wp) :: lane(lanes)
    integer :: i, j

    lane = 0
    do i = 0, n - lanes, lanes
      do j = 1, lanes
        lane(j) = merge(abs(values(i + j)), lane(j), abs(values(i + j)) > lane(j))
      end do
    end do
    largest = maxval(lane)
    do i = n - modulo(n, lanes) + 1, n
      if (abs(values(i)) > largest) largest = abs(values(i))
    end do
  end function largest_magnitude

  !> Lowest value; the largest number of an empty list. Values that are not numbers are passed over.
  pure real(wp) function lowest_value(n, values) result(lowest)
    integer, intent(in) :: n !! number of values
    real(wp), intent(in) :: values(n) !! the values
    real(wp) :: lane(lanes)
    integer :: i, j

    lane = huge(1.0_wp)
    do i = 0, n - lanes, lanes
      do j = 1, lanes
        lane(j) = merge(values(i + j), lane(j), values(i + j) < lane(j))
      end do
    end do
    lowest = minval(lane)
    do i = n - modulo(n, lanes) + 1, n
      if (values(i) < lowest) lowest = values(i)
    end do
  end function lowest_value
end module sg_extremes
