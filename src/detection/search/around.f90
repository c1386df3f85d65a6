!> What lies about a cell of a search for pairs, gathered once for those that share the cell (sg_pair_search).
module sg_around
  use sg_cells, only: cells_t
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  implicit none
  private
  public :: around_t, find_near, gather, n_places, place_of

  !> Places for what lies about cells, level by level: cells whose numbers differ by four along an axis share a place
  integer, parameter :: n_places = 64

  !> What lies in a cell of a level and in those next to it
  type :: around_t
    !> The cell
    integer(i4) :: home(3) = -huge(1_i4)
    !> Contactors, by their place in the order
    integer :: n = 0
    integer(i4), allocatable :: member(:)
    !> Periods by which each is moved, along x, y, z, shape (3, n)
    integer(i4), allocatable :: image(:, :)
    !> Their centres there, and radii [m]
    real(wp), allocatable :: x(:), y(:), z(:), radius(:)
    !> By how much the square of the distance of each exceeds that at which it is near [m2]
    real(wp), allocatable :: excess(:)
    !> Those of them that are near what is looked at, by their place among them
    integer, allocatable :: near(:)
  end type around_t

contains

  !> Place of what lies about a cell.
  pure integer function place_of(home)
    integer(i4), intent(in) :: home(3) !! the cell

    place_of = 1 + iand(home(1), 3_i4) + 4*iand(home(2), 3_i4) + 16*iand(home(3), 3_i4)
  end function place_of

  !> Gather what lies in a cell of a level and in the 3 by 3 (by 3) about it.
  subroutine gather(cells, dimension, level, home, centre, radius, period, around)
    type(cells_t), intent(in) :: cells !! cells, filled
    integer, intent(in) :: dimension !! of space
    integer, intent(in) :: level !! level of the cell
    integer(i4), intent(in) :: home(3) !! the cell
    real(wp), intent(in), contiguous :: centre(:, :) !! centres, by place in the order [m]
    real(wp), intent(in), contiguous :: radius(:) !! radii [m]
    real(wp), intent(in) :: period(3) !! in x, y and z, zero where not periodic [m]
    type(around_t), intent(inout) :: around !! its room is kept
    integer(i4) :: cell(3), wrapped(-1:1, 3), images(-1:1, 3), image(3), bucket, j
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
          image = [images(column, 1), images(row, 2), images(layer, 3)]
          bucket = cells%bucket(level, cell)
          call make_room(around, cells%first(bucket + 1) - cells%first(bucket))
          do m = cells%first(bucket), cells%first(bucket + 1) - 1
            j = cells%member(m)
            ! Other cells share the bucket.
            if (cells%cell(1, j) /= cell(1) .or. cells%cell(2, j) /= cell(2) .or. cells%cell(3, j) /= cell(3)) cycle
            if (cells%level(j) /= level) cycle
            call put(around, j, image, centre(:, j), radius(j), period)
          end do
        end do
      end do
    end do
  end subroutine gather

  !> Put one to those gathered.
  pure subroutine put(around, j, image, centre, radius, period)
    type(around_t), intent(inout) :: around
    integer(i4), intent(in) :: j, image(3)
    real(wp), intent(in) :: centre(3), radius, period(3)

    around%n = around%n + 1
    associate (n => around%n)
      around%member(n) = j
      around%image(1, n) = image(1)
      around%image(2, n) = image(2)
      around%image(3, n) = image(3)
      around%x(n) = centre(1) + period(1)*real(image(1), wp)
      around%y(n) = centre(2) + period(2)*real(image(2), wp)
      around%z(n) = centre(3) + period(3)*real(image(3), wp)
      around%radius(n) = radius
    end associate
  end subroutine put

  !> Make room for more of what is gathered.
  subroutine make_room(around, n)
    type(around_t), intent(inout) :: around
    integer, intent(in) :: n

    if (allocated(around%near)) then
      if (around%n + n <= size(around%near)) return
    end if
    call reserve(around%member, max(64, around%n + n))
    call reserve(around%image, 3, max(64, around%n + n))
    call reserve(around%x, max(64, around%n + n))
    call reserve(around%y, max(64, around%n + n))
    call reserve(around%z, max(64, around%n + n))
    call reserve(around%radius, max(64, around%n + n))
    call reserve(around%excess, max(64, around%n + n))
    call reserve(around%near, max(64, around%n + n))
  end subroutine make_room

  !> Which of those gathered come later in the order, and have a centre within the sum of two radii?
  pure subroutine find_near(around, after, own, own_radius, n_near)
    type(around_t), intent(inout) :: around !! what is gathered; those near are set
    integer, intent(in) :: after !! place in the order before those wanted
    real(wp), intent(in) :: own(3) !! centre to look from [m]
    real(wp), intent(in) :: own_radius !! its radius [m]
    integer, intent(out) :: n_near !! how many they are

    n_near = 0
    if (around%n == 0) return
    call measure(around%n, around%x, around%y, around%z, around%radius, own, own_radius, around%excess)
    call choose(around%n, around%member, after, around%excess, around%near, n_near)
  end subroutine find_near

  !> By how much squares of distances exceed those at which contactors are near.
  pure subroutine measure(n, x, y, z, radius, own, own_radius, excess)
    integer, intent(in) :: n
    real(wp), intent(in) :: x(n), y(n), z(n), radius(n), own(3), own_radius
    real(wp), intent(inout) :: excess(n)
    integer :: m

    do m = 1, n
      excess(m) = (own(1) - x(m))**2 + (own(2) - y(m))**2 + (own(3) - z(m))**2 - (own_radius + radius(m))**2
    end do
  end subroutine measure

  !> List those near. Which these are is anyone's guess, so no branch depends on it: each is noted, and the next takes its place
  !! unless it is near.
  pure subroutine choose(n, member, after, excess, near, n_near)
    integer, intent(in) :: n, after
    integer(i4), intent(in) :: member(n)
    real(wp), intent(in) :: excess(n)
    integer, intent(inout) :: near(n)
    integer, intent(out) :: n_near
    integer :: m

    n_near = 0
    do m = 1, n
      near(n_near + 1) = m
      n_near = n_near + merge(1, 0, member(m) > after)*merge(0, 1, excess(m) > 0)
    end do
  end subroutine choose
end module sg_around
