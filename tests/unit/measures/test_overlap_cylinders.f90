!> Overlap volumes of cylinders with spheres and planes against closed forms, random points and sums of parts.
program test_overlap_cylinders
  use harness, only: tests_t
  use random_space, only: check_hits, random_direction, random_frame
  use sg_kinds, only: wp, pi
  use sg_overlap_cylinders, only: overlap_cylinder_plane
  use sg_overlap_disks, only: overlap_disk_disk
  use sg_overlap_spheres, only: overlap_sphere_cylinder, overlap_sphere_hollow_cylinder, overlap_sphere_plane, overlap_sphere_sphere
  use sg_random, only: random_t
  implicit none
  !> Some tens of roundings of volumes of order 1
  real(wp), parameter :: tight = 1e-13_wp, zero(3) = 0
  real(wp), parameter :: ex(3) = [1.0_wp, 0.0_wp, 0.0_wp], ez(3) = [0.0_wp, 0.0_wp, 1.0_wp]
  real(wp), parameter :: upright(3, 3) = reshape([1.0_wp, zero, 1.0_wp, zero, 1.0_wp], [3, 3])
  !> Random points a volume
  integer, parameter :: n_points = 20000
  type(tests_t) :: t

  call test_sphere_cylinder()
  call test_cylinder_slices()
  call test_hollow()
  call test_cylinder_plane()
  call test_cylinder_plane_random()
  call t%finish()

