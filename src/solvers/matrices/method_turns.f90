!> Turns of several methods at one problem: plain sweeps, accelerated ones, and methods that factorise (interior points, then
!! proximal points), each from impulses of its own (doc/theory/solvers_sweeps.md).
!!
!! The method that is ahead gets most of the operations, each other one a share, so that none is left out for good. Methods that
!! factorise begin with more: they show what they are worth only after some factorisations. What counts are operations,
!! not seconds: the same problem always takes the same turns.
module sg_method_turns
  use sg_accelerated_nlgs, only: anderson_t, sweep_accelerated
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

  !> The methods
  integer, parameter :: plain = 1, accelerated = 2, factorising = 3

  !> How operations are shared
  type :: turns_t
    !> Sweeps of a turn at least, and operations of a turn over those of all so far
    integer :: sweeps = 200
    real(wp) :: length = 0.1_wp
    !> Share of each method that is not ahead; the one ahead has the rest
    real(wp) :: share = 0.1_wp
    !> Methods that factorise begin with the operations of so many sweeps, and have that share of all until so many factorisations
    integer :: first_sweeps = 2000, trial_factorisations = 30
    real(wp) :: trial_share = 0.4_wp
  end type turns_t

  !> One method: its impulses, without units, e1 of its last turn, operations, those that its next factorisation takes
  type :: method_t
    real(wp), allocatable :: r(:, :)
    real(wp) :: e1 = huge(1.0_wp), operations = 0, asks = 0
  end type method_t

  !> Methods that factorise, between two turns
  type :: factors_t
    type(contact_system_t) :: system
    type(path_t) :: path
    type(approach_t) :: approach
    logical :: is_possible = .true.
  end type factors_t

