!> Contacts that are links: what they carry, how long they are, and what a step leaves of them (doc/theory/links.md).
module sg_link_contacts
  use sg_contactors, only: kind_point
  use sg_contacts, only: contacts_t, normal_impulse
  use sg_kinds, only: wp
  use sg_laws, only: status_broken, status_none, status_stick
  use sg_link_laws, only: breaks, pulls_only
  use sg_scene, only: scene_t
  implicit none
  private
  public :: is_link, tension, finish_links

contains

  !> Is a contact a link?
  pure logical function is_link(scene, contacts, k)
    type(scene_t), intent(in) :: scene !! scene with its links
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact

    is_link = scene%links%n > 0
    if (is_link) is_link = scene%contactors%kind(contacts%contactor(1, k)) == kind_point
  end function is_link

  !> Impulse by which a link pulls its ends together [N s]; negative where it pushes them apart.
  pure real(wp) function tension(scene, contacts, k)
    type(scene_t), intent(in) :: scene !! scene with its links
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact, a link

    tension = normal_impulse(contacts, k)
    if (.not. pulls_only(scene%laws(contacts%law(k)))) tension = -tension
  end function tension

  !> Set what the links did in a step that is solved: nothing (a slack wire), something, or that they broke.
  pure subroutine finish_links(scene, contacts, step)
    type(scene_t), intent(in) :: scene !! scene with its links
    type(contacts_t), intent(inout) :: contacts !! contacts of the step, solved
    real(wp), intent(in) :: step !! time step [s]
    real(wp), parameter :: no_shear(2) = 0
    integer :: k

    if (scene%links%n == 0) return
    do k = 1, contacts%n
      if (.not. is_link(scene, contacts, k)) cycle
      if (contacts%status(k) == status_broken) cycle
      contacts%status(k) = status_none
      if (any(abs(contacts%impulse(:, k)) > 0)) contacts%status(k) = status_stick
      associate (l => contacts%feature(k), links => scene%links)
        if (breaks(scene%laws(contacts%law(k)), contacts%gap(k), links%length(l), [links%area(l), links%mass(l)], no_shear, &
                   tension(scene, contacts, k)/step)) contacts%status(k) = status_broken
      end associate
    end do
  end subroutine finish_links
end module sg_link_contacts
