!> Sparse matrices: triplets, products, transposes, blocks; and factors of them, against full matrices.
program test_sparse
  use harness, only: tests_t
  use sg_dense_factor, only: dense_cholesky, dense_cholesky_solve, dense_factorise, dense_solve
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_random, only: random_t
  use sg_sparse, only: blocks_t, multiply, multiply_transposed, sparse_from_triplets, sparse_t, transposed
  use sg_sparse_factor, only: has_sparse_library, largest_full, sparse_factor_t
  use sg_text, only: to_text
  implicit none
  ! Sums of at most some hundred terms of order one.
  real(wp), parameter :: rounding = 1e-13_wp
  ! The systems solved have condition numbers of at most some hundred.
  real(wp), parameter :: solved = 1e-12_wp
  type(tests_t) :: t

  call test_triplets()
  call test_products()
  call test_blocks()
  call test_dense()
  call test_factors()
  call test_singular()
  call test_large()
  call test_cholesky()
  call test_indefinite()
  call t%finish()

contains

  !> Entries of one place add, columns rise, empty rows stay empty.
  subroutine test_triplets()
    type(sparse_t) :: a

    call sparse_from_triplets(4, 3, [4_i4, 1_i4, 4_i4, 1_i4, 4_i4], [3_i4, 2_i4, 1_i4, 2_i4, 3_i4], &
                              [1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp], a)
    call t%check(all(a%first == [1, 2, 2, 2, 4]), 'triplets: beginnings of rows')
    call t%check(size(a%column) == 3, 'triplets: entries of one place are one')
    call t%check(all(a%column == [2, 1, 3]), 'triplets: columns rise')
    call t%near(maxval(abs(a%value - [6.0_wp, 3.0_wp, 6.0_wp])), 0.0_wp, 0.0_wp, 'triplets: values')
    call sparse_from_triplets(2, 2, [integer(i4) ::], [integer(i4) ::], [real(wp) ::], a)
    call t%check(all(a%first == 1) .and. size(a%value) == 0, 'triplets: none at all')
  end subroutine test_triplets

  !> Products with a matrix, its transpose, and the transpose made.
  subroutine test_products()
    type(sparse_t) :: a, b
    real(wp) :: full(30, 20), x(20), y(30), z(30), transposed_z(20)
    type(random_t) :: random

    call random%seed(7)
    call random_matrix(30, 20, 100, random, a, full)
    call fill(random, x)
    call fill(random, z)
    call multiply(a, x, y)
    call t%near(maxval(abs(y - matmul(full, x))), 0.0_wp, rounding, 'A x')
    call multiply_transposed(a, z, transposed_z)
    call t%near(maxval(abs(transposed_z - matmul(z, full))), 0.0_wp, rounding, 'A^T z')
    b = transposed(a)
    call multiply(b, z, transposed_z)
    call t%near(maxval(abs(transposed_z - matmul(z, full))), 0.0_wp, rounding, '(A^T) z')
    call t%check(b%n_rows == 20 .and. b%n_columns == 30, 'shape of the transpose')
  end subroutine test_products

  !> A product with a matrix of blocks, unsymmetric and with an empty row.
  subroutine test_blocks()
    type(blocks_t) :: a
    real(wp) :: x(2, 3), y(2, 3), block(2, 2)

    a%d = 2
    a%n = 3
    a%first = [1_i4, 3_i4, 3_i4, 4_i4]
    a%column = [1_i4, 3_i4, 2_i4]
    a%diagonal = [1_i4, 0_i4, 0_i4]
    block = reshape([1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp], [2, 2])
    allocate (a%block(2, 2, 3))
    a%block(:, :, 1) = block
    a%block(:, :, 2) = 10*block
    a%block(:, :, 3) = -block
    x = reshape([1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp, 6.0_wp], [2, 3])
    call multiply(a, x, y)
    call t%near(maxval(abs(y(:, 1) - matmul(block, x(:, 1) + 10*x(:, 3)))), 0.0_wp, rounding, 'block row with two blocks')
    call t%near(maxval(abs(y(:, 2))), 0.0_wp, 0.0_wp, 'empty block row')
    call t%near(maxval(abs(y(:, 3) + matmul(block, x(:, 2)))), 0.0_wp, rounding, 'block row with one block')
  end subroutine test_blocks

  !> Full factors of a matrix that needs its rows exchanged.
  subroutine test_dense()
    real(wp) :: a(40, 40), factors(40, 40), x(40), b(40)
    type(random_t) :: random
    integer :: pivot(40), k
    logical :: is_singular

    call random%seed(3)
    do k = 1, 40
      call fill(random, a(:, k))
      a(k, k) = 0
    end do
    call fill(random, x)
    b = matmul(a, x)
    factors = a
    call dense_factorise(factors, pivot, is_singular)
    call t%check(.not. is_singular, 'a random matrix has full factors')
    call dense_solve(factors, pivot, b)
    ! Condition number of this matrix: some thousand.
    call t%near(maxval(abs(b - x)), 0.0_wp, 1e-10_wp, 'full factors')
    factors = a
    factors(:, 7) = 0
    call dense_factorise(factors, pivot, is_singular)
    call t%check(is_singular, 'a column of zeros is singular')
  end subroutine test_dense

  !> Sparse factors: an unsymmetric matrix, the same places again, other places, and another size.
  subroutine test_factors()
    type(sparse_factor_t) :: factor
    type(random_t) :: random
    type(sparse_t) :: a

    call random%seed(5)
    call dominant(60, 240, random, a)
    call check_solution(factor, a, random, 'first matrix')
    a%value = a%value*2 + 0.1_wp
    call check_solution(factor, a, random, 'same places')
    call t%equal(factor%analyses, 1, 'same places are analysed once')
    call t%equal(factor%factorisations, 2, 'and factorised twice')
    call dominant(60, 100, random, a)
    call check_solution(factor, a, random, 'other places')
    call dominant(25, 60, random, a)
    call check_solution(factor, a, random, 'another size')
    call check_price(factor, a)
    call factor%free()
    call factor%free()
    call t%equal(factor%n, 0, 'freed, even twice')
  end subroutine test_factors

  !> Cholesky factors, for several right-hand sides, against full factors: small and large patterns, each twice, and LU factors by
  !! the same object between.
  subroutine test_cholesky()
    type(sparse_factor_t) :: factor
    type(random_t) :: random
    type(sparse_t) :: a
    integer :: k

    call random%seed(17)
    factor%is_definite = .true.
    do k = 1, 12
      call definite(random_index(random, merge(8, 400, k < 4)), random, a)
      call check_columns(factor, a, 1 + modulo(k, 5), random, 'definite matrix '//to_text(k))
      a%value = 3*a%value
      call check_columns(factor, a, 2, random, 'same pattern '//to_text(k))
    end do
    call t%equal(factor%analyses, 12, 'each pattern is analysed once')
    call t%equal(factor%factorisations, 24, 'and factorised twice')
    call check_price(factor, a)
    factor%is_definite = .false.
    factor%most_operations = huge(factor%most_operations)
    call check_columns(factor, a, 3, random, 'the same by LU')
    factor%is_definite = .true.
    call check_columns(factor, a, 3, random, 'and by Cholesky again')
    call factor%free()
    call factor%free()
    call t%equal(factor%n, 0, 'freed, even twice')
  end subroutine test_cholesky

  !> A factorisation above the effort allowed is refused before it is made, and its price counts where it is made.
  subroutine check_price(factor, a)
    type(sparse_factor_t), intent(inout) :: factor
    type(sparse_t), intent(in) :: a
    type(error_t), allocatable :: error
    real(wp) :: before, price
    integer :: made

    price = factor%price
    made = factor%factorisations
    factor%most_operations = 0.9_wp*price
    call factor%factorise(a, error)
    call t%check(allocated(error) .and. factor%is_too_dear, 'a factorisation too dear is refused')
    call t%equal(factor%factorisations, made, 'and not made')
    factor%most_operations = price
    before = factor%operations
    call factor%factorise(a, error)
    call t%check(.not. (allocated(error) .or. factor%is_too_dear), 'and made where it is allowed')
    call t%check(price > 0 .and. factor%operations >= before + price, 'its price counts')
  end subroutine check_price

  !> Singular matrices end in an error, and the factors can be used for another matrix.
  subroutine test_singular()
    type(sparse_factor_t) :: factor
    type(sparse_t) :: a
    type(random_t) :: random
    type(error_t), allocatable :: error

    call random%seed(11)
    call sparse_from_triplets(3, 3, [1_i4, 2_i4, 2_i4, 1_i4, 3_i4], [1_i4, 1_i4, 2_i4, 2_i4, 3_i4], &
                              [1.0_wp, 2.0_wp, 4.0_wp, 2.0_wp, 1.0_wp], a)
    call factor%factorise(a, error)
    call t%check(allocated(error), 'two rows in proportion are singular')
    if (allocated(error)) call t%check(index(error%message, 'singular') > 0, 'and said to be: '//error%message)
    call sparse_from_triplets(3, 3, [1_i4, 2_i4], [1_i4, 2_i4], [1.0_wp, 1.0_wp], a)
    call factor%factorise(a, error)
    call t%check(allocated(error), 'an empty row is singular')
    call dominant(30, 90, random, a)
    call check_solution(factor, a, random, 'after a singular matrix')
    call factor%free()
  end subroutine test_singular

  !> More unknowns than full factors serve: the library solves them, a build without it says what it needs.
  subroutine test_large()
    type(sparse_factor_t) :: factor
    type(sparse_t) :: a
    type(random_t) :: random
    type(error_t), allocatable :: error

    call random%seed(13)
    call dominant(largest_full + 1, 4*largest_full, random, a)
    if (has_sparse_library()) then
      call check_solution(factor, a, random, 'a large matrix')
    else
      call factor%factorise(a, error)
      call t%check(allocated(error), 'a large matrix needs the library')
      if (allocated(error)) call t%check(index(error%message, 'needs SuiteSparse') > 0, 'and that is said: '//error%message)
    end if
    call factor%free()
  end subroutine test_large

  !> Matrices that are not positive definite end in an error that names the column, and the factors serve for other matrices.
  subroutine test_indefinite()
    type(sparse_factor_t) :: factor
    type(random_t) :: random
    type(sparse_t) :: a
    type(error_t), allocatable :: error
    integer :: k, n, bad, e

    call random%seed(19)
    factor%is_definite = .true.
    do k = 1, 12
      n = 1 + random_index(random, merge(6, 300, k < 6))
      call definite(n, random, a)
      bad = random_index(random, n)
      ! Zero or negative on the diagonal: no positive definite matrix has that.
      do e = a%first(bad), a%first(bad + 1) - 1
        if (a%column(e) == bad) a%value(e) = merge(0.0_wp, -a%value(e), modulo(k, 2) == 0)
      end do
      call factor%factorise(a, error)
      call t%check(allocated(error), 'an indefinite matrix has no Cholesky factors: '//to_text(k))
      call t%check(factor%failed_column >= 1 .and. factor%failed_column <= n, 'the column is known')
      if (allocated(error)) call t%check(index(error%message, 'not positive definite: column '// &
                                               to_text(factor%failed_column)) > 0, 'and the message holds it: '//error%message)
      call definite(n, random, a)
      call check_columns(factor, a, 1, random, 'after an indefinite matrix')
    end do
    call sparse_from_triplets(3, 3, [1_i4, 2_i4, 3_i4], [1_i4, 2_i4, 3_i4], [1.0_wp, -1.0_wp, 1.0_wp], a)
    call factor%factorise(a, error)
    call t%equal(factor%failed_column, 2, 'the negative one of a diagonal')
    call factor%free()
  end subroutine test_indefinite

  !> Factorise a definite matrix and solve for k right-hand sides; compare with full factors, and take the residual.
  subroutine check_columns(factor, a, k, random, what)
    type(sparse_factor_t), intent(inout) :: factor
    type(sparse_t), intent(in) :: a
    integer, intent(in) :: k
    type(random_t), intent(inout) :: random
    character(len=*), intent(in) :: what
    type(error_t), allocatable :: error
    real(wp) :: full(a%n_rows, a%n_rows), b(a%n_rows, k), x(a%n_rows, k), y(a%n_rows), residual
    integer :: i, lost

    call factor%factorise(a, error)
    call t%check(.not. allocated(error), what//': factorised')
    if (allocated(error)) return
    full = 0
    do i = 1, a%n_rows
      full(i, a%column(a%first(i):a%first(i + 1) - 1)) = a%value(a%first(i):a%first(i + 1) - 1)
      call fill(random, b(i, :))
    end do
    call factor%solve(b, x)
    residual = maxval(abs(matmul(full, x) - b))
    call t%near(residual, 0.0_wp, solved*maxval(abs(full)), what//': residual')
    call dense_cholesky(full, lost)
    call t%equal(lost, 0, what//': definite for full factors too')
    y = b(:, k)
    call dense_cholesky_solve(full, y)
    call t%near(maxval(abs(y - x(:, k))), 0.0_wp, solved, what//': as by full factors')
  end subroutine check_columns

  !> A random symmetric positive definite matrix whose diagonal is above the sum of its row; some are full.
  subroutine definite(n, random, a)
    integer, intent(in) :: n
    type(random_t), intent(inout) :: random
    type(sparse_t), intent(out) :: a
    integer(i4), allocatable :: row(:), column(:)
    real(wp), allocatable :: value(:), sums(:)
    integer :: e, i, pairs

    pairs = random_index(random, 1 + n*random_index(random, max(1, n/8)))
    allocate (row(2*pairs + n), column(2*pairs + n), value(2*pairs + n))
    allocate (sums(n), source=1.0_wp)
    call fill(random, value)
    do e = 1, pairs
      row(e) = random_index(random, n)
      column(e) = random_index(random, n)
      row(pairs + e) = column(e)
      column(pairs + e) = row(e)
      value(pairs + e) = value(e)
      sums(row(e)) = sums(row(e)) + abs(value(e))
      sums(column(e)) = sums(column(e)) + abs(value(e))
    end do
    do i = 1, n
      row(2*pairs + i) = int(i, i4)
      column(2*pairs + i) = int(i, i4)
      value(2*pairs + i) = sums(i)
    end do
    call sparse_from_triplets(n, n, row, column, value, a)
  end subroutine definite

  !> Factorise, solve for a right-hand side of known solution, compare.
  subroutine check_solution(factor, a, random, what)
    type(sparse_factor_t), intent(inout) :: factor
    type(sparse_t), intent(in) :: a
    type(random_t), intent(inout) :: random
    character(len=*), intent(in) :: what
    type(error_t), allocatable :: error
    real(wp), allocatable :: x(:), b(:), y(:)

    allocate (x(a%n_rows), b(a%n_rows), y(a%n_rows))
    call fill(random, x)
    call multiply(a, x, b)
    call factor%factorise(a, error)
    call t%check(.not. allocated(error), what//': factorised')
    if (allocated(error)) return
    call factor%solve(b, y)
    call t%near(maxval(abs(y - x)), 0.0_wp, solved, what//': solution')
  end subroutine check_solution

  !> An unsymmetric matrix whose diagonal dominates.
  subroutine dominant(n, n_entries, random, a)
    integer, intent(in) :: n, n_entries
    type(random_t), intent(inout) :: random
    type(sparse_t), intent(out) :: a
    integer(i4), allocatable :: row(:), column(:)
    real(wp), allocatable :: value(:), sums(:)
    integer :: e, i

    allocate (row(n_entries + n), column(n_entries + n), value(n_entries + n))
    allocate (sums(n), source=1.0_wp)
    call fill(random, value)
    do e = 1, n_entries
      row(e) = random_index(random, n)
      column(e) = random_index(random, n)
      sums(row(e)) = sums(row(e)) + abs(value(e))
    end do
    do i = 1, n
      row(n_entries + i) = int(i, i4)
      column(n_entries + i) = int(i, i4)
      value(n_entries + i) = sums(i)
    end do
    call sparse_from_triplets(n, n, row, column, value, a)
  end subroutine dominant

  !> A random matrix, sparse and full.
  subroutine random_matrix(m, n, n_entries, random, a, full)
    integer, intent(in) :: m, n, n_entries
    type(random_t), intent(inout) :: random
    type(sparse_t), intent(out) :: a
    real(wp), intent(out) :: full(m, n)
    integer(i4) :: row(n_entries), column(n_entries)
    real(wp) :: value(n_entries)
    integer :: e

    full = 0
    call fill(random, value)
    do e = 1, n_entries
      row(e) = random_index(random, m)
      column(e) = random_index(random, n)
      full(row(e), column(e)) = full(row(e), column(e)) + value(e)
    end do
    call sparse_from_triplets(m, n, row, column, value, a)
  end subroutine random_matrix

  !> A random number of a list of n.
  integer(i4) function random_index(random, n)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: n

    random_index = int(min(n, 1 + int(real(n, wp)*random%uniform())), i4)
  end function random_index

  !> Random numbers between -1 and 1.
  subroutine fill(random, x)
    type(random_t), intent(inout) :: random
    real(wp), intent(out) :: x(:)
    integer :: i

    do i = 1, size(x)
      x(i) = 2*random%uniform() - 1
    end do
  end subroutine fill
end program test_sparse
