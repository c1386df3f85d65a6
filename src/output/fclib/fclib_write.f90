!> Contact problems and solutions to FCLIB files (doc/guide/solve.md).
module sg_fclib_write
  use sg_comm, only: comm_t
  use sg_condense, only: multipliers_of, velocity_of
  use sg_error, only: error_t, exit_output, fail
  use sg_fclib_items, only: holds, refuse, write_matrix, write_number
  use sg_fclib_read, only: fclib_constraints_t, open_fclib, read_problem, usable_impulses
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: wp
  use sg_matrix_pieces, only: matrix_pieces_t, matrix_state_t
  use sg_matrix_problem, only: matrix_problem_t
  use sg_settle_file, only: begin_file, part_of, settle_file
  use sg_sparse, only: multiply
  use sg_sparse_algebra, only: no_columns
  use sg_system, only: real_path, remove_file
  implicit none
  private
  public :: write_pieces, write_solution

contains

  !> Write a problem of which each rank holds some rows to STEM-local.hdf5 and, where its global form is known, to
  !! STEM-global.hdf5: one file must hold one problem. Files of these names are replaced. Collective.
  subroutine write_pieces(stem, pieces, title, description, comm, error)
    character(len=*), intent(in) :: stem !! path of the files up to -local or -global
    type(matrix_pieces_t), intent(in) :: pieces !! this rank's share of the problem, of its guess and of its solution
    character(len=*), intent(in) :: title !! one line: what this is
    character(len=*), intent(in) :: description !! where it comes from; the units are added
    type(comm_t), intent(inout) :: comm !! the ranks
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when a file cannot be written

    call write_form(stem//'-local.hdf5', .false., pieces, title, description, comm, error)
    if (.not. allocated(error) .and. pieces%has_global) &
      call write_form(stem//'-global.hdf5', .true., pieces, title, description, comm, error)
  end subroutine write_pieces

  !> Write one form of a problem; one rank gives the file its name when all have written it.
  subroutine write_form(name, is_global, pieces, title, description, ranks, error)
    character(len=*), intent(in) :: name, title, description
    logical, intent(in) :: is_global
    type(matrix_pieces_t), intent(in) :: pieces
    type(comm_t), intent(inout) :: ranks
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_file_t) :: file

    if (ranks%rank == 0) call remove_file(part_of(name))
    call file%share(ranks)
    call file%create(part_of(name))
    if (is_global) call write_global(file, pieces, title, description)
    if (.not. is_global) call write_local(file, pieces, title, description)
    call write_states(file, pieces, is_global)
    call file%close()
    call ranks%collect(file%ranks)
    if (allocated(file%error)) call move_alloc(file%error, error)
    if (ranks%rank == 0) call settle_file(part_of(name), name, error)
    call ranks%agree(error)
  end subroutine write_form

  !> Write the local form.
  subroutine write_local(file, pieces, title, description)
    type(hdf5_file_t), intent(inout) :: file
    type(matrix_pieces_t), intent(in) :: pieces
    character(len=*), intent(in) :: title, description

    associate (m => pieces%d*pieces%all_contacts)
      call file%group('/fclib_local')
      call write_number(file, '/fclib_local/spacedim', pieces%d)
      call write_matrix(file, '/fclib_local/W', m, m, pieces%w)
    end associate
    call file%group('/fclib_local/vectors')
    call file%put('/fclib_local/vectors/q', pieces%q)
    call file%put('/fclib_local/vectors/mu', pieces%friction)
    call write_info(file, '/fclib_local', title, description, &
                    'u = W r + q, components normal first; K* contains (u_N + mu |u_T|, u_T) orthogonal to r in K; '// &
                    'W in 1/kg, q and u in m/s, r in N s')
  end subroutine write_local

  !> Write the global form.
  subroutine write_global(file, pieces, title, description)
    type(hdf5_file_t), intent(inout) :: file
    type(matrix_pieces_t), intent(in) :: pieces
    character(len=*), intent(in) :: title, description

    call file%group('/fclib_global')
    call write_number(file, '/fclib_global/spacedim', pieces%d)
    call write_matrix(file, '/fclib_global/M', pieces%all_unknowns, pieces%all_unknowns, pieces%mass)
    call write_matrix(file, '/fclib_global/H', pieces%all_unknowns, pieces%d*pieces%all_contacts, pieces%h)
    call file%group('/fclib_global/vectors')
    call file%put('/fclib_global/vectors/f', pieces%f)
    call file%put('/fclib_global/vectors/w', pieces%offset)
    call file%put('/fclib_global/vectors/mu', pieces%friction)
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
  subroutine write_states(file, pieces, is_global)
    type(hdf5_file_t), intent(inout) :: file
    type(matrix_pieces_t), intent(in) :: pieces
    logical, intent(in) :: is_global

    if (pieces%has_solution) call write_state(file, '/solution', pieces%solution, is_global)
    if (.not. pieces%has_guess) return
    call file%group('/guesses')
    call write_number(file, '/guesses/number_of_guesses', 1)
    call write_state(file, '/guesses/1', pieces%guess, is_global)
  end subroutine write_states

  !> Write impulses, and the velocities and multipliers that they cause.
  subroutine write_state(file, path, state, is_global)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    type(matrix_state_t), intent(in) :: state
    logical, intent(in) :: is_global

    call file%group(path)
    if (is_global) call file%put(path//'/v', state%v)
    call file%put(path//'/u', state%u)
    call file%put(path//'/r', state%r)
    if (allocated(state%l)) call file%put(path//'/l', state%l)
  end subroutine write_state

  !> The velocities and multipliers that the impulses of a problem cause.
  subroutine find_state(problem, constraints, state, error)
    type(matrix_problem_t), intent(in) :: problem
    type(fclib_constraints_t), intent(in) :: constraints
    type(matrix_state_t), intent(out) :: state
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: u(:, :)

    allocate (u(problem%d, problem%n))
    call multiply(problem%w, problem%r, u)
    state%u = flat(u + problem%q)
    state%r = flat(problem%r)
    if (constraints%n == 0) then
      if (constraints%is_global) call velocity_of(problem, no_columns(size(problem%f)), [real(wp) ::], state%v, state%l, error)
      if (allocated(state%l)) deallocate (state%l)
    else if (constraints%is_global) then
      call velocity_of(problem, constraints%g, constraints%b, state%v, state%l, error)
    else
      call multipliers_of(constraints%v, constraints%r, constraints%s, state%r, state%l, error)
    end if
  end subroutine find_state

  !> Add a solution to the file of a problem: to a copy of all but its old solution, which takes its place when it is whole.
  subroutine write_solution(name, r, is_forced, error)
    character(len=*), intent(in) :: name !! path of the file
    real(wp), intent(in) :: r(:, :) !! impulses [N s], shape (d, n)
    logical, intent(in) :: is_forced !! replace a solution that the file holds, even if it is of use?
    type(error_t), allocatable, intent(out) :: error !! set when the file holds one, or cannot be written
    type(hdf5_file_t) :: source, file
    type(matrix_problem_t) :: problem
    type(fclib_constraints_t) :: constraints
    type(matrix_state_t) :: state
    character(len=:), allocatable :: place, part
    character(len=3) :: is_writable

    ! What a link leads to is replaced, not the link.
    place = real_path(name)
    if (len(place) == 0) place = name
    inquire (file=place, write=is_writable)
    if (is_writable == 'NO') call fail(error, 'this file is not for writing', file=name, code=exit_output)
    if (.not. allocated(error)) call check_solution(name, size(r), is_forced, error)
    if (allocated(error)) return
    part = begin_file(place)
    call open_fclib(source, place, .true.)
    call read_problem(source, problem, constraints)
    call file%create(part, is_in_memory=.true.)
    call file%take(source, except='solution')
    call source%close()
    if (.not. allocated(file%error)) then
      problem%r = r
      call find_state(problem, constraints, state, error)
      if (allocated(error)) call refuse(file, error%message)
      if (.not. allocated(file%error)) call write_state(file, '/solution', state, constraints%is_global)
    end if
    call file%close()
    if (allocated(file%error)) call move_alloc(file%error, error)
    call settle_file(part, place, error)
    if (allocated(error)) error%file = name
  end subroutine write_solution

  !> Refuse to replace a solution that is of use.
  subroutine check_solution(name, n, is_forced, error)
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    logical, intent(in) :: is_forced
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_file_t) :: file
    real(wp), allocatable :: old(:)
    logical :: is_usable

    call open_fclib(file, name, .true.)
    if (holds(file, '/solution')) then
      is_usable = .false.
      if (holds(file, '/solution/r') .and. .not. is_forced) then
        call usable_impulses(file, '/solution/r', n, old, is_usable)
        if (allocated(file%error)) deallocate (file%error)
      end if
      if (is_usable) call refuse(file, 'the file holds a solution already; --force replaces it')
    end if
    call file%close()
    if (allocated(file%error)) call move_alloc(file%error, error)
  end subroutine check_solution

  !> The components of all contacts one after the other.
  pure function flat(values) result(list)
    real(wp), intent(in) :: values(:, :)
    real(wp) :: list(size(values))

    list = reshape(values, [size(values)])
  end function flat
end module sg_fclib_write
