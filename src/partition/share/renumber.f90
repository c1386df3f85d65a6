!> Contacts that stay on their rank while its scene is rebuilt: they name its contactors by their new places.
module sg_renumber
  use sg_contacts, only: contacts_t
  use sg_kinds, only: i4
  use sg_scene, only: scene_t
  implicit none
  private
  public :: keep_present, renumber_contacts

contains

  !> Let the contacts of the last step name contactors by their places in a rebuilt scene. Contacts of contactors that are no
  !! longer here are dropped: they were too far from each other to touch.
  subroutine renumber_contacts(contacts, former, scene)
    type(contacts_t), intent(inout) :: contacts !! contacts that name contactors by their former places
    integer(i4), intent(in) :: former(:) !! numbers in the whole scene of the contactors at these places, ascending
    type(scene_t), intent(in) :: scene !! this rank's part as it is now
    integer(i4) :: place(size(former))
    integer :: k

    call find_places(former, scene%contactors%id(:scene%contactors%n), place)
    do k = 1, contacts%n
      contacts%contactor(:, k) = place(contacts%contactor(:, k))
    end do
    call keep_present(contacts, scene)
  end subroutine renumber_contacts

  !> Drop contacts of contactors that are not here, with place 0, and find the bodies of the others.
  subroutine keep_present(contacts, scene)
    type(contacts_t), intent(inout) :: contacts !! contacts that name contactors by their places
    type(scene_t), intent(in) :: scene !! this rank's part as it is now
    integer(i4), allocatable :: present(:)
    integer :: k

    present = pack([(int(k, i4), k=1, contacts%n)], [(all(contacts%contactor(:, k) > 0), k=1, contacts%n)])
    if (size(present) < contacts%n) call contacts%keep(present)
    contacts%n = size(present)
    do k = 1, contacts%n
      contacts%body(:, k) = scene%contactors%body(contacts%contactor(:, k))
    end do
  end subroutine keep_present

  !> Places of the members of one ascending list in another one, 0 where they are not in it.
  pure subroutine find_places(former, now, place)
    integer(i4), intent(in) :: former(:), now(:)
    integer(i4), intent(out) :: place(:)
    integer :: i, j

    place = 0
    j = 1
    do i = 1, size(former)
      do while (j <= size(now))
        if (now(j) >= former(i)) exit
        j = j + 1
      end do
      if (j > size(now)) return
      if (now(j) == former(i)) place(i) = int(j, i4)
    end do
  end subroutine find_places
end module sg_renumber
