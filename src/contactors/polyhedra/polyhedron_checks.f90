!> What a surface must be to bound a convex polyhedron, each failure reported with what and where.
!!
!! Lengths are judged against a tolerance that `length_tolerance` makes from the size of the shape and from the digits
!! that files carry: a face is flat, and a shape convex, when no vertex is farther out of place than that. A length is
!! a better measure than an angle: over a narrow triangle rounding alone turns the normal by any angle, yet moves no vertex.
module sg_polyhedron_checks
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4, i8
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_moments, only: solid_t, surface_solid
  use sg_sorting, only: sort_permutation
  use sg_text, only: to_text
  implicit none
  private
  public :: check_vertices, check_faces, check_volume, check_convex, check_face_count
  public :: pair_edges, length_tolerance, face_area, most_faces

  !> Most faces of a contact shape: detection looks at all faces and edges of two shapes, and hulls are made to keep within
  integer, parameter :: most_faces = 1000
  !> Files carry seven digits: of a number between 10^k and 10^(k+1) half a unit of the seventh is up to this share
  real(wp), parameter :: digits_of_files = 5e-7_wp
  !> Ten such errors: what vertices are off the plane through others, and some room
  real(wp), parameter :: flatness = 10*digits_of_files

  !> Bits of the number of a vertex: sorting takes keys of 55 bits, and no file holds as many vertices
  integer, parameter :: vertex_bits = 27

