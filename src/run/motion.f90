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
  use sg_threads, only: begin_share, n_sharing, piece_t, share_t, takes
  implicit none
  private
  public :: predict, update, shift, move_with_cell

  !> Least bodies of a piece
  integer, parameter :: least_bodies = 256

contains

  !> External forces, free velocities and the configuration of detection.
  subroutine predict(scene, time, h, theta)
    type(scene_t), intent(inout) :: scene !! scene at the beginning of the step
    real(wp), intent(in) :: time !! beginning of the step [s]
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step

    call set_gravity(scene, time, h, theta)
    associate (bodies => scene%bodies)
      call set_weights(scene%dimension, bodies%n_velocity, bodies%n, scene%gravity, bodies%mass, bodies%force)
      call hold_driven(scene%drives, bodies, time + h/2)
      call drive_forces(scene%drives, scene%pressures, bodies, time, h, theta)
      call set_free_velocities(size(bodies%force), h, bodies%velocity, bodies%inverse_mass, bodies%force, bodies%free_velocity)
    end associate
    call drive_velocities(scene%drives, scene%bodies, time + h, h)
    if (scene%cell%is_on) call begin_in_cell(scene, time, h, theta)
    if (scene%bodies%has_presence) call hold_absent(scene%bodies)
    call share_middle(scene%bodies, h, theta)
    if (scene%cell%is_on) call carry_middle(scene, (1 - theta)*h)
  end subroutine predict

  !> Gyroscopic torques, and the configuration of detection.
  subroutine share_middle(bodies, h, theta)
    type(bodies_t), intent(inout) :: bodies
    real(wp), intent(in) :: h, theta
    type(share_t) :: share
    type(piece_t) :: piece
    integer :: t

    if (bodies%n_velocity /= 6) then
      call set_middle(bodies, (1 - theta)*h)
      return
    end if
    call begin_share(share, bodies%n, least_bodies)
    !$omp taskloop default(shared) private(t, piece) grainsize(1) if (share%pieces > 1)
    do t = 1, n_sharing()
      do while (takes(share, piece))
        call spin_freely(bodies, piece, h, theta)
        call set_middle_in_space(bodies, piece, (1 - theta)*h)
      end do
    end do
  end subroutine share_middle

  !> Weights of all bodies. Loops over bodies here have plain arrays and components that are written out.
  pure subroutine set_weights(dimension, n_velocity, n, gravity, mass, force)
    integer, intent(in) :: dimension, n_velocity, n
    real(wp), intent(in) :: gravity(3), mass(n)
    real(wp), intent(out) :: force(n_velocity, n)
    integer :: b

    if (dimension == 2 .and. n_velocity == 3) then
      do b = 1, n
        force(1, b) = mass(b)*gravity(1)
        force(2, b) = mass(b)*gravity(2)
        force(3, b) = 0
      end do
      return
    end if
    do b = 1, n
      force(:dimension, b) = mass(b)*gravity(:dimension)
      force(dimension + 1:, b) = 0
    end do
  end subroutine set_weights

  !> Free velocities, one component of all bodies after the other.
  pure subroutine set_free_velocities(n, h, velocity, inverse_mass, force, free_velocity)
    integer, intent(in) :: n
    real(wp), intent(in) :: h, velocity(n), inverse_mass(n), force(n)
    real(wp), intent(out) :: free_velocity(n)

    free_velocity = velocity + h*inverse_mass*force
  end subroutine set_free_velocities

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
  pure subroutine spin_freely(bodies, piece, h, theta)
    type(bodies_t), intent(inout) :: bodies
    type(piece_t), intent(in) :: piece !! first and last body
    real(wp), intent(in) :: h, theta
    integer :: b

    do b = piece%first, piece%last
      associate (p => bodies%principal(:, b))
        if (.not. max(p(1), p(2), p(3)) > min(p(1), p(2), p(3))) cycle
      end associate
      call free_spin(bodies%principal(:, b), bodies%inverse_mass(4:6, b), bodies%velocity(4:6, b), bodies%force(4:6, b), h, &
                     theta, bodies%free_velocity(4:6, b))
    end do
  end subroutine spin_freely

  !> Configuration of detection: where bodies are after a time, at their present velocities.
  pure subroutine set_middle(bodies, duration)
    type(bodies_t), intent(inout) :: bodies
    real(wp), intent(in) :: duration
    integer :: n

    n = bodies%dimension
    select case (bodies%n_velocity - n)
    case (1)
      call move_in_plane(bodies%n, duration, bodies%position, bodies%angle, bodies%velocity, bodies%middle)
    case default
      bodies%middle(:n, :) = bodies%position + duration*bodies%velocity(:n, :)
      if (allocated(bodies%angle)) bodies%middle(3, :) = bodies%angle
      if (allocated(bodies%orientation)) bodies%middle(4:7, :) = bodies%orientation
    end select
  end subroutine set_middle

  !> The same of bodies that turn in space.
  pure subroutine set_middle_in_space(bodies, piece, duration)
    type(bodies_t), intent(inout) :: bodies
    type(piece_t), intent(in) :: piece !! first and last body
    real(wp), intent(in) :: duration
    integer :: b

    do b = piece%first, piece%last
      bodies%middle(1:3, b) = bodies%position(1:3, b) + duration*bodies%velocity(1:3, b)
      bodies%middle(4:7, b) = turned_on(bodies%orientation(1:4, b), duration*bodies%velocity(4:6, b))
    end do
  end subroutine set_middle_in_space

  !> Places and angles after a time, of bodies that turn in the plane.
  pure subroutine move_in_plane(n, duration, position, angle, velocity, moved)
    integer, intent(in) :: n
    real(wp), intent(in) :: duration, position(2, n), angle(n), velocity(3, n)
    real(wp), intent(inout) :: moved(3, n)
    integer :: b

    do b = 1, n
      moved(1, b) = position(1, b) + duration*velocity(1, b)
      moved(2, b) = position(2, b) + duration*velocity(2, b)
      moved(3, b) = angle(b) + duration*velocity(3, b)
    end do
  end subroutine move_in_plane

  !> Move bodies to the end of the step; their velocities there stand in `free_velocity`.
  subroutine update(bodies, h, theta)
    type(bodies_t), intent(inout) :: bodies !! bodies of the solved step
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step
    type(share_t) :: share
    type(piece_t) :: piece
    integer :: t

    select case (bodies%n_velocity - bodies%dimension)
    case (1)
      call update_in_plane(bodies%n, h, theta, bodies%free_velocity, bodies%position, bodies%angle, bodies%velocity)
    case (3)
      call begin_share(share, bodies%n, least_bodies)
      !$omp taskloop default(shared) private(t, piece) grainsize(1) if (share%pieces > 1)
      do t = 1, n_sharing()
        do while (takes(share, piece))
          call update_piece(bodies, piece, h, theta)
        end do
      end do
    case default
      bodies%position = bodies%position + h*((1 - theta)*bodies%velocity + theta*bodies%free_velocity)
      bodies%velocity = bodies%free_velocity
    end select
  end subroutine update

  !> Move bodies that turn in space.
  pure subroutine update_piece(bodies, piece, h, theta)
    type(bodies_t), intent(inout) :: bodies
    type(piece_t), intent(in) :: piece !! first and last body
    real(wp), intent(in) :: h, theta
    integer :: b

    do b = piece%first, piece%last
      call update_in_space(h, theta, bodies%middle(4:7, b), bodies%principal(:, b), bodies%inverse_mass(4:6, b), &
                           bodies%velocity(:, b), bodies%position(:, b), bodies%orientation(:, b), bodies%free_velocity(:, b))
      bodies%velocity(:, b) = bodies%free_velocity(:, b)
    end do
  end subroutine update_piece

  !> Those that turn in the plane.
  pure subroutine update_in_plane(n, h, theta, next, position, angle, velocity)
    integer, intent(in) :: n
    real(wp), intent(in) :: h, theta, next(3, n)
    real(wp), intent(inout) :: position(2, n), angle(n), velocity(3, n)
    integer :: b

    do b = 1, n
      position(1, b) = position(1, b) + h*((1 - theta)*velocity(1, b) + theta*next(1, b))
      position(2, b) = position(2, b) + h*((1 - theta)*velocity(2, b) + theta*next(2, b))
      angle(b) = angle(b) + h*((1 - theta)*velocity(3, b) + theta*next(3, b))
      velocity(1, b) = next(1, b)
      velocity(2, b) = next(2, b)
      velocity(3, b) = next(3, b)
    end do
  end subroutine update_in_plane

  !> One that turns in space.
  pure subroutine update_in_space(h, theta, middle, principal, inverse, velocity, position, orientation, next)
    real(wp), intent(in) :: h, theta, middle(4), principal(3), inverse(3), velocity(6)
    real(wp), intent(inout) :: position(3), orientation(4), next(6)

    position = position + h*((1 - theta)*velocity(1:3) + theta*next(1:3))
    orientation = turned_on(orientation, h*((1 - theta)*velocity(4:6) + theta*next(4:6)))
    if (keeps_spin(principal, inverse)) next(4:6) = turned_back(orientation, turned_by(middle, next(4:6)))
  end subroutine update_in_space

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

    real(wp) :: largest

    largest = max(principal(1), principal(2), principal(3))
    keeps_spin = min(inverse(1), inverse(2), inverse(3)) > 0 .and. &
                 largest - min(principal(1), principal(2), principal(3)) <= 16*epsilon(1.0_wp)*largest
  end function keeps_spin
end module sg_motion
