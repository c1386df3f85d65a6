!> Sweeps over contacts of disks and balls side by side: the same as one by one in the same order, whatever the bodies, with plain
!! records of disks and with others; and contacts that are added where records are plain.
program test_compact_lanes
  use harness, only: tests_t
  use sg_kinds, only: wp
  use sg_order_values, only: put_biases, put_impulses
  use sg_problem, only: problem_t, reserve_problem
  use sg_random, only: random_t
  use sg_records, only: ball_bias_x, ball_bias_z, ball_friction, ball_frictional, ball_inverse_i, ball_inverse_wnn, &
                        ball_inverse_wtt, body_length, first_inverse, normal_x, normal_z, round_bias_n, round_bias_t, &
                        round_friction, round_frictional, round_inverse_i, round_inverse_my, round_inverse_wnn, &
                        round_inverse_wtt
  use sg_run_options, only: criterion_quad, solver_options_t
  use sg_sweep_order, only: set_order, sweep_order_t, update_order
  use sg_sweep_round_lanes, only: lane_length_of_disks, plain_length_of_disks
  use solver_cases, only: check_side_by_side, random_pairs
  implicit none
  !> Criteria that look at increments have records one by one beside those in lanes
  type(solver_options_t), parameter :: with_copies = solver_options_t(criterion=criterion_quad)
  real(wp), parameter :: relaxations(2) = [1.0_wp, 0.8_wp]
  type(tests_t) :: t
  integer :: i

  do i = 1, 2
    call test_same(round_frictional, .true., 40, 2000, relaxations(i))
    call test_same(round_frictional, .true., 400, 1501, relaxations(i))
    call test_same(round_frictional, .false., 400, 1501, relaxations(i))
    call test_same(round_frictional, .true., 3, 900, relaxations(i))
    call test_same(ball_frictional, .false., 40, 2000, relaxations(i))
    call test_same(ball_frictional, .false., 400, 1501, relaxations(i))
  end do
  ! So many bodies are asked for before their turn.
  call test_same(round_frictional, .true., 90000, 3000, 1.0_wp)
  call test_added()
  call t%finish()

