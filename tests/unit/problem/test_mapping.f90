!> H and H^T adjoint, the compact mapping of all four kinds of problem against the geometric one, W against H^T M^-1 H.
program test_mapping
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, drive, put_disk, put_polygon, put_wall
  use resultants, only: add_resultants
  use sg_compact, only: add_impulses, compact_velocity
  use sg_contacts, only: contacts_t
  use sg_detect, only: detect
  use sg_kinds, only: wp
  use sg_laws, only: law_iqs, law_elastic, law_restitution, local_law, local_law_t, status_new
  use sg_mapping, only: relative_velocity
  use sg_motion, only: predict
  use sg_random, only: random_t
  use sg_records, only: arm_frictional, arm_frictionless, arm_frictionless_inverse_wnn, arm_wnn, arm_wtt, round_frictional, &
                        round_frictionless, round_frictionless_inverse_wnn, round_inverse_wnn, round_inverse_wtt
  use sg_simulation, only: simulation_t
  use sg_time_functions, only: time_function_t
  use solver_cases, only: begin_step, h, reassemble
  implicit none
  integer, parameter :: n_bodies = 40
  real(wp), parameter :: side = 6
  ! Sums of some ten terms of order one to ten, over contacts some hundred in all.
  real(wp), parameter :: rounding = 1e-13_wp
  character(len=18), parameter :: names(4) = [character(len=18) :: 'round frictionless', 'round frictional', 'arm frictionless', &
                                              'arm frictional']
  type(tests_t) :: t
  integer :: kind

  do kind = 1, 4
    call test_kind(kind, period=0.0_wp)
    call test_kind(kind, period=side)
  end do
  call test_hand()
  call t%finish()

