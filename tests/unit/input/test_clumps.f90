!> Samples of clumps and of shapes from files: sizes, masses, turns, seeds.
program test_clumps
  use harness, only: tests_t
  use sg_kinds, only: wp, pi
  use sg_rounded_points, only: farthest_point, rounded_points, sieve_opening
  use sg_scene, only: scene_t
  use written_files, only: put_text, read_good_deck
  implicit none
  character(len=*), parameter :: nl = new_line('a')
  character(len=*), parameter :: common = '[time]'//nl//'step = 1e-3'//nl//'steps = 10'//nl//'[[material]]'//nl// &
    'name = "stone"'//nl//'density = 1000'//nl//'[[law]]'//nl//'friction = 0.3'//nl
  character(len=*), parameter :: peanut = '[[clump]]'//nl//'name = "peanut"'//nl//'mass_of = "sum"'//nl// &
    '[[clump.shape]]'//nl//'kind = "disk"'//nl//'radius = 1'//nl//'centre = [0, 0]'//nl// &
    '[[clump.shape]]'//nl//'kind = "disk"'//nl//'radius = 1'//nl//'centre = [1.4, 0]'//nl
  character(len=*), parameter :: kite = '[[clump]]'//nl//'name = "kite"'//nl//'colour = "red"'//nl// &
    '[[clump.shape]]'//nl//'kind = "polygon"'//nl//'vertices = [[0, 0], [2, 0], [0, 2]]'//nl
  character(len=*), parameter :: dumbbell = '[[clump]]'//nl//'name = "dumbbell"'//nl//'mass_of = "sum"'//nl// &
    '[[clump.shape]]'//nl//'kind = "sphere"'//nl//'radius = 1'//nl//'centre = [0, 0, 2]'//nl// &
    '[[clump.shape]]'//nl//'kind = "sphere"'//nl//'radius = 1'//nl//'centre = [0, 0, -2]'//nl// &
    '[[clump.shape]]'//nl//'kind = "cylinder"'//nl//'radius = 0.5'//nl//'half_height = 2'//nl
  type(tests_t) :: t

  call test_masses()
  call test_union()
  call test_sieve()
  call test_own_size()
  call test_space()
  call test_files()
  call t%finish()