contains

  subroutine test_sphere_cylinder()
    real(wp), parameter :: ball = 4*pi/3
    real(wp) :: e
    integer :: i

    call t%near(overlap_sphere_cylinder(0.3_wp*ez, 1.0_wp, zero, ez, 2.0_wp, 0.5_wp), ball*(1 - 0.75_wp*sqrt(0.75_wp)), 1e-12_wp, &
                'ball about a long cylinder')
    call t%near(overlap_sphere_cylinder(0.3_wp*ez + 0.2_wp*ex, 0.2_wp, zero, ez, 2.0_wp, 0.5_wp), ball*0.008_wp, 1e-12_wp, &
                'ball in a cylinder')
    call t%near(overlap_sphere_cylinder(0.3_wp*ez + 0.2_wp*ex, 3.0_wp, zero, ez, 2.0_wp, 0.5_wp), pi + ball/8, 1e-12_wp, &
                'cylinder in a ball')
    call t%near(overlap_sphere_cylinder([1.6_wp, 0.0_wp, 0.5_wp], 1.0_wp, zero, ez, 2.0_wp, 0.5_wp), 0.0_wp, 0.0_wp, 'apart')
    call t%near(overlap_sphere_cylinder(2*ez, 0.4_wp, zero, ez, 2.0_wp, 0.5_wp), ball*0.064_wp, 1e-12_wp, 'ball at an end')
    ! The ball halved by the end plane: half of what a long cylinder would take, and half of a lens.
    call t%near(overlap_sphere_cylinder(2*ez, 1.0_wp, zero, ez, 2.0_wp, 0.5_wp), &
                0.5_wp*ball*(1 - 0.75_wp*sqrt(0.75_wp)) + 0.5_wp*ball/8, 1e-12_wp, 'ball about an end')
    do i = 0, 20
      e = 0.1_wp*real(i, wp)
      call t%near(overlap_sphere_cylinder(e*ex, 1.0_wp, zero, ez, 0.0_wp, 0.5_wp), &
                  overlap_sphere_sphere(e*ex, 1.0_wp, zero, 0.5_wp), 1e-12_wp, 'cylinder of no height')
      call t%near(overlap_sphere_cylinder(e*ex + 3.2_wp*ez, 1.0_wp, zero, ez, 2.0_wp, 0.9_wp), &
                  overlap_sphere_sphere(e*ex + 3.2_wp*ez, 1.0_wp, 2*ez, 0.9_wp), 1e-12_wp, 'ball beyond an end')
    end do
  end subroutine test_sphere_cylinder

  !> Volumes of random balls and cylinders against a plain sum of many slices.
  subroutine test_cylinder_slices()
    integer, parameter :: n = 20000
    type(random_t) :: random
    real(wp) :: e, z, radius, wall, half_height, centre, total, beyond, width
    integer :: k, i

    call random%seed(55)
    do k = 1, 60
      radius = random%uniform(0.2_wp, 1.5_wp)
      wall = random%uniform(0.2_wp, 1.0_wp)
      half_height = random%uniform(0.0_wp, 1.5_wp)
      e = random%uniform(0.0_wp, 1.5_wp)
      ! Slices that touch at one place at once
      if (modulo(k, 4) == 0) e = abs(radius - wall)
      if (modulo(k, 4) == 1) e = 0
      centre = random%uniform(0.0_wp, 2.0_wp)
      total = 0
      width = 2*radius/n
      do i = 1, n
        z = centre - radius + width*(real(i, wp) - 0.5_wp)
        beyond = max(0.0_wp, abs(z) - half_height)
        if (beyond >= wall) cycle
        total = total + width*overlap_disk_disk([e, 0.0_wp], sqrt(max(0.0_wp, radius**2 - (z - centre)**2)), [0.0_wp, 0.0_wp], &
                                                sqrt(wall**2 - beyond**2))
      end do
      ! Kinks and roots at the ends make the plain sum err by some width^(3/2) = 2e-6.
      call t%near(overlap_sphere_cylinder([e, 0.0_wp, centre], radius, zero, ez, half_height, wall), total, 2e-6_wp, &
                  'plain sum of slices')
    end do
  end subroutine test_cylinder_slices

  subroutine test_hollow()
    real(wp), parameter :: ball = 4*pi/3
    type(random_t) :: random
    real(wp) :: inside, outside, radius, wall, e, z, top, at
    integer :: k

    call t%near(overlap_sphere_hollow_cylinder(0.5_wp*ex, 0.4_wp, zero, ez, 2.0_wp, 1.0_wp), 0.0_wp, 0.0_wp, 'ball held')
    call t%near(overlap_sphere_hollow_cylinder(zero, 1.0_wp, zero, ez, 2.0_wp, 0.5_wp), ball*0.75_wp*sqrt(0.75_wp), 1e-12_wp, &
                'ball wider than the hollow cylinder')
    call t%near(overlap_sphere_hollow_cylinder(3*ex, 0.5_wp, zero, ez, 2.0_wp, 1.0_wp), ball/8, 1e-12_wp, 'ball outside')
    call random%seed(56)
    do k = 1, 200
      radius = random%uniform(0.2_wp, 1.0_wp)
      wall = random%uniform(0.2_wp, 1.5_wp)
      e = random%uniform(0.0_wp, 2.0_wp)
      ! Circles that all but touch in the middle slice
      if (modulo(k, 4) == 0) e = abs(radius - wall) + 10.0_wp**random%uniform(-17.0_wp, -1.0_wp)
      z = random%uniform(-1.0_wp, 1.0_wp)
      inside = overlap_sphere_cylinder([e, 0.0_wp, z], radius, zero, ez, 3.0_wp, wall)
      outside = overlap_sphere_hollow_cylinder([e, 0.0_wp, z], radius, zero, ez, 3.0_wp, wall)
      call t%near(inside + outside, ball*radius**3, 1e-12_wp, 'inside and outside together')
      ! Stacked on top of each other, two hollow cylinders are one: their quadratures part elsewhere.
      top = random%uniform(0.5_wp, 2.0_wp)
      at = random%uniform(-top, top)
      call t%near(overlap_sphere_hollow_cylinder([e, 0.0_wp, z - 0.5_wp*(at - top)], radius, zero, ez, 0.5_wp*(at + top), wall) &
                  + overlap_sphere_hollow_cylinder([e, 0.0_wp, z - 0.5_wp*(at + top)], radius, zero, ez, 0.5_wp*(top - at), wall), &
                  overlap_sphere_hollow_cylinder([e, 0.0_wp, z], radius, zero, ez, top, wall), 1e-12_wp, 'stacked hollow cylinders')
    end do
  end subroutine test_hollow

  subroutine test_cylinder_plane()
    real(wp), parameter :: half(3) = [4.0_wp, 3.0_wp, 2.0_wp], ball = 4*pi/3
    real(wp) :: h, segment, cap, d
    integer :: i

    ! The cap and, per length, the segment of a unit radius cut at a depth h
    h = 0.3_wp
    cap = pi*h**2*(3 - h)/3
    segment = acos(1 - h) - (1 - h)*sqrt(2*h - h**2)
    call t%near(overlap_cylinder_plane([0.5_wp, 0.0_wp, 3 - h], ex, 1.5_wp, 1.0_wp, zero, upright, half), cap + 3*segment, tight, &
                'lying')
    call t%near(overlap_cylinder_plane([4.0_wp, 0.0_wp, 3 - h], ex, 1.5_wp, 1.0_wp, zero, upright, half), cap/2 + 1.5_wp*segment, &
                tight, 'lying half over an edge')
    call t%near(overlap_cylinder_plane([0.0_wp, 3.0_wp, 3 - h], ex, 1.5_wp, 1.0_wp, zero, upright, half), cap/2 + 1.5_wp*segment, &
                tight, 'lying along an edge')
    call t%near(overlap_cylinder_plane([0.5_wp, 0.0_wp, 4.5_wp - h], ez, 1.5_wp, 1.0_wp, zero, upright, half), cap, tight, &
                'standing')
    call t%near(overlap_cylinder_plane([0.5_wp, 0.0_wp, 2.0_wp], ez, 1.5_wp, 1.0_wp, zero, upright, half), ball/2 + 1.5_wp*pi, &
                tight, 'standing, half of it within')
    call t%near(overlap_cylinder_plane([0.5_wp, 0.5_wp, 0.5_wp], ex, 2.0_wp, 1.0_wp, zero, upright, half), ball + 4*pi, 100*tight, &
                'cylinder within')
    call t%near(overlap_cylinder_plane([0.5_wp, 0.5_wp, 0.5_wp], ex, 9.0_wp, 6.0_wp, zero, upright, half), 192.0_wp, 1e-11_wp, &
                'box within')
    call t%near(overlap_cylinder_plane([0.0_wp, 3.8_wp, 2.8_wp], ex, 1.5_wp, 1.0_wp, zero, upright, half), 0.0_wp, 0.0_wp, &
                'off an edge')
    call t%near(overlap_cylinder_plane([0.0_wp, 0.0_wp, 3.1_wp], ex, 1.5_wp, 1.0_wp, zero, upright, half), 0.0_wp, 0.0_wp, 'above')
    ! A slanted cylinder through both large faces: the middle of its straight part, as long as the way through the box.
    call t%near(overlap_cylinder_plane(zero, [0.6_wp, 0.0_wp, 0.8_wp], 6.0_wp, 0.5_wp, zero, upright, [9.0_wp, 9.0_wp, 0.4_wp]), &
                pi*0.25_wp, tight, 'slanted through a plate')
    do i = 4, 9
      d = 2.0_wp**(-3*i)
      ! The segment of depth d has the area 4/3 sqrt(2) d^(3/2) up to a relative d; the depth is rounded
      ! to 1e-15, and so is the volume of the half balls.
      call t%near(overlap_cylinder_plane([0.0_wp, 0.0_wp, 3 - d], ex, 1.5_wp, 1.0_wp, zero, upright, half) &
                  /(4*sqrt(2*d)*d + pi*d**2), 1.0_wp, d + tight + 1e-15_wp/d + 1e-15_wp/(d*sqrt(d)), &
                  'thin overlap of a lying cylinder')
    end do
  end subroutine test_cylinder_plane

  !> Random cylinders and planes: spheres where there is no height, sums of two boxes, random points.
  subroutine test_cylinder_plane_random()
    type(random_t) :: random
    real(wp) :: frame(3, 3), half(3), centre(3), axis(3), length, radius, whole, cut_at, lower(3), upper(3), point(3)
    integer :: k, i, hits

    call random%seed(57)
    do k = 1, 300
      frame = random_frame(random)
      half = [random%uniform(0.2_wp, 1.2_wp), random%uniform(0.2_wp, 1.2_wp), random%uniform(0.05_wp, 1.2_wp)]
      centre = random%uniform(0.0_wp, 1.5_wp)*random_direction(random)
      axis = random_direction(random)
      if (modulo(k, 3) == 1) axis = frame(:, 1 + modulo(k/3, 3))
      length = random%uniform(0.0_wp, 1.5_wp)
      radius = random%uniform(0.1_wp, 1.0_wp)
      call t%near(overlap_cylinder_plane(centre, axis, 0.0_wp, radius, zero, frame, half), &
                  overlap_sphere_plane(centre, radius, zero, frame, half), 1e-12_wp, 'cylinder of no height and plane')
      whole = overlap_cylinder_plane(centre, axis, length, radius, zero, frame, half)
      ! Two boxes that share a face
      i = 1 + modulo(k, 3)
      cut_at = random%uniform(-0.9_wp, 0.9_wp)*half(i)
      lower = half
      upper = half
      lower(i) = 0.5_wp*(half(i) + cut_at)
      upper(i) = 0.5_wp*(half(i) - cut_at)
      call t%near(overlap_cylinder_plane(centre, axis, length, radius, (cut_at - lower(i))*frame(:, i), frame, lower) &
                  + overlap_cylinder_plane(centre, axis, length, radius, (cut_at + upper(i))*frame(:, i), frame, upper), whole, &
                  1e-11_wp, 'cylinder and two boxes')
      if (k > 12) cycle
      hits = 0
      do i = 1, n_points
        point = half*[random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)]
        point = matmul(frame, point) - centre
        if (norm2(point - axis*max(-length, min(length, dot_product(axis, point)))) < radius) hits = hits + 1
      end do
      call check_hits(t, hits, n_points, whole/product(2*half), 'points in a cylinder and a box')
    end do
  end subroutine test_cylinder_plane_random
end program test_overlap_cylinders
