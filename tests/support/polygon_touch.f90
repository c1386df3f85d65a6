!> Narrow phase of polygons given by their vertices alone: edges are found here.
module polygon_touch
  use sg_contactors, only: edges_of
  use sg_kinds, only: wp, i4
  use sg_touch, only: touch_t
  use sg_touch_polygon_polygon, only: touch_polygon_polygon
  use sg_touch_polygon_segment, only: touch_polygon_segment
  implicit none
  private
  public :: touching, touching_wall

contains

  !> Points of contact of two polygons without periodic image.
  function touching(c, a, alert, kept, clearance) result(touch)
    real(wp), intent(in) :: c(:, :) !! vertices of the candidate [m]
    real(wp), intent(in) :: a(:, :) !! vertices of the antagonist [m]
    real(wp), intent(in) :: alert !! [m]
    integer(i4), intent(inout), optional :: kept !! face to try first, none unless given
    real(wp), intent(out), optional :: clearance !! distance or less [m]
    type(touch_t) :: touch
    real(wp) :: edges_c(3, size(c, 2)), edges_a(3, size(a, 2))
    integer(i4) :: face

    face = 0
    if (present(kept)) face = kept
    call edges_of(size(c, 2), c, edges_c)
    call edges_of(size(a, 2), a, edges_a)
    call touch_polygon_polygon(size(c, 2), c, edges_c, size(a, 2), a, edges_a, max(maxval(edges_c(3, :)), maxval(edges_a(3, :))), &
                               [0.0_wp, 0.0_wp], alert, face, touch, clearance)
    if (present(kept)) kept = face
  end function touching

  !> Points of contact of a polygon and a wall.
  function touching_wall(c, centre, axis, half, alert, kept) result(touch)
    real(wp), intent(in) :: c(:, :) !! vertices of the polygon [m]
    real(wp), intent(in) :: centre(2) !! of the wall [m]
    real(wp), intent(in) :: axis(2) !! its unit vector
    real(wp), intent(in) :: half(2) !! its half length and half thickness [m]
    real(wp), intent(in) :: alert !! [m]
    integer(i4), intent(in), optional :: kept !! face to try first, none unless given
    type(touch_t) :: touch
    real(wp) :: edges_c(3, size(c, 2))
    integer(i4) :: face

    face = 0
    if (present(kept)) face = kept
    call edges_of(size(c, 2), c, edges_c)
    call touch_polygon_segment(size(c, 2), c, edges_c, maxval(edges_c(3, :)), centre, axis, half(1), half(2), alert, face, touch)
  end function touching_wall
end module polygon_touch
