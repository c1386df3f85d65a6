!> Text files that are replaced wholly or not at all, and appended to so that a full disk is noticed.
!!
!! Files are written through the C library: gfortran's gives no status for a write that fails when its buffer is
!! emptied, neither in `flush` nor in `close`.
module sg_text_files
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_null_char, c_ptr, c_size_t
  use sg_error, only: error_t, exit_output, fail
  use sg_system, only: remove_file, rename_file
  implicit none
  private
  public :: append_text, replace_file, is_synced

  interface
    function c_fopen(path, mode) bind(c, name='fopen') result(stream)
      import :: c_char, c_ptr
      character(kind=c_char), intent(in) :: path(*), mode(*)
      type(c_ptr) :: stream
    end function c_fopen
    function c_fwrite(text, size, n, stream) bind(c, name='fwrite') result(written)
      import :: c_char, c_ptr, c_size_t
      character(kind=c_char), intent(in) :: text(*)
      integer(c_size_t), value :: size, n
      type(c_ptr), value :: stream
      integer(c_size_t) :: written
    end function c_fwrite
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
    function c_fclose(stream) bind(c, name='fclose') result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: stream
      integer(c_int) :: status
    end function c_fclose
  end interface

contains

  !> Append text to a file, made when missing; when this returns, the system has it.
  subroutine append_text(file, text, error)
    character(len=*), intent(in) :: file !! path
    character(len=*), intent(in) :: text !! what to append, with its line ends
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written

    call write_text(file, text, 'a', error)
  end subroutine append_text

  !> Give a file a new content under a temporary name, then its name: a reader sees the old or the new one.
  subroutine replace_file(file, text, error)
    character(len=*), intent(in) :: file !! path
    character(len=*), intent(in) :: text !! the whole content
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    character(len=:), allocatable :: part

    part = file//'.part'
    call write_text(part, text, 'w', error)
    if (.not. allocated(error)) then
      if (rename_file(part, file)) return
      call fail(error, 'cannot give the file its name', file=file, code=exit_output)
    end if
    call remove_file(part)
  end subroutine replace_file

  !> Write text to a file opened in a mode of `fopen`.
  subroutine write_text(file, text, mode, error)
    character(len=*), intent(in) :: file, text, mode
    type(error_t), allocatable, intent(out) :: error
    type(c_ptr) :: stream
    integer(c_size_t) :: written

    stream = c_fopen(file//c_null_char, mode//c_null_char)
    if (.not. c_associated(stream)) then
      call fail(error, 'cannot open the file to write it (no folder, or no permission)', file=file, code=exit_output)
      return
    end if
    written = c_fwrite(text, 1_c_size_t, len(text, c_size_t), stream)
    if (c_fclose(stream) /= 0 .or. written < len(text, c_size_t)) &
      call fail(error, 'cannot write the file: is the disk full?', file=file, code=exit_output)
  end subroutine write_text

  !> Is a file on the disk, and not only in the system's memory? It is brought there.
  logical function is_synced(file)
    character(len=*), intent(in) :: file !! path of a finished file
    type(c_ptr) :: stream
    integer(c_int) :: status

    is_synced = .false.
    stream = c_fopen(file//c_null_char, 'r+'//c_null_char)
    if (.not. c_associated(stream)) return
    is_synced = c_fsync(c_fileno(stream)) == 0
    status = c_fclose(stream)
    is_synced = is_synced .and. status == 0
  end function is_synced
end module sg_text_files
