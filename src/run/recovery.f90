!> Overlap that steps have left is undone: where it is deeper than the deck allows, bodies are pushed apart at the end of the step
!! (doc/theory/recovery.md).
!!
!! The push is the smallest one, in the norm of the masses, that opens all contacts: a contact problem without friction whose
!! velocities are displacements, a projection on positions [Acary2013]. Contacts that carry impulses stay closed, and those that
!! stick do not slide. Velocities and impulses stay as they are, and links keep their lengths.
module sg_recovery
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t, normal_impulse
  use sg_kinds, only: wp
  use sg_laws, only: forbidden_gap, is_frictionless, law_rigid_wire, law_rod, status_broken, status_stick
  use sg_link_contacts, only: is_link
  use sg_motion, only: shift
  use sg_problem, only: is_active, problem_t
  use sg_problem_bodies, only: take_velocities
  use sg_push_problem, only: no_limit, push_problem_t
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  implicit none
  private
  public :: recover

  !> Largest opening of a contact that one push aims at, over the smaller of its shapes
  real(wp), parameter :: most_push = 1e-2_wp
  !> The same of one that carries, and at least this share of its overlap: a pile rises by the sum over its layers
  real(wp), parameter :: most_carrying_push = 1e-3_wp, carrying_share = 0.1_wp
  !> Share of the overlap that the deck allows which a push leaves: room in which contacts that carry stay closed
  real(wp), parameter :: left_share = 0.4_wp
  !> Contacts take part that carry, or whose gaps are below this share of the deepest overlap
  real(wp), parameter :: reach_share = 0.5_wp
  !> Sweeps of a push, and at most: what they leave is for the next one (theory page, table)
  integer, parameter :: sweeps = 16, most_sweeps = 50
  !> Updates of contacts that cost nothing against a step: so many a push may take in any case
  integer, parameter :: free_updates = 1000

