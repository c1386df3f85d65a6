!> Gauss-Seidel sweeps with momentum on a stored W (doc/theory/nesterov.md): a sweep starts further along the last change.
module sg_block_nesterov
  use sg_block_progress, only: progress_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_matrix_sweeps, only: sweep
  use sg_nesterov_rule, only: nesterov_rule_t
  use sg_report, only: report_t
  implicit none
  private
  public :: block_nesterov_t, nesterov_state_t, sweep_nesterov

  !> Operations per impulse component beside a sweep: the passes over the iterates
  real(wp), parameter :: passes = 10

  !> Sweeps with momentum; an iteration is one sweep
  type, extends(matrix_solver_t) :: block_nesterov_t
  contains
    procedure :: solve => block_nesterov_solve
  end type block_nesterov_t

  !> Where these sweeps stand between two turns
  type :: nesterov_state_t
    !> Impulses that the last sweep left [N s], shape (d, n)
    real(wp), allocatable :: r(:, :)
    !> Those that it started from, and those of the sweep before
    real(wp), allocatable, private :: start(:, :), before(:, :)
    type(nesterov_rule_t), private :: rule
    !> Least e1 of the tests so far, and tests since it fell
    real(wp), private :: least = huge(1.0_wp)
    integer, private :: tests = 0
  end type nesterov_state_t

contains

  !> Sweep until e1 is small enough.
  subroutine block_nesterov_solve(self, problem, report)
    class(block_nesterov_t), intent(inout) :: self
    type(matrix_problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    type(progress_t) :: progress
    type(nesterov_state_t) :: state

    call progress%begin(problem, self%options)
    state%r = problem%r
    do while (.not. progress%is_over)
      call sweep_nesterov(problem, max(1, progress%sweeps/10), state, progress)
    end do
    call progress%finish(problem, report)
  end subroutine block_nesterov_solve

  !> So many sweeps, or fewer where the time is up, and a test of what they leave. Where e1 has not fallen for two tests, momentum
  !! pauses.
  subroutine sweep_nesterov(problem, most, state, progress)
    type(matrix_problem_t), intent(in) :: problem !! problem to solve
    integer, intent(in) :: most !! sweeps
    type(nesterov_state_t), intent(inout) :: state !! where the sweeps stand; its impulses are those to start from
    type(progress_t), intent(inout) :: progress !! how far the solve has come
    integer, parameter :: patience = 7
    integer :: i

    do i = 1, min(most, progress%options%maximum_iterations - progress%iterations)
      call go_on(state)
      call sweep(problem, state%r)
      call progress%count_sweeps(1, others=passes*real(size(state%r), wp))
      if (modulo(i, 20) == 0) then
        if (progress%is_late()) exit
      end if
    end do
    call progress%look(problem, state%r)
    state%tests = state%tests + 1
    if (progress%e1 < state%least) state%tests = 0
    state%least = min(state%least, progress%e1)
    if (state%tests < patience) return
    call state%rule%rest()
    state%tests = 0
  end subroutine sweep_nesterov

  !> Let the impulses go on by the share that the last sweep allows.
  pure subroutine go_on(state)
    type(nesterov_state_t), intent(inout) :: state
    real(wp) :: share

    share = 0
    if (allocated(state%start)) then
      call state%rule%next(sums_of(size(state%r), state%r, state%start, state%before), .true., share)
    else
      state%before = state%r
      state%start = state%r
    end if
    call step(size(state%r), share, state%r, state%start, state%before)
  end subroutine go_on

  !> Sums of g^2 and g d; four each, since one alone waits for itself.
  pure function sums_of(n, x, start, before) result(sums)
    integer, intent(in) :: n
    real(wp), intent(in) :: x(n), start(n), before(n)
    real(wp) :: sums(2), gg(4), gd(4), g(4)
    integer :: i

    gg = 0
    gd = 0
    do i = 1, n - 3, 4
      g = x(i:i + 3) - start(i:i + 3)
      gg = gg + g*g
      gd = gd + g*(x(i:i + 3) - before(i:i + 3))
    end do
    do i = n - modulo(n, 4) + 1, n
      gg(1) = gg(1) + (x(i) - start(i))**2
      gd(1) = gd(1) + (x(i) - start(i))*(x(i) - before(i))
    end do
    sums = [sum(gg), sum(gd)]
  end function sums_of

  !> x goes on by a share of its last change.
  pure subroutine step(n, share, x, start, before)
    integer, intent(in) :: n
    real(wp), intent(in) :: share
    real(wp), intent(inout) :: x(n), start(n), before(n)
    real(wp) :: now
    integer :: i

    do i = 1, n
      now = x(i)
      x(i) = now + share*(now - before(i))
      before(i) = now
      start(i) = x(i)
    end do
  end subroutine step
end module sg_block_nesterov
