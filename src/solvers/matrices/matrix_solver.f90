!> What every solver of contact problems given by matrices looks like.
module sg_matrix_solver
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_report, only: report_t
  implicit none
  private
  public :: matrix_solver_t, matrix_options_t

  !> When to stop; each solver has its own settings beside
  type :: matrix_options_t
    !> e1 at which the solver stops
    real(wp) :: tolerance = 1e-8_wp
    !> Iterations, and CPU seconds, after which it gives up (each solver defines its iteration)
    integer :: maximum_iterations = 100000
    real(wp) :: maximum_seconds = 60
    !> Must every contact obey its law by itself beside e1 (sg_matrix_errors)? A run has a test of its own
    logical :: with_contacts = .true.
    !> Start from the problem's impulses rather than from zero?
    logical :: warm_start = .false.
    !> Keep the history of errors?
    logical :: with_trace = .false.
  end type matrix_options_t

  !> A solver
  type, abstract :: matrix_solver_t
    type(matrix_options_t) :: options
  contains
    procedure(solve), deferred :: solve
  end type matrix_solver_t

  abstract interface
    !> Solve a problem: `r` holds the guess and then the best answer found. The errors in the report are those of that
    !! answer; the caller measures them again.
    subroutine solve(self, problem, report)
      import :: matrix_solver_t, matrix_problem_t, report_t
      class(matrix_solver_t), intent(inout) :: self
      type(matrix_problem_t), intent(inout) :: problem !! problem to solve
      type(report_t), intent(out) :: report !! effort and errors
    end subroutine solve
  end interface
end module sg_matrix_solver
