!> One integer for two items, whichever is first: sorted by it, contacts of one pair follow one another.
module sg_pair_keys
  use sg_kinds, only: i4, i8
  implicit none
  private
  public :: pair_key

contains

  !> Key of a pair; no other pair of `n_items` items has it.
  elemental integer(i8) function pair_key(a, b, n_items) result(key)
    integer(i4), intent(in) :: a !! one item, from 1
    integer(i4), intent(in) :: b !! the other
    integer, intent(in) :: n_items !! number of items

    key = int(min(a, b) - 1, i8)*int(n_items, i8) + int(max(a, b), i8)
  end function pair_key
end module sg_pair_keys
