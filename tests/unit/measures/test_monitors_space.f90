!> Indicators in space against closed forms: pairs of shapes, boxes, flows, contacts by hand; neighbours by brute force.
program test_monitors_space
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use measured, only: box_of_scene, mean_stress, measures_of, measures_without_contacts, overlap_of_scene
  use scenes, only: begin_run, density, place_bodies, run
  use scenes_space, only: begin_space_scene, put_box, put_plane, put_sphere
  use sg_balance, only: force_on_walls, momentum
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_grains, only: count_grains, grains_t
  use sg_kinds, only: wp, i1, i4, pi
  use sg_measures, only: measures_t, unmeasured
  use sg_penetration, only: deepest_penetration
  use sg_random, only: random_t
  use sg_rotations, only: rotation_by
  use sg_samples, only: samples_t
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  use sg_space_contactors, only: add_cylinder, add_hollow_cylinder
  implicit none
  ! Closed forms of a few operations: a few roundings of numbers of order one to ten.
  real(wp), parameter :: rounding = 1e-13_wp
  ! Two unit balls whose centres are a radius apart share 5 pi/12; a plane cuts a cap of half a radius off one, of 5 pi/24.
  real(wp), parameter :: lens = 5*pi/12, cap = 5*pi/24
  type(tests_t) :: t

  call test_names()
  call test_grains_and_speeds()
  call test_kinetic_energy_of_grains()
  call test_boxes()
  call test_affine_flow()
  call test_points_of_pairs()
  call test_coordination_by_brute_force()
  call test_overlaps()
  call test_overlaps_through_periods()
  call test_stress_of_a_contact()
  call test_force_on_walls()
  call t%finish()

