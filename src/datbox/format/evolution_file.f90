!> Evolution files: times and values, in two columns or several, as DATBOX folders and decks name them.
module sg_evolution_file
  use sg_datbox_numbers, only: free_numbers
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp
  use sg_text, only: read_lines, text_t, to_text
  use sg_time_functions, only: time_function_t
  implicit none
  private
  public :: read_evolution_file

  !> Longest line shown with a mistake
  integer, parameter :: longest_shown = 120

contains

  !> Read a table of growing times and values; blank lines and lines that begin with # or ! are passed over.
  !! A file with a mistake gives no table: the function keeps its formula.
  !!
  !! A mistake inside the file is reported at its line. A fault of the file as a whole is returned to the caller, which
  !! reports it at the place that names the file.
  subroutine read_evolution_file(path, has_two_columns, value, fault, diagnostics, column)
    character(len=*), intent(in) :: path !! the file
    logical, intent(in) :: has_two_columns !! is a third number on a line a mistake? LMGC90 passes over it
    type(time_function_t), intent(inout) :: value !! its table is set
    character(len=:), allocatable, intent(out) :: fault !! empty, or what is wrong with the file as a whole
    type(diagnostics_t), intent(inout) :: diagnostics !! takes what is wrong inside
    integer, intent(in), optional :: column !! of the values, the second unless given
    type(text_t), allocatable :: lines(:)
    type(error_t), allocatable :: error
    character(len=:), allocatable :: first, mistake
    integer :: i, n, place

    fault = ''
    place = 2
    if (present(column)) place = column
    call read_lines(path, lines, error)
    if (allocated(error)) then
      fault = 'cannot read the file "'//path//'"'
      return
    end if
    allocate (value%times(size(lines)), value%values(size(lines)))
    n = 0
    do i = 1, size(lines)
      first = adjustl(lines(i)%s)
      if (first == '') cycle
      if (index('#!', first(1:1)) > 0) cycle
      call add_row(lines(i)%s, has_two_columns, place, value, n, mistake)
      if (mistake == '') cycle
      call complain(path, i, lines(i)%s, mistake, diagnostics)
      deallocate (value%times, value%values)
      return
    end do
    value%times = value%times(:n)
    value%values = value%values(:n)
    if (n >= 2) return
    fault = 'the file "'//path//'" needs two lines or more'
    deallocate (value%times, value%values)
  end subroutine read_evolution_file

  !> Report a mistake in a line, which is shown where it holds numbers alone: a path may lead to a file that is no table, and whose
  !! content must not get into logs.
  subroutine complain(path, number, line, mistake, diagnostics)
    character(len=*), intent(in) :: path, line, mistake
    integer, intent(in) :: number
    type(diagnostics_t), intent(inout) :: diagnostics

    if (verify(line, '0123456789+-.eEdD, '//achar(9)) == 0 .and. len(line) <= longest_shown) then
      call diagnostics%add(mistake, file=path, line=number, column=1, text=line)
    else
      call diagnostics%add(mistake, file=path, line=number, column=1)
    end if
  end subroutine complain

  !> Add one row to the table, or report what is wrong with it.
  subroutine add_row(line, has_two_columns, column, value, n, mistake)
    character(len=*), intent(in) :: line
    logical, intent(in) :: has_two_columns
    integer, intent(in) :: column
    type(time_function_t), intent(inout) :: value
    integer, intent(inout) :: n
    character(len=:), allocatable, intent(out) :: mistake
    real(wp) :: row(column), more(3)
    logical :: is_row, has_more

    mistake = ''
    call free_numbers(line, more, has_more)
    if (has_more .and. has_two_columns) then
      mistake = 'a third number stands here: a table has two columns, time and value, unless "column" names one'
      return
    end if
    call free_numbers(line, row, is_row)
    if (.not. is_row) then
      mistake = 'a time and a value should stand here'
      if (column > 2) mistake = to_text(column)//' numbers or more should stand here'
      return
    end if
    if (n > 0) then
      if (.not. row(1) > value%times(n)) then
        mistake = 'times must grow from line to line'
        return
      end if
    end if
    n = n + 1
    value%times(n) = row(1)
    value%values(n) = row(column)
  end subroutine add_row
end module sg_evolution_file
