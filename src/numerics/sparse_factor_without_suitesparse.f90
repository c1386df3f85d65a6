!> A build without a sparse library: full factors of small systems, and a clear sentence for large ones.
submodule(sg_sparse_factor) sparse_factor_without_suitesparse
  use sg_dense_factor, only: dense_cholesky, dense_cholesky_solve, dense_factorise, dense_solve
  use sg_error, only: exit_failure, fail
  use sg_text, only: to_text
  implicit none

  !> Operations of a sweep that take as long as a product and a sum of full factors
  real(wp), parameter :: operations_per_product = 4

contains

  module procedure has_sparse_library
  has = .false.
  end procedure has_sparse_library

  module procedure find_sparse_library
  end procedure find_sparse_library

  module procedure sparse_factor_factorise
  logical :: is_singular
  integer :: i, e

  if (matrix%n_rows > largest_full) then
    call fail(error, 'a system of '//to_text(matrix%n_rows)//' unknowns needs SuiteSparse, which this build leaves out: '// &
              'without it at most '//to_text(largest_full)//' unknowns can be solved for', code=exit_failure)
    return
  end if
  self%price = operations_per_product*real(matrix%n_rows, wp)**3/merge(6.0_wp, 3.0_wp, self%is_definite)
  self%is_too_dear = self%price > self%most_operations
  if (self%is_too_dear) then
    call fail(error, 'a factorisation takes more operations than it may', code=exit_failure)
    return
  end if
  if (self%n /= matrix%n_rows) then
    call self%free()
    self%n = matrix%n_rows
    allocate (self%full(self%n, self%n), self%pivot(self%n))
    self%analyses = self%analyses + 1
  end if
  self%full = 0
  do i = 1, self%n
    do e = matrix%first(i), matrix%first(i + 1) - 1
      self%full(i, matrix%column(e)) = self%full(i, matrix%column(e)) + matrix%value(e)
    end do
  end do
  self%failed_column = 0
  self%has_definite = self%is_definite
  self%factorisations = self%factorisations + 1
  self%operations = self%operations + self%price
  if (self%has_definite) then
    call dense_cholesky(self%full, self%failed_column)
    if (self%failed_column > 0) call fail(error, 'a matrix of '//to_text(self%n)//' unknowns is not positive definite: column '// &
                                 to_text(self%failed_column), code=exit_failure)
  else
    call dense_factorise(self%full, self%pivot, is_singular)
    if (is_singular) call fail(error, 'a matrix of '//to_text(self%n)//' unknowns is singular', code=exit_failure)
  end if
  end procedure sparse_factor_factorise

  module procedure solve_columns
  integer :: column

  x = b
  do column = 1, k
    if (self%has_definite) then
      call dense_cholesky_solve(self%full, x(:, column))
    else
      call dense_solve(self%full, self%pivot, x(:, column))
    end if
  end do
  self%operations = self%operations + operations_per_product*real(k, wp)*real(self%n, wp)**2
  end procedure solve_columns

  module procedure sparse_factor_free
  if (allocated(self%full)) deallocate (self%full, self%pivot)
  self%n = 0
  end procedure sparse_factor_free
end submodule sparse_factor_without_suitesparse