contains

  !> Push bodies apart where a contact is deeper than the deck allows; every few steps. Collective.
  subroutine recover(sim)
    type(simulation_t), intent(inout) :: sim !! after a step, its contacts those of the step
    real(wp) :: deepest(2)
    integer :: n

    if (modulo(sim%step, sim%options%recovery_every) > 0) return
    call find_deepest(sim%scene, sim%contacts, sim%problem, deepest)
    call sim%comm%maximum(deepest)
    if (.not. deepest(1) > sim%options%recovery) return
    if (.not. allocated(sim%pusher)) allocate (sim%pusher)
    call set_push(sim, reach_share*deepest(2))
    n = sim%pusher%push%n
    call sim%comm%sum(n)
    call sim%pusher%solve(min(most_sweeps, max(sweeps, free_updates/max(1, n))), &
                          sim%decomposition%subdomain%by_slot(sim%pairs%slot_of), sim%comm)
    if (is_better(sim%pusher%push, sim%comm)) call move_bodies(sim)
  end subroutine recover

  !> Does a push lessen overlap? Not where bodies have no room, nor where masses are so far apart that it overflows. Collective.
  logical function is_better(push, comm)
    type(push_problem_t), intent(in) :: push !! solved
    type(comm_t), intent(inout) :: comm
    real(wp) :: squares(2)

    call push%measure(squares)
    call comm%sum(squares)
    is_better = squares(2) < squares(1) .and. .not. comm%any(.not. all(ieee_is_finite(push%bodies%body)))
  end function is_better

  !> Move bodies by a push that is solved, and count it.
  subroutine move_bodies(sim)
    type(simulation_t), intent(inout) :: sim
    real(wp) :: moment(3)
    integer :: b, n

    n = sim%scene%dimension
    moment = 0
    associate (bodies => sim%scene%bodies)
      bodies%free_velocity = 0
      call take_velocities(sim%pusher%push%bodies, sim%pairs%body_of, sim%plan%radius, bodies)
      call shift(bodies, 1.0_wp)
      do b = 1, bodies%n_own
        moment(:n) = moment(:n) + bodies%mass(b)*bodies%free_velocity(:n, b)
      end do
      bodies%free_velocity = bodies%velocity
    end associate
    sim%energy%recovery_work = sim%energy%recovery_work - dot_product(sim%scene%gravity, moment)
    sim%totals%recoveries = sim%totals%recoveries + 1
  end subroutine move_bodies

  !> Deepest overlap over the smaller of the two shapes, and as such [m], of bodies that can move; zero without any.
  pure subroutine find_deepest(scene, contacts, problem, deepest)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    type(problem_t), intent(in) :: problem
    real(wp), intent(out) :: deepest(2)
    real(wp) :: gap
    integer :: k

    deepest = 0
    do k = 1, contacts%n
      ! Nearly all are passed by here.
      if (.not. contacts%gap(k) < 0) cycle
      if (is_link(scene, contacts, k)) cycle
      if (.not. is_active(problem, k)) cycle
      gap = gap_of(scene, contacts, k)
      deepest = max(deepest, [-gap/size_of(scene, contacts, k), -gap])
    end do
  end subroutine find_deepest

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

    associate (pair => contacts%contactor(:, k), reach => scene%contactors%reach)
      size_of = min(reach(pair(1)), reach(pair(2)))
    end associate
  end function size_of

  !> Contacts of a push: gaps that the next detection would find, of those that carry, overlap or nearly do, and links.
  subroutine set_push(sim, reach)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: reach !! largest gap of a contact that takes part without carrying [m]
    real(wp) :: opening, gap, room
    logical :: carries, sticks
    integer :: k

    associate (push => sim%pusher%push, contacts => sim%contacts)
      call push%begin(sim%scene, sim%plan, sim%pairs, sim%options%substep_length())
      do k = 1, contacts%n
        sticks = .false.
        if (is_link(sim%scene, contacts, k)) then
          if (contacts%status(k) == status_broken) cycle
          call push%place(sim%scene, sim%pairs, contacts, k, opening)
          call find_slack(sim%scene, contacts, k, opening, gap, room)
        else
          gap = gap_of(sim%scene, contacts, k)
          carries = normal_impulse(contacts, k) > 0
          if (.not. (carries .or. gap < reach)) cycle
          call push%place(sim%scene, sim%pairs, contacts, k, opening)
          call find_aim(gap + opening, size_of(sim%scene, contacts, k), carries, sim%options%recovery, gap, room)
          sticks = carries .and. contacts%status(k) == status_stick .and. .not. is_frictionless(sim%scene%laws(contacts%law(k)))
        end if
        call push%add(gap, room, sticks)
      end do
      call push%finish()
    end associate
  end subroutine set_push

  !> What a push asks of a contact: to open to the least gap that it aims at, and, where it carries, to stay closed.
  pure subroutine find_aim(gap, size, carries, allowed, lack, room)
    real(wp), intent(in) :: gap, size !! at the next detection, and reach of the smaller shape [m]
    logical, intent(in) :: carries !! does the contact carry an impulse?
    real(wp), intent(in) :: allowed !! overlap over size that the deck allows
    real(wp), intent(out) :: lack, room !! gap beyond the aim, and the largest one [m]
    real(wp) :: most

    most = most_push*size
    if (carries) most = min(most, max(most_carrying_push*size, -carrying_share*gap))
    lack = max(gap + left_share*allowed*size, -most)
    room = no_limit
    ! The aim is gap - lack. One that opens already, by restitution, is not closed.
    if (carries) room = max(0.0_wp, gap) - (gap - lack)
  end subroutine find_aim

  !> What a push asks of a link: a rod and a wire that pulls keep their length, so that their force stays; a slack wire and one that
  !! does not stretch become no longer than they are without force.
  pure subroutine find_slack(scene, contacts, k, opening, slack, room)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp), intent(in) :: opening !! in the rest of the step [m]
    real(wp), intent(out) :: slack, room !! of the link, and the largest one [m]
    real(wp) :: rest
    logical :: is_linear

    associate (own => scene%laws(contacts%law(k)))
      rest = scene%links%length(contacts%feature(k))
      ! The normal of a wire is turned round: it opens as it becomes shorter.
      slack = (1 + own%prestrain)*rest - contacts%gap(k) + opening
      is_linear = own%kind == law_rod .or. (own%kind /= law_rigid_wire .and. slack < 0)
      slack = merge(0.0_wp, max(slack, -most_push*rest), is_linear)
      room = merge(0.0_wp, no_limit, is_linear)
    end associate
  end subroutine find_slack
end module sg_recovery
