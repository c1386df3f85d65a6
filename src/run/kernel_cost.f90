!> Cost of a contact update in a run, compared with that of the bare kernel on the same data, within one process.
!!
!! The *bare kernel* sweeps contacts that stand in their order, again and again, and does nothing else. The *solver* solves the
!! same problem from the same guess with as many sweeps: it chooses the active set, puts contacts in order, sweeps, copies
!! impulses back, tests.
module sg_kernel_cost
  use sg_active_set, only: active_set_t
  use sg_compact, only: add_impulses
  use sg_kinds, only: wp
  use sg_nlgs, only: nlgs_t
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_residuals, only: measure_errors
  use sg_run_options, only: solver_options_t
  use sg_sweep_order, only: set_order, sweep_order_t
  use sg_sweeps, only: sweep
  use sg_timers, only: cpu_now
  implicit none
  private
  public :: kernel_cost_t, compare_cost

  !> Times that both are measured in turns; contact updates of one time, at least, for the resolution of the clock
  integer, parameter :: turns = 5
  real(wp), parameter :: fewest_updates = 4e6_wp

  !> CPU seconds of one contact update, the least of all turns: an undisturbed one
  type :: kernel_cost_t
    !> By the bare kernel, by the solver's sweeps, and by the whole solver; zero where nothing was measured
    real(wp) :: kernel = 0, sweeps = 0, solver = 0
    !> Contacts visited, and sweeps of one solve
    integer :: visited = 0, n_sweeps = 0
  end type kernel_cost_t

contains

  !> Measure both.
  subroutine compare_cost(problem, options, n_sweeps, cost)
    type(problem_t), intent(in) :: problem !! to solve: impulses guessed, bodies at their free velocities
    type(solver_options_t), intent(in) :: options !! options of the run
    integer, intent(in) :: n_sweeps !! sweeps of a solve
    type(kernel_cost_t), intent(out) :: cost !! CPU seconds per contact update
    integer :: turn, repeats

    if (problem%n_contacts == 0 .or. n_sweeps < 1) return
    cost%n_sweeps = n_sweeps
    repeats = max(1, nint(fewest_updates/(real(problem%n_contacts, wp)*real(n_sweeps, wp))))
    cost%kernel = huge(1.0_wp)
    cost%sweeps = huge(1.0_wp)
    cost%solver = huge(1.0_wp)
    do turn = 1, turns
      call time_kernel(problem, options, n_sweeps, repeats, cost)
      call time_solver(problem, options, n_sweeps, repeats, cost)
    end do
  end subroutine compare_cost

  !> Time sweeps in a fixed order.
  subroutine time_kernel(problem, options, n_sweeps, repeats, cost)
    type(problem_t), intent(in) :: problem
    type(solver_options_t), intent(in) :: options
    integer, intent(in) :: n_sweeps, repeats
    type(kernel_cost_t), intent(inout) :: cost
    type(problem_t) :: solved
    type(sweep_order_t) :: order
    type(report_t) :: report
    type(active_set_t) :: active_set
    real(wp) :: start, seconds
    integer :: i, k

    seconds = 0
    do k = 1, repeats
      solved = problem
      call add_impulses(solved)
      call active_set%begin(problem%n_contacts, .false.)
      call active_set%look(problem)
      if (.not. any(active_set%is_wanted(:problem%n_contacts))) then
        call active_set%want_all(problem%n_contacts)
      else if (active_set%is_calm) then
        call active_set%choose_by_guess(problem)
      else
        call active_set%reserve(problem%n_contacts)
        call measure_errors(solved, report, with_e1=.false., closing=active_set%closing)
        call active_set%choose(problem%n_contacts, report)
      end if
      call set_order(order, solved, active_set%is_wanted, options)
      start = cpu_now()
      do i = 1, n_sweeps
        call sweep(solved%kind, order, solved%n_bodies, options%relaxation, solved%body)
      end do
      seconds = seconds + cpu_now() - start
    end do
    cost%visited = order%n
    cost%kernel = min(cost%kernel, seconds/(real(repeats, wp)*real(n_sweeps, wp)*real(max(1, order%n), wp)))
  end subroutine time_kernel

  !> Time the solver that a run has.
  subroutine time_solver(problem, options, n_sweeps, repeats, cost)
    type(problem_t), intent(in) :: problem
    type(solver_options_t), intent(in) :: options
    integer, intent(in) :: n_sweeps, repeats
    type(kernel_cost_t), intent(inout) :: cost
    type(problem_t) :: solved
    type(nlgs_t) :: solver
    type(report_t) :: report
    real(wp) :: start, seconds, sweeping, updates
    integer :: k

    solver%options = options
    solver%has_momentum = options%method == 'nesterov'
    solver%options%tolerance = 0
    solver%options%maximum_sweeps = n_sweeps
    seconds = 0
    sweeping = 0
    updates = 0
    do k = 1, repeats
      solved = problem
      start = cpu_now()
      call solver%solve(solved, report)
      seconds = seconds + cpu_now() - start
      sweeping = sweeping + report%cpu_sweeps
      updates = updates + real(report%contact_updates, wp)
    end do
    cost%sweeps = min(cost%sweeps, sweeping/max(1.0_wp, updates))
    cost%solver = min(cost%solver, seconds/max(1.0_wp, updates))
  end subroutine time_solver
end module sg_kernel_cost
