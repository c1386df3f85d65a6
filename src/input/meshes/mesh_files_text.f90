!> What readers of mesh files share: the mesh, a file's whole content, its words, and mistakes with their place.
module sg_mesh_files_text
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4, i8
  use sg_text, only: text_t, to_text
  use sg_welding, only: weld
  implicit none
  private
  public :: mesh_t, mesh_text_t, open_mesh_text, next_word, word_on_line, present_word, skip_line, read_number, fail_at
  public :: weld_mesh

  !> Largest file read [bytes]: ten million triangles of text
  integer(i8), parameter :: largest = 2_i8**30
  !> Longest number: more than any double needs
  integer, parameter :: longest_number = 40
  !> Largest decimal exponent: no length needs more, and sixth powers still fit a double
  integer, parameter :: largest_exponent = 40
  !> Longest line shown with a mistake
  integer, parameter :: longest_shown = 120
  character, parameter :: newline = achar(10)

  !> A surface as a file gives it
  type :: mesh_t
    !> [m], or what the file's unit may be, shape (3, vertices)
    real(wp), allocatable :: vertex(:, :)
    !> Corners of face f: `face_vertex(face_first(f):face_first(f + 1) - 1)`
    integer(i4), allocatable :: face_first(:), face_vertex(:)
    !> Of an OBJ file: faces of part p are `part_first(p)` to `part_first(p + 1) - 1`, its object is `part_object(p)`; parts of an
    !! object follow each other. Names of the objects: empty for faces before the first one. Unallocated of other files
    integer(i4), allocatable :: part_first(:), part_object(:)
    type(text_t), allocatable :: object_name(:)
  end type mesh_t

  !> A file with a place to read from
  type :: mesh_text_t
    !> Path, as messages give it
    character(len=:), allocatable :: path
    !> All bytes
    character(len=:), allocatable :: content
    !> Next byte to look at
    integer :: at = 1
    !> First and last byte of the present word
    integer :: first = 1, last = 0
  end type mesh_text_t

