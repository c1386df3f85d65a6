!> Points of contact of two convex polyhedra along a given axis: what their facing faces share, seen along the axis.
!!
!! Of the two faces the one that faces the axis more squarely is the reference, the other the incident face. The incident
!! face is cut along the sides of the reference (Sutherland and Hodgman); each corner left is a point with a gap of its own:
!!
!!           \    incident     /            1: corner of the incident face over the reference
!!            \_______________/             2: side of the incident face over a side of the reference
!!                  |  :    .                  (or: corner of the reference under the incident face)
!!        __________2__:____1___
!!       |       reference      |
!!
!! It does not matter which of the two is the reference: the shared polygon and the gaps along the axis are the same.
module sg_clip_faces
  use sg_crossing_keys, only: crossing_key
  use sg_four_points, only: choose_points
  use sg_kinds, only: wp, i4
  use sg_polyhedron, only: polyhedron_t
  use sg_separation, only: axis_t
  use sg_touch_space, only: add_space_point, touch_space_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: add_shared_points, facing_face

  !> Corners of both faces together that need no allocation
  integer, parameter :: common = 64
  !> Of faces steeper than this cosine to the axis only the nearest point counts: no other within 1.7 of it in height
  real(wp), parameter :: steep = 0.5_wp
  !> Points nearer than this share of the smaller shape are one
  real(wp), parameter :: same_point = 1e-6_wp
  !> A point this near to a corner (share of the smaller shape) is named after it, so that its name outlives small slips
  real(wp), parameter :: same_corner = 0.01_wp

