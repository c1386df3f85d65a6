!> Structure factor of a packing, S(k) = |sum over grains of exp(-i k.x)|^2 / N (doc/theory/indicators.md, "Structure").
!!
!! Points are spread on a grid and transformed (FFTW). A grid resolves waves down to a few cells; for shorter ones the box is
!! folded onto a part of itself [Jenkins1998], which keeps every wave that fits into the part. So
!! a grid of one size serves all waves of any number of grains.
module sg_structure_factor
  use sg_centres, only: centres_t, upright
  use sg_comm, only: comm_t
  use sg_fourier, only: squared_transform_grid
  use sg_kinds, only: wp, pi
  implicit none
  private
  public :: structure_factor, structure_factor_t

  !> Cells of the grid along an axis, in the plane and in space
  integer, parameter :: cells_of(2:3) = [1024, 128]
  !> Largest k times the diameter of the grains, and bins up to there at most
  real(wp), parameter :: most = 8*pi
  integer, parameter :: most_bins = 128
  !> Waves of a grid that count have at least eight cells
  integer, parameter :: cells_of_wave = 8
  !> A box is folded 2 to this power times at most, as many cells as integers count: waves shorter than a 1e8th of it, in space
  !! than a 2e7th, are left out
  integer, parameter :: most_foldings = 20

  !> Mean over shells of waves
  type :: structure_factor_t
    !> Bins that hold waves
    integer :: n = 0
    !> Mean length of their wave vectors [1/m], and mean of S
    real(wp), allocatable :: k(:), s(:)
    !> Waves in the mean: S of each is spread by as much as S itself, the mean by one over the root of their number
    real(wp), allocatable :: waves(:)
  end type structure_factor_t

