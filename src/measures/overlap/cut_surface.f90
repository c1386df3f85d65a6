!> Closed surfaces in plain arrays cut by a plane, by the way that `sg_overlap_solid` states: arrays that may overlap no others, as
!! those of a derived type may, are read once.
module sg_cut_surface
  use sg_kinds, only: wp
  implicit none
  private
  public :: find_heights, leave_below

contains

  !> Heights of vertices above a plane, and how many lie on it or above, on it or below.
  pure subroutine find_heights(n, vertex, centre, normal, height, above, n_above, n_below)
    integer, intent(in) :: n !! vertices
    real(wp), intent(in) :: vertex(3, *), centre(3) !! vertices, and the centre that the plane is about [m]
    real(wp), intent(in) :: normal(3), height !! unit normal of the plane, and its height above the centre [m]
    real(wp), intent(inout) :: above(*) !! gets the height of each vertex above the plane [m]
    integer, intent(out) :: n_above, n_below !! vertices on it or above, on it or below
    integer :: i

    n_above = 0
    n_below = 0
    do i = 1, n
      above(i) = normal(1)*(vertex(1, i) - centre(1)) + normal(2)*(vertex(2, i) - centre(2)) &
                 + normal(3)*(vertex(3, i) - centre(3)) - height
      n_below = n_below + merge(1, 0, above(i) <= 0)
      n_above = n_above + merge(1, 0, above(i) >= 0)
    end do
  end subroutine find_heights

  !> Put into arrays what of a closed surface lies below a plane: kept vertices, then crossings of edges; kept and cut faces in
  !! their order, then that of the plane. Room for the work has as many places as there are vertices (`kept`) or corners.
  pure subroutine leave_below(n_vertices, n_faces, vertex, centre, face_first, face_vertex, above, kept, edge, back, after, &
                              is_done, n_left, n_left_faces, left_vertex, left_first, left_corner, origin)
    integer, intent(in) :: n_vertices, n_faces !! vertices and faces of the surface
    real(wp), intent(in) :: vertex(3, *), centre(3) !! vertices; what is left is about the centre [m]
    integer, intent(in) :: face_first(*), face_vertex(*) !! vertices of each face, as those of a solid
    real(wp), intent(in) :: above(*) !! heights of the vertices above the plane [m]
    integer, intent(inout) :: kept(*), edge(2, *), back(4, *), after(*) !! room, see `solid_room_t`
    logical, intent(inout) :: is_done(*) !! room
    integer, intent(out) :: n_left, n_left_faces !! vertices and faces left
    real(wp), intent(inout) :: left_vertex(3, *) !! vertices left [m]
    integer, intent(inout) :: left_first(*), left_corner(*) !! vertices of each face left
    integer, intent(inout) :: origin(*) !! face that each face left is part of, 0 for that of the plane
    integer :: f, i, n, n_kept, n_crossed, n_below, n_loop, first

    n_kept = 0
    do i = 1, n_vertices
      kept(i) = 0
      if (above(i) > 0) cycle
      n_kept = n_kept + 1
      kept(i) = n_kept
      left_vertex(1, n_kept) = vertex(1, i) - centre(1)
      left_vertex(2, n_kept) = vertex(2, i) - centre(2)
      left_vertex(3, n_kept) = vertex(3, i) - centre(3)
    end do
    n = 0
    n_crossed = 0
    n_left_faces = 0
    left_first(1) = 1
    do f = 1, n_faces
      first = face_first(f)
      n_loop = face_first(f + 1) - first
      n_below = 0
      do i = first, first + n_loop - 1
        n_below = n_below + min(kept(face_vertex(i)), 1)
      end do
      if (n_below == 0) cycle
      if (n_below == n_loop) then
        do i = 1, n_loop
          left_corner(n + i) = kept(face_vertex(first + i - 1))
        end do
        n = n + n_loop
      else
        call cut_face(n_loop, face_vertex(first), n_below, vertex, centre, above, kept, n_kept, edge, n_crossed, back, &
                      left_vertex, n, left_corner)
      end if
      n_left_faces = n_left_faces + 1
      left_first(n_left_faces + 1) = n + 1
      origin(n_left_faces) = f
    end do
    n_left = n_kept + n_crossed
    call join_crossings(n_crossed, edge, back, n_kept, after, left_corner)
    call close_hole(n_crossed, after, n_kept, is_done, n_left_faces, left_first, left_corner, origin)
  end subroutine leave_below

  !> Cut one face. Of each run of vertices that stay, one (of a convex face, unless rounding makes more), what is left comes down at
  !! a crossing of the face beyond, follows the run and goes up at a new one.
  pure subroutine cut_face(n_loop, loop, n_below, vertex, centre, above, kept, n_kept, edge, n_crossed, back, left_vertex, &
                           n, left_corner)
    integer, intent(in) :: n_loop, loop(*), n_below !! vertices of the face, and how many of them stay
    real(wp), intent(in) :: vertex(3, *), centre(3) !! vertices of the solid before the cut, and what crossings are about
    real(wp), intent(in) :: above(*) !! heights of the vertices above the plane
    integer, intent(in) :: kept(*), n_kept !! their numbers after the cut, 0 above it; those that stay
    integer, intent(inout) :: edge(2, *), n_crossed !! edges crossed so far, from below to above
    !> Ways down, as many as crossings: corner, edge from below to above, crossing that follows on the loop of the hole
    integer, intent(inout) :: back(4, *)
    real(wp), intent(inout) :: left_vertex(3, *) !! gets new crossings
    integer, intent(inout) :: n, left_corner(*) !! corners so far; gets those of the face
    real(wp) :: share
    integer :: i, from, to, last_crossed, last_corner

    last_crossed = n_crossed
    last_corner = n + n_below
    i = 0
    to = loop(n_loop)
    do while (n < last_corner)
      ! To where a run starts
      do
        from = to
        i = merge(i + 1, 1, i < n_loop)
        to = loop(i)
        if (kept(from) == 0 .and. kept(to) > 0) exit
      end do
      n_crossed = n_crossed + 1
      n = n + 1
      ! The hole's loop goes on where the run before this one went up.
      back(:, n_crossed) = [n, to, from, n_crossed - 1]
      do while (kept(to) > 0)
        n = n + 1
        left_corner(n) = kept(to)
        from = to
        i = merge(i + 1, 1, i < n_loop)
        to = loop(i)
      end do
      edge(1, n_crossed) = from
      edge(2, n_crossed) = to
      share = above(from)/(above(from) - above(to))
      left_vertex(1, n_kept + n_crossed) = vertex(1, from) - centre(1) + share*(vertex(1, to) - vertex(1, from))
      left_vertex(2, n_kept + n_crossed) = vertex(2, from) - centre(2) + share*(vertex(2, to) - vertex(2, from))
      left_vertex(3, n_kept + n_crossed) = vertex(3, from) - centre(3) + share*(vertex(3, to) - vertex(3, from))
      n = n + 1
      left_corner(n) = n_kept + n_crossed
      last_corner = last_corner + 2
    end do
    back(4, last_crossed + 1) = n_crossed
  end subroutine cut_face

  !> Give each way down the crossing of its edge, each crossing once; after it the hole's loop goes on with the way up.
  pure subroutine join_crossings(n_crossed, edge, back, n_kept, after, left_corner)
    integer, intent(in) :: n_crossed, back(4, *), n_kept
    integer, intent(inout) :: edge(2, *), after(*), left_corner(*)
    integer :: b, crossing

    do b = 1, n_crossed
      do crossing = 1, n_crossed
        if (edge(1, crossing) == back(2, b) .and. edge(2, crossing) == back(3, b)) exit
      end do
      edge(1, crossing) = 0
      after(crossing) = back(4, b)
      left_corner(back(1, b)) = n_kept + crossing
    end do
  end subroutine join_crossings

  !> Close the hole of a cut by faces along the loops of its crossings (one loop, unless rounding makes more).
  pure subroutine close_hole(n_crossed, after, n_kept, is_done, n_left_faces, left_first, left_corner, origin)
    integer, intent(in) :: n_crossed, after(*) !! the crossing that follows each
    integer, intent(in) :: n_kept !! vertices that are no crossings
    logical, intent(inout) :: is_done(*) !! room for a mark per crossing
    integer, intent(inout) :: n_left_faces, left_first(*), left_corner(*), origin(*) !! the cut solid
    integer :: i, crossing, n

    is_done(:n_crossed) = .false.
    do i = 1, n_crossed
      if (is_done(i)) cycle
      n = left_first(n_left_faces + 1) - 1
      crossing = i
      do while (.not. is_done(crossing))
        is_done(crossing) = .true.
        n = n + 1
        left_corner(n) = n_kept + crossing
        crossing = after(crossing)
      end do
      ! Two faces that meet along both crossings need no third between them.
      if (n - left_first(n_left_faces + 1) < 2) cycle
      n_left_faces = n_left_faces + 1
      left_first(n_left_faces + 1) = n + 1
      origin(n_left_faces) = 0
    end do
  end subroutine close_hole
end module sg_cut_surface
