!> regions.csv: one row per region and recorded step, named columns, SI units (doc/guide/regions.md lists them).
module sg_region_file
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_regions, only: n_region_counts, region_columns, regions_t
  use sg_step_csv, only: cell, quoted_cell
  use sg_step_file, only: step_file_t
  use sg_text, only: to_text
  use sg_text_files, only: append_text
  implicit none
  private
  public :: region_file_t, regions_name

  !> Name of the file in the folder of the results
  character(len=*), parameter :: regions_name = 'regions.csv'

  !> The file of the regions of a run
  type, extends(step_file_t) :: region_file_t
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

    call self%begin(folder//'/'//regions_name, self%names('region', region_columns(dimension)), step, error)
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
    begin = self%first_cells(step, time, stage)
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
