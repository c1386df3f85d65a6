!> Base type of all solvers of contact problems: options once, then one problem after the other.
module sg_solver
  use sg_comm, only: comm_t
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: tables_t
  implicit none
  private
  public :: solver_t

  !> A solver, chosen once per run
  type, abstract :: solver_t
    !> Keep the history of errors of the next solves?
    logical :: with_trace = .false.
    !> Vectors that the method carries from step to step: per body copy, each as long as a velocity; per contact, each as long as an
    !! impulse. Set where the solver is chosen
    integer :: carried_velocities = 0, carried_impulses = 0
    !> Their values where there are any, by slot of this rank's copies and by contact of the problem: those of the last step when a
    !! solve begins, zero for new copies and contacts
    real(wp), allocatable :: carried_body(:, :), carried_contact(:, :)
  contains
    procedure(solve_coupled), deferred :: solve_coupled
    procedure :: solve_alone
    !> Solve a problem: of this rank alone, or the part of one that several ranks share
    generic :: solve => solve_coupled, solve_alone
    procedure(list_tables), deferred :: list_tables
  end type solver_t

  abstract interface
    !> Solve a problem of which each rank holds some contacts and the bodies that they touch. Impulses hold the guess, bodies their
    !! free velocities (the same in all copies); both are replaced by the solution, on all copies of a body. Errors reported are
    !! those of the whole, undecomposed problem; sweeps and updates are those of this rank. Collective.
    subroutine solve_coupled(self, problem, coupling, comm, report)
      import :: solver_t, problem_t, subdomain_t, comm_t, report_t
      class(solver_t), intent(inout) :: self
      type(problem_t), intent(inout) :: problem !! contacts of this rank, its bodies and the copies that they touch
      type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
      type(comm_t), intent(inout) :: comm !! the ranks
      type(report_t), intent(out) :: report !! effort and errors
    end subroutine solve_coupled
    !> List the tables that a solver keeps from one problem to the next.
    subroutine list_tables(self, tables)
      import :: solver_t, tables_t
      class(solver_t), intent(in) :: self
      type(tables_t), intent(inout) :: tables !! list to add to
    end subroutine list_tables
  end interface

contains

  !> Solve a problem that this rank holds whole.
  subroutine solve_alone(self, problem, report)
    class(solver_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    type(subdomain_t) :: coupling
    type(comm_t) :: comm

    call self%solve_coupled(problem, coupling, comm, report)
  end subroutine solve_alone
end module sg_solver
