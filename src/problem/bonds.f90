!> Bonds of cohesive zones in the contact problem of a step: solved at a given integrity, weakened by what the solution does, and
!! noted at the end of the step (doc/theory/cohesive_zones.md).
module sg_bonds
  use sg_cohesive_zones, only: integrity_after, slip_across, stiffness_share
  use sg_compact, only: compact_velocity
  use sg_contact_laws, only: law_of_contact
  use sg_contact_surface, only: contact_surface
  use sg_contacts, only: contacts_t, has_bonds
  use sg_delassus, only: set_block
  use sg_internal_values, only: bond_integrity, bond_onset, bond_opening, bond_slip, bond_surface
  use sg_kinds, only: wp
  use sg_laws, only: is_cohesive_zone, law_t, local_law_t
  use sg_problem, only: problem_t
  use sg_records, only: arm_stiffness_n, bond_shift, friction_place, is_in_space, solid_stiffness_n
  use sg_scene, only: scene_t
  implicit none
  private
  public :: damage_t, refresh_bonds, finish_bonds, bond_impulse, bond_sums

  !> By how much the share of a change grows from round to round until it is whole again
  real(wp), parameter :: growth = 1.2_wp

  !> Damage of the bonds of a step over the rounds in which it settles
  type :: damage_t
    !> Integrity at the beginning of the step, and that which the last solution leads to, shape (contacts)
    real(wp), allocatable :: before(:), wanted(:)
    !> Change that the last round asked for, and share of it that the next round takes, shape (contacts)
    real(wp), allocatable, private :: change(:), share(:)
  contains
    procedure :: begin => damage_begin
    procedure :: find => damage_find
    procedure :: approach => damage_approach
    procedure :: accept => damage_accept
  end type damage_t

