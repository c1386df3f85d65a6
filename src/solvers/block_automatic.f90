!> The default: accelerated sweeps while they get on; when they do not, interior points once, then proximal points with Newton's
!! method and sweeps in turns (doc/theory/solvers_sweeps.md).
module sg_block_automatic
  use sg_accelerated_nlgs, only: anderson_t, sweep_accelerated
  use sg_block_progress, only: progress_t
  use sg_block_scaling, only: scale_problem
  use sg_interior_point, only: follow_path, interior_point_t, take_best
  use sg_interior_point_system, only: contact_system_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_proximal_newton, only: approach, proximal_t
  use sg_report, only: report_t
  use sg_sparse_factor, only: has_sparse_library
  implicit none
  private
  public :: block_automatic_t

  !> The solver; an iteration is a sweep, or a step with one factorisation
  type, extends(matrix_solver_t) :: block_automatic_t
    type(anderson_t) :: anderson
    type(proximal_t) :: proximal
    type(interior_point_t) :: interior
    !> Sweeps of a turn, which goes on while each such number lowers e1 by `fall`
    integer :: sweeps = 200
    real(wp) :: fall = 0.1_wp
    !> Factorisations of the first turn of Newton's method; each turn has twice those of the last
    integer :: factorisations = 200
  contains
    procedure :: solve => block_automatic_solve
  end type block_automatic_t

contains

  !> Sweeps, interior points, and proximal points and sweeps in turns, until e1 is small enough.
  subroutine block_automatic_solve(self, problem, report)
    class(block_automatic_t), intent(inout) :: self
    type(matrix_problem_t), intent(inout) :: problem !! problem to solve
    type(report_t), intent(out) :: report !! effort and errors
    type(matrix_problem_t) :: scaled
    type(contact_system_t) :: system
    type(progress_t) :: progress
    real(wp), allocatable :: scale(:)
    integer :: most
    logical :: is_possible

    call progress%begin(problem, self%options)
    most = self%factorisations
    is_possible = .true.
    allocate (scale(problem%n))
    if (.not. progress%is_over) then
      call scale_problem(problem, scaled, scale)
      call sweep_on(self, is_possible, problem, scaled, scale, progress)
    end if
    if (.not. progress%is_over) then
      call system%prepare(problem, scaled)
      if (system%is_possible(has_sparse_library())) call follow_path(self%interior, problem, scaled, scale, system, progress)
      call system%free()
      call take_best(scaled, scale, progress)
    end if
    do while (.not. progress%is_over)
      if (is_possible) call approach(self%proximal, problem, scaled, scale, most, progress, is_possible)
      most = 2*min(most, 100000000)
      call sweep_on(self, is_possible, problem, scaled, scale, progress)
    end do
    call progress%finish(problem, report)
  end subroutine block_automatic_solve

  !> Accelerated sweeps as long as they get on, or as there is nothing else.
  subroutine sweep_on(self, has_other, problem, scaled, scale, progress)
    class(block_automatic_t), intent(in) :: self
    logical, intent(in) :: has_other
    type(matrix_problem_t), intent(in) :: problem
    type(matrix_problem_t), intent(inout) :: scaled
    real(wp), intent(in), contiguous :: scale(:)
    type(progress_t), intent(inout) :: progress
    real(wp) :: before

    do
      before = progress%best
      call sweep_accelerated(self%anderson, problem, scaled, scale, self%sweeps, progress)
      if (progress%is_over .or. has_other .and. progress%best > self%fall*before) exit
    end do
  end subroutine sweep_on
end module sg_block_automatic
