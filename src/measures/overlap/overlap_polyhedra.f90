!> Volumes that convex polyhedra share with each other, with planes (boxes) and with spheres, all exact.
!!
!! Polyhedra are taken as placed in the world (`place_polyhedron`).
module sg_overlap_polyhedra
  use sg_kinds, only: wp
  use sg_overlap_ball, only: ball_in_faces
  use sg_overlap_solid, only: cut, cut_first, solid_room_t, solid_t, solid_volume
  use sg_polyhedron, only: polyhedron_t
  implicit none
  private
  public :: overlap_polyhedron_polyhedron, overlap_polyhedron_plane, overlap_sphere_polyhedron
  public :: measure_polyhedra, measure_polyhedron_plane, overlap_room_t

  !> Cosine from which a plane counts as across a direction
  real(wp), parameter :: across = 0.99_wp

  !> Room for the work of pairs, one after the other
  type :: overlap_room_t
    private
    !> What is left of the candidate, and room to cut it
    type(solid_t) :: solid
    type(solid_room_t) :: cuts
    !> Of each plane its height above the candidate's centre [m], and the cosine between its normal and the direction; those of the
    !! other shape
    real(wp), allocatable :: height(:), facing(:), other(:)
    !> Planes that may cut
    integer, allocatable :: plane(:)
  end type overlap_room_t

