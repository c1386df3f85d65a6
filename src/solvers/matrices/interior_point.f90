!> Interior points: few iterations, each with one factorisation, whatever the height of a packing (doc/theory/interior_point.md).
!!
!! First the convex problem without the shift of Coulomb's law, then the law itself, with the shift smoothed; at each decade of
!! the error a few steps of Newton's method on the natural map try to finish. Where the path is blocked, sweeps with momentum go
!! on from the solution of the convex problem, as they do on several ranks, in turns with proximal points, and with accelerated
!! sweeps where they do not get ahead.
module sg_interior_point
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_accelerated_nlgs, only: accelerated_state_t, anderson_t, sweep_accelerated
  use sg_block_map, only: natural_map, project, project_all
  use sg_block_nesterov, only: nesterov_state_t, sweep_nesterov
  use sg_block_progress, only: progress_t
  use sg_block_scaling, only: scale_problem
  use sg_error, only: error_t
  use sg_interior_point_step, only: point_t, start_point, take_step
  use sg_interior_point_system, only: contact_system_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_newton_map, only: newton_step, newton_sweeps
  use sg_proximal_newton, only: approach, approach_t, proximal_t
  use sg_report, only: report_t
  use sg_sparse, only: multiply
  use sg_sparse_factor, only: has_sparse_library, largest_full, sparse_factor_t
  implicit none
  private
  public :: interior_point_t, path_t, follow_path, take_best

  !> Sweeps with momentum between two tests
  integer, parameter :: sweeps_between_tests = 50

  !> The solver; an iteration is one factorisation, of the interior point method or of Newton's
  type, extends(matrix_solver_t) :: interior_point_t
    !> The shift comes in when the convex problem's own error is below this part of Coulomb's
    real(wp) :: convex_part = 0.5_wp
    !> The same for the guess of sweeps with momentum, and its steps at most
    real(wp) :: guess_part = 0.1_wp
    integer :: guess_steps = 20
    !> e1, over that of zero impulses, below which Newton's method tries to finish; by how much e1 must fall before it tries
    !! again, and its steps
    real(wp) :: finish_below = 1e-3_wp, finish_again = 0.1_wp
    integer :: finish_steps = 6
    !> e1 of a guess, over that of zero impulses, below which Newton's method starts from it
    real(wp) :: guess_below = 1e-2_wp
    !> Iterations after which the path is blocked, when e1 has not fallen by a tenth along it
    integer :: patience = 12
    !> Where the path is blocked proximal points and sweeps with momentum take turns, each of so many sweeps at least, or of these
    !! shares of all that was done
    integer :: turn_sweeps = 200
    real(wp) :: momentum_share = 0.25_wp, proximal_share = 0.25_wp, accelerated_share = 0.1_wp
    !> Proximal points go on from the answer of sweeps where these have lowered e1 below this part; else accelerated sweeps have
    !! their turn too
    real(wp) :: behind = 0.5_wp
    !> Time of a step beside its factors, in sweeps
    integer :: step_sweeps = 8
  contains
    procedure :: solve => interior_point_solve
  end type interior_point_t

  !> Where the path stands between two turns
  type :: path_t
    !> Is there a point on it; and is it blocked, so that there is no way on?
    logical :: has_begun = .false., is_blocked = .false.
    type(point_t), private :: point
    !> The last point without the shift, where it has come in
    type(point_t), allocatable, private :: convex
    type(sparse_factor_t), private :: newton_factors
    !> e1 below which Newton's method tries to finish, least e1 of note along the path, and iterations since
    real(wp), private :: finish_at = 0, mark = huge(1.0_wp)
    integer, private :: idle = 0
  end type path_t

