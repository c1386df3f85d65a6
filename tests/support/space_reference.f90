!> Dense references for pairs of convex polyhedra: every face, every pair of edges, nothing pruned.
module space_reference
  use sg_kinds, only: wp
  use sg_polyhedron, only: polyhedron_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: signed_distance, separation_along, height_above, point_distance, vertex_distance

contains

  !> Distance of two polyhedra, or minus the least translation that parts them.
  function signed_distance(c, a, offset) result(distance)
    type(polyhedron_t), intent(in) :: c, a !! placed in the world
    real(wp), intent(in) :: offset(3) !! added to a [m]
    real(wp) :: distance, normal(3), length, edge_c(3), edge_a(3), p(3), q(3)
    integer :: i, j

    distance = -huge(1.0_wp)
    do i = 1, a%n_faces
      distance = max(distance, separation_along(c, a, offset, a%world_normal(:, i)))
    end do
    do i = 1, c%n_faces
      distance = max(distance, separation_along(c, a, offset, -c%world_normal(:, i)))
    end do
    do i = 1, c%n_edges
      edge_c = c%world_vertex(:, c%edge(2, i)) - c%world_vertex(:, c%edge(1, i))
      do j = 1, a%n_edges
        edge_a = a%world_vertex(:, a%edge(2, j)) - a%world_vertex(:, a%edge(1, j))
        normal = cross(edge_c, edge_a)
        length = norm2(normal)
        if (length < 1e-10_wp*norm2(edge_a)*norm2(edge_c)) cycle
        distance = max(distance, separation_along(c, a, offset, normal/length), separation_along(c, a, offset, -normal/length))
      end do
    end do
    if (distance <= 0) return
    distance = huge(1.0_wp)
    do i = 1, c%n_edges
      p = c%world_vertex(:, c%edge(1, i)) - offset
      q = c%world_vertex(:, c%edge(2, i)) - offset
      do j = 1, a%n_edges
        distance = min(distance, edge_distance(p, q, a%world_vertex(:, a%edge(1, j)), a%world_vertex(:, a%edge(2, j))))
      end do
    end do
    do i = 1, c%n_vertices
      distance = min(distance, point_distance(c%world_vertex(:, i) - offset, a))
    end do
    do i = 1, a%n_vertices
      distance = min(distance, point_distance(a%world_vertex(:, i) + offset, c))
    end do
  end function signed_distance

  !> How far the shapes are apart along a normal.
  function separation_along(c, a, offset, normal) result(s)
    type(polyhedron_t), intent(in) :: c, a !! placed in the world
    real(wp), intent(in) :: offset(3), normal(3) !! added to a [m]; unit, from a to c
    real(wp) :: s, origin(3), low, high
    integer :: i

    ! About a corner, so that far from the origin no digits are lost.
    origin = a%world_vertex(:, 1)
    low = huge(low)
    high = -huge(high)
    do i = 1, c%n_vertices
      low = min(low, dot_product(normal, (c%world_vertex(:, i) - origin) - offset))
    end do
    do i = 1, a%n_vertices
      high = max(high, dot_product(normal, a%world_vertex(:, i) - origin))
    end do
    s = low - high
  end function separation_along

  !> Height of a point above the highest of a polyhedron's face planes; negative inside.
  function height_above(place, shape) result(height)
    real(wp), intent(in) :: place(3) !! point [m]
    type(polyhedron_t), intent(in) :: shape !! placed in the world
    real(wp) :: height
    integer :: f

    height = -huge(height)
    do f = 1, shape%n_faces
      height = max(height, dot_product(shape%world_normal(:, f), &
                                       place - shape%world_vertex(:, shape%face_vertex(shape%face_first(f)))))
    end do
  end function height_above

  !> Distance of a point outside a polyhedron to its faces' insides, edges and vertices.
  function point_distance(place, shape) result(distance)
    real(wp), intent(in) :: place(3) !! point [m]
    type(polyhedron_t), intent(in) :: shape !! placed in the world
    real(wp) :: distance, p(3), q(3), height, side
    integer :: f, k, first, last

    distance = huge(distance)
    do f = 1, shape%n_faces
      first = shape%face_first(f)
      last = shape%face_first(f + 1) - 1
      side = huge(side)
      do k = first, last
        p = shape%world_vertex(:, shape%face_vertex(k))
        q = shape%world_vertex(:, shape%face_vertex(merge(first, k + 1, k == last)))
        distance = min(distance, edge_distance(place, place, p, q))
        side = min(side, dot_product(cross(shape%world_normal(:, f), q - p), place - p))
      end do
      height = dot_product(shape%world_normal(:, f), place - p)
      if (side >= 0 .and. height >= 0) distance = min(distance, height)
    end do
  end function point_distance

  !> Distance of a point to the nearest vertex of a polyhedron.
  pure function vertex_distance(shape, place) result(distance)
    type(polyhedron_t), intent(in) :: shape !! placed in the world
    real(wp), intent(in) :: place(3) !! point [m]
    real(wp) :: distance
    integer :: k

    distance = huge(distance)
    do k = 1, shape%n_vertices
      distance = min(distance, norm2(shape%world_vertex(:, k) - place))
    end do
  end function vertex_distance

  !> Distance of two segments: between their insides, or from an end of one to the other.
  function edge_distance(p1, q1, p2, q2) result(distance)
    real(wp), intent(in) :: p1(3), q1(3), p2(3), q2(3) !! ends [m]
    real(wp) :: distance, d1(3), d2(3), normal(3), r(3), square, s, t

    distance = min(end_distance(p1, p2, q2), end_distance(q1, p2, q2), end_distance(p2, p1, q1), end_distance(q2, p1, q1))
    d1 = q1 - p1
    d2 = q2 - p2
    normal = cross(d1, d2)
    square = dot_product(normal, normal)
    if (square <= 1e-20_wp*dot_product(d1, d1)*dot_product(d2, d2)) return
    r = p2 - p1
    s = dot_product(cross(r, d2), normal)/square
    t = dot_product(cross(r, d1), normal)/square
    if (min(s, t) >= 0 .and. max(s, t) <= 1) distance = min(distance, abs(dot_product(r, normal))/sqrt(square))
  end function edge_distance

  !> Distance of a point to a segment.
  function end_distance(place, p, q) result(distance)
    real(wp), intent(in) :: place(3), p(3), q(3) !! point and ends [m]
    real(wp) :: distance, d(3), t

    d = q - p
    t = 0
    if (dot_product(d, d) > 0) t = min(max(dot_product(place - p, d)/dot_product(d, d), 0.0_wp), 1.0_wp)
    distance = norm2(place - (p + t*d))
  end function end_distance
end module space_reference
