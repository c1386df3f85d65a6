!> One time step of a simulation: predict, detect, assemble, solve, update.
!!
!! A step may be cut into substeps. Each predicts, assembles, solves and updates; the first one detects, the others carry its
!! contacts on (doc/theory/substeps.md).
module sg_advance
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_assemble, only: assemble, disassemble
  use sg_bonds, only: finish_bonds
  use sg_detect, only: detect
  use sg_dump, only: begin_dump, is_listed
  use sg_error, only: error_t, fail
  use sg_find_passages, only: find_passages
  use sg_failure, only: check_input, dump_broken_step, dump_failed_solve, keep_guess, note_unconverged, note_worst, save_dump
  use sg_gap_laws, only: laws_look_at_gaps
  use sg_guard, only: find_broken
  use sg_kinds, only: wp, i1, i4
  use sg_left_out, only: has_left_out, widen_thrown
  use sg_limits, only: check_limits
  use sg_link_contacts, only: finish_links
  use sg_motion, only: move_with_cell, predict, update
  use sg_pair_alert, only: reduce_alerts
  use sg_passage_counts, only: let_pass
  use sg_passages, only: time_slack
  use sg_penetration, only: deepest_penetration
  use sg_plan, only: set_radii
  use sg_recovery, only: recover
  use sg_relative_epsilon, only: set_relative_epsilon
  use sg_relax_cell, only: begin_cell
  use sg_report, only: add_effort, add_substep, report_t
  use sg_simulation, only: simulation_t
  use sg_solve_step, only: solve_step
  use sg_timed, only: timed
  use sg_text, only: to_text
  use sg_totals, only: phase_assemble, phase_detect, phase_measure, phase_predict, phase_solve, phase_update
  use sg_tunnelling, only: find_crossed_contacts, find_crossed_walls, warn_of_tunnelling
  use sg_update_problem, only: can_update, take_impulses, update_problem
  use sg_way_of_step, only: way_of_solution, way_of_step
  implicit none
  private
  public :: advance

  !> Solves of a step at most before the one in which all pairs have the whole alert distance
  integer, parameter :: most_reduced = 3

