!> What the narrow phase finds for one pair of shapes: no, one or two points of contact.
!!
!! The kernels `touch_<candidate>_<antagonist>` turn numbers into this; see doc/theory/detection.md.
module sg_touch
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: touch_t, add_point, same_length

  !> Lengths that differ by less than this fraction of an edge are taken for equal: ten times above the rounding of
  !! coordinates in a scene 10^5 edges wide, far below any gap that matters
  real(wp), parameter :: same_length = 1e-10_wp

  !> Points of contact of one pair
  type :: touch_t
    !> Number of points: 0, 1 or 2
    integer :: n = 0
    !> Unit normals from antagonist to candidate, shape (2, point)
    real(wp) :: normal(2, 2) = 0
    !> Points half-way between the two facing surfaces, along the normal [m], shape (2, point)
    real(wp) :: point(2, 2) = 0
    !> Gaps [m], negative where the shapes overlap
    real(wp) :: gap(2) = 0
    !> Keys that distinguish the points of a pair, the same from step to step; 0 for disks
    integer(i4) :: feature(2) = 0
  end type touch_t

contains

  !> Add a point given by the candidate's surface point, when its gap is below the alert distance.
  pure subroutine add_point(touch, surface, normal, gap, alert, feature)
    type(touch_t), intent(inout) :: touch !! points so far
    real(wp), intent(in) :: surface(2) !! point of the candidate that faces the antagonist [m]
    real(wp), intent(in) :: normal(2) !! unit normal from antagonist to candidate
    real(wp), intent(in) :: gap !! [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    integer(i4), intent(in) :: feature !! key of the point within its pair

    if (gap >= alert) return
    touch%n = touch%n + 1
    touch%normal(:, touch%n) = normal
    touch%point(:, touch%n) = surface - 0.5_wp*gap*normal
    touch%gap(touch%n) = gap
    touch%feature(touch%n) = feature
  end subroutine add_point
end module sg_touch
