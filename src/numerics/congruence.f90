!> Matrices M + H D H^T with blocks D that change while M and H stay: places of entries are found once.
!!
!! They are the matrices of velocities of bodies that contacts stiffen: of subdomains under the enriched interface
!! (doc/theory/enriched.md), and of interior points with D = K^-1 (doc/theory/interior_point.md).
module sg_congruence
  use sg_ascending, only: first_at_least
  use sg_kinds, only: wp, i4
  use sg_sparse, only: sparse_from_triplets, sparse_t, transposed
  use sg_tables, only: tables_t
  use sg_sparse_algebra, only: rows_of
  implicit none
  private
  public :: congruence_t

  !> One such matrix
  type :: congruence_t
    !> The matrix, after `fill`
    type(sparse_t) :: matrix
    !> Side of a block of D; rows of H in which block column a has entries are row(first(a)) to row(first(a + 1) - 1), with these
    integer, private :: d = 0
    integer, allocatable :: first(:), row(:)
    real(wp), allocatable :: h(:, :)
    !> Entry of the matrix to which each pair of these adds, and the matrix without them
    integer, allocatable, private :: place(:)
    real(wp), allocatable, private :: mass(:)
  contains
    procedure :: prepare => congruence_prepare
    procedure :: fill => congruence_fill
    procedure :: note_tables => congruence_note_tables
  end type congruence_t

contains

  !> Find the places of all entries.
  subroutine congruence_prepare(self, mass, h, d)
    class(congruence_t), intent(inout) :: self
    type(sparse_t), intent(in) :: mass !! M, shape (n, n)
    type(sparse_t), intent(in) :: h !! H, n rows, d columns per block
    integer, intent(in) :: d !! side of a block of D
    integer(i4), allocatable :: row(:), column(:)
    real(wp), allocatable :: value(:)
    integer :: a, i, j, k, n

    n = size(mass%value)
    self%d = d
    call gather(self, transposed(h), h%n_columns/d)
    k = n + sum((self%first(2:) - self%first(:size(self%first) - 1))**2)
    allocate (row(k), column(k))
    allocate (value(k), source=0.0_wp)
    row(:n) = rows_of(mass)
    column(:n) = mass%column
    value(:n) = mass%value
    k = n
    do a = 1, size(self%first) - 1
      do j = self%first(a), self%first(a + 1) - 1
        do i = self%first(a), self%first(a + 1) - 1
          k = k + 1
          row(k) = int(self%row(i), i4)
          column(k) = int(self%row(j), i4)
        end do
      end do
    end do
    call sparse_from_triplets(mass%n_rows, mass%n_rows, row, column, value, self%matrix)
    if (allocated(self%mass)) deallocate (self%mass)
    allocate (self%mass, source=self%matrix%value)
    self%place = [(entry_of(self%matrix, row(k), column(k)), k=n + 1, size(row))]
  end subroutine congruence_prepare

  !> Position of an entry.
  pure integer function entry_of(matrix, row, column) result(entry)
    type(sparse_t), intent(in) :: matrix
    integer(i4), intent(in) :: row, column

    associate (first => matrix%first(row), last => matrix%first(row + 1) - 1)
      entry = first - 1 + first_at_least(matrix%column(first:last), column)
    end associate
  end function entry_of

  !> Rows in which each block column of H has entries, and these.
  pure subroutine gather(self, h_transposed, blocks)
    class(congruence_t), intent(inout) :: self
    type(sparse_t), intent(in) :: h_transposed
    integer, intent(in) :: blocks
    integer, allocatable :: seen(:)
    integer :: a, e, k, last

    if (allocated(self%first)) deallocate (self%first, self%row, self%h)
    allocate (seen(h_transposed%n_columns), source=0)
    allocate (self%first(blocks + 1), source=1)
    allocate (self%row(size(h_transposed%column)))
    allocate (self%h(self%d, size(h_transposed%column)), source=0.0_wp)
    last = 0
    do a = 1, blocks
      do k = 1, self%d
        do e = h_transposed%first(self%d*(a - 1) + k), h_transposed%first(self%d*(a - 1) + k + 1) - 1
          associate (row => h_transposed%column(e))
            if (seen(row) < self%first(a)) then
              last = last + 1
              seen(row) = last
              self%row(last) = row
            end if
            self%h(k, seen(row)) = h_transposed%value(e)
          end associate
        end do
      end do
      self%first(a + 1) = last + 1
    end do
    self%row = self%row(:last)
    self%h = self%h(:, :last)
  end subroutine gather

  !> Set the matrix from the blocks of D.
  pure subroutine congruence_fill(self, blocks)
    class(congruence_t), intent(inout) :: self !! its matrix is set
    real(wp), intent(in), contiguous :: blocks(:, :, :) !! D, shape (d, d, blocks)
    real(wp) :: moved(self%d)
    integer :: a, i, j, k

    self%matrix%value = self%mass
    k = 0
    do a = 1, size(blocks, 3)
      do j = self%first(a), self%first(a + 1) - 1
        moved = matmul(blocks(:, :, a), self%h(:, j))
        do i = self%first(a), self%first(a + 1) - 1
          k = k + 1
          associate (entry => self%place(k))
            self%matrix%value(entry) = self%matrix%value(entry) + dot_product(self%h(:, i), moved)
          end associate
        end do
      end do
    end do
  end subroutine congruence_fill

  !> Add these tables to those of the owner that has begun.
  subroutine congruence_note_tables(self, tables)
    class(congruence_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%note('matrix_first', self%matrix%first)
    call tables%note('matrix_column', self%matrix%column)
    call tables%note('matrix_value', self%matrix%value)
    call tables%note('first', self%first)
    call tables%note('row', self%row)
    call tables%note('h', self%h)
    call tables%note('place', self%place)
    call tables%note('unstiffened', self%mass)
  end subroutine congruence_note_tables
end module sg_congruence
