!> Lattices of the plane and of space, place after place: row by row from the bottom, layer by layer.
!!
!! A lattice is gone through as often as wanted and need never be held as a list.
module sg_lattice
  use sg_kinds, only: wp
  implicit none
  private
  public :: lattice_t, open_lattice, place_on_lattice
  public :: lattice_square, lattice_triangular, lattice_cubic, lattice_hexagonal, lattice_fcc

  !> Lattices: square and triangular in the plane; simple cubic, hexagonal close packed, face centred cubic
  integer, parameter :: lattice_square = 1, lattice_triangular = 2
  integer, parameter :: lattice_cubic = 1, lattice_hexagonal = 2, lattice_fcc = 3

  !> A box that is a whole number of pitches wide up to rounding holds that number
  real(wp), parameter :: slack = 1e-9_wp

  !> A lattice, and how far it has been gone through
  type :: lattice_t
    !> Dimension of space, and which lattice
    integer, private :: dimension = 2, arrangement = 1
    !> Least and largest coordinates of the box, and distance of neighbours [m]
    real(wp), private :: low(3) = 0, high(3) = 0, pitch = 1
    !> Do rows close on themselves, along x and along y?
    logical, private :: is_periodic(2) = .false.
    !> Rows at most: places along x, rows along y
    integer, private :: rows(2) = 0
    !> Distance of places, of rows and of layers; shift of rows and layers in turn [m]
    real(wp), private :: step(3) = 0, shift(2) = 0
    !> Places wanted at most
    integer, private :: most = 0
    !> Places so far, and indices of the next: along the row, row, layer
    integer, private :: n = 0, at(3) = 0
    !> In the plane: height of the present row [m]
    real(wp), private :: height = 0
    logical, private :: is_empty = .false.
  contains
    procedure :: next => lattice_next
    procedure :: restart => lattice_restart
    procedure :: count => lattice_count
  end type lattice_t

