!> The motion of a periodic cell at contacts: what it adds to relative velocities, and its work (doc/theory/periodic_cell.md).
module sg_cell_motion
  use sg_contacts, only: contacts_t, image_of, impulse_vector
  use sg_kinds, only: wp
  use sg_mapping_space, only: tangent_of
  use sg_scene, only: image_shift, scene_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: cell_bias, cell_branch, cell_jump, cell_work

contains

  !> From the antagonist's centre to the candidate's in the `middle` configuration [m]; in the plane the third component is zero.
  pure function cell_branch(scene, contacts, k) result(branch)
    type(scene_t), intent(in) :: scene !! scene in its `middle` configuration
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp) :: branch(3)

    associate (n => scene%dimension, middle => scene%bodies%middle, b => contacts%body(:, k))
      branch = 0
      branch(:n) = middle(:n, b(1)) - middle(:n, b(2))
      branch = branch - image_shift(scene, image_of(contacts, k))
    end associate
  end function cell_branch

  !> Velocity of the candidate against the antagonist that is the cell's [m/s]; zero where no cell moves.
  pure function cell_jump(scene, contacts, k, share) result(jump)
    type(scene_t), intent(in) :: scene !! scene in its `middle` configuration
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp), intent(in), optional :: share !! of the step that has gone by: its end, 1, unless given
    real(wp) :: jump(3)

    jump = 0
    if (.not. scene%cell%is_on) return
    if (present(share)) then
      jump = scene%cell%mean_velocity(cell_branch(scene, contacts, k), share)
    else
      jump = scene%cell%velocity(cell_branch(scene, contacts, k))
    end if
  end function cell_jump

  !> The same along the normal and the tangents of a contact [m/s]: t = (n_y, -n_x) in the plane, those of `tangent_of` in space.
  pure function cell_bias(scene, contacts, k, share) result(bias)
    type(scene_t), intent(in) :: scene !! scene in its `middle` configuration
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp), intent(in), optional :: share !! of the step that has gone by: its end, 1, unless given
    real(wp) :: bias(3), jump(3), n(3), t(3)

    jump = cell_jump(scene, contacts, k, share)
    if (scene%dimension == 2) then
      n(:2) = contacts%normal(:, k)
      bias = [n(1)*jump(1) + n(2)*jump(2), n(2)*jump(1) - n(1)*jump(2), 0.0_wp]
    else
      n = contacts%normal(:, k)
      t = tangent_of(n)
      bias = [dot_product(n, jump), dot_product(t, jump), dot_product(cross(n, t), jump)]
    end if
  end function cell_bias

  !> Work of the cell on this rank's contacts over a step [J]: the contact impulses against the velocities that are the cell's.
  pure real(wp) function cell_work(scene, contacts) result(work)
    type(scene_t), intent(in) :: scene !! scene after the solve, before the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    integer :: k

    work = 0
    do k = 1, contacts%n
      if (.not. any(abs(contacts%impulse(:, k)) > 0)) cycle
      work = work - dot_product(impulse_vector(contacts, k), cell_jump(scene, contacts, k, 0.5_wp))
    end do
  end function cell_work
end module sg_cell_motion
