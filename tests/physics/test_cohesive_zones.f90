!> One bond of a cohesive zone pulled apart, in the plane and in space, against closed forms: opened, sheared, both; sheared under
!! load; hung on and overloaded; the balance of energy; and a restart in between.
!!
!! Grains are so heavy that nothing holds them up where a motion is imposed: what is compared is the traction at a jump.
program test_cohesive_zones
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, density, put_disk, put_wall, run
  use scenes_space, only: begin_space_scene, put_plane, put_sphere
  use sg_checkpoint, only: load_checkpoint, save_checkpoint
  use sg_choose_solver, only: choose_solver
  use sg_contacts, only: impulse_vector
  use sg_error, only: diagnostics_t, error_t
  use sg_hdf5, only: hdf5_is_available
  use sg_internal_values, only: bond_integrity, bond_opening, bond_slip
  use sg_kinds, only: wp, pi
  use sg_laws, only: law_abp, law_expo, law_mac, law_mal, law_t, law_th, status_bonded
  use sg_measures, only: measure, measures_t
  use sg_simulation, only: simulation_t
  use sg_system, only: make_folder, remove_file
  implicit none
  character(len=*), parameter :: folder = 'cohesive_zones'
  integer, parameter :: kinds(5) = [law_mac, law_mal, law_th, law_abp, law_expo]
  real(wp), parameter :: radius = 0.5_wp, h = 1e-3_wp
  type(tests_t) :: t
  integer :: dimension, i

  do dimension = 2, 3
    do i = 1, size(kinds)
      call test_pull(dimension, kinds(i), [1.0_wp, 0.0_wp])
      call test_pull(dimension, kinds(i), [0.0_wp, 1.0_wp])
      call test_pull(dimension, kinds(i), [1.0_wp, 1.0_wp])
    end do
    do i = 1, 3
      call test_driven(dimension, i)
    end do
    call test_sheared_under_load(dimension)
    call test_hung(dimension)
    call test_light(dimension)
    call test_energy(dimension)
  end do
  if (hdf5_is_available()) call test_restart()
  call t%finish()

