!> Growth of circles or spheres to a dense sample: they start small at random places and push each other apart while they grow.
!!
!! A geometric method in the manner of [Jodrey1985]: no time, no mass. Overlaps of pairs are undone one after the other, each by
!! moving both centres, until none is left; then all radii grow, up to a little more than those wanted. The same seed gives the
!! same places.
module sg_growth
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  use sg_ordering, only: order_of
  use sg_random, only: random_t
  implicit none
  private
  public :: grow_in_box

  !> Steps of growth, the first scale of the radii, and the last one, above one so that rounding leaves no overlap
  integer, parameter :: growths = 60
  real(wp), parameter :: first_scale = 0.4_wp, last_scale = 1.0005_wp
  !> Sweeps over all pairs at each scale, and at the last one; there, after how many the worst overlap has to be smaller by a fifth,
  !! and how often grains that are stuck are put elsewhere where it is not
  integer, parameter :: sweeps = 30, last_sweeps = 20000, patience = 500, most_moves = 8

  !> Circles or spheres that grow, and those that are there, largest first
  type :: growing_t
    !> Centres [m], shape (3, n), at present and when pairs were listed; radii [m]; does it move and grow?
    real(wp), allocatable :: place(:, :), listed(:, :), radius(:)
    logical, allocatable :: is_own(:)
    !> Corners of the box and periods [m]; clearance [m]; scale of the radii
    real(wp) :: low(3) = 0, high(3) = 0, period(3) = 0, clearance = 0, scale = 1
    !> Pairs that may overlap while none moves by more than half of `skin` [m], shape (2, n_pairs)
    integer(i4), allocatable :: pair(:, :)
    integer :: n_pairs = 0
    real(wp) :: skin = 0
  end type growing_t

