!> Geometrical boxes: slabs across x of equal weight, each cut across y into boxes of equal weight.
module sg_boxes
  use sg_kinds, only: wp, i4
  use sg_ordering, only: order_of
  implicit none
  private
  public :: split_boxes, fitting_boxes

contains

  !> Part of each grain, from 1, column by column of boxes; each part's weight is even but for one grain a cut.
  pure function split_boxes(position, weight, counts) result(part)
    real(wp), intent(in) :: position(:, :) !! centres of the grains [m], shape (2, n)
    integer(i4), intent(in) :: weight(:) !! cost of each grain, positive, shape (n)
    integer, intent(in) :: counts(2) !! boxes along x and y
    integer(i4), allocatable :: part(:), column(:), row(:), members(:)
    integer :: i, c

    allocate (part(size(weight)), source=1_i4)
    column = cut(position(1, :), weight, counts(1))
    do c = 1, counts(1)
      members = pack([(int(i, i4), i=1, size(weight))], column == c)
      row = cut(position(2, members), weight(members), counts(2))
      part(members) = int((c - 1)*counts(2), i4) + row
    end do
  end function split_boxes

  !> Cut a line of weights into pieces of equal weight: the piece of each item, from 1.
  pure function cut(place, weight, pieces) result(piece)
    real(wp), intent(in) :: place(:)
    integer(i4), intent(in) :: weight(:)
    integer, intent(in) :: pieces
    integer(i4), allocatable :: piece(:), order(:)
    real(wp) :: before, total
    integer :: i

    allocate (piece(size(place)))
    order = order_of(place)
    total = sum(real(weight, wp))
    before = 0
    do i = 1, size(order)
      associate (own => real(weight(order(i)), wp))
        ! The middle of an item's weight decides.
        piece(order(i)) = 1_i4 + int(real(pieces, wp)*(before + own/2)/total, i4)
        before = before + own
      end associate
    end do
  end function cut

  !> Boxes along x and y, `parts` together, whose cuts through a rectangle are shortest.
  pure function fitting_boxes(parts, extent) result(counts)
    integer, intent(in) :: parts !! number of boxes
    real(wp), intent(in) :: extent(2) !! width and height of the rectangle [m]
    integer :: counts(2), columns
    real(wp) :: length, shortest

    shortest = huge(1.0_wp)
    do columns = 1, parts
      if (modulo(parts, columns) /= 0) cycle
      length = real(columns - 1, wp)*extent(2) + real(parts/columns - 1, wp)*extent(1)
      if (length >= shortest) cycle
      shortest = length
      counts = [columns, parts/columns]
    end do
  end function fitting_boxes
end module sg_boxes
