!> Grains in space: places on lattices, random directions and orientations. The same seed gives the same grains.
module sg_space_generators
  use sg_kinds, only: wp, pi
  use sg_random, only: random_t
  implicit none
  private
  public :: place_on_space_lattice, random_direction, random_rotation
  public :: lattice_cubic, lattice_hexagonal, lattice_fcc

  !> Lattices: simple cubic, hexagonal close packed, face centred cubic
  integer, parameter :: lattice_cubic = 1, lattice_hexagonal = 2, lattice_fcc = 3

  !> A box that is a whole number of pitches wide but for rounding holds that number
  real(wp), parameter :: slack = 1e-9_wp

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
