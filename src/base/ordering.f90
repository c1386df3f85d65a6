!> Sorting of reals by the integer sort of the base.
module sg_ordering
  use sg_kinds, only: wp, i4, i8
  use sg_sorting, only: sort_permutation
  implicit none
  private
  public :: order_of

contains

  !> Permutation that sorts reals, smallest first; numbers nearer than 2^-50 of the range keep their order.
  pure function order_of(values) result(order)
    real(wp), intent(in) :: values(:) !! finite numbers
    integer(i4), allocatable :: order(:)
    integer(i8), allocatable :: keys(:)
    real(wp) :: low, range

    allocate (keys(size(values)), source=0_i8)
    if (size(values) > 0) then
      low = minval(values)
      range = maxval(values) - low
      if (range > 0) keys = int((values - low)/range*2.0_wp**50, i8)
    end if
    order = sort_permutation(keys)
  end function order_of
end module sg_ordering
