!> Factors of a sparse matrix, LU or Cholesky, without naming a library.
!!
!! The bodies live in `sparse_factor_with_suitesparse` (UMFPACK, CHOLMOD) or `sparse_factor_without_suitesparse` (full factors for
!! small systems), chosen by CMake. Whoever factorises frees: a library holds the factors.
module sg_sparse_factor
  use, intrinsic :: iso_c_binding, only: c_funptr, c_int, c_null_funptr, c_null_ptr, c_ptr
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_sparse, only: sparse_t
  implicit none
  private
  public :: sparse_factor_t, find_sparse_library, has_sparse_library, largest_full

  !> Most unknowns of a system whose factors are full: without a library there is no other way
  integer, parameter :: largest_full = 1500

  !> Factors of a matrix; those of a matrix with the same places of entries are made again without a new analysis
  type :: sparse_factor_t
    !> Unknowns; 0 when there are no factors
    integer :: n = 0
    !> Are the matrices symmetric and positive definite? Then the factors are those of Cholesky, and the lower triangle counts. To
    !! be set before the first factorisation
    logical :: is_definite = .false.
    !> Column at which a matrix proved not to be positive definite; 0 where it is, or need not be
    integer :: failed_column = 0
    !> Analyses of places of entries and factorisations so far
    integer :: analyses = 0, factorisations = 0
    !> Effort of all analyses, factorisations and solutions so far, that of the last factorisation or of one that was refused,
    !! and the most that one may take; each in operations of a sweep that take as long
    real(wp) :: operations = 0, price = 0, most_operations = huge(1.0_wp)
    !> Was the last one refused because it takes more?
    logical :: is_too_dear = .false.
    !> Entries of the factors
    real(wp), private :: entries = 0
    !> Was the present analysis made for matrices that are positive definite?
    logical, private :: has_definite = .false.
    !> Analysis and factors of the library
    type(c_ptr), private :: symbolic = c_null_ptr, numeric = c_null_ptr
    !> The procedures of the library
    type(c_funptr), private :: call_of(6) = c_null_funptr
    !> Entries of the matrix by row, counted from 0: the library asks for them with each solution
    integer(c_int), allocatable, private :: first(:), column(:)
    real(wp), allocatable, private :: value(:)
    !> Full factors and their exchanged rows, where there is no library
    real(wp), allocatable, private :: full(:, :)
    integer, allocatable, private :: pivot(:)
  contains
    procedure :: factorise => sparse_factor_factorise
    procedure, private :: solve_one, solve_several
    !> Solve A x = b, for one right-hand side of shape (n) or several of shape (n, k), by factors that were made without an error
    generic :: solve => solve_one, solve_several
    procedure :: free => sparse_factor_free
  end type sparse_factor_t

  interface
    !> Was the program built with a sparse library?
    module function has_sparse_library() result(has)
      logical :: has
    end function has_sparse_library

    !> Make sure that the sparse library is there, if the program was built with one. It is not opened for that.
    module subroutine find_sparse_library(error)
      type(error_t), allocatable, intent(out) :: error !! set when it is not
    end subroutine find_sparse_library

    !> Factorise a square matrix, symmetric or not; fails where it is singular, too large for this build, or too dear.
    module subroutine sparse_factor_factorise(self, matrix, error)
      class(sparse_factor_t), intent(inout) :: self
      type(sparse_t), intent(in) :: matrix !! the matrix
      type(error_t), allocatable, intent(out) :: error !! what failed
    end subroutine sparse_factor_factorise

    !> Solve for k right-hand sides.
    module subroutine solve_columns(self, k, b, x)
      class(sparse_factor_t), intent(inout) :: self
      integer, intent(in) :: k !! right-hand sides
      real(wp), intent(in) :: b(self%n, k) !! right-hand sides
      real(wp), intent(out) :: x(self%n, k) !! solutions
    end subroutine solve_columns

    !> Give the factors back.
    module subroutine sparse_factor_free(self)
      class(sparse_factor_t), intent(inout) :: self
    end subroutine sparse_factor_free
  end interface

contains

  !> Solve for one right-hand side.
  subroutine solve_one(self, b, x)
    class(sparse_factor_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: b(:) !! right-hand side, shape (n)
    real(wp), intent(out), contiguous :: x(:) !! solution, shape (n)

    call solve_columns(self, 1, b, x)
  end subroutine solve_one

  !> Solve for several right-hand sides.
  subroutine solve_several(self, b, x)
    class(sparse_factor_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: b(:, :) !! right-hand sides, shape (n, k)
    real(wp), intent(out), contiguous :: x(:, :) !! solutions, shape (n, k)

    call solve_columns(self, size(b, 2), b, x)
  end subroutine solve_several
end module sg_sparse_factor
