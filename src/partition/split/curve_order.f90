!> The order of grains along Hilbert's curve through the scene: near along the curve is near in space.
module sg_curve_order
  use sg_boxes, only: extent_of
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, i4
  use sg_sorting, only: hilbert_order
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

    call extent_of(comm, position, low, high)
    ! Of equal sides: cells of the curve should be as long as they are wide.
    side = maxval(high - low)
    if (.not. side > 0) side = 1
    order = hilbert_order(position, low, side)
  end function curve_order
end module sg_curve_order
