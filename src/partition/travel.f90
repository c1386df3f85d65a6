!> Contacts that travel: with the numbers of the whole scene, from the rank that had them to the rank that will.
!!
!! A record is candidate, antagonist, feature, image in x and y, law, status and the impulse. Contacts of one pair stay
!! together. What one rank knows of a contact goes with it, so that impulses are neither lost nor doubled when grains move.
module sg_travel
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_homes, only: owner_of
  use sg_kinds, only: wp, i1, i4
  use sg_local_numbers, only: local_contactor
  use sg_parcels, only: parcel_t
  use sg_rows, only: rows_t, wanted_t
  use sg_scene, only: scene_t
  use sg_sorting, only: group_items
  implicit none
  private
  public :: deal_contacts, send_contacts, unpack_contacts, may_own

contains

  !> Send contacts to the ranks that will own them, which those that have them do not know: homes are asked for by number.
  !! Collective.
  subroutine deal_contacts(contacts, scene, all_contactors, comm, parcel)
    type(contacts_t), intent(in) :: contacts !! some of all contacts on each rank, with the numbers of the whole scene
    type(scene_t), intent(in) :: scene !! this rank's part, without copies
    integer, intent(in) :: all_contactors !! contactors of the whole scene
    type(comm_t), intent(inout) :: comm !! the ranks
    type(parcel_t), intent(inout) :: parcel !! records of the contacts that this rank will own
    type(rows_t) :: rows
    type(wanted_t) :: wanted
    integer(i4), allocatable :: number(:), owner(:)
    real(wp), allocatable :: block(:, :), home(:, :)
    integer :: k

    associate (contactors => scene%contactors, n => scene%contactors%n)
      number = pack(contactors%id(:n), [(scene%bodies%home(contactors%body(k)) == comm%rank, k=1, n)])
    end associate
    call rows%plan(comm, number, all_contactors)
    ! Ranks count from 1 here: nobody speaks for wide bodies, of which the blocks hold zero.
    call rows%order(comm, reshape([(real(comm%rank + 1, wp), k=1, size(number))], [1, size(number)]), block)
    call wanted%plan(comm, rows, reshape(contacts%contactor(:, :contacts%n), [2*contacts%n]))
    call wanted%fetch(comm, block, home)
    allocate (owner(contacts%n))
    do k = 1, contacts%n
      owner(k) = int(owner_of(nint(home(1, wanted%place(contacts%contactor(:, k))), i4) - 1_i4), i4)
    end do
    call send_records(contacts, owner, comm, parcel)
  end subroutine deal_contacts

  !> May a rank own the contacts of a pair, as far as it knows? When copies are made, of those between two ranks' grains both
  !! contactors are with the owner alone.
  pure logical function may_own(scene, rank, number)
    type(scene_t), intent(in) :: scene !! the rank's part, without copies
    integer, intent(in) :: rank !! the rank, from 0
    integer(i4), intent(in) :: number(2) !! numbers of the contactors in the whole scene
    integer :: side, c, wide

    may_own = .false.
    wide = 0
    do side = 1, 2
      c = local_contactor(scene%contactors, number(side))
      if (c == 0) cycle
      associate (home => scene%bodies%home(scene%contactors%body(c)))
        may_own = may_own .or. home == rank
        if (home < 0) wide = wide + 1
      end associate
    end do
    may_own = may_own .or. (wide == 2 .and. rank == 0)
  end function may_own

  !> Append the record of a contact.
  subroutine pack_contact(contacts, k, number, parcel)
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    integer(i4), intent(in) :: number(2)
    type(parcel_t), intent(inout) :: parcel

    call parcel%put(number)
    call parcel%put(contacts%feature(k))
    call parcel%put(int(contacts%image(k)))
    if (contacts%dimension == 3) call parcel%put(int(contacts%image_y(k)))
    call parcel%put(contacts%law(k))
    call parcel%put(int(contacts%status(k)))
    call parcel%put(contacts%impulse(:, k))
  end subroutine pack_contact

  !> Send contacts to the ranks that will own them. Collective.
  subroutine send_contacts(contacts, scene, home, comm, parcel)
    type(contacts_t), intent(in) :: contacts !! contacts of the last step
    type(scene_t), intent(in) :: scene !! this rank's part, as it was in that step
    integer(i4), intent(in) :: home(:) !! home of each body of it from now on, -1 for wide ones
    type(comm_t), intent(inout) :: comm !! the ranks
    type(parcel_t), intent(inout) :: parcel !! records of the contacts that this rank will own
    integer(i4) :: owner(contacts%n)
    integer :: k

    do k = 1, contacts%n
      owner(k) = int(owner_of(home(scene%contactors%body(contacts%contactor(:, k)))), i4)
    end do
    call send_records(contacts, owner, comm, parcel, scene%contactors%id)
  end subroutine send_contacts

  !> Send contacts to their owners; those of one pair keep their order.
  subroutine send_records(contacts, owner, comm, parcel, id)
    type(contacts_t), intent(in) :: contacts
    integer(i4), intent(in) :: owner(:) !! of each contact
    type(comm_t), intent(inout) :: comm
    type(parcel_t), intent(inout) :: parcel
    integer(i4), intent(in), optional :: id(:) !! numbers of contactors in the whole scene; absent where contacts have them
    type(parcel_t) :: leaving
    real(wp), allocatable :: values(:)
    integer, allocatable :: received(:), first(:), leaver(:)
    integer(i4) :: number(2)
    integer :: sent(0:comm%size - 1), r, k

    call group_items(owner + 1_i4, comm%size, first, leaver)
    allocate (leaving%value(0))
    do r = 0, comm%size - 1
      sent(r) = leaving%n
      do k = first(r + 1), first(r + 2) - 1
        number = contacts%contactor(:, leaver(k))
        if (present(id)) number = id(number)
        call pack_contact(contacts, leaver(k), number, leaving)
      end do
      sent(r) = leaving%n - sent(r)
    end do
    call comm%swap(leaving%value(:leaving%n), sent, values, received)
    call parcel%adopt(values)
  end subroutine send_records

  !> Take contacts from their records; those of contactors that are not here are dropped.
  subroutine unpack_contacts(parcel, scene, contacts)
    type(parcel_t), intent(inout) :: parcel !! records of contacts
    type(scene_t), intent(in) :: scene !! this rank's part, as it is from now on
    type(contacts_t), intent(inout) :: contacts !! contacts; dimension and components are set
    integer(i4) :: pair(2), words(5)
    integer :: n, width

    width = 6 + merge(1, 0, contacts%dimension == 3) + contacts%n_components
    call reserve_contacts(contacts, parcel%n/width)
    n = 0
    do while (parcel%at < parcel%n)
      call parcel%take(pair)
      words = 0
      call parcel%take(words(1))
      call parcel%take(words(2))
      if (contacts%dimension == 3) call parcel%take(words(3))
      call parcel%take(words(4:5))
      call parcel%take(contacts%impulse(:, n + 1))
      contacts%contactor(1, n + 1) = int(local_contactor(scene%contactors, pair(1)), i4)
      contacts%contactor(2, n + 1) = int(local_contactor(scene%contactors, pair(2)), i4)
      if (any(contacts%contactor(:, n + 1) == 0)) cycle
      n = n + 1
      contacts%body(:, n) = scene%contactors%body(contacts%contactor(:, n))
      contacts%feature(n) = words(1)
      contacts%image(n) = int(words(2), i1)
      if (contacts%dimension == 3) contacts%image_y(n) = int(words(3), i1)
      contacts%law(n) = words(4)
      contacts%status(n) = int(words(5), i1)
    end do
    contacts%n = n
  end subroutine unpack_contacts
end module sg_travel
