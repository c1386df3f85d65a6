!> Structure of point sets that are known: random points, lattices, lattices shaken by known amounts; shared among any ranks, of
!! which several find what one finds.
program test_structure
  use harness, only: tests_t
  use sg_centres, only: centres_t
  use sg_comm, only: comm_t
  use sg_fourier, only: fourier_is_available
  use sg_kinds, only: wp, pi
  use sg_radial_distribution, only: radial_distribution, radial_distribution_t
  use sg_random, only: random_t
  use sg_structure_factor, only: structure_factor, structure_factor_t
  use subdomain_tests, only: on_subdomains
  implicit none
  !> A mean of n waves of a random set is spread by one over the root of n: five times that is met once in a million
  real(wp), parameter :: spreads = 5
  !> Random points that several ranks share, in the plane and in space
  integer, parameter :: shared_points(2:3) = [1500, 1000]
  type(tests_t) :: t
  !> g and S of these points on one rank, in the plane between ends, in space in a period
  type(radial_distribution_t), save :: radial_of(2:3)
  type(structure_factor_t), save :: factor_of(2:3)
  type(comm_t) :: alone
  integer :: d

  do d = 2, 3
    call find_structure(alone, d, radial_of(d), factor_of(d))
  end do
  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm

    ! What many points have, one subdomain shows; that several find the same, fewer points show more sharply.
    if (comm%size == 1) then
      call test_random(comm, 2, 5000)
      call test_random(comm, 3, 8000)
      call test_window(comm, 2, 70)
      call test_window(comm, 3, 20)
      call test_shaken(comm, 2, 80, 0.1_wp)
      call test_shaken(comm, 3, 20, 0.1_wp)
      call test_far(comm)
    end if
    call test_shared(comm, 2)
    call test_shared(comm, 3)
    call test_direct(comm)
    call test_lattice(comm)
    call test_nothing(comm)
  end subroutine run_tests

  !> g and S of random points, shared among the ranks.
  subroutine find_structure(comm, dimension, radial, factor)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: dimension
    type(radial_distribution_t), intent(out) :: radial
    type(structure_factor_t), intent(out) :: factor
    type(centres_t) :: centres
    type(random_t) :: random
    real(wp) :: points(3, shared_points(dimension))
    integer :: i, a

    call random%seed(15)
    points = 0
    do i = 1, size(points, 2)
      do a = 1, dimension
        points(a, i) = random%uniform(0.0_wp, 1.0_wp)
      end do
    end do
    call share(comm, dimension, points, [1.0_wp, 1.0_wp, 1.0_wp], dimension == 3, &
               (1/real(size(points, 2), wp))**(1/real(dimension, wp)), centres)
    call radial_distribution(centres, comm, radial)
    if (fourier_is_available()) call structure_factor(centres, comm, factor)
  end subroutine find_structure

  !> All ranks find the pairs and the waves that one rank finds, and the same S up to the order of sums.
  subroutine test_shared(comm, dimension)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: dimension
    type(radial_distribution_t) :: radial
    type(structure_factor_t) :: factor

    call find_structure(comm, dimension, radial, factor)
    associate (expected => radial_of(dimension))
      call t%check(radial%n == 200 .and. expected%n == 200, 'distances of shared points')
      call t%check(expected%references > 100, 'many of them count')
      call t%near(radial%references, expected%references, 0.0_wp, 'as on one rank')
      call t%near(maxval(abs(radial%r - expected%r)), 0.0_wp, 0.0_wp, 'distances as on one rank')
      call t%near(maxval(abs(radial%g - expected%g)), 0.0_wp, 0.0_wp, 'g as on one rank')
    end associate
    if (.not. fourier_is_available()) return
    associate (expected => factor_of(dimension))
      call t%equal(factor%n, expected%n, 'bins of shared points')
      call t%check(expected%n > 20, 'many of them')
      if (factor%n /= expected%n) return
      call t%near(maxval(abs(factor%waves - expected%waves)), 0.0_wp, 0.0_wp, 'waves as on one rank')
      call t%near(maxval(abs(factor%k - expected%k)), 0.0_wp, 0.0_wp, 'their lengths as on one rank')
      call t%near(maxval(abs(factor%s - expected%s)), 0.0_wp, 1e-12_wp*maxval(expected%s), 'S as on one rank')
    end associate
  end subroutine test_shared

  !> Points thrown at random into a periodic box: g = 1 and S = 1 everywhere.
  subroutine test_random(comm, dimension, n)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: dimension, n
    type(centres_t) :: centres
    type(radial_distribution_t) :: radial
    type(structure_factor_t) :: factor
    type(random_t) :: random
    real(wp) :: points(3, n), ring(200), expected
    integer :: i, a

    call random%seed(11)
    points = 0
    do i = 1, n
      do a = 1, dimension
        points(a, i) = random%uniform(0.0_wp, 1.0_wp)
      end do
    end do
    call share(comm, dimension, points, [1.0_wp, 1.0_wp, 1.0_wp], .true., (1/real(n, wp))**(1/real(dimension, wp)), centres)
    call radial_distribution(centres, comm, radial)
    call t%equal(radial%n, 200, 'distances')
    call t%near(radial%references, real(n, wp), 0.0_wp, 'all points of a periodic box count')
    ring = [(shell(dimension, radial%r(i), radial%r(2) - radial%r(1)), i=1, 200)]
    do i = 1, 200
      ! Each pair is counted from both sides: half as many independent ones.
      expected = real(n, wp)*real(n, wp)*ring(i)
      call t%near(radial%g(i), 1.0_wp, spreads*sqrt(2/expected), 'g of random points')
    end do
    if (.not. fourier_is_available()) return
    call structure_factor(centres, comm, factor)
    call t%check(factor%n > 20 .and. factor%k(factor%n)*centres%diameter > 20, 'waves')
    do i = 1, factor%n
      call t%near(factor%s(i), 1.0_wp, spreads/sqrt(factor%waves(i)), 'S of random points')
    end do
  end subroutine test_random

  !> The same in a box with ends: the window hides them.
  subroutine test_window(comm, dimension, columns)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: dimension, columns
    type(centres_t) :: centres
    type(structure_factor_t) :: factor
    type(random_t) :: random
    real(wp), allocatable :: points(:, :)
    integer :: i, a, n

    n = columns**dimension
    allocate (points(3, n), source=0.0_wp)
    call random%seed(12)
    do i = 1, n
      do a = 1, dimension
        points(a, i) = random%uniform(-0.5_wp, 0.5_wp)*real(columns, wp)
      end do
    end do
    call share(comm, dimension, points, spread(real(columns, wp), 1, 3), .false., 1.0_wp, centres)
    centres%low(:dimension) = -real(columns, wp)/2
    centres%high(:dimension) = real(columns, wp)/2
    if (.not. fourier_is_available()) return
    call structure_factor(centres, comm, factor)
    ! Windows make neighbouring waves alike: three of a line, of which fewer are independent.
    do i = 1, factor%n
      call t%near(factor%s(i), 1.0_wp, spreads*sqrt(3.0_wp**dimension/factor%waves(i)), 'S of random points in a box with ends')
    end do
  end subroutine test_window

  !> A lattice whose points are shifted by normal numbers of deviation s: S = 1 - exp(-(k s)^2) but at the waves of the lattice.
  subroutine test_shaken(comm, dimension, columns, deviation)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: dimension, columns
    real(wp), intent(in) :: deviation
    type(centres_t) :: centres
    type(structure_factor_t) :: factor
    real(wp), allocatable :: points(:, :)
    type(random_t) :: random
    real(wp) :: expected
    integer :: i, a, n

    n = columns**dimension
    allocate (points(3, n), source=0.0_wp)
    call random%seed(13)
    do i = 1, n
      do a = 1, dimension
        points(a, i) = modulo(real(modulo((i - 1)/columns**(a - 1), columns), wp) + 0.5_wp + deviation*random%normal(), &
                              real(columns, wp))
      end do
    end do
    call share(comm, dimension, points, spread(real(columns, wp), 1, 3), .true., 1.0_wp, centres)
    if (.not. fourier_is_available()) return
    call structure_factor(centres, comm, factor)
    do i = 1, factor%n
      ! The first wave of the lattice has the length 2 pi.
      if (factor%k(i) > 6) exit
      expected = 1 - exp(-(factor%k(i)*deviation)**2)
      ! Waves of a bin have different lengths: over its width the law is straight to a hundredth.
      call t%near(factor%s(i), expected, expected*(spreads/sqrt(factor%waves(i)) + 0.05_wp), 'S of a shaken lattice')
    end do
    call t%check(factor%s(1) < 0.01_wp, 'long waves are as good as absent')
  end subroutine test_shaken

  !> Few points against the sum that defines S, bin by bin.
  subroutine test_direct(comm)
    type(comm_t), intent(inout) :: comm
    integer, parameter :: n = 60
    real(wp), parameter :: length = 8
    type(centres_t) :: centres
    type(structure_factor_t) :: factor
    type(random_t) :: random
    real(wp) :: points(3, n), width, k, sums(3, 128)
    integer :: i, j, bin

    if (.not. fourier_is_available()) return
    call random%seed(14)
    points = 0
    do i = 1, n
      points(:2, i) = [random%uniform(0.0_wp, length), random%uniform(0.0_wp, length)]
    end do
    call share(comm, 2, points, [length, length, 0.0_wp], .true., 1.0_wp, centres)
    call structure_factor(centres, comm, factor)
    width = 2*pi/length
    sums = 0
    do j = -40, 40
      do i = 0, 40
        if (i == 0 .and. j <= 0) cycle
        k = width*norm2(real([i, j], wp))
        if (k > 8*pi) cycle
        bin = ceiling(k/width*(1 - 1e-12_wp))
        sums(:, bin) = sums(:, bin) + [1.0_wp, k, &
                                       abs(sum(exp(cmplx(0, -width*matmul(real([i, j], wp), points(:2, :)), wp))))**2/n]
      end do
    end do
    call t%equal(factor%n, count(sums(1, :) > 0), 'bins')
    do i = 1, factor%n
      call t%near(factor%waves(i), sums(1, i), 0.0_wp, 'waves of a bin')
      call t%near(factor%k(i), sums(2, i)/sums(1, i), 1e-12_wp*factor%k(i), 'their mean length')
      ! Of waves of 32 cells at least shorter ones keep 1/31 squared of their amplitude, twice that in S, with any sign.
      call t%near(factor%s(i), sums(3, i)/sums(1, i), spreads*2e-3_wp/sqrt(sums(1, i)), 'S is the sum that defines it')
    end do
  end subroutine test_direct

  !> A square lattice: four neighbours at one pitch, four at the diagonal, none before, in a periodic box and in one with ends.
  subroutine test_lattice(comm)
    type(comm_t), intent(inout) :: comm
    integer, parameter :: columns = 40
    type(centres_t) :: centres
    type(radial_distribution_t) :: radial
    real(wp) :: points(3, columns**2), near
    integer :: i, b

    points = 0
    do i = 1, columns**2
      points(:2, i) = [real(modulo(i - 1, columns), wp), real((i - 1)/columns, wp)] + 0.25_wp
    end do
    do b = 1, 2
      call share(comm, 2, points, [40.0_wp, 40.0_wp, 0.0_wp], b == 1, 1.0_wp, centres)
      if (b == 2) centres%high(:2) = 39.75_wp
      if (b == 2) centres%low(:2) = -0.25_wp
      call radial_distribution(centres, comm, radial)
      call t%near(radial%references, merge(1600.0_wp, 900.0_wp, b == 1), 0.0_wp, 'points with all their surroundings')
      do i = 1, radial%n
        if (radial%r(i) < 0.95_wp) call t%near(radial%g(i), 0.0_wp, 0.0_wp, 'no point is nearer than a pitch')
      end do
      near = sum([(radial%g(i)*shell(2, radial%r(i), radial%r(2) - radial%r(1)), i=1, 200)], radial%r < 1.2_wp)
      ! Of 30 by 30 points in 30 by 30 pitches the density is one.
      call t%near(near, 4.0_wp, 1e-9_wp, 'neighbours at a pitch')
      near = sum([(radial%g(i)*shell(2, radial%r(i), radial%r(2) - radial%r(1)), i=1, 200)], radial%r < 1.7_wp)
      call t%near(near, 8.0_wp, 1e-9_wp, 'and at the diagonal')
    end do
  end subroutine test_lattice

  !> No grain, one grain, grains on a line: nothing to tell, and no harm.
  subroutine test_nothing(comm)
    type(comm_t), intent(inout) :: comm
    type(centres_t) :: centres
    type(radial_distribution_t) :: radial
    type(structure_factor_t) :: factor
    real(wp) :: points(3, 3)

    points = 0
    points(1, :) = [1.0_wp, 2.0_wp, 3.0_wp]
    call share(comm, 2, points(:, :0), [0.0_wp, 0.0_wp, 0.0_wp], .false., 1.0_wp, centres)
    call radial_distribution(centres, comm, radial)
    call structure_factor(centres, comm, factor)
    call t%check(radial%n == 0 .and. factor%n == 0, 'nothing of nothing')
    call share(comm, 2, points, [3.0_wp, 0.0_wp, 0.0_wp], .false., 1.0_wp, centres)
    call radial_distribution(centres, comm, radial)
    call structure_factor(centres, comm, factor)
    call t%check(radial%n == 0 .and. factor%n == 0, 'nothing of a line')
  end subroutine test_nothing

  !> Grains 1e10 diameters apart: the longest waves are told, down to a 1e8th of the box, and there is an end.
  subroutine test_far(comm)
    type(comm_t), intent(inout) :: comm
    type(centres_t) :: centres
    type(structure_factor_t) :: factor
    real(wp) :: points(3, 3)

    if (.not. fourier_is_available()) return
    points = 0
    points(2, :) = [0.0_wp, 5e9_wp, 1e10_wp]
    points(1, :) = [0.0_wp, 1.0_wp, 2.0_wp]
    call share(comm, 2, points, [2.0_wp, 1e10_wp, 0.0_wp], .false., 1.0_wp, centres)
    call structure_factor(centres, comm, factor)
    call t%check(factor%n > 0, 'far apart: some waves')
    call t%check(all(factor%k > 0 .and. factor%k <= 8*pi .and. factor%s >= 0 .and. factor%s <= huge(1.0_wp)), 'far apart: finite')
  end subroutine test_far

  !> Area of a ring, volume of a shell, of middle radius and thickness.
  pure real(wp) function shell(dimension, radius, thickness)
    integer, intent(in) :: dimension
    real(wp), intent(in) :: radius, thickness

    if (dimension == 2) then
      shell = 2*pi*radius*thickness
    else
      shell = 4*pi/3*((radius + thickness/2)**3 - (radius - thickness/2)**3)
    end if
  end function shell

  !> Deal points to the ranks in turn.
  subroutine share(comm, dimension, points, high, is_periodic, diameter, centres)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: dimension
    real(wp), intent(in) :: points(:, :), high(3), diameter
    logical, intent(in) :: is_periodic
    type(centres_t), intent(out) :: centres

    centres%dimension = dimension
    centres%point = points(:, comm%rank + 1::comm%size)
    centres%high(:dimension) = high(:dimension)
    centres%is_periodic(:dimension) = is_periodic
    centres%diameter = diameter
  end subroutine share
end program test_structure
