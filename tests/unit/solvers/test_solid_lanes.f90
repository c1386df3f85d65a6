!> Sweeps over solids side by side: the same as one by one in the same order, whatever the laws and the bodies; the law of each
!! contact alone, next to singular blocks too; every contact dealt once, and bodies that more chains meet than there are groups;
!! momentum taken by the sweep as by a pass before it.
program test_solid_lanes
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use harness, only: tests_t
  use sg_iterates, only: hold, iterates_t, step_order
  use sg_kinds, only: wp
  use sg_order_values, only: give_impulses
  use sg_problem, only: problem_t, reserve_problem
  use sg_random, only: random_t
  use sg_records, only: body_length, normal_x, normal_z, solid_arm_ax, solid_arm_az, solid_arm_cx, solid_arm_cz, solid_bias_x, &
                        solid_bias_y, solid_bias_z, solid_cohesion, solid_compliance_n, solid_compliance_t, solid_friction, &
                        solid_frictional, solid_inverse_mx, solid_inverse_my, solid_inverse_mz, solid_inverse_xx, &
                        solid_inverse_xy, solid_inverse_xz, solid_inverse_yz, solid_law, solid_s1, solid_s2, solid_spin_z, &
                        solid_tangent_x, solid_tangent_y, solid_tangent_z, solid_wn1, solid_wn2, solid_wnn, velocity_x
  use sg_run_options, only: criterion_quad, solver_options_t
  use sg_sweep_order, only: set_order, sweep_order_t
  use sg_sweep_solid, only: sweep_solid_frictional
  use sg_sweep_solid_lanes, only: sweep_solid_lanes
  use sg_sweep_solid_order, only: lanes
  use sg_sweeps, only: sweep
  use sg_vectors, only: cross
  use solver_cases, only: random_pairs
  implicit none
  !> Criteria that look at increments have records one by one beside those in lanes
  type(solver_options_t), parameter :: with_copies = solver_options_t(criterion=criterion_quad)
  type(tests_t) :: t
  integer :: i

  do i = 0, 1
    call test_same(40, 2000, i == 1, 1.0_wp)
    call test_same(400, 1500, i == 1, 0.8_wp)
    call test_same(3, 900, i == 1, 1.0_wp)
  end do
  call test_extreme()
  call test_momentum('groups')
  call test_momentum('coloured')
  call t%finish()

