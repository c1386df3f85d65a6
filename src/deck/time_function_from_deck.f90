!> A function of time from the keys of a block: formula, or file of two columns.
module sg_time_function_from_deck
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp, pi
  use sg_text, only: read_lines, text_t
  use sg_time_functions, only: time_function_t
  implicit none
  private
  public :: read_time_function, path_in_deck

contains

  !> Read the function of time of a block.
  subroutine read_time_function(deck, b, value, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block with the keys
    type(time_function_t), intent(out) :: value !! the function
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    value%constant = deck%number(b, 'value')
    value%amplitude = deck%number(b, 'amplitude')
    value%omega = 2*pi*deck%number(b, 'frequency')
    value%phase = deck%number(b, 'phase')
    value%ramp_start = deck%number(b, 'ramp_start')
    value%ramp_rate = deck%number(b, 'ramp_rate')
    if (deck%is_given(b, 'omega')) then
      value%omega = deck%number(b, 'omega')
      if (deck%is_given(b, 'frequency')) &
        call deck%complain(diagnostics, 'give either "frequency" or "omega", not both', b, 'omega')
    end if
    if (deck%is_given(b, 'file')) call read_table(deck, b, value, diagnostics)
  end subroutine read_time_function

  !> A path of the deck, relative to the folder of the deck unless it begins with a slash.
  pure function path_in_deck(deck, path) result(full)
    type(deck_t), intent(in) :: deck !! the deck
    character(len=*), intent(in) :: path !! as the deck writes it
    character(len=:), allocatable :: full

    full = deck%folder//path
    if (path(1:min(1, len(path))) == '/') full = path
  end function path_in_deck

  !> Read the table of a file: two columns, times growing; blank lines and lines that begin with # or ! are passed over.
  subroutine read_table(deck, b, value, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(time_function_t), intent(inout) :: value
    type(diagnostics_t), intent(inout) :: diagnostics
    type(text_t), allocatable :: lines(:)
    type(error_t), allocatable :: error
    character(len=:), allocatable :: path, first
    real(wp) :: row(2)
    integer :: i, n, status

    path = path_in_deck(deck, deck%word(b, 'file'))
    call read_lines(path, lines, error)
    if (allocated(error)) then
      call deck%complain(diagnostics, 'cannot read the file "'//path//'"', b, 'file')
      return
    end if
    allocate (value%times(size(lines)), value%values(size(lines)))
    n = 0
    do i = 1, size(lines)
      first = adjustl(lines(i)%s)
      if (first == '') cycle
      if (index('#!', first(1:1)) > 0) cycle
      read (lines(i)%s, *, iostat=status) row
      if (status == 0) then
        if (.not. all(ieee_is_finite(row))) status = 1
      end if
      if (status /= 0) then
        call diagnostics%add('a time and a value should stand here', file=path, line=i, column=1, text=lines(i)%s)
        return
      end if
      if (n > 0) then
        if (.not. row(1) > value%times(n)) then
          call diagnostics%add('times must grow from line to line', file=path, line=i, column=1, text=lines(i)%s)
          return
        end if
      end if
      n = n + 1
      value%times(n) = row(1)
      value%values(n) = row(2)
    end do
    value%times = value%times(:n)
    value%values = value%values(:n)
    if (n < 2) call deck%complain(diagnostics, 'the file "'//path//'" needs two lines or more', b, 'file')
  end subroutine read_table
end module sg_time_function_from_deck
