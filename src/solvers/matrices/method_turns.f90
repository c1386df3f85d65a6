!> Turns of several methods at one problem: accelerated sweeps, plain ones, and methods that factorise (interior points, then
!! proximal points), each from impulses of its own (doc/theory/solvers_sweeps.md).
!!
!! The method whose error promises to be least gets most of the operations, each other one a share, so that none is left out for
!! good. Plain sweeps are those of `nlgs` to the last bit, and their share bounds how much later than these the answer may come.
!! Methods that factorise wait until a factorisation is cheap beside what was done before; then they have more for a while, since
!! they show what they are worth only after some factorisations. What counts are operations, not seconds: the same problem
!! always takes the same turns.
module sg_method_turns
  use sg_accelerated_nlgs, only: accelerated_state_t, anderson_t, sweep_accelerated
  use sg_block_progress, only: progress_t
  use sg_block_sweeps, only: sweep
  use sg_interior_point, only: follow_path, interior_point_t, path_t, take_best
  use sg_interior_point_system, only: contact_system_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_proximal_newton, only: approach, approach_t, proximal_t
  use sg_sparse_factor, only: has_sparse_library
  implicit none
  private
  public :: turns_t, take_turns

  !> The methods, in the order of their first turns
  integer, parameter :: accelerated = 1, plain = 2, factorising = 3

  !> How operations are shared
  type :: turns_t
    !> Accelerated sweeps go on alone while each such number lowers e1 by `fall`
    integer :: opening = 200
    real(wp) :: fall = 0.1_wp
    !> Sweeps of a turn at least, and operations of a turn over those of all so far
    integer :: sweeps = 40
    real(wp) :: length = 0.1_wp
    !> Share of each method that is not ahead; the one ahead has the rest
    real(wp) :: share(3) = [0.1_wp, 0.5_wp, 0.1_wp]
    !> Sweeps before methods that factorise have a turn, and their share until so many factorisations
    integer :: first_sweeps = 1000, trial_factorisations = 30
    real(wp) :: trial_share = 0.2_wp
    !> By how much a method may multiply its operations in a forecast
    real(wp) :: farthest = 4
  end type turns_t

  !> One method: its impulses (without units, but those of plain sweeps), least e1, operations, those that its next factorisation
  !! takes, and operations and least e1 after each turn
  type :: method_t
    real(wp), allocatable :: r(:, :)
    real(wp) :: e1 = huge(1.0_wp), operations = 0, asks = 0
    integer :: n_marks = 0
    real(wp), allocatable :: mark(:, :)
  end type method_t

  !> Methods that factorise, between two turns
  type :: factors_t
    type(contact_system_t) :: system
    type(path_t) :: path
    type(approach_t) :: approach
    logical :: is_prepared = .false., is_possible = .true.
  end type factors_t

