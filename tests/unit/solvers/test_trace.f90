!> Histories of errors within a solve: they change nothing, and say what shorter solves reach.
program test_trace
  use harness, only: tests_t
  use same_bits, only: same
  use sg_kinds, only: wp
  use sg_nlgs, only: nlgs_t
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e8
  use sg_run_trace, only: traced_steps
  use solver_cases, only: make_column, solver_of
  implicit none
  type(tests_t) :: t

  call test_history()
  call test_steps()
  call t%finish()

contains

  !> Steps to trace: those asked for, or some of all.
  subroutine test_steps()
    integer, allocatable :: none(:), some(:)

    some = [3, 1, 400]
    call t%check(all(traced_steps(some, 10) == some), 'steps asked for')
    call t%check(all(traced_steps(none, 3) == [1, 2, 3]), 'all of a few steps')
    call t%check(all(traced_steps(none, 800) == [100, 200, 300, 400, 500, 600, 700, 800]), 'some of many')
  end subroutine test_steps

  !> A history changes no bit of the answer, and its points are what solves of as many sweeps reach.
  subroutine test_history()
    type(problem_t) :: start, silent, problem
    type(nlgs_t) :: solver
    type(report_t) :: report, traced, short
    real(wp), allocatable :: exact(:)
    integer :: kind, i

    do kind = 1, 4
      call make_column(kind, start, exact)
      solver = solver_of(criterion_e8, 1e-6_wp, 1000)
      solver%options%check_every = 7
      silent = start
      call solver%solve(silent, report)
      call t%check(.not. allocated(report%trace), 'history: none unless wanted')
      problem = start
      solver%with_trace = .true.
      call solver%solve(problem, traced)
      call t%check(same(problem%impulse, silent%impulse) .and. same(problem%body, silent%body), 'history: same answer')
      call t%equal(traced%sweeps, report%sweeps, 'history: same effort')
      solver%with_trace = .false.
      solver%options%check_every = 1
      solver%options%tolerance = 1e-30_wp
      call t%equal(traced%trace(1)%iteration, 0, 'history: begins with the guess')
      call t%equal(traced%trace(size(traced%trace))%iteration, report%sweeps, 'history: ends with the answer')
      do i = 2, size(traced%trace)
        problem = start
        solver%options%maximum_sweeps = traced%trace(i)%iteration
        call solver%solve(problem, short)
        ! The active set is chosen at tests, which are more frequent here: the last digits differ.
        call t%near(traced%trace(i)%e8, short%e8, 1e-9_wp*short%e8 + 1e-15_wp, 'history: e8 after some sweeps')
        call t%near(traced%trace(i)%e1, short%e1, 1e-9_wp*short%e1 + 1e-15_wp, 'history: e1 after some sweeps')
        call t%check(traced%trace(i)%iteration > traced%trace(i - 1)%iteration, 'history: sweeps rise')
        call t%check(traced%trace(i)%cpu_seconds >= traced%trace(i - 1)%cpu_seconds, 'history: seconds rise')
      end do
    end do
  end subroutine test_history
end program test_trace
