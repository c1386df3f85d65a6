!> Narrow phase: points, normals and gaps of every pair of kinds against hand cases; test_touch_random has the rest.
!!
!! Lengths are of order 1; `tight` allows some tens of roundings of such lengths.
program test_touch
  use harness, only: tests_t
  use polygon_touch, only: touching, touching_wall
  use sg_kinds, only: wp, pi
  use sg_touch, only: touch_t
  use sg_touch_disk_disk, only: touch_disk_disk
  use sg_touch_disk_hollow, only: touch_disk_hollow
  use sg_touch_disk_polygon, only: touch_disk_polygon
  use sg_touch_disk_segment, only: touch_disk_segment
  implicit none
  real(wp), parameter :: tight = 1e-13_wp, zero(2) = [0.0_wp, 0.0_wp]
  !> A place where coordinates are rounded to 1e-13
  real(wp), parameter :: far(2) = [1234.5_wp, -987.6_wp]
  !> Gaps in a wall of bricks
  real(wp), parameter :: slacks(5) = [-1e-9_wp, -1e-16_wp, 0.0_wp, 1e-16_wp, 1e-9_wp]
  type(tests_t) :: t

  call test_disks()
  call test_disk_segment()
  call test_disk_polygon()
  call test_edge_on_edge()
  call test_vertices()
  call test_bricks()
  call test_odd_polygons()
  call test_polygon_segment()
  call test_keys()
  call t%finish()

