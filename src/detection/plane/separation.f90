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
  public :: axis_t, measure_axis, rounding_of

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
