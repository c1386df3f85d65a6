!> The linear systems (A W + B) dr = g of the interior point method, A and B of one block a contact.
!!
!! Where only W is known the matrix has the size of the contacts. Where M and H are, and there are fewer velocities than
!! impulses, dv = M^-1 H dr turns it into (M + H B^-1 A H^T) dv = H B^-1 g: its entries link bodies
!! (doc/theory/interior_point.md).
module sg_interior_point_system
  use sg_cone_system, only: cone_system_t
  use sg_congruence, only: congruence_t
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_matrix_problem, only: matrix_problem_t
  use sg_sparse, only: blocks_t, multiply, sparse_t
  use sg_sparse_factor, only: largest_full, sparse_factor_t
  implicit none
  private
  public :: contact_system_t

  !> One system, its places of entries found once
  type, extends(cone_system_t) :: contact_system_t
    !> Unknowns
    integer :: n = 0
    !> The matrix and its factors
    type(sparse_t), private :: matrix
    type(sparse_factor_t) :: factor
    !> Local form: blocks of each block row with the diagonal one, and where in W each is (0: nowhere)
    integer, allocatable, private :: first(:), column(:), source(:)
    !> Global form: M + H B^-1 A H^T, B^-1 and B^-1 A
    type(congruence_t), private :: congruence
    real(wp), allocatable, private :: inverse(:, :, :), path(:, :, :)
  contains
    procedure :: prepare => system_prepare
    procedure :: is_possible => system_is_possible
    procedure :: factorise => system_factorise
    procedure :: solve => system_solve
    procedure :: multiply => system_multiply
    procedure :: free => system_free
  end type contact_system_t

