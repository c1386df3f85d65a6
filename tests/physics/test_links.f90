!> Links with known answers: a mass on a rod, its damping, a wire that goes slack and taut, a pendulum, a hanging chain, a wire
!! that breaks; in the plane and in space, across a period too.
program test_links
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use link_scenes, only: begin_links, link, put_mass, tension_of
  use scenes, only: begin_run, g, run
  use sg_contactors, only: add_disk
  use sg_checkpoint, only: load_checkpoint, save_checkpoint
  use sg_error, only: diagnostics_t, error_t
  use sg_hdf5, only: hdf5_is_available
  use sg_kinds, only: wp, pi
  use sg_measures, only: measure, measures_t
  use sg_laws, only: law_bond, law_linear, law_rigid_wire, law_rod, law_t, law_wire, status_broken
  use sg_simulation, only: simulation_t
  use sg_space_contactors, only: add_sphere
  use sg_system, only: make_folder
  implicit none
  type(tests_t) :: t
  integer :: dimension

  do dimension = 2, 3
    call test_rod(dimension, 0.0_wp)
    call test_rod(dimension, 30.0_wp)
    call test_slack_wire(dimension)
    call test_pendulum(dimension)
    call test_chain(dimension)
    call test_break(dimension)
    call test_glue(dimension)
    call test_period(dimension)
    call test_energy(dimension)
    if (dimension == 2) call test_ring()
    if (hdf5_is_available()) then
      call test_restart(dimension, law_t(kind=law_wire, axial_stiffness=500.0_wp, axial_damping=3.0_wp, breaking_force=30.0_wp))
      call test_restart(dimension, law_t(kind=law_bond, young=1e6_wp, poisson=0.2_wp, normal_strength=5e2_wp, &
                                         tangential_strength=1e6_wp))
    end if
    call test_bond(dimension, axis=1)
    call test_bond(dimension, axis=dimension)
  end do
  call t%finish()

