!> Contact problems from FCLIB files (doc/guide/solve.md), local or global, from any code: read, checked, constraints eliminated.
module sg_fclib_read
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_condense, only: condense_constrained, eliminate_local, set_local_form
  use sg_error, only: error_t, exit_bad_input
  use sg_fclib_items, only: holds, read_matrix, read_number, read_vector, refuse
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: wp
  use sg_laws, only: largest_friction, why_largest_friction
  use sg_matrix_problem, only: matrix_problem_t
  use sg_sparse, only: sparse_t
  use sg_sparse_algebra, only: no_columns
  use sg_system, only: file_exists
  use sg_text, only: joined, text_t, to_text
  implicit none
  private
  public :: fclib_constraints_t, open_fclib, read_fclib, read_problem, usable_impulses

  !> Equality constraints of a problem, which `matrix_problem_t` has no place for
  type :: fclib_constraints_t
    !> Is the problem of the file in global form?
    logical :: is_global = .false.
    !> Number of constraints
    integer :: n = 0
    !> Local form: V (m, n), R (n, n), s (n), with u = W r + q + V l, V^T r + R l + s = 0.
    !! Global form: G (dof, n), b (n), with M v = H r + G l + f, G^T v + b = 0
    type(sparse_t) :: v, r, g
    real(wp), allocatable :: s(:), b(:)
  end type fclib_constraints_t

