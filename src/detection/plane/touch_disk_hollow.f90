!> Contact of a disk with the hollow disk (xKSID) around it.
module sg_touch_disk_hollow
  use sg_kinds, only: wp, i4
  use sg_touch, only: touch_t, add_point
  implicit none
  private
  public :: touch_disk_hollow

contains

  !> Contact of a disk with the inside of a hollow disk; where the centres coincide, the normal is that of the x axis.
  pure subroutine touch_disk_hollow(centre_c, radius_c, centre_a, radius_a, alert, touch)
    real(wp), intent(in) :: centre_c(2) !! centre of the disk, the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the disk [m]
    real(wp), intent(in) :: centre_a(2) !! centre of the hollow disk, the antagonist [m]
    real(wp), intent(in) :: radius_a !! inner radius of the hollow disk [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_t), intent(out) :: touch !! at most one point; its normal points inwards
    real(wp) :: inwards(2), distance2, distance, near, normal(2)

    inwards = centre_a - centre_c
    distance2 = inwards(1)**2 + inwards(2)**2
    near = radius_a - radius_c - alert
    if (near >= 0 .and. distance2 <= near**2) return
    distance = sqrt(distance2)
    normal = [1.0_wp, 0.0_wp]
    if (distance2 > tiny(distance2)) normal = inwards/distance
    call add_point(touch, centre_c - radius_c*normal, normal, (radius_a - radius_c) - distance, alert, 0_i4)
  end subroutine touch_disk_hollow
end module sg_touch_disk_hollow
