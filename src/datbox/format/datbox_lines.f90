!> Files of an LMGC90 DATBOX as lines of fixed columns: keywords and names (numbers: sg_datbox_numbers).
!!
!! Only columns count: labels such as `coo1=` are not looked at. Blank lines and lines that begin with `!` or `#`
!! are skipped. A block keyword stands in columns 2 to 6, by habit after a `$`.
module sg_datbox_lines
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: i8
  use sg_system, only: file_exists
  use sg_text_window, only: text_window_t
  implicit none
  private
  public :: datbox_file_t, open_datbox_file, next_line, next_data_line, step_back, go_to, keyword, line_text, first_letter
  public :: columns, name_field, complain, complain_once, remark, pass_over
  public :: is_block_end, end_with_file, next_in_block, digest_of

  !> Errors after which the rest of a file is not read: what follows is noise
  integer, parameter :: most_errors = 20
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
    type(datbox_file_t), intent(in) :: file !! file being read
    integer, intent(in) :: first, last !! first and last column
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
