!> Random insertion: places for circles or spheres in a box, none touching another. The same seed gives the same places.
module sg_insertion
  use sg_kinds, only: wp, i4
  use sg_ordering, only: order_of
  use sg_random, only: random_t
  implicit none
  private
  public :: insert_at_random

  !> Places tried for one grain before the box counts as full
  integer, parameter :: most_tries = 20000

  !> Grains of one level found by cells: `head` is the first grain of a cell. A level holds the grains whose radius is at most
  !! its own, and more than half of it. The plane is one layer of cells.
  type :: cells_t
    real(wp) :: corner(3) = 0, side(3) = 1, radius = 0
    integer :: n(3) = 1
    integer(i4), allocatable :: head(:, :, :)
  end type cells_t

  !> Grains that were placed, by levels
  type :: placed_t
    type(cells_t), allocatable :: levels(:)
    !> Level of the grain placed last
    integer :: level = 1
    !> Grain after another one in its cell, 0 for none; places [m], shape (3, n), and radii [m], largest first
    integer(i4), allocatable :: next(:)
    real(wp), allocatable :: place(:, :), radius(:)
  end type placed_t

contains

  !> Put circles or spheres at random places of a box, one after the other, none touching another or one that is there already.
  subroutine insert_at_random(random, radii, box, clearance, is_periodic, there, their_radii, points, n)
    type(random_t), intent(inout) :: random !! stream of numbers
    real(wp), intent(in) :: radii(:) !! radii, largest first [m]
    real(wp), intent(in) :: box(:) !! least, then largest coordinates [m]: four in the plane, six in space
    real(wp), intent(in) :: clearance !! least distance between two grains [m]
    logical, intent(in) :: is_periodic(:) !! do grains go through the sides of the box? Along x, y, z, as many as are given
    real(wp), intent(in) :: there(:, :) !! centres of grains that are there [m], in or about the box, shape (dimension, others)
    real(wp), intent(in) :: their_radii(:) !! their radii [m]
    real(wp), allocatable, intent(out) :: points(:, :) !! centres [m], shape (dimension, size(radii))
    integer, intent(out) :: n !! grains placed before the box was full
    type(placed_t) :: placed, others
    real(wp) :: low(size(box)/2), high(size(box)/2), point(3), period(3)
    integer :: d, i, k, try

    d = size(box)/2
    period = 0
    period(:size(is_periodic)) = merge(box(d + 1:d + size(is_periodic)) - box(:size(is_periodic)), 0.0_wp, is_periodic)
    call place_others(others, box, there, their_radii)
    call open_placed(placed, radii, box)
    point = 0
    do n = 0, size(radii) - 1
      i = n + 1
      low = box(:d) + merge(0.0_wp, radii(i), period(:d) > 0)
      high = box(d + 1:) - merge(0.0_wp, radii(i), period(:d) > 0)
      if (any(high < low)) exit
      do try = 1, most_tries
        do k = 1, d
          point(k) = random%uniform(low(k), high(k))
        end do
        if (.not. is_free(placed, point, radii(i), clearance, period)) cycle
        if (size(their_radii) == 0) exit
        if (is_free(others, point, radii(i), clearance, period)) exit
      end do
      if (try > most_tries) exit
      call add_grain(placed, i, point)
    end do
    allocate (points(d, size(radii)), source=placed%place(:d, :))
  end subroutine insert_at_random

  !> Take up grains that are there already.
  subroutine place_others(others, box, there, their_radii)
    type(placed_t), intent(out) :: others
    real(wp), intent(in) :: box(:), there(:, :), their_radii(:)
    integer(i4), allocatable :: order(:)
    real(wp) :: point(3)
    integer :: i

    point = 0
    order = order_of(-their_radii)
    if (size(order) == 0) return
    call open_placed(others, their_radii(order), box)
    do i = 1, size(order)
      point(:size(there, 1)) = there(:, order(i))
      call add_grain(others, i, point)
    end do
  end subroutine place_others

  !> Make room for grains of these radii, largest first, of which none is placed yet.
  subroutine open_placed(placed, radii, box)
    type(placed_t), intent(out) :: placed
    real(wp), intent(in) :: radii(:), box(:)

    allocate (placed%radius, source=radii)
    allocate (placed%place(3, size(radii)), source=0.0_wp)
    allocate (placed%next(size(radii)), source=0_i4)
    call open_levels(placed%levels, radii, box)
  end subroutine open_placed

  !> Levels of grains, each half as large as the one before, and their cells.
  subroutine open_levels(levels, radii, box)
    type(cells_t), allocatable, intent(out) :: levels(:)
    real(wp), intent(in) :: radii(:), box(:)
    integer, parameter :: most_levels = 8
    real(wp) :: extent(size(box)/2), side
    integer :: d, i, n

    d = size(box)/2
    n = 1
    do while (n < most_levels .and. minval(radii) <= maxval(radii)/2.0_wp**n)
      n = n + 1
    end do
    allocate (levels(n))
    extent = box(d + 1:) - box(:d)
    do i = 1, n
      associate (cells => levels(i))
        cells%radius = maxval(radii)/2.0_wp**(i - 1)
        ! No more than some cells a grain, however empty the box.
        side = max(1.2_wp*cells%radius, (product(extent)/real(4*size(radii), wp))**(1.0_wp/real(d, wp)))
        cells%corner(:d) = box(:d)
        cells%n(:d) = max(1, int(min(20000.0_wp, extent/side)))
        cells%side(:d) = extent/real(cells%n(:d), wp)
        allocate (cells%head(0:cells%n(1) - 1, 0:cells%n(2) - 1, 0:cells%n(3) - 1), source=0_i4)
      end associate
    end do
  end subroutine open_levels

  !> Cell of a point.
  pure function cell_of(cells, point) result(cell)
    type(cells_t), intent(in) :: cells
    real(wp), intent(in) :: point(3)
    integer :: cell(3)

    cell = max(0, min(cells%n - 1, int((point - cells%corner)/cells%side)))
  end function cell_of

  !> Add the next grain.
  pure subroutine add_grain(placed, grain, point)
    type(placed_t), intent(inout) :: placed
    integer, intent(in) :: grain
    real(wp), intent(in) :: point(3)

    placed%place(:, grain) = point
    do while (placed%level < size(placed%levels) .and. placed%radius(grain) <= placed%levels(placed%level)%radius/2)
      placed%level = placed%level + 1
    end do
    call add_to_cell(placed%levels(placed%level), placed%next, grain, point)
  end subroutine add_grain

  !> Add a grain to a level.
  pure subroutine add_to_cell(cells, next, grain, point)
    type(cells_t), intent(inout) :: cells
    integer(i4), intent(inout) :: next(:)
    integer, intent(in) :: grain
    real(wp), intent(in) :: point(3)
    integer :: cell(3)

    cell = cell_of(cells, point)
    next(grain) = cells%head(cell(1), cell(2), cell(3))
    cells%head(cell(1), cell(2), cell(3)) = int(grain, i4)
  end subroutine add_to_cell

  !> Is a place free of all grains so far?
  pure logical function is_free(placed, point, radius, clearance, period)
    type(placed_t), intent(in) :: placed
    real(wp), intent(in) :: point(3), radius, clearance, period(3)
    integer :: level

    is_free = .true.
    do level = 1, placed%level
      if (is_free) is_free = is_free_of(placed%levels(level), placed%next, placed%radius, placed%place, point, radius, clearance, &
                                        period)
    end do
  end function is_free

  !> Is a place free of all grains of a level?
  pure logical function is_free_of(cells, next, radii, points, point, radius, clearance, period) result(is_free)
    type(cells_t), intent(in) :: cells
    integer(i4), intent(in) :: next(:)
    real(wp), intent(in) :: radii(:), points(:, :), point(3), radius, clearance, period(3)
    integer :: reach(3), low(3), high(3), at(3), i, j, k, grain
    real(wp) :: distance(3)

    is_free = .false.
    reach = int((radius + cells%radius + clearance)/cells%side) + 1
    where (period > 0) reach = min(reach, cells%n/2)
    low = cell_of(cells, point) - reach
    high = low + 2*reach
    where (.not. period > 0) high = min(high, cells%n - 1)
    where (.not. period > 0) low = max(low, 0)
    do k = low(3), high(3)
      do j = low(2), high(2)
        do i = low(1), high(1)
          at = [i, j, k]
          where (period > 0) at = modulo(at, cells%n)
          grain = cells%head(at(1), at(2), at(3))
          do while (grain > 0)
            distance = points(:, grain) - point
            where (period > 0) distance = distance - period*anint(distance/period)
            if (sum(distance**2) < (radius + radii(grain) + clearance)**2) return
            grain = next(grain)
          end do
        end do
      end do
    end do
    is_free = .true.
  end function is_free_of
end module sg_insertion
