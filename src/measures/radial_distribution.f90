!> Radial distribution of a packing, g(r): grains at a distance r of a grain, over those of as many points thrown at random
!! (doc/theory/indicators.md, "Structure").
!!
!! Grains are counted from those whose surroundings lie in the box whole, so that nothing outside is needed. On
!! several ranks each counts about its own grains; those of the others pass by, one rank's at a time.
module sg_radial_distribution
  use sg_cells, only: build_cells, cells_t, level_cell
  use sg_centres, only: centres_t, upright
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, i4, pi
  implicit none
  private
  public :: radial_distribution, radial_distribution_t

  !> Distances, and how far they reach in diameters of the grains
  integer, parameter :: bins = 200
  real(wp), parameter :: diameters = 5
  !> How much of a box they may take: of a period, so that no grain is met twice; of a width that ends
  real(wp), parameter :: of_period = 1/3.0_wp, of_width = 1/4.0_wp

  !> g at the middle of each bin
  type :: radial_distribution_t
    integer :: n = 0
    !> Distances [m], and g there
    real(wp), allocatable :: r(:), g(:)
    !> Grains about which others were counted
    real(wp) :: references = 0
  end type radial_distribution_t

contains

  !> The radial distribution of the grains of all ranks. Collective; empty where no grain has its surroundings in the box.
  subroutine radial_distribution(centres, comm, distribution)
    type(centres_t), intent(in) :: centres !! grains of this rank
    type(comm_t), intent(inout) :: comm !! the ranks
    type(radial_distribution_t), intent(out) :: distribution !! the same on all ranks
    logical :: is_reference(size(centres%point, 2))
    real(wp) :: reach, sums(0:bins), edge(0:bins), density
    integer :: d, i

    d = centres%dimension
    reach = min(diameters*centres%diameter, &
                minval((centres%high(:d) - centres%low(:d))*merge(of_period, of_width, centres%is_periodic(:d)))/ &
                stretch_of(centres))
    if (.not. reach > 0) return
    is_reference = [(is_inside(centres, centres%point(:, i), reach), i=1, size(is_reference))]
    sums = 0
    sums(0) = real(count(is_reference), wp)
    call count_all(centres, is_reference, reach, comm, sums(1:))
    call comm%sum(sums)
    if (.not. sums(0) > 0) return
    density = sums(0)/product(centres%high(:d) - centres%low(:d) - merge(0.0_wp, 2*reach, centres%is_periodic(:d)))
    edge = [(reach*real(i, wp)/bins, i=0, bins)]
    distribution%n = bins
    distribution%references = sums(0)
    distribution%r = (edge(1:) + edge(:bins - 1))/2
    ! Areas of rings, volumes of shells.
    if (d == 2) edge = pi*edge**2
    if (d == 3) edge = 4*pi/3*edge**3
    distribution%g = sums(1:)/(sums(0)*density*(edge(1:) - edge(:bins - 1)))
  end subroutine radial_distribution

  !> Does all that lies within reach of a point lie in the box?
  pure logical function is_inside(centres, point, reach)
    type(centres_t), intent(in) :: centres
    real(wp), intent(in) :: point(3), reach

    is_inside = all(centres%is_periodic .or. (point >= centres%low + reach .and. point <= centres%high - reach) .or. &
                    [.false., .false., centres%dimension == 2])
  end function is_inside

  !> How much longer distances of points become at most where a tilted cell is sheared upright.
  pure real(wp) function stretch_of(centres) result(stretch)
    type(centres_t), intent(in) :: centres
    real(wp) :: slope

    slope = 0
    if (abs(centres%tilt) > 0) slope = abs(centres%tilt)/(centres%high(2) - centres%low(2))
    stretch = slope/2 + sqrt(1 + slope**2/4)
  end function stretch_of

  !> Count pairs of this rank's references with the grains of every rank.
  subroutine count_all(centres, is_reference, reach, comm, counts)
    type(centres_t), intent(in) :: centres
    logical, intent(in) :: is_reference(:)
    real(wp), intent(in) :: reach
    type(comm_t), intent(inout) :: comm
    real(wp), intent(inout) :: counts(bins)
    real(wp), allocatable :: received(:)
    integer, allocatable :: received_count(:)
    integer :: send_count(0:comm%size - 1), step

    call count_pairs(centres, is_reference, centres%point, reach, .true., counts)
    do step = 1, comm%size - 1
      send_count = 0
      send_count(modulo(comm%rank + step, comm%size)) = size(centres%point)
      call comm%swap(reshape(centres%point, [size(centres%point)]), send_count, received, received_count)
      call count_pairs(centres, is_reference, reshape(received, [3, size(received)/3]), reach, .false., counts)
    end do
  end subroutine count_all

  !> Count pairs of references with others by their distance.
  subroutine count_pairs(centres, is_reference, others, reach, are_own, counts)
    type(centres_t), intent(in) :: centres
    logical, intent(in) :: is_reference(:)
    real(wp), intent(in), contiguous :: others(:, :) !! [m], shape (3, any)
    real(wp), intent(in) :: reach
    logical, intent(in) :: are_own !! are the others these grains themselves?
    real(wp), intent(inout) :: counts(bins)
    type(cells_t) :: cells
    real(wp) :: radius(size(others, 2)), period(3), places(3, size(is_reference))
    integer :: i

    if (size(others) == 0) return
    period = merge(centres%high - centres%low, 0.0_wp, centres%is_periodic)
    radius = reach/2*stretch_of(centres)
    call build_cells(cells, upright(centres, others), radius, 0.0_wp, period)
    places = upright(centres, centres%point)
    do i = 1, size(is_reference)
      if (.not. is_reference(i)) cycle
      call count_about(cells, places(:, i), centres%point(:, i), others, period, centres%tilt, reach, merge(i, 0, are_own), counts)
    end do
  end subroutine count_pairs

  !> Count the others about a point, in its cell and those next to it.
  pure subroutine count_about(cells, place, point, others, period, tilt, reach, self, counts)
    type(cells_t), intent(in) :: cells
    real(wp), intent(in) :: place(3), point(3) !! the point in the cells, and where it is
    real(wp), intent(in), contiguous :: others(:, :)
    real(wp), intent(in) :: period(3), tilt, reach
    integer, intent(in) :: self
    real(wp), intent(inout) :: counts(bins)
    integer(i4) :: home(3), cell(3), bucket
    real(wp) :: between(3)
    integer :: step, m, j, bin

    home = level_cell(cells, 1, place)
    do step = 0, 26
      cell = home + int([modulo(step, 3), modulo(step/3, 3), step/9], i4) - 1_i4
      where (cells%columns(:, 1) > 0) cell = modulo(cell, cells%columns(:, 1))
      bucket = cells%bucket(1, cell)
      do m = cells%first(bucket), cells%first(bucket + 1) - 1
        j = cells%member(m)
        if (any(cells%cell(:, j) /= cell) .or. j == self) cycle
        between = others(:, j) - point
        if (abs(tilt) > 0) between(1) = between(1) - tilt*anint(between(2)/period(2))
        where (period > 0) between = between - period*anint(between/merge(period, 1.0_wp, period > 0))
        bin = int(min(bins*norm2(between)/reach, real(bins, wp))) + 1
        if (bin <= bins) counts(bin) = counts(bin) + 1
      end do
    end do
  end subroutine count_about
end module sg_radial_distribution