contains

  !> Turns until the solve is over; the best answer is kept in the progress.
  subroutine take_turns(turns, anderson, interior, proximal, problem, scaled, scale, progress)
    type(turns_t), intent(in) :: turns !! how operations are shared
    type(anderson_t), intent(in) :: anderson !! settings of accelerated sweeps
    type(interior_point_t), intent(in) :: interior !! of interior points
    type(proximal_t), intent(in) :: proximal !! of proximal points
    type(matrix_problem_t), intent(in) :: problem !! problem to solve, with the impulses to start from
    type(matrix_problem_t), intent(inout) :: scaled !! the same without units
    real(wp), intent(in), contiguous :: scale(:) !! impulse [N s] that 1 stands for
    type(progress_t), intent(inout) :: progress !! how far the solve has come
    type(method_t) :: methods(3)
    type(accelerated_state_t) :: state
    type(factors_t) :: factors
    real(wp) :: before
    integer :: m

    methods(plain)%r = problem%r
    do m = 1, size(methods)
      call begin_method(methods(m), progress)
    end do
    call open_alone(turns, anderson, problem, scaled, scale, state, methods(accelerated), progress)
    do while (.not. progress%is_over)
      m = next_method(turns, methods, factors, progress)
      before = progress%operations
      if (m == factorising .and. .not. allocated(methods(m)%r)) call begin_method(methods(m), progress)
      call progress%begin_turn(max(real(turns%sweeps, wp)*progress%sweep_operations, turns%length*before))
      select case (m)
      case (accelerated)
        call sweep_accelerated(anderson, problem, scaled, scale, huge(1), state, progress)
      case (plain)
        call sweep_turn(problem, methods(m), progress)
      case default
        call factorise_turn(interior, proximal, before, problem, scaled, scale, factors, methods(m), progress)
      end select
      methods(m)%e1 = min(methods(m)%e1, progress%turn_e1)
      methods(m)%operations = methods(m)%operations + progress%operations - before
      call add_mark(methods(m))
    end do
    call factors%system%free()
  end subroutine take_turns

  !> A method that starts from the best answer so far.
  pure subroutine begin_method(method, progress)
    type(method_t), intent(inout) :: method
    type(progress_t), intent(in) :: progress

    method%n_marks = 0
    method%e1 = progress%best
    method%operations = progress%sweep_operations
    call add_mark(method)
    method%operations = 0
  end subroutine begin_method

  !> Accelerated sweeps alone, as long as they lower e1 fast.
  subroutine open_alone(turns, anderson, problem, scaled, scale, state, method, progress)
    type(turns_t), intent(in) :: turns
    type(anderson_t), intent(in) :: anderson
    type(matrix_problem_t), intent(in) :: problem
    type(matrix_problem_t), intent(inout) :: scaled
    real(wp), intent(in), contiguous :: scale(:)
    type(accelerated_state_t), intent(inout) :: state
    type(method_t), intent(inout) :: method
    type(progress_t), intent(inout) :: progress
    real(wp) :: before

    do while (.not. progress%is_over)
      before = method%e1
      call sweep_accelerated(anderson, problem, scaled, scale, turns%opening, state, progress)
      method%e1 = progress%best
      method%operations = progress%operations
      call add_mark(method)
      if (method%e1 > turns%fall*before) exit
    end do
  end subroutine open_alone

  !> Note how far a method has come.
  pure subroutine add_mark(method)
    type(method_t), intent(inout) :: method
    real(wp), allocatable :: longer(:, :)

    if (.not. allocated(method%mark)) allocate (method%mark(2, 64))
    if (method%n_marks == size(method%mark, 2)) then
      allocate (longer(2, 2*method%n_marks))
      longer(:, :method%n_marks) = method%mark
      call move_alloc(longer, method%mark)
    end if
    method%n_marks = method%n_marks + 1
    method%mark(:, method%n_marks) = [method%operations, method%e1]
  end subroutine add_mark

  !> Least e1 of a method after so many operations more, if it falls on as a power of them, as it did since half of them.
  pure real(wp) function forecast(method, more, farthest) result(e1)
    type(method_t), intent(in) :: method
    real(wp), intent(in) :: more, farthest
    real(wp) :: power, before, from
    integer :: k

    e1 = method%e1
    if (method%operations <= method%mark(1, 1)) return
    do k = method%n_marks, 2, -1
      if (method%mark(1, k) <= method%operations/2) exit
    end do
    from = max(method%mark(1, k), method%mark(1, 1))
    before = max(method%mark(2, k), tiny(before))
    power = log(max(e1, tiny(e1))/before)/log(method%operations/from)
    e1 = e1*min(farthest, (method%operations + more)/method%operations)**power
  end function forecast

  !> The method that is most behind its share.
  pure integer function next_method(turns, methods, factors, progress) result(next)
    type(turns_t), intent(in) :: turns
    type(method_t), intent(in) :: methods(3)
    type(factors_t), intent(in) :: factors
    type(progress_t), intent(in) :: progress
    real(wp) :: shares(3), promised(3)
    integer :: m, ahead

    do m = 1, size(methods)
      promised(m) = forecast(methods(m), progress%operations, turns%farthest)
    end do
    shares = turns%share
    if (must_wait(turns, methods(factorising), factors, progress)) then
      shares(factorising) = 0
    else if (on_trial(turns, methods(factorising), factors) .and. minval(promised) > progress%options%tolerance) then
      shares(factorising) = turns%trial_share
    end if
    ahead = minloc(promised, 1, shares > 0)
    shares(ahead) = 1 - (sum(shares) - shares(ahead))
    next = maxloc(shares*progress%operations - methods%operations, 1, shares > 0)
  end function next_method

  !> Is it too early for methods that factorise? The library's estimate of a factorisation, which is a bound that is ten times too
  !! large and more, must not be above all operations so far.
  pure logical function must_wait(turns, method, factors, progress)
    type(turns_t), intent(in) :: turns
    type(method_t), intent(in) :: method
    type(factors_t), intent(in) :: factors
    type(progress_t), intent(in) :: progress

    must_wait = .not. factors%is_possible .or. &
                progress%operations < max(method%asks, real(turns%first_sweeps, wp)*progress%sweep_operations)
  end function must_wait

  !> Have methods that factorise made too few factorisations to be judged?
  pure logical function on_trial(turns, method, factors)
    type(turns_t), intent(in) :: turns
    type(method_t), intent(in) :: method
    type(factors_t), intent(in) :: factors

    on_trial = method%operations < real(turns%trial_factorisations, wp)*factors%system%factor%operations .or. &
               .not. factors%path%has_begun
  end function on_trial

  !> Plain sweeps until the turn is over. Errors are measured as often as by `nlgs`, and at the end.
  subroutine sweep_turn(problem, method, progress)
    type(matrix_problem_t), intent(in) :: problem
    type(method_t), intent(inout) :: method
    type(progress_t), intent(inout) :: progress
    real(wp) :: n
    integer :: i

    do while (.not. progress%must_yield())
      n = max(1.0_wp, min(method%operations/10, progress%turn_end - progress%operations)/progress%sweep_operations)
      do i = 1, int(min(n, real(progress%options%maximum_iterations - progress%iterations, wp)))
        call sweep(problem, method%r)
        call progress%count_sweeps(1)
        if (modulo(i, 20) == 0) then
          if (progress%is_late()) exit
        end if
      end do
      call progress%look(problem, method%r)
    end do
  end subroutine sweep_turn

  !> Interior points, or proximal points from the best answer where their path is blocked.
  subroutine factorise_turn(interior, proximal, most, problem, scaled, scale, factors, method, progress)
    type(interior_point_t), intent(in) :: interior
    type(proximal_t), intent(in) :: proximal
    real(wp), intent(in) :: most !! operations that a factorisation may take, by the library's estimate
    type(matrix_problem_t), intent(in) :: problem
    type(matrix_problem_t), intent(inout) :: scaled
    real(wp), intent(in), contiguous :: scale(:)
    type(factors_t), intent(inout) :: factors
    type(method_t), intent(inout) :: method
    type(progress_t), intent(inout) :: progress

    if (.not. factors%is_prepared) then
      call factors%system%prepare(problem, scaled)
      factors%is_prepared = .true.
      factors%is_possible = factors%system%is_possible(has_sparse_library())
      if (.not. factors%is_possible) return
    end if
    if (allocated(method%r)) scaled%r = method%r
    if (.not. factors%path%has_begun) call take_best(scaled, scale, progress)
    method%asks = 0
    if (.not. factors%path%is_blocked) then
      factors%system%factor%most_operations = most
      call follow_path(interior, problem, scaled, scale, factors%system, factors%path, progress)
      if (factors%path%is_blocked) call take_best(scaled, scale, progress)
      if (factors%system%factor%is_too_dear) method%asks = factors%system%factor%operations
    else
      factors%approach%factors%most_operations = most
      call approach(proximal, problem, scaled, scale, factors%approach, progress, factors%is_possible)
      if (factors%approach%factors%is_too_dear) method%asks = factors%approach%factors%operations
    end if
    method%r = scaled%r
  end subroutine factorise_turn
end module sg_method_turns
