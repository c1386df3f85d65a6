!> Overlap that steps have left is undone: where it is deeper than the deck allows, bodies are pushed apart at the end of the step
!! (doc/theory/recovery.md).
!!
!! The push is the smallest one, in the norm of the masses, that opens all contacts: a contact problem without friction whose
!! velocities are displacements over the step, a projection on positions [Acary2013]. Velocities and impulses stay as they are, and
!! links keep their lengths.
module sg_recovery
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_assemble, only: begin_problem, put_contact
  use sg_body_energy, only: potential_energy
  use sg_cell_motion, only: cell_bias
  use sg_choose_solver, only: choose_solver
  use sg_compact, only: compact_velocity
  use sg_contacts, only: contacts_t
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_laws, only: forbidden_gap, law_rigid_wire, law_rod, local_law_t, status_broken
  use sg_link_contacts, only: is_link
  use sg_mapping, only: relative_velocity
  use sg_mapping_space, only: space_relative_velocity
  use sg_motion, only: shift
  use sg_problem, only: is_active, problem_t
  use sg_problem_bodies, only: take_velocities
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e8, solver_options_t
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  implicit none
  private
  public :: is_push_due, recover

  !> Largest opening of a contact that one push aims at, over the smaller of its shapes
  real(wp), parameter :: most_push = 1e-2_wp
  !> Sweeps of a push at most, and its tolerance: what it leaves is for the next one (theory page, table)
  integer, parameter :: most_sweeps = 50
  real(wp), parameter :: tolerance = 1e-2_wp

