!> Volumes that convex polyhedra share with each other, with planes (boxes) and with spheres, all exact.
!!
!! Polyhedra are taken as placed in the world (`place_polyhedron`).
module sg_overlap_polyhedra
  use sg_kinds, only: wp
  use sg_overlap_ball, only: ball_in_faces
  use sg_overlap_solid, only: cut, reserve_solid, solid_room_t, solid_t, solid_volume
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
    !> Of each plane its height above the candidate's centre [m], and the cosine between its normal and the direction
    real(wp), allocatable :: height(:), facing(:)
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

    volume = 0
    shift = antagonist%centre + offset - candidate%centre
    if (sum(shift**2) >= (candidate%reach + antagonist%reach)**2) return
    if (squareness(candidate, -direction) > squareness(antagonist, direction)) then
      call cut_by_faces(antagonist, candidate, -offset, -direction, room, volume)
    else
      call cut_by_faces(candidate, antagonist, offset, direction, room, volume)
    end if
  end subroutine measure_polyhedra

  !> Largest cosine between the normals of a polyhedron and a direction.
  pure real(wp) function squareness(shape, direction) result(cosine)
    type(polyhedron_t), intent(in) :: shape
    real(wp), intent(in) :: direction(3)
    integer :: f

    cosine = -1
    do f = 1, shape%n_faces
      associate (n => shape%world_normal(:, f))
        cosine = max(cosine, n(1)*direction(1) + n(2)*direction(2) + n(3)*direction(3))
      end associate
    end do
  end function squareness

  !> Volume of a polyhedron within another [m3]: arguments as in `measure_polyhedra`.
  pure subroutine cut_by_faces(candidate, antagonist, offset, direction, room, volume)
    type(polyhedron_t), intent(in) :: candidate, antagonist
    real(wp), intent(in) :: offset(3), direction(3)
    type(overlap_room_t), intent(inout) :: room
    real(wp), intent(out) :: volume
    real(wp) :: shift(3), top
    integer :: f, i

    shift = offset - candidate%centre
    call make_room(room, antagonist%n_faces)
    do f = 1, antagonist%n_faces
      room%height(f) = dot_product(antagonist%world_normal(:, f), &
                                   antagonist%world_vertex(:, antagonist%face_vertex(antagonist%face_first(f))) + shift)
    end do
    top = -huge(top)
    do i = 1, antagonist%n_vertices
      top = max(top, dot_product(direction, antagonist%world_vertex(:, i) + shift))
    end do
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
    real(wp) :: normal(3, 6), top
    integer :: i

    call make_room(room, 6)
    top = dot_product(direction, centre_a - candidate%centre)
    do i = 1, 3
      normal(:, 2*i - 1) = frame(:, i)
      normal(:, 2*i) = -frame(:, i)
      room%height(2*i - 1:2*i) = half(i) + [1.0_wp, -1.0_wp]*dot_product(frame(:, i), centre_a - candidate%centre)
      top = top + half(i)*abs(dot_product(direction, frame(:, i)))
    end do
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
      deallocate (room%height, room%facing)
    end if
    allocate (room%height(2*n_planes), room%facing(2*n_planes))
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
    integer :: f, first, turn

    first = 1
    do f = 1, n_planes
      room%facing(f) = normal(1, f)*direction(1) + normal(2, f)*direction(2) + normal(3, f)*direction(3)
      if (room%facing(f) > room%facing(first)) first = f
    end do
    associate (solid => room%solid)
      call centred_solid(shape, solid)
      ! A plane nearly across the direction leaves such a slice itself.
      if (room%facing(first) > across) then
        call cut(solid, normal(:, first), room%height(first), room%cuts)
      else
        call cut(solid, direction, top, room%cuts)
        first = 0
      end if
      do turn = 1, 2
        do f = 1, n_planes
          if (f == first .or. ((room%facing(f) > 0) .neqv. turn == 1)) cycle
          if (solid%n_faces > 0) call cut(solid, normal(:, f), room%height(f), room%cuts)
        end do
      end do
      volume = 0
      if (solid%n_faces > 0) volume = solid_volume(solid)
    end associate
  end subroutine measure_below

  !> A placed polyhedron as a solid about its centre.
  pure subroutine centred_solid(shape, solid)
    type(polyhedron_t), intent(in) :: shape
    type(solid_t), intent(inout) :: solid
    integer :: i, corners

    corners = shape%face_first(shape%n_faces + 1) - 1
    call reserve_solid(solid, shape%n_vertices, shape%n_faces, corners)
    solid%n_vertices = shape%n_vertices
    solid%n_faces = shape%n_faces
    do i = 1, shape%n_vertices
      solid%vertex(:, i) = shape%world_vertex(:, i) - shape%centre
    end do
    do i = 1, shape%n_faces
      solid%normal(:, i) = shape%world_normal(:, i)
      solid%face_first(i) = shape%face_first(i)
    end do
    solid%face_first(shape%n_faces + 1) = corners + 1
    do i = 1, corners
      solid%face_vertex(i) = shape%face_vertex(i)
    end do
  end subroutine centred_solid
end module sg_overlap_polyhedra
