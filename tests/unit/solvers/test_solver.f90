!> The solver: criteria stop where they should, orders and relaxation reach one solution, and the active set changes nothing.
program test_solver
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_scene, g, put_disk, put_polygon, put_wall
  use sg_compact, only: compact_velocity
  use sg_kinds, only: wp
  use sg_natural_map, only: natural_map
  use sg_nlgs, only: nlgs_t
  use sg_problem, only: problem_t, reserve_problem
  use sg_random, only: random_t
  use sg_records, only: arm_friction, arm_frictional, arm_frictionless, arm_frictionless_inverse_wnn, arm_wnn, arm_wnt, arm_wtt, &
                        round_friction, round_frictional, round_frictionless, round_frictionless_bias, &
                        round_frictionless_inverse_wnn, round_inverse_wnn, round_inverse_wtt
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e1, criterion_e2, criterion_e8, criterion_maxm, criterion_names, &
                            criterion_quad, criterion_violation
  use sg_simulation, only: simulation_t
  use sg_sweep_round, only: sweep_round_frictionless
  use solver_cases, only: check_nothing, first_problem, h, heights, make_column, solver_of
  implicit none
  type(tests_t) :: t
  integer :: kind

  call test_column()
  call test_criteria()
  call test_effort()
  call test_orders()
  call test_relaxation()
  call test_visited()
  call test_late()
  call test_guess()
  do kind = 1, 4
    call check_nothing(t, kind)
  end do
  call t%finish()

