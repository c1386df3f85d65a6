!> What one rank knows of the decomposition: which bodies it shares, with whom, and where they are at home.
!!
!! Every body has one home. A rank holds its own bodies, copies of others' that may touch them before the list of
!! neighbours is made again, and all *wide* bodies (walls). A contact belongs to one rank, `owner_of` its two bodies'
!! homes. Lists of two neighbours name the same bodies in the same order (ascending number), so that messages carry values
!! alone (doc/theory/decomposition.md).
module sg_subdomain
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: subdomain_t, owner_of

  !> One rank's part of a decomposed scene
  type :: subdomain_t
    !> This rank, from 0, and the number of ranks; one rank means no decomposition
    integer :: rank = 0, size = 1
    !> Number of bodies and of contactors of the whole scene
    integer :: all_bodies = 0, all_contactors = 0
    !> Ranks that share bodies with this one, ascending
    integer, allocatable :: neighbour(:)
    !> Bodies (local) shared with neighbour i: `body(first(i):first(i + 1) - 1)`, by ascending number, and their homes; wide
    !! bodies left out
    integer, allocatable :: first(:), body(:), home(:)
    !> Wide bodies (local), which all ranks hold, by ascending number
    integer, allocatable :: wide(:)
    !> Times that these lists were made; splits made since the start, and bodies that changed home in all of them
    integer :: serial = 0, splits = 0
    real(wp) :: moved = 0
  end type subdomain_t

contains

  !> The rank that a contact belongs to, from the homes of its two bodies; -1 is the home of wide bodies here.
  !!
  !! Of two ranks now the lower, now the higher one takes all contacts between them: then only grains of the other side
  !! are shared, and loads stay even. What lies between two wide bodies falls to rank 0.
  pure integer function owner_of(home)
    integer(i4), intent(in) :: home(2) !! homes of the two bodies, -1 for wide ones

    owner_of = max(home(1), home(2), 0)
    if (any(home < 0)) return
    if (modulo(home(1) + home(2), 2) == 1) owner_of = minval(home)
  end function owner_of
end module sg_subdomain