contains

  !> The structure factor of the grains of all ranks. Collective; empty without grains or extent, or a Fourier transform.
  subroutine structure_factor(centres, comm, factor)
    type(centres_t), intent(in) :: centres !! grains of this rank
    type(comm_t), intent(inout) :: comm !! the ranks
    type(structure_factor_t), intent(out) :: factor !! the same on all ranks
    real(wp), allocatable :: grid(:, :, :), squares(:, :, :)
    real(wp) :: length(3), edge(3), reach(2), squared_weights, sums(3, most_bins), width
    integer :: fold(3), level, d, n

    d = centres%dimension
    length = centres%high - centres%low
    ! Lengths of the edges of the box, of which the second one may be tilted.
    edge = length
    edge(2) = hypot(length(2), centres%tilt)
    n = cells_of(d)
    sums = 0
    if (any(.not. length(:d) > 0)) return
    allocate (grid(n, n, merge(1, n, d == 2)))
    width = max(2*pi/maxval(length(:d)), most/centres%diameter/most_bins)
    reach = 0
    level = 0
    do while (reach(1) < most/centres%diameter .and. level <= most_foldings)
      fold = 1
      fold(:d) = max(1, nint(length(:d)/maxval(length(:d))*2.0_wp**level))
      reach(2) = min(most/centres%diameter, minval(2*pi*real(n*fold(:d), wp)/(cells_of_wave*edge(:d))))
      call spread_points(centres, length, fold, grid, squared_weights)
      call sum_over_ranks(comm, grid, size(grid), squared_weights)
      if (.not. squared_weights > 0) return
      call squared_transform_grid(grid, squares)
      call add_waves(centres, length, fold, n, reach, squares, squared_weights, width, sums)
      reach(1) = reach(2)
      level = level + 1
    end do
    call take_means(sums, factor)
  end subroutine structure_factor

  !> Spread weighted points over the cells about them (cloud in cell), the box folded. Where the box is not a period a window
  !! of Hann fades its ends out.
  subroutine spread_points(centres, length, fold, grid, squared_weights)
    type(centres_t), intent(in) :: centres
    real(wp), intent(in) :: length(3)
    integer, intent(in) :: fold(3)
    real(wp), intent(out) :: grid(:, :, :)
    real(wp), intent(out) :: squared_weights
    real(wp) :: points(3, size(centres%point, 2)), place(3), share(0:1, 3), weight
    integer :: cell(0:1, 3), p, a, i, j, l

    points = upright(centres, centres%point)
    grid = 0
    squared_weights = 0
    cell = 1
    share = reshape([1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], [2, 3])
    do p = 1, size(centres%point, 2)
      weight = 1
      do a = 1, centres%dimension
        place(a) = (points(a, p) - centres%low(a))/length(a)
        if (.not. centres%is_periodic(a)) weight = weight*(1 - cos(2*pi*place(a)))/2
        place(a) = modulo(place(a)*real(fold(a), wp), 1.0_wp)*real(size(grid, a), wp)
        cell(0, a) = min(int(place(a)), size(grid, a) - 1)
        share(1, a) = place(a) - real(cell(0, a), wp)
        share(0, a) = 1 - share(1, a)
        cell(:, a) = modulo([cell(0, a), cell(0, a) + 1], size(grid, a)) + 1
      end do
      squared_weights = squared_weights + weight**2
      do l = 0, centres%dimension - 2
        do j = 0, 1
          do i = 0, 1
            grid(cell(i, 1), cell(j, 2), cell(l, 3)) = grid(cell(i, 1), cell(j, 2), cell(l, 3)) &
                                                       + weight*share(i, 1)*share(j, 2)*share(l, 3)
          end do
        end do
      end do
    end do
  end subroutine spread_points

  !> Sum the grids of all ranks.
  subroutine sum_over_ranks(comm, grid, n, squared_weights)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: n
    real(wp), intent(inout) :: grid(n), squared_weights

    if (comm%size == 1) return
    call comm%sum(grid)
    call comm%sum(squared_weights)
  end subroutine sum_over_ranks

  !> Add the waves of a folded box whose vectors are in reach: number, lengths and S of each bin.
  subroutine add_waves(centres, length, fold, n, reach, squares, squared_weights, width, sums)
    type(centres_t), intent(in) :: centres
    real(wp), intent(in) :: length(3)
    integer, intent(in) :: fold(3), n
    real(wp), intent(in) :: reach(2)
    real(wp), intent(in) :: squares(0:, 0:, 0:)
    real(wp), intent(in) :: squared_weights, width
    real(wp), intent(inout) :: sums(3, most_bins)
    real(wp) :: k, periods(3)
    integer :: wave(3), i, j, l, m, bin

    m = n/cells_of_wave + 1
    do l = merge(-m, 0, centres%dimension == 3), merge(m, 0, centres%dimension == 3)
      do j = -m, m
        do i = 0, m
          wave = [i, j, l]
          ! Of a wave and its opposite one counts.
          if (i == 0 .and. (j < 0 .or. (j == 0 .and. l <= 0))) cycle
          if (is_of_box(wave*fold, centres%is_periodic)) cycle
          periods = real(wave*fold, wp)
          if (abs(centres%tilt) > 0) periods(2) = periods(2) - periods(1)*centres%tilt/length(1)
          k = 2*pi*norm2(periods/merge(length, 1.0_wp, length > 0))
          if (k <= reach(1) .or. k > reach(2)) cycle
          ! Many waves of a square box lie on the edge of a bin up to rounding.
          bin = max(1, min(most_bins, ceiling(k/width*(1 - 1e-12_wp))))
          sums(:, bin) = sums(:, bin) &
                         + [1.0_wp, k, corrected(squares(i, modulo(j, n), modulo(l, n))/squared_weights, wave, n)]
        end do
      end do
    end do
  end subroutine add_waves

  !> Does a wave see the box rather than what is in it? The window spreads the mean density over the waves next to zero.
  pure logical function is_of_box(wave, is_periodic)
    integer, intent(in) :: wave(3)
    logical, intent(in) :: is_periodic(3)

    is_of_box = all(abs(wave) <= merge(0, 1, is_periodic))
  end function is_of_box

  !> S from the square of a sum over spread points: cells weaken a wave and mix it with shorter ones, of which S = 1 is taken,
  !! as it is on the average [Jing2005]. Of waves of eight cells and more these are a share of 2e-3 at
  !! most; with what is left S of a single wave is off by up to 4 %, up as often as down, which is lost in the spread that such
  !! a wave has of itself.
  pure real(wp) function corrected(square, wave, n) result(s)
    real(wp), intent(in) :: square
    integer, intent(in) :: wave(3), n
    real(wp) :: weakened, mixed, half
    integer :: a

    weakened = 1
    mixed = 1
    do a = 1, 3
      half = pi*real(wave(a), wp)/real(n, wp)
      if (wave(a) /= 0) weakened = weakened*(sin(half)/half)**4
      mixed = mixed*(1 - 2*sin(half)**2/3)
    end do
    s = (square - (mixed - weakened))/weakened
  end function corrected

  !> Means of the bins that hold waves.
  subroutine take_means(sums, factor)
    real(wp), intent(in) :: sums(3, most_bins)
    type(structure_factor_t), intent(inout) :: factor
    integer :: i

    factor%waves = pack(sums(1, :), sums(1, :) > 0)
    factor%k = pack(sums(2, :), sums(1, :) > 0)/factor%waves
    factor%s = pack(sums(3, :), sums(1, :) > 0)/factor%waves
    factor%n = size(factor%k)
    do i = 1, factor%n
      factor%s(i) = max(0.0_wp, factor%s(i))
    end do
  end subroutine take_means
end module sg_structure_factor
