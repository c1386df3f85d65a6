!> Walls of a deck, and the cell that they enclose: where they begin, which way they face, their size.
!!
!! Walls are the segments and planes of the blocks wall and container, or those that a DATBOX drives. They enclose a cell where
!! along each axis that has no period two of them, and no more, face each other; its lengths follow from the places of their bodies.
module sg_walls
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: wall_t, walls_t

  !> Cosine from which on a normal is along an axis: rounding
  real(wp), parameter :: along = 1 - 1e-12_wp

  !> A wall at the start of the deck
  type :: wall_t
    !> Number of its body in the whole scene
    integer(i4) :: number = 0
    !> Centre of the body [m], and normal; that of a plane, or of a wall of the cell, points to the grains
    real(wp) :: position(3) = 0, normal(3) = 0
    !> From there to the centre of its shape [m]
    real(wp) :: shift(3) = 0
    !> Has it one side, so that forces have a sign along its normal?
    logical :: has_side = .false.
    !> Length in the plane [m], in space area [m2]; thickness [m]
    real(wp) :: area = 0, thickness = 0
    !> Axis of the cell that it bounds; 0 where it bounds none
    integer :: axis = 0
  end type wall_t

  !> All walls of a deck
  type :: walls_t
    !> The walls, ascending by number; unallocated where there are none
    type(wall_t), allocatable :: wall(:)
    !> Is the cell a periodic one, without walls?
    logical :: is_periodic = .false.
    !> Do they enclose a cell? Its two walls along each axis, lower and upper, 0 along periods; and its lengths at the start [m]
    logical :: has_cell = .false.
    integer :: pair(2, 3) = 0
    real(wp) :: start(3) = 0
  contains
    procedure :: count => walls_count
    procedure :: find_cell => walls_find_cell
    procedure :: area_of => walls_area_of
  end type walls_t

contains

  !> Number of walls.
  pure integer function walls_count(self)
    class(walls_t), intent(in) :: self

    walls_count = 0
    if (allocated(self%wall)) walls_count = size(self%wall)
  end function walls_count

  !> Find the cell that the walls enclose; its walls face each other.
  pure subroutine walls_find_cell(self, dimension, period)
    class(walls_t), intent(inout) :: self
    integer, intent(in) :: dimension !! of space
    real(wp), intent(in) :: period(3) !! lengths of the periods [m], zero where there is none
    integer :: pair(2, 3), axis, i
    real(wp) :: length(3)

    pair = 0
    length = period
    do axis = 1, dimension
      if (period(axis) > 0) cycle
      associate (found => pack([(i, i=1, self%count())], [(abs(self%wall(i)%normal(axis)) > along, i=1, self%count())]))
        if (size(found) /= 2) return
        pair(:, axis) = found
      end associate
      if (centre(self%wall(pair(1, axis)), axis) > centre(self%wall(pair(2, axis)), axis)) pair(:, axis) = pair([2, 1], axis)
      associate (lower => self%wall(pair(1, axis)), upper => self%wall(pair(2, axis)))
        if (lower%has_side .and. lower%normal(axis) < 0 .or. upper%has_side .and. upper%normal(axis) > 0) return
        length(axis) = centre(upper, axis) - centre(lower, axis) - (lower%thickness + upper%thickness)/2
      end associate
    end do
    if (any(length(:dimension) <= 0) .or. all(pair == 0)) return
    do axis = 1, dimension
      do i = 1, 2
        if (pair(i, axis) == 0) cycle
        associate (wall => self%wall(pair(i, axis)))
          wall%normal = 0
          wall%normal(axis) = merge(1.0_wp, -1.0_wp, i == 1)
          wall%has_side = .true.
          wall%axis = axis
        end associate
      end do
    end do
    self%has_cell = .true.
    self%pair = pair
    self%start = length
  end subroutine walls_find_cell

  !> Coordinate of the centre of a wall's shape [m].
  pure real(wp) function centre(wall, axis)
    type(wall_t), intent(in) :: wall
    integer, intent(in) :: axis

    centre = wall%position(axis) + wall%shift(axis)
  end function centre

  !> Length of a wall in the plane [m], in space its area [m2]: of a wall of the cell the present one of the cell.
  pure real(wp) function walls_area_of(self, wall, dimension, length) result(area)
    class(walls_t), intent(in) :: self
    integer, intent(in) :: wall !! index of the wall
    integer, intent(in) :: dimension !! of space
    real(wp), intent(in) :: length(3) !! present lengths of the cell [m]
    integer :: axis

    area = self%wall(wall)%area
    if (self%wall(wall)%axis > 0) area = product(length(:dimension), mask=[(axis /= self%wall(wall)%axis, axis=1, dimension)])
  end function walls_area_of
end module sg_walls
