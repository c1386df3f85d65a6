!> Grains in space: random directions and orientations. The same seed gives the same grains.
module sg_space_generators
  use sg_kinds, only: wp, pi
  use sg_random, only: random_t
  implicit none
  private
  public :: random_direction, random_rotation

contains

  !> A random unit vector.
  function random_direction(random) result(direction)
    type(random_t), intent(inout) :: random !! stream of numbers
    real(wp) :: direction(3)
    real(wp) :: height, angle

    height = random%uniform(-1.0_wp, 1.0_wp)
    angle = random%uniform(0.0_wp, 2*pi)
    direction = [sqrt(max(0.0_wp, 1 - height**2))*[cos(angle), sin(angle)], height]
  end function random_direction

  !> A random orientation, all equally likely [Shoemake1992].
  function random_rotation(random) result(q)
    type(random_t), intent(inout) :: random !! stream of numbers
    real(wp) :: q(4)
    real(wp) :: share, first, second

    share = random%uniform()
    first = random%uniform(0.0_wp, 2*pi)
    second = random%uniform(0.0_wp, 2*pi)
    q = [sqrt(share)*[cos(second), sin(second)], sqrt(1 - share)*[sin(first), cos(first)]]
  end function random_rotation
end module sg_space_generators
