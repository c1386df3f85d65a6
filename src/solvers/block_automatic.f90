!> The default: accelerated sweeps while they get on, proximal points with Newton's method when they do not, in turns.
module sg_block_automatic
  use sg_accelerated_nlgs, only: anderson_t, sweep_accelerated
  use sg_block_progress, only: progress_t
  use sg_block_scaling, only: scale_problem
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_proximal_newton, only: approach, proximal_t
  use sg_report, only: report_t
  implicit none
  private
  public :: block_automatic_t

  !> The solver; an iteration is a sweep, or a Newton step with one factorisation
  type, extends(matrix_solver_t) :: block_automatic_t
    type(anderson_t) :: anderson
    type(proximal_t) :: proximal
    !> Sweeps of a turn, which goes on while each such number lowers e1 by `fall`
    integer :: sweeps = 200
    real(wp) :: fall = 0.1_wp
    !> Factorisations of the first turn of Newton's method; each turn has twice those of the last
    integer :: factorisations = 200
  contains
    procedure :: solve => block_automatic_solve
  end type block_automatic_t

contains

  !> Sweeps and proximal points in turns until e1 is small enough.
  subroutine block_automatic_solve(self, problem, report)
    class(block_automatic_t), intent(inout) :: self
    type(matrix_problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    type(matrix_problem_t) :: scaled
    type(progress_t) :: progress
    real(wp), allocatable :: scale(:)
    real(wp) :: before
    integer :: most
    logical :: is_possible

    call progress%begin(problem, self%options)
    most = self%factorisations
    is_possible = .true.
    allocate (scale(problem%n))
    if (.not. progress%is_over) call scale_problem(problem, scaled, scale)
    do while (.not. progress%is_over)
      do
        before = progress%best
        call sweep_accelerated(self%anderson, problem, scaled, scale, self%sweeps, progress)
        if (progress%is_over .or. is_possible .and. progress%best > self%fall*before) exit
      end do
      if (is_possible) call approach(self%proximal, problem, scaled, scale, most, progress, is_possible)
      most = 2*min(most, 100000000)
    end do
    call progress%finish(problem, report)
  end subroutine block_automatic_solve
end module sg_block_automatic
