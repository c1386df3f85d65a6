!> Static loads: columns, the floor of a packing, a pressed wall, springs, cohesion, and the linear law's decay.
program test_static
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use measured, only: measures_of
  use scenes, only: begin_run, begin_scene, force_on, g, hold, put_disk, put_wall, run
  use sg_body_energy, only: kinetic_energy
  use sg_choose_solver, only: choose_solver
  use sg_drives, only: pressure_t
  use sg_kinds, only: wp
  use sg_laws, only: law_elastic, law_linear, law_mohr, law_wet
  use sg_measures, only: measures_t
  use sg_random, only: random_t
  use sg_run_options, only: criterion_e8, criterion_estimate, criterion_violation, solver_options_t
  use sg_simulation, only: simulation_t, start_simulation
  use sg_time_functions, only: time_function_t
  implicit none
  type(tests_t) :: t

  call test_column(10)
  call test_column(50)
  call test_packing()
  call test_pressure()
  call test_spring()
  call test_linear()
  call test_cohesion(law_wet, 'wet')
  call test_cohesion(law_mohr, 'Mohr')
  call t%finish()

contains

  !> A column of n disks of several sizes: the contact under each carries what lies above, from the first step on.
  subroutine test_column(n)
    integer, intent(in) :: n
    type(simulation_t), pointer :: sim
    real(wp) :: radius, height, worst, above
    integer :: b, k, lower

    sim => fresh()
    call begin_scene(sim%scene, n + 1, 0.3_wp, 0.01_wp)
    height = 0
    do b = 1, n
      radius = 0.3_wp + 0.1_wp*real(modulo(b, 3), wp)
      call put_disk(sim%scene, b, radius, [0.0_wp, height + radius])
      height = height + 2*radius
    end do
    call put_wall(sim%scene, n + 1, 5.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    call begin_run(sim, 1e-3_wp, 1e-10_wp)
    call run(sim, 10)
    call t%equal(sim%contacts%n, n, 'column: contacts')
    worst = 0
    do k = 1, sim%contacts%n
      lower = minval(modulo(sim%contacts%body(:, k), n + 1))
      above = sum(sim%scene%bodies%mass(lower + 1:n))*g
      worst = max(worst, abs(sim%contacts%impulse(1, k)/sim%options%time_step/above - 1))
    end do
    ! e8 is 10^-10 of the norm of all impulses; errors of a chain are n^2 larger, and relative to the least loaded contact.
    call t%near(worst, 0.0_wp, 1e-10_wp*real(n, wp)**3, 'column: each contact carries the weight above')
    call t%near(maxval(abs(sim%scene%bodies%velocity)), 0.0_wp, 1e-6_wp, 'column: at rest')
  end subroutine test_column

  !> A periodic packing that fell onto its floor, at the default criterion: the floor carries the weight.
  subroutine test_packing()
    type(simulation_t), pointer :: sim
    type(measures_t) :: measures
    integer, parameter :: columns = 20, rows = 15, n = columns*rows
    type(random_t) :: random
    real(wp) :: weight, mean, force(2)
    integer :: b, i, settling
    integer, parameter :: last = 200

    ! Where the packing settles is a matter of rounding. Of 74 seeds 5 to 9 need more than 5000 sweeps for the cold step below, and
    ! one does not come to its estimate.
    sim => fresh()
    call random%seed(1)
    call begin_scene(sim%scene, n + 1, 0.3_wp, 5e-4_wp)
    sim%scene%period = 0.02_wp*columns
    do b = 1, n
      call put_disk(sim%scene, b, random%uniform(0.008_wp, 0.0099_wp), &
                    0.02_wp*[real(modulo(b - 1, columns), wp) + 0.5_wp, real((b - 1)/columns, wp) + 0.5_wp])
      sim%scene%bodies%velocity(1:2, b) = 0.1_wp*[random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)]
    end do
    call put_wall(sim%scene, n + 1, 1.0_wp, 0.01_wp, [0.2_wp, -0.01_wp], 0.0_wp)
    sim%options%time_step = 5e-4_wp
    call start_simulation(sim)
    call run(sim, 1600)
    settling = sim%totals%steps - sim%totals%converged_steps
    weight = sum(sim%scene%bodies%mass(:n))
    mean = 0
    do i = 1, last
      call run(sim, 1)
      measures = measures_of(sim%scene, sim%contacts, sim%options%time_step)
      mean = mean + measures%get('floor_share')/last
    end do
    force = force_on(sim, n + 1)
    call t%check(kinetic_energy(sim%scene%bodies) < 1e-5_wp*weight*g*0.02_wp, 'packing: it has settled')
    ! Warm started, the impulses are far better than a step asks; what the packing's last tremor accelerates is below these.
    call t%near(mean, 1.0_wp, 1e-3_wp, 'packing: on average the floor carries the weight')
    call t%near(-force(2)/(weight*g), 1.0_wp, 1e-2_wp, 'packing: and so it does in the last step')
    call t%equal(sim%totals%steps - sim%totals%converged_steps, settling, 'packing: at rest every step converges')
    ! While it settles, a step may meet the limit of sweeps; which ones do is a matter of rounding (chaos of collisions).
    call t%check(settling <= 16, 'packing: while it settles 99 steps of 100 converge')
    call test_cold_step(sim)
  end subroutine test_packing

  !> One step of the settled packing from zero impulses: the estimate is the share of the weight that the floor misses.
  !!
  !! It is an estimate: up to twice of it is allowed (doc/theory/errors.md). With plain sweeps an E8 of 10^-3
  !! alone leaves most of the weight.
  subroutine test_cold_step(settled)
    type(simulation_t), intent(in) :: settled
    real(wp), parameter :: tolerances(3) = [1e-1_wp, 3e-2_wp, 1e-2_wp]
    integer :: i

    do i = 1, size(tolerances)
      call t%near(cold_share(settled, criterion_estimate, tolerances(i)), 1.0_wp, 2*tolerances(i), &
                  'cold step: the floor carries the weight within twice the estimate')
    end do
    call t%check(cold_share(settled, criterion_e8, 1e-3_wp, 'nlgs') < 0.8_wp, 'cold step: a small residual is not enough')
    ! With momentum a step from no impulses has to meet the estimate of decks, 2e-2, whatever the criterion: twice of it again.
    call t%near(cold_share(settled, criterion_e8, 1e-3_wp, 'nesterov'), 1.0_wp, 4e-2_wp, &
                'cold step with momentum, e8: the floor carries the weight')
    call t%near(cold_share(settled, criterion_violation, 1e-1_wp, 'nesterov'), 1.0_wp, 4e-2_wp, &
                'cold step with momentum, violation: the floor carries the weight')
  end subroutine test_cold_step

  !> Share of the weight that the floor carries after one step from zero impulses.
  real(wp) function cold_share(settled, criterion, tolerance, method)
    type(simulation_t), intent(in) :: settled
    real(wp), intent(in) :: tolerance
    integer, intent(in) :: criterion
    character(len=*), intent(in), optional :: method
    type(simulation_t), pointer :: sim
    type(measures_t) :: measures
    type(solver_options_t) :: options

    sim => fresh(settled)
    if (present(method)) options%method = method
    options%criterion = criterion
    options%tolerance = tolerance
    options%maximum_sweeps = 100000
    options%warm_start = .false.
    call choose_solver(options, sim%solver)
    call run(sim, 1)
    call t%check(sim%report%is_converged, 'cold step: converged')
    measures = measures_of(sim%scene, sim%contacts, sim%options%time_step)
    cold_share = measures%get('floor_share')
  end function cold_share

  !> A plate pressed onto disks: the opposite wall carries pressure times length and the weights.
  subroutine test_pressure()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: pressure = 2000, length = 3
    real(wp) :: force(2), weight
    integer :: b

    sim => fresh()
    call begin_scene(sim%scene, 5, 0.2_wp, 0.01_wp)
    do b = 1, 3
      call put_disk(sim%scene, b, 0.5_wp, [1.5_wp*real(b, wp), 0.5_wp])
    end do
    call put_wall(sim%scene, 4, 5.0_wp, 0.1_wp, [3.0_wp, -0.1_wp], 0.0_wp)
    call put_wall(sim%scene, 5, 5.0_wp, 0.1_wp, [3.0_wp, 1.1_wp], 0.0_wp)
    ! The plate is free in y: of its drives only those of x and rotation stay.
    sim%scene%drives = sim%scene%drives([1, 2, 3, 4, 6])
    sim%scene%bodies%mass(5) = 50
    sim%scene%bodies%inverse_mass(2, 5) = 1/50.0_wp
    deallocate (sim%scene%pressures)
    allocate (sim%scene%pressures(1))
    sim%scene%pressures(1) = pressure_t(body=5, direction=[0.0_wp, -1.0_wp, 0.0_wp], length=length, &
                                        value=time_function_t(constant=pressure))
    call begin_run(sim, 1e-3_wp, 1e-10_wp)
    call run(sim, 50)
    force = force_on(sim, 4)
    weight = g*(sum(sim%scene%bodies%mass(1:3)) + sim%scene%bodies%mass(5))
    call t%near(-force(2)/(pressure*length + weight), 1.0_wp, 1e-8_wp, 'pressure: the opposite wall carries it and the weights')
    force = force_on(sim, 5)
    call t%near(force(2)/(pressure*length + g*sim%scene%bodies%mass(5)), 1.0_wp, 1e-8_wp, 'pressure: the plate is held up')
    call t%near(sim%scene%bodies%position(2, 5), 1.1_wp, 1e-7_wp, 'pressure: the plate rests')
  end subroutine test_pressure

  !> Elastic repulsion: a disk sinks by m g/k, exactly when at rest.
  subroutine test_spring()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: stiffness = 1e6_wp
    real(wp) :: sinking

    sim => fresh()
    call begin_scene(sim%scene, 2, 0.0_wp, 0.1_wp)
    sim%scene%laws(1)%kind = law_elastic
    sim%scene%laws(1)%stiffness = stiffness
    call put_disk(sim%scene, 1, 0.5_wp, [0.0_wp, 0.5_wp])
    call put_wall(sim%scene, 2, 5.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    ! The scheme is implicit in the spring: it swings with decaying amplitude, over 2 pi sqrt(m/k) = 0.18 s.
    sim%options%theta = 1
    call begin_run(sim, 5e-3_wp, 1e-13_wp)
    sinking = sim%scene%bodies%mass(1)*g/stiffness
    call run(sim, 4000)
    call t%near((0.5_wp - sim%scene%bodies%position(2, 1))/sinking, 1.0_wp, 1e-6_wp, 'spring: static penetration')
    call t%near(sim%contacts%impulse(1, 1)/sim%options%time_step, sim%scene%bodies%mass(1)*g, 1e-6_wp*sim%scene%bodies%mass(1)*g, &
                'spring: static force')
  end subroutine test_spring

  !> The linear law r = -v/epsilon between two free disks: implicit decay of the relative velocity, factor by step
  !! epsilon/(epsilon + W), without a sign condition on the impulse.
  subroutine test_linear()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: epsilon = 0.02_wp
    real(wp) :: w, factor, v0
    integer, parameter :: steps = 30

    sim => fresh()
    call begin_scene(sim%scene, 2, 0.0_wp, 1.0_wp)
    sim%scene%gravity = 0
    sim%scene%laws(1)%kind = law_linear
    sim%scene%laws(1)%epsilon = epsilon
    call put_disk(sim%scene, 1, 0.5_wp, [0.0_wp, 0.0_wp])
    call put_disk(sim%scene, 2, 0.4_wp, [0.91_wp, 0.0_wp])
    ! They fly apart: a unilateral law would let them.
    v0 = 0.01_wp
    sim%scene%bodies%velocity(1, 2) = v0
    call begin_run(sim, 1e-3_wp, 1e-13_wp)
    call run(sim, steps)
    w = sum(1/sim%scene%bodies%mass)
    factor = (epsilon/(epsilon + w))**steps
    call t%near((sim%scene%bodies%velocity(1, 2) - sim%scene%bodies%velocity(1, 1))/v0, factor, 1e-11_wp, 'linear law: decay')
    call t%near(sum(sim%scene%bodies%mass*sim%scene%bodies%velocity(1, :)), sim%scene%bodies%mass(2)*v0, 1e-12_wp, &
                'linear law: momentum')
  end subroutine test_linear

  !> A disk hangs from a fixed one by cohesion: up to its force, not beyond; a broken bond does not heal.
  subroutine test_cohesion(kind, name)
    integer, intent(in) :: kind
    character(len=*), intent(in) :: name
    real(wp), parameter :: shares(4) = [0.5_wp, 0.99_wp, 1.01_wp, 2.0_wp]
    real(wp), parameter :: time = 0.2_wp
    type(simulation_t), pointer :: sim
    real(wp) :: weight, fall
    integer :: i

    do i = 1, 4
      sim => fresh()
      call begin_scene(sim%scene, 2, 0.3_wp, 0.02_wp)
      call put_disk(sim%scene, 1, 0.5_wp, [0.0_wp, 0.0_wp])
      call put_disk(sim%scene, 2, 0.5_wp, [0.0_wp, -1.0_wp])
      call hold(sim%scene, 1)
      weight = sim%scene%bodies%mass(2)*g
      sim%scene%laws(1)%kind = kind
      sim%scene%laws(1)%normal_cohesion = weight/shares(i)
      sim%scene%laws(1)%wet_thickness = 0.01_wp
      call begin_run(sim, 1e-3_wp, 1e-13_wp)
      call run(sim, nint(time/sim%options%time_step))
      fall = -1 - sim%scene%bodies%position(2, 2)
      if (shares(i) < 1) then
        call t%near(fall, 0.0_wp, 1e-12_wp, name//': cohesion holds less than its force')
        call t%near(sim%contacts%impulse(1, 1)/sim%options%time_step, -weight, 1e-9_wp*weight, name//': the pull is the weight')
      else if (kind == law_mohr) then
        ! Broken in the first step, which feels the cohesion still; free fall from then on.
        call t%near(fall, g*time**2/2, 2*g*sim%options%time_step*time, name//': the disk falls once its bond is broken')
      else
        ! Drawn back within the thickness, it falls with what is left, then freely: never slower than with the former.
        call t%check(fall > (1 - 1/shares(i))*g*time**2/2*0.99_wp, name//': the disk falls when it is too heavy')
        call t%check(fall < g*time**2/2, name//': but it was held back')
      end if
    end do
  end subroutine test_cohesion
end program test_static
