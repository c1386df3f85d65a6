!> A simulation: everything one run owns, and its step of five verbs.
module sg_simulation
  use sg_assemble, only: assemble, disassemble
  use sg_choose_glued_solver, only: choose_glued_solver
  use sg_choose_solver, only: choose_solver
  use sg_comm, only: comm_t, traffic_t
  use sg_contacts, only: contacts_t
  use sg_decomposition, only: decomposition_t
  use sg_detect, only: detect
  use sg_drives, only: fix_driven
  use sg_dump, only: begin_dump, dump_t, is_listed
  use sg_energy, only: energy_t
  use sg_error, only: error_t, fail
  use sg_glued_solver, only: glued_solver_t
  use sg_guard, only: find_broken
  use sg_history, only: history_t, start_history
  use sg_kinds, only: wp, i1, i8
  use sg_motion, only: predict, update
  use sg_neighbours, only: neighbours_t
  use sg_penetration, only: deepest_penetration
  use sg_passing, only: look_for_passing, passing_t
  use sg_plan, only: make_plan, plan_t, set_radii
  use sg_problem, only: problem_kind, problem_t
  use sg_report, only: report_t, unsolved
  use sg_run_options, only: partition_options_t, run_options_t
  use sg_scene, only: scene_t
  use sg_signature, only: n_signature, signature_of
  use sg_solver, only: solver_t
  use sg_text, only: to_text
  use sg_totals, only: phase_assemble, phase_detect, phase_measure, phase_predict, phase_solve, phase_update, totals_t
  implicit none
  private
  public :: simulation_t, start_simulation, decompose, advance

  !> One run: two of them fit in one program
  type :: simulation_t
    !> What exists, and what to do with it
    type(scene_t) :: scene
    type(run_options_t) :: options
    !> What the scene needs
    type(plan_t) :: plan
    !> Pairs that may touch, contacts of the step, and those of the last one
    type(neighbours_t) :: pairs
    type(contacts_t) :: contacts
    type(history_t) :: history
    !> The contact problem of the step, who solves it, and what he says
    type(problem_t) :: problem
    class(solver_t), allocatable :: solver
    type(report_t) :: report
    !> The ranks, this one's side of the decomposition, and who solves decomposed problems; of no use on one rank
    type(comm_t) :: comm
    type(decomposition_t) :: decomposition
    class(glued_solver_t), allocatable :: glued_solver
    !> Dump of the step's problem, where one is asked for or the step failed
    type(dump_t) :: dump
    !> Is the history of errors kept within the next steps?
    logical :: is_traced = .false.
    !> Is the guess of each solve kept, so that a step that breaks can be solved again? Its impulses, and free velocities by slot
    logical :: keeps_guess = .false.
    real(wp), allocatable :: guess_impulse(:, :), guess_body(:, :)
    !> Works and costs since the start
    type(energy_t) :: energy
    type(totals_t) :: totals
    !> Bodies that passed through each other
    type(passing_t) :: passing
    !> Steps done
    integer :: step = 0
    !> Contacts of the last step, of all ranks
    integer :: all_contacts = 0
    !> Where ranks share the scene: gluings of this run, contact updates of this rank and what it sent in them; what tells the
    !! whole scene
    integer(i8) :: gluings = 0, own_updates = 0
    type(traffic_t) :: gluing_traffic
    real(wp) :: signature(n_signature) = 0
  contains
    procedure :: time => simulation_time
  end type simulation_t

