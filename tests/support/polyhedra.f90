!> Polyhedra for tests, and what tests of them have in common.
module polyhedra
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use harness, only: tests_t
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4, pi
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_build, only: polyhedron_from_faces
  use sg_polyhedron_checks, only: check_convex, check_face_count, check_faces, check_vertices, check_volume, length_tolerance, &
                                  most_faces, pair_edges
  use sg_polyhedron_make, only: hull_polyhedron
  use sg_polyhedron_moments, only: solid_t
  use sg_text, only: to_text
  implicit none
  private
  public :: check_polyhedron, check_whole, same_solid, none, expect, expect_part, not_a_number, tetrahedron
  public :: tetrahedron_faces, unit_cube, unit_cube_vertex, cube_triangles, fine_cube, globe, prism_polyhedron, regular_polyhedron
  public :: rounding, identity

  !> Sums of some hundred terms of order one
  real(wp), parameter :: rounding = 1e-13_wp
  real(wp), parameter :: identity(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

contains

  !> Check a finished polyhedron: finite, closed, turned outward, flat faces, convex, with a volume, not too many faces.
  subroutine check_polyhedron(shape, error)
    type(polyhedron_t), intent(in) :: shape !! polyhedron; only vertices and faces are looked at
    type(error_t), allocatable, intent(out) :: error !! set when something is wrong
    integer(i4), allocatable :: mate(:), face_number(:), vertex_number(:)
    real(wp) :: tolerance
    integer :: i

    face_number = [(int(i, i4), i=1, shape%n_faces)]
    vertex_number = [(int(i, i4), i=1, shape%n_vertices)]
    call check_vertices(shape%vertex, error)
    if (.not. allocated(error)) call check_faces(shape%n_vertices, shape%face_first, shape%face_vertex, error)
    if (allocated(error)) return
    tolerance = length_tolerance(shape%vertex)
    call pair_edges(shape%face_first, shape%face_vertex, face_number, vertex_number, mate, error)
    if (.not. allocated(error)) call check_face_count(shape%n_faces, error)
    if (.not. allocated(error)) call check_volume(shape%vertex, shape%face_first, shape%face_vertex, tolerance, .false., error)
    if (.not. allocated(error)) call check_convex(shape, face_number, vertex_number, tolerance, error)
  end subroutine check_polyhedron

  !> Counts, checks, edges and normals of a polyhedron.
  subroutine check_whole(t, shape, n_vertices, n_edges, n_faces, what)
    class(tests_t), intent(inout) :: t
    type(polyhedron_t), intent(in) :: shape
    integer, intent(in) :: n_vertices, n_edges, n_faces
    character(len=*), intent(in) :: what
    type(error_t), allocatable :: error
    integer :: e, k
    logical :: is_good
    real(wp) :: apart(3), worst

    call t%equal(shape%n_vertices, n_vertices, what//': vertices')
    call t%equal(shape%n_edges, n_edges, what//': edges')
    call t%equal(shape%n_faces, n_faces, what//': faces')
    call t%equal(shape%n_vertices - shape%n_edges + shape%n_faces, 2, what//': Euler''s formula')
    if (.not. allocated(shape%vertex)) return
    call check_polyhedron(shape, error)
    call none(t, error, what//' is good')
    is_good = .true.
    worst = -huge(worst)
    do e = 1, shape%n_edges
      is_good = is_good .and. runs_along(shape, shape%edge(3, e), shape%edge(1, e), shape%edge(2, e)) &
                .and. runs_along(shape, shape%edge(4, e), shape%edge(2, e), shape%edge(1, e))
      ! Outward and convex: each face's normal leans away from the middle of the other.
      apart = 0
      do k = shape%face_first(shape%edge(4, e)), shape%face_first(shape%edge(4, e) + 1) - 1
        apart = apart + shape%vertex(:, shape%face_vertex(k)) - shape%vertex(:, shape%edge(1, e))
      end do
      worst = max(worst, dot_product(apart, shape%normal(:, shape%edge(3, e))))
    end do
    call t%check(is_good, what//': edges run along their faces')
    call t%check(worst < 0, what//': faces bend inward at all edges')
    call t%check(maxval(abs(norm2(shape%normal, 1) - 1)) < rounding, what//': normals have length one')
  end subroutine check_whole

  !> Does a face run from one vertex to the other?
  pure logical function runs_along(shape, face, from, to)
    type(polyhedron_t), intent(in) :: shape
    integer(i4), intent(in) :: face, from, to
    integer :: k, n

    runs_along = .false.
    associate (corners => shape%face_vertex(shape%face_first(face):shape%face_first(face + 1) - 1))
      n = size(corners)
      do k = 1, n
        if (corners(k) == from .and. corners(1 + mod(k, n)) == to) runs_along = .true.
      end do
    end associate
  end function runs_along

  subroutine same_solid(t, got, expected, what)
    class(tests_t), intent(inout) :: t
    type(solid_t), intent(in) :: got, expected
    character(len=*), intent(in) :: what
    real(wp) :: scale

    scale = max(expected%volume, maxval(abs(expected%inertia)))
    call t%near(got%volume, expected%volume, rounding*scale, what//': volume')
    call t%check(maxval(abs(got%centre - expected%centre)) < 10*rounding, what//': centre')
    call t%check(maxval(abs(got%inertia - expected%inertia)) < 10*rounding*scale, what//': inertia')
  end subroutine same_solid

  subroutine none(t, error, what)
    class(tests_t), intent(inout) :: t
    type(error_t), allocatable, intent(in) :: error
    character(len=*), intent(in) :: what

    if (allocated(error)) then
      call t%check(.false., what//': '//error%message)
    else
      call t%check(.true., what)
    end if
  end subroutine none

  !> A sentence is said.
  subroutine expect(t, error, sentence)
    class(tests_t), intent(inout) :: t
    type(error_t), allocatable, intent(in) :: error
    character(len=*), intent(in) :: sentence

    if (allocated(error)) then
      call t%check(error%message == sentence, 'said "'//error%message//'" rather than "'//sentence//'"')
    else
      call t%check(.false., 'nothing was said rather than "'//sentence//'"')
    end if
  end subroutine expect

  !> A sentence with these words is said.
  subroutine expect_part(t, error, words)
    class(tests_t), intent(inout) :: t
    type(error_t), allocatable, intent(in) :: error
    character(len=*), intent(in) :: words

    if (allocated(error)) then
      call t%check(index(error%message, words) > 0, 'said "'//error%message//'" without "'//words//'"')
    else
      call t%check(.false., 'nothing was said rather than "'//words//'"')
    end if
  end subroutine expect_part

  !> Not a number.
  real(wp) function not_a_number()

    not_a_number = ieee_value(1.0_wp, ieee_quiet_nan)
  end function not_a_number

  pure function tetrahedron() result(vertices)
    real(wp) :: vertices(3, 4)

    vertices = 0
    vertices(:, 2:) = identity
  end function tetrahedron

  pure function tetrahedron_faces() result(list)
    integer(i4) :: list(3, 4)

    list = reshape(int([1, 3, 2, 1, 2, 4, 2, 3, 4, 1, 4, 3], i4), [3, 4])
  end function tetrahedron_faces

  pure function unit_cube() result(vertices)
    real(wp) :: vertices(3, 8)
    integer :: k

    do k = 1, 8
      vertices(:, k) = unit_cube_vertex(int(k, i4))
    end do
  end function unit_cube

  pure function unit_cube_vertex(k) result(vertex)
    integer(i4), intent(in) :: k
    real(wp) :: vertex(3)

    vertex = real([mod(k - 1, 2), mod((k - 1)/2, 2), (k - 1)/4], wp)
  end function unit_cube_vertex

  pure function cube_triangles(reverse) result(list)
    logical, intent(in), optional :: reverse
    integer(i4) :: list(3, 12)

    list = reshape(int([1, 3, 4, 1, 4, 2, 5, 6, 8, 5, 8, 7, 1, 2, 6, 1, 6, 5, 3, 7, 8, 3, 8, 4, 1, 5, 7, 1, 7, 3, &
                        2, 4, 8, 2, 8, 6], i4), [3, 12])
    if (present(reverse)) list = list([1, 3, 2], :)
  end function cube_triangles

  !> The unit cube with n by n squares a side, each cut into two triangles; vertices repeat along the edges.
  subroutine fine_cube(n, vertices, list)
    integer, intent(in) :: n
    real(wp), allocatable, intent(out) :: vertices(:, :)
    integer(i4), allocatable, intent(out) :: list(:, :)
    integer :: side, i, j, at, m, corner(4)
    real(wp) :: point(3)

    allocate (vertices(3, 6*(n + 1)**2), list(3, 12*n**2))
    at = 0
    m = 0
    do side = 0, 5
      do j = 0, n
        do i = 0, n
          at = at + 1
          point = [real(i, wp)/real(n, wp), real(j, wp)/real(n, wp), real(side/3, wp)]
          if (side < 3) point(1:2) = point(2:1:-1)
          vertices(:, at) = cshift(point, mod(side, 3))
          if (i == n .or. j == n) cycle
          corner = at + [0, 1, n + 2, n + 1]
          m = m + 2
          list(:, m - 1) = int(corner([1, 2, 3]), i4)
          list(:, m) = int(corner([1, 3, 4]), i4)
        end do
      end do
    end do
  end subroutine fine_cube

  !> A globe with 2 n meridians and n - 1 circles of latitude between the poles: 4 n (n - 1) triangles.
  subroutine globe(n, vertices, list)
    integer, intent(in) :: n
    real(wp), allocatable, intent(out) :: vertices(:, :)
    integer(i4), allocatable, intent(out) :: list(:, :)
    integer :: i, j, m, a, b, c, d
    real(wp) :: latitude, longitude

    allocate (vertices(3, 2*n*(n - 1) + 2), list(3, 4*n*(n - 1)))
    vertices(:, size(vertices, 2) - 1) = [0.0_wp, 0.0_wp, -1.0_wp]
    vertices(:, size(vertices, 2)) = [0.0_wp, 0.0_wp, 1.0_wp]
    m = 0
    do j = 1, n - 1
      latitude = pi*(real(j, wp)/real(n, wp) - 0.5_wp)
      do i = 1, 2*n
        longitude = pi*real(i, wp)/real(n, wp)
        a = 2*n*(j - 1) + i
        vertices(:, a) = [cos(latitude)*cos(longitude), cos(latitude)*sin(longitude), sin(latitude)]
        b = 2*n*(j - 1) + 1 + mod(i, 2*n)
        c = b + 2*n
        d = a + 2*n
        if (j == n - 1) c = size(vertices, 2)
        m = m + 1
        list(:, m) = int([a, b, c], i4)
        if (j < n - 1) then
          m = m + 1
          list(:, m) = int([a, c, d], i4)
        end if
        if (j == 1) then
          m = m + 1
          list(:, m) = int([size(vertices, 2) - 1, b, a], i4)
        end if
      end do
    end do
    list = list(:, :m)
  end subroutine globe

  !> An upright prism about the origin over a regular polygon, a corner of which lies along x.
  subroutine prism_polyhedron(n_sides, radius, half_height, shape, error)
    integer, intent(in) :: n_sides !! of the polygon, 3 or more
    real(wp), intent(in) :: radius !! from the axis to its corners [m]
    real(wp), intent(in) :: half_height !! [m]
    type(polyhedron_t), intent(out) :: shape !! prism
    type(error_t), allocatable, intent(out) :: error !! set when the sizes make no prism
    real(wp), allocatable :: vertices(:, :)
    integer(i4), allocatable :: first(:), corner(:)
    integer :: i, n

    n = n_sides
    if (n < 3 .or. n > most_faces - 2) then
      call fail(error, 'a prism has 3 to '//to_text(most_faces - 2)//' sides, not '//to_text(n))
      return
    else if (.not. (radius > 0 .and. half_height > 0)) then
      call fail(error, 'the radius and the half height of a prism must be positive')
      return
    end if
    allocate (vertices(3, 2*n), first(n + 3), corner(6*n))
    do i = 1, n
      vertices(:, i) = [radius*cos(2*pi*real(i - 1, wp)/real(n, wp)), radius*sin(2*pi*real(i - 1, wp)/real(n, wp)), -half_height]
      vertices(:, n + i) = [vertices(1, i), vertices(2, i), half_height]
      corner(4*i - 3:4*i) = int([i, 1 + mod(i, n), n + 1 + mod(i, n), n + i], i4)
      first(i) = int(4*i - 3, i4)
      corner(4*n + i) = int(n + 1 - i, i4)
      corner(5*n + i) = int(n + i, i4)
    end do
    first(n + 1:) = int([4*n + 1, 5*n + 1, 6*n + 1], i4)
    call polyhedron_from_faces(vertices, first, corner, shape, error)
  end subroutine prism_polyhedron

  !> A regular polyhedron about the origin.
  subroutine regular_polyhedron(n_faces, radius, shape, error)
    integer, intent(in) :: n_faces !! 4, 6, 8, 12 or 20
    real(wp), intent(in) :: radius !! from the centre to the vertices [m]
    type(polyhedron_t), intent(out) :: shape !! tetrahedron, cube, octahedron, dodecahedron or icosahedron
    type(error_t), allocatable, intent(out) :: error !! set when there is no such polyhedron, or no hulls in this build
    real(wp), parameter :: golden = (1 + sqrt(5.0_wp))/2
    real(wp) :: points(3, 20), sign_1, sign_2
    integer :: i, k, n

    if (.not. radius > 0) then
      call fail(error, 'the radius of a polyhedron must be positive')
      return
    end if
    n = 0
    ! The corners of a cube, all or every second; and those of three rectangles across each other.
    do i = 0, 7
      if (n_faces == 8 .or. n_faces == 20) cycle
      if (n_faces == 4 .and. mod(popcnt(i), 2) == 1) cycle
      call add(real([2*mod(i, 2) - 1, 2*mod(i/2, 2) - 1, 2*(i/4) - 1], wp))
    end do
    do k = 0, 2
      do i = 0, 3
        sign_1 = real(2*mod(i, 2) - 1, wp)
        sign_2 = real(2*(i/2) - 1, wp)
        if (n_faces == 8 .and. i < 2) call add(cshift([sign_1, 0.0_wp, 0.0_wp], k))
        if (n_faces == 12) call add(cshift([0.0_wp, sign_1*golden, sign_2/golden], k))
        if (n_faces == 20) call add(cshift([0.0_wp, sign_1*golden, sign_2], k))
      end do
    end do
    if (.not. any(n_faces == [4, 6, 8, 12, 20])) then
      call fail(error, 'a regular polyhedron has 4, 6, 8, 12 or 20 faces, not '//to_text(n_faces))
      return
    end if
    call hull_polyhedron(points(:, :n), shape, error)

  contains

    subroutine add(point)
      real(wp), intent(in) :: point(3)

      n = n + 1
      points(:, n) = radius/norm2(point)*point
    end subroutine add
  end subroutine regular_polyhedron
end module polyhedra
