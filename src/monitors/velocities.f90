!> Speeds of the grains: mean and largest.
module sg_velocities
  use sg_bodies, only: bodies_t
  use sg_kinds, only: wp
  implicit none
  private
  public :: speeds

contains

  !> Mean and largest speed of the grains' centres [m/s]; zero without grains.
  pure subroutine speeds(bodies, mean, largest)
    type(bodies_t), intent(in) :: bodies !! bodies with their velocities
    real(wp), intent(out) :: mean !! mean speed [m/s]
    real(wp), intent(out) :: largest !! largest speed [m/s]
    real(wp) :: speed
    integer :: i, n

    mean = 0
    largest = 0
    n = 0
    do i = 1, bodies%n
      if (.not. bodies%is_grain(i)) cycle
      n = n + 1
      speed = norm2(bodies%velocity(:bodies%dimension, i))
      mean = mean + speed
      largest = max(largest, speed)
    end do
    if (n > 0) mean = mean/real(n, wp)
  end subroutine speeds
end module sg_velocities
