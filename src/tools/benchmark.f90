!> Benchmark of sweeps: a generated packing through detection, assembly and solver, compared with a STREAM triad.
!!
!! The packing is a lattice that flows towards its centre, so that nearly all contacts carry impulses
!! (sg_benchmark_scenes). Everything measured is the program's own code on its own data.
module sg_benchmark
  use sg_assemble, only: assemble
  use sg_benchmark_scenes, only: make_lattice
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t
  use sg_detect, only: detect
  use sg_history, only: history_t
  use sg_kinds, only: wp
  use sg_motion, only: predict
  use sg_neighbour_list, only: neighbours_t
  use sg_nlgs, only: nlgs_t
  use sg_plan, only: make_plan, plan_t
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse, force_length
  use sg_report, only: report_t
  use sg_run_options, only: solver_options_t
  use sg_scene, only: scene_t
  use sg_system, only: peak_memory_bytes
  use sg_timers, only: cpu_now, wall_now
  implicit none
  private
  public :: benchmark_t, run_benchmark

  !> Figures of one benchmark
  type :: benchmark_t
    !> Contacts, those that carry an impulse, sweeps done
    integer :: contacts = 0, active_contacts = 0, sweeps = 0
    !> Contact updates per CPU second, tests of convergence included
    real(wp) :: updates_per_second = 0
    !> The same per second of the clock
    real(wp) :: updates_per_wall_second = 0
    !> Share of the solver's CPU time spent in tests of convergence
    real(wp) :: check_share = 0
    !> CPU seconds of one sweep, of a detection that makes the list of neighbours, of one that finds it made, of assembly
    real(wp) :: sweep_seconds = 0, first_detect_seconds = 0, detect_seconds = 0, assemble_seconds = 0
    !> Bytes that a triad moves per CPU second
    real(wp) :: triad = 0
    !> Bytes that a contact holds, and that one update moves
    real(wp) :: bytes_per_contact = 0, bytes_per_update = 0
    !> Bytes of the whole program per contact, at its largest
    real(wp) :: peak_per_contact = 0
    !> Error reached
    real(wp) :: e8 = 0
  end type benchmark_t

contains

  !> Run the benchmark.
  subroutine run_benchmark(shape, contacts_wanted, friction, options, figures)
    character(len=*), intent(in) :: shape !! of the grains, one of `lattice_shapes`
    integer, intent(in) :: contacts_wanted !! contacts to generate, about
    real(wp), intent(in) :: friction !! Coulomb coefficient
    type(solver_options_t), intent(in) :: options !! order, sweeps and frequency of tests
    type(benchmark_t), intent(out) :: figures !! results
    type(scene_t) :: scene
    type(plan_t) :: plan
    type(comm_t) :: alone
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    type(problem_t) :: problem
    type(nlgs_t) :: solver
    type(report_t) :: report
    real(wp), parameter :: h = 1e-4_wp
    real(wp) :: start
    integer :: try

    call make_lattice(scene, shape, contacts_wanted, friction)
    call make_plan(scene, plan, alone)
    contacts%dimension = scene%dimension
    contacts%n_components = force_length(plan%kind)
    contacts%n_moments = plan%n_moments
    contacts%n_internal = plan%n_internal
    call predict(scene, 0.0_wp, h, 0.5_wp)
    figures%first_detect_seconds = -cpu_now()
    call detect(scene, pairs, history, contacts)
    figures%first_detect_seconds = figures%first_detect_seconds + cpu_now()
    ! As in every later step: the list of neighbours and the memory are there. The least of some tries is the undisturbed one.
    figures%detect_seconds = huge(1.0_wp)
    figures%assemble_seconds = huge(1.0_wp)
    do try = 1, 7
      start = cpu_now()
      call detect(scene, pairs, history, contacts)
      figures%detect_seconds = min(figures%detect_seconds, cpu_now() - start)
      start = cpu_now()
      call assemble(scene, plan, pairs, contacts, h, problem)
      figures%assemble_seconds = min(figures%assemble_seconds, cpu_now() - start)
    end do
    solver%options = options
    solver%has_momentum = options%method == 'nesterov'
    solver%options%tolerance = 0
    start = wall_now()
    call solver%solve(problem, report)
    figures%updates_per_wall_second = real(report%contact_updates, wp)/max(wall_now() - start, tiny(1.0_wp))
    figures%contacts = problem%n_contacts
    figures%active_contacts = report%active_contacts
    figures%sweeps = report%sweeps
    figures%updates_per_second = real(report%contact_updates, wp)/(report%cpu_sweeps + report%cpu_checks)
    figures%check_share = report%cpu_checks/(report%cpu_sweeps + report%cpu_checks)
    figures%sweep_seconds = report%cpu_sweeps/real(max(1, report%sweeps), wp)
    figures%bytes_per_contact = report%bytes_per_contact
    ! Records and pairs are read, impulses read and written, bodies read and their velocities written once a sweep.
    figures%bytes_per_update = report%bytes_per_contact + 8*real(size(problem%impulse, 1), wp) &
                               + 8*real(first_inverse(problem%kind) - 1, wp)*real(problem%n_bodies, wp) &
                               /real(max(1, problem%n_contacts), wp)
    figures%e8 = report%e8
    figures%peak_per_contact = real(peak_memory_bytes(), wp)/real(max(1, problem%n_contacts), wp)
    figures%triad = stream_triad()

  end subroutine run_benchmark

  !> Bytes moved per CPU second by a = b + s c on arrays too large for caches: the best of five passes.
  function stream_triad() result(bytes_per_second)
    real(wp) :: bytes_per_second
    integer, parameter :: n = 20000000
    real(wp), allocatable :: a(:), b(:), c(:)
    real(wp) :: start, seconds
    integer :: i, pass

    allocate (a(n), b(n), c(n))
    a = 0
    b = 1
    c = 2
    seconds = huge(1.0_wp)
    do pass = 1, 5
      start = cpu_now()
      do i = 1, n
        a(i) = b(i) + 3*c(i)
      end do
      seconds = min(seconds, cpu_now() - start)
      c(pass) = a(n - pass)
    end do
    bytes_per_second = 24*real(n, wp)/max(seconds, tiny(1.0_wp))
    if (sum(c(:5)) < 0) bytes_per_second = 0
  end function stream_triad
end module sg_benchmark
