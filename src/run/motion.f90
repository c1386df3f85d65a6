!> The theta scheme of Moreau and Jean [Jean1999]: motion of bodies before and after the contact problem of a step.
!!
!! V_free = V + h M^-1 F,  x_m = x + (1 - theta) h V,  x' = x + h ((1 - theta) V + theta V')  (doc/theory/scheme.md)
module sg_motion
  use sg_bodies, only: bodies_t
  use sg_drives, only: drive_forces, drive_velocities, hold_driven
  use sg_free_spin, only: free_spin
  use sg_kinds, only: wp
  use sg_presence, only: hold_absent
  use sg_rotations, only: turned_back, turned_by, turned_on
  use sg_scene, only: scene_t, set_edges, set_gravity
  implicit none
  private
  public :: predict, update, shift, move_with_cell

contains

  !> External forces, free velocities and the configuration of detection.
  pure subroutine predict(scene, time, h, theta)
    type(scene_t), intent(inout) :: scene !! scene at the beginning of the step
    real(wp), intent(in) :: time !! beginning of the step [s]
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step
    integer :: b, n

    n = scene%dimension
    call set_gravity(scene, time, h, theta)
    do b = 1, scene%bodies%n
      scene%bodies%force(:, b) = 0
      scene%bodies%force(:n, b) = scene%bodies%mass(b)*scene%gravity(:n)
    end do
    call hold_driven(scene%drives, scene%bodies, time + h/2)
    call drive_forces(scene%drives, scene%pressures, scene%bodies, time, h, theta)
    associate (bodies => scene%bodies)
      bodies%free_velocity = bodies%velocity + h*bodies%inverse_mass*bodies%force
    end associate
    call drive_velocities(scene%drives, scene%bodies, time + h, h)
    if (scene%cell%is_on) call begin_in_cell(scene, time, h, theta)
    if (scene%bodies%has_presence) call hold_absent(scene%bodies)
    if (scene%bodies%n_velocity == 6) call spin_freely(scene%bodies, h, theta)
    call set_middle(scene%bodies, (1 - theta)*h)
    if (scene%cell%is_on) call carry_middle(scene, (1 - theta)*h)
  end subroutine predict

  !> Begin a step of a periodic cell. Own velocities of bodies are those beyond the cell's: by Newton's law they change by -G V.
  pure subroutine begin_in_cell(scene, time, h, theta)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: time, h, theta
    real(wp) :: own(3), force(3)
    integer :: b, n

    n = scene%dimension
    call scene%cell%begin_step(time, h, theta)
    call set_edges(scene, (scene%cell%middle))
    own = 0
    associate (bodies => scene%bodies)
      do b = 1, bodies%n
        own(:n) = bodies%velocity(:n, b)
        force = -bodies%mass(b)*scene%cell%mean_velocity(own, 0.0_wp)
        bodies%force(:n, b) = bodies%force(:n, b) + force(:n)
        bodies%free_velocity(:n, b) = bodies%free_velocity(:n, b) + h*bodies%inverse_mass(:n, b)*force(:n)
      end do
    end associate
  end subroutine begin_in_cell

  !> Carry the configuration of detection with the cell.
  pure subroutine carry_middle(scene, duration)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: duration
    real(wp) :: place(3)
    integer :: b, n

    n = scene%dimension
    place = 0
    do b = 1, scene%bodies%n
      place(:n) = scene%bodies%middle(:n, b)
      place = scene%cell%to_middle(place, duration)
      scene%bodies%middle(:n, b) = place(:n)
    end do
  end subroutine carry_middle

  !> Move a periodic cell to the end of a step, and bodies with it: by the homogeneous velocities of their `middle`.
  pure subroutine move_with_cell(scene, h, theta)
    type(scene_t), intent(inout) :: scene !! scene of the solved step
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step
    real(wp) :: place(3)
    integer :: b, n

    n = scene%dimension
    place = 0
    do b = 1, scene%bodies%n
      place(:n) = scene%bodies%middle(:n, b)
      place = scene%cell%mean_velocity(place, theta)
      scene%bodies%position(:, b) = scene%bodies%position(:, b) + h*place(:n)
    end do
    call scene%cell%finish_step(h, theta)
  end subroutine move_with_cell

  !> Gyroscopic torques: those of the bodies whose principal moments differ.
  pure subroutine spin_freely(bodies, h, theta)
    type(bodies_t), intent(inout) :: bodies
    real(wp), intent(in) :: h, theta
    integer :: b

    do b = 1, bodies%n
      if (.not. maxval(bodies%principal(:, b)) > minval(bodies%principal(:, b))) cycle
      call free_spin(bodies%principal(:, b), bodies%inverse_mass(4:6, b), bodies%velocity(4:6, b), bodies%force(4:6, b), h, &
                     theta, bodies%free_velocity(4:6, b))
    end do
  end subroutine spin_freely

  !> Configuration of detection: where bodies are after a time, at their present velocities.
  pure subroutine set_middle(bodies, duration)
    type(bodies_t), intent(inout) :: bodies
    real(wp), intent(in) :: duration
    integer :: b

    bodies%middle(:bodies%dimension, :) = bodies%position + duration*bodies%velocity(:bodies%dimension, :)
    select case (bodies%n_velocity - bodies%dimension)
    case (1)
      bodies%middle(3, :) = bodies%angle + duration*bodies%velocity(3, :)
    case (3)
      do b = 1, bodies%n
        bodies%middle(4:7, b) = turned_on(bodies%orientation(:, b), duration*bodies%velocity(4:6, b))
      end do
    case default
      if (allocated(bodies%angle)) bodies%middle(3, :) = bodies%angle
      if (allocated(bodies%orientation)) bodies%middle(4:7, :) = bodies%orientation
    end select
  end subroutine set_middle

  !> Move bodies to the end of the step; their velocities there stand in `free_velocity`.
  pure subroutine update(bodies, h, theta)
    type(bodies_t), intent(inout) :: bodies !! bodies of the solved step
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step
    integer :: b, n

    n = bodies%dimension
    bodies%position = bodies%position + h*((1 - theta)*bodies%velocity(:n, :) + theta*bodies%free_velocity(:n, :))
    select case (bodies%n_velocity - n)
    case (1)
      bodies%angle = bodies%angle + h*((1 - theta)*bodies%velocity(3, :) + theta*bodies%free_velocity(3, :))
    case (3)
      do b = 1, bodies%n
        bodies%orientation(:, b) = turned_on(bodies%orientation(:, b), &
                                             h*((1 - theta)*bodies%velocity(4:6, b) + theta*bodies%free_velocity(4:6, b)))
        if (keeps_spin(bodies%principal(:, b), bodies%inverse_mass(4:6, b))) then
          bodies%free_velocity(4:6, b) = turned_back(bodies%orientation(:, b), &
                                                     turned_by(bodies%middle(4:7, b), bodies%free_velocity(4:6, b)))
        end if
      end do
    end select
    bodies%velocity = bodies%free_velocity
  end subroutine update

  !> Move bodies on by the velocities that stand in `free_velocity`, which those of their motion are not.
  pure subroutine shift(bodies, h)
    type(bodies_t), intent(inout) :: bodies !! bodies at the end of a step
    real(wp), intent(in) :: h !! time step [s]
    integer :: b, n

    n = bodies%dimension
    bodies%position = bodies%position + h*bodies%free_velocity(:n, :)
    select case (bodies%n_velocity - n)
    case (1)
      bodies%angle = bodies%angle + h*bodies%free_velocity(3, :)
    case (3)
      do b = 1, bodies%n
        bodies%orientation(:, b) = turned_on(bodies%orientation(:, b), h*bodies%free_velocity(4:6, b))
      end do
    end select
  end subroutine shift

  !> Is the spin of a body its angular momentum over one moment of inertia? Then it is kept as a vector of the world: the frame
  !! that carries it turns on from the `middle`, where contacts changed it, about an axis that is not its own.
  pure logical function keeps_spin(principal, inverse)
    real(wp), intent(in) :: principal(3), inverse(3)

    keeps_spin = minval(inverse) > 0 .and. maxval(principal) - minval(principal) <= 16*epsilon(1.0_wp)*maxval(principal)
  end function keeps_spin
end module sg_motion
