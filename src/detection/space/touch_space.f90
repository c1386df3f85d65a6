!> What the narrow phase finds for one pair of shapes in space: up to four points of contact.
!!
!! The kernels `touch_<candidate>_<antagonist>` turn numbers into this; see doc/theory/detection_in_space.md.
module sg_touch_space
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: touch_space_t, add_space_point, most_points

  !> The most points of one pair
  integer, parameter :: most_points = 4

  !> Points of contact of one pair. Made for every pair that comes near, so nothing but `n` is set before there are points
  type :: touch_space_t
    !> Number of points
    integer :: n = 0
    !> Unit normals from antagonist to candidate, shape (3, point)
    real(wp) :: normal(3, most_points)
    !> Points half-way between the two facing surfaces, along the normal [m], shape (3, point)
    real(wp) :: point(3, most_points)
    !> Gaps [m], negative where the shapes overlap
    real(wp) :: gap(most_points)
    !> Keys that distinguish the points of a pair, the same from step to step; 0 where a pair has one point only
    integer(i4) :: feature(most_points)
  end type touch_space_t

contains

  !> Add a point given by the candidate's surface point, when its gap is below the alert distance.
  pure subroutine add_space_point(touch, surface, normal, gap, alert, feature)
    type(touch_space_t), intent(inout) :: touch !! points so far
    real(wp), intent(in) :: surface(3) !! point of the candidate that faces the antagonist [m]
    real(wp), intent(in) :: normal(3) !! unit normal from antagonist to candidate
    real(wp), intent(in) :: gap !! [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    integer(i4), intent(in) :: feature !! key of the point within its pair

    if (gap >= alert .or. touch%n == most_points) return
    touch%n = touch%n + 1
    touch%normal(:, touch%n) = normal
    touch%point(:, touch%n) = surface - 0.5_wp*gap*normal
    touch%gap(touch%n) = gap
    touch%feature(touch%n) = feature
  end subroutine add_space_point
end module sg_touch_space