contains

  !> Distance below which two points are one, a point lies in a plane, and a vertex does not stand out of a face [m].
  !!
  !! Coordinates are trusted to seven digits, about the origin in which they are given and about the shape's middle.
  pure real(wp) function length_tolerance(vertices)
    real(wp), intent(in) :: vertices(:, :) !! finite [m], shape (3, vertices), not empty

    length_tolerance = max(flatness*norm2(maxval(vertices, 2) - minval(vertices, 2))/2, 4*digits_of_files*maxval(abs(vertices)))
  end function length_tolerance

  !> Check that vertices are finite and four or more.
  subroutine check_vertices(vertices, error)
    real(wp), intent(in) :: vertices(:, :) !! [m], shape (3, vertices)
    type(error_t), allocatable, intent(out) :: error !! set when something is wrong
    integer :: i

    do i = 1, size(vertices, 2)
      if (all(ieee_is_finite(vertices(:, i)))) cycle
      call fail(error, 'a coordinate of vertex '//to_text(i)//' is not finite')
      return
    end do
    if (size(vertices, 2) < 4) then
      call fail(error, 'a polyhedron needs 4 vertices or more, and there '//trim(merge('is ', 'are', size(vertices, 2) == 1))// &
                ' '//to_text(size(vertices, 2)))
    end if
  end subroutine check_vertices

  !> Check that there are four faces or more, and that each has three different vertices or more, all of them there.
  subroutine check_faces(n_vertices, face_first, face_vertex, error)
    integer, intent(in) :: n_vertices !! vertices there are
    integer(i4), intent(in) :: face_first(:) !! corners of face f: face_first(f) to face_first(f + 1) - 1
    integer(i4), intent(in) :: face_vertex(:) !! corners of all faces
    type(error_t), allocatable, intent(out) :: error !! set when something is wrong
    integer :: f, k, n

    n = size(face_first) - 1
    if (n < 4) then
      call fail(error, 'a polyhedron needs 4 faces or more, and there '//trim(merge('is ', 'are', n == 1))//' '//to_text(n))
      return
    end if
    do f = 1, n
      associate (corners => face_vertex(face_first(f):face_first(f + 1) - 1))
        if (size(corners) < 3) then
          call fail(error, 'face '//to_text(f)//' has '//to_text(size(corners))//' vertices; it needs 3 or more')
          return
        end if
        do k = 1, size(corners)
          if (corners(k) < 1 .or. corners(k) > n_vertices) then
            call fail(error, 'face '//to_text(f)//' names vertex '//to_text(int(corners(k)))//', and there are '// &
                      to_text(n_vertices)//', numbered from 1')
            return
          end if
          if (.not. any(corners(:k - 1) == corners(k))) cycle
          call fail(error, 'face '//to_text(f)//' names vertex '//to_text(int(corners(k)))//' twice')
          return
        end do
      end associate
    end do
  end subroutine check_faces

  !> Pair the edges of faces: a closed surface has every edge in two faces that run along it in opposite directions.
  subroutine pair_edges(face_first, face_vertex, face_number, vertex_number, mate, error, may_agree)
    integer(i4), intent(in) :: face_first(:) !! corners of face f: face_first(f) to face_first(f + 1) - 1
    integer(i4), intent(in) :: face_vertex(:) !! corners of all faces; edge k of a face runs from corner k to the next
    integer(i4), intent(in) :: face_number(:) !! numbers of the faces, for messages
    integer(i4), intent(in) :: vertex_number(:) !! numbers of the vertices, for messages
    integer(i4), allocatable, intent(out) :: mate(:) !! place in face_vertex of the same edge in the other face
    type(error_t), allocatable, intent(out) :: error !! set when the surface is not closed or its faces disagree
    logical, intent(in), optional :: may_agree !! may both faces run along an edge in the same direction? default no
    integer(i8), allocatable :: keys(:)
    integer(i4), allocatable :: order(:), face_of(:), next(:)
    integer :: f, k, i, n, count
    logical :: may

    may = .false.
    if (present(may_agree)) may = may_agree
    n = size(face_vertex)
    allocate (mate(n), keys(n), face_of(n), next(n))
    do f = 1, size(face_first) - 1
      do k = face_first(f), face_first(f + 1) - 1
        next(k) = face_vertex(merge(face_first(f), int(k + 1, i4), k == face_first(f + 1) - 1))
        face_of(k) = int(f, i4)
        keys(k) = shiftl(int(min(face_vertex(k), next(k)), i8), vertex_bits) + int(max(face_vertex(k), next(k)), i8)
      end do
    end do
    order = sort_permutation(keys)
    i = 1
    do while (i <= n)
      count = 1
      do while (i + count <= n)
        if (keys(order(i + count)) /= keys(order(i))) exit
        count = count + 1
      end do
      associate (a => order(i), b => order(min(i + 1, n)))
        if (count == 1) then
          call fail(error, 'the surface is not closed: '//edge(face_vertex(a), next(a))//' is in face '// &
                    number(face_of(a))//' alone')
        else if (count > 2) then
          call fail(error, 'the surface is not simple: '//edge(face_vertex(a), next(a))//' is in '//to_text(count)// &
                    ' faces, '//number(face_of(a))//' and '//number(face_of(b))//' among them')
        else if (face_vertex(a) == face_vertex(b) .and. .not. may) then
          call fail(error, 'faces '//number(face_of(a))//' and '//number(face_of(b))//' run along '// &
                    edge(face_vertex(a), next(a))//' in the same direction: one of them is inside out')
        end if
        if (allocated(error)) return
        mate(a) = b
        mate(b) = a
      end associate
      i = i + 2
    end do

  contains

    function edge(a, b) result(words)
      integer(i4), intent(in) :: a, b
      character(len=:), allocatable :: words

      words = 'the edge between vertices '//to_text(int(vertex_number(a)))//' and '//to_text(int(vertex_number(b)))
    end function edge

    function number(face) result(word)
      integer(i4), intent(in) :: face
      character(len=:), allocatable :: word

      word = to_text(int(face_number(face)))
    end function number
  end subroutine pair_edges

  !> Check that a closed surface bounds a volume, and that its faces run counter-clockwise seen from outside.
  !!
  !! A plate thinner than the tolerance has less volume than half its surface times the tolerance.
  subroutine check_volume(vertices, face_first, face_vertex, tolerance, may_turn, error)
    real(wp), intent(in) :: vertices(:, :) !! [m], shape (3, vertices)
    integer(i4), intent(in) :: face_first(:) !! corners of face f: face_first(f) to face_first(f + 1) - 1
    integer(i4), intent(in) :: face_vertex(:) !! corners of all faces
    real(wp), intent(in) :: tolerance !! thickness that is none [m]
    logical, intent(in) :: may_turn !! is a surface that is inside out as a whole no mistake?
    type(error_t), allocatable, intent(out) :: error !! set when something is wrong
    type(solid_t) :: solid
    real(wp) :: surface
    integer :: f

    solid = surface_solid(vertices, face_first, face_vertex)
    surface = 0
    do f = 1, size(face_first) - 1
      surface = surface + norm2(face_area(vertices, face_vertex(face_first(f):face_first(f + 1) - 1)))
    end do
    if (.not. abs(solid%volume) > surface*tolerance/2) then
      call fail(error, 'the shape has no volume: it is thinner than '//to_text(tolerance, 2)//' m')
    else if (solid%volume < 0 .and. .not. may_turn) then
      call fail(error, 'the surface is inside out: all its faces run clockwise seen from outside')
    end if
  end subroutine check_volume

  !> Check the number of faces, coplanar ones counting as one.
  subroutine check_face_count(n_faces, error)
    integer, intent(in) :: n_faces !! faces there are
    type(error_t), allocatable, intent(out) :: error !! set when there are too many

    if (n_faces <= most_faces) return
    call fail(error, 'the surface has '//to_text(n_faces)//' faces that are not coplanar, more than the '//to_text(most_faces)// &
              ' of a contact shape; take a coarser mesh, or hull = true, which keeps within')
  end subroutine check_face_count

  !> Check that every vertex is behind the plane of every face, and those of a face in it.
  subroutine check_convex(shape, face_number, vertex_number, tolerance, error)
    type(polyhedron_t), intent(in) :: shape !! polyhedron; only vertices and faces are looked at
    integer(i4), intent(in) :: face_number(:) !! numbers of the faces, for messages
    integer(i4), intent(in) :: vertex_number(:) !! numbers of the vertices, for messages
    real(wp), intent(in) :: tolerance !! how far a vertex may stand out [m]
    type(error_t), allocatable, intent(out) :: error !! set when something is wrong
    real(wp) :: area(3), normal(3), middle(3), height, highest
    integer :: f, i, out

    do f = 1, shape%n_faces
      associate (corners => shape%face_vertex(shape%face_first(f):shape%face_first(f + 1) - 1))
        area = face_area(shape%vertex, corners)
        if (.not. norm2(area) > tolerance**2) then
          call fail(error, 'face '//to_text(int(face_number(f)))//' has no area')
          return
        end if
        normal = area/norm2(area)
        middle = sum(shape%vertex(:, corners), 2)/real(size(corners), wp)
        highest = 0
        out = 0
        do i = 1, shape%n_vertices
          height = dot_product(shape%vertex(:, i) - middle, normal)
          if (height > highest) then
            highest = height
            out = i
          end if
        end do
        if (highest > 2*tolerance) then
          call fail(error, 'the shape is not convex: vertex '//to_text(int(vertex_number(out)))//' stands '// &
                    to_text(highest, 2)//' m out of the plane of face '//to_text(int(face_number(f))))
          return
        end if
        do i = 1, size(corners)
          height = dot_product(shape%vertex(:, corners(i)) - middle, normal)
          if (height >= -2*tolerance) cycle
          call fail(error, 'face '//to_text(int(face_number(f)))//' is not flat: its vertex '// &
                    to_text(int(vertex_number(corners(i))))//' lies '//to_text(-height, 2)//' m out of its plane')
          return
        end do
      end associate
    end do
  end subroutine check_convex

  !> Area of a polygon as a vector along its normal [m2].
  pure function face_area(vertices, corners) result(area)
    real(wp), intent(in) :: vertices(:, :) !! [m], shape (3, vertices)
    integer(i4), intent(in) :: corners(:) !! in order around the polygon, counter-clockwise seen from where the vector points
    real(wp) :: area(3)
    real(wp) :: a(3), b(3)
    integer :: k

    area = 0
    do k = 2, size(corners) - 1
      a = vertices(:, corners(k)) - vertices(:, corners(1))
      b = vertices(:, corners(k + 1)) - vertices(:, corners(1))
      area = area + [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]/2
    end do
  end function face_area
end module sg_polyhedron_checks
