!> Any solver of problems given by matrices as the solver of a run: the step's problem is written as matrices, solved, and its
!! impulses are brought back.
!!
!! Those solvers stop on e1. Where the deck asks for another criterion, e1 is lowered until that holds, of impulses over a
!! typical mass where that is far from 1 kg: e1 adds impulses and velocities, so that grains of a micrometre would have a small
!! one whatever they do. Problems that have no matrices, those with linear laws, are solved by sweeps.
module sg_by_matrices
  use sg_comm, only: comm_t
  use sg_compact, only: add_impulses
  use sg_convergence, only: convergence_t, scales_of
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_solver_t
  use sg_nlgs, only: nlgs_t
  use sg_problem, only: bytes_per_contact, problem_t
  use sg_problem_matrices, only: matrices_map_t, matrices_of
  use sg_problem_records, only: contact_of, contact_record_t
  use sg_report, only: report_t, trace_point_t
  use sg_residuals, only: find_worst, measure_errors
  use sg_run_options, only: criterion_e1, solver_options_t
  use sg_solver, only: solver_t
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: tables_t
  use sg_timers, only: cpu_now
  implicit none
  private
  public :: solve_by_matrices_t

  !> e1 below which no other criterion makes a solver go: rounding is near
  real(wp), parameter :: least_e1 = 1e-13_wp
  !> Mobility of contacts from which on, or below the inverse of which, impulses are scaled [1/kg]
  real(wp), parameter :: far_from_one = 1e5_wp
  !> The estimate of the error of the impulses is this many e8: what it is at least for sweeps
  real(wp), parameter :: e8_to_estimate = 100

  !> A solver of matrices for the problems of a run
  type, extends(solver_t) :: solve_by_matrices_t
    !> Options of the deck
    type(solver_options_t) :: options
    !> Solver of the matrices
    class(matrix_solver_t), allocatable :: solver
    !> Solver of problems without matrices
    type(nlgs_t) :: sweeps
  contains
    procedure :: solve_coupled => solve_by_matrices
    procedure :: list_tables => list_matrices
  end type solve_by_matrices_t

