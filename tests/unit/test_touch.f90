!> Narrow phase: points, normals and gaps of every pair of kinds against hand cases and brute force.
!!
!! Lengths are of order 1; `tight` allows some tens of roundings of such lengths.
program test_touch
  use harness, only: tests_t
  use sg_kinds, only: wp, pi
  use sg_random, only: random_t
  use sg_touch, only: touch_t
  use sg_touch_disk_disk, only: touch_disk_disk
  use sg_touch_disk_hollow, only: touch_disk_hollow
  use sg_touch_disk_polygon, only: touch_disk_polygon
  use sg_touch_disk_wall, only: touch_disk_wall
  use sg_touch_polygon_polygon, only: touch_polygon_polygon
  use sg_touch_polygon_wall, only: touch_polygon_wall
  implicit none
  real(wp), parameter :: tight = 1e-13_wp, zero(2) = [0.0_wp, 0.0_wp]
  type(tests_t) :: t

  call test_disks()
  call test_disk_wall()
  call test_disk_polygon()
  call test_edge_on_edge()
  call test_vertices()
  call test_bricks()
  call test_odd_polygons()
  call test_polygon_wall()
  call test_keys()
  call test_symmetry()
  call test_against_brute_force()
  call test_wall_against_disks()
  call test_fuzz()
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

  subroutine test_disk_wall()
    real(wp), parameter :: axis(2) = [0.0_wp, 1.0_wp]
    type(touch_t) :: touch

    call touch_disk_wall([1.0_wp, 0.5_wp], 0.6_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call check_point(touch, 1, [1.0_wp, 0.0_wp], [0.35_wp, 0.5_wp], 0.1_wp, 'disk right of a wall')
    call touch_disk_wall([-1.0_wp, 0.5_wp], 0.8_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call check_point(touch, 1, [-1.0_wp, 0.0_wp], [-0.25_wp, 0.5_wp], -0.1_wp, 'disk left of a wall')
    call touch_disk_wall([0.3_wp, 2.4_wp], 0.3_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call check_point(touch, 1, [0.6_wp, 0.8_wp], [0.15_wp, 2.2_wp], -0.1_wp, 'disk at a cap')
    call touch_disk_wall([0.0_wp, 1.0_wp], 0.3_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call check_point(touch, 1, [-1.0_wp, 0.0_wp], [0.0_wp, 1.0_wp], -0.6_wp, 'disk on the axis')
    call touch_disk_wall([0.0_wp, -2.0_wp], 0.3_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call check_point(touch, 1, [0.0_wp, -1.0_wp], [0.0_wp, -2.0_wp], -0.6_wp, 'disk on the end of the axis')
    call touch_disk_wall([0.0_wp, 3.0_wp], 0.3_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call t%equal(touch%n, 0, 'disk beyond the end of a wall')
    call touch_disk_wall([1.0_wp, 0.0_wp], 0.3_wp, zero, axis, 2.0_wp, 0.3_wp, 0.2_wp, touch)
    call t%equal(touch%n, 0, 'disk beside a wall')
  end subroutine test_disk_wall

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
    real(wp), parameter :: slack(5) = [-1e-9_wp, -1e-16_wp, 0.0_wp, 1e-16_wp, 1e-9_wp]
    real(wp), parameter :: far(2) = [1234.5_wp, -987.6_wp]
    real(wp) :: brick(2, 4)
    type(touch_t) :: touch
    integer :: i, j

    brick = rectangle([0.0_wp, 0.0_wp], 0.2_wp, 0.1_wp)
    do i = 1, size(slack)
      touch = touching(moved(brick, [0.2_wp + slack(i), 0.0_wp]), brick, 1e-3_wp)
      call t%equal(touch%n, 2, 'bricks side by side')
      call t%near(touch%normal(1, 1) + touch%normal(1, 2), 2.0_wp, tight, 'side by side: normals')
      call t%near(maxval(abs(touch%gap - slack(i))), 0.0_wp, tight, 'side by side: gaps')
      touch = touching(moved(brick, [0.1_wp, 0.1_wp + slack(i)]), brick, 1e-3_wp)
      call t%equal(touch%n, 2, 'bricks in bond')
      call t%near(touch%normal(2, 1) + touch%normal(2, 2), 2.0_wp, tight, 'in bond: normals')
      call t%near(abs(touch%point(1, 1) - touch%point(1, 2)), 0.1_wp, tight, 'in bond: width')
      do j = 1, size(slack)
        touch = touching(moved(brick, [0.2_wp + slack(i), 0.1_wp + slack(j)]), brick, 1e-3_wp)
        call t%equal(touch%n, 1, 'bricks corner on corner')
        ! Both slacks positive: distance of the corners; otherwise the greater slack is the separation.
        if (min(slack(i), slack(j)) > 1e-10_wp) then
          call t%near(touch%gap(1), norm2([slack(i), slack(j)]), tight, 'corner on corner: distance')
        else
          call t%near(touch%gap(1), max(slack(i), slack(j)), 2*tight, 'corner on corner: separation')
        end if
        call t%near(norm2(touch%normal(:, 1)), 1.0_wp, tight, 'corner on corner: unit normal')
        call t%check(all(touch%normal(:, 1) >= -tight), 'corner on corner: normal out of the corner')
        call t%near(norm2(touch%point(:, 1) - [0.1_wp, 0.05_wp]), 0.0_wp, 1e-8_wp, 'corner on corner: point')
        touch = touching(moved(brick, far + [0.2_wp + slack(i), 0.1_wp + slack(j)]), moved(brick, far), 1e-3_wp)
        ! Coordinates of order 1000 are rounded to 1e-13.
        call t%near(touch%gap(1), max(slack(i), slack(j)), 2e-9_wp, 'corner on corner, far away')
        call t%near(norm2(touch%normal(:, 1)), 1.0_wp, tight, 'corner on corner, far away: unit normal')
      end do
    end do
  end subroutine test_bricks

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

  subroutine test_polygon_wall()
    real(wp), parameter :: axis(2) = [1.0_wp, 0.0_wp]
    real(wp) :: box(2, 4), diamond(2, 4)
    type(touch_t) :: touch

    box = rectangle([0.0_wp, 0.0_wp], 2.0_wp, 1.0_wp)
    call touch_polygon_wall(4, moved(box, [0.0_wp, 0.75_wp]), zero, axis, 5.0_wp, 0.2_wp, 0.1_wp, touch)
    call t%equal(touch%n, 2, 'box on a wall')
    call t%near(maxval(abs(touch%gap - 0.05_wp)), 0.0_wp, tight, 'box on a wall: gaps')
    call t%near(maxval(abs(touch%point(2, :) - 0.225_wp)), 0.0_wp, tight, 'box on a wall: points')
    call t%near(abs(touch%point(1, 1) - touch%point(1, 2)), 2.0_wp, tight, 'box on a wall: width')
    call touch_polygon_wall(4, moved(box, [0.0_wp, -0.65_wp]), zero, axis, 5.0_wp, 0.2_wp, 0.1_wp, touch)
    call t%near(touch%normal(2, 1) + touch%normal(2, 2), -2.0_wp, tight, 'box under a wall: normals')
    call t%near(maxval(abs(touch%gap + 0.05_wp)), 0.0_wp, tight, 'box under a wall: gaps')
    diamond = turned(rectangle([0.0_wp, 0.0_wp], sqrt(2.0_wp), sqrt(2.0_wp)), pi/4, zero)
    call touch_polygon_wall(4, moved(diamond, [1.0_wp, 1.15_wp]), zero, axis, 5.0_wp, 0.2_wp, 0.1_wp, touch)
    call t%equal(touch%n, 1, 'vertex on a wall')
    call check_point(touch, 1, [0.0_wp, 1.0_wp], [1.0_wp, 0.175_wp], -0.05_wp, 'vertex on a wall')
    ! Vertex beyond the end of the axis by 3 and 4 tenths: distance to the cap.
    call touch_polygon_wall(4, moved(box, [6.3_wp, 0.9_wp]), zero, axis, 5.0_wp, 0.6_wp, 0.1_wp, touch)
    call check_point(touch, 1, [0.6_wp, 0.8_wp], [5.33_wp, 0.44_wp], -0.1_wp, 'vertex at a cap')
    ! An edge against the cap: the face is the polygon's.
    call touch_polygon_wall(4, moved(box, [6.25_wp, 0.0_wp]), zero, axis, 5.0_wp, 0.2_wp, 0.1_wp, touch)
    call t%equal(touch%n, 1, 'edge at a cap')
    call check_point(touch, 1, [1.0_wp, 0.0_wp], [5.225_wp, 0.0_wp], 0.05_wp, 'edge at a cap')
    call touch_polygon_wall(4, moved(box, [0.55_wp, 0.1_wp]), zero, axis, 0.0_wp, 0.2_wp, 0.1_wp, touch)
    call t%near(norm2(touch%normal(:, 1)), 1.0_wp, tight, 'wall of no length inside a box: normal')
    ! Box through the axis: pushed to the side where less is missing.
    call touch_polygon_wall(4, moved(box, [0.0_wp, 0.3_wp]), zero, axis, 5.0_wp, 0.2_wp, 0.1_wp, touch)
    call t%near(touch%normal(2, 1), 1.0_wp, tight, 'box through a wall: normal')
    call t%near(touch%gap(1), -0.4_wp, tight, 'box through a wall: gap')
  end subroutine test_polygon_wall

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
    end do
    one = touching(moved(brick, [0.0_wp, 0.1_wp]), brick, 1e-3_wp)
    do i = -5, 5
      two = touching(turned(brick, 1e-9_wp*real(i, wp), [1e-9_wp*real(i, wp), 0.1_wp]), brick, 1e-3_wp)
      call t%check(same_keys(one, two), 'keys of a brick right on a brick')
      two = touching(turned(brick, 1e-4_wp*real(i, wp), [0.0_wp, 0.1_wp]), brick, 1e-3_wp)
      call t%check(same_keys(one, two), 'keys of a brick rocking right on a brick')
    end do
  end subroutine test_keys

  !> Have two touches the same points, told by their keys?
  logical function same_keys(one, two)
    type(touch_t), intent(in) :: one, two

    same_keys = one%n == two%n
    if (same_keys) same_keys = all(one%feature(:one%n) == two%feature(:two%n)) &
                               .or. all(one%feature(:one%n) == two%feature(two%n:1:-1))
  end function same_keys

  !> Swapping the bodies turns the normal; moving both moves the point and leaves the gap.
  subroutine test_symmetry()
    type(random_t) :: random
    type(touch_t) :: touch, swapped, there
    real(wp), allocatable :: a(:, :), c(:, :)
    real(wp) :: angle, shift(2)
    integer :: i, found

    call random%seed(3)
    found = 0
    do i = 1, 2000
      call random_pair(random, a, c)
      touch = touching(c, a, 0.2_wp)
      swapped = touching(a, c, 0.2_wp)
      angle = random%uniform(0.0_wp, 2*pi)
      shift = [random%uniform(-9.0_wp, 9.0_wp), random%uniform(-9.0_wp, 9.0_wp)]
      there = touching(turned(c, angle, shift), turned(a, angle, shift), 0.2_wp)
      if (touch%n /= swapped%n .or. touch%n /= there%n) then
        call t%check(.false., 'as many points after a swap or a motion')
        cycle
      end if
      if (touch%n == 0) cycle
      found = found + 1
      call t%near(minval(touch%gap(:touch%n)), minval(swapped%gap(:touch%n)), 1e-12_wp, 'same gap after a swap')
      call t%near(norm2(touch%normal(:, 1) + swapped%normal(:, minloc(norm2(swapped%point(:, :touch%n) &
                  - spread(touch%point(:, 1), 2, touch%n), 1), 1))), 0.0_wp, 1e-10_wp, 'opposite normal after a swap')
      call t%near(maxval(abs(touch%gap - there%gap)), 0.0_wp, 1e-12_wp, 'same gaps after a motion')
      call t%near(norm2(there%point(:, :touch%n) - turned(touch%point(:, :touch%n), angle, shift)), 0.0_wp, 1e-11_wp, &
                  'points move along')
      call t%near(norm2(there%normal - turned(touch%normal, angle, zero)), 0.0_wp, 1e-10_wp, 'normals turn along')
      call t%check(all(touch%feature == there%feature), 'keys stay')
    end do
    call t%check(found > 500, 'many pairs are near enough')
  end subroutine test_symmetry

  !> Gaps of separated polygons against all distances between vertices and edges; depths of overlapping ones against
  !! the shortest translation over 720 directions.
  subroutine test_against_brute_force()
    type(random_t) :: random
    type(touch_t) :: touch
    real(wp), allocatable :: a(:, :), c(:, :)
    real(wp) :: distance, depth, gap, surface(2, 1)
    integer :: i, j, apart, deep

    call random%seed(11)
    apart = 0
    deep = 0
    do i = 1, 4000
      call random_pair(random, a, c)
      touch = touching(c, a, 0.5_wp)
      depth = shortest_translation(a, c)
      distance = brute_distance(a, c)
      if (touch%n == 0) then
        call t%check(distance >= 0.5_wp - tight .and. depth < 0, 'no point is missed')
        cycle
      end if
      do j = 1, touch%n
        surface(:, 1) = touch%point(:, j) + touch%gap(j)/2*touch%normal(:, j)
        call t%near(shortest_of(surface, c), 0.0_wp, 1e-12_wp, 'half a gap from the point to the candidate')
        surface(:, 1) = touch%point(:, j) - touch%gap(j)/2*touch%normal(:, j)
        call t%near(shortest_of(surface, a), 0.0_wp, 1e-12_wp, 'half a gap from the point to the antagonist')
      end do
      gap = minval(touch%gap(:touch%n))
      if (gap > 0) then
        apart = apart + 1
        call t%near(gap, distance, 1e-12_wp, 'gap of separated polygons')
      else
        deep = deep + 1
        ! The best of the directions is within a step of pi/720 of the best of all; shapes reach to 4.
        call t%check(depth >= -gap - tight .and. depth <= -gap + 4*pi/720, 'depth is the shortest way apart')
      end if
    end do
    call t%check(apart > 500 .and. deep > 500, 'both cases are met')
  end subroutine test_against_brute_force

  !> A wall's gap to a polygon is the polygon's distance to the axis less the half thickness.
  subroutine test_wall_against_disks()
    type(random_t) :: random
    type(touch_t) :: touch
    real(wp), allocatable :: a(:, :), c(:, :)
    real(wp) :: angle, axis(2), ends(2, 2), distance
    integer :: i, found

    call random%seed(5)
    found = 0
    do i = 1, 2000
      call random_pair(random, a, c)
      angle = random%uniform(0.0_wp, 2*pi)
      axis = [cos(angle), sin(angle)]
      ends(:, 1) = -0.8_wp*axis
      ends(:, 2) = 0.8_wp*axis
      if (shortest_translation(ends, c) > 0) cycle
      distance = brute_distance(ends, c)
      call touch_polygon_wall(size(c, 2), c, zero, axis, 0.8_wp, 0.3_wp, 0.2_wp, touch)
      if (abs(distance - 0.5_wp) < tight) cycle
      call t%check((distance < 0.5_wp) .eqv. (touch%n > 0), 'wall and polygon within alert')
      if (touch%n == 0) cycle
      found = found + 1
      call t%near(minval(touch%gap(:touch%n)), distance - 0.3_wp, 1e-12_wp, 'gap of wall and polygon')
    end do
    call t%check(found > 300, 'many walls are near enough')
  end subroutine test_wall_against_disks

  !> Whatever comes: finite numbers, unit normals, gaps below alert.
  subroutine test_fuzz()
    type(random_t) :: random
    type(touch_t) :: touch
    real(wp), allocatable :: a(:, :), c(:, :)
    real(wp) :: alert
    integer :: i, bad

    call random%seed(2024)
    bad = 0
    do i = 1, 100000
      call random_pair(random, a, c)
      ! Coordinates cut to a coarse grid now and then, for shared vertices, flat angles and no area.
      if (modulo(i, 3) == 0) a = anint(2*a)/2
      if (modulo(i, 6) == 0) c = anint(2*c)/2
      alert = 10**random%uniform(-6.0_wp, 0.0_wp)
      touch = touching(c, a, alert)
      if (.not. is_sane(touch, alert)) bad = bad + 1
      call touch_polygon_wall(size(c, 2), c, a(:, 1), [0.6_wp, 0.8_wp], 1.0_wp, 0.1_wp, alert, touch)
      if (.not. is_sane(touch, alert)) bad = bad + 1
      call touch_disk_polygon(c(:, 1), 0.3_wp, size(a, 2), a, zero, alert, touch)
      if (.not. is_sane(touch, alert)) bad = bad + 1
    end do
    call t%equal(bad, 0, 'fuzzed pairs that are not sane')
  end subroutine test_fuzz

  !> Is every point finite, with a unit normal and a gap below alert?
  logical function is_sane(touch, alert)
    type(touch_t), intent(in) :: touch
    real(wp), intent(in) :: alert

    is_sane = touch%n >= 0 .and. touch%n <= 2
    if (.not. is_sane) return
    associate (n => touch%n)
      is_sane = all(touch%gap(:n) < alert) .and. all(abs(touch%point(:, :n)) < 100) &
                .and. all(touch%gap(:n) > -10) .and. all(abs(norm2(touch%normal(:, :n), 1) - 1) <= tight)
    end associate
  end function is_sane

  !> Points of contact of two polygons without periodic image.
  function touching(c, a, alert) result(touch)
    real(wp), intent(in) :: c(:, :), a(:, :) !! candidate and antagonist
    real(wp), intent(in) :: alert
    type(touch_t) :: touch

    call touch_polygon_polygon(size(c, 2), c, size(a, 2), a, zero, alert, touch)
  end function touching

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

  !> Two random convex polygons of 3 to 8 vertices on ellipses (some thin), overlapping, near or apart.
  subroutine random_pair(random, a, c)
    type(random_t), intent(inout) :: random
    real(wp), allocatable, intent(out) :: a(:, :), c(:, :)

    call random_polygon(random, zero, a)
    call random_polygon(random, [random%uniform(0.0_wp, 2.5_wp), random%uniform(-0.5_wp, 0.5_wp)], c)
  end subroutine random_pair

  !> A random convex polygon: vertices on an ellipse at angles that grow by random steps.
  subroutine random_polygon(random, centre, vertices)
    type(random_t), intent(inout) :: random
    real(wp), intent(in) :: centre(2)
    real(wp), allocatable, intent(out) :: vertices(:, :)
    real(wp) :: angle(8), flatness
    integer :: i, n

    n = 3 + int(5.999_wp*random%uniform())
    angle(1) = 0
    do i = 2, n
      angle(i) = angle(i - 1) + random%uniform(0.2_wp, 1.0_wp)
    end do
    angle(:n) = angle(:n)*2*pi/(angle(n) + random%uniform(0.2_wp, 1.0_wp))
    flatness = 10**random%uniform(-2.0_wp, 0.0_wp)
    allocate (vertices(2, n))
    vertices(1, :) = cos(angle(:n))
    vertices(2, :) = flatness*sin(angle(:n))
    vertices = turned(vertices, random%uniform(0.0_wp, 2*pi), centre)
  end subroutine random_polygon

  !> Least distance between the boundaries of two separated polygons: every vertex against every edge.
  pure real(wp) function brute_distance(a, c)
    real(wp), intent(in) :: a(:, :), c(:, :)

    brute_distance = min(shortest_of(a, c), shortest_of(c, a))
  end function brute_distance

  !> Least distance of some points to the edges of a polygon.
  pure real(wp) function shortest_of(points, polygon) result(shortest)
    real(wp), intent(in) :: points(:, :), polygon(:, :)
    real(wp) :: edge(2), between(2)
    integer :: i, j

    shortest = huge(shortest)
    do i = 1, size(polygon, 2)
      edge = polygon(:, modulo(i, size(polygon, 2)) + 1) - polygon(:, i)
      do j = 1, size(points, 2)
        between = points(:, j) - polygon(:, i)
        between = between - max(0.0_wp, min(1.0_wp, dot_product(between, edge)/dot_product(edge, edge)))*edge
        shortest = min(shortest, norm2(between))
      end do
    end do
  end function shortest_of

  !> Least length by which c must move to leave a, over 720 directions; negative when they are apart.
  pure real(wp) function shortest_translation(a, c) result(depth)
    real(wp), intent(in) :: a(:, :), c(:, :)
    real(wp) :: normal(2)
    integer :: i

    depth = huge(depth)
    do i = 1, 720
      normal = [cos(2*pi*real(i, wp)/720), sin(2*pi*real(i, wp)/720)]
      depth = min(depth, maxval(matmul(normal, a)) - minval(matmul(normal, c)))
    end do
  end function shortest_translation
end program test_touch
