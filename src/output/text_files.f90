!> Text files that are written wholly or not at all, and appended to so that a full disk is noticed.
!!
!! The Fortran library reports a failed write when the file is closed, not when it is flushed: each piece is
!! therefore written to a file that is opened for it and closed after it.
module sg_text_files
  use sg_error, only: error_t, exit_output, fail
  use sg_system, only: remove_file, rename_file
  implicit none
  private
  public :: append_text, replace_file

contains

  !> Append text to a file, made when missing.
  subroutine append_text(file, text, error)
    character(len=*), intent(in) :: file !! path
    character(len=*), intent(in) :: text !! what to append, with its line ends
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written

    call write_text(file, text, 'append', error)
  end subroutine append_text

  !> Give a file a new content under a temporary name, then its name: a reader sees the old or the new one.
  subroutine replace_file(file, text, error)
    character(len=*), intent(in) :: file !! path
    character(len=*), intent(in) :: text !! the whole content
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    character(len=:), allocatable :: part

    part = file//'.part'
    call remove_file(part)
    call write_text(part, text, 'rewind', error)
    if (.not. allocated(error)) then
      if (rename_file(part, file)) return
      call fail(error, 'cannot give the file its name', file=file, code=exit_output)
    end if
    call remove_file(part)
  end subroutine replace_file

  !> Write text at a position of a file.
  subroutine write_text(file, text, position, error)
    character(len=*), intent(in) :: file, text, position
    type(error_t), allocatable, intent(out) :: error
    character(len=200) :: message
    integer :: unit, status, closing

    open (newunit=unit, file=file, access='stream', form='unformatted', action='write', position=position, &
          iostat=status, iomsg=message)
    if (status == 0) then
      write (unit, iostat=status, iomsg=message) text
      if (status == 0) then
        close (unit, iostat=status, iomsg=message)
      else
        close (unit, iostat=closing)
      end if
    end if
    if (status /= 0) call fail(error, 'cannot write the file: '//trim(message), file=file, code=exit_output)
  end subroutine write_text
end module sg_text_files
