!> Bodies that links ask to be copied: at the far end of a link, however far it is (doc/theory/decomposition.md).
!!
!! All ranks keep all links, but no rank holds the owners of all bodies. So owners of the ends of all links are gathered
!! whenever copies are made: two reals per link.
module sg_link_copies
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  use sg_local_numbers, only: local_contactor
  use sg_owners, only: contact_owner
  use sg_scene, only: scene_t
  use sg_sorting, only: group_items
  implicit none
  private
  public :: link_copies_t

  !> Own bodies that links ask other ranks to hold: those for rank r are `body(first(r + 1):first(r + 2) - 1)`, in any order
  type :: link_copies_t
    integer, allocatable :: first(:)
    integer(i4), allocatable :: body(:)
  contains
    procedure :: find => copies_find
    procedure :: mark => copies_mark
  end type link_copies_t

contains

  !> Find them. Collective where there are links.
  subroutine copies_find(self, scene, comm)
    class(link_copies_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! this rank's part, with its links
    type(comm_t), intent(inout) :: comm !! the ranks
    integer, allocatable :: owner(:)
    integer, allocatable :: item(:)
    integer(i4), allocatable :: own(:), rank(:), body(:)
    integer :: l, side, e, n, far

    n = 0
    allocate (owner(2*scene%links%n), source=0)
    allocate (own(2*scene%links%n))
    do e = 1, size(own)
      own(e) = own_body(scene, scene%links%number(1 + modulo(e - 1, 2), (e + 1)/2), comm%rank)
      ! Ranks count from 1 here; bodies that all ranks hold have zero.
      if (own(e) > 0) owner(e) = comm%rank + 1
    end do
    if (size(own) > 0) call comm%maximum(owner)
    do l = 1, scene%links%n
      do side = 1, 2
        e = 2*(l - 1) + side
        far = owner(2*l + 1 - side) - 1
        if (own(e) == 0 .or. far < 0 .or. far == comm%rank) cycle
        if (contact_owner(int([comm%rank, far], i4)) /= far) cycle
        n = n + 1
        call reserve(rank, n)
        call reserve(body, n)
        rank(n) = int(far, i4)
        body(n) = own(e)
      end do
    end do
    if (n == 0) allocate (rank(0), body(0))
    call group_items(rank(:n) + 1_i4, comm%size, self%first, item)
    self%body = body(item)
  end subroutine copies_find

  !> Mark the bodies for a rank.
  pure subroutine copies_mark(self, rank, is_marked)
    class(link_copies_t), intent(in) :: self
    integer, intent(in) :: rank !! rank that is to hold copies, from 0
    logical, intent(out) :: is_marked(:) !! shape (bodies)

    is_marked = .false.
    is_marked(self%body(self%first(rank + 1):self%first(rank + 2) - 1)) = .true.
  end subroutine copies_mark

  !> Own body of a contactor, not one that all ranks hold; 0 where it is none.
  pure integer(i4) function own_body(scene, number, rank) result(body)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: number !! of the contactor in the whole scene
    integer, intent(in) :: rank
    integer :: c

    body = 0
    c = local_contactor(scene%contactors, number)
    if (c == 0) return
    if (scene%bodies%owner(scene%contactors%body(c)) == rank) body = scene%contactors%body(c)
  end function own_body
end module sg_link_copies
