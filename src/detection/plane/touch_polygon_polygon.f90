!> Contact of two convex polygons.
module sg_touch_polygon_polygon
  use sg_kinds, only: wp
  use sg_touch, only: touch_t
  use sg_touch_convex, only: touch_convex
  implicit none
  private
  public :: touch_polygon_polygon

contains

  !> Points of contact of two convex polygons whose vertices turn counter-clockwise.
  pure subroutine touch_polygon_polygon(n_c, vertices_c, n_a, vertices_a, offset_a, alert, touch)
    integer, intent(in) :: n_c !! vertices of the candidate
    real(wp), intent(in) :: vertices_c(2, n_c) !! candidate's vertices [m]
    integer, intent(in) :: n_a !! vertices of the antagonist
    real(wp), intent(in) :: vertices_a(2, n_a) !! antagonist's vertices [m]
    real(wp), intent(in) :: offset_a(2) !! added to the antagonist's vertices (its periodic image) [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_t), intent(out) :: touch !! one point, or two where edges face each other

    call touch_convex(n_c, vertices_c, n_a, vertices_a, offset_a, 0.0_wp, alert, touch)
  end subroutine touch_polygon_polygon
end module sg_touch_polygon_polygon
