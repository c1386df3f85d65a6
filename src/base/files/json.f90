!> One JSON object: strings, numbers, booleans, null and lists of such objects, valid whatever the values are.
module sg_json
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_kinds, only: wp, i8
  use sg_text, only: to_text
  implicit none
  private
  public :: json_t

  !> An object that is being written
  type :: json_t
    !> The members so far
    character(len=:), allocatable, private :: members
  contains
    procedure, private :: add_text, add_integer, add_long, add_real, add_logical, add_member
    !> Add a member
    generic :: add => add_text, add_integer, add_long, add_real, add_logical
    procedure :: add_objects
    procedure :: text => json_text
    procedure :: line => json_line
  end type json_t

contains

  !> Add a string.
  subroutine add_text(self, key, value)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: key !! name of the member
    character(len=*), intent(in) :: value !! any text; trailing blanks are dropped

    call self%add_member(key, quoted(trim(value)))
  end subroutine add_text

  !> Add an integer.
  subroutine add_integer(self, key, value)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: key !! name of the member
    integer, intent(in) :: value !! any number

    call self%add_member(key, to_text(value))
  end subroutine add_integer

  !> Add a long integer.
  subroutine add_long(self, key, value)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: key !! name of the member
    integer(i8), intent(in) :: value !! any number

    call self%add_member(key, to_text(value))
  end subroutine add_long

  !> Add a real; null when it is not finite.
  subroutine add_real(self, key, value)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: key !! name of the member
    real(wp), intent(in) :: value !! any number

    if (ieee_is_finite(value)) then
      call self%add_member(key, to_text(value))
    else
      call self%add_member(key, 'null')
    end if
  end subroutine add_real

  !> Add true or false.
  subroutine add_logical(self, key, value)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: key !! name of the member
    logical, intent(in) :: value !! true or false

    call self%add_member(key, trim(merge('true ', 'false', value)))
  end subroutine add_logical

  !> Add a list of objects, one a line.
  subroutine add_objects(self, key, objects)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: key !! name of the member
    type(json_t), intent(in) :: objects(:) !! the objects
    character(len=:), allocatable :: list
    integer :: i

    list = '['
    do i = 1, size(objects)
      list = list//new_line('a')//'    '//objects(i)%line()
      if (i < size(objects)) list = list//','
    end do
    call self%add_member(key, list//']')
  end subroutine add_objects

  !> Add a member whose value is JSON already.
  subroutine add_member(self, key, value)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: key, value
    character(len=*), parameter :: end_of_line = ','//new_line('a')

    if (.not. allocated(self%members)) then
      self%members = ''
    else
      self%members = self%members//end_of_line
    end if
    self%members = self%members//'  '//quoted(key)//': '//value
  end subroutine add_member

  !> The object, one member a line.
  pure function json_text(self) result(text)
    class(json_t), intent(in) :: self
    character(len=:), allocatable :: text

    text = ''
    if (allocated(self%members)) text = self%members//new_line('a')
    text = '{'//new_line('a')//text//'}'
  end function json_text

  !> The object on one line.
  pure function json_line(self) result(text)
    class(json_t), intent(in) :: self
    character(len=:), allocatable :: text
    integer :: i

    text = '{'
    if (allocated(self%members)) then
      ! Ends of lines stand between members alone: within strings they are escaped.
      do i = 3, len(self%members)
        if (self%members(i:i) == new_line('a')) cycle
        if (self%members(i - 1:i - 1) == new_line('a')) cycle
        text = text//self%members(i:i)
      end do
    end if
    text = text//'}'
  end function json_line

  !> A text as a JSON string: quotes, backslashes and control characters escaped, bytes that are no UTF-8 replaced.
  pure function quoted(text) result(string)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: string
    character(len=6) :: code
    integer :: i, n

    string = '"'
    i = 1
    do while (i <= len(text))
      n = max(1, utf8_length(text(i:)))
      if (text(i:i) == '"' .or. text(i:i) == '\') then
        string = string//'\'//text(i:i)
      else if (iachar(text(i:i)) < 32) then
        write (code, '(a,z4.4)') '\u', iachar(text(i:i))
        string = string//code
      else if (utf8_length(text(i:)) == 0) then
        string = string//'?'
      else
        string = string//text(i:i + n - 1)
      end if
      i = i + n
    end do
    string = string//'"'
  end function quoted

  !> Bytes of the UTF-8 character that a text begins with; 0 when it begins with none.
  pure integer function utf8_length(text) result(n)
    character(len=*), intent(in) :: text
    integer :: byte, i

    byte = ichar(text(1:1))
    select case (byte)
    case (0:127)
      n = 1
    case (194:223)
      n = 2
    case (224:239)
      n = 3
    case (240:244)
      n = 4
    case default
      n = 0
    end select
    if (n > len(text)) n = 0
    do i = 2, n
      if (iand(ichar(text(i:i)), 192) /= 128) n = 0
    end do
  end function utf8_length
end module sg_json
