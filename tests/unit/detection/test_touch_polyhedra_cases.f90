!> Contacts of convex polyhedra in the cases that chance never meets: parallel faces, shared edges and vertices, same places.
program test_touch_polyhedra_cases
  use harness, only: tests_t
  use random_space, only: random_direction, random_frame
  use sg_kinds, only: wp, i4, pi
  use sg_polyhedron, only: place_polyhedron, polyhedron_t
  use sg_random, only: random_t
  use sg_touch_polyhedron_polyhedron, only: touch_polyhedron_polyhedron
  use sg_touch_space, only: touch_space_t
  use sg_vectors, only: cross
  use space_reference, only: separation_along, signed_distance
  use space_shapes, only: box_shape, hull_shape, prism_shape
  implicit none
  type(tests_t) :: t
  real(wp), parameter :: zero(3) = 0
  real(wp), parameter :: unit(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
  ! A hundred units in the last place of coordinates of about 1.
  real(wp), parameter :: tight = 2e-14_wp
  type(polyhedron_t) :: cube

  ! The antagonist of most cases: side 2, centre at the origin, so that its top lies at z = 1.
  cube = box_shape(spread(1.0_wp, 1, 3))
  call place_polyhedron(cube, zero, unit)
  call test_stacks()
  call test_edges()
  call test_vertices()
  call test_same_place()
  call test_nearly_parallel()
  call test_many_corners()
  call test_keys_of_resting_cubes()
  call test_lattice()
  call test_turned_together()
  call t%finish()

contains

  !> A rotation about an axis of the world, cyclic.
  function turned(axis, angle) result(frame)
    integer, intent(in) :: axis
    real(wp), intent(in) :: angle
    real(wp) :: frame(3, 3)
    integer :: j, k

    j = modulo(axis, 3) + 1
    k = modulo(axis + 1, 3) + 1
    frame = unit
    frame(j, j) = cos(angle)
    frame(k, j) = sin(angle)
    frame(j, k) = -sin(angle)
    frame(k, k) = cos(angle)
  end function turned

  !> A shape placed over the cube.
  function touching(shape, centre, frame, alert) result(touch)
    type(polyhedron_t), intent(in) :: shape
    real(wp), intent(in) :: centre(3), frame(3, 3), alert
    type(touch_space_t) :: touch
    type(polyhedron_t) :: placed

    placed = shape
    call place_polyhedron(placed, centre, frame)
    call touch_polyhedron_polyhedron(placed, cube, zero, alert, touch)
  end function touching

  !> Check the number of points, the normal, and that all points have one gap.
  subroutine check_flat(touch, n, normal, gap, what)
    type(touch_space_t), intent(in) :: touch
    integer, intent(in) :: n
    real(wp), intent(in) :: normal(3), gap
    character(len=*), intent(in) :: what
    integer :: i

    call t%equal(touch%n, n, what//': points')
    do i = 1, touch%n
      call t%near(norm2(touch%normal(:, i) - normal), 0.0_wp, tight, what//': normal')
      call t%near(touch%gap(i), gap, tight, what//': gap')
      call t%check(.not. any(touch%feature(:i - 1) == touch%feature(i)) .and. touch%feature(i) > 0, what//': features differ')
    end do
  end subroutine check_flat

  !> Check that a place is among the points.
  subroutine check_point(touch, place, what)
    type(touch_space_t), intent(in) :: touch
    real(wp), intent(in) :: place(3)
    character(len=*), intent(in) :: what
    real(wp) :: nearest
    integer :: i

    nearest = huge(nearest)
    do i = 1, touch%n
      nearest = min(nearest, norm2(touch%point(:, i) - place))
    end do
    call t%near(nearest, 0.0_wp, tight, what//': a point')
  end subroutine check_point

  !> Cubes on a cube: laid exactly, half a side aside, small, turned.
  subroutine test_stacks()
    type(touch_space_t) :: touch
    type(polyhedron_t) :: small
    real(wp) :: gap, side
    real(wp), parameter :: gaps(3) = [0.0_wp, 1e-3_wp, -1e-3_wp], up(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    integer :: i, x, y

    do i = 1, 3
      gap = gaps(i)
      touch = touching(cube, [0.0_wp, 0.0_wp, 2 + gap], unit, 0.01_wp)
      call check_flat(touch, 4, up, gap, 'cube exactly on cube')
      do x = -1, 1, 2
        do y = -1, 1, 2
          call check_point(touch, [real(x, wp), real(y, wp), 1 + 0.5_wp*gap], 'cube exactly on cube')
        end do
      end do
      touch = touching(cube, [1.0_wp, 1.0_wp, 2 + gap], unit, 0.01_wp)
      call check_flat(touch, 4, up, gap, 'cube half aside')
      do x = 0, 1
        do y = 0, 1
          call check_point(touch, [real(x, wp), real(y, wp), 1 + 0.5_wp*gap], 'cube half aside')
        end do
      end do
      small = box_shape(spread(1e-3_wp, 1, 3))
      touch = touching(small, [0.3_wp, 0.2_wp, 1.001_wp + 1e-4_wp*gap], unit, 1e-4_wp)
      call check_flat(touch, 4, up, 1e-4_wp*gap, 'cube a thousand times smaller')
      call check_point(touch, [0.301_wp, 0.199_wp, 1 + 0.5e-4_wp*gap], 'cube a thousand times smaller')
      ! An eighth of a turn: the shared octagon has sides of length 2 tan(pi/8), of which four corners are kept.
      touch = touching(cube, [0.0_wp, 0.0_wp, 2 + gap], turned(3, pi/4), 0.01_wp)
      call check_flat(touch, 4, up, gap, 'cube turned on cube')
      side = 2*tan(pi/8)
      call t%check(kept_area(touch) >= 0.7_wp*(4 - (2 - side)**2/2), 'four corners span most of the octagon')
    end do
    touch = touching(cube, [0.0_wp, 0.0_wp, 2.0101_wp], unit, 0.01_wp)
    call t%equal(touch%n, 0, 'none beyond alert')
  end subroutine test_stacks

  !> Area that four points in a horizontal plane span: half the greatest product of diagonals, in any order.
  real(wp) function kept_area(touch) result(area)
    type(touch_space_t), intent(in) :: touch
    integer, parameter :: other(2, 3) = reshape([3, 4, 2, 4, 2, 3], [2, 3])
    real(wp) :: product(3)
    integer :: i

    area = 0
    do i = 2, 4
      product = cross(touch%point(:, i) - touch%point(:, 1), touch%point(:, other(2, i - 1)) - touch%point(:, other(1, i - 1)))
      area = max(area, 0.5_wp*abs(product(3)))
    end do
  end function kept_area

  !> Edges on faces, edges across edges, edges shared.
  subroutine test_edges()
    type(touch_space_t) :: touch
    real(wp) :: gap, half
    real(wp), parameter :: gaps(3) = [0.0_wp, 1e-3_wp, -1e-3_wp], up(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    type(polyhedron_t) :: ridge
    integer :: i

    half = sqrt(2.0_wp)
    do i = 1, 3
      gap = gaps(i)
      touch = touching(cube, [0.1_wp, 0.5_wp, 1 + half + gap], turned(2, pi/4), 0.01_wp)
      call check_flat(touch, 2, up, gap, 'cube on its edge')
      call check_point(touch, [0.1_wp, 1.0_wp, 1 + 0.5_wp*gap], 'cube on its edge, over the border')
      call check_point(touch, [0.1_wp, -0.5_wp, 1 + 0.5_wp*gap], 'cube on its edge, end of the edge')
      ! Edge across edge: the ridge of a roof along x, an edge of a cube along y.
      ridge = hull_shape(reshape([-3.0_wp, 0.0_wp, 1.0_wp, 3.0_wp, 0.0_wp, 1.0_wp, -3.0_wp, 1.0_wp, 0.0_wp, 3.0_wp, 1.0_wp, &
                                  0.0_wp, -3.0_wp, -1.0_wp, 0.0_wp, 3.0_wp, -1.0_wp, 0.0_wp], [3, 6]))
      call place_polyhedron(ridge, zero, unit)
      touch = touching_two(cube, [0.2_wp, 0.1_wp, 1 + half + gap], turned(2, pi/4), ridge)
      call check_flat(touch, 1, up, gap, 'edge across edge')
      call check_point(touch, [0.2_wp, 0.0_wp, 1 + 0.5_wp*gap], 'edge across edge')
    end do
    ! An edge shared to the last digit: its two ends, gap zero, a normal between the two cubes' axes.
    touch = touching(cube, [2.0_wp, 0.0_wp, 2.0_wp], unit, 0.01_wp)
    call t%equal(touch%n, 2, 'shared edge: points')
    call check_point(touch, [1.0_wp, 1.0_wp, 1.0_wp], 'shared edge')
    call check_point(touch, [1.0_wp, -1.0_wp, 1.0_wp], 'shared edge')
    call t%near(maxval(abs(touch%gap(:2))), 0.0_wp, tight, 'shared edge: gap')
    call t%check(touch%normal(1, 1) >= 0 .and. touch%normal(3, 1) >= 0, 'shared edge: normal')
    ! Parallel edges apart: the ends of what they share, along the true direction.
    touch = touching(cube, [2.003_wp, 0.5_wp, 2.004_wp], unit, 0.01_wp)
    call check_flat(touch, 2, [0.6_wp, 0.0_wp, 0.8_wp], 0.005_wp, 'parallel edges')
    call check_point(touch, [1.0015_wp, 1.0_wp, 1.002_wp], 'parallel edges')
  end subroutine test_edges

  !> Contact of two shapes of which the second is placed.
  function touching_two(shape, centre, frame, other) result(touch)
    type(polyhedron_t), intent(in) :: shape, other
    real(wp), intent(in) :: centre(3), frame(3, 3)
    type(touch_space_t) :: touch
    type(polyhedron_t) :: placed

    placed = shape
    call place_polyhedron(placed, centre, frame)
    call touch_polyhedron_polyhedron(placed, other, zero, 0.01_wp, touch)
  end function touching_two

  !> Vertices on faces, on edges, on vertices.
  subroutine test_vertices()
    type(touch_space_t) :: touch
    type(polyhedron_t) :: tip
    real(wp), parameter :: up(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    real(wp), parameter :: gaps(3) = [0.0_wp, 1e-3_wp, -1e-3_wp]
    integer :: i

    ! A pyramid that stands on its tip, which is at its origin.
    tip = hull_shape(reshape([0.0_wp, 0.0_wp, 0.0_wp, 0.5_wp, 0.0_wp, 1.0_wp, -0.5_wp, 0.3_wp, 1.0_wp, -0.5_wp, -0.3_wp, 1.0_wp], &
                             [3, 4]))
    do i = 1, 3
      touch = touching(tip, [0.3_wp, 0.4_wp, 1 + gaps(i)], unit, 0.01_wp)
      call check_flat(touch, 1, up, gaps(i), 'tip on face')
      call check_point(touch, [0.3_wp, 0.4_wp, 1 + 0.5_wp*gaps(i)], 'tip on face')
    end do
    touch = touching(tip, [1.003_wp, 0.4_wp, 1.004_wp], unit, 0.01_wp)
    call check_flat(touch, 1, [0.6_wp, 0.0_wp, 0.8_wp], 0.005_wp, 'tip by an edge')
    touch = touching(tip, [1.002_wp, 1.003_wp, 1.006_wp], unit, 0.01_wp)
    call check_flat(touch, 1, [2.0_wp, 3.0_wp, 6.0_wp]/7, 0.007_wp, 'tip by a vertex')
    call check_point(touch, [1.001_wp, 1.0015_wp, 1.003_wp], 'tip by a vertex')
    touch = touching(tip, [1.0_wp, 0.4_wp, 1.0_wp], unit, 0.01_wp)
    call t%equal(touch%n, 1, 'tip at an edge: points')
    call t%near(touch%gap(1), 0.0_wp, tight, 'tip at an edge: gap')
    touch = touching(tip, [1.0_wp, 1.0_wp, 1.0_wp], unit, 0.01_wp)
    call t%equal(touch%n, 1, 'tip at a vertex: points')
    call t%near(touch%gap(1), 0.0_wp, tight, 'tip at a vertex: gap')
    call check_point(touch, [1.0_wp, 1.0_wp, 1.0_wp], 'tip at a vertex')
    touch = touching(cube, [2.0_wp, 2.0_wp, 2.0_wp], unit, 0.01_wp)
    call t%equal(touch%n, 1, 'shared vertex: points')
    call t%near(touch%gap(1), 0.0_wp, tight, 'shared vertex: gap')
    call check_point(touch, [1.0_wp, 1.0_wp, 1.0_wp], 'shared vertex')
  end subroutine test_vertices

  !> Shapes in the same place, and deep in each other.
  subroutine test_same_place()
    type(touch_space_t) :: touch
    real(wp), parameter :: up(3) = [0.0_wp, 0.0_wp, 1.0_wp]

    touch = touching(cube, zero, unit, 0.01_wp)
    call t%check(touch%n >= 1, 'same place: points')
    call t%near(minval(touch%gap(:touch%n)), -2.0_wp, tight, 'same place: the least width is missing')
    call t%near(norm2(touch%normal(:, 1)), 1.0_wp, tight, 'same place: unit normal')
    touch = touching(cube, [0.1_wp, 0.2_wp, 0.3_wp], unit, 0.01_wp)
    call check_flat(touch, 4, up, -1.7_wp, 'deep overlap')
    touch = touching(cube, [0.1_wp, 0.2_wp, 0.3_wp], turned(3, 0.3_wp), 0.01_wp)
    call check_flat(touch, 4, up, -1.7_wp, 'deep overlap, turned')
  end subroutine test_same_place

  !> A cube tilted a little keeps its four points as long as they are below alert; gaps follow the tilt.
  subroutine test_nearly_parallel()
    type(touch_space_t) :: touch
    type(random_t) :: random
    type(polyhedron_t) :: placed
    real(wp) :: tilt, way(3), frame(3, 3), centre(3)
    integer :: i

    call random%seed(9)
    do i = 1, 2000
      tilt = 10**random%uniform(-15.0_wp, -3.0_wp)
      way = random_direction(random)
      ! A small turn about any axis, to first order; its error of tilt^2 is far below alert.
      frame(:, 1) = unit(:, 1) + tilt*cross(way, unit(:, 1))
      frame(:, 1) = frame(:, 1)/norm2(frame(:, 1))
      frame(:, 2) = cross(unit(:, 3) + tilt*cross(way, unit(:, 3)), frame(:, 1))
      frame(:, 2) = frame(:, 2)/norm2(frame(:, 2))
      frame(:, 3) = cross(frame(:, 1), frame(:, 2))
      centre = [random%uniform(-0.5_wp, 0.5_wp), random%uniform(-0.5_wp, 0.5_wp), 2.0_wp]
      touch = touching(cube, centre, frame, 0.01_wp)
      call t%equal(touch%n, 4, 'nearly parallel faces: points')
      if (touch%n == 0) cycle
      placed = cube
      call place_polyhedron(placed, centre, frame)
      call t%near(minval(touch%gap(:touch%n)), signed_distance(placed, cube, zero), tight, 'nearly parallel faces: gap')
      ! Faces lean by the tilt, so gaps differ by its part of their length, and the normal from the vertical by as much.
      call t%check(maxval(touch%gap(:touch%n)) - minval(touch%gap(:touch%n)) <= 3*tilt + tight, 'nearly parallel faces: spread')
      call t%check(norm2(touch%normal(:, 1) - unit(:, 3)) <= 2*tilt + tight, 'nearly parallel faces: normal')
    end do
  end subroutine test_nearly_parallel

  !> Faces of a hundred corners.
  subroutine test_many_corners()
    type(touch_space_t) :: touch
    type(polyhedron_t) :: drum, placed

    drum = prism_shape(100)
    call place_polyhedron(drum, zero, unit)
    placed = drum
    call place_polyhedron(placed, [0.5_wp, 0.0_wp, 2.001_wp], turned(3, 0.01_wp))
    call touch_polyhedron_polyhedron(placed, drum, zero, 0.01_wp, touch)
    call check_flat(touch, 4, [0.0_wp, 0.0_wp, 1.0_wp], 0.001_wp, 'drum on drum')
  end subroutine test_many_corners

  !> Corners keep their names while cubes slip a little, also where corner lies on corner.
  subroutine test_keys_of_resting_cubes()
    type(touch_space_t) :: touch, slipped
    type(random_t) :: random
    real(wp) :: slip(3)
    integer :: i, j, k, kept

    call random%seed(10)
    touch = touching(cube, [0.0_wp, 0.0_wp, 2.0_wp], unit, 0.01_wp)
    kept = 0
    do i = 1, 500
      slip = 10**random%uniform(-16.0_wp, -3.0_wp)*random_direction(random)
      slipped = touching(cube, [0.0_wp, 0.0_wp, 2.0_wp] + slip, turned(3, slip(1)), 0.01_wp)
      call t%equal(slipped%n, 4, 'slipping cube: points')
      do j = 1, slipped%n
        do k = 1, touch%n
          if (touch%feature(k) /= slipped%feature(j)) cycle
          call t%near(norm2(slipped%point(:, j) - touch%point(:, k)), 0.0_wp, 4e-3_wp, 'same key, same corner')
          kept = kept + 1
        end do
      end do
    end do
    call t%equal(kept, 2000, 'keys kept')
  end subroutine test_keys_of_resting_cubes

  !> Boxes on a lattice, turned by quarters and eighths: all that can be shared is shared. Gaps and normals stay right.
  subroutine test_lattice()
    type(touch_space_t) :: touch
    type(random_t) :: random
    type(polyhedron_t) :: c, a
    real(wp) :: half(3), frame(3, 3), offset(3), distance
    integer :: i, j, touched

    call random%seed(11)
    touched = 0
    do i = 1, 4000
      do j = 1, 3
        half(j) = 0.5_wp*real(1 + int(random%uniform(0.0_wp, 4.0_wp)), wp)
        offset(j) = 0.5_wp*anint(random%uniform(-6.0_wp, 6.0_wp))
      end do
      c = box_shape(half)
      a = box_shape(half(3:1:-1))
      frame = matmul(turned(1, 0.25_wp*pi*anint(random%uniform(-2.0_wp, 2.0_wp))), &
                     turned(2, 0.25_wp*pi*anint(random%uniform(-2.0_wp, 2.0_wp))))
      call place_polyhedron(c, zero, frame)
      call place_polyhedron(a, zero, unit)
      call touch_polyhedron_polyhedron(c, a, offset, 0.6_wp, touch)
      distance = signed_distance(c, a, offset)
      if (touch%n == 0) then
        call t%check(distance >= 0.6_wp - tight, 'boxes on a lattice: missed')
        cycle
      end if
      touched = touched + 1
      ! To the length that is none, 1e-10 of the smaller shape (2.7 at most).
      call t%near(minval(touch%gap(:touch%n)), distance, 3e-10_wp, 'boxes on a lattice: gap')
      call t%near(separation_along(c, a, offset, touch%normal(:, 1)), distance, 3e-10_wp, 'boxes on a lattice: normal')
    end do
    call t%check(touched > 1000, 'many boxes touch')
  end subroutine test_lattice

  !> The same points of exact cases whichever way both cubes are turned, moved and rounded; names of corners too.
  subroutine test_turned_together()
    type(random_t) :: random
    type(polyhedron_t) :: c, a
    type(touch_space_t) :: touch
    real(wp) :: frame(3, 3), shift(3)
    real(wp), parameter :: place(3, 5) = reshape([0.0_wp, 0.0_wp, 2.0_wp, 1.0_wp, 1.0_wp, 2.0_wp, 2.0_wp, 0.0_wp, 2.0_wp, &
                                                  2.0_wp, 1.0_wp, 2.0_wp, 2.0_wp, 2.0_wp, 2.0_wp], [3, 5])
    integer, parameter :: points(5) = [4, 4, 2, 2, 1]
    integer(i4) :: keys(4, 5)
    integer :: i, j

    call random%seed(12)
    c = cube
    a = cube
    keys = 0
    do i = 1, 1000
      frame = random_frame(random)
      shift = 100*random_direction(random)
      call place_polyhedron(a, shift, frame)
      do j = 1, 5
        call place_polyhedron(c, shift + matmul(frame, place(:, j)), frame)
        call touch_polyhedron_polyhedron(c, a, zero, 0.01_wp, touch)
        call t%equal(touch%n, points(j), 'turned together: points')
        ! Coordinates of about 100: 64 units of their last place.
        call t%near(maxval(abs(touch%gap(:touch%n))), 0.0_wp, 1e-12_wp, 'turned together: gaps')
        if (j <= 2) call t%near(norm2(touch%normal(:, 1) - frame(:, 3)), 0.0_wp, 1e-14_wp, 'turned together: normal')
        if (i == 1) keys(:, j) = touch%feature
        if (j <= 2) call t%equal(count([any(keys(1, j) == touch%feature), any(keys(2, j) == touch%feature), &
                                        any(keys(3, j) == touch%feature), any(keys(4, j) == touch%feature)]), 4, &
                                 'turned together: keys')
      end do
    end do
  end subroutine test_turned_together
end program test_touch_polyhedra_cases
