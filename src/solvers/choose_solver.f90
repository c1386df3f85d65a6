!> From a name to the solver, by the list of methods (sg_methods).
!!
!! Sweeps over compact records run on any number of ranks, coupled by the method that `partition.gluing` names. Solvers of matrices
!! run on one rank; one that has a coupled solver of its own runs on several, too.
module sg_choose_solver
  use sg_by_matrices, only: solve_by_matrices_t
  use sg_coupled_solver, only: coupled_solver_t
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp
  use sg_matrix_solver, only: matrix_options_t, matrix_solver_t
  use sg_methods, only: find_method, list_couplings, list_solvers, method_t, quoted_names
  use sg_nlgs, only: nlgs_t
  use sg_options, only: option_values_t
  use sg_run_options, only: partition_options_t, solver_options_t
  use sg_solver, only: solver_t
  use sg_text, only: append_word, joined, nearest_word, text_t
  implicit none
  private
  public :: choose_solver, choose_matrix_solver

  !> Make the solver that the options name: for one rank, or for several
  interface choose_solver
    module procedure choose_for_one, choose_for_ranks
  end interface choose_solver

contains

  !> Make the solver of one rank.
  subroutine choose_for_one(options, solver)
    type(solver_options_t), intent(in) :: options !! of the deck; its reader has refused methods that cannot be had
    class(solver_t), allocatable, intent(out) :: solver !! the solver
    type(partition_options_t) :: whole
    type(error_t), allocatable :: error

    call choose_for_ranks(options, whole, 1, solver, error)
  end subroutine choose_for_one

  !> Make the solver of some ranks.
  subroutine choose_for_ranks(options, partition, ranks, solver, error)
    type(solver_options_t), intent(in) :: options !! options of the deck
    type(partition_options_t), intent(in) :: partition !! options of the deck for several ranks
    integer, intent(in) :: ranks !! number of ranks that share the scene
    class(solver_t), allocatable, intent(out) :: solver !! the solver
    type(error_t), allocatable, intent(out) :: error !! set when the method does not run on so many ranks, or lacks a library
    type(method_t), allocatable :: methods(:)
    class(nlgs_t), allocatable :: sweeps
    class(coupled_solver_t), allocatable :: coupled
    integer :: i, method

    call list_solvers(methods)
    method = find_method(methods, options%method)
    if (ranks > 1 .and. methods(method)%runs_alone()) then
      call fail(error, 'solver "'//trim(options%method)//'" does not run on several ranks; use method = '// &
                quoted_names(methods, [(.not. methods(i)%runs_alone(), i=1, size(methods))]))
    else if (ranks > 1 .and. allocated(methods(method)%coupled)) then
      call methods(method)%find_library(error)
      if (allocated(error)) return
      call move_alloc(methods(method)%coupled, coupled)
      call couple(options, .true., partition, coupled, solver)
    else if (ranks > 1) then
      call make_coupled(options, methods(method)%sweeps%has_momentum, partition, solver)
    else
      call move_alloc(methods(method)%sweeps, sweeps)
      if (.not. allocated(sweeps)) then
        call make_matrix_solver(options, solver, error)
      else
        sweeps%options = options
        call move_alloc(sweeps, solver)
      end if
    end if
  end subroutine choose_for_ranks

  !> Make a solver of matrices for the problems of a run.
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

  !> Make the solver of a decomposed scene, with the options that the deck gives for its coupling.
  subroutine make_coupled(options, has_momentum, partition, solver)
    type(solver_options_t), intent(in) :: options
    logical, intent(in) :: has_momentum
    type(partition_options_t), intent(in) :: partition
    class(solver_t), allocatable, intent(out) :: solver
    type(method_t), allocatable :: couplings(:)
    class(coupled_solver_t), allocatable :: coupled
    type(option_values_t) :: values

    call list_couplings(couplings)
    call move_alloc(couplings(find_method(couplings, partition%gluing))%coupled, coupled)
    values = partition%own
    call coupled%visit_options(values)
    call couple(options, has_momentum, partition, coupled, solver)
  end subroutine make_coupled

  !> Give a coupled solver the options of the deck.
  subroutine couple(options, has_momentum, partition, coupled, solver)
    type(solver_options_t), intent(in) :: options
    logical, intent(in) :: has_momentum
    type(partition_options_t), intent(in) :: partition
    class(coupled_solver_t), allocatable, intent(inout) :: coupled
    class(solver_t), allocatable, intent(out) :: solver

    coupled%options = options
    coupled%has_momentum = has_momentum
    coupled%partition = partition
    call move_alloc(coupled, solver)
  end subroutine couple

  !> Make the solver of problems given by matrices of a name.
  subroutine choose_matrix_solver(name, options, solver, error)
    character(len=*), intent(in) :: name !! one of `solver_names`
    type(matrix_options_t), intent(in) :: options !! when to stop
    class(matrix_solver_t), allocatable, intent(out) :: solver !! the solver
    type(error_t), allocatable, intent(out) :: error !! set when there is no solver of this name, or no library for it
    type(method_t), allocatable :: methods(:)
    integer :: i

    call list_solvers(methods)
    i = find_method(methods, name)
    if (i == 0) then
      call refuse(name, methods, error)
    else
      call methods(i)%find_library(error)
      if (allocated(error)) return
      call move_alloc(methods(i)%matrices, solver)
      solver%options = options
    end if
  end subroutine choose_matrix_solver

  !> Refuse an unknown name with the list of solvers.
  subroutine refuse(name, methods, error)
    character(len=*), intent(in) :: name
    type(method_t), intent(in) :: methods(:)
    type(error_t), allocatable, intent(out) :: error
    type(text_t), allocatable :: known(:)
    character(len=:), allocatable :: near
    integer :: i

    do i = 1, size(methods)
      call append_word(known, trim(methods(i)%name))
    end do
    near = nearest_word(name, known)
    if (len(near) > 0) near = '; did you mean "'//near//'"?'
    call fail(error, 'there is no solver "'//name//'" of contact problems; there are '//joined(known, ', ')//near)
  end subroutine refuse
end module sg_choose_solver
