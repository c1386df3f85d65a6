!> A text file read line by line in either direction, of which only a window of lines is held: files larger than memory can be
!! read, and places gone back to.
module sg_text_window
  use sg_error, only: error_t, fail
  use sg_kinds, only: i8
  use sg_text, only: split_lines, text_t
  implicit none
  private
  public :: text_window_t

  !> Lines of a window
  integer, parameter :: window = 4096
  !> Bytes read at a time while lines are counted
  integer, parameter :: block = 1048576

  !> A file and the lines of it that are held
  type :: text_window_t
    !> Number of lines; a last line without an end counts
    integer :: n = 0
    !> Mix of all bytes, by which files are distinguished
    integer(i8) :: digest = 0
    character(len=:), allocatable, private :: file
    !> Byte at which each window begins, and the one behind the file
    integer(i8), allocatable, private :: start(:)
    !> Which window is held, its lines
    integer, private :: held = 0
    type(text_t), allocatable, private :: lines(:)
  contains
    procedure :: open => window_open
    procedure :: get => window_get
  end type text_window_t

contains

  !> Go once through a file and note where its windows begin.
  subroutine window_open(self, file, error)
    class(text_window_t), intent(out) :: self
    character(len=*), intent(in) :: file !! path
    type(error_t), allocatable, intent(out) :: error !! set when the file cannot be read
    character(len=200) :: message
    integer(i8) :: length
    integer :: unit, status

    self%file = file
    self%start = [1_i8]
    open (newunit=unit, file=file, access='stream', form='unformatted', status='old', action='read', iostat=status, &
          iomsg=message)
    if (status == 0) then
      inquire (unit=unit, size=length)
      call count_lines(self, unit, length, status, message)
      close (unit)
    end if
    if (status /= 0) call fail(error, 'cannot read the file: '//trim(message), file=file)
  end subroutine window_open

  !> Count the lines of an open file, a block of it at a time.
  subroutine count_lines(self, unit, length, status, message)
    type(text_window_t), intent(inout) :: self
    integer, intent(in) :: unit
    integer(i8), intent(in) :: length
    integer, intent(out) :: status
    character(len=*), intent(inout) :: message
    character(len=:), allocatable :: content
    integer(i8) :: at
    integer :: i

    status = 0
    at = 0
    do while (at < length)
      allocate (character(len=int(min(int(block, i8), length - at))) :: content)
      read (unit, iostat=status, iomsg=message) content
      if (status /= 0) return
      do i = 1, len(content)
        self%digest = ieor(ishftc(self%digest, 5), int(iachar(content(i:i)), i8))
        if (content(i:i) /= new_line('a') .and. at + int(i, i8) < length) cycle
        self%n = self%n + 1
        if (mod(self%n, window) == 0) self%start = [self%start, at + int(i, i8) + 1]
      end do
      at = at + int(len(content), i8)
      deallocate (content)
    end do
    self%start = [self%start, length + 1]
  end subroutine count_lines

  !> A line, without its end and a carriage return there; empty where there is none or the file can no longer be read.
  subroutine window_get(self, number, line)
    class(text_window_t), intent(inout) :: self
    integer, intent(in) :: number !! of the line, from 1
    character(len=:), allocatable, intent(inout) :: line !! its text
    integer :: wanted, place

    line = ''
    if (number < 1 .or. number > self%n) return
    wanted = (number - 1)/window + 1
    if (wanted /= self%held) call hold(self, wanted)
    place = number - (wanted - 1)*window
    if (place <= size(self%lines)) line = self%lines(place)%s
  end subroutine window_get

  !> Read a window.
  subroutine hold(self, wanted)
    class(text_window_t), intent(inout) :: self
    integer, intent(in) :: wanted
    character(len=:), allocatable :: content
    integer :: unit, status

    self%held = wanted
    allocate (character(len=int(self%start(wanted + 1) - self%start(wanted))) :: content)
    open (newunit=unit, file=self%file, access='stream', form='unformatted', status='old', action='read', iostat=status)
    if (status == 0) read (unit, pos=self%start(wanted), iostat=status) content
    if (status /= 0) content = ''
    close (unit, iostat=status)
    call split_lines(content, self%lines)
  end subroutine hold
end module sg_text_window
