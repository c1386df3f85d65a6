!> Shared libraries that are opened on demand: a run that needs no graph loads no METIS.
!!
!! A `*_with_<library>` submodule names the procedures that it calls, and gets their addresses; c_f_procpointer makes them
!! procedures again. CMake writes down where each library was found (sg_library_files). An opened library stays open.
module sg_library
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_f_procpointer, c_funptr, c_int, c_null_char, &
                                         c_null_funptr, c_null_ptr, c_ptr, c_size_t
  use sg_c_library, only: c_strlen
  use sg_error, only: error_t, exit_failure, fail
  use sg_kinds, only: i8
  implicit none
  private
  public :: find_procedures, heap_bytes, is_open, is_there

  !> What libraries are opened with, the same on all systems: all symbols are looked up at once, so that what lacks shows then
  integer(c_int), parameter :: all_now = 2
  !> What Linux takes for: only if it is open already
  integer(c_int), parameter :: if_open = 4

  !> Statistics of the C library of GNU on allocated memory: bytes taken from the system, ..., bytes in use
  type, bind(c) :: memory_t
    integer(c_size_t) :: arena = 0, free_blocks = 0, fast_blocks = 0, mapped_blocks = 0, mapped_bytes = 0, unused = 0, &
                         fast_bytes = 0, used_bytes = 0, free_bytes = 0, top_bytes = 0
  end type memory_t

  abstract interface
    function mallinfo2() bind(c) result(memory)
      import :: memory_t
      type(memory_t) :: memory
    end function mallinfo2
  end interface

  interface
    function c_dlopen(file, mode) bind(c, name='dlopen') result(handle)
      import :: c_char, c_int, c_ptr
      character(kind=c_char), intent(in) :: file(*)
      integer(c_int), value :: mode
      type(c_ptr) :: handle
    end function c_dlopen
    function c_dlopen_program(none, mode) bind(c, name='dlopen') result(handle)
      import :: c_int, c_ptr
      type(c_ptr), value :: none
      integer(c_int), value :: mode
      type(c_ptr) :: handle
    end function c_dlopen_program
    function c_dlsym(handle, name) bind(c, name='dlsym') result(address)
      import :: c_char, c_funptr, c_ptr
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: name(*)
      type(c_funptr) :: address
    end function c_dlsym
    function c_dlerror() bind(c, name='dlerror') result(text)
      import :: c_ptr
      type(c_ptr) :: text
    end function c_dlerror
  end interface

contains

  !> Addresses of procedures of a library, which is opened unless it is open already.
  subroutine find_procedures(library, file, names, address, error)
    character(len=*), intent(in) :: library !! what people call it
    character(len=*), intent(in) :: file !! where CMake found it; empty when it is a part of the program
    character(len=*), intent(in) :: names(:) !! its procedures
    type(c_funptr), intent(out) :: address(:) !! where they are, same shape
    type(error_t), allocatable, intent(out) :: error !! set when the library or one of its procedures is missing
    type(c_ptr) :: handle
    character(len=:), allocatable :: why
    integer :: i

    address = c_null_funptr
    call open_library(file, handle, why)
    if (c_associated(handle)) then
      do i = 1, size(names)
        address(i) = c_dlsym(handle, trim(names(i))//c_null_char)
        if (.not. c_associated(address(i))) then
          why = reason()
          exit
        end if
      end do
    end if
    if (len(why) > 0) call fail(error, library//' cannot be loaded: '//why, code=exit_failure)
  end subroutine find_procedures

  !> Is a library where CMake found it, or where the system looks? It is not opened for that in the first case.
  subroutine is_there(library, file, error)
    character(len=*), intent(in) :: library !! what people call it
    character(len=*), intent(in) :: file !! where CMake found it; empty when it is a part of the program
    type(error_t), allocatable, intent(out) :: error !! set when it is not there
    type(c_funptr) :: nothing(0)
    logical :: exists

    inquire (file=file, exist=exists)
    if (exists .or. len(file) == 0) return
    call find_procedures(library, file, [character(len=1) ::], nothing, error)
  end subroutine is_there

  !> Is a library in memory, opened by this program or by another library? Reported on Linux alone; elsewhere it may be opened for
  !! that.
  logical function is_open(file)
    character(len=*), intent(in) :: file !! where CMake found it; empty when it is a part of the program
    integer(c_int) :: mode

    mode = all_now + if_open
    is_open = len(file) == 0
    if (.not. is_open) is_open = c_associated(c_dlopen(file//c_null_char, mode))
    if (.not. is_open) is_open = c_associated(c_dlopen(file(index(file, '/', back=.true.) + 1:)//c_null_char, mode))
  end function is_open

  !> Memory that the program has in use: allocated and not freed; 0 where the system does not report it.
  function heap_bytes() result(bytes)
    integer(i8) :: bytes
    procedure(mallinfo2), pointer :: ask
    type(c_funptr) :: address(1)
    type(error_t), allocatable :: error
    type(memory_t) :: memory

    bytes = 0
    call find_procedures('the C library', '', ['mallinfo2'], address, error)
    if (allocated(error)) return
    call c_f_procpointer(address(1), ask)
    memory = ask()
    bytes = int(memory%used_bytes + memory%mapped_bytes, i8)
  end function heap_bytes

  !> Open a library at its place, or wherever the system finds one of its name.
  subroutine open_library(file, handle, why)
    character(len=*), intent(in) :: file
    type(c_ptr), intent(out) :: handle
    character(len=:), allocatable, intent(out) :: why

    why = ''
    if (len(file) == 0) then
      handle = c_dlopen_program(c_null_ptr, all_now)
    else
      handle = c_dlopen(file//c_null_char, all_now)
      if (c_associated(handle)) return
      handle = c_dlopen(file(index(file, '/', back=.true.) + 1:)//c_null_char, all_now)
    end if
    if (.not. c_associated(handle)) why = reason()
  end subroutine open_library

  !> Why the last call failed, in the system's words.
  function reason() result(why)
    character(len=:), allocatable :: why
    character(kind=c_char), pointer :: letters(:)
    type(c_ptr) :: text
    integer :: i

    why = 'no reason given'
    text = c_dlerror()
    if (.not. c_associated(text)) return
    call c_f_pointer(text, letters, [c_strlen(text)])
    deallocate (why)
    allocate (character(len=size(letters)) :: why)
    do i = 1, size(letters)
      why(i:i) = letters(i)
    end do
  end function reason
end module sg_library
