!> Records of the bodies of a contact problem: velocities and inverse masses by slot, and velocities back to the bodies.
module sg_problem_bodies
  use sg_assemble_space, only: load_space_bodies, unload_space_bodies
  use sg_bodies, only: bodies_t
  use sg_kinds, only: wp, i4
  use sg_problem, only: problem_t
  use sg_records, only: arm_frictional, arm_frictionless, arm_inverse_i, arm_inverse_mx, arm_spin, is_in_space, plain_kind, &
                        round_frictional, round_frictionless, round_frictionless_inverse_mx, round_frictionless_inverse_my, &
                        round_inverse_i, round_inverse_mx, round_inverse_my, round_spin, velocity_x, velocity_y
  implicit none
  private
  public :: load_bodies, take_velocities

contains

  !> Free velocities and inverse masses by slot.
  pure subroutine load_bodies(bodies, kind, body_of, radius, body)
    type(bodies_t), intent(in) :: bodies !! bodies with their free velocities
    integer, intent(in) :: kind !! kind of problem
    integer(i4), intent(in) :: body_of(:) !! body of each slot
    real(wp), intent(in) :: radius(:) !! radius of round bodies [m]
    real(wp), intent(inout) :: body(:, :) !! records to fill

    if (is_in_space(kind)) then
      call load_space_bodies(bodies, kind, body_of, radius, body)
    else
      call load_plane_bodies(bodies, kind, body_of, radius, body)
    end if
  end subroutine load_bodies

  !> Those of bodies in the plane.
  pure subroutine load_plane_bodies(bodies, kind, body_of, radius, body)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: kind
    integer(i4), intent(in) :: body_of(:)
    real(wp), intent(in) :: radius(:)
    real(wp), intent(inout) :: body(:, :)
    integer :: s, b

    do s = 1, size(body_of)
      b = body_of(s)
      body(velocity_x:velocity_y, s) = bodies%free_velocity(1:2, b)
      select case (kind)
      case (round_frictionless)
        body(round_frictionless_inverse_mx:round_frictionless_inverse_my, s) = bodies%inverse_mass(1:2, b)
      case (round_frictional)
        body(round_spin, s) = radius(b)*bodies%free_velocity(3, b)
        body(round_inverse_mx:round_inverse_my, s) = bodies%inverse_mass(1:2, b)
        body(round_inverse_i, s) = radius(b)**2*bodies%inverse_mass(3, b)
      case default
        body(arm_spin, s) = bodies%free_velocity(3, b)
        body(arm_inverse_mx:arm_inverse_i, s) = bodies%inverse_mass(1:3, b)
      end select
    end do
  end subroutine load_plane_bodies

  !> Velocities of the solution back to the bodies (into `free_velocity`).
  pure subroutine take_velocities(problem, body_of, radius, bodies)
    type(problem_t), intent(in) :: problem !! solved problem
    integer(i4), intent(in) :: body_of(:) !! body of each slot
    real(wp), intent(in) :: radius(:) !! as in `load_bodies`
    type(bodies_t), intent(inout) :: bodies !! bodies that move on
    integer :: s, b

    if (is_in_space(problem%kind)) then
      call unload_space_bodies(problem, body_of, radius, bodies)
      return
    end if
    do s = 1, problem%n_bodies
      b = body_of(s)
      bodies%free_velocity(1:2, b) = problem%body(velocity_x:velocity_y, s)
      select case (plain_kind(problem%kind))
      case (round_frictional)
        if (bodies%inverse_mass(3, b) > 0) bodies%free_velocity(3, b) = problem%body(round_spin, s)/radius(b)
      case (arm_frictional, arm_frictionless)
        bodies%free_velocity(3, b) = problem%body(arm_spin, s)
      end select
    end do
  end subroutine take_velocities
end module sg_problem_bodies
