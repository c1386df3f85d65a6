!> The default solver of contact problems given by matrices: shares of its methods, whatever these are worth, and how it keeps up
!! with plain sweeps on columns, which these solve slowly.
program test_method_turns
  use harness, only: tests_t
  use sg_block_automatic, only: block_automatic_t
  use sg_block_nlgs, only: block_nlgs_t
  use sg_kinds, only: wp, i4
  use sg_matrix_problem, only: matrix_problem_t
  use sg_method_shares, only: accelerated, add_mark, choose_turn, method_t, n_methods, plain, proximal, shares_t
  use sg_random, only: random_t
  use sg_report, only: report_t
  use sg_text, only: to_text
  implicit none
  type(tests_t) :: tests
  integer :: d, k

  do d = 2, 3
    call default_keeps_up(d, 5)
    call default_keeps_up(d, 50)
    call default_keeps_up(d, 500)
  end do
  do k = 1, 200
    call plain_sweeps_keep_half(k)
  end do
  call steady_sweeps_keep_most()
  call stalled_sweeps_give_half()
  call tests%finish()

contains

  !> Plain sweeps have at least half of the effort of the default solver after its opening, and no iteration of another method takes
  !! less than one of theirs: with four times the iterations its answer is no worse, except for the places where e1 is measured.
  subroutine default_keeps_up(d, bodies)
    integer, intent(in) :: d, bodies
    integer, parameter :: sweeps(4) = [30, 100, 300, 1000]
    type(block_nlgs_t) :: nlgs
    type(block_automatic_t) :: automatic
    type(matrix_problem_t) :: problem, answer
    type(report_t) :: plain, default
    integer :: i

    call make_column(d, bodies, problem)
    do i = 1, size(sweeps)
      nlgs%options%tolerance = 1e-12_wp
      nlgs%options%maximum_iterations = sweeps(i)
      automatic%options%tolerance = 1e-12_wp
      automatic%options%maximum_iterations = 4*sweeps(i)
      answer = problem
      call nlgs%solve(answer, plain)
      answer = problem
      call automatic%solve(answer, default)
      call tests%check(default%e1 <= max(1.2_wp*plain%e1, 1e-12_wp), 'the default solver keeps up with '// &
                       to_text(sweeps(i))//' sweeps on '//to_text(bodies)//' bodies, d = '//to_text(d))
    end do
  end subroutine default_keeps_up

  !> Methods that fall as random powers of their effort, stall at random, and have random prices: plain sweeps have half of all
  !! effort after each turn, once they have made up for the opening.
  subroutine plain_sweeps_keep_half(seed)
    integer, intent(in) :: seed
    type(method_t) :: methods(n_methods)
    type(shares_t) :: shares
    type(random_t) :: random
    real(wp) :: power(n_methods), bottom(n_methods), share
    integer :: m
    logical :: has_caught_up, is_kept

    call random%seed(seed)
    do m = 1, n_methods
      power(m) = random%uniform(0.0_wp, 3.0_wp)
      bottom(m) = 10**random%uniform(-10.0_wp, 0.0_wp)
      if (m >= proximal) methods(m)%price = 10**random%uniform(0.0_wp, 4.0_wp)
    end do
    call open_with_accelerated(random%uniform(1.0_wp, 300.0_wp), methods)
    has_caught_up = .false.
    is_kept = .true.
    do m = 1, 300
      call take_turn(power, bottom, methods)
      share = methods(plain)%operations/sum(methods%operations)
      has_caught_up = has_caught_up .or. share >= shares%plain
      if (has_caught_up) is_kept = is_kept .and. share >= shares%plain - 1e-12_wp
    end do
    call tests%check(has_caught_up .and. is_kept, 'plain sweeps keep half of the effort, draw '//to_text(seed))
  end subroutine plain_sweeps_keep_half

  !> Plain sweeps that fall steadily, and ahead of all others, have all but the small shares of these.
  subroutine steady_sweeps_keep_most()
    type(method_t) :: methods(n_methods)
    type(shares_t) :: shares
    integer :: i

    methods(proximal:)%price = 10
    call open_with_accelerated(40.0_wp, methods)
    do i = 1, 200
      call take_turn([2.0_wp, 0.5_wp, 0.5_wp, 0.5_wp], spread(0.0_wp, 1, n_methods), methods)
    end do
    call tests%check(methods(plain)%operations >= (1 - 3*shares%other - 1e-3_wp)*sum(methods%operations), &
                     'plain sweeps that fall steadily have all but small shares')
  end subroutine steady_sweeps_keep_most

  !> Where sweeps stall and a method that factorises does not, this one has nearly the half that plain sweeps leave.
  subroutine stalled_sweeps_give_half()
    type(method_t) :: methods(n_methods)
    integer :: i

    methods(proximal:)%price = 10
    call open_with_accelerated(40.0_wp, methods)
    do i = 1, 200
      call take_turn([1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp], [1e-2_wp, 1e-2_wp, 0.0_wp, 0.0_wp], methods)
    end do
    call tests%check(methods(proximal)%operations >= 0.35_wp*sum(methods%operations), &
                     'where sweeps stall a method that does not has most of the other half')
  end subroutine stalled_sweeps_give_half

  !> Accelerated sweeps alone for some effort.
  subroutine open_with_accelerated(operations, methods)
    real(wp), intent(in) :: operations
    type(method_t), intent(inout) :: methods(n_methods)
    integer :: i

    do i = 1, 2
      methods(accelerated)%operations = real(i, wp)*operations/2
      methods(accelerated)%e1 = 1/(1 + methods(accelerated)%operations)
      call add_mark(methods(accelerated))
    end do
    methods(plain)%e1 = 1
  end subroutine open_with_accelerated

  !> One turn of the method that is chosen, each sweep of effort 1; e1 falls as a power of the effort down to a floor.
  subroutine take_turn(power, bottom, methods)
    real(wp), intent(in) :: power(n_methods), bottom(n_methods)
    type(method_t), intent(inout) :: methods(n_methods)
    type(shares_t) :: shares
    real(wp) :: operations
    integer :: m

    call choose_turn(shares, methods, sum(methods%operations), 1.0_wp, m, operations)
    methods(m)%operations = methods(m)%operations + max(operations, methods(m)%price)
    methods(m)%e1 = max(bottom(m), (1 + methods(m)%operations)**(-power(m)))
    call add_mark(methods(m))
  end subroutine take_turn

  !> A column of bodies of mass 1 without rotation that falls on a bottom and slides: contact k is below body k.
  subroutine make_column(d, bodies, problem)
    integer, intent(in) :: d, bodies
    type(matrix_problem_t), intent(out) :: problem
    integer :: a, b, e, k

    problem%d = d
    problem%n = bodies
    allocate (problem%friction(bodies), source=0.3_wp)
    allocate (problem%q(d, bodies), problem%r(d, bodies), source=0.0_wp)
    problem%q(:2, 1) = [-1.0_wp, 0.1_wp]
    associate (w => problem%w)
      w%d = d
      w%n = bodies
      allocate (w%first(bodies + 1), w%diagonal(bodies), w%column(3*bodies - 2))
      allocate (w%block(d, d, 3*bodies - 2), source=0.0_wp)
      e = 0
      w%first(1) = 1
      do a = 1, bodies
        do b = max(1, a - 1), min(bodies, a + 1)
          e = e + 1
          w%column(e) = int(b, i4)
          if (a == b) w%diagonal(a) = int(e, i4)
          do k = 1, d
            w%block(k, k, e) = merge(merge(1.0_wp, 2.0_wp, a == 1), -1.0_wp, a == b)
          end do
        end do
        w%first(a + 1) = int(e + 1, i4)
      end do
    end associate
  end subroutine make_column
end program test_method_turns
