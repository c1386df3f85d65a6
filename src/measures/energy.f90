!> The energy balance of a run, exact for the discrete scheme (doc/theory/indicators.md, "Energy").
!!
!! With the mean velocity Vm = (V0 + V)/2 of a step, the change of kinetic energy is Vm . M (V - V0), and the
!! discrete equation M (V - V0) = h f + H r + d makes it the work of the forces f, of the contact impulses r and
!! of the impulses d that hold driven components. Works are summed over the steps; the balance closes to rounding
!! when positions move with Vm too (theta = 1/2). In space gyroscopic torques do no work on a free body; in a step with
!! impacts they do some, of the order of the step, which the balance then shows. Drives work against them. The work of a periodic
!! cell is one of imposed forces.
module sg_energy
  use sg_bodies, only: is_absent
  use sg_body_energy, only: kinetic_energy, kinetic_energy_of, potential_drop, potential_energy
  use sg_cell_motion, only: cell_work
  use sg_comm, only: comm_t
  use sg_contact_work, only: contact_work
  use sg_contacts, only: contacts_t
  use sg_imposed_work, only: find_mean, has_driven, held_work, imposed_work
  use sg_kinds, only: wp
  use sg_link_contacts, only: energy_of_links
  use sg_scene, only: scene_t
  use sg_tally, only: pass_columns, pass_sums, tally_t
  implicit none
  private
  public :: energy_t, measure_energy, bond_work_of, measure_rolling, n_energy_values

  !> Numbers that `pack` writes
  integer, parameter :: n_energy_values = 10
  !> Numbers of `energy_sums`
  integer, parameter :: n_energy_sums = 11

  !> Works summed since the start of the run [J per metre of depth]; in a decomposed scene the shares of this rank
  type :: energy_t
    !> Has the balance begun?
    logical :: is_started = .false.
    !> Kinetic and potential energy when it began
    real(wp) :: kinetic_start = 0, potential_start = 0
    !> Work of imposed forces and pressures
    real(wp) :: external_work = 0
    !> Work of what holds driven components on their velocities
    real(wp) :: drive_work = 0
    !> Energy taken by contacts along tangents and along normals
    real(wp) :: friction_loss = 0, impact_loss = 0
    !> Energy taken by the bonds of cohesive zones, stored or lost
    real(wp) :: bond_work = 0
    !> Energy taken by moments that resist rolling and twisting
    real(wp) :: rolling_loss = 0
    !> Potential energy that bodies were given by pushes which undo overlap
    real(wp) :: recovery_work = 0
    !> Gravity of the last step counted [m/s2], shape (3); unallocated before the first one
    real(wp), allocatable, private :: gravity(:)
  contains
    procedure :: add_step => energy_add_step
    procedure :: change_gravity => energy_change_gravity
    procedure :: gravity_for => energy_gravity_for
    procedure :: let_pass => energy_let_pass
    procedure :: pack => energy_pack
    procedure :: unpack => energy_unpack
    procedure :: reduce => energy_reduce
    procedure :: leave_to_first => energy_leave_to_first
  end type energy_t

