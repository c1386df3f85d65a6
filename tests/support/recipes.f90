!> Scenes as recipes: bodies by shape, place and motion in any axes, which can be moved, turned, mirrored, measured in other units
!! and reordered before they are built.
module recipes
  use polyhedra, only: prism_polyhedron
  use scenes, only: begin_run, begin_scene, density, hold
  use scenes_space, only: begin_space_scene, put_box, put_capsule, put_dumbbell, put_plane, put_shape, put_sphere
  use sg_contactors, only: add_disk, add_polygon, add_segment
  use sg_error, only: error_t
  use sg_kinds, only: wp, pi
  use sg_laws, only: law_t
  use sg_moments, only: polygon_moments
  use sg_polyhedron, only: polyhedron_t
  use sg_random, only: random_t
  use sg_rotations, only: frame_of, no_rotation, normalised, quaternion_of, quaternion_product
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  implicit none
  private
  public :: recipe_t, body_recipe_t, map_t, random_recipe, turned_at_random, mapped, in_space, build, end_state
  public :: shape_disk, shape_segment, shape_polygon, shape_pair, shape_sphere, shape_box, shape_prism, shape_capsule
  public :: shape_dumbbell, shape_plane, shape_slab

  !> Shapes: of the plane disk, rounded segment, polygon, two disks; of space sphere, box, prism of five sides, cylinder with round
  !! ends, two spheres, plane, and a floor as the one shape or the other of two (segment and polygon, plane and box)
  integer, parameter :: shape_disk = 1, shape_segment = 2, shape_polygon = 3, shape_pair = 4, shape_sphere = 5, shape_box = 6, &
                        shape_prism = 7, shape_capsule = 8, shape_dumbbell = 9, shape_plane = 10, shape_slab = 11

  !> A body
  type :: body_recipe_t
    integer :: shape = shape_disk
    !> Sizes [m], by shape: radius; half length and half thickness; scale; half sides
    real(wp) :: size(3) = 0
    !> Vertices of a polygon about its centre in its frame [m]
    real(wp), allocatable :: vertex(:, :)
    !> Centre [m], axes as columns, velocity [m/s], angular velocity [rad/s], all in the world
    real(wp) :: position(3) = 0, frame(3, 3) = 0, velocity(3) = 0, spin(3) = 0
    logical :: is_fixed = .false.
    !> Mass and moment of inertia about all axes in place of those of the shape [kg, kg m2]; zero for these
    real(wp) :: mass = 0, inertia = 0
  end type body_recipe_t

  !> A scene
  type :: recipe_t
    integer :: dimension = 2
    type(body_recipe_t), allocatable :: bodies(:)
    type(law_t) :: law
    real(wp) :: gravity(3) = 0, step = 0, alert = 0
    !> Over the density of tests
    real(wp) :: density_factor = 1
  end type recipe_t

  !> Turn by an orthogonal matrix, which may mirror, then scale and shift; factors of length, time and mass
  type :: map_t
    real(wp) :: turn(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
    real(wp) :: shift(3) = 0, length = 1, time = 1, mass = 1
  end type map_t

  !> Mirror of a body's own frame: all shapes but polygons are the same in it
  real(wp), parameter :: mirror(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

contains

  !> A few bodies above a floor, which meet it and each other within some dozens of steps of 5 ms.
  function random_recipe(random, dimension, shapes) result(recipe)
    type(random_t), intent(inout) :: random !! stream of random numbers
    integer, intent(in) :: dimension !! of space
    integer, intent(in) :: shapes(:) !! shapes to choose from; with segments the floor is a polygon
    type(recipe_t) :: recipe !! the scene
    integer, parameter :: n = 5
    integer :: b, i, up
    real(wp) :: radius

    recipe%dimension = dimension
    up = dimension
    recipe%gravity(up) = -10
    recipe%step = 5e-3_wp
    recipe%alert = 0.05_wp
    allocate (recipe%bodies(n + 1))
    do b = 1, n
      associate (body => recipe%bodies(b))
        body%shape = shapes(1 + int(random%uniform()*real(size(shapes), wp)))
        radius = random%uniform(0.4_wp, 0.48_wp)
        body%size = radius
        body%position(1) = real(modulo(b, 3), wp) + random%uniform(-0.02_wp, 0.02_wp)
        if (dimension == 3) body%position(2) = random%uniform(-0.02_wp, 0.02_wp)
        body%position(up) = merge(0.52_wp, 1.55_wp, b < 4)
        body%velocity(:dimension) = [(random%uniform(-0.3_wp, 0.3_wp), i=1, dimension)]
        body%velocity(up) = body%velocity(up) - 0.5_wp
        body%spin = [(random%uniform(-1.0_wp, 1.0_wp), i=1, 3)]
        if (dimension == 2) body%spin(1:2) = 0
        body%frame = frame_at_random(random, dimension)
        if (body%shape == shape_polygon) call draw_polygon(random, radius, body%vertex)
      end associate
    end do
    associate (floor => recipe%bodies(n + 1))
      floor%is_fixed = .true.
      floor%frame = frame_of(no_rotation)
      floor%shape = merge(shape_segment, shape_plane, dimension == 2)
      if (any(shapes == shape_segment)) floor%shape = shape_slab
      floor%size = [6.0_wp, 6.0_wp, 0.2_wp]
      floor%position(up) = -0.2_wp
      floor%position(1) = 1
    end associate
  end function random_recipe

  !> Axes at random; in the plane about the third.
  function frame_at_random(random, dimension) result(frame)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: dimension
    real(wp) :: frame(3, 3), q(4)
    integer :: i

    q = [(random%normal(), i=1, 4)]
    if (dimension == 2) q(2:3) = 0
    frame = frame_of(normalised(q))
  end function frame_at_random

  !> A convex polygon about its centre.
  subroutine draw_polygon(random, radius, vertex)
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: radius
    real(wp), allocatable, intent(out) :: vertex(:, :)
    real(wp) :: angle, area, centre(2), moment
    integer :: i, n

    n = 3 + int(4*random%uniform())
    allocate (vertex(2, n))
    do i = 1, n
      angle = 2*pi*(real(i, wp) + random%uniform(-0.3_wp, 0.3_wp))/real(n, wp)
      vertex(:, i) = radius*[cos(angle), sin(angle)]
    end do
    call polygon_moments(vertex, area, centre, moment)
    vertex = 0.9_wp*(vertex - spread(centre, 2, n))
  end subroutine draw_polygon

  !> A rotation at random, about the third axis in the plane.
  function turned_at_random(random, dimension) result(map)
    type(random_t), intent(inout) :: random !! stream of random numbers
    integer, intent(in) :: dimension !! of space
    type(map_t) :: map

    map%turn = frame_at_random(random, dimension)
  end function turned_at_random

  !> The same scene, moved and measured otherwise.
  function mapped(recipe, map) result(other)
    type(recipe_t), intent(in) :: recipe !! a scene
    type(map_t), intent(in) :: map !! what is done to it
    type(recipe_t) :: other
    real(wp) :: handed
    integer :: b

    other = recipe
    handed = sign(1.0_wp, determinant(map%turn))
    other%gravity = matmul(map%turn, recipe%gravity)*map%length/map%time**2
    other%step = recipe%step*map%time
    other%alert = recipe%alert*map%length
    other%density_factor = recipe%density_factor*map%mass/map%length**recipe%dimension
    do b = 1, size(recipe%bodies)
      associate (body => recipe%bodies(b), image => other%bodies(b))
        image%size = body%size*map%length
        image%position = map%length*matmul(map%turn, body%position) + map%shift
        image%velocity = matmul(map%turn, body%velocity)*map%length/map%time
        image%spin = handed*matmul(map%turn, body%spin)/map%time
        image%frame = matmul(map%turn, body%frame)
        image%mass = body%mass*map%mass
        image%inertia = body%inertia*map%mass*map%length**2
        if (allocated(body%vertex)) image%vertex = body%vertex*map%length
        if (handed > 0) cycle
        image%frame = matmul(image%frame, mirror)
        if (allocated(body%vertex)) then
          image%vertex(2, :) = -image%vertex(2, :)
          image%vertex = image%vertex(:, size(image%vertex, 2):1:-1)
        end if
      end associate
    end do
  end function mapped

  !> Determinant of a matrix.
  pure real(wp) function determinant(a)
    real(wp), intent(in) :: a(3, 3)

    determinant = a(1, 1)*(a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)) - a(1, 2)*(a(2, 1)*a(3, 3) - a(2, 3)*a(3, 1)) &
                  + a(1, 3)*(a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1))
  end function determinant

  !> A scene of disks in the plane as spheres in the plane of x and z, with the masses and moments that the disks have.
  function in_space(recipe) result(other)
    type(recipe_t), intent(in) :: recipe !! scene of disks over a floor
    type(recipe_t) :: other
    integer :: b
    real(wp) :: upright(3, 3)

    upright = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, -1.0_wp, 0.0_wp], [3, 3])
    other = mapped(recipe, map_t(turn=upright))
    other%dimension = 3
    do b = 1, size(recipe%bodies)
      associate (body => other%bodies(b), radius => recipe%bodies(b)%size(1))
        body%shape = merge(shape_plane, shape_sphere, body%is_fixed)
        if (body%is_fixed) body%frame = frame_of(no_rotation)
        body%mass = density*recipe%density_factor*pi*radius**2
        body%inertia = body%mass*radius**2/2
      end associate
    end do
  end function in_space

  !> Make a simulation of a recipe, ready to run.
  subroutine build(recipe, tolerance, sim)
    type(recipe_t), intent(in) :: recipe !! the scene
    real(wp), intent(in) :: tolerance !! of the criterion e8
    type(simulation_t), intent(inout) :: sim !! options may be set
    integer :: b, n

    n = recipe%dimension
    if (n == 2) call begin_scene(sim%scene, size(recipe%bodies), 0.0_wp, recipe%alert)
    if (n == 3) call begin_space_scene(sim%scene, size(recipe%bodies), 0.0_wp, recipe%alert)
    sim%scene%laws(1) = recipe%law
    sim%scene%laws(1)%name = 'law'
    sim%scene%gravity = 0
    sim%scene%gravity(:n) = recipe%gravity(:n)
    do b = 1, size(recipe%bodies)
      if (n == 2) call put_planar(sim%scene, b, recipe%bodies(b))
      if (n == 3) call put_spatial(sim%scene, b, recipe%bodies(b))
      call weigh(sim%scene, b, recipe%bodies(b), recipe%density_factor)
    end do
    call begin_run(sim, recipe%step, tolerance)
  end subroutine build

  !> Add a body of the plane.
  subroutine put_planar(scene, b, body)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: b
    type(body_recipe_t), intent(in) :: body
    real(wp), parameter :: centre(2) = 0
    real(wp), parameter :: corners(2, 4) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])
    real(wp) :: area, moment, x(2), half(2)

    half = body%size([1, 3])
    select case (body%shape)
    case (shape_disk)
      call add_disk(scene%contactors, b, 1, body%size(1), centre)
      area = pi*body%size(1)**2
      moment = area*body%size(1)**2/2
    case (shape_pair)
      x = [0.4_wp*body%size(1), 0.0_wp]
      call add_disk(scene%contactors, b, 1, 0.6_wp*body%size(1), x)
      call add_disk(scene%contactors, b, 1, 0.6_wp*body%size(1), -x)
      area = 0.72_wp*pi*body%size(1)**2
      moment = area*(0.18_wp + 0.16_wp)*body%size(1)**2
    case (shape_segment)
      if (.not. body%is_fixed) half = [0.7_wp, 0.25_wp]*body%size(1)
      call add_segment(scene%contactors, b, 1, half(1), half(2), centre, 0.0_wp)
      area = 4*half(1)*half(2)
      moment = area*sum(half**2)/3
    case (shape_slab)
      call add_polygon(scene%contactors, b, 1, spread(half, 2, 4)*corners, centre)
      area = 4*half(1)*half(2)
      moment = area*sum(half**2)/3
    case default
      call add_polygon(scene%contactors, b, 1, body%vertex, centre)
      call polygon_moments(body%vertex, area, x, moment)
    end select
    associate (bodies => scene%bodies)
      bodies%position(:, b) = body%position(:2)
      bodies%angle(b) = atan2(body%frame(2, 1), body%frame(1, 1))
      bodies%velocity(:, b) = [body%velocity(:2), body%spin(3)]
      bodies%area(b) = area
      bodies%mass(b) = density*area
      bodies%inertia(b) = density*moment
    end associate
  end subroutine put_planar

  !> Add a body in space.
  subroutine put_spatial(scene, b, body)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: b
    type(body_recipe_t), intent(in) :: body
    type(polyhedron_t) :: prism
    type(error_t), allocatable :: error
    real(wp) :: q(4), frame(3, 3)
    integer :: n_drives

    n_drives = size(scene%drives)
    associate (r => body%size(1), place => body%position)
      select case (body%shape)
      case (shape_sphere)
        call put_sphere(scene, b, r, place)
      case (shape_box)
        call put_box(scene, b, r*[0.45_wp, 0.5_wp, 0.6_wp], place)
      case (shape_slab)
        call put_box(scene, b, body%size, place)
      case (shape_plane)
        call put_plane(scene, b, body%size, place)
        scene%drives = scene%drives(:n_drives)
      case (shape_capsule)
        call put_capsule(scene, b, 0.5_wp*r, 0.4_wp*r, place)
      case (shape_dumbbell)
        call put_dumbbell(scene, b, 0.5_wp*r, 0.4_wp*r, place)
      case default
        call prism_polyhedron(5, 0.8_wp*r, 0.5_wp*r, prism, error)
        if (allocated(error)) error stop 'a prism that is none'
        call put_shape(scene, b, prism, place)
      end select
    end associate
    associate (bodies => scene%bodies)
      q = quaternion_of(body%frame)
      bodies%position(:, b) = body%position + matmul(body%frame, bodies%position(:, b) - body%position)
      bodies%orientation(:, b) = quaternion_product(q, bodies%orientation(:, b))
      frame = frame_of(bodies%orientation(:, b))
      bodies%velocity(:, b) = [body%velocity, matmul(body%spin, frame)]
    end associate
  end subroutine put_spatial

  !> Mass and moments of a body by the recipe's density, or its own.
  subroutine weigh(scene, b, body, factor)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: b
    type(body_recipe_t), intent(in) :: body
    real(wp), intent(in) :: factor
    integer :: n

    n = scene%dimension
    associate (bodies => scene%bodies)
      bodies%mass(b) = bodies%mass(b)*factor
      if (body%mass > 0) bodies%mass(b) = body%mass
      bodies%inverse_mass(:n, b) = 1/bodies%mass(b)
      if (n == 2) then
        bodies%inertia(b) = bodies%inertia(b)*factor
        bodies%inverse_mass(3, b) = 1/bodies%inertia(b)
      else
        bodies%principal(:, b) = bodies%principal(:, b)*factor
        if (body%inertia > 0) bodies%principal(:, b) = body%inertia
        bodies%inverse_mass(4:6, b) = 1/bodies%principal(:, b)
      end if
      bodies%is_grain(b) = .not. body%is_fixed
    end associate
    if (body%is_fixed) call hold(scene, b)
  end subroutine weigh

  !> Positions, velocities and angular velocities at the end, brought back through a map: to compare with those of the scene that it
  !! was applied to. Shape (9, bodies), in order of the recipe [m, m/s, rad/s].
  function end_state(sim, map, place) result(state)
    type(simulation_t), intent(in) :: sim !! simulation after some steps
    type(map_t), intent(in) :: map !! map that its scene came from
    integer, intent(in), optional :: place(:) !! place of each body of the first scene in this one; its own unless given
    real(wp), allocatable :: state(:, :)
    real(wp) :: x(3), v(3), w(3), handed
    integer :: b, k, n

    n = sim%scene%dimension
    handed = sign(1.0_wp, determinant(map%turn))
    k = sim%scene%bodies%n
    if (present(place)) k = size(place)
    allocate (state(9, k))
    do k = 1, size(state, 2)
      b = k
      if (present(place)) b = place(k)
      x = 0
      v = 0
      w = 0
      associate (bodies => sim%scene%bodies)
        x(:n) = bodies%position(:, b)
        v(:n) = bodies%velocity(:n, b)
        if (bodies%n_velocity == 3 .and. n == 2) w(3) = bodies%velocity(3, b)
        if (bodies%n_velocity == 6) w = matmul(frame_of(bodies%orientation(:, b)), bodies%velocity(4:6, b))
      end associate
      state(1:3, k) = matmul(x - map%shift, map%turn)/map%length
      state(4:6, k) = matmul(v, map%turn)*map%time/map%length
      state(7:9, k) = handed*matmul(w, map%turn)*map%time
    end do
  end function end_state
end module recipes
