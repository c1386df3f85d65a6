!> Kinetic and potential energy of bodies (doc/theory/indicators.md, "Energy").
module sg_body_energy
  use sg_bodies, only: bodies_t, is_absent
  use sg_kinds, only: wp
  use sg_scene, only: scene_t, unwrapped
  implicit none
  private
  public :: inertia_of, kinetic_energy, kinetic_energy_at, kinetic_energy_of, potential_energy, potential_drop

contains

  !> Mass, or moment of inertia for components beyond the dimension of space.
  pure real(wp) function inertia_of(bodies, component, body)
    type(bodies_t), intent(in) :: bodies !! the bodies
    integer, intent(in) :: component !! of the velocity
    integer, intent(in) :: body !! which one

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
    type(bodies_t), intent(in) :: bodies !! bodies with their velocities
    integer, intent(in) :: body !! which one
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
    type(scene_t), intent(in) :: scene !! scene with its positions
    integer, intent(in) :: body !! which one
    real(wp), intent(in) :: gravity(3) !! [m/s2]

    work = scene%bodies%mass(body)*dot_product(gravity, unwrapped(scene, scene%bodies, body))
  end function potential_drop
end module sg_body_energy
