!> Interior points: few iterations, each with one factorisation, whatever the height of a packing (doc/theory/interior_point.md).
!!
!! First the convex problem without the shift of Coulomb's law, then the law itself, with the shift smoothed; at each decade of
!! the error a few steps of Newton's method on the natural map try to finish. Where the path is blocked, proximal points do.
module sg_interior_point
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_accelerated_nlgs, only: anderson_t, sweep_accelerated
  use sg_block_map, only: natural_map, project, project_all
  use sg_block_progress, only: progress_t
  use sg_block_scaling, only: scale_problem
  use sg_error, only: error_t
  use sg_interior_point_step, only: point_t, start_point, take_step
  use sg_interior_point_system, only: contact_system_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_newton_map, only: newton_step
  use sg_proximal_newton, only: approach, proximal_t
  use sg_report, only: report_t
  use sg_sparse, only: multiply
  use sg_sparse_factor, only: has_sparse_library, largest_full, sparse_factor_t
  implicit none
  private
  public :: interior_point_t, follow_path, take_best

  !> The solver; an iteration is one factorisation, of the interior point method or of Newton's
  type, extends(matrix_solver_t) :: interior_point_t
    !> The shift comes in when the convex problem's own error is below this part of Coulomb's
    real(wp) :: convex_part = 0.5_wp
    !> e1, over that of zero impulses, below which Newton's method tries to finish; by how much e1 must fall before it tries
    !! again, and its steps
    real(wp) :: finish_below = 1e-3_wp, finish_again = 0.1_wp
    integer :: finish_steps = 6
    !> e1 of a guess, over that of zero impulses, below which Newton's method starts from it
    real(wp) :: guess_below = 1e-2_wp
    !> Iterations after which the path is blocked, when e1 has not fallen by a tenth along it
    integer :: patience = 12
    !> Where the path is blocked: factorisations of the first turn of proximal points, each of which has twice those of the last,
    !! and sweeps between two turns
    integer :: first_turn = 200, sweeps = 200
  contains
    procedure :: solve => interior_point_solve
  end type interior_point_t

contains

  !> Follow the path, finish by Newton's method; proximal points where the path is blocked.
  subroutine interior_point_solve(self, problem, report)
    class(interior_point_t), intent(inout) :: self
    type(matrix_problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    type(contact_system_t) :: system
    type(matrix_problem_t) :: scaled
    type(progress_t) :: progress
    type(anderson_t) :: anderson
    real(wp), allocatable :: scale(:)
    integer :: most
    logical :: is_possible

    call progress%begin(problem, self%options)
    if (.not. progress%is_over) then
      allocate (scale(problem%n))
      call scale_problem(problem, scaled, scale)
      call system%prepare(problem, scaled)
      if (system%is_possible(has_sparse_library())) call follow_path(self, problem, scaled, scale, system, progress)
      call system%free()
      if (.not. progress%is_over) then
        call take_best(scaled, scale, progress)
        most = self%first_turn
        do while (.not. progress%is_over)
          call approach(proximal_t(), problem, scaled, scale, most, progress, is_possible)
          call sweep_accelerated(anderson, problem, scaled, scale, merge(self%sweeps, huge(1), is_possible), progress)
          most = 2*min(most, 100000000)
        end do
      end if
    end if
    call progress%finish(problem, report)
  end subroutine interior_point_solve

  !> Interior points until the solve is over or the path blocked.
  subroutine follow_path(self, problem, scaled, scale, system, progress)
    class(interior_point_t), intent(in) :: self !! settings
    type(matrix_problem_t), intent(in) :: problem !! problem to solve
    type(matrix_problem_t), intent(inout) :: scaled !! the same without units; holds the guess
    real(wp), intent(in), contiguous :: scale(:) !! impulse [N s] that 1 stands for
    type(contact_system_t), intent(inout) :: system !! linear system of these contacts, prepared; freed by the caller
    type(progress_t), intent(inout) :: progress !! how far the solve has come
    type(sparse_factor_t) :: newton_factors
    type(point_t) :: point
    real(wp) :: length, finish_at, mark, scale_e1
    integer :: idle
    logical :: is_done

    scale_e1 = e1_of_nothing(problem)
    if (progress%e1 < self%guess_below*scale_e1) call finish(self, problem, scaled, scale, scaled%r, newton_factors, progress)
    is_done = .false.
    if (.not. progress%is_over) then
      call start_point(scaled, system, point, is_done)
      call count_one(progress)
    end if
    finish_at = self%finish_below*scale_e1
    mark = huge(mark)
    idle = 0
    do while (is_done)
      call progress%look(problem, point%r, scale)
      if (progress%is_over) exit
      idle = idle + 1
      if (progress%e1 < 0.9_wp*mark) then
        mark = progress%e1
        idle = 0
      end if
      if (idle > self%patience) exit
      if (progress%e1 < finish_at) then
        finish_at = self%finish_again*progress%e1
        call finish(self, problem, scaled, scale, point%r, newton_factors, progress)
        if (progress%is_over) exit
      end if
      if (.not. point%has_shift) point%has_shift = is_convex_solved(self%convex_part, scaled, point)
      call take_step(scaled, system, point, length, is_done)
      call count_one(progress)
    end do
    call newton_factors%free()
  end subroutine follow_path

  !> e1 of zero impulses: where far contacts make q large, it is small.
  pure real(wp) function e1_of_nothing(problem) result(e1)
    type(matrix_problem_t), intent(in) :: problem
    real(wp) :: f(problem%d, problem%n)

    call natural_map(problem%friction, 1.0_wp, 0*problem%q, problem%q, f)
    e1 = norm2(f)/max(norm2(problem%q), tiny(e1))
  end function e1_of_nothing

  !> One more factorisation.
  pure subroutine count_one(progress)
    type(progress_t), intent(inout) :: progress

    progress%iterations = progress%iterations + 1
    progress%factorisations = progress%factorisations + 1
  end subroutine count_one

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
    real(wp) :: norm, tried_norm, alpha, length
    integer :: i

    if (.not. has_sparse_library() .and. scaled%d*scaled%n > largest_full) return
    allocate (u, f, step, tried, mold=start)
    r = start
    call evaluate(scaled, rho, r, u, f, norm)
    alpha = 1e-6_wp
    do i = 1, self%finish_steps
      call newton_step(scaled, alpha, rho, r, u, f, factors, step, error)
      call count_one(progress)
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
