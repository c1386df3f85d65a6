!> The energy balance of a run, exact for the discrete scheme (doc/theory/indicators.md, "Energy").
!!
!! With the mean velocity Vm = (V0 + V)/2 of a step, the change of kinetic energy is Vm . M (V - V0), and the
!! discrete equation M (V - V0) = h f + H r + d makes it the work of the forces f, of the contact impulses r and
!! of the impulses d that hold driven components. Works are summed over the steps; the balance closes to rounding
!! when positions move with Vm too (theta = 1/2). In space gyroscopic torques do no work on a free body; in a step with
!! impacts they do some, of the order of the step, which the balance then shows. Drives work against them. The work of a periodic
!! cell is one of imposed forces.
module sg_energy
  use sg_bodies, only: bodies_t, is_absent
  use sg_bonds, only: bond_impulse
  use sg_cell_motion, only: cell_bias, cell_jump, cell_work
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t, impulse_vector, normal_impulse
  use sg_internal_values, only: bond_slip
  use sg_kinds, only: wp
  use sg_laws, only: is_cohesive_zone
  use sg_link_contacts, only: energy_of_links
  use sg_mapping, only: relative_velocity
  use sg_mapping_space, only: space_arms
  use sg_rotations, only: no_rotation, turned_back, turned_by, turned_on
  use sg_scene, only: scene_t, unwrapped
  use sg_tally, only: pass_columns, pass_sums, tally_t
  implicit none
  private
  public :: energy_t, measure_energy, add_held_work, bond_work_of, kinetic_energy, kinetic_energy_at, potential_energy
  public :: n_energy_values

  !> Numbers that `pack` writes
  integer, parameter :: n_energy_values = 9
  !> Numbers of `energy_sums`
  integer, parameter :: n_energy_sums = 10

  !> Works summed since the start of the run [J per metre of depth]; in a decomposed scene the shares of this rank
  type :: energy_t
    !> Has the balance begun?
    logical :: is_started = .false.
    !> Kinetic and potential energy when it began
    real(wp) :: kinetic_start = 0, potential_start = 0
    !> Work of imposed forces and pressures, and of what holds driven components on their velocities
    real(wp) :: external_work = 0, drive_work = 0
    !> Energy taken by contacts along tangents and along normals
    real(wp) :: friction_loss = 0, impact_loss = 0
    !> Energy taken by the bonds of cohesive zones, stored or lost
    real(wp) :: bond_work = 0
    !> Potential energy that bodies were given by pushes which undo overlap
    real(wp) :: recovery_work = 0
    !> Gravity of the last step counted [m/s2], under which the potential energy is measured; huge where it is that of the scene
    real(wp) :: gravity(3) = huge(1.0_wp)
  contains
    procedure :: add_step => energy_add_step
    procedure :: change_gravity => energy_change_gravity
    procedure :: let_pass => energy_let_pass
    procedure :: pack => energy_pack
    procedure :: unpack => energy_unpack
    procedure :: reduce => energy_reduce
    procedure :: leave_to_first => energy_leave_to_first
  end type energy_t

