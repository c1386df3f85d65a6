!> The convex hull of points in space, without naming a library.
!!
!! What the points must be is checked here; the hull itself lives in `convex_hull_with_qhull` or
!! `convex_hull_without_qhull`, chosen by CMake.
module sg_convex_hull
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4
  use sg_text, only: to_text
  use sg_vectors, only: cross
  implicit none
  private
  public :: convex_hull, find_spanning, hull_is_available

  !> Points nearer to one plane, line or point than this share of their extent lie in it: a hundred times what rounding
  !> does to a hull, so that the library never sees what it could not distinguish from a flat set
  real(wp), parameter :: flatness = 1e-12_wp

  interface
    !> Was the program built with convex hulls?
    module function hull_is_available() result(is_available)
      logical :: is_available
    end function hull_is_available

    !> Faces of the hull of points that have been checked: polygons, in no certain sense of turning.
    module subroutine make_hull(points, face_first, face_vertex, error)
      real(wp), contiguous, intent(in) :: points(:, :) !! about their middle, shape (3, points)
      integer(i4), allocatable, intent(out) :: face_first(:) !! where the corners of each face begin, shape (faces + 1)
      integer(i4), allocatable, intent(out) :: face_vertex(:) !! corners of all faces, as numbers of points
      type(error_t), allocatable, intent(out) :: error !! set when there is no hull
    end subroutine make_hull
  end interface

contains

  !> Faces of the convex hull: polygons whose corners are points, counter-clockwise seen from outside.
  subroutine convex_hull(points, face_first, face_vertex, error)
    real(wp), intent(in) :: points(:, :) !! points [m], shape (3, points)
    integer(i4), allocatable, intent(out) :: face_first(:) !! corners of face f: face_first(f) to face_first(f + 1) - 1
    integer(i4), allocatable, intent(out) :: face_vertex(:) !! corners of all faces, as numbers of points from 1
    type(error_t), allocatable, intent(out) :: error !! set when the points have no hull with a volume
    real(wp), allocatable :: about(:, :)
    real(wp) :: middle(3), inside(3)
    integer :: corner(4), f

    call find_spanning(points, corner, error)
    if (allocated(error)) return
    inside = sum(points(:, corner), 2)/4
    ! About their middle: a hull far from the origin loses no digits.
    middle = (minval(points, 2) + maxval(points, 2))/2
    allocate (about(3, size(points, 2)))
    do f = 1, size(points, 2)
      about(:, f) = points(:, f) - middle
    end do
    call make_hull(about, face_first, face_vertex, error)
    if (allocated(error)) return
    do f = 1, size(face_first) - 1
      call turn_outward(about, inside - middle, face_vertex(face_first(f):face_first(f + 1) - 1))
    end do
  end subroutine convex_hull

  !> Four points that span a volume, each the farthest from the point, the line and the plane before.
  subroutine find_spanning(points, corner, error)
    real(wp), intent(in) :: points(:, :) !! points [m], shape (3, points)
    integer, intent(out) :: corner(4) !! numbers of four of them
    type(error_t), allocatable, intent(out) :: error !! set when points are not finite or do not span a volume
    real(wp) :: extent, along(3), normal(3), distance
    integer :: i

    corner = 0
    do i = 1, size(points, 2)
      if (all(ieee_is_finite(points(:, i)))) cycle
      call fail(error, 'a coordinate of point '//to_text(i)//' is not finite')
      return
    end do
    if (size(points, 2) < 4) then
      call fail(error, 'a convex hull needs 4 points or more, and there '//trim(merge('is ', 'are', size(points, 2) == 1))// &
                ' '//to_text(size(points, 2)))
      return
    end if
    extent = maxval(maxval(points, 2) - minval(points, 2))
    corner(1) = 1
    call find_farthest(points, points(:, 1), [0.0_wp, 0.0_wp, 0.0_wp], 0, corner(2), distance)
    if (.not. distance > flatness*maxval(abs(points))) then
      call fail(error, 'all '//to_text(size(points, 2))//' points coincide: they have no convex hull')
      return
    end if
    along = unit(points(:, corner(2)) - points(:, 1))
    call find_farthest(points, points(:, 1), along, 1, corner(3), distance)
    if (.not. distance > flatness*extent) then
      call fail(error, 'all '//to_text(size(points, 2))//' points lie on one line: their convex hull has no volume')
      return
    end if
    normal = unit(cross(along, points(:, corner(3)) - points(:, 1)))
    call find_farthest(points, points(:, 1), normal, 2, corner(4), distance)
    if (.not. distance > flatness*extent) then
      call fail(error, 'all '//to_text(size(points, 2))//' points lie in one plane: their convex hull has no volume')
      return
    end if
  end subroutine find_spanning

  !> The point farthest from a point (span 0), from a line along `axis` (1), or from a plane across `axis` (2).
  pure subroutine find_farthest(points, origin, axis, span, found, distance)
    real(wp), intent(in) :: points(:, :), origin(3), axis(3)
    integer, intent(in) :: span
    integer, intent(out) :: found
    real(wp), intent(out) :: distance
    real(wp) :: x(3), d
    integer :: i

    found = 1
    distance = 0
    do i = 1, size(points, 2)
      x = points(:, i) - origin
      select case (span)
      case (0)
        d = norm2(x)
      case (1)
        d = norm2(x - dot_product(x, axis)*axis)
      case default
        d = abs(dot_product(x, axis))
      end select
      if (.not. d > distance) cycle
      distance = d
      found = i
    end do
  end subroutine find_farthest

  !> Order the corners of one face counter-clockwise seen from outside.
  pure subroutine turn_outward(points, inside, corners)
    real(wp), intent(in) :: points(:, :), inside(3)
    integer(i4), intent(inout) :: corners(:)
    real(wp) :: area(3)
    integer :: k, n

    n = size(corners)
    area = 0
    do k = 2, n - 1
      area = area + cross(points(:, corners(k)) - points(:, corners(1)), points(:, corners(k + 1)) - points(:, corners(1)))
    end do
    if (dot_product(area, points(:, corners(1)) - inside) < 0) corners = corners(n:1:-1)
  end subroutine turn_outward

  !> A vector made one long.
  pure function unit(v)
    real(wp), intent(in) :: v(3)
    real(wp) :: unit(3)

    unit = v/norm2(v)
  end function unit
end module sg_convex_hull
