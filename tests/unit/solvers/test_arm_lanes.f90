!> Sweeps over contacts with arms and friction side by side: the same as one by one in the same order, whatever the bodies; the law
!! of each contact alone, next to singular blocks too; contacts whose law has no place in lanes; momentum by passes.
program test_arm_lanes
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use harness, only: tests_t
  use sg_group_dealing, only: lanes
  use sg_kinds, only: wp
  use sg_order_values, only: give_impulses, put_biases, put_impulses
  use sg_problem, only: problem_t, reserve_problem
  use sg_random, only: random_t
  use sg_records, only: arm_bias_n, arm_bias_t, arm_cohesion, arm_compliance_n, arm_compliance_t, arm_friction, arm_frictional, &
                        arm_inverse_i, arm_inverse_mx, arm_inverse_my, arm_law, arm_moment_nc, arm_moment_ta, arm_spin, arm_wnn, &
                        arm_wnt, arm_wtt, normal_x, normal_y, velocity_x
  use sg_run_options, only: criterion_quad, solver_options_t
  use sg_sweep_arm, only: sweep_arm_frictional
  use sg_sweep_order, only: set_order, sweep_order_t, update_order
  use sg_sweeps, only: sweep
  use solver_cases, only: check_side_by_side, random_pairs
  implicit none
  !> Criteria that look at increments have records one by one beside those in lanes
  type(solver_options_t), parameter :: with_copies = solver_options_t(criterion=criterion_quad)
  real(wp), parameter :: relaxations(2) = [1.0_wp, 0.8_wp]
  type(tests_t) :: t
  integer :: i

  do i = 1, 2
    call test_same(40, 2000, relaxations(i))
    call test_same(400, 1501, relaxations(i))
    call test_same(3, 900, relaxations(i))
  end do
  call test_alone()
  call test_special()
  call test_appended()
  call t%finish()

