!> Contact migration: contacts, with the numbers of the whole scene, move from the rank that owned them to the rank that will.
!!
!! A record is the fields of a contact that are sent when its owner changes (sg_field_visitor), so that impulses are neither lost
!! nor doubled when grains move. Contacts of one pair stay together.
module sg_contact_migration
  use sg_block_distribution, only: block_distribution_t, wanted_t
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_field_visitor, only: sync_on_owner
  use sg_internal_values, only: most_internal
  use sg_kinds, only: wp, i1, i4
  use sg_local_numbers, only: local_contactor
  use sg_owners, only: contact_owner
  use sg_parcels, only: parcel_t
  use sg_renumber, only: keep_present
  use sg_scene, only: scene_t, start_contact_t
  use sg_sorting, only: group_items
  implicit none
  private
  public :: distribute_contacts, distribute_start_contacts, send_contacts, unpack_contacts

contains

  !> Send contacts to the ranks that will own them. Owners of bodies of other ranks are asked for by number.
  !! Collective.
  subroutine distribute_contacts(contacts, scene, all_contactors, comm, parcel)
    type(contacts_t), intent(in) :: contacts !! some of all contacts on each rank, with the numbers of the whole scene
    type(scene_t), intent(in) :: scene !! this rank's part, without copies
    integer, intent(in) :: all_contactors !! contactors of the whole scene
    type(comm_t), intent(inout) :: comm !! the ranks
    type(parcel_t), intent(inout) :: parcel !! records of the contacts that this rank will own

    call send_records(contacts, owners_of(contacts%contactor(:, :contacts%n), scene, all_contactors, comm), comm, parcel)
  end subroutine distribute_contacts

  !> Send contacts known at the start to the ranks that will own them; those of one pair keep their order. Collective.
  subroutine distribute_start_contacts(contacts, scene, all_contactors, comm)
    type(start_contact_t), allocatable, intent(inout) :: contacts(:) !! a piece of all on each rank, with the numbers of the whole
    !! scene; afterwards those that this rank will own
    type(scene_t), intent(in) :: scene !! this rank's part, without copies
    integer, intent(in) :: all_contactors !! contactors of the whole scene
    type(comm_t), intent(inout) :: comm !! the ranks
    integer, parameter :: width = 11 + most_internal
    real(wp), allocatable :: leaving(:), coming(:)
    integer, allocatable :: received(:), first(:), leaver(:)
    integer(i4), allocatable :: owner(:)
    integer :: k

    owner = owners_of(reshape([(int(contacts(k)%contactor, i4), k=1, size(contacts))], [2, size(contacts)]), scene, &
                      all_contactors, comm)
    call group_items(owner + 1_i4, comm%size, first, leaver)
    leaving = [(record_of(contacts(leaver(k))), k=1, size(leaver))]
    call comm%swap(leaving, [(width*(first(k + 1) - first(k)), k=1, comm%size)], coming, received)
    deallocate (contacts)
    allocate (contacts(size(coming)/width))
    do k = 1, size(contacts)
      associate (record => coming(width*(k - 1) + 1:width*k))
        contacts(k) = start_contact_t(nint(record(:2)), record(3:5), record(6:8), nint(record(9), i1), record(10) > 0, &
                                      record(12:), record(11) > 0)
      end associate
    end do
  contains
    !> A contact as reals.
    pure function record_of(contact) result(record)
      type(start_contact_t), intent(in) :: contact
      real(wp) :: record(width)

      record = [real(contact%contactor, wp), contact%point, contact%force, real(contact%status, wp), &
                merge(1.0_wp, 0.0_wp, [contact%is_vector, contact%has_internal]), contact%internal]
    end function record_of
  end subroutine distribute_start_contacts

  !> The ranks that will own contacts of some pairs of contactors. Collective.
  function owners_of(pair, scene, all_contactors, comm) result(owner)
    integer(i4), intent(in) :: pair(:, :) !! numbers of contactors in the whole scene, shape (2, contacts)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: all_contactors
    type(comm_t), intent(inout) :: comm
    integer(i4) :: owner(size(pair, 2))
    type(block_distribution_t) :: rows
    type(wanted_t) :: wanted
    integer(i4), allocatable :: number(:)
    real(wp), allocatable :: block(:, :), body_owner(:, :)
    integer :: k

    associate (contactors => scene%contactors, n => scene%contactors%n)
      number = pack(contactors%id(:n), [(scene%bodies%owner(contactors%body(k)) == comm%rank, k=1, n)])
    end associate
    call rows%plan(comm, number, all_contactors)
    ! Ranks count from 1 here: replicated bodies have no owner, and the blocks hold zero for them.
    call rows%order(comm, reshape([(real(comm%rank + 1, wp), k=1, size(number))], [1, size(number)]), block)
    call wanted%plan(comm, rows, reshape(pair, [size(pair)]))
    call wanted%fetch(comm, block, body_owner)
    do k = 1, size(owner)
      owner(k) = int(contact_owner(nint(body_owner(1, wanted%place(pair(:, k))), i4) - 1_i4), i4)
    end do
  end function owners_of

  !> Send contacts to the ranks that will own them. Collective.
  subroutine send_contacts(contacts, scene, body_owner, comm, parcel)
    type(contacts_t), intent(inout) :: contacts !! contacts of the last step; with the numbers of the whole scene afterwards
    type(scene_t), intent(in) :: scene !! this rank's part, as it was in that step
    integer(i4), intent(in) :: body_owner(:) !! owner of each body of it from now on, -1 for replicated ones
    type(comm_t), intent(inout) :: comm !! the ranks
    type(parcel_t), intent(inout) :: parcel !! records of the contacts that this rank will own
    integer(i4) :: owner(contacts%n)
    integer :: k

    do k = 1, contacts%n
      owner(k) = int(contact_owner(body_owner(scene%contactors%body(contacts%contactor(:, k)))), i4)
      contacts%contactor(:, k) = scene%contactors%id(contacts%contactor(:, k))
    end do
    call send_records(contacts, owner, comm, parcel)
  end subroutine send_contacts

  !> Send contacts to their owners; those of one pair keep their order.
  subroutine send_records(contacts, owner, comm, parcel)
    type(contacts_t), intent(in) :: contacts !! contacts with the numbers of the whole scene
    integer(i4), intent(in) :: owner(:) !! of each contact
    type(comm_t), intent(inout) :: comm
    type(parcel_t), intent(inout) :: parcel
    real(wp), allocatable :: leaving(:, :), values(:)
    integer, allocatable :: received(:), first(:), leaver(:)
    integer :: r

    call group_items(owner + 1_i4, comm%size, first, leaver)
    call contacts%pack(leaver, leaving, sync_on_owner)
    call comm%swap(reshape(leaving, [size(leaving)]), [(size(leaving, 1)*(first(r + 1) - first(r)), r=1, comm%size)], values, &
                   received)
    call parcel%adopt(values)
  end subroutine send_records

  !> Take contacts from their records; those of contactors that are not here are dropped.
  subroutine unpack_contacts(parcel, scene, contacts)
    type(parcel_t), intent(in) :: parcel !! records of contacts
    type(scene_t), intent(in) :: scene !! this rank's part, as it is from now on
    type(contacts_t), intent(inout) :: contacts !! contacts; dimension, components and number of internal values are set
    integer :: n, width, k, side

    width = contacts%width(sync_on_owner)
    n = parcel%n/width
    call reserve_contacts(contacts, n)
    call contacts%unpack([(int(k, i4), k=1, n)], reshape(parcel%value, [width, n]), sync_on_owner)
    do k = 1, n
      do side = 1, 2
        contacts%contactor(side, k) = int(local_contactor(scene%contactors, contacts%contactor(side, k)), i4)
      end do
    end do
    contacts%n = n
    call keep_present(contacts, scene)
  end subroutine unpack_contacts
end module sg_contact_migration
