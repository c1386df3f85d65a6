!> Small scenes for tests, body by body: density 1000, one law, everything sees everything.
module scenes
  use sg_advance, only: advance
  use sg_contactors, only: add_disk, add_polygon, add_segment, place_contactors
  use sg_drives, only: drive_t
  use sg_error, only: error_t
  use sg_kinds, only: wp, pi
  use sg_moments, only: polygon_moments
  use sg_run_options, only: criterion_e8
  use sg_scene, only: colour_index, scene_t
  use sg_simulation, only: simulation_t, start_simulation
  use sg_time_functions, only: time_function_t
  implicit none
  private
  public :: begin_scene, put_disk, put_polygon, put_wall, drive, hold, place_bodies, begin_run, run, force_on

  !> Mass per area and metre of depth of all bodies [kg/m3]
  real(wp), parameter, public :: density = 1000
  !> Gravity of most tests [m/s2]
  real(wp), parameter, public :: g = 9.81_wp

contains

  !> A scene of `n` bodies without shapes, one inelastic law with friction, gravity downwards: along -y, in space along -z.
  subroutine begin_scene(scene, n, friction, alert, dimension)
    type(scene_t), intent(out) :: scene !! the scene
    integer, intent(in) :: n !! number of bodies
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(in) :: alert !! gap from which a contact is none [m]
    integer, intent(in), optional :: dimension !! 2 unless given
    integer :: colour

    if (present(dimension)) scene%dimension = dimension
    scene%contactors%dimension = scene%dimension
    call scene%bodies%allocate(n, scene%dimension)
    call colour_index(scene, 'any', colour)
    allocate (scene%laws(1), scene%sees(1), scene%drives(0), scene%pressures(0))
    scene%laws(1)%name = 'law'
    scene%laws(1)%static_friction = friction
    scene%laws(1)%dynamic_friction = friction
    scene%sees(1)%law = 1
    scene%sees(1)%alert = alert
    scene%gravity(scene%dimension) = -g
  end subroutine begin_scene

  !> Make a body a disk.
  subroutine put_disk(scene, body, radius, position)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    real(wp), intent(in) :: radius !! [m]
    real(wp), intent(in) :: position(2) !! centre [m]

    call add_disk(scene%contactors, body, 1, radius, [0.0_wp, 0.0_wp])
    scene%bodies%position(:, body) = position
    call set_mass(scene, body, pi*radius**2, pi*radius**4/2)
  end subroutine put_disk

  !> Make a body a convex polygon; its frame is put at the centre of its area.
  subroutine put_polygon(scene, body, vertices)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    real(wp), intent(in) :: vertices(:, :) !! where they are [m], counter-clockwise, shape (2, vertices)
    real(wp) :: about_centre(2, size(vertices, 2)), area, centre(2), moment

    call polygon_moments(vertices, area, centre, moment)
    about_centre = vertices - spread(centre, 2, size(vertices, 2))
    call add_polygon(scene%contactors, body, 1, about_centre, [0.0_wp, 0.0_wp])
    scene%bodies%position(:, body) = centre
    call set_mass(scene, body, area, moment)
  end subroutine put_polygon

  !> Make a body a rounded segment that does not move.
  subroutine put_wall(scene, body, half_length, half_thickness, position, angle)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    real(wp), intent(in) :: half_length !! of the axis [m]
    real(wp), intent(in) :: half_thickness !! radius of the caps [m]
    real(wp), intent(in) :: position(2) !! centre [m]
    real(wp), intent(in) :: angle !! of the axis [rad]

    call add_segment(scene%contactors, body, 1, half_length, half_thickness, [0.0_wp, 0.0_wp], angle)
    scene%bodies%position(:, body) = position
    call set_mass(scene, body, 1.0_wp, 1.0_wp)
    call hold(scene, body)
  end subroutine put_wall

  !> Mass and inertia of a body from area [m2] and moment of area [m4].
  subroutine set_mass(scene, body, area, moment)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body
    real(wp), intent(in) :: area, moment

    associate (b => scene%bodies)
      b%area(body) = area
      b%mass(body) = density*area
      b%inertia(body) = density*moment
      b%inverse_mass(:, body) = [1/b%mass(body), 1/b%mass(body), 1/b%inertia(body)]
    end associate
  end subroutine set_mass

  !> Impose a velocity on one component of a body; it is a wall from then on.
  subroutine drive(scene, body, component, velocity)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    integer, intent(in) :: component !! 1 x, 2 y, 3 rotation; in space 1 to 3 along x, y, z, 4 to 6 spin
    type(time_function_t), intent(in) :: velocity !! imposed velocity [m/s, rad/s]
    type(drive_t), allocatable :: longer(:)
    integer :: n

    n = size(scene%drives)
    allocate (longer(n + 1))
    longer(:n) = scene%drives
    longer(n + 1)%body = body
    longer(n + 1)%component = component
    longer(n + 1)%value = velocity
    call move_alloc(longer, scene%drives)
    scene%bodies%is_grain(body) = .false.
  end subroutine drive

  !> Hold a body where it is.
  subroutine hold(scene, body)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! index of the body
    integer :: component

    do component = 1, scene%bodies%n_velocity
      call drive(scene, body, component, time_function_t())
    end do
  end subroutine hold

  !> Bring a scene to its detection configuration, which is that of the beginning.
  subroutine place_bodies(scene)
    type(scene_t), intent(inout) :: scene !! scene to place

    associate (bodies => scene%bodies)
      bodies%middle(:bodies%dimension, :) = bodies%position
      if (allocated(bodies%angle)) bodies%middle(3, :) = bodies%angle
      if (allocated(bodies%orientation)) bodies%middle(4:7, :) = bodies%orientation
    end associate
    call place_contactors(scene%contactors, scene%bodies%middle)
  end subroutine place_bodies

  !> Start a simulation whose scene is set; the solver stops at an e8 of `tolerance`, tested every sweep.
  subroutine begin_run(sim, step, tolerance, maximum_sweeps)
    type(simulation_t), intent(inout) :: sim !! its scene is set
    real(wp), intent(in) :: step !! time step [s]
    real(wp), intent(in) :: tolerance !! of the criterion e8
    integer, intent(in), optional :: maximum_sweeps !! where sweeps may stall, since bodies share loads in many ways

    sim%options%time_step = step
    sim%options%solver%criterion = criterion_e8
    sim%options%solver%tolerance = tolerance
    sim%options%solver%check_every = 1
    sim%options%solver%maximum_sweeps = 100000
    if (present(maximum_sweeps)) sim%options%solver%maximum_sweeps = maximum_sweeps
    call start_simulation(sim)
  end subroutine begin_run

  !> Make steps; a value that is not finite ends the test.
  subroutine run(sim, steps)
    type(simulation_t), intent(inout) :: sim !! started simulation
    integer, intent(in) :: steps !! steps to make
    type(error_t), allocatable :: error
    integer :: i

    do i = 1, steps
      call advance(sim, error)
      if (.not. allocated(error)) cycle
      write (*, '(a)') error%message
      error stop 1
    end do
  end subroutine run

  !> Mean force of all contacts on a body over the last step [N].
  pure function force_on(sim, body) result(force)
    type(simulation_t), intent(in) :: sim !! simulation after a step
    integer, intent(in) :: body !! index of the body
    real(wp) :: force(2), n(2), p(2)
    integer :: k

    force = 0
    do k = 1, sim%contacts%n
      if (all(sim%contacts%body(:, k) /= body)) cycle
      n = sim%contacts%normal(:, k)
      p = sim%contacts%impulse(1, k)*n
      if (sim%contacts%n_components == 2) p = p + sim%contacts%impulse(2, k)*[n(2), -n(1)]
      force = force + merge(p, -p, sim%contacts%body(1, k) == body)/sim%options%time_step
    end do
  end function force_on
end module scenes
