!> tracks.csv: one row per tracked body and recorded step, named columns, SI units (doc/guide/tracks.md lists them).
module sg_track_file
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_step_csv, only: cell, quoted_cell, resume_rows
  use sg_text, only: to_text
  use sg_text_files, only: append_text, replace_file
  use sg_tracks, only: track_columns, tracks_t
  implicit none
  private
  public :: track_file_t, tracks_name

  !> Name of the file in the folder of the results
  character(len=*), parameter :: tracks_name = 'tracks.csv'

  !> The file of the tracked bodies of a run
  type :: track_file_t
    !> Path of the file
    character(len=:), allocatable :: file
    !> Does this rank write it? Of ranks that share a run one alone does
    logical :: is_root = .true.
    !> Has the run stages, with a column for their number?
    logical :: has_stages = .false.
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

    self%file = folder//'/'//tracks_name
    if (.not. self%is_root) return
    if (step >= 0) then
      call resume_rows(self%file, header(dimension, self%has_stages), step, error)
    else
      call replace_file(self%file, header(dimension, self%has_stages)//new_line('a'), error)
    end if
  end subroutine track_file_open

  !> The names of the columns.
  pure function header(dimension, has_stages) result(names)
    integer, intent(in) :: dimension
    logical, intent(in) :: has_stages
    character(len=:), allocatable :: names
    character(len=16), allocatable :: columns(:)
    integer :: i

    names = 'step,time,'//trim(merge('stage,body', 'body      ', has_stages))
    columns = track_columns(dimension)
    do i = 1, size(columns)
      names = names//','//trim(columns(i))
    end do
  end function header

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
    begin = to_text(step)//','//cell(time)//','
    if (self%has_stages) begin = begin//to_text(stage)//','
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
