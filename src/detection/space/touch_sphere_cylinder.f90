!> Contact of a sphere with a cylinder with round ends (CYLND): the points within a radius of an axis.
module sg_touch_sphere_cylinder
  use sg_kinds, only: wp, i4
  use sg_touch_axis, only: from_axis
  use sg_touch_space, only: touch_space_t, add_space_point
  implicit none
  private
  public :: touch_sphere_cylinder

contains

  !> Contact of a sphere with the round side or the cap that is nearest to its centre.
  !!
  !! A centre on the axis is pushed out perpendicular to it, one on an end along it.
  pure subroutine touch_sphere_cylinder(centre_c, radius_c, centre_a, axis, half_height, radius_a, alert, touch)
    real(wp), intent(in) :: centre_c(3) !! centre of the sphere, the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the sphere [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the cylinder, the antagonist [m]
    real(wp), intent(in) :: axis(3) !! unit vector of the cylinder's axis
    real(wp), intent(in) :: half_height !! half length of the axis, caps not counted [m]
    real(wp), intent(in) :: radius_a !! radius of the cylinder [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_space_t), intent(out) :: touch !! at most one point
    real(wp) :: between(3), along, reach, normal(3), distance

    between = centre_c - centre_a
    along = axis(1)*between(1) + axis(2)*between(2) + axis(3)*between(3)
    reach = max(0.0_wp, radius_c + radius_a + alert)
    if (abs(along) - half_height >= reach) return
    if (between(1)**2 + between(2)**2 + between(3)**2 >= (half_height + reach)**2) return
    call from_axis(between, axis, half_height, normal, distance)
    call add_space_point(touch, centre_c - radius_c*normal, normal, distance - (radius_c + radius_a), alert, 0_i4)
  end subroutine touch_sphere_cylinder
end module sg_touch_sphere_cylinder
