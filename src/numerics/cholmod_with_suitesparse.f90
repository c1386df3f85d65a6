!> Cholesky factors of one matrix by CHOLMOD [Chen2008], reached through cholmod_with_suitesparse.c.
module sg_cholmod_with_suitesparse
  use, intrinsic :: iso_c_binding, only: c_double, c_funptr, c_int, c_null_ptr, c_ptr
  use sg_error, only: error_t, exit_failure, fail
  use sg_kinds, only: wp
  use sg_library, only: find_procedures
  use sg_library_files, only: cholmod_file
  use sg_text, only: to_text
  implicit none
  private
  public :: cholmod_analyse, cholmod_factorise, cholmod_solve, cholmod_free

  !> CHOLMOD's procedures in the order of `struct cholmod` in cholmod_with_suitesparse.c
  character(len=*), parameter :: names(7) = [character(len=19) :: 'cholmod_start', 'cholmod_finish', 'cholmod_analyze', &
                                             'cholmod_factorize', 'cholmod_solve2', 'cholmod_free_factor', 'cholmod_free_dense']
  !> What follows them: procedures of OpenMP, which CHOLMOD may bring
  character(len=*), parameter :: openmp_names(2) = [character(len=25) :: 'omp_get_max_active_levels', 'omp_set_max_active_levels']
  !> Answers of cholmod_with_suitesparse.c
  integer(c_int), parameter :: is_done = 0, not_definite = 1, no_memory = 2

  interface
    !> Analyse a pattern.
    function splitgrain_cholmod_analyse(call_of, n, first, column, factors, entries, flops) &
      bind(c, name='splitgrain_cholmod_analyse') result(status)
      import :: c_double, c_funptr, c_int, c_ptr
      type(c_funptr), intent(in) :: call_of(*)
      integer(c_int), value :: n
      integer(c_int), intent(in) :: first(*), column(*)
      type(c_ptr), intent(out) :: factors
      real(c_double), intent(out) :: entries, flops
      integer(c_int) :: status
    end function splitgrain_cholmod_analyse
    !> Factorise a matrix of the pattern.
    function splitgrain_cholmod_factorise(factors, n, first, column, value, lost) &
      bind(c, name='splitgrain_cholmod_factorise') result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: factors
      integer(c_int), value :: n
      integer(c_int), intent(in) :: first(*), column(*)
      real(c_double), intent(in) :: value(*)
      integer(c_int), intent(out) :: lost
      integer(c_int) :: status
    end function splitgrain_cholmod_factorise
    function splitgrain_cholmod_solve(factors, n, k, b, x) bind(c, name='splitgrain_cholmod_solve') result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: factors
      integer(c_int), value :: n, k
      real(c_double), intent(in) :: b(*)
      real(c_double), intent(out) :: x(*)
      integer(c_int) :: status
    end function splitgrain_cholmod_solve
    subroutine splitgrain_cholmod_free(factors) bind(c, name='splitgrain_cholmod_free')
      import :: c_ptr
      type(c_ptr), value :: factors
    end subroutine splitgrain_cholmod_free
  end interface

contains

  !> Analyse the pattern of a symmetric matrix, of which the lower triangle counts.
  subroutine cholmod_analyse(first, column, factors, entries, flops, error)
    integer(c_int), intent(in), contiguous :: first(:) !! where each row begins, from 0, shape (n + 1)
    integer(c_int), intent(in), contiguous :: column(:) !! column of each entry, from 0
    type(c_ptr), intent(out) :: factors !! factors without values
    real(wp), intent(out) :: entries !! entries of the factor
    real(wp), intent(out) :: flops !! floating-point operations of a factorisation
    type(error_t), allocatable, intent(out) :: error !! what failed
    type(c_funptr) :: call_of(size(names) + size(openmp_names))
    type(error_t), allocatable :: has_none

    factors = c_null_ptr
    entries = 0
    flops = 0
    call find_procedures('CHOLMOD, which factorises large systems,', cholmod_file, names, call_of(:size(names)), error)
    if (allocated(error)) return
    call find_procedures('OpenMP', cholmod_file, openmp_names, call_of(size(names) + 1:), has_none)
    call check(splitgrain_cholmod_analyse(call_of, int(size(first) - 1, c_int), first, column, factors, entries, flops), &
               size(first) - 1, 0, error)
  end subroutine cholmod_analyse

  !> Factorise a matrix of the pattern analysed.
  subroutine cholmod_factorise(factors, first, column, value, lost, error)
    type(c_ptr), intent(in) :: factors !! factors; get values
    integer(c_int), intent(in), contiguous :: first(:) !! where each row begins, from 0, shape (n + 1)
    integer(c_int), intent(in), contiguous :: column(:) !! column of each entry, from 0
    real(wp), intent(in), contiguous :: value(:) !! value of each entry
    integer, intent(out) :: lost !! column at which the matrix proves not to be positive definite; 0 where it is
    type(error_t), allocatable, intent(out) :: error !! what failed
    integer(c_int) :: status, c_lost

    status = splitgrain_cholmod_factorise(factors, int(size(first) - 1, c_int), first, column, value, c_lost)
    lost = int(c_lost)
    call check(status, size(first) - 1, lost, error)
  end subroutine cholmod_factorise

  !> An error for an answer of cholmod_with_suitesparse.c other than `is_done`.
  subroutine check(status, n, lost, error)
    integer(c_int), intent(in) :: status
    integer, intent(in) :: n, lost
    type(error_t), allocatable, intent(out) :: error

    select case (status)
    case (is_done)
    case (not_definite)
      call fail(error, 'a matrix of '//to_text(n)//' unknowns is not positive definite: column '//to_text(lost), &
                code=exit_failure)
    case (no_memory)
      call fail(error, 'the factors of a matrix of '//to_text(n)//' unknowns do not fit into memory', code=exit_failure)
    case default
      call fail(error, 'CHOLMOD cannot factorise a matrix of '//to_text(n)//' unknowns', code=exit_failure)
    end select
  end subroutine check

  !> Solve for several right-hand sides.
  subroutine cholmod_solve(factors, b, x)
    type(c_ptr), intent(in) :: factors !! factors with values
    real(wp), intent(in), contiguous :: b(:, :) !! right-hand sides, shape (n, k)
    real(wp), intent(out), contiguous :: x(:, :) !! solutions, shape (n, k)

    if (splitgrain_cholmod_solve(factors, int(size(b, 1), c_int), int(size(b, 2), c_int), b, x) /= is_done) x = 0
  end subroutine cholmod_solve

  !> Give factors back.
  subroutine cholmod_free(factors)
    type(c_ptr), intent(inout) :: factors !! factors; null afterwards

    call splitgrain_cholmod_free(factors)
    factors = c_null_ptr
  end subroutine cholmod_free
end module sg_cholmod_with_suitesparse
