!> Failure of a step: checks before and after the solve, dumps of problems that failed, and the trace of the last step of a run.
!!
!! A step that fails leaves its contact problem as a dump, the state at its beginning as a checkpoint, and, in a traced run, the
!! history of its errors. None of these could be asked for before: so the guess of every solve is kept where a run is traced, and
!! when the step fails, its problem is solved once more, from the same guess and by the same solver, this time with a history.
module sg_failure
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_assemble, only: assemble
  use sg_checkpoint, only: save_once
  use sg_dump, only: begin_dump, finish_dump
  use sg_error, only: error_t, exit_broken, exit_stopped, exit_unbalanced
  use sg_guard, only: find_broken, number_of
  use sg_history, only: revive
  use sg_kinds, only: wp, i1
  use sg_motion, only: predict
  use sg_problem, only: problem_t
  use sg_relative_epsilon, only: set_relative_epsilon
  use sg_report, only: unsolved
  use sg_moments_of_run, only: moment_of, moment_t
  use sg_penetration, only: deepest_penetration
  use sg_simulation, only: simulation_t
  use sg_text, only: to_text
  use sg_timed, only: timed
  use sg_totals, only: find_moment, phase_measure
  implicit none
  private
  public :: check_input, keep_guess, dump_failed_solve, dump_broken_step, note_unconverged, note_worst, is_of_the_step
  public :: save_dump, keep_failed_step, trace_last

