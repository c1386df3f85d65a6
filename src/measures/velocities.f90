!> Speeds of the grains: mean and largest.
module sg_velocities
  use sg_bodies, only: bodies_t
  use sg_kinds, only: wp
  implicit none
  private
  public :: speed_sums

contains

  !> Sum of the speeds of this rank's grains and the largest of them [m/s].
  pure subroutine speed_sums(bodies, total, largest)
    type(bodies_t), intent(in) :: bodies !! bodies with their velocities
    real(wp), intent(out) :: total !! sum of the speeds [m/s]
    real(wp), intent(out) :: largest !! largest speed [m/s]
    real(wp) :: speed
    integer :: i

    total = 0
    largest = 0
    do i = 1, bodies%n_home
      if (.not. bodies%is_grain(i)) cycle
      speed = norm2(bodies%velocity(:bodies%dimension, i))
      total = total + speed
      largest = max(largest, speed)
    end do
  end subroutine speed_sums
end module sg_velocities
