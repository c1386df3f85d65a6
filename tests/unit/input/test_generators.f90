!> Samples: no overlaps, seeds, size distributions, lattices, polygons.
program test_generators
  use harness, only: tests_t
  use sg_generators, only: draw_polygon, draw_radius, size_constant, size_lognormal, size_uniform, &
                           size_volume
  use sg_insertion, only: insert_at_random
  use sg_kinds, only: wp, pi
  use sg_lattice, only: lattice_square, lattice_triangular, place_on_lattice
  use sg_moments, only: polygon_moments
  use sg_ordering, only: order_of
  use sg_random, only: random_t
  use sg_scene, only: scene_t
  use sg_timers, only: cpu_now
  use written_files, only: read_good_deck
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  type(tests_t) :: t

  call test_order()
  call test_sizes()
  call test_insertion()
  call test_lattice()
  call test_polygons()
  call test_samples()
  call test_many()
  call t%finish()

contains

  subroutine test_order()
    real(wp) :: values(1000)
    type(random_t) :: random
    integer :: i

    call random%seed(3)
    do i = 1, size(values)
      values(i) = random%normal()
    end do
    values = values(order_of(values))
    call t%check(all(values(2:) >= values(:999)), 'reals are sorted')
    call t%equal(size(order_of(values(:0))), 0, 'none of them')
  end subroutine test_order

  !> Moments of the distributions, within five standard deviations of a mean over n numbers.
  subroutine test_sizes()
    integer, parameter :: n = 20000
    real(wp), parameter :: range(2) = [1.0_wp, 3.0_wp]
    real(wp), allocatable :: radii(:)
    real(wp) :: mean, deviation
    type(random_t) :: random
    integer :: distribution, i

    allocate (radii(n))
    call random%seed(11)
    do distribution = 1, 4
      do i = 1, n
        radii(i) = draw_radius(random, distribution, range, 2)
      end do
      call t%check(all(radii >= 1 .and. radii <= 3), 'radii within their range')
      mean = sum(radii)/n
      deviation = 5*sqrt(sum((radii - mean)**2)/n/n)
      select case (distribution)
      case (size_uniform)
        call t%near(mean, 2.0_wp, deviation, 'uniform: mean')
        call t%near(sum(radii**2)/n, 13.0_wp/3, 5*sqrt(sum((radii**2 - 13.0_wp/3)**2)/n/n), 'uniform: mean square')
      case (size_volume)
        ! Density proportional to 1/r**2 between 1 and 3: mean 1.5 log(3), mean square 3, half of the area below r = 2.
        call t%near(mean, 1.5_wp*log(3.0_wp), deviation, 'by area: mean')
        call t%near(sum(radii**2)/n, 3.0_wp, 5*sqrt(sum((radii**2 - 3)**2)/n/n), 'by area: mean square')
        call t%near(sum(radii**2, radii < 2)/sum(radii**2), 0.5_wp, 0.02_wp, 'by area: half of the area below the middle')
      case (size_lognormal)
        ! Symmetric in the logarithm about log(sqrt(3)); a normal law cut at two deviations has 0.7737 of its variance.
        call t%near(sum(log(radii))/n, log(3.0_wp)/2, 5*log(3.0_wp)/4/sqrt(real(n, wp)), 'lognormal: median')
        call t%near(sum((log(radii) - log(3.0_wp)/2)**2)/n, 0.7737_wp*(log(3.0_wp)/4)**2, 0.05_wp*(log(3.0_wp)/4)**2, &
                    'lognormal: variance')
      case (size_constant)
        call t%near(maxval(abs(radii - 1)), 0.0_wp, 0.0_wp, 'all the same')
      end select
    end do
  end subroutine test_sizes

  !> Random insertion against brute force, with and without a period.
  subroutine test_insertion()
    integer, parameter :: n = 800
    real(wp), parameter :: box(4) = [1.0_wp, 2.0_wp, 5.0_wp, 5.0_wp]
    real(wp), allocatable :: points(:, :), again(:, :)
    real(wp) :: none(2, 0)
    real(wp) :: radii(n), gap
    type(random_t) :: random
    integer :: i, placed
    logical :: is_periodic

    do i = 1, 2
      is_periodic = i == 2
      radii = sizes(n, 0.02_wp, 0.08_wp)
      call random%seed(5)
      call insert_at_random(random, radii, box, 0.005_wp, [is_periodic], none, none(1, :), points, placed)
      call t%equal(placed, n, 'all grains find room')
      gap = least_gap(points, radii, merge(4.0_wp, 0.0_wp, is_periodic))
      call t%check(gap >= 0.005_wp - 1e-12_wp, 'grains keep their clearance')
      if (is_periodic) then
        call t%check(any(points(1, :) - radii < 1) .and. any(points(1, :) + radii > 5), 'grains go through the sides')
        call t%check(all(points(1, :) >= 1 .and. points(1, :) <= 5), 'centres within the period')
      else
        call t%check(all(points(1, :) - radii >= 1 .and. points(1, :) + radii <= 5), 'grains within the box in x')
      end if
      call t%check(all(points(2, :) - radii >= 2 .and. points(2, :) + radii <= 5), 'grains within the box in y')
    end do
    call random%seed(5)
    call insert_at_random(random, radii, box, 0.005_wp, [.true.], none, none(1, :), again, placed)
    call t%near(maxval(abs(points - again)), 0.0_wp, 0.0_wp, 'the same seed gives the same places')
    call random%seed(6)
    call insert_at_random(random, radii, box, 0.005_wp, [.true.], none, none(1, :), again, placed)
    call t%check(maxval(abs(points - again)) > 0.1_wp, 'another seed gives others')
    radii = 0.2_wp
    call insert_at_random(random, radii, box, 0.0_wp, [.false.], none, none(1, :), again, placed)
    call t%check(placed > 30 .and. placed < 96, 'a box that is too full takes some')
    call t%check(least_gap(again(:, :placed), radii(:placed), 0.0_wp) >= 0, 'and those do not overlap')
  end subroutine test_insertion

  !> Radii, largest first.
  function sizes(n, low, high) result(radii)
    integer, intent(in) :: n
    real(wp), intent(in) :: low, high
    real(wp) :: radii(n)
    integer :: i

    radii = [(high + (low - high)*real(i - 1, wp)/real(n - 1, wp), i=1, n)]
  end function sizes

  !> Least gap between any two circles.
  real(wp) function least_gap(points, radii, period) result(gap)
    real(wp), intent(in) :: points(:, :), radii(:), period
    real(wp) :: distance(2)
    integer :: i, j

    gap = huge(1.0_wp)
    do i = 1, size(radii)
      do j = 1, i - 1
        distance = points(:, i) - points(:, j)
        if (period > 0) distance(1) = distance(1) - period*anint(distance(1)/period)
        gap = min(gap, norm2(distance) - radii(i) - radii(j))
      end do
    end do
  end function least_gap

  subroutine test_lattice()
    real(wp), parameter :: box(4) = [0.0_wp, 0.0_wp, 1.0_wp, 0.5_wp]
    real(wp), allocatable :: points(:, :), radii(:)
    real(wp) :: gap

    call place_on_lattice(box, 0.1_wp, lattice_square, [.false.], 1000, points)
    call t%equal(size(points, 2), 50, 'square lattice')
    radii = spread(0.05_wp, 1, 1000)
    gap = least_gap(points, radii(:50), 0.0_wp)
    call t%near(gap, 0.0_wp, 1e-14_wp, 'neighbours at one pitch')
    call t%near(minval(points), 0.05_wp, 1e-15_wp, 'half a pitch from the sides')
    call place_on_lattice(box, 0.1_wp, lattice_triangular, [.false.], 1000, points)
    ! Rows 0.0866 apart: five of them, of ten and nine places.
    call t%equal(size(points, 2), 10 + 9 + 10 + 9 + 10, 'triangular lattice')
    gap = least_gap(points, radii(:48), 0.0_wp)
    call t%near(gap, 0.0_wp, 1e-14_wp, 'neighbours at one pitch')
    call place_on_lattice([0.0_wp, 0.0_wp, 1.04_wp, 0.5_wp], 0.1_wp, lattice_triangular, [.true.], 1000, points)
    call t%equal(size(points, 2), 50, 'triangular lattice with a period')
    gap = least_gap(points, radii(:50), 1.04_wp)
    call t%near(gap, norm2([0.052_wp, 0.1_wp*sqrt(0.75_wp)]) - 0.1_wp, 1e-14_wp, 'rows stretched to the period')
    call place_on_lattice(box, 0.1_wp, lattice_square, [.false.], 7, points)
    call t%equal(size(points, 2), 7, 'no more than wanted')
    call place_on_lattice(box, 0.6_wp, lattice_square, [.false.], 7, points)
    call t%equal(size(points, 2), 0, 'no room')
  end subroutine test_lattice

  subroutine test_polygons()
    real(wp), allocatable :: vertices(:, :)
    real(wp) :: area, centre(2), moment, turn
    type(random_t) :: random
    integer :: n, i, k

    call random%seed(1)
    do i = 1, 200
      n = 3 + modulo(i, 8)
      call draw_polygon(random, n, 2.0_wp, vertices)
      call polygon_moments(vertices, area, centre, moment)
      turn = huge(1.0_wp)
      do k = 1, n
        associate (a => vertices(:, k), b => vertices(:, modulo(k, n) + 1), c => vertices(:, modulo(k + 1, n) + 1))
          turn = min(turn, (b(1) - a(1))*(c(2) - b(2)) - (b(2) - a(2))*(c(1) - b(1)))
        end associate
      end do
      if (turn <= 0 .or. area <= 0 .or. size(vertices, 2) /= n) exit
      if (maxval(abs(norm2(vertices, 1) - 2)) > 1e-14_wp) exit
    end do
    call t%equal(i, 201, 'random polygons are convex, counter-clockwise, on their circle')
  end subroutine test_polygons

  !> Samples through a deck: kinds, materials, period, mass.
  subroutine test_samples()
    type(scene_t) :: scene, again, other
    real(wp) :: mass

    call read_good_deck(t, head('7')//'shape = "polygon"'//nl//'sides = [3, 6]'//nl//'radius = [0.05, 0.1]'//nl// &
                        'box = [0, 0, 3, 3]'//nl//'count = 200'//nl//'velocity = [1, 2]'//nl, scene)
    call read_good_deck(t, head('7')//'shape = "polygon"'//nl//'sides = [3, 6]'//nl//'radius = [0.05, 0.1]'//nl// &
                        'box = [0, 0, 3, 3]'//nl//'count = 200'//nl, again)
    call read_good_deck(t, head('8')//'shape = "polygon"'//nl//'sides = [3, 6]'//nl//'radius = [0.05, 0.1]'//nl// &
                        'box = [0, 0, 3, 3]'//nl//'count = 200'//nl, other)
    call t%equal(scene%bodies%n, 200, 'grains of a sample')
    call t%near(maxval(abs(scene%bodies%position - again%bodies%position)), 0.0_wp, 0.0_wp, 'the same seed, the same sample')
    call t%check(maxval(abs(scene%bodies%position - other%bodies%position)) > 0.1_wp, 'another seed, another sample')
    call t%check(all(abs(scene%bodies%velocity(2, :) - 2) <= 0), 'velocity')
    associate (first => scene%contactors%polygon_first(:201))
      call t%check(minval(first(2:) - first(:200)) == 3 .and. maxval(first(2:) - first(:200)) == 6, 'three to six sides')
    end associate
    call t%check(all(scene%bodies%mass > 0 .and. scene%bodies%inertia > 0 .and. scene%bodies%is_grain), 'masses')
    call read_good_deck(t, '[scene]'//nl//'period_x = 3'//nl//head('7')//'radius = 0.1'//nl//'box = [0, 0, 3, 3]'//nl// &
                        'fill = 0.4'//nl, scene)
    mass = 1000*0.4_wp*9
    call t%near(sum(scene%bodies%mass), mass, 1000*pi*0.01_wp, 'fill, to one grain')
    call t%check(least_gap(scene%bodies%position, spread(0.1_wp, 1, scene%bodies%n), 3.0_wp) >= 0, 'no overlap through the period')
    call read_good_deck(t, head('7')//'kind = "lattice"'//nl//'arrangement = "triangular"'//nl//'spacing = 1.2'//nl// &
                        'jitter = 1'//nl// &
                        'radius = 0.1'//nl//'box = [0, 0, 3, 3]'//nl, scene)
    call t%check(least_gap(scene%bodies%position, spread(0.1_wp, 1, scene%bodies%n), 0.0_wp) >= 0, 'jitter makes no overlap')
  end subroutine test_samples

  !> Beginning of a deck with a sample.
  function head(seed) result(text)
    character(len=*), intent(in) :: seed
    character(len=:), allocatable :: text

    text = '[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl//'[[material]]'//nl//'name = "stone"'//nl//'density = 1000'//nl// &
           '[[law]]'//nl//'[[sample]]'//nl//'seed = '//seed//nl
  end function head

  !> A hundred thousand grains take seconds.
  subroutine test_many()
    type(scene_t) :: scene
    real(wp) :: start

    start = cpu_now()
    call read_good_deck(t, head('1')//'radius = [0.5, 1.5]'//nl//'distribution = "volume"'//nl//'box = [0, 0, 700, 700]'//nl// &
                        'count = 100000'//nl, scene)
    call t%equal(scene%bodies%n, 100000, 'a hundred thousand grains')
    ! Some seconds with all run-time checks; a search through all grains would take hours.
    call t%check(cpu_now() - start < 60, 'in seconds')
    write (*, '(a,f6.2,a)') '100000 grains in ', cpu_now() - start, ' s'
  end subroutine test_many
end program test_generators
