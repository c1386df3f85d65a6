!> Sweeps with momentum: they need as many sweeps as a column is high, where plain ones need its square; they end in the cones, at
!! the same impulses; and momentum does no harm where plain sweeps go round in circles or overshoot.
program test_block_nesterov
  use falling_column, only: make_column
  use harness, only: tests_t
  use sg_block_nesterov, only: block_nesterov_t
  use sg_block_nlgs, only: block_nlgs_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_nesterov_rule, only: nesterov_rule_t
  use sg_report, only: report_t
  use sg_text, only: to_text
  implicit none
  type(tests_t) :: tests
  integer :: d

  do d = 2, 3
    call sweeps_grow_as_the_height(d)
  end do
  call shares_follow_nesterov()
  call growth_restarts()
  call pauses_grow()
  call tests%finish()

contains

  !> Sweeps to an error of 1e-8 (e1) on columns each twice as high as the one before: four times as many without momentum, twice as
  !! many with it. The last ratios are compared: those of low columns are not yet near the limit.
  subroutine sweeps_grow_as_the_height(d)
    integer, intent(in) :: d
    integer, parameter :: bodies(4) = [10, 20, 40, 80]
    type(block_nlgs_t) :: nlgs
    type(block_nesterov_t) :: momentum
    type(matrix_problem_t) :: plain, pushed
    real(wp) :: sweeps(2, size(bodies))
    integer :: i

    do i = 1, size(bodies)
      call make_column(d, bodies(i), plain)
      pushed = plain
      call solve(nlgs, plain, sweeps(1, i))
      call solve(momentum, pushed, sweeps(2, i))
      ! e1 of 1e-8 leaves impulses 1/delta times as far from the answer, delta = (pi/2n)^2.
      call tests%near(maxval(abs(pushed%r - plain%r)), 0.0_wp, 2e-8_wp*real(bodies(i), wp)**2, 'same impulses, '// &
                       to_text(bodies(i))//' bodies')
      call tests%check(all(pushed%r(1, :) >= 0) .and. all(norm2(pushed%r(2:, :), 1) <= 0.3_wp*pushed%r(1, :) + 1e-15_wp), &
                       'impulses lie in their cones, '//to_text(bodies(i))//' bodies')
    end do
    associate (ratio => sweeps(:, 4)/sweeps(:, 3))
      call tests%near(ratio(1), 4.0_wp, 0.8_wp, 'plain sweeps grow as the square of the height, d = '//to_text(d))
      call tests%near(ratio(2), 2.0_wp, 0.4_wp, 'sweeps with momentum grow as the height, d = '//to_text(d))
    end associate
  end subroutine sweeps_grow_as_the_height

  !> Solve to 1e-8, and count the sweeps.
  subroutine solve(solver, problem, sweeps)
    class(matrix_solver_t), intent(inout) :: solver
    type(matrix_problem_t), intent(inout) :: problem
    real(wp), intent(out) :: sweeps
    type(report_t) :: report

    solver%options%tolerance = 1e-8_wp
    solver%options%maximum_iterations = 1000000
    call solver%solve(problem, report)
    call tests%check(report%is_converged, 'solved to 1e-8')
    sweeps = real(report%sweeps, wp)
  end subroutine solve

  !> While the change of a sweep falls, shares are those of Nesterov's sequence, up to their limit.
  subroutine shares_follow_nesterov()
    type(nesterov_rule_t) :: rule
    real(wp) :: t, next, share
    integer :: k

    t = 1
    do k = 1, 300
      next = (1 + sqrt(1 + 4*t**2))/2
      call rule%next([1/real(k, wp), 1.0_wp], .true., share)
      call tests%near(share, min((t - 1)/next, max(0.85_wp, 1 - (20/real(k, wp))**2)), 1e-15_wp, 'share of sweep '//to_text(k))
      t = next
    end do
  end subroutine shares_follow_nesterov

  !> A change that grows by more than 1.1 and a tenth of the changes that momentum is the sum of, or by more than 2, and one that
  !! points back restart; sums that are not known do not.
  subroutine growth_restarts()
    real(wp), parameter :: nothing = 0

    call tests%near(share_after([1.208_wp, 1.0_wp], .true.), share_after([1.0_wp, 1.0_wp], .true.), nothing, &
                    'grows less')
    call tests%near(share_after([1.212_wp, 1.0_wp], .true.), 0.0_wp, nothing, 'grows more')
    call tests%near(share_after([2.25_wp, 34.0_wp], .true.), share_after([1.0_wp, 1.0_wp], .true.), nothing, &
                    'grows to 1.5, less than a tenth of 15.1 changes')
    call tests%near(share_after([2.25_wp, 33.5_wp], .true.), 0.0_wp, nothing, 'grows to 1.5, more than a tenth of 14.9 changes')
    call tests%near(share_after([4.01_wp, 1e3_wp], .true.), 0.0_wp, nothing, 'more than doubles')
    call tests%near(share_after([1.0_wp, -1e-9_wp], .true.), 0.0_wp, nothing, 'points back')
    call tests%check(share_after([4.0_wp, -1.0_wp], .false.) > 0.5_wp, 'sums that are not known do not restart')
  end subroutine growth_restarts

  !> Share after ten sweeps with changes of 1, and one with these sums.
  real(wp) function share_after(sums, has_sums) result(share)
    real(wp), intent(in) :: sums(2)
    logical, intent(in) :: has_sums
    type(nesterov_rule_t) :: rule
    integer :: k

    do k = 1, 10
      call rule%next([1.0_wp, 1.0_wp], .true., share)
    end do
    call rule%next(sums, has_sums, share)
  end function share_after

  !> Pauses take 40, 80, 160 sweeps without a share; then the sequence begins again.
  subroutine pauses_grow()
    type(nesterov_rule_t) :: rule
    real(wp) :: share
    integer :: i, k, plain

    do i = 0, 2
      call rule%rest()
      plain = 0
      do k = 1, 1000
        call rule%next([1.0_wp, 1.0_wp], .true., share)
        if (share > 0) exit
        plain = plain + 1
      end do
      ! The first sweep of a sequence has no share either.
      call tests%check(plain == 40*2**i + 1, 'pause of '//to_text(40*2**i)//' sweeps, not '//to_text(plain - 1))
    end do
  end subroutine pauses_grow
end program test_block_nesterov
