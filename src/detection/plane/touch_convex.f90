!> Contact of two convex polygons, the antagonist thickened by a radius (0 for a polygon, half thickness for a segment).
!!
!! The face of greatest separation, over the edges of both, is the reference: where the two overlap it gives the
!! shortest way apart, where they do not a lower bound of the distance. Points of contact lie over it (`face_points.f90`).
!!
!! A kept face, the reference of the last step, is measured first. The best face is at least as high, so most others are rejected
!! at one vertex; a kept face beyond reach ends the search, and mostly it is proven best (`kept_face.f90`). Else faces in `slack`
!! below the kept one, or above it, are compared in their order as without it. A lower one cannot win. Nor can it decide among
!! faces as good: one that is rejected in its favour is higher by `same_length` at most, and of such steps there are no more than
!! faces. So no point depends on what is kept.
!!
!! With a face its lowest vertex is kept. Where the two next to it are clearly higher it is the lowest still, since polygons are
!! convex; else all are looked at.
module sg_touch_convex
  use sg_face_points, only: add_points, face_t, next
  use sg_kept_face, only: prove_face, stands_off
  use sg_kinds, only: wp, i4
  use sg_touch, only: touch_t, same_length
  implicit none
  private
  public :: touch_convex, vertex_unit

  !> A face kept is its edge and this times the vertex that is lowest over it, where both are less than half of it
  integer(i4), parameter :: vertex_unit = 2_i4**16

