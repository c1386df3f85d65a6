!> Contact of a cylinder with round ends (CYLND) with the inside of a hollow cylinder (DNLYC).
module sg_touch_cylinder_hollow
  use sg_kinds, only: wp, i4
  use sg_touch_axis, only: clip_to_slab, from_line
  use sg_touch_space, only: touch_space_t, add_space_point
  implicit none
  private
  public :: touch_cylinder_hollow

  !> Points of the axis nearer to each other than this, in radii, are one
  real(wp), parameter :: same_point = 1e-6_wp

contains

  !> Contact of the two ends of the part of the axis between the open ends of the hollow cylinder.
  !!
  !! The distance from the hollow cylinder's axis is convex along the other axis, so that it is largest, and the gap
  !! least, at these ends. The features are 1 for the end on the negative side of the own axis and 2 for the other.
  pure subroutine touch_cylinder_hollow(centre_c, axis_c, half_height_c, radius_c, centre_a, axis_a, half_height_a, radius_a, &
                                        alert, touch)
    real(wp), intent(in) :: centre_c(3) !! centre of the cylinder, the candidate [m]
    real(wp), intent(in) :: axis_c(3) !! unit vector of its axis
    real(wp), intent(in) :: half_height_c !! half length of its axis, caps not counted [m]
    real(wp), intent(in) :: radius_c !! its radius [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the hollow cylinder, the antagonist [m]
    real(wp), intent(in) :: axis_a(3) !! unit vector of its axis
    real(wp), intent(in) :: half_height_a !! half its height [m]
    real(wp), intent(in) :: radius_a !! its inner radius [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_space_t), intent(out) :: touch !! at most two points
    real(wp) :: between(3), s(2), outward(3), distance
    integer :: i

    between = centre_c - centre_a
    s = [-half_height_c, half_height_c]
    call clip_to_slab(dot_product(axis_a, between), dot_product(axis_a, axis_c), half_height_a, s(1), s(2))
    if (s(1) > s(2)) return
    do i = 1, 2
      if (i == 2 .and. s(2) - s(1) <= same_point*radius_c) exit
      call from_line(between + s(i)*axis_c, axis_a, outward, distance)
      call add_space_point(touch, centre_c + s(i)*axis_c + radius_c*outward, -outward, radius_a - radius_c - distance, alert, &
                           int(i, i4))
    end do
  end subroutine touch_cylinder_hollow
end module sg_touch_cylinder_hollow
