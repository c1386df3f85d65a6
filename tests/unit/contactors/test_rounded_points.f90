!> Extents of bodies: radius about the centre, and the smallest opening of a sieve that they pass.
program test_rounded_points
  use harness, only: tests_t
  use sg_contactors, only: add_disk, add_polygon, contactors_t
  use sg_kinds, only: wp
  use sg_rotations, only: frame_of, rotation_by
  use sg_rounded_points, only: farthest_point, rounded_points, sieve_opening
  use sg_scaled_shapes, only: add_scaled_shapes
  use sg_space_contactors, only: add_cylinder, add_sphere
  implicit none
  !> The search for the narrowest place ends at turns of 1e-7 in space, and widths grow with the turn at corners
  real(wp), parameter :: searched = 1e-5_wp
  type(tests_t) :: t

  call test_plane()
  call test_space()
  call test_shapes()
  call t%finish()

contains

  !> Slits in the plane: a disk, two disks, a triangle and a thin rectangle at an angle.
  subroutine test_plane()
    real(wp) :: angle, side(2), corner(2, 4)

    call t%near(sieve_opening(reshape([0.3_wp, -2.0_wp], [2, 1]), [0.7_wp]), 1.4_wp, 1e-14_wp, 'a disk passes its diameter')
    call t%near(sieve_opening(reshape([0.0_wp, 0.0_wp, 1.0_wp, 2.0_wp], [2, 2]), [0.5_wp, 0.4_wp]), 1.0_wp, 1e-12_wp, &
                'two disks pass the larger diameter')
    ! The heights of an equilateral triangle are its least widths.
    call t%near(sieve_opening(reshape([0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 1.0_wp, sqrt(3.0_wp)], [2, 3]), [0.0_wp, 0.0_wp, 0.0_wp]), &
                sqrt(3.0_wp), 1e-10_wp, 'a triangle')
    angle = 0.7312_wp
    side = [cos(angle), sin(angle)]
    corner(:, 1) = 0
    corner(:, 2) = 3*side
    corner(:, 3) = 3*side + 0.2_wp*[-side(2), side(1)]
    corner(:, 4) = 0.2_wp*[-side(2), side(1)]
    call t%near(sieve_opening(corner, spread(0.0_wp, 1, 4)), 0.2_wp, 1e-10_wp, 'a rectangle')
    call t%near(farthest_point(corner, spread(0.1_wp, 1, 4)), sqrt(9.04_wp) + 0.1_wp, 1e-14_wp, 'radius about the origin')
  end subroutine test_plane

  !> Square openings: a sphere, a cube, a brick and a tetrahedron, which all pass straight.
  subroutine test_space()
    real(wp) :: cube(3, 8), tetrahedron(3, 4), frame(3, 3)
    integer :: i

    call t%near(sieve_opening(spread([1.0_wp, 2.0_wp, 3.0_wp], 2, 1), [0.7_wp]), 1.4_wp, 1e-12_wp, 'a sphere')
    do i = 1, 8
      cube(:, i) = real([mod(i, 2), mod(i/2, 2), mod(i/4, 2)], wp)
    end do
    frame = frame_of(rotation_by([0.3_wp, -0.8_wp, 0.5_wp]))
    call t%near(sieve_opening(matmul(frame, cube), spread(0.0_wp, 1, 8)), 1.0_wp, searched, 'a cube passes its side')
    ! A brick 1 x 2 x 5 goes lengthwise through a square in which it lies aslant: corners of 1 x 2 at 45 degrees need 3/sqrt(2) > 2.
    call t%near(sieve_opening(matmul(frame, spread([1.0_wp, 2.0_wp, 5.0_wp], 2, 8)*cube), spread(0.0_wp, 1, 8)), 2.0_wp, searched, &
                'a brick passes its middle side')
    ! Seen along the line between the middles of two opposite edges a regular tetrahedron is a square with these as diagonals.
    tetrahedron = reshape([1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp], &
                          [3, 4])
    call t%near(sieve_opening(matmul(frame, tetrahedron), spread(0.0_wp, 1, 4)), 2.0_wp, searched, 'a tetrahedron')
  end subroutine test_space

  !> Points of shapes, and copies of shapes at another size.
  subroutine test_shapes()
    type(contactors_t) :: plane, space, larger, larger_space
    real(wp), allocatable :: point(:, :), radius(:)

    call add_disk(plane, 1, 1, 0.5_wp, [1.0_wp, 0.0_wp])
    call add_polygon(plane, 1, 1, reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 0.0_wp, 2.0_wp], [2, 3]), [0.0_wp, -1.0_wp])
    call rounded_points(plane, 1, 2, point, radius)
    call t%equal(size(radius), 4, 'a disk and three vertices')
    call t%near(farthest_point(point, radius), sqrt(5.0_wp), 1e-14_wp, 'the farthest vertex')
    call add_scaled_shapes(larger, 3, plane, 2.0_wp)
    call rounded_points(larger, 1, 2, point, radius)
    call t%near(farthest_point(point, radius), 2*sqrt(5.0_wp), 1e-14_wp, 'twice as far in a copy of twice the size')
    call t%near(radius(1), 1.0_wp, 0.0_wp, 'twice the radius')
    call t%equal(int(larger%body(2)), 3, 'the body of a copy')
    space%dimension = 3
    larger_space%dimension = 3
    call add_sphere(space, 1, 1, 0.5_wp, [0.0_wp, 0.0_wp, 1.0_wp])
    call add_cylinder(space, 1, 1, 2.0_wp, 0.25_wp, [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp])
    call rounded_points(space, 1, 2, point, radius)
    call t%near(farthest_point(point, radius), 2.25_wp, 1e-14_wp, 'end of a capsule')
    ! Lengthwise the capsule and the sphere stand 1.75 high and 1 wide; aslant by an angle from the diagonal they need less.
    call t%check(sieve_opening(point, radius) < 1.75_wp .and. sieve_opening(point, radius) > 1.0_wp, 'a capsule with a sphere')
    call t%near(sieve_opening(point, radius), oblique(), searched, 'lengthwise, turned about the axis')
    call add_scaled_shapes(larger_space, 1, space, 0.5_wp)
    call rounded_points(larger_space, 1, 2, point, radius)
    call t%near(2*sieve_opening(point, radius), oblique(), 2*searched, 'half of it in a copy of half the size')
  end subroutine test_shapes

  !> Side of the smallest square about circles of radii 0.25 and 0.5 whose centres are one apart: these stand on its diagonal.
  pure real(wp) function oblique()
    oblique = 0.75_wp + 1/sqrt(2.0_wp)
  end function oblique
end program test_rounded_points
