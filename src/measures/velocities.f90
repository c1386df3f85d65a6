!> Speeds of the grains: mean and largest.
module sg_velocities
  use sg_bodies, only: bodies_t
  use sg_grains, only: grains_of, grains_t
  use sg_kinds, only: wp
  use sg_tally, only: pass_columns, pass_largest, ratio, tally_t
  implicit none
  private
  public :: measure_velocities

contains

  !> Mean and largest speed [m/s].
  pure subroutine measure_velocities(bodies, tally)
    type(bodies_t), intent(in) :: bodies !! bodies with their velocities
    type(tally_t), intent(inout) :: tally !! tally of the measure
    type(grains_t) :: grains
    real(wp) :: speed, total(1), largest(1)
    integer :: i

    if (tally%pass == pass_largest) then
      total = 0
      largest = 0
      do i = 1, bodies%n_own
        if (.not. bodies%is_grain(i)) cycle
        speed = norm2(bodies%velocity(:bodies%dimension, i))
        total = total + speed
        largest = max(largest, speed)
      end do
      call tally%sums%put('speed', total)
      call tally%largest%put('speed', largest)
    else if (tally%pass == pass_columns) then
      grains = grains_of(tally)
      total = tally%sums%get('speed', 1)
      largest = tally%largest%get('speed', 1)
      call tally%add('mean_velocity', ratio(total(1), real(grains%n, wp)))
      call tally%add('max_velocity', largest(1))
    end if
  end subroutine measure_velocities
end module sg_velocities
