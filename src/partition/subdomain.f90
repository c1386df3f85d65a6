!> What one rank knows of the decomposition: which bodies it shares, with whom, and where they are at home.
!!
!! Every body has one home. A rank holds its own bodies, copies of others' that may touch them before the list of
!! neighbours is made again, and all *wide* bodies (walls). A contact belongs to one rank, `owner_of` its two bodies'
!! homes (sg_homes). Lists of two neighbours name the same bodies in the same order (ascending number), so that messages
!! carry values alone (doc/theory/decomposition.md).
module sg_subdomain
  use sg_kinds, only: wp
  implicit none
  private
  public :: subdomain_t

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
end module sg_subdomain
