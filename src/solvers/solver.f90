!> What every solver of contact problems looks like: options once, then one problem after the other.
module sg_solver
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  implicit none
  private
  public :: solver_t

  !> A solver, chosen once a run
  type, abstract :: solver_t
    !> Keep the history of errors of the next solves?
    logical :: with_trace = .false.
  contains
    procedure(solve), deferred :: solve
  end type solver_t

  abstract interface
    !> Solve a problem: impulses hold the guess, bodies their free velocities; both are replaced by the solution.
    subroutine solve(self, problem, report)
      import :: solver_t, problem_t, report_t
      class(solver_t), intent(inout) :: self
      type(problem_t), intent(inout) :: problem !! problem to solve
      type(report_t), intent(out) :: report !! effort and errors
    end subroutine solve
  end interface
end module sg_solver
