!> Geometrical boxes: slabs across x of equal weight, each cut across y into boxes of equal weight, these across z.
!!
!! Every rank brings its own grains and learns their boxes; no rank sees the others' grains. A grain's place along an axis
!! is a whole number of 63 bits: its coordinate in 2^-32 of the scene's extent, then its number, so that no two grains have
!! the same place and rows of equal coordinates are cut evenly. The places of all cuts of an axis are sought together, three
!! bits a round, from sums of weights over the ranks. Weights are whole numbers: their sums, and so the boxes, do not
!! depend on where the grains are (doc/theory/partition.md).
module sg_boxes
  use sg_ascending, only: first_at_least
  use sg_comm, only: comm_t
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4, i8
  use sg_sorting, only: sort_permutation
  use sg_text, only: to_text
  implicit none
  private
  public :: split_boxes, choose_boxes, extent_of

  !> Bits of a coordinate and of a grain's number in its place
  integer, parameter :: coordinate_bits = 32, number_bits = 31
  !> Bits found in one round; all bits together are a multiple of it
  integer, parameter :: round_bits = 3, steps = 2**round_bits - 1

  !> This rank's grains in the order of their group and place along an axis
  type :: line_t
    !> Grains in that order, and their places, shape (n)
    integer(i4), allocatable :: grain(:)
    integer(i8), allocatable :: place(:)
    !> Grains of group g are first(g) to first(g + 1) - 1
    integer, allocatable :: first(:)
    !> Weight of the grains before the i-th of its group, shape (n)
    real(wp), allocatable :: before(:)
    !> Weight of each group on this rank
    real(wp), allocatable :: weight(:)
  end type line_t

