!> Files of an LMGC90 DATBOX as lines of fixed columns: keywords, names, whole numbers, reals in 14 columns.
!!
!! Only columns count: labels such as `coo1=` are not looked at. Blank lines and lines that begin with `!` or `#`
!! are skipped. A block keyword stands in columns 2 to 6, by habit after a `$`.
module sg_datbox_lines
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp, i8
  use sg_system, only: file_exists
  use sg_text, only: to_text
  use sg_text_window, only: text_window_t
  implicit none
  private
  public :: datbox_file_t, open_datbox_file, next_line, next_data_line, step_back, go_to, keyword, line_text, first_letter
  public :: name_field, real_field, is_real, integer_field, free_numbers, complain, complain_once, remark, pass_over
  public :: is_block_end, end_with_file, next_in_block, digest_of

  !> Errors after which the rest of a file is not read: what follows is noise
  integer, parameter :: most_errors = 20
  !> Columns of a real number
  integer, parameter :: real_width = 14
  !> Largest decimal exponent: no length, force or mass needs more, and fourth powers still fit a double
  integer, parameter :: largest_exponent = 60
  !> Smallest decimal exponent: what is written of numbers that have all but vanished
  integer, parameter :: smallest_exponent = -400
  !> Keywords that begin a block, a section or a record
  character(len=5), parameter :: keywords(10) = [character(len=5) :: 'bdyty', 'blmty', 'nodty', 'tacty', 'dofty', &
                                                 'gravy', 'behav', 'seety', 'steps', 'icdan']

  !> A file with a place to read from
  type :: datbox_file_t
    !> Path, as messages give it
    character(len=:), allocatable :: path
    !> Number of lines, and of the present one
    integer :: n = 0, at = 0
    !> The present line
    character(len=:), allocatable, private :: line
    !> All lines, of which a few are held
    type(text_window_t), private :: text
    !> Mistakes found so far
    integer :: n_errors = 0
    !> What has been reported and need not be reported again, each between bars
    character(len=:), allocatable :: reported
  end type datbox_file_t

