!> Work of contact impulses and of bonds over a step (doc/theory/indicators.md, "Energy").
module sg_contact_work
  use sg_bodies, only: bodies_t
  use sg_bonds, only: bond_impulse
  use sg_cell_motion, only: cell_bias, cell_jump
  use sg_contacts, only: contacts_t, has_bonds, impulse_vector, moment_vector, normal_impulse
  use sg_gap_laws, only: has_driven_spin
  use sg_kinds, only: wp
  use sg_laws, only: is_cohesive_zone
  use sg_mapping, only: relative_velocity
  use sg_mapping_space, only: space_arms
  use sg_rotations, only: turned_by
  use sg_scene, only: scene_t
  use sg_work_loops, only: work_in_plane, work_in_space, work_of_balls, work_of_disks
  implicit none
  private
  public :: contact_work

contains

  !> Work of the contact impulses along normals and along tangents, of bonds, and of moments [J]: r . H^T v.
  !! Lever arms of round bodies are their radii, unless a spin is driven.
  pure function contact_work(scene, contacts, h, velocity, radius) result(work)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in), contiguous :: velocity(:, :) !! of each body, components as in `bodies_t`
    real(wp), intent(in), contiguous :: radius(:) !! signed radii of round bodies as in `plan_t`, empty for other scenes [m]
    real(wp) :: work(4), u(2), bias(3), jump(3), normal_work, bond(contacts%n_components), of_bond
    real(wp), allocatable :: spin(:, :)
    integer :: k
    logical :: has_zones, is_round

    work = 0
    if (contacts%n == 0) return
    has_zones = has_bonds(contacts)
    is_round = size(radius) > 0 .and. contacts%n_components == scene%dimension
    if (is_round) is_round = .not. has_driven_spin(scene%bodies, velocity)
    spin = spins_in_world(scene%bodies, velocity)
    if (contacts%n_moments > 0) work(4) = work_of_moments(contacts, velocity, spin)
    if (.not. (has_zones .or. scene%cell%is_on)) then
      work(1:2) = work_of_forces(scene, contacts, velocity, spin, is_round, radius)
      return
    end if
    do k = 1, contacts%n
      if (.not. any(abs(contacts%impulse(:, k)) > 0)) cycle
      if (scene%dimension == 3) then
        jump = jump_at(scene, contacts, k, velocity, spin)
        if (scene%cell%is_on) jump = jump + cell_jump(scene, contacts, k, 0.5_wp)
        normal_work = normal_impulse(contacts, k)*dot_product(contacts%normal(:, k), jump)
        work(:2) = work(:2) + [normal_work, dot_product(impulse_vector(contacts, k), jump) - normal_work]
        if (.not. has_zones) cycle
        if (.not. is_cohesive_zone(scene%laws(contacts%law(k)))) cycle
        bond = bond_impulse(scene%laws(contacts%law(k)), contacts, k, h)
        of_bond = dot_product(bond, jump)
        normal_work = dot_product(bond, contacts%normal(:, k))*dot_product(contacts%normal(:, k), jump)
        work(:3) = work(:3) + [-normal_work, normal_work - of_bond, of_bond]
        cycle
      end if
      u = relative_velocity(contacts, k, scene%bodies%middle, scene%period, velocity)
      if (scene%cell%is_on) then
        bias = cell_bias(scene, contacts, k, 0.5_wp)
        u = u + bias(:2)
      end if
      work(:size(bond)) = work(:size(bond)) + contacts%impulse(:, k)*u(:size(bond))
      if (.not. has_zones) cycle
      if (.not. is_cohesive_zone(scene%laws(contacts%law(k)))) cycle
      bond = bond_impulse(scene%laws(contacts%law(k)), contacts, k, h)
      work(:3) = work(:3) + [-bond*u, dot_product(bond, u)]
    end do
  end function contact_work

  !> Work along normals and along tangents, without bonds and a periodic cell.
  pure function work_of_forces(scene, contacts, velocity, spin, is_round, radius) result(work)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in), contiguous :: velocity(:, :), spin(:, :), radius(:)
    logical, intent(in) :: is_round
    real(wp) :: work(2)

    associate (n => contacts%n, m => contacts%n_components, bodies => scene%bodies, v => size(velocity, 1), &
               c => size(scene%bodies%middle, 1))
      if (is_round .and. scene%dimension == 2) then
        work = work_of_disks(n, bodies%n, contacts%body, contacts%normal, contacts%impulse, radius, velocity)
      else if (is_round) then
        work = work_of_balls(n, bodies%n, contacts%body, contacts%normal, contacts%impulse, radius, velocity, spin)
      else if (scene%dimension == 2) then
        work = work_in_plane(n, m, bodies%n, v, c, contacts%body, contacts%image, contacts%normal, contacts%point, contacts%gap, &
                             contacts%impulse, scene%period, bodies%middle, velocity)
      else
        work = work_in_space(n, m, bodies%n, size(spin, 2), v, c, contacts%body, contacts%image, contacts%image_y, &
                             contacts%normal, contacts%point, contacts%gap, contacts%impulse, [scene%period, scene%period_y], &
                             bodies%middle, velocity, spin)
      end if
    end associate
  end function work_of_forces

  !> Work of moments on the relative spins of contacts [J].
  pure real(wp) function work_of_moments(contacts, velocity, spin) result(work)
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in), contiguous :: velocity(:, :), spin(:, :)
    real(wp) :: moment(3)
    integer :: k

    work = 0
    do k = 1, contacts%n
      moment = moment_vector(contacts, k)
      associate (c => contacts%body(1, k), a => contacts%body(2, k))
        if (contacts%n_moments == 1) work = work + moment(3)*(velocity(3, c) - velocity(3, a))
        if (contacts%n_moments == 3) work = work + dot_product(moment, spin(:, c) - spin(:, a))
      end associate
    end do
  end function work_of_moments

  !> Spins of all bodies in the world's axes [rad/s]; a body has many contacts, and is turned once. None where nothing turns.
  pure function spins_in_world(bodies, velocity) result(spin)
    type(bodies_t), intent(in) :: bodies
    real(wp), intent(in), contiguous :: velocity(:, :)
    real(wp), allocatable :: spin(:, :)
    integer :: b

    allocate (spin(3, merge(bodies%n, 0, bodies%dimension == 3 .and. size(velocity, 1) == 6)))
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
end module sg_contact_work
