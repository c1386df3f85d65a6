!> Sparse matrices in compressed rows, and blocks of one size in compressed rows.
module sg_sparse
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: sparse_t, blocks_t, sparse_from_triplets, multiply, multiply_transposed, transposed

  !> A sparse matrix by rows: entries of row i are `first(i)` to `first(i + 1) - 1`, columns rising
  type :: sparse_t
    !> Number of rows and columns
    integer :: n_rows = 0, n_columns = 0
    !> Where each row begins, shape (n_rows + 1)
    integer(i4), allocatable :: first(:)
    !> Column and value of each entry
    integer(i4), allocatable :: column(:)
    real(wp), allocatable :: value(:)
  end type sparse_t

  !> A square matrix of d by d blocks: blocks of block row i are `first(i)` to `first(i + 1) - 1`, columns rising
  type :: blocks_t
    !> Side of a block, and number of block rows
    integer :: d = 0, n = 0
    !> Where each block row begins, shape (n + 1)
    integer(i4), allocatable :: first(:)
    !> Block column of each block, and position of the diagonal block of each row (0 where there is none)
    integer(i4), allocatable :: column(:), diagonal(:)
    !> Blocks, shape (d, d, blocks): row, column
    real(wp), allocatable :: block(:, :, :)
  end type blocks_t

  interface multiply
    module procedure multiply_sparse, multiply_blocks
  end interface multiply

contains

  !> A matrix from triplets in any order; entries of one place are added.
  pure subroutine sparse_from_triplets(n_rows, n_columns, row, column, value, matrix)
    integer, intent(in) :: n_rows !! rows
    integer, intent(in) :: n_columns !! columns
    integer(i4), intent(in) :: row(:) !! row of each entry, from 1
    integer(i4), intent(in) :: column(:) !! column of each entry, from 1
    real(wp), intent(in) :: value(:) !! value of each entry
    type(sparse_t), intent(out) :: matrix !! the matrix
    integer(i4), allocatable :: by_column(:), by_row(:)
    integer :: e, i, k, last

    ! Two stable counting sorts: by column, then by row.
    by_column = counted(n_columns, column, [(int(e, i4), e=1, size(row))])
    by_row = counted(n_rows, row, by_column)
    matrix%n_rows = n_rows
    matrix%n_columns = n_columns
    allocate (matrix%first(n_rows + 1), source=1_i4)
    allocate (matrix%column(size(row)), matrix%value(size(row)))
    k = 0
    last = 0
    do e = 1, size(row)
      i = by_row(e)
      if (row(i) == last) then
        if (matrix%column(k) == column(i)) then
          matrix%value(k) = matrix%value(k) + value(i)
          cycle
        end if
      end if
      k = k + 1
      matrix%column(k) = column(i)
      matrix%value(k) = value(i)
      last = row(i)
      matrix%first(last + 1) = int(k, i4) + 1
    end do
    do i = 1, n_rows
      matrix%first(i + 1) = max(matrix%first(i + 1), matrix%first(i))
    end do
    matrix%column = matrix%column(:k)
    matrix%value = matrix%value(:k)
  end subroutine sparse_from_triplets

  !> Entries of a list in the stable order of their keys 1 to n.
  pure function counted(n, key, list) result(ordered)
    integer, intent(in) :: n
    integer(i4), intent(in) :: key(:), list(:)
    integer(i4), allocatable :: ordered(:), next(:)
    integer :: i

    allocate (next(n + 1), source=0_i4)
    allocate (ordered(size(list)))
    do i = 1, size(key)
      next(key(i) + 1) = next(key(i) + 1) + 1
    end do
    if (n > 0) next(1) = 1
    do i = 2, n
      next(i) = next(i) + next(i - 1)
    end do
    do i = 1, size(list)
      ordered(next(key(list(i)))) = list(i)
      next(key(list(i))) = next(key(list(i))) + 1
    end do
  end function counted

  !> y = A x.
  pure subroutine multiply_sparse(a, x, y)
    type(sparse_t), intent(in) :: a !! matrix
    real(wp), intent(in), contiguous :: x(:) !! vector, shape (n_columns)
    real(wp), intent(out), contiguous :: y(:) !! product, shape (n_rows)
    integer :: i, e

    do i = 1, a%n_rows
      y(i) = 0
      do e = a%first(i), a%first(i + 1) - 1
        y(i) = y(i) + a%value(e)*x(a%column(e))
      end do
    end do
  end subroutine multiply_sparse

  !> y = A^T x.
  pure subroutine multiply_transposed(a, x, y)
    type(sparse_t), intent(in) :: a !! matrix
    real(wp), intent(in), contiguous :: x(:) !! vector, shape (n_rows)
    real(wp), intent(out), contiguous :: y(:) !! product, shape (n_columns)
    integer :: i, e

    y = 0
    do i = 1, a%n_rows
      do e = a%first(i), a%first(i + 1) - 1
        y(a%column(e)) = y(a%column(e)) + a%value(e)*x(i)
      end do
    end do
  end subroutine multiply_transposed

  !> y = A x for a matrix of blocks; vectors by block, shape (d, n).
  pure subroutine multiply_blocks(a, x, y)
    type(blocks_t), intent(in) :: a !! matrix
    real(wp), intent(in), contiguous :: x(:, :) !! vector
    real(wp), intent(out), contiguous :: y(:, :) !! product
    integer :: i, e, k

    do i = 1, a%n
      y(:, i) = 0
      do e = a%first(i), a%first(i + 1) - 1
        do k = 1, a%d
          y(:, i) = y(:, i) + a%block(:, k, e)*x(k, a%column(e))
        end do
      end do
    end do
  end subroutine multiply_blocks

  !> The transpose.
  pure function transposed(a) result(t)
    type(sparse_t), intent(in) :: a !! matrix
    type(sparse_t) :: t
    integer(i4), allocatable :: row(:)
    integer :: i

    allocate (row(size(a%column)))
    do i = 1, a%n_rows
      row(a%first(i):a%first(i + 1) - 1) = int(i, i4)
    end do
    call sparse_from_triplets(a%n_columns, a%n_rows, a%column, row, a%value, t)
  end function transposed
end module sg_sparse