contains

  !> Open a file of the folder; a missing one has no lines, and is a mistake when it is needed.
  subroutine open_datbox_file(file, folder, name, is_needed, diagnostics)
    type(datbox_file_t), intent(out) :: file !! the file, before its first line
    character(len=*), intent(in) :: folder !! DATBOX folder
    character(len=*), intent(in) :: name !! name within the folder
    logical, intent(in) :: is_needed !! must it be there?
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(error_t), allocatable :: error

    file%path = trim(folder)//'/'//name
    file%reported = '|'
    file%line = ''
    if (.not. file_exists(file%path)) then
      if (is_needed) call complain(file, 'this file is missing', 0, diagnostics)
      return
    end if
    call file%text%open(file%path, error)
    if (.not. allocated(error)) file%n = file%text%n
    if (allocated(error)) then
      call complain(file, error%message, 0, diagnostics)
    else if (is_needed .and. file%n == 0) then
      call complain(file, 'this file is empty', 0, diagnostics)
    end if
  end subroutine open_datbox_file

  !> Go to the next line that is neither blank nor a comment; false at the end of the file.
  logical function next_line(file) result(found)
    type(datbox_file_t), intent(inout) :: file !! file to read on

    found = .true.
    do while (file%at < file%n)
      call go_to(file, file%at + 1)
      if (len_trim(file%line) == 0) cycle
      if (all(file%line(1:1) /= ['!', '#'])) return
    end do
    found = .false.
  end function next_line

  !> Go to the next line, which must hold data: a keyword or the end of the file there is a mistake.
  logical function next_data_line(file, wanted, diagnostics) result(found)
    type(datbox_file_t), intent(inout) :: file !! file to read on
    character(len=*), intent(in) :: wanted !! what the line should hold, for the message
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    found = next_line(file)
    if (.not. found) then
      call complain(file, 'the file ends where '//wanted//' should stand', 0, diagnostics)
    else if (keyword(file) /= '') then
      call complain(file, 'a keyword stands where '//wanted//' should', 1, diagnostics)
      call step_back(file)
      found = .false.
    end if
  end function next_data_line

  !> Have the present line read once more.
  subroutine step_back(file)
    type(datbox_file_t), intent(inout) :: file !! file to step back in

    call go_to(file, file%at - 1)
  end subroutine step_back

  !> Make a line the present one; 0 is before the first.
  subroutine go_to(file, at)
    type(datbox_file_t), intent(inout) :: file !! file being read
    integer, intent(in) :: at !! number of the line

    file%at = at
    call file%text%get(at, file%line)
  end subroutine go_to

  !> A digest that distinguishes this file from others.
  pure integer(i8) function digest_of(file)
    type(datbox_file_t), intent(in) :: file !! file that is open

    digest_of = file%text%digest
  end function digest_of

  !> The present line.
  pure function line_text(file) result(text)
    type(datbox_file_t), intent(in) :: file !! file being read
    character(len=:), allocatable :: text

    text = trim(file%line)
  end function line_text

  !> First letter of the present line; blank where it has none.
  pure function first_letter(file) result(letter)
    type(datbox_file_t), intent(in) :: file !! file being read
    character(len=1) :: letter

    letter = ''
    if (len(file%line) > 0) letter = file%line(1:1)
  end function first_letter

  !> Keyword of the present line; blank when it has none.
  pure function keyword(file)
    type(datbox_file_t), intent(in) :: file !! file being read
    character(len=5) :: keyword

    keyword = columns(file, 2, 6)
    if (any(keywords == keyword) .or. keyword == '$$$$$') return
    if (first_letter(file) == '$') return
    keyword = ''
  end function keyword

  !> Does this keyword end a block (`$$$$$$`)?
  pure logical function is_block_end(word)
    character(len=*), intent(in) :: word !! keyword to look at

    is_block_end = word(1:1) == '$'
  end function is_block_end

  !> Columns of the present line, blanks beyond its ends.
  pure function columns(file, first, last)
    type(datbox_file_t), intent(in) :: file
    integer, intent(in) :: first, last
    character(len=last - first + 1) :: columns

    columns = ''
    associate (line => file%line, low => max(1, first))
      if (len(line) >= low) columns(low - first + 1:) = line(low:min(last, len(line)))
    end associate
  end function columns

  !> A word that begins at a column: five letters unless `width` is given.
  pure function name_field(file, first, width) result(name)
    type(datbox_file_t), intent(in) :: file !! file being read
    integer, intent(in) :: first !! first column
    integer, intent(in), optional :: width !! columns, 5 when absent
    character(len=:), allocatable :: name
    integer :: n

    n = 5
    if (present(width)) n = width
    name = trim(columns(file, first, first + n - 1))
  end function name_field

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

  !> Report a mistake in the present line; after too many the rest of the file is not read.
  subroutine complain(file, message, column, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file being read
    character(len=*), intent(in) :: message !! one sentence
    integer, intent(in) :: column !! where the caret stands; 0 for the line as a whole
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    file%n_errors = file%n_errors + 1
    if (file%n_errors > most_errors) return
    if (file%at < 1) then
      call diagnostics%add(message, file=file%path)
    else
      call diagnostics%add(message, file=file%path, line=file%at, column=column, text=line_text(file))
    end if
    if (file%n_errors < most_errors) return
    call diagnostics%add('too many mistakes: the rest of this file is not read', file=file%path)
    call go_to(file, file%n)
  end subroutine complain

  !> Report a mistake about one thing, the first time it is met.
  subroutine complain_once(file, thing, message, column, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file being read
    character(len=*), intent(in) :: thing !! what it is about
    character(len=*), intent(in) :: message !! one sentence
    integer, intent(in) :: column !! where the caret stands; 0 for the line as a whole
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    if (is_news(file, thing)) call complain(file, message, column, diagnostics)
  end subroutine complain_once

  !> Give a warning about one thing, where it is met first, with the number of times that it is met.
  subroutine remark(file, thing, message, column, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file being read
    character(len=*), intent(in) :: thing !! what it is about
    character(len=*), intent(in) :: message !! one sentence
    integer, intent(in) :: column !! where the caret stands; 0 for the line as a whole
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered

    call diagnostics%warn(message, file=file%path, line=file%at, column=column, text=line_text(file), kind=thing)
  end subroutine remark

  !> Pass over the present line, as LMGC90 passes over whatever stands outside the blocks that it looks for.
  subroutine pass_over(file, place, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file being read
    character(len=*), intent(in) :: place !! where it stands, for the message
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered

    call remark(file, 'stray '//place, 'a line '//place//' is passed over, as LMGC90 does', 1, diagnostics)
  end subroutine pass_over

  !> Go to the next line of a body's block; false at its end, which is also where the next body or the end of the file is met first.
  logical function next_in_block(file, diagnostics) result(found)
    type(datbox_file_t), intent(inout) :: file !! file within a block, left at the last line that belongs to it
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered

    found = next_line(file)
    if (.not. found) then
      call end_with_file(file, diagnostics)
    else if (is_block_end(keyword(file))) then
      found = .false.
    else if (keyword(file) == 'bdyty') then
      call remark(file, 'open block', 'a body begins here, before the $$$$$$ of the one before, which ends here, as in LMGC90', 1, &
                  diagnostics)
      call step_back(file)
      found = .false.
    end if
  end function next_in_block

  !> End a block where the file ends, before the line that should end the block.
  subroutine end_with_file(file, diagnostics)
    type(datbox_file_t), intent(inout) :: file !! file at its last line
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered

    ! After too many mistakes the end of the file has not been read.
    if (file%n_errors < most_errors) &
      call remark(file, 'end of file', 'the file ends here, before the $$$$$$ of a body, which ends with it, as in LMGC90', 0, &
                  diagnostics)
  end subroutine end_with_file

  !> Has this thing not been reported yet? It is noted as reported.
  logical function is_news(file, thing)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: thing

    is_news = index(file%reported, '|'//thing//'|') == 0
    if (is_news) file%reported = file%reported//thing//'|'
  end function is_news
end module sg_datbox_lines
