!> CSV files of which each row belongs to a step, named in the first column: taking them up again, and the cells of reals.
module sg_step_csv
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan, ieee_is_negative
  use sg_error, only: error_t, exit_output, fail
  use sg_kinds, only: wp
  use sg_system, only: file_exists
  use sg_text, only: read_lines, text_t, to_text
  use sg_text_files, only: replace_file
  implicit none
  private
  public :: cell, quoted_cell, resume_rows

contains

  !> Go on with the file of a run that restarts after a step: rows of later steps, and a torn last row, are cut; a file that is
  !! not there is begun.
  subroutine resume_rows(file, names, step, error)
    character(len=*), intent(in) :: file !! path
    character(len=*), intent(in) :: names !! first line: of the columns
    integer, intent(in) :: step !! step of the checkpoint
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be read or written, or has other columns
    type(text_t), allocatable :: lines(:)
    character(len=:), allocatable :: kept
    integer :: i

    kept = names//new_line('a')
    if (file_exists(file)) then
      call read_lines(file, lines, error)
      if (allocated(error)) return
      do i = 1, size(lines)
        if (i == 1) then
          if (lines(1)%s == names) cycle
          call fail(error, 'this record has other columns: move it away to restart', file=file, line=1, code=exit_output)
          return
        end if
        if (is_row_until(lines(i)%s, count_columns(names), step)) kept = kept//lines(i)%s//new_line('a')
      end do
    end if
    call replace_file(file, kept, error)
  end subroutine resume_rows

  !> Is this a whole row of a step not later than the one given?
  pure logical function is_row_until(line, columns, last_step)
    character(len=*), intent(in) :: line
    integer, intent(in) :: columns, last_step
    integer :: step, status

    is_row_until = .false.
    if (count_columns(line) /= columns) return
    if (line(len(line):) == ',') return
    read (line(:index(line, ',') - 1), *, iostat=status) step
    is_row_until = status == 0 .and. step <= last_step
  end function is_row_until

  !> Number of columns; commas within quotation marks separate none.
  pure integer function count_columns(line)
    character(len=*), intent(in) :: line
    integer :: i
    logical :: is_quoted

    count_columns = 1
    is_quoted = .false.
    do i = 1, len(line)
      if (line(i:i) == '"') is_quoted = .not. is_quoted
      if (line(i:i) == ',' .and. .not. is_quoted) count_columns = count_columns + 1
    end do
  end function count_columns

  !> A text as a cell: in quotation marks, each of its own doubled, where it holds a comma or one of them.
  pure function quoted_cell(text) result(word)
    character(len=*), intent(in) :: text !! text without line ends
    character(len=:), allocatable :: word
    integer :: i

    word = text
    if (scan(text, ',"') == 0) return
    word = '"'
    do i = 1, len(text)
      word = word//text(i:i)
      if (text(i:i) == '"') word = word//'"'
    end do
    word = word//'"'
  end function quoted_cell

  !> A real with all its digits; pandas and numpy read `nan` and `inf` where it is not finite.
  pure function cell(value) result(word)
    real(wp), intent(in) :: value !! the number
    character(len=:), allocatable :: word

    if (ieee_is_finite(value)) then
      word = to_text(value)
    else if (ieee_is_nan(value)) then
      word = 'nan'
    else
      word = trim(merge('-inf', 'inf ', ieee_is_negative(value)))
    end if
  end function cell
end module sg_step_csv
