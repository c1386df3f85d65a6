!> From the options of a deck to the solver of a run: the one list of all methods and what each needs.
!!
!! Sweeps over compact records run on any number of ranks, coupled by the method that `partition.gluing` names; solvers of matrices
!! run on one rank, some of them with a sparse library (sg_choose_matrix_solver).
module sg_choose_solver
  use sg_by_matrices, only: solve_by_matrices_t
  use sg_choose_matrix_solver, only: choose_matrix_solver
  use sg_coupled_solver, only: coupled_solver_t
  use sg_dual, only: dual_t
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp
  use sg_matrix_solver, only: matrix_options_t
  use sg_momentum, only: momentum_t
  use sg_nlgs, only: nlgs_t
  use sg_primal, only: primal_t
  use sg_run_options, only: partition_options_t, solver_options_t
  use sg_solver, only: solver_t
  implicit none
  private
  public :: choose_solver

  !> Make the solver that the options name: for one rank, or for several
  interface choose_solver
    module procedure choose_for_one, choose_for_ranks
  end interface choose_solver

contains

  !> Make the solver of one rank.
  subroutine choose_for_one(options, solver)
    type(solver_options_t), intent(in) :: options !! of the deck; its reader has refused methods that cannot be had
    class(solver_t), allocatable, intent(out) :: solver !! the solver
    type(error_t), allocatable :: error

    call choose_for_ranks(options, partition_options_t(), 1, solver, error)
  end subroutine choose_for_one

  !> Make the solver of some ranks.
  subroutine choose_for_ranks(options, partition, ranks, solver, error)
    type(solver_options_t), intent(in) :: options !! options of the deck
    type(partition_options_t), intent(in) :: partition !! options of the deck for several ranks
    integer, intent(in) :: ranks !! number of ranks that share the scene
    class(solver_t), allocatable, intent(out) :: solver !! the solver
    type(error_t), allocatable, intent(out) :: error !! set when the method does not run on so many ranks, or lacks a library
    type(nlgs_t) :: nlgs

    if (options%method /= 'nlgs') then
      if (ranks > 1) then
        call fail(error, 'solver "'//trim(options%method)//'" does not run on several ranks; use method = "nlgs"')
      else
        call make_matrix_solver(options, solver, error)
      end if
    else if (ranks > 1) then
      call make_coupled(options, partition, solver)
    else
      nlgs%options = options
      allocate (solver, source=nlgs)
    end if
  end subroutine choose_for_ranks

  !> Make a solver of matrices.
  subroutine make_matrix_solver(options, solver, error)
    type(solver_options_t), intent(in) :: options
    class(solver_t), allocatable, intent(out) :: solver
    type(error_t), allocatable, intent(out) :: error
    type(solve_by_matrices_t), allocatable :: by_matrices
    type(matrix_options_t) :: matrix_options

    allocate (by_matrices)
    by_matrices%options = options
    matrix_options%maximum_seconds = huge(1.0_wp)
    matrix_options%with_contacts = .false.
    call choose_matrix_solver(trim(options%method), matrix_options, by_matrices%solver, error)
    call move_alloc(by_matrices, solver)
  end subroutine make_matrix_solver

  !> Make the solver of a decomposed scene, by the deck's word for its gluing.
  subroutine make_coupled(options, partition, solver)
    type(solver_options_t), intent(in) :: options
    type(partition_options_t), intent(in) :: partition
    class(solver_t), allocatable, intent(out) :: solver
    class(coupled_solver_t), allocatable :: coupled

    select case (partition%gluing)
    case ('primal')
      allocate (primal_t :: coupled)
    case ('momentum')
      allocate (momentum_t :: coupled)
    case default
      allocate (dual_t :: coupled)
    end select
    coupled%options = options
    coupled%partition = partition
    call move_alloc(coupled, solver)
  end subroutine make_coupled
end module sg_choose_solver
