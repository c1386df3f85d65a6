!> Narrow phase of round shapes in space: brute force over random pairs, pairs moved, turned and exchanged.
!!
!! Lengths are of order 1; `tight` allows some tens of roundings of such lengths.
program test_touch_space_random
  use harness, only: tests_t
  use random_space, only: random_direction, random_frame
  use sg_kinds, only: wp
  use sg_random, only: random_t
  use sg_touch_cylinder_cylinder, only: touch_cylinder_cylinder
  use sg_touch_cylinder_hollow, only: touch_cylinder_hollow
  use sg_touch_cylinder_plane, only: touch_cylinder_plane
  use sg_touch_space, only: touch_space_t
  use sg_touch_sphere_cylinder, only: touch_sphere_cylinder
  use sg_touch_sphere_plane, only: touch_sphere_plane
  implicit none
  real(wp), parameter :: tight = 1e-13_wp, zero(3) = 0
  real(wp), parameter :: upright(3, 3) = &
                         reshape([1.0_wp, zero, 1.0_wp, zero, 1.0_wp], [3, 3])
  integer, parameter :: n_random = 3000
  type(tests_t) :: t

  call test_random_spheres()
  call test_random_cylinders()
  call test_moved()
  call t%finish()

contains

  !> Distance of a point to a segment by its parameter, written apart from the kernels.
  pure real(wp) function to_segment(point, centre, axis, half_height)
    real(wp), intent(in) :: point(3), centre(3), axis(3), half_height

    to_segment = norm2(point - centre - axis*min(half_height, max(-half_height, dot_product(axis, point - centre))))
  end function to_segment

  !> Signed distance of a point to a box, the nearest of all faces inside.
  pure real(wp) function to_box(point, centre, frame, half)
    real(wp), intent(in) :: point(3), centre(3), frame(3, 3), half(3)
    real(wp) :: q(3)

    q = abs(matmul(point - centre, frame)) - half
    to_box = norm2(max(q, 0.0_wp)) + min(maxval(q), 0.0_wp)
  end function to_box

  !> Check what every point of contact promises, given how far the points on its surfaces are from the shapes' surfaces.
  subroutine check_surfaces(touch, i, candidate, antagonist, what)
    type(touch_space_t), intent(in) :: touch
    integer, intent(in) :: i
    real(wp), intent(in) :: candidate, antagonist !! signed distances to the shapes' surfaces
    character(len=*), intent(in) :: what

    call t%near(norm2(touch%normal(:, i)), 1.0_wp, tight, what//', unit normal')
    call t%near(candidate, 0.0_wp, tight, what//', point on the candidate')
    call t%near(antagonist, 0.0_wp, tight, what//', point on the antagonist')
  end subroutine check_surfaces

  !> Spheres about boxes and cylinders: the gap is the signed distance, the facing points lie on both surfaces.
  subroutine test_random_spheres()
    type(random_t) :: random
    type(touch_space_t) :: touch
    real(wp) :: centre(3), origin(3), frame(3, 3), half(3), radius, wall, gap, facing(3)
    integer :: k, n_near

    call random%seed(31)
    n_near = 0
    do k = 1, n_random
      centre = [random%uniform(-1.2_wp, 1.2_wp), random%uniform(-1.2_wp, 1.2_wp), random%uniform(-1.2_wp, 1.2_wp)]
      origin = 0.3_wp*random_direction(random)
      frame = random_frame(random)
      half = [random%uniform(0.1_wp, 1.5_wp), random%uniform(0.1_wp, 1.5_wp), random%uniform(0.05_wp, 0.3_wp)]
      radius = random%uniform(0.05_wp, 1.0_wp)
      wall = random%uniform(0.05_wp, 0.5_wp)
      call touch_sphere_plane(centre, radius, origin, frame, half, 0.2_wp, touch)
      gap = to_box(centre, origin, frame, half) - radius
      if (gap > -radius) then
        call t%check((touch%n == 1) .eqv. (gap < 0.2_wp), 'sphere and box: near or not')
        if (touch%n == 1) then
          n_near = n_near + 1
          call t%near(touch%gap(1), gap, tight, 'sphere and box: gap')
          facing = touch%point(:, 1) - 0.5_wp*touch%gap(1)*touch%normal(:, 1)
          call check_surfaces(touch, 1, norm2(facing + touch%gap(1)*touch%normal(:, 1) - centre) - radius, &
                              to_box(facing, origin, frame, half), 'sphere and box')
        end if
      end if
      call touch_sphere_cylinder(centre, radius, origin, frame(:, 1), half(1), wall, 0.2_wp, touch)
      gap = to_segment(centre, origin, frame(:, 1), half(1)) - radius - wall
      call t%check((touch%n == 1) .eqv. (gap < 0.2_wp), 'sphere and cylinder: near or not')
      if (touch%n == 1) then
        n_near = n_near + 1
        call t%near(touch%gap(1), gap, tight, 'sphere and cylinder: gap')
        facing = touch%point(:, 1) - 0.5_wp*touch%gap(1)*touch%normal(:, 1)
        call check_surfaces(touch, 1, norm2(facing + touch%gap(1)*touch%normal(:, 1) - centre) - radius, &
                            to_segment(facing, origin, frame(:, 1), half(1)) - wall, 'sphere and cylinder')
      end if
    end do
    call t%check(n_near > n_random/2, 'random spheres touch often enough')
  end subroutine test_random_spheres

  !> Signed distance of a point to the surface of a box or of a cylinder along the first axis of the frame.
  pure real(wp) function to_antagonist(point, is_box, frame, half, wall)
    real(wp), intent(in) :: point(3), frame(3, 3), half(3), wall
    logical, intent(in) :: is_box

    if (is_box) then
      to_antagonist = to_box(point, zero, frame, half)
    else
      to_antagonist = to_segment(point, zero, frame(:, 1), half(1)) - wall
    end if
  end function to_antagonist

  !> Cylinders about boxes and cylinders: the least gap is that of a search, each point is a true distance.
  subroutine test_random_cylinders()
    type(random_t) :: random
    type(touch_space_t) :: touch
    real(wp) :: centre(3), axis(3), frame(3, 3), half(3), length, radius, wall
    integer :: k, n_near

    call random%seed(32)
    n_near = 0
    do k = 1, n_random
      centre = [random%uniform(-1.5_wp, 1.5_wp), random%uniform(-1.5_wp, 1.5_wp), random%uniform(-1.5_wp, 1.5_wp)]
      frame = random_frame(random)
      half = [random%uniform(0.1_wp, 1.5_wp), random%uniform(0.1_wp, 1.5_wp), random%uniform(0.05_wp, 0.3_wp)]
      axis = random_direction(random)
      ! A part of them parallel to a face or an edge, or nearly so
      if (modulo(k, 3) == 1) axis = frame(:, 1 + modulo(k, 2))
      if (modulo(k, 3) == 2) axis = 0.05_wp*axis + frame(:, 1)
      axis = axis/norm2(axis)
      length = random%uniform(0.1_wp, 2.0_wp)
      radius = random%uniform(0.05_wp, 0.6_wp)
      wall = random%uniform(0.05_wp, 0.6_wp)
      call touch_cylinder_plane(centre, axis, length, radius, zero, frame, half, 0.2_wp, touch)
      call check_against_search(touch, centre, axis, length, radius, .true., frame, half, wall, n_near)
      call touch_cylinder_cylinder(centre, axis, length, radius, zero, frame(:, 1), half(1), wall, 0.2_wp, touch)
      call check_against_search(touch, centre, axis, length, radius, .false., frame, half, wall, n_near)
    end do
    call t%check(n_near > n_random/2, 'random cylinders touch often enough')
  end subroutine test_random_cylinders

  !> Check points of contact against the least distance along the axis, which is found by thirds since it is convex.
  subroutine check_against_search(touch, centre, axis, length, radius, is_box, frame, half, wall, n_near)
    type(touch_space_t), intent(in) :: touch
    real(wp), intent(in) :: centre(3), axis(3), length, radius, frame(3, 3), half(3), wall
    logical, intent(in) :: is_box
    integer, intent(inout) :: n_near
    character(len=:), allocatable :: what
    real(wp) :: facing(3), low, high, first, second, gap
    integer :: i, j

    what = 'cylinder and cylinder'
    if (is_box) what = 'cylinder and box'
    low = -length
    high = length
    do i = 1, 120
      first = to_antagonist(centre + (low + (high - low)/3)*axis, is_box, frame, half, wall)
      second = to_antagonist(centre + (high - (high - low)/3)*axis, is_box, frame, half, wall)
      if (first > second) then
        low = low + (high - low)/3
      else
        high = high - (high - low)/3
      end if
    end do
    gap = to_antagonist(centre + 0.5_wp*(low + high)*axis, is_box, frame, half, wall) - radius
    ! An axis within the box leaves by a large face whatever is nearest.
    if (is_box .and. gap < 1e-9_wp - radius) return
    call t%check((touch%n > 0) .eqv. (gap < 0.2_wp), what//': near or not')
    if (touch%n == 0) return
    n_near = n_near + 1
    ! A nearest point that counts as no nearer than an end may be nearer by 1e-6 of the radii.
    call t%check(minval(touch%gap(:touch%n)) >= gap - 1e-12_wp, what//': no gap is too small')
    call t%near(minval(touch%gap(:touch%n)), gap, 1.3e-6_wp, what//': least gap')
    do i = 1, touch%n
      facing = touch%point(:, i) - 0.5_wp*touch%gap(i)*touch%normal(:, i)
      first = to_segment(facing + touch%gap(i)*touch%normal(:, i), centre, axis, length) - radius
      second = to_antagonist(facing, is_box, frame, half, wall)
      ! The spheres at other places of the axes have their facing points on the surfaces or beneath them.
      if (touch%gap(i) > gap + 1e-12_wp) then
        first = max(first, 0.0_wp)
        second = max(second, 0.0_wp)
      end if
      call check_surfaces(touch, i, first, second, what)
      do j = 1, i - 1
        call t%check(touch%feature(i) /= touch%feature(j), what//': features differ')
      end do
    end do
  end subroutine check_against_search

  !> Pairs moved and turned together keep their gaps and features; cylinders taken the other way round turn their normals.
  subroutine test_moved()
    type(random_t) :: random
    type(touch_space_t) :: here, there
    real(wp) :: turn(3, 3), shift(3), centre(3), frame(3, 3), axis(3), half(3)
    integer :: k

    call random%seed(33)
    do k = 1, 500
      turn = random_frame(random)
      shift = 5*random_direction(random)
      centre = random_direction(random)*random%uniform(0.3_wp, 1.2_wp)
      frame = random_frame(random)
      axis = random_direction(random)
      half = [0.8_wp, 0.6_wp, 0.1_wp]
      call touch_cylinder_plane(centre, axis, 0.7_wp, 0.4_wp, zero, frame, half, 0.1_wp, here)
      call touch_cylinder_plane(shift + matmul(turn, centre), matmul(turn, axis), 0.7_wp, 0.4_wp, shift, matmul(turn, frame), &
                                half, 0.1_wp, there)
      call check_moved(here, there, turn, shift, 'cylinder and box, moved')
      call touch_cylinder_hollow(centre, axis, 0.7_wp, 0.4_wp, zero, frame(:, 1), 0.9_wp, 1.1_wp, 0.1_wp, here)
      call touch_cylinder_hollow(shift + matmul(turn, centre), matmul(turn, axis), 0.7_wp, 0.4_wp, shift, &
                                 matmul(turn, frame(:, 1)), 0.9_wp, 1.1_wp, 0.1_wp, there)
      call check_moved(here, there, turn, shift, 'cylinder in a drum, moved')
      call touch_cylinder_cylinder(centre, axis, 0.7_wp, 0.4_wp, zero, frame(:, 1), 0.9_wp, 0.3_wp, 0.1_wp, here)
      call touch_cylinder_cylinder(shift + matmul(turn, centre), matmul(turn, axis), 0.7_wp, 0.4_wp, shift, &
                                   matmul(turn, frame(:, 1)), 0.9_wp, 0.3_wp, 0.1_wp, there)
      call check_moved(here, there, turn, shift, 'cylinders, moved')
      call touch_cylinder_cylinder(zero, frame(:, 1), 0.9_wp, 0.3_wp, centre, axis, 0.7_wp, 0.4_wp, 0.1_wp, there)
      call t%equal(there%n, here%n, 'cylinders, exchanged')
      if (there%n /= here%n .or. here%n == 0) cycle
      there%normal = -there%normal
      ! Along the other axis the two ends may come in the other order.
      if (norm2(there%point(:, 1) - here%point(:, 1)) > 1e-9_wp .and. here%n > 1) then
        there%point(:, :2) = there%point(:, 2:1:-1)
        there%normal(:, :2) = there%normal(:, 2:1:-1)
        there%gap(:2) = there%gap(2:1:-1)
      end if
      there%feature = here%feature
      call check_moved(here, there, upright, zero, 'cylinders, exchanged')
    end do
  end subroutine test_moved

  !> Check that what was found there is what was found here, moved.
  subroutine check_moved(here, there, turn, shift, what)
    type(touch_space_t), intent(in) :: here, there
    real(wp), intent(in) :: turn(3, 3), shift(3)
    character(len=*), intent(in) :: what
    integer :: i

    call t%equal(there%n, here%n, what)
    do i = 1, min(here%n, there%n)
      call t%near(there%gap(i), here%gap(i), 1e-12_wp, what//': gap')
      ! Rounding of 1e-15 over distances of axes down to 1e-3
      call t%near(norm2(there%normal(:, i) - matmul(turn, here%normal(:, i))), 0.0_wp, 1e-11_wp, what//': normal')
      call t%near(norm2(there%point(:, i) - shift - matmul(turn, here%point(:, i))), 0.0_wp, 1e-11_wp, what//': point')
      call t%check(there%feature(i) == here%feature(i), what//': feature')
    end do
  end subroutine check_moved
end program test_touch_space_random