contains

  !> Choose the form and find the places of entries.
  subroutine system_prepare(self, problem, scaled)
    class(contact_system_t), intent(inout) :: self
    type(matrix_problem_t), intent(in) :: problem !! problem to solve
    type(matrix_problem_t), intent(in) :: scaled !! the same without units

    self%is_global = .false.
    if (problem%has_global) self%is_global = problem%mass%n_rows < problem%d*problem%n
    if (self%is_global) then
      self%n = problem%mass%n_rows
      call prepare_global(self, problem, scaled)
    else
      self%n = scaled%d*scaled%n
      call prepare_local(self, scaled%w)
    end if
  end subroutine system_prepare

  !> Can this build factorise a system of this size?
  pure logical function system_is_possible(self, has_library) result(is_possible)
    class(contact_system_t), intent(in) :: self
    logical, intent(in) :: has_library !! is there a sparse library?

    is_possible = has_library .or. self%n <= largest_full
  end function system_is_possible

  !> Places of W and of the diagonal.
  pure subroutine prepare_local(self, w)
    class(contact_system_t), intent(inout) :: self
    type(blocks_t), intent(in) :: w
    integer :: a, e, k, n, row, column, d

    d = w%d
    n = size(w%column) + count(w%diagonal == 0)
    allocate (self%first(w%n + 1), self%column(n), self%source(n))
    allocate (self%matrix%first(d*w%n + 1), self%matrix%column(d**2*n))
    allocate (self%matrix%value(d**2*n), source=0.0_wp)
    self%matrix%n_rows = d*w%n
    self%matrix%n_columns = d*w%n
    self%matrix%first(1) = 1
    n = 0
    do a = 1, w%n
      self%first(a) = n + 1
      column = 0
      do e = w%first(a), w%first(a + 1) - 1
        if (w%diagonal(a) == 0 .and. column < a .and. w%column(e) > a) call append(self%column, self%source, n, a, 0)
        column = w%column(e)
        call append(self%column, self%source, n, column, e)
      end do
      if (w%diagonal(a) == 0 .and. column < a) call append(self%column, self%source, n, a, 0)
      k = self%matrix%first(d*(a - 1) + 1)
      do row = 1, d
        do e = self%first(a), n
          do column = 1, d
            self%matrix%column(k) = int(d*(self%column(e) - 1) + column, i4)
            k = k + 1
          end do
        end do
        self%matrix%first(d*(a - 1) + row + 1) = int(k, i4)
      end do
    end do
    self%first(w%n + 1) = n + 1
  end subroutine prepare_local

  !> One more block of a block row.
  pure subroutine append(columns, sources, n, column, source)
    integer, intent(inout) :: columns(:), sources(:), n
    integer, intent(in) :: column, source

    n = n + 1
    columns(n) = column
    sources(n) = source
  end subroutine append

  !> Places of M + H B^-1 A H^T.
  subroutine prepare_global(self, problem, scaled)
    class(contact_system_t), intent(inout) :: self
    type(matrix_problem_t), intent(in) :: problem, scaled
    type(sparse_t) :: h
    real(wp) :: factor(problem%n)

    h = problem%h
    factor = scales_of(problem, scaled)
    h%value = factor((h%column - 1)/problem%d + 1)*h%value
    call self%congruence%prepare(problem%mass, h, problem%d)
    allocate (self%inverse(problem%d, problem%d, problem%n), self%path(problem%d, problem%d, problem%n))
  end subroutine prepare_global

  !> By what each contact's columns of H are to be multiplied for the problem without units.
  pure function scales_of(problem, scaled) result(factor)
    type(matrix_problem_t), intent(in) :: problem, scaled
    real(wp) :: factor(problem%n)
    real(wp) :: before, after
    integer :: a, e, k

    factor = 1
    do a = 1, problem%n
      e = problem%w%diagonal(a)
      if (e == 0) cycle
      before = 0
      after = 0
      do k = 1, problem%d
        before = before + problem%w%block(k, k, e)
        after = after + scaled%w%block(k, k, e)
      end do
      if (before > 0 .and. after > 0) factor(a) = sqrt(after/before)
    end do
  end function scales_of

  !> Factorise A W + B; in the global form B^-1 is asked for instead of B. Where A is 1 the factors are those of Cholesky, unless
  !! rounding or the W of a file leaves the matrix indefinite.
  subroutine system_factorise(self, scaled, has_identity, a, b, error)
    class(contact_system_t), intent(inout) :: self
    type(matrix_problem_t), intent(in) :: scaled !! problem without units
    logical, intent(in) :: has_identity !! is A 1 at all contacts?
    real(wp), intent(in), contiguous :: a(:, :, :) !! A, shape (d, d, n)
    real(wp), intent(in), contiguous :: b(:, :, :) !! B, or B^-1 in the global form, shape (d, d, n)
    type(error_t), allocatable, intent(out) :: error !! why there are no factors

    self%factor%is_definite = has_identity .and. (self%is_global .or. scaled%is_symmetric)
    if (self%is_global) then
      call fill_global(self, a, b)
      call factorise_matrix(self%factor, self%congruence%matrix, error)
    else
      call fill_local(self, scaled%w, a, b)
      call factorise_matrix(self%factor, self%matrix, error)
    end if
  end subroutine system_factorise

  !> Factorise a matrix, without symmetry where the factor of Cholesky breaks down.
  subroutine factorise_matrix(factor, matrix, error)
    type(sparse_factor_t), intent(inout) :: factor
    type(sparse_t), intent(in) :: matrix
    type(error_t), allocatable, intent(out) :: error

    call factor%factorise(matrix, error)
    if (factor%failed_column == 0) return
    factor%is_definite = .false.
    call factor%factorise(matrix, error)
  end subroutine factorise_matrix

  !> Entries of A W + B; columns of impulses that stay zero, where the diagonal of A is 0, are left out as their rows are.
  pure subroutine fill_local(self, w, a, b)
    class(contact_system_t), intent(inout) :: self
    type(blocks_t), intent(in) :: w
    real(wp), intent(in), contiguous :: a(:, :, :), b(:, :, :)
    real(wp) :: block(w%d, w%d)
    integer :: i, e, k, row

    do i = 1, w%n
      do e = self%first(i), self%first(i + 1) - 1
        block = 0
        if (self%source(e) > 0) block = matmul(a(:, :, i), w%block(:, :, self%source(e)))
        do k = 1, w%d
          if (.not. abs(a(k, k, self%column(e))) > 0) block(:, k) = 0
        end do
        if (self%column(e) == i) block = block + b(:, :, i)
        do row = 1, w%d
          k = self%matrix%first(w%d*(i - 1) + row) + w%d*(e - self%first(i))
          self%matrix%value(k:k + w%d - 1) = block(row, :)
        end do
      end do
    end do
  end subroutine fill_local

  !> Entries of M + H B^-1 A H^T.
  pure subroutine fill_global(self, a, b_inverse)
    class(contact_system_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: a(:, :, :), b_inverse(:, :, :)
    integer :: n

    self%inverse = b_inverse
    do n = 1, size(a, 3)
      self%path(:, :, n) = matmul(b_inverse(:, :, n), a(:, :, n))
    end do
    call self%congruence%fill(self%path)
  end subroutine fill_global

  !> Solve (A W + B) dr = g.
  subroutine system_solve(self, scaled, g, dr, du)
    class(contact_system_t), intent(inout) :: self
    type(matrix_problem_t), intent(in) :: scaled !! problem without units
    real(wp), intent(in), contiguous :: g(:, :) !! right-hand side, shape (d, n)
    real(wp), intent(out), contiguous :: dr(:, :) !! solution, shape (d, n)
    real(wp), intent(out), contiguous :: du(:, :) !! W dr, shape (d, n)

    if (self%is_global) then
      call solve_global(self, g, dr)
    else
      call solve_local(self, g, dr)
    end if
    call multiply(scaled%w, dr, du)
  end subroutine system_solve

  !> Product u = W r.
  subroutine system_multiply(self, scaled, r, u)
    class(contact_system_t), intent(inout) :: self
    type(matrix_problem_t), intent(in) :: scaled !! problem without units
    real(wp), intent(in), contiguous :: r(:, :) !! impulses, shape (d, n)
    real(wp), intent(out), contiguous :: u(:, :) !! relative velocities, shape (d, n)

    call multiply(scaled%w, r, u)
  end subroutine system_multiply

  !> Solve for the impulses of the contacts.
  subroutine solve_local(self, g, dr)
    class(contact_system_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: g(:, :)
    real(wp), intent(out), contiguous :: dr(:, :)
    real(wp) :: x(self%n)

    call self%factor%solve(reshape(g, [self%n]), x)
    dr = reshape(x, shape(dr))
  end subroutine solve_local

  !> Solve by the velocities of the bodies.
  subroutine solve_global(self, g, dr)
    class(contact_system_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: g(:, :)
    real(wp), intent(out), contiguous :: dr(:, :)
    real(wp), allocatable :: right(:), dv(:)
    integer :: a, i

    allocate (right(self%n), dv(self%n))
    right = 0
    associate (first => self%congruence%first, row => self%congruence%row, h => self%congruence%h)
      do a = 1, size(g, 2)
        dr(:, a) = matmul(self%inverse(:, :, a), g(:, a))
        do i = first(a), first(a + 1) - 1
          right(row(i)) = right(row(i)) + dot_product(h(:, i), dr(:, a))
        end do
      end do
      call self%factor%solve(right, dv)
      do a = 1, size(g, 2)
        do i = first(a), first(a + 1) - 1
          dr(:, a) = dr(:, a) - matmul(self%path(:, :, a), h(:, i))*dv(row(i))
        end do
      end do
    end associate
  end subroutine solve_global

  !> Give the factors back.
  subroutine system_free(self)
    class(contact_system_t), intent(inout) :: self

    call self%factor%free()
  end subroutine system_free
end module sg_interior_point_system
