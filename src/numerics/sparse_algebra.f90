!> Sparse matrices made from others: products, sums, columns.
module sg_sparse_algebra
  use sg_error, only: error_t, exit_memory, fail
  use sg_kinds, only: wp, i4, i8
  use sg_memory, only: memory_t
  use sg_sparse, only: sparse_from_triplets, sparse_t
  use sg_text, only: to_text
  implicit none
  private
  public :: multiply_matrices, sum_of, columns_of, beside, with_column, dense_column, no_columns, diagonal_matrix, rows_of

  !> Memory of an entry of a product while it is made: as a triplet, sorted, and in the matrix [bytes]
  integer(i8), parameter :: bytes_per_entry = 48

contains

  !> Row of each entry.
  pure function rows_of(a) result(row)
    type(sparse_t), intent(in) :: a !! matrix
    integer(i4), allocatable :: row(:)
    integer :: i

    allocate (row(size(a%column)))
    do i = 1, a%n_rows
      row(a%first(i):a%first(i + 1) - 1) = int(i, i4)
    end do
  end function rows_of

  !> C = A B, row by row.
  subroutine multiply_matrices(a, b, c, error)
    type(sparse_t), intent(in) :: a !! left matrix
    type(sparse_t), intent(in) :: b !! right matrix
    type(sparse_t), intent(out) :: c !! product
    type(error_t), allocatable, intent(out) :: error !! set when the product has too many entries, also for the memory
    integer(i4), allocatable :: row(:), column(:), place(:)
    real(wp), allocatable :: value(:)
    type(memory_t) :: memory
    integer(i8) :: entries
    integer :: i, e, f, n, before

    entries = product_entries(a, b)
    if (entries > huge(n)) then
      call fail(error, 'a product of matrices would have '//to_text(entries)//' entries, more than can be counted')
      return
    end if
    if (.not. memory%fits(bytes_per_entry*entries)) then
      call fail(error, 'memory is short: a product of matrices would have '//to_text(entries)//' entries', code=exit_memory)
      return
    end if
    allocate (row(entries), column(entries), value(entries))
    allocate (place(b%n_columns), source=0_i4)
    n = 0
    do i = 1, a%n_rows
      before = n
      do e = a%first(i), a%first(i + 1) - 1
        do f = b%first(a%column(e)), b%first(a%column(e) + 1) - 1
          associate (j => b%column(f))
            if (place(j) <= before) then
              n = n + 1
              place(j) = int(n, i4)
              row(n) = int(i, i4)
              column(n) = j
              value(n) = 0
            end if
            value(place(j)) = value(place(j)) + a%value(e)*b%value(f)
          end associate
        end do
      end do
    end do
    call sparse_from_triplets(a%n_rows, b%n_columns, row, column, value, c)
  end subroutine multiply_matrices

  !> Number of entries of A B.
  pure integer(i8) function product_entries(a, b) result(n)
    type(sparse_t), intent(in) :: a, b
    integer(i4), allocatable :: seen(:)
    integer :: i, e, f

    allocate (seen(b%n_columns), source=0_i4)
    n = 0
    do i = 1, a%n_rows
      do e = a%first(i), a%first(i + 1) - 1
        do f = b%first(a%column(e)), b%first(a%column(e) + 1) - 1
          if (seen(b%column(f)) == i) cycle
          seen(b%column(f)) = int(i, i4)
          n = n + 1
        end do
      end do
    end do
  end function product_entries

  !> A + factor B.
  pure function sum_of(a, factor, b) result(c)
    type(sparse_t), intent(in) :: a !! first matrix
    real(wp), intent(in) :: factor !! of the second
    type(sparse_t), intent(in) :: b !! second matrix, of the same shape
    type(sparse_t) :: c

    call sparse_from_triplets(a%n_rows, a%n_columns, [rows_of(a), rows_of(b)], [a%column, b%column], [a%value, factor*b%value], c)
  end function sum_of

  !> The columns `first` to `last` of a matrix.
  pure function columns_of(a, first, last) result(c)
    type(sparse_t), intent(in) :: a !! matrix
    integer, intent(in) :: first !! first column
    integer, intent(in) :: last !! last column
    type(sparse_t) :: c
    logical, allocatable :: is_in(:)

    allocate (is_in(size(a%column)))
    is_in = a%column >= first .and. a%column <= last
    call sparse_from_triplets(a%n_rows, last - first + 1, pack(rows_of(a), is_in), pack(a%column, is_in) - int(first - 1, i4), &
                              pack(a%value, is_in), c)
  end function columns_of

  !> The matrix (A, B).
  pure function beside(a, b) result(c)
    type(sparse_t), intent(in) :: a !! left columns
    type(sparse_t), intent(in) :: b !! right columns, of as many rows
    type(sparse_t) :: c

    call sparse_from_triplets(a%n_rows, a%n_columns + b%n_columns, [rows_of(a), rows_of(b)], &
                              [a%column, b%column + int(a%n_columns, i4)], [a%value, b%value], c)
  end function beside

  !> The matrix (A, x).
  pure function with_column(a, x) result(c)
    type(sparse_t), intent(in) :: a !! left columns
    real(wp), intent(in) :: x(:) !! last column, shape (rows)
    type(sparse_t) :: c, column

    column = diagonal_matrix(x)
    column%n_columns = 1
    column%column = 1
    c = beside(a, column)
  end function with_column

  !> A column with its zeros.
  pure function dense_column(a, j) result(x)
    type(sparse_t), intent(in) :: a !! matrix
    integer, intent(in) :: j !! column
    real(wp), allocatable :: x(:)
    integer :: i, e

    allocate (x(a%n_rows), source=0.0_wp)
    do i = 1, a%n_rows
      do e = a%first(i), a%first(i + 1) - 1
        if (a%column(e) == j) x(i) = a%value(e)
      end do
    end do
  end function dense_column

  !> A matrix without columns.
  pure function no_columns(n_rows) result(a)
    integer, intent(in) :: n_rows !! rows
    type(sparse_t) :: a

    a%n_rows = n_rows
    allocate (a%first(n_rows + 1), source=1_i4)
    allocate (a%column(0), a%value(0))
  end function no_columns

  !> A diagonal matrix, with an entry also where it is zero.
  pure function diagonal_matrix(diagonal) result(a)
    real(wp), intent(in) :: diagonal(:) !! its entries
    type(sparse_t) :: a
    integer :: i

    a%n_rows = size(diagonal)
    a%n_columns = size(diagonal)
    allocate (a%first(size(diagonal) + 1), a%column(size(diagonal)), a%value(size(diagonal)))
    a%first = [(int(i, i4), i=1, size(diagonal) + 1)]
    a%column = [(int(i, i4), i=1, size(diagonal))]
    a%value = diagonal
  end function diagonal_matrix
end module sg_sparse_algebra
