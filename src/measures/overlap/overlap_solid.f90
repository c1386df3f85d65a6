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
  public :: solid_t, box_solid, cut, solid_volume

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
  pure subroutine cut(solid, normal, height)
    type(solid_t), intent(inout) :: solid !! solid; without faces when nothing is left
    real(wp), intent(in) :: normal(3) !! unit normal to the side that is cut off
    real(wp), intent(in) :: height !! of the plane along the normal
    real(wp) :: above(solid%n_vertices)
    integer :: i

    do i = 1, solid%n_vertices
      above(i) = normal(1)*solid%vertex(1, i) + normal(2)*solid%vertex(2, i) + normal(3)*solid%vertex(3, i) - height
    end do
    if (all(above <= 0)) return
    if (all(above >= 0)) then
      solid%n_vertices = 0
      solid%n_faces = 0
    else
      call cut_through(solid, above, normal)
    end if
  end subroutine cut

  !> Cut a solid that has vertices on both sides of the plane.
  pure subroutine cut_through(solid, above, normal)
    type(solid_t), intent(inout) :: solid
    real(wp), intent(in) :: above(:) !! height of each vertex above the plane
    real(wp), intent(in) :: normal(3) !! unit normal of the plane
    type(solid_t) :: left
    integer, allocatable :: edge(:, :), after(:), kept(:)
    integer :: f, first, n_corners, n_crossed, i

    n_corners = solid%face_first(solid%n_faces + 1) - 1
    n_crossed = count_crossed(solid, above)
    allocate (edge(2, n_crossed), after(n_crossed), kept(solid%n_vertices))
    allocate (left%vertex(3, solid%n_vertices + n_crossed), left%face_first(solid%n_faces + n_crossed + 1), &
              left%face_vertex(n_corners + 3*n_crossed), left%normal(3, solid%n_faces + n_crossed))
    kept = 0
    do i = 1, solid%n_vertices
      if (above(i) > 0) cycle
      left%n_vertices = left%n_vertices + 1
      kept(i) = left%n_vertices
      left%vertex(:, kept(i)) = solid%vertex(:, i)
    end do
    n_crossed = 0
    after = 0
    left%face_first(1) = 1
    do f = 1, solid%n_faces
      first = solid%face_first(f)
      call cut_face(solid%vertex, above, kept, solid%face_vertex(first:solid%face_first(f + 1) - 1), solid%normal(:, f), edge, &
                    after, n_crossed, left)
    end do
    call close_hole(after, left%n_vertices - n_crossed, normal, left)
    call move_alloc(left%normal, solid%normal)
    call move_alloc(left%vertex, solid%vertex)
    call move_alloc(left%face_first, solid%face_first)
    call move_alloc(left%face_vertex, solid%face_vertex)
    solid%n_vertices = left%n_vertices
    solid%n_faces = left%n_faces
  end subroutine cut_through

  !> Number of edges that cross the plane; each edge is in two faces.
  pure integer function count_crossed(solid, above) result(n)
    type(solid_t), intent(in) :: solid
    real(wp), intent(in) :: above(:)
    integer :: f, i, last

    n = 0
    do f = 1, solid%n_faces
      last = solid%face_vertex(solid%face_first(f + 1) - 1)
      do i = solid%face_first(f), solid%face_first(f + 1) - 1
        if ((above(last) > 0) .neqv. (above(solid%face_vertex(i)) > 0)) n = n + 1
        last = solid%face_vertex(i)
      end do
    end do
    n = (n + 1)/2
  end function count_crossed

  !> Cut one face; where its loop leaves and comes back, the hole's loop runs from the way back to the way out.
  pure subroutine cut_face(vertex, above, kept, loop, normal, edge, after, n_crossed, left)
    real(wp), intent(in) :: vertex(:, :) !! vertices before the cut [m]
    real(wp), intent(in) :: above(:) !! their heights above the plane
    integer, intent(in) :: kept(:) !! their numbers after the cut
    integer, intent(in) :: loop(:) !! vertices of the face
    real(wp), intent(in) :: normal(3) !! its unit normal
    integer, intent(inout) :: edge(:, :) !! edges crossed so far, lower vertex first
    integer, intent(inout) :: after(:) !! the crossing that follows each on the loop of the hole
    integer, intent(inout) :: n_crossed !! how many
    type(solid_t), intent(inout) :: left !! gets the new vertices and the cut face
    integer :: i, from, to, crossing, n, way_out, first_back

    n = left%face_first(left%n_faces + 1) - 1
    way_out = 0
    first_back = 0
    do i = 1, size(loop)
      from = loop(i)
      to = loop(merge(1, i + 1, i == size(loop)))
      if (kept(from) > 0) then
        n = n + 1
        left%face_vertex(n) = kept(from)
      end if
      if ((kept(from) > 0) .eqv. (kept(to) > 0)) cycle
      call find_crossing(vertex, above, from, to, edge, n_crossed, crossing, left)
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
    if (n < left%face_first(left%n_faces + 1)) return
    left%n_faces = left%n_faces + 1
    left%face_first(left%n_faces + 1) = n + 1
    left%normal(:, left%n_faces) = normal
  end subroutine cut_face

  !> The crossing of an edge with the plane: the one made for the other face of the edge, or a new one.
  pure subroutine find_crossing(vertex, above, from, to, edge, n_crossed, crossing, left)
    real(wp), intent(in) :: vertex(:, :), above(:)
    integer, intent(in) :: from, to
    integer, intent(inout) :: edge(:, :), n_crossed
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
    left%n_vertices = left%n_vertices + 1
    left%vertex(:, left%n_vertices) = vertex(:, low) + above(low)/(above(low) - above(high))*(vertex(:, high) - vertex(:, low))
  end subroutine find_crossing

  !> Close the hole of a cut by faces along the loops of its crossings (one loop, unless rounding makes more).
  pure subroutine close_hole(after, n_before, normal, left)
    integer, intent(in) :: after(:) !! the crossing that follows each
    integer, intent(in) :: n_before !! vertices that are no crossings
    real(wp), intent(in) :: normal(3) !! unit normal of the plane
    type(solid_t), intent(inout) :: left !! the cut solid
    logical :: is_done(size(after))
    integer :: i, crossing, n

    is_done = .false.
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