contains

  !> Box of each grain, from 1, z fastest and x slowest. Collective.
  subroutine split_boxes(comm, position, weight, number, counts, part)
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(in) :: position(:, :) !! centres of this rank's grains [m], shape (dimension, n)
    real(wp), intent(in) :: weight(:) !! cost of each, a positive whole number, shape (n)
    integer(i4), intent(in) :: number(:) !! number of each in the whole scene, shape (n)
    integer, intent(in) :: counts(:) !! boxes along each axis, shape (dimension) or longer
    integer(i4), allocatable, intent(out) :: part(:) !! box of each, shape (n)
    real(wp) :: low(size(position, 1)), high(size(position, 1))
    integer(i4), allocatable :: piece(:)
    integer :: axis, groups

    call extent_of(comm, position, low, high)
    allocate (part(size(weight)), source=1_i4)
    groups = 1
    do axis = 1, size(position, 1)
      if (counts(axis) == 1) cycle
      call cut(comm, places(position(axis, :), number, low(axis), high(axis)), weight, part, groups, counts(axis), piece)
      part = int(counts(axis), i4)*(part - 1_i4) + piece
      groups = groups*counts(axis)
    end do
  end subroutine split_boxes

  !> Boxes along each axis, for grains as they lie now. Collective.
  subroutine choose_boxes(comm, position, parts, wanted, counts, error)
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(in) :: position(:, :) !! centres of this rank's grains [m], shape (dimension, n)
    integer, intent(in) :: parts !! number of boxes
    integer, intent(in) :: wanted(3) !! boxes along x, y and z that are asked for; 0 where the program chooses
    integer, intent(out) :: counts(3) !! boxes along x, y and z
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when those asked for do not make so many
    real(wp) :: low(size(position, 1)), high(size(position, 1))
    character(len=:), allocatable :: boxes
    integer :: axis

    call extent_of(comm, position, low, high)
    counts = fitting_boxes(parts, high - low, wanted)
    if (all(counts > 0)) return
    boxes = to_text(wanted(1))
    do axis = 2, max(size(low), merge(3, 2, wanted(3) > 1))
      boxes = boxes//' x '//to_text(wanted(axis))
    end do
    call fail(error, 'boxes '//boxes//' (0 for any number) cannot make '//to_text(parts)//' parts of a scene in '// &
              trim(merge('the plane', 'space    ', size(low) == 2)))
  end subroutine choose_boxes

  !> Corners of the box about the centres of all grains; zero where there are none. Collective.
  subroutine extent_of(comm, position, low, high)
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(in) :: position(:, :) !! centres of this rank's grains [m], shape (dimension, n)
    real(wp), intent(out) :: low(:) !! least coordinates [m], shape (dimension)
    real(wp), intent(out) :: high(:) !! largest ones [m], shape (dimension)

    low = huge(1.0_wp)
    high = -huge(1.0_wp)
    if (size(position, 2) > 0) then
      low = minval(position, 2)
      high = maxval(position, 2)
    end if
    call comm%minimum(low)
    call comm%maximum(high)
    if (high(1) >= low(1)) return
    low = 0
    high = 0
  end subroutine extent_of

  !> Places along an axis: no two grains have the same.
  pure function places(coordinate, number, low, high) result(place)
    real(wp), intent(in) :: coordinate(:), low, high
    integer(i4), intent(in) :: number(:)
    integer(i8), allocatable :: place(:)
    real(wp) :: cells

    allocate (place(size(coordinate)), source=0_i8)
    cells = 2.0_wp**coordinate_bits
    if (high > low) place = min(int(cells, i8) - 1, int((coordinate - low)/(high - low)*cells, i8))
    place = shiftl(place, number_bits) + int(number, i8)
  end function places

  !> Cut the line of each group into pieces of equal weight: the piece of each grain, from 1.
  subroutine cut(comm, place, weight, group, groups, pieces, piece)
    type(comm_t), intent(inout) :: comm
    integer(i8), intent(in) :: place(:)
    real(wp), intent(in) :: weight(:)
    integer(i4), intent(in) :: group(:)
    integer, intent(in) :: groups, pieces
    integer(i4), allocatable, intent(out) :: piece(:)
    type(line_t) :: line
    integer(i8) :: bound(pieces - 1, groups)
    real(wp) :: total(groups)
    integer :: g, i, c

    call lay_out(place, weight, group, groups, line)
    total = line%weight
    call comm%sum(total)
    call find_cuts(comm, line, total, pieces, bound)
    call settle_cuts(comm, line, total, pieces, bound)
    allocate (piece(size(place)), source=1_i4)
    do g = 1, groups
      c = 1
      do i = line%first(g), line%first(g + 1) - 1
        do while (c < pieces)
          if (line%place(i) < bound(c, g)) exit
          c = c + 1
        end do
        piece(line%grain(i)) = int(c, i4)
      end do
    end do
  end subroutine cut

  !> Sort this rank's grains by group and place.
  pure subroutine lay_out(place, weight, group, groups, line)
    integer(i8), intent(in) :: place(:)
    real(wp), intent(in) :: weight(:)
    integer(i4), intent(in) :: group(:)
    integer, intent(in) :: groups
    type(line_t), intent(out) :: line
    integer :: i, g

    allocate (line%grain(size(place)), line%place(size(place)), line%before(size(place)))
    line%grain = sort_permutation(place)
    line%grain = line%grain(sort_permutation(int(group(line%grain), i8)))
    line%place = place(line%grain)
    allocate (line%first(groups + 1), source=0)
    allocate (line%weight(groups), source=0.0_wp)
    do i = 1, size(place)
      g = group(line%grain(i))
      line%before(i) = line%weight(g)
      line%weight(g) = line%weight(g) + weight(line%grain(i))
      line%first(g + 1) = line%first(g + 1) + 1
    end do
    line%first(1) = 1
    do g = 1, groups
      line%first(g + 1) = line%first(g) + line%first(g + 1)
    end do
  end subroutine lay_out

  !> For each cut the last place before which no more than its share lies: the place of the grain that the cut falls into.
  subroutine find_cuts(comm, line, total, pieces, bound)
    type(comm_t), intent(inout) :: comm
    type(line_t), intent(in) :: line
    real(wp), intent(in) :: total(:)
    integer, intent(in) :: pieces
    integer(i8), intent(out) :: bound(:, :)
    real(wp) :: below(steps*size(bound))
    integer :: shift, g, c, s, n

    bound = 0
    do shift = coordinate_bits + number_bits - round_bits, 0, -round_bits
      n = 0
      do g = 1, size(total)
        do c = 1, pieces - 1
          do s = 1, steps
            n = n + 1
            below(n) = weight_below(line, g, bound(c, g) + shiftl(int(s, i8), shift))
          end do
        end do
      end do
      call comm%sum(below)
      n = 0
      do g = 1, size(total)
        do c = 1, pieces - 1
          s = count(real(pieces, wp)*below(n + 1:n + steps) <= real(c, wp)*total(g))
          bound(c, g) = bound(c, g) + shiftl(int(s, i8), shift)
          n = n + steps
        end do
      end do
    end do
  end subroutine find_cuts

  !> Put the grain that a cut falls into on the side of its middle: `bound` becomes the first place after the cut.
  subroutine settle_cuts(comm, line, total, pieces, bound)
    type(comm_t), intent(inout) :: comm
    type(line_t), intent(in) :: line
    real(wp), intent(in) :: total(:)
    integer, intent(in) :: pieces
    integer(i8), intent(inout) :: bound(:, :)
    real(wp) :: sums(2*size(bound))
    integer :: g, c, n

    n = 0
    do g = 1, size(total)
      do c = 1, pieces - 1
        ! What lies before the grain, and what lies before what follows it.
        sums(n + 1) = weight_below(line, g, bound(c, g))
        sums(n + 2) = sums(n + 1)
        if (bound(c, g) < huge(bound)) sums(n + 2) = weight_below(line, g, bound(c, g) + 1)
        n = n + 2
      end do
    end do
    call comm%sum(sums)
    n = 0
    do g = 1, size(total)
      do c = 1, pieces - 1
        if (real(pieces, wp)*(sums(n + 1) + sums(n + 2)) < 2*real(c, wp)*total(g)) bound(c, g) = bound(c, g) + 1
        n = n + 2
      end do
    end do
  end subroutine settle_cuts

  !> Weight of this rank's grains of a group before a place.
  pure real(wp) function weight_below(line, group, place) result(weight)
    type(line_t), intent(in) :: line
    integer, intent(in) :: group
    integer(i8), intent(in) :: place
    integer :: low

    low = line%first(group)
    low = low - 1 + first_at_least(line%place(low:line%first(group + 1) - 1), place)
    weight = line%weight(group)
    if (low < line%first(group + 1)) weight = line%before(low)
  end function weight_below

  !> Boxes along each axis, `parts` together, whose cuts through the scene are smallest; zeros where none fit.
  pure function fitting_boxes(parts, extent, wanted) result(counts)
    integer, intent(in) :: parts !! number of boxes
    real(wp), intent(in) :: extent(:) !! width, height and, in space, depth of the scene [m]
    integer, intent(in) :: wanted(3) !! boxes along x, y and z; 0 where they are to be chosen
    integer :: counts(3)
    integer :: nx, ny, nz
    real(wp) :: sides(3), area, smallest

    sides = 1
    sides(:size(extent)) = extent
    smallest = huge(1.0_wp)
    counts = 0
    do nx = 1, parts
      if (modulo(parts, nx) /= 0 .or. .not. fits(nx, 1)) cycle
      do ny = 1, parts/nx
        nz = parts/nx/ny
        if (nx*ny*nz /= parts .or. .not. (fits(ny, 2) .and. fits(nz, 3))) cycle
        if (size(extent) == 2 .and. nz > 1) cycle
        area = real(nx - 1, wp)*sides(2)*sides(3) + real(ny - 1, wp)*sides(1)*sides(3) + real(nz - 1, wp)*sides(1)*sides(2)
        if (area >= smallest) cycle
        smallest = area
        counts = [nx, ny, nz]
      end do
    end do
  contains
    pure logical function fits(count, axis)
      integer, intent(in) :: count, axis

      fits = wanted(axis) == 0 .or. wanted(axis) == count
    end function fits
  end function fitting_boxes
end module sg_boxes