contains

  !> Make a simulation ready for its first step: plan, driven components, guess of the first impulses, solver. Collective where
  !! each rank of `sim%comm` has a part of the scene.
  subroutine start_simulation(sim)
    type(simulation_t), intent(inout) :: sim !! its scene and options are set

    call make_plan(sim%scene, sim%plan, sim%comm)
    call fix_driven(sim%scene%drives, sim%scene%bodies)
    sim%contacts%dimension = sim%scene%dimension
    sim%contacts%n_components = merge(sim%scene%dimension, 1, sim%plan%has_tangent)
    ! Contacts known to a scene that is held in part travel first, see `decompose`.
    if (.not. allocated(sim%scene%bodies%id)) &
      call start_history(sim%history, sim%scene, sim%options%step, sim%contacts%n_components)
    call choose_solver(sim%options%solver, sim%solver)
    call sim%totals%clock%start()
  end subroutine start_simulation

  !> Split a started simulation over the ranks of `sim%comm`, where there are several: each keeps its part. Collective.
  subroutine decompose(sim, error)
    type(simulation_t), intent(inout) :: sim !! started, perhaps brought to the state of a restart file; whole on all ranks, or
    !! a part on each
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when the deck asks for what cannot be done

    if (sim%comm%size == 1) return
    sim%signature = signature_of(sim%scene, sim%comm)
    call check_sweeps(sim%options%partition, sim%comm%size, error)
    if (allocated(error)) return
    call choose_glued_solver(sim%options%solver, sim%options%partition, sim%glued_solver, error)
    if (allocated(error)) return
    call sim%decomposition%begin(sim%scene, sim%contacts, sim%step > 0, sim%options%partition, sim%comm, error)
    if (allocated(error)) return
    if (allocated(sim%pairs%built)) deallocate (sim%pairs%built)
    sim%pairs%rank = sim%comm%rank
    sim%contacts%n = 0
  end subroutine decompose

  !> Are there sweeps for every part?
  subroutine check_sweeps(partition, ranks, error)
    type(partition_options_t), intent(in) :: partition
    integer, intent(in) :: ranks
    type(error_t), allocatable, intent(out) :: error

    if (.not. allocated(partition%sweeps)) return
    if (any(size(partition%sweeps) == [1, ranks])) return
    call fail(error, 'partition.sweeps has '//to_text(size(partition%sweeps))//' numbers; it takes one for all parts, or one '// &
              'for each of the '//to_text(ranks)//' ranks')
  end subroutine check_sweeps

  !> Bring this rank's part up to date when lists of neighbours are stale, and predict anew what has come.
  subroutine renew(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    logical :: is_renewed

    call sim%decomposition%renew(sim%scene, sim%pairs, sim%history, sim%contacts, sim%options%step, sim%comm, is_renewed, error)
    if (allocated(error) .or. .not. is_renewed) return
    call set_radii(sim%scene, sim%plan)
    call predict(sim%scene, sim%time(), sim%options%step, sim%options%theta)
  end subroutine renew

  !> One time step. When a value is not finite, the bodies stay at the beginning of the step and an error tells.
  subroutine advance(sim, error)
    type(simulation_t), intent(inout) :: sim !! moved on by a step
    type(error_t), allocatable, intent(out) :: error !! set when a value is not finite
    integer(i1), allocatable :: status(:)
    logical :: is_fast
    real(wp) :: way

    associate (h => sim%options%step, theta => sim%options%theta, phase => sim%totals%phase)
      call phase(phase_predict)%start()
      way = h*largest_speed(sim%scene%bodies%velocity(:sim%scene%dimension, :))
      is_fast = way > sim%plan%alert
      sim%passing%n = 0
      ! What a checkpoint or a deck knows of contacts has no gaps.
      if (way > sim%plan%thinnest .and. .not. sim%history%is_loaded) &
        call look_for_passing(sim%passing, sim%scene, sim%contacts, sim%step + 1, h)
      call predict(sim%scene, sim%time(), h, theta)
      if (sim%decomposition%is_on) call renew(sim, error)
      if (allocated(error)) return
      call phase(phase_predict)%stop()

      call phase(phase_detect)%start()
      call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
      call phase(phase_detect)%stop()

      call phase(phase_assemble)%start()
      call assemble(sim%scene, sim%contacts, problem_kind(sim%scene%dimension, sim%plan%is_round, sim%plan%has_tangent), &
                    sim%pairs%body_of, sim%pairs%slot_of, sim%plan%radius, h, sim%problem)
      if (is_dumped(sim)) call begin_dump(sim%dump, sim%problem, sim%decomposition%subdomain, sim%pairs%slot_of, sim%comm)
      call look_before(sim, error)
      call phase(phase_assemble)%stop()
      if (allocated(error)) return

      if (sim%keeps_guess) call keep_guess(sim)
      call phase(phase_solve)%start()
      if (sim%decomposition%is_on) then
        call solve_glued(sim)
      else
        sim%solver%with_trace = sim%is_traced
        call sim%solver%solve(sim%problem, sim%report)
      end if
      call phase(phase_solve)%stop()
      if (sim%is_traced) call phase(phase_solve)%hand_over(sim%report%apart, phase(phase_measure))

      call phase(phase_update)%start()
      if (has_failed(sim)) call begin_late_dump(sim)
      status = sim%contacts%status(:sim%contacts%n)
      call disassemble(sim%problem, sim%scene, sim%pairs%body_of, sim%plan%radius, sim%contacts)
      call find_broken(sim%scene, sim%contacts, sim%step + 1, h, .true., error)
      sim%all_contacts = sim%contacts%n
      if (sim%decomposition%is_on) call agree(sim%comm, error, is_fast, sim%passing%n, sim%all_contacts)
      call phase(phase_update)%stop()
      if (allocated(error)) then
        if (.not. sim%dump%is_begun .and. sim%all_contacts > 0) call begin_last_dump(sim, status)
        return
      end if

      call phase(phase_measure)%start()
      call sim%energy%add_step(sim%scene, sim%contacts, h)
      call sim%totals%add(sim%report, sim%contacts%n, deepest_penetration(sim%contacts), sim%all_contacts)
      if (is_fast) sim%totals%fast_steps = sim%totals%fast_steps + 1
      sim%totals%passings = sim%totals%passings + sim%passing%n
      call phase(phase_measure)%stop()

      call phase(phase_update)%start()
      call update(sim%scene%bodies, h, theta)
      sim%step = sim%step + 1
      call phase(phase_update)%stop()
    end associate
  end subroutine advance

  !> Stop before a problem whose data are not finite already: its dump holds no solution. Collective.
  subroutine look_before(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when a value of one is not finite
    logical :: has_contacts
    real(wp) :: contacts(1)
    integer :: speaker

    call find_broken(sim%scene, sim%contacts, sim%step + 1, sim%options%step, .false., error)
    has_contacts = sim%problem%n_contacts > 0
    if (sim%decomposition%is_on) then
      if (.not. sim%comm%any(allocated(error))) return
      call sim%comm%agree(error, speaker)
      has_contacts = sim%comm%any(has_contacts)
    end if
    if (.not. allocated(error)) return
    sim%dump%is_unsolved = .true.
    sim%report = unsolved()
    contacts = real(sim%contacts%n, wp)
    call sim%comm%sum(contacts)
    sim%all_contacts = nint(contacts(1))
    if (.not. sim%dump%is_begun .and. has_contacts) then
      call begin_dump(sim%dump, sim%problem, sim%decomposition%subdomain, sim%pairs%slot_of, sim%comm)
    end if
  end subroutine look_before

  !> Keep what the solve is about to replace. Measuring, as histories are.
  subroutine keep_guess(sim)
    type(simulation_t), intent(inout) :: sim

    call sim%totals%phase(phase_measure)%start()
    call keep(sim%problem%impulse, sim%guess_impulse)
    call keep(sim%problem%body, sim%guess_body)
    call sim%totals%phase(phase_measure)%stop()
  contains
    pure subroutine keep(values, kept)
      real(wp), intent(in) :: values(:, :)
      real(wp), allocatable, intent(inout) :: kept(:, :)

      if (allocated(kept)) then
        if (any(shape(kept) /= shape(values))) deallocate (kept)
      end if
      if (.not. allocated(kept)) allocate (kept(size(values, 1), size(values, 2)))
      kept = values
    end subroutine keep
  end subroutine keep_guess

  !> Solve this rank's part of the problem, and count what is sent.
  subroutine solve_glued(sim)
    type(simulation_t), intent(inout) :: sim
    type(traffic_t) :: before

    before = sim%comm%traffic
    sim%glued_solver%with_trace = sim%is_traced
    call sim%glued_solver%solve(sim%problem, sim%decomposition%subdomain, sim%pairs%slot_of, sim%comm, sim%report)
    sim%gluings = sim%gluings + int(sim%report%gluings, i8)
    sim%own_updates = sim%own_updates + sim%report%contact_updates
    sim%gluing_traffic%messages = sim%gluing_traffic%messages + sim%comm%traffic%messages - before%messages
    sim%gluing_traffic%bytes = sim%gluing_traffic%bytes + sim%comm%traffic%bytes - before%bytes
  end subroutine solve_glued

  !> What all ranks must know of a step: whether one of them found a value that is not finite, or a body that moves too fast,
  !! how many passed through each other, and how many contacts there are. Collective.
  subroutine agree(comm, error, is_fast, passings, all_contacts)
    type(comm_t), intent(inout) :: comm
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(inout) :: is_fast
    integer, intent(inout) :: passings, all_contacts
    real(wp) :: sums(4)
    integer :: speaker

    sums = [merge(1.0_wp, 0.0_wp, allocated(error)), merge(1.0_wp, 0.0_wp, is_fast), real(passings, wp), &
            real(all_contacts, wp)]
    call comm%sum(sums)
    is_fast = sums(2) > 0
    passings = nint(sums(3))
    all_contacts = nint(sums(4))
    if (sums(1) > 0) call comm%agree(error, speaker)
  end subroutine agree

  !> Is the problem of the step about to be solved to be dumped?
  pure logical function is_dumped(sim)
    type(simulation_t), intent(in) :: sim

    is_dumped = .false.
    if (allocated(sim%options%dump_steps)) is_dumped = is_listed(sim%options%dump_steps, sim%step + 1)
  end function is_dumped

  !> Did a solve fail of which no dump has begun: a value is not finite, or the run ends because it did not converge? All ranks
  !! say the same.
  pure logical function has_failed(sim)
    type(simulation_t), intent(in) :: sim

    has_failed = .false.
    if (sim%dump%is_begun) return
    if (sim%decomposition%is_on) then
      has_failed = .not. sim%report%is_finite
    else if (sim%problem%n_contacts > 0) then
      has_failed = .not. all(abs(sim%problem%body) <= huge(1.0_wp))
    else
      return
    end if
    has_failed = has_failed .or. (sim%options%solver%stop_unconverged .and. .not. sim%report%is_converged)
  end function has_failed

  !> Begin a dump after all: contacts still hold the guess, and bodies their free velocities.
  subroutine begin_late_dump(sim)
    type(simulation_t), intent(inout) :: sim
    type(problem_t) :: problem

    call assemble(sim%scene, sim%contacts, sim%problem%kind, sim%pairs%body_of, sim%pairs%slot_of, sim%plan%radius, &
                  sim%options%step, problem)
    call begin_dump(sim%dump, problem, sim%decomposition%subdomain, sim%pairs%slot_of, sim%comm)
  end subroutine begin_late_dump

  !> Begin a dump of a step whose values are finite, but too large to go on with: bodies get their free velocities back, contacts
  !! what they were, and their guess is none. Collective.
  subroutine begin_last_dump(sim, status)
    type(simulation_t), intent(inout) :: sim
    integer(i1), intent(in) :: status(:) !! of the contacts before the solve

    sim%contacts%impulse(:, :sim%contacts%n) = 0
    sim%contacts%status(:sim%contacts%n) = status
    call predict(sim%scene, sim%time(), sim%options%step, sim%options%theta)
    call begin_late_dump(sim)
  end subroutine begin_last_dump

  !> Largest speed of all bodies [m/s]; where squares have no room, the largest component.
  pure real(wp) function largest_speed(velocity)
    real(wp), intent(in) :: velocity(:, :)
    integer :: b

    largest_speed = 0
    if (size(velocity) > 0) largest_speed = maxval(abs(velocity))
    if (largest_speed > sqrt(huge(1.0_wp))/2) return
    largest_speed = 0
    do b = 1, size(velocity, 2)
      largest_speed = max(largest_speed, sum(velocity(:, b)**2))
    end do
    largest_speed = sqrt(largest_speed)
  end function largest_speed

  !> Time reached, or that of the end of another step [s]; a product, so that a restarted run has the very same times.
  pure real(wp) function simulation_time(self, step) result(time)
    class(simulation_t), intent(in) :: self
    integer, intent(in), optional :: step !! number of the step

    if (present(step)) then
      time = self%scene%start_time + self%options%step*real(step, wp)
    else
      time = self%scene%start_time + self%options%step*real(self%step, wp)
    end if
  end function simulation_time
end module sg_simulation
