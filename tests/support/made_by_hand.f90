!> Scenes and contacts put together by hand, so that what is measured of them has a closed form.
module made_by_hand
  use sg_contactors, only: add_disk, place_contactors
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_kinds, only: wp, i1, i4, pi
  use sg_scene, only: scene_t
  implicit none
  private
  public :: disks, set_middle, make_wall, touch

contains

  !> A scene of `n` unit disks at the positions given, at rest.
  function disks(position) result(scene)
    real(wp), intent(in) :: position(:, :) !! centres [m], shape (2, n)
    type(scene_t) :: scene
    integer :: i

    call scene%bodies%allocate(size(position, 2))
    scene%bodies%position = position
    do i = 1, scene%bodies%n
      call add_disk(scene%contactors, i, 1, 1.0_wp, [0.0_wp, 0.0_wp])
      scene%bodies%mass(i) = 2
      scene%bodies%inertia(i) = 1
      scene%bodies%area(i) = pi
    end do
    scene%bodies%inverse_mass(1:2, :) = 0.5_wp
    scene%bodies%inverse_mass(3, :) = 1
    call set_middle(scene, 0.0_wp)
  end function disks

  !> Bring a scene to its detection configuration.
  subroutine set_middle(scene, h)
    type(scene_t), intent(inout) :: scene !! scene to place
    real(wp), intent(in) :: h !! time step [s]

    scene%bodies%middle(1:2, :) = scene%bodies%position + h/2*scene%bodies%velocity(1:2, :)
    scene%bodies%middle(3, :) = scene%bodies%angle + h/2*scene%bodies%velocity(3, :)
    call place_contactors(scene%contactors, scene%bodies%middle)
  end subroutine set_middle

  !> Take a body's freedom away.
  subroutine make_wall(scene, body)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body

    scene%bodies%is_grain(body) = .false.
    scene%bodies%inverse_mass(:, body) = 0
  end subroutine make_wall

  !> Add a contact.
  subroutine touch(contacts, candidate, antagonist, normal, point, gap, impulse)
    type(contacts_t), intent(inout) :: contacts !! list to grow
    integer, intent(in) :: candidate, antagonist !! bodies, and contactors of the same numbers
    real(wp), intent(in) :: normal(2) !! from antagonist to candidate
    real(wp), intent(in) :: point(2) !! [m]
    real(wp), intent(in) :: gap !! [m]
    real(wp), intent(in) :: impulse(2) !! normal and tangential [N s]

    call reserve_contacts(contacts, contacts%n + 1)
    contacts%n = contacts%n + 1
    contacts%body(:, contacts%n) = int([candidate, antagonist], i4)
    contacts%contactor(:, contacts%n) = int([candidate, antagonist], i4)
    contacts%normal(:, contacts%n) = normal
    contacts%point(:, contacts%n) = point
    contacts%gap(contacts%n) = gap
    contacts%impulse(:, contacts%n) = impulse(:contacts%n_components)
    contacts%image(contacts%n) = 0_i1
  end subroutine touch
end module made_by_hand
