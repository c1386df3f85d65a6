!> Nearest points of two convex polyhedra that are apart, by the walk of Gilbert, Johnson and Keerthi.
!!
!! The points c - a of two bodies form a convex body too, D, whose point nearest to the origin is the shortest way from
!! A to C. The walk holds a simplex of D's vertices; the vertex of D that lies farthest against the simplex's nearest
!! point v joins it. Each direction v measured gives a lower bound s(v) of the distance, so that pairs out of reach
!! end at once, mostly at the first direction; |v| is an upper bound.
module sg_polyhedra_apart
  use sg_kinds, only: wp
  use sg_nearest_simplex, only: reduce_simplex, simplex_t
  use sg_polyhedron, only: polyhedron_t
  use sg_separation, only: axis_t, measure_axis
  implicit none
  private
  public :: walk_apart

  !> Steps after which the walk gives up: it takes about six, and thirty on slivers
  integer, parameter :: most_steps = 100

contains

  !> Find the axis of greatest separation, or one beyond `alert`, or that there is none because the shapes overlap.
  pure subroutine walk_apart(c, a, offset, alert, rounding, start, axis, distance)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    real(wp), intent(in) :: alert !! separation from which the walk may stop [m]
    real(wp), intent(in) :: rounding !! distance that is none [m]
    real(wp), intent(in) :: start(3) !! unit normal to start with
    type(axis_t), intent(out) :: axis !! the axis of greatest separation met
    real(wp), intent(out) :: distance !! upper bound of the distance, its value to rounding [m]; 0 where the shapes overlap
    type(simplex_t) :: simplex, last
    type(axis_t) :: trial
    real(wp) :: way(3), normal(3), length
    logical :: is_inside
    integer :: step, k

    normal = start
    distance = huge(distance)
    do step = 1, most_steps
      call measure_axis(c, a, offset, normal, trial)
      if (trial%separation > axis%separation) axis = trial
      if (axis%separation >= alert .or. distance - trial%separation <= 1e-4_wp*rounding) exit
      do k = 1, simplex%n
        if (simplex%vertex(1, k) == trial%vertex_c .and. simplex%vertex(2, k) == trial%vertex_a) exit
      end do
      if (k <= simplex%n) exit
      last = simplex
      simplex%n = simplex%n + 1
      simplex%vertex(:, simplex%n) = [trial%vertex_c, trial%vertex_a]
      simplex%point(:, simplex%n) = (c%world_vertex(:, trial%vertex_c) - a%world_vertex(:, trial%vertex_a)) - offset
      call reduce_simplex(simplex, way, is_inside)
      if (is_inside .or. dot_product(way, way) <= rounding**2) then
        distance = 0
        return
      end if
      length = sqrt(dot_product(way, way))
      if (length >= distance) then
        simplex = last
        exit
      end if
      distance = length
      normal = way/distance
    end do
    do k = 1, simplex%n
      axis%surface = axis%surface + simplex%weight(k)*c%world_vertex(:, simplex%vertex(1, k))
    end do
  end subroutine walk_apart
end module sg_polyhedra_apart