contains

  !> Grow circles or spheres in a box, none touching another or one that is there already; `n` is 0 where they do not fit.
  subroutine grow_in_box(random, radii, box, clearance, is_periodic, there, their_radii, points, n)
    type(random_t), intent(inout) :: random !! stream of numbers
    real(wp), intent(in) :: radii(:) !! radii to reach [m]
    real(wp), intent(in) :: box(:) !! least, then largest coordinates [m]: four in the plane, six in space
    real(wp), intent(in) :: clearance !! least distance between two grains [m]
    logical, intent(in) :: is_periodic(:) !! do grains go through the sides of the box? Along x, y, z, as many as are given
    real(wp), intent(in) :: there(:, :) !! centres of grains that are there [m], in or about the box, shape (dimension, others)
    real(wp), intent(in) :: their_radii(:) !! their radii [m]
    real(wp), allocatable, intent(out) :: points(:, :) !! centres [m], shape (dimension, size(radii))
    integer, intent(out) :: n !! grains placed: all or none
    type(growing_t) :: growing
    integer(i4), allocatable :: order(:)
    real(wp) :: overlap, before
    integer :: d, i, k, sweep, moves

    d = size(box)/2
    n = 0
    allocate (points(d, size(radii)), source=0.0_wp)
    growing%low(:d) = box(:d)
    growing%high(:d) = box(d + 1:)
    growing%period(:size(is_periodic)) = merge(box(d + 1:d + size(is_periodic)) - box(:size(is_periodic)), 0.0_wp, is_periodic)
    growing%clearance = clearance
    growing%skin = 0.4_wp*minval(radii)
    if (any(box(d + 1:) - box(:d) < 2*maxval(radii) .and. .not. growing%period(:d) > 0)) return
    order = order_of(-[radii, their_radii])
    growing%radius = [radii, their_radii]
    growing%radius = growing%radius(order)
    growing%is_own = order <= size(radii)
    allocate (growing%place(3, size(order)), source=0.0_wp)
    do i = 1, size(order)
      do k = 1, d
        if (growing%is_own(i)) then
          growing%place(k, i) = random%uniform(box(k), box(d + k))
        else
          growing%place(k, i) = there(k, order(i) - size(radii))
        end if
      end do
    end do
    before = huge(before)
    moves = 0
    do i = 1, growths
      growing%scale = first_scale + (last_scale - first_scale)*real(i, wp)/real(growths, wp)
      call list_pairs(growing, d)
      do sweep = 1, merge(last_sweeps, sweeps, i == growths)
        call push_apart(growing, d)
        if (maxval(norm2(growing%place - growing%listed, 1)) > growing%skin/2) call list_pairs(growing, d)
        if (i < growths) cycle
        overlap = worst_overlap(growing)
        if (.not. overlap > 0) exit
        if (mod(sweep, patience) /= 0) cycle
        if (overlap > 0.8_wp*before) then
          moves = moves + 1
          if (moves > most_moves) exit
          call put_elsewhere(growing, overlap/2, d, random)
          call list_pairs(growing, d)
          overlap = huge(overlap)
        end if
        before = overlap
      end do
    end do
    if (overlap > 0) return
    n = size(radii)
    do i = 1, size(order)
      if (growing%is_own(i)) points(:, order(i)) = growing%place(:d, i)
    end do
  end subroutine grow_in_box

  !> Present radius of a grain [m].
  pure real(wp) function radius_now(growing, i)
    type(growing_t), intent(in) :: growing
    integer, intent(in) :: i

    radius_now = growing%radius(i)*merge(growing%scale, 1.0_wp, growing%is_own(i))
  end function radius_now

  !> From one grain to another, or to the nearest image of that [m].
  pure function apart(growing, i, j)
    type(growing_t), intent(in) :: growing
    integer, intent(in) :: i, j
    real(wp) :: apart(3)

    apart = growing%place(:, j) - growing%place(:, i)
    where (growing%period > 0) apart = apart - growing%period*anint(apart/merge(growing%period, 1.0_wp, growing%period > 0))
  end function apart

  !> Undo the overlap of each pair in turn, then bring all grains back into the box.
  pure subroutine push_apart(growing, d)
    type(growing_t), intent(inout) :: growing
    integer, intent(in) :: d
    real(wp) :: between(3), wanted, distance
    integer :: i, j, p

    do p = 1, growing%n_pairs
      i = growing%pair(1, p)
      j = growing%pair(2, p)
      wanted = radius_now(growing, i) + radius_now(growing, j) + growing%clearance
      between = apart(growing, i, j)
      distance = norm2(between)
      if (distance >= wanted) cycle
      if (.not. distance > 0) between = [1.0_wp, 0.0_wp, 0.0_wp]
      between = between*(wanted - distance)/max(distance, tiny(1.0_wp), merge(0.0_wp, 1.0_wp, distance > 0))
      if (growing%is_own(i) .and. growing%is_own(j)) between = between/2
      if (growing%is_own(i)) growing%place(:, i) = growing%place(:, i) - between
      if (growing%is_own(j)) growing%place(:, j) = growing%place(:, j) + between
    end do
    do i = 1, size(growing%radius)
      if (.not. growing%is_own(i)) cycle
      associate (place => growing%place(:d, i), reach => radius_now(growing, i), low => growing%low(:d), high => growing%high(:d))
        where (.not. growing%period(:d) > 0) place = max(low + reach, min(high - reach, place))
      end associate
    end do
  end subroutine push_apart

  !> Largest overlap of two grains of the radii wanted [m], zero where there is none.
  pure real(wp) function worst_overlap(growing) result(worst)
    type(growing_t), intent(in) :: growing
    integer :: i, j, p

    worst = 0
    do p = 1, growing%n_pairs
      i = growing%pair(1, p)
      j = growing%pair(2, p)
      if (.not. (growing%is_own(i) .or. growing%is_own(j))) cycle
      worst = max(worst, growing%radius(i) + growing%radius(j) + growing%clearance - norm2(apart(growing, i, j)))
    end do
  end function worst_overlap

  !> Put grains that overlap by more than a length at random places: the smaller one of each pair, if it moves.
  subroutine put_elsewhere(growing, length, d, random)
    type(growing_t), intent(inout) :: growing
    real(wp), intent(in) :: length
    integer, intent(in) :: d
    type(random_t), intent(inout) :: random
    integer :: i, j, k, p

    do p = 1, growing%n_pairs
      i = growing%pair(1, p)
      j = growing%pair(2, p)
      if (growing%radius(i) + growing%radius(j) + growing%clearance - norm2(apart(growing, i, j)) <= length) cycle
      if (.not. growing%is_own(j)) j = i
      if (.not. growing%is_own(j)) cycle
      do k = 1, d
        growing%place(k, j) = random%uniform(growing%low(k), growing%high(k))
      end do
    end do
  end subroutine put_elsewhere

  !> List the pairs that may overlap soon: each grain looks for smaller ones in cells as wide as the mean grain.
  subroutine list_pairs(growing, d)
    type(growing_t), intent(inout) :: growing
    integer, intent(in) :: d
    integer(i4), allocatable :: head(:, :, :), next(:)
    real(wp) :: side(3), reach
    integer :: cells(3), low(3), high(3), at(3), i, j, k, x, y, z

    ! Grains that left a periodic box come back on the other side.
    do k = 1, d
      if (.not. growing%period(k) > 0) cycle
      growing%place(k, :) = growing%low(k) + modulo(growing%place(k, :) - growing%low(k), growing%period(k))
    end do
    growing%listed = growing%place
    associate (extent => growing%high(:d) - growing%low(:d), n => real(size(growing%radius), wp))
      ! No more than some cells per grain, however empty the box.
      side = max(sum(2*growing%radius)/n, (product(extent)/(4*n))**(1/real(d, wp)))
      cells = 1
      cells(:d) = max(1, int(extent/side(:d)))
      side(:d) = extent/real(cells(:d), wp)
    end associate
    allocate (head(0:cells(1) - 1, 0:cells(2) - 1, 0:cells(3) - 1), source=0_i4)
    allocate (next(size(growing%radius)), source=0_i4)
    growing%n_pairs = 0
    ! The smallest come first: a grain finds those that are there.
    do i = size(growing%radius), 1, -1
      reach = 2*growing%radius(i)*max(1.0_wp, growing%scale) + growing%clearance + growing%skin
      low = floor((growing%place(:, i) - reach - growing%low)/side)
      high = floor((growing%place(:, i) + reach - growing%low)/side)
      where (growing%period > 0)
        high = min(high, low + cells - 1)
      elsewhere
        low = max(0, min(cells - 1, low))
        high = max(0, min(cells - 1, high))
      end where
      do z = low(3), high(3)
        do y = low(2), high(2)
          do x = low(1), high(1)
            at = [x, y, z]
            where (growing%period > 0) at = modulo(at, cells)
            j = head(at(1), at(2), at(3))
            do while (j > 0)
              call note(i, j, growing%radius(i) + growing%radius(j))
              j = next(j)
            end do
          end do
        end do
      end do
      at = max(0, min(cells - 1, floor((growing%place(:, i) - growing%low)/side)))
      next(i) = head(at(1), at(2), at(3))
      head(at(1), at(2), at(3)) = int(i, i4)
    end do
  contains
    !> Note a pair that is near.
    subroutine note(one, other, sum_of_radii)
      integer, intent(in) :: one, other
      real(wp), intent(in) :: sum_of_radii

      if (norm2(apart(growing, one, other)) >= sum_of_radii*max(1.0_wp, growing%scale) + growing%clearance + growing%skin) return
      growing%n_pairs = growing%n_pairs + 1
      call reserve(growing%pair, 2, growing%n_pairs)
      growing%pair(:, growing%n_pairs) = int([one, other], i4)
    end subroutine note
  end subroutine list_pairs
end module sg_growth
