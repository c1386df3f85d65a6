!> A convex polyhedron from vertices and faces, as files give them: triangles or polygons, vertices repeated or unused.
!!
!! Equal vertices are welded, faces in one plane made one polygon, vertices left inside a face or along an edge dropped,
!! edges listed with their two faces, and all of it checked. What equal and in one plane mean: `length_tolerance`.
module sg_polyhedron_build
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4, i8
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_checks, only: check_convex, check_face_count, check_faces, check_vertices, check_volume, face_area, &
                                  length_tolerance, pair_edges
  use sg_polyhedron_moments, only: solid_t, surface_solid
  use sg_sorting, only: sort_permutation
  use sg_text, only: to_text
  use sg_welding, only: weld
  implicit none
  private
  public :: polyhedron_from_faces, polyhedron_from_triangles

  !> Rounds of growing a flat region and fitting its plane; two or three are what meshes take
  integer, parameter :: most_fits = 8
  !> Cosine of the angle from which on a face is not in the plane of another whatever the distances: 60 degrees
  real(wp), parameter :: least_cosine = 0.5_wp

  !> A surface of faces, with what is known of them
  type :: surface_t
    !> [m], shape (3, vertices)
    real(wp), allocatable :: vertex(:, :)
    !> Corners of face f: `face_vertex(face_first(f):face_first(f + 1) - 1)`
    integer(i4), allocatable :: face_first(:), face_vertex(:)
    !> Number of each face as given
    integer(i4), allocatable :: face_number(:)
    !> Of each place in `face_vertex`: the same edge in the other face, the next edge around the face, the face
    integer(i4), allocatable :: mate(:), next(:), face_of(:)
    !> Area vectors [m2], shape (3, faces), and middles of the corners [m], shape (3, faces)
    real(wp), allocatable :: area(:, :), middle(:, :)
    !> Is the face narrower than the tolerance, so that its normal is lost in rounding?
    logical, allocatable :: is_narrow(:)
    !> Flat region that each face belongs to
    integer(i4), allocatable :: region(:)
  end type surface_t

