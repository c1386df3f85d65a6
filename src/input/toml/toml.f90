!> A TOML text as a flat list of entries: the Fortran side of toml.cpp.
!!
!! Tables, arrays and their elements are entries of their own, in the order of the text, containers first:
!!
!!     [solver]                solver               table
!!     tolerance = 1e-3        solver.tolerance     real
!!     [[body]]                body                 array
!!     position = [0, 1]       body[0]              table
!!                             body[0].position     array
!!                             body[0].position[0]  integer ...
module sg_toml
  use, intrinsic :: iso_c_binding, only: c_associated, c_bool, c_char, c_double, c_int32_t, c_int64_t, c_ptr
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i8
  use sg_system, only: file_exists
  use sg_text, only: lower
  implicit none
  private
  public :: entry_t, document_t, parse_toml, read_content, line_of
  public :: toml_table, toml_array, toml_integer, toml_real, toml_logical, toml_string, toml_names

  !> Kinds of entry
  integer, parameter :: toml_table = 1, toml_array = 2, toml_integer = 3, toml_real = 4, toml_logical = 5, toml_string = 6
  !> Words for the kinds, for messages; the last is dates and times, which decks do not use
  character(len=10), parameter :: toml_names(7) = [character(len=10) :: 'a table', 'a list', 'an integer', 'a number', &
                                                  'a logical', 'a string', 'a date']
  !> Largest deck read [bytes]: beyond it something is wrong
  integer, parameter :: largest = 64*1024**2

  !> One key, table, array or array element
  type :: entry_t
    !> Where it is, such as `body[0].shape[1].radius`; elements count from zero
    character(len=:), allocatable :: path
    !> Kind of entry, one of `toml_*`
    integer :: kind = 0
    !> Entry that holds this one; 0 at the top
    integer :: parent = 0
    !> Line and column of the key and of the value, from 1
    integer :: key_line = 0, key_column = 0, line = 0, column = 0
    !> Value of a string
    character(len=:), allocatable :: text
    !> Value of an integer, and 1 or 0 for a logical
    integer(i8) :: integer = 0
    !> Value of a real or an integer
    real(wp) :: real = 0
  end type entry_t

  !> All entries of a text
  type :: document_t
    type(entry_t), allocatable :: entries(:)
  contains
    procedure :: find => document_find
  end type document_t

  !> What toml.cpp reports of an entry
  type, bind(c) :: c_entry_t
    integer(c_int32_t) :: kind, key_line, key_column, line, column
    integer(c_int64_t) :: parent, path_length, text_length, integer
    real(c_double) :: real
  end type c_entry_t

  interface
    function sg_toml_parse(text, length) bind(c) result(handle)
      import :: c_char, c_int64_t, c_ptr
      character(kind=c_char), intent(in) :: text(*)
      integer(c_int64_t), value :: length
      type(c_ptr) :: handle
    end function sg_toml_parse
    subroutine sg_toml_free(handle) bind(c)
      import :: c_ptr
      type(c_ptr), value :: handle
    end subroutine sg_toml_free
    function sg_toml_count(handle) bind(c) result(count)
      import :: c_int64_t, c_ptr
      type(c_ptr), value :: handle
      integer(c_int64_t) :: count
    end function sg_toml_count
    subroutine sg_toml_describe(handle, index, described) bind(c)
      import :: c_entry_t, c_int64_t, c_ptr
      type(c_ptr), value :: handle
      integer(c_int64_t), value :: index
      type(c_entry_t), intent(out) :: described
    end subroutine sg_toml_describe
    function sg_toml_copy(handle, index, path, text) bind(c) result(copied)
      import :: c_bool, c_char, c_int64_t, c_ptr
      type(c_ptr), value :: handle
      integer(c_int64_t), value :: index
      character(kind=c_char), intent(inout) :: path(*), text(*)
      logical(c_bool) :: copied
    end function sg_toml_copy
  end interface