contains

  !> Turns until the solve is over; the best answer is kept in the progress.
  subroutine take_turns(turns, anderson, interior, proximal, problem, scaled, scale, progress)
    type(turns_t), intent(in) :: turns !! how operations are shared
    type(anderson_t), intent(in) :: anderson !! settings of accelerated sweeps
    type(interior_point_t), intent(in) :: interior !! of interior points
    type(proximal_t), intent(in) :: proximal !! of proximal points
    type(matrix_problem_t), intent(in) :: problem !! problem to solve
    type(matrix_problem_t), intent(inout) :: scaled !! the same without units, after accelerated sweeps
    real(wp), intent(in), contiguous :: scale(:) !! impulse [N s] that 1 stands for
    type(progress_t), intent(inout) :: progress !! how far the solve has come
    type(method_t) :: methods(3)
    type(factors_t) :: factors
    real(wp) :: before, length
    integer :: m

    methods(accelerated)%r = scaled%r
    call take_best(scaled, scale, progress)
    methods(plain)%r = scaled%r
    methods(factorising)%r = scaled%r
    methods%e1 = progress%best
    methods(accelerated)%operations = progress%operations
    call factors%system%prepare(problem, scaled)
    factors%is_possible = factors%system%is_possible(has_sparse_library())
    do while (.not. progress%is_over)
      m = next_method(turns, methods, factors, progress)
      before = progress%operations
      length = max(real(turns%sweeps, wp)*progress%sweep_operations, turns%length*before)
      call progress%begin_turn(length)
      scaled%r = methods(m)%r
      select case (m)
      case (plain)
        call sweep_turn(problem, scaled, scale, progress)
      case (accelerated)
        call sweep_accelerated(anderson, problem, scaled, scale, huge(1), progress)
      case default
        call factorise_turn(interior, proximal, max(length, credit(turns, methods, factors, progress)), problem, scaled, scale, &
                            factors, methods(m), progress)
      end select
      methods(m)%r = scaled%r
      if (progress%turn_e1 < huge(1.0_wp)) methods(m)%e1 = progress%turn_e1
      methods(m)%operations = methods(m)%operations + progress%operations - before
    end do
    call factors%system%free()
  end subroutine take_turns

  !> The method that is most behind its share.
  pure integer function next_method(turns, methods, factors, progress) result(next)
    type(turns_t), intent(in) :: turns
    type(method_t), intent(in) :: methods(3)
    type(factors_t), intent(in) :: factors
    type(progress_t), intent(in) :: progress
    real(wp) :: behind(3), shares(3), own

    own = credit(turns, methods, factors, progress)
    shares = turns%share
    if (on_trial(turns, methods(factorising), factors)) shares(factorising) = turns%trial_share
    ! Those that cannot pay for a factorisation leave their share to the method ahead.
    if (.not. factors%is_possible .or. methods(factorising)%asks > own) shares(factorising) = 0
    associate (ahead => minloc(methods%e1, 1, shares > 0))
      shares(ahead) = max(shares(ahead), 1 - (sum(shares) - shares(ahead)))
    end associate
    behind = shares*progress%operations - methods%operations
    if (methods(factorising)%operations < first_operations(turns, progress)) behind(factorising) = huge(own)
    next = maxloc(behind, 1, shares > 0)
  end function next_method

  !> Operations that methods which factorise may spend now.
  pure real(wp) function credit(turns, methods, factors, progress)
    type(turns_t), intent(in) :: turns
    type(method_t), intent(in) :: methods(3)
    type(factors_t), intent(in) :: factors
    type(progress_t), intent(in) :: progress
    real(wp) :: share

    share = turns%share
    if (on_trial(turns, methods(factorising), factors)) share = turns%trial_share
    if (minloc(methods%e1, 1) == factorising) share = 1 - 2*turns%share
    credit = max(share*progress%operations, first_operations(turns, progress)) - methods(factorising)%operations
  end function credit

  !> Operations with which methods that factorise begin.
  pure real(wp) function first_operations(turns, progress)
    type(turns_t), intent(in) :: turns
    type(progress_t), intent(in) :: progress

    first_operations = real(turns%first_sweeps, wp)*progress%sweep_operations
  end function first_operations

  !> Have methods that factorise made too few factorisations to be judged?
  pure logical function on_trial(turns, method, factors)
    type(turns_t), intent(in) :: turns
    type(method_t), intent(in) :: method
    type(factors_t), intent(in) :: factors

    on_trial = method%operations < real(turns%trial_factorisations, wp)*factors%system%factor%operations .or. &
               .not. factors%path%has_begun
  end function on_trial

  !> Plain sweeps until the turn is over, with a test after each quarter of it.
  subroutine sweep_turn(problem, scaled, scale, progress)
    type(matrix_problem_t), intent(in) :: problem
    type(matrix_problem_t), intent(inout) :: scaled
    real(wp), intent(in), contiguous :: scale(:)
    type(progress_t), intent(inout) :: progress
    integer :: i, n

    n = max(1, int(min((progress%turn_end - progress%operations)/(4*progress%sweep_operations), 1e8_wp)))
    do while (.not. progress%must_yield())
      do i = 1, min(n, progress%options%maximum_iterations - progress%iterations)
        call sweep(scaled, scaled%r)
        call progress%count_sweeps(1)
        if (modulo(i, 20) == 0) then
          if (progress%is_late()) exit
        end if
      end do
      call progress%look(problem, scaled%r, scale)
    end do
  end subroutine sweep_turn

  !> Interior points, or proximal points from the best answer where their path is blocked.
  subroutine factorise_turn(interior, proximal, most, problem, scaled, scale, factors, method, progress)
    type(interior_point_t), intent(in) :: interior
    type(proximal_t), intent(in) :: proximal
    real(wp), intent(in) :: most !! operations that a factorisation may take
    type(matrix_problem_t), intent(in) :: problem
    type(matrix_problem_t), intent(inout) :: scaled
    real(wp), intent(in), contiguous :: scale(:)
    type(factors_t), intent(inout) :: factors
    type(method_t), intent(inout) :: method
    type(progress_t), intent(inout) :: progress

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
  end subroutine factorise_turn
end module sg_method_turns
