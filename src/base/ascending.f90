!> Ascending lists: where a number is, by bisection, and each number of a list once.
module sg_ascending
  use sg_kinds, only: i4, i8
  use sg_sorting, only: sort_permutation
  implicit none
  private
  public :: first_at_least, place_in, distinct

  !> First place of an ascending list whose number is not below a value: where the value stands, or would stand
  interface first_at_least
    module procedure first_at_least_i4, first_at_least_i8
  end interface first_at_least

  !> First place of a value in an ascending list; 0 when it is not there
  interface place_in
    module procedure place_in_i4, place_in_i8
  end interface place_in

  !> Each number of a list once, ascending
  interface distinct
    module procedure distinct_i4, distinct_i8
  end interface distinct

contains

  !> `first_at_least` for numbers of four bytes; one more than there are when all are below.
  pure integer function first_at_least_i4(list, value) result(low)
    integer(i4), intent(in) :: list(:) !! ascending numbers
    integer(i4), intent(in) :: value !! any number
    integer :: high, middle

    low = 1
    high = size(list) + 1
    do while (low < high)
      middle = low + (high - low)/2
      if (list(middle) < value) then
        low = middle + 1
      else
        high = middle
      end if
    end do
  end function first_at_least_i4

  !> `first_at_least` for numbers of eight bytes; one more than there are when all are below.
  pure integer function first_at_least_i8(list, value) result(low)
    integer(i8), intent(in) :: list(:) !! ascending numbers
    integer(i8), intent(in) :: value !! any number
    integer :: high, middle

    low = 1
    high = size(list) + 1
    do while (low < high)
      middle = low + (high - low)/2
      if (list(middle) < value) then
        low = middle + 1
      else
        high = middle
      end if
    end do
  end function first_at_least_i8

  !> `place_in` for numbers of four bytes.
  pure integer function place_in_i4(list, value) result(place)
    integer(i4), intent(in) :: list(:) !! ascending numbers
    integer(i4), intent(in) :: value !! number to look for

    place = first_at_least(list, value)
    if (place > size(list)) then
      place = 0
    else if (list(place) /= value) then
      place = 0
    end if
  end function place_in_i4

  !> `place_in` for numbers of eight bytes.
  pure integer function place_in_i8(list, value) result(place)
    integer(i8), intent(in) :: list(:) !! ascending numbers
    integer(i8), intent(in) :: value !! number to look for

    place = first_at_least(list, value)
    if (place > size(list)) then
      place = 0
    else if (list(place) /= value) then
      place = 0
    end if
  end function place_in_i8

  !> `distinct` for numbers of four bytes.
  pure function distinct_i4(list) result(kept)
    integer(i4), intent(in) :: list(:) !! numbers in any order, none negative
    integer(i4), allocatable :: kept(:)

    kept = int(distinct_i8(int(list, i8)), i4)
  end function distinct_i4

  !> `distinct` for numbers of eight bytes.
  pure function distinct_i8(list) result(kept)
    integer(i8), intent(in) :: list(:) !! numbers in any order, none negative
    integer(i8), allocatable :: kept(:)
    integer :: i, n

    kept = list(sort_permutation(list))
    n = min(1, size(kept))
    do i = 2, size(kept)
      if (kept(i) == kept(n)) cycle
      n = n + 1
      kept(n) = kept(i)
    end do
    kept = kept(:n)
  end function distinct_i8
end module sg_ascending
