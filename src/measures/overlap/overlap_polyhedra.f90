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
    !> How far what is left stands out of each plane [m]
    real(wp), allocatable :: excess(:)
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
    real(wp) :: shift(3)
    integer :: own, square

    volume = 0
    shift = antagonist%centre + offset - candidate%centre
    if (sum(shift**2) >= (candidate%reach + antagonist%reach)**2) return
    call make_room(room, max(candidate%n_faces, antagonist%n_faces))
    call find_facing(candidate%n_faces, candidate%world_normal, -direction, room%other, own)
    call find_facing(antagonist%n_faces, antagonist%world_normal, direction, room%facing, square)
    if (room%other(own) > room%facing(square)) then
      room%facing(:candidate%n_faces) = room%other(:candidate%n_faces)
      call cut_by_faces(antagonist, candidate, -offset, -direction, own, room, volume)
    else
      call cut_by_faces(candidate, antagonist, offset, direction, square, room, volume)
    end if
  end subroutine measure_polyhedra

  !> Cosines between normals and a direction, and the normal that has the largest.
  pure subroutine find_facing(n, normal, direction, facing, first)
    integer, intent(in) :: n !! normals
    real(wp), intent(in), contiguous :: normal(:, :)
    real(wp), intent(in) :: direction(3)
    real(wp), intent(inout), contiguous :: facing(:)
    integer, intent(out) :: first
    real(wp) :: largest
    integer :: f

    largest = -2
    do f = 1, n
      facing(f) = normal(1, f)*direction(1) + normal(2, f)*direction(2) + normal(3, f)*direction(3)
      largest = max(largest, facing(f))
    end do
    do first = 1, n - 1
      if (facing(first) >= largest) exit
    end do
  end subroutine find_facing

  !> Volume of a polyhedron within another [m3]: arguments as in `measure_polyhedra`; cosines of the antagonist's faces are known,
  !! and the face that has the largest.
  pure subroutine cut_by_faces(candidate, antagonist, offset, direction, first, room, volume)
    type(polyhedron_t), intent(in) :: candidate, antagonist
    real(wp), intent(in) :: offset(3), direction(3)
    integer, intent(in) :: first
    type(overlap_room_t), intent(inout) :: room
    real(wp), intent(out) :: volume
    real(wp) :: shift(3), top
    integer :: f, i

    shift = antagonist%centre + offset - candidate%centre
    associate (n => antagonist%world_normal)
      do f = 1, antagonist%n_faces
        room%height(f) = antagonist%face_height(f) + n(1, f)*shift(1) + n(2, f)*shift(2) + n(3, f)*shift(3)
      end do
    end associate
    top = huge(top)
    if (.not. room%facing(first) > across) then
      top = -huge(top)
      shift = offset - candidate%centre
      do i = 1, antagonist%n_vertices
        top = max(top, dot_product(direction, antagonist%world_vertex(:, i) + shift))
      end do
    end if
    call measure_below(candidate, antagonist%n_faces, antagonist%world_normal, first, direction, top, room, volume)
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
    real(wp) :: normal(3, 6), top
    integer :: i, first

    call make_room(room, 6)
    top = dot_product(direction, centre_a - candidate%centre)
    do i = 1, 3
      normal(:, 2*i - 1) = frame(:, i)
      normal(:, 2*i) = -frame(:, i)
      room%height(2*i - 1:2*i) = half(i) + [1.0_wp, -1.0_wp]*dot_product(frame(:, i), centre_a - candidate%centre)
      top = top + half(i)*abs(dot_product(direction, frame(:, i)))
    end do
    call find_facing(6, normal, direction, room%facing, first)
    call measure_below(candidate, 6, normal, first, direction, top, room, volume)
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
      deallocate (room%height, room%facing, room%other, room%excess, room%plane)
    end if
    allocate (room%height(2*n_planes), room%facing(2*n_planes), room%other(2*n_planes), room%excess(2*n_planes))
    allocate (room%plane(2*n_planes + 1))
  end subroutine make_room

  !> Volume of the part of a polyhedron below planes [m3], which bound a convex shape.
  !!
  !! A first cut, at the highest point of that shape along the direction, leaves a slice that most planes do not cut. Planes that
  !! face the direction come before the others, which then find still less.
  pure subroutine measure_below(shape, n_planes, normal, facing_most, direction, top, room, volume)
    type(polyhedron_t), intent(in) :: shape !! placed polyhedron
    integer, intent(in) :: n_planes !! number of planes; their heights above the polyhedron's centre are in the room [m]
    real(wp), intent(in) :: normal(:, :) !! their unit normals, to the side cut off, shape (3, n_planes)
    integer, intent(in) :: facing_most !! plane that has the largest cosine
    real(wp), intent(in) :: direction(3) !! unit vector
    real(wp), intent(in) :: top !! highest point of the convex shape along it, above the polyhedron's centre [m]
    type(overlap_room_t), intent(inout) :: room
    real(wp), intent(out) :: volume
    integer :: f, first, n

    volume = 0
    ! A plane nearly across the direction leaves such a slice itself.
    first = 0
    if (room%facing(facing_most) > across) first = facing_most
    associate (solid => room%solid, centre => shape%centre)
      if (first > 0) then
        call cut_first(shape%n_vertices, shape%n_faces, shape%world_vertex, centre, shape%face_first, shape%face_vertex, &
                       normal(:, first), room%height(first), room%cuts, solid)
      else
        call cut_first(shape%n_vertices, shape%n_faces, shape%world_vertex, centre, shape%face_first, shape%face_vertex, &
                       direction, top, room%cuts, solid)
      end if
      if (solid%n_faces == 0) return
      call list_planes(n_planes, normal, room%height, room%facing, first, solid%n_vertices, solid%vertex, room%excess, &
                       room%plane, n)
      do f = 1, n
        call cut(solid, normal(:, room%plane(f)), room%height(room%plane(f)), room%cuts)
        if (solid%n_faces == 0) return
      end do
      volume = solid_volume(solid)
    end associate
  end subroutine measure_below

  !> List the planes that cut a solid, without the one that has: those that face the direction before the others.
  pure subroutine list_planes(n_planes, normal, height, facing, first, n_vertices, vertex, excess, plane, n)
    integer, intent(in) :: n_planes, first, n_vertices
    real(wp), intent(in) :: normal(3, n_planes), height(n_planes), facing(n_planes), vertex(3, n_vertices)
    real(wp), intent(inout) :: excess(n_planes) !! gets how far the solid stands out of each plane
    integer, intent(inout) :: plane(n_planes + 1)
    integer, intent(out) :: n
    integer :: f, i

    excess = 0
    do i = 1, n_vertices
      do f = 1, n_planes
        excess(f) = max(excess(f), normal(1, f)*vertex(1, i) + normal(2, f)*vertex(2, i) + normal(3, f)*vertex(3, i) - height(f))
      end do
    end do
    if (first > 0) excess(first) = 0
    ! Without branches: which planes cut is as good as random.
    n = 0
    do f = 1, n_planes
      plane(n + 1) = f
      n = n + merge(1, 0, excess(f) > 0 .and. facing(f) > 0)
    end do
    do f = 1, n_planes
      plane(n + 1) = f
      n = n + merge(1, 0, excess(f) > 0 .and. .not. facing(f) > 0)
    end do
  end subroutine list_planes
end module sg_overlap_polyhedra
