!> The solve of a step: once, or, where there are cohesive zones, in rounds until damage agrees with the solution that it leads to
!! (doc/theory/cohesive_zones.md).
module sg_solve_step
  use sg_bonds, only: damage_t, refresh_bonds
  use sg_comm, only: traffic_t
  use sg_kinds, only: wp
  use sg_report, only: add_effort, report_t
  use sg_residuals, only: find_worst
  use sg_simulation, only: simulation_t
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: solve_step

  !> Change of an integrity from round to round below which damage is taken for settled
  real(wp), parameter :: least_settled = 1e-8_wp
  !> That change over the tolerance of the solver, where that is more
  real(wp), parameter :: settled_share = 1e-3_wp
  !> Rounds of a step at most
  integer, parameter :: most_rounds = 200
  !> Solves of a step that may fail to converge before its rounds end
  integer, parameter :: most_unsolved = 3

contains

  !> Solve the problem of a step. Collective.
  subroutine solve_step(sim)
    type(simulation_t), intent(inout) :: sim !! its problem is assembled

    if (.not. sim%plan%has_bonds) then
      call solve_once(sim)
    else
      call solve_in_rounds(sim)
    end if
  end subroutine solve_step

  !> Solve with the integrity that bonds have, weaken them by the solution, and solve again from there. Bonds only ever get weaker
  !! than at the beginning of the step; the effort of all rounds is that of the step.
  subroutine solve_in_rounds(sim)
    type(simulation_t), intent(inout) :: sim
    type(report_t) :: before
    type(damage_t) :: damage
    real(wp), allocatable :: free(:, :)
    real(wp) :: change, settled
    integer :: round, unsolved

    allocate (free, source=sim%problem%body)
    call damage%begin(sim%contacts)
    unsolved = 0
    settled = max(least_settled, settled_share*sim%options%solver%tolerance)
    do round = 1, most_rounds
      call solve_once(sim)
      if (.not. sim%report%is_converged) unsolved = unsolved + 1
      if (round > 1) call add_effort(before, sim%report)
      call damage%find(sim%scene, sim%options%substep_length(), sim%problem, sim%contacts, change)
      call sim%comm%maximum(change)
      if (.not. change > settled .or. round == most_rounds .or. unsolved == most_unsolved) exit
      before = sim%report
      sim%problem%body = free
      call damage%approach(settled, sim%contacts)
      call refresh_bonds(sim%scene, sim%contacts, sim%options%substep_length(), sim%problem)
    end do
    call damage%accept(sim%contacts)
    if (change > settled) call judge_unsettled(sim)
  end subroutine solve_in_rounds

  !> Find by how much the solution of the last round breaks the laws at the damage that it leads to, and where most. Within the
  !! tolerance, what sweeps leave open keeps damage from settling, and the step has converged. Collective.
  subroutine judge_unsettled(sim)
    type(simulation_t), intent(inout) :: sim !! its report is set; its problem stays as it was solved
    real(wp), allocatable :: solved(:, :)
    real(wp) :: own

    allocate (solved, source=sim%problem%record)
    call refresh_bonds(sim%scene, sim%contacts, sim%options%substep_length(), sim%problem)
    call find_worst(sim%problem, sim%report%worst_contact, own)
    call move_alloc(solved, sim%problem%record)
    sim%report%worst_speed = own
    call sim%comm%maximum(sim%report%worst_speed)
    if (own < sim%report%worst_speed) sim%report%worst_contact = 0
    sim%report%is_converged = sim%report%is_converged .and. &
                              sim%report%worst_speed <= sim%options%solver%tolerance*sim%report%velocity_scale
  end subroutine judge_unsettled

  !> Solve once, with or without a history, and count its messages.
  subroutine solve_once(sim)
    type(simulation_t), intent(inout) :: sim
    type(subdomain_t) :: coupling
    type(traffic_t) :: before

    before = sim%comm%traffic
    coupling = sim%decomposition%subdomain%by_slot(sim%pairs%slot_of)
    sim%solver%with_trace = sim%is_traced
    associate (bodies => sim%scene%bodies, contacts => sim%contacts, solver => sim%solver)
      if (bodies%n_carried > 0) solver%carried_body = bodies%carried(:, sim%pairs%body_of)
      if (contacts%n_carried > 0) solver%carried_contact = contacts%carried(:, :contacts%n)
      call solver%solve(sim%problem, coupling, sim%comm, sim%report)
      if (bodies%n_carried > 0) bodies%carried(:, sim%pairs%body_of) = solver%carried_body
      if (contacts%n_carried > 0) contacts%carried(:, :contacts%n) = solver%carried_contact
    end associate
    call sim%effort%add(sim%report)
    sim%gluing_traffic%messages = sim%gluing_traffic%messages + sim%comm%traffic%messages - before%messages
    sim%gluing_traffic%bytes = sim%gluing_traffic%bytes + sim%comm%traffic%bytes - before%bytes
  end subroutine solve_once
end module sg_solve_step
