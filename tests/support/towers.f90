!> Towers of grains of 1 kg, one above the other on a common floor, that fall by 1 m/s: contact k of a tower of n carries
!! n - k + 1 N s. A tall tower takes thousands of sweeps, short ones a few.
module towers
  use sg_kinds, only: wp
  use sg_problem, only: problem_t, reserve_problem
  use sg_records, only: round_frictionless, round_frictionless_inverse_wnn, velocity_x, velocity_y
  implicit none
  private
  public :: make_towers

contains

  !> Towers of so many grains on one floor, which is body 1: bodies and contacts tower by tower, upwards.
  subroutine make_towers(heights, problem, spare)
    integer, intent(in) :: heights(:) !! grains of each tower
    type(problem_t), intent(out) :: problem !! without impulses
    integer, intent(in) :: spare !! bodies more, of 1 kg, that fall as fast and touch nothing
    integer :: tower, floor, k

    call reserve_problem(problem, round_frictionless, sum(heights) + 1 + spare, sum(heights))
    problem%velocity_scale = 1
    problem%free_norm = sqrt(real(size(heights), wp))
    problem%impulse = 0
    problem%body = 1
    problem%body(velocity_x, :) = 0
    problem%body(velocity_y, :) = -1
    problem%body(:, 1) = 0
    k = 0
    do tower = 1, size(heights)
      do floor = 1, heights(tower)
        k = k + 1
        problem%pair(:, k) = [k + 1, k]
        problem%record(:, k) = [0.0_wp, 1.0_wp, 0.0_wp, 0.5_wp]
        if (floor > 1) cycle
        problem%pair(2, k) = 1
        problem%record(round_frictionless_inverse_wnn, k) = 1
      end do
    end do
  end subroutine make_towers
end module towers
