!> Histories of errors as text: the columns of one point, for every file that holds some.
module sg_trace_csv
  use sg_report, only: trace_point_t
  use sg_step_csv, only: cell
  use sg_text, only: to_text
  implicit none
  private
  public :: point_cells, point_names

  !> Names of the columns of a point
  character(len=*), parameter :: point_names = 'iteration,contact_updates,cpu_seconds,e1,e2,e8'

contains

  !> A point as cells of a row.
  pure function point_cells(point) result(text)
    type(trace_point_t), intent(in) :: point !! effort and errors
    character(len=:), allocatable :: text

    text = to_text(point%iteration)//','//to_text(point%contact_updates)//','//cell(point%cpu_seconds)//','//cell(point%e1)// &
           ','//cell(point%e2)//','//cell(point%e8)
  end function point_cells
end module sg_trace_csv