contains

  !> Parse a TOML text.
  subroutine parse_toml(content, document, error, file, lines_before)
    character(len=*), intent(in) :: content !! the text
    type(document_t), intent(out) :: document !! its entries
    type(error_t), allocatable, intent(out) :: error !! set when the text is no TOML
    character(len=*), intent(in), optional :: file !! name of the text in messages
    integer, intent(in), optional :: lines_before !! lines that stand before a piece of a longer text
    type(c_ptr) :: handle
    type(entry_t) :: mistake
    logical :: copied
    integer :: i, n

    handle = sg_toml_parse(content, len(content, c_int64_t))
    if (.not. c_associated(handle)) then
      call fail(error, 'no memory left for this deck', file=file)
      return
    end if
    n = int(sg_toml_count(handle))
    if (n < 0) then
      call take(handle, 0, mistake, copied)
      mistake%text(1:1) = lower(mistake%text(1:1))
      call fail(error, 'syntax '//mistake%text, file=file, line=mistake%line, column=mistake%column, &
                text=line_of(content, mistake%line))
      if (error%text == '') deallocate (error%text)
    else
      allocate (document%entries(n))
      do i = 1, n
        call take(handle, i - 1, document%entries(i), copied)
        if (.not. copied) exit
      end do
      if (i <= n) call fail(error, 'no memory left for this deck', file=file)
      if (present(lines_before)) then
        document%entries%key_line = document%entries%key_line + lines_before
        document%entries%line = document%entries%line + lines_before
      end if
    end if
    call sg_toml_free(handle)
  end subroutine parse_toml

  !> Copy one entry.
  subroutine take(handle, index, taken, copied)
    type(c_ptr), intent(in) :: handle
    integer, intent(in) :: index
    type(entry_t), intent(out) :: taken
    logical, intent(out) :: copied
    type(c_entry_t) :: described

    call sg_toml_describe(handle, int(index, c_int64_t), described)
    copied = described%path_length >= 0
    if (.not. copied) return
    allocate (character(len=described%path_length) :: taken%path)
    allocate (character(len=described%text_length) :: taken%text)
    copied = sg_toml_copy(handle, int(index, c_int64_t), taken%path, taken%text)
    taken%kind = int(described%kind)
    taken%parent = int(described%parent) + 1
    taken%key_line = int(described%key_line)
    taken%key_column = int(described%key_column)
    taken%line = int(described%line)
    taken%column = int(described%column)
    taken%integer = int(described%integer, i8)
    taken%real = real(described%real, wp)
  end subroutine take

  !> Index of the entry with a path; 0 when there is none.
  pure integer function document_find(self, path) result(found)
    class(document_t), intent(in) :: self
    character(len=*), intent(in) :: path !! such as `body[0].radius`

    do found = 1, size(self%entries)
      if (self%entries(found)%path == path) return
    end do
    found = 0
  end function document_find

  !> Read a whole file into one text.
  subroutine read_content(file, content, error)
    character(len=*), intent(in) :: file !! path
    character(len=:), allocatable, intent(out) :: content !! all its bytes
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be read or is too large
    integer :: unit, status
    integer(i8) :: length
    character(len=200) :: message

    if (file_exists(file//'/BODIES.DAT')) then
      call fail(error, 'this is a folder of LMGC90: "splitgrain convert FOLDER DECK.toml" makes a deck of it, and '// &
                '[scene] datbox = "FOLDER" in a deck reads it', file=file)
      return
    end if
    open (newunit=unit, file=file, access='stream', form='unformatted', status='old', action='read', &
          iostat=status, iomsg=message)
    if (status /= 0) then
      call fail(error, 'cannot read the file: '//trim(message), file=file)
      return
    end if
    inquire (unit=unit, size=length)
    if (length > largest) then
      call fail(error, 'the file is larger than 64 MiB: this is no deck', file=file)
    else
      allocate (character(len=max(length, 0_i8)) :: content)
      if (length > 0) read (unit, iostat=status, iomsg=message) content
      if (status /= 0) call fail(error, 'cannot read the file: '//trim(message), file=file)
    end if
    close (unit)
  end subroutine read_content

  !> Text of one line, fit to be printed: odd bytes as `?`; empty where the line is missing or very long.
  pure function line_of(content, number) result(line)
    character(len=*), intent(in) :: content !! text of all lines
    integer, intent(in) :: number !! line, from 1
    character(len=:), allocatable :: line
    integer, parameter :: longest = 200
    integer :: i, n, first

    line = ''
    first = 1
    n = 1
    do i = 1, len(content)
      if (n == number) exit
      if (content(i:i) /= new_line('a')) cycle
      n = n + 1
      first = i + 1
    end do
    if (n < number) return
    i = index(content(first:), new_line('a'))
    if (i == 0) i = len(content) - first + 2
    if (i > longest) return
    line = content(first:first + i - 2)
    if (len(line) > 0) then
      if (line(len(line):) == achar(13)) line = line(:len(line) - 1)
    end if
    do i = 1, len(line)
      if (iachar(line(i:i)) < 32 .and. line(i:i) /= achar(9)) line(i:i) = '?'
    end do
    line = trim(line)
  end function line_of
end module sg_toml
