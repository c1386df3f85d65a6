!> The energy balance against closed forms: a bounce, a shaken cluster, a pushed wall, a wide gap.
program test_energy
  use harness, only: tests_t
  use made_by_hand, only: disks, make_wall, set_middle, touch
  use resultants, only: add_resultants
  use sg_body_energy, only: kinetic_energy, potential_energy
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_energy, only: energy_t
  use sg_kinds, only: wp, i1
  use sg_measures, only: measure, measures_t
  use sg_random, only: random_t
  use sg_scene, only: scene_t
  implicit none
  ! Closed forms of a few operations: a few roundings of numbers of order one to ten.
  real(wp), parameter :: rounding = 1e-13_wp
  !> Lever arms of any direction
  real(wp), parameter :: no_radii(0) = 0
  type(tests_t) :: t

  call test_bounce()
  call test_energy_of_a_shaken_cluster()
  call test_energy_of_a_pushed_wall()
  call test_energy_across_a_gap()
  call test_energy_at_rest()
  call t%finish()

contains

  !> How far the balance of a scene without links is from closing.
  real(wp) function closure_of(energy, scene) result(closure)
    type(energy_t), intent(in) :: energy
    type(scene_t), intent(in) :: scene
    type(contacts_t) :: contacts
    type(measures_t) :: measures

    call reserve_contacts(contacts, 1)
    call measure(scene, contacts, 0.01_wp, energy, measures)
    closure = measures%get('energy_closure')
  end function closure_of

  !> Velocities of the end of the step by the scheme's own equation; driven components keep `free_velocity`.
  subroutine end_step(scene, contacts, h)
    type(scene_t), intent(inout) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in) :: h
    real(wp) :: resultant(3, scene%bodies%n)

    resultant = 0
    call add_resultants(contacts, scene%bodies%middle, scene%period, resultant)
    associate (b => scene%bodies)
      where (b%inverse_mass > 0) b%free_velocity = b%velocity + b%inverse_mass*(h*b%force + resultant)
    end associate
  end subroutine end_step

  !> Update with theta = 1/2.
  subroutine update(scene, h)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: h

    associate (b => scene%bodies)
      b%position = b%position + h/2*(b%velocity(1:2, :) + b%free_velocity(1:2, :))
      b%angle = b%angle + h/2*(b%velocity(3, :) + b%free_velocity(3, :))
      b%velocity = b%free_velocity
    end associate
  end subroutine update

  !> A disk of mass 2 falls at 3 m/s on a floor and leaves at 1 m/s: the impact takes 2 (9 - 1)/2 = 8 J.
  subroutine test_bounce()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(energy_t) :: energy, by_radii
    real(wp), parameter :: h = 0.01_wp

    scene = disks(reshape([0.0_wp, 1.0_wp, 0.0_wp, -1.0_wp], [2, 2]))
    call make_wall(scene, 2)
    scene%bodies%velocity(1:2, 1) = [2.0_wp, -3.0_wp]
    ! Friction brings the sliding velocity of the point from 2 to 1.7 and starts a spin.
    call touch(contacts, 1, 2, [0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp], 0.0_wp, [8.0_wp, -0.2_wp])
    call end_step(scene, contacts, h)
    call energy%add_step(scene, contacts, h, no_radii)
    call by_radii%add_step(scene, contacts, h, [1.0_wp, 0.0_wp])
    call t%near(maxval(abs(by_radii%pack() - energy%pack())), 0.0_wp, rounding, 'works with lever arms that are radii')
    call update(scene, h)
    call t%near(scene%bodies%velocity(2, 1), 1.0_wp, rounding, 'velocity after the bounce')
    call t%near(energy%impact_loss, 8.0_wp, rounding, 'impact loss of a bounce')
    ! Point's velocity along t = (1, 0): 2 before; after, 2 - 0.1 with a spin of 0.2 rad/s on a radius of 1.
    call t%near(energy%friction_loss, 0.2_wp*(2.0_wp + 1.7_wp)/2, rounding, 'friction loss of a bounce')
    call t%near(kinetic_energy(scene%bodies), 1.0_wp + 1.9_wp**2 + 0.02_wp, rounding, 'kinetic energy after the bounce')
    call t%near(energy%external_work, 0.0_wp, rounding, 'nothing pushes')
    call t%near(closure_of(energy, scene), 0.0_wp, rounding, 'balance of a bounce')
    energy%friction_loss = energy%friction_loss + 0.1_wp
    call t%near(closure_of(energy, scene), 0.1_wp/13, rounding, 'an error of 0.1 J is seen over the largest term, 13 J')
  end subroutine test_bounce

  !> Two disks in gravity with random impulses, forces and a driven spin: the balance closes whatever they are.
  subroutine test_energy_of_a_shaken_cluster()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(energy_t) :: energy
    type(random_t) :: random
    real(wp), parameter :: h = 0.02_wp
    integer :: step, i

    scene = disks(reshape([0.1_wp, 3.0_wp, 0.2_wp, 1.0_wp, 1.9_wp, 2.0_wp], [2, 3]))
    scene%gravity(:2) = [1.0_wp, -9.81_wp]
    scene%period = 10
    scene%bodies%inverse_mass(3, 2) = 0
    call random%seed(3)
    do step = 1, 50
      call set_middle(scene, h)
      contacts%n = 0
      call touch(contacts, 1, 2, [0.6_wp, 0.8_wp], scene%bodies%middle(1:2, 2) + [0.6_wp, 0.8_wp], 0.0_wp, &
                 [random%uniform(), random%uniform(-1.0_wp, 1.0_wp)])
      call touch(contacts, 3, 2, [0.8_wp, 0.6_wp], scene%bodies%middle(1:2, 2) + [0.8_wp, 0.6_wp], 0.0_wp, &
                 [random%uniform(), random%uniform(-1.0_wp, 1.0_wp)])
      contacts%image(2) = 1_i1
      do i = 1, 3
        scene%bodies%force(:, i) = 2*scene%gravity + [random%uniform(), random%uniform(), random%uniform()]
      end do
      scene%bodies%free_velocity(3, 2) = random%uniform(-1.0_wp, 1.0_wp)
      call end_step(scene, contacts, h)
      call energy%add_step(scene, contacts, h, no_radii)
      call update(scene, h)
      ! A wrapped position with its crossing is the same unwrapped one.
      scene%bodies%position(1, 1) = scene%bodies%position(1, 1) - scene%period
      scene%bodies%crossings(1) = scene%bodies%crossings(1) + 1
    end do
    call t%check(abs(energy%drive_work) > 0.01_wp .and. abs(energy%external_work) > 0.1_wp, 'drive and forces work')
    call t%near(closure_of(energy, scene), 0.0_wp, rounding, 'balance over 50 steps')
  end subroutine test_energy_of_a_shaken_cluster

  !> A wall driven at 2 m/s pushes a disk at rest to 2 m/s: the drive gives m v v = 8 J, half of it is lost.
  subroutine test_energy_of_a_pushed_wall()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(energy_t) :: energy
    real(wp), parameter :: h = 0.01_wp

    scene = disks(reshape([0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp], [2, 2]))
    call make_wall(scene, 1)
    scene%bodies%velocity(1, 1) = 2
    scene%bodies%free_velocity(1, 1) = 2
    call touch(contacts, 1, 2, [-1.0_wp, 0.0_wp], [1.0_wp, 0.0_wp], 0.0_wp, [4.0_wp, 0.0_wp])
    call end_step(scene, contacts, h)
    call energy%add_step(scene, contacts, h, no_radii)
    call update(scene, h)
    call t%near(energy%drive_work, 8.0_wp, rounding, 'work of the drive')
    call t%near(energy%impact_loss, 4.0_wp, rounding, 'loss of the push')
    call t%near(closure_of(energy, scene), 0.0_wp, rounding, 'balance of the push')
    call test_energy_pack(energy)
  end subroutine test_energy_of_a_pushed_wall

  !> Two disks with a wide gap: lever arms are radii, and the balance closes all the same.
  subroutine test_energy_across_a_gap()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(energy_t) :: energy
    real(wp), parameter :: h = 0.01_wp, gap = 0.4_wp, tangential = 3
    integer :: b

    scene = disks(reshape([0.0_wp, 2 + gap, 0.0_wp, 0.0_wp], [2, 2]))
    scene%bodies%velocity(3, :) = [5.0_wp, -1.0_wp]
    call set_middle(scene, 0.0_wp)
    call touch(contacts, 1, 2, [0.0_wp, 1.0_wp], [0.0_wp, 1 + gap/2], gap, [1.0_wp, tangential])
    call end_step(scene, contacts, h)
    do b = 1, 2
      ! On a disk of unit radius and inertia; the tangential impulse turns both disks the same way.
      scene%bodies%free_velocity(3, b) = scene%bodies%velocity(3, b) + tangential
    end do
    call energy%add_step(scene, contacts, h, no_radii)
    call update(scene, h)
    call t%near(closure_of(energy, scene), 0.0_wp, rounding, 'balance across a gap')
  end subroutine test_energy_across_a_gap

  !> Packed and unpacked, the sums are the same to the last bit.
  subroutine test_energy_pack(energy)
    type(energy_t), intent(in) :: energy
    type(energy_t) :: copy

    call copy%unpack(energy%pack())
    call t%check(copy%is_started .and. all(abs(copy%pack() - energy%pack()) <= 0), 'energy sums survive a restart')
    call t%near(copy%drive_work, energy%drive_work, 0.0_wp, 'each in its place')
  end subroutine test_energy_pack

  !> Nothing moves, nothing weighs: no division by zero; and at rest under gravity far from the origin.
  subroutine test_energy_at_rest()
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(energy_t) :: energy
    type(measures_t) :: measures

    scene = disks(reshape([0.0_wp, 0.0_wp], [2, 1]))
    call t%near(closure_of(energy, scene), 0.0_wp, 0.0_wp, 'no balance before the first step')
    call energy%add_step(scene, contacts, 0.1_wp, no_radii)
    call t%near(closure_of(energy, scene), 0.0_wp, 0.0_wp, 'an empty balance is closed')
    scene%gravity(:2) = [0.0_wp, -10.0_wp]
    scene%bodies%position(2, 1) = 1000
    call t%near(potential_energy(scene), 20000.0_wp, 1e-10_wp, 'potential energy m g y')
    call energy%add_step(scene, contacts, 0.1_wp, no_radii)
    call reserve_contacts(contacts, 1)
    call measure(scene, contacts, 0.1_wp, energy, measures)
    call t%near(measures%get('potential_energy'), 20000.0_wp, 1e-10_wp, 'a measure by its name')
    call t%near(measures%get('inertia_number'), 0.0_wp, 0.0_wp, 'one grain has no inertia number')
  end subroutine test_energy_at_rest
end program test_energy
