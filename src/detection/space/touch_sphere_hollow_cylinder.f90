!> Contact of a sphere with the inside of a hollow cylinder (DNLYC), which is open at its ends.
module sg_touch_sphere_hollow_cylinder
  use sg_kinds, only: wp, i4
  use sg_touch_axis, only: from_line
  use sg_touch_space, only: touch_space_t, add_space_point
  implicit none
  private
  public :: touch_sphere_hollow_cylinder

contains

  !> Contact of a sphere with the wall around it, whose normal points inwards.
  !!
  !! A sphere whose centre is beyond the ends does not touch; one beyond the wall is pushed back in. A centre on the
  !! axis is pushed perpendicular to it.
  pure subroutine touch_sphere_hollow_cylinder(centre_c, radius_c, centre_a, axis, half_height, radius_a, alert, touch)
    real(wp), intent(in) :: centre_c(3) !! centre of the sphere, the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the sphere [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the hollow cylinder, the antagonist [m]
    real(wp), intent(in) :: axis(3) !! unit vector of its axis
    real(wp), intent(in) :: half_height !! half its height [m]
    real(wp), intent(in) :: radius_a !! its inner radius [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_space_t), intent(out) :: touch !! at most one point
    real(wp) :: between(3), across(3), along, outward(3), distance

    between = centre_c - centre_a
    along = axis(1)*between(1) + axis(2)*between(2) + axis(3)*between(3)
    if (abs(along) > half_height) return
    across = between - along*axis
    if (across(1)**2 + across(2)**2 + across(3)**2 < max(0.0_wp, radius_a - radius_c - alert)**2) return
    call from_line(between, axis, outward, distance)
    call add_space_point(touch, centre_c + radius_c*outward, -outward, radius_a - radius_c - distance, alert, 0_i4)
  end subroutine touch_sphere_hollow_cylinder
end module sg_touch_sphere_hollow_cylinder
