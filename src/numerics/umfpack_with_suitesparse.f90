!> LU factors of one matrix by UMFPACK, of SuiteSparse, through its C calls.
!!
!! UMFPACK takes compressed columns: the rows of A are the columns of A^T, which it is asked to solve with transposed.
module sg_umfpack_with_suitesparse
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_procpointer, c_funptr, c_int, c_null_ptr, c_ptr
  use sg_error, only: error_t, exit_failure, fail
  use sg_kinds, only: wp
  use sg_library, only: find_procedures
  use sg_library_files, only: umfpack_file
  use sg_text, only: to_text
  implicit none
  private
  public :: umfpack_analyse, umfpack_factorise, umfpack_free, umfpack_solve

  !> Answers and systems of umfpack.h
  integer(c_int), parameter :: umfpack_ok = 0, umfpack_singular = 1, umfpack_out_of_memory = -1, umfpack_at = 1
  !> Lengths of UMFPACK's settings and of its report
  integer, parameter :: n_control = 20, n_info = 90
  !> Entry of the settings that bounds steps of iterative refinement: methods that ask for solutions correct them by their own next
  !! steps, and each refinement takes as long as a solution
  integer, parameter :: refinements = 8
  !> Entries of the report that count entries of L + U and floating-point operations: where pivots stay on the diagonal
  !! (negative where the analysis does not count them), bounds by the analysis, and of the factors made
  integer, parameter :: diagonal_entries = 37, diagonal_flops = 38, most_flops = 23, most_entries(2) = [24, 25], &
                        made_flops = 43, made_entries(2) = [44, 45]

  !> Its procedures, and their places in `call_of`
  character(len=*), parameter :: names(6) = [character(len=24) :: 'umfpack_di_defaults', 'umfpack_di_symbolic', &
                                  'umfpack_di_numeric', 'umfpack_di_solve', 'umfpack_di_free_symbolic', 'umfpack_di_free_numeric']
  integer, parameter :: defaults = 1, symbolic = 2, numeric = 3, solve = 4, free_symbolic = 5, free_numeric = 6

  abstract interface
    subroutine umfpack_di_defaults(control) bind(c)
      import :: c_double
      real(c_double), intent(out) :: control(*)
    end subroutine umfpack_di_defaults
    function umfpack_di_symbolic(m, n, ap, ai, ax, symbolic, control, info) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      integer(c_int), value :: m, n
      integer(c_int), intent(in) :: ap(*), ai(*)
      real(c_double), intent(in) :: ax(*), control(*)
      type(c_ptr), intent(out) :: symbolic
      real(c_double), intent(out) :: info(*)
      integer(c_int) :: status
    end function umfpack_di_symbolic
    function umfpack_di_numeric(ap, ai, ax, symbolic, numeric, control, info) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      integer(c_int), intent(in) :: ap(*), ai(*)
      real(c_double), intent(in) :: ax(*), control(*)
      type(c_ptr), value :: symbolic
      type(c_ptr), intent(out) :: numeric
      real(c_double), intent(out) :: info(*)
      integer(c_int) :: status
    end function umfpack_di_numeric
    function umfpack_di_solve(sys, ap, ai, ax, x, b, numeric, control, info) bind(c) result(status)
      import :: c_double, c_int, c_ptr
      integer(c_int), value :: sys
      integer(c_int), intent(in) :: ap(*), ai(*)
      real(c_double), intent(in) :: ax(*), b(*), control(*)
      real(c_double), intent(out) :: x(*), info(*)
      type(c_ptr), value :: numeric
      integer(c_int) :: status
    end function umfpack_di_solve
    subroutine umfpack_di_free(object) bind(c)
      import :: c_ptr
      type(c_ptr), intent(inout) :: object
    end subroutine umfpack_di_free
  end interface

