!> Contact of two disks.
module sg_touch_disk_disk
  use sg_kinds, only: wp, i4
  use sg_touch, only: touch_t, add_point
  implicit none
  private
  public :: touch_disk_disk

contains

  !> Contact of two disks; where the centres coincide, the normal is that of the x axis.
  pure subroutine touch_disk_disk(centre_c, radius_c, centre_a, radius_a, alert, touch)
    real(wp), intent(in) :: centre_c(2) !! centre of the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the candidate [m]
    real(wp), intent(in) :: centre_a(2) !! centre of the antagonist [m]
    real(wp), intent(in) :: radius_a !! radius of the antagonist [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_t), intent(out) :: touch !! at most one point
    real(wp) :: between(2), distance2, distance, normal(2)

    between = centre_c - centre_a
    distance2 = between(1)**2 + between(2)**2
    if (distance2 >= max(0.0_wp, radius_c + radius_a + alert)**2) return
    distance = sqrt(distance2)
    normal = [1.0_wp, 0.0_wp]
    if (distance2 > tiny(distance2)) normal = between/distance
    call add_point(touch, centre_c - radius_c*normal, normal, distance - (radius_c + radius_a), alert, 0_i4)
  end subroutine touch_disk_disk
end module sg_touch_disk_disk
