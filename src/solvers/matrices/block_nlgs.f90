!> Nonlinear Gauss-Seidel on a stored W (doc/theory/solvers_sweeps.md).
module sg_block_nlgs
  use sg_block_progress, only: progress_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_matrix_sweeps, only: sweep
  use sg_report, only: report_t
  implicit none
  private
  public :: block_nlgs_t

  !> Sweeps and nothing else; an iteration is one sweep over all contacts
  type, extends(matrix_solver_t) :: block_nlgs_t
  contains
    procedure :: solve => block_nlgs_solve
  end type block_nlgs_t

contains

  !> Sweep until e1 is small enough. Errors cost as much as a sweep: they are measured after 1, 2, ..., 20, 22, 24, ... sweeps.
  subroutine block_nlgs_solve(self, problem, report)
    class(block_nlgs_t), intent(inout) :: self
    type(matrix_problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    type(progress_t) :: progress
    real(wp), allocatable :: r(:, :)
    integer :: i

    call progress%begin(problem, self%options)
    r = problem%r
    do while (.not. progress%is_over)
      do i = 1, min(max(1, progress%sweeps/10), self%options%maximum_iterations - progress%iterations)
        call sweep(problem, r)
        call progress%count_sweeps(1)
      end do
      call progress%look(problem, r)
    end do
    call progress%finish(problem, report)
  end subroutine block_nlgs_solve
end module sg_block_nlgs
