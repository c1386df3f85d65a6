!> One rank's part of a scene that all ranks hold, cut out the plain way: every rank looks at all bodies and contacts.
!!
!! No message is sent, so tests that use it know what is right from the whole scene alone.
module cut_by_hand
  use sg_contactors, only: place_contactors
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_field_visitor, only: sync_on_owner
  use sg_kinds, only: i4
  use sg_local_numbers, only: contactors_of_bodies
  use sg_owners, only: contact_owner
  use sg_pack_bodies, only: order_records, pack_bodies, rebuild_scene
  use sg_parcels, only: parcel_t
  use sg_scene, only: scene_t
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: cut_scene

contains

  !> Cut a rank's part: its own bodies, all replicated ones, and all grains that its own grains or its contacts touch.
  subroutine cut_scene(whole, contacts, part, rank, size_of_all, local, local_contacts, subdomain)
    type(scene_t), intent(in) :: whole !! the scene
    type(contacts_t), intent(in) :: contacts !! all its contacts
    integer(i4), intent(in) :: part(:) !! rank of each grain; of replicated bodies it does not count
    integer, intent(in) :: rank !! whose part
    integer, intent(in) :: size_of_all !! number of ranks
    type(scene_t), intent(out) :: local !! its scene
    type(contacts_t), intent(out) :: local_contacts !! its contacts
    type(subdomain_t), intent(out) :: subdomain !! who shares which bodies
    integer(i4) :: owner(whole%bodies%n)
    type(parcel_t) :: parcel
    integer :: place(whole%bodies%n), seat(whole%contactors%n), n_own, i
    integer, allocatable :: start(:), kept(:)
    integer(i4), allocatable :: first(:), list(:), held(:)
    logical :: is_held(whole%bodies%n, 0:size_of_all - 1)

    owner = merge(part, -1_i4, whole%bodies%is_grain)
    do i = 0, size_of_all - 1
      is_held(:, i) = held_by(i, owner, contacts)
    end do
    call contactors_of_bodies(whole%contactors, whole%bodies%n, first, list)
    held = pack([(int(i, i4), i=1, whole%bodies%n)], is_held(:, rank))
    call pack_bodies(whole, held, first, list, owner(held), sync_on_owner, parcel)
    call order_records(parcel, rank, size_of_all, start, n_own)
    local = whole
    call rebuild_scene(local, parcel, start, n_own)
    associate (ids => local%bodies%id)
      local%bodies%force = whole%bodies%force(:, ids)
      local%bodies%free_velocity = whole%bodies%free_velocity(:, ids)
      local%bodies%middle = whole%bodies%middle(:, ids)
      place = 0
      place(ids) = [(i, i=1, size(ids))]
    end associate
    call place_contactors(local%contactors, local%bodies%middle)
    seat = 0
    seat(local%contactors%id) = [(i, i=1, local%contactors%n)]
    kept = pack([(i, i=1, contacts%n)], [(contact_owner(owner(contacts%body(:, i))) == rank, i=1, contacts%n)])
    call keep_contacts(contacts, kept, place, seat, local_contacts)
    call name_neighbours(is_held, owner, place, rank, subdomain)
  end subroutine cut_scene

  !> Bodies that a rank holds.
  pure function held_by(rank, owner, contacts) result(is_held)
    integer, intent(in) :: rank
    integer(i4), intent(in) :: owner(:)
    type(contacts_t), intent(in) :: contacts
    logical :: is_held(size(owner))
    integer :: k

    is_held = owner < 0 .or. owner == rank
    do k = 1, contacts%n
      associate (pair => contacts%body(:, k))
        if (any(owner(pair) == rank) .or. contact_owner(owner(pair)) == rank) is_held(pair) = .true.
      end associate
    end do
  end function held_by

  !> Keep some contacts, with the numbers of their bodies and contactors here.
  subroutine keep_contacts(whole, kept, place, seat, contacts)
    type(contacts_t), intent(in) :: whole
    integer, intent(in) :: kept(:), place(:), seat(:)
    type(contacts_t), intent(inout) :: contacts
    integer :: i

    contacts = whole
    call reserve_contacts(contacts, 1)
    call contacts%keep(kept)
    contacts%n = size(kept)
    do i = 1, size(kept)
      contacts%contactor(:, i) = int(seat(contacts%contactor(:, i)), i4)
      contacts%body(:, i) = int(place(contacts%body(:, i)), i4)
    end do
  end subroutine keep_contacts

  !> Name the grains shared with each neighbour, and the replicated bodies.
  subroutine name_neighbours(is_held, owner, place, rank, subdomain)
    logical, intent(in) :: is_held(:, 0:)
    integer(i4), intent(in) :: owner(:)
    integer, intent(in) :: place(:), rank
    type(subdomain_t), intent(inout) :: subdomain
    integer, allocatable :: shared(:)
    integer :: r

    subdomain%rank = rank
    subdomain%size = size(is_held, 2)
    subdomain%all_bodies = size(owner)
    allocate (subdomain%neighbour(0), subdomain%body(0), subdomain%owner(0), subdomain%first(1))
    subdomain%first = 1
    do r = 0, subdomain%size - 1
      shared = pack(place, is_held(:, r) .and. is_held(:, rank) .and. owner >= 0 .and. r /= rank)
      if (size(shared) == 0) cycle
      subdomain%neighbour = [subdomain%neighbour, r]
      subdomain%body = [subdomain%body, shared]
      subdomain%owner = [subdomain%owner, pack(int(owner), is_held(:, r) .and. is_held(:, rank) .and. owner >= 0)]
      subdomain%first = [subdomain%first, size(subdomain%body) + 1]
    end do
    subdomain%replicated = pack(place, owner < 0)
  end subroutine name_neighbours
end module cut_by_hand
