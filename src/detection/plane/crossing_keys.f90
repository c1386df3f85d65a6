!> Keys of points where an edge of one polyhedron crosses an edge of another: four vertices in one whole number, and back.
!!
!! Keys up to the number of vertices of both polyhedra name vertices; those of crossings are greater.
module sg_crossing_keys
  use sg_kinds, only: i4, i8
  implicit none
  private
  public :: crossing_key, crossing_ends

contains

  !> Key of the crossing of two edges given by their ends. Where polyhedra have too many vertices for a whole number of 32 bits,
  !! keys of different crossings may be the same.
  pure integer(i4) function crossing_key(n_c, n_a, ends_c, ends_a) result(key)
    integer, intent(in) :: n_c !! vertices of the candidate
    integer, intent(in) :: n_a !! vertices of the antagonist
    integer(i4), intent(in) :: ends_c(2) !! vertices of the candidate's edge
    integer(i4), intent(in) :: ends_a(2) !! vertices of the antagonist's edge
    integer(i8) :: long, last, ends(4)
    integer :: k

    last = int(huge(key) - n_c - n_a, i8)
    ends = int([ends_c, ends_a], i8)
    long = 0
    do k = 1, 4
      long = modulo(long*int(merge(n_c, n_a, k <= 2), i8) + ends(k), last)
    end do
    key = int(long, i4) + int(n_c + n_a, i4) + 1_i4
  end function crossing_key

  !> The ends of two edges whose crossing has a key; zeros where the key does not encode them.
  pure function crossing_ends(n_c, n_a, key) result(ends)
    integer, intent(in) :: n_c !! vertices of the candidate
    integer, intent(in) :: n_a !! vertices of the antagonist
    integer(i4), intent(in) :: key !! key of a crossing
    integer :: ends(4) !! two vertices of the candidate, two of the antagonist
    integer(i8) :: long
    integer :: k, n

    ends = 0
    if (real(n_c + 1)**2*real(n_a + 1)**2 >= real(huge(key) - n_c - n_a)) return
    long = int(key, i8) - int(n_c + n_a + 1, i8)
    do k = 4, 1, -1
      n = merge(n_c, n_a, k <= 2)
      ends(k) = int(modulo(long - 1, int(n, i8))) + 1
      long = (long - int(ends(k), i8))/int(n, i8)
    end do
    if (long /= 0 .or. key <= n_c + n_a) ends = 0
  end function crossing_ends
end module sg_crossing_keys
