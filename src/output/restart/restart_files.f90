!> The two restart files of a folder, which take turns: which of them was written last.
module sg_restart_files
  use sg_error, only: error_t, fail
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: i8
  use sg_system, only: file_exists
  use sg_text, only: append_word, text_t
  implicit none
  private
  public :: find_newest, find_restarts, newest_restart, restart_names, restarts_of

  !> The two files that take turns
  character(len=*), parameter :: restart_names(2) = [character(len=12) :: 'restart_a.h5', 'restart_b.h5']

contains

  !> Path of the newest restart file of a folder that can be opened; empty when there is none.
  function newest_restart(folder) result(name)
    character(len=*), intent(in) :: folder !! folder of the results
    character(len=:), allocatable :: name
    integer :: newest
    integer(i8) :: serial

    name = ''
    call find_newest(folder, newest, serial)
    if (newest > 0) name = folder//'/'//trim(restart_names(newest))
  end function newest_restart

  !> Find the file written last, by serial number, not by step: a new run may have begun in the folder of an old one.
  subroutine find_newest(folder, newest, serial)
    character(len=*), intent(in) :: folder !! folder of the results
    integer, intent(out) :: newest !! index into `restart_names`; 0 when there is none
    integer(i8), intent(out) :: serial !! its serial number; 0 when there is none
    integer(i8) :: found
    integer :: i

    newest = 0
    serial = 0
    do i = 1, size(restart_names)
      found = serial_of(folder//'/'//restart_names(i))
      if (found <= serial) cycle
      newest = i
      serial = found
    end do
  end subroutine find_newest

  !> Serial number of a restart file; 0 where it cannot be read.
  integer(i8) function serial_of(name) result(serial)
    character(len=*), intent(in) :: name
    type(hdf5_file_t) :: file

    call file%open(name, is_read_only=.true.)
    call file%look('/', 'serial', serial)
    call file%close()
    if (allocated(file%error)) serial = 0
  end function serial_of

  !> The restart file of a name, or those of a folder, the newest first.
  subroutine find_restarts(name, names, error)
    character(len=*), intent(in) :: name !! path of a restart file or of a folder of results
    type(text_t), allocatable, intent(out) :: names(:) !! paths
    type(error_t), allocatable, intent(out) :: error !! set when the folder holds none
    logical :: is_folder

    inquire (file=name//'/.', exist=is_folder)
    if (.not. is_folder) then
      call append_word(names, name)
      return
    end if
    names = restarts_of(name)
    if (size(names) == 0) call fail(error, 'the folder holds no restart file', file=name)
  end subroutine find_restarts

  !> Restart files of a folder, the newest first. One whose number cannot be read may be the newest: it stands before the others.
  function restarts_of(folder) result(names)
    character(len=*), intent(in) :: folder !! folder of the results
    type(text_t), allocatable :: names(:)
    integer(i8) :: serial(size(restart_names))
    integer :: i, k

    allocate (names(0))
    do i = 1, size(restart_names)
      serial(i) = -1
      if (.not. file_exists(folder//'/'//restart_names(i))) cycle
      serial(i) = serial_of(folder//'/'//restart_names(i))
      if (serial(i) == 0) serial(i) = huge(serial)
    end do
    do i = 1, count(serial > 0)
      k = maxloc(serial, 1)
      call append_word(names, folder//'/'//trim(restart_names(k)))
      serial(k) = -1
    end do
  end function restarts_of
end module sg_restart_files