contains

  !> Every kind of problem: the contacts of a column carry what lies above.
  subroutine test_column()
    type(problem_t) :: problem
    type(nlgs_t) :: solver
    type(report_t) :: report
    real(wp), allocatable :: exact(:)
    integer :: kind

    do kind = 1, 4
      call make_column(kind, problem, exact)
      call t%equal(problem%kind, kind, 'column: the kind is as planned')
      call t%equal(problem%n_contacts, merge(1, 2, kind <= round_frictional)*heights(kind), 'column: number of contacts')
      solver = solver_of(criterion_e8, 1e-13_wp, 10000)
      call solver%solve(problem, report)
      call t%check(report%is_converged, 'column: converged')
      ! An error of 10^-13 of a contact's natural map is carried through W's condition, some 10^2.
      call t%near(maxval(abs(problem%impulse(1, :problem%n_contacts) - exact))/maxval(exact), 0.0_wp, 1e-10_wp, &
                  'column: each contact carries the weight above')
      call t%equal(report%active_contacts, problem%n_contacts, 'column: all contacts are active')
    end do
  end subroutine test_column

  !> Each criterion has the value of its definition, and the solver stops at the first sweep that fulfils it.
  subroutine test_criteria()
    real(wp), parameter :: tolerances(7) = [1e-4_wp, 1e-6_wp, 1e-4_wp, 1e-4_wp, 1e-3_wp, 1e-3_wp, 1e-3_wp]
    type(problem_t) :: start, before, after
    type(nlgs_t) :: solver
    type(report_t) :: report, earlier
    real(wp), allocatable :: exact(:)
    integer :: criterion, kind
    character(len=:), allocatable :: name

    do kind = 1, 4
      call make_column(kind, start, exact)
      do criterion = 1, 7
        name = 'criterion '//trim(criterion_names(criterion))
        after = start
        solver = solver_of(criterion, tolerances(criterion), 10000)
        call solver%solve(after, report)
        call t%check(report%is_converged .and. report%criterion <= tolerances(criterion), name//': reached')
        call t%check(report%sweeps > 2, name//': takes some sweeps')
        call t%equal(report%checks, report%sweeps, name//': tested every sweep')
        before = start
        solver = solver_of(criterion, tolerances(criterion), report%sweeps - 1)
        call solver%solve(before, earlier)
        call t%check(.not. earlier%is_converged .and. earlier%criterion > tolerances(criterion), name//': not a sweep earlier')
        call t%near(report%criterion, defined(criterion, start, after), 1e-9_wp*report%criterion, name//': definition')
      end do
    end do
  end subroutine test_criteria

  !> A criterion by its definition, from the problem and its solution. All contacts of the column press, so what a contact
  !! asks is the impulse that makes its own velocity vanish: W_aa times the change is minus its velocity.
  real(wp) function defined(criterion, start, after)
    integer, intent(in) :: criterion
    type(problem_t), intent(in) :: start, after
    real(wp) :: f1, f8, fv, r2, u2, q2, w, u(3), r(2), dv(2), wr(2), friction, sums(5), largest(2), n
    integer :: k, m

    m = size(after%impulse, 1)
    f1 = 0
    f8 = 0
    fv = 0
    r2 = 0
    u2 = 0
    q2 = 0
    sums = 0
    largest = 0
    r = 0
    dv = 0
    wr = 0
    n = real(after%n_contacts, wp)
    do k = 1, after%n_contacts
      u = compact_velocity(start, k)
      q2 = q2 + sum(u(:m)**2)
      u = compact_velocity(after, k)
      r(:m) = after%impulse(:, k)
      call local_block(after, k, w, friction)
      f1 = f1 + sum(natural_map(r, u(:2), friction, 1.0_wp, 0.0_wp)**2)
      f8 = f8 + sum(natural_map(r, u(:2), friction, 1/w, 0.0_wp)**2)
      fv = fv + sum((natural_map(r, u(:2), friction, 1/w, 0.0_wp)*w)**2)
      r2 = r2 + sum(r**2)
      u2 = u2 + sum(u**2)
      dv(:m) = -u(:m)
      wr(:m) = block_times(after, k, after%impulse(:, k))
      sums = sums + [sum(dv**2), sum(wr**2), sum(dv*r), sum(wr*r), sum(dv**2)*sum(r**2)]
      largest = max(largest, [sum(dv**2), sum(dv**2)*sum(r**2)])
    end do
    select case (criterion)
    case (criterion_e1)
      defined = sqrt(f1/q2)
    case (criterion_e2)
      defined = sqrt(f1/max(q2, r2, u2))
    case (criterion_e8)
      defined = sqrt(f8/r2)
    case (criterion_violation)
      defined = sqrt(fv/n)/(g*h)
    case (criterion_quad)
      defined = max(abs(sums(3))/sums(4), sqrt(sums(1)/sums(2)), sqrt(sums(5)*n)/sums(4))
    case (criterion_maxm)
      defined = max(abs(sums(3))/sums(4), sqrt(largest(1)*n/sums(2)), sqrt(largest(2))*n/sums(4))
    case default
      defined = max(abs(sums(3))/sums(4), sqrt(sums(1)/sums(2)), sqrt(sums(5)*n)/sums(4), &
                    sqrt(largest(1)*n/sums(2))/16.666_wp, sqrt(largest(2))*n/sums(4)/16.666_wp)
    end select
  end function defined

  !> Largest eigenvalue of a contact's block, and its friction.
  subroutine local_block(problem, k, largest, friction)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    real(wp), intent(out) :: largest, friction

    friction = 0
    associate (record => problem%record(:, k))
      select case (problem%kind)
      case (round_frictionless)
        largest = 1/record(round_frictionless_inverse_wnn)
      case (round_frictional)
        largest = 1/min(record(round_inverse_wnn), record(round_inverse_wtt))
        friction = record(round_friction)
      case (arm_frictionless)
        largest = 1/record(arm_frictionless_inverse_wnn)
      case default
        largest = (record(arm_wnn) + record(arm_wtt))/2 + hypot((record(arm_wnn) - record(arm_wtt))/2, record(arm_wnt))
        friction = record(arm_friction)
      end select
    end associate
  end subroutine local_block

  !> A contact's block times a vector.
  function block_times(problem, k, r) result(wr)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    real(wp), intent(in) :: r(:)
    real(wp) :: wr(size(r))

    associate (record => problem%record(:, k))
      select case (problem%kind)
      case (round_frictionless)
        wr = r/record(round_frictionless_inverse_wnn)
      case (round_frictional)
        wr = r/record(round_inverse_wnn:round_inverse_wtt)
      case (arm_frictionless)
        wr = r/record(arm_frictionless_inverse_wnn)
      case default
        wr = [record(arm_wnn)*r(1) + record(arm_wnt)*r(2), record(arm_wnt)*r(1) + record(arm_wtt)*r(2)]
      end select
    end associate
  end function block_times

  !> What is told of effort: sweeps, tests, no convergence, warm and cold starts.
  subroutine test_effort()
    type(problem_t) :: start, problem
    type(nlgs_t) :: solver
    type(report_t) :: report
    real(wp), allocatable :: exact(:)

    call make_column(round_frictional, start, exact)
    problem = start
    solver = solver_of(criterion_e8, 1e-6_wp, 3)
    call solver%solve(problem, report)
    call t%check(.not. report%is_converged, 'effort: too few sweeps are told')
    call t%equal(report%sweeps, 3, 'effort: the solver gives up where asked')
    call t%equal(int(report%contact_updates), 3*heights(round_frictional), 'effort: contact updates')
    call t%check(report%e8 > 1e-6_wp, 'effort: the error reached is told')
    solver%options%check_every = 7
    solver%options%maximum_sweeps = 10000
    problem = start
    call solver%solve(problem, report)
    call t%check(report%is_converged .and. report%sweeps == 7*report%checks, 'effort: tests every seven sweeps')
    solver%options%maximum_sweeps = 10
    problem = start
    call solver%solve(problem, report)
    call t%equal(report%sweeps, 10, 'effort: the last tests come earlier where sweeps end')
    call t%equal(report%checks, 2, 'effort: and there is one')
    solver%options%check_every = 1
    problem = start
    problem%impulse(1, :size(exact)) = exact
    call solver%solve(problem, report)
    call t%equal(report%sweeps, 1, 'effort: from the solution, one sweep')
    solver%options%warm_start = .false.
    problem = start
    problem%impulse(1, :size(exact)) = exact
    call solver%solve(problem, report)
    call t%equal(report%sweeps, 10, 'effort: a cold start forgets the guess')
  end subroutine test_effort

  !> A heap of overlapping shapes thrown together.
  subroutine make_heap(sim, problem, with_polygons, friction)
    type(simulation_t), intent(inout) :: sim
    type(problem_t), intent(out) :: problem
    logical, intent(in) :: with_polygons
    real(wp), intent(in) :: friction
    integer, parameter :: rows = 18
    type(random_t) :: random
    real(wp) :: place(2)
    integer :: b

    call random%seed(2)
    call begin_scene(sim%scene, rows**2 + 1, friction, 0.05_wp)
    do b = 1, rows**2
      place = [real(modulo(b - 1, rows), wp) + 0.5_wp*real(modulo((b - 1)/rows, 2), wp), 0.87_wp*real((b - 1)/rows, wp)]
      if (with_polygons .and. modulo(b, 2) == 0) then
        call put_polygon(sim%scene, b, spread(place, 2, 4) + 0.4_wp*reshape([1.0_wp, 0.1_wp, -0.1_wp, 1.0_wp, -1.0_wp, -0.1_wp, &
                                                                             0.1_wp, -1.0_wp], [2, 4]))
      else
        call put_disk(sim%scene, b, random%uniform(0.49_wp, 0.51_wp), place)
      end if
      sim%scene%bodies%velocity(1:2, b) = 0.1_wp*[random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)]
    end do
    call put_wall(sim%scene, rows**2 + 1, 50.0_wp, 0.1_wp, [10.0_wp, -0.6_wp], 0.0_wp)
    call first_problem(sim, problem)
  end subroutine make_heap

  !> Natural and groups order: the same velocities, which are unique without friction; small errors with it.
  subroutine test_orders()
    type(simulation_t), pointer :: sim
    type(problem_t) :: start, natural, groups
    type(nlgs_t) :: solver
    type(report_t) :: report
    integer :: i
    logical :: with_polygons
    character(len=:), allocatable :: name

    sim => fresh()
    do i = 1, 4
      with_polygons = i > 2
      name = 'orders, '//merge('polygons', 'disks   ', with_polygons)
      call make_heap(sim, start, with_polygons, merge(0.3_wp, 0.0_wp, modulo(i, 2) == 0))
      call t%equal(start%kind, merge(2, 0, with_polygons) + merge(2, 1, modulo(i, 2) == 0), name//': the kind is as planned')
      solver = solver_of(criterion_e8, 1e-11_wp, 200000)
      solver%options%check_every = 10
      solver%options%order = 'natural'
      natural = start
      call solver%solve(natural, report)
      call t%check(report%is_converged, name//': natural order converges')
      solver%options%order = 'groups'
      groups = start
      call solver%solve(groups, report)
      call t%check(report%is_converged, name//': groups order converges')
      ! Velocities are of order 0.1 m/s; the heap's W has a condition of some 10^4.
      call t%near(maxval(abs(natural%body(1:2, :) - groups%body(1:2, :))), 0.0_wp, 1e-7_wp, name//': one solution')
      call compare_shuffled(solver, start, natural, name)
      sim => fresh()
    end do
  end subroutine test_orders

  !> Shuffled orders: one seed gives one answer to the bit, another seed another way to a solution; to the same one without
  !! friction.
  subroutine compare_shuffled(solver, start, natural, name)
    type(nlgs_t), intent(inout) :: solver
    type(problem_t), intent(in) :: start, natural !! before, and solved in natural order
    character(len=*), intent(in) :: name
    integer, parameter :: seeds(3) = [1, 2, 1]
    type(problem_t) :: shuffled(3)
    type(report_t) :: report
    integer :: i

    solver%options%order = 'shuffled'
    do i = 1, 3
      solver%options%order_seed = seeds(i)
      shuffled(i) = start
      call solver%solve(shuffled(i), report)
      call t%check(report%is_converged, name//': shuffled order converges')
      if (start%kind == round_frictional .or. start%kind == arm_frictional) cycle
      call t%near(maxval(abs(natural%body(1:2, :) - shuffled(i)%body(1:2, :))), 0.0_wp, 1e-7_wp, name//': shuffled, one solution')
    end do
    call t%check(any(abs(shuffled(1)%body - shuffled(2)%body) > 0), name//': another seed, another order')
    call t%check(all(abs(shuffled(1)%body - shuffled(3)%body) <= 0), name//': the same seed, the same bits')
  end subroutine compare_shuffled

  !> Under- and over-relaxed sweeps reach the same solution of a column.
  subroutine test_relaxation()
    real(wp), parameter :: relaxations(3) = [0.5_wp, 0.9_wp, 1.4_wp]
    type(problem_t) :: problem
    type(nlgs_t) :: solver
    type(report_t) :: report
    real(wp), allocatable :: exact(:)
    integer :: kind, i, sweeps(3)

    do kind = 1, 4
      do i = 1, 3
        call make_column(kind, problem, exact)
        solver = solver_of(criterion_e8, 1e-12_wp, 20000)
        solver%options%relaxation = relaxations(i)
        call solver%solve(problem, report)
        sweeps(i) = report%sweeps
        call t%near(maxval(abs(problem%impulse(1, :problem%n_contacts) - exact))/maxval(exact), 0.0_wp, 1e-9_wp, &
                    'relaxation: each contact carries the weight above')
      end do
      call t%check(sweeps(1) > sweeps(2) .and. sweeps(2) > sweeps(3), 'relaxation: over-relaxation is faster on a column')
    end do
  end subroutine test_relaxation

  !> A fast disk hits a row with small gaps: contacts that are open at first close one after the other as impulses spread.
  !! Sweeps that visit all contacts always, with the kernel alone, give the solution to compare with.
  subroutine test_visited()
    integer, parameter :: n = 80, all_sweeps = 60000
    type(simulation_t), pointer :: sim
    type(problem_t) :: start, problem, reference
    type(nlgs_t) :: solver
    type(report_t) :: report
    integer :: b, k, i, orders
    character(len=7), parameter :: order(2) = [character(len=7) :: 'natural', 'groups']

    sim => fresh()
    call begin_scene(sim%scene, n, 0.0_wp, 0.1_wp)
    sim%scene%gravity = 0
    do b = 1, n
      ! Each closed gap leaves the next disk 0.2 m/s slower: some sixty close, the last ones long after sweeps that change
      ! little have left them out.
      call put_disk(sim%scene, b, 0.5_wp, [real(b, wp)*(1.0_wp + 0.2_wp*h), 0.0_wp])
    end do
    sim%scene%bodies%velocity(1, 1:4) = 100
    call first_problem(sim, start)
    call t%equal(start%n_contacts, n - 1, 'visited: contacts of the row')
    reference = start
    k = reference%n_contacts
    do i = 1, all_sweeps
      call sweep_round_frictionless(k, n, reference%pair(:, :k), reference%record(:, :k), 1.0_wp, reference%impulse(:, :k), &
                                    reference%body)
    end do
    call t%check(count(reference%impulse(1, :k) > 0) > k/4 .and. count(reference%impulse(1, :k) > 0) < k, &
                 'visited: some contacts close, some stay open')
    call t%check(count(closes_late(start, k) .and. reference%impulse(1, :k) > 0) > k/5, 'visited: contacts open at first close')
    do orders = 1, 2
      problem = start
      solver = solver_of(criterion_e8, 1e-10_wp, 100000)
      solver%options%order = order(orders)
      call solver%solve(problem, report)
      call t%check(report%is_converged, 'visited: converged')
      call t%check(int(report%contact_updates) < report%sweeps*k, 'visited: not all contacts are visited')
      ! Velocities of 100 m/s; an error of 10^-10 in impulses through the n^2 of a chain's condition.
      call t%near(maxval(abs(problem%body(1, :) - reference%body(1, :))), 0.0_wp, 1e-4_wp, 'visited: the same velocities')
      call t%check(all(problem%impulse(1, :k) > 0 .eqv. reference%impulse(1, :k) > 0), 'visited: the same contacts close')
    end do
  end subroutine test_visited

  !> A contact that parts fast while all else is nearly solved is left out, and must come back when its turn comes.
  subroutine test_late()
    integer, parameter :: resting = 4000, parting = 400
    type(problem_t) :: problem
    type(nlgs_t) :: solver
    type(report_t) :: report

    call make_late(resting, parting, problem)
    solver = solver_of(criterion_e8, 1e-12_wp, 1000)
    solver%options%order = 'natural'
    call solver%solve(problem, report)
    call t%check(report%is_converged, 'late contact: converged')
    call t%check(int(report%contact_updates) < report%sweeps*(3 + resting) + 3*parting, 'late contact: some are left out')
    call t%near(maxval(abs(problem%body(1, 1:3) - 32.5_wp)), 0.0_wp, 1e-9_wp, 'late contact: those that push')
    call t%near(problem%body(1, 4), 2.5_wp, 1e-9_wp, 'late contact: the one that is pushed')
  end subroutine test_late

  !> The same from a guess that opens that contact, by 10 m/s where the limit is 30 times 20 m/s over the root of 44,003:
  !! the very first sweep leaves it out, and those that part, and the first test brings it back.
  subroutine test_guess()
    integer, parameter :: resting = 40000, parting = 4000, first = 20
    type(problem_t) :: start, problem
    type(nlgs_t) :: solver
    type(report_t) :: report

    call make_late(resting, parting, start)
    start%body(1, start%pair(1, 4:3 + resting)) = -2
    start%impulse(1, 2:3) = [20.0_wp, 60.0_wp]
    start%impulse(1, 4:3 + resting) = 1
    problem = start
    solver = solver_of(criterion_e8, 1e-12_wp, first)
    solver%options%check_every = first
    call solver%solve(problem, report)
    call t%equal(int(report%contact_updates), first*(2 + resting), 'guess: only contacts that carry are visited')
    call t%check(report%e8 > 1e-12_wp, 'guess: the test sees the contact left out')
    solver%options%maximum_sweeps = 1000
    problem = start
    call solver%solve(problem, report)
    call t%check(report%is_converged, 'guess: converged')
    call t%near(maxval(abs(problem%body(1, 1:3) - 32.5_wp)), 0.0_wp, 1e-9_wp, 'guess: those that push')
    call t%near(problem%body(1, 4), 2.5_wp, 1e-9_wp, 'guess: the one that is pushed')
    problem = start
    solver%options%warm_start = .false.
    call solver%solve(problem, report)
    call t%check(int(report%contact_updates) >= first*start%n_contacts, 'guess: without one all are visited at first')
  end subroutine test_guess

  !> P hits A and B before it, in an order of contacts that lets the impact reach the next one only a sweep later; C is
  !! 30 m/s of a gap away from B. Thousands of resting pairs keep the mean error low, hundreds of parting ones make it
  !! worth a new order. Momentum: 3 v_B + v_C = 100 and v_C = v_B - 30.
  subroutine make_late(resting, parting, problem)
    integer, intent(in) :: resting, parting
    type(problem_t), intent(out) :: problem
    integer :: k, n

    n = 3 + resting + parting
    call reserve_problem(problem, round_frictionless, 2*n, n)
    problem%velocity_scale = 1
    problem%free_norm = 100
    do k = 1, n
      problem%pair(:, k) = 2*k - 2 + [2, 1]
      problem%record(:, k) = [1.0_wp, 0.0_wp, 0.0_wp, 0.5_wp]
      if (k > 3 + resting) problem%body(1, problem%pair(1, k)) = 1000
    end do
    problem%body(3:4, :) = 1
    problem%body(1, 1) = 100
    problem%pair(:, 1) = [4, 3]
    problem%pair(:, 2) = [3, 2]
    problem%pair(:, 3) = [2, 1]
    problem%record(round_frictionless_bias, 1) = 30
  end subroutine make_late

  !> Contacts that part when no contact acts.
  function closes_late(problem, n) result(late)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: n
    logical :: late(n)
    real(wp) :: u(3)
    integer :: k

    do k = 1, n
      u = compact_velocity(problem, k)
      late(k) = u(1) > 0
    end do
  end function closes_late
end program test_solver
