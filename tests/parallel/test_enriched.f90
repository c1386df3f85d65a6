!> The enriched interface in packs on any number of ranks: velocities of the answer are those of whole bodies under the impulses
!! of all ranks, one update solves linear interactions exactly (doc/theory/enriched.md), and matrices are factorised after tests
!! alone.
program test_enriched
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use packs, only: advance_pack, can_be_made, next_problem, pack_deck, start_pack
  use sg_comm, only: comm_t
  use sg_dual, only: dual_t
  use sg_enriched, only: enriched_t
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: active_place, first_inverse
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e8
  use sg_simulation, only: decompose, simulation_t
  use sg_subdomain, only: subdomain_t
  use subdomain_tests, only: on_subdomains
  implicit none
  !> Compliance of linear interactions [1/kg], about W of two disks
  real(wp), parameter :: epsilon = 0.6_wp
  type(tests_t) :: t

  call on_subdomains(run_tests)
  call t%finish()

contains

  !> All tests, as one of several subdomains.
  subroutine run_tests(comm)
    type(comm_t), intent(inout) :: comm

    call test_pack(comm, 'disks')
    call test_pack(comm, 'pressed disks')
    call test_pack(comm, 'polygons')
    call test_pack(comm, 'spheres')
    if (can_be_made('polyhedra')) call test_pack(comm, 'polyhedra')
    call test_linear(comm)
  end subroutine run_tests

  !> A pack at rest, split along x.
  subroutine test_pack(comm, name)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(simulation_t), pointer :: sim
    type(problem_t) :: problem, solved
    type(subdomain_t) :: coupling
    type(enriched_t) :: enriched
    type(report_t) :: report
    character(len=9), parameter :: preconditioners(3) = [character(len=9) :: 'mass', 'lumped', 'dirichlet']
    integer :: i

    sim => fresh()
    call split_pack(comm, name, pack_deck(name), 120, sim)
    if (comm%size == 1) return
    call next_problem(sim, problem)
    coupling = sim%decomposition%subdomain%by_slot(sim%pairs%slot_of)
    enriched%options = sim%options%solver
    enriched%options%criterion = criterion_e8
    enriched%options%tolerance = 1e-5_wp
    enriched%options%maximum_sweeps = 20000
    enriched%partition%sweeps = [5]
    do i = merge(1, size(preconditioners), name == 'pressed disks' .or. name == 'spheres'), size(preconditioners)
      enriched%preconditioner = preconditioners(i)
      solved = problem
      call enriched%solve(solved, coupling, sim%comm, report)
      call t%check(report%is_converged, name//' converges, '//trim(preconditioners(i)))
      call check_velocities(comm, name//', '//trim(preconditioners(i)), problem, solved, coupling, sim)
      call t%check(report%iterations > 0 .and. report%factorisations > 0, name//': effort is counted')
      call t%check(report%factorisations <= 2*(report%checks + 1), name//': factors are made after tests alone')
    end do
    call t%check(report%failed_factors == 0 .and. report%failed_systems == 0, name//': nothing failed')
    ! Polyhedra that lose such contacts are no problem for a test: the dual method does not converge either.
    if (name /= 'polyhedra') call test_inactive(comm, name, enriched, problem, coupling, sim)
    call test_failures(comm, name, enriched, problem, coupling, sim)
    call test_overshoot(comm, name, enriched, problem, coupling, sim)
  end subroutine test_pack

  !> Contacts of one rank cannot carry impulses on some bodies that it shares: its copies have their part of the mass all the same.
  subroutine test_inactive(comm, name, enriched, problem, coupling, sim)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(enriched_t), intent(inout) :: enriched
    type(problem_t), intent(in) :: problem
    type(subdomain_t), intent(in) :: coupling
    type(simulation_t), intent(inout) :: sim
    type(problem_t) :: changed, solved
    type(report_t) :: report
    integer :: k, i, changes

    changed = problem
    changes = 0
    do i = 1, merge(3, 0, comm%rank == 1)
      if (i > enriched%gluing%interface%n_shared) exit
      do k = 1, problem%n_contacts
        if (.not. any(problem%pair(:, k) == enriched%gluing%interface%slot(i))) cycle
        changed%record(active_place(problem%kind), k) = 0
        changed%impulse(:, k) = 0
        changes = changes + 1
      end do
    end do
    call comm%sum(changes)
    call t%check(changes > 0, name//': contacts that cannot carry')
    solved = changed
    call enriched%solve(solved, coupling, sim%comm, report)
    call t%check(report%is_converged, name//' converges with inactive contacts')
    call check_velocities(comm, name//', inactive contacts', changed, solved, coupling, sim)
  end subroutine test_inactive

  !> An interface system that cannot converge leaves the rest of the step to the dual method, and an eta in which masses are lost to
  !! rounding leaves the subdomain without a factor: both are counted, and the step converges.
  subroutine test_failures(comm, name, enriched, problem, coupling, sim)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(enriched_t), intent(in) :: enriched
    type(problem_t), intent(in) :: problem
    type(subdomain_t), intent(in) :: coupling
    type(simulation_t), intent(inout) :: sim
    type(enriched_t) :: failing
    type(problem_t) :: solved
    type(report_t) :: report
    integer :: failures

    failing%options = enriched%options
    failing%partition = enriched%partition
    failing%tolerance = 1e-12_wp
    failing%most_iterations = 1
    ! Without a guess there is work for more than one iteration.
    solved = problem
    solved%impulse = 0
    call failing%solve(solved, coupling, sim%comm, report)
    call t%equal(report%failed_systems, 1, name//': one system does not converge')
    call t%check(report%is_converged, name//' converges without it')
    call check_velocities(comm, name//', without a system', problem, solved, coupling, sim)
    failing%tolerance = enriched%tolerance
    failing%most_iterations = enriched%most_iterations
    failing%eta = 1e-30_wp
    solved = problem
    call failing%solve(solved, coupling, sim%comm, report)
    failures = report%failed_factors
    call comm%sum(failures)
    call t%check(failures > 0, name//': matrices have no factor')
    call t%check(report%is_converged, name//' converges without factors')
    call check_velocities(comm, name//', without factors', problem, solved, coupling, sim)
  end subroutine test_failures

  !> An eta for much stiffer contacts than one sweep per round answers with: rounds overshoot, and converge all the same.
  subroutine test_overshoot(comm, name, enriched, problem, coupling, sim)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(enriched_t), intent(inout) :: enriched
    type(problem_t), intent(in) :: problem
    type(subdomain_t), intent(in) :: coupling
    type(simulation_t), intent(inout) :: sim
    type(problem_t) :: solved
    type(report_t) :: report

    enriched%partition%sweeps = [1]
    enriched%eta = 1e-3_wp
    enriched%is_automatic = .false.
    solved = problem
    call enriched%solve(solved, coupling, sim%comm, report)
    call t%check(report%is_converged, name//' converges after overshooting')
    call check_velocities(comm, name//', overshooting', problem, solved, coupling, sim)
  end subroutine test_overshoot

  !> Velocities are those that the dual method finds under the same impulses.
  subroutine check_velocities(comm, name, problem, solved, coupling, sim)
    type(comm_t), intent(inout) :: comm
    character(len=*), intent(in) :: name
    type(problem_t), intent(in) :: problem, solved
    type(subdomain_t), intent(in) :: coupling
    type(simulation_t), intent(inout) :: sim
    ! Rounding of sums of interface impulses over some hundred rounds.
    real(wp), parameter :: rounding = 1e-10_wp
    type(problem_t) :: under
    type(dual_t) :: dual
    real(wp) :: largest
    integer :: w, k

    under = problem
    under%impulse(:, :) = solved%impulse
    dual%options = sim%options%solver
    call dual%sets%begin(under, dual%options)
    call dual%open(under, coupling, sim%comm)
    call dual%close(under, coupling, sim%comm)
    w = first_inverse(problem%kind) - 1
    largest = maxval(abs(problem%body(:w, :problem%n_bodies)))
    call comm%maximum(largest)
    do k = 1, problem%n_contacts
      call t%check(all(abs(solved%body(:w, problem%pair(:, k)) - under%body(:w, problem%pair(:, k))) <= rounding*largest), &
                   name//': velocities under all impulses')
    end do
  end subroutine check_velocities

  !> Disks whose pairs all resist their relative velocity: when each subdomain is solved to rounding, and eta is the compliance
  !! of the interactions, the second round begins with the exact interface impulses. The dual method is far from them then.
  subroutine test_linear(comm)
    type(comm_t), intent(inout) :: comm
    character(len=*), parameter :: law = 'friction = 0.0'
    type(simulation_t), pointer :: sim
    type(problem_t) :: problem, solved
    type(subdomain_t) :: coupling
    type(enriched_t) :: enriched
    type(dual_t) :: dual
    type(report_t) :: report, of_dual
    character(len=:), allocatable :: deck
    integer :: at

    sim => fresh()
    deck = pack_deck('frictionless disks')
    at = index(deck, law)
    deck = deck(:at - 1)//'kind = "LINEAR"'//new_line('a')//'epsilon = 0.6'//deck(at + len(law):)
    call split_pack(comm, 'linear interactions', deck, 5, sim)
    if (comm%size == 1) return
    call next_problem(sim, problem)
    problem%impulse = 0
    coupling = sim%decomposition%subdomain%by_slot(sim%pairs%slot_of)
    enriched%partition%sweeps = [2000]
    enriched%options = sim%options%solver
    enriched%options%maximum_sweeps = 2*enriched%partition%most_sweeps()
    enriched%options%check_every = enriched%options%maximum_sweeps + 1
    enriched%options%criterion = criterion_e8
    enriched%options%tolerance = tiny(1.0_wp)
    enriched%eta = epsilon
    enriched%scale = 'absolute'
    enriched%tolerance = 1e-14_wp
    solved = problem
    call enriched%solve(solved, coupling, sim%comm, report)
    dual%partition = enriched%partition
    dual%options = enriched%options
    solved = problem
    call dual%solve(solved, coupling, sim%comm, of_dual)
    call t%equal(report%gluings, 2, 'linear interactions: rounds')
    call t%check(report%e8 <= 1e-12_wp, 'linear interactions: one update solves them')
    call t%check(of_dual%e8 > 1e-6_wp, 'linear interactions: the dual method takes more')
  end subroutine test_linear

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
end program test_enriched