contains

  !> Points of contact of two convex polygons; the antagonist's surface lies `radius_a` outside its vertices' hull.
  pure subroutine touch_convex(n_c, vertices_c, edges_c, n_a, vertices_a, edges_a, longest, offset_a, radius_a, alert, kept, &
                               touch, clearance)
    integer, intent(in) :: n_c !! vertices of the candidate
    real(wp), intent(in) :: vertices_c(2, n_c) !! candidate's vertices, counter-clockwise [m]
    real(wp), intent(in) :: edges_c(3, n_c) !! normals and lengths of its edges, see `edges_of` [m]
    integer, intent(in) :: n_a !! vertices of the antagonist
    real(wp), intent(in) :: vertices_a(2, n_a) !! antagonist's vertices, counter-clockwise [m]
    real(wp), intent(in) :: edges_a(3, n_a) !! normals and lengths of its edges [m]
    real(wp), intent(in) :: longest !! no edge of either is longer [m]
    real(wp), intent(in) :: offset_a(2) !! added to the antagonist's vertices (its periodic image) [m]
    real(wp), intent(in) :: radius_a !! thickness of the antagonist's skin [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    integer(i4), intent(inout) :: kept !! face to try first, on return the best one: an edge of the antagonist; of the candidate
    !! where it is negative; 0 for none; with the vertex over it (`key_of`). The points do not depend on it
    type(touch_t), intent(out) :: touch !! points found
    real(wp), intent(out), optional :: clearance !! least distance of the hulls; nothing where they are nearer than points count [m]
    type(face_t) :: face_a, face_c
    real(wp) :: reach, floor, slack, height
    integer :: edge_a, edge_c, low_a, low_c, guess
    logical :: is_proven, is_of_antagonist

    reach = alert + radius_a
    floor = -huge(floor)
    slack = real(n_a + n_c + 4, wp)*same_length*longest
    guess = abs(int(kept)/vertex_unit)
    edge_a = usable(mod(int(kept), vertex_unit), n_a, edges_a)
    edge_c = usable(-mod(int(kept), vertex_unit), n_c, edges_c)
    low_c = edge_c
    low_a = 0
    if (present(clearance)) clearance = -huge(clearance)
    is_proven = .false.
    if (edge_a > 0) then
      call measure_kept(n_a, vertices_a, edges_a, edge_a, n_c, vertices_c, edges_c, -offset_a, guess, slack, reach, .true., &
                        low_c, height, is_proven)
      kept = key_of(edge_a, low_c)
    else if (edge_c > 0) then
      call measure_kept(n_c, vertices_c, edges_c, edge_c, n_a, vertices_a, edges_a, offset_a, guess, slack, reach, .false., &
                        low_a, height, is_proven)
      kept = -key_of(edge_c, low_a)
    end if
    if (max(edge_a, edge_c) > 0) floor = height - slack
    if (is_proven .or. floor >= reach) then
      if (max(floor, height) >= reach) then
        if (present(clearance)) clearance = height - sure_slack()
      else if (edge_a > 0) then
        face_a = face_t(edge_a, edges_a(3, edge_a), edges_a(1:2, edge_a), low_c, height)
        call add_points(n_a, vertices_a, n_c, vertices_c, edges_c, -offset_a, face_a, .true., radius_a, alert, touch)
      else
        face_c = face_t(edge_c, edges_c(3, edge_c), edges_c(1:2, edge_c), low_a, height)
        call add_points(n_c, vertices_c, n_a, vertices_a, edges_a, offset_a, face_c, .false., radius_a, alert, touch)
      end if
      return
    end if
    call find_face(n_a, vertices_a, edges_a, n_c, vertices_c, -offset_a, reach, low_c, floor, face_a)
    if (face_a%height >= reach) then
      kept = key_of(face_a%edge, face_a%lowest)
      if (present(clearance)) clearance = face_a%height - sure_slack()
      return
    end if
    floor = max(floor, face_a%height - slack)
    call find_face(n_c, vertices_c, edges_c, n_a, vertices_a, offset_a, reach, max(low_a, face_a%edge), floor, face_c)
    if (present(clearance) .and. face_c%height >= reach) clearance = face_c%height - sure_slack()
    ! Of two faces as good, always the antagonist's: the normal of resting bricks must not depend on rounding.
    is_of_antagonist = face_a%height >= face_c%height - same_length*max(face_a%length, face_c%length)
    kept = merge(key_of(face_a%edge, face_a%lowest), -key_of(face_c%edge, face_c%lowest), is_of_antagonist)
    if (face_c%height >= reach .or. max(face_a%edge, face_c%edge) == 0) return
    if (is_of_antagonist) then
      call add_points(n_a, vertices_a, n_c, vertices_c, edges_c, -offset_a, face_a, .true., radius_a, alert, touch)
    else
      call add_points(n_c, vertices_c, n_a, vertices_a, edges_a, offset_a, face_c, .false., radius_a, alert, touch)
    end if

  contains

    !> By how much heights may differ that are measured in other places [m]: faces as good, and digits lost far from the origin.
    pure real(wp) function sure_slack()
      sure_slack = 2*slack + 32*epsilon(slack)*(sum(abs(vertices_c(:, 1))) + sum(abs(vertices_a(:, 1))) + sum(abs(offset_a)) &
                                                + real(n_c + n_a, wp)*longest)
    end function sure_slack
  end subroutine touch_convex

  !> Measure the face kept, and prove it best where that takes no search.
  pure subroutine measure_kept(n_r, reference, edges_r, edge, n_i, incident, edges_i, shift, guess, slack, reach, comes_first, &
                               low, height, is_proven)
    integer, intent(in) :: n_r !! vertices of the polygon that has the face
    real(wp), intent(in) :: reference(2, n_r) !! its vertices [m]
    real(wp), intent(in) :: edges_r(3, n_r) !! normals and lengths of its edges [m]
    integer, intent(in) :: edge !! the face
    integer, intent(in) :: n_i !! vertices of the other polygon
    real(wp), intent(in) :: incident(2, n_i) !! its vertices [m]
    real(wp), intent(in) :: edges_i(3, n_i) !! normals and lengths of its edges [m]
    real(wp), intent(in) :: shift(2) !! added to its vertices [m]
    integer, intent(in) :: guess !! vertex of the other that was lowest over the face; any number where none is known
    real(wp), intent(in) :: slack !! heights that differ by less are as good [m]
    real(wp), intent(in) :: reach !! height from which a face ends the search, and no proof is needed [m]
    logical, intent(in) :: comes_first !! are faces of this polygon preferred to those of the other?
    integer, intent(out) :: low !! the other's lowest vertex over the face
    real(wp), intent(out) :: height !! its height [m]
    logical, intent(out) :: is_proven !! does a search find this face?
    real(wp) :: start(2), inside

    start = reference(:, edge) - shift
    call check_lowest(n_i, incident, edges_r(1:2, edge), start, guess, slack, low, height)
    if (low == 0) call find_lowest(n_i, incident, edges_r(1:2, edge), start, -huge(height), low, height)
    is_proven = height - slack < reach
    if (is_proven) call prove_face(n_r, reference, edges_r, edge, incident(:, low) - start, height, slack, inside, is_proven)
    if (comes_first .or. .not. is_proven) return
    ! Of the other's faces those at its lowest vertex are next to parallel.
    is_proven = stands_off(-edges_r(1:2, edge), edges_i(:, low), inside, slack)
    if (is_proven) is_proven = stands_off(-edges_r(1:2, edge), edges_i(:, merge(n_i, low - 1, low == 1)), inside, slack)
  end subroutine measure_kept

  !> Find the reference edge over which the lowest incident vertex is highest; stop once it is beyond reach.
  pure subroutine find_face(n_r, reference, edges, n_i, incident, shift, reach, probe, floor, face)
    integer, intent(in) :: n_r !! vertices of the reference polygon
    real(wp), intent(in) :: reference(2, n_r) !! its vertices [m]
    real(wp), intent(in) :: edges(3, n_r) !! normals and lengths of its edges [m]
    integer, intent(in) :: n_i !! vertices of the incident polygon
    real(wp), intent(in) :: incident(2, n_i) !! its vertices [m]
    real(wp), intent(in) :: shift(2) !! added to the incident vertices [m]
    real(wp), intent(in) :: reach !! height from which the search may stop [m]
    integer, intent(in) :: probe !! incident vertex that is probably low, like the one after it; 0 where none is known
    real(wp), intent(in) :: floor !! height of faces that need not be found [m]
    type(face_t), intent(out) :: face !! the best edge
    real(wp) :: first(2), second(2), start(2), bar, height
    integer :: i, lowest

    first = incident(:, max(probe, 1))
    second = incident(:, next(max(probe, 1), n_i))
    do i = 1, n_r
      associate (normal => edges(1:2, i), length => edges(3, i))
        if (length <= tiny(length)) cycle
        start = reference(:, i) - shift
        ! A face must win by more than rounding, or faces as good would take turns.
        bar = max(face%height + same_length*length, floor)
        if (normal(1)*(first(1) - start(1)) + normal(2)*(first(2) - start(2)) <= bar) cycle
        if (normal(1)*(second(1) - start(1)) + normal(2)*(second(2) - start(2)) <= bar) cycle
        call find_lowest(n_i, incident, normal, start, bar, lowest, height)
        if (height <= bar) cycle
        face = face_t(edge=i, length=length, normal=normal, lowest=lowest, height=height)
        if (height >= reach) return
      end associate
    end do
  end subroutine find_face

  !> A kept edge, 0 where a polygon has no such edge or it has no normal.
  pure integer function usable(kept, n, edges) result(edge)
    integer, intent(in) :: kept !! number of the edge, of any size
    integer, intent(in) :: n !! edges of the polygon
    real(wp), intent(in) :: edges(3, n) !! their normals and lengths [m]

    edge = 0
    if (kept < 1 .or. kept > n) return
    if (edges(3, kept) > tiny(edges)) edge = kept
  end function usable

  !> Key by which a face is kept: its edge and the vertex that is lowest over it, or the edge alone where there are too many.
  pure integer(i4) function key_of(edge, lowest) result(key)
    integer, intent(in) :: edge !! the face, 0 for none
    integer, intent(in) :: lowest !! vertex of the other polygon

    key = int(edge, i4)
    if (max(edge, lowest) < vertex_unit/2) key = key + int(vertex_unit*lowest, i4)
  end function key_of

  !> Is a vertex still the lowest over a face? Where the next ones are clearly higher; of a convex polygon all others are then.
  pure subroutine check_lowest(n, vertices, normal, start, guess, slack, lowest, height)
    integer, intent(in) :: n !! vertices
    real(wp), intent(in) :: vertices(2, n) !! [m]
    real(wp), intent(in) :: normal(2) !! outward unit normal of the face
    real(wp), intent(in) :: start(2) !! a point of the face [m]
    integer, intent(in) :: guess !! the vertex, or any number
    real(wp), intent(in) :: slack !! heights that differ by less are as good [m]
    integer, intent(out) :: lowest !! the vertex if it is, 0 where that is not known
    real(wp), intent(out) :: height !! its height [m]

    lowest = 0
    height = 0
    if (guess < 1 .or. guess > n) return
    height = height_of(guess)
    if (min(height_of(merge(n, guess - 1, guess == 1)), height_of(next(guess, n))) > height + slack) lowest = guess
  contains
    pure real(wp) function height_of(j)
      integer, intent(in) :: j

      height_of = normal(1)*(vertices(1, j) - start(1)) + normal(2)*(vertices(2, j) - start(2))
    end function height_of
  end subroutine check_lowest

  !> Find the lowest vertex over a face; stop at one that is no higher than a bar.
  pure subroutine find_lowest(n, vertices, normal, start, bar, lowest, lowest_height)
    integer, intent(in) :: n !! vertices
    real(wp), intent(in) :: vertices(2, n) !! [m]
    real(wp), intent(in) :: normal(2) !! outward unit normal of the face
    real(wp), intent(in) :: start(2) !! a point of the face [m]
    real(wp), intent(in) :: bar !! height [m]
    integer, intent(out) :: lowest !! the vertex, or the first one that is no higher than the bar
    real(wp), intent(out) :: lowest_height !! its height [m]
    real(wp) :: height
    integer :: j

    lowest_height = huge(lowest_height)
    lowest = 0
    do j = 1, n
      height = normal(1)*(vertices(1, j) - start(1)) + normal(2)*(vertices(2, j) - start(2))
      if (height >= lowest_height) cycle
      lowest_height = height
      lowest = j
      if (height <= bar) return
    end do
  end subroutine find_lowest
end module sg_touch_convex