contains

  !> Stop before a problem whose data are not finite: its dump holds no solution. Collective.
  subroutine check_input(sim, error)
    type(simulation_t), intent(inout) :: sim !! its problem is assembled
    type(error_t), allocatable, intent(inout) :: error !! set where memory or time is short; afterwards on all ranks, also when
    !! a value of one is not finite
    logical :: has_contacts

    if (.not. allocated(error)) &
      call find_broken(sim%scene, sim%contacts, sim%step + 1, sim%options%substep_length(), .false., error)
    if (.not. sim%comm%any(allocated(error))) return
    call sim%comm%agree(error)
    has_contacts = sim%comm%any(sim%problem%n_contacts > 0)
    sim%dump%is_unsolved = .true.
    sim%report = unsolved()
    ! A step that the walltime ends has no contacts; those of the step before count.
    if (error%code /= exit_stopped) then
      sim%all_contacts = sim%contacts%n
      call sim%comm%sum(sim%all_contacts)
    end if
    if (error%code == exit_broken .and. has_contacts) call dump(sim, sim%problem)
  end subroutine check_input

  !> Keep the guess that the solve replaces: impulses, and free velocities of the bodies.
  subroutine keep_guess(sim, error)
    type(simulation_t), intent(inout) :: sim !! its problem is assembled
    type(error_t), allocatable, intent(out) :: error !! never set

    call keep(sim%problem%impulse, sim%guess_impulse)
    call keep(sim%problem%body, sim%guess_body)
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

  !> Begin a dump of a problem whose solution is not finite, or ends the run because it did not converge. Collective.
  subroutine dump_failed_solve(sim)
    type(simulation_t), intent(inout) :: sim !! its problem is solved: contacts hold the guess, bodies their free velocities

    if (.not. sim%report%is_finite .or. (sim%options%solver%stop_unconverged .and. .not. sim%report%is_converged)) &
      call dump_again(sim)
  end subroutine dump_failed_solve

  !> Begin a dump of a step whose values are finite, but too large to go on with. Bodies get their free velocities back, contacts
  !! their status; the guess is zero. Collective.
  subroutine dump_broken_step(sim, status)
    type(simulation_t), intent(inout) :: sim !! its solution is stored
    integer(i1), intent(in) :: status(:) !! of the contacts before the solve

    if (sim%dump%is_begun .or. sim%all_contacts == 0) return
    sim%contacts%impulse(:, :sim%contacts%n) = 0
    sim%contacts%status(:sim%contacts%n) = status
    call predict(sim%scene, sim%substep_time(), sim%options%substep_length(), sim%options%theta)
    call dump_again(sim)
  end subroutine dump_broken_step

  !> Assemble the problem of the step once more, and begin its dump.
  subroutine dump_again(sim)
    type(simulation_t), intent(inout) :: sim
    type(problem_t) :: problem

    if (sim%dump%is_begun) return
    call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, sim%options%substep_length(), problem)
    call set_relative_epsilon(sim%scene, sim%contacts, sim%comm, problem)
    call dump(sim, problem)
  end subroutine dump_again

  !> Begin a dump, unless one has begun.
  subroutine dump(sim, problem)
    type(simulation_t), intent(inout) :: sim
    type(problem_t), intent(in) :: problem

    if (.not. sim%dump%is_begun) &
      call begin_dump(sim%dump, problem, sim%decomposition%subdomain, sim%pairs%slot_of, sim%comm)
  end subroutine dump

  !> Keep step and bodies of the worst contact of a step that did not converge. Collective.
  subroutine note_unconverged(sim)
    type(simulation_t), intent(inout) :: sim !! its solution is stored
    integer :: bodies(2), side, first

    bodies = 0
    if (sim%report%worst_contact > 0) then
      do side = 1, 2
        bodies(side) = number_of(sim%scene, sim%contacts%body(side, sim%report%worst_contact))
      end do
    end if
    ! Of contacts that are equally bad on several ranks one is named.
    first = bodies(1)
    call sim%comm%maximum(first)
    if (bodies(1) < first) bodies = [first, 0]
    call sim%comm%maximum(bodies(2))
    call sim%totals%note_unconverged(sim%step + 1, bodies, sim%report%worst_speed)
  end subroutine note_unconverged

  !> Keep where and when the deepest penetration and the largest violation of the run so far are found. Collective.
  subroutine note_worst(sim)
    type(simulation_t), intent(inout) :: sim !! its solution is stored, bodies not updated
    real(wp) :: depth, time, violation
    integer :: k

    time = sim%substep_time(sim%substep + 1)
    associate (h => sim%options%substep_length(), totals => sim%totals, report => sim%report)
      depth = deepest_penetration(sim%contacts)
      if (depth > max(totals%worst_penetration, merge(0.0_wp, sim%tunnelling%deepest, sim%substep == 1))) then
        k = minloc(sim%contacts%gap(:sim%contacts%n), 1)
        ! Of this rank: ranks compare at the end.
        totals%penetration_at = moment_of(sim%scene, sim%contacts, k, sim%step + 1, time, depth/(2*h), report%is_converged)
      end if
      violation = totals%worst_violation
      if (sim%substep > 1) violation = max(violation, sim%so_far%violation)
      if (.not. report%violation > violation) return
      totals%violation_at = moment_t(step=sim%step + 1, time=time)
      if (report%worst_contact > 0) totals%violation_at = &
        moment_of(sim%scene, sim%contacts, report%worst_contact, sim%step + 1, time, 10*norm2(sim%scene%gravity)*h, &
                  report%is_converged)
      ! The rank that holds the worst contact has its bodies, others none.
      call find_moment(sim%comm, real(maxval(totals%violation_at%bodies), wp), totals%violation_at)
    end associate
  end subroutine note_worst

  !> Is an error one of the step itself, not of a file that cannot be written or a deck that is wrong?
  pure logical function is_of_the_step(error)
    type(error_t), intent(in) :: error !! error that ended the run

    is_of_the_step = any(error%code == [exit_broken, exit_unbalanced])
  end function is_of_the_step

  !> Write the dump of a step; that it cannot be written gives a warning, and does not end the run. Collective.
  subroutine save_dump(sim, step)
    type(simulation_t), intent(inout) :: sim !! its dump has begun
    integer, intent(in) :: step !! number of the step
    type(error_t), allocatable :: error
    character(len=:), allocatable :: name

    call finish_dump(sim%dump, sim%problem, sim%options%folder, sim%writers%summary%deck, step, sim%comm, name, error)
    if (.not. allocated(error)) call sim%writers%summary%add_file('dump_'//to_text(step), name)
    call warn(sim, error)
  end subroutine save_dump

  !> Keep the state at the beginning of a step that failed, so that it can be tried again, and its trace. Collective.
  subroutine keep_failed_step(sim, error)
    type(simulation_t), intent(inout) :: sim !! its bodies are at the beginning of the step
    type(error_t), intent(in) :: error !! error that ended the step
    type(error_t), allocatable :: late

    if (sim%writers%has_checkpoints .and. sim%writers%saved_step /= sim%step) then
      call revive(sim%history, sim%pairs, sim%contacts)
      call save_once(sim, late)
    end if
    if (is_of_the_step(error)) call trace_last(sim, sim%step + 1)
  end subroutine keep_failed_step

  !> Write the history of the step that ends the run, where a run is traced; that it cannot be written gives a warning, and does not
  !! hide why the run ends. Collective.
  subroutine trace_last(sim, step)
    type(simulation_t), intent(inout) :: sim !! its problem is that of the step
    integer, intent(in) :: step !! number of the step
    type(error_t), allocatable :: error

    if (.not. sim%writers%trace%is_on) return
    if (.not. (sim%is_traced .or. sim%dump%is_unsolved)) call timed(solve_again, sim, phase_measure, error)
    call sim%writers%trace%end_step(step, sim%time(step), sim%all_contacts, sim%report, sim%totals, sim%comm, error)
    call warn(sim, error)
  end subroutine trace_last

  !> Print an error as a warning, on the root rank alone.
  subroutine warn(sim, error)
    type(simulation_t), intent(in) :: sim
    type(error_t), allocatable, intent(in) :: error

    if (allocated(error) .and. sim%writers%is_root) write (error_unit, '(a)') error%report('warning')
  end subroutine warn

  !> Solve the problem of the last step once more, with a history; the report is that of this solve. Collective.
  subroutine solve_again(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    type(problem_t) :: problem

    problem = sim%problem
    problem%impulse = sim%guess_impulse
    problem%body = sim%guess_body
    sim%solver%with_trace = .true.
    call sim%solver%solve(problem, sim%decomposition%subdomain%by_slot(sim%pairs%slot_of), sim%comm, sim%report)
  end subroutine solve_again
end module sg_failure
