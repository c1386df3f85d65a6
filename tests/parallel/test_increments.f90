!> Criteria that look at increments: several ranks find the value that one rank finds, and sweeps that leave contacts out find that
!! of all.
program test_increments_ranks
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, can_be_made, next_problem, pack_deck, start_pack
  use sg_choose_solver, only: choose_solver
  use sg_comm, only: comm_t
  use sg_compact, only: add_impulses
  use sg_contact_sets, only: contact_sets_t
  use sg_error, only: error_t
  use sg_increments, only: increment_value, increments_t, n_increment_maxima, n_increment_sums
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_run_options, only: criterion_maxm, criterion_names, criterion_qm16, criterion_quad, solver_options_t
  use sg_simulation, only: decompose, simulation_t
  use sg_sweep_order, only: set_order, sweep_order_t
  use sg_text, only: to_text
  use sg_whole_errors, only: whole_errors_t
  use subdomain_tests, only: on_subdomains
  implicit none
  character(len=*), parameter :: gluings(3) = [character(len=8) :: 'dual', 'primal', 'momentum']
  integer, parameter :: criteria(3) = [criterion_quad, criterion_maxm, criterion_qm16]
  type(tests_t) :: t

  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm
    integer :: i

    do i = 1, size(gluings)
      call test_pack(comm, 'disks', trim(gluings(i)))
    end do
    ! Not by `momentum`, which drops a trace of an impulse that the guess has, and so counts a contact less.
    call test_pack(comm, 'pressed disks', 'dual')
    call test_pack(comm, 'pressed disks', 'primal')
    call test_pack(comm, 'frictionless disks', 'dual')
    call test_pack(comm, 'polygons', 'primal')
    call test_pack(comm, 'spheres', 'dual')
    if (can_be_made('polyhedra')) call test_pack(comm, 'polyhedra', 'primal')
  end subroutine run_tests

  !> Compare the criteria of the guess of a step.
  subroutine test_pack(comm, name, gluing)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name, gluing
    type(simulation_t), pointer :: sim
    type(problem_t) :: problem
    type(report_t) :: report
    type(error_t), allocatable :: error
    real(wp) :: values(size(criteria))
    integer :: c

    sim => fresh()
    call start_pack(t, comm, name, pack_deck(name), 1e-3_wp, sim)
    call advance_pack(t, name, sim, 60)
    sim%comm = comm
    sim%options%partition%gluing = gluing
    sim%options%partition%boxes = [comm%size, 1, 1]
    sim%options%solver%maximum_sweeps = 0
    call values_of_one(comm, name, values)
    if (comm%size == 1) then
      call test_left_out(comm, name, 2, values)
      call test_left_out(comm, name, 10, values)
    end if
    if (comm%size == 1) return
    call decompose(sim, error)
    call t%check(.not. allocated(error), name//': split')
    do c = 1, size(criteria)
      if (c == 1) call next_problem(sim, problem)
      sim%problem = problem
      sim%options%solver%criterion = criteria(c)
      call choose_solver(sim%options%solver, sim%options%partition, comm%size, sim%solver, error)
      call sim%solver%solve(sim%problem, sim%decomposition%subdomain%by_slot(sim%pairs%slot_of), sim%comm, report)
      ! Sums of some hundred numbers, of velocities to which the guess of all contacts adds.
      call t%near(report%criterion, values(c), 1e-9_wp*values(c), &
                  name//', '//gluing//': '//trim(criterion_names(criteria(c))))
    end do
  end subroutine test_pack

  !> The same where sweeps leave one contact of some out: errors of few of them are measured apart from those side by side.
  subroutine test_left_out(comm, name, every, values)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    integer, intent(in) :: every !! one of so many is left out
    real(wp), intent(in) :: values(:)
    type(problem_t) :: problem
    type(contact_sets_t) :: sets
    type(whole_errors_t) :: errors
    type(report_t) :: report
    integer :: c, k

    call make_problem(comm, name, problem)
    call sets%begin(problem, solver_options_t(criterion=criterion_quad))
    sets%active_set%is_wanted(:problem%n_contacts) = [(modulo(k, every) > 0, k=1, problem%n_contacts)]
    call sets%arrange(problem)
    call t%equal(sets%order(1)%n, problem%n_contacts - problem%n_contacts/every, name//': the others are visited')
    do c = 1, size(criteria)
      errors%criterion = criteria(c)
      call errors%prepare(problem, .false., comm)
      call errors%begin(problem, .true., sets, comm)
      call errors%finish(report, comm)
      call t%near(errors%increments, values(c), 1e-9_wp*values(c), name//', one of '//to_text(every)// &
                  ' left out: '//trim(criterion_names(criteria(c))))
      if (every > 4) call t%check(sets%errors%is_set .eqv. sets%order(1)%lanes%n_groups > 0, name//': errors side by side')
    end do
  end subroutine test_left_out

  !> The same by one rank that holds all.
  subroutine values_of_one(comm, name, values)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    real(wp), intent(out) :: values(:)
    type(problem_t) :: problem
    type(increments_t) :: increments
    type(sweep_order_t) :: order
    real(wp) :: sums(n_increment_sums), maxima(n_increment_maxima)
    logical, allocatable :: is_wanted(:)
    integer :: c

    call make_problem(comm, name, problem)
    allocate (is_wanted(problem%n_contacts), source=.true.)
    call set_order(order, problem, is_wanted, solver_options_t(criterion=criterion_quad))
    call increments%measure(problem, order, sums, maxima)
    do c = 1, size(criteria)
      values(c) = increment_value(criteria(c), sums, maxima)
    end do
    call t%check(all(values > 1e-6_wp), name//': the guess is not the solution')
    call t%check(values(2) > values(1) .and. values(2) > values(3), name//': maxm is the largest of them')
  end subroutine values_of_one

  !> The problem of a step on one rank, under its guess.
  subroutine make_problem(comm, name, problem)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(problem_t), intent(out) :: problem
    type(simulation_t), pointer :: sim

    sim => fresh()
    call start_pack(t, comm, name, pack_deck(name), 1e-3_wp, sim)
    call advance_pack(t, name, sim, 60)
    call next_problem(sim, problem)
    call add_impulses(problem)
  end subroutine make_problem
end program test_increments_ranks
