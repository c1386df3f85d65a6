!> Proof that the axis kept of a pair of polyhedra is the axis of greatest separation still, without a search.
!!
!! A face of one polyhedron and the lowest vertex of the other over it, or an edge of each, make a facet of the difference of the
!! two. Let s be the separation along its normal n, and let the origin's foot on it be farther than r from its border. Points of the
!! facet bound the separation along any unit vector at an angle w from n by s cos w - r sin w, and a vertex of the same body as the
!! face, H farther back, by (s + H) cos w + 2 R sin w, R being the reach of that body. Where r >= 3 |s| and r H >= 16 R |s|, no
!! vector reaches s, so that n is the axis of greatest separation (doc/theory/detection_in_space.md, "The axis kept").
!!
!! The search prefers axes that come early and are as good up to rounding. So the proof asks more, by multiples of the rounding:
!! that no such axis is there. Then it gives the axis that the search finds, bit for bit; where it fails, the search is due.
module sg_kept_axis
  use sg_kinds, only: wp, i4
  use sg_polyhedron, only: polyhedron_t
  use sg_separation, only: axis_t, measure_axis, name_edges, normal_of_edges, separation_of
  use sg_vectors, only: cross
  implicit none
  private
  public :: prove_axis, feature_of

  !> Roundings that are added to a depth: other axes are worse by some roundings then
  real(wp), parameter :: clear_of_rounding = 64