contains

  !> Read a whole file.
  subroutine open_mesh_text(path, text, error)
    character(len=*), intent(in) :: path !! the file
    type(mesh_text_t), intent(out) :: text !! its content, before the first word
    type(error_t), allocatable, intent(out) :: error !! set when the file cannot be read, is empty or far too large
    integer(i8) :: length
    integer :: unit, status
    character(len=200) :: message

    text%path = path
    text%content = ''
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', action='read', iostat=status, iomsg=message)
    if (status /= 0) then
      call fail(error, 'cannot read the file: '//trim(message), file=path)
      return
    end if
    inquire (unit=unit, size=length)
    if (length > largest) then
      call fail(error, 'this mesh is too large: '//to_text(length)//' bytes, more than '//to_text(largest), file=path)
    else if (length <= 0) then
      call fail(error, 'this mesh file is empty', file=path)
    else
      deallocate (text%content)
      allocate (character(len=int(length)) :: text%content)
      read (unit, iostat=status, iomsg=message) text%content
      if (status /= 0) call fail(error, 'cannot read the file: '//trim(message), file=path)
    end if
    close (unit)
  end subroutine open_mesh_text

  !> Go to the next word, on this line or a later one; false at the end of the file.
  pure subroutine next_word(text, found)
    type(mesh_text_t), intent(inout) :: text !! file being read
    logical, intent(out) :: found !! is there one?

    do
      call word_on_line(text, found)
      if (found .or. text%at > len(text%content)) return
      call skip_line(text)
    end do
  end subroutine next_word

  !> Go to the next word on this line; false where there is none. A backslash at its end joins the next line to it.
  pure subroutine word_on_line(text, found)
    type(mesh_text_t), intent(inout) :: text !! file being read
    logical, intent(out) :: found !! is there one?
    integer :: n

    found = .false.
    n = len(text%content)
    do while (text%at <= n)
      if (text%content(text%at:text%at) == newline) return
      if (.not. is_blank(text%content(text%at:text%at))) then
        if (.not. joins_lines(text)) exit
        call skip_line(text)
      else
        text%at = text%at + 1
      end if
    end do
    if (text%at > n) return
    found = .true.
    text%first = text%at
    do while (text%at <= n)
      if (is_blank(text%content(text%at:text%at)) .or. text%content(text%at:text%at) == newline) exit
      text%at = text%at + 1
    end do
    text%last = text%at - 1
  end subroutine word_on_line

  !> Is the next byte a backslash with nothing but blanks behind it on its line?
  pure logical function joins_lines(text)
    type(mesh_text_t), intent(in) :: text
    integer :: i

    joins_lines = .false.
    if (text%content(text%at:text%at) /= '\') return
    do i = text%at + 1, len(text%content)
      if (text%content(i:i) == newline) exit
      if (.not. is_blank(text%content(i:i))) return
    end do
    joins_lines = .true.
  end function joins_lines

  !> A blank, a tab or a carriage return.
  pure logical function is_blank(letter)
    character, intent(in) :: letter

    is_blank = letter == ' ' .or. letter == achar(9) .or. letter == achar(13)
  end function is_blank

  !> Go to the beginning of the next line.
  pure subroutine skip_line(text)
    type(mesh_text_t), intent(inout) :: text !! file being read
    integer :: length

    length = index(text%content(text%at:), newline)
    if (length == 0) then
      text%at = len(text%content) + 1
    else
      text%at = text%at + length
    end if
  end subroutine skip_line

  !> The present word as a number.
  subroutine read_number(text, value, error)
    type(mesh_text_t), intent(in) :: text !! file being read
    real(wp), intent(out) :: value !! the number
    type(error_t), allocatable, intent(out) :: error !! set when the word is no finite number
    character(len=:), allocatable :: fault

    call parse_number(piece(text%content, text%first, text%last), value, fault)
    if (allocated(fault)) call fail_at(text, fault, error)
  end subroutine read_number

  !> The present word, or as many letters of it as wanted.
  pure function present_word(text, most) result(word)
    type(mesh_text_t), intent(in) :: text !! file being read
    integer, intent(in) :: most !! letters wanted at most
    character(len=:), allocatable :: word

    word = piece(text%content, text%first, min(text%last, text%first + most - 1))
  end function present_word

  !> Part of a text; gfortran 12 warns of parts of a component.
  pure function piece(whole, first, last)
    character(len=*), intent(in) :: whole
    integer, intent(in) :: first, last
    character(len=last - first + 1) :: piece

    piece = whole(first:last)
  end function piece

  !> A word as a number, or what is wrong with it.
  !!
  !! Fifteen digits and powers up to 10^22 are exact doubles, and so their product or quotient is rounded once: the number
  !! that reading gives, in a tenth of its time. What is longer is read.
  subroutine parse_number(word, value, fault)
    character(len=*), intent(in) :: word
    real(wp), intent(out) :: value
    character(len=:), allocatable, intent(out) :: fault
    integer(i8) :: digits
    integer :: n_digits, power, status

    value = 0
    call take_apart(word, digits, n_digits, power, status)
    if (status /= 0) then
      fault = '"'//word(:min(len(word), longest_number))//'" is not a finite number'
      return
    else if (power + n_digits > largest_exponent) then
      fault = '"'//word//'" is too large for a coordinate'
      return
    end if
    if (n_digits <= 15 .and. abs(power) <= 22) then
      value = real(digits, wp)
      if (power > 0) value = value*10.0_wp**power
      if (power < 0) value = value/10.0_wp**(-power)
      if (word(1:1) == '-') value = -value
    else
      read (word, *, iostat=status) value
      if (status /= 0) fault = '"'//word//'" is not a finite number'
    end if
  end subroutine parse_number

  !> A number as digits times a power of ten; its sign is left alone. A status other than zero means that it is none.
  pure subroutine take_apart(word, digits, n_digits, power, status)
    character(len=*), intent(in) :: word
    integer(i8), intent(out) :: digits
    integer, intent(out) :: n_digits, power, status
    integer :: i, e, digit, exponent
    logical :: has_point, has_digits

    digits = 0
    n_digits = 0
    power = 0
    status = 1
    has_point = .false.
    has_digits = .false.
    if (len(word) > longest_number) return
    e = scan(word, 'eEdD')
    if (e == 0) e = len(word) + 1
    do i = 1, e - 1
      digit = iachar(word(i:i)) - iachar('0')
      if (digit >= 0 .and. digit <= 9) then
        has_digits = .true.
        if (has_point) power = power - 1
        if (digit > 0 .or. n_digits > 0) n_digits = n_digits + 1
        if (n_digits <= 15) digits = 10*digits + int(digit, i8)
      else if (word(i:i) == '.' .and. .not. has_point) then
        has_point = .true.
      else if (i > 1 .or. scan(word(i:i), '+-') == 0) then
        return
      end if
    end do
    if (.not. has_digits) return
    status = 0
    if (e > len(word)) return
    ! Four digits are beyond any double, and what is far below is zero.
    status = verify(word(e + 1:), '0123456789+-')
    if (status == 0) read (word(e + 1:min(len(word), e + 5)), *, iostat=status) exponent
    if (status == 0) power = power + exponent
    if (digits == 0) power = 0
  end subroutine take_apart

  !> A mistake at the present word, or at another place.
  subroutine fail_at(text, message, error, at)
    type(mesh_text_t), intent(in) :: text !! file being read
    character(len=*), intent(in) :: message !! one sentence
    type(error_t), allocatable, intent(out) :: error !! the mistake
    integer, intent(in), optional :: at !! byte at fault, the first of the present word when absent
    character(len=:), allocatable :: line_text
    integer :: place, line, begin, length, i

    place = text%first
    if (present(at)) place = at
    place = min(place, len(text%content))
    line = 1
    begin = 1
    do i = 1, place - 1
      if (text%content(i:i) /= newline) cycle
      line = line + 1
      begin = i + 1
    end do
    length = index(text%content(begin:), newline) - 1
    if (length < 0) length = len(text%content) + 1 - begin
    if (length > longest_shown) then
      call fail(error, message, file=text%path, line=line, column=place - begin + 1)
      return
    end if
    line_text = piece(text%content, begin, begin + length - 1)
    if (length > 0) then
      if (line_text(length:length) == achar(13)) line_text = line_text(:length - 1)
    end if
    call fail(error, message, file=text%path, line=line, column=place - begin + 1, text=line_text)
  end subroutine fail_at

  !> Make one vertex of those with the same coordinates.
  subroutine weld_mesh(mesh)
    type(mesh_t), intent(inout) :: mesh !! mesh; vertices and their numbers in faces change
    integer(i4), allocatable :: same(:), number(:)
    integer :: i, n

    call weld(mesh%vertex, 0.0_wp, same)
    allocate (number(size(same)))
    n = 0
    do i = 1, size(same)
      if (same(i) /= i) cycle
      n = n + 1
      number(i) = int(n, i4)
      mesh%vertex(:, n) = mesh%vertex(:, i)
    end do
    do i = 1, size(mesh%face_vertex)
      mesh%face_vertex(i) = number(same(mesh%face_vertex(i)))
    end do
    mesh%vertex = mesh%vertex(:, :n)
  end subroutine weld_mesh
end module sg_mesh_files_text
