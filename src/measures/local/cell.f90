!> The cell that walls enclose, or the periodic cell: lengths, logarithmic strains, void ratio (doc/theory/indicators.md, "Cell").
module sg_cell
  use sg_comm, only: comm_t
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_tally, only: column_t
  use sg_tracks, only: own_body, place_of
  use sg_walls, only: walls_t
  implicit none
  private
  public :: cell_t, cell_columns

  !> The cell of a run, measured
  type :: cell_t
    !> The walls of the deck
    type(walls_t) :: walls
    !> Present lengths [m]; those of the start until the first measure
    real(wp) :: length(3) = 0
    !> Shear strain of a periodic cell: way of the upper face along x over the length along y
    real(wp) :: shear = 0
    !> Area of the grains [m2], in space their volume [m3]
    real(wp) :: grains = 0
  contains
    procedure :: begin => cell_begin
    procedure :: measure => cell_measure
  end type cell_t

contains

  !> Take the walls of a deck.
  pure subroutine cell_begin(self, walls)
    class(cell_t), intent(inout) :: self
    type(walls_t), intent(in) :: walls !! walls of the deck

    self%walls = walls
    self%length = walls%start
  end subroutine cell_begin

  !> Measure lengths and grains. Collective: all ranks get the same values.
  subroutine cell_measure(self, scene, comm)
    class(cell_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene after the update
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp) :: sums(4), way(3)
    integer :: axis, side, body

    if (.not. self%walls%has_cell) return
    sums = 0
    do axis = 1, scene%dimension
      do side = 1, 2
        if (self%walls%pair(side, axis) == 0) cycle
        associate (wall => self%walls%wall(self%walls%pair(side, axis)))
          body = own_body(scene%bodies, wall%number)
          if (body == 0) cycle
          way = place_of(scene, body) - wall%position
          sums(axis) = sums(axis) + merge(-1.0_wp, 1.0_wp, side == 1)*way(axis)
        end associate
      end do
    end do
    associate (n => scene%bodies%n_own)
      sums(4) = sum(scene%bodies%area(:n), mask=scene%bodies%is_grain(:n))
    end associate
    if (comm%size > 1) call comm%sum(sums)
    self%length = self%walls%start + sums(1:3)
    if (self%walls%is_periodic) then
      self%length = scene%cell%now(:3)
      self%shear = scene%cell%shear()
    end if
    self%grains = sums(4)
  end subroutine cell_measure

  !> Columns of the record: lengths [m], strains, void ratio; none where walls enclose no cell.
  pure function cell_columns(cell, dimension) result(columns)
    type(cell_t), intent(in) :: cell !! cell, measured or at the start
    integer, intent(in) :: dimension !! of space
    type(column_t), allocatable :: columns(:)
    type(column_t) :: column
    real(wp) :: strain(3)
    character(len=*), parameter :: axis = 'xyz'
    integer :: a

    allocate (columns(0))
    if (.not. cell%walls%has_cell) return
    strain = 0
    where (cell%length > 0) strain = log(cell%walls%start/cell%length)
    do a = 1, dimension
      column%name = 'cell_'//axis(a:a)
      column%value = cell%length(a)
      columns = [columns, column]
    end do
    do a = 1, dimension
      column%name = 'strain_'//axis(a:a)//axis(a:a)
      column%value = strain(a)
      columns = [columns, column]
    end do
    if (cell%walls%is_periodic) then
      column%name = 'strain_xy'
      column%value = cell%shear
      columns = [columns, column]
    end if
    column%name = 'void_ratio'
    column%value = 0
    if (cell%grains > 0) column%value = product(cell%length(:dimension))/cell%grains - 1
    columns = [columns, column]
  end function cell_columns
end module sg_cell
