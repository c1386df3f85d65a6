!> Contact of two spheres.
module sg_touch_sphere_sphere
  use sg_kinds, only: wp, i4
  use sg_touch_space, only: touch_space_t, add_space_point
  implicit none
  private
  public :: touch_sphere_sphere

contains

  !> Contact of two spheres; where the centres coincide, the normal is that of the z axis.
  pure subroutine touch_sphere_sphere(centre_c, radius_c, centre_a, radius_a, alert, touch)
    real(wp), intent(in) :: centre_c(3) !! centre of the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the candidate [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the antagonist [m]
    real(wp), intent(in) :: radius_a !! radius of the antagonist [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_space_t), intent(out) :: touch !! at most one point
    real(wp) :: between(3), distance2, distance, normal(3)

    between = centre_c - centre_a
    distance2 = between(1)**2 + between(2)**2 + between(3)**2
    if (distance2 >= max(0.0_wp, radius_c + radius_a + alert)**2) return
    distance = sqrt(distance2)
    normal = [0.0_wp, 0.0_wp, 1.0_wp]
    if (distance2 > tiny(distance2)) normal = between/distance
    call add_space_point(touch, centre_c - radius_c*normal, normal, distance - (radius_c + radius_a), alert, 0_i4)
  end subroutine touch_sphere_sphere
end module sg_touch_sphere_sphere
