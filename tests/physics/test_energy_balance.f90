!> The energy balance of whole runs closes to rounding at theta = 1/2, whatever the solver left undone.
!!
!! Grains fall into a shaken box: disks alone (lever arms along normals), and disks with squares (any lever arms). The
!! sums are packed and unpacked half-way, as a restart does.
program test_energy_balance
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use sg_advance, only: advance
  use sg_contactors, only: add_disk, add_polygon, add_segment
  use sg_energy, only: energy_t
  use sg_error, only: error_t
  use sg_kinds, only: wp, pi
  use sg_measures, only: measure, measures_t
  use sg_random, only: random_t
  use sg_scene, only: colour_index, scene_t
  use sg_simulation, only: simulation_t, start_simulation
  implicit none
  integer, parameter :: rows = 6, grains = rows**2, steps = 600
  ! Rounding of some 10^2 sums a step over 600 steps, terms of either sign: 1e-14 measured.
  real(wp), parameter :: rounding = 1e-12_wp
  type(tests_t) :: t

  call test_box(with_squares=.false., name='disks')
  call test_box(with_squares=.true., name='disks and squares')
  call t%finish()

contains

  !> Run a box and look at its balance.
  subroutine test_box(with_squares, name)
    logical, intent(in) :: with_squares
    character(len=*), intent(in) :: name
    type(simulation_t), pointer :: sim
    type(error_t), allocatable :: error
    type(measures_t) :: measures
    type(energy_t) :: restored
    integer :: step

    sim => fresh()
    call make_box(sim%scene, with_squares)
    sim%options%time_step = 1e-3_wp
    sim%options%steps = steps
    ! Few sweeps and a tolerance far away: the balance holds for a solution that is not converged, too.
    sim%options%solver%maximum_sweeps = 20
    call start_simulation(sim)
    do step = 1, steps
      call advance(sim, error)
      if (allocated(error)) exit
      if (step /= steps/2) cycle
      call restored%unpack(sim%energy%pack())
      sim%energy = restored
    end do
    call t%check(.not. allocated(error), name//': the run ends')
    call measure(sim%scene, sim%contacts, sim%options%time_step, sim%energy, measures)
    call t%near(measures%get('energy_closure'), 0.0_wp, rounding, name//': the balance closes')
    call t%check(min(measures%get('friction_loss'), measures%get('impact_loss')) > 0.01_wp*measures%get('kinetic_energy'), &
                 name//': contacts take energy')
    call t%check(abs(measures%get('drive_work')) > 0.001_wp*measures%get('kinetic_energy'), name//': drives work')
    call t%equal(sim%totals%steps, steps, name//': all steps are counted')
  end subroutine test_box

  !> Grains of random radii, velocities and spins above a floor and between two walls, all three shaken.
  subroutine make_box(scene, with_squares)
    type(scene_t), intent(inout) :: scene
    logical, intent(in) :: with_squares
    real(wp), parameter :: square(2, 4) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])
    type(random_t) :: random
    real(wp) :: radius, middle
    integer :: b, i, colour

    call random%seed(1)
    call scene%bodies%allocate(grains + 3)
    call colour_index(scene, 'any', colour)
    do b = 1, grains
      radius = random%uniform(0.3_wp, 0.5_wp)
      scene%bodies%position(:, b) = [1.1_wp*real(modulo(b - 1, rows) + 1, wp), 1.1_wp*real((b - 1)/rows + 1, wp)]
      scene%bodies%velocity(:, b) = [random%uniform(-1.0_wp, 1.0_wp), random%uniform(-3.0_wp, 1.0_wp), &
                                     random%uniform(-1.0_wp, 1.0_wp)]
      if (with_squares .and. modulo(b, 2) == 0) then
        call add_polygon(scene%contactors, b, colour, radius/sqrt(2.0_wp)*square, [0.0_wp, 0.0_wp])
      else
        call add_disk(scene%contactors, b, colour, radius, [0.0_wp, 0.0_wp])
      end if
      call set_mass(scene, b, radius)
    end do
    middle = 1.1_wp*real(rows + 1, wp)/2
    call add_side(scene, grains + 1, colour, [middle, 0.0_wp], 0.0_wp)
    call add_side(scene, grains + 2, colour, [0.0_wp, middle], pi/2)
    call add_side(scene, grains + 3, colour, [2*middle, middle], pi/2)
    allocate (scene%laws(1), scene%sees(1), scene%drives(9), scene%pressures(0))
    scene%laws(1)%name = 'friction'
    scene%laws(1)%static_friction = 0.4_wp
    scene%laws(1)%dynamic_friction = 0.4_wp
    scene%sees(1)%law = 1
    scene%sees(1)%alert = 0.02_wp
    do i = 1, 9
      scene%drives(i)%body = grains + (i + 2)/3
      scene%drives(i)%component = modulo(i - 1, 3) + 1
      if (modulo(i, 3) > 0) scene%drives(i)%value%amplitude = 0.2_wp
      scene%drives(i)%value%omega = 5.0_wp + real(i, wp)
    end do
    scene%gravity(:2) = [0.5_wp, -9.81_wp]
  end subroutine make_box

  !> Mass and inertia of a disk of density 1000.
  subroutine set_mass(scene, body, radius)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body
    real(wp), intent(in) :: radius

    associate (b => scene%bodies)
      b%area(body) = pi*radius**2
      b%mass(body) = 1000*b%area(body)
      b%inertia(body) = b%mass(body)*radius**2/2
      b%inverse_mass(:, body) = [1/b%mass(body), 1/b%mass(body), 1/b%inertia(body)]
    end associate
  end subroutine set_mass

  !> A long side of the box.
  subroutine add_side(scene, body, colour, centre, angle)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body, colour
    real(wp), intent(in) :: centre(2), angle

    call add_segment(scene%contactors, body, colour, 10.0_wp, 0.1_wp, [0.0_wp, 0.0_wp], angle)
    call set_mass(scene, body, 1.0_wp)
    scene%bodies%position(:, body) = centre
    scene%bodies%is_grain(body) = .false.
  end subroutine add_side
end program test_energy_balance
