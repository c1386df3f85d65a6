!> Areas that disks and convex polygons share with rounded segments (JONCx), flat sides and caps alike exact.
module sg_overlap_segments
  use sg_kinds, only: wp
  use sg_overlap_outline, only: add_cap, add_edge, close_outline, outline_t
  use sg_overlap_polygons, only: clip, overlap_disk_polygon, overlap_polygon_polygon
  implicit none
  private
  public :: overlap_disk_segment, overlap_polygon_segment

contains

  !> Area shared by a disk and a rounded segment [m2].
  pure real(wp) function overlap_disk_segment(centre_c, radius_c, centre_a, axis, half_length, half_thickness) result(area)
    real(wp), intent(in) :: centre_c(2) !! centre of the disk, the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the disk [m]
    real(wp), intent(in) :: centre_a(2) !! centre of the segment, the antagonist [m]
    real(wp), intent(in) :: axis(2) !! unit vector of the segment's axis
    real(wp), intent(in) :: half_length !! half length of the axis [m]
    real(wp), intent(in) :: half_thickness !! radius of the caps [m]
    type(outline_t) :: outline
    real(wp) :: start(2), end(2), up(2), along, across, beyond
    logical :: is_centre_inside

    start = centre_a - half_length*axis - centre_c
    end = centre_a + half_length*axis - centre_c
    up = half_thickness*[-axis(2), axis(1)]
    call add_edge(outline, radius_c, start - up, end - up)
    call add_cap(outline, radius_c, end, axis, half_thickness)
    call add_edge(outline, radius_c, end + up, start + up)
    call add_cap(outline, radius_c, start, -axis, half_thickness)
    along = dot_product(axis, centre_c - centre_a)
    across = axis(1)*(centre_c(2) - centre_a(2)) - axis(2)*(centre_c(1) - centre_a(1))
    beyond = max(0.0_wp, abs(along) - half_length)
    is_centre_inside = across**2 + beyond**2 <= half_thickness**2
    call close_outline(outline, radius_c, is_centre_inside, area)
  end function overlap_disk_segment

  !> Area shared by a convex polygon and a rounded segment [m2]: with its rectangle, and beyond either end of its axis
  !! with its cap.
  pure real(wp) function overlap_polygon_segment(n_c, vertices_c, centre_a, axis, half_length, half_thickness) result(area)
    integer, intent(in) :: n_c !! vertices of the polygon, the candidate
    real(wp), intent(in) :: vertices_c(2, n_c) !! vertices of the polygon, counter-clockwise [m]
    real(wp), intent(in) :: centre_a(2) !! centre of the segment, the antagonist [m]
    real(wp), intent(in) :: axis(2) !! unit vector of the segment's axis
    real(wp), intent(in) :: half_length !! half length of the axis [m]
    real(wp), intent(in) :: half_thickness !! radius of the caps [m]
    real(wp) :: along(2), up(2), box(2, 4), beyond(2, n_c + 1), zero(2)
    integer :: n, side

    zero = 0
    along = half_length*axis
    up = half_thickness*[-axis(2), axis(1)]
    box(:, 1) = -along - up
    box(:, 2) = along - up
    box(:, 3) = along + up
    box(:, 4) = -along + up
    area = 0
    if (half_length > 0) area = overlap_polygon_polygon(n_c, vertices_c, 4, box, centre_a)
    do side = -1, 1, 2
      n = n_c
      beyond(:, :n) = vertices_c
      associate (end => centre_a + real(side, wp)*along)
        call clip(n, beyond, end, -real(side, wp)*axis)
        if (n > 2) area = area + overlap_disk_polygon(end, half_thickness, n, beyond(:, :n), zero)
      end associate
    end do
  end function overlap_polygon_segment
end module sg_overlap_segments
