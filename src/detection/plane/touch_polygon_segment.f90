!> Contact of a convex polygon with a rounded segment (JONCx): the points within a half thickness of an axis.
module sg_touch_polygon_segment
  use sg_contactors, only: edges_of
  use sg_kinds, only: wp, i4
  use sg_touch, only: touch_t
  use sg_touch_convex, only: touch_convex
  implicit none
  private
  public :: touch_polygon_segment

contains

  !> Points of contact of a convex polygon with a rounded segment: its axis is a polygon of two vertices whose skin is
  !! a half thickness, so that flat sides and caps need no case of their own.
  pure subroutine touch_polygon_segment(n_c, vertices_c, edges_c, longest, centre_a, axis, half_length, half_thickness, alert, &
                                        kept, touch)
    integer, intent(in) :: n_c !! vertices of the polygon, the candidate
    real(wp), intent(in) :: vertices_c(2, n_c) !! vertices of the polygon, counter-clockwise [m]
    real(wp), intent(in) :: edges_c(3, n_c) !! normals and lengths of its edges, see `edges_of` [m]
    real(wp), intent(in) :: longest !! no edge of it is longer [m]
    real(wp), intent(in) :: centre_a(2) !! centre of the segment, the antagonist [m]
    real(wp), intent(in) :: axis(2) !! unit vector of the segment's axis
    real(wp), intent(in) :: half_length !! half length of the axis [m]
    real(wp), intent(in) :: half_thickness !! radius of the caps [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    integer(i4), intent(inout) :: kept !! face to try first, see `touch_convex`
    type(touch_t), intent(out) :: touch !! one point, or two where an edge faces a flat side
    real(wp) :: ends(2, 2), sides(3, 2)

    ends(:, 1) = -half_length*axis
    ends(:, 2) = half_length*axis
    call edges_of(2, ends, sides)
    call touch_convex(n_c, vertices_c, edges_c, 2, ends, sides, max(longest, 2*half_length), centre_a, &
                      half_thickness, alert, kept, touch)
  end subroutine touch_polygon_segment
end module sg_touch_polygon_segment
