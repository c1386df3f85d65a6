!> The mapping H between bodies and contacts in space, from geometry alone (doc/theory/contact_problem.md).
!!
!! Velocities of bodies are those of `bodies_t`: translation in the world, spin about principal axes.
module sg_mapping_space
  use sg_contacts, only: contacts_t, image_of
  use sg_kinds, only: wp
  use sg_rotations, only: turned_by
  use sg_scene, only: image_shift, scene_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: tangent_of, space_arms, space_relative_velocity

contains

  !> A unit tangent of a unit normal; the second one is n x t.
  !!
  !! With one sign as its only branch [Duff2017].
  pure function tangent_of(n) result(t)
    real(wp), intent(in) :: n(3) !! unit normal
    real(wp) :: t(3), side, a

    side = sign(1.0_wp, n(3))
    a = -1/(side + n(3))
    t = [1 + side*n(1)**2*a, side*n(1)*n(2)*a, -side*n(1)]
  end function tangent_of

  !> Lever arms of a contact [m], from the centres of candidate and antagonist, each to its own surface.
  pure function space_arms(scene, contacts, k) result(arms)
    type(scene_t), intent(in) :: scene !! scene in its `middle` configuration
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp) :: arms(3, 2), half(3)

    half = contacts%gap(k)/2*contacts%normal(:, k)
    arms(:, 1) = contacts%point(:, k) + half - scene%bodies%middle(1:3, contacts%body(1, k))
    arms(:, 2) = contacts%point(:, k) - half - scene%bodies%middle(1:3, contacts%body(2, k))
    if (scene%cell%is_on) then
      arms(:, 2) = arms(:, 2) - image_shift(scene, image_of(contacts, k))
      return
    end if
    arms(1, 2) = arms(1, 2) - scene%period*real(contacts%image(k), wp)
    arms(2, 2) = arms(2, 2) - scene%period_y*real(contacts%image_y(k), wp)
  end function space_arms

  !> Relative velocity at a contact in the world's axes [m/s]: rows of H^T V.
  pure function space_relative_velocity(scene, contacts, k, velocity) result(u)
    type(scene_t), intent(in) :: scene !! scene in its `middle` configuration
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp), intent(in), contiguous :: velocity(:, :) !! of the bodies, shape (3 or 6, bodies)
    real(wp) :: u(3), arms(3, 2)
    integer :: c, a

    c = contacts%body(1, k)
    a = contacts%body(2, k)
    u = velocity(1:3, c) - velocity(1:3, a)
    if (size(velocity, 1) < 6) return
    arms = space_arms(scene, contacts, k)
    u = u + cross(turned_by(scene%bodies%middle(4:7, c), velocity(4:6, c)), arms(:, 1)) &
        - cross(turned_by(scene%bodies%middle(4:7, a), velocity(4:6, a)), arms(:, 2))
  end function space_relative_velocity
end module sg_mapping_space
