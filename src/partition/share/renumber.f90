!> Contacts that stay on their rank while its scene is rebuilt: they name its contactors by their new places.
module sg_renumber
  use sg_contacts, only: contacts_t
  use sg_kinds, only: i4
  use sg_scene, only: scene_t
  implicit none
  private
  public :: renumber_contacts

contains

  !> Let the contacts of the last step name contactors by their places in a rebuilt scene. Contacts of contactors that are no
  !! longer here are dropped: they were too far from each other to touch.
  pure subroutine renumber_contacts(contacts, former, scene)
    type(contacts_t), intent(inout) :: contacts !! contacts that name contactors by their former places
    integer(i4), intent(in) :: former(:) !! numbers in the whole scene of the contactors at these places, ascending
    type(scene_t), intent(in) :: scene !! this rank's part as it is now
    integer(i4) :: place(size(former)), pair(2)
    integer :: k, n

    call find_places(former, scene%contactors%id(:scene%contactors%n), place)
    n = 0
    do k = 1, contacts%n
      pair = place(contacts%contactor(:, k))
      if (any(pair == 0)) cycle
      n = n + 1
      contacts%contactor(:, n) = pair
      contacts%body(:, n) = scene%contactors%body(pair)
      contacts%feature(n) = contacts%feature(k)
      contacts%image(n) = contacts%image(k)
      if (contacts%dimension == 3) contacts%image_y(n) = contacts%image_y(k)
      contacts%law(n) = contacts%law(k)
      contacts%status(n) = contacts%status(k)
      contacts%impulse(:, n) = contacts%impulse(:, k)
      if (contacts%n_internal > 0) contacts%internal(:, n) = contacts%internal(:, k)
    end do
    contacts%n = n
  end subroutine renumber_contacts

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
