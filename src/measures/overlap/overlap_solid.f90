!> Convex solids cut by planes, and their volume.
!!
!! A solid is a closed surface: faces are loops of vertices, and faces that meet share their vertices. A cut decides for
!! each *vertex* whether it stays, makes one new vertex on each edge that it crosses, and closes the hole with the loop
!! of these. So the surface stays closed whatever rounding decides, also where a plane lies on a face, and the volume is
!! off by no more than the rounding of coordinates.
module sg_overlap_solid
  use sg_cut_surface, only: find_heights, leave_below
  use sg_kinds, only: wp
  implicit none
  private
  public :: solid_t, solid_room_t, box_solid, cut, cut_first, solid_volume

  !> The centre of solids that are cut again
  real(wp), parameter :: at_origin(3) = 0

  !> A closed surface
  type :: solid_t
    !> Numbers of vertices and faces
    integer :: n_vertices = 0, n_faces = 0
    !> Vertices [m], shape (3, :), at least n_vertices long
    real(wp), allocatable :: vertex(:, :)
    !> Vertices of face f, counter-clockwise seen from outside: `face_vertex(face_first(f):face_first(f + 1) - 1)`
    integer, allocatable :: face_first(:), face_vertex(:)
    !> Outward unit normals of the faces, shape (3, :), at least n_faces long, where they are wanted
    real(wp), allocatable :: normal(:, :)
    logical :: has_normals = .true.
  end type solid_t

  !> Room for cuts of solids, one after the other
  type :: solid_room_t
    private
    !> Vertices and corners of faces of a solid that find room
    integer :: vertices = 0, corners = 0
    !> What is left by a cut, which then changes places with the solid
    type(solid_t) :: left
    !> Height of each vertex above the plane, and its number after the cut, 0 above
    real(wp), allocatable :: above(:)
    integer, allocatable :: kept(:)
    !> Edges crossed, shape (2, :), the crossing that follows each on the loop of the hole, and crossings done
    integer, allocatable :: edge(:, :), after(:)
    logical, allocatable :: is_done(:)
    !> Places where the loop of a face comes down through the plane, see `cut_face`
    integer, allocatable :: back(:, :)
    !> Face before the cut that each face is part of; 0 for that of the plane
    integer, allocatable :: origin(:)
  end type solid_room_t

  !> Cut a solid, with room of its own or with room that many cuts share
  interface cut
    module procedure cut_alone, cut_in_room
  end interface cut

