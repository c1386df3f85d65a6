!> One time step of a simulation: predict, detect, assemble, solve, update.
module sg_advance
  use sg_assemble, only: assemble, disassemble
  use sg_bonds, only: finish_bonds
  use sg_comm, only: comm_t
  use sg_detect, only: detect
  use sg_dump, only: begin_dump, is_listed
  use sg_error, only: error_t, exit_broken, fail
  use sg_guard, only: find_broken, number_of
  use sg_kinds, only: wp, i1
  use sg_limits, only: check_limits
  use sg_link_contacts, only: finish_links
  use sg_motion, only: predict, update
  use sg_passing, only: look_for_passing, look_through_walls
  use sg_penetration, only: deepest_penetration
  use sg_plan, only: set_radii
  use sg_problem, only: problem_t
  use sg_records, only: problem_kind
  use sg_report, only: unsolved
  use sg_simulation, only: simulation_t
  use sg_solve_step, only: solve_step
  use sg_totals, only: phase_assemble, phase_detect, phase_measure, phase_predict, phase_solve, phase_update
  implicit none
  private
  public :: advance

contains

  !> One time step. When a value is not finite, the bodies stay at the beginning of the step and an error tells.
  subroutine advance(sim, error)
    type(simulation_t), intent(inout) :: sim !! moved on by a step
    type(error_t), allocatable, intent(out) :: error !! set when a value is not finite
    logical :: is_fast

    call move_freely(sim, is_fast, error)
    if (allocated(error)) return
    call find_contacts(sim, error)
    if (allocated(error)) return
    if (sim%keeps_guess) call keep_guess(sim)
    call solve_contacts(sim)
    call take_velocities(sim, is_fast, error)
    if (allocated(error)) return
    call conclude(sim, is_fast)
  end subroutine advance

  !> Bring this rank's part up to date when lists of neighbours are stale, and predict again for bodies that arrived.
  subroutine renew(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    logical :: is_renewed

    call sim%decomposition%renew(sim%scene, sim%pairs, sim%history, sim%contacts, sim%options%step, sim%comm, is_renewed, error)
    if (allocated(error) .or. .not. is_renewed) return
    call set_radii(sim%scene, sim%plan)
    call predict(sim%scene, sim%time(), sim%options%step, sim%options%theta)
  end subroutine renew

  !> Free velocities, and bodies in the middle of the step.
  subroutine move_freely(sim, is_fast, error)
    type(simulation_t), intent(inout) :: sim
    logical, intent(out) :: is_fast !! may a body of this rank meet one that no contact tells of?
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: way

    associate (h => sim%options%step, clock => sim%totals%phase(phase_predict))
      call clock%start()
      way = h*largest_speed(sim%scene%bodies%velocity(:sim%scene%dimension, :))
      is_fast = way > sim%plan%alert
      sim%passing%n = 0
      sim%passing%is_due = way > sim%plan%thinnest
      ! What a checkpoint or a deck knows of contacts has no gaps.
      if (way + sim%passing%deepest > sim%plan%thinnest .and. .not. sim%history%is_loaded) &
        call look_for_passing(sim%passing, sim%scene, sim%contacts, sim%step + 1, h)
      call predict(sim%scene, sim%time(), h, sim%options%theta)
      if (sim%decomposition%is_on) call renew(sim, error)
      if (allocated(error)) return
      call clock%stop()
    end associate
  end subroutine move_freely

  !> Contacts, and the problem that they make.
  subroutine find_contacts(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    integer :: kind

    kind = problem_kind(sim%scene%dimension, sim%plan)
    associate (phase => sim%totals%phase)
      call phase(phase_detect)%start()
      call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
      ! Before the first detection bodies are where they start.
      if (sim%passing%is_due) call look_through_walls(sim%passing, sim%scene, sim%step + 1, sim%options%step, &
                                                      merge(1 - sim%options%theta, 1.0_wp, sim%step == 0), sim%plan%thinnest)
      call phase(phase_detect)%stop()

      call phase(phase_assemble)%start()
      call check_limits(sim%scene, sim%pairs, sim%contacts, sim%problem, kind, sim%step + 1, error)
      call assemble(sim%scene, sim%contacts, kind, sim%pairs%body_of, sim%pairs%slot_of, sim%plan%radius, sim%options%step, &
                    sim%problem)
      call look_before(sim, error)
      if (is_dumped(sim) .and. .not. allocated(error)) &
        call begin_dump(sim%dump, sim%problem, sim%decomposition%subdomain, sim%pairs%slot_of, sim%comm)
      call phase(phase_assemble)%stop()
    end associate
  end subroutine find_contacts

  !> Impulses of the contacts.
  subroutine solve_contacts(sim)
    type(simulation_t), intent(inout) :: sim

    associate (phase => sim%totals%phase)
      call phase(phase_solve)%start()
      call solve_step(sim)
      call phase(phase_solve)%stop()
      if (sim%is_traced) call phase(phase_solve)%hand_over(sim%report%apart, phase(phase_measure))
    end associate
  end subroutine solve_contacts

  !> Velocities at the end of the step and impulses of the contacts, from the problem solved.
  subroutine take_velocities(sim, is_fast, error)
    type(simulation_t), intent(inout) :: sim
    logical, intent(inout) :: is_fast !! of this rank, then of any
    type(error_t), allocatable, intent(out) :: error
    integer(i1), allocatable :: status(:)

    call sim%totals%phase(phase_update)%start()
    if (has_failed(sim)) call begin_late_dump(sim)
    status = sim%contacts%status(:sim%contacts%n)
    call disassemble(sim%problem, sim%scene, sim%pairs%body_of, sim%plan%radius, sim%options%step, sim%report%violation, &
                     sim%contacts)
    call finish_links(sim%scene, sim%contacts, sim%options%step)
    if (sim%plan%has_bonds) &
      call finish_bonds(sim%scene, sim%options%step, sim%time(sim%step + 1), sim%problem, sim%contacts)
    call find_broken(sim%scene, sim%contacts, sim%step + 1, sim%options%step, .true., error)
    sim%all_contacts = sim%contacts%n
    if (sim%decomposition%is_on) call agree(sim%comm, error, is_fast, sim%passing%n, sim%all_contacts)
    if (sim%all_contacts > 0) sim%history%is_untouched = .false.
    call sim%totals%phase(phase_update)%stop()
    if (allocated(error) .and. .not. sim%dump%is_begun .and. sim%all_contacts > 0) call begin_last_dump(sim, status)
  end subroutine take_velocities

  !> Works and costs of the step, and bodies at its end.
  subroutine conclude(sim, is_fast)
    type(simulation_t), intent(inout) :: sim
    logical, intent(in) :: is_fast

    associate (h => sim%options%step, phase => sim%totals%phase)
      call phase(phase_measure)%start()
      call sim%energy%add_step(sim%scene, sim%contacts, h)
      sim%passing%deepest = deepest_penetration(sim%contacts)
      call sim%totals%add(sim%report, sim%contacts%n, sim%passing%deepest, sim%all_contacts)
      if (.not. sim%report%is_converged) call note_unconverged(sim)
      if (is_fast) sim%totals%fast_steps = sim%totals%fast_steps + 1
      sim%totals%passings = sim%totals%passings + sim%passing%n
      call phase(phase_measure)%stop()

      call phase(phase_update)%start()
      call update(sim%scene%bodies, h, sim%options%theta)
      sim%step = sim%step + 1
      call phase(phase_update)%stop()
    end associate
  end subroutine conclude

  !> Keep step and bodies of the worst contact of a step that did not converge. Collective.
  subroutine note_unconverged(sim)
    type(simulation_t), intent(inout) :: sim
    integer :: bodies(2), side, first

    bodies = 0
    if (sim%report%worst_contact > 0) then
      do side = 1, 2
        bodies(side) = number_of(sim%scene, sim%contacts%body(side, sim%report%worst_contact))
      end do
    end if
    if (sim%decomposition%is_on) then
      ! Of contacts that are equally bad on several ranks one is named.
      first = bodies(1)
      call sim%comm%maximum(first)
      if (bodies(1) < first) bodies = [first, 0]
      call sim%comm%maximum(bodies(2))
    end if
    call sim%totals%note_unconverged(sim%step + 1, bodies, sim%report%worst_speed)
  end subroutine note_unconverged

  !> Stop before a problem whose data are not finite already: its dump holds no solution. Collective.
  subroutine look_before(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(inout) :: error !! set where memory or time ran short; afterwards on all ranks, also when
    !! a value of one is not finite
    logical :: has_contacts

    if (.not. allocated(error)) call find_broken(sim%scene, sim%contacts, sim%step + 1, sim%options%step, .false., error)
    has_contacts = sim%problem%n_contacts > 0
    if (sim%decomposition%is_on) then
      if (.not. sim%comm%any(allocated(error))) return
      call sim%comm%agree(error)
      has_contacts = sim%comm%any(has_contacts)
    end if
    if (.not. allocated(error)) return
    sim%dump%is_unsolved = .true.
    sim%report = unsolved()
    sim%all_contacts = sim%contacts%n
    call sim%comm%sum(sim%all_contacts)
    if (error%code /= exit_broken) return
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

  !> What all ranks must know of a step: whether one of them found a value that is not finite, or a body that moves too fast,
  !! how many passed through each other, and how many contacts there are. Collective.
  subroutine agree(comm, error, is_fast, passings, all_contacts)
    type(comm_t), intent(inout) :: comm
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(inout) :: is_fast
    integer, intent(inout) :: passings, all_contacts
    integer :: sums(4)

    sums = [merge(1, 0, allocated(error)), merge(1, 0, is_fast), passings, all_contacts]
    call comm%sum(sums)
    is_fast = sums(2) > 0
    passings = sums(3)
    all_contacts = sums(4)
    if (sums(1) > 0) call comm%agree(error)
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
end module sg_advance