contains

  !> Add the works of a step that is solved but not updated: `velocity` is that of its beginning, `free_velocity` of its end.
  pure subroutine energy_add_step(self, scene, contacts, h)
    class(energy_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene after the solve, before the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    real(wp) :: mean(scene%bodies%n_velocity, scene%bodies%n), work(3), elastic(2)

    if (.not. self%is_started) then
      self%is_started = .true.
      self%gravity = scene%gravity
      self%kinetic_start = kinetic_energy(scene%bodies)
      ! What links hold at the start is taken from them as they give it back.
      elastic = energy_of_links(scene, contacts)
      self%potential_start = potential_energy(scene) + sum(elastic)
      self%impact_loss = elastic(1)
      self%friction_loss = elastic(2)
    end if
    if (.not. self%gravity(1) < huge(1.0_wp)) self%gravity = scene%gravity
    if (any(abs(scene%gravity - self%gravity) > 0)) call self%change_gravity(scene, self%gravity)
    call find_mean(size(mean), scene%bodies%velocity, scene%bodies%free_velocity, mean)
    work = contact_work(scene, contacts, h, mean)
    self%impact_loss = self%impact_loss - work(1)
    self%friction_loss = self%friction_loss - work(2)
    self%bond_work = self%bond_work - work(3)
    self%external_work = self%external_work + imposed_work(scene, h, mean)
    if (scene%cell%is_on) self%external_work = self%external_work + cell_work(scene, contacts)
    if (.not. has_driven(size(mean), mean, scene%bodies%inverse_mass)) return
    where (scene%bodies%inverse_mass > 0) mean = 0
    self%drive_work = self%drive_work + held_work(scene%bodies, h, mean) &
                      - sum(contact_work(scene, contacts, h, mean))
  end subroutine energy_add_step

  !> Go on under another gravity: the balance counts from the potential energy that bodies would have had under it.
  pure subroutine energy_change_gravity(self, scene, former)
    class(energy_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene where the change happens, with its gravity from now on
    real(wp), intent(in) :: former(3) !! gravity before [m/s2]

    self%potential_start = self%potential_start + potential_energy(scene) - potential_energy(scene, former)
    self%gravity = scene%gravity
  end subroutine energy_change_gravity

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
    self%potential_start = self%potential_start - sign*potential_drop(scene, body, self%gravity)
  end subroutine energy_let_pass

  !> Work of the contact impulses along normals and along tangents, and of bonds [J]: r . H^T v.
  pure function contact_work(scene, contacts, h, velocity) result(work)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in) :: h
    real(wp), intent(in), contiguous :: velocity(:, :)
    real(wp) :: work(3), u(2), bias(3), jump(3), normal_work, bond(contacts%n_components), of_bond
    real(wp), allocatable :: spin(:, :)
    integer :: k
    logical :: has_bonds

    work = 0
    has_bonds = contacts%n_internal >= bond_slip
    if (scene%dimension == 2 .and. .not. has_bonds .and. .not. scene%cell%is_on) then
      work(1:2) = work_in_plane(scene, contacts, velocity)
      return
    end if
    if (scene%dimension == 3) spin = spins_in_world(scene%bodies, velocity)
    do k = 1, contacts%n
      if (.not. any(abs(contacts%impulse(:, k)) > 0)) cycle
      if (scene%dimension == 3) then
        jump = jump_at(scene, contacts, k, velocity, spin)
        if (scene%cell%is_on) jump = jump + cell_jump(scene, contacts, k, 0.5_wp)
        normal_work = normal_impulse(contacts, k)*dot_product(contacts%normal(:, k), jump)
        work = work + [normal_work, dot_product(impulse_vector(contacts, k), jump) - normal_work, 0.0_wp]
        if (.not. has_bonds) cycle
        if (.not. is_cohesive_zone(scene%laws(contacts%law(k)))) cycle
        bond = bond_impulse(scene%laws(contacts%law(k)), contacts, k, h)
        of_bond = dot_product(bond, jump)
        normal_work = dot_product(bond, contacts%normal(:, k))*dot_product(contacts%normal(:, k), jump)
        work = work + [-normal_work, normal_work - of_bond, of_bond]
        cycle
      end if
      u = relative_velocity(contacts, k, scene%bodies%middle, scene%period, velocity)
      if (scene%cell%is_on) then
        bias = cell_bias(scene, contacts, k, 0.5_wp)
        u = u + bias(:2)
      end if
      work(:size(bond)) = work(:size(bond)) + contacts%impulse(:, k)*u(:size(bond))
      if (.not. has_bonds) cycle
      if (.not. is_cohesive_zone(scene%laws(contacts%law(k)))) cycle
      bond = bond_impulse(scene%laws(contacts%law(k)), contacts, k, h)
      work = work + [-bond*u, dot_product(bond, u)]
    end do
  end function contact_work

  !> The same along normals and tangents in the plane, without bonds and a periodic cell: r . `relative_velocity` in one pass.
  pure function work_in_plane(scene, contacts, velocity) result(work)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in), contiguous :: velocity(:, :)
    real(wp) :: work(2), normal, tangential, half, x, y, ux, uy
    integer :: k

    work = 0
    do k = 1, contacts%n
      normal = contacts%impulse(1, k)
      tangential = 0
      if (contacts%n_components == 2) tangential = contacts%impulse(2, k)
      if (.not. abs(normal) + abs(tangential) > 0) cycle
      associate (c => contacts%body(1, k), a => contacts%body(2, k), n => contacts%normal(:, k), point => contacts%point(:, k), &
                 middle => scene%bodies%middle)
        ux = velocity(1, c) - velocity(1, a)
        uy = velocity(2, c) - velocity(2, a)
        if (size(velocity, 1) == 3) then
          half = contacts%gap(k)/2
          x = point(1) + half*n(1) - middle(1, c)
          y = point(2) + half*n(2) - middle(2, c)
          ux = ux - velocity(3, c)*y
          uy = uy + velocity(3, c)*x
          x = point(1) - half*n(1) - middle(1, a) - scene%period*real(contacts%image(k), wp)
          y = point(2) - half*n(2) - middle(2, a)
          ux = ux + velocity(3, a)*y
          uy = uy - velocity(3, a)*x
        end if
        work(1) = work(1) + normal*(n(1)*ux + n(2)*uy)
        work(2) = work(2) + tangential*(n(2)*ux - n(1)*uy)
      end associate
    end do
  end function work_in_plane

  !> Spins of all bodies in the world's axes [rad/s]; a body has many contacts, and is turned once. None where nothing turns.
  pure function spins_in_world(bodies, velocity) result(spin)
    type(bodies_t), intent(in) :: bodies
    real(wp), intent(in), contiguous :: velocity(:, :)
    real(wp), allocatable :: spin(:, :)
    integer :: b

    allocate (spin(3, merge(bodies%n, 0, size(velocity, 1) == 6)))
    do b = 1, size(spin, 2)
      spin(:, b) = turned_by(bodies%middle(4:7, b), velocity(4:6, b))
    end do
  end function spins_in_world

  !> Relative velocity at a contact in space [m/s]: `space_relative_velocity`, of spins that are turned already.
  pure function jump_at(scene, contacts, k, velocity, spin) result(u)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp), intent(in), contiguous :: velocity(:, :), spin(:, :)
    real(wp) :: u(3), arms(3, 2)

    associate (c => contacts%body(1, k), a => contacts%body(2, k))
      u = velocity(1:3, c) - velocity(1:3, a)
      if (size(spin, 2) == 0) return
      arms = space_arms(scene, contacts, k)
      associate (p => spin(:, c), q => spin(:, a), x => arms(:, 1), y => arms(:, 2))
        u(1) = u(1) + p(2)*x(3) - p(3)*x(2) - q(2)*y(3) + q(3)*y(2)
        u(2) = u(2) + p(3)*x(1) - p(1)*x(3) - q(3)*y(1) + q(1)*y(3)
        u(3) = u(3) + p(1)*x(2) - p(2)*x(1) - q(1)*y(2) + q(2)*y(1)
      end associate
    end associate
  end function jump_at

  !> Mean velocity of a step, by components one after the other: in pieces of a body they would not fill vector registers.
  pure subroutine find_mean(n, before, after, mean)
    integer, intent(in) :: n !! components of all bodies
    real(wp), intent(in) :: before(n), after(n)
    real(wp), intent(out) :: mean(n)

    mean = (before + after)/2
  end subroutine find_mean

  !> Does a component move whose velocity is given?
  pure logical function has_driven(n, mean, inverse_mass)
    integer, intent(in) :: n !! components of all bodies
    real(wp), intent(in) :: mean(n), inverse_mass(n)

    has_driven = count(abs(mean) > 0 .and. .not. inverse_mass > 0) > 0
  end function has_driven

  !> Work of all forces but gravity over a step [J].
  pure real(wp) function imposed_work(scene, h, mean) result(work)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: h, mean(:, :)
    integer :: i

    work = 0
    associate (bodies => scene%bodies, g => scene%gravity)
      do i = 1, bodies%n_own
        if (scene%dimension == 2 .and. size(mean, 1) == 3) then
          work = work + h*(bodies%force(1, i)*mean(1, i) + bodies%force(2, i)*mean(2, i) + bodies%force(3, i)*mean(3, i) &
                           - bodies%mass(i)*(g(1)*mean(1, i) + g(2)*mean(2, i)))
        else
          work = work + h*(dot_product(bodies%force(:, i), mean(:, i)) &
                           - bodies%mass(i)*dot_product(g(:scene%dimension), mean(:scene%dimension, i)))
        end if
      end do
    end associate
  end function imposed_work

  !> What driven components gain beyond the work of forces [J]; `driven` is their mean velocity, zero elsewhere.
  pure real(wp) function held_work(bodies, h, driven) result(work)
    type(bodies_t), intent(in) :: bodies
    real(wp), intent(in) :: h, driven(:, :)
    integer :: i

    work = 0
    do i = 1, bodies%n_own
      call add_held_work(bodies, i, h, driven(:, i), work)
    end do
  end function held_work

  !> Add what driven components of a body gain beyond the work of forces [J]; that of its contacts is to be taken away.
  pure subroutine add_held_work(bodies, body, h, driven, work)
    type(bodies_t), intent(in) :: bodies !! bodies with velocities of both ends of the step
    integer, intent(in) :: body !! one of this rank's own
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: driven(:) !! its mean velocity where it is driven, zero in other components
    real(wp), intent(inout) :: work !! sum to add to
    integer :: c

    do c = 1, bodies%n_velocity
      work = work + driven(c)*(inertia_of(bodies, c, body)*(bodies%free_velocity(c, body) - bodies%velocity(c, body)) &
                               - h*bodies%force(c, body))
    end do
    if (bodies%n_velocity < 6) return
    if (any(abs(driven(4:6)) > 0)) work = work - dot_product(driven(4:6), gyroscopic_impulse(bodies, body, h))
  end subroutine add_held_work

  !> What turning does to the spin of a body in space over a step, about its principal axes [N m s]: (R(-h w) - 1) J w0.
  pure function gyroscopic_impulse(bodies, body, h) result(impulse)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: body
    real(wp), intent(in) :: h
    real(wp) :: impulse(3), turn(4), momentum(3)

    turn = turned_on(no_rotation, h/2*(bodies%velocity(4:6, body) + bodies%free_velocity(4:6, body)))
    momentum = bodies%principal(:, body)*bodies%velocity(4:6, body)
    impulse = turned_back(turn, momentum) - momentum
  end function gyroscopic_impulse

  !> Mass, or moment of inertia for components beyond the dimension of space.
  pure real(wp) function inertia_of(bodies, component, body)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: component, body

    if (component <= bodies%dimension) then
      inertia_of = bodies%mass(body)
    else if (bodies%dimension == 2) then
      inertia_of = bodies%inertia(body)
    else
      inertia_of = bodies%principal(component - 3, body)
    end if
  end function inertia_of

  !> Kinetic energy of this rank's bodies [J].
  pure real(wp) function kinetic_energy(bodies) result(kinetic)
    type(bodies_t), intent(in) :: bodies !! bodies with their velocities

    kinetic = kinetic_energy_at(bodies, bodies%velocity)
  end function kinetic_energy

  !> Kinetic energy of this rank's bodies at other velocities [J].
  pure real(wp) function kinetic_energy_at(bodies, velocity) result(kinetic)
    type(bodies_t), intent(in) :: bodies !! the bodies
    real(wp), intent(in), contiguous :: velocity(:, :) !! of each body, components as in `bodies_t`
    integer :: i, c

    kinetic = 0
    do i = 1, bodies%n_own
      do c = 1, bodies%n_velocity
        kinetic = kinetic + inertia_of(bodies, c, i)*velocity(c, i)**2/2
      end do
    end do
  end function kinetic_energy_at

  !> Kinetic energy of one body [J].
  pure real(wp) function kinetic_energy_of(bodies, body) result(kinetic)
    type(bodies_t), intent(in) :: bodies
    integer, intent(in) :: body
    integer :: c

    kinetic = 0
    do c = 1, bodies%n_velocity
      kinetic = kinetic + inertia_of(bodies, c, body)*bodies%velocity(c, body)**2/2
    end do
  end function kinetic_energy_of

  !> Potential energy of this rank's bodies [J], zero at the origin; positions are unwrapped.
  pure real(wp) function potential_energy(scene, gravity) result(potential)
    type(scene_t), intent(in) :: scene !! scene with its positions
    real(wp), intent(in), optional :: gravity(3) !! gravity [m/s2], that of the scene unless given
    real(wp) :: g(3)
    integer :: i

    g = scene%gravity
    if (present(gravity)) g = gravity
    potential = 0
    do i = 1, scene%bodies%n_own
      if (is_absent(scene%bodies, i)) cycle
      potential = potential - potential_drop(scene, i, g)
    end do
  end function potential_energy

  !> Work of gravity on a body brought from the origin to where it is [J].
  pure real(wp) function potential_drop(scene, body, gravity) result(work)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body
    real(wp), intent(in) :: gravity(3)

    work = scene%bodies%mass(body)*dot_product(gravity, unwrapped(scene, scene%bodies, body))
  end function potential_drop

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

  !> Terms of the balance, of this rank [J]: kinetic and potential energy, sum of the absolute potential energies of
  !! the bodies, both energies at the start, and works of forces and pushes, of drives, of friction, of impacts and of bonds.
  pure function energy_sums(energy, scene, contacts) result(sums)
    type(energy_t), intent(in) :: energy
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp) :: sums(n_energy_sums), elastic(2), drop
    integer :: i

    elastic = energy_of_links(scene, contacts)
    sums(1:3) = [kinetic_energy(scene%bodies), 0.0_wp, 0.0_wp]
    do i = 1, scene%bodies%n_own
      if (is_absent(scene%bodies, i)) cycle
      drop = potential_drop(scene, i, merge(energy%gravity, scene%gravity, energy%gravity(1) < huge(1.0_wp)))
      sums(2) = sums(2) - drop
      sums(3) = sums(3) + abs(drop)
    end do
    sums(2) = sums(2) + sum(elastic)
    sums(4:) = [energy%kinetic_start, energy%potential_start, energy%external_work + energy%recovery_work, energy%drive_work, &
                energy%friction_loss - elastic(2), energy%impact_loss - elastic(1), energy%bond_work]
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
               friction_loss => sums(8), impact_loss => sums(9), bond_work => sums(10))
      gain = sums(2) - sums(5)
      scale = max(sums(3)*sqrt(epsilon(scale)), kinetic, abs(kinetic_start), abs(gain), abs(external_work), abs(drive_work), &
                  abs(friction_loss), abs(impact_loss), abs(bond_work))
      if (.not. scale > 0) return
      closure = abs(kinetic - kinetic_start + gain - external_work - drive_work + friction_loss + impact_loss &
                    + bond_work)/scale
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

    if (comm%rank > 0) call self%unpack([merge(1.0_wp, 0.0_wp, self%is_started), spread(0.0_wp, 1, n_energy_values - 1)])
  end subroutine energy_leave_to_first

  !> The sums as a list of reals, for restart files.
  pure function energy_pack(self) result(values)
    class(energy_t), intent(in) :: self
    real(wp) :: values(n_energy_values)

    values = [merge(1.0_wp, 0.0_wp, self%is_started), self%kinetic_start, self%potential_start, self%external_work, &
              self%drive_work, self%friction_loss, self%impact_loss, self%bond_work, self%recovery_work]
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
  end subroutine energy_unpack
end module sg_energy
