!> Contact of two convex polygons.
module sg_touch_polygon_polygon
  use sg_kinds, only: wp, i4
  use sg_touch, only: touch_t
  use sg_touch_convex, only: touch_convex
  implicit none
  private
  public :: touch_polygon_polygon

contains

  !> Points of contact of two convex polygons whose vertices turn counter-clockwise.
  pure subroutine touch_polygon_polygon(n_c, vertices_c, edges_c, n_a, vertices_a, edges_a, longest, offset_a, alert, kept, touch, &
                                        clearance)
    integer, intent(in) :: n_c !! vertices of the candidate
    real(wp), intent(in) :: vertices_c(2, n_c) !! candidate's vertices [m]
    real(wp), intent(in) :: edges_c(3, n_c) !! normals and lengths of its edges, see `edges_of` [m]
    integer, intent(in) :: n_a !! vertices of the antagonist
    real(wp), intent(in) :: vertices_a(2, n_a) !! antagonist's vertices [m]
    real(wp), intent(in) :: edges_a(3, n_a) !! normals and lengths of its edges [m]
    real(wp), intent(in) :: longest !! no edge of either is longer [m]
    real(wp), intent(in) :: offset_a(2) !! added to the antagonist's vertices (its periodic image) [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    integer(i4), intent(inout) :: kept !! face to try first, see `touch_convex`
    type(touch_t), intent(out) :: touch !! one point, or two where edges face each other
    real(wp), intent(out), optional :: clearance !! their distance or less [m]

    call touch_convex(n_c, vertices_c, edges_c, n_a, vertices_a, edges_a, longest, offset_a, 0.0_wp, alert, kept, touch, clearance)
  end subroutine touch_polygon_polygon
end module sg_touch_polygon_polygon
