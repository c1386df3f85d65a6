!> Histories of tests: the estimated error of sequences whose error is known, plain and with momentum, and the next test.
program test_check_history
  use harness, only: tests_t
  use sg_check_history, only: check_history_t
  use sg_kinds, only: wp
  use sg_nesterov_rule, only: nesterov_rule_t
  implicit none
  type(tests_t) :: t

  call test_plain()
  call test_columns()
  call test_even_gaps()
  call test_next()
  call t%finish()

contains

  !> One mode that plain sweeps shrink by 1 - delta: e8 is delta times its error, which the estimate finds.
  subroutine test_plain()
    type(check_history_t) :: history
    real(wp), parameter :: delta = 1e-3_wp
    real(wp) :: error
    integer :: k

    do k = 20, 4000, 20
      error = (1 - delta)**k
      call history%add(k, real(k, wp), delta*error)
    end do
    ! It is taken to fall in the 4000 sweeps done, four times as many as it does.
    call t%near(history%estimate(0.0_wp)/error, 4.0_wp, 1e-12_wp, 'one mode, many sweeps: no faster than the sweeps done')
    history%n = 10
    error = (1 - delta)**200
    call t%near(history%estimate(0.0_wp)/error, 1.0_wp, 1e-2_wp, 'one mode, few sweeps: its rate')
  end subroutine test_plain

  !> Columns of grains from no impulses, mode by mode, plain and with momentum, tested every 10 sweeps: where the estimate ends the
  !! sweeps, the error is within twice of it, as for packings (doc/theory/errors.md); and momentum takes fewer sweeps.
  subroutine test_columns()
    integer, parameter :: heights(3) = [20, 40, 80]
    real(wp) :: error(2), estimate(2)
    integer :: sweeps(2), i

    do i = 1, size(heights)
      call solve_column(heights(i), .false., sweeps(1), error(1), estimate(1))
      call solve_column(heights(i), .true., sweeps(2), error(2), estimate(2))
      call t%check(all(estimate <= 2e-2_wp), 'column: the estimate is reached')
      call t%check(all(error <= 2*estimate), 'column: the error is within twice the estimate')
      call t%check(sweeps(2) < sweeps(1)/2, 'column: momentum takes less than half the sweeps')
    end do
  end subroutine test_columns

  !> Sweeps over a column of n grains: modes of the Delassus matrix with 2 on the diagonal, -1 next to it and 1 at the floor. Each
  !! sweep takes the share `rate` of the error of a mode; impulses grow linearly with depth.
  subroutine solve_column(n, has_momentum, sweeps, error, estimate)
    integer, intent(in) :: n
    logical, intent(in) :: has_momentum
    integer, intent(out) :: sweeps
    real(wp), intent(out) :: error, estimate
    type(check_history_t) :: history
    type(nesterov_rule_t) :: rule
    real(wp), parameter :: pi = acos(-1.0_wp)
    real(wp) :: rate(n), goal(n), x(n), last(n), start(n), sums(2), share
    integer :: i, j

    do j = 1, n
      associate (angle => real(2*j - 1, wp)*pi/real(2*n + 1, wp))
        rate(j) = sin(angle/2)**2
        goal(j) = sqrt(4/real(2*n + 1, wp))*sum([(real(i, wp)*sin(angle*real(i, wp)), i=1, n)])
      end associate
    end do
    x = 0
    start = 0
    do sweeps = 1, 100000
      last = x
      x = start + rate*(goal - start)
      sums = [sum((x - start)**2), sum((x - start)*(x - last))]
      share = 0
      if (has_momentum) call rule%next(sums, .true., share)
      start = x + share*(x - last)
      if (modulo(sweeps, 10) /= 0) cycle
      call history%add(sweeps, real(sweeps, wp) + rule%gain, norm2(rate*(goal - x))/norm2(x))
      estimate = history%estimate(merge(1.0_wp, 0.0_wp, has_momentum))
      if (estimate <= 2e-2_wp) exit
    end do
    error = norm2(goal - x)/norm2(goal)
  end subroutine solve_column

  !> Tests every 20 sweeps and every 10: where e8 falls evenly, the estimate is the same.
  subroutine test_even_gaps()
    type(check_history_t) :: fine, coarse
    integer :: k

    do k = 10, 400, 10
      call fine%add(k, real(k, wp), exp(-2e-3_wp*real(k, wp)))
      if (modulo(k, 20) == 0) call coarse%add(k, real(k, wp), exp(-2e-3_wp*real(k, wp)))
    end do
    call t%near(fine%estimate(0.0_wp), coarse%estimate(0.0_wp), 1e-12_wp, 'the same estimate from twice as many tests')
    call t%check(.not. fine%has_not_fallen(40), 'e8 falls')
    call fine%add(410, 410.0_wp, 1.0_wp)
    call t%check(fine%has_not_fallen(40), 'e8 has risen')
    call t%check(.not. fine%has_not_fallen(500), 'no test lies so far back')
  end subroutine test_even_gaps

  !> The next test comes where an even fall ends, at least an eighth of the sweeps on, at most as many again.
  subroutine test_next()
    type(check_history_t) :: history
    integer :: first

    first = history%next_test(2.0_wp, huge(1.0_wp))
    call t%check(first >= 1 .and. first <= 20, 'first test')
    call history%add(100, 100.0_wp, 1.0_wp)
    call t%check(history%next_test(10.0_wp, huge(1.0_wp)) == 200, 'far off after one test: twice the sweeps')
    call t%check(history%next_test(1.6_wp, huge(1.0_wp)) == 127, 'near after one test: as sweeps to the second power')
    call history%add(200, 200.0_wp, 0.5_wp)
    call t%check(history%next_test(2.0_wp, 8.0_wp) == 250, 'an even fall: where it ends')
    call t%check(history%next_test(1.01_wp, 8.0_wp) == 225, 'nearly there: an eighth of the sweeps')
    call t%check(history%next_test(8.0_wp, 8.0_wp) == 400, 'no fall: twice the sweeps')
    call t%check(history%next_test(8.0_wp, 8.1_wp) == 400, 'hardly a fall: twice the sweeps')
  end subroutine test_next
end program test_check_history
