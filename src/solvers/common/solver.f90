!> What every solver of contact problems looks like: options once, then one problem after the other.
module sg_solver
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_tables, only: tables_t
  implicit none
  private
  public :: solver_t

  !> A solver, chosen once a run
  type, abstract :: solver_t
    !> Keep the history of errors of the next solves?
    logical :: with_trace = .false.
  contains
    procedure(solve), deferred :: solve
    procedure(list_tables), deferred :: list_tables
  end type solver_t

  abstract interface
    !> Solve a problem: impulses hold the guess, bodies their free velocities; both are replaced by the solution.
    subroutine solve(self, problem, report)
      import :: solver_t, problem_t, report_t
      class(solver_t), intent(inout) :: self
      type(problem_t), intent(inout) :: problem !! problem to solve
      type(report_t), intent(out) :: report !! effort and errors
    end subroutine solve
    !> List the tables that a solver keeps from one problem to the next.
    subroutine list_tables(self, tables)
      import :: solver_t, tables_t
      class(solver_t), intent(in) :: self
      type(tables_t), intent(inout) :: tables !! list to add to
    end subroutine list_tables
  end interface
end module sg_solver
