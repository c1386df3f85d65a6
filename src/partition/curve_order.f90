!> The order of grains along Hilbert's curve through the scene: near along the curve is near in space.
module sg_curve_order
  use sg_boxes, only: extent_of
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, i4, i8
  use sg_sorting, only: hilbert_key, hilbert_key_in_space, sort_permutation
  implicit none
  private
  public :: curve_order

contains

  !> Order of this rank's grains along the curve; the same curve on all ranks. Collective.
  function curve_order(comm, position) result(order)
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(in) :: position(:, :) !! centres of this rank's grains [m], shape (dimension, n)
    integer(i4), allocatable :: order(:)
    real(wp) :: low(size(position, 1)), high(size(position, 1)), side
    integer(i8), allocatable :: key(:)
    integer :: i

    call extent_of(comm, position, low, high)
    ! Of equal sides: cells of the curve should be as long as they are wide.
    side = maxval(high - low)
    if (.not. side > 0) side = 1
    allocate (key(size(position, 2)))
    do i = 1, size(key)
      if (size(low) == 2) then
        key(i) = hilbert_key((position(:, i) - low)/side)
      else
        key(i) = hilbert_key_in_space((position(:, i) - low)/side)
      end if
    end do
    order = sort_permutation(key)
  end function curve_order
end module sg_curve_order