contains

  !> A box about the origin, its edges along the axes.
  pure subroutine box_solid(half, solid)
    real(wp), intent(in) :: half(3) !! half lengths [m]
    type(solid_t), intent(out) :: solid !! the box
    integer :: i

    solid%n_vertices = 8
    solid%n_faces = 6
    allocate (solid%vertex(3, 8), solid%face_first(7), solid%face_vertex(24), solid%normal(3, 6))
    do i = 0, 7
      solid%vertex(:, i + 1) = half*real(2*[ibits(i, 0, 1), ibits(i, 1, 1), ibits(i, 2, 1)] - 1, wp)
    end do
    solid%face_first = [1, 5, 9, 13, 17, 21, 25]
    solid%face_vertex = [1, 5, 7, 3, 2, 4, 8, 6, 1, 2, 6, 5, 3, 7, 8, 4, 1, 3, 4, 2, 5, 6, 8, 7]
    solid%normal = 0
    do i = 1, 3
      solid%normal(i, 2*i - 1:2*i) = [-1.0_wp, 1.0_wp]
    end do
  end subroutine box_solid

  !> Volume of a solid [m3], about its first vertex, so that thin slivers keep their digits.
  pure real(wp) function solid_volume(solid) result(volume)
    type(solid_t), intent(in) :: solid !! any closed surface

    volume = 0
    if (solid%n_faces > 0) volume = volume_of(solid%n_faces, solid%vertex, solid%face_first, solid%face_vertex)
  end function solid_volume

  !> The same of arrays.
  pure real(wp) function volume_of(n_faces, vertex, face_first, face_vertex) result(volume)
    integer, intent(in) :: n_faces, face_first(*), face_vertex(*)
    real(wp), intent(in) :: vertex(3, *)
    real(wp) :: a(3), b(3), c(3)
    integer :: f, i

    volume = 0
    do f = 1, n_faces
      a = vertex(:, face_vertex(face_first(f))) - vertex(:, 1)
      b = vertex(:, face_vertex(face_first(f) + 1)) - vertex(:, 1)
      do i = face_first(f) + 2, face_first(f + 1) - 1
        c = vertex(:, face_vertex(i)) - vertex(:, 1)
        volume = volume + (a(1)*(b(2)*c(3) - b(3)*c(2)) + a(2)*(b(3)*c(1) - b(1)*c(3)) + a(3)*(b(1)*c(2) - b(2)*c(1)))/6
        b = c
      end do
    end do
    volume = max(0.0_wp, volume)
  end function volume_of

  !> Keep of a solid what lies below a plane: normal.x <= height.
  pure subroutine cut_alone(solid, normal, height)
    type(solid_t), intent(inout) :: solid !! solid; without faces when nothing is left
    real(wp), intent(in) :: normal(3) !! unit normal to the side that is cut off
    real(wp), intent(in) :: height !! of the plane along the normal
    type(solid_room_t) :: room

    call cut_in_room(solid, normal, height, room)
  end subroutine cut_alone

  !> The same with room for the work, which many cuts share.
  pure subroutine cut_in_room(solid, normal, height, room)
    type(solid_t), intent(inout) :: solid !! solid; without faces when nothing is left
    real(wp), intent(in) :: normal(3) !! unit normal to the side that is cut off
    real(wp), intent(in) :: height !! of the plane along the normal
    type(solid_room_t), intent(inout) :: room !! room for the work
    integer :: n_above, n_below

    if (solid%n_faces == 0) return
    call make_room(solid%n_vertices, solid%face_first(solid%n_faces + 1) - 1, room)
    call find_heights(solid%n_vertices, solid%vertex, at_origin, normal, height, room%above, n_above, n_below)
    if (n_below == solid%n_vertices) return
    if (n_above == solid%n_vertices) then
      solid%n_vertices = 0
      solid%n_faces = 0
    else
      call cut_through(solid, normal, room)
    end if
  end subroutine cut_in_room

  !> Make of a convex shape about its centre what lies below a plane: no more of it is copied than that. It has no normals.
  pure subroutine cut_first(n_vertices, n_faces, vertex, centre, face_first, face_vertex, normal, height, room, solid)
    integer, intent(in) :: n_vertices, n_faces !! of the shape
    real(wp), intent(in), contiguous :: vertex(:, :) !! its vertices [m]
    real(wp), intent(in) :: centre(3) !! its centre [m]
    integer, intent(in), contiguous :: face_first(:), face_vertex(:) !! its faces, as those of a solid
    real(wp), intent(in) :: normal(3) !! unit normal to the side that is cut off
    real(wp), intent(in) :: height !! of the plane along the normal, above the centre
    type(solid_room_t), intent(inout) :: room !! room for the work
    type(solid_t), intent(inout) :: solid !! what is left; without faces when that is nothing
    integer :: n_above, n_below, corners

    solid%has_normals = .false.
    corners = face_first(n_faces + 1) - 1
    call make_room(n_vertices, corners, room)
    call find_heights(n_vertices, vertex, centre, normal, height, room%above, n_above, n_below)
    call reserve_solid(solid, n_vertices + corners, n_faces + corners, 4*corners)
    if (n_above == n_vertices .and. n_below < n_vertices) return
    call leave_below(n_vertices, n_faces, vertex, centre, face_first, face_vertex, room%above, room%kept, room%edge, room%back, &
                     room%after, room%is_done, solid%n_vertices, solid%n_faces, solid%vertex, solid%face_first, &
                     solid%face_vertex, room%origin)
  end subroutine cut_first

  !> Make room for a cut of a solid: no more edges are crossed than there are corners.
  pure subroutine make_room(n_vertices, corners, room)
    integer, intent(in) :: n_vertices, corners !! of the solid
    type(solid_room_t), intent(inout) :: room

    if (room%corners >= corners .and. room%vertices >= n_vertices) return
    if (allocated(room%above)) deallocate (room%above, room%kept, room%edge, room%after, room%is_done, room%back, room%origin)
    room%corners = 2*corners
    room%vertices = 2*n_vertices
    allocate (room%above(room%vertices), room%kept(room%vertices), room%back(4, room%corners))
    allocate (room%edge(2, room%corners), room%after(room%corners), room%is_done(room%corners), room%origin(2*room%corners))
  end subroutine make_room

  !> Make room in a solid, whose values are lost, for at least so many vertices, faces and corners.
  pure subroutine reserve_solid(solid, vertices, faces, corners)
    type(solid_t), intent(inout) :: solid !! solid without vertices and faces
    integer, intent(in) :: vertices !! vertices
    integer, intent(in) :: faces !! faces
    integer, intent(in) :: corners !! corners of all faces

    solid%n_vertices = 0
    solid%n_faces = 0
    if (allocated(solid%vertex)) then
      if (size(solid%vertex, 2) >= vertices .and. size(solid%normal, 2) >= faces .and. size(solid%face_vertex) >= corners) return
      deallocate (solid%vertex, solid%face_first, solid%face_vertex, solid%normal)
    end if
    allocate (solid%vertex(3, 2*vertices), solid%face_first(2*faces + 1), solid%face_vertex(2*corners), solid%normal(3, 2*faces))
  end subroutine reserve_solid

  !> Cut a solid that has vertices on both sides of the plane; their heights are in the room for the work.
  pure subroutine cut_through(solid, normal, room)
    type(solid_t), intent(inout) :: solid
    real(wp), intent(in) :: normal(3) !! unit normal of the plane
    type(solid_room_t), intent(inout) :: room
    integer :: n_corners, f

    n_corners = solid%face_first(solid%n_faces + 1) - 1
    call reserve_solid(room%left, solid%n_vertices + n_corners, solid%n_faces + n_corners, 4*n_corners)
    associate (left => room%left)
      left%has_normals = solid%has_normals
      call leave_below(solid%n_vertices, solid%n_faces, solid%vertex, at_origin, solid%face_first, solid%face_vertex, room%above, &
                       room%kept, room%edge, room%back, room%after, room%is_done, left%n_vertices, left%n_faces, left%vertex, &
                       left%face_first, left%face_vertex, room%origin)
      if (left%has_normals) then
        do f = 1, left%n_faces
          if (room%origin(f) == 0) left%normal(:, f) = normal
          if (room%origin(f) > 0) left%normal(:, f) = solid%normal(:, room%origin(f))
        end do
      end if
    end associate
    call exchange(solid, room%left)
  end subroutine cut_through

  !> Let two solids change places.
  pure subroutine exchange(a, b)
    type(solid_t), intent(inout) :: a, b
    real(wp), allocatable :: reals(:, :)
    integer, allocatable :: integers(:)
    integer :: n

    n = a%n_vertices
    a%n_vertices = b%n_vertices
    b%n_vertices = n
    n = a%n_faces
    a%n_faces = b%n_faces
    b%n_faces = n
    call move_alloc(a%vertex, reals)
    call move_alloc(b%vertex, a%vertex)
    call move_alloc(reals, b%vertex)
    if (a%has_normals) then
      call move_alloc(a%normal, reals)
      call move_alloc(b%normal, a%normal)
      call move_alloc(reals, b%normal)
    end if
    call move_alloc(a%face_first, integers)
    call move_alloc(b%face_first, a%face_first)
    call move_alloc(integers, b%face_first)
    call move_alloc(a%face_vertex, integers)
    call move_alloc(b%face_vertex, a%face_vertex)
    call move_alloc(integers, b%face_vertex)
  end subroutine exchange
end module sg_overlap_solid
