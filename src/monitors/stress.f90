!> The mean stress of the grains from contact forces and branch vectors (Love and Weber).
!!
!! sigma = (1/A) sum over contacts of f (x) l: f is the mean force over the step on the candidate, l leads from the
!! antagonist's centre to the candidate's; towards a wall it ends at the point of contact. Compression is positive.
module sg_stress
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp
  use sg_mapping, only: arms_of
  use sg_scene, only: scene_t
  implicit none
  private
  public :: mean_stress, contact_impulse

contains

  !> Mean stress over an area [Pa]: component (a, b) is force along a, branch along b; zero on an empty area.
  pure function mean_stress(scene, contacts, h, area) result(stress)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: area !! area that the grains take [m2]
    real(wp) :: stress(2, 2), arms(2, 2), half_gap(2), branch(2), impulse(2)
    integer :: k

    stress = 0
    if (.not. area*h > 0) return
    do k = 1, contacts%n
      arms = arms_of(contacts, k, scene%bodies%middle, scene%period)
      half_gap = contacts%gap(k)/2*contacts%normal(:, k)
      branch = 0
      if (scene%bodies%is_grain(contacts%body(1, k))) branch = branch - arms(:, 1) + half_gap
      if (scene%bodies%is_grain(contacts%body(2, k))) branch = branch + arms(:, 2) + half_gap
      impulse = contact_impulse(contacts, k)
      stress(:, 1) = stress(:, 1) + impulse*branch(1)
      stress(:, 2) = stress(:, 2) + impulse*branch(2)
    end do
    stress = stress/(area*h)
  end function mean_stress

  !> Impulse of a contact on its candidate in the global frame [N s].
  pure function contact_impulse(contacts, k) result(impulse)
    type(contacts_t), intent(in) :: contacts !! contacts with their impulses
    integer, intent(in) :: k !! contact
    real(wp) :: impulse(2)

    associate (n => contacts%normal(:, k))
      impulse = contacts%impulse(1, k)*n
      if (contacts%n_components == 2) impulse = impulse + contacts%impulse(2, k)*[n(2), -n(1)]
    end associate
  end function contact_impulse
end module sg_stress
