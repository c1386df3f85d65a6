!> Narrow phase of round shapes in space: hand cases and odd cases; test_touch_space_random has the rest.
!!
!! Lengths are of order 1; `tight` allows some tens of roundings of such lengths.
program test_touch_space
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use harness, only: tests_t
  use random_space, only: random_direction, random_frame
  use sg_kinds, only: wp, i4
  use sg_random, only: random_t
  use sg_touch_cylinder_cylinder, only: touch_cylinder_cylinder
  use sg_touch_cylinder_hollow, only: touch_cylinder_hollow
  use sg_touch_cylinder_plane, only: touch_cylinder_plane
  use sg_touch_space, only: touch_space_t
  use sg_touch_sphere_cylinder, only: touch_sphere_cylinder
  use sg_touch_sphere_hollow_cylinder, only: touch_sphere_hollow_cylinder
  use sg_touch_sphere_plane, only: touch_sphere_plane
  use sg_touch_sphere_sphere, only: touch_sphere_sphere
  implicit none
  real(wp), parameter :: tight = 1e-13_wp, zero(3) = 0
  real(wp), parameter :: ex(3) = [1.0_wp, 0.0_wp, 0.0_wp], ey(3) = [0.0_wp, 1.0_wp, 0.0_wp], ez(3) = [0.0_wp, 0.0_wp, 1.0_wp]
  real(wp), parameter :: upright(3, 3) = reshape([ex, ey, ez], [3, 3])
  !> A floor whose upper face lies at z = 0.1
  real(wp), parameter :: floor_half(3) = [3.0_wp, 2.0_wp, 0.1_wp]
  type(tests_t) :: t

  call test_spheres()
  call test_sphere_plane()
  call test_sphere_cylinder()
  call test_hollow()
  call test_cylinder_plane()
  call test_cylinder_edges()
  call test_cylinders()
  call test_degenerate()
  call t%finish()