contains

  !> Add the works of a step that is solved but not updated: `velocity` is that of its beginning, `free_velocity` of its end.
  pure subroutine energy_add_step(self, scene, contacts, h, radius)
    class(energy_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene after the solve, before the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in), contiguous :: radius(:) !! signed radii of round bodies as in `plan_t`, empty for other scenes [m]
    real(wp) :: mean(scene%bodies%n_velocity, scene%bodies%n), work(4), elastic(2)

    if (.not. self%is_started) then
      self%is_started = .true.
      self%kinetic_start = kinetic_energy(scene%bodies)
      ! What links hold at the start is taken from them as they give it back.
      elastic = energy_of_links(scene, contacts)
      self%potential_start = potential_energy(scene) + sum(elastic)
      self%impact_loss = elastic(1)
      self%friction_loss = elastic(2)
    end if
    if (any(abs(scene%gravity - self%gravity_for(scene)) > 0)) call self%change_gravity(scene, self%gravity_for(scene))
    call keep_gravity(self, scene%gravity)
    call find_mean(size(mean), scene%bodies%velocity, scene%bodies%free_velocity, mean)
    work = contact_work(scene, contacts, h, mean, radius)
    self%impact_loss = self%impact_loss - work(1)
    self%friction_loss = self%friction_loss - work(2)
    self%bond_work = self%bond_work - work(3)
    self%rolling_loss = self%rolling_loss - work(4)
    self%external_work = self%external_work + imposed_work(scene, h, mean)
    if (scene%cell%is_on) self%external_work = self%external_work + cell_work(scene, contacts)
    if (.not. has_driven(size(mean), mean, scene%bodies%inverse_mass)) return
    where (scene%bodies%inverse_mass > 0) mean = 0
    self%drive_work = self%drive_work + held_work(scene%bodies, h, mean) &
                      - sum(contact_work(scene, contacts, h, mean, radius))
  end subroutine energy_add_step

  !> Go on under another gravity: the balance counts from the potential energy that bodies would have had under it.
  pure subroutine energy_change_gravity(self, scene, former)
    class(energy_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene where the change happens, with its gravity from now on
    real(wp), intent(in) :: former(3) !! gravity before [m/s2]

    self%potential_start = self%potential_start + (potential_energy(scene) - potential_energy(scene, former))
    call keep_gravity(self, scene%gravity)
  end subroutine energy_change_gravity

  !> Keep the gravity of a step. Allocated before: an assignment would compute with the bounds of what is not there.
  pure subroutine keep_gravity(self, gravity)
    class(energy_t), intent(inout) :: self
    real(wp), intent(in) :: gravity(3)

    if (.not. allocated(self%gravity)) allocate (self%gravity(3))
    self%gravity(:) = gravity
  end subroutine keep_gravity

  !> Gravity under which the potential energy is measured [m/s2]: that of the last step counted, else that of the scene.
  pure function energy_gravity_for(self, scene) result(gravity)
    class(energy_t), intent(in) :: self
    type(scene_t), intent(in) :: scene !! the scene
    real(wp) :: gravity(3)

    gravity = scene%gravity
    if (allocated(self%gravity)) gravity = self%gravity
  end function energy_gravity_for

  !> Count the energy that a body brings when it enters as energy of the start, or no longer that which it takes along.
  pure subroutine energy_let_pass(self, scene, body, is_entering)
    class(energy_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene with the body, which has its place and velocity
    integer, intent(in) :: body !! one that this rank counts as its own
    logical, intent(in) :: is_entering !! does it enter? Else it leaves
    real(wp) :: sign

    ! What the first step begins with is counted then.
    if (.not. self%is_started) return
    sign = merge(1.0_wp, -1.0_wp, is_entering)
    self%kinetic_start = self%kinetic_start + sign*kinetic_energy_of(scene%bodies, body)
    self%potential_start = self%potential_start - sign*potential_drop(scene, body, self%gravity_for(scene))
  end subroutine energy_let_pass

  !> Energies, works since the start [J], and how far their balance is from closing.
  pure subroutine measure_energy(scene, contacts, energy, tally)
    type(scene_t), intent(in) :: scene !! scene after the update
    type(contacts_t), intent(in) :: contacts !! contacts of the step, for the energy of links
    type(energy_t), intent(in) :: energy !! works since the start
    type(tally_t), intent(inout) :: tally !! tally of the measure
    real(wp) :: sums(n_energy_sums)

    if (tally%pass == pass_sums) call tally%sums%put('energy', energy_sums(energy, scene, contacts))
    if (tally%pass /= pass_columns) return
    sums = tally%sums%get('energy', n_energy_sums)
    call tally%add('kinetic_energy', sums(1))
    call tally%add('potential_energy', sums(2))
    call tally%add('external_work', sums(6))
    call tally%add('drive_work', sums(7))
    call tally%add('friction_loss', sums(8))
    call tally%add('impact_loss', sums(9))
    call tally%add('energy_closure', closure_of(sums, energy%is_started))
  end subroutine measure_energy

  !> Energy that bonds have taken since the start [J], stored or lost.
  pure real(wp) function bond_work_of(tally) result(work)
    type(tally_t), intent(in) :: tally !! tally of the measure, summed
    real(wp) :: sums(n_energy_sums)

    sums = tally%sums%get('energy', n_energy_sums)
    work = sums(10)
  end function bond_work_of

  !> Energy that moments against rolling and twisting have taken since the start [J], a column of scenes with such laws.
  pure subroutine measure_rolling(tally)
    type(tally_t), intent(inout) :: tally !! tally of the measure, summed in its last pass
    real(wp) :: sums(n_energy_sums)

    if (tally%pass /= pass_columns .or. .not. tally%has_rolling) return
    sums = tally%sums%get('energy', n_energy_sums)
    call tally%add('rolling_loss', sums(11))
  end subroutine measure_rolling

  !> Terms of the balance, of this rank [J]: kinetic and potential energy, sum of the absolute potential energies of
  !! the bodies, both energies at the start, and works of forces and pushes, of drives, of friction, of impacts, of bonds and of
  !! moments.
  pure function energy_sums(energy, scene, contacts) result(sums)
    type(energy_t), intent(in) :: energy
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp) :: sums(n_energy_sums), elastic(2), gravity(3), drop
    integer :: i

    elastic = energy_of_links(scene, contacts)
    gravity = energy%gravity_for(scene)
    sums(1:3) = [kinetic_energy(scene%bodies), 0.0_wp, 0.0_wp]
    do i = 1, scene%bodies%n_own
      if (is_absent(scene%bodies, i)) cycle
      drop = potential_drop(scene, i, gravity)
      sums(2) = sums(2) - drop
      sums(3) = sums(3) + abs(drop)
    end do
    sums(2) = sums(2) + sum(elastic)
    sums(4:) = [energy%kinetic_start, energy%potential_start, energy%external_work + energy%recovery_work, energy%drive_work, &
                energy%friction_loss - elastic(2), energy%impact_loss - elastic(1), energy%bond_work, energy%rolling_loss]
  end function energy_sums

  !> How far the balance is from closing over its largest term, from the sums over all ranks; zero before the first step.
  !!
  !! Terms that are lost in the rounding of the potential energy (10^-8 of it and below) do not count as large.
  pure real(wp) function closure_of(sums, is_started) result(closure)
    real(wp), intent(in) :: sums(n_energy_sums)
    logical, intent(in) :: is_started
    real(wp) :: gain, scale

    closure = 0
    if (.not. is_started) return
    associate (kinetic => sums(1), kinetic_start => sums(4), external_work => sums(6), drive_work => sums(7), &
               friction_loss => sums(8), impact_loss => sums(9), bond_work => sums(10), rolling_loss => sums(11))
      gain = sums(2) - sums(5)
      scale = max(sums(3)*sqrt(epsilon(scale)), kinetic, abs(kinetic_start), abs(gain), abs(external_work), abs(drive_work), &
                  abs(friction_loss), abs(impact_loss), abs(bond_work), abs(rolling_loss))
      if (.not. scale > 0) return
      closure = abs(kinetic - kinetic_start + gain - external_work - drive_work + friction_loss + impact_loss &
                    + bond_work + rolling_loss)/scale
    end associate
  end function closure_of

  !> From the shares of each rank to the sums of the whole scene, for restart files.
  subroutine energy_reduce(self, comm)
    class(energy_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp) :: values(n_energy_values)

    if (comm%size == 1) return
    values = self%pack()
    call comm%sum(values)
    call self%unpack(values)
  end subroutine energy_reduce

  !> The other way round: the first rank keeps the sums of the whole scene, and the others begin at zero.
  pure subroutine energy_leave_to_first(self, comm)
    class(energy_t), intent(inout) :: self
    type(comm_t), intent(in) :: comm !! the ranks
    real(wp) :: values(n_energy_values)

    if (comm%rank == 0) return
    values = 0
    if (self%is_started) values(1) = 1
    call self%unpack(values)
  end subroutine energy_leave_to_first

  !> The sums as a list of reals, for restart files.
  pure function energy_pack(self) result(values)
    class(energy_t), intent(in) :: self
    real(wp) :: values(n_energy_values)

    values = [merge(1.0_wp, 0.0_wp, self%is_started), self%kinetic_start, self%potential_start, self%external_work, &
              self%drive_work, self%friction_loss, self%impact_loss, self%bond_work, self%recovery_work, self%rolling_loss]
  end function energy_pack

  !> The sums back from a list of reals.
  pure subroutine energy_unpack(self, values)
    class(energy_t), intent(inout) :: self
    real(wp), intent(in) :: values(n_energy_values) !! what `pack` gave

    self%is_started = values(1) > 0
    self%kinetic_start = values(2)
    self%potential_start = values(3)
    self%external_work = values(4)
    self%drive_work = values(5)
    self%friction_loss = values(6)
    self%impact_loss = values(7)
    self%bond_work = values(8)
    self%recovery_work = values(9)
    self%rolling_loss = values(10)
  end subroutine energy_unpack
end module sg_energy
