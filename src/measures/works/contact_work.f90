!> Work of contact impulses and of bonds over a step (doc/theory/indicators.md, "Energy").
module sg_contact_work
  use sg_bodies, only: bodies_t
  use sg_bonds, only: bond_impulse
  use sg_cell_motion, only: cell_bias, cell_jump
  use sg_contacts, only: contacts_t, has_bonds, impulse_vector, moment_vector, normal_impulse
  use sg_kinds, only: wp
  use sg_laws, only: is_cohesive_zone
  use sg_mapping, only: relative_velocity
  use sg_mapping_space, only: space_arms
  use sg_rotations, only: turned_by
  use sg_scene, only: scene_t
  implicit none
  private
  public :: contact_work

contains

  !> Work of the contact impulses along normals and along tangents, of bonds, and of moments [J]: r . H^T v.
  pure function contact_work(scene, contacts, h, velocity) result(work)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in), contiguous :: velocity(:, :) !! of each body, components as in `bodies_t`
    real(wp) :: work(4), u(2), bias(3), jump(3), normal_work, bond(contacts%n_components), of_bond
    real(wp), allocatable :: spin(:, :)
    integer :: k
    logical :: has_zones

    work = 0
    has_zones = has_bonds(contacts)
    if (scene%dimension == 3) spin = spins_in_world(scene%bodies, velocity)
    if (contacts%n_moments > 0) work(4) = work_of_moments(contacts, velocity, spin)
    if (.not. (has_zones .or. scene%cell%is_on)) then
      if (scene%dimension == 2) work(1:2) = work_in_plane(scene, contacts, velocity)
      if (scene%dimension == 3) work(1:2) = work_in_space(scene, contacts, velocity, spin)
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

  !> The same in space: impulses, which are vectors there or along the normal alone, times `jump_at`.
  pure function work_in_space(scene, contacts, velocity, spin) result(work)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in), contiguous :: velocity(:, :), spin(:, :)
    real(wp) :: work(2), x, y, z, half, ux, uy, uz, normal
    integer :: k

    work = 0
    do k = 1, contacts%n
      if (.not. any(abs(contacts%impulse(:, k)) > 0)) cycle
      associate (c => contacts%body(1, k), a => contacts%body(2, k), n => contacts%normal(:, k), point => contacts%point(:, k), &
                 middle => scene%bodies%middle, r => contacts%impulse(:, k))
        ux = velocity(1, c) - velocity(1, a)
        uy = velocity(2, c) - velocity(2, a)
        uz = velocity(3, c) - velocity(3, a)
        if (size(spin, 2) > 0) then
          half = contacts%gap(k)/2
          x = point(1) + half*n(1) - middle(1, c)
          y = point(2) + half*n(2) - middle(2, c)
          z = point(3) + half*n(3) - middle(3, c)
          ux = ux + spin(2, c)*z - spin(3, c)*y
          uy = uy + spin(3, c)*x - spin(1, c)*z
          uz = uz + spin(1, c)*y - spin(2, c)*x
          x = point(1) - half*n(1) - middle(1, a) - scene%period*real(contacts%image(k), wp)
          y = point(2) - half*n(2) - middle(2, a) - scene%period_y*real(contacts%image_y(k), wp)
          z = point(3) - half*n(3) - middle(3, a)
          ux = ux - (spin(2, a)*z - spin(3, a)*y)
          uy = uy - (spin(3, a)*x - spin(1, a)*z)
          uz = uz - (spin(1, a)*y - spin(2, a)*x)
        end if
        normal = r(1)
        if (contacts%n_components == 3) normal = n(1)*r(1) + n(2)*r(2) + n(3)*r(3)
        normal = normal*(n(1)*ux + n(2)*uy + n(3)*uz)
        work(1) = work(1) + normal
        if (contacts%n_components == 3) work(2) = work(2) + (r(1)*ux + r(2)*uy + r(3)*uz - normal)
      end associate
    end do
  end function work_in_space

  !> Work of moments on the relative spins of contacts [J].
  pure real(wp) function work_of_moments(contacts, velocity, spin) result(work)
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in), contiguous :: velocity(:, :)
    real(wp), allocatable, intent(in) :: spin(:, :)
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
end module sg_contact_work
