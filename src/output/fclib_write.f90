!> Contact problems and solutions to FCLIB files (doc/guide/solve.md).
module sg_fclib_write
  use sg_condense, only: multipliers_of, sparse_from_blocks, velocity_of
  use sg_error, only: error_t, exit_bad_input, fail
  use sg_fclib_items, only: holds, refuse, write_matrix, write_number
  use sg_fclib_read, only: fclib_constraints_t, open_fclib, read_problem, usable_impulses
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_sparse, only: multiply
  use sg_sparse_algebra, only: no_columns
  implicit none
  private
  public :: write_fclib, write_solution

contains

  !> Write a problem with its solution to STEM-local.hdf5 and, where its global form is known, to STEM-global.hdf5: one
  !! file must hold one problem. Files of these names are replaced.
  subroutine write_fclib(stem, problem, title, description, with_solution, error, guess)
    character(len=*), intent(in) :: stem !! path of the files up to -local or -global
    type(matrix_problem_t), intent(in) :: problem !! problem
    character(len=*), intent(in) :: title !! one line: what this is
    character(len=*), intent(in) :: description !! where it comes from; the units are said beside
    logical, intent(in) :: with_solution !! are the impulses of the problem its solution?
    type(error_t), allocatable, intent(out) :: error !! set when a file cannot be written
    real(wp), intent(in), optional :: guess(:, :) !! impulses that a solver may start from [N s], shape (d, n)
    type(hdf5_file_t) :: file

    call file%create(stem//'-local.hdf5')
    call write_local(file, problem, title, description)
    call write_states(file, problem, .false., with_solution, guess)
    call file%close()
    if (.not. allocated(file%error) .and. problem%has_global) then
      call file%create(stem//'-global.hdf5')
      call write_global(file, problem, title, description)
      call write_states(file, problem, .true., with_solution, guess)
      call file%close()
    end if
    if (allocated(file%error)) call move_alloc(file%error, error)
  end subroutine write_fclib

  !> Write the local form.
  subroutine write_local(file, problem, title, description)
    type(hdf5_file_t), intent(inout) :: file
    type(matrix_problem_t), intent(in) :: problem
    character(len=*), intent(in) :: title, description

    call file%group('/fclib_local')
    call write_number(file, '/fclib_local/spacedim', problem%d)
    call write_matrix(file, '/fclib_local/W', sparse_from_blocks(problem%w))
    call file%group('/fclib_local/vectors')
    call file%put('/fclib_local/vectors/q', flat(problem%q))
    call file%put('/fclib_local/vectors/mu', problem%friction)
    call write_info(file, '/fclib_local', title, description, &
                    'u = W r + q, components normal first; K* contains (u_N + mu |u_T|, u_T) orthogonal to r in K; '// &
                    'W in 1/kg, q and u in m/s, r in N s')
  end subroutine write_local

  !> Write the global form.
  subroutine write_global(file, problem, title, description)
    type(hdf5_file_t), intent(inout) :: file
    type(matrix_problem_t), intent(in) :: problem
    character(len=*), intent(in) :: title, description

    call file%group('/fclib_global')
    call write_number(file, '/fclib_global/spacedim', problem%d)
    call write_matrix(file, '/fclib_global/M', problem%mass)
    call write_matrix(file, '/fclib_global/H', problem%h)
    call file%group('/fclib_global/vectors')
    call file%put('/fclib_global/vectors/f', problem%f)
    call file%put('/fclib_global/vectors/w', problem%offset)
    call file%put('/fclib_global/vectors/mu', problem%friction)
    call write_info(file, '/fclib_global', title, description, &
                    'M v = H r + f, u = H^T v + w, components normal first; K* contains (u_N + mu |u_T|, u_T) orthogonal to r '// &
                    'in K; SI units: M in kg and kg m^2, v in m/s and rad/s, w and u in m/s, r in N s')
  end subroutine write_global

  !> Write what the file is.
  subroutine write_info(file, group, title, description, mathematics)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: group, title, description, mathematics

    call file%group(group//'/info')
    call file%put(group//'/info/title', title)
    call file%put(group//'/info/description', description)
    call file%put(group//'/info/math_info', mathematics)
  end subroutine write_info

  !> Write guess and solution.
  subroutine write_states(file, problem, is_global, with_solution, guess)
    type(hdf5_file_t), intent(inout) :: file
    type(matrix_problem_t), intent(in) :: problem
    logical, intent(in) :: is_global, with_solution
    real(wp), intent(in), optional :: guess(:, :)
    type(fclib_constraints_t) :: constraints
    type(matrix_problem_t) :: guessed

    constraints%is_global = is_global
    if (with_solution) call write_state(file, '/solution', problem, constraints)
    if (.not. present(guess)) return
    guessed = problem
    guessed%r = guess
    call file%group('/guesses')
    call write_number(file, '/guesses/number_of_guesses', 1)
    call write_state(file, '/guesses/1', guessed, constraints)
  end subroutine write_states

  !> Write the impulses of a problem, and the velocities and multipliers that they cause.
  subroutine write_state(file, path, problem, constraints)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    type(matrix_problem_t), intent(in) :: problem
    type(fclib_constraints_t), intent(in) :: constraints
    real(wp), allocatable :: u(:, :), v(:), l(:)
    type(error_t), allocatable :: error

    if (allocated(file%error)) return
    allocate (u(problem%d, problem%n))
    call multiply(problem%w, problem%r, u)
    u = u + problem%q
    if (constraints%n == 0) then
      if (constraints%is_global) call velocity_of(problem, no_columns(size(problem%f)), [real(wp) ::], v, l, error)
    else if (constraints%is_global) then
      call velocity_of(problem, constraints%g, constraints%b, v, l, error)
    else
      call multipliers_of(constraints%v, constraints%r, constraints%s, flat(problem%r), l, error)
    end if
    if (allocated(error)) call refuse(file, error%message)
    call file%group(path)
    if (constraints%is_global) call file%put(path//'/v', v)
    call file%put(path//'/u', flat(u))
    call file%put(path//'/r', flat(problem%r))
    if (constraints%n > 0) call file%put(path//'/l', l)
  end subroutine write_state

  !> Add a solution to the file of a problem.
  subroutine write_solution(name, r, is_forced, error)
    character(len=*), intent(in) :: name !! path of the file
    real(wp), intent(in) :: r(:, :) !! impulses [N s], shape (d, n)
    logical, intent(in) :: is_forced !! replace a solution that the file holds, even if it is of use?
    type(error_t), allocatable, intent(out) :: error !! set when the file holds one, or cannot be written
    type(hdf5_file_t) :: file
    type(matrix_problem_t) :: problem
    type(fclib_constraints_t) :: constraints
    real(wp), allocatable :: old(:)
    logical :: is_usable

    call open_fclib(file, name, .false.)
    call read_problem(file, problem, constraints)
    if (holds(file, '/solution')) then
      is_usable = .false.
      if (holds(file, '/solution/r') .and. .not. is_forced) then
        call usable_impulses(file, '/solution/r', size(r), old, is_usable)
        if (allocated(file%error)) deallocate (file%error)
      end if
      if (is_usable) then
        call refuse(file, 'the file holds a solution already; --force replaces it')
      else
        call file%remove('/solution')
      end if
    end if
    if (.not. allocated(file%error)) then
      problem%r = r
      call write_state(file, '/solution', problem, constraints)
    end if
    call file%close()
    if (allocated(file%error)) call move_alloc(file%error, error)
  end subroutine write_solution

  !> The components of all contacts one after the other.
  pure function flat(values) result(list)
    real(wp), intent(in) :: values(:, :)
    real(wp) :: list(size(values))

    list = reshape(values, [size(values)])
  end function flat
end module sg_fclib_write
