!> From the options of a deck to the solver of a run: the one place that knows all methods, today one.
module sg_choose_solver
  use sg_nlgs, only: nlgs_t
  use sg_run_options, only: solver_options_t
  use sg_solver, only: solver_t
  implicit none
  private
  public :: choose_solver

contains

  !> Make the solver that the options name; the deck layer lets no other method than nlgs pass.
  subroutine choose_solver(options, solver)
    type(solver_options_t), intent(in) :: options !! options of the deck
    class(solver_t), allocatable, intent(out) :: solver !! the solver
    type(nlgs_t) :: nlgs

    nlgs%options = options
    allocate (solver, source=nlgs)
  end subroutine choose_solver
end module sg_choose_solver