contains

  !> Solve a problem by its matrices, on one rank.
  subroutine solve_by_matrices(self, problem, coupling, comm, report)
    class(solve_by_matrices_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem to solve
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks: none
    type(comm_t), intent(inout) :: comm !! this rank alone
    type(report_t), intent(out) :: report !! effort and errors
    type(matrix_problem_t) :: matrices
    type(matrices_map_t) :: map
    type(error_t), allocatable :: error
    real(wp) :: start

    start = cpu_now()
    report%bytes_per_contact = bytes_per_contact(problem)
    if (problem%n_contacts == 0) return
    if (.not. self%options%warm_start) problem%impulse = 0
    call matrices_of(problem, .false., matrices, map, error)
    if (allocated(error)) then
      self%sweeps%options = self%options
      self%sweeps%with_trace = self%with_trace
      call self%sweeps%solve(problem, coupling, comm, report)
      return
    end if
    call solve_matrices(self, problem, matrices, map, start, report)
    report%is_finite = all(abs(problem%body) <= huge(1.0_wp))
    report%cpu_seconds = cpu_now() - start - report%apart%cpu
    report%cpu_sweeps = report%cpu_seconds
  end subroutine solve_by_matrices

  !> Matrices are given back after each solve: only sweeps keep tables.
  subroutine list_matrices(self, tables)
    class(solve_by_matrices_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%sweeps%list_tables(tables)
  end subroutine list_matrices

  !> Solve the matrices as closely as the criterion asks for; bodies get the velocities of the solution.
  subroutine solve_matrices(self, problem, matrices, map, start, report)
    class(solve_by_matrices_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(matrix_problem_t), intent(inout) :: matrices
    type(matrices_map_t), intent(in) :: map
    real(wp), intent(in) :: start !! of the solve, on the CPU clock
    type(report_t), intent(inout) :: report
    type(report_t) :: one
    type(convergence_t) :: convergence
    real(wp), allocatable :: free(:, :)
    real(wp) :: before, mobility

    call convergence%begin(self%options, .false., scales_of(problem))
    allocate (free, source=problem%body)
    mobility = 1
    if (self%options%criterion /= criterion_e1) mobility = typical_mobility(matrices)
    matrices%w%block = matrices%w%block/mobility
    matrices%r = matrices%r*mobility
    self%solver%options%tolerance = self%options%tolerance
    self%solver%options%maximum_iterations = self%options%maximum_sweeps
    self%solver%options%warm_start = self%options%warm_start
    self%solver%options%with_trace = self%with_trace
    do
      before = cpu_now() - start - report%apart%cpu
      call self%solver%solve(matrices, one)
      call bring_back(problem, map, matrices, mobility)
      problem%body = free
      call add_impulses(problem)
      call measure_errors(problem, report, with_e1=.true.)
      if (self%with_trace) call add_trace(report, one, before)
      call add_effort(report, one, problem%n_contacts)
      report%estimate = e8_to_estimate*report%e8
      ! There are no sweeps whose increments could be looked at.
      call convergence%decide(self%options, report, increments=report%estimate)
      if (convergence%must_look(report)) then
        call find_worst(problem, report%worst_contact, report%worst_speed)
        call convergence%confirm(report%worst_speed, report)
      end if
      if (report%is_converged .or. .not. one%is_converged) exit
      if (self%solver%options%tolerance <= least_e1) exit
      self%solver%options%tolerance = max(least_e1, self%solver%options%tolerance/10)
      self%solver%options%warm_start = .true.
    end do
    if (.not. report%is_converged) call find_worst(problem, report%worst_contact, report%worst_speed)
    call convergence%finish(report)
  end subroutine solve_matrices

  !> Velocity that an impulse brings to a contact, typically, as a power of four, so that neither dividing by it nor by its root
  !! rounds anything; 1 where it is not far from that [1/kg].
  pure real(wp) function typical_mobility(matrices) result(mobility)
    type(matrix_problem_t), intent(in) :: matrices
    real(wp) :: total
    integer :: a, k

    total = 0
    do a = 1, matrices%n
      if (matrices%w%diagonal(a) == 0) cycle
      do k = 1, matrices%d
        total = total + max(matrices%w%block(k, k, matrices%w%diagonal(a)), 0.0_wp)
      end do
    end do
    mobility = 1
    total = total/real(max(1, matrices%d*matrices%n), wp)
    if (total > far_from_one .or. (total > 0 .and. total < 1/far_from_one)) &
      mobility = set_exponent(1.0_wp, 2*(exponent(total)/2) + 1)
  end function typical_mobility

  !> Impulses of the matrices as the compact problem has them; contacts without any carry nothing.
  subroutine bring_back(problem, map, matrices, mobility)
    type(problem_t), intent(inout) :: problem
    type(matrices_map_t), intent(in) :: map
    type(matrix_problem_t), intent(in) :: matrices
    real(wp), intent(in) :: mobility !! by which impulses of the matrices are too large [1/kg]
    type(contact_record_t) :: contact
    real(wp) :: r(matrices%d)
    integer :: k

    problem%impulse = 0
    do k = 1, matrices%n
      r = matrices%r(:, k)/mobility
      r(1) = r(1) - map%cohesion(k)
      associate (impulse => problem%impulse(:, map%contact(k)))
        if (size(impulse) == 3) then
          contact = contact_of(problem, int(map%contact(k)))
          impulse = matmul(r, contact%h(:, 1:3, 1))
        else
          impulse = r(:size(impulse))
        end if
      end associate
    end do
  end subroutine bring_back

  !> Go on with the history by that of one solve more, whose effort is not added yet.
  subroutine add_trace(report, one, before)
    type(report_t), intent(inout) :: report
    type(report_t), intent(in) :: one
    real(wp), intent(in) :: before !! CPU seconds until that solve
    type(trace_point_t), allocatable :: both(:)
    integer :: n

    n = 0
    if (allocated(report%trace)) n = size(report%trace)
    allocate (both(n + size(one%trace)))
    if (n > 0) both(:n) = report%trace
    both(n + 1:) = one%trace
    both(n + 1:)%iteration = report%iterations + one%trace%iteration
    both(n + 1:)%contact_updates = report%contact_updates + one%trace%contact_updates
    both(n + 1:)%cpu_seconds = before + one%trace%cpu_seconds
    call move_alloc(both, report%trace)
    call report%apart%add(one%apart)
  end subroutine add_trace

  !> Add what one solve took.
  pure subroutine add_effort(report, one, n_contacts)
    type(report_t), intent(inout) :: report
    type(report_t), intent(in) :: one
    integer, intent(in) :: n_contacts

    report%sweeps = report%sweeps + merge(one%sweeps, one%iterations, one%sweeps > 0)
    report%contact_updates = report%contact_updates + one%contact_updates
    report%iterations = report%iterations + one%iterations
    report%factorisations = report%factorisations + one%factorisations
    report%checks = report%checks + max(one%checks, min(1, n_contacts))
  end subroutine add_effort
end module sg_by_matrices
