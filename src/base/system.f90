!> What the operating system is asked for: terminals, folders, renaming, memory, signals.
module sg_system
  use, intrinsic :: iso_c_binding, only: c_int, c_char, c_null_char, c_null_ptr, c_funptr, c_funloc, c_loc, c_ptr
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use sg_kinds, only: i8
  implicit none
  private
  public :: is_terminal, make_folder, rename_file, remove_file, file_exists, peak_memory_bytes
  public :: become, end_program, catch_signals, stop_signal, checkpoint_requested

  integer(c_int), parameter :: sigint = 2, sigusr1 = 10, sigterm = 15

  ! Set by signal handlers, which can reach nothing but module variables.
  integer(c_int), volatile, save :: caught_stop = 0, caught_checkpoint = 0

  interface
    function c_isatty(descriptor) bind(c, name='isatty') result(yes)
      import :: c_int
      integer(c_int), value :: descriptor
      integer(c_int) :: yes
    end function c_isatty
    function c_mkdir(path, mode) bind(c, name='mkdir') result(status)
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode
      integer(c_int) :: status
    end function c_mkdir
    function c_rename(from, to) bind(c, name='rename') result(status)
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: from(*), to(*)
      integer(c_int) :: status
    end function c_rename
    function c_unlink(path) bind(c, name='unlink') result(status)
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: status
    end function c_unlink
    function c_execv(path, words) bind(c, name='execv') result(status)
      import :: c_int, c_char, c_ptr
      character(kind=c_char), intent(in) :: path(*)
      type(c_ptr), intent(in) :: words(*)
      integer(c_int) :: status
    end function c_execv
    subroutine c_exit(code) bind(c, name='exit')
      import :: c_int
      integer(c_int), value :: code
    end subroutine c_exit
    function c_signal(number, handler) bind(c, name='signal') result(before)
      import :: c_int, c_funptr
      integer(c_int), value :: number
      type(c_funptr), value :: handler
      type(c_funptr) :: before
    end function c_signal
  end interface

contains

  !> Is standard output a terminal?
  logical function is_terminal()
    is_terminal = c_isatty(1_c_int) == 1
  end function is_terminal

  !> Make a folder and its parents; an existing one is kept.
  logical function make_folder(path) result(made)
    character(len=*), intent(in) :: path !! folder to make
    integer :: i
    integer(c_int) :: status

    do i = 2, len_trim(path)
      if (path(i:i) == '/') status = c_mkdir(path(:i - 1)//c_null_char, int(o'777', c_int))
    end do
    status = c_mkdir(trim(path)//c_null_char, int(o'777', c_int))
    inquire (file=trim(path)//'/.', exist=made)
  end function make_folder

  !> Rename a file over another; the change is all or nothing.
  logical function rename_file(from, to) result(done)
    character(len=*), intent(in) :: from !! present name
    character(len=*), intent(in) :: to !! new name, replaced when it exists

    done = c_rename(trim(from)//c_null_char, trim(to)//c_null_char) == 0
  end function rename_file

  !> Remove a file; a missing one is no fault.
  subroutine remove_file(path)
    character(len=*), intent(in) :: path !! file to remove
    integer(c_int) :: status

    status = c_unlink(trim(path)//c_null_char)
  end subroutine remove_file

  !> Does a file or folder of this name exist?
  logical function file_exists(path)
    character(len=*), intent(in) :: path !! name to look for

    inquire (file=trim(path), exist=file_exists)
  end function file_exists

  !> Largest resident memory of this process so far, in bytes; 0 where the system does not tell.
  integer(i8) function peak_memory_bytes() result(bytes)
    character(len=200) :: line
    integer :: unit, status

    bytes = 0
    open (newunit=unit, file='/proc/self/status', status='old', action='read', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (line(:6) /= 'VmHWM:') cycle
      read (line(7:index(line, 'kB') - 1), *, iostat=status) bytes
      bytes = bytes*1024
      exit
    end do
    close (unit)
  end function peak_memory_bytes

  !> End the program with an exit code, in good order: open files are flushed.
  subroutine end_program(code)
    integer, intent(in) :: code !! exit code

    flush (output_unit)
    flush (error_unit)
    call c_exit(int(code, c_int))
  end subroutine end_program

  !> Become another program, which goes on in place of this one; it comes back only when that cannot be started.
  subroutine become(words)
    character(len=*), intent(in) :: words(:) !! path of the program, then its arguments; blanks at their ends are not of them
    character(kind=c_char, len=len(words) + 1), allocatable, target :: texts(:)
    type(c_ptr), allocatable :: places(:)
    integer(c_int) :: status
    integer :: i

    allocate (texts(size(words)), places(size(words) + 1))
    do i = 1, size(words)
      texts(i) = trim(words(i))//c_null_char
      places(i) = c_loc(texts(i))
    end do
    places(size(words) + 1) = c_null_ptr
    flush (output_unit)
    flush (error_unit)
    status = c_execv(trim(words(1))//c_null_char, places)
  end subroutine become

  !> From now on SIGINT and SIGTERM ask to stop after the step, SIGUSR1 asks for a checkpoint.
  subroutine catch_signals()
    type(c_funptr) :: before

    before = c_signal(sigint, c_funloc(on_stop))
    before = c_signal(sigterm, c_funloc(on_stop))
    before = c_signal(sigusr1, c_funloc(on_checkpoint))
  end subroutine catch_signals

  !> Number of the stop signal received; 0 when none.
  integer function stop_signal()
    stop_signal = int(caught_stop)
  end function stop_signal

  !> Has a checkpoint been asked for since the last call?
  logical function checkpoint_requested()
    ! Only a request that was seen is taken back: one that comes meanwhile must not be lost.
    checkpoint_requested = caught_checkpoint /= 0
    if (checkpoint_requested) caught_checkpoint = 0
  end function checkpoint_requested

  subroutine on_stop(number) bind(c)
    integer(c_int), value :: number

    caught_stop = number
  end subroutine on_stop

  subroutine on_checkpoint(number) bind(c)
    integer(c_int), value :: number

    caught_checkpoint = number
  end subroutine on_checkpoint
end module sg_system
