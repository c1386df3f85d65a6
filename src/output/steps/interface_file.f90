!> interfaces.csv: one row per pair of bodies and recorded step, named columns, SI units (doc/guide/interfaces.md lists them).
module sg_interface_file
  use sg_error, only: error_t
  use sg_body_interfaces, only: interface_columns, interfaces_t
  use sg_kinds, only: wp
  use sg_step_csv, only: cell, quoted_cell
  use sg_step_file, only: step_file_t
  use sg_text, only: to_text
  use sg_text_files, only: append_text
  implicit none
  private
  public :: interface_file_t, interfaces_name

  !> Name of the file in the folder of the results
  character(len=*), parameter :: interfaces_name = 'interfaces.csv'

  !> The file of the interfaces of a run
  type, extends(step_file_t) :: interface_file_t
  contains
    procedure :: open => interface_file_open
    procedure :: add => interface_file_add
  end type interface_file_t

contains

  !> Begin a new file, or go on with that of a run that restarts: rows of later steps, and a torn last row, are cut.
  subroutine interface_file_open(self, folder, dimension, step, error)
    class(interface_file_t), intent(inout) :: self
    character(len=*), intent(in) :: folder !! folder of the results
    integer, intent(in) :: dimension !! of space
    integer, intent(in) :: step !! step of the checkpoint; negative for a new run
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be read or written, or has other columns

    call self%begin(folder//'/'//interfaces_name, self%names('first,second', interface_columns(dimension)), step, error)
  end subroutine interface_file_open

  !> Add the rows of a step that is measured, one per pair.
  subroutine interface_file_add(self, step, time, interfaces, stage, error)
    class(interface_file_t), intent(in) :: self
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: time !! end of the step [s]
    type(interfaces_t), intent(in) :: interfaces !! interfaces, measured
    integer, intent(in) :: stage !! number of the stage; unused where the run has none
    type(error_t), allocatable, intent(out) :: error !! set when the rows cannot be written
    character(len=:), allocatable :: rows, row, begin
    integer :: r, i, n, length

    if (.not. self%is_root) return
    begin = self%first_cells(step, time, stage)
    n = size(interfaces%value, 1)
    length = 0
    allocate (character(len=0) :: rows)
    do r = 1, size(interfaces%value, 2)
      associate (name => interfaces%options)
        row = begin//quoted_cell(name%name_of(interfaces%body(1, r)))//','//quoted_cell(name%name_of(interfaces%body(2, r)))
      end associate
      do i = 1, n - 1
        row = row//','//cell(interfaces%value(i, r))
      end do
      row = row//','//to_text(nint(interfaces%value(n, r)))//new_line('a')
      call add_row()
    end do
    call append_text(self%file, rows(:length), error)
  contains
    !> Add a row to the text, whose room doubles.
    subroutine add_row()
      character(len=:), allocatable :: grown

      if (length + len(row) > len(rows)) then
        allocate (character(len=2*(length + len(row))) :: grown)
        grown(:length) = rows(:length)
        call move_alloc(grown, rows)
      end if
      rows(length + 1:length + len(row)) = row
      length = length + len(row)
    end subroutine add_row
  end subroutine interface_file_add
end module sg_interface_file
