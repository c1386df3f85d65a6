!> What lies about a cell of a search for pairs, gathered once for all that share the cell (sg_pair_search).
module sg_around
  use sg_cells, only: cells_t
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  implicit none
  private
  public :: around_t, find_near, gather

  !> What lies in a cell of a level and in those next to it
  type :: around_t
    !> The cell
    integer(i4) :: home(3) = -huge(1_i4)
    !> Contactors, by their place in the order
    integer :: n = 0
    integer(i4), allocatable :: member(:)
    !> Periods by which each is moved, along x, y, z, shape (3, n)
    integer(i4), allocatable :: image(:, :)
    !> Those of them that are near what is looked at, by their place among them
    integer, allocatable :: near(:)
  end type around_t

contains

  !> Gather what lies in a cell of a level and in the 3 by 3 (by 3) about it.
  subroutine gather(cells, dimension, level, home, around)
    type(cells_t), intent(in) :: cells !! cells, filled
    integer, intent(in) :: dimension !! of space
    integer, intent(in) :: level !! level of the cell
    integer(i4), intent(in) :: home(3) !! the cell
    type(around_t), intent(inout) :: around !! its room is kept
    integer(i4) :: cell(3), wrapped(-1:1, 3), images(-1:1, 3), bucket, j
    integer :: column, row, layer, axis, step, m

    images = 0
    do axis = 1, 3
      do step = -1, 1
        wrapped(step, axis) = home(axis) + int(step, i4)
        if (cells%columns(axis, level) == 0) cycle
        wrapped(step, axis) = modulo(wrapped(step, axis), cells%columns(axis, level))
        images(step, axis) = (home(axis) + int(step, i4) - wrapped(step, axis))/cells%columns(axis, level)
      end do
    end do
    around%home = home
    around%n = 0
    do layer = 2 - dimension, dimension - 2
      do row = -1, 1
        do column = -1, 1
          cell = [wrapped(column, 1), wrapped(row, 2), wrapped(layer, 3)]
          bucket = cells%bucket(level, cell)
          call make_room(around, cells%first(bucket + 1) - cells%first(bucket))
          do m = cells%first(bucket), cells%first(bucket + 1) - 1
            j = cells%member(m)
            ! Other cells share the bucket.
            if (cells%cell(1, j) /= cell(1) .or. cells%cell(2, j) /= cell(2) .or. cells%cell(3, j) /= cell(3)) cycle
            if (cells%level(j) /= level) cycle
            around%n = around%n + 1
            around%member(around%n) = j
            around%image(1, around%n) = images(column, 1)
            around%image(2, around%n) = images(row, 2)
            around%image(3, around%n) = images(layer, 3)
          end do
        end do
      end do
    end do
  end subroutine gather

  !> Make room for more of what is gathered.
  subroutine make_room(around, n)
    type(around_t), intent(inout) :: around
    integer, intent(in) :: n

    if (allocated(around%near)) then
      if (around%n + n <= size(around%near)) return
    end if
    call reserve(around%member, around%n + n)
    call reserve(around%image, 3, around%n + n)
    call reserve(around%near, around%n + n)
  end subroutine make_room

  !> Which of those gathered come later in the order, and have a centre within the sum of two radii?
  pure subroutine find_near(n, member, image, after, own, centre, own_radius, radius, period, near, n_near)
    integer, intent(in) :: n !! number of those gathered
    integer(i4), intent(in), contiguous :: member(:) !! their places in the order
    integer(i4), intent(in), contiguous :: image(:, :) !! periods by which each is moved, along x, y, z
    integer, intent(in) :: after !! place in the order before those wanted
    real(wp), intent(in) :: own(3) !! centre to look from [m]
    real(wp), intent(in) :: own_radius !! its radius [m]
    real(wp), intent(in) :: period(3) !! in x, y and z, zero where not periodic [m]
    real(wp), intent(in), contiguous :: centre(:, :) !! centres, by place in the order [m]
    real(wp), intent(in), contiguous :: radius(:) !! radii [m]
    integer, intent(inout), contiguous :: near(:) !! those that are near, by their number among those gathered
    integer, intent(out) :: n_near !! how many they are
    real(wp) :: square
    integer :: m, j

    ! Which are near is anyone's guess, so no branch depends on it: each is noted, and the next takes its place unless it is near.
    n_near = 0
    do m = 1, n
      j = member(m)
      square = (own(1) - centre(1, j) - period(1)*real(image(1, m), wp))**2 + &
               (own(2) - centre(2, j) - period(2)*real(image(2, m), wp))**2 + &
               (own(3) - centre(3, j) - period(3)*real(image(3, m), wp))**2
      near(n_near + 1) = m
      n_near = n_near + merge(1, 0, j > after)*merge(0, 1, square > (own_radius + radius(j))**2)
    end do
  end subroutine find_near
end module sg_around
