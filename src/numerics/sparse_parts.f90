!> A^-1 C for a sparse matrix A that falls into parts which nothing connects: a mass matrix, whose parts are bodies.
module sg_sparse_parts
  use sg_dense_factor, only: dense_factorise, dense_solve
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4
  use sg_sorting, only: group_items
  use sg_sparse, only: sparse_from_triplets, sparse_t
  use sg_text, only: to_text
  implicit none
  private
  public :: solve_by_parts

  !> Most unknowns of a part: its factors are full
  integer, parameter :: largest_part = 3000

contains

  !> X = A^-1 C; each part of A is factorised full.
  subroutine solve_by_parts(a, name, c, x, error)
    type(sparse_t), intent(in) :: a !! square matrix, symmetric or not
    character(len=*), intent(in) :: name !! what an error calls A
    type(sparse_t), intent(in) :: c !! right-hand sides, of as many rows
    type(sparse_t), intent(out) :: x !! solutions
    type(error_t), allocatable, intent(out) :: error !! set when A is singular or a part too large
    integer(i4), allocatable :: first(:), member(:), local(:), row(:), column(:), place(:), wanted(:)
    real(wp), allocatable :: value(:), solutions(:, :)
    integer :: part, n, j

    call find_parts(a, first, member, local)
    allocate (row(size(c%column)), column(size(c%column)), value(size(c%column)))
    allocate (place(c%n_columns), source=0_i4)
    n = 0
    do part = 1, size(first) - 1
      associate (rows => member(first(part):first(part + 1) - 1))
        if (size(rows) > largest_part) then
          call fail(error, name//' connects '//to_text(size(rows))//' unknowns, and at most '//to_text(largest_part)// &
                    ' can be eliminated together')
          return
        end if
        call gather_columns(c, rows, place, wanted, solutions)
        call solve_part(a, rows, local, name, solutions, error)
        if (allocated(error)) return
        call reserve(n, n + size(solutions), row, column, value)
        do j = 1, size(wanted)
          row(n + 1:n + size(rows)) = rows
          column(n + 1:n + size(rows)) = wanted(j)
          value(n + 1:n + size(rows)) = solutions(:, j)
          n = n + size(rows)
        end do
      end associate
    end do
    call sparse_from_triplets(c%n_rows, c%n_columns, row(:n), column(:n), value(:n), x)
  end subroutine solve_by_parts

  !> Rows of each part, and the number of each row within its part.
  pure subroutine find_parts(a, first, member, local)
    type(sparse_t), intent(in) :: a
    integer(i4), allocatable, intent(out) :: first(:), member(:), local(:)
    integer(i4), allocatable :: root(:), part_of(:)
    integer :: i, e, parts

    allocate (root(a%n_rows), part_of(a%n_rows), local(a%n_rows))
    root = [(int(i, i4), i=1, a%n_rows)]
    do i = 1, a%n_rows
      do e = a%first(i), a%first(i + 1) - 1
        call join(root, int(i, i4), a%column(e))
      end do
    end do
    parts = 0
    do i = 1, a%n_rows
      root(i) = root_of(root, int(i, i4))
      if (root(i) == i) then
        parts = parts + 1
        part_of(i) = int(parts, i4)
      end if
    end do
    part_of = part_of(root)
    call group_items(part_of, parts, first, member)
    do i = 1, parts
      local(member(first(i):first(i + 1) - 1)) = [(int(e, i4), e=1, first(i + 1) - first(i))]
    end do
  end subroutine find_parts

  !> Make one set of the sets of two rows; the lower root stays.
  pure subroutine join(root, i, j)
    integer(i4), intent(inout) :: root(:)
    integer(i4), intent(in) :: i, j
    integer(i4) :: a, b

    a = root_of(root, i)
    b = root_of(root, j)
    root(max(a, b)) = min(a, b)
    root(i) = min(a, b)
    root(j) = min(a, b)
  end subroutine join

  !> Root of a row's set.
  pure integer(i4) function root_of(root, i) result(top)
    integer(i4), intent(in) :: root(:), i

    top = i
    do while (root(top) /= top)
      top = root(top)
    end do
  end function root_of

  !> The columns of C that have an entry in some rows, and those rows of them.
  pure subroutine gather_columns(c, rows, place, wanted, values)
    type(sparse_t), intent(in) :: c
    integer(i4), intent(in) :: rows(:)
    integer(i4), intent(inout) :: place(:)
    integer(i4), allocatable, intent(out) :: wanted(:)
    real(wp), allocatable, intent(out) :: values(:, :)
    integer :: k, n, e

    allocate (wanted(sum(c%first(rows + 1) - c%first(rows))))
    n = 0
    do k = 1, size(rows)
      do e = c%first(rows(k)), c%first(rows(k) + 1) - 1
        if (place(c%column(e)) > 0) cycle
        n = n + 1
        wanted(n) = c%column(e)
        place(c%column(e)) = int(n, i4)
      end do
    end do
    wanted = wanted(:n)
    allocate (values(size(rows), n), source=0.0_wp)
    do k = 1, size(rows)
      do e = c%first(rows(k)), c%first(rows(k) + 1) - 1
        values(k, place(c%column(e))) = c%value(e)
      end do
    end do
    place(wanted) = 0
  end subroutine gather_columns

  !> Solve with one part of A, in place.
  subroutine solve_part(a, rows, local, name, x, error)
    type(sparse_t), intent(in) :: a
    integer(i4), intent(in) :: rows(:), local(:)
    character(len=*), intent(in) :: name
    real(wp), intent(inout) :: x(:, :)
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: full(size(rows), size(rows)), least, largest
    integer :: pivot(size(rows)), k, e, j
    logical :: is_singular

    full = 0
    do k = 1, size(rows)
      do e = a%first(rows(k)), a%first(rows(k) + 1) - 1
        full(k, local(a%column(e))) = a%value(e)
      end do
    end do
    largest = maxval(abs(full))
    call dense_factorise(full, pivot, is_singular)
    if (.not. is_singular) then
      least = minval([(abs(full(k, k)), k=1, size(rows))])
      is_singular = least <= 4*real(size(rows), wp)*epsilon(1.0_wp)*largest
    end if
    if (is_singular) then
      call fail(error, name//' is singular (row '//to_text(int(rows(1)) - 1)//' and those connected with it, counted from 0)')
      return
    end if
    do j = 1, size(x, 2)
      call dense_solve(full, pivot, x(:, j))
    end do
  end subroutine solve_part

  !> Make room for n triplets, of which some are there.
  pure subroutine reserve(used, n, row, column, value)
    integer, intent(in) :: used, n
    integer(i4), allocatable, intent(inout) :: row(:), column(:)
    real(wp), allocatable, intent(inout) :: value(:)
    integer(i4), allocatable :: more(:)
    real(wp), allocatable :: more_values(:)
    integer :: room

    if (n <= size(row)) return
    room = n + n/2
    allocate (more(room))
    more(:used) = row(:used)
    call move_alloc(more, row)
    allocate (more(room))
    more(:used) = column(:used)
    call move_alloc(more, column)
    allocate (more_values(room))
    more_values(:used) = value(:used)
    call move_alloc(more_values, value)
  end subroutine reserve
end module sg_sparse_parts
