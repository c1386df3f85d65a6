!> The mapping H between bodies and contacts, from geometry alone (doc/theory/contact_problem.md).
!!
!! Relative velocities u = H^T V: velocity of the candidate's material point minus the antagonist's, on the normal
!! and the tangent t = (n_y, -n_x).
module sg_mapping
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp
  implicit none
  private
  public :: arms_of, relative_velocity

contains

  !> Lever arms of a contact [m], from the centres of candidate and antagonist, each to its own surface.
  !!
  !! The point of contact lies midway between the two surfaces, half a gap from either along the normal.
  pure function arms_of(contacts, k, middle, period) result(arms)
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp), intent(in), contiguous :: middle(:, :) !! configuration of detection, shape (2 or 3, bodies)
    real(wp), intent(in) :: period !! period in x, zero when not periodic [m]
    real(wp) :: arms(2, 2)

    arms(:, 1) = contacts%point(:, k) + contacts%gap(k)/2*contacts%normal(:, k) - middle(1:2, contacts%body(1, k))
    arms(:, 2) = contacts%point(:, k) - contacts%gap(k)/2*contacts%normal(:, k) - middle(1:2, contacts%body(2, k))
    arms(1, 2) = arms(1, 2) - period*real(contacts%image(k), wp)
    if (contacts%has_cell) arms(:, 2) = arms(:, 2) - contacts%upwards*real(contacts%image_y(k), wp)
  end function arms_of

  !> Relative velocity at a contact, normal and tangential [m/s]: one row of H^T V.
  pure function relative_velocity(contacts, k, middle, period, velocity) result(u)
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp), intent(in), contiguous :: middle(:, :) !! configuration of detection, shape (2 or 3, bodies)
    real(wp), intent(in) :: period !! period in x, zero when not periodic [m]
    real(wp), intent(in), contiguous :: velocity(:, :) !! of the bodies, shape (2 or 3, bodies)
    real(wp) :: u(2), arms(2, 2), jump(2), n(2)
    integer :: c, a

    c = contacts%body(1, k)
    a = contacts%body(2, k)
    n = contacts%normal(:, k)
    jump = velocity(1:2, c) - velocity(1:2, a)
    if (size(velocity, 1) == 3) then
      arms = arms_of(contacts, k, middle, period)
      jump = jump + velocity(3, c)*[-arms(2, 1), arms(1, 1)] - velocity(3, a)*[-arms(2, 2), arms(1, 2)]
    end if
    u = [n(1)*jump(1) + n(2)*jump(2), n(2)*jump(1) - n(1)*jump(2)]
  end function relative_velocity
end module sg_mapping
