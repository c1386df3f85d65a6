!> Points of contact of two convex polygons over the face that is their reference.
!!
!! The edge of the other polygon that faces it is the incident edge. Points of contact are the two ends of what the edges share
!! along the reference:
!!
!!              \            /  incident polygon
!!               \__________/   incident edge
!!                 |    |
!!         _______1|____|2         1: incident vertex over the face, 2: end of the face under the edge
!!        |  reference  |
!!
!! Where the lowest incident vertex hangs beyond the end of the face, that end and the vertex nearest to it are the
!! contact: a distance true in length and direction.
!!
!! A point is named after its vertex, 1 to n_c of the candidate, n_c + 1 to n_c + n_a of the antagonist: whichever face is the
!! reference and whichever edge the incident one, which a tilt of rounding size may change, the vertex stays. Of two
!! vertices at one place the candidate's gives the name.
module sg_face_points
  use sg_kinds, only: wp, i4
  use sg_touch, only: touch_t, add_point, same_length
  implicit none
  private
  public :: add_points, face_t, next

  !> Points nearer than this fraction of the shorter edge are one: a second one would add nothing
  real(wp), parameter :: same_point = 1e-6_wp
  !> Vertices nearer than this fraction of the shorter edge are at one place, so that the name outlives small slips
  real(wp), parameter :: same_corner = 0.01_wp

  !> An edge of the reference polygon and what faces it
  type :: face_t
    !> Index of the edge (of its first vertex), 0 when the polygon has no edge
    integer :: edge = 0
    !> Length of the edge [m]
    real(wp) :: length = 0
    !> Unit outward normal
    real(wp) :: normal(2) = 0
    !> Lowest vertex of the incident polygon over the face
    integer :: lowest = 0
    !> Its height [m], negative below the face
    real(wp) :: height = -huge(1.0_wp)
  end type face_t