contains

  !> All checks for one kind of problem.
  subroutine test_kind(kind, period)
    integer, intent(in) :: kind
    real(wp), intent(in) :: period
    type(simulation_t), pointer :: sim
    character(len=:), allocatable :: name

    sim => fresh()
    name = trim(names(kind))
    if (period > 0) name = name//', periodic'
    call make_scene(sim, kind, period)
    call begin_step(sim)
    call reassemble(sim)
    call t%equal(sim%problem%kind, kind, name//': the kind is as planned')
    call t%check(sim%contacts%n > 60, name//': there are contacts')
    call test_adjoint(sim, name)
    call test_compact(sim, name)
    call test_delassus(sim, name)
  end subroutine test_kind

  !> Overlapping shapes that fly about; some bodies are driven in one direction, some in their spin.
  subroutine make_scene(sim, kind, period)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: kind
    real(wp), intent(in) :: period
    type(random_t) :: random
    real(wp) :: place(2), r
    logical :: has_friction, is_round
    integer :: b

    call random%seed(5)
    has_friction = kind == round_frictional .or. kind == arm_frictional
    is_round = kind == round_frictional .or. kind == round_frictionless
    associate (scene => sim%scene)
      call begin_scene(scene, n_bodies, merge(0.4_wp, 0.0_wp, has_friction), 0.1_wp)
      scene%period = period
      do b = 1, n_bodies - 3
        place = [random%uniform(0.0_wp, side), random%uniform(0.0_wp, side)]
        r = random%uniform(0.4_wp, 0.9_wp)
        if (is_round .or. modulo(b, 3) > 0) then
          call put_disk(scene, b, r, place)
        else
          call put_polygon(scene, b, spread(place, 2, 3) + r*reshape([1.0_wp, 0.0_wp, -0.5_wp, 0.8_wp, -0.6_wp, -0.7_wp], [2, 3]))
        end if
        scene%bodies%velocity(:, b) = [random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp), 0.0_wp]
        if (kind /= round_frictionless) scene%bodies%velocity(3, b) = random%uniform(-1.0_wp, 1.0_wp)
        ! Masses near one, so that all terms of W count.
        scene%bodies%inverse_mass(:, b) = scene%bodies%inverse_mass(:, b)*1000
        scene%bodies%mass(b) = scene%bodies%mass(b)/1000
        scene%bodies%inertia(b) = scene%bodies%inertia(b)/1000
      end do
      call put_wall(scene, n_bodies - 2, 10.0_wp, 0.2_wp, [side/2, 0.0_wp], 0.0_wp)
      call put_wall(scene, n_bodies - 1, 1.0_wp, 0.2_wp, [side/2, side/2], 0.7_wp)
      call put_disk(scene, n_bodies, 1.0_wp, [side/3, side/3])
      call drive(scene, 1, 1, time_function_t(constant=0.3_wp))
      call drive(scene, 2, 2, time_function_t(constant=-0.4_wp))
      call drive(scene, 4, 1, time_function_t(constant=0.3_wp))
      call drive(scene, 4, 2, time_function_t())
      if (kind /= round_frictionless) call drive(scene, n_bodies, 3, time_function_t(constant=2.0_wp))
      if (kind /= round_frictionless) call drive(scene, 5, 3, time_function_t(constant=-1.0_wp))
      scene%laws(1)%kind = merge(law_restitution, law_iqs, is_round)
      scene%laws(1)%normal_restitution = 0.5_wp
      scene%laws(1)%tangential_restitution = merge(0.3_wp, 0.0_wp, has_friction)
      if (kind == arm_frictional) then
        scene%laws(1)%kind = law_elastic
        scene%laws(1)%stiffness = 1e4_wp
      end if
    end associate
  end subroutine make_scene

  !> r . H^T V = V . H r for random impulses and velocities.
  subroutine test_adjoint(sim, name)
    type(simulation_t), intent(inout) :: sim
    character(len=*), intent(in) :: name
    real(wp) :: velocity(sim%scene%bodies%n_velocity, n_bodies), resultant(sim%scene%bodies%n_velocity, n_bodies), u(2), power
    type(random_t) :: random
    integer :: b, c, k, m

    call random%seed(6)
    m = sim%contacts%n_components
    do b = 1, n_bodies
      do c = 1, size(velocity, 1)
        velocity(c, b) = random%uniform(-1.0_wp, 1.0_wp)
      end do
    end do
    power = 0
    do k = 1, sim%contacts%n
      do c = 1, m
        sim%contacts%impulse(c, k) = random%uniform(-1.0_wp, 1.0_wp)
      end do
      u = relative_velocity(sim%contacts, k, sim%scene%bodies%middle, sim%scene%period, velocity)
      power = power + dot_product(sim%contacts%impulse(:, k), u(:m))
    end do
    resultant = 0
    call add_resultants(sim%contacts, sim%scene%bodies%middle, sim%scene%period, resultant)
    call t%near(sum(resultant*velocity), power, 100*rounding, name//': H and its transpose are adjoint')
  end subroutine test_adjoint

  !> Compact relative velocities and the effect of compact impulses are those of geometry; impulses are set.
  subroutine test_compact(sim, name)
    type(simulation_t), intent(inout) :: sim
    character(len=*), intent(in) :: name
    real(wp) :: velocity(sim%scene%bodies%n_velocity, n_bodies), worst

    call reassemble(sim)
    velocity = sim%scene%bodies%free_velocity
    sim%problem%impulse = 0
    call t%near(misfit(sim, velocity), 0.0_wp, rounding, name//': relative velocities without impulses')
    sim%problem%impulse(:, :sim%contacts%n) = sim%contacts%impulse(:, :sim%contacts%n)
    call add_impulses(sim%problem)
    velocity = sim%scene%bodies%free_velocity + effect_of(sim, sim%contacts)
    call t%near(misfit(sim, velocity), 0.0_wp, 100*rounding, name//': relative velocities with impulses')
    worst = maxval(abs(sim%problem%body(1:2, sim%pairs%slot_of) - velocity(1:2, :)))
    call t%near(worst, 0.0_wp, 100*rounding, name//': velocities of bodies')
    if (sim%problem%kind == round_frictionless) return
    worst = maxval(abs(sim%problem%body(3, sim%pairs%slot_of) - scaled_spin(sim, velocity)))
    call t%near(worst, 0.0_wp, 100*rounding, name//': spins of bodies')
  end subroutine test_compact

  !> What impulses do to velocities, by geometry: M^-1 H r.
  function effect_of(sim, contacts) result(change)
    type(simulation_t), intent(in) :: sim
    type(contacts_t), intent(in) :: contacts
    real(wp) :: change(sim%scene%bodies%n_velocity, n_bodies)

    change = 0
    call add_resultants(contacts, sim%scene%bodies%middle, sim%scene%period, change)
    change = change*sim%scene%bodies%inverse_mass
  end function effect_of

  !> Spins as problems carry them: times the radius for round ones.
  function scaled_spin(sim, velocity) result(spin)
    type(simulation_t), intent(in) :: sim
    real(wp), intent(in) :: velocity(:, :)
    real(wp) :: spin(n_bodies)

    spin = velocity(3, :)
    if (sim%problem%kind == round_frictional) spin = sim%plan%radius*spin
  end function scaled_spin

  !> Largest difference between compact and geometric relative velocities, bias and compliance included.
  real(wp) function misfit(sim, velocity)
    type(simulation_t), intent(in) :: sim
    real(wp), intent(in), contiguous :: velocity(:, :)
    type(local_law_t) :: law
    real(wp) :: u(2), before(3), r(2), got(3)
    integer :: k, m

    misfit = 0
    r = 0
    m = sim%contacts%n_components
    do k = 1, sim%contacts%n
      before = 0
      before(:2) = relative_velocity(sim%contacts, k, sim%scene%bodies%middle, sim%scene%period, sim%scene%bodies%velocity)
      law = local_law(sim%scene%laws(1), sim%contacts%gap(k), h, before, sim%contacts%status(k))
      if (.not. law%is_active) cycle
      r(:m) = sim%problem%impulse(:, k)
      u = relative_velocity(sim%contacts, k, sim%scene%bodies%middle, sim%scene%period, velocity) + law%bias(:2) &
          + law%compliance*r
      got = compact_velocity(sim%problem, k)
      misfit = max(misfit, maxval(abs(got(:m) - u(:m))))
    end do
  end function misfit

  !> W from unit impulses through the compact mapping against H^T M^-1 H from geometry; diagonal blocks of the records.
  subroutine test_delassus(sim, name)
    type(simulation_t), intent(inout) :: sim
    character(len=*), intent(in) :: name
    real(wp) :: compliance(2), worst, worst_block, largest, u(2), got(3)
    real(wp), allocatable :: dense(:, :), velocity(:, :), q(:, :)
    type(contacts_t) :: unit
    type(local_law_t) :: law
    integer :: j, k, m, i

    m = sim%contacts%n_components
    unit = sim%contacts
    allocate (dense(m*unit%n, m*unit%n), q(2, unit%n))
    sim%contacts%impulse = 0
    call reassemble(sim)
    sim%problem%impulse = 0
    do k = 1, unit%n
      got = compact_velocity(sim%problem, k)
      q(:, k) = got(:2)
    end do
    law = local_law(sim%scene%laws(1), 0.0_wp, h, [0.0_wp, 0.0_wp, 0.0_wp], status_new)
    worst = 0
    worst_block = 0
    do j = 1, m*unit%n
      i = (j - 1)/m + 1
      unit%impulse = 0
      unit%impulse(j - m*(i - 1), i) = 1
      velocity = effect_of(sim, unit)
      call reassemble(sim)
      sim%problem%impulse = 0
      sim%problem%impulse(j - m*(i - 1), i) = 1
      call add_impulses(sim%problem)
      do k = 1, unit%n
        u = relative_velocity(unit, k, sim%scene%bodies%middle, sim%scene%period, velocity)
        dense(m*(k - 1) + 1:m*k, j) = u(:m)
        compliance = 0
        if (k == i) compliance(j - m*(i - 1)) = law%compliance(j - m*(i - 1))
        got = compact_velocity(sim%problem, k) - [q(:, k) + compliance, 0.0_wp]
        worst = max(worst, maxval(abs(got(:m) - u(:m))))
      end do
    end do
    largest = maxval(abs(dense))
    call t%near(worst/largest, 0.0_wp, rounding, name//': W by the compact mapping is that of geometry')
    call t%near(maxval(abs(dense - transpose(dense)))/largest, 0.0_wp, rounding, name//': W is symmetric')
    do k = 1, unit%n
      worst_block = max(worst_block, block_misfit(sim, k, dense(m*(k - 1) + 1:m*k, m*(k - 1) + 1:m*k), law%compliance))
    end do
    call t%near(worst_block/largest, 0.0_wp, rounding, name//': diagonal blocks of the records')
  end subroutine test_delassus

  !> Difference between a record's block and W's; round frictional records hold a diagonal that bounds it.
  real(wp) function block_misfit(sim, k, w, compliance) result(misfit)
    type(simulation_t), intent(in) :: sim
    integer, intent(in) :: k
    real(wp), intent(in) :: w(:, :), compliance(2)

    misfit = 0
    associate (record => sim%problem%record(:, k))
      select case (sim%problem%kind)
      case (round_frictionless)
        if (record(round_frictionless_inverse_wnn) > 0) misfit = abs(1/record(round_frictionless_inverse_wnn) - w(1, 1))
      case (round_frictional)
        if (.not. record(round_inverse_wnn) > 0) return
        misfit = max(abs(1/record(round_inverse_wnn) - w(1, 1) - abs(w(1, 2))), &
                     abs(1/record(round_inverse_wtt) - w(2, 2) - abs(w(1, 2))))
      case (arm_frictionless)
        if (record(arm_frictionless_inverse_wnn) > 0) misfit = abs(1/record(arm_frictionless_inverse_wnn) - w(1, 1))
      case (arm_frictional)
        misfit = maxval(abs(record(arm_wnn:arm_wtt) - [w(1, 1) + compliance(1), w(1, 2), w(2, 2) + compliance(2)]))
      end select
    end associate
  end function block_misfit

  !> One contact by hand: a spinning disk on a floor.
  subroutine test_hand()
    type(simulation_t), pointer :: sim
    real(wp) :: u(2), resultant(3, 2)

    sim => fresh()
    call begin_scene(sim%scene, 2, 0.3_wp, 0.1_wp)
    call put_disk(sim%scene, 1, 2.0_wp, [0.0_wp, 2.05_wp])
    call put_wall(sim%scene, 2, 5.0_wp, 1.0_wp, [0.0_wp, -1.0_wp], 0.0_wp)
    sim%scene%bodies%velocity(:, 1) = [3.0_wp, -4.0_wp, 5.0_wp]
    sim%scene%gravity = 0
    call begin_run(sim, h, 1e-3_wp)
    call predict(sim%scene, 0.0_wp, h, 1.0_wp)
    call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
    call t%equal(sim%contacts%n, 1, 'disk on a floor: one contact')
    call t%near(sim%contacts%gap(1), 0.05_wp, 1e-15_wp, 'disk on a floor: gap')
    u = relative_velocity(sim%contacts, 1, sim%scene%bodies%middle, 0.0_wp, sim%scene%bodies%velocity)
    call t%near(u(1), -4.0_wp, rounding, 'disk on a floor: normal velocity')
    ! The tangent of an upward normal is x; the lowest point of a disk that turns counter-clockwise moves along x.
    call t%near(u(2), 3.0_wp + 2*5.0_wp, rounding, 'disk on a floor: tangential velocity')
    sim%contacts%impulse(:, 1) = [7.0_wp, 1.0_wp]
    resultant = 0
    call add_resultants(sim%contacts, sim%scene%bodies%middle, 0.0_wp, resultant)
    call t%near(maxval(abs(resultant(:, 1) - [1.0_wp, 7.0_wp, 2.0_wp])), 0.0_wp, rounding, 'disk on a floor: resultant')
    call t%near(maxval(abs(resultant(1:2, 2) + [1.0_wp, 7.0_wp])), 0.0_wp, rounding, 'disk on a floor: reaction')
  end subroutine test_hand
end program test_mapping