contains

  !> Add the points that the facing faces of two polyhedra share; the deepest has the separation of the axis for its gap.
  pure subroutine add_shared_points(c, a, offset, alert, rounding, axis, touch)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    real(wp), intent(in) :: rounding !! lengths below which rounding hides all differences [m]
    type(axis_t), intent(in) :: axis !! axis of contact
    type(touch_space_t), intent(inout) :: touch !! points found
    type(axis_t) :: facing
    real(wp) :: small(4, common, 2), nearest(3)
    real(wp), allocatable :: large(:, :, :)
    integer :: small_owner(2, common, 2), corners
    integer, allocatable :: large_owner(:, :, :)

    facing = axis
    if (facing%face_c == 0) facing%face_c = facing_face(c, axis%vertex_c, -axis%normal)
    if (facing%face_a == 0) facing%face_a = facing_face(a, axis%vertex_a, axis%normal)
    nearest = nearest_surface(c, a, offset, axis)
    corners = n_corners(c, facing%face_c) + n_corners(a, facing%face_a)
    if (corners <= common) then
      call add_within(c, a, offset, alert, rounding, facing, nearest, common, small, small_owner, touch)
    else
      allocate (large(4, corners, 2), large_owner(2, corners, 2))
      call add_within(c, a, offset, alert, rounding, facing, nearest, corners, large, large_owner, touch)
    end if
  end subroutine add_shared_points

  !> The face at a vertex that faces a direction: of the two at its flattest edge, the one more square to the direction.
  pure integer function facing_face(shape, vertex, direction) result(face)
    type(polyhedron_t), intent(in) :: shape !! polyhedron, in the world
    integer, intent(in) :: vertex !! its vertex that lies farthest in the direction
    real(wp), intent(in) :: direction(3) !! unit vector
    real(wp) :: edge(3), slope, flattest
    integer :: i, other, best

    best = 1
    flattest = -huge(flattest)
    do i = 1, shape%n_edges
      if (shape%edge(1, i) == vertex) then
        other = shape%edge(2, i)
      else if (shape%edge(2, i) == vertex) then
        other = shape%edge(1, i)
      else
        cycle
      end if
      edge = shape%world_vertex(:, other) - shape%world_vertex(:, vertex)
      slope = dot_product(edge, direction)/max(sqrt(dot_product(edge, edge)), tiny(slope))
      if (slope <= flattest) cycle
      flattest = slope
      best = i
    end do
    face = shape%edge(3, best)
    if (dot_product(direction, shape%world_normal(:, shape%edge(4, best))) > dot_product(direction, shape%world_normal(:, face))) &
      face = shape%edge(4, best)
  end function facing_face

  !> Number of corners of a face.
  pure integer function n_corners(shape, face)
    type(polyhedron_t), intent(in) :: shape !! polyhedron
    integer, intent(in) :: face !! one of its faces

    n_corners = shape%face_first(face + 1) - shape%face_first(face)
  end function n_corners

  !> Add the points, with room for the corners given.
  pure subroutine add_within(c, a, offset, alert, rounding, axis, nearest, room, corner, owner, touch)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    real(wp), intent(in) :: rounding !! lengths below which rounding hides all differences [m]
    type(axis_t), intent(in) :: axis !! axis of contact, with both faces
    real(wp), intent(in) :: nearest(3) !! point of the candidate nearest to the antagonist [m]
    integer, intent(in) :: room !! columns of the working space
    real(wp), intent(out) :: corner(4, room, 2) !! working space: place on the candidate and gap of each corner
    integer, intent(out) :: owner(2, room, 2) !! working space: owners of the sides after and before each corner
    type(touch_space_t), intent(inout) :: touch !! points found
    real(wp) :: same, least
    integer :: n, n_chosen, chosen(4), i
    logical :: by_a

    call find_corners(c, a, offset, rounding, axis, room, corner, owner, n, by_a)
    least = huge(least)
    if (n > 0) least = minval(corner(4, :n, 1))
    ! Where rounding has cut the nearest point away, or no faces face each other, it is added.
    if (least > axis%separation + rounding) then
      n = min(n + 1, room)
      corner(:, n, 1) = [nearest, axis%separation]
      owner(:, n, 1) = 0
    end if
    call drop_far(alert, room, n, corner, owner)
    if (n == 0) return
    same = max(same_point*min(c%reach, a%reach), 4*rounding)
    call choose_points(n, corner, axis%normal, rounding, same, n_chosen, chosen)
    do i = 1, n_chosen
      associate (place => corner(1:3, chosen(i), 1), gap => corner(4, chosen(i), 1))
        call add_space_point(touch, place, axis%normal, gap, alert, key_of(c, a, offset, axis, place, owner(:, chosen(i), 1), &
                                                                           by_a, touch))
      end associate
    end do
  end subroutine add_within

  !> Corners of what the two faces share: places on the candidate, gaps, owners of their sides.
  pure subroutine find_corners(c, a, offset, rounding, axis, room, corner, owner, n, by_a)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    real(wp), intent(in) :: rounding !! lengths below which rounding hides all differences [m]
    type(axis_t), intent(in) :: axis !! axis of contact, with both faces
    integer, intent(in) :: room !! columns of the working space
    real(wp), intent(out) :: corner(4, room, 2) !! corners, in (:, :, 1)
    integer, intent(out) :: owner(2, room, 2) !! owners, in (:, :, 1)
    integer, intent(out) :: n !! number of corners
    logical, intent(out) :: by_a !! is the reference the antagonist's face?
    real(wp) :: square_c, square_a, origin(3), slant(3)
    integer :: i

    square_c = -dot_product(axis%normal, c%world_normal(:, axis%face_c))
    square_a = dot_product(axis%normal, a%world_normal(:, axis%face_a))
    ! Of faces as square, the antagonist's: rounding must not decide.
    by_a = square_a >= square_c - 1e-10_wp
    n = 0
    if (max(square_a, square_c) < steep) return
    if (by_a) then
      call shared_polygon(a, axis%face_a, c, axis%face_c, -offset, axis%normal, rounding, room, corner, owner, n)
      origin = a%world_vertex(:, a%face_vertex(a%face_first(axis%face_a))) + offset
      slant = a%world_normal(:, axis%face_a)/square_a
    else
      call shared_polygon(c, axis%face_c, a, axis%face_a, offset, -axis%normal, rounding, room, corner, owner, n)
      origin = c%world_vertex(:, c%face_vertex(c%face_first(axis%face_c)))
      slant = c%world_normal(:, axis%face_c)/square_c
    end if
    do i = 1, n
      corner(4, i, 1) = dot_product(slant, corner(1:3, i, 1))
      owner(2, i, 1) = owner(1, merge(n, i - 1, i == 1), 1)
      if (.not. by_a) corner(1:3, i, 1) = corner(1:3, i, 1) + corner(4, i, 1)*axis%normal
      corner(1:3, i, 1) = origin + corner(1:3, i, 1)
    end do
  end subroutine find_corners

  !> Leave out the corners beyond alert.
  pure subroutine drop_far(alert, room, n, corner, owner)
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    integer, intent(in) :: room !! columns of the corners
    integer, intent(inout) :: n !! number of corners
    real(wp), intent(inout) :: corner(4, room) !! places and gaps
    integer, intent(inout) :: owner(2, room) !! owners of the sides after and before
    integer :: i, kept

    kept = 0
    do i = 1, n
      if (corner(4, i) >= alert) cycle
      kept = kept + 1
      corner(:, kept) = corner(:, i)
      owner(:, kept) = owner(:, i)
    end do
    n = kept
  end subroutine drop_far

  !> Key of a point, another one than those of the points before.
  !!
  !! At a vertex of either face it is the vertex's number, of the candidate first; elsewhere it comes from the two sides that cross.
  pure integer(i4) function key_of(c, a, offset, axis, place, owner, by_a, touch) result(key)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    type(axis_t), intent(in) :: axis !! axis of contact, with both faces
    real(wp), intent(in) :: place(3) !! the point on the candidate [m]
    integer, intent(in) :: owner(2) !! owners of the sides after and before it
    logical, intent(in) :: by_a !! is the reference the antagonist's face?
    type(touch_space_t), intent(in) :: touch !! points before
    real(wp) :: near
    integer :: side_a, side_c

    near = same_corner*min(c%reach, a%reach)
    key = near_corner(c, axis%face_c, place, axis%normal, near)
    if (key == 0) then
      key = near_corner(a, axis%face_a, place - offset, axis%normal, near)
      if (key > 0) key = key + int(c%n_vertices, i4)
    end if
    if (any(touch%feature(:touch%n) == key)) key = 0
    if (key == 0) then
      side_c = merge(maxval(owner), -minval(owner), by_a)
      side_a = merge(-minval(owner), maxval(owner), by_a)
      key = crossing_key(c%n_vertices, a%n_vertices, side_of(c, axis%face_c, side_c), side_of(a, axis%face_a, side_a))
    end if
    do while (any(touch%feature(:touch%n) == key))
      key = modulo(key, huge(key)) + 1_i4
    end do
  end function key_of

  !> Cut the incident face along the sides of the reference, seen along a direction.
  !!
  !! Each corner records the owner of the side that leaves it: side k of the incident face (k > 0) or side k of the reference (-k).
  pure subroutine shared_polygon(r, face_r, s, face_s, shift, up, rounding, room, corner, owner, n)
    type(polyhedron_t), intent(in) :: r !! polyhedron of the reference
    integer, intent(in) :: face_r !! reference face
    type(polyhedron_t), intent(in) :: s !! polyhedron of the incident face
    integer, intent(in) :: face_s !! incident face
    real(wp), intent(in) :: shift(3) !! added to the incident coordinates [m]
    real(wp), intent(in) :: up(3) !! unit vector along the axis, out of the reference
    real(wp), intent(in) :: rounding !! a corner beyond a side by less is within [m]
    integer, intent(in) :: room !! columns of the corners
    real(wp), intent(out) :: corner(4, room, 2) !! corners about the reference's first corner [m], in (1:3, :, 1)
    integer, intent(out) :: owner(2, room, 2) !! owners, in (1, :, 1)
    integer, intent(out) :: n !! number of corners
    real(wp) :: origin(3), start(3), finish(3), side(3), out(3), length, beyond
    integer :: first_r, first_s, n_r, i, k

    first_r = r%face_first(face_r)
    n_r = r%face_first(face_r + 1) - first_r
    first_s = s%face_first(face_s)
    n = s%face_first(face_s + 1) - first_s
    origin = r%world_vertex(:, r%face_vertex(first_r))
    do i = 1, n
      corner(1:3, i, 1) = (s%world_vertex(:, s%face_vertex(first_s + i - 1)) - origin) + shift
      owner(1, i, 1) = i
    end do
    finish = 0
    do i = 1, n_r
      start = finish
      finish = r%world_vertex(:, r%face_vertex(first_r + merge(0, i, i == n_r))) - origin
      side = finish - start
      ! Written out, since the compiler calls a procedure of another file.
      out(1) = side(2)*up(3) - side(3)*up(2)
      out(2) = side(3)*up(1) - side(1)*up(3)
      out(3) = side(1)*up(2) - side(2)*up(1)
      ! Most sides cut nothing.
      beyond = -huge(beyond)
      do k = 1, n
        beyond = max(beyond, out(1)*(corner(1, k, 1) - start(1)) + out(2)*(corner(2, k, 1) - start(2)) &
                             + out(3)*(corner(3, k, 1) - start(3)))
      end do
      if (beyond <= 0) cycle
      length = sqrt(dot_product(out, out))
      if (length <= tiny(length)) cycle
      call cut(start, out/length, i, rounding, room, n, corner, owner)
      if (n == 0) return
    end do
  end subroutine shared_polygon

  !> Cut a polygon along one plane.
  pure subroutine cut(place, out, side, rounding, room, n, corner, owner)
    real(wp), intent(in) :: place(3) !! of the plane [m]
    real(wp), intent(in) :: out(3) !! its outward unit normal
    integer, intent(in) :: side !! number of the plane
    real(wp), intent(in) :: rounding !! a corner beyond by less is within [m]
    integer, intent(in) :: room !! columns of the corners
    integer, intent(inout) :: n !! number of corners
    real(wp), intent(inout) :: corner(4, room, 2) !! corners, in (1:3, :, 1) [m]
    integer, intent(inout) :: owner(2, room, 2) !! owners of the sides that leave the corners, in (1, :, 1)
    real(wp) :: beyond, beyond_next, first_beyond, share
    integer :: i, j, m

    m = 0
    first_beyond = dot_product(out, corner(1:3, 1, 1) - place)
    beyond_next = first_beyond
    do i = 1, n
      beyond = beyond_next
      j = merge(1, i + 1, i == n)
      beyond_next = first_beyond
      if (j > 1) beyond_next = dot_product(out, corner(1:3, j, 1) - place)
      if (beyond <= rounding .and. m < room) then
        m = m + 1
        corner(1:3, m, 2) = corner(1:3, i, 1)
        owner(1, m, 2) = owner(1, i, 1)
      end if
      if ((beyond <= rounding .eqv. beyond_next <= rounding) .or. m == room) cycle
      share = min(max(beyond/(beyond - beyond_next), 0.0_wp), 1.0_wp)
      m = m + 1
      corner(1:3, m, 2) = corner(1:3, i, 1) + share*(corner(1:3, j, 1) - corner(1:3, i, 1))
      owner(1, m, 2) = merge(-side, owner(1, i, 1), beyond <= rounding)
    end do
    n = m
    corner(1:3, :n, 1) = corner(1:3, :n, 2)
    owner(1, :n, 1) = owner(1, :n, 2)
  end subroutine cut

  !> The point of the candidate that is nearest to the antagonist along an axis.
  pure function nearest_surface(c, a, offset, axis) result(place)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    type(axis_t), intent(in) :: axis !! axis of contact
    real(wp) :: place(3), edge_a(3), edge_c(3), between(3), normal(3), square

    if (axis%edge_c > 0) then
      place = c%world_vertex(:, c%edge(1, axis%edge_c))
      edge_c = c%world_vertex(:, c%edge(2, axis%edge_c)) - place
      edge_a = a%world_vertex(:, a%edge(2, axis%edge_a)) - a%world_vertex(:, a%edge(1, axis%edge_a))
      between = (a%world_vertex(:, a%edge(1, axis%edge_a)) - place) + offset
      normal = cross(edge_c, edge_a)
      square = dot_product(normal, normal)
      if (square > tiny(square)) place = place + min(max(dot_product(cross(between, edge_a), normal)/square, 0.0_wp), 1.0_wp)*edge_c
    else if (axis%face_a > 0) then
      place = c%world_vertex(:, axis%vertex_c)
    else if (axis%face_c > 0 .or. axis%separation <= 0) then
      place = a%world_vertex(:, axis%vertex_a) + offset + axis%separation*axis%normal
    else
      place = axis%surface
    end if
  end function nearest_surface

  !> The vertex of a face that a point lies at, seen along the normal; 0 where none is near.
  pure integer(i4) function near_corner(shape, face, place, normal, near) result(vertex)
    type(polyhedron_t), intent(in) :: shape !! polyhedron, in the world
    integer, intent(in) :: face !! one of its faces
    real(wp), intent(in) :: place(3) !! point [m]
    real(wp), intent(in) :: normal(3) !! unit normal of the contact
    real(wp), intent(in) :: near !! distance that is near [m]
    real(wp) :: way(3), square, least
    integer :: k

    vertex = 0
    least = near**2
    do k = shape%face_first(face), shape%face_first(face + 1) - 1
      way = place - shape%world_vertex(:, shape%face_vertex(k))
      square = dot_product(way, way) - dot_product(way, normal)**2
      if (square >= least) cycle
      least = square
      vertex = shape%face_vertex(k)
    end do
  end function near_corner

  !> The two vertices of a side of a face, the lower number first; the two first where there is no such side.
  pure function side_of(shape, face, side) result(ends)
    type(polyhedron_t), intent(in) :: shape !! polyhedron
    integer, intent(in) :: face !! one of its faces
    integer, intent(in) :: side !! number of the side along the face
    integer(i4) :: ends(2)
    integer :: first, n

    first = shape%face_first(face)
    n = shape%face_first(face + 1) - first
    ends = 1
    if (side < 1 .or. side > n) return
    ends(1) = shape%face_vertex(first + side - 1)
    ends(2) = shape%face_vertex(first + modulo(side, n))
    ends = [minval(ends), maxval(ends)]
  end function side_of
end module sg_clip_faces
