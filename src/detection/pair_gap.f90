!> Gap of a pair of shapes: the least of its points of contact.
module sg_pair_gap
  use sg_kinds, only: wp, i4
  use sg_scene, only: image_shift, scene_t
  use sg_touch, only: touch_t
  use sg_touch_pair, only: touch_pair
  use sg_touch_space, only: touch_space_t
  use sg_touch_space_pair, only: touch_space_pair
  implicit none
  private
  public :: pair_gap

contains

  !> Gap of two shapes that overlap [m], negative, along the way by which contacts push them apart; huge where they do not overlap.
  pure real(wp) function pair_gap(scene, pair, image) result(gap)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    integer(i4), intent(in) :: pair(2) !! candidate and antagonist
    integer(i4), intent(in) :: image(:) !! periods along x, y and, if given, z by which the antagonist is moved
    type(touch_t) :: touch
    type(touch_space_t) :: touch_space
    real(wp) :: period(2), offset(3)
    integer :: all(3)

    period = [scene%period, scene%period_y]
    all = 0
    all(:size(image)) = image
    offset = image_shift(scene, all)
    if (scene%dimension == 2) then
      call touch_pair(scene%contactors, pair(1), pair(2), offset(:2), 0.0_wp, touch, period(1))
      gap = minval(touch%gap(:touch%n))
    else
      call touch_space_pair(scene%contactors, pair(1), pair(2), offset, 0.0_wp, period, touch_space)
      gap = minval(touch_space%gap(:touch_space%n))
    end if
  end function pair_gap
end module sg_pair_gap
