!> Stages of the run that a restart file is of: read before the deck, since they decide which stage is due, and with it the scene.
module sg_restart_stages
  use sg_error, only: error_t
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: wp, i8
  use sg_restart_files, only: find_restarts
  use sg_stages, only: stages_t
  use sg_text, only: text_t
  implicit none
  private
  public :: read_stages

contains

  !> Read the stages of the newest checkpoint that can be read; one that cannot is reported when it is loaded.
  subroutine read_stages(name, stages)
    character(len=*), intent(in) :: name !! restart file, or a folder of results
    type(stages_t), intent(inout) :: stages !! gets steps done, time and numbers of the file
    type(text_t), allocatable :: names(:)
    type(error_t), allocatable :: error
    integer :: i

    call find_restarts(name, names, error)
    if (allocated(error)) return
    do i = 1, size(names)
      if (has_read(names(i)%s, stages)) return
    end do
  end subroutine read_stages

  !> Read the stages of a file; false where that fails.
  logical function has_read(name, stages)
    character(len=*), intent(in) :: name
    type(stages_t), intent(inout) :: stages
    type(hdf5_file_t) :: file
    real(wp), allocatable :: time(:), values(:)
    integer(i8) :: step

    call file%open(name, is_read_only=.true.)
    call file%look('/', 'step', step)
    if (.not. allocated(file%error)) then
      call file%get('/time', time)
      if (file%has('/stages')) call file%get('/stages', values)
    end if
    call file%close()
    has_read = .not. allocated(file%error)
    if (has_read) has_read = size(time) == 1 .and. step >= 0 .and. step < int(huge(0), i8)
    if (.not. has_read) return
    stages%step = int(step)
    stages%time = time(1)
    if (allocated(values)) call move_alloc(values, stages%loaded)
  end function has_read
end module sg_restart_stages
