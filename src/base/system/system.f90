!> What the operating system is asked for: terminals, folders, renaming, memory, signals.
module sg_system
  use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_size_t, c_char, c_null_char, c_null_ptr, c_funptr, c_funloc, &
                                         c_loc, c_ptr, c_associated
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use sg_c_library, only: c_signal
  use sg_kinds, only: i8
  implicit none
  private
  public :: is_terminal, make_folder, link_file, rename_file, remove_file, file_exists, is_link, real_path, peak_memory_bytes
  public :: become, end_program, survive_full_disks, catch_signals, stop_signal, checkpoint_requested

  integer(c_int), parameter :: sighup = 1, sigint = 2, sigusr1 = 10, sigpipe = 13, sigterm = 15, sigxfsz = 25
  !> What C calls SIG_IGN
  integer(c_intptr_t), parameter :: ignored = 1

  !> Longest path that the system takes, with the zero byte at its end
  integer, parameter :: longest_path = 4097

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
    function c_link(from, to) bind(c, name='link') result(status)
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: from(*), to(*)
      integer(c_int) :: status
    end function c_link
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
    function c_readlink(path, target, length) bind(c, name='readlink') result(letters)
      import :: c_char, c_intptr_t, c_size_t
      character(kind=c_char), intent(in) :: path(*)
      character(kind=c_char), intent(inout) :: target(*)
      integer(c_size_t), value :: length
      integer(c_intptr_t) :: letters
    end function c_readlink
    function c_realpath(path, full) bind(c, name='realpath') result(address)
      import :: c_char, c_ptr
      character(kind=c_char), intent(in) :: path(*)
      character(kind=c_char), intent(inout) :: full(*)
      type(c_ptr) :: address
    end function c_realpath
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

  !> Give a file a second name, unless that exists; of several processes that try at once one alone succeeds.
  logical function link_file(from, to) result(done)
    character(len=*), intent(in) :: from !! present name
    character(len=*), intent(in) :: to !! second name

    done = c_link(trim(from)//c_null_char, trim(to)//c_null_char) == 0
  end function link_file

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

  !> Is a name that of a symbolic link, wherever it leads?
  logical function is_link(path)
    character(len=*), intent(in) :: path !! name to look at
    character(kind=c_char) :: target(1)

    is_link = c_readlink(trim(path)//c_null_char, target, 1_c_size_t) >= 0
  end function is_link

  !> Absolute path of a file or folder, without symbolic links; empty where there is none.
  function real_path(path) result(full)
    character(len=*), intent(in) :: path !! path of a file or folder
    character(len=:), allocatable :: full
    character(kind=c_char) :: letters(longest_path)
    integer :: i

    full = ''
    letters = c_null_char
    if (.not. c_associated(c_realpath(path//c_null_char, letters))) return
    do i = 1, size(letters)
      if (letters(i) == c_null_char) exit
      full = full//letters(i)
    end do
  end function real_path

  !> Largest resident memory of this process so far, in bytes; 0 where the system does not report it.
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

  !> A file that grows beyond the limit of the process is an error of the write, as a full disk is, and no end of the program.
  subroutine survive_full_disks()
    type(c_funptr) :: before

    before = c_signal(sigxfsz, transfer(ignored, before))
  end subroutine survive_full_disks

  !> From now on SIGINT, SIGTERM, SIGHUP and SIGPIPE ask to stop after the step, SIGUSR1 asks for a checkpoint. The end of a
  !! terminal, or of the reader of a pipe, stays ignored where the caller had it so (`nohup`).
  subroutine catch_signals()
    integer(c_int), parameter :: ends(2) = [sighup, sigpipe]
    type(c_funptr) :: before
    integer :: i

    before = c_signal(sigint, c_funloc(on_stop))
    before = c_signal(sigterm, c_funloc(on_stop))
    do i = 1, size(ends)
      before = c_signal(ends(i), c_funloc(on_stop))
      if (transfer(before, ignored) == ignored) before = c_signal(ends(i), before)
    end do
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
