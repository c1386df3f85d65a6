!> One time step of a simulation: predict, detect, assemble, solve, update.
module sg_advance
  use sg_assemble, only: assemble, disassemble
  use sg_bonds, only: finish_bonds
  use sg_detect, only: detect
  use sg_dump, only: begin_dump, is_listed
  use sg_error, only: error_t
  use sg_failure, only: check_input, dump_broken_step, dump_failed_solve, keep_guess, note_unconverged
  use sg_guard, only: find_broken
  use sg_kinds, only: wp, i1
  use sg_limits, only: check_limits
  use sg_link_contacts, only: finish_links
  use sg_motion, only: predict, update
  use sg_penetration, only: deepest_penetration
  use sg_plan, only: set_radii
  use sg_recovery, only: recover
  use sg_relative_epsilon, only: set_relative_epsilon
  use sg_simulation, only: simulation_t
  use sg_solve_step, only: solve_step
  use sg_timed, only: timed
  use sg_totals, only: phase_assemble, phase_detect, phase_measure, phase_predict, phase_solve, phase_update
  use sg_tunnelling, only: find_crossed_contacts, find_crossed_walls
  implicit none
  private
  public :: advance

contains

  !> One time step. When a value is not finite, bodies stay at the beginning of the step. Collective.
  subroutine advance(sim, error)
    type(simulation_t), intent(inout) :: sim !! moved on by a step
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when a value is not finite, or memory or time is short

    call timed(predict_bodies, sim, phase_predict, error)
    call timed(detect_contacts, sim, phase_detect, error)
    call timed(assemble_problem, sim, phase_assemble, error)
    call timed(solve_problem, sim, phase_solve, error)
    call timed(update_bodies, sim, phase_update, error)
    if (sim%options%recovery > 0) call timed(push_bodies, sim, phase_solve, error)
  end subroutine advance

  !> Free velocities, and bodies in the middle of the step; again for bodies that arrive where this rank's part is rebuilt.
  subroutine predict_bodies(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    logical :: is_rebuilt

    associate (h => sim%options%time_step)
      call find_crossed_contacts(sim%tunnelling, sim%scene, sim%contacts, sim%plan, sim%history%is_loaded, sim%step + 1, h)
      call predict(sim%scene, sim%time(), h, sim%options%theta)
      call sim%decomposition%update(sim%scene, sim%pairs, sim%history, sim%contacts, h, sim%comm, is_rebuilt, error)
      if (allocated(error) .or. .not. is_rebuilt) return
      call set_radii(sim%scene, sim%plan)
      call predict(sim%scene, sim%time(), h, sim%options%theta)
    end associate
  end subroutine predict_bodies

  !> Contacts of the step, with the impulses of the last one.
  subroutine detect_contacts(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
    ! Before the first detection bodies are where they start.
    call find_crossed_walls(sim%tunnelling, sim%scene, sim%step + 1, sim%options%time_step, &
                            merge(1 - sim%options%theta, 1.0_wp, sim%step == 0), sim%plan%thinnest)
  end subroutine detect_contacts

  !> The contact problem, and its dump where one is asked for.
  subroutine assemble_problem(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call check_limits(sim, error)
    call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, sim%options%time_step, sim%problem)
    call set_relative_epsilon(sim%scene, sim%contacts, sim%comm, sim%problem)
    call check_input(sim, error)
    if (allocated(error) .or. .not. allocated(sim%options%dump_steps)) return
    if (is_listed(sim%options%dump_steps, sim%step + 1)) &
      call begin_dump(sim%dump, sim%problem, sim%decomposition%subdomain, sim%pairs%slot_of, sim%comm)
  end subroutine assemble_problem

  !> Impulses of the contacts.
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

  !> Velocities and impulses from the solution, and bodies at the end of the step.
  subroutine update_bodies(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call store_solution(sim, error)
    call timed(count_step, sim, phase_measure, error)
    if (allocated(error)) return
    call update(sim%scene%bodies, sim%options%time_step, sim%options%theta)
    sim%step = sim%step + 1
  end subroutine update_bodies

  !> Bodies apart where they overlap.
  subroutine push_bodies(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call recover(sim, error)
  end subroutine push_bodies

  !> Velocities at the end of the step and impulses of the contacts, from the problem solved.
  subroutine store_solution(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    integer(i1), allocatable :: status(:)

    status = sim%contacts%status(:sim%contacts%n)
    associate (h => sim%options%time_step)
      call disassemble(sim%problem, sim%plan, sim%pairs, h, sim%report%violation, sim%scene, sim%contacts)
      call finish_links(sim%scene, sim%contacts, h)
      if (sim%plan%has_bonds) call finish_bonds(sim%scene, h, sim%time(sim%step + 1), sim%problem, sim%contacts)
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

  !> Add the works and costs of the step to those of the run.
  subroutine count_step(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call sim%energy%add_step(sim%scene, sim%contacts, sim%options%time_step)
    call sim%tracks%add_step(sim%scene, sim%contacts, sim%options%time_step)
    sim%tunnelling%deepest = deepest_penetration(sim%contacts)
    call sim%totals%add(sim%report, sim%contacts%n, sim%tunnelling%deepest, sim%all_contacts)
    if (.not. sim%report%is_converged) call note_unconverged(sim)
    if (sim%tunnelling%exceeds_alert) sim%totals%fast_steps = sim%totals%fast_steps + 1
    sim%totals%tunnellings = sim%totals%tunnellings + sim%tunnelling%n
  end subroutine count_step
end module sg_advance
