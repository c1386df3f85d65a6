!> From the name of a solver of contact problems given by matrices to the solver: the one list of them all.
!!
!! A new solver is a name in `matrix_solver_names` and a case of `choose_matrix_solver`.
module sg_choose_matrix_solver
  use sg_accelerated_nlgs, only: accelerated_nlgs_t
  use sg_block_automatic, only: block_automatic_t
  use sg_block_nlgs, only: block_nlgs_t
  use sg_error, only: error_t, fail
  use sg_interior_point, only: interior_point_t
  use sg_matrix_solver, only: matrix_options_t, matrix_solver_t
  use sg_proximal_newton, only: proximal_newton_t
  use sg_sparse_factor, only: find_sparse_library
  use sg_text, only: append_word, joined, nearest_word, text_t
  implicit none
  private
  public :: choose_matrix_solver, matrix_solver_names

  !> Names of all solvers, in the order in which `splitgrain solve --solver all` runs them; the first is its default
  character(len=16), parameter :: matrix_solver_names(5) = &
    [character(len=16) :: 'auto', 'nlgs', 'accelerated', 'proximal', 'interior']

contains

  !> Make the solver of a name.
  subroutine choose_matrix_solver(name, options, solver, error)
    character(len=*), intent(in) :: name !! one of `matrix_solver_names`
    type(matrix_options_t), intent(in) :: options !! when to stop
    class(matrix_solver_t), allocatable, intent(out) :: solver !! the solver
    type(error_t), allocatable, intent(out) :: error !! set when there is no solver of this name, or no library for it

    if (any(name == ['auto    ', 'proximal', 'interior'])) call find_sparse_library(error)
    if (allocated(error)) return
    select case (name)
    case ('auto')
      allocate (block_automatic_t :: solver)
    case ('nlgs')
      allocate (block_nlgs_t :: solver)
    case ('accelerated')
      allocate (accelerated_nlgs_t :: solver)
    case ('proximal')
      allocate (proximal_newton_t :: solver)
    case ('interior')
      allocate (interior_point_t :: solver)
    case default
      call refuse(name, error)
    end select
    if (allocated(solver)) solver%options = options
  end subroutine choose_matrix_solver

  !> Refuse an unknown name with the list of solvers.
  subroutine refuse(name, error)
    character(len=*), intent(in) :: name
    type(error_t), allocatable, intent(out) :: error
    type(text_t), allocatable :: known(:)
    character(len=:), allocatable :: near
    integer :: i

    do i = 1, size(matrix_solver_names)
      call append_word(known, trim(matrix_solver_names(i)))
    end do
    near = nearest_word(name, known)
    if (len(near) > 0) near = '; did you mean "'//near//'"?'
    call fail(error, 'there is no solver "'//name//'" of contact problems; there are '//joined(known, ', ')//near)
  end subroutine refuse
end module sg_choose_matrix_solver
