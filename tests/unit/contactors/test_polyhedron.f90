!> Convex polyhedra from vertices and faces: building, checking, and what is refused.
program test_polyhedron
  use, intrinsic :: iso_fortran_env, only: int64
  use harness, only: tests_t
  use polyhedra, only: check_polyhedron, check_whole, cube_triangles, expect, fine_cube, globe, none, expect_part, not_a_number, &
                       prism_polyhedron, rounding, same_solid, tetrahedron, tetrahedron_faces, unit_cube, unit_cube_vertex
  use sg_convex_hull, only: hull_is_available
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4, pi
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_build, only: polyhedron_from_faces, polyhedron_from_triangles
  use sg_polyhedron_make, only: box_polyhedron, centre_polyhedron, hull_polyhedron, most_vertices
  use sg_polyhedron_moments, only: box_solid, polyhedron_solid, solid_t
  use sg_random, only: random_t
  use sg_rotations, only: frame_of
  use sg_system, only: file_exists
  use sg_text, only: read_lines, text_t, to_text
  use written_files, only: shared_folder
  implicit none
  type(tests_t) :: t

  call test_box()
  call test_prism()
  call test_triangles()
  call test_digits()
  call test_wall_of_bricks()
  call test_faults_of_faces()
  call test_faults_of_surfaces()
  call test_huge_mesh()
  call t%finish()

