!> The axis of greatest separation of two convex polyhedra among their faces and pairs of edges.
!!
!! Where two polyhedra overlap, the least translation that parts them is along the normal of a face of one, or
!! perpendicular to an edge of each: these are the normals of the faces of their difference. A pair of edges makes
!! such a face only when the arcs that join the normals of their adjacent faces cross on the unit sphere.
module sg_polyhedra_overlap
  use sg_kinds, only: wp
  use sg_polyhedron, only: polyhedron_t
  use sg_separation, only: axis_t, measure_axis, name_edges, normal_of_edges, separation_of
  implicit none
  private
  public :: try_faces, try_edges

  !> Edges looked at in one go, and vertices whose heights are kept meanwhile
  integer, parameter :: batch = 64

  !> Edges of the candidate near the antagonist, laid out so that one of the antagonist's is tried with all in a few strokes
  type :: near_edges_t
    !> Their number and their numbers
    integer :: n, edge(batch)
    !> Ways from first vertex to second, normals of the faces on the left and on the right, shape (edge, 3)
    real(wp) :: way(batch, 3), left(batch, 3), right(batch, 3)
  end type near_edges_t

contains

  !> Try the faces of both: the antagonist's first, which a later one must beat by more than rounding.
  pure subroutine try_faces(c, a, offset, rounding, axis)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    real(wp), intent(in) :: rounding !! separations that differ by less are as good [m]
    type(axis_t), intent(inout) :: axis !! best axis so far; a face as good replaces it
    real(wp) :: bar
    integer :: face_a, face_c, vertex_a, vertex_c

    bar = axis%separation - rounding
    call best_face(a, c, -offset, axis%vertex_c, rounding, bar, face_a, vertex_c)
    call best_face(c, a, offset, axis%vertex_a, rounding, bar, face_c, vertex_a)
    if (face_c > 0) then
      axis%normal = -c%world_normal(:, face_c)
      vertex_c = c%face_vertex(c%face_first(face_c))
    else if (face_a > 0) then
      axis%normal = a%world_normal(:, face_a)
      vertex_a = a%face_vertex(a%face_first(face_a))
    else
      return
    end if
    axis%face_a = merge(face_a, 0, face_c == 0)
    axis%face_c = face_c
    axis%vertex_a = vertex_a
    axis%vertex_c = vertex_c
    axis%separation = separation_of(c, a, offset, axis)
  end subroutine try_faces

  !> Find the face over which the other's lowest vertex is highest, if it is above a bar.
  pure subroutine best_face(reference, other, shift, first, rounding, bar, face, lowest)
    type(polyhedron_t), intent(in) :: reference !! the one whose faces are tried
    type(polyhedron_t), intent(in) :: other !! the other
    real(wp), intent(in) :: shift(3) !! added to the other's vertices [m]
    integer, intent(in) :: first !! vertex of the other that is probably low
    real(wp), intent(in) :: rounding !! by how much a face must beat another [m]
    real(wp), intent(inout) :: bar !! height to be above; raised by the face found [m]
    integer, intent(out) :: face !! best face, 0 where none is above the bar
    integer, intent(out) :: lowest !! the other's lowest vertex over it
    real(wp) :: normal(3), corner(3), height, low
    integer :: f, i, k

    face = 0
    lowest = 0
    do f = 1, reference%n_faces
      normal = reference%world_normal(:, f)
      corner = reference%world_vertex(:, reference%face_vertex(reference%face_first(f))) - shift
      low = dot_product(normal, other%world_vertex(:, first) - corner)
      if (low < bar) cycle
      k = first
      do i = 1, other%n_vertices
        height = dot_product(normal, other%world_vertex(:, i) - corner)
        if (height >= low) cycle
        low = height
        k = i
        if (low < bar) exit
      end do
      if (low < bar) cycle
      face = f
      lowest = k
      bar = low + rounding
    end do
  end subroutine best_face

  !> Try the pairs of edges that may touch once the shapes are parted.
  !!
  !! Of two shapes that overlap by the depth d along any normal n, translated apart along the best axis (by at most d),
  !! the edges that make it cross. So along n each of them comes within 2 d of the other shape's side of its own shape; where
  !! the shapes are apart by between s(n) and d, within d - s(n).
  pure subroutine try_edges(c, a, offset, distance, rounding, axis)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    real(wp), intent(in) :: distance !! the shapes are no farther apart [m]; 0 where they overlap
    real(wp), intent(in) :: rounding !! separations that differ by less are as good [m]
    type(axis_t), intent(inout) :: axis !! best axis so far; a pair of edges replaces it where it is better
    real(wp) :: normal(3), width, bar_a, bar_c, bar
    type(near_edges_t) :: near
    integer :: near_a(batch), n_a, i, j, k

    normal = axis%normal
    width = max(-axis%separation, 0.0_wp) + max(distance, -axis%separation) - max(axis%separation, 0.0_wp) + rounding
    bar_a = dot_product(normal, a%world_vertex(:, axis%vertex_a)) - width
    bar_c = -dot_product(normal, c%world_vertex(:, axis%vertex_c)) - width
    ! Faces are as good already. An axis through the nearest points of an edge and another gains digits as theirs.
    bar = axis%separation + merge(rounding, -rounding, max(axis%face_a, axis%face_c) > 0)
    i = 0
    do while (i < c%n_edges)
      call near_edges(c, -normal, bar_c, i, near%n, near%edge)
      call gather_edges(c, near)
      j = 0
      do while (j < a%n_edges .and. near%n > 0)
        call near_edges(a, normal, bar_a, j, n_a, near_a)
        do k = 1, n_a
          call try_edge(c, a, offset, near, near_a(k), rounding, bar, axis)
        end do
      end do
    end do
  end subroutine try_edges

  !> Find edges that reach above a bar, from where the last search ended, as many as go into one batch.
  pure subroutine near_edges(shape, normal, bar, last, n, near)
    type(polyhedron_t), intent(in) :: shape !! polyhedron, in the world
    real(wp), intent(in) :: normal(3) !! direction of heights
    real(wp), intent(in) :: bar !! height [m]
    integer, intent(inout) :: last !! edge looked at last
    integer, intent(out) :: n !! number of edges found
    integer, intent(out) :: near(batch) !! the edges
    real(wp) :: height(batch), top
    integer :: i
    logical :: is_small

    is_small = shape%n_vertices <= batch
    if (is_small) then
      do i = 1, shape%n_vertices
        height(i) = dot_product(normal, shape%world_vertex(:, i))
      end do
    end if
    n = 0
    do while (last < shape%n_edges .and. n < batch)
      last = last + 1
      associate (ends => shape%edge(1:2, last))
        if (is_small) then
          top = max(height(ends(1)), height(ends(2)))
        else
          top = max(dot_product(normal, shape%world_vertex(:, ends(1))), dot_product(normal, shape%world_vertex(:, ends(2))))
        end if
      end associate
      if (top < bar) cycle
      n = n + 1
      near(n) = last
    end do
  end subroutine near_edges

  !> Gather what is known of edges.
  pure subroutine gather_edges(shape, near)
    type(polyhedron_t), intent(in) :: shape !! polyhedron, in the world
    type(near_edges_t), intent(inout) :: near !! edges, by their numbers
    integer :: k

    do k = 1, near%n
      associate (edge => shape%edge(:, near%edge(k)))
        near%way(k, :) = shape%world_vertex(:, edge(2)) - shape%world_vertex(:, edge(1))
        near%left(k, :) = shape%world_normal(:, edge(3))
        near%right(k, :) = shape%world_normal(:, edge(4))
      end associate
    end do
  end subroutine gather_edges

  !> Try one edge of the antagonist with some of the candidate.
  pure subroutine try_edge(c, a, offset, near, j, rounding, bar, axis)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    type(near_edges_t), intent(in) :: near !! edges of the candidate
    integer, intent(in) :: j !! edge of the antagonist
    real(wp), intent(in) :: rounding !! by how much a pair must beat another [m]
    real(wp), intent(inout) :: bar !! separation to beat [m]
    type(axis_t), intent(inout) :: axis !! best axis so far
    type(axis_t) :: trial
    real(wp) :: edge_a(3), edge_c(3), left_a(3), right_a(3), normal(3), right, on_left(batch), on_right(batch)
    integer :: i, k
    logical :: is_direction

    edge_a = a%world_vertex(:, a%edge(2, j)) - a%world_vertex(:, a%edge(1, j))
    left_a = a%world_normal(:, a%edge(3, j))
    right_a = a%world_normal(:, a%edge(4, j))
    do k = 1, near%n
      on_left(k) = edge_a(1)*near%left(k, 1) + edge_a(2)*near%left(k, 2) + edge_a(3)*near%left(k, 3)
      on_right(k) = edge_a(1)*near%right(k, 1) + edge_a(2)*near%right(k, 2) + edge_a(3)*near%right(k, 3)
    end do
    do k = 1, near%n
      if (on_left(k)*on_right(k) >= 0) cycle
      edge_c = near%way(k, :)
      right = dot_product(edge_c, right_a)
      if (dot_product(edge_c, left_a)*right >= 0 .or. (on_left(k) > 0 .eqv. right > 0)) cycle
      i = near%edge(k)
      call normal_of_edges(c, a, i, j, normal, is_direction)
      if (.not. is_direction) cycle
      if (dot_product(normal, (c%world_vertex(:, c%edge(1, i)) - a%world_vertex(:, a%edge(1, j))) - offset) < bar) cycle
      ! What rounding makes of short edges is no axis unless all vertices confirm it.
      call measure_axis(c, a, offset, normal, trial)
      if (trial%separation < bar) cycle
      axis = trial
      call name_edges(c, a, i, j, axis)
      bar = trial%separation + rounding
    end do
  end subroutine try_edge
end module sg_polyhedra_overlap
