!> The default: all methods in turns, of which the one that is ahead gets most (doc/theory/solvers_sweeps.md).
module sg_block_automatic
  use sg_block_progress, only: progress_t
  use sg_block_scaling, only: scale_problem
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_method_turns, only: take_turns, turns_t
  use sg_report, only: report_t
  implicit none
  private
  public :: block_automatic_t

  !> The solver; an iteration is a sweep, or a step with one factorisation
  type, extends(matrix_solver_t) :: block_automatic_t
    type(turns_t) :: turns
  contains
    procedure :: solve => block_automatic_solve
  end type block_automatic_t

contains

  !> All methods in turns until e1 is small enough.
  subroutine block_automatic_solve(self, problem, report)
    class(block_automatic_t), intent(inout) :: self
    type(matrix_problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    type(matrix_problem_t) :: scaled
    type(progress_t) :: progress
    real(wp), allocatable :: scale(:)

    call progress%begin(problem, self%options)
    if (.not. progress%is_over) then
      allocate (scale(problem%n))
      call scale_problem(problem, scaled, scale)
      call take_turns(self%turns, problem, scaled, scale, progress)
    end if
    call progress%finish(problem, report)
  end subroutine block_automatic_solve
end module sg_block_automatic
