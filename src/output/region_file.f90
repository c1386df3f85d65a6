!> regions.csv: one row per region and recorded step, named columns, SI units (doc/guide/regions.md lists them).
module sg_region_file
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_regions, only: n_region_counts, region_columns, regions_t
  use sg_step_csv, only: cell, quoted_cell, resume_rows
  use sg_text, only: to_text
  use sg_text_files, only: append_text, replace_file
  implicit none
  private
  public :: region_file_t, regions_name

  !> Name of the file in the folder of the results
  character(len=*), parameter :: regions_name = 'regions.csv'

  !> The file of the regions of a run
  type :: region_file_t
    !> Path of the file
    character(len=:), allocatable :: file
    !> Does this rank write it? Of ranks that share a run one alone does
    logical :: is_root = .true.
    !> Has the run stages, with a column for their number?
    logical :: has_stages = .false.
  contains
    procedure :: open => region_file_open
    procedure :: add => region_file_add
  end type region_file_t

contains

  !> Begin a new file, or go on with that of a run that restarts: rows of later steps, and a torn last row, are cut.
  subroutine region_file_open(self, folder, dimension, step, error)
    class(region_file_t), intent(inout) :: self
    character(len=*), intent(in) :: folder !! folder of the results
    integer, intent(in) :: dimension !! of space
    integer, intent(in) :: step !! step of the checkpoint; negative for a new run
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be read or written, or has other columns
    character(len=18), allocatable :: columns(:)
    character(len=:), allocatable :: header
    integer :: i

    self%file = folder//'/'//regions_name
    if (.not. self%is_root) return
    header = 'step,time,'//trim(merge('stage,region', 'region      ', self%has_stages))
    columns = region_columns(dimension)
    do i = 1, size(columns)
      header = header//','//trim(columns(i))
    end do
    if (step >= 0) then
      call resume_rows(self%file, header, step, error)
    else
      call replace_file(self%file, header//new_line('a'), error)
    end if
  end subroutine region_file_open

  !> Add the rows of a step that is measured, one per region.
  subroutine region_file_add(self, step, time, dimension, regions, stage, error)
    class(region_file_t), intent(in) :: self
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: time !! end of the step [s]
    integer, intent(in) :: dimension !! of space
    type(regions_t), intent(in) :: regions !! regions, measured
    integer, intent(in) :: stage !! number of the stage; unused where the run has none
    type(error_t), allocatable, intent(out) :: error !! set when the rows cannot be written
    character(len=:), allocatable :: rows, begin
    integer :: r, i

    if (.not. self%is_root) return
    rows = ''
    begin = to_text(step)//','//cell(time)//','
    if (self%has_stages) begin = begin//to_text(stage)//','
    do r = 1, size(regions%options)
      rows = rows//begin//quoted_cell(regions%options(r)%name)
      do i = 1, size(regions%value, 1)
        if (i <= n_region_counts(dimension)) then
          rows = rows//','//to_text(nint(regions%value(i, r)))
        else
          rows = rows//','//cell(regions%value(i, r))
        end if
      end do
      rows = rows//new_line('a')
    end do
    call append_text(self%file, rows, error)
  end subroutine region_file_add
end module sg_region_file