contains

  !> A law whose numbers lie close together: stiffness 1e6 and 2e6 Pa/m, strength 1 and 0.9 kPa.
  pure subroutine set_law(kind, law)
    integer, intent(in) :: kind
    type(law_t), intent(inout) :: law

    law%kind = kind
    law%static_friction = 0.3_wp
    law%dynamic_friction = 0.3_wp
    law%zone_stiffness = [1e6_wp, 2e6_wp]
    law%normal_strength = 1000
    law%tangential_strength = 900
    law%zone_energy = [10.0_wp, 12.0_wp]
    law%zone_plateau = [4e-3_wp, 6e-3_wp]
    law%zone_opening = [0.05_wp, 0.06_wp]
    law%zone_share = 0.7_wp
    law%zone_residual = 1e-3_wp
  end subroutine set_law

  !> A grain that touches a wall from above, its surface R, in space pi R^2.
  subroutine make(dimension, kind, weight, velocity, gravity, sim)
    integer, intent(in) :: dimension, kind
    real(wp), intent(in) :: weight !! mass over that of the tests' density
    real(wp), intent(in) :: velocity(2) !! away from the wall and along it [m/s]
    real(wp), intent(in) :: gravity
    type(simulation_t), pointer, intent(out) :: sim

    sim => fresh()
    if (dimension == 2) then
      call begin_scene(sim%scene, 2, 0.3_wp, 0.3_wp)
      call put_disk(sim%scene, 1, radius, [0.0_wp, radius])
      call put_wall(sim%scene, 2, 3.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
      sim%scene%bodies%velocity(:2, 1) = velocity([2, 1])
    else
      call begin_space_scene(sim%scene, 2, 0.3_wp, 0.3_wp)
      call put_sphere(sim%scene, 1, radius, [0.0_wp, 0.0_wp, radius])
      call put_plane(sim%scene, 2, [3.0_wp, 3.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
      sim%scene%bodies%velocity(:3, 1) = [0.6_wp*velocity(2), -0.8_wp*velocity(2), velocity(1)]
    end if
    associate (bodies => sim%scene%bodies)
      bodies%mass(1) = weight*bodies%mass(1)
      bodies%inverse_mass(:, 1) = bodies%inverse_mass(:, 1)/weight
      if (dimension == 2) bodies%inertia(1) = weight*bodies%inertia(1)
      if (dimension == 3) bodies%principal(:, 1) = weight*bodies%principal(:, 1)
    end associate
    sim%scene%gravity = 0
    sim%scene%gravity(dimension) = gravity
    call set_law(kind, sim%scene%laws(1))
    sim%options%folder = folder
    sim%options%deck_hash = 'cafe'
    call begin_run(sim, h, 1e-12_wp)
    sim%options%solver%maximum_sweeps = 200
    call choose_solver(sim%options%solver, sim%solver)
  end subroutine make

  !> Surface of the contact [m, m2].
  pure real(wp) function surface(dimension)
    integer, intent(in) :: dimension

    surface = merge(radius, pi*radius**2, dimension == 2)
  end function surface

  !> A grain so light that its bond is 1e23 times stiffer than it is inert: sweeps stay finite, the bond holds, and the grain
  !! swings on it with no more than its speed, within the way of a step.
  subroutine test_light(dimension)
    integer, intent(in) :: dimension
    real(wp), parameter :: speed(2) = [1.0_wp, 0.5_wp]
    type(simulation_t), pointer :: sim

    call make(dimension, law_mal, 1e-26_wp, speed, 0.0_wp, sim)
    call run(sim, 5)
    call t%check(all(sim%contacts%status(:sim%contacts%n) == status_bonded) .and. sim%contacts%n > 0, 'a light grain: it is held')
    call t%check(norm2(sim%scene%bodies%velocity(:dimension, 1)) <= norm2(speed), 'a light grain: it is no faster than before')
    call t%check(abs(sim%scene%bodies%position(dimension, 1) - radius) <= h*norm2(speed), 'a light grain: it stays')
  end subroutine test_light

  !> Force on the grain along the normal, and against its slip [N].
  pure function tractions(sim, dimension) result(force)
    type(simulation_t), intent(in) :: sim
    integer, intent(in) :: dimension
    real(wp) :: force(2), p(3)

    force = 0
    if (sim%contacts%n == 0) return
    p = impulse_vector(sim%contacts, 1)/h
    force = [p(dimension), -p(1)]
    if (dimension == 3) force(2) = -0.6_wp*p(1) + 0.8_wp*p(2)
    force(1) = -force(1)
  end function tractions

  !> Stress of a bond over its strength by the formulas of each law, written out for one mode or, by the effective jump, for both
  !! (LMGC90's mixed modes).
  pure real(wp) function integrity_of(kind, opening, slip, before) result(beta)
    integer, intent(in) :: kind
    real(wp), intent(in) :: opening, slip, before
    type(law_t) :: law
    real(wp) :: q, d, di, dp, du, gg, di1, di2, sp1, sp2, dp1, dp2, k0, si, sp, gi, phi

    call set_law(kind, law)
    beta = before
    d = sqrt(opening**2 + slip**2)
    ! The ratio of the two squares; large where nothing opens.
    q = 1e20_wp
    if (opening > 1e-9_wp*slip) q = (slip/opening)**2
    associate (cn => law%zone_stiffness(1), ct => law%zone_stiffness(2), g1 => law%zone_energy(1), g2 => law%zone_energy(2))
      di1 = law%normal_strength/cn
      di2 = law%tangential_strength/ct
      di = di1*di2*sqrt((1 + q)/(di2**2 + q*di1**2))
      gg = (g2*cn + g1*ct*q)/(1 + q)
      select case (kind)
      case (law_mac)
        beta = g1/(cn*opening**2 + ct*slip**2)
      case (law_mal)
        du = 1.5_wp*(g1*g2 - 0.5_wp*di**2*gg)/(di*gg)
        beta = 1
        if (d > di) beta = di/d*(1 - ((d - di)/du)**2)
        if (d > di + du) beta = 0
      case (law_th)
        dp1 = law%zone_plateau(1)
        dp2 = law%zone_plateau(2)
        dp = dp1*dp2*sqrt((1 + q)/(dp2**2 + q*dp1**2))
        du = (2*g1*g2 - di*(dp - di)*gg)/(di*gg)
        beta = min(1.0_wp, di/d)
        if (d > dp) beta = di/d*(du - d)/(du - dp)
        if (d > du) beta = 0
      case (law_abp)
        phi = law%zone_share
        sp1 = 2*g1*(1 - phi)/law%zone_opening(1)
        sp2 = 2*g2*(1 - phi)/law%zone_opening(2)
        dp1 = (2*g1*phi + sp1*di1)/law%normal_strength
        dp2 = (2*g2*phi + sp2*di2)/law%tangential_strength
        dp = dp1*dp2*sqrt(1 + q)*sqrt(di2**2 + q*di1**2)/(di2*dp2 + q*di1*dp1)
        du = (1 + q)/dp*dp1*law%zone_opening(1)*dp2*law%zone_opening(2)/(dp2*law%zone_opening(2) + q*dp1*law%zone_opening(1))
        k0 = sqrt((cn**2 + ct**2*q)/(1 + q))
        si = k0*di
        sp = si*dp/(di + phi*du/(1 - phi))
        beta = 1
        if (d > di) beta = (si + (sp - si)*(d - di)/(dp - di))/(d*k0)
        if (d > dp) beta = (sp + sp*(d - dp)/(dp - du))/(d*k0)
        if (d > du) beta = 0
      case default
        gi = (di2**2*g1 + q*di1**2*g2)/(di2**2 + q*di1**2)
        k0 = sqrt((cn**2 + ct**2*q)/(1 + q))
        phi = k0*di/(gi - 0.5_wp*k0*di**2)
        beta = 1
        if (d > di) beta = di/d*exp(phi*(di - d))
        if (d > di - log(law%zone_residual)/phi) beta = 0
      end select
    end associate
    beta = min(beta, before)
    if (beta < 1e-12_wp) beta = 0
  end function integrity_of

  !> Traction at each jump until the bond is broken, and the energy that breaking it took.
  subroutine test_pull(dimension, kind, direction)
    integer, intent(in) :: dimension, kind
    real(wp), intent(in) :: direction(2)
    type(simulation_t), pointer :: sim
    character(len=:), allocatable :: name
    real(wp) :: jump(2), before, beta, share, worst, expected(2), energy(2), force(2), last(2)
    integer :: step
    real(wp) :: speed

    ! The exponential goes on for longest.
    speed = merge(0.12_wp, 0.05_wp, kind == law_expo)
    name = 'law '//achar(iachar('a') + kind - law_mac)//merge(', opened', '        ', direction(1) > 0)// &
           merge(', sheared', '         ', direction(2) > 0)
    call make(dimension, kind, 1e12_wp, speed*direction, 0.0_wp, sim)
    before = 1
    worst = 0
    energy = 0
    last = 0
    do step = 1, 1300
      call run(sim, 1)
      if (sim%contacts%n == 0) exit
      ! The gap of the detection and the opening of a step, half a step on.
      jump = speed*h*[real(step, wp) + 0.5_wp, real(step, wp)]*direction
      beta = integrity_of(kind, jump(1), jump(2), before)
      share = merge(beta**2, beta, kind == law_mac)
      expected = surface(dimension)*share*[1e6_wp, 2e6_wp]*jump
      force = tractions(sim, dimension)
      worst = max(worst, maxval(abs(force - expected)), 1e3_wp*abs(beta - sim%contacts%internal(bond_integrity, 1)))
      energy = energy + 0.5_wp*(force + last)*speed*h*direction
      last = force
      before = beta
    end do
    ! Forces of up to 1 kN; grains as heavy as this are held up by 1e-9 of their speed, and damage settles to 1e-8.
    call t%near(worst, 0.0_wp, 2e-5_wp, name//': traction against the formula')
    if (kind == law_mac) return
    ! The trapezoidal rule with 200 to 1000 steps up the curve.
    ! In mixed modes the energies of the exponential law do not add up to one.
    if (kind /= law_expo .or. minval(direction) < 0.5_wp) &
      call t%near(energy(1)/10/surface(dimension) + energy(2)/12/surface(dimension), 1.0_wp, 2e-3_wp, name//': energy of fracture')
    call t%check(.not. before > 0, name//': the bond is broken')
  end subroutine test_pull

  !> A bond between bodies that nothing moves, or that nothing moves along the normal: it pulls by its law, does not push where they
  !! come closer, and leaves nothing when it is broken; all the while steps converge.
  subroutine test_driven(dimension, case)
    integer, intent(in) :: dimension
    integer, intent(in) :: case !! 1: parted and sheared, 2: the same, free along the wall, 3: sheared and pressed into the wall
    real(wp), parameter :: speed = 0.05_wp
    character(len=*), parameter :: names(3) = ['driven               ', 'driven off the wall  ', 'driven into the wall ']
    type(simulation_t), pointer :: sim
    character(len=:), allocatable :: name
    real(wp) :: direction(2), opening, before, worst, rest
    integer :: step, unconverged, broken

    direction = merge([-0.01_wp, 1.0_wp], [1.0_wp, 1.0_wp], case == 3)
    call make(dimension, law_mal, 1e12_wp, speed*direction, 0.0_wp, sim)
    if (case == 2) then
      sim%scene%bodies%inverse_mass(dimension, 1) = 0
    else
      sim%scene%bodies%inverse_mass(:, 1) = 0
    end if
    before = 1
    worst = 0
    rest = 0
    unconverged = 0
    broken = 0
    do step = 1, 1300
      call run(sim, 1)
      if (sim%contacts%n == 0) exit
      if (.not. sim%report%is_converged) unconverged = unconverged + 1
      opening = max(0.0_wp, speed*direction(1)*h*(real(step, wp) + 0.5_wp))
      before = integrity_of(law_mal, opening, speed*h*real(step, wp), before)
      worst = max(worst, maxval(abs(tractions(sim, dimension) - &
                                    surface(dimension)*before*[1e6_wp*opening, 2e6_wp*speed*h*real(step, wp)])))
      if (before > 0) cycle
      broken = broken + 1
      rest = max(rest, maxval(abs(impulse_vector(sim%contacts, 1))))
    end do
    name = trim(names(case))
    call t%equal(unconverged, 0, name//': steps that have not converged')
    call t%check(broken > 10, name//': the bond breaks')
    ! As in `test_pull`.
    call t%near(worst, 0.0_wp, 2e-5_wp, name//': traction against the formula')
    call t%near(rest, 0.0_wp, 0.0_wp, name//': a broken bond carries nothing')
  end subroutine test_driven

  !> Pressed on the wall by 100 N and drawn along: the bond, and friction on (1 - beta) of the load.
  subroutine test_sheared_under_load(dimension)
    integer, intent(in) :: dimension
    type(simulation_t), pointer :: sim
    real(wp) :: weight, slip, before, beta, worst, force(2), load
    integer :: step, i

    do i = 1, 2
      weight = 1e12_wp
      call make(dimension, kinds(i + 1), weight, [0.0_wp, 0.05_wp], 0.0_wp, sim)
      load = 100
      sim%scene%gravity(dimension) = -load/sim%scene%bodies%mass(1)
      before = 1
      worst = 0
      do step = 1, 800
        call run(sim, 1)
        slip = 0.05_wp*h*real(step, wp)
        beta = integrity_of(kinds(i + 1), 0.0_wp, slip, before)
        force = tractions(sim, dimension)
        worst = max(worst, abs(force(1) + load), &
                    abs(force(2) - surface(dimension)*beta*2e6_wp*slip - 0.3_wp*(1 - beta)*load))
        before = beta
      end do
      call t%near(worst, 0.0_wp, 2e-5_wp, 'sheared under load')
      call t%check(.not. before > 0, 'sheared under load: broken at the end, friction alone')
    end do
  end subroutine test_sheared_under_load

  !> A grain below a ceiling, as gravity upwards has it: a bond that is strong enough holds its weight at weight over stiffness, the
  !! same one lets go of a grain that is too heavy.
  subroutine test_hung(dimension)
    integer, intent(in) :: dimension
    type(simulation_t), pointer :: sim
    real(wp) :: mass
    integer :: i

    do i = 1, 2
      ! One percent below and above the strength, brought on slowly; light grains do not swing, the scheme damps them.
      mass = density*merge(pi*radius**2, 4*pi*radius**3/3, dimension == 2)
      call make(dimension, law_mal, 1e-4_wp, [0.0_wp, 0.0_wp], 0.0_wp, sim)
      call load_up(sim, dimension, merge(0.99_wp, 1.01_wp, i == 1)*1000*surface(dimension)/(1e-4_wp*mass))
      if (i == 1) then
        call t%near(sim%contacts%internal(bond_opening, 1), 0.99e-3_wp, 1e-9_wp, 'hung: opening')
        call t%near(sim%contacts%internal(bond_integrity, 1), 1.0_wp, 0.0_wp, 'hung: whole')
        call t%check(sim%contacts%status(1) == status_bonded, 'hung: status')
        ! Its weight of up to 800 N.
        call t%near(maxval(abs(tractions(sim, dimension) - [990*surface(dimension), 0.0_wp])), 0.0_wp, 1e-5_wp, 'hung: weight')
      else
        call t%check(sim%contacts%n == 0 .or. sim%scene%bodies%velocity(dimension, 1) > 0.1_wp, 'overloaded: it falls')
      end if
    end do
  end subroutine test_hung

  !> Let gravity grow to a value and act for a while.
  subroutine load_up(sim, dimension, g)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: dimension
    real(wp), intent(in) :: g
    integer :: step

    do step = 1, 800
      sim%scene%gravity(dimension) = g*min(1.0_wp, real(step, wp)/500)
      call run(sim, 1)
      if (sim%contacts%n == 0) return
    end do
  end subroutine load_up

  !> The balance closes to rounding, whole and broken: work of bonds is what they store and what they lose.
  subroutine test_energy(dimension)
    integer, intent(in) :: dimension
    type(simulation_t), pointer :: sim
    integer :: step
    type(measures_t) :: measures
    real(wp) :: worst

    call make(dimension, law_mal, 1.0_wp, [0.09_wp, 0.05_wp], 0.0_wp, sim)
    worst = 0
    do step = 1, 400
      call run(sim, 1)
      call measure(sim%scene, sim%contacts, sim%options%time_step, sim%energy, measures)
      worst = max(worst, measures%get('energy_closure'))
    end do
    call t%near(worst, 0.0_wp, 1e-11_wp, 'the balance of energy closes')
    call t%check(sim%energy%bond_work > 1, 'bonds took energy')
    call t%check(sim%contacts%internal(bond_integrity, 1) < 1 .and. sim%contacts%internal(bond_integrity, 1) > 0, 'damaged')
  end subroutine test_energy

  !> A run continued from a checkpoint has the very same bond.
  subroutine test_restart()
    type(simulation_t), pointer :: straight, second
    type(error_t), allocatable :: error
    type(diagnostics_t) :: warnings
    integer :: dim

    do dim = 2, 3
      call t%check(make_folder(folder), 'the folder is there')
      call remove_file(folder//'/restart_a.h5')
      call remove_file(folder//'/restart_b.h5')
      call make(dim, law_expo, 1e12_wp, [0.05_wp, 0.05_wp], 0.0_wp, straight)
      call run(straight, 100)
      call save_checkpoint(straight, error)
      call t%check(.not. allocated(error), 'a checkpoint is written')
      call run(straight, 50)
      call make(dim, law_expo, 1e12_wp, [0.05_wp, 0.05_wp], 0.0_wp, second)
      call load_checkpoint(second, folder, warnings, error)
      call t%check(.not. allocated(error), 'it is read')
      if (allocated(error)) return
      call run(second, 50)
      call t%near(maxval(abs(second%contacts%internal(:, 1) - straight%contacts%internal(:, 1))), 0.0_wp, 0.0_wp, &
                  'restarted is straight')
      call t%near(abs(second%energy%bond_work - straight%energy%bond_work), 0.0_wp, 0.0_wp, 'and so is its work')
      call t%check(norm2(straight%contacts%internal(bond_slip:, 1)) > 1e-3_wp, 'there is slip')
    end do
  end subroutine test_restart
end program test_cohesive_zones