contains

  !> Open a lattice before its first place.
  subroutine open_lattice(lattice, box, pitch, arrangement, is_periodic, most)
    type(lattice_t), intent(out) :: lattice !! the lattice
    real(wp), intent(in) :: box(:) !! least, then largest coordinates [m]: four in the plane, six in space
    real(wp), intent(in) :: pitch !! distance of neighbours [m]
    integer, intent(in) :: arrangement !! one of `lattice_*`
    logical, intent(in) :: is_periodic(:) !! do rows close on themselves? In x; in space in x and in y
    integer, intent(in) :: most !! places wanted at most
    integer :: d

    d = size(box)/2
    lattice%dimension = d
    lattice%arrangement = arrangement
    lattice%low(:d) = box(:d)
    lattice%high(:d) = box(d + 1:)
    lattice%pitch = pitch
    lattice%is_periodic(:d - 1) = is_periodic
    lattice%most = most
    if (d == 2) call open_plane(lattice)
    if (d == 3) call open_space(lattice)
  end subroutine open_lattice

  !> Rows of a lattice of the plane.
  subroutine open_plane(lattice)
    type(lattice_t), intent(inout) :: lattice
    real(wp) :: room(2)

    associate (pitch => lattice%pitch, step => lattice%step)
      room = lattice%high(:2) - lattice%low(:2)
      lattice%rows(1) = int(min(1e9_wp, room(1)/pitch + slack))
      step(2) = merge(sqrt(3.0_wp)/2, 1.0_wp, lattice%arrangement == lattice_triangular)*pitch
      if (room(2) >= pitch*(1 - slack)) lattice%rows(2) = int(min(1e9_wp, (room(2) - pitch)/step(2) + slack)) + 1
      step(1) = pitch
      if (lattice%is_periodic(1) .and. lattice%rows(1) > 0) step(1) = room(1)/real(lattice%rows(1), wp)
      if (lattice%arrangement == lattice_triangular) lattice%shift(1) = step(1)/2
      lattice%is_empty = lattice%rows(1) == 0
    end associate
  end subroutine open_plane

  !> Rows and layers of a lattice of space.
  subroutine open_space(lattice)
    type(lattice_t), intent(inout) :: lattice
    real(wp) :: room(3)

    associate (pitch => lattice%pitch, step => lattice%step, rows => lattice%rows, is_periodic => lattice%is_periodic, &
               arrangement => lattice%arrangement)
      room = lattice%high - lattice%low
      step = pitch
      if (arrangement == lattice_hexagonal) step(2:3) = pitch*[sqrt(3.0_wp)/2, sqrt(2.0_wp/3)]
      if (arrangement == lattice_fcc) step(3) = pitch/sqrt(2.0_wp)
      rows = max(0, int(min(1e7_wp, room(:2)/step(:2) + slack)))
      ! Rows of a hexagonal layer are shifted in turn: a period holds an even number of them.
      if (arrangement == lattice_hexagonal .and. is_periodic(2)) rows(2) = 2*(rows(2)/2)
      where (is_periodic .and. rows > 0) step(:2) = room(:2)/real(max(1, rows), wp)
      if (arrangement == lattice_hexagonal) lattice%shift = [step(1)/2, step(2)/3]
      if (arrangement == lattice_fcc) lattice%shift = step(:2)/2
      lattice%is_empty = any(room < pitch*(1 - slack) .and. [.not. is_periodic, .true.]) .or. any(is_periodic .and. rows == 0)
    end associate
  end subroutine open_space

  !> The next place; false when there is none.
  logical function lattice_next(self, point) result(has_place)
    class(lattice_t), intent(inout) :: self
    real(wp), intent(out) :: point(:) !! place [m], shape (dimension)

    has_place = .false.
    if (self%is_empty .or. self%n == self%most) return
    if (self%dimension == 2) then
      call next_in_plane(self, point, has_place)
    else
      call next_in_space(self, point, has_place)
    end if
    if (has_place) self%n = self%n + 1
  end function lattice_next

  !> The next place in the plane.
  subroutine next_in_plane(lattice, point, has_place)
    class(lattice_t), intent(inout) :: lattice
    real(wp), intent(out) :: point(2)
    logical, intent(out) :: has_place
    real(wp) :: shift

    point = 0
    has_place = .false.
    associate (i => lattice%at(1), row => lattice%at(2), along => lattice%step(1), low => lattice%low, high => lattice%high)
      do while (row < lattice%rows(2))
        shift = merge(lattice%shift(1), 0.0_wp, modulo(row, 2) == 1)
        has_place = i < lattice%rows(1)
        if (shift > 0 .and. .not. lattice%is_periodic(1)) &
          has_place = has_place .and. .not. shift + real(i + 1, wp)*along > (high(1) - low(1))*(1 + slack)
        if (has_place) exit
        row = row + 1
        i = 0
      end do
      if (.not. has_place) return
      if (i == 0) lattice%height = low(2) + lattice%pitch/2 + real(row, wp)*lattice%step(2)
      point(1) = low(1) + shift + (real(i, wp) + 0.5_wp)*along
      point(2) = lattice%height
      i = i + 1
    end associate
  end subroutine next_in_plane

  !> The next place in space.
  subroutine next_in_space(lattice, point, has_place)
    class(lattice_t), intent(inout) :: lattice
    real(wp), intent(out) :: point(3)
    logical, intent(out) :: has_place
    real(wp) :: last(3)

    has_place = .false.
    associate (i => lattice%at(1), j => lattice%at(2), layer => lattice%at(3), half => lattice%pitch/2, step => lattice%step, &
               low => lattice%low, rows => lattice%rows, is_periodic => lattice%is_periodic)
      last = lattice%high - half + slack*lattice%pitch
      where (is_periodic) last(:2) = huge(1.0_wp)
      do
        point = low + half
        point(3) = low(3) + half + real(layer, wp)*step(3)
        if (point(3) > last(3)) return
        point(2) = low(2) + half + real(j, wp)*step(2) + merge(lattice%shift(2), 0.0_wp, mod(layer, 2) == 1)
        if (point(2) > last(2) .or. (is_periodic(2) .and. j == rows(2))) then
          layer = layer + 1
          j = 0
          i = 0
          cycle
        end if
        point(1) = low(1) + half + (real(i, wp) + shift_of_row(lattice%arrangement, layer, j))*step(1)
        if (.not. (point(1) > last(1) .or. (is_periodic(1) .and. i == rows(1)))) exit
        j = j + 1
        i = 0
      end do
      i = i + 1
      has_place = .true.
      where (is_periodic) point(:2) = low(:2) + modulo(point(:2) - low(:2), lattice%high(:2) - low(:2))
    end associate
  end subroutine next_in_space

  !> Shift of a row along x, as a share of the pitch.
  pure real(wp) function shift_of_row(arrangement, layer, j) result(share)
    integer, intent(in) :: arrangement, layer, j

    share = 0
    if (arrangement == lattice_fcc .and. mod(layer, 2) == 1) share = 0.5_wp
    if (arrangement == lattice_hexagonal .and. mod(j + layer, 2) == 1) share = 0.5_wp
  end function shift_of_row

  !> Go back before the first place.
  subroutine lattice_restart(self)
    class(lattice_t), intent(inout) :: self

    self%n = 0
    self%at = 0
  end subroutine lattice_restart

  !> Number of places; the lattice is before its first one afterwards.
  integer function lattice_count(self) result(n)
    class(lattice_t), intent(inout) :: self
    real(wp) :: point(self%dimension)

    call self%restart()
    do while (self%next(point))
    end do
    n = self%n
    call self%restart()
  end function lattice_count

  !> All places of a lattice as a list.
  subroutine place_on_lattice(box, pitch, arrangement, is_periodic, most, points)
    real(wp), intent(in) :: box(:) !! least, then largest coordinates [m]: four in the plane, six in space
    real(wp), intent(in) :: pitch !! distance of neighbours [m]
    integer, intent(in) :: arrangement !! one of `lattice_*`
    logical, intent(in) :: is_periodic(:) !! do rows close on themselves? In x; in space in x and in y
    integer, intent(in) :: most !! places wanted at most
    real(wp), allocatable, intent(out) :: points(:, :) !! places, fewer when the box is full [m], shape (dimension, n)
    type(lattice_t) :: lattice
    integer :: i

    call open_lattice(lattice, box, pitch, arrangement, is_periodic, most)
    allocate (points(size(box)/2, lattice%count()))
    do i = 1, size(points, 2)
      if (.not. lattice%next(points(:, i))) exit
    end do
  end subroutine place_on_lattice
end module sg_lattice
