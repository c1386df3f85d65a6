!> What two cylinders with round ends share, against closed forms, spheres along an axis, and points thrown at random.
program test_overlap_capsules
  use harness, only: tests_t
  use sg_kinds, only: wp, pi
  use sg_overlap_capsules, only: overlap_cylinder_cylinder
  use sg_overlap_spheres, only: overlap_sphere_cylinder, overlap_sphere_sphere
  use sg_random, only: random_t
  implicit none
  type(tests_t) :: t
  real(wp), parameter :: zero(3) = 0, ex(3) = [1.0_wp, 0.0_wp, 0.0_wp], ey(3) = [0.0_wp, 1.0_wp, 0.0_wp], &
                         ez(3) = [0.0_wp, 0.0_wp, 1.0_wp]
  ! Of the volume: where ends come in or edges meet, the area of slices has kinks, which cost the rule some digits.
  real(wp), parameter :: rule = 1e-4_wp

  call test_crossed()
  call test_in_line()
  call test_beside()
  call test_spheres()
  call test_random_points()
  call t%finish()

contains

  !> Long cylinders that cross at right angles through one point share 16 r3/3; leaning, that over the sine.
  subroutine test_crossed()
    real(wp), parameter :: lean(3) = [0.6_wp, 0.8_wp, 0.0_wp]

    call t%near(overlap_cylinder_cylinder(zero, ex, 5.0_wp, 1.0_wp, zero, ey, 5.0_wp, 1.0_wp), 16/3.0_wp, rule, 'crossed')
    call t%near(overlap_cylinder_cylinder(ex, ex, 5.0_wp, 1.0_wp, zero, lean, 5.0_wp, 1.0_wp), 16/3.0_wp/0.8_wp, rule, 'leaning')
    ! Near each other: a dent of depth d, pi d2 sqrt(r1 r2)/sine and terms of higher order.
    call t%near(overlap_cylinder_cylinder(zero, ex, 5.0_wp, 1.0_wp, 2.9999_wp*ez, lean, 5.0_wp, 2.0_wp)/1e-8_wp, &
                pi*sqrt(2.0_wp)/0.8_wp, 1e-3_wp, 'a small dent')
    call t%near(overlap_cylinder_cylinder(zero, ex, 5.0_wp, 1.0_wp, 3.0001_wp*ez, lean, 5.0_wp, 2.0_wp), 0.0_wp, 0.0_wp, 'apart')
  end subroutine test_crossed

  !> End to end their balls share two caps; one behind the other they share a cylinder with round ends.
  subroutine test_in_line()
    call t%near(overlap_cylinder_cylinder(zero, ez, 2.0_wp, 1.0_wp, 5.9_wp*ez, ez, 2.0_wp, 1.0_wp), &
                overlap_sphere_sphere(zero, 1.0_wp, 1.9_wp*ez, 1.0_wp), 0.015_wp*rule, 'end to end')
    call t%near(overlap_cylinder_cylinder(zero, ez, 3.0_wp, 1.0_wp, 4*ez, ez, 3.0_wp, 0.5_wp), &
                pi*0.5_wp**2*2 + 2*pi/3*0.5_wp**3 + thin_end(), rule, 'one within the other')
    call t%near(overlap_cylinder_cylinder(zero, ez, 3.0_wp, 1.0_wp, zero, ez, 1.0_wp, 0.5_wp), &
                pi*0.5_wp**2*2 + 4*pi/3*0.5_wp**3, rule, 'wholly within')
  end subroutine test_in_line

  !> What a long cylinder of radius 1/2 shares with a half ball of radius 1 about the same axis.
  pure real(wp) function thin_end()
    thin_end = 2*pi/3*(1 - 0.75_wp**1.5_wp)
  end function thin_end

  !> Parallel and side by side: a lens of the section along the common length, and the ends as two balls share them.
  subroutine test_beside()
    real(wp) :: lens

    lens = 2*acos(0.9_wp) - 1.8_wp*sqrt(1 - 0.81_wp)
    call t%near(overlap_cylinder_cylinder(zero, ez, 2.0_wp, 1.0_wp, 1.8_wp*ex, ez, 2.0_wp, 1.0_wp), &
                4*lens + overlap_sphere_sphere(zero, 1.0_wp, 1.8_wp*ex, 1.0_wp), rule, 'side by side')
    call t%near(overlap_cylinder_cylinder(zero, ez, 2.0_wp, 1.0_wp, 1.8_wp*ex, -ez, 2.0_wp, 1.0_wp), &
                4*lens + overlap_sphere_sphere(zero, 1.0_wp, 1.8_wp*ex, 1.0_wp), rule, 'whichever way an axis points')
  end subroutine test_beside

  !> A cylinder without length is a sphere.
  subroutine test_spheres()
    type(random_t) :: random
    real(wp) :: centre(3), axis(3), expected
    integer :: i, k

    call random%seed(2)
    do i = 1, 200
      centre = [(random%uniform(-2.0_wp, 2.0_wp), k=1, 3)]
      axis = [(random%uniform(-1.0_wp, 1.0_wp), k=1, 3)]
      axis = axis/norm2(axis)
      expected = overlap_sphere_cylinder(centre, 0.7_wp, zero, axis, 1.5_wp, 1.0_wp)
      call t%near(overlap_cylinder_cylinder(centre, ez, 0.0_wp, 0.7_wp, zero, axis, 1.5_wp, 1.0_wp), expected, &
                  rule*expected, 'a sphere')
      call t%near(overlap_cylinder_cylinder(zero, axis, 1.5_wp, 1.0_wp, centre, ez, 0.0_wp, 0.7_wp), expected, &
                  rule*expected, 'exchanged')
    end do
  end subroutine test_spheres

  !> Any two cylinders against the share of random points that lie in both.
  subroutine test_random_points()
    integer, parameter :: points = 40000
    type(random_t) :: random
    real(wp) :: centre(3), axis(3), point(3), share, box
    integer :: i, k, inside, p

    call random%seed(3)
    box = 4*4*5
    do i = 1, 20
      centre = [(random%uniform(-1.0_wp, 1.0_wp), k=1, 3)]
      axis = [(random%uniform(-1.0_wp, 1.0_wp), k=1, 3)]
      axis = axis/norm2(axis)
      inside = 0
      do p = 1, points
        point = [random%uniform(-2.0_wp, 2.0_wp), random%uniform(-2.0_wp, 2.0_wp), random%uniform(-2.5_wp, 2.5_wp)]
        if (holds(zero, ez, 1.5_wp, 1.0_wp, point) .and. holds(centre, axis, 2.0_wp, 0.8_wp, point)) inside = inside + 1
      end do
      share = real(inside, wp)/points
      ! Five standard deviations.
      call t%near(overlap_cylinder_cylinder(zero, ez, 1.5_wp, 1.0_wp, centre, axis, 2.0_wp, 0.8_wp), box*share, &
                  5*box*sqrt(share*(1 - share)/points), 'random points')
    end do
  end subroutine test_random_points

  !> Is a point within a radius of an axis?
  pure logical function holds(centre, axis, half, radius, point)
    real(wp), intent(in) :: centre(3), axis(3), half, radius, point(3)
    real(wp) :: from(3), along

    from = point - centre
    along = max(-half, min(half, dot_product(from, axis)))
    holds = norm2(from - along*axis) <= radius
  end function holds
end program test_overlap_capsules
