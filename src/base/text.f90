!> Text: files as lists of lines, numbers as words, and the nearest known word to a misspelt one.
module sg_text
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i8
  implicit none
  private
  public :: text_t, read_lines, split_lines, to_text, counted, lower, nearest_word, joined, append_word

  !> One string of any length, so that lists of strings exist
  type :: text_t
    character(len=:), allocatable :: s
  end type text_t

  !> A number as a word without blanks
  interface to_text
    module procedure :: integer_to_text, long_to_text, real_to_text
  end interface to_text

  interface
    pure subroutine c_write_real(value, decimals, length, letters, n) bind(c, name='splitgrain_write_real')
      import :: c_char, c_double, c_int
      real(c_double), value :: value
      integer(c_int), value :: decimals, length
      character(kind=c_char), intent(out) :: letters(*)
      integer(c_int), intent(out) :: n
    end subroutine c_write_real
  end interface

contains

  !> A number of things, with the noun in the singular or in the plural.
  pure function counted(n, noun) result(words)
    integer, intent(in) :: n !! how many
    character(len=*), intent(in) :: noun !! noun whose plural ends with -s
    character(len=:), allocatable :: words

    words = to_text(n)//' '//noun
    if (n /= 1) words = words//'s'
  end function counted

  !> Read a whole text file as lines; carriage returns at line ends are dropped.
  subroutine read_lines(file, lines, error)
    character(len=*), intent(in) :: file !! path
    type(text_t), allocatable, intent(out) :: lines(:) !! the lines, without their ends
    type(error_t), allocatable, intent(out) :: error !! set when the file cannot be read
    character(len=:), allocatable :: content
    integer :: unit, status, length
    character(len=200) :: message

    open (newunit=unit, file=file, access='stream', form='unformatted', status='old', action='read', &
          iostat=status, iomsg=message)
    if (status == 0) inquire (unit=unit, size=length)
    if (status /= 0) then
      call fail(error, 'cannot read the file: '//trim(message), file=file)
      return
    end if
    allocate (character(len=max(length, 0)) :: content)
    if (length > 0) read (unit, iostat=status, iomsg=message) content
    close (unit)
    if (status /= 0) then
      call fail(error, 'cannot read the file: '//trim(message), file=file)
      return
    end if
    call split_lines(content, lines)
  end subroutine read_lines

  !> Split a text into lines; carriage returns at line ends are dropped.
  pure subroutine split_lines(content, lines)
    character(len=*), intent(in) :: content !! text of a file or a part of it
    type(text_t), allocatable, intent(out) :: lines(:) !! the lines, without their ends
    integer :: first, last, n

    allocate (lines(count_lines(content)))
    first = 1
    do n = 1, size(lines)
      last = index(content(first:), new_line('a')) + first - 2
      if (last < first - 1) last = len(content)
      lines(n)%s = without_return(content(first:last))
      first = last + 2
    end do
  end subroutine split_lines

  !> Number of lines of a file's content; a last line without an end counts.
  pure integer function count_lines(content) result(n)
    character(len=*), intent(in) :: content
    integer :: i

    n = 0
    do i = 1, len(content)
      if (content(i:i) == new_line('a')) n = n + 1
    end do
    if (len(content) == 0) return
    if (content(len(content):) /= new_line('a')) n = n + 1
  end function count_lines

  !> A line without a closing carriage return.
  pure function without_return(line) result(cut)
    character(len=*), intent(in) :: line
    character(len=:), allocatable :: cut

    cut = line
    if (len(line) == 0) return
    if (line(len(line):) == achar(13)) cut = line(:len(line) - 1)
  end function without_return

  !> An integer as a word.
  pure function integer_to_text(value) result(word)
    integer, intent(in) :: value !! number to write
    character(len=:), allocatable :: word
    character(len=24) :: buffer

    write (buffer, '(i0)') value
    word = trim(buffer)
  end function integer_to_text

  !> A long integer as a word.
  pure function long_to_text(value) result(word)
    integer(i8), intent(in) :: value !! number to write
    character(len=:), allocatable :: word
    character(len=24) :: buffer

    write (buffer, '(i0)') value
    word = trim(buffer)
  end function long_to_text

  !> A real as a word: `digits` significant digits, by default all 17 that a double needs.
  pure function real_to_text(value, digits) result(word)
    real(wp), intent(in) :: value !! number to write
    integer, intent(in), optional :: digits !! significant digits, at most 30; 17 when absent
    character(len=:), allocatable :: word
    character(kind=c_char, len=1) :: letters(40)
    character(len=size(letters)) :: buffer
    integer(c_int) :: written
    integer :: n, i

    if (.not. abs(value) <= huge(value)) then
      write (buffer, '(es40.1)') value
      word = trim(adjustl(buffer))
      return
    end if
    n = 17
    if (present(digits)) n = digits
    call c_write_real(value, int(n - 1, c_int), size(letters, kind=c_int), letters, written)
    n = int(written)
    allocate (character(len=n) :: word)
    do i = 1, n
      word(i:i) = merge('E', letters(i), letters(i) == 'e')
    end do
  end function real_to_text

  !> Lower case of an ASCII text.
  pure function lower(text) result(small)
    character(len=*), intent(in) :: text !! any text
    character(len=len(text)) :: small
    integer :: i

    small = text
    do i = 1, len(text)
      if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') small(i:i) = achar(iachar(text(i:i)) + 32)
    end do
  end function lower

  !> The known word nearest to `word` by edit distance; empty when none is near (a third of the length or less).
  pure function nearest_word(word, known) result(nearest)
    character(len=*), intent(in) :: word !! misspelt word
    type(text_t), intent(in) :: known(:) !! words to choose from
    character(len=:), allocatable :: nearest
    integer :: i, best, distance

    nearest = ''
    best = max(2, len(word)/3) + 1
    do i = 1, size(known)
      distance = edit_distance(word, known(i)%s)
      if (distance >= best) cycle
      best = distance
      nearest = known(i)%s
    end do
  end function nearest_word

  !> Levenshtein distance: least number of letters to insert, delete or replace.
  pure integer function edit_distance(a, b) result(distance)
    character(len=*), intent(in) :: a, b
    integer :: row(0:len(b)), i, j, diagonal, above, cost

    row = [(j, j=0, len(b))]
    do i = 1, len(a)
      diagonal = row(0)
      row(0) = i
      do j = 1, len(b)
        cost = merge(0, 1, a(i:i) == b(j:j))
        above = row(j)
        row(j) = min(above + 1, row(j - 1) + 1, diagonal + cost)
        diagonal = above
      end do
    end do
    distance = row(len(b))
  end function edit_distance

  !> Append a word to a list, item by item: gfortran 12 leaks the texts of items in an array constructor.
  pure subroutine append_word(list, word)
    type(text_t), allocatable, intent(inout) :: list(:) !! list to grow; made when unallocated
    character(len=*), intent(in) :: word !! word to append
    type(text_t), allocatable :: grown(:)
    integer :: i, n

    n = 0
    if (allocated(list)) n = size(list)
    allocate (grown(n + 1))
    do i = 1, n
      call move_alloc(list(i)%s, grown(i)%s)
    end do
    grown(n + 1)%s = word
    call move_alloc(grown, list)
  end subroutine append_word

  !> Words joined by a separator.
  pure function joined(words, separator) result(text)
    type(text_t), intent(in) :: words(:) !! words to join
    character(len=*), intent(in) :: separator !! put between two words
    character(len=:), allocatable :: text
    integer :: i, length

    length = len(separator)*max(0, size(words) - 1)
    do i = 1, size(words)
      length = length + len(words(i)%s)
    end do
    allocate (character(len=length) :: text)
    length = 0
    do i = 1, size(words)
      if (i > 1) then
        text(length + 1:length + len(separator)) = separator
        length = length + len(separator)
      end if
      text(length + 1:length + len(words(i)%s)) = words(i)%s
      length = length + len(words(i)%s)
    end do
  end function joined
end module sg_text