contains

  !> Mass, centre and moment of grains, in closed form.
  subroutine test_masses()
    type(scene_t) :: scene, again
    real(wp) :: size_of
    integer :: i

    call read_good_deck(t, common//peanut//'[[sample]]'//nl//'shape = "clump"'//nl//'clump = "peanut"'//nl// &
                        'radius = [0.017, 0.034]'//nl//'box = [0, 0, 1, 1]'//nl//'count = 150'//nl, scene)
    call read_good_deck(t, common//peanut//'[[sample]]'//nl//'shape = "clump"'//nl//'clump = "peanut"'//nl// &
                        'radius = [0.017, 0.034]'//nl//'box = [0, 0, 1, 1]'//nl//'count = 150'//nl, again)
    call t%equal(scene%bodies%n, 150, 'bodies')
    call t%equal(scene%contactors%n, 300, 'two disks each')
    call t%near(maxval(abs(scene%bodies%position - again%bodies%position)), 0.0_wp, 0.0_wp, 'the same seed, the same places')
    call t%near(maxval(abs(scene%bodies%angle - again%bodies%angle)), 0.0_wp, 0.0_wp, 'and the same turns')
    call t%check(maxval(scene%bodies%angle) > 5 .and. minval(scene%bodies%angle) < 1, 'turns all round')
    do i = 1, 150
      size_of = scene%contactors%disk_radius(2*i - 1)
      call t%check(1.7_wp*size_of > 0.017_wp*(1 - 1e-14_wp) .and. 1.7_wp*size_of < 0.034_wp*(1 + 1e-14_wp), 'radius about a grain')
      call t%near(scene%bodies%mass(i)/(1000*2*pi*size_of**2), 1.0_wp, 1e-13_wp, 'mass, what disks share counted twice')
      call t%near(scene%bodies%inertia(i)/(1000*(pi + 2*pi*0.49_wp)*size_of**4), 1.0_wp, 1e-13_wp, 'moment about the centre')
      call t%near(scene%contactors%shift(1, 2*i), 0.7_wp*size_of, 1e-15_wp, 'centre of mass in the middle')
    end do
  end subroutine test_masses

  !> What shapes share counts once: two rectangles and two boxes that together are one.
  subroutine test_union()
    type(scene_t) :: scene

    call read_good_deck(t, common//'[[clump]]'//nl//'name = "brick"'//nl// &
                        '[[clump.shape]]'//nl//'kind = "polygon"'//nl//'vertices = [[0, 0], [2, 0], [2, 1], [0, 1]]'//nl// &
                        '[[clump.shape]]'//nl//'kind = "polygon"'//nl//'vertices = [[1, 0], [3, 0], [3, 1], [1, 1]]'//nl// &
                        '[[sample]]'//nl//'shape = "clump"'//nl//'clump = "brick"'//nl//'box = [0, 0, 9, 9]'//nl// &
                        'count = 2'//nl, scene)
    ! Lines along x cut rectangles exactly.
    call t%near(scene%bodies%mass(1), 3000.0_wp, 1e-9_wp, 'mass of a union')
    call t%near(scene%bodies%inertia(2), 2500.0_wp, 1e-3_wp, 'moment of a union, to the square of the distance of lines')
    call t%near(scene%contactors%shift(1, 1), -0.5_wp, 1e-12_wp, 'centre of a union')
    call read_good_deck(t, '[scene]'//nl//'dimension = 3'//nl//common//'[[clump]]'//nl//'name = "brick"'//nl// &
                        '[[clump.shape]]'//nl//'kind = "box"'//nl//'half_axes = [1, 0.5, 0.25]'//nl// &
                        '[[clump.shape]]'//nl//'kind = "box"'//nl//'half_axes = [1, 0.5, 0.25]'//nl//'centre = [1, 0, 0]'//nl// &
                        '[[sample]]'//nl//'shape = "clump"'//nl//'clump = "brick"'//nl//'box = [0, 0, 0, 9, 9, 9]'//nl// &
                        'count = 2'//nl, scene)
    call t%near(scene%bodies%mass(1), 1500.0_wp, 1e-9_wp, 'mass of a union in space')
    call t%near(maxval(scene%bodies%principal(:, 1)), 1250.0_wp, 1e-2_wp, 'largest moment of a union in space')
    call t%near(minval(scene%bodies%principal(:, 1)), 156.25_wp, 1e-2_wp, 'least moment of a union in space')
  end subroutine test_union

  !> Of two clumps each grain is one; all pass the largest opening, none the smallest.
  subroutine test_sieve()
    type(scene_t) :: scene
    real(wp), allocatable :: point(:, :), radius(:)
    real(wp) :: opening(120)
    integer :: i, c, last

    call read_good_deck(t, common//peanut//kite//'[[sample]]'//nl//'shape = "clump"'//nl//'clump = ["peanut", "kite"]'//nl// &
                        'sieve = [[0.02, 0], [0.03, 40], [0.04, 100]]'//nl//'box = [0, 0, 1, 1]'//nl//'count = 120'//nl// &
                        'colour = "grey"'//nl, scene)
    c = 1
    do i = 1, 120
      last = c
      do while (last < scene%contactors%n)
        if (scene%contactors%body(last + 1) /= i) exit
        last = last + 1
      end do
      call rounded_points(scene%contactors, c, last, point, radius)
      opening(i) = sieve_opening(point, radius)
      c = last + 1
    end do
    call t%check(minval(opening) > 0.02_wp*(1 - 1e-9_wp) .and. maxval(opening) < 0.04_wp*(1 + 1e-9_wp), 'openings within the curve')
    ! Sizes follow an even sequence; shapes are drawn independently of them, so masses do within five standard deviations of a mean
    ! over a hundred grains.
    call t%near(sum(scene%bodies%mass, opening < 0.03_wp)/sum(scene%bodies%mass), 0.4_wp, 0.1_wp, 'mass below an opening')
    associate (red => count([(scene%colours(scene%contactors%colour(c))%s == 'red', c=1, scene%contactors%n)]))
      call t%check(red > 30 .and. red < 90, 'both kinds of clump are there')
      call t%equal(2*(120 - red) + red, scene%contactors%n, 'colours of clumps and of the sample')
    end associate
  end subroutine test_sieve

  !> Without sizes grains are as large as their template.
  subroutine test_own_size()
    type(scene_t) :: scene

    call read_good_deck(t, common//kite//'[[sample]]'//nl//'kind = "lattice"'//nl//'shape = "clump"'//nl//'clump = "kite"'//nl// &
                        'box = [0, 0, 20, 20]'//nl, scene)
    call t%check(scene%bodies%n >= 25, 'a lattice of clumps')
    call t%near(maxval(abs(scene%bodies%mass - 2000)), 0.0_wp, 1e-9_wp, 'masses of the template')
  end subroutine test_own_size

  !> The same in space: principal frame, mass and moments of a grain.
  subroutine test_space()
    type(scene_t) :: scene
    real(wp), parameter :: half = 2, thin = 0.5_wp
    real(wp) :: size_of, volume
    integer :: i

    call read_good_deck(t, '[scene]'//nl//'dimension = 3'//nl//common//dumbbell//'[[sample]]'//nl//'shape = "clump"'//nl// &
                        'clump = "dumbbell"'//nl//'sieve = [[0.02, 0], [0.04, 100]]'//nl//'box = [0, 0, 0, 1, 1, 1]'//nl// &
                        'count = 60'//nl, scene)
    call t%equal(scene%contactors%n, 180, 'three shapes each')
    do i = 1, 60
      size_of = scene%contactors%space%sphere_radius(2*i)
      call t%check(2*size_of > 0.02_wp*(1 - 1e-9_wp) .and. 2*size_of < 0.04_wp*(1 + 1e-9_wp), 'passes its larger sphere')
      volume = 2*4*pi/3 + pi*thin**2*2*half + 4*pi/3*thin**3
      call t%near(scene%bodies%mass(i)/(1000*volume*size_of**3), 1.0_wp, 1e-12_wp, 'mass')
      ! About the axis: two spheres, a cylinder and its two caps.
      call t%near(minval(scene%bodies%principal(:, i))/(1000*size_of**5*(2*0.4_wp*4*pi/3 + pi*thin**4*half + &
                                                                         0.4_wp*4*pi/3*thin**5)), 1.0_wp, 1e-12_wp, 'least moment')
      associate (place => norm2(scene%contactors%shift(:, 3*i - 2:3*i), 1))
        call t%near(maxval(abs(place - size_of*[2.0_wp, 2.0_wp, 0.0_wp])), 0.0_wp, 1e-14_wp, 'places')
      end associate
    end do
    call t%check(maxval(abs(scene%bodies%orientation(:, 2:) - scene%bodies%orientation(:, :59))) > 0.5_wp, 'turned at random')
  end subroutine test_space

  !> Polyhedra from files, sized by the opening that they pass.
  subroutine test_files()
    type(scene_t) :: scene
    real(wp), allocatable :: point(:, :), radius(:)
    real(wp) :: opening
    integer :: i

    call put_text('clump_a.obj', 'v 0 0 0'//nl//'v 3 0 0'//nl//'v 0 3 0'//nl//'v 0 0 3'//nl//'f 1 3 2'//nl//'f 1 2 4'//nl// &
                  'f 1 4 3'//nl//'f 2 3 4'//nl)
    call put_text('clump_b.obj', 'v 1 1 1'//nl//'v 1 -1 -1'//nl//'v -1 1 -1'//nl//'v -1 -1 1'//nl//'f 1 2 3'//nl//'f 1 4 2'//nl// &
                  'f 1 3 4'//nl//'f 2 4 3'//nl)
    call read_good_deck(t, '[scene]'//nl//'dimension = 3'//nl//common//'[[sample]]'//nl//'shape = "polyhedron"'//nl// &
                        'files = "clump_[ab].ob?"'//nl//'sieve = [[0.02, 0], [0.04, 100]]'//nl//'box = [0, 0, 0, 1, 1, 1]'//nl// &
                        'count = 40'//nl, scene)
    do i = 1, 40
      call rounded_points(scene%contactors, i, i, point, radius)
      opening = sieve_opening(point, radius)
      call t%check(opening > 0.02_wp*(1 - 1e-4_wp) .and. opening < 0.04_wp*(1 + 1e-4_wp), 'opening of a stone')
      ! Both are tetrahedra: the regular one of opening 2 has the volume 8/3.
      if (is_regular(scene%bodies%principal(:, i))) &
        call t%near(scene%bodies%mass(i)/(1000*8.0_wp/3*(opening/2)**3), 1.0_wp, 1e-3_wp, 'mass of a regular tetrahedron')
      call t%near(farthest_point(point, radius), scene%contactors%reach(i), 1e-15_wp, 'about its centre of mass')
    end do
    i = count([(is_regular(scene%bodies%principal(:, i)), i=1, 40)])
    call t%check(i > 5 .and. i < 35, 'both stones are drawn')
  end subroutine test_files

  !> Are the three moments of a body the same?
  pure logical function is_regular(moments)
    real(wp), intent(in) :: moments(3)

    is_regular = maxval(moments) < minval(moments)*(1 + 1e-9_wp)
  end function is_regular
end program test_clumps
