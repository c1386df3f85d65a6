!> Files that are written under another name, brought to the disk and only then given their own: whoever looks finds the file of
!! before or the whole new one, also on a full disk and after a kill. All files that the program makes come about this way.
module sg_settle_file
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_null_char, c_ptr
  use sg_c_library, only: c_fclose, c_fileno, c_fopen, c_fsync
  use sg_error, only: error_t, exit_output, fail
  use sg_system, only: remove_file, rename_file
  implicit none
  private
  public :: begin_file, part_of, settle_file

  interface
    function c_take_mode(from, to) bind(c, name='splitgrain_take_mode') result(status)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: from(*), to(*)
      integer(c_int) :: status
    end function c_take_mode
  end interface

contains

  !> Name under which a file is to be written.
  pure function part_of(file) result(part)
    character(len=*), intent(in) :: file !! path of the file to make
    character(len=:), allocatable :: part

    part = file//'.part'
  end function part_of

  !> The same, where it can be written at once: what stood there is removed, since a symbolic link would lead elsewhere.
  function begin_file(file) result(part)
    character(len=*), intent(in) :: file !! path of the file to make
    character(len=:), allocatable :: part

    part = part_of(file)
    call remove_file(part)
  end function begin_file

  !> Give a file that was written its own name, and the permissions of the file that it replaces; remove it where that, or the
  !! writing, failed.
  subroutine settle_file(part, file, error)
    character(len=*), intent(in) :: part !! name under which it was written
    character(len=*), intent(in) :: file !! its own name; what stands there is replaced
    type(error_t), allocatable, intent(inout) :: error !! why it could not be written; set when it cannot be settled

    if (.not. allocated(error)) then
      if (c_take_mode(file//c_null_char, part//c_null_char) /= 0) then
        call fail(error, 'cannot give the file the permissions of the one that it replaces', file=file, code=exit_output)
      else if (.not. is_synced(part)) then
        call fail(error, 'cannot bring the file to the disk', file=part, code=exit_output)
      else if (.not. rename_file(part, file)) then
        call fail(error, 'cannot give the file its name', file=file, code=exit_output)
      end if
    end if
    if (allocated(error)) call remove_file(part)
  end subroutine settle_file

  !> Is a file on the disk, and not only in the system's memory? It is brought there.
  logical function is_synced(file)
    character(len=*), intent(in) :: file
    type(c_ptr) :: stream
    integer(c_int) :: status

    is_synced = .false.
    stream = c_fopen(file//c_null_char, 'r+'//c_null_char)
    if (.not. c_associated(stream)) return
    is_synced = c_fsync(c_fileno(stream)) == 0
    status = c_fclose(stream)
    is_synced = is_synced .and. status == 0
  end function is_synced
end module sg_settle_file
