!> Random grains: sizes, places without overlap, and convex polygons. The same seed gives the same grains.
module sg_generators
  use sg_kinds, only: wp, i4, i8, pi
  use sg_random, only: random_t
  implicit none
  private
  public :: draw_radius, place_on_lattice, insert_at_random, draw_polygon
  public :: size_uniform, size_volume, size_lognormal, size_constant

  !> How radii are spread: evenly by number, evenly by area, lognormal, all the same
  integer, parameter :: size_uniform = 1, size_volume = 2, size_lognormal = 3, size_constant = 4

  !> Places tried for one grain before the box counts as full
  integer, parameter :: most_tries = 20000

  !> Grains found by cells: `head` is the first grain of a cell, `next` the one after a grain (0 for none).
  !! Grains are added one by one, which a sorted list of cells could not take.
  type :: cells_t
    real(wp) :: corner(2) = 0, side(2) = 1
    integer :: n(2) = 1
    integer(i4), allocatable :: head(:, :), next(:)
  end type cells_t

contains

  !> One radius [m].
  function draw_radius(random, distribution, range, dimension) result(radius)
    type(random_t), intent(inout) :: random !! stream of numbers
    integer, intent(in) :: distribution !! one of `size_*`
    real(wp), intent(in) :: range(2) !! least and largest radius [m]
    integer, intent(in), optional :: dimension !! of space, 2 unless given
    real(wp) :: radius
    logical :: is_space

    radius = range(1)
    if (.not. range(2) > range(1)) return
    is_space = .false.
    if (present(dimension)) is_space = dimension == 3
    select case (distribution)
    case (size_uniform)
      radius = random%uniform(range(1), range(2))
    case (size_volume)
      ! Number density proportional to 1/r**2: every size class covers the same area; in space to 1/r**3: the same volume.
      if (is_space) then
        radius = product(range)/sqrt(range(2)**2 - random%uniform()*(range(2)**2 - range(1)**2))
      else
        radius = range(1)*range(2)/(range(2) - random%uniform()*(range(2) - range(1)))
      end if
    case (size_lognormal)
      do
        radius = sqrt(range(1)*range(2))*exp(random%normal()*log(range(2)/range(1))/4)
        if (radius >= range(1) .and. radius <= range(2)) exit
      end do
    end select
  end function draw_radius

  !> Places on a lattice, row by row from the bottom.
  subroutine place_on_lattice(box, pitch, is_triangular, is_periodic, most, points)
    real(wp), intent(in) :: box(4) !! x least, y least, x most, y most [m]
    real(wp), intent(in) :: pitch !! distance of neighbours [m]
    logical, intent(in) :: is_triangular !! triangular rather than square
    logical, intent(in) :: is_periodic !! do the rows close on themselves?
    integer, intent(in) :: most !! places wanted at most
    real(wp), allocatable, intent(out) :: points(:, :) !! places, fewer when the box is full, shape (2, n)
    integer :: n, n_row, n_rows, row, i
    real(wp) :: along, height, shift
    ! A box that is a whole number of pitches wide but for rounding holds that number.
    real(wp), parameter :: slack = 1e-9_wp

    n_row = int((box(3) - box(1))/pitch + slack)
    height = merge(sqrt(3.0_wp)/2, 1.0_wp, is_triangular)*pitch
    n_rows = 0
    if (box(4) - box(2) >= pitch*(1 - slack)) n_rows = int((box(4) - box(2) - pitch)/height + slack) + 1
    along = pitch
    if (is_periodic .and. n_row > 0) along = (box(3) - box(1))/real(n_row, wp)
    allocate (points(2, int(min(int(most, i8), int(n_row, i8)*int(n_rows, i8)))))
    n = 0
    do row = 0, n_rows - 1
      shift = merge(along/2, 0.0_wp, is_triangular .and. modulo(row, 2) == 1)
      do i = 0, n_row - 1
        if (n == size(points, 2)) return
        if (shift > 0 .and. .not. is_periodic .and. &
            shift + real(i + 1, wp)*along > (box(3) - box(1))*(1 + slack)) exit
        n = n + 1
        points(:, n) = [box(1) + shift + (real(i, wp) + 0.5_wp)*along, box(2) + pitch/2 + real(row, wp)*height]
      end do
    end do
    points = points(:, :n)
  end subroutine place_on_lattice

  !> Put circles at random places of a box, one after the other, none touching another.
  subroutine insert_at_random(random, radii, box, clearance, is_periodic, points, n)
    type(random_t), intent(inout) :: random !! stream of numbers
    real(wp), intent(in) :: radii(:) !! radii, largest first [m]
    real(wp), intent(in) :: box(4) !! x least, y least, x most, y most [m]
    real(wp), intent(in) :: clearance !! least distance between two circles [m]
    logical, intent(in) :: is_periodic !! do circles go through the sides of the box?
    real(wp), allocatable, intent(out) :: points(:, :) !! centres [m], shape (2, size(radii))
    integer, intent(out) :: n !! circles placed before the box was full
    type(cells_t) :: cells
    real(wp) :: low(2), high(2), point(2)
    integer :: i, try

    allocate (points(2, size(radii)), source=0.0_wp)
    call open_cells(cells, radii, box)
    do n = 0, size(radii) - 1
      i = n + 1
      low = box(1:2) + radii(i)
      high = box(3:4) - radii(i)
      if (is_periodic) low(1) = box(1)
      if (is_periodic) high(1) = box(3)
      if (any(high < low)) return
      do try = 1, most_tries
        point = [random%uniform(low(1), high(1)), random%uniform(low(2), high(2))]
        if (is_free(cells, radii, points, point, radii(i), clearance, box, is_periodic)) exit
      end do
      if (try > most_tries) return
      points(:, i) = point
      call add_to_cell(cells, i, point)
    end do
    n = size(radii)
  end subroutine insert_at_random

  !> Cells that hold one grain each or fewer, on average.
  subroutine open_cells(cells, radii, box)
    type(cells_t), intent(out) :: cells
    real(wp), intent(in) :: radii(:), box(4)
    real(wp) :: extent(2), side

    extent = box(3:4) - box(1:2)
    side = max(sqrt(2.0_wp)*minval(radii), sqrt(extent(1)*extent(2)/real(4*size(radii), wp)))
    cells%corner = box(1:2)
    cells%n = max(1, min(20000, int(extent/side)))
    cells%side = extent/real(cells%n, wp)
    allocate (cells%head(0:cells%n(1) - 1, 0:cells%n(2) - 1), cells%next(size(radii)), source=0_i4)
  end subroutine open_cells

  !> Cell of a point.
  pure function cell_of(cells, point) result(cell)
    type(cells_t), intent(in) :: cells
    real(wp), intent(in) :: point(2)
    integer :: cell(2)

    cell = max(0, min(cells%n - 1, int((point - cells%corner)/cells%side)))
  end function cell_of

  !> Add a grain.
  pure subroutine add_to_cell(cells, grain, point)
    type(cells_t), intent(inout) :: cells
    integer, intent(in) :: grain
    real(wp), intent(in) :: point(2)
    integer :: cell(2)

    cell = cell_of(cells, point)
    cells%next(grain) = cells%head(cell(1), cell(2))
    cells%head(cell(1), cell(2)) = int(grain, i4)
  end subroutine add_to_cell

  !> Is a place free of all grains so far? The first of `radii` is the largest.
  pure logical function is_free(cells, radii, points, point, radius, clearance, box, is_periodic)
    type(cells_t), intent(in) :: cells
    real(wp), intent(in) :: radii(:), points(:, :), point(2), radius, clearance, box(4)
    logical, intent(in) :: is_periodic
    integer :: reach(2), cell(2), i, j, column, grain
    real(wp) :: distance(2)

    is_free = .false.
    reach = int((radius + radii(1) + clearance)/cells%side) + 1
    if (is_periodic) reach(1) = min(reach(1), cells%n(1)/2)
    cell = cell_of(cells, point)
    do j = max(0, cell(2) - reach(2)), min(cells%n(2) - 1, cell(2) + reach(2))
      do i = cell(1) - reach(1), cell(1) + reach(1)
        column = i
        if (is_periodic) column = modulo(i, cells%n(1))
        if (column < 0 .or. column >= cells%n(1)) cycle
        grain = cells%head(column, j)
        do while (grain > 0)
          distance = points(:, grain) - point
          if (is_periodic) distance(1) = distance(1) - (box(3) - box(1))*anint(distance(1)/(box(3) - box(1)))
          if (sum(distance**2) < (radius + radii(grain) + clearance)**2) return
          grain = cells%next(grain)
        end do
      end do
    end do
    is_free = .true.
  end function is_free

  !> A random convex polygon with its vertices on a circle about the origin, counter-clockwise.
  subroutine draw_polygon(random, n, radius, vertices)
    type(random_t), intent(inout) :: random !! stream of numbers
    integer, intent(in) :: n !! number of vertices
    real(wp), intent(in) :: radius !! of the circle [m]
    real(wp), allocatable, intent(out) :: vertices(:, :) !! [m], shape (2, n)
    real(wp) :: start, angle
    integer :: k

    allocate (vertices(2, n))
    start = random%uniform(0.0_wp, 2*pi)
    do k = 1, n
      ! Neighbours keep at least half of their even distance.
      angle = start + (real(k, wp) + random%uniform(-0.25_wp, 0.25_wp))*2*pi/real(n, wp)
      vertices(:, k) = radius*[cos(angle), sin(angle)]
    end do
  end subroutine draw_polygon
end module sg_generators
