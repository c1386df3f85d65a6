!> How deep two shapes in space overlap: every shape but the hollow cylinder is a core, a point, a segment or a convex
!! polyhedron, made rounder by a radius.
!!
!! Where cores overlap, their depth is the least along the axes on which two convex polyhedra part: normals of faces and
!! products of edges. Where they are apart, their distance is the least between an edge and an edge or a vertex and a face.
module sg_solid_overlaps
  use sg_contactors, only: contactors_t
  use sg_kinds, only: wp, i4
  use sg_space_shapes, only: kind_cylinder, kind_hollow_cylinder, kind_plane, kind_polyhedron
  use sg_vectors, only: cross
  implicit none
  private
  public :: solid_overlap_depth

  !> The core of a shape
  type :: core_t
    !> Points [m], shape (3, n)
    real(wp), allocatable :: point(:, :)
    !> Edges, as pairs of points; a single point is an edge too
    integer(i4), allocatable :: edge(:, :)
    !> Outward normals of the faces, shape (3, n_faces), and corners of face f, `corner(first(f):first(f + 1) - 1)`
    real(wp), allocatable :: normal(:, :)
    integer(i4), allocatable :: first(:), corner(:)
    !> Radius about it [m]
    real(wp) :: radius = 0
  end type core_t

contains

  !> Depth of the overlap of two placed contactors [m]; negative where they are apart.
  pure real(wp) function solid_overlap_depth(contactors, c1, c2, shift) result(depth)
    type(contactors_t), intent(in) :: contactors !! contactors, placed
    integer, intent(in) :: c1 !! one contactor
    integer, intent(in) :: c2 !! the other
    real(wp), intent(in) :: shift(3) !! moves the other [m], for periodic images
    type(core_t) :: p, q
    integer :: i

    if (contactors%kind(c1) == kind_hollow_cylinder) then
      call take_core(contactors, c2, shift, q)
      depth = out_of_hollow(contactors, c1, [0.0_wp, 0.0_wp, 0.0_wp], q)
    else if (contactors%kind(c2) == kind_hollow_cylinder) then
      call take_core(contactors, c1, [0.0_wp, 0.0_wp, 0.0_wp], p)
      depth = out_of_hollow(contactors, c2, shift, p)
    else
      call take_core(contactors, c1, [0.0_wp, 0.0_wp, 0.0_wp], p)
      call take_core(contactors, c2, shift, q)
      depth = separation(p, q)
      if (depth > 0) then
        depth = distance_of_edges(p, q)
        do i = 1, size(p%point, 2)
          depth = min(depth, distance_to_faces(p%point(:, i), q))
        end do
        do i = 1, size(q%point, 2)
          depth = min(depth, distance_to_faces(q%point(:, i), p))
        end do
      end if
      depth = p%radius + q%radius - depth
    end if
  end function solid_overlap_depth

  !> Core of a contactor.
  pure subroutine take_core(contactors, c, shift, core)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp), intent(in) :: shift(3)
    type(core_t), intent(out) :: core
    real(wp) :: along(3)
    integer :: row, i

    row = contactors%row(c)
    associate (space => contactors%space, centre => contactors%centre(:, c))
      select case (contactors%kind(c))
      case (kind_plane)
        call box_core(space%plane_half(:, row), reshape(space%plane_world(:, row), [3, 3]), centre, core)
      case (kind_cylinder)
        along = space%cylinder_size(1, row)*space%cylinder_world(:, row)
        core%point = reshape([centre - along, centre + along], [3, 2])
        core%edge = reshape([1_i4, 2_i4], [2, 1])
        core%radius = space%cylinder_size(2, row)
      case (kind_polyhedron)
        associate (shape => space%polyhedra(row))
          core%point = shape%world_vertex
          core%edge = shape%edge(:2, :)
          core%normal = shape%world_normal
          core%first = shape%face_first
          core%corner = shape%face_vertex
        end associate
      case default
        core%point = reshape(centre, [3, 1])
        core%edge = reshape([1_i4, 1_i4], [2, 1])
        core%radius = contactors%reach(c)
      end select
    end associate
    if (.not. allocated(core%normal)) allocate (core%normal(3, 0), core%first(0), core%corner(0))
    do i = 1, size(core%point, 2)
      core%point(:, i) = core%point(:, i) + shift
    end do
  end subroutine take_core

  !> Corners, edges and faces of a box; corner i lies on the sides that the bits of i - 1 tell.
  pure subroutine box_core(half, frame, centre, core)
    real(wp), intent(in) :: half(3), frame(3, 3), centre(3)
    type(core_t), intent(inout) :: core
    integer :: i, axis, n

    allocate (core%point(3, 8), core%edge(2, 12), core%normal(3, 6), core%first(7), core%corner(24))
    core%first = [(int(4*i - 3, i4), i=1, 7)]
    n = 0
    do i = 0, 7
      core%point(:, i + 1) = centre + matmul(frame, merge(half, -half, [(btest(i, axis), axis=0, 2)]))
      do axis = 0, 2
        if (btest(i, axis)) cycle
        n = n + 1
        core%edge(:, n) = int([i, ibset(i, axis)] + 1, i4)
      end do
    end do
    do axis = 0, 2
      do i = 1, 2
        core%normal(:, 2*axis + i) = merge(1.0_wp, -1.0_wp, i == 1)*frame(:, axis + 1)
        call face_of_box(axis, i == 1, core%corner(8*axis + 4*i - 3:8*axis + 4*i))
      end do
    end do
  end subroutine box_core

  !> The corners of one face of a box, in order around it.
  pure subroutine face_of_box(axis, is_far, corner)
    integer, intent(in) :: axis
    logical, intent(in) :: is_far
    integer(i4), intent(out) :: corner(4)
    integer :: start, next, last

    next = mod(axis + 1, 3)
    last = mod(axis + 2, 3)
    start = merge(ibset(0, axis), 0, is_far)
    corner = int([start, ibset(start, next), ibset(ibset(start, next), last), ibset(start, last)] + 1, i4)
    if (.not. is_far) corner = corner(4:1:-1)
  end subroutine face_of_box

  !> Largest gap of two cores along the axes on which they can part; negative where they overlap.
  pure real(wp) function separation(p, q) result(gap)
    type(core_t), intent(in) :: p, q
    real(wp) :: axis(3), first(3), second(3), length
    integer :: i, j

    ! Points and segments do not overlap.
    gap = tiny(gap)
    if (size(p%normal, 2) + size(q%normal, 2) == 0) return
    gap = -huge(1.0_wp)
    do i = 1, size(p%normal, 2)
      gap = max(gap, minval(matmul(p%normal(:, i), q%point)) - maxval(matmul(p%normal(:, i), p%point)))
    end do
    do i = 1, size(q%normal, 2)
      gap = max(gap, minval(matmul(q%normal(:, i), p%point)) - maxval(matmul(q%normal(:, i), q%point)))
    end do
    if (gap > 0) return
    do i = 1, size(p%edge, 2)
      first = p%point(:, p%edge(2, i)) - p%point(:, p%edge(1, i))
      do j = 1, size(q%edge, 2)
        second = q%point(:, q%edge(2, j)) - q%point(:, q%edge(1, j))
        axis = cross(first, second)
        length = norm2(axis)
        if (.not. length > 1e-9_wp*norm2(first)*norm2(second)) cycle
        axis = axis/length
        gap = max(gap, minval(matmul(axis, q%point)) - maxval(matmul(axis, p%point)), &
                  minval(matmul(axis, p%point)) - maxval(matmul(axis, q%point)))
        if (gap > 0) return
      end do
    end do
  end function separation

  !> Least distance of two sets of edges.
  pure real(wp) function distance_of_edges(p, q) result(distance)
    type(core_t), intent(in) :: p, q
    integer :: i, j

    distance = huge(1.0_wp)
    do i = 1, size(p%edge, 2)
      do j = 1, size(q%edge, 2)
        distance = min(distance, distance_of_segments(p%point(:, p%edge(1, i)), p%point(:, p%edge(2, i)), &
                                                      q%point(:, q%edge(1, j)), q%point(:, q%edge(2, j))))
      end do
    end do
  end function distance_of_edges

  !> Distance of two segments: between their insides, or from an end to the other.
  pure real(wp) function distance_of_segments(a, b, c, d) result(distance)
    real(wp), intent(in) :: a(3), b(3), c(3), d(3)
    real(wp) :: u(3), v(3), w(3), uu, uv, vv, determinant, s, t

    u = b - a
    v = d - c
    w = a - c
    distance = min(to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b))
    uu = dot_product(u, u)
    uv = dot_product(u, v)
    vv = dot_product(v, v)
    determinant = uu*vv - uv**2
    if (.not. determinant > 1e-12_wp*uu*vv) return
    s = (uv*dot_product(v, w) - vv*dot_product(u, w))/determinant
    t = (uu*dot_product(v, w) - uv*dot_product(u, w))/determinant
    if (min(s, t) >= 0 .and. max(s, t) <= 1) distance = min(distance, norm2(w + s*u - t*v))
  end function distance_of_segments

  !> Distance of a point from a segment.
  pure real(wp) function to_segment(point, a, b) result(distance)
    real(wp), intent(in) :: point(3), a(3), b(3)
    real(wp) :: share, length

    share = 0
    length = sum((b - a)**2)
    if (length > 0) share = max(0.0_wp, min(1.0_wp, dot_product(point - a, b - a)/length))
    distance = norm2(point - a - share*(b - a))
  end function to_segment

  !> Distance of a point from the faces below it; huge where it stands above none.
  pure real(wp) function distance_to_faces(point, core) result(distance)
    real(wp), intent(in) :: point(3)
    type(core_t), intent(in) :: core
    real(wp) :: height, edge(3), from(3)
    integer :: f, k, next
    logical :: is_above

    distance = huge(1.0_wp)
    do f = 1, size(core%normal, 2)
      height = dot_product(core%normal(:, f), point - core%point(:, core%corner(core%first(f))))
      if (height < 0 .or. height > distance) cycle
      is_above = .true.
      do k = core%first(f), core%first(f + 1) - 1
        next = merge(core%first(f), int(k + 1, i4), k == core%first(f + 1) - 1)
        from = core%point(:, core%corner(k))
        edge = core%point(:, core%corner(next)) - from
        is_above = is_above .and. dot_product(cross(edge, point - from), core%normal(:, f)) >= 0
      end do
      if (is_above) distance = height
    end do
  end function distance_to_faces

  !> How far a core stands out of a hollow cylinder [m], where it is between its ends.
  pure real(wp) function out_of_hollow(contactors, c, shift, core) result(depth)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp), intent(in) :: shift(3)
    type(core_t), intent(in) :: core
    real(wp) :: arm(3), along
    integer :: i, row

    row = contactors%row(c)
    depth = -huge(1.0_wp)
    associate (axis => contactors%space%hollow_world(:, row), size_of => contactors%space%hollow_size(:, row))
      do i = 1, size(core%point, 2)
        arm = core%point(:, i) - contactors%centre(:, c) - shift
        along = dot_product(arm, axis)
        if (abs(along) > size_of(1)) cycle
        depth = max(depth, norm2(arm - along*axis) + core%radius - size_of(2))
      end do
    end associate
  end function out_of_hollow
end module sg_solid_overlaps
