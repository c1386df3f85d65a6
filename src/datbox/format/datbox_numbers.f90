!> Numbers in lines of an LMGC90 DATBOX: whole numbers within columns, reals in 14 columns, and numbers of free format.
module sg_datbox_numbers
  use sg_datbox_lines, only: columns, complain, datbox_file_t, remark
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_text, only: to_text
  implicit none
  private
  public :: real_field, is_real, integer_field, free_numbers

  !> Columns of a real number
  integer, parameter :: real_width = 14
  !> Largest decimal exponent: no length, force or mass needs more, and fourth powers still fit a double
  integer, parameter :: largest_exponent = 60
  !> Smallest decimal exponent: what is written of numbers that have all but vanished
  integer, parameter :: smallest_exponent = -400

contains

  !> A real number that begins at a column; where it is wrong, a mistake is reported and `ok` turns false.
  subroutine real_field(file, first, value, ok, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file being read
    integer, intent(in) :: first !! first of 14 columns
    real(wp), intent(out) :: value !! the number, zero when wrong
    logical, intent(inout) :: ok !! turned false when the number is wrong, else left alone
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=real_width) :: field
    character(len=:), allocatable :: fault
    integer :: status

    value = 0
    field = columns(file, first, first + real_width - 1)
    if (field == '') then
      call remark(file, 'blank number', 'no number stands in columns '//to_text(first)//' to '//to_text(first + real_width - 1) &
                  //', which is read as zero, as LMGC90 does', first, diagnostics)
      return
    end if
    fault = fault_of_real(field)
    if (fault == '') then
      read (field, '(d14.0)', iostat=status) value
      if (status /= 0) fault = 'this is not a number'
    end if
    if (fault /= '') then
      call complain_field(file, first, real_width, fault, diagnostics)
      ok = .false.
    else if (is_cut(file, first, value)) then
      call remark(file, 'cut number', 'a number runs out of columns '//to_text(first)//' to ' &
                       //to_text(first + real_width - 1)//' and is read as '//to_text(value, 7)//', as LMGC90 does', &
                       first, diagnostics)
    end if
  end subroutine real_field

  !> Do these columns of the present line hold a number?
  pure logical function is_real(file, first)
    type(datbox_file_t), intent(in) :: file !! file being read
    integer, intent(in) :: first !! first of 14 columns

    is_real = fault_of_real(columns(file, first, first + real_width - 1)) == ''
  end function is_real

  !> Does a number begin before its columns or go on behind them, so that it is another than what is read of it?
  pure logical function is_cut(file, first, value)
    type(datbox_file_t), intent(in) :: file
    integer, intent(in) :: first
    real(wp), intent(in) :: value
    character(len=*), parameter :: letters = '+-.0123456789dDeE'
    character(len=3*real_width) :: around
    real(wp) :: whole
    integer :: low, high, status

    around = columns(file, first - real_width, first + 2*real_width - 1)
    low = real_width + 1
    high = 2*real_width
    if (around(low:low) /= ' ') low = verify(around(:low), letters, back=.true.) + 1
    if (around(high:high) /= ' ') high = high + verify(around(high + 1:)//' ', letters) - 1
    is_cut = low <= real_width .or. high > 2*real_width
    if (.not. is_cut) return
    read (around(low:high), '(d42.0)', iostat=status) whole
    is_cut = status /= 0 .or. abs(whole - value) > 0
  end function is_cut

  !> What is wrong with a real number; empty when nothing is.
  pure function fault_of_real(field) result(fault)
    character(len=*), intent(in) :: field
    character(len=:), allocatable :: fault
    character(len=len(field)) :: word
    integer :: mark, exponent, status

    fault = ''
    word = adjustl(field)
    if (index(field, achar(9)) > 0) then
      fault = 'a tab stands where a number should: only blanks keep the columns'
    else if (word == '') then
      fault = 'a number is missing here'
    else
      mark = scan(word(2:), 'dDeE+-') + 1
      if (mark == 1) mark = len_trim(word) + 1
      if (.not. is_mantissa(word(:mark - 1))) then
        fault = 'this is not a number'
        if (is_integer(word)) fault = 'a number needs its decimal point: LMGC90 scales one without'
        ! Zero stays zero however it is scaled.
        if (is_integer(word) .and. verify(word, '+-0 ') == 0) fault = ''
        return
      end if
      if (mark > len_trim(word)) return
      if (scan(word(mark:mark), 'dDeE') > 0) mark = mark + 1
      if (.not. is_integer(word(mark:))) then
        fault = 'this is not a number'
        return
      end if
      read (word(mark:), *, iostat=status) exponent
      if (status /= 0) exponent = huge(1)
      if (exponent > largest_exponent .or. exponent < smallest_exponent) fault = 'this number is out of range'
    end if
  end function fault_of_real

  !> Is this an optional sign, then digits with one point among them?
  pure logical function is_mantissa(word)
    character(len=*), intent(in) :: word
    integer :: first, point

    first = 1
    if (scan(word(1:1), '+-') > 0) first = 2
    point = index(word, '.')
    is_mantissa = point >= first .and. len(word) > first
    if (is_mantissa) is_mantissa = verify(word(first:point - 1)//word(point + 1:), '0123456789') == 0
  end function is_mantissa

  !> Is this an optional sign, then digits?
  pure logical function is_integer(word)
    character(len=*), intent(in) :: word
    integer :: first, last

    last = len_trim(word)
    first = 1
    if (last > 0) then
      if (scan(word(1:1), '+-') > 0) first = 2
    end if
    is_integer = last >= first
    if (is_integer) is_integer = verify(word(first:last), '0123456789') == 0
  end function is_integer

  !> A whole number within columns; where it is wrong, a mistake is reported and `ok` turns false.
  subroutine integer_field(file, first, last, value, ok, diagnostics, may_go_on)
    type(datbox_file_t), intent(inout) :: file !! file being read
    integer, intent(in) :: first !! first column
    integer, intent(in) :: last !! last column
    integer, intent(out) :: value !! the number, zero when wrong
    logical, intent(inout) :: ok !! turned false when the number is wrong, else left alone
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    logical, intent(in), optional :: may_go_on !! may anything follow it, behind a blank? Not when absent
    character(len=last - first + 2) :: word

    word = adjustl(columns(file, first, last))
    if (present(may_go_on)) then
      if (may_go_on) word(index(word, ' '):) = ''
    end if
    value = 0
    if (is_integer(word) .and. len_trim(word) <= 9) then
      read (word, *) value
    else
      ok = .false.
      call complain_field(file, first, last - first + 1, 'a whole number should stand in columns '//to_text(first)//' to ' &
                          //to_text(last), diagnostics)
    end if
  end subroutine integer_field

  !> Numbers of a line of free format, as evolution files have them; false when there are others than wanted.
  subroutine free_numbers(line, values, ok)
    character(len=*), intent(in) :: line !! the line
    real(wp), intent(out) :: values(:) !! as many numbers as wanted
    logical, intent(out) :: ok !! does the line begin with them?
    character(len=len(line) + 1) :: rest
    character(len=:), allocatable :: word
    integer :: i, last, mark, status

    values = 0
    rest = line
    do i = 1, len(line)
      if (rest(i:i) == achar(9) .or. rest(i:i) == ',') rest(i:i) = ' '
    end do
    ok = .true.
    do i = 1, size(values)
      rest = adjustl(rest)
      last = max(1, index(rest, ' ') - 1)
      word = rest(:last)
      rest(:last) = ''
      ! What stands free needs no point: 1e3.
      mark = scan(word, 'dDeE')
      if (mark > 1) then
        if (is_integer(word(:mark - 1))) word = word(:mark - 1)//'.'//word(mark:)
      end if
      ! Forty letters hold any double; more might be digits without end.
      ok = last <= 40 .and. (is_integer(word) .or. fault_of_real(word) == '')
      if (ok) read (word, *, iostat=status) values(i)
      if (ok) ok = status == 0
      if (.not. ok) return
    end do
  end subroutine free_numbers

  !> Report a mistake with the caret under what stands in a field.
  subroutine complain_field(file, first, width, message, diagnostics)
    type(datbox_file_t), intent(inout) :: file
    integer, intent(in) :: first, width
    character(len=*), intent(in) :: message
    type(diagnostics_t), intent(inout) :: diagnostics

    call complain(file, message, first - 1 + max(1, verify(columns(file, first, first + width - 1), ' ')), diagnostics)
  end subroutine complain_field
end module sg_datbox_numbers
