!> The default solver of contact problems given by matrices: shares of its methods, whatever these are worth, and how it keeps up
!! with sweeps on columns, which these solve slowly.
program test_method_turns
  use falling_column, only: make_column
  use harness, only: tests_t
  use sg_block_automatic, only: block_automatic_t
  use sg_block_nesterov, only: block_nesterov_t
  use sg_block_nlgs, only: block_nlgs_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_method_shares, only: add_mark, choose_turn, method_t, n_methods, nesterov, proximal, shares_t
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
    call momentum_keeps_half(k)
  end do
  call steady_sweeps_keep_most()
  call stalled_sweeps_give_half()
  call tests%finish()

contains

  !> Sweeps with momentum have at least half of the effort of the default solver, and no iteration of another method takes less
  !! than one of theirs: with twice the iterations its answer is no worse than theirs and than that of plain sweeps, except for the
  !! places where e1 is measured.
  subroutine default_keeps_up(d, bodies)
    integer, intent(in) :: d, bodies
    type(block_nlgs_t) :: nlgs
    type(block_nesterov_t) :: momentum

    call keep_up_with(nlgs, 'plain sweeps', d, bodies)
    call keep_up_with(momentum, 'sweeps with momentum', d, bodies)
  end subroutine default_keeps_up

  !> The default solver with twice the sweeps of another one.
  subroutine keep_up_with(solver, name, d, bodies)
    class(matrix_solver_t), intent(inout) :: solver
    character(len=*), intent(in) :: name
    integer, intent(in) :: d, bodies
    integer, parameter :: sweeps(4) = [30, 100, 300, 1000]
    type(block_automatic_t) :: automatic
    type(matrix_problem_t) :: problem, answer
    type(report_t) :: alone, default
    integer :: i

    call make_column(d, bodies, problem)
    do i = 1, size(sweeps)
      solver%options%tolerance = 1e-12_wp
      solver%options%maximum_iterations = sweeps(i)
      automatic%options%tolerance = 1e-12_wp
      automatic%options%maximum_iterations = 2*sweeps(i)
      answer = problem
      call solver%solve(answer, alone)
      answer = problem
      call automatic%solve(answer, default)
      call tests%check(default%e1 <= max(1.2_wp*alone%e1, 1e-12_wp), 'the default solver keeps up with '//to_text(sweeps(i))// &
                       ' '//name//' on '//to_text(bodies)//' bodies, d = '//to_text(d))
    end do
  end subroutine keep_up_with

  !> Methods that fall as random powers of their effort, stall at random, and have random prices: sweeps with momentum have
  !! half of all effort after each turn.
  subroutine momentum_keeps_half(seed)
    integer, intent(in) :: seed
    type(method_t) :: methods(n_methods)
    type(shares_t) :: shares
    type(random_t) :: random
    real(wp) :: power(n_methods), bottom(n_methods)
    integer :: m
    logical :: is_kept

    call random%seed(seed)
    do m = 1, n_methods
      power(m) = random%uniform(0.0_wp, 3.0_wp)
      bottom(m) = 10**random%uniform(-10.0_wp, 0.0_wp)
      if (m >= proximal) methods(m)%price = 10**random%uniform(0.0_wp, 4.0_wp)
    end do
    methods(nesterov)%e1 = 1
    is_kept = .true.
    do m = 1, 300
      call take_turn(power, bottom, methods)
      is_kept = is_kept .and. methods(nesterov)%operations >= (shares%nesterov - 1e-12_wp)*sum(methods%operations)
    end do
    call tests%check(is_kept, 'sweeps with momentum keep half of the effort, draw '//to_text(seed))
  end subroutine momentum_keeps_half

  !> Sweeps with momentum that fall steadily, and ahead of all others, have all but the small shares of these.
  subroutine steady_sweeps_keep_most()
    type(method_t) :: methods(n_methods)
    type(shares_t) :: shares
    integer :: i

    methods(proximal:)%price = 10
    methods(nesterov)%e1 = 1
    do i = 1, 200
      call take_turn([2.0_wp, 0.5_wp, 0.5_wp, 0.5_wp], spread(0.0_wp, 1, n_methods), methods)
    end do
    call tests%check(methods(nesterov)%operations >= (1 - 3*shares%other - 1e-3_wp)*sum(methods%operations), &
                     'sweeps that fall steadily have all but small shares')
  end subroutine steady_sweeps_keep_most

  !> Where sweeps stall and a method that factorises does not, this one has nearly the half that sweeps with momentum leave.
  subroutine stalled_sweeps_give_half()
    type(method_t) :: methods(n_methods)
    integer :: i

    methods(proximal:)%price = 10
    methods(nesterov)%e1 = 1
    do i = 1, 200
      call take_turn([1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp], [1e-2_wp, 1e-2_wp, 0.0_wp, 0.0_wp], methods)
    end do
    call tests%check(methods(proximal)%operations >= 0.35_wp*sum(methods%operations), &
                     'where sweeps stall a method that does not has most of the other half')
  end subroutine stalled_sweeps_give_half

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
end program test_method_turns
