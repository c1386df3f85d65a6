!> What FCLIB files are made of (doc/guide/solve.md): whole numbers, vectors and sparse matrices, each checked as it is read.
!!
!! A failed check goes where a failure of the library goes, into the file's `error`: readers make all their calls and look
!! once, at the end. Indices count from 0 in files, and from 1 here.
module sg_fclib_items
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_error, only: exit_bad_input, fail
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: wp, i4, i8
  use sg_matrix_pieces, only: triplets_t
  use sg_sparse, only: sparse_from_triplets, sparse_t
  use sg_text, only: to_text
  implicit none
  private
  public :: refuse, holds, read_number, read_vector, read_matrix, write_number, write_matrix

  !> What stands in `nz` for matrices that are no triplets: columns compressed, rows compressed
  integer, parameter :: by_columns = -1, by_rows = -2

contains

  !> Keep what is wrong with a file, unless something was before.
  subroutine refuse(file, message)
    class(hdf5_file_t), intent(inout) :: file !! file read
    character(len=*), intent(in) :: message !! one sentence

    if (.not. allocated(file%error)) call fail(file%error, message, file=file%name, code=exit_bad_input)
  end subroutine refuse

  !> Is there something of this path, its parents included?
  logical function holds(file, path)
    class(hdf5_file_t), intent(inout) :: file !! open file
    character(len=*), intent(in) :: path !! from the root, with a slash before each name
    integer :: slash, next

    holds = .false.
    slash = 1
    do
      next = index(path(slash + 1:), '/')
      if (next == 0) exit
      if (.not. file%has(path(:slash + next - 1))) return
      slash = slash + next
    end do
    holds = file%has(path)
  end function holds

  !> Must something be there? Its absence is noted.
  logical function is_missing(file, path)
    class(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path

    is_missing = .not. holds(file, path)
    if (is_missing) call refuse(file, path//' is missing')
  end function is_missing

  !> Read one whole number; 0 after a failure.
  subroutine read_number(file, path, number)
    class(hdf5_file_t), intent(inout) :: file !! open file
    character(len=*), intent(in) :: path !! dataset of one entry
    integer, intent(out) :: number !! its value
    integer(i4), allocatable :: entries(:)

    number = 0
    call read_integers(file, path, entries)
    if (allocated(file%error)) return
    if (size(entries) == 1) then
      number = entries(1)
    else
      call refuse(file, path//' has '//to_text(size(entries))//' entries, not one')
    end if
  end subroutine read_number

  !> Read whole numbers; empty after a failure.
  subroutine read_integers(file, path, entries)
    class(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer(i4), allocatable, intent(out) :: entries(:)

    if (is_missing(file, path)) then
      allocate (entries(0))
    else
      call file%get(path, entries)
    end if
  end subroutine read_integers

  !> Read finite reals; empty after a failure.
  subroutine read_vector(file, path, n, values)
    class(hdf5_file_t), intent(inout) :: file !! open file
    character(len=*), intent(in) :: path !! dataset
    integer, intent(in) :: n !! entries that it must have; negative when any number will do
    real(wp), allocatable, intent(out) :: values(:) !! entries
    integer :: i

    if (is_missing(file, path)) then
      allocate (values(0))
      return
    end if
    call file%get(path, values)
    if (allocated(file%error)) return
    if (n >= 0 .and. size(values) /= n) then
      call refuse(file, path//' has '//to_text(size(values))//' entries, not '//to_text(n))
    end if
    do i = 1, size(values)
      if (ieee_is_finite(values(i))) cycle
      call refuse(file, path//' is not finite: its entry '//to_text(i - 1)//', counted from 0')
      exit
    end do
  end subroutine read_vector

  !> Read a matrix of any storage; zeros that are stored are dropped. Without rows and columns after a failure.
  subroutine read_matrix(file, path, n_rows, n_columns, matrix)
    class(hdf5_file_t), intent(inout) :: file !! open file
    character(len=*), intent(in) :: path !! group of the matrix
    integer, intent(in) :: n_rows !! rows that it must have
    integer, intent(in) :: n_columns !! columns that it must have; negative when any number will do
    type(sparse_t), intent(out) :: matrix !! the matrix
    integer(i4), allocatable :: row(:), column(:)
    real(wp), allocatable :: value(:)
    integer :: m, n, nz, bad
    logical, allocatable :: is_kept(:)

    if (.not. allocated(file%error)) then
      if (.not. is_missing(file, path)) call read_number(file, path//'/m', m)
    end if
    call read_number(file, path//'/n', n)
    call read_number(file, path//'/nz', nz)
    if (allocated(file%error)) return
    if (m /= n_rows .or. n < 0 .or. (n_columns >= 0 .and. n /= n_columns)) then
      call refuse(file, path//' is '//to_text(m)//' by '//to_text(n)//', where the rest of the file needs '//to_text(n_rows)// &
                  ' rows'//columns_wanted(n_columns))
      return
    end if
    if (nz == by_columns) then
      call read_compressed(file, path, n, m, column, row, value)
    else if (nz == by_rows) then
      call read_compressed(file, path, m, n, row, column, value)
    else
      call read_triplets(file, path, nz, m, n, row, column, value)
    end if
    if (allocated(file%error)) return
    bad = findloc(ieee_is_finite(value), .false., 1)
    if (bad > 0) then
      call refuse(file, path//'/x is not finite: its entry '//to_text(bad - 1)//', counted from 0')
      return
    end if
    allocate (is_kept(size(value)))
    is_kept = abs(value) > 0
    call sparse_from_triplets(m, n, pack(row, is_kept), pack(column, is_kept), pack(value, is_kept), matrix)
  end subroutine read_matrix

  !> Words for the number of columns that a matrix must have.
  pure function columns_wanted(n) result(text)
    integer, intent(in) :: n
    character(len=:), allocatable :: text

    text = ''
    if (n >= 0) text = ' and '//to_text(n)//' columns'
  end function columns_wanted

  !> Read the triplets of a matrix; there may be more room on disk than triplets.
  !!
  !! fclib.h calls p the rows and i the columns, but all known files hold it the other way round, as CXSparse does.
  subroutine read_triplets(file, path, nz, m, n, row, column, value)
    class(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer, intent(in) :: nz, m, n
    integer(i4), allocatable, intent(out) :: row(:), column(:)
    real(wp), allocatable, intent(out) :: value(:)
    integer(i4), allocatable :: swapped(:)

    allocate (row(0), column(0), value(0))
    if (nz < 0) then
      call refuse(file, path//'/nz is '//to_text(nz)//': neither a number of triplets nor -1 (columns) or -2 (rows)')
    else if (nz > 0) then
      call read_integers(file, path//'/i', row)
      call read_integers(file, path//'/p', column)
      call file%get(path//'/x', value)
      call check_length(file, path//'/i', size(row), nz)
      call check_length(file, path//'/p', size(column), nz)
      call check_length(file, path//'/x', size(value), nz)
      if (allocated(file%error)) return
      row = row(:nz)
      column = column(:nz)
      value = value(:nz)
      if (maxval(row) >= m .and. maxval(row) < n .and. maxval(column) < m) then
        call move_alloc(row, swapped)
        call move_alloc(column, row)
        call move_alloc(swapped, column)
      end if
      call check_range(file, path//'/i', row, m)
      call check_range(file, path//'/p', column, n)
      row = row + 1_i4
      column = column + 1_i4
    end if
  end subroutine read_triplets

  !> Read a matrix whose lines, rows or columns, follow one another.
  subroutine read_compressed(file, path, n_lines, n_across, line, across, value)
    class(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer, intent(in) :: n_lines, n_across
    integer(i4), allocatable, intent(out) :: line(:), across(:)
    real(wp), allocatable, intent(out) :: value(:)
    integer(i4), allocatable :: first(:)
    integer :: k, n

    allocate (line(0))
    call read_integers(file, path//'/p', first)
    if (.not. allocated(file%error) .and. size(first) /= n_lines + 1) then
      call refuse(file, path//'/p has '//to_text(size(first))//' entries, not '//to_text(n_lines + 1))
    end if
    if (.not. allocated(file%error)) then
      if (first(1) /= 0 .or. any(first(2:) < first(:n_lines))) call refuse(file, path//'/p does not rise from 0')
    end if
    n = 0
    if (.not. allocated(file%error)) n = first(n_lines + 1)
    allocate (across(0), value(0))
    if (allocated(file%error) .or. n == 0) return
    call read_integers(file, path//'/i', across)
    call file%get(path//'/x', value)
    call check_length(file, path//'/i', size(across), n)
    call check_length(file, path//'/x', size(value), n)
    if (allocated(file%error)) return
    across = across(:n)
    value = value(:n)
    call check_range(file, path//'/i', across, n_across)
    across = across + 1_i4
    deallocate (line)
    allocate (line(n))
    do k = 1, n_lines
      line(first(k) + 1:first(k + 1)) = int(k, i4)
    end do
  end subroutine read_compressed

  !> A list must have so many entries, or more.
  subroutine check_length(file, path, length, needed)
    class(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer, intent(in) :: length, needed

    if (length < needed) call refuse(file, path//' has '//to_text(length)//' entries, fewer than the '//to_text(needed)//' needed')
  end subroutine check_length

  !> Indices must lie between 0 and the number of rows or columns.
  subroutine check_range(file, path, indices, n)
    class(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer(i4), intent(in) :: indices(:)
    integer, intent(in) :: n
    integer :: bad

    bad = findloc(indices >= 0 .and. indices < n, .false., 1)
    if (bad == 0) return
    call refuse(file, path//' holds the index '//to_text(int(indices(bad)))//', out of the range 0 to '//to_text(n - 1))
  end subroutine check_range

  !> Write one whole number.
  subroutine write_number(file, path, number)
    class(hdf5_file_t), intent(inout) :: file !! open file
    character(len=*), intent(in) :: path !! dataset to make
    integer, intent(in) :: number !! its value, the same on all ranks that share the file

    call file%put(path, [int(number, i4)], is_common=.true.)
  end subroutine write_number

  !> Write a matrix as triplets, which all readers take; ranks that share the file bring some of them each.
  subroutine write_matrix(file, path, n_rows, n_columns, entries)
    class(hdf5_file_t), intent(inout) :: file !! open file
    character(len=*), intent(in) :: path !! group to make
    integer, intent(in) :: n_rows !! rows
    integer, intent(in) :: n_columns !! columns
    type(triplets_t), intent(in) :: entries !! entries that this rank brings
    integer(i8) :: all

    call file%group(path)
    all = file%total(size(entries%value))
    if (all > int(huge(1_i4), i8)) call refuse(file, path//' has more entries than FCLIB files can count')
    call write_number(file, path//'/nzmax', int(min(all, int(huge(1_i4), i8))))
    call write_number(file, path//'/m', n_rows)
    call write_number(file, path//'/n', n_columns)
    call write_number(file, path//'/nz', int(min(all, int(huge(1_i4), i8))))
    call file%put(path//'/p', entries%column - 1_i4)
    call file%put(path//'/i', entries%row - 1_i4)
    call file%put(path//'/x', entries%value)
  end subroutine write_matrix
end module sg_fclib_items