contains

  subroutine test_box()
    type(polyhedron_t) :: box
    type(error_t), allocatable :: error
    real(wp), parameter :: half(3) = [1.0_wp, 2.0_wp, 3.0_wp]
    integer :: i

    call box_polyhedron(half, box, error)
    call none(t, error, 'a box')
    call check_whole(t, box, 8, 12, 6, 'box')
    call same_solid(t, polyhedron_solid(box), box_solid(half), 'moments of a box')
    call t%near(box%reach, norm2(half), rounding, 'radius of a box')
    do i = 1, 3
      call t%equal(count(abs(abs(box%normal(i, :)) - 1) < rounding), 2, 'two faces across each axis')
    end do
    call box_polyhedron([1.0_wp, 0.0_wp, 1.0_wp], box, error)
    call expect(t, error, 'the half sizes of a box must be positive')
    call box_polyhedron([1.0_wp, 1e-7_wp, 1.0_wp], box, error)
    call t%check(allocated(error), 'a box too thin to tell from a sheet is refused')
    call box_polyhedron([1.0_wp, 1e-4_wp, 1e-2_wp], box, error)
    call none(t, error, 'a thin box')
    call check_whole(t, box, 8, 12, 6, 'thin box')
    call same_solid(t, polyhedron_solid(box), box_solid([1.0_wp, 1e-4_wp, 1e-2_wp]), 'moments of a thin box')
  end subroutine test_box

  subroutine test_prism()
    type(polyhedron_t) :: prism
    type(error_t), allocatable :: error
    type(solid_t) :: solid
    real(wp) :: area, polar, angle
    integer :: n

    do n = 3, 40
      call prism_polyhedron(n, 2.0_wp, 0.7_wp, prism, error)
      call none(t, error, 'a prism')
      call check_whole(t, prism, 2*n, 3*n, n + 2, 'prism')
      solid = polyhedron_solid(prism)
      ! Area of the regular polygon, and its polar moment about the centre.
      angle = 2*pi/real(n, wp)
      area = real(n, wp)*2*sin(angle)
      polar = area*4*(2 + cos(angle))/6
      call t%near(solid%volume, 1.4_wp*area, 100*rounding, 'volume of a prism')
      call t%near(solid%inertia(3, 3), 1.4_wp*polar, 100*rounding, 'inertia of a prism about its axis')
      call t%near(solid%inertia(1, 1), 1.4_wp*(polar/2 + area*0.49_wp/3), 100*rounding, 'and across it')
    end do
    call prism_polyhedron(2, 1.0_wp, 1.0_wp, prism, error)
    call expect(t, error, 'a prism has 3 to 998 sides, not 2')
    call prism_polyhedron(3, 1.0_wp, -1.0_wp, prism, error)
    call expect(t, error, 'the radius and the half height of a prism must be positive')
  end subroutine test_prism

  !> A tetrahedron and a cube from triangles, the cube also as loose triangles with repeated and unused vertices.
  subroutine test_triangles()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    type(solid_t) :: solid
    real(wp) :: loose(3, 37)
    integer(i4) :: list(3, 12)
    integer :: i, k

    call polyhedron_from_triangles(tetrahedron(), tetrahedron_faces(), shape, error)
    call none(t, error, 'a tetrahedron')
    call check_whole(t, shape, 4, 6, 4, 'tetrahedron')
    solid = polyhedron_solid(shape)
    call t%near(solid%volume, 1/6.0_wp, rounding, 'its volume')
    call t%check(maxval(abs(solid%centre - 0.25_wp)) < rounding, 'its centre')
    ! About the right-angled corner the moments are 1/30 and the products 1/120.
    call t%near(solid%inertia(1, 1), 1/30.0_wp - 2/96.0_wp, rounding, 'its moment of inertia')
    call t%near(solid%inertia(1, 2), -1/120.0_wp + 1/96.0_wp, rounding, 'its product of inertia')
    call polyhedron_from_triangles(unit_cube(), cube_triangles(), shape, error)
    call none(t, error, 'a cube from triangles')
    call check_whole(t, shape, 8, 12, 6, 'cube from triangles')
    loose = 0.3_wp
    list = cube_triangles()
    do i = 1, 12
      do k = 1, 3
        loose(:, 3*i + k - 2) = unit_cube_vertex(list(k, i)) + 1e-9_wp*real(i, wp)
        list(k, i) = int(3*i + k - 2, i4)
      end do
    end do
    loose(:, 1) = 0.5_wp
    call polyhedron_from_triangles(loose, list, shape, error)
    call none(t, error, 'loose triangles')
    call check_whole(t, shape, 8, 12, 6, 'cube from loose triangles')
    call polyhedron_from_triangles(unit_cube(), cube_triangles(reverse=.true.), shape, error, may_turn=.true.)
    call none(t, error, 'a cube inside out that may be turned')
    call check_whole(t, shape, 8, 12, 6, 'turned cube')
    do i = 0, 4095
      list = cube_triangles()
      do k = 1, 12
        if (btest(i, k - 1)) list(:, k) = list([2, 1, 3], k)
      end do
      if (mod(i, 41) /= 0) cycle
      call polyhedron_from_triangles(unit_cube(), list, shape, error, may_turn=.true.)
      call none(t, error, 'a cube any of whose faces may be turned')
      call check_whole(t, shape, 8, 12, 6, 'cube of turned faces')
    end do
    call test_split_sides()
  end subroutine test_triangles

  !> A cube whose sides are cut into many triangles, with vertices along edges and within sides, turned any way.
  subroutine test_split_sides()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    type(random_t) :: random
    real(wp), allocatable :: vertices(:, :)
    integer(i4), allocatable :: list(:, :)
    real(wp) :: frame(3, 3)
    integer :: i, k

    call random%seed(5)
    do i = 1, 10
      call fine_cube(2*i, vertices, list)
      frame = frame_of([(random%normal(), k=1, 4)])
      vertices = matmul(frame, vertices)
      ! Seven digits, as files have them.
      if (mod(i, 2) == 0) vertices = real(nint(vertices*1e7_wp), wp)*1e-7_wp
      call polyhedron_from_triangles(vertices, list, shape, error)
      call none(t, error, 'a cube of '//to_text(size(list, 2))//' triangles')
      call check_whole(t, shape, 8, 12, 6, 'cube of many triangles')
    end do
  end subroutine test_split_sides

  !> Coordinates of seven digits far from the origin, as walls of bricks are written.
  subroutine test_digits()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    type(random_t) :: random
    type(solid_t) :: solid
    real(wp) :: vertices(3, 8), frame(3, 3), shift(3), centre(3)
    integer :: i, k

    call random%seed(6)
    do i = 1, 100
      frame = frame_of([(random%normal(), k=1, 4)])
      shift = [(random%uniform(-5.0_wp, 5.0_wp), k=1, 3)]
      do k = 1, 8
        vertices(:, k) = shift + 0.1_wp*matmul(frame, unit_cube_vertex(int(k, i4))*[2.0_wp, 1.0_wp, 0.5_wp])
      end do
      vertices = real(nint(vertices*1e6_wp), wp)*1e-6_wp
      call polyhedron_from_triangles(vertices, cube_triangles(), shape, error)
      call none(t, error, 'a brick with seven digits')
      call check_whole(t, shape, 8, 12, 6, 'brick with seven digits')
      call centre_polyhedron(shape, centre)
      solid = polyhedron_solid(shape)
      call t%check(maxval(abs(solid%centre)) < rounding, 'the centre of mass is made the origin')
      ! Half a unit of the last digit on lengths of 0.05 to 0.2.
      call t%near(solid%volume, 1e-3_wp, 1e-3_wp*1e-4_wp, 'volume of a brick with seven digits')
      call t%check(shape%reach < 0.12_wp, 'its radius is about its centre')
    end do
  end subroutine test_digits

  !> The bricks of a wall that LMGC90 wrote, in the wall's coordinates: each is a box, and their volumes are the wall's.
  subroutine test_wall_of_bricks()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    type(text_t), allocatable :: lines(:)
    type(solid_t) :: solid
    character(len=:), allocatable :: file
    real(wp) :: vertices(3, 8), low(3), high(3)
    integer(i4) :: list(3, 12)
    integer :: i, k, n

    file = shared_folder()//'/decks/Wall_PR/DATBOX/BODIES.DAT'
    if (.not. file_exists(file)) then
      write (*, '(a)') 'the wall of LMGC90 is not at hand: skipped'
      return
    end if
    call read_lines(file, lines, error)
    n = 0
    do i = 1, size(lines) - 20
      if (index(lines(i)%s, 'POLYR') /= 2 .or. index(lines(i)%s, 'nb_vertex=    8      nb_face=   12') == 0) cycle
      do k = 1, 8
        read (lines(i + k)%s, '(34x,d14.7,7x,d14.7,7x,d14.7)') vertices(:, k)
      end do
      do k = 1, 12
        read (lines(i + 8 + k)%s(35:), *) list(1, k)
        read (lines(i + 8 + k)%s(56:), *) list(2, k)
        read (lines(i + 8 + k)%s(77:), *) list(3, k)
      end do
      ! LMGC90 takes faces that are inside out, and writes such.
      call polyhedron_from_triangles(vertices, list, shape, error, may_turn=.true.)
      call none(t, error, 'a brick of the wall')
      call check_whole(t, shape, 8, 12, 6, 'brick of the wall')
      solid = polyhedron_solid(shape)
      low = minval(vertices, 2)
      high = maxval(vertices, 2)
      call t%near(solid%volume, product(high - low), 1e-12_wp, 'bricks along the axes are boxes')
      n = n + 1
    end do
    call t%check(n > 100, 'the wall has more than a hundred bricks: '//to_text(n))
  end subroutine test_wall_of_bricks

  !> What is wrong with vertices and faces one by one.
  subroutine test_faults_of_faces()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    real(wp) :: vertices(3, 4)
    integer(i4) :: list(3, 4)

    list = tetrahedron_faces()
    call polyhedron_from_triangles(tetrahedron(), list(:, :3), shape, error)
    call expect(t, error, 'a polyhedron needs 4 faces or more, and there are 3')
    vertices = tetrahedron()
    call polyhedron_from_triangles(vertices(:, :3), list, shape, error)
    call expect(t, error, 'a polyhedron needs 4 vertices or more, and there are 3')
    vertices(2, 3) = not_a_number()
    call polyhedron_from_triangles(vertices, list, shape, error)
    call expect(t, error, 'a coordinate of vertex 3 is not finite')
    list(2, 3) = 5
    call polyhedron_from_triangles(tetrahedron(), list, shape, error)
    call expect(t, error, 'face 3 names vertex 5, and there are 4, numbered from 1')
    list(2, 3) = 0
    call polyhedron_from_triangles(tetrahedron(), list, shape, error)
    call expect(t, error, 'face 3 names vertex 0, and there are 4, numbered from 1')
    list(2, 3) = list(1, 3)
    call polyhedron_from_triangles(tetrahedron(), list, shape, error)
    call expect(t, error, 'face 3 names vertex 2 twice')
    list = tetrahedron_faces()
    call polyhedron_from_faces(tetrahedron(), int([1, 4, 7, 9, 12], i4), int([1, 3, 2, 1, 2, 4, 2, 3, 1, 4, 3], i4), shape, error)
    call expect(t, error, 'face 3 has 2 vertices; it needs 3 or more')
    vertices = 1
    call polyhedron_from_triangles(vertices, list, shape, error)
    call expect(t, error, 'the shape has no volume: it is thinner than 2.0E-06 m')
  end subroutine test_faults_of_faces

  !> What is wrong with surfaces as a whole.
  subroutine test_faults_of_surfaces()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    real(wp) :: cube(3, 8), two(3, 16), vertices(3, 5)
    integer(i4) :: list(3, 12), both(3, 24), six(3, 6)

    cube = unit_cube()
    list = cube_triangles()
    call polyhedron_from_triangles(cube, list(:, :11), shape, error)
    call expect(t, error, 'the surface is not closed: the edge between vertices 2 and 6 is in face 5 alone')
    call polyhedron_from_triangles(cube, cube_triangles(reverse=.true.), shape, error)
    call expect(t, error, 'the surface is inside out: all its faces run clockwise seen from outside')
    list(:, 5) = list([1, 3, 2], 5)
    call polyhedron_from_triangles(cube, list, shape, error)
    call expect_part(t, error, 'in the same direction: one of them is inside out')
    call expect_part(t, error, 'faces 2 and 5 run along the edge between vertices 2 and 1 ')
    list = cube_triangles()
    both(:, :12) = list
    both(:, 13:) = list
    call polyhedron_from_triangles(cube, both, shape, error)
    call expect_part(t, error, 'is in 4 faces')
    two(:, :8) = cube
    two(:, 9:) = cube + 3
    both(:, 13:) = list + 8_i4
    call polyhedron_from_triangles(two, both, shape, error)
    call expect_part(t, error, 'the shape is not convex: vertex 13 stands 3.0E+00 m out of the plane of face 3')
    ! One corner of the cube pushed in to below its neighbours' plane.
    cube(:, 8) = 0.4_wp
    call polyhedron_from_triangles(cube, list, shape, error)
    call expect_part(t, error, 'the shape is not convex: vertex ')
    ! A cube pressed flat.
    cube = unit_cube()
    cube(3, :) = 0
    call polyhedron_from_triangles(cube, list, shape, error)
    call expect_part(t, error, 'the shape has no volume: it is thinner than ')
    ! Two tetrahedra on both sides of a triangle, their tips in its plane except for a hair.
    vertices = reshape([0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
                        0.3_wp, 0.3_wp, 1e-6_wp, 0.3_wp, 0.3_wp, -1e-6_wp], [3, 5])
    six = reshape(int([1, 2, 4, 2, 3, 4, 3, 1, 4, 2, 1, 5, 3, 2, 5, 1, 3, 5], i4), [3, 6])
    call polyhedron_from_triangles(vertices, six, shape, error)
    call expect_part(t, error, 'the shape has no volume: it is thinner than ')
    ! A square frame: a box with a hole through it.
    call framed_hole()
  end subroutine test_faults_of_surfaces

  !> A box with a square hole through it: its top lies in one plane, around the hole.
  subroutine framed_hole()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    real(wp) :: vertices(3, 16)
    integer(i4) :: corner(64)
    integer :: i, k, n

    do i = 1, 4
      vertices(:, i) = [real(2*mod(i/2, 2) - 1, wp), real(2*((i - 1)/2) - 1, wp), 0.0_wp]
      vertices(:, i + 4) = vertices(:, i)/2
    end do
    vertices(:, 9:) = vertices(:, :8)
    vertices(3, 9:) = 1
    do i = 1, 4
      n = 16*(i - 1)
      k = 1 + mod(i, 4)
      corner(n + 1:n + 4) = int([i, k, k + 8, i + 8], i4)
      corner(n + 5:n + 8) = int([i + 4, i + 12, k + 12, k + 4], i4)
      corner(n + 9:n + 12) = int([i + 8, k + 8, k + 12, i + 12], i4)
      corner(n + 13:n + 16) = int([i, i + 4, k + 4, k], i4)
    end do
    call polyhedron_from_faces(vertices, [(int(4*i + 1, i4), i=0, 16)], corner, shape, error)
    call expect_part(t, error, 'the shape is not convex: the faces in the plane of face ')
    call expect_part(t, error, 'surround others')
  end subroutine framed_hole

  !> A sphere of a million triangles: refused as a contact shape; its hull is taken with fewer vertices.
  subroutine test_huge_mesh()
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    real(wp), allocatable :: vertices(:, :)
    integer(i4), allocatable :: list(:, :)
    type(solid_t) :: solid
    real(wp) :: deviation
    integer(int64) :: begin, end, rate

    call globe(502, vertices, list)
    call t%check(size(list, 2) > 1000000, 'a million faces')
    call system_clock(begin, rate)
    call polyhedron_from_triangles(vertices, list, shape, error)
    call system_clock(end)
    write (*, '(a,i0,a,f0.2,a)') 'refusing ', size(list, 2), ' faces took ', real(end - begin, wp)/real(rate, wp), ' s'
    call expect_part(t, error, 'more than the 1000 of a contact shape; take a coarser mesh, or hull = true')
    if (.not. hull_is_available()) return
    call hull_polyhedron(vertices, shape, error, deviation=deviation)
    call system_clock(begin)
    write (*, '(a,f0.2,a,i0,a)') 'its hull took ', real(begin - end, wp)/real(rate, wp), ' s and has ', shape%n_vertices, &
      ' vertices'
    call none(t, error, 'the hull of a million faces')
    call check_polyhedron(shape, error)
    call none(t, error, 'it is a good polyhedron')
    call t%check(shape%n_vertices > 400 .and. shape%n_vertices <= most_vertices, 'it uses the vertices allowed')
    solid = polyhedron_solid(shape)
    ! A cap between vertices a distance d apart has height d^2/6 or so; 500 vertices are 0.16 apart.
    call t%check(deviation > 1e-3_wp .and. deviation < 0.02_wp, 'and tells how far it keeps within: '//to_text(deviation, 3))
    call t%near(solid%volume, 4*pi/3, 4*pi*0.02_wp, 'it keeps most of the volume')
  end subroutine test_huge_mesh
end program test_polyhedron