contains

  !> Volume shared by two convex polyhedra [m3].
  pure real(wp) function overlap_polyhedron_polyhedron(candidate, antagonist, offset) result(volume)
    type(polyhedron_t), intent(in) :: candidate !! placed polyhedron
    type(polyhedron_t), intent(in) :: antagonist !! placed polyhedron
    real(wp), intent(in) :: offset(3) !! added to the antagonist's vertices (its periodic image) [m]
    type(overlap_room_t) :: room

    call measure_polyhedra(candidate, antagonist, offset, antagonist%world_normal(:, 1), room, volume)
  end function overlap_polyhedron_polyhedron

  !> The same with room for the work, and a direction: the one cut by every face of the other, whose face is more square to it.
  pure subroutine measure_polyhedra(candidate, antagonist, offset, direction, room, volume)
    type(polyhedron_t), intent(in) :: candidate !! placed polyhedron
    type(polyhedron_t), intent(in) :: antagonist !! placed polyhedron
    real(wp), intent(in) :: offset(3) !! added to the antagonist's vertices (its periodic image) [m]
    real(wp), intent(in) :: direction(3) !! unit vector: least work where they overlap least along it, as along a contact normal
    type(overlap_room_t), intent(inout) :: room !! room for the work
    real(wp), intent(out) :: volume !! volume shared [m3]
    real(wp) :: shift(3), own, square

    volume = 0
    shift = antagonist%centre + offset - candidate%centre
    if (sum(shift**2) >= (candidate%reach + antagonist%reach)**2) return
    call make_room(room, max(candidate%n_faces, antagonist%n_faces))
    call find_facing(candidate%n_faces, candidate%world_normal, -direction, room%other, own)
    call find_facing(antagonist%n_faces, antagonist%world_normal, direction, room%facing, square)
    if (own > square) then
      room%facing(:candidate%n_faces) = room%other(:candidate%n_faces)
      call cut_by_faces(antagonist, candidate, -offset, -direction, room, volume)
    else
      call cut_by_faces(candidate, antagonist, offset, direction, room, volume)
    end if
  end subroutine measure_polyhedra

  !> Cosines between normals and a direction, and the largest of them.
  pure subroutine find_facing(n, normal, direction, facing, largest)
    integer, intent(in) :: n !! normals
    real(wp), intent(in), contiguous :: normal(:, :)
    real(wp), intent(in) :: direction(3)
    real(wp), intent(inout), contiguous :: facing(:)
    real(wp), intent(out) :: largest
    integer :: f

    largest = -1
    do f = 1, n
      facing(f) = normal(1, f)*direction(1) + normal(2, f)*direction(2) + normal(3, f)*direction(3)
      largest = max(largest, facing(f))
    end do
  end subroutine find_facing

  !> Volume of a polyhedron within another [m3]: arguments as in `measure_polyhedra`; cosines of the antagonist's faces are known.
  pure subroutine cut_by_faces(candidate, antagonist, offset, direction, room, volume)
    type(polyhedron_t), intent(in) :: candidate, antagonist
    real(wp), intent(in) :: offset(3), direction(3)
    type(overlap_room_t), intent(inout) :: room
    real(wp), intent(out) :: volume
    real(wp) :: shift(3), v(3), top
    integer :: f, i

    shift = offset - candidate%centre
    do f = 1, antagonist%n_faces
      associate (n => antagonist%world_normal(:, f))
        v = antagonist%world_vertex(:, antagonist%face_vertex(antagonist%face_first(f))) + shift
        room%height(f) = n(1)*v(1) + n(2)*v(2) + n(3)*v(3)
      end associate
    end do
    top = huge(top)
    if (.not. maxval(room%facing(:antagonist%n_faces)) > across) then
      top = -huge(top)
      do i = 1, antagonist%n_vertices
        top = max(top, dot_product(direction, antagonist%world_vertex(:, i) + shift))
      end do
    end if
    call measure_below(candidate, antagonist%n_faces, antagonist%world_normal, direction, top, room, volume)
  end subroutine cut_by_faces

  !> Volume shared by a convex polyhedron and a plane (PLANx), which is a box [m3].
  pure real(wp) function overlap_polyhedron_plane(candidate, centre_a, frame, half) result(volume)
    type(polyhedron_t), intent(in) :: candidate !! placed polyhedron
    real(wp), intent(in) :: centre_a(3) !! centre of the box, the antagonist [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: axes of the box in the world
    real(wp), intent(in) :: half(3) !! half lengths along these axes [m]
    type(overlap_room_t) :: room

    call measure_polyhedron_plane(candidate, centre_a, frame, half, frame(:, 1), room, volume)
  end function overlap_polyhedron_plane

  !> The same with room for the work, and a direction.
  pure subroutine measure_polyhedron_plane(candidate, centre_a, frame, half, direction, room, volume)
    type(polyhedron_t), intent(in) :: candidate !! placed polyhedron
    real(wp), intent(in) :: centre_a(3) !! centre of the box, the antagonist [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: axes of the box in the world
    real(wp), intent(in) :: half(3) !! half lengths along these axes [m]
    real(wp), intent(in) :: direction(3) !! unit vector, as in `measure_polyhedra`
    type(overlap_room_t), intent(inout) :: room !! room for the work
    real(wp), intent(out) :: volume !! volume shared [m3]
    real(wp) :: normal(3, 6), top, largest
    integer :: i

    call make_room(room, 6)
    top = dot_product(direction, centre_a - candidate%centre)
    do i = 1, 3
      normal(:, 2*i - 1) = frame(:, i)
      normal(:, 2*i) = -frame(:, i)
      room%height(2*i - 1:2*i) = half(i) + [1.0_wp, -1.0_wp]*dot_product(frame(:, i), centre_a - candidate%centre)
      top = top + half(i)*abs(dot_product(direction, frame(:, i)))
    end do
    call find_facing(6, normal, direction, room%facing, largest)
    call measure_below(candidate, 6, normal, direction, top, room, volume)
  end subroutine measure_polyhedron_plane

  !> Volume shared by a sphere and a convex polyhedron [m3].
  pure real(wp) function overlap_sphere_polyhedron(centre_c, radius_c, antagonist, offset) result(volume)
    real(wp), intent(in) :: centre_c(3) !! centre of the sphere, the candidate [m]
    real(wp), intent(in) :: radius_c !! its radius [m]
    type(polyhedron_t), intent(in) :: antagonist !! placed polyhedron
    real(wp), intent(in) :: offset(3) !! added to the polyhedron's vertices (its periodic image) [m]
    real(wp) :: vertex(3, antagonist%n_vertices)
    integer :: i

    volume = 0
    if (sum((antagonist%centre + offset - centre_c)**2) >= (radius_c + antagonist%reach)**2) return
    do i = 1, antagonist%n_vertices
      vertex(:, i) = antagonist%world_vertex(:, i) + (offset - centre_c)
    end do
    volume = ball_in_faces(radius_c, antagonist%n_faces, antagonist%world_normal, antagonist%face_first, antagonist%face_vertex, &
                           vertex)
  end function overlap_sphere_polyhedron

  !> Make room for so many planes.
  pure subroutine make_room(room, n_planes)
    type(overlap_room_t), intent(inout) :: room
    integer, intent(in) :: n_planes

    if (allocated(room%height)) then
      if (size(room%height) >= n_planes) return
      deallocate (room%height, room%facing, room%other, room%plane)
    end if
    allocate (room%height(2*n_planes), room%facing(2*n_planes), room%other(2*n_planes), room%plane(4*n_planes))
  end subroutine make_room

  !> Volume of the part of a polyhedron below planes [m3], which bound a convex shape.
  !!
  !! A first cut, at the highest point of that shape along the direction, leaves a slice that most planes do not cut. Planes that
  !! face the direction come before the others, which then find still less.
  pure subroutine measure_below(shape, n_planes, normal, direction, top, room, volume)
    type(polyhedron_t), intent(in) :: shape !! placed polyhedron
    integer, intent(in) :: n_planes !! number of planes; their heights above the polyhedron's centre are in the room [m]
    real(wp), intent(in) :: normal(:, :) !! their unit normals, to the side cut off, shape (3, n_planes)
    real(wp), intent(in) :: direction(3) !! unit vector
    real(wp), intent(in) :: top !! highest point of the convex shape along it, above the polyhedron's centre [m]
    type(overlap_room_t), intent(inout) :: room
    real(wp), intent(out) :: volume
    real(wp) :: middle(3), reach
    integer :: f, first, n

    first = 1
    do f = 2, n_planes
      if (room%facing(f) > room%facing(first)) first = f
    end do
    volume = 0
    ! A plane nearly across the direction leaves such a slice itself.
    if (.not. room%facing(first) > across) first = 0
    associate (solid => room%solid, centre => shape%centre)
      if (first > 0) then
        call cut_first(shape%n_vertices, shape%n_faces, shape%world_vertex, centre, shape%face_first, shape%face_vertex, &
                       normal(:, first), room%height(first), room%cuts, solid)
      else
        call cut_first(shape%n_vertices, shape%n_faces, shape%world_vertex, centre, shape%face_first, shape%face_vertex, &
                       direction, top, room%cuts, solid)
      end if
      if (solid%n_faces == 0) return
      call find_ball(solid, middle, reach)
      call list_planes(n_planes, normal, room%height, room%facing, middle, reach, first, room%plane, n)
      do f = 1, n
        call cut(solid, normal(:, room%plane(f)), room%height(room%plane(f)), room%cuts)
        if (solid%n_faces == 0) return
      end do
      volume = solid_volume(solid)
    end associate
  end subroutine measure_below

  !> List the planes that may cut a ball, without the one that has: those that face the direction before the others.
  pure subroutine list_planes(n_planes, normal, height, facing, middle, reach, first, plane, n)
    integer, intent(in) :: n_planes
    real(wp), intent(in) :: normal(3, n_planes), height(n_planes), facing(n_planes), middle(3), reach
    integer, intent(in) :: first !! plane that has cut, 0 for none
    integer, intent(inout) :: plane(2*n_planes)
    integer, intent(out) :: n
    integer :: f, n_behind

    n = 0
    n_behind = 0
    do f = 1, n_planes
      if (normal(1, f)*middle(1) + normal(2, f)*middle(2) + normal(3, f)*middle(3) + reach <= height(f) .or. f == first) cycle
      if (facing(f) > 0) then
        n = n + 1
        plane(n) = f
      else
        n_behind = n_behind + 1
        plane(n_planes + n_behind) = f
      end if
    end do
    do f = 1, n_behind
      plane(n + f) = plane(n_planes + f)
    end do
    n = n + n_behind
  end subroutine list_planes

  !> A ball about the vertices of a solid, a little larger than need be for rounding.
  pure subroutine find_ball(solid, middle, reach)
    type(solid_t), intent(in) :: solid
    real(wp), intent(out) :: middle(3), reach
    real(wp), parameter :: slack = 1 + 1e-9_wp
    real(wp) :: low(3), high(3)
    integer :: i

    low = solid%vertex(:, 1)
    high = low
    do i = 2, solid%n_vertices
      low = min(low, solid%vertex(:, i))
      high = max(high, solid%vertex(:, i))
    end do
    middle = (low + high)/2
    reach = 0
    do i = 1, solid%n_vertices
      reach = max(reach, (solid%vertex(1, i) - middle(1))**2 + (solid%vertex(2, i) - middle(2))**2 &
                  + (solid%vertex(3, i) - middle(3))**2)
    end do
    reach = slack*sqrt(reach)
  end subroutine find_ball
end module sg_overlap_polyhedra
