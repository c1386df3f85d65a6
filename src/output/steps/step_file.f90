!> A CSV file of a run whose rows belong to recorded steps: what record.csv, tracks.csv, walls.csv and regions.csv have in common.
module sg_step_file
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_step_csv, only: cell, resume_rows
  use sg_text, only: to_text
  use sg_text_files, only: replace_file
  implicit none
  private
  public :: step_file_t

  !> Such a file
  type :: step_file_t
    !> Path of the file
    character(len=:), allocatable :: file
    !> Does this rank write it? Of ranks that share a run one alone does
    logical :: is_root = .true.
    !> Has the run stages, with a column for their number?
    logical :: has_stages = .false.
  contains
    procedure :: begin => step_file_begin
    procedure :: names => step_file_names
    procedure :: first_cells => step_file_first_cells
  end type step_file_t

contains

  !> Begin a new file, or go on with that of a run that restarts: rows of later steps, and a torn last row, are cut.
  subroutine step_file_begin(self, file, names, step, error)
    class(step_file_t), intent(inout) :: self
    character(len=*), intent(in) :: file !! path of the file
    character(len=*), intent(in) :: names !! its first line
    integer, intent(in) :: step !! step of the checkpoint; negative for a new run
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be read or written, or has other columns

    self%file = file
    if (.not. self%is_root) return
    if (step >= 0) then
      call resume_rows(file, names, step, error)
    else
      call replace_file(file, names//new_line('a'), error)
    end if
  end subroutine step_file_begin

  !> First line of a file with several rows per step: step, time, stage where there are stages, the item of a row, its columns.
  pure function step_file_names(self, item, columns) result(names)
    class(step_file_t), intent(in) :: self
    character(len=*), intent(in) :: item !! what a row is about
    character(len=*), intent(in) :: columns(:) !! names of the columns that follow
    character(len=:), allocatable :: names
    integer :: i

    names = 'step,time,'
    if (self%has_stages) names = names//'stage,'
    names = names//item
    do i = 1, size(columns)
      names = names//','//trim(columns(i))
    end do
  end function step_file_names

  !> First cells of each row of a step in such a file, up to the item.
  pure function step_file_first_cells(self, step, time, stage) result(cells)
    class(step_file_t), intent(in) :: self
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: time !! end of the step [s]
    integer, intent(in) :: stage !! number of the stage; unused where the run has none
    character(len=:), allocatable :: cells

    cells = to_text(step)//','//cell(time)//','
    if (self%has_stages) cells = cells//to_text(stage)//','
  end function step_file_first_cells
end module sg_step_file
