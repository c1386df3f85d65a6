!> subdomains.csv: one row per subdomain and recorded step, named columns, SI units (doc/guide/regions.md lists them).
module sg_subdomain_file
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_step_csv, only: cell
  use sg_step_file, only: step_file_t
  use sg_subdomain_means, only: n_subdomain_counts, subdomain_columns, subdomain_means_t
  use sg_text, only: to_text
  use sg_text_files, only: append_text
  implicit none
  private
  public :: subdomain_file_t, subdomains_name

  !> Name of the file in the folder of the results
  character(len=*), parameter :: subdomains_name = 'subdomains.csv'

  !> The file of the subdomains of a run
  type, extends(step_file_t) :: subdomain_file_t
  contains
    procedure :: open => subdomain_file_open
    procedure :: add => subdomain_file_add
  end type subdomain_file_t

contains

  !> Begin a new file, or go on with that of a run that restarts: rows of later steps, and a torn last row, are cut.
  subroutine subdomain_file_open(self, folder, dimension, step, error)
    class(subdomain_file_t), intent(inout) :: self
    character(len=*), intent(in) :: folder !! folder of the results
    integer, intent(in) :: dimension !! of space
    integer, intent(in) :: step !! step of the checkpoint; negative for a new run
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be read or written, or has other columns

    call self%begin(folder//'/'//subdomains_name, self%names('subdomain', subdomain_columns(dimension)), step, error)
  end subroutine subdomain_file_open

  !> Add the rows of a step that is measured, one per subdomain, numbered from 0 as ranks are in pictures.
  subroutine subdomain_file_add(self, step, time, means, stage, error)
    class(subdomain_file_t), intent(in) :: self
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: time !! end of the step [s]
    type(subdomain_means_t), intent(in) :: means !! means, measured
    integer, intent(in) :: stage !! number of the stage; unused where the run has none
    type(error_t), allocatable, intent(out) :: error !! set when the rows cannot be written
    character(len=:), allocatable :: rows
    integer :: r, i

    if (.not. self%is_root) return
    rows = ''
    do r = 1, size(means%value, 2)
      rows = rows//self%first_cells(step, time, stage)//to_text(r - 1)
      do i = 1, size(means%value, 1)
        if (i <= n_subdomain_counts) then
          rows = rows//','//to_text(nint(means%value(i, r)))
        else
          rows = rows//','//cell(means%value(i, r))
        end if
      end do
      rows = rows//new_line('a')
    end do
    call append_text(self%file, rows, error)
  end subroutine subdomain_file_add
end module sg_subdomain_file