contains

  !> May bodies be pushed apart at the end of a step?
  pure logical function is_push_due(sim, step)
    type(simulation_t), intent(in) :: sim !! the run
    integer, intent(in) :: step !! number of the step

    is_push_due = sim%options%recovery > 0 .and. modulo(step, sim%options%recovery_every) == 0
  end function is_push_due

  !> Push bodies apart where a contact is deeper than the deck allows; every few steps. Collective.
  subroutine recover(sim, error)
    type(simulation_t), intent(inout) :: sim !! after a step, its contacts those of the step
    type(error_t), allocatable, intent(out) :: error !! set on all ranks where there is no solver
    type(report_t) :: report
    real(wp) :: deepest

    if (.not. is_push_due(sim, sim%step)) return
    deepest = deepest_share(sim%scene, sim%contacts, sim%problem)
    call sim%comm%maximum(deepest)
    if (.not. deepest > sim%options%recovery) return
    if (.not. allocated(sim%pusher)) call choose_pusher(sim, error)
    if (allocated(error)) return
    sim%scene%bodies%free_velocity = 0
    call set_push(sim)
    call sim%pusher%solve(sim%push, sim%decomposition%subdomain%by_slot(sim%pairs%slot_of), sim%comm, report)
    ! Where masses are so far apart that the push overflows, overlap stays.
    if (.not. sim%comm%any(.not. all(ieee_is_finite(sim%push%body)))) call move_bodies(sim)
    sim%scene%bodies%free_velocity = sim%scene%bodies%velocity
  end subroutine recover

  !> Move bodies by a push that is solved, and count it.
  subroutine move_bodies(sim)
    type(simulation_t), intent(inout) :: sim
    real(wp) :: before

    call take_velocities(sim%push, sim%pairs%body_of, sim%plan%radius, sim%scene%bodies)
    before = potential_energy(sim%scene)
    call shift(sim%scene%bodies, sim%options%substep_length())
    sim%energy%recovery_work = sim%energy%recovery_work + potential_energy(sim%scene) - before
    sim%totals%recoveries = sim%totals%recoveries + 1
  end subroutine move_bodies

  !> Deepest overlap over the smaller of the two shapes, of bodies that can move; zero without any.
  pure real(wp) function deepest_share(scene, contacts, problem) result(deepest)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    type(problem_t), intent(in) :: problem
    integer :: k

    deepest = 0
    do k = 1, contacts%n
      ! Nearly all are passed by here.
      if (.not. contacts%gap(k) < 0) cycle
      if (is_link(scene, contacts, k)) cycle
      if (is_active(problem, k)) deepest = max(deepest, -gap_of(scene, contacts, k)/size_of(scene, contacts, k))
    end do
  end function deepest_share

  !> Gap of a contact as its law sees it [m].
  pure real(wp) function gap_of(scene, contacts, k)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k

    gap_of = forbidden_gap(scene%laws(contacts%law(k)), contacts%gap(k), contacts%internal(:, k))
  end function gap_of

  !> Reach of the smaller shape of a contact [m].
  pure real(wp) function size_of(scene, contacts, k)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k

    size_of = minval(scene%contactors%reach(contacts%contactor(:, k)))
  end function size_of

  !> A solver for pushes: sweeps with momentum, by the orders and the coupling of the run.
  subroutine choose_pusher(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    type(solver_options_t) :: options

    options = sim%options%solver
    options%method = 'nesterov'
    options%criterion = criterion_e8
    options%tolerance = tolerance
    options%maximum_sweeps = most_sweeps
    options%check_every = 0
    options%warm_start = .false.
    call choose_solver(options, sim%options%partition, sim%comm%size, sim%pusher, error)
  end subroutine choose_pusher

  !> The contact problem of a push: velocities are displacements over the step, biases the gaps that the next detection would find
  !! over the step.
  subroutine set_push(sim)
    type(simulation_t), intent(inout) :: sim !! bodies without velocities in `free_velocity`
    type(local_law_t) :: law
    real(wp) :: squares, gap
    integer :: k

    squares = 0
    associate (h => sim%options%substep_length(), push => sim%push, contacts => sim%contacts)
      call begin_problem(sim%scene, sim%plan, sim%pairs, contacts%n, push)
      push%closing_speed = 0
      push%most_friction = 0
      do k = 1, contacts%n
        if (is_link(sim%scene, contacts, k)) then
          law = law_of_length(sim%scene, contacts, k, h)
        else
          gap = gap_of(sim%scene, contacts, k) + h*opening_of(sim%scene, contacts, k)
          law = local_law_t()
          law%bias(1) = max(gap, -most_push*size_of(sim%scene, contacts, k))/h
        end if
        call put_contact(sim%scene, sim%pairs, contacts, k, law, push)
        push%closing_speed = max(push%closing_speed, -law%bias(1))
        squares = squares + sum(compact_velocity(push, k)**2)
      end do
      push%free_norm = sqrt(squares)
      push%fall_speed = 0
      push%velocity_scale = push%closing_speed
    end associate
  end subroutine set_push

  !> What a push asks of a link: a rod and a wire that pulls keep their length, so that their force stays; a slack wire and one that
  !! does not stretch become no longer than they are without force.
  pure function law_of_length(scene, contacts, k, h) result(law)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp), intent(in) :: h
    type(local_law_t) :: law
    real(wp) :: slack, rest

    law%is_active = contacts%status(k) /= status_broken
    associate (own => scene%laws(contacts%law(k)))
      rest = scene%links%length(contacts%feature(k))
      ! The normal of a wire is turned round: it opens as it becomes shorter.
      slack = (1 + own%prestrain)*rest - contacts%gap(k) + h*opening_of(scene, contacts, k)
      law%is_linear = own%kind == law_rod .or. (own%kind /= law_rigid_wire .and. slack < 0)
      law%is_along_normal = law%is_linear
      if (.not. law%is_linear) law%bias(1) = max(slack, -most_push*rest)/h
    end associate
  end function law_of_length

  !> Velocity at which a contact opens at the end of the step [m/s].
  pure real(wp) function opening_of(scene, contacts, k) result(u)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp) :: in_plane(2), of_cell(3)

    if (scene%dimension == 3) then
      u = dot_product(contacts%normal(:, k), space_relative_velocity(scene, contacts, k, scene%bodies%velocity))
    else
      in_plane = relative_velocity(contacts, k, scene%bodies%middle, scene%period, scene%bodies%velocity)
      u = in_plane(1)
    end if
    if (scene%cell%is_on) then
      of_cell = cell_bias(scene, contacts, k)
      u = u + of_cell(1)
    end if
  end function opening_of
end module sg_recovery
