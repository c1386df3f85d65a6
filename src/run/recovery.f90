!> Overlap that steps have left is undone: where it is deeper than the deck allows, bodies are pushed apart at the end of the step
!! (doc/theory/recovery.md).
!!
!! The push is the smallest one, in the norm of the masses, that opens all contacts: a contact problem without friction whose
!! velocities are displacements, a projection on positions [Acary2013]. Velocities and impulses stay as they are, and links keep
!! their lengths.
module sg_recovery
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp
  use sg_laws, only: forbidden_gap, law_rigid_wire, law_rod, status_broken
  use sg_link_contacts, only: is_link
  use sg_motion, only: shift
  use sg_problem, only: is_active, problem_t
  use sg_problem_bodies, only: take_velocities
  use sg_push_problem, only: push_problem_t
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  implicit none
  private
  public :: recover

  !> Largest opening of a contact that one push aims at, over the smaller of its shapes
  real(wp), parameter :: most_push = 1e-2_wp
  !> Share of the overlap that the deck allows which a push leaves: contacts that carry stay closed, or what rests would hop
  real(wp), parameter :: left_share = 0.5_wp
  !> Contacts take part whose gaps are below this share of the deepest overlap
  real(wp), parameter :: reach_share = 0.5_wp
  !> Sweeps of a push per step since the last look, and at most: what they leave is for the next one (theory page, table)
  integer, parameter :: sweeps_per_step = 2, most_sweeps = 50
  !> Updates of rows that cost nothing against a step: so many a push may take in any case
  integer, parameter :: free_updates = 1000

contains

  !> Push bodies apart where a contact is deeper than the deck allows; every few steps. Collective.
  subroutine recover(sim)
    type(simulation_t), intent(inout) :: sim !! after a step, its contacts those of the step
    real(wp) :: deepest(2)
    integer :: rows

    if (modulo(sim%step, sim%options%recovery_every) > 0) return
    call find_deepest(sim%scene, sim%contacts, sim%problem, deepest)
    call sim%comm%maximum(deepest)
    if (.not. deepest(1) > sim%options%recovery) return
    if (.not. allocated(sim%pusher)) allocate (sim%pusher)
    call set_push(sim, reach_share*deepest(2))
    rows = sim%pusher%push%n
    call sim%comm%sum(rows)
    call sim%pusher%solve(min(most_sweeps, max(sweeps_per_step*sim%options%recovery_every, free_updates/max(1, rows))), &
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

    size_of = minval(scene%contactors%reach(contacts%contactor(:, k)))
  end function size_of

  !> Rows of a push: gaps that the next detection would find, of contacts that overlap or nearly do, and links.
  subroutine set_push(sim, reach)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: reach !! largest gap of a contact that takes part [m]
    real(wp) :: jacobian(6, 2), opening, gap, size
    logical :: is_linear
    integer :: k

    associate (push => sim%pusher%push, contacts => sim%contacts)
      call push%begin(sim%scene, sim%plan, sim%pairs, sim%options%substep_length())
      do k = 1, contacts%n
        if (is_link(sim%scene, contacts, k)) then
          if (contacts%status(k) == status_broken) cycle
          call push%find(sim%scene, sim%pairs, contacts, k, jacobian, opening)
          call find_slack(sim%scene, contacts, k, opening, gap, is_linear)
        else
          if (.not. is_active(sim%problem, k)) cycle
          call push%find(sim%scene, sim%pairs, contacts, k, jacobian, opening)
          gap = gap_of(sim%scene, contacts, k) + opening
          if (.not. gap < reach) cycle
          size = size_of(sim%scene, contacts, k)
          gap = max(gap + left_share*sim%options%recovery*size, -most_push*size)
          is_linear = .false.
        end if
        call push%add(sim%pairs%slot_of(contacts%body(:, k)), jacobian, gap, is_linear)
      end do
      call push%finish()
    end associate
  end subroutine set_push

  !> What a push asks of a link: a rod and a wire that pulls keep their length, so that their force stays; a slack wire and one that
  !! does not stretch become no longer than they are without force.
  pure subroutine find_slack(scene, contacts, k, opening, slack, is_linear)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp), intent(in) :: opening !! in the rest of the step [m]
    real(wp), intent(out) :: slack !! [m]
    logical, intent(out) :: is_linear !! does it keep its length?
    real(wp) :: rest

    associate (own => scene%laws(contacts%law(k)))
      rest = scene%links%length(contacts%feature(k))
      ! The normal of a wire is turned round: it opens as it becomes shorter.
      slack = (1 + own%prestrain)*rest - contacts%gap(k) + opening
      is_linear = own%kind == law_rod .or. (own%kind /= law_rigid_wire .and. slack < 0)
      slack = merge(0.0_wp, max(slack, -most_push*rest), is_linear)
    end associate
  end subroutine find_slack
end module sg_recovery
