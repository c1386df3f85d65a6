!> Rows of datasets that one rank picks out of a file by their numbers: it goes through them in pieces, and holds no dataset whole.
module sg_picked_rows
  use sg_error, only: exit_output, fail
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: wp, i4, i8
  use sg_sorting, only: sort_permutation
  implicit none
  private
  public :: picked_rows_t

  !> Rows that are read at once, at most
  integer, parameter :: piece = 16384

  !> Which rows to read: all, until some are picked
  type :: picked_rows_t
    !> Numbers of the rows from 1, ascending, and where each of them goes
    integer(i4), allocatable, private :: number(:), place(:)
  contains
    procedure :: pick => picked_pick
    procedure :: pick_piece => picked_pick_piece
    procedure :: get => picked_get
  end type picked_rows_t

contains

  !> Pick rows.
  subroutine picked_pick(self, number)
    class(picked_rows_t), intent(inout) :: self
    integer(i4), intent(in) :: number(:) !! numbers of the rows, from 1, in the order in which they are wanted

    self%place = sort_permutation(int(number, i8))
    self%number = number(self%place)
  end subroutine picked_pick

  !> Pick one of so many pieces of a dataset, all of about one size, in the order of the file.
  subroutine picked_pick_piece(self, file, path, part, parts)
    class(picked_rows_t), intent(inout) :: self
    type(hdf5_file_t), intent(inout) :: file !! open file, not shared
    character(len=*), intent(in) :: path !! path within the file
    integer, intent(in) :: part !! which piece, from 0
    integer, intent(in) :: parts !! how many there are
    integer(i8) :: total
    integer :: i

    total = int(rows_of(file, path), i8)
    call self%pick([(int(i, i4), i=int(total*int(part, i8)/int(parts, i8)) + 1, int(total*int(part + 1, i8)/int(parts, i8)))])
  end subroutine picked_pick_piece

  !> Rows of a dataset.
  integer function rows_of(file, path) result(rows)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer(i8) :: total

    total = file%rows(path)
    rows = int(min(total, int(huge(rows), i8)))
    if (total > int(rows, i8)) &
      call fail(file%error, path//' has more entries than can be counted', file=file%name, code=exit_output)
  end function rows_of

  !> Read the rows.
  subroutine picked_get(self, file, path, values)
    class(picked_rows_t), intent(in) :: self
    type(hdf5_file_t), intent(inout) :: file !! open file, not shared
    character(len=*), intent(in) :: path !! path within the file
    real(wp), allocatable, intent(out) :: values(:, :) !! rows in the order wanted; zero beyond the last row of the file
    real(wp), allocatable :: block(:, :)
    integer :: first, last, n, before

    if (.not. allocated(self%number)) then
      call file%get(path, values)
      return
    end if
    call file%get_rows(path, 0_i8, 0, block)
    allocate (values(size(block, 1), size(self%number)), source=0.0_wp)
    n = count(self%number <= rows_of(file, path))
    first = 1
    do while (first <= n .and. .not. allocated(file%error))
      before = self%number(first) - 1
      last = first - 1 + count(self%number(first:min(n, first + piece - 1)) <= before + piece)
      call file%get_rows(path, int(before, i8), self%number(last) - before, block)
      if (size(block) > 0) values(:, self%place(first:last)) = block(:, self%number(first:last) - before)
      first = last + 1
    end do
  end subroutine picked_get
end module sg_picked_rows
