!> Contact of a disk with a rounded segment (JONCx): the points within a half thickness of an axis.
module sg_touch_disk_segment
  use sg_kinds, only: wp, i4
  use sg_touch, only: touch_t, add_point
  implicit none
  private
  public :: touch_disk_segment

contains

  !> Contact of a disk with the flat side or the round cap that is nearest to its centre.
  !!
  !! The flat side keeps the exact normal of the axis. A centre on the axis is pushed to the left of the axis, one on
  !! an end of it along the axis.
  pure subroutine touch_disk_segment(centre_c, radius_c, centre_a, axis, half_length, half_thickness, alert, touch)
    real(wp), intent(in) :: centre_c(2) !! centre of the disk, the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the disk [m]
    real(wp), intent(in) :: centre_a(2) !! centre of the segment, the antagonist [m]
    real(wp), intent(in) :: axis(2) !! unit vector of the segment's axis
    real(wp), intent(in) :: half_length !! half length of the axis [m]
    real(wp), intent(in) :: half_thickness !! radius of the caps [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_t), intent(out) :: touch !! at most one point
    real(wp) :: between(2), along, across, distance, normal(2)

    between = centre_c - centre_a
    along = axis(1)*between(1) + axis(2)*between(2)
    across = axis(1)*between(2) - axis(2)*between(1)
    if (abs(across) - (radius_c + half_thickness) >= alert) return
    if (abs(along) < half_length) then
      distance = abs(across)
      normal = sign(1.0_wp, across)*[-axis(2), axis(1)]
    else
      between = between - sign(half_length, along)*axis
      distance = sqrt(between(1)**2 + between(2)**2)
      normal = sign(1.0_wp, along)*axis
      if (distance > tiny(distance)) normal = between/distance
    end if
    call add_point(touch, centre_c - radius_c*normal, normal, distance - (radius_c + half_thickness), alert, 0_i4)
  end subroutine touch_disk_segment
end module sg_touch_disk_segment
