!> Factors by UMFPACK, of SuiteSparse, through its C calls.
!!
!! UMFPACK takes compressed columns: the rows of A are the columns of A^T, which it is asked to solve with transposed.
submodule(sg_sparse_factor) sparse_factor_with_suitesparse
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_procpointer
  use sg_error, only: exit_failure, fail
  use sg_library, only: find_procedures, is_there
  use sg_library_files, only: umfpack_file
  use sg_text, only: to_text
  implicit none

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

  !> Time of UMFPACK's work in operations of a sweep (0.19 ns where both were measured: doc/verification_solvers.md, "What
  !! operations cost"): analysis per entry of the matrix; factorisation per unknown, entry of the factors and floating-point
  !! operation; solution per unknown and entry of the factors. Opening the library, once per process, is left out
  real(wp), parameter :: per_analysed = 130, per_factorised(3) = [2100.0_wp, 95.0_wp, 0.14_wp], &
                         per_solved(2) = [500.0_wp, 14.0_wp]

  !> What people call it
  character(len=*), parameter :: library = 'UMFPACK, which factorises large systems,'
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

  module procedure has_sparse_library
  has = .true.
  end procedure has_sparse_library

  module procedure find_sparse_library
  call is_there(library, umfpack_file, error)
  end procedure find_sparse_library

  module procedure sparse_factor_factorise
  procedure(umfpack_di_defaults), pointer :: set_defaults
  procedure(umfpack_di_symbolic), pointer :: analyse
  procedure(umfpack_di_numeric), pointer :: make_factors
  real(c_double) :: control(n_control), info(n_info)
  integer(c_int) :: status

  if (.not. c_associated(self%call_of(1))) call find_procedures(library, umfpack_file, names, self%call_of, error)
  if (allocated(error)) return
  call c_f_procpointer(self%call_of(defaults), set_defaults)
  call c_f_procpointer(self%call_of(symbolic), analyse)
  call c_f_procpointer(self%call_of(numeric), make_factors)
  call set_defaults(control)
  if (c_associated(self%numeric)) call free_by(self%call_of(free_numeric), self%numeric)
  status = umfpack_ok
  if (.not. has_same_places(self, matrix)) then
    call self%free()
    self%n = matrix%n_rows
    self%first = int(matrix%first - 1, c_int)
    self%column = int(matrix%column - 1, c_int)
    status = analyse(int(self%n, c_int), int(self%n, c_int), self%first, self%column, matrix%value, &
                     self%symbolic, control, info)
    self%analyses = self%analyses + 1
    self%operations = self%operations + per_analysed*real(size(self%column), wp)
    if (status == umfpack_ok) call expect_factors(self, info)
  end if
  self%is_too_dear = status == umfpack_ok .and. self%price > self%most_operations
  if (self%is_too_dear) then
    call fail(error, 'a factorisation takes more operations than it may', code=exit_failure)
    return
  end if
  self%value = matrix%value
  if (status == umfpack_ok) then
    status = make_factors(self%first, self%column, self%value, self%symbolic, self%numeric, control, info)
    self%factorisations = self%factorisations + 1
    if (status == umfpack_ok) call set_price(self, sum(info(made_entries)), info(made_flops))
    self%operations = self%operations + self%price
  end if
  select case (status)
  case (umfpack_ok)
  case (umfpack_singular)
    call fail(error, 'a matrix of '//to_text(self%n)//' unknowns is singular', code=exit_failure)
  case (umfpack_out_of_memory)
    call fail(error, 'the factors of a matrix of '//to_text(self%n)//' unknowns do not fit into memory', code=exit_failure)
  case default
    call fail(error, 'UMFPACK cannot factorise a matrix of '//to_text(self%n)//' unknowns (its answer is '// &
              to_text(int(status))//')', code=exit_failure)
  end select
  if (allocated(error)) call self%free()
  end procedure sparse_factor_factorise

  !> Set the price of a factorisation that is about to be made.
  pure subroutine expect_factors(self, info)
    type(sparse_factor_t), intent(inout) :: self
    real(c_double), intent(in) :: info(:)

    if (info(diagonal_flops) >= 0) then
      call set_price(self, info(diagonal_entries), info(diagonal_flops))
    else
      call set_price(self, sum(info(most_entries)), info(most_flops))
    end if
  end subroutine expect_factors

  !> Set the price of a factorisation, and the entries of the factors.
  pure subroutine set_price(self, entries, flops)
    type(sparse_factor_t), intent(inout) :: self
    real(wp), intent(in) :: entries, flops

    self%entries = entries
    self%price = dot_product(per_factorised, [real(self%n, wp), entries, flops])
  end subroutine set_price

  !> Has a matrix its entries where the analysed one had them?
  pure logical function has_same_places(self, matrix) result(has)
    class(sparse_factor_t), intent(in) :: self
    type(sparse_t), intent(in) :: matrix

    has = c_associated(self%symbolic) .and. self%n == matrix%n_rows
    if (has) has = size(self%column) == size(matrix%column)
    if (has) has = all(self%first == matrix%first - 1)
    if (has) has = all(self%column == matrix%column - 1)
  end function has_same_places

  module procedure sparse_factor_solve
  procedure(umfpack_di_defaults), pointer :: set_defaults
  procedure(umfpack_di_solve), pointer :: solve_by
  real(c_double) :: control(n_control), info(n_info)
  integer(c_int) :: status

  call c_f_procpointer(self%call_of(defaults), set_defaults)
  call c_f_procpointer(self%call_of(solve), solve_by)
  call set_defaults(control)
  control(refinements) = 0
  status = solve_by(umfpack_at, self%first, self%column, self%value, x, b, self%numeric, control, info)
  if (status /= umfpack_ok) x = 0
  self%operations = self%operations + dot_product(per_solved, [real(self%n, wp), self%entries])
  end procedure sparse_factor_solve

  module procedure sparse_factor_free
  if (c_associated(self%numeric)) call free_by(self%call_of(free_numeric), self%numeric)
  if (c_associated(self%symbolic)) call free_by(self%call_of(free_symbolic), self%symbolic)
  self%numeric = c_null_ptr
  self%symbolic = c_null_ptr
  self%n = 0
  end procedure sparse_factor_free

  !> Give back what one of UMFPACK's procedures frees.
  subroutine free_by(address, object)
    type(c_funptr), intent(in) :: address
    type(c_ptr), intent(inout) :: object
    procedure(umfpack_di_free), pointer :: free

    call c_f_procpointer(address, free)
    call free(object)
  end subroutine free_by
end submodule sparse_factor_with_suitesparse
