!> Proximal points around a nonsmooth Newton method (doc/theory/solvers_proximal.md).
!!
!! Outer loop: r_(k+1) solves the problem of W + alpha with q - alpha r_k, which is well posed where W alone is not; alpha falls
!! while that is easy. Inner loop: Newton's method with a line search on the natural map. Where it fails, alpha rises, the map
!! changes its scale, and a few sweeps move the point.
module sg_proximal_newton
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_accelerated_nlgs, only: accelerated_state_t, anderson_t, sweep_accelerated
  use sg_block_map, only: natural_map, project_all
  use sg_block_progress, only: progress_t
  use sg_block_scaling, only: scale_problem
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_matrix_sweeps, only: sweep
  use sg_newton_map, only: newton_step, newton_sweeps
  use sg_report, only: report_t
  use sg_sparse, only: multiply
  use sg_sparse_factor, only: has_sparse_library, largest_full, sparse_factor_t
  implicit none
  private
  public :: approach_t, proximal_newton_t, proximal_t, approach

  !> Settings, for a problem without units
  type :: proximal_t
    !> First and least weight of the proximal term, over the mean diagonal of W
    real(wp) :: first_alpha = 1e-2_wp, least_alpha = 1e-10_wp
    !> How alpha changes: after an easy inner solve, a hard one, and one that failed
    real(wp) :: fall = 0.2_wp, rise = 2, jump = 10
    !> Newton steps up to which an inner solve is easy, from which it is hard, and after which it has failed
    integer :: easy = 6, hard = 12, most_steps = 25
    !> Halvings of a Newton step
    integer :: most_halvings = 12
    !> Fall of the natural map that an inner solve must reach, times min(1, alpha)
    real(wp) :: accuracy = 0.1_wp
    !> Scales of the map (impulse per velocity), taken in turn when an inner solve fails
    real(wp) :: rho(3) = [50.0_wp, 5.0_wp, 500.0_wp]
    !> Sweeps after an inner solve that failed
    integer :: sweeps = 20
  end type proximal_t

  !> Where proximal points stand between two turns: weight of the proximal term (none before the first), place in the scales of
  !! the map, inner solves that failed in a row; steps and impulses of an inner solve that the turn has cut; factors
  type :: approach_t
    real(wp), private :: alpha = -1
    integer, private :: scale = 1, failures = 0, steps = 0
    real(wp), allocatable, private :: next(:, :)
    type(sparse_factor_t) :: factors
  contains
    procedure :: drop_steps => approach_drop_steps
  end type approach_t

  !> The solver; an iteration is a Newton step, with one factorisation, or a sweep
  type, extends(matrix_solver_t) :: proximal_newton_t
    type(proximal_t) :: proximal
    !> Sweeps before the first Newton step
    integer :: first_sweeps = 30
  contains
    procedure :: solve => proximal_newton_solve
  end type proximal_newton_t

