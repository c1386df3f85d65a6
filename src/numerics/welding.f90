!> Points that lie nearer to each other than a tolerance, made one: what a mesh file repeats for every triangle.
module sg_welding
  use sg_ascending, only: place_in
  use sg_kinds, only: wp, i4, i8
  use sg_sorting, only: sort_permutation
  implicit none
  private
  public :: weld

  !> Bits of the number of a cell along each axis: sorting takes keys of 55 bits
  integer, parameter :: cell_bits = 18

contains

  !> For every point the first point that it lies near to, itself where there is none: `same(same(i)) == same(i)`.
  !!
  !! The cells are several tolerances wide, so that what is near lies in the same cell, or in one next to it when the point
  !! is near that side. Time grows as n log n unless many points that differ share a cell; equal ones cost nothing.
  pure subroutine weld(points, tolerance, same)
    real(wp), intent(in) :: points(:, :) !! finite [m], shape (3, points)
    real(wp), intent(in) :: tolerance !! distance below which points are one [m]
    integer(i4), allocatable, intent(out) :: same(:) !! shape (points)
    integer(i8), allocatable :: keys(:), sorted(:)
    integer(i4), allocatable :: order(:), next(:)
    real(wp) :: low(3), width
    integer :: i, n

    n = size(points, 2)
    allocate (same(n), keys(n), next(n))
    if (n == 0) return
    low = minval(points, 2)
    width = max(8*tolerance, maxval(maxval(points, 2) - low)/real(2**cell_bits - 4, wp))
    if (.not. width > 0) width = 1
    do i = 1, n
      keys(i) = cell_key(int((points(:, i) - low)/width) + 1)
    end do
    order = sort_permutation(keys)
    sorted = keys(order)
    call weld_sorted(points, tolerance, low, width, order, sorted, next, same)
  end subroutine weld

  !> Weld, the points being sorted by cell: the first points of groups in a cell stand in a list.
  pure subroutine weld_sorted(points, tolerance, low, width, order, sorted, next, same)
    real(wp), intent(in) :: points(:, :), tolerance, low(3), width
    integer(i4), intent(in) :: order(:)
    integer(i8), intent(in) :: sorted(:)
    integer(i4), intent(out) :: next(:), same(:)
    integer(i4), allocatable :: head(:), cell_of(:)
    integer :: i, n, at, found

    n = size(order)
    ! The place of a cell is that of its first point in `sorted`.
    allocate (head(n), cell_of(n))
    head = 0
    next = 0
    at = 1
    do i = 1, n
      if (sorted(i) /= sorted(at)) at = i
      cell_of(order(i)) = at
    end do
    do i = 1, n
      found = near_in_list(points, i, head(cell_of(i)), next, tolerance)
      if (found == 0) found = near_in_cells(points, i, tolerance, low, width, sorted, head, next)
      if (found > 0) then
        same(i) = found
      else
        same(i) = int(i, i4)
        next(i) = head(cell_of(i))
        head(cell_of(i)) = int(i, i4)
      end if
    end do
  end subroutine weld_sorted

  !> The first point of the cells next to a point's that lies near to it; 0 when none does.
  pure integer function near_in_cells(points, i, tolerance, low, width, sorted, head, next) result(found)
    real(wp), intent(in) :: points(:, :), tolerance, low(3), width
    integer, intent(in) :: i
    integer(i8), intent(in) :: sorted(:)
    integer(i4), intent(in) :: head(:), next(:)
    integer :: cell(3), from(3), to(3), dx, dy, dz, place, near

    found = 0
    cell = int((points(:, i) - low)/width)
    from = -merge(1, 0, points(:, i) - low - width*real(cell, wp) <= 1.01_wp*tolerance)
    to = merge(1, 0, points(:, i) - low - width*real(cell + 1, wp) >= -1.01_wp*tolerance)
    do dz = from(3), to(3)
      do dy = from(2), to(2)
        do dx = from(1), to(1)
          place = place_in(sorted, cell_key(cell + 1 + [dx, dy, dz]))
          if (place == 0) cycle
          near = near_in_list(points, i, head(place), next, tolerance)
          if (near > 0 .and. (found == 0 .or. near < found)) found = near
        end do
      end do
    end do
  end function near_in_cells

  !> A point of a list that lies near; 0 when none does.
  pure integer function near_in_list(points, i, first, next, tolerance) result(found)
    real(wp), intent(in) :: points(:, :), tolerance
    integer, intent(in) :: i
    integer(i4), intent(in) :: first, next(:)

    found = first
    do while (found > 0)
      if (maxval(abs(points(:, found) - points(:, i))) <= tolerance) return
      found = next(found)
    end do
  end function near_in_list

  !> Number of a cell.
  pure integer(i8) function cell_key(cell)
    integer, intent(in) :: cell(3)

    cell_key = int(cell(1), i8) + shiftl(int(cell(2), i8), cell_bits) + shiftl(int(cell(3), i8), 2*cell_bits)
  end function cell_key
end module sg_welding
