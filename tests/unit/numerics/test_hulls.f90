!> Convex hulls, and polyhedra made by them: regular, random, simplified.
program test_hulls
  use harness, only: tests_t
  use polyhedra, only: check_polyhedron, check_whole, expect, fine_cube, identity, none, not_a_number, regular_polyhedron, &
                       rounding, same_solid, unit_cube
  use sg_convex_hull, only: convex_hull, hull_is_available
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_polyhedron, only: place_polyhedron, polyhedron_t
  use sg_polyhedron_make, only: centre_polyhedron, hull_polyhedron, most_vertices, move_polyhedron, random_polyhedron
  use sg_polyhedron_moments, only: moved_solid, polyhedron_solid, principal_inertia, solid_t
  use sg_random, only: random_t
  use sg_rotations, only: frame_of
  use sg_text, only: to_text
  implicit none
  type(tests_t) :: t

  if (hull_is_available()) then
    call test_regular()
    call test_random()
    call test_large_random()
    call test_hull()
    call test_hull_faults()
    call test_simplified_hull()
  else
    write (*, '(a)') 'no Qhull: tests of hulls are left out'
    call test_without_hull()
  end if
  call t%finish()

contains

  subroutine test_regular()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    type(solid_t) :: solid
    integer, parameter :: faces(5) = [4, 6, 8, 12, 20], vertices(5) = [4, 8, 6, 20, 12]
    real(wp) :: volumes(5), golden, length
    integer :: i

    golden = (1 + sqrt(5.0_wp))/2
    ! Volumes at a circumradius of 2, from edge lengths.
    length = 2*4/sqrt(6.0_wp)
    volumes(1) = length**3/(6*sqrt(2.0_wp))
    volumes(2) = (4/sqrt(3.0_wp))**3
    volumes(3) = sqrt(2.0_wp)/3*(2*sqrt(2.0_wp))**3
    length = 4/(sqrt(3.0_wp)*golden)
    volumes(4) = (15 + 7*sqrt(5.0_wp))/4*length**3
    length = 4/sqrt(golden*sqrt(5.0_wp))
    volumes(5) = 5*(3 + sqrt(5.0_wp))/12*length**3
    do i = 1, 5
      call regular_polyhedron(faces(i), 2.0_wp, shape, error)
      call none(t, error, 'a regular polyhedron')
      call check_whole(t, shape, vertices(i), vertices(i) + faces(i) - 2, faces(i), 'regular polyhedron')
      solid = polyhedron_solid(shape)
      call t%near(solid%volume, volumes(i), 1e3_wp*rounding, 'volume of a regular polyhedron of '//to_text(faces(i))//' faces')
      call t%check(maxval(abs(solid%inertia - solid%inertia(1, 1)*identity)) < 1e3_wp*rounding, 'its inertia is that of a ball')
    end do
    call regular_polyhedron(7, 2.0_wp, shape, error)
    call expect(t, error, 'a regular polyhedron has 4, 6, 8, 12 or 20 faces, not 7')
  end subroutine test_regular

  !> Random polyhedra of all sizes: whole, and as many vertices as asked for.
  subroutine test_random()
    type(polyhedron_t) :: shape, again
    type(error_t), allocatable :: error
    type(random_t) :: random
    type(solid_t) :: solid
    real(wp) :: frame(3, 3), centre(3), volume, moments(3), same(3), axes(3, 3)
    integer :: i, k, n

    call random%seed(11)
    do i = 1, 300
      n = 4 + mod(i, 60)
      call random_polyhedron(n, [1.0_wp, 0.7_wp, 0.4_wp], random, shape, error)
      call none(t, error, 'a random polyhedron')
      call t%equal(shape%n_vertices, n, 'its vertices')
      call check_whole(t, shape, n, shape%n_edges, shape%n_edges + 2 - n, 'random polyhedron')
      ! By pyramids over the faces from the origin, which is inside.
      solid = polyhedron_solid(shape)
      volume = 0
      do k = 1, shape%n_faces
        volume = volume + pyramid(shape, k)
      end do
      call t%near(solid%volume, volume, rounding, 'volume by pyramids')
      frame = frame_of([(random%normal(), k=1, 4)])
      call principal_inertia(solid, moments, axes)
      call move_polyhedron(shape, [3.0_wp, -4.0_wp, 5.0_wp], frame)
      call check_polyhedron(shape, error)
      call none(t, error, 'the same moved')
      ! Seen from 7 m off, the 1e-16 of a coordinate count for 100 times the volume's.
      call same_solid(t, moved_solid(polyhedron_solid(shape), [3.0_wp, -4.0_wp, 5.0_wp], frame), solid, &
                      'moments do not depend on the frame')
      call principal_inertia(polyhedron_solid(shape), same, axes)
      call t%check(maxval(abs(sorted(moments) - sorted(same))) < 10*rounding, 'nor do the principal ones')
      call centre_polyhedron(shape, centre)
      call t%check(norm2(centre + matmul([3.0_wp, -4.0_wp, 5.0_wp], frame)) < 1, 'the centre of mass is inside')
    end do
    call random%seed(12)
    call random_polyhedron(20, [1.0_wp, 1.0_wp, 1.0_wp], random, shape, error)
    call random%seed(12)
    call random_polyhedron(20, [1.0_wp, 1.0_wp, 1.0_wp], random, again, error)
    call t%check(maxval(abs(shape%vertex - again%vertex)) <= 0, 'the same seed gives the same polyhedron')
    call random_polyhedron(3, [1.0_wp, 1.0_wp, 1.0_wp], random, again, error)
    call expect(t, error, 'a random polyhedron has 4 to 502 vertices, not 3')
    call random_polyhedron(9, [1.0_wp, 1.0_wp, 0.0_wp], random, again, error)
    call expect(t, error, 'the half axes of a random polyhedron must be positive')
  end subroutine test_random

  !> The largest that is allowed, and placed in the world.
  subroutine test_large_random()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    type(random_t) :: random
    integer :: f

    call random%seed(13)
    call random_polyhedron(most_vertices, [1.0_wp, 1.0_wp, 2.0_wp], random, shape, error)
    call none(t, error, 'the largest random polyhedron')
    call check_whole(t, shape, most_vertices, 3*most_vertices - 6, 2*most_vertices - 4, 'largest random polyhedron')
    call place_polyhedron(shape, [1.0_wp, 2.0_wp, 3.0_wp], frame_of([0.5_wp, 0.5_wp, 0.5_wp, 0.5_wp]))
    call t%check(all([(maxval(matmul(shape%world_normal(:, f), shape%world_vertex)) &
                       < dot_product(shape%world_normal(:, f), shape%centre) + shape%face_height(f) + rounding, &
                       f=1, shape%n_faces)]), 'placed in the world no vertex stands out')
  end subroutine test_large_random

  !> Hulls of points of a ball and of a grid: all points behind all faces, vertices among the points.
  subroutine test_hull()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    type(random_t) :: random
    real(wp), allocatable :: points(:, :)
    integer :: i, k, f

    call random%seed(21)
    do i = 1, 50
      allocate (points(3, 10*i))
      do k = 1, size(points, 2)
        points(:, k) = [random%normal(), random%normal(), 3*random%normal()] + 100
      end do
      call hull_polyhedron(points, shape, error)
      call none(t, error, 'a hull')
      call check_polyhedron(shape, error)
      call none(t, error, 'is a good polyhedron')
      call t%equal(shape%n_vertices - shape%n_edges + shape%n_faces, 2, 'Euler''s formula')
      do f = 1, shape%n_faces
        ! Faces are flat to the five millionths of the size that files' digits leave; hulls of doubles are much better, but
        ! vertices nearer than that to a plane are taken into it.
        call t%check(maxval(matmul(shape%normal(:, f), points)) < 1e-3_wp + &
                     dot_product(shape%normal(:, f), shape%vertex(:, shape%face_vertex(shape%face_first(f)))), 'all points behind')
      end do
      do k = 1, shape%n_vertices
        call t%check(minval(norm2(points - spread(shape%vertex(:, k), 2, size(points, 2)), 1)) < rounding, 'vertices are points')
      end do
      deallocate (points)
    end do
    allocate (points(3, 1000))
    do k = 1, 1000
      points(:, k) = real([mod(k, 10), mod(k/10, 10), (k - 1)/100], wp)
    end do
    call hull_polyhedron(points, shape, error)
    call none(t, error, 'the hull of a grid')
    points = real(nint(matmul(frame_of([0.9_wp, 0.3_wp, -0.2_wp, 0.4_wp]), points)*1e6_wp), wp)*1e-6_wp
    call hull_polyhedron(points, shape, error)
    call none(t, error, 'the hull of a turned grid with seven digits')
    call check_polyhedron(shape, error)
    call none(t, error, 'and it is good')
    ! Points in clusters about the places of a grid, as joined scans have them.
    do i = 1, 20
      do k = 1, 1000
        points(:, k) = anint([(random%uniform(-1.5_wp, 1.5_wp), f=1, 3)]) + 1e-9_wp*random%normal()
        points(1, k) = points(1, k) + 1e-9_wp*random%normal()
      end do
      points = matmul(frame_of([(random%normal(), f=1, 4)]), points)
      call hull_polyhedron(points, shape, error)
      call none(t, error, 'the hull of clusters')
      call check_whole(t, shape, 8, 12, 6, 'hull of clusters')
    end do
  end subroutine test_hull

  subroutine test_hull_faults()
    type(error_t), allocatable :: error
    type(polyhedron_t) :: shape
    integer(i4), allocatable :: first(:), corner(:)
    real(wp) :: points(3, 20)
    type(random_t) :: random
    integer :: i

    call random%seed(22)
    do i = 1, 20
      points(:, i) = [random%normal(), random%normal(), random%normal()]
    end do
    call convex_hull(points(:, :3), first, corner, error)
    call expect(t, error, 'a convex hull needs 4 points or more, and there are 3')
    call convex_hull(points(:, :1), first, corner, error)
    call expect(t, error, 'a convex hull needs 4 points or more, and there is 1')
    call hull_polyhedron(points, shape, error, at_most=3)
    call expect(t, error, 'a polyhedron needs 4 vertices or more, and 3 are allowed')
    points(3, :) = points(1, :) - 2*points(2, :) + 1
    call convex_hull(points, first, corner, error)
    call expect(t, error, 'all 20 points lie in one plane: their convex hull has no volume')
    points(1, :) = 3
    points(2, :) = 0.1_wp*points(3, :)
    call convex_hull(points, first, corner, error)
    call expect(t, error, 'all 20 points lie on one line: their convex hull has no volume')
    points = 0.1_wp
    call convex_hull(points, first, corner, error)
    call expect(t, error, 'all 20 points coincide: they have no convex hull')
    points(2, 7) = not_a_number()
    call convex_hull(points, first, corner, error)
    call expect(t, error, 'a coordinate of point 7 is not finite')
  end subroutine test_hull_faults

  !> A hull with few vertices lies within the whole one, and the deviation told is that of the points.
  subroutine test_simplified_hull()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    type(random_t) :: random
    real(wp), allocatable :: points(:, :), vertices(:, :)
    integer(i4), allocatable :: list(:, :)
    real(wp) :: deviation, out
    integer, parameter :: sizes(4) = [4, 8, 50, 300]
    integer :: i, k, f, n

    call random%seed(23)
    allocate (points(3, 3000))
    do k = 1, size(points, 2)
      points(:, k) = [random%normal(), random%normal(), random%normal()]
      points(:, k) = [1.0_wp, 0.6_wp, 0.3_wp]*points(:, k)/norm2(points(:, k))
    end do
    do i = 1, 4
      n = sizes(i)
      call hull_polyhedron(points, shape, error, at_most=n, deviation=deviation)
      call none(t, error, 'a hull with few vertices')
      call t%check(shape%n_vertices <= n .and. shape%n_vertices > n/2, 'as many as allowed')
      out = 0
      do f = 1, shape%n_faces
        out = max(out, maxval(matmul(shape%normal(:, f), points)) - &
                  dot_product(shape%normal(:, f), shape%vertex(:, shape%face_vertex(shape%face_first(f)))))
      end do
      ! Except what merging of faces moves.
      call t%near(out, deviation, 2e-5_wp, 'points stand out as far as told')
    end do
    ! A cube of many points needs no more than its corners, however many points rounding puts outside.
    call fine_cube(40, vertices, list)
    vertices = real(nint(matmul(frame_of([0.9_wp, 0.3_wp, -0.2_wp, 0.4_wp]), vertices)*1e7_wp), wp)*1e-7_wp
    call hull_polyhedron(vertices, shape, error, at_most=12, deviation=deviation)
    call none(t, error, 'the hull of a cube of many points')
    call check_whole(t, shape, 8, 12, 6, 'hull of a cube of many points')
    call t%check(deviation < 1e-5_wp, 'is the cube')
  end subroutine test_simplified_hull

  subroutine test_without_hull()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error

    call hull_polyhedron(unit_cube(), shape, error)
    call expect(t, error, 'this program was built without Qhull, which convex hulls need; '// &
                'polyhedra given with their faces do without')
  end subroutine test_without_hull

  !> Volume of the pyramid between the origin and a face.
  pure real(wp) function pyramid(shape, face) result(volume)
    type(polyhedron_t), intent(in) :: shape
    integer, intent(in) :: face
    real(wp) :: area, u(3), v(3)
    integer :: k

    area = 0
    associate (corners => shape%face_vertex(shape%face_first(face):shape%face_first(face + 1) - 1))
      do k = 2, size(corners) - 1
        u = shape%vertex(:, corners(k)) - shape%vertex(:, corners(1))
        v = shape%vertex(:, corners(k + 1)) - shape%vertex(:, corners(1))
        area = area + sqrt(max(0.0_wp, sum(u**2)*sum(v**2) - dot_product(u, v)**2))/2
      end do
      volume = area*dot_product(shape%normal(:, face), shape%vertex(:, corners(1)))/3
    end associate
  end function pyramid

  pure function sorted(values) result(s)
    real(wp), intent(in) :: values(3)
    real(wp) :: s(3)

    s = [minval(values), sum(values) - minval(values) - maxval(values), maxval(values)]
  end function sorted
end program test_hulls