contains

  !> Contacts of random bodies: some that nothing moves, some driven in part; up to three points of a pair in a row.
  subroutine random_problem(random, n_bodies, n, problem)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: n_bodies, n
    type(problem_t), intent(out) :: problem
    integer :: k, b, c

    call reserve_problem(problem, arm_frictional, n_bodies, n)
    do b = 1, n_bodies
      do c = velocity_x, arm_spin
        problem%body(c, b) = random%normal()
      end do
      do c = arm_inverse_mx, arm_inverse_i
        problem%body(c, b) = random%uniform(0.5_wp, 2.0_wp)
      end do
      if (modulo(b, 10) == 3) problem%body(arm_inverse_mx:arm_inverse_i, b) = 0
      if (modulo(b, 10) == 4) problem%body([arm_inverse_my, arm_inverse_i], b) = 0
    end do
    call random_pairs(random, n_bodies, 3, problem%pair(:, :n))
    do k = 1, n
      call random_contact(random, k, problem)
    end do
  end subroutine random_problem

  !> A contact with a block of the size that bodies give.
  subroutine random_contact(random, k, problem)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: k
    type(problem_t), intent(inout) :: problem
    real(wp) :: angle
    integer :: c

    angle = random%uniform(-3.2_wp, 3.2_wp)
    associate (record => problem%record(:, k))
      record = 0
      record(normal_x:normal_y) = [cos(angle), sin(angle)]
      do c = arm_moment_nc, arm_moment_ta
        record(c) = random%uniform(-0.6_wp, 0.6_wp)
      end do
      record(arm_bias_n) = 0.1_wp*random%uniform()
      record(arm_bias_t) = 0.1_wp*random%normal()
      record(arm_wnn) = random%uniform(2.0_wp, 4.0_wp)
      record(arm_wtt) = random%uniform(2.0_wp, 4.0_wp)
      record(arm_wnt) = random%uniform(-1.5_wp, 1.5_wp)
      record(arm_friction) = 100.0_wp*random%uniform()**6
      if (modulo(k, 9) == 0) record(arm_friction) = 0
      record(arm_law) = merge(0.0_wp, 1.0_wp, modulo(k, 17) == 0)
      problem%impulse(:, k) = [max(0.0_wp, random%normal()), 0.2_wp*random%normal()]
    end associate
  end subroutine random_contact

  !> One sweep side by side and one by one, with impulses and biases that are put into the order again.
  subroutine test_same(n_bodies, n, relaxation)
    integer, intent(in) :: n_bodies, n
    real(wp), intent(in) :: relaxation
    type(problem_t) :: problem
    type(sweep_order_t) :: order
    type(random_t) :: random
    logical, allocatable :: is_wanted(:)
    integer :: k

    call random%seed(37)
    call random_problem(random, n_bodies, n, problem)
    allocate (is_wanted(n))
    is_wanted = [(modulo(k, 13) > 0, k=1, n)]
    call set_order(order, problem, is_wanted, with_copies)
    problem%impulse(1, :n) = problem%impulse(1, :n) + 0.1_wp
    problem%record(arm_bias_n:arm_bias_t, :n) = problem%record(arm_bias_n:arm_bias_t, :n) - 0.05_wp
    call put_impulses(order, problem)
    call put_biases(order, problem)
    call check_side_by_side(t, problem, order, is_wanted, relaxation)
  end subroutine test_same

  !> Contacts between two bodies that nothing moves, so that each is solved alone: blocks of any condition and size, singular ones
  !! too, friction 0 to 100. Finite, no pull, within the cone, and what the scalar kernel gives.
  subroutine test_alone()
    integer, parameter :: n = 20000
    type(random_t) :: random
    type(problem_t) :: problem
    type(sweep_order_t) :: order
    real(wp), allocatable :: impulse(:, :), body(:, :)
    real(wp) :: scale, worst, r_n, r_t
    logical, allocatable :: is_wanted(:)
    integer :: k, bad, slides

    allocate (is_wanted(n), source=.true.)
    call random%seed(39)
    call reserve_problem(problem, arm_frictional, 2, n)
    problem%body = 0
    problem%impulse = 0
    do k = 1, n
      problem%pair(:, k) = [1, 2]
      scale = 10**random%uniform(-12.0_wp, 12.0_wp)
      associate (record => problem%record(:, k))
        record = 0
        record(normal_x) = 1
        record(arm_bias_n) = random%normal()*10**random%uniform(-15.0_wp, 6.0_wp)
        record(arm_bias_t) = random%normal()*10**random%uniform(-15.0_wp, 6.0_wp)
        if (modulo(k, 7) == 0) record(arm_bias_t) = 0
        if (modulo(k, 11) == 0) record(arm_bias_n) = 0
        record(arm_wnn) = scale
        record(arm_wtt) = scale*10**random%uniform(-6.0_wp, 6.0_wp)
        record(arm_wnt) = sqrt(record(arm_wnn)*record(arm_wtt))*random%uniform(-0.9_wp, 0.9_wp)
        if (modulo(k, 13) == 0) record(arm_wnt:arm_wtt) = 0
        record(arm_friction) = merge(0.0_wp, 100.0_wp*random%uniform()**4, modulo(k, 5) == 0)
        record(arm_law) = 1
      end associate
    end do
    call set_order(order, problem, is_wanted, with_copies)
    call t%check(order%lanes%n_groups >= n/lanes, 'contacts of bodies that nothing moves lie side by side')
    impulse = order%impulse(:, :n)
    body = problem%body
    call sweep_arm_frictional(n, 2, order%pair, order%record, 1.0_wp, impulse, body)
    call sweep(arm_frictional, order, 2, 1.0_wp, problem%body)
    call give_impulses(order, problem)
    bad = 0
    slides = 0
    worst = 0
    do k = 1, n
      associate (e => order%contact(k))
        r_n = problem%impulse(1, e)
        r_t = problem%impulse(2, e)
        if (.not. all(ieee_is_finite(problem%impulse(:, e)))) bad = bad + 1
        if (r_n < 0 .or. abs(r_t) > problem%record(arm_friction, e)*r_n*(1 + 1e-12_wp)) bad = bad + 1
        if (r_n > 0 .and. abs(r_t) >= problem%record(arm_friction, e)*r_n*(1 - 1e-12_wp)) slides = slides + 1
        worst = max(worst, maxval(abs(problem%impulse(:, e) - impulse(:, k)))/max(maxval(abs(impulse(:, k))), tiny(1.0_wp)))
      end associate
    end do
    call t%equal(bad, 0, 'finite and within the cone whatever the block')
    call t%check(slides > 3000 .and. slides < 9000, 'some slide, some stick, some part')
    ! Determinants of blocks with a correlation of 0.9 lose one digit.
    call t%near(worst, 0.0_wp, 1e-13_wp, 'the answer that one by one gives')
  end subroutine test_alone

  !> With one law of another kind the contacts are swept one by one, in the order of the groups.
  subroutine test_special()
    integer, parameter :: n = 300, place(4) = [arm_cohesion, arm_compliance_n, arm_compliance_t, arm_law]
    type(random_t) :: random
    type(problem_t) :: problem
    type(sweep_order_t) :: order, plain
    logical :: is_wanted(n)
    integer :: i

    call random%seed(41)
    call random_problem(random, 60, n, problem)
    is_wanted = .true.
    call set_order(plain, problem, is_wanted, solver_options_t())
    call t%check(plain%lanes%n_groups > 0 .and. .not. plain%has_copies, 'plain laws: side by side alone')
    do i = 1, size(place)
      problem%record(place(i), n/2) = merge(2.0_wp, 0.1_wp, place(i) == arm_law)
      call set_order(order, problem, is_wanted, solver_options_t())
      call t%check(order%lanes%n_groups == 0 .and. order%has_copies, 'another law: one by one')
      call t%check(all(order%contact(:n) == plain%contact(:n)), 'another law: the same order')
      problem%record(place(i), n/2) = merge(1.0_wp, 0.0_wp, place(i) == arm_law)
      call set_order(order, problem, is_wanted, solver_options_t())
      call t%check(order%lanes%n_groups == plain%lanes%n_groups, 'side by side again')
    end do
  end subroutine test_special

  !> A contact that comes late, with a law of another kind or not: the sweep that follows is one over all in the order's order.
  subroutine test_appended()
    integer, parameter :: n = 300, late = 17
    type(random_t) :: random
    type(problem_t) :: problem
    type(sweep_order_t) :: order
    type(solver_options_t) :: options
    real(wp), allocatable :: impulse(:, :), body(:, :)
    logical :: is_wanted(n), is_ordered(n)
    integer :: i

    options%order = 'groups'
    do i = 1, 2
      call random%seed(43)
      call random_problem(random, 60, n, problem)
      is_wanted = .true.
      is_wanted(late) = .false.
      call set_order(order, problem, is_wanted, options)
      is_ordered = is_wanted
      is_wanted(late) = .true.
      problem%record(arm_law, late) = 1
      if (i == 2) problem%record(arm_cohesion, late) = 0.3_wp
      call update_order(order, problem, is_wanted, is_ordered, options)
      call t%check(order%n == n .and. all(is_ordered), 'the late contact has come')
      call t%check(i == 1 .eqv. order%lanes%n_groups > 0, 'side by side where laws are plain')
      impulse = problem%impulse(:, order%contact(:n))
      body = problem%body
      call sweep_arm_frictional(n, 60, problem%pair(:, order%contact(:n)), problem%record(:, order%contact(:n)), 1.0_wp, &
                                impulse, body)
      call sweep(arm_frictional, order, 60, 1.0_wp, problem%body)
      call t%near(maxval(abs(problem%body - body)), 0.0_wp, 1e-12_wp*maxval(abs(body)), 'a late contact: bodies')
    end do
  end subroutine test_appended
end program test_arm_lanes
