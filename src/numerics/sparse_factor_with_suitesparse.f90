!> Factors by SuiteSparse: UMFPACK (umfpack_with_suitesparse.f90) or, where a matrix is symmetric and positive definite, CHOLMOD
!! (cholmod_with_suitesparse.f90), about half the operations.
submodule(sg_sparse_factor) sparse_factor_with_suitesparse
  use, intrinsic :: iso_c_binding, only: c_associated, c_f_procpointer
  use sg_cholmod_with_suitesparse, only: cholmod_analyse, cholmod_factorise, cholmod_free, cholmod_solve
  use sg_error, only: exit_failure, fail
  use sg_library, only: find_procedures, is_there
  use sg_library_files, only: cholmod_file, umfpack_file
  use sg_umfpack_with_suitesparse, only: umfpack_analyse, umfpack_factorise, umfpack_free, umfpack_solve
  implicit none

  !> Time of the work in operations of a sweep (0.19 ns where both were measured: doc/verification_solvers.md, "What operations
  !! cost"), by library
  type :: prices_t
    !> Analysis per entry of the matrix
    real(wp) :: per_analysed
    !> Factorisation per unknown, entry of the factors and floating-point operation
    real(wp) :: per_factorised(3)
    !> Solution per unknown and entry of the factors
    real(wp) :: per_solved(2)
  end type prices_t

  !> Opening a library, once per process, is left out
  type(prices_t), parameter :: of_umfpack = prices_t(130.0_wp, [2100.0_wp, 95.0_wp, 0.14_wp], [500.0_wp, 14.0_wp]), &
                               of_cholmod = prices_t(200.0_wp, [140.0_wp, 68.0_wp, 0.085_wp], [0.0_wp, 5.0_wp])

  abstract interface
    subroutine openblas_set_num_threads(n) bind(c)
      import :: c_int
      integer(c_int), value :: n
    end subroutine openblas_set_num_threads
  end interface

contains

  module procedure has_sparse_library
  has = .true.
  end procedure has_sparse_library

  module procedure find_sparse_library
  call is_there('UMFPACK, which factorises large systems,', umfpack_file, error)
  if (.not. allocated(error)) call is_there('CHOLMOD, which factorises large systems,', cholmod_file, error)
  end procedure find_sparse_library

  module procedure sparse_factor_factorise
  real(wp) :: entries, flops

  self%failed_column = 0
  if (.not. has_same_places(self, matrix)) call analyse(self, matrix, error)
  if (allocated(error)) then
    call self%free()
    return
  end if
  self%is_too_dear = self%price > self%most_operations
  if (self%is_too_dear) then
    call fail(error, 'a factorisation takes more operations than it may', code=exit_failure)
    return
  end if
  if (self%has_definite) then
    call cholmod_factorise(self%symbolic, self%first, self%column, matrix%value, self%failed_column, error)
  else
    self%value = matrix%value
    call umfpack_factorise(self%call_of, self%symbolic, self%first, self%column, self%value, self%numeric, entries, flops, error)
    if (.not. allocated(error)) call set_price(self, entries, flops)
  end if
  self%factorisations = self%factorisations + 1
  self%operations = self%operations + self%price
  if (allocated(error)) call self%free()
  end procedure sparse_factor_factorise

  !> Analyse places of entries, and set the price of a factorisation that is about to be made.
  subroutine analyse(self, matrix, error)
    class(sparse_factor_t), intent(inout) :: self
    type(sparse_t), intent(in) :: matrix
    type(error_t), allocatable, intent(out) :: error
    type(prices_t) :: prices
    real(wp) :: entries, flops

    call self%free()
    self%n = matrix%n_rows
    self%has_definite = self%is_definite
    self%first = int(matrix%first - 1, c_int)
    self%column = int(matrix%column - 1, c_int)
    if (self%has_definite) then
      call cholmod_analyse(self%first, self%column, self%symbolic, entries, flops, error)
      call use_one_thread(cholmod_file)
    else
      call umfpack_analyse(self%call_of, self%first, self%column, matrix%value, self%symbolic, entries, flops, error)
      call use_one_thread(umfpack_file)
    end if
    prices = prices_of(self)
    self%analyses = self%analyses + 1
    self%operations = self%operations + prices%per_analysed*real(size(self%column), wp)
    if (.not. allocated(error)) call set_price(self, entries, flops)
  end subroutine analyse

  !> Let OpenBLAS, where a library brought it, use one thread: its waiting threads spend time that other ranks need, and the last
  !! digits of factors depend on their number.
  subroutine use_one_thread(file)
    character(len=*), intent(in) :: file
    type(c_funptr) :: address(1)
    type(error_t), allocatable :: has_other
    procedure(openblas_set_num_threads), pointer :: set_threads

    call find_procedures('OpenBLAS', file, ['openblas_set_num_threads'], address, has_other)
    if (allocated(has_other)) return
    call c_f_procpointer(address(1), set_threads)
    call set_threads(1_c_int)
  end subroutine use_one_thread

  !> Price list of the library that makes the factors.
  pure type(prices_t) function prices_of(self) result(prices)
    type(sparse_factor_t), intent(in) :: self

    prices = of_umfpack
    if (self%has_definite) prices = of_cholmod
  end function prices_of

  !> Set the price of a factorisation, and the entries of the factors.
  pure subroutine set_price(self, entries, flops)
    type(sparse_factor_t), intent(inout) :: self
    real(wp), intent(in) :: entries, flops
    type(prices_t) :: prices

    prices = prices_of(self)
    self%entries = entries
    self%price = dot_product(prices%per_factorised, [real(self%n, wp), entries, flops])
  end subroutine set_price

  !> Has a matrix its entries where the analysed one had them, and is it to be factorised in the same way?
  pure logical function has_same_places(self, matrix) result(has)
    class(sparse_factor_t), intent(in) :: self
    type(sparse_t), intent(in) :: matrix

    has = c_associated(self%symbolic) .and. self%n == matrix%n_rows .and. (self%is_definite .eqv. self%has_definite)
    if (has) has = size(self%column) == size(matrix%column)
    if (has) has = all(self%first == matrix%first - 1)
    if (has) has = all(self%column == matrix%column - 1)
  end function has_same_places

  module procedure solve_columns
  type(prices_t) :: prices
  integer :: column

  if (self%has_definite) then
    call cholmod_solve(self%symbolic, b, x)
  else
    do column = 1, k
      call umfpack_solve(self%call_of, self%first, self%column, self%value, self%numeric, b(:, column), x(:, column))
    end do
  end if
  prices = prices_of(self)
  self%operations = self%operations + real(k, wp)*dot_product(prices%per_solved, [real(self%n, wp), self%entries])
  end procedure solve_columns

  module procedure sparse_factor_free
  if (self%has_definite) then
    call cholmod_free(self%symbolic)
  else
    call umfpack_free(self%call_of, self%symbolic, self%numeric)
  end if
  if (allocated(self%first)) deallocate (self%first)
  if (allocated(self%column)) deallocate (self%column)
  if (allocated(self%value)) deallocate (self%value)
  self%n = 0
  end procedure sparse_factor_free
end submodule sparse_factor_with_suitesparse
