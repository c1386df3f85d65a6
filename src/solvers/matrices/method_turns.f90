!> Turns of several methods at one problem: sweeps with momentum, accelerated ones, proximal points and interior points, each from
!! impulses of its own (doc/theory/solvers_sweeps.md).
!!
!! Sweeps with momentum are those of the solver of that name to the last bit, and their share bounds how much later than these the
!! answer may come (sg_method_shares). Effort is counted in operations, not in seconds: the same problem always takes the same
!! turns.
module sg_method_turns
  use sg_accelerated_nlgs, only: accelerated_state_t, anderson_t, sweep_accelerated
  use sg_block_nesterov, only: nesterov_state_t, sweep_nesterov
  use sg_block_progress, only: progress_t
  use sg_interior_point, only: follow_path, interior_point_t, path_t, take_best
  use sg_interior_point_system, only: contact_system_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_method_shares, only: accelerated, add_mark, choose_turn, interior, method_t, n_methods, nesterov, proximal, shares_t
  use sg_proximal_newton, only: approach, approach_t, proximal_t
  use sg_sparse_factor, only: has_sparse_library
  implicit none
  private
  public :: turns_t, take_turns

  !> Settings
  type :: turns_t
    type(shares_t) :: shares
    !> Settings of each method
    type(anderson_t) :: anderson
    type(proximal_t) :: proximal
    type(interior_point_t) :: interior
    !> Price of the first turn of methods that factorise, in sweeps: the analysis shows what a factorisation takes
    real(wp) :: first_sweeps = 10
  end type turns_t

  !> What each method keeps between two turns, apart from its impulses
  type :: states_t
    type(nesterov_state_t) :: nesterov
    type(accelerated_state_t) :: sweeps
    type(approach_t) :: approach
    type(contact_system_t) :: system
    type(path_t) :: path
    logical :: is_prepared = .false.
  end type states_t

contains

  !> Turns until the solve is over; the best answer is kept in the progress.
  subroutine take_turns(turns, problem, scaled, scale, progress)
    type(turns_t), intent(in) :: turns !! how effort is shared, and settings of each method
    type(matrix_problem_t), intent(in) :: problem !! problem to solve, with the impulses to start from
    type(matrix_problem_t), intent(inout) :: scaled !! the same without units
    real(wp), intent(in), contiguous :: scale(:) !! impulse [N s] that 1 stands for
    type(progress_t), intent(inout) :: progress !! how far the solve has come
    type(method_t) :: methods(n_methods)
    type(states_t) :: states
    real(wp) :: before, length, most
    integer :: m

    states%nesterov%r = problem%r
    methods(nesterov)%e1 = progress%best
    methods(proximal:)%price = turns%first_sweeps*progress%sweep_operations
    do while (.not. progress%is_over)
      before = progress%operations
      call choose_turn(turns%shares, methods, before, progress%sweep_operations, m, length)
      call progress%begin_turn(length)
      if (m == nesterov) then
        call sweep_turn(problem, states%nesterov, methods(m), progress)
      else
        ! A factorisation that takes more would leave sweeps with momentum less than their share.
        most = (1 + 1e-9_wp)*(methods(nesterov)%operations/turns%shares%nesterov - before)
        call choose_start(turns, methods(m), m, scaled, scale, states, progress)
        call matrix_turn(turns, m, most, problem, scaled, scale, states, methods(m), progress)
        methods(m)%r = scaled%r
      end if
      methods(m)%e1 = min(methods(m)%e1, progress%turn_e1)
      methods(m)%operations = methods(m)%operations + progress%operations - before
      call add_mark(methods(m))
      if (.not. progress%is_over) progress%is_over = progress%is_late()
    end do
    call states%system%free()
  end subroutine take_turns

  !> Where a method begins its turn: from its own impulses, or from the best answer where these are far behind.
  pure subroutine choose_start(turns, method, m, scaled, scale, states, progress)
    type(turns_t), intent(in) :: turns
    type(method_t), intent(inout) :: method
    integer, intent(in) :: m
    type(matrix_problem_t), intent(inout) :: scaled
    real(wp), intent(in), contiguous :: scale(:)
    type(states_t), intent(inout) :: states
    type(progress_t), intent(in) :: progress

    ! Where no e1 is finite none is behind, also one without impulses.
    if (allocated(method%r)) then
      if (method%e1 <= turns%shares%behind*progress%best .or. states%path%has_begun .and. m == interior) then
        scaled%r = method%r
        return
      end if
    end if
    call take_best(scaled, scale, progress)
    method%e1 = progress%best
    method%n_marks = 0
    call add_mark(method)
    if (m == accelerated) states%sweeps = accelerated_state_t()
    if (m == proximal) call states%approach%drop_steps()
  end subroutine choose_start

  !> Sweeps with momentum until the turn is over. Errors are measured as often as where they are alone, and at the end.
  subroutine sweep_turn(problem, state, method, progress)
    type(matrix_problem_t), intent(in) :: problem
    type(nesterov_state_t), intent(inout) :: state
    type(method_t), intent(in) :: method
    type(progress_t), intent(inout) :: progress
    real(wp) :: n

    do while (.not. progress%must_yield())
      n = min(method%operations/10, progress%turn_end - progress%operations)/progress%sweep_operations
      call sweep_nesterov(problem, max(1, int(min(n, 1e6_wp))), state, progress)
    end do
  end subroutine sweep_turn

  !> Accelerated sweeps, proximal points or interior points until the turn is over, a factorisation exceeds its share, or the path
  !! of interior points is blocked.
  subroutine matrix_turn(turns, m, most, problem, scaled, scale, states, method, progress)
    type(turns_t), intent(in) :: turns
    integer, intent(in) :: m
    real(wp), intent(in) :: most !! effort that a factorisation may take
    type(matrix_problem_t), intent(in) :: problem
    type(matrix_problem_t), intent(inout) :: scaled
    real(wp), intent(in), contiguous :: scale(:)
    type(states_t), intent(inout) :: states
    type(method_t), intent(inout) :: method
    type(progress_t), intent(inout) :: progress
    real(wp) :: price

    price = 0
    associate (factors => states%approach%factors, system => states%system)
      select case (m)
      case (accelerated)
        call sweep_accelerated(turns%anderson, problem, scaled, scale, huge(1), states%sweeps, progress)
      case (proximal)
        factors%most_operations = most
        call approach(turns%proximal, problem, scaled, scale, states%approach, progress, method%is_possible)
        price = factors%price
      case (interior)
        if (.not. states%is_prepared) call system%prepare(problem, scaled)
        states%is_prepared = .true.
        system%factor%most_operations = most
        if (system%is_possible(has_sparse_library())) then
          call follow_path(turns%interior, problem, scaled, scale, system, states%path, progress)
        else
          states%path%is_blocked = .true.
        end if
        method%is_possible = .not. states%path%is_blocked
        price = system%factor%price
      end select
    end associate
    if (price > 0) method%price = price
  end subroutine matrix_turn
end module sg_method_turns
