!> Interior points in packs on any number of ranks: without friction they solve the step, with friction they lead to an answer, and
!> laws that are no cones are left to the rounds (doc/theory/interior_point.md, "Several ranks").
program test_interior_ranks
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, next_problem, pack_deck, start_pack
  use same_bits, only: same
  use sg_comm, only: comm_t
  use sg_dual, only: dual_t
  use sg_error, only: error_t
  use sg_interior_point_ranks, only: interior_ranks_t
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e8
  use sg_simulation, only: decompose, simulation_t
  use sg_subdomain, only: subdomain_t
  use subdomain_tests, only: on_subdomains
  implicit none
  character(len=*), parameter :: law = 'friction = 0.0'
  type(tests_t) :: t

  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm
    character(len=:), allocatable :: linear
    integer :: at

    call test_pack(comm, 'frictionless disks', pack_deck('frictionless disks'), 1e-10_wp, .true.)
    call test_pack(comm, 'disks', pack_deck('disks'), 1e-6_wp, .false.)
    call test_pack(comm, 'spheres', pack_deck('spheres'), 1e-6_wp, .false.)
    linear = pack_deck('frictionless disks')
    at = index(linear, law)
    linear = linear(:at - 1)//'kind = "LINEAR"'//new_line('a')//'epsilon = 0.6'//linear(at + len(law):)
    call test_pack(comm, 'linear disks', linear, 1e-6_wp, .false.)
  end subroutine run_tests

  !> A pack at rest, split along x, cold: converged, and where the problem is convex without a round beyond the first test, with the
  !! velocities that sweeps find.
  subroutine test_pack(comm, name, deck, tolerance, is_convex)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name, deck
    real(wp), intent(in) :: tolerance
    logical, intent(in) :: is_convex
    type(simulation_t), pointer :: sim
    type(problem_t) :: problem, solved, traced, swept
    type(subdomain_t) :: coupling
    type(interior_ranks_t) :: interior
    type(dual_t) :: dual
    type(report_t) :: report, of_trace, of_dual
    real(wp) :: largest
    integer :: w, k

    sim => fresh()
    call split_pack(comm, name, deck, 60, sim)
    if (comm%size == 1) return
    call next_problem(sim, problem)
    problem%impulse = 0
    coupling = sim%decomposition%subdomain%by_slot(sim%pairs%slot_of)
    interior%options = sim%options%solver
    interior%options%criterion = criterion_e8
    interior%options%tolerance = tolerance
    interior%options%check_every = 20
    interior%options%maximum_sweeps = 50000
    solved = problem
    call interior%solve(solved, coupling, sim%comm, report)
    call t%check(report%is_converged .and. report%e8 <= tolerance, name//' converges')
    ! 17 at most were measured on 2 to 4 ranks, in space.
    call t%check(report%iterations <= 25*report%factorisations, name//': iterations per factorisation are few')
    call t%equal(report%failed_systems, 0, name//': all systems are solved')
    interior%with_trace = .true.
    traced = problem
    call interior%solve(traced, coupling, sim%comm, of_trace)
    call t%equal(count(of_trace%trace%iteration == 0), of_trace%factorisations + 1, name//': the history has the steps')
    call t%check(same(traced%impulse, solved%impulse), name//': a history changes no bit')
    call t%check(of_trace%messages == report%messages, name//': messages of a history do not count')
    if (.not. is_convex) return
    call t%check(report%factorisations > 0 .and. report%factorisations < 40, name//': factorisations are few')
    call t%equal(report%sweeps, interior%options%check_every, name//': rounds have nothing left to do')
    dual%options = interior%options
    swept = problem
    call dual%solve(swept, coupling, sim%comm, of_dual)
    call t%check(of_dual%sweeps > report%sweeps, name//': sweeps alone take longer')
    w = first_inverse(problem%kind) - 1
    largest = maxval(abs(problem%body(:w, :problem%n_bodies)))
    call comm%maximum(largest)
    ! Velocities of a convex problem are unique; sweeps come this near at their tolerance.
    do k = 1, problem%n_contacts
      call t%check(all(abs(solved%body(:w, problem%pair(:, k)) - swept%body(:w, problem%pair(:, k))) <= 1e-6_wp*largest), &
                   name//': velocities as sweeps find them')
    end do
  end subroutine test_pack

  !> A pack after some steps on one rank, split along x.
  subroutine split_pack(comm, name, deck, steps, sim)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name, deck
    integer, intent(in) :: steps
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable :: error

    call start_pack(t, comm, name, deck, 1e-3_wp, sim)
    call advance_pack(t, name, sim, steps)
    if (comm%size == 1) return
    sim%comm = comm
    sim%options%partition%boxes = [comm%size, 1, 1]
    call decompose(sim, error)
    call advance_pack(t, name, sim, 2)
  end subroutine split_pack
end program test_interior_ranks