contains

  !> What to keep of an axis: an edge of the candidate and one of the antagonist, or a face of one of them, negative; or zeros.
  pure function feature_of(axis) result(kept)
    type(axis_t), intent(in) :: axis !! best axis of a pair
    integer(i4) :: kept(2)

    if (axis%edge_c > 0) then
      kept = int([axis%edge_c, axis%edge_a], i4)
    else
      kept = -int([axis%face_c, axis%face_a], i4)
    end if
  end function feature_of

  !> Measure the axis kept, and prove it best where that takes no search.
  pure subroutine prove_axis(c, a, offset, rounding, kept, axis, is_proven)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    real(wp), intent(in) :: rounding !! separations that differ by less are as good [m]
    integer(i4), intent(in) :: kept(2) !! what `feature_of` gave, or any other numbers
    type(axis_t), intent(out) :: axis !! the axis; its separation is a lower bound of the distance even where it is not proven
    logical, intent(out) :: is_proven !! is it the one that a search finds?

    is_proven = .false.
    if (kept(1) > 0 .and. kept(1) <= c%n_edges .and. kept(2) > 0 .and. kept(2) <= a%n_edges) then
      call prove_edges(c, a, offset, rounding, int(kept(1)), int(kept(2)), axis, is_proven)
    else if (kept(2) < 0 .and. kept(2) >= -a%n_faces .and. kept(1) == 0) then
      call prove_face(a, c, -offset, rounding, -int(kept(2)), axis%vertex_a, axis%vertex_c, axis%separation, is_proven)
      axis%face_a = -int(kept(2))
      axis%normal = a%world_normal(:, axis%face_a)
      if (is_proven) axis%separation = separation_of(c, a, offset, axis)
    else if (kept(1) < 0 .and. kept(1) >= -c%n_faces .and. kept(2) == 0) then
      call prove_face(c, a, offset, rounding, -int(kept(1)), axis%vertex_c, axis%vertex_a, axis%separation, is_proven, before=a)
      axis%face_c = -int(kept(1))
      axis%normal = -c%world_normal(:, axis%face_c)
      if (is_proven) axis%separation = separation_of(c, a, offset, axis)
    end if
  end subroutine prove_axis

  !> Prove a face of one polyhedron, the reference, to be best.
  pure subroutine prove_face(reference, other, shift, rounding, face, corner, lowest, low, is_proven, before)
    type(polyhedron_t), intent(in) :: reference !! the one that has the face
    type(polyhedron_t), intent(in) :: other !! the other
    real(wp), intent(in) :: shift(3) !! added to the other's vertices [m]
    real(wp), intent(in) :: rounding !! by how much a face must beat another [m]
    integer, intent(in) :: face !! the face
    integer, intent(out) :: corner !! its first vertex
    integer, intent(out) :: lowest !! the other's lowest vertex over it
    real(wp), intent(out) :: low !! its height [m]
    logical, intent(out) :: is_proven !! does a search find this face?
    type(polyhedron_t), intent(in), optional :: before !! polyhedron whose faces the search tries before: the other one
    real(wp) :: normal(3), origin(3), height, second, square
    integer :: i

    normal = reference%world_normal(:, face)
    corner = reference%face_vertex(reference%face_first(face))
    origin = reference%world_vertex(:, corner) - shift
    low = huge(low)
    second = huge(second)
    lowest = 1
    do i = 1, other%n_vertices
      height = dot_product(normal, other%world_vertex(:, i) - origin)
      if (height < low) then
        second = low
        low = height
        lowest = i
      else if (height < second) then
        second = height
      end if
    end do
    ! Of vertices as low the search takes one by chance.
    is_proven = second - low > rounding
    if (.not. is_proven) return
    square = foot_clearance(reference, face, normal, other%world_vertex(:, lowest) + shift)
    is_proven = is_best(reference, normal, reference%world_vertex(:, corner), low, square, rounding)
    if (is_proven) is_proven = .not. has_parallel(reference, face - 1, normal, square, rounding)
    if (is_proven .and. present(before)) is_proven = .not. has_parallel(before, before%n_faces, -normal, square, rounding)
  end subroutine prove_face

  !> Prove a pair of edges to be best.
  pure subroutine prove_edges(c, a, offset, rounding, i, j, axis, is_proven)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    real(wp), intent(in) :: rounding !! by how much a pair must beat another [m]
    integer, intent(in) :: i !! edge of the candidate
    integer, intent(in) :: j !! edge of the antagonist
    type(axis_t), intent(out) :: axis !! their axis
    logical, intent(out) :: is_proven !! does a search find this pair?
    real(wp) :: normal(3), square

    call normal_of_edges(c, a, i, j, normal, is_proven)
    if (.not. is_proven) return
    call measure_axis(c, a, offset, normal, axis)
    is_proven = any(axis%vertex_c == c%edge(1:2, i)) .and. any(axis%vertex_a == a%edge(1:2, j))
    if (.not. is_proven) return
    square = crossing_clearance(c, a, offset, i, j)
    is_proven = is_best(a, normal, a%world_vertex(:, axis%vertex_a), axis%separation, square, rounding)
    if (is_proven) is_proven = stands_alone(c, i, -normal, square, rounding) .and. stands_alone(a, j, normal, square, rounding)
    if (is_proven) call name_edges(c, a, i, j, axis)
  end subroutine prove_edges

  !> Square of the distance of a point's foot on a face from the border [m2]; 0 where it is outside.
  pure real(wp) function foot_clearance(shape, face, normal, place) result(square)
    type(polyhedron_t), intent(in) :: shape !! polyhedron, in the world
    integer, intent(in) :: face !! one of its faces
    real(wp), intent(in) :: normal(3) !! its normal
    real(wp), intent(in) :: place(3) !! the point [m]
    real(wp) :: start(3), side(3), way(3), within
    integer :: k

    square = huge(square)
    associate (first => shape%face_first(face), last => shape%face_first(face + 1) - 1)
      start = shape%world_vertex(:, shape%face_vertex(last))
      do k = first, last
        side = shape%world_vertex(:, shape%face_vertex(k)) - start
        way = place - start
        within = normal(1)*(side(2)*way(3) - side(3)*way(2)) + normal(2)*(side(3)*way(1) - side(1)*way(3)) &
                 + normal(3)*(side(1)*way(2) - side(2)*way(1))
        square = min(square, max(within, 0.0_wp)**2/max(dot_product(side, side), tiny(within)))
        if (.not. square > 0) return
        start = start + side
      end do
    end associate
  end function foot_clearance

  !> Square of the distance of the crossing of two edges, seen along their common normal, from the border of the parallelogram
  !! that they span [m2]; 0 where they do not cross.
  pure real(wp) function crossing_clearance(c, a, offset, i, j) result(square)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    integer, intent(in) :: i !! edge of the candidate
    integer, intent(in) :: j !! edge of the antagonist
    real(wp) :: edge_c(3), edge_a(3), between(3), normal(3), length2, on_c, on_a

    edge_c = c%world_vertex(:, c%edge(2, i)) - c%world_vertex(:, c%edge(1, i))
    edge_a = a%world_vertex(:, a%edge(2, j)) - a%world_vertex(:, a%edge(1, j))
    between = (a%world_vertex(:, a%edge(1, j)) - c%world_vertex(:, c%edge(1, i))) + offset
    normal = cross(edge_c, edge_a)
    length2 = dot_product(normal, normal)
    on_c = dot_product(cross(between, edge_a), normal)/length2
    on_a = dot_product(cross(between, edge_c), normal)/length2
    on_c = max(min(on_c, 1 - on_c), 0.0_wp)
    on_a = max(min(on_a, 1 - on_a), 0.0_wp)
    square = length2*min(on_c**2/dot_product(edge_a, edge_a), on_a**2/dot_product(edge_c, edge_c))
  end function crossing_clearance

  !> Is no separation greater than that along the normal of a facet, and any that is as great up to rounding along a normal
  !! next to it?
  pure logical function is_best(shape, normal, place, separation, square, rounding)
    type(polyhedron_t), intent(in) :: shape !! a body whose face or edge is in the facet
    real(wp), intent(in) :: normal(3) !! normal of the facet, either way
    real(wp), intent(in) :: place(3) !! a point of that face or edge [m]
    real(wp), intent(in) :: separation !! along the normal [m]
    real(wp), intent(in) :: square !! square of the distance of the foot from the border of the facet [m2]
    real(wp), intent(in) :: rounding !! [m]
    real(wp) :: least, back
    integer :: k

    least = max(-separation, 0.0_wp) + clear_of_rounding*rounding
    is_best = square >= (3*least)**2
    if (.not. is_best) return
    least = (16*least*shape%reach)**2
    do k = 1, shape%n_vertices
      back = dot_product(normal, shape%world_vertex(:, k) - place)
      if (square*back**2 >= least) return
    end do
    is_best = .false.
  end function is_best

  !> Has one of the first faces of a polyhedron so nearly a given normal that its separation may be as great up to rounding?
  pure logical function has_parallel(shape, n, normal, square, rounding)
    type(polyhedron_t), intent(in) :: shape !! polyhedron, in the world
    integer, intent(in) :: n !! number of faces to look at
    real(wp), intent(in) :: normal(3) !! normal of the facet
    real(wp), intent(in) :: square !! square of the distance of the foot from the border of the facet [m2]
    real(wp), intent(in) :: rounding !! [m]
    real(wp) :: cosine
    integer :: f

    ! At an angle w the separation is less by 2/3 r sin w, which is to be several roundings; a cosine has 1e-16 of error.
    cosine = 1 - 1e-14_wp - 32*rounding**2/square
    has_parallel = .true.
    do f = 1, n
      if (dot_product(normal, shape%world_normal(:, f)) >= cosine) return
    end do
    has_parallel = .false.
  end function has_parallel

  !> Are all vertices but the ends of an edge farther back than they could be if another face or edge had nearly the same normal?
  pure logical function stands_alone(shape, edge, normal, square, rounding)
    type(polyhedron_t), intent(in) :: shape !! polyhedron, in the world
    integer, intent(in) :: edge !! edge that lies farthest in a direction
    real(wp), intent(in) :: normal(3) !! the direction
    real(wp), intent(in) :: square !! square of the distance of the foot from the border of the facet [m2]
    real(wp), intent(in) :: rounding !! [m]
    real(wp) :: place(3), back, least
    integer :: k

    ! The angle is 8 roundings over r, as in `has_parallel`, and a way is 2 R long at most.
    least = (16*rounding*shape%reach)**2
    place = shape%world_vertex(:, shape%edge(1, edge))
    stands_alone = .false.
    do k = 1, shape%n_vertices
      if (any(shape%edge(1:2, edge) == k)) cycle
      back = dot_product(normal, place - shape%world_vertex(:, k)) - rounding
      if (back <= 0 .or. square*back**2 <= least) return
    end do
    stands_alone = .true.
  end function stands_alone
end module sg_kept_axis
