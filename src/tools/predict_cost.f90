!> Predicted cost of runs of a scene on many ranks: splits into more and more parts, each with its real interfaces, and the
!! program's own kernels timed on the largest part (doc/performance.md). Nothing is run.
module sg_predict_cost
  use sg_assemble, only: assemble
  use sg_comm, only: comm_t
  use sg_cost_model, only: dual_iteration, machine_t, prediction_t, primal_iteration
  use sg_error, only: error_t
  use sg_gluing, only: rehearse_gluing
  use sg_interfaces, only: find_interfaces, interfaces_t
  use sg_kinds, only: wp, i4
  use sg_load, only: measured_weights
  use sg_problem, only: problem_t
  use sg_process_swap, only: first_subdomain
  use sg_records, only: first_inverse
  use sg_residuals, only: n_error_sums, sum_errors
  use sg_run_options, only: solver_options_t
  use sg_simulation, only: simulation_t
  use sg_start_split, only: find_contacts, split_bodies
  use sg_sweep_order, only: set_order, sweep_order_t
  use sg_sweeps, only: sweep
  use sg_timers, only: cpu_now
  implicit none
  private
  public :: predict_cost

  !> Least seconds of one timing, and how many are made of each: the shortest is the undisturbed one
  real(wp), parameter :: least_seconds = 0.02_wp
  integer, parameter :: tries = 3