contains

  !> Analyse the places of entries of a matrix.
  subroutine umfpack_analyse(call_of, first, column, value, analysis, entries, flops, error)
    type(c_funptr), intent(inout) :: call_of(:) !! procedures of UMFPACK; found where they are not yet
    integer(c_int), intent(in), contiguous :: first(:) !! where each row begins, from 0, shape (n + 1)
    integer(c_int), intent(in), contiguous :: column(:) !! column of each entry, from 0
    real(wp), intent(in), contiguous :: value(:) !! value of each entry
    type(c_ptr), intent(out) :: analysis !! the analysis
    real(wp), intent(out) :: entries !! entries of the factors expected
    real(wp), intent(out) :: flops !! floating-point operations of a factorisation expected
    type(error_t), allocatable, intent(out) :: error !! what failed
    procedure(umfpack_di_symbolic), pointer :: analyse
    real(c_double) :: control(n_control), info(n_info)
    integer(c_int) :: n

    analysis = c_null_ptr
    entries = 0
    flops = 0
    if (.not. c_associated(call_of(1))) then
      call find_procedures('UMFPACK, which factorises large systems,', umfpack_file, names, call_of, error)
      if (allocated(error)) return
    end if
    n = int(size(first) - 1, c_int)
    call take_defaults(call_of, control)
    call c_f_procpointer(call_of(symbolic), analyse)
    call check(analyse(n, n, first, column, value, analysis, control, info), size(first) - 1, error)
    if (allocated(error)) return
    if (info(diagonal_flops) >= 0) then
      entries = info(diagonal_entries)
      flops = info(diagonal_flops)
    else
      entries = sum(info(most_entries))
      flops = info(most_flops)
    end if
  end subroutine umfpack_analyse

  !> Factorise a matrix with its entries where the analysis had them.
  subroutine umfpack_factorise(call_of, analysis, first, column, value, factors, entries, flops, error)
    type(c_funptr), intent(in) :: call_of(:) !! procedures of UMFPACK
    type(c_ptr), intent(in) :: analysis !! the analysis
    integer(c_int), intent(in), contiguous :: first(:) !! where each row begins, from 0, shape (n + 1)
    integer(c_int), intent(in), contiguous :: column(:) !! column of each entry, from 0
    real(wp), intent(in), contiguous :: value(:) !! value of each entry
    type(c_ptr), intent(inout) :: factors !! the factors; former ones are given back
    real(wp), intent(out) :: entries !! entries of the factors
    real(wp), intent(out) :: flops !! floating-point operations spent
    type(error_t), allocatable, intent(out) :: error !! what failed
    procedure(umfpack_di_numeric), pointer :: make_factors
    real(c_double) :: control(n_control), info(n_info)

    if (c_associated(factors)) call free_by(call_of(free_numeric), factors)
    call take_defaults(call_of, control)
    call c_f_procpointer(call_of(numeric), make_factors)
    call check(make_factors(first, column, value, analysis, factors, control, info), size(first) - 1, error)
    entries = sum(info(made_entries))
    flops = info(made_flops)
  end subroutine umfpack_factorise

  !> An error for an answer of UMFPACK other than `umfpack_ok`.
  subroutine check(status, n, error)
    integer(c_int), intent(in) :: status
    integer, intent(in) :: n
    type(error_t), allocatable, intent(out) :: error

    select case (status)
    case (umfpack_ok)
    case (umfpack_singular)
      call fail(error, 'a matrix of '//to_text(n)//' unknowns is singular', code=exit_failure)
    case (umfpack_out_of_memory)
      call fail(error, 'the factors of a matrix of '//to_text(n)//' unknowns do not fit into memory', code=exit_failure)
    case default
      call fail(error, 'UMFPACK cannot factorise a matrix of '//to_text(n)//' unknowns (its answer is '// &
                to_text(int(status))//')', code=exit_failure)
    end select
  end subroutine check

  !> Solve A x = b by factors.
  subroutine umfpack_solve(call_of, first, column, value, factors, b, x)
    type(c_funptr), intent(in) :: call_of(:) !! procedures of UMFPACK
    integer(c_int), intent(in), contiguous :: first(:) !! where each row begins, from 0, shape (n + 1)
    integer(c_int), intent(in), contiguous :: column(:) !! column of each entry, from 0
    real(wp), intent(in), contiguous :: value(:) !! value of each entry
    type(c_ptr), intent(in) :: factors !! the factors
    real(wp), intent(in), contiguous :: b(:) !! right-hand side, shape (n)
    real(wp), intent(out), contiguous :: x(:) !! solution, shape (n)
    procedure(umfpack_di_solve), pointer :: solve_by
    real(c_double) :: control(n_control), info(n_info)

    call take_defaults(call_of, control)
    control(refinements) = 0
    call c_f_procpointer(call_of(solve), solve_by)
    if (solve_by(umfpack_at, first, column, value, x, b, factors, control, info) /= umfpack_ok) x = 0
  end subroutine umfpack_solve

  !> Give an analysis and factors back.
  subroutine umfpack_free(call_of, analysis, factors)
    type(c_funptr), intent(in) :: call_of(:) !! procedures of UMFPACK
    type(c_ptr), intent(inout) :: analysis !! the analysis; null afterwards
    type(c_ptr), intent(inout) :: factors !! the factors; null afterwards

    if (c_associated(factors)) call free_by(call_of(free_numeric), factors)
    if (c_associated(analysis)) call free_by(call_of(free_symbolic), analysis)
    factors = c_null_ptr
    analysis = c_null_ptr
  end subroutine umfpack_free

  !> Default settings.
  subroutine take_defaults(call_of, control)
    type(c_funptr), intent(in) :: call_of(:)
    real(c_double), intent(out) :: control(:)
    procedure(umfpack_di_defaults), pointer :: set_defaults

    call c_f_procpointer(call_of(defaults), set_defaults)
    call set_defaults(control)
  end subroutine take_defaults

  !> Give back what one of UMFPACK's procedures frees.
  subroutine free_by(address, object)
    type(c_funptr), intent(in) :: address
    type(c_ptr), intent(inout) :: object
    procedure(umfpack_di_free), pointer :: free

    call c_f_procpointer(address, free)
    call free(object)
  end subroutine free_by
end module sg_umfpack_with_suitesparse
