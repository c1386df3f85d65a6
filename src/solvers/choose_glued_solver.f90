!> The solver of a decomposed scene, from the deck's word for its gluing.
module sg_choose_glued_solver
  use sg_dual, only: dual_t
  use sg_error, only: error_t, fail
  use sg_glued_solver, only: glued_solver_t
  use sg_momentum, only: momentum_t
  use sg_primal, only: primal_t
  use sg_run_options, only: partition_options_t, solver_options_t
  implicit none
  private
  public :: choose_glued_solver

contains

  !> Make the solver.
  subroutine choose_glued_solver(options, partition, solver, error)
    type(solver_options_t), intent(in) :: options !! of the deck
    type(partition_options_t), intent(in) :: partition !! of the deck
    class(glued_solver_t), allocatable, intent(out) :: solver !! the solver
    type(error_t), allocatable, intent(out) :: error !! set when options do not go with several ranks

    if (options%method /= 'nlgs') then
      call fail(error, 'the solver "'//trim(options%method)//'" works on one rank; on several take nlgs')
    end if
    if (allocated(error)) return
    select case (partition%gluing)
    case ('primal')
      allocate (primal_t :: solver)
    case ('contacts')
      allocate (momentum_t :: solver)
    case default
      allocate (dual_t :: solver)
    end select
    solver%options = options
    solver%partition = partition
  end subroutine choose_glued_solver
end module sg_choose_glued_solver
