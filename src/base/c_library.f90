!> Procedures of the C library that several modules call: files, signals, the end of a process, lengths of texts.
module sg_c_library
  use, intrinsic :: iso_c_binding, only: c_char, c_funptr, c_int, c_intptr_t, c_long, c_ptr, c_size_t
  implicit none
  private
  public :: c_exit_now, c_fclose, c_fileno, c_fopen, c_fseek, c_fsync, c_fwrite, c_signal, c_strlen, c_write, from_start

  !> What C calls SEEK_SET
  integer(c_int), parameter :: from_start = 0

  interface
    function c_fopen(path, mode) bind(c, name='fopen') result(stream)
      import :: c_char, c_ptr
      character(kind=c_char), intent(in) :: path(*), mode(*)
      type(c_ptr) :: stream
    end function c_fopen
    function c_fclose(stream) bind(c, name='fclose') result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: stream
      integer(c_int) :: status
    end function c_fclose
    function c_fwrite(text, size, n, stream) bind(c, name='fwrite') result(done)
      import :: c_char, c_ptr, c_size_t
      character(kind=c_char), intent(in) :: text(*)
      integer(c_size_t), value :: size, n
      type(c_ptr), value :: stream
      integer(c_size_t) :: done
    end function c_fwrite
    function c_fseek(stream, place, whence) bind(c, name='fseek') result(status)
      import :: c_int, c_long, c_ptr
      type(c_ptr), value :: stream
      integer(c_long), value :: place
      integer(c_int), value :: whence
      integer(c_int) :: status
    end function c_fseek
    function c_fileno(stream) bind(c, name='fileno') result(descriptor)
      import :: c_int, c_ptr
      type(c_ptr), value :: stream
      integer(c_int) :: descriptor
    end function c_fileno
    function c_fsync(descriptor) bind(c, name='fsync') result(status)
      import :: c_int
      integer(c_int), value :: descriptor
      integer(c_int) :: status
    end function c_fsync
    function c_write(descriptor, text, n) bind(c, name='write') result(written)
      import :: c_char, c_int, c_intptr_t, c_size_t
      integer(c_int), value :: descriptor
      character(kind=c_char), intent(in) :: text(*)
      integer(c_size_t), value :: n
      integer(c_intptr_t) :: written
    end function c_write
    function c_signal(number, handler) bind(c, name='signal') result(before)
      import :: c_funptr, c_int
      integer(c_int), value :: number
      type(c_funptr), value :: handler
      type(c_funptr) :: before
    end function c_signal
    subroutine c_exit_now(code) bind(c, name='_exit')
      import :: c_int
      integer(c_int), value :: code
    end subroutine c_exit_now
    pure function c_strlen(text) bind(c, name='strlen') result(length)
      import :: c_ptr, c_size_t
      type(c_ptr), value :: text
      integer(c_size_t) :: length
    end function c_strlen
  end interface
end module sg_c_library
