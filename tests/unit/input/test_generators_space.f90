!> Samples in space: no overlaps, seeds, size distributions, lattices, polyhedra.
program test_generators_space
  use harness, only: tests_t
  use sg_convex_hull, only: hull_is_available
  use sg_generators, only: draw_radius, size_lognormal, size_uniform, size_volume
  use sg_insertion, only: insert_at_random
  use sg_kinds, only: wp, pi
  use sg_lattice, only: lattice_cubic, lattice_fcc, lattice_hexagonal, place_on_lattice
  use sg_random, only: random_t
  use sg_rotations, only: turned_by
  use sg_scene, only: scene_t
  use sg_space_generators, only: random_direction, random_rotation
  use written_files, only: read_good_deck
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  type(tests_t) :: t

  call test_sizes()
  call test_directions()
  call test_insertion()
  call test_lattices()
  call test_samples()
  call test_polyhedra()
  call test_many()
  call t%finish()

contains

  !> Moments of the distributions, within five standard deviations of a mean over n numbers.
  subroutine test_sizes()
    integer, parameter :: n = 20000
    real(wp), parameter :: range(2) = [1.0_wp, 3.0_wp]
    real(wp), allocatable :: radii(:)
    type(random_t) :: random
    integer :: i

    allocate (radii(n))
    call random%seed(11)
    do i = 1, n
      radii(i) = draw_radius(random, size_volume, range, 3)
    end do
    call t%check(all(radii >= 1 .and. radii <= 3), 'radii within their range')
    ! Density proportional to 1/r**3 between 1 and 3: mean (1 - 1/3)/(1 - 1/9)*2 = 3/2, half of the volume below r = 2.
    call t%near(sum(radii)/n, 1.5_wp, 5*sqrt(sum((radii - 1.5_wp)**2)/n/n), 'by volume: mean')
    call t%near(sum(radii**3, radii < 2)/sum(radii**3), 0.5_wp, 0.02_wp, 'by volume: half of the volume below the middle')
    ! What does not hang on the dimension is drawn alike.
    do i = 1, 2
      call same_in_both(merge(size_uniform, size_lognormal, i == 1))
    end do
  end subroutine test_sizes

  subroutine same_in_both(distribution)
    integer, intent(in) :: distribution
    type(random_t) :: first, second

    call first%seed(4)
    call second%seed(4)
    call t%near(draw_radius(first, distribution, [1.0_wp, 2.0_wp], 3), draw_radius(second, distribution, [1.0_wp, 2.0_wp], 2), &
                0.0_wp, 'the same radius in plane and space')
  end subroutine same_in_both

  !> Directions and rotations have no preference: means of squares of coordinates, five standard deviations.
  subroutine test_directions()
    integer, parameter :: n = 20000
    real(wp) :: square(3), image(3), v(3)
    type(random_t) :: random
    integer :: i

    call random%seed(2)
    square = 0
    image = 0
    do i = 1, n
      v = random_direction(random)
      if (abs(norm2(v) - 1) > 1e-14_wp) exit
      square = square + v**2/n
      v = turned_by(random_rotation(random), [1.0_wp, 0.0_wp, 0.0_wp])
      if (abs(norm2(v) - 1) > 1e-14_wp) exit
      image = image + v**2/n
    end do
    call t%equal(i, n + 1, 'unit vectors')
    ! The variance of a squared coordinate of a random unit vector is 4/45.
    call t%near(maxval(abs(square - 1.0_wp/3)), 0.0_wp, 5*sqrt(4.0_wp/45/n), 'directions without preference')
    call t%near(maxval(abs(image - 1.0_wp/3)), 0.0_wp, 5*sqrt(4.0_wp/45/n), 'rotations without preference')
  end subroutine test_directions

  !> Random insertion against brute force, without a period, with one, with two.
  subroutine test_insertion()
    integer, parameter :: n = 500
    real(wp), parameter :: box(6) = [1.0_wp, 2.0_wp, 3.0_wp, 3.0_wp, 4.5_wp, 5.0_wp]
    real(wp), allocatable :: points(:, :), again(:, :)
    real(wp) :: none(3, 0)
    real(wp) :: radii(n)
    type(random_t) :: random
    integer :: k, axis, placed
    logical :: is_periodic(2), wraps(3)

    do k = 1, n
      radii(k) = 0.16_wp - 0.12_wp*real(k, wp)/n
    end do
    do k = 0, 3
      wraps = [btest(k, 0), btest(k, 1), .false.]
      is_periodic = wraps(:2)
      call random%seed(5)
      call insert_at_random(random, radii, box, 0.003_wp, is_periodic, none, none(1, :), points, placed)
      call t%equal(placed, n, 'all grains find room')
      call t%check(least_gap(points, radii, merge(box(4:5) - box(1:2), 0.0_wp, is_periodic)) >= 0.003_wp - 1e-12_wp, &
                   'grains keep their clearance')
      do axis = 1, 3
        if (wraps(axis)) then
          call t%check(any(points(axis, :) - radii < box(axis)), 'grains go through the sides')
          call t%check(all(points(axis, :) >= box(axis) .and. points(axis, :) <= box(3 + axis)), 'centres within the period')
        else
          call t%check(all(points(axis, :) - radii >= box(axis) .and. points(axis, :) + radii <= box(3 + axis)), &
                       'grains within the box')
        end if
      end do
    end do
    call random%seed(5)
    call insert_at_random(random, radii, box, 0.003_wp, is_periodic, none, none(1, :), again, placed)
    call t%near(maxval(abs(points - again)), 0.0_wp, 0.0_wp, 'the same seed gives the same places')
    call random%seed(6)
    call insert_at_random(random, radii, box, 0.003_wp, is_periodic, none, none(1, :), again, placed)
    call t%check(maxval(abs(points - again)) > 0.1_wp, 'another seed gives others')
    radii = 0.45_wp
    call insert_at_random(random, radii, box, 0.0_wp, is_periodic, none, none(1, :), again, placed)
    call t%check(placed > 3 .and. placed < 20, 'a full box is told')
  end subroutine test_insertion

  !> Least gap between spheres by brute force.
  pure real(wp) function least_gap(points, radii, period) result(gap)
    real(wp), intent(in) :: points(:, :), radii(:), period(2)
    real(wp) :: distance(3)
    integer :: i, j, axis

    gap = huge(1.0_wp)
    do i = 1, size(points, 2)
      do j = 1, i - 1
        distance = points(:, i) - points(:, j)
        do axis = 1, 2
          if (period(axis) > 0) distance(axis) = distance(axis) - period(axis)*anint(distance(axis)/period(axis))
        end do
        gap = min(gap, norm2(distance) - radii(i) - radii(j))
      end do
    end do
  end function least_gap

  !> Lattices: numbers counted by hand, neighbours at one pitch, twelve of them in the dense ones.
  subroutine test_lattices()
    real(wp), parameter :: cube(6) = [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 1.0_wp]
    real(wp), allocatable :: points(:, :)
    real(wp) :: period(2)
    integer :: lattice, middle

    call place_on_lattice(cube, 0.25_wp, lattice_cubic, [.false., .false.], 1000, points)
    call t%equal(size(points, 2), 64, 'cubic lattice')
    call t%near(minval(points), 0.125_wp, 1e-15_wp, 'half a pitch from the sides')
    call place_on_lattice(cube, 0.25_wp, lattice_cubic, [.false., .false.], 7, points)
    call t%equal(size(points, 2), 7, 'no more than wanted')
    call place_on_lattice(cube, 1.2_wp, lattice_cubic, [.false., .false.], 7, points)
    call t%equal(size(points, 2), 0, 'no room')
    call place_on_lattice([0.0_wp, 0.0_wp, 0.0_wp, 0.5_wp, 0.5_wp, 0.5_wp], 0.25_wp, lattice_fcc, [.false., .false.], 99, &
                                points)
    ! Layers 0.177 apart: of four, of one; a third would stand at 0.479.
    call t%equal(size(points, 2), 5, 'face centred cubic lattice')
    call place_on_lattice([0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.5_wp], 0.25_wp, lattice_hexagonal, &
                                [.false., .false.], 99, points)
    ! Rows 0.2165 apart, of four, three, four and three in the first layer, of three, four, three and four in the second.
    call t%equal(size(points, 2), 14 + 14, 'hexagonal lattice')
    period = [2.2_wp, 2.4_wp]
    do lattice = lattice_cubic, lattice_fcc
      call place_on_lattice([0.0_wp, 0.0_wp, 0.0_wp, period, 2.1_wp], 0.25_wp, lattice, [.true., .true.], 9999, points)
      call t%check(least_gap(points, spread(0.125_wp, 1, size(points, 2)), period) >= -1e-14_wp, 'no overlap through the period')
      call t%check(all(points >= 0) .and. all(points(1, :) < period(1)) .and. all(points(2, :) < period(2)), 'within the period')
    end do
    do lattice = lattice_hexagonal, lattice_fcc
      call place_on_lattice(2*cube, 0.25_wp, lattice, [.false., .false.], 9999, points)
      call t%near(least_gap(points, spread(0.125_wp, 1, size(points, 2)), [0.0_wp, 0.0_wp]), 0.0_wp, 1e-14_wp, &
                  'neighbours at one pitch')
      middle = minloc(norm2(points - 1, 1), 1)
      call t%equal(count(norm2(points - spread(points(:, middle), 2, size(points, 2)), 1) < 0.2501_wp) - 1, 12, &
                   'twelve neighbours')
    end do
  end subroutine test_lattices

  !> Samples through a deck: seeds, period, mass, jitter.
  subroutine test_samples()
    type(scene_t) :: scene, again, other
    real(wp) :: mass

    call read_good_deck(t, head('7')//'radius = [0.05, 0.1]'//nl//'box = [0, 0, 0, 2, 2, 2]'//nl//'count = 200'//nl// &
                        'velocity = [1, 2, 3]'//nl, scene)
    call read_good_deck(t, head('7')//'radius = [0.05, 0.1]'//nl//'box = [0, 0, 0, 2, 2, 2]'//nl//'count = 200'//nl, again)
    call read_good_deck(t, head('8')//'radius = [0.05, 0.1]'//nl//'box = [0, 0, 0, 2, 2, 2]'//nl//'count = 200'//nl, other)
    call t%equal(scene%bodies%n, 200, 'grains of a sample')
    call t%equal(scene%dimension + scene%bodies%dimension + scene%contactors%dimension, 9, 'in space')
    call t%near(maxval(abs(scene%bodies%position - again%bodies%position)), 0.0_wp, 0.0_wp, 'the same seed, the same sample')
    call t%check(maxval(abs(scene%bodies%position - other%bodies%position)) > 0.1_wp, 'another seed, another sample')
    call t%near(maxval(abs(scene%bodies%velocity(3, :) - 3)), 0.0_wp, 0.0_wp, 'velocity')
    call t%check(all(scene%bodies%is_grain), 'grains')
    ! Exact formulas, to rounding.
    call t%near(maxval(abs(scene%bodies%mass/(4000*pi/3*scene%contactors%space%sphere_radius(:200)**3) - 1)), 0.0_wp, 1e-14_wp, &
                'masses')
    call t%near(maxval(abs(scene%bodies%principal(2, :)/(0.4_wp*scene%bodies%mass*scene%contactors%reach(:200)**2) - 1)), 0.0_wp, &
                1e-14_wp, 'moments')
    call read_good_deck(t, '[scene]'//nl//'period_x = 2'//nl//'period_y = 3'//nl//'dimension = 3'//nl// &
                        tail('7')//'radius = 0.1'//nl// &
                        'box = [0, 0, 0, 2, 3, 2]'//nl//'fill = 0.25'//nl, scene)
    mass = 1000*0.25_wp*12
    call t%near(sum(scene%bodies%mass), mass, 4000*pi/3*0.001_wp, 'fill, to one grain')
    call t%check(least_gap(scene%bodies%position, spread(0.1_wp, 1, scene%bodies%n), [2.0_wp, 3.0_wp]) >= 0, &
                 'no overlap through the periods')
    call read_good_deck(t, head('7')//'kind = "lattice"'//nl//'arrangement = "fcc"'//nl//'spacing = 1.2'//nl//'jitter = 1'//nl// &
                        'radius = 0.1'//nl//'box = [0, 0, 0, 2, 2, 2]'//nl, scene)
    call t%check(least_gap(scene%bodies%position, spread(0.1_wp, 1, scene%bodies%n), [0.0_wp, 0.0_wp]) >= 0, &
                 'jitter makes no overlap')
  end subroutine test_samples

  !> Polyhedra: numbers of vertices, within their spheres, principal frames, seeds.
  subroutine test_polyhedra()
    type(scene_t) :: scene, again
    integer :: i, least, most
    real(wp) :: volume

    if (.not. hull_is_available()) then
      write (*, '(a)') 'polyhedra not tested: built without Qhull'
      return
    end if
    call read_good_deck(t, head('7')//'shape = "polyhedron"'//nl//'vertices = [6, 9]'//nl//'elongation = [1, 2]'//nl// &
                        'radius = [0.08, 0.1]'//nl//'box = [0, 0, 0, 2, 2, 2]'//nl//'count = 120'//nl, scene)
    call read_good_deck(t, head('7')//'shape = "polyhedron"'//nl//'vertices = [6, 9]'//nl//'elongation = [1, 2]'//nl// &
                        'radius = [0.08, 0.1]'//nl//'box = [0, 0, 0, 2, 2, 2]'//nl//'count = 120'//nl, again)
    call t%near(maxval(abs(scene%bodies%position - again%bodies%position)), 0.0_wp, 0.0_wp, 'the same seed, the same polyhedra')
    least = huge(1)
    most = 0
    do i = 1, 120
      least = min(least, scene%contactors%space%polyhedra(i)%n_vertices)
      most = max(most, scene%contactors%space%polyhedra(i)%n_vertices)
    end do
    call t%check(least == 6 .and. most == 9, 'six to nine vertices')
    volume = 4*pi/3*0.1_wp**3
    call t%check(all(scene%bodies%area > 0.01_wp*volume .and. scene%bodies%area < volume), 'volumes below those of the spheres')
    call t%near(maxval(abs(scene%bodies%mass - 1000*scene%bodies%area)), 0.0_wp, 1e-12_wp, 'masses')
    call t%check(all(scene%bodies%principal > 0) .and. all(2*maxval(scene%bodies%principal, 1) < sum(scene%bodies%principal, 1)), &
                 'moments of bodies that there may be')
    ! Ellipsoids with the half axes 2, 1, 1 have the moments 2, 5, 5; with 2, 2, 1 they have 5, 5, 8.
    call t%near(middle_over_least('1'), 2.5_wp, 0.5_wp, 'long polyhedra')
    call t%near(middle_over_least('2'), 1.0_wp, 0.3_wp, 'flat polyhedra')
  end subroutine test_polyhedra

  !> Mean over grains of the middle over the least principal moment, of polyhedra with elongation two.
  real(wp) function middle_over_least(flatness) result(mean)
    character(len=*), intent(in) :: flatness
    type(scene_t) :: scene
    real(wp) :: moments(3)
    integer :: i

    call read_good_deck(t, head('7')//'shape = "polyhedron"'//nl//'vertices = 20'//nl//'elongation = 2'//nl//'flatness = '// &
                        flatness//nl//'radius = 0.1'//nl//'box = [0, 0, 0, 2, 2, 2]'//nl//'count = 60'//nl, scene)
    mean = 0
    do i = 1, 60
      moments = scene%bodies%principal(:, i)
      mean = mean + (sum(moments) - maxval(moments) - minval(moments))/minval(moments)/60
    end do
  end function middle_over_least

  !> Beginning of a deck with a sample.
  function head(seed) result(text)
    character(len=*), intent(in) :: seed
    character(len=:), allocatable :: text

    text = '[scene]'//nl//'dimension = 3'//nl//tail(seed)
  end function head

  !> The same without [scene].
  function tail(seed) result(text)
    character(len=*), intent(in) :: seed
    character(len=:), allocatable :: text

    text = '[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl//'[[material]]'//nl//'name = "stone"'//nl//'density = 1000'//nl// &
           '[[law]]'//nl//'[[sample]]'//nl//'seed = '//seed//nl
  end function tail

  !> Thirty thousand spheres through a deck, without one overlap that its check would find.
  subroutine test_many()
    type(scene_t) :: scene

    call read_good_deck(t, head('1')//'radius = [0.5, 1.0]'//nl//'distribution = "volume"'//nl// &
                        'box = [0, 0, 0, 60, 60, 60]'//nl// &
                        'count = 30000'//nl, scene)
    call t%equal(scene%bodies%n, 30000, 'thirty thousand spheres')
  end subroutine test_many
end program test_generators_space
