!> walls.csv: one row per wall and recorded step, named columns, SI units (doc/guide/results.md lists them).
module sg_wall_file
  use sg_cell, only: cell_t
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_step_csv, only: cell, quoted_cell
  use sg_step_file, only: step_file_t
  use sg_text, only: to_text
  use sg_text_files, only: append_text
  use sg_tracks, only: track_columns, tracks_t
  implicit none
  private
  public :: wall_file_t, walls_name

  !> Name of the file in the folder of the results
  character(len=*), parameter :: walls_name = 'walls.csv'

  !> The file of the walls of a run
  type, extends(step_file_t) :: wall_file_t
  contains
    procedure :: open => wall_file_open
    procedure :: add => wall_file_add
  end type wall_file_t

contains

  !> Begin a new file, or go on with that of a run that restarts: rows of later steps, and a torn last row, are cut.
  subroutine wall_file_open(self, folder, dimension, step, error)
    class(wall_file_t), intent(inout) :: self
    character(len=*), intent(in) :: folder !! folder of the results
    integer, intent(in) :: dimension !! of space
    integer, intent(in) :: step !! step of the checkpoint; negative for a new run
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be read or written, or has other columns

    call self%begin(folder//'/'//walls_name, self%names('wall', [character(len=16) :: &
                    pack(track_columns(dimension), is_copied(dimension)), 'pressure', 'mean_pressure', 'area', 'contacts']), &
                    step, error)
  end subroutine wall_file_open

  !> Which columns of tracks are columns here: place, velocity, force, mean force.
  pure function is_copied(dimension) result(copied)
    integer, intent(in) :: dimension
    logical, allocatable :: copied(:)
    integer :: i

    if (dimension == 2) then
      copied = [(any(i == [1, 2, 4, 5, 7, 8, 10, 11]), i=1, 16)]
    else
      copied = [(any(i == [1, 2, 3, 8, 9, 10, 14, 15, 16, 20, 21, 22]), i=1, 29)]
    end if
  end function is_copied

  !> Add the rows of a step that is measured, one per wall.
  subroutine wall_file_add(self, step, time, dimension, tracks, bounds, stage, error)
    class(wall_file_t), intent(in) :: self
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: time !! end of the step [s]
    integer, intent(in) :: dimension !! of space
    type(tracks_t), intent(in) :: tracks !! tracked bodies, measured
    type(cell_t), intent(in) :: bounds !! walls and the cell that they enclose, measured
    integer, intent(in) :: stage !! number of the stage; unused where the run has none
    type(error_t), allocatable, intent(out) :: error !! set when the rows cannot be written
    character(len=:), allocatable :: rows, begin
    real(wp), allocatable :: values(:)
    integer :: t, i, n, wall

    if (.not. self%is_root) return
    rows = ''
    begin = self%first_cells(step, time, stage)
    do t = 1, size(tracks%number)
      wall = tracks%wall(t)
      if (wall == 0) cycle
      values = pack(tracks%value(:, t), is_copied(dimension))
      n = size(values)
      associate (area => bounds%walls%area_of(wall, dimension, bounds%length), d => dimension)
        values = [values, pressure(values(n - 2*d + 1:n - d), area), pressure(values(n - d + 1:n), area), area]
      end associate
      rows = rows//begin//quoted_cell(tracks%name(t)%s)
      do i = 1, size(values)
        rows = rows//','//cell(values(i))
      end do
      rows = rows//','//to_text(nint(tracks%value(size(tracks%value, 1), t)))//new_line('a')
    end do
    call append_text(self%file, rows, error)
  contains
    !> Force of grains along the normal over the area, positive where they push; of a wall with two sides its size [Pa].
    pure real(wp) function pressure(force, area)
      real(wp), intent(in) :: force(:), area

      pressure = -dot_product(force, bounds%walls%wall(wall)%normal(:size(force)))/area
      if (.not. bounds%walls%wall(wall)%has_side) pressure = abs(pressure)
    end function pressure
  end subroutine wall_file_add
end module sg_wall_file