contains

  !> Check one point of contact.
  subroutine check_point(touch, i, normal, point, gap, what)
    type(touch_space_t), intent(in) :: touch
    integer, intent(in) :: i !! which point
    real(wp), intent(in) :: normal(3), point(3), gap !! as they should be
    character(len=*), intent(in) :: what

    call t%check(touch%n >= i, what//', is there')
    if (touch%n < i) return
    call t%near(norm2(touch%normal(:, i) - normal), 0.0_wp, tight, what//', normal')
    call t%near(norm2(touch%point(:, i) - point), 0.0_wp, tight, what//', point')
    call t%near(touch%gap(i), gap, tight, what//', gap')
  end subroutine check_point

  subroutine test_spheres()
    type(touch_space_t) :: touch

    call touch_sphere_sphere([2.0_wp, 3.0_wp, 6.0_wp], 3.0_wp, zero, 3.5_wp, 1.0_wp, touch)
    call t%equal(touch%n, 1, 'spheres apart but near')
    call check_point(touch, 1, [2.0_wp, 3.0_wp, 6.0_wp]/7, 3.75_wp*[2.0_wp, 3.0_wp, 6.0_wp]/7, 0.5_wp, 'spheres apart')
    call touch_sphere_sphere([2.0_wp, 3.0_wp, 6.0_wp], 3.0_wp, zero, 3.5_wp, 0.4_wp, touch)
    call t%equal(touch%n, 0, 'spheres beyond the alert distance')
    call touch_sphere_sphere(zero, 2.0_wp, zero, 2.5_wp, 0.1_wp, touch)
    call check_point(touch, 1, ez, 0.25_wp*ez, -4.5_wp, 'spheres with one centre')
  end subroutine test_spheres

  subroutine test_sphere_plane()
    type(touch_space_t) :: touch

    call touch_sphere_plane([1.0_wp, -1.0_wp, 0.5_wp], 0.5_wp, zero, upright, floor_half, 0.05_wp, touch)
    call check_point(touch, 1, ez, [1.0_wp, -1.0_wp, 0.05_wp], -0.1_wp, 'sphere on a floor')
    call touch_sphere_plane([1.0_wp, -1.0_wp, -0.62_wp], 0.5_wp, zero, upright, floor_half, 0.05_wp, touch)
    call check_point(touch, 1, -ez, [1.0_wp, -1.0_wp, -0.11_wp], 0.02_wp, 'sphere under a floor')
    call touch_sphere_plane([3.3_wp, 0.0_wp, 0.5_wp], 0.5_wp, zero, upright, floor_half, 0.05_wp, touch)
    call check_point(touch, 1, [0.6_wp, 0.0_wp, 0.8_wp], [3.0_wp, 0.0_wp, 0.1_wp], 0.0_wp, 'sphere at an edge')
    call touch_sphere_plane([-3.2_wp, 2.3_wp, -0.7_wp], 0.7_wp, zero, upright, floor_half, 0.05_wp, touch)
    call check_point(touch, 1, [-2.0_wp, 3.0_wp, -6.0_wp]/7, [-3.0_wp, 2.0_wp, -0.1_wp], 0.0_wp, 'sphere at a corner')
    call touch_sphere_plane([3.5_wp, 0.0_wp, 0.0_wp], 0.6_wp, zero, upright, floor_half, 0.05_wp, touch)
    call check_point(touch, 1, ex, [2.95_wp, 0.0_wp, 0.0_wp], -0.1_wp, 'sphere at a narrow face')
    call touch_sphere_plane([2.99_wp, 0.0_wp, -0.05_wp], 0.5_wp, zero, upright, floor_half, 0.05_wp, touch)
    call check_point(touch, 1, -ez, [2.99_wp, 0.0_wp, 0.175_wp], -0.55_wp, 'centre within the floor, below')
    call touch_sphere_plane([2.99_wp, 0.0_wp, 0.0_wp], 0.5_wp, zero, upright, floor_half, 0.05_wp, touch)
    call check_point(touch, 1, ez, [2.99_wp, 0.0_wp, -0.2_wp], -0.6_wp, 'centre in the middle of the floor')
    call touch_sphere_plane([3.4_wp, 2.4_wp, 0.4_wp], 0.5_wp, zero, upright, floor_half, 0.05_wp, touch)
    call t%equal(touch%n, 0, 'sphere near three faces but far from the corner')
    call test_rim()
  end subroutine test_sphere_plane

  !> A rectangle with a rounded rim: its face is that of the box, beyond it everything within the radius of the rim is touched.
  subroutine test_rim()
    real(wp), parameter :: flat(3) = [3.0_wp, 2.0_wp, 0.0_wp], rim = 0.1_wp
    type(touch_space_t) :: touch

    call touch_sphere_plane([1.0_wp, -1.0_wp, 0.5_wp], 0.5_wp, zero, upright, flat, 0.05_wp, touch, rim)
    call check_point(touch, 1, ez, [1.0_wp, -1.0_wp, 0.05_wp], -0.1_wp, 'sphere on a plate')
    call touch_sphere_plane([3.3_wp, 0.0_wp, 0.4_wp], 0.3_wp, zero, upright, flat, 0.2_wp, touch, rim)
    call check_point(touch, 1, [0.6_wp, 0.0_wp, 0.8_wp], [3.09_wp, 0.0_wp, 0.12_wp], 0.1_wp, 'sphere at a rim')
    call touch_sphere_plane([-3.2_wp, 2.3_wp, -0.6_wp], 0.6_wp, zero, upright, flat, 0.05_wp, touch, rim)
    call check_point(touch, 1, [-2.0_wp, 3.0_wp, -6.0_wp]/7, [-3.0_wp, 2.0_wp, 0.0_wp] + [-0.2_wp, 0.3_wp, -0.6_wp]/7, 0.0_wp, &
                     'sphere at the corner of a rim')
    call touch_sphere_plane([3.7_wp, 0.0_wp, 0.0_wp], 0.5_wp, zero, upright, flat, 0.05_wp, touch, rim)
    call t%equal(touch%n, 0, 'sphere beside a rim, beyond the alert distance')
    call touch_cylinder_plane([3.3_wp, 0.0_wp, 0.4_wp], ey, 1.0_wp, 0.3_wp, zero, upright, flat, 0.2_wp, touch, rim)
    call t%equal(touch%n, 2, 'ends of a cylinder along a rim')
    call check_point(touch, 1, [0.6_wp, 0.0_wp, 0.8_wp], [3.09_wp, -1.0_wp, 0.12_wp], 0.1_wp, 'first end of a cylinder along a rim')
    call check_point(touch, 2, [0.6_wp, 0.0_wp, 0.8_wp], [3.09_wp, 1.0_wp, 0.12_wp], 0.1_wp, 'other end of a cylinder along a rim')
    call touch_cylinder_plane([0.0_wp, 0.0_wp, 0.5_wp], ex, 1.0_wp, 0.45_wp, zero, upright, flat, 0.1_wp, touch, rim)
    call t%equal(touch%n, 2, 'ends of a cylinder on a plate')
    call check_point(touch, 1, ez, [-1.0_wp, 0.0_wp, 0.075_wp], -0.05_wp, 'a cylinder on a plate')
  end subroutine test_rim

  subroutine test_sphere_cylinder()
    type(touch_space_t) :: touch

    call touch_sphere_cylinder([0.6_wp, 0.8_wp, 1.5_wp], 0.5_wp, zero, ez, 2.0_wp, 0.6_wp, 0.1_wp, touch)
    call check_point(touch, 1, [0.6_wp, 0.8_wp, 0.0_wp], [0.33_wp, 0.44_wp, 1.5_wp], -0.1_wp, 'sphere beside a cylinder')
    call touch_sphere_cylinder([0.6_wp, 0.0_wp, 2.8_wp], 0.5_wp, zero, ez, 2.0_wp, 0.45_wp, 0.1_wp, touch)
    call check_point(touch, 1, [0.6_wp, 0.0_wp, 0.8_wp], [0.285_wp, 0.0_wp, 2.38_wp], 0.05_wp, 'sphere at a cap')
    call touch_sphere_cylinder([0.0_wp, 0.0_wp, -2.0_wp], 0.5_wp, zero, ez, 2.0_wp, 0.5_wp, 0.1_wp, touch)
    call check_point(touch, 1, -ez, -2*ez, -1.0_wp, 'sphere on an end of the axis')
    call touch_sphere_cylinder([0.0_wp, 0.0_wp, 1.0_wp], 0.5_wp, zero, ez, 2.0_wp, 0.5_wp, 0.1_wp, touch)
    call check_point(touch, 1, ex, ez, -1.0_wp, 'sphere on the axis')
    call touch_sphere_cylinder([0.9_wp, 0.0_wp, 2.9_wp], 0.5_wp, zero, ez, 2.0_wp, 0.5_wp, 0.1_wp, touch)
    call t%equal(touch%n, 0, 'sphere far from a cap')
  end subroutine test_sphere_cylinder

  subroutine test_hollow()
    type(touch_space_t) :: touch

    call touch_sphere_hollow_cylinder([0.6_wp, 0.8_wp, 1.9_wp], 0.5_wp, zero, ez, 2.0_wp, 1.4_wp, 0.1_wp, touch)
    call check_point(touch, 1, [-0.6_wp, -0.8_wp, 0.0_wp], [0.87_wp, 1.16_wp, 1.9_wp], -0.1_wp, 'sphere in a drum')
    call touch_sphere_hollow_cylinder([0.6_wp, 0.8_wp, 2.1_wp], 0.5_wp, zero, ez, 2.0_wp, 1.4_wp, 0.1_wp, touch)
    call t%equal(touch%n, 0, 'sphere beyond the end of a drum')
    call touch_sphere_hollow_cylinder([0.0_wp, -3.0_wp, 0.0_wp], 0.5_wp, zero, ez, 2.0_wp, 1.4_wp, 0.1_wp, touch)
    call check_point(touch, 1, ey, [0.0_wp, -2.45_wp, 0.0_wp], -2.1_wp, 'sphere outside a drum is pushed in')
    call touch_sphere_hollow_cylinder([0.1_wp, 0.0_wp, 0.0_wp], 0.5_wp, zero, ez, 2.0_wp, 1.4_wp, 0.1_wp, touch)
    call t%equal(touch%n, 0, 'sphere far from the wall of a drum')
    call touch_cylinder_hollow([0.0_wp, 0.8_wp, 0.5_wp], ez, 1.0_wp, 0.6_wp, zero, ez, 2.0_wp, 1.35_wp, 0.1_wp, touch)
    call t%equal(touch%n, 2, 'cylinder along the wall of a drum')
    call check_point(touch, 1, -ey, [0.0_wp, 1.375_wp, -0.5_wp], -0.05_wp, 'cylinder in a drum, low end')
    call check_point(touch, 2, -ey, [0.0_wp, 1.375_wp, 1.5_wp], -0.05_wp, 'cylinder in a drum, high end')
    call touch_cylinder_hollow([0.0_wp, 0.8_wp, 1.5_wp], ez, 1.0_wp, 0.6_wp, zero, ez, 2.0_wp, 1.35_wp, 0.1_wp, touch)
    call check_point(touch, 2, -ey, [0.0_wp, 1.375_wp, 2.0_wp], -0.05_wp, 'cylinder that overhangs the end of a drum')
    call touch_cylinder_hollow(0.2_wp*ez, ex, 1.0_wp, 0.5_wp, zero, ez, 2.0_wp, 1.4_wp, 0.1_wp, touch)
    call check_point(touch, 1, ex, [-1.45_wp, 0.0_wp, 0.2_wp], -0.1_wp, 'cylinder across a drum, one end')
    call check_point(touch, 2, -ex, [1.45_wp, 0.0_wp, 0.2_wp], -0.1_wp, 'cylinder across a drum, other end')
    call touch_cylinder_hollow(3.5_wp*ez, ex, 1.0_wp, 0.5_wp, zero, ez, 2.0_wp, 1.4_wp, 0.1_wp, touch)
    call t%equal(touch%n, 0, 'cylinder beyond the end of a drum')
  end subroutine test_hollow

  subroutine test_cylinder_plane()
    type(touch_space_t) :: touch

    call touch_cylinder_plane([0.0_wp, 0.0_wp, 0.5_wp], ex, 1.0_wp, 0.45_wp, zero, upright, floor_half, 0.1_wp, touch)
    call t%equal(touch%n, 2, 'cylinder lying on a floor')
    call check_point(touch, 1, ez, [-1.0_wp, 0.0_wp, 0.075_wp], -0.05_wp, 'lying, low end')
    call check_point(touch, 2, ez, [1.0_wp, 0.0_wp, 0.075_wp], -0.05_wp, 'lying, high end')
    call t%check(touch%feature(1) == 1_i4 .and. touch%feature(2) == 2_i4, 'lying, features')
    call touch_cylinder_plane([0.0_wp, 0.0_wp, 1.5_wp], -ez, 1.0_wp, 0.45_wp, zero, upright, floor_half, 0.1_wp, touch)
    call t%equal(touch%n, 1, 'cylinder standing on a floor')
    call check_point(touch, 1, ez, [0.0_wp, 0.0_wp, 0.075_wp], -0.05_wp, 'standing')
    call t%check(touch%feature(1) == 2_i4, 'standing, feature of the end')
    call touch_cylinder_plane([2.5_wp, 0.0_wp, 0.5_wp], ex, 1.0_wp, 0.45_wp, zero, upright, floor_half, 0.1_wp, touch)
    call t%equal(touch%n, 2, 'cylinder that overhangs')
    call check_point(touch, 1, ez, [1.5_wp, 0.0_wp, 0.075_wp], -0.05_wp, 'overhanging, end')
    call check_point(touch, 2, ez, [3.0_wp, 0.0_wp, 0.075_wp], -0.05_wp, 'overhanging, edge')
    call touch_cylinder_plane([0.0_wp, 1.0_wp, 0.5_wp], ex, 5.0_wp, 0.45_wp, zero, upright, floor_half, 0.1_wp, touch)
    call check_point(touch, 1, ez, [-3.0_wp, 1.0_wp, 0.075_wp], -0.05_wp, 'from edge to edge, low')
    call check_point(touch, 2, ez, [3.0_wp, 1.0_wp, 0.075_wp], -0.05_wp, 'from edge to edge, high')
    call touch_cylinder_plane([0.0_wp, 2.3_wp, 0.5_wp], ex, 1.0_wp, 0.45_wp, zero, upright, floor_half, 0.1_wp, touch)
    call t%equal(touch%n, 2, 'cylinder beside an edge')
    call check_point(touch, 2, [0.0_wp, 0.6_wp, 0.8_wp], [1.0_wp, 2.015_wp, 0.12_wp], 0.05_wp, 'beside an edge')
    call touch_cylinder_plane([0.0_wp, 2.5_wp, 0.0_wp], ex, 4.0_wp, 0.45_wp, zero, upright, floor_half, 0.1_wp, touch)
    call check_point(touch, 1, ey, [-3.0_wp, 2.025_wp, 0.0_wp], 0.05_wp, 'at a narrow face')
    call touch_cylinder_plane([0.0_wp, 0.0_wp, 0.02_wp], ex, 1.0_wp, 0.3_wp, zero, upright, floor_half, 0.1_wp, touch)
    call check_point(touch, 2, ez, [1.0_wp, 0.0_wp, -0.09_wp], -0.38_wp, 'axis within the floor')
    call touch_cylinder_plane([0.0_wp, 0.0_wp, -0.8_wp], ez, 1.0_wp, 0.3_wp, zero, upright, floor_half, 0.1_wp, touch)
    call t%equal(touch%n, 1, 'axis through the floor')
    call check_point(touch, 1, -ez, [0.0_wp, 0.0_wp, 0.2_wp], -0.6_wp, 'axis through the floor, from below')
  end subroutine test_cylinder_plane

  !> A rod that leans over an edge, and rods turned by next to nothing.
  subroutine test_cylinder_edges()
    type(touch_space_t) :: touch
    real(wp), parameter :: tilts(5) = [-1e-9_wp, -1e-16_wp, 0.0_wp, 1e-16_wp, 1e-9_wp]
    real(wp) :: axis(3), up(3)
    integer :: i

    ! Perpendicular to the edge, a slope of 3 in 4; the axis passes 0.5 from the edge at its middle.
    axis = [0.8_wp, 0.0_wp, -0.6_wp]
    up = [0.6_wp, 0.0_wp, 0.8_wp]
    call touch_cylinder_plane([3.0_wp, 0.0_wp, 0.1_wp] + 0.5_wp*up, axis, 1.0_wp, 0.55_wp, zero, upright, floor_half, 0.1_wp, touch)
    call t%equal(touch%n, 1, 'rod that leans on an edge')
    call check_point(touch, 1, up, [3.0_wp, 0.0_wp, 0.1_wp] - 0.025_wp*up, -0.05_wp, 'leaning')
    do i = 1, size(tilts)
      axis = [1.0_wp, 0.0_wp, tilts(i)]/norm2([1.0_wp, 0.0_wp, tilts(i)])
      call touch_cylinder_plane([0.0_wp, 0.0_wp, 0.5_wp], axis, 5.0_wp, 0.41_wp, zero, upright, floor_half, 0.1_wp, touch)
      call t%equal(touch%n, 2, 'nearly level rod from edge to edge')
      call t%near(norm2(touch%point(:, 2) - touch%point(:, 1)), 6.0_wp, 1e-6_wp, 'its points are at the edges')
      call t%near(touch%gap(1), -0.01_wp, 1e-8_wp, 'its gap')
      call t%check(all(touch%feature(:2) == [1_i4, 2_i4]), 'its features')
      call touch_cylinder_plane([2.8_wp, 0.0_wp, 0.5_wp], axis, 1.0_wp, 0.41_wp, zero, upright, floor_half, 0.1_wp, touch)
      call t%equal(touch%n, 2, 'nearly level rod that overhangs')
      call t%near(norm2(touch%point(:, 2) - touch%point(:, 1)), 1.2_wp, 1e-6_wp, 'its points are at its end and the edge')
      call touch_cylinder_cylinder([0.3_wp, 0.0_wp, 1.0_wp], axis, 1.0_wp, 0.5_wp, zero, -ex, 1.0_wp, 0.52_wp, 0.1_wp, touch)
      call t%equal(touch%n, 2, 'nearly parallel cylinders')
      call t%near(norm2(touch%point(:, 2) - touch%point(:, 1)), 1.7_wp, 1e-6_wp, 'their points')
      axis = [1.0_wp, tilts(i), 0.0_wp]/norm2([1.0_wp, tilts(i), 0.0_wp])
      call touch_cylinder_cylinder([0.3_wp, 0.0_wp, 1.0_wp], axis, 1.0_wp, 0.5_wp, zero, -ex, 1.0_wp, 0.52_wp, 0.1_wp, touch)
      call t%equal(touch%n, 2, 'cylinders that hardly cross')
      call t%near(norm2(touch%point(:, 2) - touch%point(:, 1)), 1.7_wp, 1e-6_wp, 'points of cylinders that hardly cross')
    end do
  end subroutine test_cylinder_edges

  subroutine test_cylinders()
    type(touch_space_t) :: touch
    real(wp) :: axis(3)

    call touch_cylinder_cylinder([0.2_wp, 0.3_wp, 1.0_wp], ex, 1.0_wp, 0.5_wp, zero, ey, 1.0_wp, 0.45_wp, 0.1_wp, touch)
    call t%equal(touch%n, 1, 'crossed cylinders')
    call check_point(touch, 1, ez, [0.0_wp, 0.3_wp, 0.475_wp], 0.05_wp, 'crossed')
    call touch_cylinder_cylinder([1.0_wp, 0.0_wp, 1.0_wp], ex, 1.0_wp, 0.6_wp, zero, ex, 1.5_wp, 0.45_wp, 0.1_wp, touch)
    call t%equal(touch%n, 2, 'parallel cylinders')
    call check_point(touch, 1, ez, [0.0_wp, 0.0_wp, 0.425_wp], -0.05_wp, 'parallel, low')
    call check_point(touch, 2, ez, [1.5_wp, 0.0_wp, 0.425_wp], -0.05_wp, 'parallel, high')
    call touch_cylinder_cylinder([1.0_wp, 0.0_wp, 1.0_wp], -ex, 1.0_wp, 0.6_wp, zero, ex, 1.5_wp, 0.45_wp, 0.1_wp, touch)
    call check_point(touch, 1, ez, [1.5_wp, 0.0_wp, 0.425_wp], -0.05_wp, 'antiparallel, low')
    call touch_cylinder_cylinder([3.0_wp, 0.0_wp, 0.0_wp], ex, 1.0_wp, 0.6_wp, zero, ex, 1.0_wp, 0.45_wp, 0.1_wp, touch)
    call t%equal(touch%n, 1, 'cylinders end to end')
    call check_point(touch, 1, ex, [1.425_wp, 0.0_wp, 0.0_wp], -0.05_wp, 'end to end')
    call touch_cylinder_cylinder([2.6_wp, 0.8_wp, 0.0_wp], ex, 1.0_wp, 0.6_wp, zero, ex, 1.0_wp, 0.45_wp, 0.1_wp, touch)
    call check_point(touch, 1, [0.6_wp, 0.8_wp, 0.0_wp], [1.255_wp, 0.34_wp, 0.0_wp], -0.05_wp, 'caps of parallel cylinders')
    call touch_cylinder_cylinder([2.0_wp, 0.0_wp, 0.2_wp], ex, 1.0_wp, 0.6_wp, zero, ez, 1.0_wp, 0.5_wp, 0.1_wp, touch)
    call check_point(touch, 1, ex, [0.45_wp, 0.0_wp, 0.2_wp], -0.1_wp, 'an end on a side')
    ! Crossed at a slight angle: the middle is nearer than the ends, and all three are near.
    axis = [cos(0.05_wp), sin(0.05_wp), 0.0_wp]
    call touch_cylinder_cylinder([0.0_wp, 0.0_wp, 1.0_wp], axis, 1.0_wp, 0.5_wp, zero, ex, 1.0_wp, 0.5_wp, 0.1_wp, touch)
    call t%equal(touch%n, 3, 'cylinders crossed at a slight angle')
    call t%near(minval(touch%gap(:3)), 0.0_wp, tight, 'their least gap')
    call t%check(all(touch%feature(:3) == [1_i4, 2_i4, 3_i4]), 'their features')
  end subroutine test_cylinders

  !> Shapes on top of each other and of no length: unit normals and finite numbers.
  subroutine test_degenerate()
    type(touch_space_t) :: touch
    type(random_t) :: random
    real(wp) :: axis(3), frame(3, 3), shift(3), across
    integer :: k

    call random%seed(34)
    do k = 1, 200
      axis = random_direction(random)
      frame = random_frame(random)
      shift = zero
      if (modulo(k, 2) == 0) shift = 1e-300_wp*axis
      if (modulo(k, 5) == 0) shift = 1e-16_wp*axis
      call touch_sphere_sphere(shift, 0.5_wp, zero, 0.3_wp, 0.1_wp, touch)
      call check_sound(touch, 1, -0.8_wp, 'spheres with one centre')
      call touch_sphere_cylinder(shift + 0.4_wp*axis, 0.5_wp, zero, axis, 1.0_wp, 0.3_wp, 0.1_wp, touch)
      call check_sound(touch, 1, -0.8_wp, 'sphere on the axis of a cylinder')
      across = dot_product(touch%normal(:, 1), axis)
      call t%near(across, 0.0_wp, tight, 'sphere on the axis leaves across it')
      call touch_sphere_cylinder(shift, 0.5_wp, zero, axis, 0.0_wp, 0.3_wp, 0.1_wp, touch)
      call check_sound(touch, 1, -0.8_wp, 'sphere at a cylinder of no height')
      call touch_sphere_hollow_cylinder(shift + 0.4_wp*axis, 0.5_wp, zero, axis, 1.0_wp, 0.3_wp, 0.1_wp, touch)
      call check_sound(touch, 1, -0.2_wp, 'sphere on the axis of a drum')
      call t%near(dot_product(touch%normal(:, 1), axis), 0.0_wp, tight, 'sphere on the axis of a drum is pushed across it')
      call touch_cylinder_hollow(shift, axis, 0.5_wp, 0.5_wp, zero, axis, 1.0_wp, 0.3_wp, 0.1_wp, touch)
      call check_sound(touch, 2, -0.2_wp, 'cylinder along the axis of a drum')
      call touch_cylinder_plane(shift, axis, 0.0_wp, 0.5_wp, zero, frame, [0.0_wp, 0.0_wp, 0.0_wp], 0.1_wp, touch)
      call check_sound(touch, 1, -0.5_wp, 'cylinder of no height and box of no size')
      call touch_cylinder_plane(shift, frame(:, 1), 0.3_wp, 0.5_wp, zero, frame, [1.0_wp, 1.0_wp, 0.0_wp], 0.1_wp, touch)
      call check_sound(touch, 2, -0.5_wp, 'axis in a plane of no thickness')
      call touch_cylinder_cylinder(shift, axis, 0.5_wp, 0.5_wp, zero, axis, 0.5_wp, 0.3_wp, 0.1_wp, touch)
      call check_sound(touch, 2, -0.8_wp, 'coincident cylinders')
      call t%near(dot_product(touch%normal(:, 1), touch%normal(:, 2)), 1.0_wp, tight, 'coincident cylinders leave one way')
      call touch_cylinder_cylinder(shift + 0.25_wp*axis, -axis, 0.5_wp, 0.5_wp, zero, axis, 0.5_wp, 0.3_wp, 0.1_wp, touch)
      call check_sound(touch, 2, -0.8_wp, 'cylinders on one axis')
      call touch_cylinder_plane(5*axis + 1.03_wp*frame(:, 2) + 0.14_wp*frame(:, 3), frame(:, 1), 1.4_wp, 0.1_wp, 5*axis, frame, &
                                [1.0_wp, 1.0_wp, 0.1_wp], 0.1_wp, touch)
      call check_sound(touch, 2, -0.05_wp, 'rod beside an edge, longer than it')
      ! Rods of one length in a pile: which end is beyond the other is rounding.
      call touch_cylinder_cylinder(5*axis + 0.7_wp*frame(:, 2), frame(:, 1), 0.5_wp, 0.5_wp, 5*axis, frame(:, 1), 0.5_wp, 0.3_wp, &
                                   0.1_wp, touch)
      call check_sound(touch, 2, -0.1_wp, 'aligned rods')
      call touch_cylinder_cylinder(shift, frame(:, 1), 0.5_wp, 0.5_wp, zero, frame(:, 2), 0.5_wp, 0.3_wp, 0.1_wp, touch)
      call check_sound(touch, 1, -0.8_wp, 'crossed cylinders with one centre')
      call t%near(abs(dot_product(touch%normal(:, 1), frame(:, 3))), 1.0_wp, tight, 'crossed cylinders leave across both')
      call touch_cylinder_cylinder(shift, axis, 0.0_wp, 0.5_wp, zero, frame(:, 1), 0.0_wp, 0.3_wp, 0.1_wp, touch)
      call check_sound(touch, 1, -0.8_wp, 'cylinders of no height')
    end do
    call touch_cylinder_cylinder(ex, ex, 0.5_wp, 0.3_wp, zero, ex, 0.5_wp, 0.3_wp, 0.1_wp, touch)
    call check_point(touch, 1, ex, 0.5_wp*ex, -0.6_wp, 'axes that share an end')
  end subroutine test_degenerate

  !> Check that points of contact are as many as they should be, with finite unit normals and one gap.
  subroutine check_sound(touch, n, gap, what)
    type(touch_space_t), intent(in) :: touch
    integer, intent(in) :: n
    real(wp), intent(in) :: gap
    character(len=*), intent(in) :: what
    integer :: i

    call t%equal(touch%n, n, what)
    do i = 1, touch%n
      call t%near(norm2(touch%normal(:, i)), 1.0_wp, tight, what//', unit normal')
      call t%near(touch%gap(i), gap, tight, what//', gap')
      call t%check(all(ieee_is_finite(touch%point(:, i))), what//', finite point')
    end do
  end subroutine check_sound
end program test_touch_space