contains

  !> Predict the cost of an iteration on 1, 2, 4, ... ranks up to a number, and on that number. Where the options ask for so many
  !! subdomains, it is their number at most, and the ranks share them.
  !!
  !! All ranks that the program was started on measure at the same time, as in a run they would; the slowest counts.
  subroutine predict_cost(sim, most, comm, machine, predictions, error)
    type(simulation_t), intent(inout) :: sim !! its scene and options are set
    integer, intent(in) :: most !! number of ranks to end at
    type(comm_t), intent(inout) :: comm !! ranks that measure
    type(machine_t), intent(inout) :: machine !! messages are set; the other costs are found
    type(prediction_t), allocatable, intent(out) :: predictions(:) !! one for each number of ranks
    type(error_t), allocatable, intent(out) :: error !! set when the scene cannot be split so
    integer, allocatable :: ranks(:)
    real(wp), allocatable :: load(:)
    real(wp) :: check
    integer :: i, last

    call find_contacts(sim, error)
    if (allocated(error)) return
    call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, sim%options%substep_length(), sim%problem)
    load = measured_weights(sim%contacts, sim%scene%bodies%is_grain, sim%scene%bodies%n_own)
    machine%check_every = sim%options%solver%typical_gap()
    machine%item_bytes = 8*real(first_inverse(sim%problem%kind) - 1, wp)
    machine%glue = glue_seconds(sim%problem)
    check = check_seconds(sim%problem)/real(machine%check_every, wp)
    call comm%maximum(machine%glue)
    call comm%maximum(check)
    last = most
    if (sim%options%partition%parts > 0) last = min(most, sim%options%partition%parts)
    ranks = [pack([(2**i, i=0, 30)], [(2**i < last, i=0, 30)]), last]
    allocate (predictions(size(ranks)))
    do i = 1, size(ranks)
      call predict_split(sim, load, ranks(i), check, comm, machine, predictions(i), error)
      if (allocated(error)) return
      associate (one => predictions(1)%dual%seconds, of => predictions(i))
        ! An iteration without contacts costs nothing on any number of ranks.
        if (of%dual%seconds > 0) of%dual_efficiency = one/(real(ranks(i), wp)*of%dual%seconds)
        if (of%primal%seconds > 0) of%primal_efficiency = one/(real(ranks(i), wp)*of%primal%seconds)
      end associate
    end do
  end subroutine predict_cost

  !> Split into parts, time updates on the largest, and put the cost on so many ranks together.
  subroutine predict_split(sim, load, ranks, check, comm, machine, prediction, error)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: load(:), check
    integer, intent(in) :: ranks
    type(comm_t), intent(inout) :: comm
    type(machine_t), intent(inout) :: machine
    type(prediction_t), intent(inout) :: prediction
    type(error_t), allocatable, intent(out) :: error
    type(interfaces_t) :: split
    integer(i4), allocatable :: part(:), owner(:)
    integer, allocatable :: rank(:)
    integer :: boxes(3), parts, r

    parts = max(ranks, sim%options%partition%parts)
    call split_bodies(sim, load, parts, boxes, part, error)
    if (allocated(error)) return
    call find_interfaces(sim%contacts, part, parts, owner, split)
    rank = [(spread(r, 1, first_subdomain(r + 1, ranks, parts) - first_subdomain(r, ranks, parts)), r=0, ranks - 1)]
    prediction%ranks = ranks
    prediction%contacts = sim%contacts%n
    prediction%largest = maxval([(sum(split%owned, rank == r), r=0, ranks - 1)])
    prediction%shared_grains = split%shared_grains
    machine%update = update_seconds(sim%problem, owner == maxloc(split%owned, 1), sim%options%solver)
    call comm%maximum(machine%update)
    machine%update = machine%update + check
    prediction%update = machine%update
    prediction%dual = dual_iteration(machine, split, rank)
    prediction%primal = primal_iteration(machine, split, rank)
  end subroutine predict_split

  !> CPU seconds of an update, when some contacts are swept again and again.
  real(wp) function update_seconds(problem, is_wanted, options) result(seconds)
    type(problem_t), intent(in) :: problem
    logical, intent(in) :: is_wanted(:)
    type(solver_options_t), intent(in) :: options
    type(sweep_order_t) :: order
    real(wp), allocatable :: body(:, :)
    real(wp) :: start, spent
    integer :: try, sweeps

    seconds = 0
    call set_order(order, problem, is_wanted, options)
    if (order%n == 0) return
    allocate (body(size(problem%body, 1), problem%n_bodies))
    body(:, :) = problem%body(:, :problem%n_bodies)
    call sweep(problem%kind, order, problem%n_bodies, 1.0_wp, body)
    seconds = huge(1.0_wp)
    do try = 1, tries
      sweeps = 0
      start = cpu_now()
      do
        call sweep(problem%kind, order, problem%n_bodies, 1.0_wp, body)
        sweeps = sweeps + 1
        spent = cpu_now() - start
        if (spent > least_seconds) exit
      end do
      seconds = min(seconds, spent/(real(sweeps, wp)*real(order%n, wp)))
    end do
  end function update_seconds

  !> CPU seconds per contact of a test of convergence.
  real(wp) function check_seconds(problem) result(seconds)
    type(problem_t), intent(in) :: problem
    real(wp) :: sums(n_error_sums), start
    integer :: try

    seconds = 0
    if (problem%n_contacts == 0) return
    seconds = huge(1.0_wp)
    do try = 1, tries
      start = cpu_now()
      call sum_errors(problem, .false., sums)
      seconds = min(seconds, cpu_now() - start)
    end do
    ! What was summed is asked for, so that no compiler leaves it out.
    if (sums(1) < -huge(1.0_wp)) seconds = 0
    seconds = seconds/real(problem%n_contacts, wp)
  end function check_seconds

  !> CPU seconds of gluing one grain, messages apart: bodies as far apart in memory as those along a cut are.
  real(wp) function glue_seconds(problem) result(seconds)
    type(problem_t), intent(inout) :: problem
    integer, parameter :: times = 20
    integer, allocatable :: slots(:)
    real(wp) :: start
    integer :: try, i, stride

    seconds = 0
    if (problem%n_bodies == 0) return
    stride = max(1, problem%n_bodies/2000)
    slots = [(i, i=1, problem%n_bodies, stride)]
    seconds = huge(1.0_wp)
    do try = 1, tries
      start = cpu_now()
      call rehearse_gluing(problem, slots, times)
      seconds = min(seconds, cpu_now() - start)
    end do
    seconds = seconds/(real(times, wp)*real(size(slots), wp))
  end function glue_seconds
end module sg_predict_cost
