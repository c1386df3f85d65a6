!> A whole problem in matrices as FCLIB files, with a solution and a guess.
module fclib_of_problem
  use sg_comm, only: comm_t
  use sg_condense, only: sparse_from_blocks, velocity_of
  use sg_error, only: error_t
  use sg_fclib_write, only: write_pieces
  use sg_kinds, only: wp
  use sg_matrix_pieces, only: matrix_pieces_t, matrix_state_t, triplets_t
  use sg_matrix_problem, only: matrix_problem_t
  use sg_sparse, only: multiply, sparse_t
  use sg_sparse_algebra, only: no_columns, rows_of
  implicit none
  private
  public :: write_fclib

contains

  !> Write a problem to STEM-local.hdf5 and, where its global form is known, to STEM-global.hdf5.
  subroutine write_fclib(stem, problem, title, description, with_solution, error, guess)
    character(len=*), intent(in) :: stem !! path of the files up to -local or -global
    type(matrix_problem_t), intent(in) :: problem !! problem
    character(len=*), intent(in) :: title !! one line: what this is
    character(len=*), intent(in) :: description !! where it comes from
    logical, intent(in) :: with_solution !! are the impulses of the problem its solution?
    type(error_t), allocatable, intent(out) :: error !! set when a file cannot be written
    real(wp), intent(in), optional :: guess(:, :) !! impulses that a solver may start from [N s], shape (d, n)
    type(matrix_pieces_t) :: pieces
    type(comm_t) :: alone

    pieces%d = problem%d
    pieces%all_contacts = problem%n
    pieces%w = triplets_of(sparse_from_blocks(problem%w))
    pieces%q = reshape(problem%q, [size(problem%q)])
    pieces%friction = problem%friction
    pieces%has_global = problem%has_global
    pieces%has_solution = with_solution
    pieces%has_guess = present(guess)
    if (problem%has_global) then
      pieces%all_unknowns = size(problem%f)
      pieces%mass = triplets_of(problem%mass)
      pieces%h = triplets_of(problem%h)
      pieces%f = problem%f
      pieces%offset = problem%offset
    end if
    if (with_solution) call find_state(problem, problem%r, pieces%solution, error)
    if (allocated(error)) return
    if (present(guess)) call find_state(problem, guess, pieces%guess, error)
    if (.not. allocated(error)) call write_pieces(stem, pieces, title, description, alone, error)
  end subroutine write_fclib

  !> Entries of a matrix that one rank holds whole.
  pure function triplets_of(matrix) result(triplets)
    type(sparse_t), intent(in) :: matrix !! the matrix
    type(triplets_t) :: triplets

    triplets%row = rows_of(matrix)
    triplets%column = matrix%column
    triplets%value = matrix%value
  end function triplets_of

  !> Velocities of contacts and bodies under given impulses.
  subroutine find_state(problem, r, state, error)
    type(matrix_problem_t), intent(in) :: problem
    real(wp), intent(in) :: r(:, :)
    type(matrix_state_t), intent(out) :: state
    type(error_t), allocatable, intent(out) :: error
    type(matrix_problem_t) :: with_impulses
    real(wp), allocatable :: u(:, :)

    allocate (u(problem%d, problem%n))
    call multiply(problem%w, r, u)
    state%u = reshape(u + problem%q, [size(u)])
    state%r = reshape(r, [size(r)])
    if (.not. problem%has_global) return
    with_impulses = problem
    with_impulses%r = r
    call velocity_of(with_impulses, no_columns(size(problem%f)), [real(wp) ::], state%v, state%l, error)
    if (allocated(state%l)) deallocate (state%l)
  end subroutine find_state
end module fclib_of_problem
