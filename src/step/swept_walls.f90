!> Paths through walls: does a point that moves from one place to another go through a convex shape, or end beyond its middle?
!!
!! The path is cut by the planes of the shape's faces (Cyrus and Beck). A path that ends inside goes through where the nearest face
!! lies ahead: a contact there pushes on, not back.
module sg_swept_walls
  use sg_contactors, only: contactors_t, kind_plane, kind_polygon, kind_polyhedron, kind_wall
  use sg_kinds, only: wp
  implicit none
  private
  public :: goes_through

  !> A path and what the faces have left of it so far
  type :: path_t
    real(wp) :: from(3) = 0, to(3) = 0
    !> Shares of the path where it enters and leaves the shape, and the height of its end above the highest face [m]
    real(wp) :: enters = 0, leaves = 1, height = -huge(1.0_wp)
    !> Is the start outside, and does the highest face at the end look ahead?
    logical :: starts_outside = .false., looks_ahead = .false.
  end type path_t

contains

  !> Does the path of a point lead through a shape? Shapes without flat faces are not looked at.
  pure logical function goes_through(contactors, wall, from, to)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer, intent(in) :: wall !! the shape
    real(wp), intent(in) :: from(:), to(:) !! ends of the path [m], shape (dimension)
    type(path_t) :: path
    integer :: n

    n = size(from)
    path%from(:n) = from
    path%to(:n) = to
    select case (contactors%kind(wall))
    case (kind_wall)
      call cut_by_box(path, contactors%centre(:, wall), segment_frame(contactors, wall), &
                      [contactors%wall_size(1:2, contactors%row(wall)), huge(1.0_wp)])
    case (kind_polygon)
      call cut_by_polygon(path, contactors, wall)
    case (kind_plane)
      call cut_by_box(path, contactors%centre(:, wall), reshape(contactors%space%plane_world(:, contactors%row(wall)), [3, 3]), &
                      contactors%space%plane_half(:, contactors%row(wall)))
    case (kind_polyhedron)
      call cut_by_polyhedron(path, contactors, wall)
    end select
    goes_through = path%starts_outside .and. path%enters < path%leaves .and. (path%height > 0 .or. path%looks_ahead)
  end function goes_through

  !> Axes of a rounded segment: along it, across, and out of the plane.
  pure function segment_frame(contactors, wall) result(frame)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: wall
    real(wp) :: frame(3, 3)

    associate (axis => contactors%wall_axis(:, contactors%row(wall)))
      frame = reshape([axis(1), axis(2), 0.0_wp, -axis(2), axis(1), 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
    end associate
  end function segment_frame

  !> Cut a path by the sides of a box; those at no finite distance have no part.
  pure subroutine cut_by_box(path, centre, frame, half)
    type(path_t), intent(inout) :: path
    real(wp), intent(in) :: centre(:), frame(3, 3), half(3)
    real(wp) :: middle(3)
    integer :: i

    middle = 0
    middle(:size(centre)) = centre
    do i = 1, 3
      if (half(i) > sqrt(huge(1.0_wp))) cycle
      call cut_path(path, frame(:, i), middle + half(i)*frame(:, i))
      call cut_path(path, -frame(:, i), middle - half(i)*frame(:, i))
    end do
  end subroutine cut_by_box

  !> Cut a path by the edges of a polygon.
  pure subroutine cut_by_polygon(path, contactors, wall)
    type(path_t), intent(inout) :: path
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: wall
    real(wp) :: edge(2)
    integer :: v, first, last

    first = contactors%polygon_first(contactors%row(wall))
    last = contactors%polygon_first(contactors%row(wall) + 1) - 1
    do v = first, last
      associate (vertex => contactors%polygon_world)
        edge = vertex(:, merge(first, v + 1, v == last)) - vertex(:, v)
        if (norm2(edge) > 0) call cut_path(path, [edge(2), -edge(1), 0.0_wp]/norm2(edge), [vertex(:, v), 0.0_wp])
      end associate
    end do
  end subroutine cut_by_polygon

  !> Cut a path by the faces of a polyhedron.
  pure subroutine cut_by_polyhedron(path, contactors, wall)
    type(path_t), intent(inout) :: path
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: wall
    integer :: f

    associate (shape => contactors%space%polyhedra(contactors%row(wall)))
      do f = 1, shape%n_faces
        call cut_path(path, shape%world_normal(:, f), shape%world_vertex(:, shape%face_vertex(shape%face_first(f))))
      end do
    end associate
  end subroutine cut_by_polyhedron

  !> Cut a path by one face.
  pure subroutine cut_path(path, normal, place)
    type(path_t), intent(inout) :: path
    real(wp), intent(in) :: normal(3) !! unit outward normal of the face
    real(wp), intent(in) :: place(3) !! a point of it [m]
    real(wp) :: start, finish

    start = dot_product(normal, path%from - place)
    finish = dot_product(normal, path%to - place)
    if (finish > path%height) then
      path%height = finish
      path%looks_ahead = finish > start
    end if
    if (start > 0) then
      path%starts_outside = .true.
      ! A path that ends outside of the same face does not enter at all.
      if (finish >= 0) path%enters = 2
      if (finish < 0) path%enters = max(path%enters, start/(start - finish))
    else if (finish > 0) then
      path%leaves = min(path%leaves, start/(start - finish))
    end if
  end subroutine cut_path
end module sg_swept_walls