contains

  !> Contacts of random bodies, some of which nothing moves and some of which are driven in part.
  subroutine random_problem(random, kind, are_plain, n_bodies, n, problem)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: kind, n_bodies, n
    logical, intent(in) :: are_plain !! disks alike, with one friction and no bias along tangents
    type(problem_t), intent(out) :: problem
    integer :: k, b, c

    call reserve_problem(problem, kind, n_bodies, n)
    do b = 1, n_bodies
      do c = 1, first_inverse(kind) - 1
        problem%body(c, b) = random%normal()
      end do
      do c = first_inverse(kind), body_length(kind)
        problem%body(c, b) = random%uniform(0.5_wp, 2.0_wp)
      end do
      if (modulo(b, 10) == 3) problem%body(first_inverse(kind):, b) = 0
      if (modulo(b, 10) == 4 .and. kind == ball_frictional) problem%body(ball_inverse_i, b) = -real(1 + modulo(b/10, 6), wp)
      if (modulo(b, 10) == 4 .and. kind == round_frictional) problem%body([round_inverse_my, round_inverse_i], b) = 0
    end do
    call random_pairs(random, n_bodies, 3, problem%pair(:, :n))
    do k = 1, n
      if (kind == round_frictional) then
        call random_disks(random, are_plain, k, problem)
      else
        call random_balls(random, k, problem)
      end if
    end do
  end subroutine random_problem

  !> A contact of disks.
  subroutine random_disks(random, are_plain, k, problem)
    type(random_t), intent(inout) :: random
    logical, intent(in) :: are_plain
    integer, intent(in) :: k
    type(problem_t), intent(inout) :: problem
    real(wp) :: angle

    angle = random%uniform(-3.2_wp, 3.2_wp)
    associate (record => problem%record(:, k))
      record(1:2) = [cos(angle), sin(angle)]
      record(round_bias_n) = 0.1_wp*random%uniform()
      record(round_inverse_wnn) = random%uniform(0.2_wp, 0.5_wp)
      record(round_inverse_wtt) = record(round_inverse_wnn)/3
      record(round_bias_t) = 0
      record(round_friction) = 0.4_wp
      if (modulo(k, 17) == 0) record(round_inverse_wnn:round_inverse_wtt) = 0
      if (.not. are_plain) then
        record(round_bias_t) = 0.1_wp*random%normal()
        record(round_friction) = 100.0_wp*random%uniform()**6
        record(round_inverse_wtt) = record(round_inverse_wtt)*random%uniform(0.8_wp, 1.2_wp)
      end if
    end associate
    problem%impulse(:, k) = [max(0.0_wp, random%normal()), 0.2_wp*random%normal()]
  end subroutine random_disks

  !> A contact of balls.
  subroutine random_balls(random, k, problem)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: k
    type(problem_t), intent(inout) :: problem
    integer :: i

    associate (record => problem%record(:, k))
      do i = normal_x, normal_z
        record(i) = random%normal()
      end do
      record(normal_x:normal_z) = record(normal_x:normal_z)/norm2(record(normal_x:normal_z))
      do i = ball_bias_x, ball_bias_z
        record(i) = 0.1_wp*random%normal()
      end do
      record(ball_inverse_wnn) = random%uniform(0.2_wp, 0.5_wp)
      record(ball_inverse_wtt) = record(ball_inverse_wnn)*random%uniform(0.2_wp, 0.4_wp)
      record(ball_friction) = merge(0.0_wp, random%uniform(), modulo(k, 9) == 0)
      if (modulo(k, 17) == 0) record(ball_inverse_wnn:ball_inverse_wtt) = 0
      problem%impulse(:, k) = max(0.0_wp, random%normal())*record(normal_x:normal_z)
      do i = 1, 3
        problem%impulse(i, k) = problem%impulse(i, k) + 0.1_wp*random%normal()
      end do
    end associate
  end subroutine random_balls

  !> One sweep side by side and one by one, with impulses and biases that are put into the order again.
  subroutine test_same(kind, are_plain, n_bodies, n, relaxation)
    integer, intent(in) :: kind, n_bodies, n
    logical, intent(in) :: are_plain
    real(wp), intent(in) :: relaxation
    type(problem_t) :: problem
    type(sweep_order_t) :: order
    type(random_t) :: random
    logical, allocatable :: is_wanted(:)
    integer :: k

    call random%seed(37)
    call random_problem(random, kind, are_plain, n_bodies, n, problem)
    allocate (is_wanted(n))
    is_wanted = [(modulo(k, 13) > 0, k=1, n)]
    call set_order(order, problem, is_wanted, with_copies)
    if (kind == round_frictional) &
      call t%equal(size(order%lanes%record, 2), merge(plain_length_of_disks, lane_length_of_disks, are_plain), 'reals of a lane')
    problem%impulse(1, :n) = problem%impulse(1, :n) + 0.1_wp
    problem%record(merge(round_bias_n, ball_bias_x, kind == round_frictional), :n) = 0.05_wp
    call put_impulses(order, problem)
    call put_biases(order, problem)
    call check_side_by_side(t, problem, order, is_wanted, relaxation)
  end subroutine test_same

  !> A contact out of the ordinary that is added to plain ones: all of them have long records then.
  subroutine test_added()
    type(problem_t) :: problem
    type(sweep_order_t) :: order
    type(solver_options_t) :: options
    type(random_t) :: random
    logical :: is_wanted(800), is_ordered(800)

    call random%seed(5)
    call random_problem(random, round_frictional, .true., 300, 800, problem)
    problem%record(round_friction, 77) = 0.7_wp
    is_wanted = .true.
    is_wanted([77, 400]) = .false.
    is_ordered = is_wanted
    call set_order(order, problem, is_wanted, options)
    call t%equal(size(order%lanes%record, 2), plain_length_of_disks, 'without it: plain')
    is_wanted(400) = .true.
    call update_order(order, problem, is_wanted, is_ordered, options)
    call t%equal(size(order%lanes%record, 2), plain_length_of_disks, 'with another plain one: plain')
    call t%check(is_ordered(400), 'that one was added')
    is_wanted(77) = .true.
    call update_order(order, problem, is_wanted, is_ordered, options)
    call t%equal(size(order%lanes%record, 2), lane_length_of_disks, 'with it: not plain')
    call t%check(all(is_ordered), 'it was added too')
    call t%equal(order%n, 800, 'all contacts')
  end subroutine test_added
end program test_compact_lanes
