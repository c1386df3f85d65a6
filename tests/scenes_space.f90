!> Small scenes in space for tests, body by body: density 1000, one law, everything sees everything.
module scenes_space
  use scenes, only: density, drive, g
  use sg_contacts, only: impulse_vector
  use sg_kinds, only: wp
  use sg_error, only: error_t
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: box_polyhedron
  use sg_rotations, only: frame_of, no_rotation
  use sg_scene, only: colour_index, scene_t
  use sg_simulation, only: simulation_t
  use sg_solid_bodies, only: make_solid_body
  use sg_space_contactors, only: add_plane, add_polyhedron, add_sphere
  use sg_time_functions, only: time_function_t
  implicit none
  private
  public :: begin_space_scene, put_sphere, put_plane, put_box, put_shape, hold_in_space, force_in_space

contains

  !> A scene of `n` bodies without shapes, one inelastic law with friction, gravity along -z.
  subroutine begin_space_scene(scene, n, friction, alert)
    type(scene_t), intent(out) :: scene !! the scene
    integer, intent(in) :: n !! number of bodies
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(in) :: alert !! gap from which a contact is none [m]
    integer :: colour

    scene%dimension = 3
    scene%contactors%dimension = 3
    call scene%bodies%allocate(n, 3)
    call colour_index(scene, 'any', colour)
    allocate (scene%laws(1), scene%sees(1), scene%drives(0), scene%pressures(0))
    scene%laws(1)%name = 'law'
    scene%laws(1)%static_friction = friction
    scene%laws(1)%dynamic_friction = friction
    scene%sees(1)%law = 1
    scene%sees(1)%alert = alert
    scene%gravity = [0.0_wp, 0.0_wp, -g]
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
    call hold_in_space(scene, body)
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

  !> Mass, centre and principal frame of a body whose only contactor was the last one added.
  subroutine finish_body(scene, body)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body

    call make_solid_body(scene%bodies, scene%contactors, body, scene%contactors%n, scene%contactors%n, density)
    scene%bodies%inverse_mass(1:3, body) = 1/scene%bodies%mass(body)
    scene%bodies%inverse_mass(4:6, body) = 1/scene%bodies%principal(:, body)
  end subroutine finish_body

  !> Hold a body where it is.
  subroutine hold_in_space(scene, body)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    integer :: component

    do component = 1, 6
      call drive(scene, body, component, time_function_t())
    end do
  end subroutine hold_in_space

  !> Mean force of all contacts on a body over the last step [N].
  pure function force_in_space(sim, body) result(force)
    type(simulation_t), intent(in) :: sim !! simulation after a step
    integer, intent(in) :: body !! index of the body
    real(wp) :: force(3)
    integer :: k

    force = 0
    do k = 1, sim%contacts%n
      if (sim%contacts%body(1, k) == body) force = force + impulse_vector(sim%contacts, k)/sim%options%step
      if (sim%contacts%body(2, k) == body) force = force - impulse_vector(sim%contacts, k)/sim%options%step
    end do
  end function force_in_space
end module scenes_space