contains

  !> Columns in space: the shared ones, then nine stresses and three momenta; counts are what counts contacts and grains.
  subroutine test_names()
    type(measures_t) :: measures
    character(len=:), allocatable :: all_names
    integer :: i

    all_names = ''
    measures = unmeasured(3, .true.)
    do i = 1, size(measures%column)
      all_names = all_names//','//trim(measures%column(i)%name)
    end do
    call t%check(index(all_names, ',rattlers,quadruple_contacts,stress_xx,stress_xy,stress_xz,stress_yx,stress_yy,stress_yz,'// &
                       'stress_zx,stress_zy,stress_zz,shear_rate,momentum_x,momentum_y,momentum_z,'// &
                       'fabric_xx,fabric_xy,fabric_xz,fabric_yy,fabric_yz,fabric_zz,mobilised_friction,sliding_share,'// &
                       'grain_coordination,wall_coordination,bond_energy,bond_loss,bonds,damaged_bonds') > 0, 'names in space')
    call check_columns(unmeasured(3, .true.), 50, 7, 'in space')
    call check_columns(unmeasured(2, .true.), 40, 6, 'in the plane')
    call check_columns(unmeasured(3, .false.), 46, 5, 'in space without cohesive zones')
    call check_columns(unmeasured(2, .false.), 36, 4, 'in the plane without cohesive zones')
    call check_columns(unmeasured(3, .false., has_means=.true.), 46 + 23, 5, 'in space with means')
    call check_columns(unmeasured(2, .false., has_means=.true.), 36 + 14, 4, 'in the plane with means')
  end subroutine test_names

  !> Numbers of columns and of counts among them; no two have one name.
  subroutine check_columns(measures, n, counts, what)
    type(measures_t), intent(in) :: measures
    integer, intent(in) :: n, counts
    character(len=*), intent(in) :: what
    integer :: i

    call t%equal(size(measures%column), n, 'columns '//what)
    call t%equal(count(measures%column%is_count), counts, 'counts '//what)
    do i = 2, n
      call t%check(all(measures%column(:i - 1)%name /= measures%column(i)%name), 'names are unique '//what)
    end do
    call t%near(maxval(abs(measures%column%value)), 0.0_wp, 0.0_wp, 'nothing is measured '//what)
  end subroutine check_columns

  !> Add a contact of two bodies, and of contactors of the same numbers.
  subroutine touch(contacts, candidate, antagonist, normal, gap, impulse)
    type(contacts_t), intent(inout) :: contacts
    integer, intent(in) :: candidate, antagonist
    real(wp), intent(in) :: normal(3), gap, impulse(3)

    contacts%dimension = 3
    contacts%n_components = 3
    call reserve_contacts(contacts, contacts%n + 1)
    contacts%n = contacts%n + 1
    contacts%body(:, contacts%n) = int([candidate, antagonist], i4)
    contacts%contactor(:, contacts%n) = int([candidate, antagonist], i4)
    contacts%normal(:, contacts%n) = normal
    contacts%point(:, contacts%n) = 0
    contacts%gap(contacts%n) = gap
    contacts%impulse(:, contacts%n) = impulse
    contacts%law(contacts%n) = 1
    contacts%image(contacts%n) = 0_i1
    contacts%image_y(contacts%n) = 0_i1
  end subroutine touch

  subroutine test_grains_and_speeds()
    type(scene_t) :: scene
    type(measures_t) :: measures
    type(grains_t) :: grains

    call begin_space_scene(scene, 3, 0.0_wp, 0.01_wp)
    call put_sphere(scene, 1, 2.0_wp, [0.0_wp, 0.0_wp, 0.0_wp])
    call put_box(scene, 2, [1.0_wp, 2.0_wp, 3.0_wp], [9.0_wp, 0.0_wp, 0.0_wp])
    call put_plane(scene, 3, [5.0_wp, 5.0_wp, 1.0_wp], [0.0_wp, 0.0_wp, -9.0_wp])
    scene%bodies%velocity(1:3, 1) = [2.0_wp, 3.0_wp, 6.0_wp]
    scene%bodies%velocity(1:3, 2) = [0.0_wp, 0.0_wp, -1.0_wp]
    scene%bodies%velocity(1:3, 3) = 100
    call place_bodies(scene)
    measures = measures_without_contacts(scene)
    call t%near(measures%get('mean_velocity'), 4.0_wp, rounding, 'mean speed of the grains, walls left out')
    call t%near(measures%get('max_velocity'), 7.0_wp, rounding, 'largest speed')
    call t%near(maxval(abs(momentum(scene%bodies)/density - 32*pi/3*[2.0_wp, 3.0_wp, 6.0_wp] + [0.0_wp, 0.0_wp, 48.0_wp])), &
                0.0_wp, 1e4_wp*rounding, 'momentum')
    call count_grains(scene%bodies, grains)
    call t%equal(grains%n, 2, 'grains')
    call t%near(grains%area, 32*pi/3 + 48, 100*rounding, 'their volume')
    call t%near(grains%mean_radius, (2 + (36/pi)**(1/3.0_wp))/2, rounding, 'mean radius of spheres of the same volume')
  end subroutine test_grains_and_speeds

  !> A box of 2 x 4 x 6 that spins about its principal axes, and a wall that must not count.
  subroutine test_kinetic_energy_of_grains()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(samples_t) :: samples
    real(wp) :: mass

    call begin_space_scene(scene, 2, 0.0_wp, 0.01_wp)
    call put_box(scene, 1, [1.0_wp, 2.0_wp, 3.0_wp], [0.0_wp, 0.0_wp, 0.0_wp])
    call put_plane(scene, 2, [5.0_wp, 5.0_wp, 1.0_wp], [0.0_wp, 0.0_wp, -9.0_wp])
    scene%bodies%velocity(:, 1) = [1.0_wp, 2.0_wp, 2.0_wp, 1.0_wp, 2.0_wp, 3.0_wp]
    scene%bodies%velocity(:, 2) = 7
    call touch(contacts, 1, 2, [0.0_wp, 0.0_wp, 1.0_wp], 0.0_wp, [1.0_wp, -2.0_wp, 3.0_wp])
    call samples%add(scene, contacts, 0.5_wp)
    mass = 48*density
    ! Moments m (b2 + c2)/3, b and c half lengths: 13, 10 and 5 m/3, with spins of 1, 2 and 3 rad/s.
    call t%near(samples%value(1, 1)/mass, (9 + 98/3.0_wp)/2, 100*rounding, 'kinetic energy of a box')
    call t%near(maxval(abs(samples%value(2:4, 1) - [-2.0_wp, 4.0_wp, -6.0_wp])), 0.0_wp, rounding, 'wall forces sampled')
    call t%near(maxval(abs(samples%value(5:7, 1)/mass - [1.0_wp, 2.0_wp, 2.0_wp])), 0.0_wp, rounding, 'momentum sampled')
    call t%equal(size(samples%value, 1), 7, 'seven series in space')
  end subroutine test_kinetic_energy_of_grains

  !> Boxes of grains: spheres, periods in x and y, a cube on its edge, capsule, hollow cylinder, plane; walls do not count.
  subroutine test_boxes()
    type(scene_t) :: scene
    type(measures_t) :: measures
    real(wp), parameter :: centre(3) = 0

    call begin_space_scene(scene, 3, 0.0_wp, 0.01_wp)
    call put_sphere(scene, 1, 1.0_wp, [0.0_wp, 0.0_wp, 0.0_wp])
    call put_box(scene, 2, [1.0_wp, 1.0_wp, 1.0_wp], [6.0_wp, 0.0_wp, 0.0_wp], rotation_by([0.0_wp, pi/4, 0.0_wp]))
    call put_plane(scene, 3, [90.0_wp, 90.0_wp, 1.0_wp], [0.0_wp, 0.0_wp, -9.0_wp])
    call place_bodies(scene)
    call t%near(box_of_scene(scene), (7 + sqrt(2.0_wp))*2*(2*sqrt(2.0_wp)), 100*rounding, 'box of a sphere and a cube on its edge')
    scene%period = 7
    call t%near(box_of_scene(scene), 7*2*(2*sqrt(2.0_wp)), 100*rounding, 'as wide as the period')
    scene%period_y = 3
    call t%near(box_of_scene(scene), 7*3*(2*sqrt(2.0_wp)), 100*rounding, 'as deep as the period in y')
    scene%period = 0
    scene%period_y = 0
    ! A capsule along (0, 3, 4)/5: half lengths 1, 5 * 0.6 + 1 and 5 * 0.8 + 1.
    call add_cylinder(scene%contactors, 1, 1, 5.0_wp, 1.0_wp, centre, [0.0_wp, 0.6_wp, 0.8_wp])
    call place_bodies(scene)
    call t%near(box_of_scene(scene), (7 + sqrt(2.0_wp))*8*10, 1e3_wp*rounding, 'box with a leaning capsule')
    ! A hollow cylinder about the same axis, its rim 10 off: half lengths 10, 6 * 0.6 + 10 * 0.8 and 6 * 0.8 + 10 * 0.6.
    call add_hollow_cylinder(scene%contactors, 1, 1, 6.0_wp, 10.0_wp, centre, [0.0_wp, 0.6_wp, 0.8_wp])
    call place_bodies(scene)
    call t%near(box_of_scene(scene), 20*23.2_wp*21.6_wp, 1e4_wp*rounding, 'box with a leaning hollow cylinder')
    scene%bodies%is_grain = [.false., .false., .true.]
    call t%near(box_of_scene(scene), 180*180*2.0_wp, 1e4_wp*rounding, 'box of a plane that is a grain')
    scene%bodies%is_grain = .false.
    measures = measures_without_contacts(scene)
    call t%near(measures%get('compactness'), 0.0_wp, 0.0_wp, 'no grain, no box')
  end subroutine test_boxes

  !> An affine field gives its own gradient; rotation and swelling have no shear rate, simple shear has its own.
  subroutine test_affine_flow()
    type(scene_t) :: scene
    type(random_t) :: random
    real(wp) :: gradient(3, 3), shear(3, 3)
    integer :: i, a, b

    call random%seed(5)
    call begin_space_scene(scene, 12, 0.0_wp, 0.01_wp)
    gradient = reshape([(random%uniform(-1.0_wp, 1.0_wp), i=1, 9)], [3, 3])
    do i = 1, 11
      call put_sphere(scene, i, 0.1_wp, [(random%uniform(0.0_wp, 5.0_wp), a=1, 3)])
    end do
    call put_plane(scene, 12, [9.0_wp, 9.0_wp, 1.0_wp], [0.0_wp, 0.0_wp, -9.0_wp])
    call expect_rate(scene, gradient, sqrt(2*sum(deviator(gradient)**2)), 'rate of an affine flow')
    do a = 1, 3
      do b = 1, 3
        shear = 0
        shear(a, b) = 3
        if (a /= b) call expect_rate(scene, shear, 3.0_wp, 'rate of a simple shear')
        shear(b, a) = -shear(a, b)
        if (a /= b) call expect_rate(scene, shear, 0.0_wp, 'rotation is no shear')
      end do
    end do
    shear = 0
    do a = 1, 3
      shear(a, a) = 2
    end do
    call expect_rate(scene, shear, 0.0_wp, 'swelling is no shear')
    ! Extension by 2 along z, shrinking by 1 along x and y: D' = D, 2 (4 + 1 + 1) = 12.
    shear(1, 1) = -1
    shear(2, 2) = -1
    call expect_rate(scene, shear, sqrt(12.0_wp), 'rate of an extension')
    scene%bodies%position(3, :) = scene%bodies%position(1, :) + 2*scene%bodies%position(2, :)
    call expect_rate(scene, shear, 0.0_wp, 'grains in a plane have no gradient')
    scene%bodies%is_grain(4:) = .false.
    call expect_rate(scene, shear, 0.0_wp, 'neither have three')
  end subroutine test_affine_flow

  !> Shear rate of a drift and a gradient, as it is measured.
  subroutine expect_rate(scene, gradient, rate, what)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: gradient(3, 3), rate
    character(len=*), intent(in) :: what
    type(measures_t) :: measures
    integer :: i

    do i = 1, 11
      scene%bodies%velocity(1:3, i) = [5.0_wp, 7.0_wp, -1.0_wp] + matmul(gradient, scene%bodies%position(:, i))
    end do
    measures = measures_without_contacts(scene)
    call t%near(measures%get('shear_rate'), rate, rounding, what)
  end subroutine expect_rate

  !> Deviator of the symmetric part.
  pure function deviator(gradient)
    real(wp), intent(in) :: gradient(3, 3)
    real(wp) :: deviator(3, 3), third
    integer :: a

    deviator = (gradient + transpose(gradient))/2
    third = sum([(deviator(a, a), a=1, 3)])/3
    do a = 1, 3
      deviator(a, a) = deviator(a, a) - third
    end do
  end function deviator

  !> Pairs that touch by one to five points; a rattler has one neighbour, by however many points.
  subroutine test_points_of_pairs()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(measures_t) :: measures
    integer, parameter :: pair(2, 15) = reshape([1, 2, 3, 4, 2, 3, 2, 3, 4, 3, 3, 4, 5, 1, 1, 5, 5, 1, 1, 5, 6, 5, 6, 5, 6, 5, &
                                                 5, 6, 5, 6], [2, 15])
    integer :: i

    scene = row_of_spheres(6, 5)
    do i = 1, size(pair, 2)
      call touch(contacts, pair(1, i), pair(2, i), [0.0_wp, 0.0_wp, 1.0_wp], 0.0_wp, [0.0_wp, 0.0_wp, 1.0_wp])
    end do
    measures = measures_of(scene, contacts, 0.1_wp)
    call t%equal(nint(measures%get('single_contacts')), 1, 'pairs with one point')
    call t%equal(nint(measures%get('double_contacts')), 1, 'pairs with two points')
    call t%equal(nint(measures%get('triple_contacts')), 1, 'pairs with three points')
    call t%equal(nint(measures%get('quadruple_contacts')), 2, 'pairs with four points and more')
    call t%near(measures%get('coordination'), 9/5.0_wp, rounding, 'a pair counts once, one with a wall for its grain')
    call t%equal(nint(measures%get('rattlers')), 1, 'one neighbour makes a rattler')
    call t%near(measures%get('coordination_without_rattlers'), 7/4.0_wp, rounding, 'coordination without it')
  end subroutine test_points_of_pairs

  !> Spheres in a row, of which the first are grains and the others are walls.
  function row_of_spheres(n, grains) result(scene)
    integer, intent(in) :: n, grains
    type(scene_t) :: scene
    integer :: i

    call begin_space_scene(scene, n, 0.0_wp, 0.01_wp)
    do i = 1, n
      call put_sphere(scene, i, 1.0_wp, [2*real(i, wp), 0.0_wp, 0.0_wp])
    end do
    scene%bodies%is_grain = [(i <= grains, i=1, n)]
    call place_bodies(scene)
  end function row_of_spheres

  !> Random contacts in random order, of which a third pull or slide without normal part, against a table of all pairs.
  subroutine test_coordination_by_brute_force()
    integer, parameter :: n = 40, grains = 35
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(measures_t) :: measures
    type(random_t) :: random
    real(wp) :: normal(3), along(3)
    integer :: points(n, n), i, a, b, d
    logical :: carries(n), touches(n, n)

    call random%seed(11)
    scene = row_of_spheres(n, grains)
    points = 0
    do i = 1, 90
      a = min(n, 1 + int(real(n, wp)*random%uniform()))
      b = min(n, 1 + int(real(n, wp)*random%uniform()))
      if (a == b) cycle
      normal = [(random%uniform(-1.0_wp, 1.0_wp), d=1, 3)]
      normal = normal/norm2(normal)
      along = [(random%uniform(-9.0_wp, 9.0_wp), d=1, 3)]
      along = along - dot_product(along, normal)*normal
      call touch(contacts, a, b, normal, 0.0_wp, along + (real(modulo(i, 3), wp) - 0.01_wp)*normal)
      if (modulo(i, 3) == 0) cycle
      points(a, b) = points(a, b) + 1
      points(b, a) = points(a, b)
    end do
    touches = points > 0
    carries = scene%bodies%is_grain .and. count(touches, 2) >= 2
    measures = measures_of(scene, contacts, 0.1_wp)
    call t%equal(nint(measures%get('single_contacts')), count(points == 1)/2, 'single contacts')
    call t%equal(nint(measures%get('double_contacts')), count(points == 2)/2, 'double contacts')
    call t%equal(nint(measures%get('triple_contacts') + measures%get('quadruple_contacts')), count(points > 2)/2, 'more')
    call t%equal(nint(measures%get('rattlers')), grains - count(carries), 'rattlers')
    call t%near(measures%get('coordination'), real(count(touches(:grains, :)), wp)/grains, rounding, 'coordination')
    do i = 1, grains
      if (carries(i)) cycle
      touches(i, :) = .false.
      touches(:, i) = .false.
    end do
    call t%near(measures%get('coordination_without_rattlers'), real(count(touches(:grains, :)), wp)/real(count(carries), wp), &
                rounding, 'coordination without rattlers')
  end subroutine test_coordination_by_brute_force

  !> Every pair of shapes that has a volume to share; a pair by four points counts once.
  subroutine test_overlaps()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(measures_t) :: measures
    integer :: i
    real(wp), parameter :: up(3) = [0.0_wp, 0.0_wp, 1.0_wp], none(3) = 0

    call begin_space_scene(scene, 11, 0.0_wp, 0.01_wp)
    call put_sphere(scene, 1, 1.0_wp, [0.6_wp, 0.0_wp, 0.8_wp])
    call put_sphere(scene, 2, 1.0_wp, [0.0_wp, 0.0_wp, 0.0_wp])
    call put_plane(scene, 3, [50.0_wp, 50.0_wp, 1.0_wp], [0.0_wp, 0.0_wp, -1.5_wp])
    call put_box(scene, 4, [1.0_wp, 1.0_wp, 1.0_wp], [10.0_wp, 0.0_wp, 0.4_wp])
    call put_box(scene, 5, [1.0_wp, 1.0_wp, 1.0_wp], [11.8_wp, 0.5_wp, 0.9_wp])
    call put_sphere(scene, 6, 1.0_wp, [10.0_wp, 0.0_wp, 1.9_wp])
    call put_capsule(scene, 7, [20.0_wp, 0.0_wp, 1.0_wp])
    call put_sphere(scene, 8, 1.0_wp, [20.0_wp, 0.0_wp, 3.0_wp])
    call put_sphere(scene, 9, 1.0_wp, [30.0_wp, 0.0_wp, 3.0_wp])
    call add_hollow_cylinder(scene%contactors, 10, 1, 5.0_wp, 0.8_wp, none, up)
    scene%bodies%position(:, 10) = [30.0_wp, 0.0_wp, 3.0_wp]
    scene%bodies%is_grain(10:11) = .false.
    call put_capsule(scene, 11, [20.0_wp, 0.0_wp, 4.0_wp])
    call place_bodies(scene)
    call expect(scene, 1, 2, lens, 'two spheres')
    call expect(scene, 2, 3, cap, 'sphere and plane')
    call expect(scene, 6, 4, cap, 'sphere and polyhedron')
    call expect(scene, 4, 3, 4*0.1_wp, 'polyhedron and plane')
    call expect(scene, 5, 4, 0.2_wp*1.5_wp*1.5_wp, 'two polyhedra')
    call expect(scene, 7, 3, cap, 'capsule and plane')
    call expect(scene, 8, 7, lens, 'sphere and capsule')
    call t%near(shared_by(scene, 7, 11), lens, 1e-4_wp*lens, 'two capsules')
    ! What is left of a ball with a hole through its centre: a ring of height 2 * 0.6.
    call expect(scene, 9, 10, 4*pi/3*0.6_wp**3, 'sphere in a hollow cylinder')
    call touch(contacts, 1, 2, up, -0.1_wp, none)
    do i = 1, 4
      call touch(contacts, 5, 4, up, -0.2_wp, none)
    end do
    call touch(contacts, 2, 3, up, 0.1_wp, none)
    measures = measures_of(scene, contacts, 0.1_wp)
    associate (volume => 5*4*pi/3 + 16 + (2*pi + 4*pi/3))
      call t%near(measures%get('volume_error'), (lens + 0.45_wp)/volume, rounding, 'volume error: open pairs count as nothing')
    end associate
    call t%near(measures%get('max_penetration'), 0.2_wp, rounding, 'deepest penetration by name')
    call t%near(deepest_penetration(contacts), 0.2_wp, rounding, 'deepest penetration alone')
  end subroutine test_overlaps

  !> Overlap of one pair alone.
  subroutine expect(scene, candidate, antagonist, volume, name)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: candidate, antagonist
    real(wp), intent(in) :: volume
    character(len=*), intent(in) :: name

    call t%near(shared_by(scene, candidate, antagonist), volume, 10*rounding, name)
  end subroutine expect

  !> The same without a word on it.
  real(wp) function shared_by(scene, candidate, antagonist) result(volume)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: candidate, antagonist
    type(contacts_t) :: one
    real(wp), parameter :: zero(3) = 0

    call touch(one, candidate, antagonist, [0.0_wp, 0.0_wp, 1.0_wp], -0.1_wp, zero)
    volume = overlap_of_scene(scene, one)
  end function shared_by

  !> An upright capsule of radius 1 and half height 1.
  subroutine put_capsule(scene, body, position)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body
    real(wp), intent(in) :: position(3)

    call add_cylinder(scene%contactors, body, 1, 1.0_wp, 1.0_wp, [0.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp, 1.0_wp])
    scene%bodies%position(:, body) = position
    scene%bodies%area(body) = 2*pi + 4*pi/3
    scene%bodies%mass(body) = density*scene%bodies%area(body)
    scene%bodies%principal(:, body) = 1
  end subroutine put_capsule

  !> Contacts as detection finds them: through x and y together, of polyhedra, and on a plane that spans both periods.
  subroutine test_overlaps_through_periods()
    type(simulation_t), pointer :: sim

    sim => fresh()
    call begin_space_scene(sim%scene, 6, 0.3_wp, 0.01_wp)
    sim%scene%gravity = 0
    sim%scene%period = 10
    sim%scene%period_y = 8
    call put_sphere(sim%scene, 1, 1.0_wp, [0.3_wp, 0.2_wp, 2.0_wp])
    call put_sphere(sim%scene, 2, 1.0_wp, [9.5_wp, 7.6_wp, 2.0_wp])
    call put_box(sim%scene, 3, [1.0_wp, 1.0_wp, 1.0_wp], [0.8_wp, 4.0_wp, 5.0_wp])
    call put_box(sim%scene, 4, [1.0_wp, 1.0_wp, 1.0_wp], [9.0_wp, 4.5_wp, 5.0_wp])
    call put_sphere(sim%scene, 5, 1.0_wp, [0.0_wp, 4.0_wp, 0.5_wp])
    call put_plane(sim%scene, 6, [5.0_wp, 4.0_wp, 1.0_wp], [5.0_wp, 4.0_wp, -1.0_wp])
    call begin_run(sim, 1e-3_wp, 1e-6_wp)
    call run(sim, 1)
    call t%equal(sim%contacts%n, 6, 'two spheres, four points of two boxes, and a sphere on the plane')
    call t%near(overlap_of_scene(sim%scene, sim%contacts), lens + 0.6_wp + cap, 10*rounding, &
                'overlaps through both periods')
    call t%near(sim%totals%worst_penetration, 1.0_wp, rounding, 'the deepest penetration of the run')
    sim%scene%bodies%velocity(1:3, 1) = [80.0_wp, 60.0_wp, 0.0_wp]
    call run(sim, 3)
    call t%near(sim%totals%worst_penetration, 1.0_wp, rounding, 'is kept when shapes have moved apart')
    call t%near(deepest_penetration(sim%contacts), 0.75_wp, 1e-3_wp, 'as these have, by a tenth of a metre a step')
  end subroutine test_overlaps_through_periods

  !> Force (10, 6, -4) N on a sphere, branch of 2.1 m through both periods; half of the branch on a wall; no stress without a box.
  subroutine test_stress_of_a_contact()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    real(wp), parameter :: h = 0.5_wp, n(3) = [0.6_wp, 0.0_wp, 0.8_wp], force(3) = [10.0_wp, 6.0_wp, -4.0_wp]
    ! Volumes of the box of both spheres and of one, as wide and deep as the periods [m3].
    real(wp), parameter :: both = 10*20*(2 + 2.1_wp*0.8_wp), one = 10*20*2
    real(wp) :: stress(3, 3)
    integer :: a, b

    call begin_space_scene(scene, 2, 0.0_wp, 0.01_wp)
    scene%period = 10
    scene%period_y = 20
    call put_sphere(scene, 1, 1.0_wp, [1.0_wp, 1.0_wp, 1.0_wp])
    ! Seen from the first sphere the second stands at (1, 1, 1) - 2.1 n.
    call put_sphere(scene, 2, 1.0_wp, [1.0_wp, 1.0_wp, 1.0_wp] - 2.1_wp*n + [10.0_wp, 20.0_wp, 0.0_wp])
    call place_bodies(scene)
    call touch(contacts, 1, 2, n, 0.1_wp, h*force)
    contacts%point(:, 1) = [1.0_wp, 1.0_wp, 1.0_wp] - 1.05_wp*n
    contacts%image(1) = -1_i1
    contacts%image_y(1) = -1_i1
    stress = mean_stress(scene, contacts, h)
    do b = 1, 3
      do a = 1, 3
        call t%near(stress(a, b)*both, force(a)*2.1_wp*n(b), rounding*10, 'stress of a contact: force by branch over volume')
      end do
    end do
    scene%bodies%is_grain(2) = .false.
    stress = mean_stress(scene, contacts, h)
    call t%near(stress(1, 3)*one, force(1)*1.05_wp*n(3), rounding*10, 'on a wall the branch ends at the point of contact')
    scene%contactors%n = 0
    call t%near(maxval(abs(mean_stress(scene, contacts, h))), 0.0_wp, 0.0_wp, 'no volume, no stress')
  end subroutine test_stress_of_a_contact

  !> Forces on walls, of either side of a contact, and the share of the weight that they are.
  subroutine test_force_on_walls()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(measures_t) :: measures
    real(wp), parameter :: up(3) = [0.0_wp, 0.0_wp, 1.0_wp], h = 0.5_wp

    scene = row_of_spheres(4, 2)
    scene%bodies%mass = 1
    scene%gravity = [0.0_wp, -3.0_wp, -4.0_wp]
    call touch(contacts, 1, 3, up, 0.0_wp, [1.0_wp, 2.0_wp, 5.0_wp])
    call touch(contacts, 4, 2, up, 0.0_wp, [1.0_wp, 0.0_wp, 3.0_wp])
    call touch(contacts, 1, 2, up, 0.0_wp, [9.0_wp, 9.0_wp, 9.0_wp])
    call touch(contacts, 3, 4, up, 0.0_wp, [9.0_wp, 9.0_wp, 9.0_wp])
    call t%near(maxval(abs(force_on_walls(scene, contacts, h) - [0.0_wp, -4.0_wp, -4.0_wp])), 0.0_wp, rounding, 'force on walls')
    ! Along gravity (12 + 16)/5 N of a weight of 2 kg times 5 m/s2.
    measures = measures_of(scene, contacts, h)
    call t%near(measures%get('floor_share'), 0.56_wp, rounding, 'floor share under leaning gravity')
  end subroutine test_force_on_walls
end program test_monitors_space