contains

  !> A unit vector in any direction.
  function direction(random) result(n)
    type(random_t), intent(inout) :: random
    real(wp) :: n(3)
    integer :: c

    do c = 1, 3
      n(c) = random%normal()
    end do
    n = n/norm2(n)
  end function direction

  !> Contacts of random bodies: some that nothing moves, some driven in part; up to seven points of a pair in a row.
  subroutine random_problem(random, n_bodies, n, with_special, problem)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: n_bodies, n
    logical, intent(in) :: with_special !! laws with compliance, linear ones, biases along tangents
    type(problem_t), intent(out) :: problem
    integer :: k, b, c

    call reserve_problem(problem, solid_frictional, n_bodies, n)
    do b = 1, n_bodies
      do c = 1, 6
        problem%body(c, b) = random%normal()
      end do
      problem%body(solid_inverse_mx:solid_inverse_mz, b) = random%uniform(0.5_wp, 2.0_wp)
      do c = 10, 12
        problem%body(c, b) = random%uniform(1.0_wp, 4.0_wp)
      end do
      do c = 13, 15
        problem%body(c, b) = random%uniform(-0.3_wp, 0.3_wp)
      end do
      if (modulo(b, 10) == 3) problem%body(solid_inverse_mx:solid_inverse_yz, b) = 0
      if (modulo(b, 10) == 4) problem%body([solid_inverse_my, solid_inverse_xx, solid_inverse_xy, solid_inverse_xz], b) = 0
    end do
    call random_pairs(random, n_bodies, 7, problem%pair(:, :n))
    do k = 1, n
      call random_contact(random, k, with_special, problem)
    end do
  end subroutine random_problem

  !> A contact with a block of the size that bodies give.
  subroutine random_contact(random, k, with_special, problem)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: k
    logical, intent(in) :: with_special
    type(problem_t), intent(inout) :: problem
    real(wp) :: n(3), tangent(3), r_n

    n = direction(random)
    tangent = cross(n, direction(random))
    tangent = tangent/norm2(tangent)
    associate (record => problem%record(:, k))
      record = 0
      record(normal_x:normal_z) = n
      record(solid_tangent_x:solid_tangent_z) = tangent
      record(solid_arm_cx:solid_arm_cz) = 0.5_wp*direction(random)
      record(solid_arm_ax:solid_arm_az) = 0.5_wp*direction(random)
      record(solid_bias_x:solid_bias_z) = 0.1_wp*random%uniform()*n
      record(solid_wnn) = random%uniform(3.0_wp, 6.0_wp)
      record(solid_wn1) = random%uniform(-1.0_wp, 1.0_wp)
      record(solid_wn2) = random%uniform(-1.0_wp, 1.0_wp)
      record(solid_s1) = random%uniform(1.0_wp, 5.0_wp)
      record(solid_s2) = random%uniform(1.0_wp, 5.0_wp)
      record(solid_friction) = 100.0_wp*random%uniform()**6
      if (modulo(k, 9) == 0) record(solid_friction) = 0
      if (modulo(k, 5) == 0) record(solid_cohesion) = random%uniform()
      record(solid_law) = merge(0.0_wp, 1.0_wp, modulo(k, 17) == 0)
      if (with_special .and. modulo(k, 3) == 0) then
        record(solid_bias_x:solid_bias_z) = 0.1_wp*direction(random)
        record(solid_compliance_n) = random%uniform()
        record(solid_compliance_t) = random%uniform()
        if (modulo(k, 6) == 0) record(solid_law) = 2
      end if
      r_n = max(0.0_wp, random%normal())
      if (record(solid_law) > 0.5_wp) problem%impulse(:, k) = r_n*n + 0.2_wp*r_n*direction(random)
    end associate
  end subroutine random_contact

  !> One sweep side by side and one by one.
  subroutine test_same(n_bodies, n, with_special, relaxation)
    integer, intent(in) :: n_bodies, n
    logical, intent(in) :: with_special
    real(wp), intent(in) :: relaxation
    type(problem_t) :: problem
    type(sweep_order_t) :: order
    type(random_t) :: random
    real(wp), allocatable :: impulse(:, :), body(:, :)
    logical, allocatable :: is_wanted(:)
    integer :: k, seen(n)

    call random%seed(31)
    call random_problem(random, n_bodies, n, with_special, problem)
    allocate (is_wanted(n))
    is_wanted = [(modulo(k, 13) > 0, k=1, n)]
    call set_order(order, problem, is_wanted, with_copies)
    seen = 0
    do k = 1, order%n
      seen(order%contact(k)) = seen(order%contact(k)) + 1
    end do
    call t%check(all(seen == merge(1, 0, is_wanted)), 'each wanted contact is dealt once, no other')
    call check_groups(order, problem)
    allocate (impulse(3, order%n), source=order%impulse(:, :order%n))
    allocate (body(body_length(solid_frictional), n_bodies), source=problem%body)
    call sweep_solid_frictional(order%n, n_bodies, order%pair, order%record, relaxation, impulse, body)
    call sweep_lanes(order, relaxation, problem)
    ! Sums in another order: rounding, carried from contact to contact through the sweep.
    call t%near(maxval(abs(problem%body(velocity_x:solid_spin_z, :) - body(velocity_x:solid_spin_z, :))), 0.0_wp, &
                1e-10_wp*maxval(abs(body(velocity_x:solid_spin_z, :))), 'side by side as one by one: bodies')
    call t%near(maxval(abs(problem%impulse(:, order%contact(:order%n)) - impulse)), 0.0_wp, 1e-10_wp*maxval(abs(impulse)), &
                'side by side as one by one: impulses')
    call t%check(maxval(abs(impulse - order%record(normal_x:normal_z, :order%n))) > 0.1_wp, 'the sweep changed something')
  end subroutine test_same

  !> No movable body is twice in a group, and a row holds the lanes of its group or the first of them.
  subroutine check_groups(order, problem)
    type(sweep_order_t), intent(in) :: order
    type(problem_t), intent(in) :: problem
    integer :: g, row, first, e, bad, slots(2*lanes), n, i
    logical :: moves(2*lanes)

    e = 0
    bad = 0
    first = 1
    do g = 1, order%solids%n_groups
      n = order%solids%row_size(first)
      slots(:2*n) = reshape(order%pair(:, e + 1:e + n), [2*n])
      do i = 1, 2*n
        moves(i) = any(problem%body(solid_inverse_mx:solid_inverse_yz, slots(i)) > 0)
      end do
      do i = 1, 2*n
        if (moves(i) .and. count(slots(:2*n) == slots(i)) > 1) bad = bad + 1
      end do
      do row = first, order%solids%last_row(g)
        if (order%solids%row_size(row) > n) bad = bad + 1
        do i = 1, order%solids%row_size(row)
          if (any(order%pair(:, e + i) /= slots(2*i - 1:2*i))) bad = bad + 1
        end do
        e = e + order%solids%row_size(row)
      end do
      first = order%solids%last_row(g) + 1
    end do
    call t%equal(e, order%n, 'the rows hold all contacts')
    call t%equal(bad, 0, 'no movable body twice in a group, and each lane one pair')
  end subroutine check_groups

  !> One sweep over a problem in lanes.
  subroutine sweep_lanes(order, relaxation, problem)
    type(sweep_order_t), intent(inout) :: order
    real(wp), intent(in) :: relaxation
    type(problem_t), intent(inout) :: problem

    associate (solids => order%solids)
      call sweep_solid_lanes(1, solids%n_groups, solids%n_groups, solids%n_rows, problem%n_bodies, solids%last_row, &
                             solids%row_size, solids%pair, solids%special, relaxation, solids%row, problem%body)
    end associate
    call give_impulses(order, problem)
  end subroutine sweep_lanes

  !> Blocks of any condition and size, friction 0 to 100, bodies that nothing moves: finite, no pull, within the cone, and what
  !! the scalar kernel gives.
  subroutine test_extreme()
    integer, parameter :: n = 20000
    type(random_t) :: random
    type(problem_t) :: problem
    type(sweep_order_t) :: order
    real(wp) :: body(body_length(solid_frictional), 2), scale, thin(2), couple, r_n, r_t, worst
    real(wp), allocatable :: impulse(:, :)
    logical, allocatable :: is_wanted(:)
    integer :: k, c, bad, compared

    call random%seed(33)
    call reserve_problem(problem, solid_frictional, 2, n)
    do k = 1, n
      problem%pair(:, k) = [1, 2]
      scale = 10**random%uniform(-12.0_wp, 12.0_wp)
      thin = [10**random%uniform(-15.0_wp, 0.0_wp), 10**random%uniform(-15.0_wp, 0.0_wp)]
      couple = 10**random%uniform(-3.0_wp, 3.0_wp)
      associate (record => problem%record(:, k))
        record = 0
        record(normal_x) = 1
        record(solid_tangent_y) = 1
        do c = 13, 15
          record(c) = random%normal()*10**random%uniform(-15.0_wp, 6.0_wp)
        end do
        if (modulo(k, 7) == 0) record(solid_bias_y:solid_bias_z) = 0
        if (modulo(k, 11) == 0) record(solid_bias_x) = 0
        record(solid_wnn) = scale
        record(solid_wn1:solid_wn2) = scale*couple*[random%normal(), random%normal()]
        record(solid_s1:solid_s2) = scale*thin
        record(solid_friction) = merge(0.0_wp, 100.0_wp*random%uniform()**4, modulo(k, 5) == 0)
        record(solid_law) = 1
      end associate
    end do
    problem%impulse = 0
    allocate (is_wanted(n), source=.true.)
    call set_order(order, problem, is_wanted, with_copies)
    allocate (impulse(3, n), source=0.0_wp)
    body = 0
    call sweep_solid_frictional(n, 2, problem%pair(:, :n), problem%record(:, :n), 1.0_wp, impulse, body)
    call sweep_lanes(order, 1.0_wp, problem)
    bad = 0
    compared = 0
    worst = 0
    do k = 1, n
      r_n = problem%impulse(1, k)
      r_t = hypot(problem%impulse(2, k), problem%impulse(3, k))
      if (.not. all(ieee_is_finite(problem%impulse(:, k)))) then
        bad = bad + 1
      else if (r_n < 0 .or. r_t > problem%record(solid_friction, k)*r_n*(1 + 1e-9_wp) + tiny(1.0_wp)) then
        bad = bad + 1
      end if
      ! Where friction times coupling is weak there is one answer. Its length is right to 1e-13; where one component alone nearly
      ! fills the disk of friction, the other is right to the root of that, 3e-7 of the length.
      couple = max(1.0_wp, problem%record(solid_friction, k))*norm2(problem%record(solid_wn1:solid_wn2, k))
      if (couple < 0.5_wp*problem%record(solid_wnn, k)) then
        compared = compared + 1
        worst = max(worst, norm2(problem%impulse(:, k) - impulse(:, k))/max(norm2(impulse(:, k)), tiny(1.0_wp)))
      end if
    end do
    call t%check(compared > 2000, 'side by side: answers are compared')
    call t%near(worst, 0.0_wp, 1e-6_wp, 'side by side: the answer that one by one gives')
    call t%equal(bad, 0, 'side by side: finite and within the cone whatever the block')
  end subroutine test_extreme

  !> Sweeps that take momentum leave what sweeps after a pass leave, bit for bit, and sum what the next pass sums.
  subroutine test_momentum(order_name)
    character(len=*), intent(in) :: order_name
    real(wp), parameter :: shares(3) = [0.0_wp, 0.8_wp, 0.5_wp]
    integer, parameter :: n_bodies = 400, n = 1500
    type(problem_t) :: passed, taken
    type(sweep_order_t) :: order, same_order
    type(iterates_t) :: past, own
    type(solver_options_t) :: options
    type(random_t) :: random
    real(wp) :: sums(2)
    logical :: is_wanted(n)
    integer :: i

    call random%seed(32)
    call random_problem(random, n_bodies, n, .true., passed)
    taken = passed
    is_wanted = .true.
    options%order = order_name
    call set_order(order, passed, is_wanted, options)
    same_order = order
    call hold(order, past)
    call hold(same_order, own)
    do i = 1, size(shares)
      past%share = shares(i)
      own%share = shares(i)
      call step_order(order, past)
      ! Coloured sweeps sum block by block: rounding of sums of 4500 numbers.
      if (i > 1) call t%near(maxval(abs(past%sums - sums)/abs(past%sums)), 0.0_wp, 1e-12_wp, order_name//': sums')
      call sweep(solid_frictional, order, n_bodies, 1.0_wp, passed%body)
      call sweep(solid_frictional, same_order, n_bodies, 1.0_wp, taken%body, own)
      sums = own%sums
    end do
    call give_impulses(order, passed)
    call give_impulses(same_order, taken)
    call t%check(.not. any(abs(passed%body - taken%body) > 0), order_name//': the same velocities')
    call t%check(.not. any(abs(passed%impulse - taken%impulse) > 0), order_name//': the same impulses')
    call t%check(minval(sums(:1)) > 0, order_name//': impulses change')
  end subroutine test_momentum
end program test_solid_lanes
