!> Largest and lowest values of lists of any length, with the value sought at any place.
program test_extremes
  use, intrinsic :: ieee_arithmetic, only: ieee_invalid, ieee_quiet_nan, ieee_set_flag, &
                                           ieee_set_halting_mode, ieee_value
  use harness, only: tests_t
  use sg_extremes, only: largest_magnitude, lowest_value
  use sg_kinds, only: wp
  use sg_random, only: random_t
  implicit none
  type(tests_t) :: t

  call test_places()
  call test_ends()
  call t%finish()

contains

  !> The same as the compiler's own, exactly: all lengths up to several rounds of lanes, the extreme value at each place in turn.
  subroutine test_places()
    type(random_t) :: random
    real(wp) :: values(70), kept
    integer :: n, i, wrong

    call random%seed(7)
    wrong = 0
    do n = 1, size(values)
      values(:n) = [(random%normal(), i=1, n)]
      do i = 1, n
        kept = values(i)
        values(i) = -10
        if (abs(largest_magnitude(n, values) - maxval(abs(values(:n)))) > 0) wrong = wrong + 1
        if (abs(lowest_value(n, values) - minval(values(:n))) > 0) wrong = wrong + 1
        values(i) = 20
        if (abs(largest_magnitude(n, values) - maxval(abs(values(:n)))) > 0) wrong = wrong + 1
        if (abs(lowest_value(n, values) - minval(values(:n))) > 0) wrong = wrong + 1
        values(i) = kept
      end do
    end do
    call t%check(wrong == 0, 'as maxval and minval, wherever the value is')
  end subroutine test_places

  !> Lists without a value, and values that are not numbers or infinite.
  subroutine test_ends()
    real(wp) :: values(20)

    call t%near(largest_magnitude(0, values), 0.0_wp, 0.0_wp, 'nothing is largest in an empty list')
    call t%check(.not. lowest_value(0, values) < huge(1.0_wp), 'and nothing is lowest')
    ! Builds with checks stop where a value that is no number is compared.
    call ieee_set_halting_mode(ieee_invalid, .false.)
    values = 1
    values(3) = ieee_value(1.0_wp, ieee_quiet_nan)
    values(19) = ieee_value(1.0_wp, ieee_quiet_nan)
    values(20) = -2
    call t%near(largest_magnitude(20, values), 2.0_wp, 0.0_wp, 'what is no number is passed over')
    call t%near(lowest_value(20, values), -2.0_wp, 0.0_wp, 'for the lowest value too')
    ! The way of halting comes back with the end of this procedure, and would find the flag raised.
    call ieee_set_flag(ieee_invalid, .false.)
  end subroutine test_ends
end program test_extremes
