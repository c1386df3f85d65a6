!> Indicators against closed forms: two disks, a box of four disks, affine flows, one pressed contact.
program test_monitors
  use harness, only: tests_t
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use made_by_hand, only: disks, make_wall, set_middle, touch
  use measured, only: box_of_scene, mean_stress, measures_of, measures_without_contacts, overlap_of_scene
  use sg_balance, only: momentum
  use sg_contactors, only: add_polygon, add_segment
  use sg_contacts, only: contacts_t
  use sg_grains, only: count_grains, grains_t
  use sg_kinds, only: wp, i1, i8, pi
  use sg_measures, only: measures_t
  use sg_report, only: report_t
  use sg_scene, only: scene_t
  use sg_totals, only: n_phases, phase_solve, totals_t
  implicit none
  ! Closed forms of a few operations: a few roundings of numbers of order one to ten.
  real(wp), parameter :: rounding = 1e-13_wp
  type(tests_t) :: t

  call test_grains_and_speeds()
  call test_two_disks()
  call test_volume_error()
  call test_box_of_four()
  call test_points_of_a_pair()
  call test_boxes()
  call test_affine_flow()
  call test_pressed_contact()
  call test_periodic_stress()
  call test_totals()
  call t%finish()

contains

  subroutine test_grains_and_speeds()
    type(scene_t) :: scene
    type(measures_t) :: measures
    type(grains_t) :: grains

    scene = disks(reshape([0.0_wp, 0.0_wp, 3.0_wp, 0.0_wp, 6.0_wp, 0.0_wp], [2, 3]))
    call make_wall(scene, 3)
    scene%bodies%velocity(1:2, 1) = [3.0_wp, 4.0_wp]
    scene%bodies%velocity(1:2, 2) = [0.0_wp, -1.0_wp]
    scene%bodies%velocity(1:2, 3) = [100.0_wp, 0.0_wp]
    measures = measures_without_contacts(scene)
    call t%near(measures%get('mean_velocity'), 3.0_wp, rounding, 'mean speed of the grains, walls left out')
    call t%near(measures%get('max_velocity'), 5.0_wp, rounding, 'largest speed')
    call t%near(norm2(momentum(scene%bodies) - [6.0_wp, 6.0_wp]), 0.0_wp, rounding, 'momentum')
    call count_grains(scene%bodies, grains)
    call t%equal(grains%n, 2, 'grains')
    call t%near(grains%area, 2*pi, rounding, 'their area')
    call t%near(grains%mean_radius, 1.0_wp, rounding, 'their mean radius')
  end subroutine test_grains_and_speeds

  !> Gaps -0.1, 0.05, -0.3: mean penetration 0.2, largest 0.3.
  subroutine test_two_disks()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(measures_t) :: measures

    scene = disks(reshape([0.0_wp, 0.0_wp, -1.9_wp, 0.0_wp, 0.0_wp, 2.05_wp, 0.0_wp, -1.7_wp], [2, 4]))
    call touch(contacts, 1, 2, [1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], -0.1_wp, [0.0_wp, 0.0_wp])
    call touch(contacts, 1, 3, [0.0_wp, -1.0_wp], [0.0_wp, 0.0_wp], 0.05_wp, [0.0_wp, 0.0_wp])
    call touch(contacts, 1, 4, [0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp], -0.3_wp, [0.0_wp, 0.0_wp])
    measures = measures_of(scene, contacts, 0.1_wp)
    call t%near(measures%get('mean_penetration'), 0.2_wp, rounding, 'mean penetration')
    call t%near(measures%get('max_penetration'), 0.3_wp, rounding, 'largest penetration')
    contacts%n = 0
    measures = measures_of(scene, contacts, 0.1_wp)
    call t%near(measures%get('mean_penetration') + measures%get('max_penetration'), 0.0_wp, 0.0_wp, 'no contact, no penetration')
  end subroutine test_two_disks

  !> Overlaps by pair of kinds, through the period, and a pair with two points that counts once.
  subroutine test_volume_error()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(measures_t) :: measures
    real(wp), parameter :: square(2, 4) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])
    ! Two unit disks whose centres are a radius apart share 2 pi/3 - sqrt(3)/2; the side of a square through the centre, pi/2.
    real(wp), parameter :: lens = 2*pi/3 - sqrt(3.0_wp)/2
    integer :: b

    scene = disks(reshape([0.0_wp, 0.0_wp, 9.0_wp, 0.0_wp, 0.0_wp, -20.0_wp, 20.0_wp, 0.0_wp], [2, 4]))
    scene%period = 10
    call add_polygon(scene%contactors, 1, 1, square, [1.0_wp, 0.0_wp])
    call add_polygon(scene%contactors, 3, 1, square, [1.5_wp, 21.8_wp])
    call add_segment(scene%contactors, 4, 1, 5.0_wp, 0.5_wp, [-20.0_wp, -1.4_wp], 0.0_wp)
    call make_wall(scene, 4)
    call set_middle(scene, 0.0_wp)
    call touch(contacts, 1, 2, [1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], -1.0_wp, [0.0_wp, 0.0_wp])
    contacts%image(1) = -1_i1
    call t%near(overlap_of_scene(scene, contacts), lens, rounding, 'two disks through the period')
    do b = 1, 2
      call touch(contacts, 6, 5, [0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp], -0.2_wp, [0.0_wp, 0.0_wp])
    end do
    ! Any grain: overlaps are of contactors alone.
    contacts%body = 1
    call t%near(overlap_of_scene(scene, contacts), lens + 1.5_wp*0.2_wp, rounding, 'polygons by two points')
    ! The segment's upper side stands at -0.9, 0.1 above the lower side of the square, which is 2 wide.
    call touch(contacts, 5, 7, [0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp], -0.1_wp, [0.0_wp, 0.0_wp])
    call touch(contacts, 1, 5, [-1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], -1.0_wp, [0.0_wp, 0.0_wp])
    contacts%body = 1
    call t%near(overlap_of_scene(scene, contacts), lens + 0.5_wp + pi/2, rounding, 'all pairs')
    measures = measures_of(scene, contacts, 0.1_wp)
    call t%near(measures%get('volume_error'), (lens + 0.5_wp + pi/2)/(3*pi), rounding, 'volume error')
    contacts%gap(2:) = 0
    call t%near(overlap_of_scene(scene, contacts), lens, rounding, 'only pairs that overlap')
  end subroutine test_volume_error

  !> Four disks in a square on a floor, and a fifth on top of one of them: its own single neighbour makes it a rattler.
  subroutine test_box_of_four()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(measures_t) :: measures

    scene = disks(reshape([2.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, 2.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 4.0_wp, &
                           1.0_wp, -2.0_wp], [2, 6]))
    call make_wall(scene, 6)
    call touch(contacts, 6, 1, [0.0_wp, -1.0_wp], [0.0_wp, 0.0_wp], 0.0_wp, [2.0_wp, 0.0_wp])
    call touch(contacts, 2, 6, [0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp], 0.0_wp, [2.0_wp, 0.0_wp])
    call touch(contacts, 1, 2, [1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], 0.0_wp, [1.0_wp, 0.0_wp])
    call touch(contacts, 3, 4, [1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], 0.0_wp, [1.0_wp, 0.0_wp])
    call touch(contacts, 3, 1, [0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp], 0.0_wp, [1.0_wp, 0.0_wp])
    call touch(contacts, 4, 2, [0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp], 0.0_wp, [1.0_wp, 0.0_wp])
    call touch(contacts, 5, 4, [0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp], 0.0_wp, [1.0_wp, 0.0_wp])
    call touch(contacts, 5, 3, [0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp], 0.0_wp, [0.0_wp, 0.0_wp])
    measures = measures_of(scene, contacts, 0.1_wp)
    ! Five pairs of grains count twice, two with the floor once.
    call t%near(measures%get('coordination'), 12/5.0_wp, rounding, 'coordination')
    call t%equal(nint(measures%get('rattlers')), 1, 'rattlers')
    call t%near(measures%get('coordination_without_rattlers'), 10/4.0_wp, rounding, 'coordination without rattlers')
    call t%equal(nint(measures%get('single_contacts')), 7, 'single contacts: the open one does not count')
    contacts%n = 0
    measures = measures_of(scene, contacts, 0.1_wp)
    call t%near(measures%get('coordination') + measures%get('coordination_without_rattlers'), 0.0_wp, 0.0_wp, &
                'no contact, no neighbours')
    call t%equal(nint(measures%get('rattlers')), 5, 'all are rattlers')
  end subroutine test_box_of_four

  !> Points of one pair are counted together wherever they stand in the list, whichever body is the candidate.
  subroutine test_points_of_a_pair()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(measures_t) :: measures
    integer, parameter :: pair(2, 7) = reshape([1, 2, 3, 4, 2, 3, 2, 1, 4, 3, 3, 4, 5, 1], [2, 7])
    integer :: i

    scene = disks(reshape([(2.0_wp*real(i, wp), 0.0_wp, i=1, 5)], [2, 5]))
    do i = 1, size(pair, 2)
      call touch(contacts, pair(1, i), pair(2, i), [0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp], 0.0_wp, [1.0_wp, 0.0_wp])
    end do
    measures = measures_of(scene, contacts, 0.1_wp)
    call t%equal(nint(measures%get('single_contacts')), 2, 'pairs with one point')
    call t%equal(nint(measures%get('double_contacts')), 1, 'pairs with two points')
    call t%equal(nint(measures%get('triple_contacts')), 1, 'pairs with three points')
    call t%near(measures%get('coordination'), 8/5.0_wp, rounding, 'a pair counts once')
  end subroutine test_points_of_a_pair

  !> Boxes of grains: disks 8 x 2, periodic, a lying segment and a square on its corner.
  subroutine test_boxes()
    type(scene_t) :: scene
    type(measures_t) :: measures
    real(wp), parameter :: square(2, 4) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])

    scene = disks(reshape([0.0_wp, 0.0_wp, 6.0_wp, 0.0_wp, 50.0_wp, 0.0_wp], [2, 3]))
    call make_wall(scene, 3)
    call t%near(box_of_scene(scene), 16.0_wp, rounding, 'box of two disks')
    scene%period = 7
    call t%near(box_of_scene(scene), 14.0_wp, rounding, 'its width is the period')
    scene%period = 0
    call add_segment(scene%contactors, 1, 1, 2.0_wp, 0.5_wp, [0.0_wp, 0.0_wp], pi/2)
    call set_middle(scene, 0.0_wp)
    call t%near(box_of_scene(scene), 8*5.0_wp, 10*rounding, 'box with a segment upright')
    scene%bodies%angle(2) = pi/4
    call add_polygon(scene%contactors, 2, 1, square, [0.0_wp, 0.0_wp])
    call set_middle(scene, 0.0_wp)
    call t%near(box_of_scene(scene), (7 + sqrt(2.0_wp))*5, 10*rounding, 'box with a square on its corner')
    scene%bodies%is_grain = .false.
    measures = measures_without_contacts(scene)
    call t%near(measures%get('compactness'), 0.0_wp, 0.0_wp, 'no grain, no box')
  end subroutine test_boxes

  !> An affine velocity field gives its own gradient; rotation has no shear rate, simple shear has its own.
  subroutine test_affine_flow()
    type(scene_t) :: scene
    real(wp), parameter :: gradient(2, 2) = reshape([0.5_wp, -0.3_wp, 2.0_wp, 0.1_wp], [2, 2])
    real(wp) :: position(2, 5)
    integer :: i

    position = reshape([0.0_wp, 0.0_wp, 2.0_wp, 0.3_wp, 1.0_wp, 2.5_wp, -1.5_wp, 4.0_wp, 9.0_wp, 9.0_wp], [2, 5])
    scene = disks(position)
    call make_wall(scene, 5)
    do i = 1, 4
      scene%bodies%velocity(1:2, i) = [5.0_wp, 7.0_wp] + matmul(gradient, position(:, i))
    end do
    call t%near(shear_rate_of(scene), hypot(0.4_wp, 1.7_wp), rounding, 'shear rate of an affine flow')
    scene%bodies%velocity(1:2, :4) = matmul(reshape([0.0_wp, 0.0_wp, 3.0_wp, 0.0_wp], [2, 2]), position(:, :4))
    call t%near(shear_rate_of(scene), 3.0_wp, rounding, 'rate of a simple shear')
    scene%bodies%velocity(1:2, :4) = matmul(reshape([0.0_wp, 1.0_wp, -1.0_wp, 0.0_wp], [2, 2]), position(:, :4))
    call t%near(shear_rate_of(scene), 0.0_wp, rounding, 'rotation is no shear')
    call test_inertia_number(scene, position(:, :4))
    scene%bodies%position(2, :) = 1
    call t%near(shear_rate_of(scene), 0.0_wp, 0.0_wp, 'grains on a line have no gradient')
  end subroutine test_affine_flow

  !> Shear rate of a scene without contacts [1/s].
  real(wp) function shear_rate_of(scene) result(rate)
    type(scene_t), intent(in) :: scene
    type(measures_t) :: measures

    measures = measures_without_contacts(scene)
    rate = measures%get('shear_rate')
  end function shear_rate_of

  !> Grains of 2 kg that shear by 3 per second: I = 3 sqrt(2/p), and zero where contacts pull.
  subroutine test_inertia_number(scene, position)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: position(:, :)
    type(contacts_t) :: contacts
    type(measures_t) :: measures

    scene%bodies%velocity(1:2, :4) = matmul(reshape([0.0_wp, 0.0_wp, 3.0_wp, 0.0_wp], [2, 2]), position)
    call set_middle(scene, 0.0_wp)
    call touch(contacts, 2, 1, [1.0_wp, 0.0_wp], [1.0_wp, 0.0_wp], 0.0_wp, [1.0_wp, 0.0_wp])
    measures = measures_of(scene, contacts, 0.1_wp)
    call t%check(measures%get('pressure') > 0.01_wp, 'a contact presses')
    call t%near(measures%get('inertia_number'), 3*sqrt(2/measures%get('pressure')), rounding*100, 'inertia number')
    contacts%impulse(1, 1) = -1
    measures = measures_of(scene, contacts, 0.1_wp)
    call t%near(measures%get('inertia_number'), 0.0_wp, 0.0_wp, 'no pressure, no inertia number')
  end subroutine test_inertia_number

  !> Two disks pressed between two walls by 10 N: sigma_xx = 10 N over the height; a floor under weight.
  subroutine test_pressed_contact()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(measures_t) :: measures
    real(wp) :: stress(2, 2)
    real(wp), parameter :: h = 0.5_wp

    scene = disks(reshape([-1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, -3.0_wp, 0.0_wp, 3.0_wp, 0.0_wp], [2, 4]))
    call make_wall(scene, 3)
    call make_wall(scene, 4)
    call touch(contacts, 1, 2, [-1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], 0.0_wp, [5.0_wp, 0.0_wp])
    call touch(contacts, 1, 3, [1.0_wp, 0.0_wp], [-2.0_wp, 0.0_wp], 0.0_wp, [5.0_wp, 0.0_wp])
    call touch(contacts, 4, 2, [1.0_wp, 0.0_wp], [2.0_wp, 0.0_wp], 0.0_wp, [5.0_wp, 0.0_wp])
    stress = mean_stress(scene, contacts, h)
    call t%near(norm2(stress - reshape([5.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], [2, 2])), 0.0_wp, rounding, '10 N over a height of 2 m')
    scene%gravity(:2) = [5.0_wp, 0.0_wp]
    measures = measures_of(scene, contacts, h)
    call t%near(measures%get('floor_share'), 0.0_wp, rounding, 'two walls that push alike carry nothing')
    contacts%impulse(1, 2) = 0
    ! The right wall carries 10 N of a weight of 4 kg times 5 m/s2.
    measures = measures_of(scene, contacts, h)
    call t%near(measures%get('floor_share'), 0.5_wp, rounding, 'one wall carries half of the weight')
    scene%gravity = 0
    measures = measures_of(scene, contacts, h)
    call t%near(measures%get('floor_share'), 0.0_wp, 0.0_wp, 'no weight, no share')
    contacts%impulse(:, 1) = [0.0_wp, 3.0_wp]
    contacts%n = 1
    stress = mean_stress(scene, contacts, h)
    ! t = (n_y, -n_x) = (0, 1): force (0, 6) N on the left disk, branch (-2, 0), over a box of 4 m by 2 m.
    call t%near(stress(2, 1), -1.5_wp, rounding, 'shear stress: force along y, branch along x')
    scene%contactors%n = 0
    call t%near(norm2(mean_stress(scene, contacts, h)), 0.0_wp, 0.0_wp, 'no area, no stress')
  end subroutine test_pressed_contact

  !> Through the period the branch is the short one.
  subroutine test_periodic_stress()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    real(wp) :: stress(2, 2)

    scene = disks(reshape([1.0_wp, 0.0_wp, 9.0_wp, 0.0_wp], [2, 2]))
    scene%period = 10
    ! The antagonist at x = 9 is seen at x = -1.
    ! A gap changes nothing: the branch leads from centre to centre.
    call touch(contacts, 1, 2, [1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], 0.1_wp, [4.0_wp, 0.0_wp])
    contacts%image(1) = -1_i1
    stress = mean_stress(scene, contacts, 1.0_wp)
    call t%near(stress(1, 1), 4*2.0_wp/20, rounding, 'stress through the period')
  end subroutine test_periodic_stress

  subroutine test_totals()
    type(totals_t) :: totals, copy
    type(report_t) :: report
    real(wp) :: nan

    report%sweeps = 30
    report%contact_updates = 3000000000_i8
    report%e8 = 1e-3_wp
    report%active_contacts = 80
    report%bytes_per_contact = 320
    call totals%add(report, 120)
    report%is_converged = .false.
    report%e8 = 1e-5_wp
    call totals%add(report, 100)
    totals%phase(phase_solve)%cpu = 1.5_wp
    totals%clock%wall = 7
    totals%penetration_at%step = 2
    totals%violation_at%place = [1.5_wp, -2.0_wp, 3.0_wp]
    totals%violation_at%bodies = [7, 2**30]
    call t%equal(totals%steps, 2, 'steps')
    call t%equal(totals%unconverged_steps, 1, 'unconverged steps')
    call t%check(totals%sweeps == 60_i8 .and. totals%contact_updates == 6000000000_i8, 'sums pass 2^31')
    call t%equal(totals%most_contacts, 120, 'most contacts')
    call t%near(totals%worst_e8, 1e-3_wp, 0.0_wp, 'worst error')
    call copy%unpack(totals%pack())
    call t%check(all(abs(copy%pack() - totals%pack()) <= 0), 'totals survive a restart')
    call t%check(copy%contact_updates == 6000000000_i8, 'so do large counters')
    call t%equal(copy%penetration_at%step, 2, 'and the step of the deepest penetration')
    call t%equal(copy%violation_at%bodies(2), 2**30, 'and the bodies of the largest violation')
    call t%near(copy%phase(phase_solve)%cpu, 1.5_wp, 0.0_wp, 'and timers')
    call t%near(copy%clock%wall, 7.0_wp, 0.0_wp, 'and the clock')
    nan = ieee_value(nan, ieee_quiet_nan)
    report%e8 = nan
    call totals%add(report, 1)
    report%e8 = 1
    call totals%add(report, 1)
    call t%check(ieee_is_nan(totals%worst_e8), 'an error that is not a number stays the worst')
    call t%equal(size(totals%phase), n_phases, 'a stopwatch a phase')
  end subroutine test_totals
end program test_monitors
