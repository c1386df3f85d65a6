!> Paths through shapes: does a point that moves from one place to another go through a convex shape, or end beyond its middle?
!!
!! The path is cut by the planes of the shape's faces (Cyrus and Beck), or by the balls and the tube of a round shape. A path that
!! ends inside goes through where the nearest surface lies ahead: a contact there pushes on, not back. A hollow shape pushes back
!! all that detection finds outside of it: a path goes through its surface where it ends out of the range of detection.
module sg_swept_shapes
  use sg_contactors, only: contactors_t, kind_cylinder, kind_disk, kind_hollow, kind_hollow_cylinder, kind_plane, kind_polygon, &
                           kind_polyhedron, kind_segment, kind_sphere
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

  !> Does the path of a point lead through a shape?
  pure logical function goes_through(contactors, obstacle, from, to)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer, intent(in) :: obstacle !! the shape
    real(wp), intent(in) :: from(:), to(:) !! ends of the path [m], shape (dimension)
    type(path_t) :: path
    real(wp) :: centre(3)
    integer :: n, row

    n = size(from)
    path%from(:n) = from
    path%to(:n) = to
    centre = 0
    centre(:n) = contactors%centre(:, obstacle)
    row = contactors%row(obstacle)
    select case (contactors%kind(obstacle))
    case (kind_segment)
      call cut_by_capsule(path, centre, [contactors%segment_axis(:, row), 0.0_wp], contactors%segment_size(1, row), &
                          contactors%segment_size(2, row))
    case (kind_polygon)
      call cut_by_polygon(path, contactors, obstacle)
    case (kind_plane)
      call cut_by_box(path, centre, reshape(contactors%space%plane_world(:, row), [3, 3]), contactors%space%plane_half(:, row))
    case (kind_polyhedron)
      call cut_by_polyhedron(path, contactors, obstacle)
    case (kind_disk, kind_sphere)
      call cut_by_capsule(path, centre, [1.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, contactors%reach(obstacle))
    case (kind_cylinder)
      call cut_by_capsule(path, centre, contactors%space%cylinder_world(:, row), contactors%space%cylinder_size(1, row), &
                          contactors%space%cylinder_size(2, row))
    case (kind_hollow)
      call cut_by_hollow(path, centre, [0.0_wp, 0.0_wp, 1.0_wp], huge(1.0_wp), contactors%reach(obstacle), &
                         contactors%reach(obstacle))
    case (kind_hollow_cylinder)
      call cut_by_hollow(path, centre, contactors%space%hollow_world(:, row), contactors%space%hollow_size(1, row), &
                         contactors%space%hollow_size(2, row), contactors%reach(obstacle))
    end select
    goes_through = path%starts_outside .and. path%enters < path%leaves .and. (path%height > 0 .or. path%looks_ahead)
  end function goes_through

  !> Cut a path by the balls and the tube about a segment.
  pure subroutine cut_by_capsule(path, centre, axis, half_length, radius)
    type(path_t), intent(inout) :: path
    real(wp), intent(in) :: centre(3), axis(3), half_length, radius
    real(wp) :: way(3), start(3), finish(3), share(2)
    integer :: side

    way = path%to - path%from
    start = path%from - centre
    finish = path%to - centre
    path%starts_outside = norm2(from_segment(start)) > radius
    finish = from_segment(finish)
    path%height = norm2(finish) - radius
    path%looks_ahead = dot_product(finish, way) > 0
    path%enters = 2
    path%leaves = 0
    do side = -1, 1, 2
      share = within_ball(start - real(side, wp)*half_length*axis, way, radius)
      call widen(path, share)
    end do
    share = within_ball(across(start), across(way), radius)
    call clip_slab(share, dot_product(start, axis), dot_product(way, axis), half_length)
    call widen(path, share)
  contains
    !> Part of a vector across the axis.
    pure function across(v)
      real(wp), intent(in) :: v(3)
      real(wp) :: across(3)

      across = v - dot_product(v, axis)*axis
    end function across

    !> Way from the segment to a point given from its centre.
    pure function from_segment(v) result(apart)
      real(wp), intent(in) :: v(3)
      real(wp) :: apart(3)

      apart = v - max(-half_length, min(half_length, dot_product(v, axis)))*axis
    end function from_segment
  end subroutine cut_by_capsule

  !> Let the path's part within the shape hold one more part.
  pure subroutine widen(path, share)
    type(path_t), intent(inout) :: path
    real(wp), intent(in) :: share(2)

    if (share(1) >= share(2)) return
    path%enters = min(path%enters, share(1))
    path%leaves = max(path%leaves, share(2))
  end subroutine widen

  !> Cut a path that leads out of a hollow shape through its surface: it goes through where no contact is found at its end.
  pure subroutine cut_by_hollow(path, centre, axis, half_height, radius, reach)
    type(path_t), intent(inout) :: path
    real(wp), intent(in) :: centre(3), axis(3), half_height, radius, reach
    real(wp) :: way(3), start(3), finish(3), share(2), along, end_along

    start = path%from - centre
    finish = path%to - centre
    way = finish - start
    along = dot_product(start, axis)
    end_along = dot_product(finish, axis)
    share = within_ball(start - along*axis, way - dot_product(way, axis)*axis, radius)
    path%starts_outside = .false.
    if (abs(along) > half_height .or. norm2(start - along*axis) >= radius .or. share(2) >= 1) return
    if (abs(along + share(2)*(end_along - along)) > half_height) return
    ! Cells are at least twice the reach wide, and detection looks in the next ones.
    path%starts_outside = abs(end_along) > half_height .or. maxval(abs(finish)) > 2*reach
    path%height = 1
  end subroutine cut_by_hollow

  !> Shares between which a path is within a ball about the origin, or a tube where both vectors lie across its axis; none where the
  !! first is not below the second.
  pure function within_ball(start, way, radius) result(share)
    real(wp), intent(in) :: start(3), way(3), radius
    real(wp) :: share(2)
    real(wp) :: length, nearest, apart(3), half

    length = norm2(way)
    share = [1.0_wp, 0.0_wp]
    if (.not. length > 0) then
      if (norm2(start) < radius) share = [0.0_wp, 1.0_wp]
      return
    end if
    nearest = -dot_product(start, way/length)
    apart = start + nearest*(way/length)
    if (norm2(apart) >= radius) return
    half = sqrt((radius - norm2(apart))*(radius + norm2(apart)))
    share = [max(0.0_wp, (nearest - half)/length), min(1.0_wp, (nearest + half)/length)]
  end function within_ball

  !> Keep of a part of a path what lies within a distance of a plane.
  pure subroutine clip_slab(share, start, way, half)
    real(wp), intent(inout) :: share(2)
    real(wp), intent(in) :: start, way, half
    real(wp) :: ends(2)

    if (abs(way) > 0) then
      ! Far beyond both ends of the path all is one; so nothing overflows.
      ends = [-half - start, half - start]
      if (way < 0) ends = -ends([2, 1])
      ends = max(-abs(way), min(2*abs(way), ends))/abs(way)
      share = [max(share(1), ends(1)), min(share(2), ends(2))]
    else if (abs(start) > half) then
      share = [1.0_wp, 0.0_wp]
    end if
  end subroutine clip_slab

  !> Cut a path by the sides of a box.
  pure subroutine cut_by_box(path, centre, frame, half)
    type(path_t), intent(inout) :: path
    real(wp), intent(in) :: centre(3), frame(3, 3), half(3)
    integer :: i

    do i = 1, 3
      call cut_path(path, frame(:, i), centre + half(i)*frame(:, i))
      call cut_path(path, -frame(:, i), centre - half(i)*frame(:, i))
    end do
  end subroutine cut_by_box

  !> Cut a path by the edges of a polygon.
  pure subroutine cut_by_polygon(path, contactors, obstacle)
    type(path_t), intent(inout) :: path
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: obstacle
    real(wp) :: edge(2)
    integer :: v, first, last

    first = contactors%polygon_first(contactors%row(obstacle))
    last = contactors%polygon_first(contactors%row(obstacle) + 1) - 1
    do v = first, last
      associate (vertex => contactors%polygon_world)
        edge = vertex(:, merge(first, v + 1, v == last)) - vertex(:, v)
        if (norm2(edge) > 0) call cut_path(path, [edge(2), -edge(1), 0.0_wp]/norm2(edge), [vertex(:, v), 0.0_wp])
      end associate
    end do
  end subroutine cut_by_polygon

  !> Cut a path by the faces of a polyhedron.
  pure subroutine cut_by_polyhedron(path, contactors, obstacle)
    type(path_t), intent(inout) :: path
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: obstacle
    integer :: f

    associate (shape => contactors%space%polyhedra(contactors%row(obstacle)))
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
    real(wp) :: start, finish, rounding

    start = dot_product(normal, path%from - place)
    finish = dot_product(normal, path%to - place)
    ! Of faces as high as each other, to rounding, detection may take any: one that looks ahead counts.
    rounding = 8*epsilon(1.0_wp)*(norm2(path%to) + norm2(place))
    if (finish > path%height + rounding) then
      path%looks_ahead = finish > start
    else if (finish > path%height - rounding) then
      path%looks_ahead = path%looks_ahead .or. finish > start
    end if
    path%height = max(path%height, finish)
    if (start > 0) then
      path%starts_outside = .true.
      ! A path that ends outside of the same face does not enter at all.
      if (finish >= 0) path%enters = 2
      if (finish < 0) path%enters = max(path%enters, start/(start - finish))
    else if (finish > 0) then
      path%leaves = min(path%leaves, start/(start - finish))
    end if
  end subroutine cut_path
end module sg_swept_shapes