contains

  !> One time step. When a value is not finite, bodies stay at the beginning of the step. Collective.
  subroutine advance(sim, error)
    type(simulation_t), intent(inout) :: sim !! moved on by a step
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when a value is not finite, or memory or time is short
    type(report_t) :: first

    if (sim%scene%bodies%has_presence) call timed(change_presence, sim, phase_predict, error)
    do
      call timed(predict_bodies, sim, phase_predict, error)
      first = report_t()
      do
        call timed(find_contacts, sim, phase_detect, error)
        call timed(assemble_problem, sim, phase_assemble, error)
        call timed(solve_problem, sim, phase_solve, error)
        call timed(check_alerts, sim, phase_detect, error)
        if (.not. must_look_again(sim, first, error)) exit
      end do
      call timed(update_bodies, sim, phase_update, error)
      if (allocated(error) .or. sim%substep == 1) exit
      ! What concerns the solve of one substep cannot wait for the end of the step.
      call warn_of_tunnelling(sim%tunnelling, sim%comm, error_unit)
      if (sim%dump%is_begun) call save_dump(sim, sim%step + 1)
    end do
    if (sim%substep > 1) call sim%step_start%restore(sim%scene%bodies, sim%energy, sim%totals, sim%tracks, sim%means)
    sim%substep = 1
    if (sim%options%recovery > 0) call timed(push_bodies, sim, phase_solve, error)
  end subroutine advance

  !> May contacts be sought up to a reduced alert distance, and the step be solved again where that was too short? Where a solve
  !! leaves nothing behind but its solution, and substeps but impulses.
  pure logical function can_look_again(sim)
    type(simulation_t), intent(in) :: sim

    can_look_again = .not. sim%history%is_start .and. .not. sim%plan%has_bonds .and. .not. sim%scene%cell%is_on .and. &
                     sim%scene%bodies%n_carried == 0 .and. sim%contacts%n_carried == 0
    if (can_look_again .and. sim%options%substeps > 1) can_look_again = laws_look_at_gaps(sim%scene)
  end function can_look_again

  !> Find out whether the solution closes a contact on any rank that a reduced alert distance has left out. Collective.
  subroutine check_alerts(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    sim%pairs%is_too_short = .false.
    if (.not. (sim%pairs%is_reduced .and. sim%report%is_finite)) return
    sim%pairs%is_too_short = sim%comm%any(has_left_out(sim%scene, sim%pairs, sim%history, sim%contacts, sim%problem%body, &
                                                       sim%pairs%slot_of, .not. sim%plan%is_round))
  end subroutine check_alerts

  !> Were alert distances too short? Then the step is solved again, and the effort of both solves is that of the step. Collective.
  logical function must_look_again(sim, first, error)
    type(simulation_t), intent(inout) :: sim
    type(report_t), intent(inout) :: first !! effort of the solve before, zero for none
    type(error_t), allocatable, intent(in) :: error
    real(wp) :: way

    must_look_again = .false.
    call add_effort(first, sim%report)
    if (allocated(error)) return
    must_look_again = sim%pairs%is_too_short
    if (.not. must_look_again) return
    first = sim%report
    way = way_of_solution(sim%scene, sim%problem%body, sim%pairs%slot_of, .not. sim%plan%is_round, sim%options%time_step)
    call sim%comm%maximum(way)
    sim%pairs%way = max(sim%pairs%way, way)
    sim%pairs%n_reduced = sim%pairs%n_reduced + 1
    if (sim%pairs%n_reduced < most_reduced .and. sim%substep == 1) then
      call widen_thrown(sim%scene, sim%pairs, sim%problem%body, sim%pairs%slot_of, .not. sim%plan%is_round)
    else
      sim%pairs%is_reduced = .false.
    end if
    ! Copies of a rank's halo have moved since their margin was looked at: a list that must be made now is for this step alone.
    if (sim%comm%size > 1) sim%pairs%asked_skin = tiny(1.0_wp)
    ! The dump of this problem, which was too small, makes room for that of the next.
    sim%dump%is_begun = .false.
    if (sim%substep > 1) call begin_again(sim, first)
    sim%totals%repeated_steps = sim%totals%repeated_steps + 1
  end function must_look_again

  !> Go back from a later substep to the beginning of the step, its bodies in the middle of the first substep.
  subroutine begin_again(sim, first)
    type(simulation_t), intent(inout) :: sim
    type(report_t), intent(inout) :: first !! effort of this substep, and then of those before too

    call add_effort(sim%so_far, first)
    call sim%step_start%restore(sim%scene%bodies, sim%energy, sim%totals, sim%tracks, sim%means)
    sim%substep = 1
    call predict(sim%scene, sim%substep_time(), sim%options%substep_length(), sim%options%theta)
  end subroutine begin_again

  !> Let bodies in and out whose time or place it is. The list of neighbours is then made again, on all ranks.
  subroutine change_presence(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    integer(i4), allocatable :: next(:)
    logical :: has_changed

    call find_passages(sim%scene, sim%decomposition%subdomain, sim%comm, sim%step, &
                       sim%time() + time_slack*sim%options%time_step, next, has_changed)
    if (.not. has_changed) return
    call let_pass(sim%scene, next, sim%energy)
    if (allocated(sim%pairs%built)) deallocate (sim%pairs%built)
  end subroutine change_presence

  !> Free velocities, and bodies in the middle of the substep; again for bodies that arrive where this rank's part is rebuilt.
  subroutine predict_bodies(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    logical :: is_rebuilt

    associate (h => sim%options%substep_length(), options => sim%options)
      call find_crossed_contacts(sim%tunnelling, sim%scene, sim%contacts, sim%plan, sim%pairs%way, sim%history%is_loaded, &
                                 sim%step + 1, h, sim%substep, options%substeps)
      call predict(sim%scene, sim%substep_time(), h, options%theta)
      if (sim%substep > 1) return
      sim%pairs%way = way_of_step(sim%scene, h, options%substeps)
      call sim%comm%maximum(sim%pairs%way)
      sim%pairs%is_reduced = .false.
      sim%pairs%n_reduced = 0
      if (can_look_again(sim)) call reduce_alerts(sim%scene, options%time_step, sim%pairs)
      call sim%decomposition%update(sim%scene, sim%pairs, sim%history, sim%contacts, h, sim%comm, is_rebuilt, error)
      if (allocated(error) .or. .not. is_rebuilt) return
      call set_radii(sim%scene, sim%plan)
      call predict(sim%scene, sim%time(), h, options%theta)
      if (sim%pairs%is_reduced) call reduce_alerts(sim%scene, options%time_step, sim%pairs)
    end associate
  end subroutine predict_bodies

  !> Contacts of the step, with the impulses of the last one; in later substeps those of the step, where their bodies are now.
  subroutine find_contacts(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: share

    if (sim%substep == 1) then
      ! Corners of polygons are placed for pairs that need them, and for measures, unless more looks at them.
      sim%pairs%corners_wait = sim%options%substeps == 1 .and. .not. sim%tunnelling%exceeds_thinnest
      call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
    else
      ! Shapes are placed for what looks at them: paths through walls in every substep, measures after the last one.
      call sim%carry%move(sim%scene, sim%contacts, sim%tunnelling%exceeds_thinnest .or. sim%substep == sim%options%substeps, &
                          sim%tunnelling%exceeds_alert)
    end if
    ! Before the first detection bodies are where they start.
    share = merge(1 - sim%options%theta, 1.0_wp, sim%step == 0 .and. sim%substep == 1)
    call find_crossed_walls(sim%tunnelling, sim%scene, sim%step + 1, sim%options%substep_length(), share, sim%plan%thinnest)
    if (sim%substep > 1 .or. sim%options%substeps == 1) return
    call sim%carry%begin(sim%scene, sim%contacts)
    call sim%step_start%keep(sim%scene%bodies, sim%energy, sim%totals, sim%tracks, sim%means)
  end subroutine find_contacts

  !> The contact problem, and its dump where one is asked for.
  subroutine assemble_problem(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    if (sim%substep == 1) call check_limits(sim, error)
    associate (h => sim%options%substep_length())
      sim%updates_problem = .false.
      if (sim%options%substeps > 1) sim%updates_problem = can_update(sim%scene, sim%plan)
      if (sim%substep > 1 .and. sim%updates_problem) then
        call update_problem(sim%scene, sim%plan, sim%pairs, sim%contacts, h, sim%problem)
      else
        call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, h, sim%problem)
        call set_relative_epsilon(sim%scene, sim%contacts, sim%comm, sim%problem)
        if (sim%scene%cell%is_on) call begin_cell(sim%scene, sim%contacts, sim%comm, sim%problem)
      end if
    end associate
    call check_input(sim, error)
    if (allocated(error) .or. .not. allocated(sim%options%dump_steps)) return
    if (is_listed(sim%options%dump_steps, sim%step + 1) .and. sim%substep == sim%options%substeps) &
      call begin_dump(sim%dump, sim%problem, sim%decomposition%subdomain, sim%pairs%slot_of, sim%comm)
  end subroutine assemble_problem

  !> Impulses of the contacts over the substep.
  subroutine solve_problem(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    if (sim%keeps_guess) call timed(keep_guess, sim, phase_measure, error)
    call solve_step(sim)
    associate (phase => sim%totals%phase)
      if (sim%is_traced) call phase(phase_solve)%hand_over(sim%report%apart, phase(phase_measure))
    end associate
    call dump_failed_solve(sim)
  end subroutine solve_problem

  !> Velocities and impulses from the solution, and bodies at the end of the substep.
  subroutine update_bodies(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call store_solution(sim, error)
    call timed(count_substep, sim, phase_measure, error)
    if (allocated(error)) return
    if (sim%scene%cell%is_on) then
      call move_with_cell(sim%scene, sim%options%substep_length(), sim%options%theta)
      call check_width(sim, error)
    end if
    call update(sim%scene%bodies, sim%options%substep_length(), sim%options%theta)
    if (sim%substep == sim%options%substeps) sim%step = sim%step + 1
    sim%substep = merge(1, sim%substep + 1, sim%substep == sim%options%substeps)
  end subroutine update_bodies

  !> End the run where a periodic cell has become too narrow for its grains: they would touch themselves. Collective.
  subroutine check_width(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    integer :: n

    n = sim%scene%dimension
    associate (contactors => sim%scene%contactors, cell => sim%scene%cell)
      if (sim%comm%any(minval(cell%now(:n)) < 2*maxval([0.0_wp, contactors%reach(:contactors%n)]))) &
        call fail(error, 'step '//to_text(sim%step + 1)//': the periodic cell is narrower than its widest grain')
    end associate
  end subroutine check_width

  !> Bodies apart where they overlap.
  subroutine push_bodies(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call recover(sim)
  end subroutine push_bodies

  !> Velocities at the end of the substep and impulses of the contacts, from the problem solved.
  subroutine store_solution(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    integer(i1), allocatable :: status(:)

    status = sim%contacts%status(:sim%contacts%n)
    associate (h => sim%options%substep_length())
      if (sim%substep < sim%options%substeps .and. sim%updates_problem) then
        call take_impulses(sim%problem, sim%plan, sim%pairs, sim%scene, sim%contacts)
      else
        call disassemble(sim%problem, sim%plan, sim%pairs, h, sim%report%violation, sim%scene, sim%contacts)
      end if
      if (sim%problem%cell%is_on) sim%scene%cell%rate = sim%problem%cell%rate
      call finish_links(sim%scene, sim%contacts, h)
      if (sim%plan%has_bonds) call finish_bonds(sim%scene, h, sim%substep_time(sim%substep + 1), &
                                                sim%problem, sim%contacts)
      call find_broken(sim%scene, sim%contacts, sim%step + 1, h, .true., error)
    end associate
    call agree_on_step(sim, error)
    if (sim%all_contacts > 0) sim%history%is_untouched = .false.
    if (allocated(error)) call dump_broken_step(sim, status)
  end subroutine store_solution

  !> Combine over the ranks: whether a value is not finite, whether a body moves too fast, bodies that passed each other, contacts.
  subroutine agree_on_step(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(inout) :: error
    integer :: sums(4)

    sums = [merge(1, 0, allocated(error)), merge(1, 0, sim%tunnelling%exceeds_alert), sim%tunnelling%n, sim%contacts%n]
    call sim%comm%sum(sums)
    sim%tunnelling%exceeds_alert = sums(2) > 0
    sim%tunnelling%n = sums(3)
    sim%all_contacts = sums(4)
    if (sums(1) > 0) call sim%comm%agree(error)
  end subroutine agree_on_step

  !> Add the works and costs of a substep to those of the step, and those of the step to those of the run.
  subroutine count_substep(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call sim%energy%add_step(sim%scene, sim%contacts, sim%options%substep_length(), sim%plan%radius)
    call sim%tracks%add_step(sim%scene, sim%contacts, sim%options%substep_length())
    call sim%means%add_step(sim%scene, sim%contacts, sim%options%substep_length())
    call note_worst(sim)
    associate (deepest => sim%tunnelling%deepest)
      deepest = max(deepest_penetration(sim%contacts), merge(0.0_wp, deepest, sim%substep == 1))
    end associate
    if (.not. sim%report%is_converged) call note_unconverged(sim)
    sim%totals%tunnellings = sim%totals%tunnellings + sim%tunnelling%n
    if (sim%substep > 1) call add_substep(sim%so_far, sim%report)
    if (sim%substep < sim%options%substeps) then
      sim%so_far = sim%report
      return
    end if
    call sim%totals%add(sim%report, sim%contacts%n, sim%tunnelling%deepest, sim%all_contacts)
    if (sim%tunnelling%exceeds_alert) sim%totals%fast_steps = sim%totals%fast_steps + 1
  end subroutine count_substep
end module sg_advance
