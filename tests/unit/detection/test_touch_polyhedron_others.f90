!> Contacts of convex polyhedra with planes and with spheres, against dense references.
program test_touch_polyhedron_others
  use harness, only: tests_t
  use random_space, only: random_direction, random_frame
  use sg_kinds, only: wp
  use sg_polyhedron, only: place_polyhedron, polyhedron_t
  use sg_random, only: random_t
  use sg_touch_polyhedron_plane, only: touch_polyhedron_plane
  use sg_touch_polyhedron_polyhedron, only: touch_polyhedron_polyhedron
  use sg_touch_space, only: touch_space_t
  use sg_touch_sphere_polyhedron, only: touch_sphere_polyhedron
  use space_reference, only: height_above, point_distance, separation_along, signed_distance
  use space_shapes, only: box_shape, random_shape
  implicit none
  type(tests_t) :: t
  real(wp), parameter :: zero(3) = 0
  real(wp), parameter :: unit(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
  ! As in the tests of polyhedra: some tens of thousands of units in the last place of the sizes.
  real(wp), parameter :: tight = 1e-11_wp

  call test_planes()
  call test_cube_on_plane()
  call test_plane_from_below()
  call test_spheres()
  call test_sphere_regions()
  call test_sphere_sweep()
  call t%finish()

contains

  !> Random polyhedra over, at the border of, and through planes: the plane is the box that it is.
  subroutine test_planes()
    type(random_t) :: random
    type(polyhedron_t) :: c, box
    type(touch_space_t) :: touch, general
    real(wp) :: half(3), frame(3, 3), centre(3), alert, low, gap, distance, tolerance, nearest
    integer :: i, j, over, hanging

    call random%seed(21)
    over = 0
    hanging = 0
    do i = 1, 6000
      c = random_shape(random)
      half = [random%uniform(1.0_wp, 6.0_wp), random%uniform(1.0_wp, 6.0_wp), 10**random%uniform(-3.0_wp, 0.0_wp)]
      frame = random_frame(random)
      centre = random_direction(random)
      call place_polyhedron(c, zero, random_frame(random))
      alert = 0.1_wp*c%reach
      low = minval(matmul(frame(:, 3), c%world_vertex))
      gap = random%uniform(-2.0_wp, 1.1_wp)*alert
      centre = (low - gap - half(3))*frame(:, 3) + half(1)*random%uniform(-1.0_wp, 1.0_wp)*frame(:, 1) &
               + half(2)*random%uniform(-1.0_wp, 1.0_wp)*frame(:, 2)
      box = box_shape(half)
      call place_polyhedron(box, centre, frame)
      call touch_polyhedron_plane(c, centre, frame, half, alert, touch)
      call touch_polyhedron_polyhedron(c, box, zero, alert, general)
      distance = signed_distance(c, box, zero)
      tolerance = tight*(c%reach + box%reach)
      call t%equal(touch%n, general%n, 'plane and box: points')
      if (touch%n == 0) then
        call t%check(distance >= alert - tolerance, 'plane: missed')
        cycle
      end if
      call t%near(minval(touch%gap(:touch%n)), distance, tolerance, 'plane: gap')
      call t%near(separation_along(c, box, zero, touch%normal(:, 1)), distance, tolerance, 'plane: normal')
      do j = 1, min(touch%n, general%n)
        nearest = minval(norm2(general%point(:, :general%n) - spread(touch%point(:, j), 2, general%n), 1))
        call t%near(nearest, 0.0_wp, tolerance, 'plane and box: point')
        ! Corners of the candidate have their numbers; those of the box are numbered otherwise here.
        if (touch%feature(j) <= c%n_vertices) call t%check(any(general%feature(:general%n) == touch%feature(j)), 'plane: feature')
      end do
      if (norm2(touch%normal(:, 1) - frame(:, 3)) <= 0) over = over + 1
      if (abs(distance - gap) > tolerance) hanging = hanging + 1
    end do
    call t%check(over > 1000 .and. hanging > 200, 'over the face and at its border')
  end subroutine test_planes

  !> A cube that rests on a plane has its four corners.
  subroutine test_cube_on_plane()
    type(polyhedron_t) :: cube
    type(touch_space_t) :: touch

    cube = box_shape(spread(1.0_wp, 1, 3))
    call place_polyhedron(cube, [3.0_wp, -2.0_wp, 1.099_wp], unit)
    call touch_polyhedron_plane(cube, zero, unit, [10.0_wp, 10.0_wp, 0.1_wp], 0.01_wp, touch)
    call t%equal(touch%n, 4, 'cube on plane: points')
    call t%near(maxval(abs(touch%gap + 0.001_wp)), 0.0_wp, 1e-14_wp, 'cube on plane: gaps')
    call t%near(minval(touch%point(1, :)), 2.0_wp, 1e-14_wp, 'cube on plane: left')
    call t%near(maxval(touch%point(2, :)), -1.0_wp, 1e-14_wp, 'cube on plane: rear')
    call t%near(touch%point(3, 1), 0.0995_wp, 1e-14_wp, 'cube on plane: half-way between the surfaces')
    call t%near(touch%normal(3, 1), 1.0_wp, 1e-14_wp, 'cube on plane: normal')
    ! Half over the border: the corners beyond are those of the plane's edge.
    call place_polyhedron(cube, [10.0_wp, 0.0_wp, 1.099_wp], unit)
    call touch_polyhedron_plane(cube, zero, unit, [10.0_wp, 10.0_wp, 0.1_wp], 0.01_wp, touch)
    call t%equal(touch%n, 4, 'cube over the border: points')
    call t%near(maxval(touch%point(1, :)), 10.0_wp, 1e-13_wp, 'cube over the border: the edge')
  end subroutine test_cube_on_plane

  !> Below the plane, the normal points down; in its middle, the shorter way is taken.
  subroutine test_plane_from_below()
    type(polyhedron_t) :: cube
    type(touch_space_t) :: touch

    cube = box_shape(spread(1.0_wp, 1, 3))
    call place_polyhedron(cube, [0.0_wp, 0.0_wp, -1.105_wp], unit)
    call touch_polyhedron_plane(cube, zero, unit, [10.0_wp, 10.0_wp, 0.1_wp], 0.01_wp, touch)
    call t%equal(touch%n, 4, 'cube below plane: points')
    call t%near(touch%gap(1), 0.005_wp, 1e-14_wp, 'cube below plane: gap')
    call t%near(touch%normal(3, 1), -1.0_wp, 1e-14_wp, 'cube below plane: normal')
    call place_polyhedron(cube, [0.0_wp, 0.0_wp, 0.3_wp], unit)
    call touch_polyhedron_plane(cube, zero, unit, [10.0_wp, 10.0_wp, 0.1_wp], 0.01_wp, touch)
    call t%near(minval(touch%gap(:touch%n)), -0.8_wp, 1e-14_wp, 'cube through plane: gap')
  end subroutine test_plane_from_below

  !> Spheres near, at and in random polyhedra.
  subroutine test_spheres()
    type(random_t) :: random
    type(polyhedron_t) :: a
    type(touch_space_t) :: touch
    real(wp) :: centre(3), offset(3), radius, alert, distance, tolerance, half(3)
    integer :: i, outside, inside

    call random%seed(22)
    outside = 0
    inside = 0
    do i = 1, 8000
      a = random_shape(random)
      call place_polyhedron(a, random_direction(random), random_frame(random))
      offset = 10*random_direction(random)
      radius = 10**random%uniform(-3.0_wp, 1.0_wp)
      alert = 0.2_wp*min(radius, a%reach)
      centre = a%centre + offset + random%uniform(0.0_wp, 1.1_wp)*(a%reach + radius + alert)*random_direction(random)
      ! Some centres on vertices and in the middle of faces.
      if (modulo(i, 20) == 0) centre = a%world_vertex(:, 1) + offset
      if (modulo(i, 20) == 1) centre = (a%world_vertex(:, 1) + a%world_vertex(:, 2))/2 + offset
      distance = height_above(centre - offset, a)
      ! On the surface to rounding, the height is the distance.
      if (distance > 1e-13_wp) distance = point_distance(centre - offset, a)
      call touch_sphere_polyhedron(centre, radius, a, offset, alert, touch)
      tolerance = tight*(a%reach + radius)
      if (touch%n == 0) then
        call t%check(distance - radius >= alert - tolerance, 'sphere: missed')
        cycle
      end if
      call t%near(touch%gap(1), distance - radius, tolerance, 'sphere: gap')
      call t%near(norm2(touch%normal(:, 1)), 1.0_wp, 1e-14_wp, 'sphere: unit normal')
      half = 0.5_wp*touch%gap(1)*touch%normal(:, 1)
      call t%near(norm2(touch%point(:, 1) + half - centre), radius, tolerance, 'sphere: on the sphere')
      call t%near(height_above(touch%point(:, 1) - half - offset, a), 0.0_wp, tolerance, 'sphere: on the polyhedron')
      if (distance > 0) outside = outside + 1
      if (distance <= 0) inside = inside + 1
    end do
    call t%check(outside > 1000 .and. inside > 300, 'centres outside and inside')
  end subroutine test_spheres

  !> By a face, an edge, a vertex, and from the inside.
  subroutine test_sphere_regions()
    type(polyhedron_t) :: cube

    cube = box_shape(spread(1.0_wp, 1, 3))
    call place_polyhedron(cube, zero, unit)
    call check_sphere(cube, [0.2_wp, 0.3_wp, 1.5_wp], [0.0_wp, 0.0_wp, 1.0_wp], 0.5_wp, 'face')
    call check_sphere(cube, [1.3_wp, 0.3_wp, 1.4_wp], [0.6_wp, 0.0_wp, 0.8_wp], 0.5_wp, 'edge')
    call check_sphere(cube, [1.2_wp, 1.3_wp, 1.6_wp], [2.0_wp, 3.0_wp, 6.0_wp]/7, 0.7_wp, 'vertex')
    call check_sphere(cube, [0.2_wp, -0.9_wp, 0.1_wp], [0.0_wp, -1.0_wp, 0.0_wp], -0.1_wp, 'inside')
  end subroutine test_sphere_regions

  !> Check normal and gap of a sphere of radius 0.6.
  subroutine check_sphere(cube, centre, normal, distance, what)
    type(polyhedron_t), intent(in) :: cube
    real(wp), intent(in) :: centre(3), normal(3), distance
    character(len=*), intent(in) :: what
    type(touch_space_t) :: touch

    call touch_sphere_polyhedron(centre, 0.6_wp, cube, zero, 0.2_wp, touch)
    call t%equal(touch%n, 1, 'sphere by '//what//': points')
    call t%near(norm2(touch%normal(:, 1) - normal), 0.0_wp, 1e-14_wp, 'sphere by '//what//': normal')
    call t%near(touch%gap(1), distance - 0.6_wp, 1e-14_wp, 'sphere by '//what//': gap')
  end subroutine check_sphere

  !> A sphere that moves by a step changes its gap by no more, inside and outside.
  subroutine test_sphere_sweep()
    type(random_t) :: random
    type(polyhedron_t) :: a
    type(touch_space_t) :: touch
    real(wp) :: start(3), way(3), last, step
    integer :: i, k

    call random%seed(23)
    do i = 1, 200
      a = random_shape(random)
      call place_polyhedron(a, zero, random_frame(random))
      start = 0.3_wp*random_direction(random)
      way = random_direction(random)
      step = 0.01_wp
      last = huge(last)
      do k = 1, 150
        call touch_sphere_polyhedron(start + step*real(k, wp)*way, 0.5_wp, a, zero, 10.0_wp, touch)
        call t%equal(touch%n, 1, 'sweep of a sphere: points')
        if (k > 1) call t%check(abs(touch%gap(1) - last) <= step + tight, 'sweep of a sphere: the gap jumps')
        last = touch%gap(1)
      end do
    end do
  end subroutine test_sphere_sweep
end program test_touch_polyhedron_others
