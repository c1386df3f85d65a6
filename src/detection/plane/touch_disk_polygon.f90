!> Contact of a disk with a convex polygon.
module sg_touch_disk_polygon
  use sg_kinds, only: wp, i4
  use sg_touch, only: touch_t, add_point, same_length
  implicit none
  private
  public :: touch_disk_polygon

contains

  !> Contact of a disk with the edge or the vertex that is nearest to its centre; a centre inside the polygon is pushed
  !! out through the nearest edge.
  pure subroutine touch_disk_polygon(centre_c, radius_c, n_a, vertices_a, offset_a, alert, touch)
    real(wp), intent(in) :: centre_c(2) !! centre of the disk, the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the disk [m]
    integer, intent(in) :: n_a !! vertices of the polygon
    real(wp), intent(in) :: vertices_a(2, n_a) !! vertices of the polygon, the antagonist, counter-clockwise [m]
    real(wp), intent(in) :: offset_a(2) !! added to the polygon's vertices (its periodic image) [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_t), intent(out) :: touch !! at most one point
    real(wp) :: centre(2), edge(2), between(2), normal(2), vertex(2), along, beyond, length, height, best
    integer :: i, next

    centre = centre_c - offset_a
    best = -huge(best)
    beyond = 0
    vertex = 0
    do i = 1, n_a
      next = merge(1, i + 1, i == n_a)
      edge = vertices_a(:, next) - vertices_a(:, i)
      length = sqrt(edge(1)**2 + edge(2)**2)
      if (length <= tiny(length)) cycle
      edge = edge/length
      between = centre - vertices_a(:, i)
      height = edge(2)*between(1) - edge(1)*between(2)
      if (height <= best + same_length*length) cycle
      if (height - radius_c >= alert) return
      best = height
      normal = [edge(2), -edge(1)]
      along = edge(1)*between(1) + edge(2)*between(2)
      vertex = vertices_a(:, merge(i, next, along < 0.5_wp*length))
      beyond = max(-along, along - length) - same_length*length
    end do
    if (best <= -huge(best)) return
    if (best > 0 .and. beyond > 0) then
      ! Beyond the end of the highest edge: the vertex there is the nearest point.
      between = centre - vertex
      best = sqrt(between(1)**2 + between(2)**2)
      normal = between/best
    end if
    call add_point(touch, centre_c - radius_c*normal, normal, best - radius_c, alert, 0_i4)
  end subroutine touch_disk_polygon
end module sg_touch_disk_polygon
