!> Processes: number, host and start of this one, and whether another one is alive.
module sg_processes
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char, c_size_t
  use sg_system, only: file_exists
  use sg_text, only: to_text
  implicit none
  private
  public :: host_name, is_alive, own_process, start_of

  interface
    function c_getpid() bind(c, name='getpid') result(number)
      import :: c_int
      integer(c_int) :: number
    end function c_getpid
    function c_gethostname(name, length) bind(c, name='gethostname') result(status)
      import :: c_char, c_int, c_size_t
      character(kind=c_char), intent(inout) :: name(*)
      integer(c_size_t), value :: length
      integer(c_int) :: status
    end function c_gethostname
    function c_kill(process, number) bind(c, name='kill') result(status)
      import :: c_int
      integer(c_int), value :: process, number
      integer(c_int) :: status
    end function c_kill
  end interface

contains

  !> Number of this process.
  integer function own_process()
    own_process = int(c_getpid())
  end function own_process

  !> Name of this machine in its network.
  function host_name() result(name)
    character(len=:), allocatable :: name
    character(kind=c_char) :: letters(256)
    integer :: i

    letters = c_null_char
    name = ''
    if (c_gethostname(letters, size(letters, kind=c_size_t) - 1_c_size_t) /= 0) return
    do i = 1, size(letters)
      if (letters(i) == c_null_char) exit
      name = name//letters(i)
    end do
  end function host_name

  !> When a process of this machine began, in ticks since the machine did; 0 where the system does not report it, empty where the
  !! process has ended and its parent has not fetched its status. Numbers of processes are used again; a number with its start is
  !! not.
  function start_of(process) result(ticks)
    integer, intent(in) :: process !! number of the process
    character(len=:), allocatable :: ticks
    character(len=1000) :: line
    integer :: unit, status, i, word

    ticks = '0'
    open (newunit=unit, file='/proc/'//to_text(process)//'/stat', status='old', action='read', iostat=status)
    if (status /= 0) return
    read (unit, '(a)', iostat=status) line
    close (unit)
    if (status /= 0) return
    ! After the name in brackets, which may hold blanks, words 3 to 52: word 3 is the state, word 22 the start.
    i = index(line, ') ', back=.true.) + 2
    if (line(i:i) == 'Z' .or. line(i:i) == 'X') ticks = ''
    if (len(ticks) == 0) return
    do word = 3, 21
      i = i + index(line(i:), ' ')
    end do
    ticks = line(i:i + index(line(i:), ' ') - 2)
  end function start_of

  !> Does the process of this machine live that had a number and a start?
  logical function is_alive(process, start)
    integer, intent(in) :: process !! its number
    character(len=*), intent(in) :: start !! what `start_of` gave when it lived

    is_alive = c_kill(int(process, c_int), 0_c_int) == 0 .or. file_exists('/proc/'//to_text(process))
    if (is_alive .and. file_exists('/proc/self/stat')) is_alive = start_of(process) == start
  end function is_alive
end module sg_processes
