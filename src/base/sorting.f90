!> Sorting in linear time: integer keys by radix, a few of them by insertion, and places on a space-filling curve as keys.
module sg_sorting
  use sg_kinds, only: wp, i4, i8
  implicit none
  private
  public :: sort_permutation, hilbert_order, group_items, hilbert_key, hilbert_key_in_space

  integer, parameter :: bits = 11, buckets = 2**bits
  ! As many keys are sorted sooner by insertion than buckets are counted.
  integer, parameter :: few = 64

contains

  !> Permutation that sorts non-negative keys; equal keys keep their order.
  pure function sort_permutation(keys) result(permutation)
    integer(i8), intent(in) :: keys(:) !! keys, none negative
    integer(i4), allocatable :: permutation(:)
    integer(i4), allocatable :: moved(:)
    integer(i8) :: largest
    integer :: shift, i

    permutation = [(int(i, i4), i=1, size(keys))]
    if (size(keys) <= few) then
      call sort_few(keys, permutation)
      return
    end if
    allocate (moved(size(keys)))
    largest = maxval(keys)
    shift = 0
    do while (shift < 63)
      if (shiftr(largest, shift) == 0) exit
      call sort_digit(keys, shift, permutation, moved)
      permutation = moved
      shift = shift + bits
    end do
  end function sort_permutation

  !> Sort by insertion.
  pure subroutine sort_few(keys, permutation)
    integer(i8), intent(in) :: keys(:)
    integer(i4), intent(inout) :: permutation(:) !! 1, 2, ...
    integer(i8) :: key
    integer :: i, place

    do i = 2, size(keys)
      key = keys(i)
      place = i
      do while (place > 1)
        if (keys(permutation(place - 1)) <= key) exit
        permutation(place) = permutation(place - 1)
        place = place - 1
      end do
      permutation(place) = int(i, i4)
    end do
  end subroutine sort_few

  !> Items by their groups, in linear time; those of one group keep their order.
  pure subroutine group_items(group, groups, first, item)
    integer(i4), intent(in) :: group(:) !! group of each item, from 1; items of others are left out
    integer, intent(in) :: groups !! number of groups
    integer, allocatable, intent(out) :: first(:) !! items of group g are item(first(g):first(g + 1) - 1), shape (groups + 1)
    integer, allocatable, intent(out) :: item(:) !! the items, group after group
    integer :: next(groups), i, g

    allocate (first(groups + 1), source=0)
    do i = 1, size(group)
      if (group(i) < 1 .or. group(i) > groups) cycle
      first(group(i) + 1) = first(group(i) + 1) + 1
    end do
    first(1) = 1
    do g = 1, groups
      first(g + 1) = first(g) + first(g + 1)
    end do
    next = first(:groups)
    allocate (item(first(groups + 1) - 1))
    do i = 1, size(group)
      if (group(i) < 1 .or. group(i) > groups) cycle
      item(next(group(i))) = i
      next(group(i)) = next(group(i)) + 1
    end do
  end subroutine group_items

  !> One stable pass of the radix sort.
  pure subroutine sort_digit(keys, shift, from, to)
    integer(i8), intent(in) :: keys(:)
    integer, intent(in) :: shift
    integer(i4), intent(in) :: from(:)
    integer(i4), intent(out) :: to(:)
    integer :: first(0:buckets), i, digit

    first = 0
    do i = 1, size(keys)
      digit = int(iand(shiftr(keys(i), shift), int(buckets - 1, i8)))
      first(digit + 1) = first(digit + 1) + 1
    end do
    first(0) = 1
    do i = 1, buckets
      first(i) = first(i) + first(i - 1)
    end do
    do i = 1, size(keys)
      digit = int(iand(shiftr(keys(from(i)), shift), int(buckets - 1, i8)))
      to(first(digit)) = from(i)
      first(digit) = first(digit) + 1
    end do
  end subroutine sort_digit

  !> Order of points along Hilbert's curve through a square or a cube: near along the curve is near in space.
  pure function hilbert_order(point, low, side) result(order)
    real(wp), intent(in) :: point(:, :) !! points [m], shape (dimension, n)
    real(wp), intent(in) :: low(:) !! low corner of the square or cube [m], shape (dimension)
    real(wp), intent(in) :: side !! its side, above 0 [m]
    integer(i4), allocatable :: order(:)
    integer(i8), allocatable :: keys(:)
    integer :: i

    allocate (keys(size(point, 2)))
    if (size(low) == 2) then
      do i = 1, size(keys)
        keys(i) = hilbert_key([(point(1, i) - low(1))/side, (point(2, i) - low(2))/side])
      end do
    else
      do i = 1, size(keys)
        keys(i) = hilbert_key_in_space([(point(1, i) - low(1))/side, (point(2, i) - low(2))/side, (point(3, i) - low(3))/side])
      end do
    end if
    order = sort_permutation(keys)
  end function hilbert_order

  !> Place of a point of the unit square along Hilbert's curve of 2^20 cells a side: digit by digit, without a branch, since
  !! which way the curve turns is anyone's guess.
  pure integer(i8) function hilbert_key(point) result(key)
    real(wp), intent(in) :: point(2) !! within 0 to 1
    integer, parameter :: order = 20, all_bits = 2**order - 1
    integer :: x, y, digit, rx, ry, change

    x = min(all_bits, max(0, int(point(1)*2**order)))
    y = min(all_bits, max(0, int(point(2)*2**order)))
    key = 0
    do digit = order - 1, 0, -1
      rx = ibits(x, digit, 1)
      ry = ibits(y, digit, 1)
      key = 4*key + int(ieor(3*rx, ry), i8)
      ! In the two lower squares the curve is mirrored at a diagonal: at the other one in the right of them.
      change = rx*(1 - ry)*all_bits
      x = ieor(x, change)
      y = ieor(y, change)
      change = iand(ieor(x, y), (1 - ry)*all_bits)
      x = ieor(x, change)
      y = ieor(y, change)
    end do
  end function hilbert_key

  !> Place of a point of the unit cube along Hilbert's curve of 2^20 cells a side ([Skilling2004]: exchange and
  !! invert bits from the highest down, then undo Gray's code).
  pure integer(i8) function hilbert_key_in_space(point) result(key)
    real(wp), intent(in) :: point(3) !! within 0 to 1
    integer, parameter :: order = 20
    integer :: x(3), q, p, t, i

    x = min(2**order - 1, max(0, int(point*2**order)))
    q = 2**(order - 1)
    do while (q > 1)
      p = q - 1
      do i = 1, 3
        if (iand(x(i), q) /= 0) then
          x(1) = ieor(x(1), p)
        else
          t = iand(ieor(x(1), x(i)), p)
          x(1) = ieor(x(1), t)
          x(i) = ieor(x(i), t)
        end if
      end do
      q = q/2
    end do
    x(2) = ieor(x(2), x(1))
    x(3) = ieor(x(3), x(2))
    t = 0
    q = 2**(order - 1)
    do while (q > 1)
      if (iand(x(3), q) /= 0) t = ieor(t, q - 1)
      q = q/2
    end do
    x = ieor(x, t)
    key = 0
    do i = order - 1, 0, -1
      key = 8*key + int(4*ibits(x(1), i, 1) + 2*ibits(x(2), i, 1) + ibits(x(3), i, 1), i8)
    end do
  end function hilbert_key_in_space
end module sg_sorting