contains

  !> Follow the path, finish by Newton's method; sweeps with momentum and proximal points where the path is blocked.
  subroutine interior_point_solve(self, problem, report)
    class(interior_point_t), intent(inout) :: self
    type(matrix_problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    type(contact_system_t) :: system
    type(matrix_problem_t) :: scaled
    type(progress_t) :: progress
    type(path_t) :: path
    real(wp), allocatable :: scale(:)

    call progress%begin(problem, self%options)
    if (.not. progress%is_over) then
      allocate (scale(problem%n))
      call scale_problem(problem, scaled, scale)
      call system%prepare(problem, scaled)
      if (system%is_possible(has_sparse_library())) call follow_path(self, problem, scaled, scale, system, path, progress)
      call take_best(scaled, scale, progress)
      call go_on(self, problem, scaled, scale, system, path, progress)
      call system%free()
    end if
    call progress%finish(problem, report)
  end subroutine interior_point_solve

  !> Go on where the path is blocked: proximal points from the best answer, and in turns with them sweeps with momentum and, where
  !! these do not get ahead, accelerated ones from the best answer.
  subroutine go_on(self, problem, scaled, scale, system, path, progress)
    class(interior_point_t), intent(in) :: self
    type(matrix_problem_t), intent(in) :: problem
    type(matrix_problem_t), intent(inout) :: scaled
    real(wp), intent(in), contiguous :: scale(:)
    type(contact_system_t), intent(inout) :: system
    type(path_t), intent(inout) :: path
    type(progress_t), intent(inout) :: progress
    type(approach_t) :: state
    type(accelerated_state_t) :: accelerated
    real(wp), allocatable :: swept(:, :)
    real(wp) :: best
    logical :: is_possible

    do while (.not. progress%is_over)
      call begin_turn(self%proximal_share)
      call approach(proximal_t(), problem, scaled, scale, state, progress, is_possible)
      if (progress%is_over) exit
      if (.not. allocated(swept)) call find_guess(self, problem, scaled, scale, system, path%convex, swept, progress)
      best = progress%best
      call begin_turn(self%momentum_share)
      call sweep_turn(problem, swept, progress)
      if (progress%best < self%behind*best) then
        call take_best(scaled, scale, progress)
        call state%drop_steps()
      else if (.not. progress%is_over) then
        call begin_turn(self%accelerated_share)
        accelerated = accelerated_state_t()
        call sweep_accelerated(anderson_t(), problem, scaled, scale, huge(1), accelerated, progress)
      end if
    end do
  contains
    subroutine begin_turn(share)
      real(wp), intent(in) :: share

      call progress%begin_turn(max(real(self%turn_sweeps, wp)*progress%sweep_operations, share*progress%operations))
    end subroutine begin_turn
  end subroutine go_on

  !> Impulses that sweeps with momentum start from: those of the convex problem, or the best so far where the shift never came in.
  subroutine find_guess(self, problem, scaled, scale, system, point, r, progress)
    class(interior_point_t), intent(in) :: self
    type(matrix_problem_t), intent(in) :: problem, scaled
    real(wp), intent(in), contiguous :: scale(:)
    type(contact_system_t), intent(inout) :: system
    type(point_t), allocatable, intent(inout) :: point !! where the path of the convex problem was left, if it was
    real(wp), allocatable, intent(out) :: r(:, :) !! the impulses [N s]
    type(progress_t), intent(inout) :: progress
    logical :: is_done
    integer :: i

    r = progress%answer
    if (.not. allocated(point)) return
    do i = 1, self%guess_steps
      if (progress%is_over .or. is_convex_solved(self%guess_part, scaled, point)) exit
      call go_along(self, scaled, system, point, is_done, progress)
      if (.not. is_done) exit
      call progress%look(problem, point%r, scale)
    end do
    do i = 1, scaled%n
      r(:, i) = scale(i)*point%r(:, i)
    end do
  end subroutine find_guess

  !> Sweeps until the turn is over, with momentum that begins with the turn.
  subroutine sweep_turn(problem, r, progress)
    type(matrix_problem_t), intent(in) :: problem
    real(wp), allocatable, intent(inout) :: r(:, :) !! impulses [N s]
    type(progress_t), intent(inout) :: progress
    type(nesterov_state_t) :: state

    call move_alloc(r, state%r)
    do while (.not. progress%must_yield())
      call sweep_nesterov(problem, sweeps_between_tests, state, progress)
    end do
    call move_alloc(state%r, r)
  end subroutine sweep_turn

  !> Interior points until the solve or the turn is over, the path blocked, or a factorisation too dear.
  subroutine follow_path(self, problem, scaled, scale, system, path, progress)
    class(interior_point_t), intent(in) :: self !! settings
    type(matrix_problem_t), intent(in) :: problem !! problem to solve
    type(matrix_problem_t), intent(inout) :: scaled !! the same without units; holds the guess where the path has not begun
    real(wp), intent(in), contiguous :: scale(:) !! impulse [N s] that 1 stands for
    type(contact_system_t), intent(inout) :: system !! linear system of these contacts, prepared; freed by the caller
    type(path_t), intent(inout) :: path !! where the path stands
    type(progress_t), intent(inout) :: progress !! how far the solve has come

    if (.not. path%has_begun) call begin_path(self, problem, scaled, scale, system, path, progress)
    do while (path%has_begun .and. .not. (path%is_blocked .or. progress%must_yield()))
      call walk_on(self, problem, scaled, scale, system, path, progress)
      if (system%factor%is_too_dear) exit
    end do
    call path%newton_factors%free()
  end subroutine follow_path

  !> Try to finish from the guess, or else take the first point.
  subroutine begin_path(self, problem, scaled, scale, system, path, progress)
    class(interior_point_t), intent(in) :: self
    type(matrix_problem_t), intent(in) :: problem
    type(matrix_problem_t), intent(inout) :: scaled
    real(wp), intent(in), contiguous :: scale(:)
    type(contact_system_t), intent(inout) :: system
    type(path_t), intent(inout) :: path
    type(progress_t), intent(inout) :: progress
    real(wp) :: scale_e1, before
    logical :: is_done

    scale_e1 = e1_of_nothing(problem)
    path%newton_factors%most_operations = system%factor%most_operations
    if (progress%best < self%guess_below*scale_e1) &
      call finish(self, problem, scaled, scale, scaled%r, path%newton_factors, progress)
    if (progress%is_over) return
    before = system%factor%operations
    call start_point(scaled, system, path%point, is_done)
    call count_step(before, system%factor, self%step_sweeps, progress)
    if (system%factor%is_too_dear) return
    path%has_begun = .true.
    path%is_blocked = .not. is_done
    path%finish_at = self%finish_below*scale_e1
  end subroutine begin_path

  !> Look at the present point, try to finish from it, and take a step.
  subroutine walk_on(self, problem, scaled, scale, system, path, progress)
    class(interior_point_t), intent(in) :: self
    type(matrix_problem_t), intent(in) :: problem
    type(matrix_problem_t), intent(inout) :: scaled
    real(wp), intent(in), contiguous :: scale(:)
    type(contact_system_t), intent(inout) :: system
    type(path_t), intent(inout) :: path
    type(progress_t), intent(inout) :: progress
    logical :: is_done

    call progress%look(problem, path%point%r, scale)
    if (progress%is_over) return
    path%idle = path%idle + 1
    if (progress%e1 < 0.9_wp*path%mark) then
      path%mark = progress%e1
      path%idle = 0
    end if
    path%is_blocked = path%idle > self%patience
    if (path%is_blocked) return
    if (progress%e1 < path%finish_at) then
      path%finish_at = self%finish_again*progress%e1
      path%newton_factors%most_operations = system%factor%most_operations
      call finish(self, problem, scaled, scale, path%point%r, path%newton_factors, progress)
      if (progress%is_over) return
    end if
    if (.not. path%point%has_shift) then
      if (is_convex_solved(self%convex_part, scaled, path%point)) then
        path%convex = path%point
        path%point%has_shift = .true.
      end if
    end if
    call go_along(self, scaled, system, path%point, is_done, progress)
    path%is_blocked = .not. (is_done .or. system%factor%is_too_dear)
  end subroutine walk_on

  !> Take a step along the path, and count it.
  subroutine go_along(self, scaled, system, point, is_done, progress)
    class(interior_point_t), intent(in) :: self
    type(matrix_problem_t), intent(in) :: scaled
    type(contact_system_t), intent(inout) :: system
    type(point_t), intent(inout) :: point
    logical, intent(out) :: is_done !! did the system have a solution?
    type(progress_t), intent(inout) :: progress
    real(wp) :: length, before

    before = system%factor%operations
    call take_step(scaled, system, point, length, is_done)
    call count_step(before, system%factor, self%step_sweeps, progress)
  end subroutine go_along

  !> Count a step: a factorisation, or the analysis of one that was refused.
  pure subroutine count_step(before, factor, sweeps, progress)
    real(wp), intent(in) :: before
    type(sparse_factor_t), intent(in) :: factor
    integer, intent(in) :: sweeps
    type(progress_t), intent(inout) :: progress

    if (factor%is_too_dear) then
      progress%operations = progress%operations + factor%operations - before
    else
      call progress%count_factorisation(factor%operations - before, sweeps)
    end if
  end subroutine count_step

  !> e1 of zero impulses: where far contacts make q large, it is small.
  pure real(wp) function e1_of_nothing(problem) result(e1)
    type(matrix_problem_t), intent(in) :: problem
    real(wp) :: f(problem%d, problem%n)

    call natural_map(problem%friction, 1.0_wp, 0*problem%q, problem%q, f)
    e1 = norm2(f)/max(norm2(problem%q), tiny(e1))
  end function e1_of_nothing

  !> Is the problem without the shift solved as far as is of use?
  pure logical function is_convex_solved(part, scaled, point) result(is_solved)
    real(wp), intent(in) :: part
    type(matrix_problem_t), intent(in) :: scaled
    type(point_t), intent(in) :: point
    real(wp) :: x(scaled%d), squares(2)
    integer :: a

    squares = 0
    do a = 1, scaled%n
      x = point%r(:, a) - point%u(:, a)
      call project(scaled%friction(a), x)
      squares(1) = squares(1) + sum((point%r(:, a) - x)**2)
      x = point%r(:, a) - point%u(:, a)
      x(1) = x(1) - scaled%friction(a)*norm2(point%u(2:, a))
      call project(scaled%friction(a), x)
      squares(2) = squares(2) + sum((point%r(:, a) - x)**2)
    end do
    is_solved = squares(1) < part**2*squares(2)
  end function is_convex_solved

  !> A few steps of Newton's method on the natural map, with a proximal term about each point that rises where a step fails.
  subroutine finish(self, problem, scaled, scale, start, factors, progress)
    class(interior_point_t), intent(in) :: self
    type(matrix_problem_t), intent(in) :: problem, scaled
    real(wp), intent(in), contiguous :: scale(:), start(:, :)
    type(sparse_factor_t), intent(inout) :: factors
    type(progress_t), intent(inout) :: progress
    real(wp), parameter :: rho = 50, least_alpha = 1e-12_wp, most_alpha = 1
    type(error_t), allocatable :: error
    real(wp), allocatable :: r(:, :), u(:, :), f(:, :), step(:, :), tried(:, :)
    real(wp) :: norm, tried_norm, alpha, length, before
    integer :: i

    if (.not. has_sparse_library() .and. scaled%d*scaled%n > largest_full) return
    allocate (u, f, step, tried, mold=start)
    r = start
    call evaluate(scaled, rho, r, u, f, norm)
    alpha = 1e-6_wp
    do i = 1, self%finish_steps
      before = factors%operations
      call newton_step(scaled, alpha, rho, r, u, f, factors, step, error)
      call count_step(before, factors, newton_sweeps, progress)
      if (factors%is_too_dear) exit
      length = 0
      if (.not. allocated(error)) then
        if (all(ieee_is_finite(step))) length = 1
      end if
      do while (length > 0.2_wp)
        tried = r + length*step
        call evaluate(scaled, rho, tried, u, f, tried_norm)
        if (tried_norm < (1 - 0.1_wp*length)*norm) exit
        length = length/2
      end do
      if (length > 0.2_wp) then
        if (length > 0.9_wp) alpha = max(least_alpha, 0.1_wp*alpha)
        r = tried
        norm = tried_norm
        call project_all(scaled%friction, tried)
        call progress%look(problem, tried, scale)
        if (progress%is_over) exit
      else
        alpha = 100*alpha
        if (alpha > most_alpha) exit
        call evaluate(scaled, rho, r, u, f, norm)
      end if
    end do
  end subroutine finish

  !> Velocities, the natural map, and its norm.
  subroutine evaluate(scaled, rho, r, u, f, norm)
    type(matrix_problem_t), intent(in) :: scaled
    real(wp), intent(in) :: rho
    real(wp), intent(in), contiguous :: r(:, :)
    real(wp), intent(out), contiguous :: u(:, :), f(:, :)
    real(wp), intent(out) :: norm

    call multiply(scaled%w, r, u)
    u = u + scaled%q
    call natural_map(scaled%friction, rho, r, u, f)
    norm = norm2(f)
  end subroutine evaluate

  !> Make the best answer so far the impulses of the problem without units.
  pure subroutine take_best(scaled, scale, progress)
    type(matrix_problem_t), intent(inout) :: scaled !! problem without units; gets the impulses
    real(wp), intent(in), contiguous :: scale(:) !! impulse [N s] that 1 stands for
    type(progress_t), intent(in) :: progress !! holds the best answer
    integer :: a

    do a = 1, scaled%n
      scaled%r(:, a) = progress%answer(:, a)/scale(a)
    end do
  end subroutine take_best
end module sg_interior_point
