!> Small scenes in space for tests, body by body: density 1000, one law, everything sees everything.
module scenes_space
  use scenes, only: begin_scene, density, drive, hold
  use sg_contacts, only: impulse_vector
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: box_polyhedron
  use sg_random, only: random_t
  use sg_records, only: ball_frictional, ball_frictionless, solid_frictional
  use sg_rotations, only: frame_of, no_rotation, normalised
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  use sg_solid_bodies, only: make_solid_body
  use sg_space_contactors, only: add_cylinder, add_hollow_cylinder, add_plane, add_polyhedron, add_sphere
  use sg_time_functions, only: time_function_t
  implicit none
  private
  public :: begin_space_scene, put_sphere, put_plane, put_box, put_shape, force_in_space
  public :: put_capsule, put_dumbbell, put_drum, turn_at_random, random_space_scene

contains

  !> A scene of `n` bodies without shapes, one inelastic law with friction, gravity along -z.
  subroutine begin_space_scene(scene, n, friction, alert)
    type(scene_t), intent(out) :: scene !! the scene
    integer, intent(in) :: n !! number of bodies
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(in) :: alert !! gap from which a contact is none [m]

    call begin_scene(scene, n, friction, alert, dimension=3)
  end subroutine begin_space_scene

  !> Make a body a sphere.
  subroutine put_sphere(scene, body, radius, position)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    real(wp), intent(in) :: radius !! [m]
    real(wp), intent(in) :: position(3) !! centre [m]

    call add_sphere(scene%contactors, body, 1, radius, [0.0_wp, 0.0_wp, 0.0_wp])
    scene%bodies%position(:, body) = position
    call finish_body(scene, body)
  end subroutine put_sphere

  !> Make a body a plane that does not move: a thin box, its face at +half(3) along the third axis of its orientation.
  subroutine put_plane(scene, body, half, position, orientation)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    real(wp), intent(in) :: half(3) !! half axes [m]
    real(wp), intent(in) :: position(3) !! centre [m]
    real(wp), intent(in), optional :: orientation(4) !! unit quaternion, none unless given

    call add_plane(scene%contactors, body, 1, half, [0.0_wp, 0.0_wp, 0.0_wp], frame_of(no_rotation))
    scene%bodies%position(:, body) = position
    if (present(orientation)) scene%bodies%orientation(:, body) = orientation
    call finish_body(scene, body)
    call hold(scene, body)
  end subroutine put_plane

  !> Make a body a box.
  subroutine put_box(scene, body, half, position, orientation)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    real(wp), intent(in) :: half(3) !! half lengths of its sides [m]
    real(wp), intent(in) :: position(3) !! centre [m]
    real(wp), intent(in), optional :: orientation(4) !! unit quaternion, none unless given
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error

    call box_polyhedron(half, shape, error)
    if (allocated(error)) error stop 'a box that is none'
    call put_shape(scene, body, shape, position, orientation)
  end subroutine put_box

  !> Make a body a convex polyhedron.
  subroutine put_shape(scene, body, shape, position, orientation)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    type(polyhedron_t), intent(in) :: shape !! in its own frame
    real(wp), intent(in) :: position(3) !! of the origin of that frame [m]
    real(wp), intent(in), optional :: orientation(4) !! unit quaternion, none unless given

    call add_polyhedron(scene%contactors, body, 1, shape, [0.0_wp, 0.0_wp, 0.0_wp])
    scene%bodies%position(:, body) = position
    if (present(orientation)) scene%bodies%orientation(:, body) = orientation
    call finish_body(scene, body)
  end subroutine put_shape

  !> Make a body a cylinder with round caps, its axis along z.
  subroutine put_capsule(scene, body, half_height, radius, position)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    real(wp), intent(in) :: half_height !! of the axis [m]
    real(wp), intent(in) :: radius !! [m]
    real(wp), intent(in) :: position(3) !! centre [m]

    call add_cylinder(scene%contactors, body, 1, half_height, radius, [0.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp, 1.0_wp])
    scene%bodies%position(:, body) = position
    call finish_body(scene, body)
  end subroutine put_capsule

  !> Make a body two spheres side by side along x; its centre is where they weigh the same.
  subroutine put_dumbbell(scene, body, radius, half_distance, position)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    real(wp), intent(in) :: radius !! of both [m]
    real(wp), intent(in) :: half_distance !! from its centre to theirs [m]
    real(wp), intent(in) :: position(3) !! centre [m]

    call add_sphere(scene%contactors, body, 1, radius, [-half_distance, 0.0_wp, 0.0_wp])
    call add_sphere(scene%contactors, body, 1, radius, [half_distance, 0.0_wp, 0.0_wp])
    scene%bodies%position(:, body) = position
    call make_solid_body(scene%bodies, scene%contactors, body, scene%contactors%n - 1, scene%contactors%n, density)
    scene%bodies%inverse_mass(1:3, body) = 1/scene%bodies%mass(body)
    scene%bodies%inverse_mass(4:6, body) = 1/scene%bodies%principal(:, body)
  end subroutine put_dumbbell

  !> Make a body a hollow cylinder along y that does not move.
  subroutine put_drum(scene, body, half_height, radius, position)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    real(wp), intent(in) :: half_height !! [m]
    real(wp), intent(in) :: radius !! inner radius [m]
    real(wp), intent(in) :: position(3) !! centre [m]

    call add_hollow_cylinder(scene%contactors, body, 1, half_height, radius, [0.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, 0.0_wp])
    scene%bodies%position(:, body) = position
    scene%bodies%mass(body) = 1
    scene%bodies%principal(:, body) = 1
    scene%bodies%inverse_mass(:, body) = 1
    call hold(scene, body)
  end subroutine put_drum

  !> Give a body an orientation, all equally likely.
  subroutine turn_at_random(scene, body, random)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    type(random_t), intent(inout) :: random !! stream of random numbers
    real(wp) :: q(4)
    integer :: i

    do i = 1, 4
      q(i) = random%normal()
    end do
    scene%bodies%orientation(:, body) = normalised(q)
  end subroutine turn_at_random

  !> Overlapping shapes that fly about in a box, masses near one; some bodies are driven in some directions, some in their
  !! spin. The plan makes of it a problem of the kind asked.
  subroutine random_space_scene(scene, kind, law, period, side, n)
    type(scene_t), intent(inout) :: scene !! the scene
    integer, intent(in) :: kind !! kind of problem
    integer, intent(in) :: law !! kind of law
    real(wp), intent(in) :: period(2) !! in x and y [m]
    real(wp), intent(in) :: side !! of the box [m]
    integer, intent(in) :: n !! bodies
    type(random_t) :: random
    real(wp) :: place(3), r
    logical :: is_ball, has_friction
    integer :: b, c

    call random%seed(5)
    is_ball = kind <= ball_frictional
    has_friction = kind == ball_frictional .or. kind == solid_frictional
    call begin_space_scene(scene, n, merge(0.4_wp, 0.0_wp, has_friction), 0.1_wp)
    scene%period = period(1)
    scene%period_y = period(2)
    do b = 1, n - 3
      place = [random%uniform(0.0_wp, side), random%uniform(0.0_wp, side), random%uniform(0.0_wp, side)]
      r = random%uniform(0.35_wp, 0.7_wp)
      select case (merge(0, modulo(b, 4), is_ball))
      case (0)
        call put_sphere(scene, b, r, place)
      case (1)
        call put_box(scene, b, r*[0.5_wp, 0.8_wp, 0.9_wp], place)
      case (2)
        call put_capsule(scene, b, r, 0.6_wp*r, place)
      case (3)
        call put_dumbbell(scene, b, 0.7_wp*r, 0.5_wp*r, place)
      end select
      call turn_at_random(scene, b, random)
      do c = 1, merge(3, 6, kind == ball_frictionless)
        scene%bodies%velocity(c, b) = random%uniform(-1.0_wp, 1.0_wp)
      end do
      scene%bodies%inverse_mass(:, b) = scene%bodies%inverse_mass(:, b)*1000
      scene%bodies%mass(b) = scene%bodies%mass(b)/1000
      scene%bodies%principal(:, b) = scene%bodies%principal(:, b)/1000
    end do
    call put_plane(scene, n - 2, [10.0_wp, 10.0_wp, 0.2_wp], [side/2, side/2, 0.0_wp])
    call put_plane(scene, n - 1, [1.0_wp, 1.0_wp, 0.2_wp], [side/2, side/2, side/2], [0.8_wp, 0.6_wp, 0.0_wp, 0.0_wp])
    call put_sphere(scene, n, 1.0_wp, [side/3, side/3, side/2])
    call drive_some(scene, kind, n)
    scene%laws(1)%kind = law
    scene%laws(1)%normal_restitution = 0.5_wp
    scene%laws(1)%tangential_restitution = merge(0.3_wp, 0.0_wp, has_friction)
    scene%laws(1)%stiffness = 1e4_wp
    scene%laws(1)%epsilon = 0.7_wp
  end subroutine random_space_scene

  !> Partly driven bodies: those of ball problems do not turn, or turn as they are told.
  subroutine drive_some(scene, kind, n)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: kind, n
    integer :: b, c, balls(4)

    call drive(scene, 1, 1, time_function_t(constant=0.3_wp))
    call drive(scene, 2, 2, time_function_t(constant=-0.4_wp))
    call drive(scene, 2, 3, time_function_t(constant=0.1_wp))
    do c = 1, 3
      call drive(scene, 4, c, time_function_t(constant=0.2_wp*real(c, wp)))
    end do
    if (kind <= ball_frictional) then
      balls = [1, 2, 4, n]
      do b = 1, 4
        scene%bodies%velocity(4:6, balls(b)) = 0
        do c = 4, 6
          call drive(scene, balls(b), c, time_function_t(constant=merge(0.3_wp*real(c, wp), 0.0_wp, kind == ball_frictional)))
        end do
      end do
    else
      call drive(scene, 3, 5, time_function_t(constant=-1.0_wp))
      call drive(scene, 5, 4, time_function_t(constant=1.0_wp))
      call drive(scene, 5, 6, time_function_t())
      do c = 4, 6
        call drive(scene, n, c, time_function_t(constant=2.0_wp))
      end do
    end if
  end subroutine drive_some

  !> Mass, centre and principal frame of a body whose only contactor was the last one added.
  subroutine finish_body(scene, body)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body

    call make_solid_body(scene%bodies, scene%contactors, body, scene%contactors%n, scene%contactors%n, density)
    scene%bodies%inverse_mass(1:3, body) = 1/scene%bodies%mass(body)
    scene%bodies%inverse_mass(4:6, body) = 1/scene%bodies%principal(:, body)
  end subroutine finish_body

  !> Mean force of all contacts on a body over the last step [N].
  pure function force_in_space(sim, body) result(force)
    type(simulation_t), intent(in) :: sim !! simulation after a step
    integer, intent(in) :: body !! index of the body
    real(wp) :: force(3)
    integer :: k

    force = 0
    do k = 1, sim%contacts%n
      if (sim%contacts%body(1, k) == body) force = force + impulse_vector(sim%contacts, k)/sim%options%time_step
      if (sim%contacts%body(2, k) == body) force = force - impulse_vector(sim%contacts, k)/sim%options%time_step
    end do
  end function force_in_space
end module scenes_space
