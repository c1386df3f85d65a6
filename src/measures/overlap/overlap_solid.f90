!> Convex solids cut by planes, and their volume.
!!
!! A solid is a closed surface: faces are loops of vertices, and faces that meet share their vertices. A cut decides for
!! each *vertex* whether it stays, makes one new vertex on each edge that it crosses, and closes the hole with the loop
!! of these. So the surface stays closed whatever rounding decides, also where a plane lies on a face, and the volume is
!! off by no more than the rounding of coordinates.
module sg_overlap_solid
  use sg_kinds, only: wp
  implicit none
  private
  public :: solid_t, solid_room_t, box_solid, cut, reserve_solid, solid_volume

  !> A closed surface
  type :: solid_t
    !> Numbers of vertices and faces
    integer :: n_vertices = 0, n_faces = 0
    !> Vertices [m], shape (3, :), at least n_vertices long
    real(wp), allocatable :: vertex(:, :)
    !> Vertices of face f, counter-clockwise seen from outside: `face_vertex(face_first(f):face_first(f + 1) - 1)`
    integer, allocatable :: face_first(:), face_vertex(:)
    !> Outward unit normals of the faces, shape (3, :), at least n_faces long
    real(wp), allocatable :: normal(:, :)
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
    real(wp) :: a(3), b(3), c(3)
    integer :: f, i

    volume = 0
    do f = 1, solid%n_faces
      a = solid%vertex(:, solid%face_vertex(solid%face_first(f))) - solid%vertex(:, 1)
      do i = solid%face_first(f) + 1, solid%face_first(f + 1) - 2
        b = solid%vertex(:, solid%face_vertex(i)) - solid%vertex(:, 1)
        c = solid%vertex(:, solid%face_vertex(i + 1)) - solid%vertex(:, 1)
        volume = volume + (a(1)*(b(2)*c(3) - b(3)*c(2)) + a(2)*(b(3)*c(1) - b(1)*c(3)) + a(3)*(b(1)*c(2) - b(2)*c(1)))/6
      end do
    end do
    volume = max(0.0_wp, volume)
  end function solid_volume

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
    integer :: i, n_above, n_below

    call make_room(solid, room)
    n_above = 0
    n_below = 0
    do i = 1, solid%n_vertices
      room%above(i) = normal(1)*solid%vertex(1, i) + normal(2)*solid%vertex(2, i) + normal(3)*solid%vertex(3, i) - height
      if (room%above(i) <= 0) n_below = n_below + 1
      if (room%above(i) >= 0) n_above = n_above + 1
    end do
    if (n_below == solid%n_vertices) return
    if (n_above == solid%n_vertices) then
      solid%n_vertices = 0
      solid%n_faces = 0
    else
      call cut_through(solid, normal, room)
    end if
  end subroutine cut_in_room

  !> Make room for a cut of a solid: no more edges are crossed than there are corners.
  pure subroutine make_room(solid, room)
    type(solid_t), intent(in) :: solid
    type(solid_room_t), intent(inout) :: room
    integer :: corners

    corners = solid%face_first(solid%n_faces + 1) - 1
    if (room%corners >= corners .and. room%vertices >= solid%n_vertices) return
    if (allocated(room%above)) deallocate (room%above, room%kept, room%edge, room%after, room%is_done)
    room%corners = 2*corners
    room%vertices = 2*solid%n_vertices
    allocate (room%above(room%vertices), room%kept(room%vertices))
    allocate (room%edge(2, room%corners), room%after(room%corners), room%is_done(room%corners))
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
    integer :: f, n_corners, n_crossed, i

    n_corners = solid%face_first(solid%n_faces + 1) - 1
    call reserve_solid(room%left, solid%n_vertices + n_corners, solid%n_faces + n_corners, 4*n_corners)
    associate (left => room%left)
      do i = 1, solid%n_vertices
        room%kept(i) = 0
        if (room%above(i) > 0) cycle
        left%n_vertices = left%n_vertices + 1
        room%kept(i) = left%n_vertices
        left%vertex(:, left%n_vertices) = solid%vertex(:, i)
      end do
      n_crossed = 0
      left%face_first(1) = 1
      do f = 1, solid%n_faces
        call cut_face(solid, f, room%above, room%kept, room%edge, room%after, n_crossed, left)
      end do
      call close_hole(room%after(:n_crossed), left%n_vertices - n_crossed, normal, room%is_done, left)
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
    call move_alloc(a%normal, reals)
    call move_alloc(b%normal, a%normal)
    call move_alloc(reals, b%normal)
    call move_alloc(a%face_first, integers)
    call move_alloc(b%face_first, a%face_first)
    call move_alloc(integers, b%face_first)
    call move_alloc(a%face_vertex, integers)
    call move_alloc(b%face_vertex, a%face_vertex)
    call move_alloc(integers, b%face_vertex)
  end subroutine exchange

  !> Cut one face; where its loop leaves and comes back, the hole's loop runs from the way back to the way out.
  pure subroutine cut_face(solid, face, above, kept, edge, after, n_crossed, left)
    type(solid_t), intent(in) :: solid !! solid before the cut
    integer, intent(in) :: face !! its face
    real(wp), intent(in) :: above(:) !! heights of its vertices above the plane
    integer, intent(in) :: kept(:) !! their numbers after the cut
    integer, intent(inout) :: edge(:, :) !! edges crossed so far, lower vertex first
    integer, intent(inout) :: after(:) !! the crossing that follows each on the loop of the hole
    integer, intent(inout) :: n_crossed !! how many
    type(solid_t), intent(inout) :: left !! gets the new vertices and the cut face
    integer :: i, first, last, from, to, crossing, n, n_kept, way_out, first_back

    first = solid%face_first(face)
    last = solid%face_first(face + 1) - 1
    n_kept = 0
    do i = first, last
      if (kept(solid%face_vertex(i)) > 0) n_kept = n_kept + 1
    end do
    if (n_kept == 0) return
    n = left%face_first(left%n_faces + 1) - 1
    way_out = 0
    first_back = 0
    do i = first, last
      from = solid%face_vertex(i)
      if (kept(from) > 0) then
        n = n + 1
        left%face_vertex(n) = kept(from)
      end if
      if (n_kept == last - first + 1) cycle
      to = solid%face_vertex(merge(first, i + 1, i == last))
      if ((kept(from) > 0) .eqv. (kept(to) > 0)) cycle
      call find_crossing(solid%vertex, above, from, to, edge, after, n_crossed, crossing, left)
      n = n + 1
      left%face_vertex(n) = left%n_vertices - n_crossed + crossing
      if (kept(from) > 0) then
        way_out = crossing
      else if (way_out > 0) then
        after(crossing) = way_out
        way_out = 0
      else
        first_back = crossing
      end if
    end do
    if (first_back > 0) after(first_back) = way_out
    left%n_faces = left%n_faces + 1
    left%face_first(left%n_faces + 1) = n + 1
    left%normal(:, left%n_faces) = solid%normal(:, face)
  end subroutine cut_face

  !> The crossing of an edge with the plane: the one made for the other face of the edge, or a new one.
  pure subroutine find_crossing(vertex, above, from, to, edge, after, n_crossed, crossing, left)
    real(wp), intent(in) :: vertex(:, :), above(:)
    integer, intent(in) :: from, to
    integer, intent(inout) :: edge(:, :), after(:), n_crossed
    integer, intent(out) :: crossing
    type(solid_t), intent(inout) :: left
    integer :: low, high

    low = min(from, to)
    high = max(from, to)
    do crossing = 1, n_crossed
      if (edge(1, crossing) == low .and. edge(2, crossing) == high) return
    end do
    n_crossed = n_crossed + 1
    crossing = n_crossed
    edge(:, crossing) = [low, high]
    after(crossing) = 0
    left%n_vertices = left%n_vertices + 1
    left%vertex(:, left%n_vertices) = vertex(:, low) + above(low)/(above(low) - above(high))*(vertex(:, high) - vertex(:, low))
  end subroutine find_crossing

  !> Close the hole of a cut by faces along the loops of its crossings (one loop, unless rounding makes more).
  pure subroutine close_hole(after, n_before, normal, is_done, left)
    integer, intent(in) :: after(:) !! the crossing that follows each
    integer, intent(in) :: n_before !! vertices that are no crossings
    real(wp), intent(in) :: normal(3) !! unit normal of the plane
    logical, intent(inout) :: is_done(:) !! room for a mark per crossing
    type(solid_t), intent(inout) :: left !! the cut solid
    integer :: i, crossing, n

    is_done(:size(after)) = .false.
    do i = 1, size(after)
      if (is_done(i)) cycle
      n = left%face_first(left%n_faces + 1) - 1
      crossing = i
      do while (.not. is_done(crossing))
        is_done(crossing) = .true.
        n = n + 1
        left%face_vertex(n) = n_before + crossing
        crossing = after(crossing)
      end do
      ! Two faces that meet along both crossings need no third between them.
      if (n - left%face_first(left%n_faces + 1) < 2) cycle
      left%n_faces = left%n_faces + 1
      left%face_first(left%n_faces + 1) = n + 1
      left%normal(:, left%n_faces) = normal
    end do
  end subroutine close_hole
end module sg_overlap_solid