contains

  !> A few sweeps, then proximal points until e1 is small enough; accelerated sweeps where this build cannot factorise.
  subroutine proximal_newton_solve(self, problem, report)
    class(proximal_newton_t), intent(inout) :: self
    type(matrix_problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    type(matrix_problem_t) :: scaled
    type(progress_t) :: progress
    type(accelerated_state_t) :: sweeps
    type(approach_t) :: state
    real(wp), allocatable :: scale(:)
    logical :: is_possible

    call progress%begin(problem, self%options)
    if (.not. progress%is_over) then
      allocate (scale(problem%n))
      call scale_problem(problem, scaled, scale)
      call sweep_and_look(self%first_sweeps, problem, scaled, scale, scaled%r, progress)
      call approach(self%proximal, problem, scaled, scale, state, progress, is_possible)
      if (.not. is_possible) call sweep_accelerated(anderson_t(), problem, scaled, scale, huge(1), sweeps, progress)
    end if
    call progress%finish(problem, report)
  end subroutine proximal_newton_solve

  !> Proximal points until the solve or the turn is over, or a factorisation is too dear; `scaled` holds the impulses.
  subroutine approach(settings, problem, scaled, scale, state, progress, is_possible)
    type(proximal_t), intent(in) :: settings !! settings
    type(matrix_problem_t), intent(in) :: problem !! problem to solve
    type(matrix_problem_t), intent(inout) :: scaled !! the same without units; gets the impulses
    real(wp), intent(in), contiguous :: scale(:) !! impulse [N s] that 1 stands for
    type(approach_t), intent(inout) :: state !! where the points stand; its factors are freed
    type(progress_t), intent(inout) :: progress !! how far the solve has come
    logical, intent(out) :: is_possible !! can this build factorise systems of this size?
    real(wp), allocatable :: next(:, :)
    real(wp) :: e1
    integer :: steps
    logical :: has_solved, is_cut

    is_possible = has_sparse_library() .or. scaled%d*scaled%n <= largest_full
    if (.not. is_possible) return
    if (state%alpha < 0) state%alpha = settings%first_alpha
    associate (alpha => state%alpha, i => state%scale, failures => state%failures, factors => state%factors)
      do while (.not. progress%must_yield())
        call solve_inner(settings, scaled, state, progress, has_solved, is_cut)
        if (is_cut) exit
        steps = state%steps
        call move_alloc(state%next, next)
        if (has_solved) then
          failures = 0
          scaled%r = next
          call project_all(scaled%friction, next)
          call progress%look(problem, next, scale)
          if (steps <= settings%easy) alpha = max(settings%fall*alpha, settings%least_alpha)
          if (steps > settings%hard) alpha = settings%rise*alpha
        else
          failures = failures + 1
          alpha = min(settings%jump*alpha, 1/settings%first_alpha)
          i = modulo(i, size(settings%rho)) + 1
          e1 = progress%e1
          if (failures > 2) next = scaled%r
          call project_all(scaled%friction, next)
          call sweep_and_look(settings%sweeps, problem, scaled, scale, next, progress)
          if (progress%e1 < e1 .or. failures > 2) scaled%r = next
        end if
      end do
      if (.not. allocated(state%next)) call project_all(scaled%friction, scaled%r)
      call factors%free()
    end associate
  end subroutine approach

  !> Forget the inner solve that a turn has cut: the impulses to go on from are others.
  pure subroutine approach_drop_steps(self)
    class(approach_t), intent(inout) :: self

    if (allocated(self%next)) deallocate (self%next)
  end subroutine approach_drop_steps

  !> Some sweeps, and a look at what they gave.
  subroutine sweep_and_look(sweeps, problem, scaled, scale, r, progress)
    integer, intent(in) :: sweeps
    type(matrix_problem_t), intent(in) :: problem, scaled
    real(wp), intent(in), contiguous :: scale(:)
    real(wp), intent(inout), contiguous :: r(:, :)
    type(progress_t), intent(inout) :: progress
    integer :: i

    do i = 1, sweeps
      call sweep(scaled, r)
    end do
    call progress%count_sweeps(sweeps)
    call progress%look(problem, r, scale)
  end subroutine sweep_and_look

  !> Newton's method with a line search for the problem of W + alpha, q - alpha r; it goes on where a turn has cut it.
  subroutine solve_inner(settings, scaled, state, progress, has_solved, is_cut)
    type(proximal_t), intent(in) :: settings
    type(matrix_problem_t), intent(in) :: scaled
    type(approach_t), intent(inout) :: state
    type(progress_t), intent(inout) :: progress
    logical, intent(out) :: has_solved, is_cut
    real(wp), allocatable :: u(:, :), f(:, :)
    real(wp) :: norm, goal
    logical :: is_stuck

    allocate (u, f, mold=scaled%r)
    associate (alpha => state%alpha, rho => settings%rho(state%scale), centre => scaled%r)
      call evaluate(scaled, alpha, rho, centre, centre, u, f, norm)
      goal = settings%accuracy*min(1.0_wp, alpha)*norm
      if (.not. allocated(state%next)) then
        state%next = centre
        state%steps = 0
        ! No loop over points without steps may last for ever.
        if (norm <= goal) progress%iterations = progress%iterations + 1
      else
        call evaluate(scaled, alpha, rho, centre, state%next, u, f, norm)
      end if
    end associate
    is_cut = .false.
    do
      has_solved = norm <= goal
      if (has_solved .or. state%steps >= settings%most_steps) return
      is_cut = progress%must_yield() .or. progress%is_late()
      if (is_cut) return
      call take_newton_step(settings, scaled, state, progress, u, f, norm, is_stuck)
      is_cut = state%factors%is_too_dear
      if (is_stuck) return
    end do
  end subroutine solve_inner

  !> One step of Newton's method, as long as the map falls.
  subroutine take_newton_step(settings, scaled, state, progress, u, f, norm, is_stuck)
    type(proximal_t), intent(in) :: settings
    type(matrix_problem_t), intent(in) :: scaled
    type(approach_t), intent(inout) :: state
    type(progress_t), intent(inout) :: progress
    real(wp), intent(inout), contiguous :: u(:, :), f(:, :)
    real(wp), intent(inout) :: norm
    logical, intent(out) :: is_stuck
    type(error_t), allocatable :: error
    real(wp), allocatable :: step(:, :), start(:, :)
    real(wp) :: last, length, before
    integer :: i

    is_stuck = .true.
    associate (r => state%next, rho => settings%rho(state%scale), factors => state%factors)
      allocate (step, mold=r)
      before = factors%operations
      call newton_step(scaled, state%alpha, rho, r, u, f, factors, step, error)
      if (factors%is_too_dear) then
        progress%operations = progress%operations + factors%operations - before
        return
      end if
      state%steps = state%steps + 1
      call progress%count_factorisation(factors%operations - before, newton_sweeps)
      if (allocated(error)) return
      if (.not. all(ieee_is_finite(step))) return
      start = r
      last = norm
      length = 1
      do i = 1, settings%most_halvings
        r = start + length*step
        call evaluate(scaled, state%alpha, rho, scaled%r, r, u, f, norm)
        is_stuck = .not. norm <= (1 - 1e-4_wp*length)*last
        if (.not. is_stuck) return
        progress%operations = progress%operations + progress%sweep_operations
        length = length/2
      end do
      r = start
    end associate
  end subroutine take_newton_step

  !> Velocities with the proximal term, the natural map, and its norm.
  subroutine evaluate(scaled, alpha, rho, centre, r, u, f, norm)
    type(matrix_problem_t), intent(in) :: scaled
    real(wp), intent(in) :: alpha, rho
    real(wp), intent(in), contiguous :: centre(:, :), r(:, :)
    real(wp), intent(out), contiguous :: u(:, :), f(:, :)
    real(wp), intent(out) :: norm

    call multiply(scaled%w, r, u)
    u = u + scaled%q + alpha*(r - centre)
    call natural_map(scaled%friction, rho, r, u, f)
    norm = sqrt(sum(f**2))
  end subroutine evaluate
end module sg_proximal_newton
