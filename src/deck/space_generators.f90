!> Grains in space: places without overlap, on lattices or at random. The same seed gives the same grains.
module sg_space_generators
  use sg_kinds, only: wp, i4, pi
  use sg_random, only: random_t
  implicit none
  private
  public :: place_on_space_lattice, insert_in_space, random_direction, random_rotation
  public :: lattice_cubic, lattice_hexagonal, lattice_fcc

  !> Lattices: simple cubic, hexagonal close packed, face centred cubic
  integer, parameter :: lattice_cubic = 1, lattice_hexagonal = 2, lattice_fcc = 3

  !> Places tried for one grain before the box counts as full
  integer, parameter :: most_tries = 20000
  !> A box that is a whole number of pitches wide but for rounding holds that number
  real(wp), parameter :: slack = 1e-9_wp

  !> Grains of one level found by cells: `head` is the first grain of a cell. A level holds the grains whose radius is at most
  !! its own, and more than half of it.
  type :: cells_t
    real(wp) :: corner(3) = 0, side(3) = 1, radius = 0
    integer :: n(3) = 1
    integer(i4), allocatable :: head(:, :, :)
  end type cells_t

contains

  !> Places on a lattice, layer by layer from the bottom, row by row.
  subroutine place_on_space_lattice(box, pitch, lattice, is_periodic, most, points)
    real(wp), intent(in) :: box(6) !! least and largest x, y and z: [x, y, z, x, y, z] [m]
    real(wp), intent(in) :: pitch !! distance of neighbours [m]
    integer, intent(in) :: lattice !! one of `lattice_*`
    logical, intent(in) :: is_periodic(2) !! do rows close on themselves in x and in y?
    integer, intent(in) :: most !! places wanted at most
    real(wp), allocatable, intent(out) :: points(:, :) !! places, fewer when the box is full, shape (3, n)
    real(wp) :: room(3), step(3), shift(2)
    integer :: rows(2), n

    room = box(4:6) - box(1:3)
    step = pitch
    shift = 0
    if (lattice == lattice_hexagonal) step(2:3) = pitch*[sqrt(3.0_wp)/2, sqrt(2.0_wp/3)]
    if (lattice == lattice_fcc) step(3) = pitch/sqrt(2.0_wp)
    rows = max(0, int(min(1e7_wp, room(:2)/step(:2) + slack)))
    ! Rows of a hexagonal layer are shifted in turn: a period holds an even number of them.
    if (lattice == lattice_hexagonal .and. is_periodic(2)) rows(2) = 2*(rows(2)/2)
    where (is_periodic .and. rows > 0) step(:2) = room(:2)/real(max(1, rows), wp)
    if (lattice == lattice_hexagonal) shift = [step(1)/2, step(2)/3]
    if (lattice == lattice_fcc) shift = step(:2)/2
    allocate (points(3, 0))
    call fill_layers(.true., n)
    deallocate (points)
    allocate (points(3, n))
    call fill_layers(.false., n)
  contains
    !> Go through all places; count them, or note them too.
    subroutine fill_layers(only_count, n)
      logical, intent(in) :: only_count
      integer, intent(out) :: n
      real(wp) :: point(3), last(3)
      integer :: layer, i, j

      n = 0
      last = box(4:6) - pitch/2 + slack*pitch
      where (is_periodic) last(:2) = huge(1.0_wp)
      if (any(room < pitch*(1 - slack) .and. [.not. is_periodic, .true.]) .or. any(is_periodic .and. rows == 0)) return
      do layer = 0, huge(1) - 1
        point(3) = box(3) + pitch/2 + real(layer, wp)*step(3)
        if (point(3) > last(3)) return
        do j = 0, huge(1) - 1
          point(2) = box(2) + pitch/2 + real(j, wp)*step(2) + merge(shift(2), 0.0_wp, mod(layer, 2) == 1)
          if (point(2) > last(2) .or. (is_periodic(2) .and. j == rows(2))) exit
          do i = 0, huge(1) - 1
            point(1) = box(1) + pitch/2 + (real(i, wp) + shift_of_row(layer, j))*step(1)
            if (point(1) > last(1) .or. (is_periodic(1) .and. i == rows(1))) exit
            if (n == most) return
            n = n + 1
            if (only_count) cycle
            points(:, n) = point
            where (is_periodic) points(:2, n) = box(1:2) + modulo(point(:2) - box(1:2), room(:2))
          end do
        end do
      end do
    end subroutine fill_layers

    !> Shift of a row along x, as a share of the pitch.
    pure real(wp) function shift_of_row(layer, j) result(share)
      integer, intent(in) :: layer, j

      share = 0
      if (lattice == lattice_fcc .and. mod(layer, 2) == 1) share = 0.5_wp
      if (lattice == lattice_hexagonal .and. mod(j + layer, 2) == 1) share = 0.5_wp
    end function shift_of_row
  end subroutine place_on_space_lattice

  !> Put spheres at random places of a box, one after the other, none touching another.
  subroutine insert_in_space(random, radii, box, clearance, is_periodic, points, n)
    type(random_t), intent(inout) :: random !! stream of numbers
    real(wp), intent(in) :: radii(:) !! radii, largest first [m]
    real(wp), intent(in) :: box(6) !! least and largest x, y and z [m]
    real(wp), intent(in) :: clearance !! least distance between two spheres [m]
    logical, intent(in) :: is_periodic(2) !! do spheres go through the sides of the box, in x and in y?
    real(wp), allocatable, intent(out) :: points(:, :) !! centres [m], shape (3, size(radii))
    integer, intent(out) :: n !! spheres placed before the box was full
    type(cells_t), allocatable :: levels(:)
    integer(i4), allocatable :: next(:)
    real(wp) :: low(3), high(3), point(3)
    integer :: i, k, try, level

    allocate (points(3, size(radii)), source=0.0_wp)
    ! The grain after another one in its cell; 0 for none.
    allocate (next(size(radii)), source=0_i4)
    call open_levels(levels, radii, box)
    level = 1
    do n = 0, size(radii) - 1
      i = n + 1
      low = box(1:3) + radii(i)
      high = box(4:6) - radii(i)
      where (is_periodic) low(:2) = box(1:2)
      where (is_periodic) high(:2) = box(4:5)
      if (any(high < low)) return
      do try = 1, most_tries
        do k = 1, 3
          point(k) = random%uniform(low(k), high(k))
        end do
        if (is_free(levels, next, radii, points, point, radii(i), clearance, box, is_periodic)) exit
      end do
      if (try > most_tries) return
      points(:, i) = point
      do while (level < size(levels) .and. radii(i) <= levels(level)%radius/2)
        level = level + 1
      end do
      call add_to_cell(levels(level), next, i, point)
    end do
    n = size(radii)
  end subroutine insert_in_space

  !> Levels of grains, each half as large as the one before, and their cells.
  subroutine open_levels(levels, radii, box)
    type(cells_t), allocatable, intent(out) :: levels(:)
    real(wp), intent(in) :: radii(:), box(6)
    integer, parameter :: most_levels = 8
    real(wp) :: extent(3), side
    integer :: i, n

    n = 1
    do while (n < most_levels .and. minval(radii) <= maxval(radii)/2.0_wp**n)
      n = n + 1
    end do
    allocate (levels(n))
    extent = box(4:6) - box(1:3)
    do i = 1, n
      levels(i)%radius = maxval(radii)/2.0_wp**(i - 1)
      ! No more than some cells a grain, however empty the box.
      side = max(1.2_wp*levels(i)%radius, (product(extent)/real(4*size(radii), wp))**(1.0_wp/3))
      levels(i)%corner = box(1:3)
      levels(i)%n = max(1, int(min(2000.0_wp, extent/side)))
      levels(i)%side = extent/real(levels(i)%n, wp)
      associate (m => levels(i)%n)
        allocate (levels(i)%head(0:m(1) - 1, 0:m(2) - 1, 0:m(3) - 1), source=0_i4)
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

  !> Add a grain.
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
  pure logical function is_free(levels, next, radii, points, point, radius, clearance, box, is_periodic)
    type(cells_t), intent(in) :: levels(:)
    integer(i4), intent(in) :: next(:)
    real(wp), intent(in) :: radii(:), points(:, :), point(3), radius, clearance, box(6)
    logical, intent(in) :: is_periodic(2)
    integer :: level

    is_free = .true.
    do level = 1, size(levels)
      if (is_free) is_free = is_free_of(levels(level), next, radii, points, point, radius, clearance, box, is_periodic)
    end do
  end function is_free

  !> Is a place free of all grains of a level?
  pure logical function is_free_of(cells, next, radii, points, point, radius, clearance, box, is_periodic) result(is_free)
    type(cells_t), intent(in) :: cells
    integer(i4), intent(in) :: next(:)
    real(wp), intent(in) :: radii(:), points(:, :), point(3), radius, clearance, box(6)
    logical, intent(in) :: is_periodic(2)
    integer :: reach(3), cell(3), at(3), i, j, k, grain
    real(wp) :: distance(3), period(2)

    is_free = .false.
    period = box(4:5) - box(1:2)
    reach = int((radius + cells%radius + clearance)/cells%side) + 1
    where (is_periodic) reach(:2) = min(reach(:2), cells%n(:2)/2)
    cell = cell_of(cells, point)
    do k = max(0, cell(3) - reach(3)), min(cells%n(3) - 1, cell(3) + reach(3))
      do j = cell(2) - reach(2), cell(2) + reach(2)
        do i = cell(1) - reach(1), cell(1) + reach(1)
          at = [i, j, k]
          where (is_periodic) at(:2) = modulo(at(:2), cells%n(:2))
          if (any(at(:2) < 0 .or. at(:2) >= cells%n(:2))) cycle
          grain = cells%head(at(1), at(2), k)
          do while (grain > 0)
            distance = points(:, grain) - point
            where (is_periodic) distance(:2) = distance(:2) - period*anint(distance(:2)/period)
            if (sum(distance**2) < (radius + radii(grain) + clearance)**2) return
            grain = next(grain)
          end do
        end do
      end do
    end do
    is_free = .true.
  end function is_free_of

  !> A random unit vector.
  function random_direction(random) result(direction)
    type(random_t), intent(inout) :: random !! stream of numbers
    real(wp) :: direction(3)
    real(wp) :: height, angle

    height = random%uniform(-1.0_wp, 1.0_wp)
    angle = random%uniform(0.0_wp, 2*pi)
    direction = [sqrt(max(0.0_wp, 1 - height**2))*[cos(angle), sin(angle)], height]
  end function random_direction

  !> A random orientation, all equally likely (K. Shoemake, "Uniform random rotations", Graphics Gems III, 1992).
  function random_rotation(random) result(q)
    type(random_t), intent(inout) :: random !! stream of numbers
    real(wp) :: q(4)
    real(wp) :: share, first, second

    share = random%uniform()
    first = random%uniform(0.0_wp, 2*pi)
    second = random%uniform(0.0_wp, 2*pi)
    q = [sqrt(share)*[cos(second), sin(second)], sqrt(1 - share)*[sin(first), cos(first)]]
  end function random_rotation
end module sg_space_generators
