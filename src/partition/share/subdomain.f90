!> One rank's view of the decomposition: the bodies that it shares, the ranks that share them, and their owners.
!!
!! Every body has one owner. A rank holds its own bodies, copies of others' that may touch them before the list of
!! neighbours is made again, and all *replicated* bodies (walls). A contact belongs to one rank, `contact_owner` its two bodies'
!! owners (sg_owners). Lists of two neighbours name the same bodies in the same order (ascending number), so that messages
!! carry values alone (doc/theory/decomposition.md).
module sg_subdomain
  use sg_kinds, only: wp, i4
  use sg_tables, only: per_body, tables_t
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
    !> Bodies (local) shared with neighbour i: `body(first(i):first(i + 1) - 1)`, by ascending number, and their owners; replicated
    !! bodies left out
    integer, allocatable :: first(:), body(:), owner(:)
    !> Replicated bodies (local), which all ranks hold, by ascending number
    integer, allocatable :: replicated(:)
    !> Times that these lists were made; splits made since the start, and bodies that changed owner in all of them
    integer :: serial = 0, splits = 0
    real(wp) :: moved = 0
    !> Largest load of a rank over the mean one, before and after a split, summed over the splits after the first
    real(wp) :: imbalance_sums(2) = 0
  contains
    procedure :: by_slot => subdomain_by_slot
    procedure :: list_tables => subdomain_list_tables
  end type subdomain_t

contains

  !> The same with bodies numbered by their slots in the contact problem; nothing where a scene is not decomposed.
  pure type(subdomain_t) function subdomain_by_slot(self, slot_of) result(coupling)
    class(subdomain_t), intent(in) :: self
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body

    if (.not. allocated(self%body)) return
    coupling%rank = self%rank
    coupling%size = self%size
    coupling%neighbour = self%neighbour
    coupling%first = self%first
    coupling%body = slot_of(self%body)
    coupling%owner = self%owner
    coupling%replicated = slot_of(self%replicated)
    coupling%serial = self%serial
  end function subdomain_by_slot

  !> List the tables of what is shared.
  subroutine subdomain_list_tables(self, tables)
    class(subdomain_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('subdomain', per_body)
    call tables%note('neighbour', self%neighbour)
    call tables%note('first', self%first)
    call tables%note('body', self%body)
    call tables%note('owner', self%owner)
    call tables%note('replicated', self%replicated)
  end subroutine subdomain_list_tables
end module sg_subdomain
