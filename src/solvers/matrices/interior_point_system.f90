!> The linear systems (A W + B) dr = g of the interior point method, A and B of one block a contact.
!!
!! Where only W is known the matrix has the size of the contacts. Where M and H are, and there are fewer velocities than
!! impulses, dv = M^-1 H dr turns it into (M + H B^-1 A H^T) dv = H B^-1 g: its entries link bodies
!! (doc/theory/interior_point.md).
module sg_interior_point_system
  use sg_ascending, only: first_at_least
  use sg_cone_system, only: cone_system_t
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_matrix_problem, only: matrix_problem_t
  use sg_sparse, only: blocks_t, multiply, sparse_from_triplets, sparse_t, transposed
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
    !> Global form: degrees of freedom of contact a are dof(first(a)) to dof(first(a + 1) - 1), with their columns of H^T
    integer, allocatable, private :: dof(:)
    real(wp), allocatable, private :: h(:, :)
    !> Global form: entry of the matrix to which each pair of these adds, and the matrix without them
    integer, allocatable, private :: place(:)
    real(wp), allocatable, private :: mass(:)
    !> Global form: B^-1 and B^-1 A
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

  !> Degrees of freedom of each contact, and the places to which their pairs add.
  subroutine prepare_global(self, problem, scaled)
    class(contact_system_t), intent(inout) :: self
    type(matrix_problem_t), intent(in) :: problem, scaled
    type(sparse_t) :: h_transposed
    integer(i4), allocatable :: row(:), column(:)
    real(wp), allocatable :: value(:), factor(:)
    integer :: a, i, j, k, e

    h_transposed = transposed(problem%h)
    factor = scales_of(problem, scaled)
    call gather_dofs(self, h_transposed, problem%d, problem%n, factor)
    k = size(problem%mass%column)
    do a = 1, problem%n
      k = k + (self%first(a + 1) - self%first(a))**2
    end do
    allocate (row(k), column(k), self%place(k - size(problem%mass%column)))
    allocate (value(k), source=0.0_wp)
    do i = 1, problem%mass%n_rows
      do e = problem%mass%first(i), problem%mass%first(i + 1) - 1
        row(e) = int(i, i4)
        column(e) = problem%mass%column(e)
        value(e) = problem%mass%value(e)
      end do
    end do
    k = size(problem%mass%column)
    do a = 1, problem%n
      do i = self%first(a), self%first(a + 1) - 1
        do j = self%first(a), self%first(a + 1) - 1
          k = k + 1
          row(k) = int(self%dof(i), i4)
          column(k) = int(self%dof(j), i4)
        end do
      end do
    end do
    call sparse_from_triplets(self%n, self%n, row, column, value, self%matrix)
    self%mass = self%matrix%value
    e = size(problem%mass%column)
    do k = 1, size(self%place)
      i = self%matrix%first(row(e + k))
      j = self%matrix%first(row(e + k) + 1) - 1
      self%place(k) = i - 1 + first_at_least(self%matrix%column(i:j), column(e + k))
    end do
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

  !> The degrees of freedom that each contact moves, with their columns of H^T.
  pure subroutine gather_dofs(self, h_transposed, d, n, factor)
    class(contact_system_t), intent(inout) :: self
    type(sparse_t), intent(in) :: h_transposed
    integer, intent(in) :: d, n
    real(wp), intent(in) :: factor(:)
    integer, allocatable :: seen(:)
    integer :: a, e, k, last

    allocate (seen(h_transposed%n_columns), source=0)
    allocate (self%first(n + 1), self%dof(size(h_transposed%column)))
    allocate (self%h(d, size(h_transposed%column)), source=0.0_wp)
    last = 0
    self%first(1) = 1
    do a = 1, n
      do k = 1, d
        do e = h_transposed%first(d*(a - 1) + k), h_transposed%first(d*(a - 1) + k + 1) - 1
          if (seen(h_transposed%column(e)) < self%first(a)) then
            last = last + 1
            seen(h_transposed%column(e)) = last
            self%dof(last) = h_transposed%column(e)
          end if
          self%h(k, seen(h_transposed%column(e))) = factor(a)*h_transposed%value(e)
        end do
      end do
      self%first(a + 1) = last + 1
    end do
    self%dof = self%dof(:last)
    self%h = self%h(:, :last)
  end subroutine gather_dofs

  !> Factorise A W + B; in the global form B^-1 is asked for instead of B. Where A is 1 the factors are those of Cholesky, unless
  !! rounding or the W of a file leaves the matrix indefinite.
  subroutine system_factorise(self, scaled, has_identity, a, b, error)
    class(contact_system_t), intent(inout) :: self
    type(matrix_problem_t), intent(in) :: scaled !! problem without units
    logical, intent(in) :: has_identity !! is A 1 at all contacts?
    real(wp), intent(in), contiguous :: a(:, :, :) !! A, shape (d, d, n)
    real(wp), intent(in), contiguous :: b(:, :, :) !! B, or B^-1 in the global form, shape (d, d, n)
    type(error_t), allocatable, intent(out) :: error !! why there are no factors

    if (self%is_global) then
      call fill_global(self, a, b)
    else
      call fill_local(self, scaled%w, a, b)
    end if
    self%factor%is_definite = has_identity .and. (self%is_global .or. scaled%is_symmetric)
    call self%factor%factorise(self%matrix, error)
    if (self%factor%failed_column == 0) return
    self%factor%is_definite = .false.
    call self%factor%factorise(self%matrix, error)
  end subroutine system_factorise

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
    real(wp) :: moved(size(a, 1))
    integer :: n, i, j, k, size_n

    self%matrix%value = self%mass
    self%inverse = b_inverse
    k = 0
    do n = 1, size(a, 3)
      self%path(:, :, n) = matmul(b_inverse(:, :, n), a(:, :, n))
      size_n = self%first(n + 1) - self%first(n)
      do j = self%first(n), self%first(n + 1) - 1
        moved = matmul(self%path(:, :, n), self%h(:, j))
        do i = self%first(n), self%first(n + 1) - 1
          associate (entry => self%place(k + (i - self%first(n))*size_n + j - self%first(n) + 1))
            self%matrix%value(entry) = self%matrix%value(entry) + dot_product(self%h(:, i), moved)
          end associate
        end do
      end do
      k = k + size_n**2
    end do
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
    do a = 1, size(g, 2)
      dr(:, a) = matmul(self%inverse(:, :, a), g(:, a))
      do i = self%first(a), self%first(a + 1) - 1
        right(self%dof(i)) = right(self%dof(i)) + dot_product(self%h(:, i), dr(:, a))
      end do
    end do
    call self%factor%solve(right, dv)
    do a = 1, size(g, 2)
      do i = self%first(a), self%first(a + 1) - 1
        dr(:, a) = dr(:, a) - matmul(self%path(:, :, a), self%h(:, i))*dv(self%dof(i))
      end do
    end do
  end subroutine solve_global

  !> Give the factors back.
  subroutine system_free(self)
    class(contact_system_t), intent(inout) :: self

    call self%factor%free()
  end subroutine system_free
end module sg_interior_point_system