contains

  !> A convex polyhedron from vertices and triangles.
  subroutine polyhedron_from_triangles(vertices, triangles, shape, error, may_turn)
    real(wp), intent(in) :: vertices(:, :) !! [m], shape (3, vertices)
    integer(i4), intent(in) :: triangles(:, :) !! vertices of each, counter-clockwise seen from outside, shape (3, triangles)
    type(polyhedron_t), intent(out) :: shape !! polyhedron in the frame of the vertices
    type(error_t), allocatable, intent(out) :: error !! set when they do not bound a convex polyhedron
    logical, intent(in), optional :: may_turn !! turn faces that are inside out, one by one or all of them? default no
    integer :: f

    call polyhedron_from_faces(vertices, [(int(3*f - 2, i4), f=1, size(triangles, 2) + 1)], &
                               reshape(triangles, [size(triangles)]), shape, error, may_turn)
  end subroutine polyhedron_from_triangles

  !> A convex polyhedron from vertices and polygons.
  subroutine polyhedron_from_faces(vertices, face_first, face_vertex, shape, error, may_turn)
    real(wp), intent(in) :: vertices(:, :) !! [m], shape (3, vertices)
    integer(i4), intent(in) :: face_first(:) !! corners of face f: face_first(f) to face_first(f + 1) - 1
    integer(i4), intent(in) :: face_vertex(:) !! corners of all faces, counter-clockwise seen from outside, from 1
    type(polyhedron_t), intent(out) :: shape !! polyhedron in the frame of the vertices
    type(error_t), allocatable, intent(out) :: error !! set when they do not bound a convex polyhedron
    logical, intent(in), optional :: may_turn !! turn faces that are inside out, one by one or all of them? default no
    type(surface_t) :: surface
    real(wp) :: tolerance
    integer :: n_regions, f
    logical :: may

    may = .false.
    if (present(may_turn)) may = may_turn
    call check_vertices(vertices, error)
    if (.not. allocated(error)) call check_faces(size(vertices, 2), face_first, face_vertex, error)
    if (allocated(error)) return
    tolerance = length_tolerance(vertices)
    ! Before vertices are welded: the two sides of a sheet would be made one.
    if (.not. may) call check_volume(vertices, face_first, face_vertex, tolerance, .true., error)
    if (allocated(error)) return
    call weld_faces(vertices, face_first, face_vertex, tolerance, surface)
    if (may) call turn_alike(surface, error)
    if (.not. allocated(error)) call connect(surface, error)
    if (allocated(error)) return
    call check_volume(surface%vertex, surface%face_first, surface%face_vertex, tolerance, may, error)
    if (allocated(error)) return
    if (is_inside_out(surface)) then
      do f = 1, size(surface%face_number)
        call turn_face(surface, f)
      end do
      call connect(surface, error)
      if (allocated(error)) return
    end if
    call find_regions(surface, tolerance, n_regions)
    call check_face_count(n_regions, error)
    if (.not. allocated(error)) call polygons_of_regions(surface, n_regions, tolerance, shape, error)
    if (allocated(error)) return
    call find_normals(shape)
    call find_edges(shape, error)
  end subroutine polyhedron_from_faces

  !> Name each vertex by the first of those it is equal to; drop corners and faces that have come to nothing thereby.
  subroutine weld_faces(vertices, face_first, face_vertex, tolerance, surface)
    real(wp), intent(in) :: vertices(:, :), tolerance
    integer(i4), intent(in) :: face_first(:), face_vertex(:)
    type(surface_t), intent(out) :: surface
    integer(i4), allocatable :: same(:)
    integer(i4) :: corner
    integer :: f, k, n, kept, last

    call weld(vertices, tolerance, same)
    allocate (surface%vertex, source=vertices)
    allocate (surface%face_first(size(face_first)), surface%face_vertex(size(face_vertex)), surface%face_number(size(face_first)))
    kept = 0
    n = 0
    surface%face_first(1) = 1
    do f = 1, size(face_first) - 1
      last = n
      corner = same(face_vertex(face_first(f + 1) - 1))
      do k = face_first(f), face_first(f + 1) - 1
        if (same(face_vertex(k)) == corner) cycle
        corner = same(face_vertex(k))
        n = n + 1
        surface%face_vertex(n) = corner
      end do
      if (n - last < 3) then
        n = last
      else
        kept = kept + 1
        surface%face_number(kept) = int(f, i4)
        surface%face_first(kept + 1) = int(n + 1, i4)
      end if
    end do
    surface%face_first = surface%face_first(:kept + 1)
    surface%face_vertex = surface%face_vertex(:n)
    surface%face_number = surface%face_number(:kept)
  end subroutine weld_faces

  !> Find what lies beside what.
  subroutine connect(surface, error, may_agree)
    type(surface_t), intent(inout) :: surface
    type(error_t), allocatable, intent(out) :: error
    logical, intent(in), optional :: may_agree
    integer :: f, k, i

    if (allocated(surface%mate)) deallocate (surface%mate, surface%next, surface%face_of)
    allocate (surface%next(size(surface%face_vertex)), surface%face_of(size(surface%face_vertex)))
    do f = 1, size(surface%face_number)
      do k = surface%face_first(f), surface%face_first(f + 1) - 1
        surface%next(k) = int(k + 1, i4)
        surface%face_of(k) = int(f, i4)
      end do
      surface%next(surface%face_first(f + 1) - 1) = surface%face_first(f)
    end do
    call pair_edges(surface%face_first, surface%face_vertex, surface%face_number, &
                    [(int(i, i4), i=1, size(surface%vertex, 2))], surface%mate, error, may_agree)
  end subroutine connect

  !> Turn faces so that all run around the surface in one sense, that of the first face.
  subroutine turn_alike(surface, error)
    type(surface_t), intent(inout) :: surface
    type(error_t), allocatable, intent(out) :: error
    integer(i4), allocatable :: found(:)
    logical, allocatable :: is_found(:), is_turned(:)
    integer :: at, n, f, g, k, seed

    call connect(surface, error, may_agree=.true.)
    if (allocated(error)) return
    allocate (found(size(surface%face_number)), is_found(size(surface%face_number)), is_turned(size(surface%face_number)))
    is_found = .false.
    is_turned = .false.
    n = 0
    at = 0
    do seed = 1, size(found)
      if (is_found(seed)) cycle
      n = n + 1
      found(n) = int(seed, i4)
      is_found(seed) = .true.
      do while (at < n)
        at = at + 1
        f = found(at)
        do k = surface%face_first(f), surface%face_first(f + 1) - 1
          g = surface%face_of(surface%mate(k))
          if (is_found(g)) cycle
          is_found(g) = .true.
          is_turned(g) = is_turned(f) .neqv. surface%face_vertex(k) == surface%face_vertex(surface%mate(k))
          n = n + 1
          found(n) = int(g, i4)
        end do
      end do
    end do
    do f = 1, size(found)
      if (is_turned(f)) call turn_face(surface, f)
    end do
  end subroutine turn_alike

  !> Do the faces of a closed surface run clockwise seen from outside?
  pure logical function is_inside_out(surface)
    type(surface_t), intent(in) :: surface
    type(solid_t) :: solid

    solid = surface_solid(surface%vertex, surface%face_first, surface%face_vertex)
    is_inside_out = solid%volume < 0
  end function is_inside_out

  !> Run around a face the other way.
  pure subroutine turn_face(surface, f)
    type(surface_t), intent(inout) :: surface
    integer, intent(in) :: f

    associate (first => surface%face_first(f), last => surface%face_first(f + 1) - 1)
      surface%face_vertex(first:last) = surface%face_vertex(last:first:-1)
    end associate
  end subroutine turn_face

  !> Divide the surface into flat regions, beginning with the largest faces, whose planes are known best.
  subroutine find_regions(surface, tolerance, n_regions)
    type(surface_t), intent(inout) :: surface
    real(wp), intent(in) :: tolerance
    integer, intent(out) :: n_regions
    integer(i4), allocatable :: order(:), members(:)
    integer(i8), allocatable :: keys(:)
    integer :: i, f, n

    n = size(surface%face_number)
    allocate (surface%area(3, n), surface%middle(3, n), surface%is_narrow(n), surface%region(n), keys(n), members(n))
    do f = 1, n
      associate (corners => surface%face_vertex(surface%face_first(f):surface%face_first(f + 1) - 1))
        surface%area(:, f) = face_area(surface%vertex, corners)
        surface%middle(:, f) = sum(surface%vertex(:, corners), 2)/real(size(corners), wp)
        surface%is_narrow(f) = norm2(surface%area(:, f)) <= tolerance*longest_side(surface%vertex, corners)
      end associate
      ! The bits of a positive real grow with it; sorting takes 55 of them.
      keys(f) = shiftr(huge(keys) - transfer(norm2(surface%area(:, f)), 0_i8), 10)
    end do
    order = sort_permutation(keys)
    surface%region = 0
    n_regions = 0
    do i = 1, n
      if (surface%region(order(i)) /= 0) cycle
      n_regions = n_regions + 1
      call grow_region(surface, int(order(i)), n_regions, tolerance, members)
    end do
  end subroutine find_regions

  !> Longest side of a polygon [m].
  pure real(wp) function longest_side(vertices, corners) result(longest)
    real(wp), intent(in) :: vertices(:, :)
    integer(i4), intent(in) :: corners(:)
    integer :: k

    longest = 0
    do k = 1, size(corners)
      longest = max(longest, norm2(vertices(:, corners(k)) - vertices(:, corners(1 + mod(k, size(corners))))))
    end do
  end function longest_side

  !> Take into a region all faces around a first one that lie in its plane, and fit the plane to them, until it stays.
  subroutine grow_region(surface, seed, label, tolerance, members)
    type(surface_t), intent(inout) :: surface
    integer, intent(in) :: seed, label
    real(wp), intent(in) :: tolerance
    integer(i4), intent(inout) :: members(:)
    real(wp) :: normal(3), origin(3), weight, total
    integer :: n, n_before, fit, i

    normal = surface%area(:, seed)
    origin = surface%middle(:, seed)
    n_before = 1
    do fit = 1, most_fits
      if (.not. norm2(normal) > tiny(weight)) normal = [0.0_wp, 0.0_wp, 1.0_wp]
      call flood(surface, seed, label, normal/norm2(normal), origin, tolerance, members, n)
      if (n <= n_before .or. fit == most_fits) exit
      n_before = n
      normal = 0
      origin = 0
      total = 0
      do i = 1, n
        weight = norm2(surface%area(:, members(i)))
        normal = normal + surface%area(:, members(i))
        origin = origin + weight*surface%middle(:, members(i))
        total = total + weight
        surface%region(members(i)) = 0
      end do
      origin = origin/total
    end do
  end subroutine grow_region

  !> Give a label to the first face and to all that are reached from it within its plane.
  pure subroutine flood(surface, seed, label, normal, origin, tolerance, members, n)
    type(surface_t), intent(inout) :: surface
    integer, intent(in) :: seed, label
    real(wp), intent(in) :: normal(3), origin(3), tolerance
    integer(i4), intent(inout) :: members(:)
    integer, intent(out) :: n
    integer :: at, f, g, k

    n = 1
    at = 0
    members(1) = int(seed, i4)
    surface%region(seed) = int(label, i4)
    do while (at < n)
      at = at + 1
      f = members(at)
      do k = surface%face_first(f), surface%face_first(f + 1) - 1
        g = surface%face_of(surface%mate(k))
        if (surface%region(g) /= 0) cycle
        if (.not. lies_in_plane(surface, g, normal, origin, tolerance)) cycle
        n = n + 1
        members(n) = int(g, i4)
        surface%region(g) = int(label, i4)
      end do
    end do
  end subroutine flood

  !> Are all corners of a face in a plane, and does the face look the same way?
  pure logical function lies_in_plane(surface, f, normal, origin, tolerance) result(does)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: f
    real(wp), intent(in) :: normal(3), origin(3), tolerance
    integer :: k

    does = surface%is_narrow(f)
    if (.not. does) does = dot_product(surface%area(:, f), normal) > least_cosine*norm2(surface%area(:, f))
    do k = surface%face_first(f), surface%face_first(f + 1) - 1
      if (.not. does) return
      does = abs(dot_product(surface%vertex(:, surface%face_vertex(k)) - origin, normal)) <= tolerance
    end do
  end function lies_in_plane

  !> The outlines of the regions, and from them the faces and vertices of the polyhedron.
  subroutine polygons_of_regions(surface, n_regions, tolerance, shape, error)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: n_regions
    real(wp), intent(in) :: tolerance
    type(polyhedron_t), intent(out) :: shape
    type(error_t), allocatable, intent(out) :: error
    integer(i4), allocatable :: first(:), corner(:), number(:), place(:), degree(:)
    integer :: r, k, i, n

    call trace_outlines(surface, n_regions, first, corner, number, error)
    if (allocated(error)) return
    allocate (degree(size(surface%vertex, 2)), place(size(surface%vertex, 2)))
    degree = 0
    do k = 1, size(corner)
      degree(corner(k)) = degree(corner(k)) + 1_i4
    end do
    ! Where two faces alone meet there is no vertex, only a point along their edge.
    n = 0
    do i = 1, size(degree)
      place(i) = 0
      if (degree(i) < 3) cycle
      n = n + 1
      place(i) = int(n, i4)
    end do
    allocate (shape%vertex(3, n), shape%face_first(n_regions + 1), shape%face_vertex(count(place(corner) > 0)))
    shape%n_vertices = n
    shape%n_faces = n_regions
    n = 0
    do r = 1, n_regions
      shape%face_first(r) = int(n + 1, i4)
      do k = first(r), first(r + 1) - 1
        if (place(corner(k)) == 0) cycle
        n = n + 1
        shape%face_vertex(n) = place(corner(k))
      end do
      if (n + 1 - shape%face_first(r) < 3) then
        call fail(error, 'face '//to_text(int(number(r)))//' has no area')
        return
      end if
    end do
    shape%face_first(n_regions + 1) = int(n + 1, i4)
    shape%vertex = surface%vertex(:, pack([(i, i=1, size(place))], place > 0))
    call check_convex(shape, number, pack([(int(i, i4), i=1, size(place))], place > 0), tolerance, error)
  end subroutine polygons_of_regions

  !> Follow the one outline of each region.
  subroutine trace_outlines(surface, n_regions, first, corner, number, error)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: n_regions
    integer(i4), allocatable, intent(out) :: first(:), corner(:), number(:)
    type(error_t), allocatable, intent(out) :: error
    integer(i4), allocatable :: start(:)
    logical, allocatable :: is_seen(:)
    integer :: r, k, n

    allocate (start(n_regions), first(n_regions + 1), corner(size(surface%face_vertex)), number(n_regions))
    allocate (is_seen(size(surface%face_vertex)))
    start = 0
    do k = size(surface%face_vertex), 1, -1
      r = surface%region(surface%face_of(k))
      is_seen(k) = r == surface%region(surface%face_of(surface%mate(k)))
      if (is_seen(k)) cycle
      start(r) = int(k, i4)
      number(r) = surface%face_number(surface%face_of(k))
    end do
    n = 0
    do r = 1, n_regions
      first(r) = int(n + 1, i4)
      k = start(r)
      if (k == 0) cycle
      do while (.not. is_seen(k))
        is_seen(k) = .true.
        n = n + 1
        corner(n) = surface%face_vertex(k)
        k = surface%next(k)
        do while (surface%region(surface%face_of(surface%mate(k))) == r)
          k = surface%next(surface%mate(k))
        end do
      end do
    end do
    first(n_regions + 1) = int(n + 1, i4)
    corner = corner(:n)
    if (all(is_seen)) return
    k = findloc(is_seen, .false., 1)
    call fail(error, 'the shape is not convex: the faces in the plane of face '// &
              to_text(int(surface%face_number(surface%face_of(k))))//' surround others')
  end subroutine trace_outlines

  !> Outward normals, and the radius that holds the shape.
  pure subroutine find_normals(shape)
    type(polyhedron_t), intent(inout) :: shape
    real(wp) :: area(3)
    integer :: f

    allocate (shape%normal(3, shape%n_faces))
    do f = 1, shape%n_faces
      area = face_area(shape%vertex, shape%face_vertex(shape%face_first(f):shape%face_first(f + 1) - 1))
      shape%normal(:, f) = area/norm2(area)
    end do
    shape%reach = maxval(norm2(shape%vertex, 1))
  end subroutine find_normals

  !> Edges with their two faces; a convex polyhedron has V - E + F = 2.
  subroutine find_edges(shape, error)
    type(polyhedron_t), intent(inout) :: shape
    type(error_t), allocatable, intent(out) :: error
    integer(i4), allocatable :: mate(:), face_of(:)
    integer :: f, k, i, n

    call pair_edges(shape%face_first, shape%face_vertex, [(int(i, i4), i=1, shape%n_faces)], &
                    [(int(i, i4), i=1, shape%n_vertices)], mate, error)
    if (allocated(error)) return
    n = size(shape%face_vertex)
    allocate (face_of(n), shape%edge(4, n/2))
    do f = 1, shape%n_faces
      face_of(shape%face_first(f):shape%face_first(f + 1) - 1) = int(f, i4)
    end do
    do k = 1, n
      if (mate(k) < k) cycle
      shape%n_edges = shape%n_edges + 1
      shape%edge(:, shape%n_edges) = [shape%face_vertex(k), shape%face_vertex(mate(k)), face_of(k), face_of(mate(k))]
    end do
    if (shape%n_vertices - shape%n_edges + shape%n_faces /= 2) then
      call fail(error, 'the surface is not one closed piece without holes: '//to_text(shape%n_vertices)//' vertices, '// &
                to_text(shape%n_edges)//' edges and '//to_text(shape%n_faces)//' faces')
    end if
  end subroutine find_edges
end module sg_polyhedron_build
