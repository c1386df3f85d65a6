!> What every solver of decomposed contact problems looks like: each rank brings its part of one problem.
module sg_glued_solver
  use sg_comm, only: comm_t
  use sg_kinds, only: i4
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_run_options, only: partition_options_t, solver_options_t
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: glued_solver_t

  !> A solver of decomposed problems, chosen once a run
  type, abstract :: glued_solver_t
    !> Options of the deck
    type(solver_options_t) :: options
    type(partition_options_t) :: partition
  contains
    procedure(solve), deferred :: solve
  end type glued_solver_t

  abstract interface
    !> Solve a problem of which each rank holds some contacts and the bodies that they touch. Impulses hold the guess,
    !! bodies their free velocities (the same in all copies); both are replaced by the solution, on all copies of a body.
    !! The errors reported are those of the whole, undecomposed problem; sweeps and updates are those of this rank.
    subroutine solve(self, problem, subdomain, slot_of, comm, report)
      import :: glued_solver_t, problem_t, subdomain_t, comm_t, report_t, i4
      class(glued_solver_t), intent(inout) :: self
      type(problem_t), intent(inout) :: problem !! this rank's contacts, its bodies and the copies that they touch
      type(subdomain_t), intent(in) :: subdomain !! who shares which body
      integer(i4), intent(in) :: slot_of(:) !! slot of each local body
      type(comm_t), intent(inout) :: comm !! the ranks
      type(report_t), intent(out) :: report !! effort and errors
    end subroutine solve
  end interface
end module sg_glued_solver