contains

  !> Unit vector along the first axis.
  pure function along(dimension, axis) result(vector)
    integer, intent(in) :: dimension, axis
    real(wp) :: vector(dimension)

    vector = 0
    vector(axis) = 1
  end function along

  !> A closed chain of rods under pressure from outside, and from inside: a regular polygon at rest, whose rods carry the pressure
  !! times the apothem, N = p R cos(pi/n), to the last digit; turned and moved too, for the pressure follows it.
  subroutine test_ring()
    integer, parameter :: n = 9
    real(wp), parameter :: pressure = 700, radius = 0.4_wp, stiffness = 1e4_wp
    type(simulation_t), pointer :: sim
    real(wp) :: place(2, n), force, side, moved, miss, middle(2), angle
    integer :: i, sense

    sim => fresh()
    do sense = -1, 1, 2
      force = real(sense, wp)*pressure*radius*cos(pi/real(n, wp))
      side = 2*radius*sin(pi/real(n, wp))
      call begin_links(sim%scene, n, 2, law_t(kind=law_rod, axial_stiffness=stiffness))
      deallocate (sim%scene%pressures)
      allocate (sim%scene%pressures(n))
      do i = 1, n
        angle = 2*pi*real(i, wp)/real(n, wp) + 0.3_wp
        place(:, i) = radius*[cos(angle), sin(angle)]
        call put_mass(sim%scene, i, 1.5_wp, place(:, i))
        sim%scene%bodies%velocity(1, i) = 0.25_wp
        sim%scene%pressures(i)%body = i
        sim%scene%pressures(i)%chain = [modulo(i - 2, n) + 1, modulo(i, n) + 1]
        sim%scene%pressures(i)%value%constant = real(sense, wp)*pressure
      end do
      do i = 1, n
        ! Under compression a rod is shorter than at rest: N = k (1 - L/l0).
        call link(sim%scene, i, modulo(i, n) + 1, side/(1 - force/stiffness))
      end do
      call begin_run(sim, 1e-3_wp, 1e-13_wp)
      call run(sim, 40)
      miss = maxval([(abs(tension_of(sim, i) + force), i=1, n)])
      middle = sum(sim%scene%bodies%position, 2)/real(n, wp)
      moved = maxval([(abs(norm2(sim%scene%bodies%position(:, i) - middle) - radius), i=1, n)])
      call t%near(miss, 0.0_wp, 1e-6_wp, 'ring: the force of the rods is pressure times apothem')
      call t%near(moved, 0.0_wp, 1e-9_wp, 'ring: it keeps its shape')
      call t%near(middle(1), 0.01_wp, 1e-9_wp, 'ring: its pressure pushes it nowhere')
    end do
  end subroutine test_ring

  !> A mass on a rod: each step against the recursion of the scheme, and the period of the oscillation.
  !!
  !! The force is that of the length L + h u at the end of a step from the length L in its middle; the mass begins at rest,
  !! stretched beyond the strain at rest.
  subroutine test_rod(dimension, damping)
    integer, intent(in) :: dimension
    real(wp), intent(in) :: damping
    real(wp), parameter :: stiffness = 400, mass = 4, rest = 0.5_wp, h = 1e-4_wp, strain = 0.02_wp
    type(simulation_t), pointer :: sim
    real(wp) :: x, v, force, expected, miss, turn(2)
    integer :: step, turns

    sim => fresh()
    call begin_links(sim%scene, 2, dimension, law_t(kind=law_rod, axial_stiffness=stiffness, axial_damping=damping, &
                                                    prestrain=strain))
    call put_mass(sim%scene, 1, 0.0_wp, 0*along(dimension, 1))
    call put_mass(sim%scene, 2, mass, 0.6_wp*along(dimension, 1))
    call link(sim%scene, 1, 2, rest)
    call begin_run(sim, h, 1e-13_wp)
    x = 0.6_wp
    v = 0
    miss = 0
    turns = 0
    do step = 1, 12000
      call run(sim, 1)
      force = -(stiffness*(x + h/2*v - (1 + strain)*rest)/rest + (stiffness*h + damping)/rest*v) &
              /(1 + h/mass*(stiffness*h + damping)/rest)
      x = x + h*v/2
      if (v < 0 .and. v + h/mass*force >= 0 .and. turns < 2) then
        turns = turns + 1
        turn(turns) = h*real(step, wp)
      end if
      v = v + h/mass*force
      x = x + h*v/2
      miss = max(miss, abs(sim%scene%bodies%position(1, 2) - x), abs(tension_of(sim, 1) + force)/stiffness)
    end do
    ! Rounding of a few operations, which an oscillator does not amplify, over 12000 steps.
    call t%near(miss, 0.0_wp, 1e-10_wp, 'rod: place and force as the recursion has them')
    expected = 2*pi/sqrt(stiffness/(rest*mass) - (damping/(rest*mass)/2)**2)
    ! The scheme is of first order: its frequency is off by less than omega h of it; a turn is seen a step late at most.
    if (turns == 2) call t%near(turn(2) - turn(1), expected, (2 + 2*pi)*h, 'rod: period of the oscillation')
    call t%equal(turns, 2, 'rod: it oscillates')
    call t%near(maxval(abs(sim%scene%bodies%position(2:, 2))), 0.0_wp, 0.0_wp, 'rod: nothing moves across')
  end subroutine test_rod

  !> A mass thrown from its anchor flies free while the wire is slack, is stopped where it is taut, and hangs there.
  subroutine test_slack_wire(dimension)
    integer, intent(in) :: dimension
    real(wp), parameter :: h = 1e-3_wp, length = 0.3_wp
    type(simulation_t), pointer :: sim
    integer :: step, taut

    sim => fresh()
    call begin_links(sim%scene, 2, dimension, law_t(kind=law_rigid_wire))
    sim%scene%gravity(dimension) = -g
    call put_mass(sim%scene, 1, 0.0_wp, 0*along(dimension, 1))
    call put_mass(sim%scene, 2, 2.0_wp, -0.1_wp*along(dimension, dimension))
    call link(sim%scene, 1, 2, length)
    call begin_run(sim, h, 1e-13_wp)
    taut = 0
    do step = 1, 400
      call run(sim, 1)
      if (taut == 0 .and. tension_of(sim, 1) > 0) taut = step
      if (taut == 0) call t%near(sim%scene%bodies%velocity(dimension, 2), -g*h*real(step, wp), 1e-12_wp, 'wire: free fall')
    end do
    ! It falls 0.2 m in sqrt(2 0.2/g) = 0.202 s; the step in which it comes taut is seen in the middle of it.
    call t%near(real(taut, wp)*h, sqrt(0.4_wp/g), 2*h, 'wire: when it comes taut')
    call t%near(-sim%scene%bodies%position(dimension, 2), length, 1e-12_wp + h*h*g, 'wire: as long as it is')
    call t%near(norm2(sim%scene%bodies%velocity(:, 2)), 0.0_wp, 1e-12_wp, 'wire: it stops the mass')
    call t%near(tension_of(sim, 1), 2*g, 1e-10_wp, 'wire: it carries the weight')
  end subroutine test_slack_wire

  !> Period of a pendulum on a wire that does not stretch, for a small swing.
  subroutine test_pendulum(dimension)
    integer, intent(in) :: dimension
    real(wp), parameter :: h = 5e-4_wp, length = 0.5_wp, swing = 0.05_wp
    type(simulation_t), pointer :: sim
    real(wp) :: before, crossing(2)
    integer :: step, crossings

    sim => fresh()
    call begin_links(sim%scene, 2, dimension, law_t(kind=law_rigid_wire))
    sim%scene%gravity(dimension) = -g
    call put_mass(sim%scene, 1, 0.0_wp, 0*along(dimension, 1))
    call put_mass(sim%scene, 2, 3.0_wp, length*(sin(swing)*along(dimension, 1) - cos(swing)*along(dimension, dimension)))
    call link(sim%scene, 1, 2, length)
    call begin_run(sim, h, 1e-13_wp)
    crossings = 0
    do step = 1, 4000
      before = sim%scene%bodies%position(1, 2)
      call run(sim, 1)
      if (before <= 0 .or. sim%scene%bodies%position(1, 2) > 0) cycle
      crossings = crossings + 1
      crossing(min(crossings, 2)) = sim%time() - h*sim%scene%bodies%position(1, 2)/(sim%scene%bodies%position(1, 2) - before)
      if (crossings == 2) exit
    end do
    call t%equal(crossings, 2, 'pendulum: it swings')
    ! The swing lengthens the period by swing^2/16 = 1.6e-4 of it, the scheme by less than omega h/2 = 1.1e-3.
    call t%near(crossing(2) - crossing(1), 2*pi*sqrt(length/g), 2e-3_wp*2*pi*sqrt(length/g), 'pendulum: its period')
  end subroutine test_pendulum

  !> A chain that hangs as its forces ask stays so: the horizontal pull is one all along, the vertical one grows by the weights.
  subroutine test_chain(dimension)
    integer, intent(in) :: dimension
    integer, parameter :: n = 12
    real(wp), parameter :: pull = 50, weight = 2*g, stiffness = 1e5_wp, rest = 0.1_wp
    type(simulation_t), pointer :: sim
    real(wp) :: force(dimension), place(dimension, 0:n), miss, moved
    integer :: i

    sim => fresh()
    call begin_links(sim%scene, n + 1, dimension, law_t(kind=law_wire, axial_stiffness=stiffness))
    sim%scene%gravity(dimension) = -g
    place = 0
    do i = 1, n
      force = pull*along(dimension, 1) + weight*(real(i, wp) - 0.5_wp*real(n + 1, wp))*along(dimension, dimension)
      place(:, i) = place(:, i - 1) + rest*(1 + norm2(force)/stiffness)*force/norm2(force)
    end do
    do i = 0, n
      call put_mass(sim%scene, i + 1, merge(0.0_wp, weight/g, i == 0 .or. i == n), place(:, i))
    end do
    do i = 1, n
      call link(sim%scene, i, i + 1, rest)
    end do
    call begin_run(sim, 1e-3_wp, 1e-12_wp)
    call run(sim, 50)
    miss = 0
    moved = 0
    do i = 1, n
      miss = max(miss, abs(tension_of(sim, i) - hypot(pull, weight*(real(i, wp) - 0.5_wp*real(n + 1, wp)))))
      moved = max(moved, norm2(sim%scene%bodies%position(:, i) - place(:, i - 1)))
    end do
    ! The guess of the first step is no force at all; e8 <= 1e-12 of some hundred newtons, over 50 steps.
    call t%near(miss, 0.0_wp, 1e-6_wp, 'chain: tensions of the catenary')
    call t%near(moved, 0.0_wp, 1e-9_wp, 'chain: it stays where it hangs')
  end subroutine test_chain

  !> A wire that is pulled ever more breaks where its tension passes the limit, for good.
  subroutine test_break(dimension)
    integer, intent(in) :: dimension
    real(wp), parameter :: limit = 25, stiffness = 1e3_wp, h = 1e-3_wp, speed = 0.05_wp
    type(simulation_t), pointer :: sim
    integer :: step, broken, k

    sim => fresh()
    call begin_links(sim%scene, 2, dimension, law_t(kind=law_wire, axial_stiffness=stiffness, breaking_force=limit))
    call put_mass(sim%scene, 1, 0.0_wp, 0*along(dimension, 1))
    ! Heavy, so that the wire does not slow it: 25 N for a second on 10^9 kg.
    call put_mass(sim%scene, 2, 1e9_wp, along(dimension, 1))
    sim%scene%bodies%velocity(1, 2) = speed
    call link(sim%scene, 1, 2, 1.0_wp)
    call begin_run(sim, h, 1e-12_wp)
    broken = 0
    do step = 1, 1000
      call run(sim, 1)
      k = 1
      if (sim%contacts%status(k) /= status_broken) then
        ! From the length in the middle of the step to that h later.
        call t%near(tension_of(sim, 1), stiffness*speed*h*(real(step, wp) + 0.5_wp), 1e-4_wp, 'break: tension grows')
      else if (broken == 0) then
        broken = step
      else
        call t%near(tension_of(sim, 1), 0.0_wp, 0.0_wp, 'break: nothing holds any more')
      end if
    end do
    call t%near(stiffness*speed*h*real(broken, wp), limit, stiffness*speed*h, 'break: force at which it breaks')
  end subroutine test_break

  !> Two masses that a linear law without length holds together move as one.
  subroutine test_glue(dimension)
    integer, intent(in) :: dimension
    type(simulation_t), pointer :: sim

    sim => fresh()
    call begin_links(sim%scene, 2, dimension, law_t(kind=law_linear))
    sim%scene%gravity(dimension) = -g
    call put_mass(sim%scene, 1, 1.0_wp, 0*along(dimension, 1))
    call put_mass(sim%scene, 2, 3.0_wp, 0*along(dimension, 1))
    sim%scene%bodies%velocity(1, 1) = 4
    call link(sim%scene, 1, 2, 0.0_wp)
    call begin_run(sim, 1e-3_wp, 1e-13_wp)
    call run(sim, 100)
    call t%near(sim%scene%bodies%velocity(1, 1), 1.0_wp, 1e-12_wp, 'glue: common velocity')
    call t%near(maxval(abs(sim%scene%bodies%velocity(:dimension, 1) - sim%scene%bodies%velocity(:dimension, 2))), 0.0_wp, &
                1e-12_wp, 'glue: no relative velocity')
  end subroutine test_glue

  !> Two masses on a wire that fly through a period together stay linked by the same image.
  subroutine test_period(dimension)
    integer, intent(in) :: dimension
    type(simulation_t), pointer :: sim
    integer :: i

    sim => fresh()
    call begin_links(sim%scene, 3, dimension, law_t(kind=law_rod, axial_stiffness=1e4_wp))
    sim%scene%period = 2
    do i = 1, 3
      call put_mass(sim%scene, i, real(i, wp), (0.3_wp*real(i, wp) + 1)*along(dimension, 1))
      sim%scene%bodies%velocity(1, i) = 5
    end do
    ! Spheres touch nothing here, but as they move bodies are brought back into the period.
    do i = 1, 3
      if (dimension == 2) call add_disk(sim%scene%contactors, i, 1, 0.1_wp, [0.0_wp, 0.0_wp])
      if (dimension == 3) call add_sphere(sim%scene%contactors, i, 1, 0.1_wp, [0.0_wp, 0.0_wp, 0.0_wp])
    end do
    call link(sim%scene, 1, 2, 0.3_wp)
    call link(sim%scene, 2, 3, 0.3_wp)
    call begin_run(sim, 1e-3_wp, 1e-13_wp)
    call run(sim, 2000)
    call t%check(minval(sim%scene%bodies%crossings) > 3, 'period: it is crossed')
    call t%near(maxval(abs(sim%scene%bodies%velocity(1, :) - 5)), 0.0_wp, 1e-10_wp, 'period: nothing changes their velocity')
  end subroutine test_period

  !> A bond whose ends are drawn apart slowly, along it or across it: force by displacement and by speed, and where it breaks.
  subroutine test_bond(dimension, axis)
    integer, intent(in) :: dimension, axis
    real(wp), parameter :: h = 1e-3_wp, rest = 2, area = 0.03_wp, mass = 0.5_wp, young = 1e7_wp, poisson = 0.25_wp
    real(wp), parameter :: strength(2) = [2000.0_wp, 600.0_wp], speed = 1e-3_wp
    type(simulation_t), pointer :: sim
    real(wp) :: stiffness, damping, expected, limit, force
    integer :: step, broken, mode

    sim => fresh()
    mode = merge(1, 2, axis == 1)
    call begin_links(sim%scene, 2, dimension, law_t(kind=law_bond, young=young, poisson=poisson, normal_strength=strength(1), &
                                                    tangential_strength=strength(2)))
    call put_mass(sim%scene, 1, 0.0_wp, 0*along(dimension, 1))
    ! Heavy, so that the bond does not slow it: 60 N for a second on 10^9 kg.
    call put_mass(sim%scene, 2, 1e9_wp, rest*along(dimension, 1))
    sim%scene%bodies%velocity(axis, 2) = speed
    call link(sim%scene, 1, 2, rest, [area, mass])
    call begin_run(sim, h, 1e-12_wp)
    stiffness = young*area/rest/merge(1.0_wp, 2*(1 + poisson), mode == 1)
    damping = 2*sqrt(mass*stiffness)
    limit = area*strength(mode)/stiffness
    broken = 0
    do step = 1, 800
      call run(sim, 1)
      force = abs(sim%contacts%impulse(mode, 1))/h
      if (dimension == 3) force = norm2(sim%contacts%impulse(:, 1))/h
      if (sim%contacts%status(1) == status_broken) then
        if (broken == 0) broken = step
        call t%near(force, 0.0_wp, 0.0_wp, 'bond: nothing holds once it is broken')
      else
        ! Displacements count from the first detection along the bond, from the beginning of the step across it: both end with it.
        expected = stiffness*speed*h*real(step, wp) + damping*speed
        ! Slow ends: what a turned bond does in the other direction is x/rest = 4e-4 of the force, and grows it by its square.
        call t%near(force, expected, 1e-3_wp*expected, 'bond: force')
      end if
    end do
    call t%near(speed*h*real(broken, wp), limit, 2*speed*h, 'bond: displacement at which it breaks')
  end subroutine test_bond

  !> A mass on a damped rod under its weight: potential and elastic energy, what the dashpot takes, and the balance that closes.
  subroutine test_energy(dimension)
    integer, intent(in) :: dimension
    real(wp), parameter :: stiffness = 2e3_wp, damping = 40, mass = 4, rest = 0.5_wp, h = 1e-4_wp
    type(simulation_t), pointer :: sim
    type(measures_t) :: measures
    real(wp) :: sag, scale
    integer :: step

    sim => fresh()
    call begin_links(sim%scene, 2, dimension, law_t(kind=law_rod, axial_stiffness=stiffness, axial_damping=damping))
    sim%scene%gravity(dimension) = -g
    call put_mass(sim%scene, 1, 0.0_wp, 0*along(dimension, 1))
    call put_mass(sim%scene, 2, mass, -0.55_wp*along(dimension, dimension))
    call link(sim%scene, 1, 2, rest)
    call begin_run(sim, h, 1e-13_wp)
    scale = mass*g*0.1_wp
    do step = 1, 30000
      call run(sim, 1)
      if (mod(step, 3000) /= 1) cycle
      call measure(sim%scene, sim%contacts, h, sim%energy, measures)
      ! Rounding of 30000 steps, each of a few times 1e-16 of the energies.
      call t%near(measures%get('energy_closure'), 0.0_wp, 1e-10_wp, 'energy: the balance closes')
      call t%check(measures%get('impact_loss') >= -1e-12_wp*scale, 'energy: the dashpot gives nothing back')
    end do
    ! At rest after 3 s, which are 20 times 2 mass rest/damping = 0.1 s of decay; the sag is weight over stiffness.
    sag = mass*g*rest/stiffness
    call t%near(measures%get('kinetic_energy'), 0.0_wp, 1e-12_wp*scale, 'energy: at rest')
    call t%near(measures%get('potential_energy'), -mass*g*(rest + sag) + stiffness/rest*sag**2/2, 1e-9_wp*scale, &
                'energy: of weight and of the rod')
    call t%near(measures%get('impact_loss'), stiffness/rest*(0.05_wp**2 - sag**2)/2 - mass*g*(0.05_wp - sag), 1e-9_wp*scale, &
                'energy: all that the dashpot took')
  end subroutine test_energy

  !> A run that goes on from a checkpoint is the straight run, bit by bit, with links that have broken and others that hold.
  subroutine test_restart(dimension, law)
    integer, intent(in) :: dimension
    type(law_t), intent(in) :: law
    character(len=*), parameter :: folder = 'links_restart'
    type(simulation_t), pointer :: straight, first, second
    type(error_t), allocatable :: error
    type(diagnostics_t) :: warnings

    straight => fresh()
    first => fresh()
    second => fresh()
    call t%check(make_folder(folder), 'restart: the folder is there')
    call make_row(dimension, law, folder, straight)
    call run(straight, 300)
    associate (status => straight%contacts%status(:straight%contacts%n))
      call t%check(any(status == status_broken) .and. any(status /= status_broken), 'restart: some links are broken')
    end associate
    call make_row(dimension, law, folder, first)
    call run(first, 170)
    call save_checkpoint(first, error)
    call t%check(.not. allocated(error), 'restart: a checkpoint is written')
    call make_row(dimension, law, folder, second)
    call load_checkpoint(second, folder, warnings, error)
    call t%check(.not. allocated(error), 'restart: it is read')
    if (allocated(error)) return
    call run(second, 130)
    call t%check(all(second%contacts%status(:second%contacts%n) == straight%contacts%status(:straight%contacts%n)), &
                 'restart: what the links did')
    call t%near(maxval(abs(second%scene%bodies%position - straight%scene%bodies%position)), 0.0_wp, 0.0_wp, 'restart: places')
    call t%near(maxval(abs(second%scene%bodies%velocity - straight%scene%bodies%velocity)), 0.0_wp, 0.0_wp, 'restart: velocities')
  end subroutine test_restart

  !> Masses in a row between two that are held, the heaviest in the middle.
  subroutine make_row(dimension, law, folder, sim)
    integer, intent(in) :: dimension
    type(law_t), intent(in) :: law
    character(len=*), intent(in) :: folder
    type(simulation_t), intent(inout) :: sim
    integer, parameter :: n = 9
    integer :: i

    call begin_links(sim%scene, n, dimension, law)
    sim%scene%gravity(dimension) = -g
    do i = 1, n
      call put_mass(sim%scene, i, merge(0.0_wp, 0.5_wp + 0.1_wp*real(i*(n - i), wp), i == 1 .or. i == n), &
                    0.2_wp*real(i, wp)*along(dimension, 1))
      if (i > 1) call link(sim%scene, i - 1, i, 0.2_wp + 0.005_wp*real(i, wp), [1e-2_wp, 0.01_wp])
    end do
    sim%options%folder = folder
    sim%options%deck_hash = 'cafe'
    call begin_run(sim, 1e-3_wp, 1e-12_wp)
  end subroutine make_row
end program test_links
