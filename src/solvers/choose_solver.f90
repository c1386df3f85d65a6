!> From the options of a deck to the solver of a run: the one place that knows all methods.
module sg_choose_solver
  use sg_by_matrices, only: solve_by_matrices_t
  use sg_choose_matrix_solver, only: choose_matrix_solver
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_matrix_solver, only: matrix_options_t
  use sg_nlgs, only: nlgs_t
  use sg_run_options, only: solver_options_t
  use sg_solver, only: solver_t
  implicit none
  private
  public :: choose_solver

contains

  !> Make the solver that the options name: sweeps over compact records, or a solver of matrices by its own name.
  subroutine choose_solver(options, solver)
    type(solver_options_t), intent(in) :: options !! options of the deck
    class(solver_t), allocatable, intent(out) :: solver !! the solver
    type(nlgs_t) :: nlgs
    type(solve_by_matrices_t), allocatable :: by_matrices
    type(matrix_options_t) :: matrix_options
    type(error_t), allocatable :: error

    if (options%method /= 'nlgs') then
      allocate (by_matrices)
      by_matrices%options = options
      matrix_options%maximum_seconds = huge(1.0_wp)
      matrix_options%with_contacts = .false.
      call choose_matrix_solver(trim(options%method), matrix_options, by_matrices%solver, error)
      ! The deck layer lets no unknown name pass.
      if (.not. allocated(error)) then
        call move_alloc(by_matrices, solver)
        return
      end if
    end if
    nlgs%options = options
    allocate (solver, source=nlgs)
  end subroutine choose_solver
end module sg_choose_solver
