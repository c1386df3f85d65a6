!> Separation of two convex polyhedra along a direction, and the axis along which they touch.
!!
!! Along a unit normal n the candidate C and the antagonist A are apart by
!! s(n) = min over C of n.x - max over A of n.x. The signed distance of the two is the greatest s(n): their distance
!! where they are apart, minus the least translation that parts them where they overlap.
module sg_separation
  use sg_kinds, only: wp
  use sg_polyhedron, only: polyhedron_t
  implicit none
  private
  public :: axis_t, measure_axis, name_edges, normal_of_edges, rounding_of, separation_of

  !> An axis between two polyhedra
  type :: axis_t
    !> Unit normal from antagonist to candidate, and s along it [m]
    real(wp) :: normal(3) = 0, separation = -huge(1.0_wp)
    !> The vertex of each that lies nearest to the other along the axis
    integer :: vertex_c = 0, vertex_a = 0
    !> Faces that face the other body, 0 where the axis does not determine which
    integer :: face_c = 0, face_a = 0
    !> The two edges to which the axis is perpendicular, 0 where it comes from elsewhere
    integer :: edge_c = 0, edge_a = 0
    !> Point of the candidate that faces the antagonist [m]; set where the axis joins the two nearest points
    real(wp) :: surface(3) = 0
  end type axis_t

contains

  !> The vertex that lies farthest in a direction, the first of several.
  pure integer function extreme_vertex(n, vertex, x, y, z) result(k)
    integer, intent(in) :: n !! number of vertices
    real(wp), intent(in) :: vertex(3, n) !! [m]
    real(wp), intent(in) :: x, y, z !! direction, of any length
    real(wp) :: height, highest
    integer :: i

    k = 1
    highest = -huge(highest)
    do i = 1, n
      height = x*vertex(1, i) + y*vertex(2, i) + z*vertex(3, i)
      if (height > highest) then
        highest = height
        k = i
      end if
    end do
  end function extreme_vertex

  !> Measure the separation along a unit normal, and forget whence the axis came.
  pure subroutine measure_axis(c, a, offset, normal, axis)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    real(wp), intent(in) :: normal(3) !! unit, from antagonist to candidate
    type(axis_t), intent(out) :: axis !! the axis measured
    integer :: i, j

    i = extreme_vertex(c%n_vertices, c%world_vertex, -normal(1), -normal(2), -normal(3))
    j = extreme_vertex(a%n_vertices, a%world_vertex, normal(1), normal(2), normal(3))
    axis%normal = normal
    axis%vertex_c = i
    axis%vertex_a = j
    axis%separation = dot_product(normal, (c%world_vertex(:, i) - a%world_vertex(:, j)) - offset)
  end subroutine measure_axis

  !> Separation along an axis, from its normal and its two vertices [m].
  pure real(wp) function separation_of(c, a, offset, axis) result(separation)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    type(axis_t), intent(in) :: axis !! its normal and vertices

    separation = dot_product(axis%normal, (c%world_vertex(:, axis%vertex_c) - a%world_vertex(:, axis%vertex_a)) - offset)
  end function separation_of

  !> Unit normal perpendicular to an edge of each, out of the antagonist.
  pure subroutine normal_of_edges(c, a, i, j, normal, is_direction)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    integer, intent(in) :: i !! edge of the candidate
    integer, intent(in) :: j !! edge of the antagonist
    real(wp), intent(out) :: normal(3) !! the normal
    logical, intent(out) :: is_direction !! are the edges far enough from parallel to have one?
    real(wp) :: edge_a(3), edge_c(3), length2

    edge_a = a%world_vertex(:, a%edge(2, j)) - a%world_vertex(:, a%edge(1, j))
    edge_c = c%world_vertex(:, c%edge(2, i)) - c%world_vertex(:, c%edge(1, i))
    ! Written out, since the compiler calls a procedure of another file.
    normal(1) = edge_a(2)*edge_c(3) - edge_a(3)*edge_c(2)
    normal(2) = edge_a(3)*edge_c(1) - edge_a(1)*edge_c(3)
    normal(3) = edge_a(1)*edge_c(2) - edge_a(2)*edge_c(1)
    length2 = dot_product(normal, normal)
    ! Nearly parallel edges give no direction, and where they matter faces or nearest points give a better one.
    is_direction = length2 > 1e-20_wp*dot_product(edge_a, edge_a)*dot_product(edge_c, edge_c)
    if (is_direction) normal = normal/sign(sqrt(length2), dot_product(normal, a%world_normal(:, a%edge(3, j)) &
                                                                              + a%world_normal(:, a%edge(4, j))))
  end subroutine normal_of_edges

  !> Note the edges that an axis comes from, with the face of each that faces the other body.
  pure subroutine name_edges(c, a, i, j, axis)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    integer, intent(in) :: i !! edge of the candidate
    integer, intent(in) :: j !! edge of the antagonist
    type(axis_t), intent(inout) :: axis !! axis measured along `normal_of_edges`

    axis%edge_c = i
    axis%edge_a = j
    associate (face_c => c%edge(3:4, i), face_a => a%edge(3:4, j), normal => axis%normal)
      axis%face_c = face_c(merge(1, 2, dot_product(c%world_normal(:, face_c(1)) - c%world_normal(:, face_c(2)), normal) <= 0))
      axis%face_a = face_a(merge(1, 2, dot_product(a%world_normal(:, face_a(1)) - a%world_normal(:, face_a(2)), normal) >= 0))
    end associate
  end subroutine name_edges

  !> Lengths below which rounding hides all differences [m]: separations that differ by less are as good, points nearer are one.
  !!
  !! It holds what coordinates lose far from the origin (some units in the last place) and a share of the smaller shape
  !! that no impulse notices, so that of two faces in contact always the same gives the normal.
  pure real(wp) function rounding_of(c, a, offset) result(rounding)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]

    rounding = 1e-10_wp*min(c%reach, a%reach) &
               + 16*epsilon(rounding)*(maxval(abs(c%centre)) + maxval(abs(a%centre)) + maxval(abs(offset)) + c%reach + a%reach)
  end function rounding_of
end module sg_separation