contains

  !> Check one point of contact.
  subroutine check_point(touch, i, normal, point, gap, what)
    type(touch_t), intent(in) :: touch
    integer, intent(in) :: i !! which point
    real(wp), intent(in) :: normal(2), point(2), gap !! as they should be
    character(len=*), intent(in) :: what

    call t%near(norm2(touch%normal(:, i) - normal), 0.0_wp, tight, what//', normal')
    call t%near(norm2(touch%point(:, i) - point), 0.0_wp, tight, what//', point')
    call t%near(touch%gap(i), gap, tight, what//', gap')
  end subroutine check_point

  subroutine test_disks()
    type(touch_t) :: touch

    call touch_disk_disk([3.0_wp, 4.0_wp], 2.0_wp, zero, 2.5_wp, 1.0_wp, touch)
    call t%equal(touch%n, 1, 'disks apart but near')
    call check_point(touch, 1, [0.6_wp, 0.8_wp], 2.75_wp*[0.6_wp, 0.8_wp], 0.5_wp, 'disks apart')
    call touch_disk_disk([3.0_wp, 4.0_wp], 2.0_wp, zero, 2.5_wp, 0.4_wp, touch)
    call t%equal(touch%n, 0, 'disks beyond the alert distance')
    call touch_disk_disk(zero, 2.0_wp, zero, 2.5_wp, 0.1_wp, touch)
    call check_point(touch, 1, [1.0_wp, 0.0_wp], [0.25_wp, 0.0_wp], -4.5_wp, 'disks with one centre')

    call touch_disk_hollow([3.0_wp, 0.0_wp], 2.0_wp, zero, 4.9_wp, 0.1_wp, touch)
    call check_point(touch, 1, [-1.0_wp, 0.0_wp], [4.95_wp, 0.0_wp], -0.1_wp, 'disk in a hollow disk')
    call touch_disk_hollow([3.0_wp, 0.0_wp], 2.0_wp, zero, 5.2_wp, 0.1_wp, touch)
    call t%equal(touch%n, 0, 'disk far from the wall of the hollow disk')
    call touch_disk_hollow(zero, 2.0_wp, zero, 1.9_wp, 0.1_wp, touch)
    call t%near(touch%gap(1), -0.1_wp, tight, 'disk too large for the hollow disk')
    call t%near(norm2(touch%normal(:, 1)), 1.0_wp, tight, 'its normal')
  end subroutine test_disks

  subroutine test_disk_segment()
    real(wp), parameter :: axis(2) = [0.0_wp, 1.0_wp]
    type(touch_t) :: touch

    call touch_disk_segment([1.0_wp, 0.5_wp], 0.6_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call check_point(touch, 1, [1.0_wp, 0.0_wp], [0.35_wp, 0.5_wp], 0.1_wp, 'disk right of a wall')
    call touch_disk_segment([-1.0_wp, 0.5_wp], 0.8_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call check_point(touch, 1, [-1.0_wp, 0.0_wp], [-0.25_wp, 0.5_wp], -0.1_wp, 'disk left of a wall')
    call touch_disk_segment([0.3_wp, 2.4_wp], 0.3_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call check_point(touch, 1, [0.6_wp, 0.8_wp], [0.15_wp, 2.2_wp], -0.1_wp, 'disk at a cap')
    call touch_disk_segment([0.0_wp, 1.0_wp], 0.3_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call check_point(touch, 1, [-1.0_wp, 0.0_wp], [0.0_wp, 1.0_wp], -0.6_wp, 'disk on the axis')
    call touch_disk_segment([0.0_wp, -2.0_wp], 0.3_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call check_point(touch, 1, [0.0_wp, -1.0_wp], [0.0_wp, -2.0_wp], -0.6_wp, 'disk on the end of the axis')
    call touch_disk_segment([0.0_wp, 3.0_wp], 0.3_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call t%equal(touch%n, 0, 'disk beyond the end of a wall')
    call touch_disk_segment([1.0_wp, 0.0_wp], 0.3_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call t%equal(touch%n, 0, 'disk beside a wall')
  end subroutine test_disk_segment

  subroutine test_disk_polygon()
    real(wp) :: box(2, 4)
    type(touch_t) :: touch

    box = rectangle([0.0_wp, 0.0_wp], 4.0_wp, 2.0_wp)
    call touch_disk_polygon([1.0_wp, 1.9_wp], 1.0_wp, 4, box, zero, 0.2_wp, touch)
    call check_point(touch, 1, [0.0_wp, 1.0_wp], [1.0_wp, 0.95_wp], -0.1_wp, 'disk on an edge')
    call touch_disk_polygon([2.6_wp, 1.8_wp], 1.1_wp, 4, box, zero, 0.2_wp, touch)
    call check_point(touch, 1, [0.6_wp, 0.8_wp], [1.97_wp, 0.96_wp], -0.1_wp, 'disk on a vertex')
    call touch_disk_polygon([1.0_wp, 0.9_wp], 0.5_wp, 4, box, zero, 0.2_wp, touch)
    call check_point(touch, 1, [0.0_wp, 1.0_wp], [1.0_wp, 0.7_wp], -0.6_wp, 'disk deep below an edge')
    call touch_disk_polygon([2.0_wp, 1.0_wp], 0.5_wp, 4, box, zero, 0.2_wp, touch)
    call t%equal(touch%n, 1, 'disk centred on a vertex')
    call t%near(touch%gap(1), -0.5_wp, tight, 'its gap')
    call t%near(norm2(touch%normal(:, 1)), 1.0_wp, tight, 'its normal')
    call touch_disk_polygon([2.8_wp, 1.8_wp], 1.0_wp, 4, box, zero, 0.1_wp, touch)
    call t%equal(touch%n, 0, 'disk near both lines of a vertex but not near it')
    call touch_disk_polygon([11.0_wp, 1.9_wp], 1.0_wp, 4, box, [10.0_wp, 0.0_wp], 0.2_wp, touch)
    call check_point(touch, 1, [0.0_wp, 1.0_wp], [11.0_wp, 0.95_wp], -0.1_wp, 'disk on a periodic image')
  end subroutine test_disk_polygon

  subroutine test_edge_on_edge()
    type(touch_t) :: touch

    ! Half a brick of overlap in running bond: points at the ends of what the edges share.
    touch = touching(rectangle([1.0_wp, 1.0_wp], 2.0_wp, 1.0_wp), rectangle([0.0_wp, 0.0_wp], 2.0_wp, 1.0_wp), 0.1_wp)
    call t%equal(touch%n, 2, 'brick flat on a brick')
    call check_point(touch, 1, [0.0_wp, 1.0_wp], [1.0_wp, 0.5_wp], 0.0_wp, 'flat, first point')
    call check_point(touch, 2, [0.0_wp, 1.0_wp], [0.0_wp, 0.5_wp], 0.0_wp, 'flat, second point')
    ! A tilt of the upper one: two gaps.
    touch = touching(turned(rectangle([0.0_wp, 0.0_wp], 2.0_wp, 1.0_wp), 1e-3_wp, [0.0_wp, 1.0_wp]), &
                     rectangle([0.0_wp, 0.0_wp], 4.0_wp, 1.0_wp), 0.1_wp)
    call t%equal(touch%n, 2, 'tilted brick')
    call t%near(maxval(touch%gap) - minval(touch%gap), 2*sin(1e-3_wp), tight, 'tilted brick: difference of gaps')
    call t%near(minval(touch%gap), 0.5_wp - 0.5_wp*cos(1e-3_wp) - sin(1e-3_wp), tight, 'tilted brick: lowest gap')
    ! With the alert distance below the second gap only the lower corner counts.
    touch = touching(turned(rectangle([0.0_wp, 0.0_wp], 2.0_wp, 1.0_wp), 0.1_wp, [0.0_wp, 1.1_wp]), &
                     rectangle([0.0_wp, 0.0_wp], 4.0_wp, 1.0_wp), 0.1_wp)
    call t%equal(touch%n, 1, 'a second point beyond alert is dropped')
    touch = touching(rectangle([0.0_wp, 1.2_wp], 2.0_wp, 1.0_wp), rectangle([0.0_wp, 0.0_wp], 2.0_wp, 1.0_wp), 0.1_wp)
    call t%equal(touch%n, 0, 'bricks apart')
  end subroutine test_edge_on_edge

  subroutine test_vertices()
    real(wp) :: diamond(2, 4), box(2, 4)
    type(touch_t) :: touch

    box = rectangle([0.0_wp, 0.0_wp], 4.0_wp, 2.0_wp)
    diamond = turned(rectangle([0.0_wp, 0.0_wp], sqrt(2.0_wp), sqrt(2.0_wp)), pi/4, [0.3_wp, 2.05_wp])
    touch = touching(diamond, box, 0.1_wp)
    call t%equal(touch%n, 1, 'vertex over an edge')
    call check_point(touch, 1, [0.0_wp, 1.0_wp], [0.3_wp, 1.025_wp], 0.05_wp, 'vertex over an edge')
    touch = touching(box, diamond, 0.1_wp)
    call check_point(touch, 1, [0.0_wp, -1.0_wp], [0.3_wp, 1.025_wp], 0.05_wp, 'edge under a vertex')
    ! Deep: the vertex stands 0.5 below the edge; its neighbours are high above the alert distance.
    diamond(2, :) = diamond(2, :) - 0.55_wp
    touch = touching(diamond, box, 0.1_wp)
    call t%equal(touch%n, 1, 'deep vertex')
    call check_point(touch, 1, [0.0_wp, 1.0_wp], [0.3_wp, 0.75_wp], -0.5_wp, 'deep vertex')
    ! Corner to corner, apart: true distance and direction.
    touch = touching(rectangle([4.03_wp, 2.04_wp], 4.0_wp, 2.0_wp), box, 0.1_wp)
    call t%equal(touch%n, 1, 'corners apart')
    call check_point(touch, 1, [0.6_wp, 0.8_wp], [2.015_wp, 1.02_wp], 0.05_wp, 'corners apart')
    touch = touching(rectangle([4.08_wp, 2.08_wp], 4.0_wp, 2.0_wp), box, 0.1_wp)
    call t%equal(touch%n, 0, 'corners beyond alert though both faces are within')
    ! Corners that overlap: out by the shorter way.
    touch = touching(rectangle([3.9_wp, 1.8_wp], 4.0_wp, 2.0_wp), box, 0.1_wp)
    call t%equal(touch%n, 2, 'corners overlap')
    call t%near(touch%normal(1, 1), 1.0_wp, tight, 'corners overlap: normal of least penetration')
    call t%near(touch%gap(1), -0.1_wp, tight, 'corners overlap: gap')
  end subroutine test_vertices

  !> Bricks of a wall: gaps and overlaps of nothing or rounding, shared faces, corner neighbours, far from the origin.
  subroutine test_bricks()
    real(wp) :: brick(2, 4)
    type(touch_t) :: touch
    integer :: i, j

    brick = rectangle([0.0_wp, 0.0_wp], 0.2_wp, 0.1_wp)
    do i = 1, size(slacks)
      touch = touching(moved(brick, [0.2_wp + slacks(i), 0.0_wp]), brick, 1e-3_wp)
      call t%equal(touch%n, 2, 'bricks side by side')
      call t%near(touch%normal(1, 1) + touch%normal(1, 2), 2.0_wp, tight, 'side by side: normals')
      call t%near(maxval(abs(touch%gap - slacks(i))), 0.0_wp, tight, 'side by side: gaps')
      do j = -1, 1, 2
        touch = touching(moved(brick, [0.1_wp*real(j, wp), 0.1_wp + slacks(i)]), brick, 1e-3_wp)
        call t%equal(touch%n, 2, 'bricks in bond')
        call t%near(touch%normal(2, 1) + touch%normal(2, 2), 2.0_wp, tight, 'in bond: normals')
        call t%near(maxval(abs(touch%gap - slacks(i))), 0.0_wp, tight, 'in bond: gaps')
        call t%near(abs(touch%point(1, 1) - touch%point(1, 2)), 0.1_wp, tight, 'in bond: width')
        ! Far away, coordinates are rounded to 1e-13, directions of edges to some 1e-12.
        touch = touching(turned(moved(brick, [0.1_wp*real(j, wp), 0.1_wp + slacks(i)]), 0.3_wp, far), &
                         turned(brick, 0.3_wp, far), 1e-3_wp)
        call t%near(maxval(abs(touch%normal - reshape([-sin(0.3_wp), cos(0.3_wp), -sin(0.3_wp), cos(0.3_wp)], [2, 2]))), &
                    0.0_wp, 1e-11_wp, 'in bond, far away: normals')
      end do
    end do
    call test_corners(brick)
  end subroutine test_bricks

  !> A brick above another, to the right and to the left, that meets it in a corner at most.
  subroutine test_corners(brick)
    real(wp), intent(in) :: brick(2, 4) !! 0.2 by 0.1
    real(wp) :: corner(2), slack(2), first(2)
    type(touch_t) :: touch
    integer :: i, j, side

    do side = -1, 1, 2
      corner = [0.2_wp*real(side, wp), 0.1_wp]
      touch = touching(moved(brick, corner), brick, 1e-3_wp)
      first = touch%normal(:, 1)
      do i = 1, size(slacks)
        do j = 1, size(slacks)
          slack = [slacks(i), slacks(j)]
          touch = touching(moved(brick, corner + slack*real([side, 1], wp)), brick, 1e-3_wp)
          call t%equal(touch%n, 1, 'bricks corner on corner')
          ! Both slacks positive: distance of the corners; otherwise the greater slack is the separation.
          call t%near(touch%gap(1), merge(norm2(slack), maxval(slack), minval(slack) > 1e-10_wp), 2*tight, &
                      'corner on corner: gap')
          call t%near(norm2(touch%normal(:, 1)), 1.0_wp, tight, 'corner on corner: unit normal')
          call t%check(all(touch%normal(:, 1)*real([side, 1], wp) >= -tight), 'corner on corner: normal out of the corner')
          if (maxval(abs(slack)) < 1e-15_wp) &
            call t%near(norm2(touch%normal(:, 1) - first), 0.0_wp, tight, 'corner on corner: not by rounding')
          call t%near(norm2(touch%point(:, 1) - corner/2), 0.0_wp, 1e-8_wp, 'corner on corner: point')
          touch = touching(moved(brick, far + corner + slack*real([side, 1], wp)), moved(brick, far), 1e-3_wp)
          ! Coordinates of order 1000 are rounded to 1e-13.
          call t%near(touch%gap(1), maxval(slack), 2e-9_wp, 'corner on corner, far away')
          call t%near(norm2(touch%normal(:, 1)), 1.0_wp, tight, 'corner on corner, far away: unit normal')
        end do
      end do
    end do
  end subroutine test_corners

  !> Needles, slivers, coincident polygons, polygons of no size: finite unit normals.
  subroutine test_odd_polygons()
    real(wp) :: needle(2, 3), sliver(2, 4), box(2, 4), dot(2, 3)
    type(touch_t) :: touch

    box = rectangle([0.0_wp, 0.0_wp], 2.0_wp, 1.0_wp)
    touch = touching(box, box, 0.1_wp)
    call t%equal(touch%n, 2, 'coincident boxes')
    call t%near(maxval(abs(touch%gap + 1)), 0.0_wp, tight, 'coincident boxes: out by the shorter side')
    needle = reshape([-1e-9_wp, 1.0_wp, 0.0_wp, 0.0_wp, 1e-9_wp, 1.0_wp], [2, 3])
    touch = touching(moved(needle, [0.3_wp, 0.45_wp]), box, 0.1_wp)
    call t%equal(touch%n, 1, 'needle into a box')
    call check_point(touch, 1, [0.0_wp, 1.0_wp], [0.3_wp, 0.475_wp], -0.05_wp, 'needle into a box')
    touch = touching(moved(needle, [1.03_wp, 0.54_wp]), box, 0.1_wp)
    call check_point(touch, 1, [0.6_wp, 0.8_wp], [1.015_wp, 0.52_wp], 0.05_wp, 'needle near a corner')
    sliver = rectangle([0.0_wp, 0.5_wp], 2.0_wp, 1e-9_wp)
    touch = touching(sliver, box, 0.1_wp)
    call t%equal(touch%n, 2, 'sliver on a box')
    call t%near(touch%gap(1), -0.5e-9_wp, tight, 'sliver on a box: gap')
    touch = touching(sliver, sliver, 0.1_wp)
    call t%check(all(abs(norm2(touch%normal(:, :touch%n), 1) - 1) <= tight), 'sliver on itself: unit normals')
    dot = 0.7_wp
    touch = touching(dot, box, 0.3_wp)
    call check_point(touch, 1, [0.0_wp, 1.0_wp], [0.7_wp, 0.6_wp], 0.2_wp, 'polygon of no size near a box')
    touch = touching(dot, dot, 0.3_wp)
    call t%equal(touch%n, 0, 'two polygons of no size')
  end subroutine test_odd_polygons

  subroutine test_polygon_segment()
    real(wp), parameter :: axis(2) = [1.0_wp, 0.0_wp]
    real(wp) :: box(2, 4), diamond(2, 4)
    type(touch_t) :: touch

    box = rectangle([0.0_wp, 0.0_wp], 2.0_wp, 1.0_wp)
    touch = touching_wall(moved(box, [0.0_wp, 0.75_wp]), zero, axis, [5.0_wp, 0.2_wp], 0.1_wp)
    call t%equal(touch%n, 2, 'box on a wall')
    call t%near(maxval(abs(touch%gap - 0.05_wp)), 0.0_wp, tight, 'box on a wall: gaps')
    call t%near(maxval(abs(touch%point(2, :) - 0.225_wp)), 0.0_wp, tight, 'box on a wall: points')
    call t%near(abs(touch%point(1, 1) - touch%point(1, 2)), 2.0_wp, tight, 'box on a wall: width')
    touch = touching_wall(moved(box, [0.0_wp, -0.65_wp]), zero, axis, [5.0_wp, 0.2_wp], 0.1_wp)
    call t%near(touch%normal(2, 1) + touch%normal(2, 2), -2.0_wp, tight, 'box under a wall: normals')
    call t%near(maxval(abs(touch%gap + 0.05_wp)), 0.0_wp, tight, 'box under a wall: gaps')
    diamond = turned(rectangle([0.0_wp, 0.0_wp], sqrt(2.0_wp), sqrt(2.0_wp)), pi/4, zero)
    touch = touching_wall(moved(diamond, [1.0_wp, 1.15_wp]), zero, axis, [5.0_wp, 0.2_wp], 0.1_wp)
    call t%equal(touch%n, 1, 'vertex on a wall')
    call check_point(touch, 1, [0.0_wp, 1.0_wp], [1.0_wp, 0.175_wp], -0.05_wp, 'vertex on a wall')
    ! Vertex beyond the end of the axis by 3 and 4 tenths: distance to the cap.
    touch = touching_wall(moved(box, [6.3_wp, 0.9_wp]), zero, axis, [5.0_wp, 0.6_wp], 0.1_wp)
    call check_point(touch, 1, [0.6_wp, 0.8_wp], [5.33_wp, 0.44_wp], -0.1_wp, 'vertex at a cap')
    ! An edge against the cap: the face is the polygon's.
    touch = touching_wall(moved(box, [6.25_wp, 0.0_wp]), zero, axis, [5.0_wp, 0.2_wp], 0.1_wp)
    call t%equal(touch%n, 1, 'edge at a cap')
    call check_point(touch, 1, [1.0_wp, 0.0_wp], [5.225_wp, 0.0_wp], 0.05_wp, 'edge at a cap')
    touch = touching_wall(moved(box, [0.55_wp, 0.1_wp]), zero, axis, [0.0_wp, 0.2_wp], 0.1_wp)
    call t%near(norm2(touch%normal(:, 1)), 1.0_wp, tight, 'wall of no length inside a box: normal')
    ! Box through the axis: pushed to the side where less is missing.
    touch = touching_wall(moved(box, [0.0_wp, 0.3_wp]), zero, axis, [5.0_wp, 0.2_wp], 0.1_wp)
    call t%near(touch%normal(2, 1), 1.0_wp, tight, 'box through a wall: normal')
    call t%near(touch%gap(1), -0.4_wp, tight, 'box through a wall: gap')
  end subroutine test_polygon_segment

  !> A point keeps its key while the bodies rock, slide a little, or the reference face changes side.
  subroutine test_keys()
    real(wp) :: brick(2, 4)
    type(touch_t) :: one, two
    integer :: i

    brick = rectangle([0.0_wp, 0.0_wp], 0.2_wp, 0.1_wp)
    one = touching(moved(brick, [0.1_wp, 0.1_wp]), brick, 1e-3_wp)
    call t%check(one%feature(1) /= one%feature(2) .and. minval(one%feature) > 0, 'two points have two keys')
    do i = -5, 5
      two = touching(turned(brick, 1e-5_wp*real(i, wp), [0.1_wp + 1e-4_wp*real(i, wp), 0.1_wp]), brick, 1e-3_wp)
      call t%check(same_keys(one, two), 'keys of a rocking brick in bond')
      call t%check(all(abs(two%normal(1, :)) <= 1.001e-5_wp*abs(real(i, wp)) + tight .and. two%normal(2, :) > 0), &
                   'normals of a rocking brick turn by its tilt at most')
    end do
    one = touching(moved(brick, [0.0_wp, 0.1_wp]), brick, 1e-3_wp)
    do i = -5, 5
      two = touching(turned(brick, 1e-9_wp*real(i, wp), [1e-9_wp*real(i, wp), 0.1_wp]), brick, 1e-3_wp)
      call t%check(same_keys(one, two), 'keys of a brick right on a brick')
      two = touching(turned(brick, 1e-4_wp*real(i, wp), [0.0_wp, 0.1_wp]), brick, 1e-3_wp)
      call t%check(same_keys(one, two), 'keys of a brick rocking right on a brick')
      two = touching(turned(brick, 1e-13_wp*real(i, wp), [0.1_wp, 0.1_wp]), brick, 1e-3_wp)
      call t%check(all(abs(two%normal(1, :)) <= 0), 'a brick at rest has the normal of the one below')
    end do
  end subroutine test_keys

  !> Have two touches the same keys, at the left and at the right?
  logical function same_keys(one, two)
    type(touch_t), intent(in) :: one, two

    same_keys = one%n == 2 .and. two%n == 2
    if (same_keys) same_keys = all(one%feature([minloc(one%point(1, :)), maxloc(one%point(1, :))]) &
                                   == two%feature([minloc(two%point(1, :)), maxloc(two%point(1, :))]))
  end function same_keys

  !> A rectangle about a centre.
  pure function rectangle(centre, width, height) result(box)
    real(wp), intent(in) :: centre(2), width, height
    real(wp) :: box(2, 4)

    box = moved(reshape(0.5_wp*[-width, -height, width, -height, width, height, -width, height], [2, 4]), centre)
  end function rectangle

  !> Vertices moved.
  pure function moved(vertices, shift) result(new)
    real(wp), intent(in) :: vertices(:, :), shift(2)
    real(wp) :: new(2, size(vertices, 2))

    new = vertices + spread(shift, 2, size(vertices, 2))
  end function moved

  !> Vertices turned about the origin, then moved.
  pure function turned(vertices, angle, shift) result(new)
    real(wp), intent(in) :: vertices(:, :), angle, shift(2)
    real(wp) :: new(2, size(vertices, 2))

    new(1, :) = cos(angle)*vertices(1, :) - sin(angle)*vertices(2, :) + shift(1)
    new(2, :) = sin(angle)*vertices(1, :) + cos(angle)*vertices(2, :) + shift(2)
  end function turned
end program test_touch