contains

  !> Read a problem from a file.
  subroutine read_fclib(name, with_guess, problem, has_guess, error)
    character(len=*), intent(in) :: name !! path of the file
    logical, intent(in) :: with_guess !! take the impulses of the file's first usable guess? They are zero without
    type(matrix_problem_t), intent(out) :: problem !! the problem
    logical, intent(out) :: has_guess !! did the file have such a guess?
    type(error_t), allocatable, intent(out) :: error !! what is wrong with the file
    type(hdf5_file_t) :: file
    type(fclib_constraints_t) :: constraints

    has_guess = .false.
    call open_fclib(file, name, .true.)
    call read_problem(file, problem, constraints)
    if (with_guess) call read_guess(file, problem, has_guess)
    call file%close()
    if (allocated(file%error)) call move_alloc(file%error, error)
    if (.not. allocated(error)) return
    error%code = exit_bad_input
    error%message = printable(error%message)
  end subroutine read_fclib

  !> A text with question marks for what cannot be printed: names in spoilt files are any bytes.
  pure function printable(text) result(clean)
    character(len=*), intent(in) :: text
    character(len=len(text)) :: clean
    integer :: i

    do i = 1, len(text)
      clean(i:i) = merge(text(i:i), '?', iachar(text(i:i)) >= 32 .and. iachar(text(i:i)) < 127)
    end do
  end function printable

  !> Open a file that must exist.
  subroutine open_fclib(file, name, is_read_only)
    type(hdf5_file_t), intent(inout) :: file !! the file
    character(len=*), intent(in) :: name !! its path
    logical, intent(in) :: is_read_only !! open for reading alone?

    file%name = name
    if (.not. file_exists(name)) then
      call refuse(file, 'there is no such file')
      return
    end if
    call file%open(name, is_read_only)
    if (.not. allocated(file%error)) return
    if (index(file%error%message, 'signature not found') > 0) file%error%message = 'this is no HDF5 file'
    if (index(file%error%message, 'truncated file') > 0) file%error%message = 'the file is truncated'
    file%error%code = exit_bad_input
  end subroutine open_fclib

  !> Read the problem of an open file, with its constraints eliminated and all impulses zero.
  subroutine read_problem(file, problem, constraints)
    type(hdf5_file_t), intent(inout) :: file !! open file; its error is set when something is wrong
    type(matrix_problem_t), intent(out) :: problem !! the problem
    type(fclib_constraints_t), intent(out) :: constraints !! the constraints that were eliminated
    character(len=:), allocatable :: group
    type(error_t), allocatable :: error

    call find_group(file, group)
    if (allocated(file%error)) return
    constraints%is_global = group == '/fclib_global'
    call read_number(file, group//'/spacedim', problem%d)
    if (problem%d /= 2 .and. problem%d /= 3) then
      call refuse(file, group//'/spacedim is '//to_text(problem%d)//', not 2 or 3')
    end if
    if (constraints%is_global) then
      call read_global(file, group, problem, constraints, error)
    else
      call read_local(file, group, problem, constraints, error)
    end if
    if (allocated(error)) call refuse(file, error%message)
    if (allocated(file%error)) return
    if (.not. (all(ieee_is_finite(problem%w%block)) .and. all(ieee_is_finite(problem%q)))) then
      call refuse(file, 'W or q, condensed from '//group//', is not finite')
    end if
    allocate (problem%r(problem%d, problem%n), source=0.0_wp)
  end subroutine read_problem

  !> Path of the one problem of a file.
  subroutine find_group(file, group)
    type(hdf5_file_t), intent(inout) :: file
    character(len=:), allocatable, intent(out) :: group
    type(text_t), allocatable :: names(:)
    integer :: i, found
    character(len=:), allocatable :: rolling

    group = ''
    rolling = ''
    found = 0
    call file%names('/', names)
    do i = 1, size(names)
      if (names(i)%s == 'fclib_local' .or. names(i)%s == 'fclib_global') then
        group = '/'//names(i)%s
        found = found + 1
      else if (index(names(i)%s, 'fclib_') == 1) then
        rolling = names(i)%s
      end if
    end do
    if (found == 1) return
    if (found > 1) then
      call refuse(file, 'the file holds two problems, /fclib_local and /fclib_global, where one is allowed')
    else if (len(rolling) > 0) then
      call refuse(file, 'the problem /'//rolling//' is of a kind (rolling friction) that is not solved here')
    else if (size(names) == 0) then
      call refuse(file, 'the file holds nothing, neither /fclib_local nor /fclib_global')
    else
      call refuse(file, 'the file holds no contact problem, neither /fclib_local nor /fclib_global, but '//joined(names, ', '))
    end if
  end subroutine find_group

  !> Read the vector that has an entry for each contact and direction, and the friction of contacts.
  subroutine read_contacts(file, path, group, d, values, friction)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path, group
    integer, intent(in) :: d
    real(wp), allocatable, intent(out) :: values(:), friction(:)
    integer :: bad

    call read_vector(file, path, -1, values)
    if (.not. allocated(file%error)) then
      if (mod(size(values), d) /= 0) call refuse(file, path//' has '//to_text(size(values))// &
                                                 ' entries, not a multiple of spacedim, '//to_text(d))
    end if
    call read_vector(file, group//'/vectors/mu', size(values)/max(1, d), friction)
    if (allocated(file%error)) return
    bad = findloc(friction >= 0, .false., 1)
    if (bad > 0) call refuse(file, group//'/vectors/mu is negative at contact '//to_text(bad - 1)//', counted from 0')
    bad = findloc(friction <= largest_friction, .false., 1)
    if (bad > 0) call refuse(file, group//'/vectors/mu is above '//to_text(largest_friction, 1)//' at contact '// &
                             to_text(bad - 1)//', counted from 0: refused, '//why_largest_friction)
  end subroutine read_contacts

  !> Read a local problem.
  subroutine read_local(file, group, problem, constraints, error)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: group
    type(matrix_problem_t), intent(inout) :: problem
    type(fclib_constraints_t), intent(inout) :: constraints
    type(error_t), allocatable, intent(out) :: error
    type(sparse_t) :: w
    real(wp), allocatable :: q(:)
    logical :: has_v, has_r

    call read_contacts(file, group//'/vectors/q', group, problem%d, q, problem%friction)
    call read_matrix(file, group//'/W', size(q), size(q), w)
    has_v = holds(file, group//'/V')
    has_r = holds(file, group//'/R')
    if (has_v .neqv. has_r) call refuse(file, group//' holds one of V and R without the other')
    if (has_v) then
      call read_vector(file, group//'/vectors/s', -1, constraints%s)
      constraints%n = size(constraints%s)
      call read_matrix(file, group//'/V', size(q), constraints%n, constraints%v)
      call read_matrix(file, group//'/R', constraints%n, constraints%n, constraints%r)
    end if
    if (allocated(file%error)) return
    if (constraints%n > 0) call eliminate_local(w, q, constraints%v, constraints%r, constraints%s, error)
    if (.not. allocated(error)) call set_local_form(problem, w, q)
  end subroutine read_local

  !> Read a global problem.
  subroutine read_global(file, group, problem, constraints, error)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: group
    type(matrix_problem_t), intent(inout) :: problem
    type(fclib_constraints_t), intent(inout) :: constraints
    type(error_t), allocatable, intent(out) :: error
    integer :: n

    call read_contacts(file, group//'/vectors/w', group, problem%d, problem%offset, problem%friction)
    call read_vector(file, group//'/vectors/f', -1, problem%f)
    n = size(problem%f)
    call read_matrix(file, group//'/M', n, n, problem%mass)
    call read_matrix(file, group//'/H', n, size(problem%offset), problem%h)
    if (holds(file, group//'/G')) then
      call read_vector(file, group//'/vectors/b', -1, constraints%b)
      constraints%n = size(constraints%b)
      call read_matrix(file, group//'/G', n, constraints%n, constraints%g)
    else
      allocate (constraints%b(0))
      constraints%g = no_columns(n)
    end if
    if (allocated(file%error)) return
    call condense_constrained(problem, constraints%g, constraints%b, error)
    ! Solvers that work on M and H have no constraints: they get W alone.
    problem%has_global = constraints%n == 0
  end subroutine read_global

  !> Take the impulses of the first guess that is finite and not zero everywhere.
  subroutine read_guess(file, problem, has_guess)
    type(hdf5_file_t), intent(inout) :: file
    type(matrix_problem_t), intent(inout) :: problem
    logical, intent(out) :: has_guess
    real(wp), allocatable :: r(:)
    integer :: number, i

    has_guess = .false.
    if (allocated(file%error)) return
    if (.not. holds(file, '/guesses/number_of_guesses')) return
    call read_number(file, '/guesses/number_of_guesses', number)
    do i = 1, number
      if (.not. holds(file, '/guesses/'//to_text(i)//'/r')) exit
      call usable_impulses(file, '/guesses/'//to_text(i)//'/r', problem%d*problem%n, r, has_guess)
      if (.not. has_guess) cycle
      problem%r = reshape(r, [problem%d, problem%n])
      exit
    end do
  end subroutine read_guess

  !> Read impulses of a solution or guess, and whether they are of use: finite, and not zero everywhere.
  subroutine usable_impulses(file, path, m, r, are_usable)
    type(hdf5_file_t), intent(inout) :: file !! open file; its error is set when the number of entries is wrong
    character(len=*), intent(in) :: path !! dataset
    integer, intent(in) :: m !! entries that it must have
    real(wp), allocatable, intent(out) :: r(:) !! impulses [N s]
    logical, intent(out) :: are_usable !! can they be used?

    are_usable = .false.
    call file%get(path, r)
    if (allocated(file%error)) return
    if (size(r) /= m) then
      call refuse(file, path//' has '//to_text(size(r))//' entries, not '//to_text(m))
    else if (all(ieee_is_finite(r))) then
      are_usable = any(abs(r) > 0)
    end if
  end subroutine usable_impulses
end module sg_fclib_read