contains

  !> Begin a step.
  pure subroutine damage_begin(self, contacts)
    class(damage_t), intent(inout) :: self
    type(contacts_t), intent(in) :: contacts !! contacts of the step, with the integrity of its beginning

    self%before = contacts%internal(bond_integrity, :contacts%n)
    self%wanted = self%before
    self%change = 0*self%before
    self%share = self%change + 1
  end subroutine damage_begin

  !> Find the integrity of all bonds from the opening and slip at the end of the step, as its solution has them now.
  pure subroutine damage_find(self, scene, time_step, problem, contacts, change)
    class(damage_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene
    real(wp), intent(in) :: time_step !! time step [s]
    type(problem_t), intent(in) :: problem !! solved problem
    type(contacts_t), intent(in) :: contacts !! contacts with the integrity that it was solved for
    real(wp), intent(out) :: change !! largest change of an integrity
    real(wp) :: jump(4)
    integer :: k

    do k = 1, contacts%n
      if (.not. is_cohesive_zone(scene%laws(contacts%law(k)))) cycle
      if (.not. self%before(k) > 0) cycle
      jump = jump_after(problem, contacts, k, time_step)
      self%wanted(k) = integrity_after(scene%laws(contacts%law(k)), jump(1), norm2(jump(2:)), self%before(k), time_step)
    end do
    change = 0
    if (contacts%n > 0) change = maxval(abs(self%wanted - contacts%internal(bond_integrity, :contacts%n)))
  end subroutine damage_find

  !> Bring the bonds nearer to the integrity found, for the next round. A bond whose change has turned back, as where bonds that
  !! hold the same body take its load from each other in turns, takes half the share of it.
  pure subroutine damage_approach(self, settled, contacts)
    class(damage_t), intent(inout) :: self
    real(wp), intent(in) :: settled !! changes that do not count
    type(contacts_t), intent(inout) :: contacts !! contacts whose integrity is set
    real(wp) :: change
    integer :: k

    do k = 1, contacts%n
      change = self%wanted(k) - contacts%internal(bond_integrity, k)
      if (abs(change) > settled) then
        self%share(k) = merge(self%share(k)/2, min(1.0_wp, growth*self%share(k)), change*self%change(k) < 0)
        self%change(k) = change
      end if
      if (self%share(k) < 1) then
        contacts%internal(bond_integrity, k) = contacts%internal(bond_integrity, k) + self%share(k)*change
      else
        contacts%internal(bond_integrity, k) = self%wanted(k)
      end if
    end do
  end subroutine damage_approach

  !> Give all bonds the integrity found.
  pure subroutine damage_accept(self, contacts)
    class(damage_t), intent(in) :: self
    type(contacts_t), intent(inout) :: contacts !! contacts whose integrity is set

    contacts%internal(bond_integrity, :contacts%n) = self%wanted
  end subroutine damage_accept

  !> Put the present integrity of all bonds into the records of their contacts.
  subroutine refresh_bonds(scene, contacts, time_step, problem)
    type(scene_t), intent(in) :: scene !! scene, its `middle` configuration set
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    real(wp), intent(in) :: time_step !! time step [s]
    type(problem_t), intent(inout) :: problem !! problem of the step; its bodies have whole masses
    type(local_law_t) :: law
    integer :: k, first

    do k = 1, contacts%n
      if (.not. is_cohesive_zone(scene%laws(contacts%law(k)))) cycle
      call law_of_contact(scene, contacts, k, time_step, law)
      problem%most_friction = max(problem%most_friction, law%friction)
      problem%record(friction_place(problem%kind), k) = law%friction
      first = merge(solid_stiffness_n, arm_stiffness_n, is_in_space(problem%kind)) + bond_shift(problem%kind)
      problem%record(first:first + 1, k) = law%stiffness
      call set_block(problem%kind, problem%body(:, problem%pair(1, k)), problem%body(:, problem%pair(2, k)), problem%record(:, k))
    end do
  end subroutine refresh_bonds

  !> Opening, and slip, at the end of a step [m]; in the plane the slip has one component.
  pure function jump_after(problem, contacts, k, time_step) result(jump)
    type(problem_t), intent(in) :: problem
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp), intent(in) :: time_step
    real(wp) :: jump(4), u(3)

    jump = 0
    ! The velocity holds the gap as a bias: what opens is the gap at the end of the step.
    u = compact_velocity(problem, k)
    if (contacts%dimension == 2) then
      jump(1:2) = [time_step*u(1), contacts%internal(bond_slip, k) + time_step*u(2)]
    else
      associate (n => contacts%normal(:, k))
        jump(1) = time_step*dot_product(n, u)
        jump(2:) = slip_across(contacts%internal(bond_slip:bond_slip + 2, k), n) + time_step*(u - dot_product(n, u)*n)
      end associate
    end if
    jump(1) = max(0.0_wp, jump(1))
  end function jump_after

  !> Note opening, slip and surface of all bonds at the end of a step, and when they began to fail.
  subroutine finish_bonds(scene, time_step, time, problem, contacts)
    type(scene_t), intent(in) :: scene !! scene
    real(wp), intent(in) :: time_step !! time step [s]
    real(wp), intent(in) :: time !! at the end of the step [s]
    type(problem_t), intent(in) :: problem !! solved problem
    type(contacts_t), intent(inout) :: contacts !! contacts whose internal values are set
    real(wp) :: jump(4)
    integer :: k, last

    last = contacts%n_internal - contacts%n_moments
    do k = 1, contacts%n
      if (.not. is_cohesive_zone(scene%laws(contacts%law(k)))) cycle
      jump = jump_after(problem, contacts, k, time_step)
      associate (values => contacts%internal(:, k))
        values(bond_surface) = contact_surface(scene%contactors, contacts, k)
        values(bond_opening) = jump(1)
        values(bond_slip:last) = jump(2:2 + last - bond_slip)
        if (values(bond_integrity) < 1 .and. values(bond_onset) < 0) values(bond_onset) = time
      end associate
    end do
  end subroutine finish_bonds

  !> Impulse of a bond on the candidate over a step whose end is noted [N s], components as impulses of contacts have them.
  pure function bond_impulse(law, contacts, k, time_step) result(impulse)
    type(law_t), intent(in) :: law !! law of the contact, a cohesive zone
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp), intent(in) :: time_step !! time step [s]
    real(wp) :: impulse(contacts%n_components)
    real(wp) :: share

    associate (values => contacts%internal(:, k), c => law%zone_stiffness)
      share = -time_step*values(bond_surface)*stiffness_share(law, values(bond_integrity))
      if (contacts%dimension == 2) then
        impulse = share*c*values([bond_opening, bond_slip])
      else
        impulse = share*(c(1)*values(bond_opening)*contacts%normal(:, k) + c(2)*values(bond_slip:bond_slip + 2))
      end if
    end associate
  end function bond_impulse

  !> Sums over the bonds of all contacts: the energy that they store [J], how many hold, and how many of those are damaged.
  pure function bond_sums(scene, contacts) result(sums)
    type(scene_t), intent(in) :: scene !! scene
    type(contacts_t), intent(in) :: contacts !! contacts after a step
    real(wp) :: sums(3)
    integer :: k, last

    sums = 0
    if (.not. has_bonds(contacts)) return
    last = contacts%n_internal - contacts%n_moments
    do k = 1, contacts%n
      associate (law => scene%laws(contacts%law(k)), values => contacts%internal(:, k))
        if (.not. is_cohesive_zone(law)) cycle
        if (.not. values(bond_integrity) > 0) cycle
        sums(1) = sums(1) + values(bond_surface)*stiffness_share(law, values(bond_integrity))/2 &
                  *(law%zone_stiffness(1)*values(bond_opening)**2 + law%zone_stiffness(2)*sum(values(bond_slip:last)**2))
        sums(2:3) = sums(2:3) + [1.0_wp, merge(1.0_wp, 0.0_wp, values(bond_integrity) < 1)]
      end associate
    end do
  end function bond_sums
end module sg_bonds
