!> tracks.csv: one row per tracked body and recorded step, named columns, SI units (doc/guide/tracks.md lists them).
module sg_track_file
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_step_csv, only: cell, quoted_cell
  use sg_step_file, only: step_file_t
  use sg_text, only: to_text
  use sg_text_files, only: append_text
  use sg_tracks, only: track_columns, tracks_t
  implicit none
  private
  public :: track_file_t, tracks_name

  !> Name of the file in the folder of the results
  character(len=*), parameter :: tracks_name = 'tracks.csv'

  !> The file of the tracked bodies of a run
  type, extends(step_file_t) :: track_file_t
  contains
    procedure :: open => track_file_open
    procedure :: add => track_file_add
  end type track_file_t

contains

  !> Begin a new file, or go on with that of a run that restarts: rows of later steps, and a torn last row, are cut.
  subroutine track_file_open(self, folder, dimension, step, error)
    class(track_file_t), intent(inout) :: self
    character(len=*), intent(in) :: folder !! folder of the results
    integer, intent(in) :: dimension !! of space
    integer, intent(in) :: step !! step of the checkpoint; negative for a new run
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be read or written, or has other columns

    call self%begin(folder//'/'//tracks_name, self%names('body', track_columns(dimension)), step, error)
  end subroutine track_file_open

  !> Add the rows of a step that is measured, one per body.
  subroutine track_file_add(self, step, time, tracks, stage, error)
    class(track_file_t), intent(in) :: self
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: time !! end of the step [s]
    type(tracks_t), intent(in) :: tracks !! tracked bodies, measured
    integer, intent(in) :: stage !! number of the stage; unused where the run has none
    type(error_t), allocatable, intent(out) :: error !! set when the rows cannot be written
    character(len=:), allocatable :: rows, begin
    integer :: t, i, n

    if (.not. self%is_root) return
    rows = ''
    begin = self%first_cells(step, time, stage)
    n = size(tracks%value, 1)
    do t = 1, size(tracks%number)
      if (.not. tracks%is_asked(t)) cycle
      rows = rows//begin//quoted_cell(tracks%name(t)%s)
      do i = 1, n - 1
        rows = rows//','//cell(tracks%value(i, t))
      end do
      rows = rows//','//to_text(nint(tracks%value(n, t)))//new_line('a')
    end do
    call append_text(self%file, rows, error)
  end subroutine track_file_add
end module sg_track_file
