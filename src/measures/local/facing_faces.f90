!> The joint of two shapes that touch: what their facing faces share, seen along the normal of contact.
!!
!! The face of a shape is that whose outward normal is nearest to the normal of contact, or against it. The joint is the overlap of
!! both faces projected on the plane of contact, whether it is closed or open at one edge:
!!
!!        ____________
!!       |  candidate |           in the plane: the length that both edges share, from a to b, and its middle m
!!       |____________|
!!        ....a__m__b______       in space: the polygon that both faces share, and its centroid
!!            | antagonist |
!!
!! Polygons, rounded segments, polyhedra and planes have faces. Shapes of another kind, and a corner on a face, share none.
module sg_facing_faces
  use sg_contactors, only: contactors_t, kind_plane, kind_polygon, kind_polyhedron, kind_segment
  use sg_kinds, only: wp
  use sg_overlap_polygons, only: clip
  use sg_vectors, only: cross
  implicit none
  private
  public :: find_joint

  !> Least cosine of the angle between the outward normal of a face and the direction that it faces: 10 degrees
  real(wp), parameter :: least_cosine = 0.985_wp

contains

  !> Area and middle of the joint of two shapes.
  pure subroutine find_joint(contactors, pair, normal, point, shift, area, middle)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer, intent(in) :: pair(2) !! candidate and antagonist
    real(wp), intent(in) :: normal(3) !! from antagonist to candidate
    real(wp), intent(in) :: point(3) !! a point of their plane of contact [m]
    real(wp), intent(in) :: shift(3) !! added to the antagonist's coordinates [m]
    real(wp), intent(out) :: area !! [m2], in the plane the length [m]; zero where no faces face each other
    real(wp), intent(out) :: middle(3) !! in the plane of contact [m]; the point where there is no area
    real(wp), allocatable :: face_c(:, :), face_a(:, :)
    integer :: i

    area = 0
    middle = point
    if (.not. (has_faces(contactors, pair(1)) .and. has_faces(contactors, pair(2)))) return
    if (contactors%dimension == 2) then
      call find_edge(contactors, pair(1), -normal(1:2), face_c)
      call find_edge(contactors, pair(2), normal(1:2), face_a)
    else
      call find_face(contactors, pair(1), -normal, face_c)
      call find_face(contactors, pair(2), normal, face_a)
    end if
    do i = 1, size(face_c, 2)
      face_c(:, i) = face_c(:, i) - point
    end do
    do i = 1, size(face_a, 2)
      face_a(:, i) = face_a(:, i) + (shift - point)
    end do
    if (size(face_c, 2) == 0 .or. size(face_a, 2) == 0) return
    if (contactors%dimension == 2) then
      call share_edges(face_c, face_a, [normal(2), -normal(1), 0.0_wp], area, middle)
    else
      call share_faces(face_c, face_a, normal, area, middle)
    end if
    middle = middle + point
  end subroutine find_joint

  !> Has a shape flat faces?
  pure logical function has_faces(contactors, c)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c

    has_faces = any(contactors%kind(c) == [kind_polygon, kind_segment, kind_polyhedron, kind_plane])
  end function has_faces

  !> Ends of the edge of a shape in the plane that faces a direction, shape (3, 2); none where no edge does.
  pure subroutine find_edge(contactors, c, direction, ends)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp), intent(in) :: direction(2)
    real(wp), allocatable, intent(out) :: ends(:, :)
    real(wp) :: out(2)
    integer :: row, first, last, best, v

    row = contactors%row(c)
    if (contactors%kind(c) == kind_polygon) then
      first = contactors%polygon_first(row)
      last = contactors%polygon_first(row + 1) - 1
      best = first
      do v = first, last
        if (dot_product(contactors%polygon_edge(1:2, v), direction) > dot_product(contactors%polygon_edge(1:2, best), direction)) &
          best = v
      end do
      out = contactors%polygon_edge(1:2, best)
      call make_face(merge(2, 0, dot_product(out, direction) > least_cosine), ends)
      if (size(ends, 2) == 0) return
      ends(1:2, 1) = contactors%polygon_world(:, best)
      ends(1:2, 2) = contactors%polygon_world(:, merge(first, best + 1, best == last))
    else
      associate (axis => contactors%segment_axis(:, row), size_of => contactors%segment_size(:, row))
        out = [axis(2), -axis(1)]
        call make_face(merge(2, 0, abs(dot_product(out, direction)) > least_cosine), ends)
        if (size(ends, 2) == 0) return
        out = contactors%centre(:, c) + sign(size_of(2), dot_product(out, direction))*out
        ends(1:2, 1) = out - size_of(1)*axis
        ends(1:2, 2) = out + size_of(1)*axis
      end associate
    end if
  end subroutine find_edge

  !> Corners of the face of a shape in space that faces a direction, shape (3, corners); none where no face does.
  pure subroutine find_face(contactors, c, direction, corners)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp), intent(in) :: direction(3)
    real(wp), allocatable, intent(out) :: corners(:, :)
    real(wp) :: axes(3, 3), along(3), out(3), one(3), other(3)
    integer :: f, best, row

    row = contactors%row(c)
    if (contactors%kind(c) == kind_polyhedron) then
      associate (shape_of => contactors%space%polyhedra(row))
        best = 1
        do f = 2, shape_of%n_faces
          if (dot_product(shape_of%world_normal(:, f), direction) > dot_product(shape_of%world_normal(:, best), direction)) best = f
        end do
        associate (first => shape_of%face_first(best), last => shape_of%face_first(best + 1) - 1)
          call make_face(merge(last - first + 1, 0, dot_product(shape_of%world_normal(:, best), direction) > least_cosine), corners)
          if (size(corners, 2) > 0) corners(:, :) = shape_of%world_vertex(:, shape_of%face_vertex(first:last))
        end associate
      end associate
    else
      axes = reshape(contactors%space%plane_world(:, row), [3, 3])
      along = matmul(direction, axes)
      best = maxloc(abs(along), 1)
      call make_face(merge(4, 0, abs(along(best)) > least_cosine), corners)
      if (size(corners, 2) == 0) return
      associate (half => contactors%space%plane_half(:, row), i => modulo(best, 3) + 1, j => modulo(best + 1, 3) + 1)
        out = contactors%centre(:, c) + sign(half(best), along(best))*axes(:, best)
        one = half(i)*axes(:, i)
        other = half(j)*axes(:, j)
      end associate
      corners(:, 1) = out - one - other
      corners(:, 2) = out + one - other
      corners(:, 3) = out + one + other
      corners(:, 4) = out - one + other
    end if
  end subroutine find_face

  !> Room for the corners of a face.
  pure subroutine make_face(n, corners)
    integer, intent(in) :: n
    real(wp), allocatable, intent(out) :: corners(:, :)

    allocate (corners(3, n), source=0.0_wp)
  end subroutine make_face

  !> Length that two edges share along a tangent, and its middle.
  pure subroutine share_edges(one, other, tangent, length, middle)
    real(wp), intent(in) :: one(3, 2), other(3, 2), tangent(3)
    real(wp), intent(out) :: length, middle(3)
    real(wp) :: low, high

    low = max(minval(matmul(tangent, one)), minval(matmul(tangent, other)))
    high = min(maxval(matmul(tangent, one)), maxval(matmul(tangent, other)))
    length = max(0.0_wp, high - low)
    middle = 0
    if (length > 0) middle = (low + high)/2*tangent
  end subroutine share_edges

  !> Area that two convex faces share, seen along a normal, and its centroid.
  pure subroutine share_faces(one, other, normal, area, middle)
    real(wp), intent(in) :: one(:, :), other(:, :), normal(3)
    real(wp), intent(out) :: area, middle(3)
    real(wp) :: frame(3, 2), left(2, size(one, 2) + size(other, 2)), by(2, size(other, 2)), side(2), part, moment(2)
    integer :: n, i, next

    frame(:, 1) = 0
    frame(minloc(abs(normal), 1), 1) = 1
    frame(:, 1) = frame(:, 1) - dot_product(frame(:, 1), normal)*normal
    frame(:, 1) = frame(:, 1)/norm2(frame(:, 1))
    frame(:, 2) = cross(normal, frame(:, 1))
    n = size(one, 2)
    left(:, :n) = counter_clockwise(matmul(transpose(frame), one))
    by = counter_clockwise(matmul(transpose(frame), other))
    do i = 1, size(by, 2)
      next = merge(1, i + 1, i == size(by, 2))
      side = by(:, next) - by(:, i)
      call clip(n, left, by(:, i), [side(2), -side(1)])
    end do
    area = 0
    moment = 0
    do i = 2, n - 1
      part = double_area(left(:, 1), left(:, i), left(:, i + 1))/2
      area = area + part
      moment = moment + part*(left(:, 1) + left(:, i) + left(:, i + 1))/3
    end do
    middle = 0
    if (area > 0) middle = matmul(frame, moment/area)
    area = max(0.0_wp, area)
  end subroutine share_faces

  !> The corners of a convex polygon, turned round where they run clockwise.
  pure function counter_clockwise(corners) result(turned)
    real(wp), intent(in) :: corners(:, :)
    real(wp) :: turned(2, size(corners, 2)), doubled
    integer :: i

    doubled = 0
    do i = 2, size(corners, 2) - 1
      doubled = doubled + double_area(corners(:, 1), corners(:, i), corners(:, i + 1))
    end do
    turned = corners
    if (doubled < 0) turned = corners(:, size(corners, 2):1:-1)
  end function counter_clockwise

  !> Twice the area of a triangle, positive where it runs counter-clockwise.
  pure real(wp) function double_area(a, b, c)
    real(wp), intent(in) :: a(2), b(2), c(2)

    double_area = (b(1) - a(1))*(c(2) - a(2)) - (b(2) - a(2))*(c(1) - a(1))
  end function double_area
end module sg_facing_faces
