!> Resultants R = H r of contact impulses on bodies, from geometry alone: what the contact problem's own H is compared with.
module resultants
  use sg_contacts, only: contacts_t, impulse_vector
  use sg_kinds, only: wp
  use sg_mapping, only: arms_of
  use sg_mapping_space, only: space_arms
  use sg_rotations, only: turned_back
  use sg_scene, only: scene_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: add_resultants, add_space_resultants

contains

  !> Add to each body what the contact impulses do to it [N s, N m s]: R = R + H r.
  pure subroutine add_resultants(contacts, middle, period, resultant)
    type(contacts_t), intent(in) :: contacts !! contacts of the step, with their impulses
    real(wp), intent(in), contiguous :: middle(:, :) !! configuration of detection, shape (2 or 3, bodies)
    real(wp), intent(in) :: period !! period in x, zero when not periodic [m]
    real(wp), intent(inout), contiguous :: resultant(:, :) !! resultants to add to, shape (2 or 3, bodies)
    real(wp) :: arms(2, 2), n(2), p(2)
    integer :: k, c, a

    do k = 1, contacts%n
      c = contacts%body(1, k)
      a = contacts%body(2, k)
      n = contacts%normal(:, k)
      p = contacts%impulse(1, k)*n
      if (contacts%n_components == 2) p = p + contacts%impulse(2, k)*[n(2), -n(1)]
      resultant(1:2, c) = resultant(1:2, c) + p
      resultant(1:2, a) = resultant(1:2, a) - p
      if (size(resultant, 1) < 3) cycle
      arms = arms_of(contacts, k, middle, period)
      resultant(3, c) = resultant(3, c) + arms(1, 1)*p(2) - arms(2, 1)*p(1)
      resultant(3, a) = resultant(3, a) - arms(1, 2)*p(2) + arms(2, 2)*p(1)
    end do
  end subroutine add_resultants

  !> Add to each body what the contact impulses do to it [N s, N m s]: R = R + H r.
  pure subroutine add_space_resultants(scene, contacts, resultant)
    type(scene_t), intent(in) :: scene !! scene in its `middle` configuration
    type(contacts_t), intent(in) :: contacts !! contacts of the step, with their impulses
    real(wp), intent(inout), contiguous :: resultant(:, :) !! resultants to add to, shape (3 or 6, bodies)
    real(wp) :: arms(3, 2), p(3)
    integer :: k, c, a

    do k = 1, contacts%n
      c = contacts%body(1, k)
      a = contacts%body(2, k)
      p = impulse_vector(contacts, k)
      resultant(1:3, c) = resultant(1:3, c) + p
      resultant(1:3, a) = resultant(1:3, a) - p
      if (size(resultant, 1) < 6) cycle
      arms = space_arms(scene, contacts, k)
      resultant(4:6, c) = resultant(4:6, c) + turned_back(scene%bodies%middle(4:7, c), cross(arms(:, 1), p))
      resultant(4:6, a) = resultant(4:6, a) - turned_back(scene%bodies%middle(4:7, a), cross(arms(:, 2), p))
    end do
  end subroutine add_space_resultants
end module resultants
