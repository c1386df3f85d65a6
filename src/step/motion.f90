!> The theta scheme of Moreau and Jean: what happens to bodies before and after the contact problem of a step.
!!
!! V_free = V + h M^-1 F,  x_m = x + (1 - theta) h V,  x' = x + h ((1 - theta) V + theta V')  (doc/theory/scheme.md)
module sg_motion
  use sg_bodies, only: bodies_t
  use sg_drives, only: drive_forces, drive_velocities
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  implicit none
  private
  public :: predict, update

contains

  !> External forces, free velocities and the configuration of detection.
  pure subroutine predict(scene, time, h, theta)
    type(scene_t), intent(inout) :: scene !! scene at the beginning of the step
    real(wp), intent(in) :: time !! beginning of the step [s]
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step
    integer :: b

    do b = 1, scene%bodies%n
      scene%bodies%force(1:2, b) = scene%bodies%mass(b)*scene%gravity
      if (scene%bodies%n_velocity == 3) scene%bodies%force(3, b) = 0
    end do
    call drive_forces(scene%drives, scene%pressures, scene%bodies, time, h, theta)
    associate (bodies => scene%bodies)
      bodies%free_velocity = bodies%velocity + h*bodies%inverse_mass*bodies%force
    end associate
    call drive_velocities(scene%drives, scene%bodies, time + h)
    call set_middle(scene%bodies, (1 - theta)*h)
  end subroutine predict

  !> Configuration of detection: where bodies are after a time, at their present velocities.
  pure subroutine set_middle(bodies, duration)
    type(bodies_t), intent(inout) :: bodies
    real(wp), intent(in) :: duration

    bodies%middle(1:2, :) = bodies%position + duration*bodies%velocity(1:2, :)
    if (bodies%n_velocity == 3) bodies%middle(3, :) = bodies%angle + duration*bodies%velocity(3, :)
  end subroutine set_middle

  !> Move bodies to the end of the step; their velocities there stand in `free_velocity`.
  pure subroutine update(bodies, h, theta)
    type(bodies_t), intent(inout) :: bodies !! bodies of the solved step
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step

    bodies%position = bodies%position + h*((1 - theta)*bodies%velocity(1:2, :) + theta*bodies%free_velocity(1:2, :))
    if (bodies%n_velocity == 3) then
      bodies%angle = bodies%angle + h*((1 - theta)*bodies%velocity(3, :) + theta*bodies%free_velocity(3, :))
    end if
    bodies%velocity = bodies%free_velocity
  end subroutine update
end module sg_motion
