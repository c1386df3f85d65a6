!> Text files that are replaced wholly or not at all, and appended to so that a full disk is noticed.
!!
!! Files are written through the C library: gfortran's gives no status for a write that fails when its buffer is
!! emptied, neither in `flush` nor in `close`.
module sg_text_files
  use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_long, c_null_char, c_ptr, c_size_t
  use sg_c_library, only: c_fclose, c_fopen, c_fseek, c_fwrite, from_start
  use sg_error, only: error_t, exit_output, fail
  use sg_kinds, only: i8
  use sg_settle_file, only: begin_file, settle_file
  use sg_system, only: remove_file
  implicit none
  private
  public :: append_text, create_text, overwrite_text, replace_file

contains

  !> Append text to a file, made when missing; when this returns, the system has it.
  subroutine append_text(file, text, error)
    character(len=*), intent(in) :: file !! path
    character(len=*), intent(in) :: text !! what to append, with its line ends
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    type(c_ptr) :: stream

    call open_file(file, 'a', stream, error)
    if (.not. allocated(error)) call write_all(file, stream, text, error)
  end subroutine append_text

  !> Make a file that does not exist, in one step that no other process can share; it is not there when it cannot be written.
  subroutine create_text(file, text, error)
    character(len=*), intent(in) :: file !! path
    character(len=*), intent(in) :: text !! the whole content
    type(error_t), allocatable, intent(out) :: error !! set when it exists, or cannot be written
    type(c_ptr) :: stream

    call open_file(file, 'wx', stream, error)
    if (allocated(error)) return
    call write_all(file, stream, text, error)
    if (allocated(error)) call remove_file(file)
  end subroutine create_text

  !> Write text over that at a place of a file, which grows where needed.
  subroutine overwrite_text(file, place, text, error)
    character(len=*), intent(in) :: file !! path of a file that exists
    integer(i8), intent(in) :: place !! first byte to write over, from 1
    character(len=*), intent(in) :: text !! what to write
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    type(c_ptr) :: stream
    integer(c_int) :: status

    call open_file(file, 'r+', stream, error)
    if (allocated(error)) return
    if (c_fseek(stream, int(place - 1, c_long), from_start) == 0) then
      call write_all(file, stream, text, error)
    else
      status = c_fclose(stream)
      call fail(error, 'cannot write the file', file=file, code=exit_output)
    end if
  end subroutine overwrite_text

  !> Give a file a new content: a reader sees the old or the new one.
  subroutine replace_file(file, text, error)
    character(len=*), intent(in) :: file !! path
    character(len=*), intent(in) :: text !! the whole content
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    character(len=:), allocatable :: part

    part = begin_file(file)
    call create_text(part, text, error)
    call settle_file(part, file, error)
  end subroutine replace_file

  !> Open a file to write it, in a mode of `fopen`.
  subroutine open_file(file, mode, stream, error)
    character(len=*), intent(in) :: file, mode
    type(c_ptr), intent(out) :: stream
    type(error_t), allocatable, intent(out) :: error

    stream = c_fopen(file//c_null_char, mode//c_null_char)
    if (.not. c_associated(stream)) &
      call fail(error, 'cannot open the file to write it (no folder, or no permission)', file=file, code=exit_output)
  end subroutine open_file

  !> Write text to an open file, and close it.
  subroutine write_all(file, stream, text, error)
    character(len=*), intent(in) :: file, text
    type(c_ptr), intent(in) :: stream
    type(error_t), allocatable, intent(out) :: error
    integer(c_size_t) :: written

    written = c_fwrite(text, 1_c_size_t, len(text, c_size_t), stream)
    if (c_fclose(stream) /= 0 .or. written < len(text, c_size_t)) &
      call fail(error, 'cannot write the file: is the disk full?', file=file, code=exit_output)
  end subroutine write_all
end module sg_text_files