contains

  !> Add the points of contact over a reference face.
  pure subroutine add_points(n_r, reference, n_i, incident, edges, shift, face, is_antagonist, radius_a, alert, touch)
    integer, intent(in) :: n_r !! vertices of the reference polygon
    real(wp), intent(in) :: reference(2, n_r) !! its vertices [m]
    integer, intent(in) :: n_i !! vertices of the incident polygon
    real(wp), intent(in) :: incident(2, n_i) !! its vertices [m]
    real(wp), intent(in) :: edges(3, n_i) !! normals and lengths of its edges [m]
    real(wp), intent(in) :: shift(2) !! added to the incident vertices [m]
    type(face_t), intent(in) :: face !! the reference face
    logical, intent(in) :: is_antagonist !! is the reference polygon the antagonist?
    real(wp), intent(in) :: radius_a !! thickness of the antagonist's skin [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_t), intent(inout) :: touch !! points found
    real(wp) :: origin(2), place(2, 2), along(2), low, high, shorter, x, fraction, facing(2), gap, beyond
    integer(i4) :: key
    integer :: vertex(2), side, i

    vertex = [face%lowest, other_end(n_i, incident, edges, face%lowest, face%normal)]
    ! Everything is taken about the start of the face, so that far from the origin gaps keep their digits.
    origin = reference(:, face%edge)
    place(:, 1) = incident(:, vertex(1)) + (shift - origin)
    place(:, 2) = incident(:, vertex(2)) + (shift - origin)
    along = face%normal(1)*place(2, :) - face%normal(2)*place(1, :)
    low = max(0.0_wp, min(along(1), along(2)))
    high = min(face%length, max(along(1), along(2)))
    shorter = min(face%length, size_of(place(:, 2) - place(:, 1)))
    if (high - low <= same_point*shorter .or. max(-along(1), along(1) - face%length) > same_length*face%length) then
      call add_beyond(n_r, n_i, origin, shift, face, is_antagonist, radius_a, alert, vertex, place, along, shorter, touch)
      return
    end if
    do side = 1, 2
      i = merge(side, 3 - side, along(1) <= along(2))
      x = merge(low, high, side == 1)
      fraction = min(max((x - along(1))/(along(2) - along(1)), 0.0_wp), 1.0_wp)
      facing = place(:, 1) + fraction*(place(:, 2) - place(:, 1))
      gap = dot(face%normal, facing)
      beyond = merge(-along(i), along(i) - face%length, side == 1)
      key = name_of(vertex(i), merge(face%edge, next(face%edge, n_r), side == 1), is_antagonist, &
                    merge(n_i, n_r, is_antagonist), beyond, same_corner*shorter, .false.)
      call put(origin, shift, facing, face%normal, gap, is_antagonist, radius_a, alert, key, touch)
    end do
  end subroutine add_points

  !> The same where what the edges share is a point, or the lowest vertex hangs beyond an end of the face.
  pure subroutine add_beyond(n_r, n_i, origin, shift, face, is_antagonist, radius_a, alert, vertex, place, along, shorter, touch)
    integer, intent(in) :: n_r, n_i
    real(wp), intent(in) :: origin(2), shift(2) !! start of the face, and what was added to the incident vertices [m]
    type(face_t), intent(in) :: face
    logical, intent(in) :: is_antagonist
    real(wp), intent(in) :: radius_a, alert
    integer, intent(in) :: vertex(2) !! ends of the incident edge, the lowest vertex first
    real(wp), intent(in) :: place(2, 2), along(2) !! where they are from the start of the face, and along it [m]
    real(wp), intent(in) :: shorter !! length of the shorter edge [m]
    type(touch_t), intent(inout) :: touch
    real(wp) :: tangent(2), low, high, same, rounding

    tangent = [-face%normal(2), face%normal(1)]
    low = max(0.0_wp, min(along(1), along(2)))
    high = min(face%length, max(along(1), along(2)))
    rounding = same_length*face%length
    same = same_point*shorter
    if (high - low > same) then
      call add_end(touch, low, is_start=.true., i=merge(1, 2, along(1) <= along(2)), is_alone=.false.)
      call add_end(touch, high, is_start=.false., i=merge(2, 1, along(1) <= along(2)), is_alone=.false.)
    else
      call add_end(touch, min(max(along(1), 0.0_wp), face%length), is_start=2*along(1) < face%length, i=1, is_alone=.true.)
    end if

  contains

    !> Add one end of what the edges share.
    pure subroutine add_end(touch, x, is_start, i, is_alone)
      type(touch_t), intent(inout) :: touch !! points so far
      real(wp), intent(in) :: x !! place of the end along the face [m]
      logical, intent(in) :: is_start !! is it on the side of the face's start?
      integer, intent(in) :: i !! which of the incident edge's vertices is on that side
      logical, intent(in) :: is_alone !! is it the only point?
      real(wp) :: corner, beyond, fraction, facing(2), normal(2), apart(2), gap
      integer(i4) :: key

      corner = merge(0.0_wp, face%length, is_start)
      beyond = merge(-along(1), along(1) - face%length, is_start)
      fraction = 0
      if (beyond > rounding) then
        fraction = nearest_fraction(corner*tangent, place)
      else if (abs(along(2) - along(1)) > same) then
        fraction = min(max((x - along(1))/(along(2) - along(1)), 0.0_wp), 1.0_wp)
      end if
      facing = place(:, 1) + fraction*(place(:, 2) - place(:, 1))
      normal = face%normal
      gap = dot(normal, facing)
      apart = facing - corner*tangent
      ! Beyond the face, vertex faces vertex. A foot inside the incident edge would mean that the two edges are parallel
      ! to rounding, for otherwise the incident polygon had the better face: then the normal stays the face's.
      if (beyond > rounding .and. abs(2*fraction - 1) >= 1 .and. size_of(apart) > rounding) then
        gap = size_of(apart)
        normal = apart/gap
      end if
      key = name_of(vertex(i), merge(face%edge, next(face%edge, n_r), is_start), is_antagonist, merge(n_i, n_r, is_antagonist), &
                    merge(-along(i), along(i) - face%length, is_start), same_corner*shorter, is_alone)
      call put(origin, shift, facing, normal, gap, is_antagonist, radius_a, alert, key, touch)
    end subroutine add_end
  end subroutine add_beyond

  !> Put a point to those found.
  pure subroutine put(origin, shift, facing, normal, gap, is_antagonist, radius_a, alert, key, touch)
    real(wp), intent(in) :: origin(2), shift(2), facing(2) !! start of the face, shift, and the incident point from that start [m]
    real(wp), intent(in) :: normal(2), gap !! from the face, and its height [m]
    logical, intent(in) :: is_antagonist
    real(wp), intent(in) :: radius_a, alert
    integer(i4), intent(in) :: key
    type(touch_t), intent(inout) :: touch

    if (is_antagonist) then
      call add_point(touch, origin - shift + facing, normal, gap - radius_a, alert, key)
    else
      call add_point(touch, origin + facing - gap*normal, -normal, gap - radius_a, alert, key)
    end if
  end subroutine put

  !> Key of a point: the vertex where it lies, the antagonist's counted after those of the candidate.
  pure integer(i4) function name_of(incident, reference, is_antagonist, n_c, beyond, near, is_alone) result(key)
    integer, intent(in) :: incident !! vertex of the incident edge on that side
    integer, intent(in) :: reference !! vertex of the reference face on that side
    logical, intent(in) :: is_antagonist !! is the reference polygon the antagonist?
    integer, intent(in) :: n_c !! vertices of the candidate
    real(wp), intent(in) :: beyond !! by which the incident vertex is beyond the end of the face [m]
    real(wp), intent(in) :: near !! distance of vertices that are at one place [m]
    logical, intent(in) :: is_alone !! is it the pair's only point?
    logical :: by_incident

    if (abs(beyond) <= near .or. (is_alone .and. beyond > 0)) then
      by_incident = is_antagonist
    else
      by_incident = beyond < 0
    end if
    key = int(merge(incident, reference, by_incident), i4)
    if (by_incident .neqv. is_antagonist) key = key + int(n_c, i4)
  end function name_of

  !> The other end of the edge at the lowest vertex that is the flatter one, seen from the face.
  pure integer function other_end(n, vertices, edges, lowest, normal) result(vertex)
    integer, intent(in) :: n !! vertices of the incident polygon
    real(wp), intent(in) :: vertices(2, n) !! its vertices [m]
    real(wp), intent(in) :: edges(3, n) !! normals and lengths of its edges [m]
    integer, intent(in) :: lowest !! the lowest one
    real(wp), intent(in) :: normal(2) !! normal of the face
    real(wp) :: to_before(2), to_after(2)
    integer :: before

    before = merge(n, lowest - 1, lowest == 1)
    vertex = next(lowest, n)
    to_before = vertices(:, before) - vertices(:, lowest)
    to_after = vertices(:, vertex) - vertices(:, lowest)
    if (dot(normal, to_before)*edges(3, lowest) < dot(normal, to_after)*edges(3, before)) vertex = before
  end function other_end

  !> The vertex after one, around a polygon.
  pure integer function next(i, n)
    integer, intent(in) :: i !! vertex
    integer, intent(in) :: n !! vertices of the polygon

    next = merge(1, i + 1, i == n)
  end function next

  !> Place of the point of an edge nearest to a point, from 0 at the edge's first end to 1 at its second.
  pure real(wp) function nearest_fraction(point, ends) result(fraction)
    real(wp), intent(in) :: point(2) !! [m]
    real(wp), intent(in) :: ends(2, 2) !! [m], shape (2, end)
    real(wp) :: edge(2), length2

    edge = ends(:, 2) - ends(:, 1)
    length2 = dot(edge, edge)
    fraction = 0
    if (length2 > tiny(length2)) fraction = min(max(dot(edge, point - ends(:, 1))/length2, 0.0_wp), 1.0_wp)
  end function nearest_fraction

  !> Scalar product of two vectors.
  pure real(wp) function dot(a, b)
    real(wp), intent(in) :: a(2), b(2)

    dot = a(1)*b(1) + a(2)*b(2)
  end function dot

  !> Length of a vector, without the scaling that makes `norm2` slow.
  pure real(wp) function size_of(a)
    real(wp), intent(in) :: a(2)

    size_of = sqrt(a(1)*a(1) + a(2)*a(2))
  end function size_of
end module sg_face_points
