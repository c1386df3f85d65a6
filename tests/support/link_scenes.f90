!> Small scenes of links for tests: point masses, blocks with points, and links between them, in the plane and in space.
module link_scenes
  use scenes, only: hold
  use sg_contactors, only: add_point
  use sg_kinds, only: wp
  use sg_laws, only: law_t
  use sg_link_contacts, only: tension
  use sg_links, only: add_link, locate_links
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  implicit none
  private
  public :: begin_links, put_mass, link, tension_of

contains

  !> A scene of `n` bodies without shapes and one law, of links; no gravity.
  subroutine begin_links(scene, n, dimension, law)
    type(scene_t), intent(out) :: scene !! the scene
    integer, intent(in) :: n !! bodies
    integer, intent(in) :: dimension !! of space
    type(law_t), intent(in) :: law !! of the links

    scene%dimension = dimension
    scene%contactors%dimension = dimension
    call scene%bodies%allocate(n, dimension)
    allocate (scene%laws(1), scene%sees(0), scene%drives(0), scene%pressures(0), scene%colours(1))
    scene%colours(1)%s = 'point'
    scene%laws(1) = law
    scene%laws(1)%name = 'link'
  end subroutine begin_links

  !> Make a body a mass with one point at its centre; one without mass is held. The contactor has the number of the body.
  subroutine put_mass(scene, body, mass, place)
    type(scene_t), intent(inout) :: scene !! scene that holds the body
    integer, intent(in) :: body !! the next body
    real(wp), intent(in) :: mass !! [kg]
    real(wp), intent(in) :: place(:) !! [m], shape (dimension)
    real(wp), parameter :: centre(3) = 0

    call add_point(scene%contactors, body, 1, centre(:scene%dimension))
    scene%bodies%position(:, body) = place
    scene%bodies%mass(body) = max(mass, tiny(1.0_wp))
    if (mass > 0) then
      scene%bodies%inverse_mass(:scene%dimension, body) = 1/mass
    else
      call hold(scene, body)
    end if
  end subroutine put_mass

  !> Link two contactors.
  subroutine link(scene, first, second, length, bond)
    type(scene_t), intent(inout) :: scene !! scene with both
    integer, intent(in) :: first !! one contactor
    integer, intent(in) :: second !! the other
    real(wp), intent(in) :: length !! at rest [m]
    real(wp), intent(in), optional :: bond(2) !! cross section [m2] and mass [kg] of a bond
    integer, parameter :: none(2) = 0
    real(wp) :: section(2)

    section = 0
    if (present(bond)) section = bond
    call add_link(scene%links, [first, second], none, 1, length, section(1), section(2))
    call locate_links(scene%links, scene%contactors)
  end subroutine link

  !> Tension of a link in the last step [N].
  pure real(wp) function tension_of(sim, l)
    type(simulation_t), intent(in) :: sim !! simulation after a step
    integer, intent(in) :: l !! the link
    integer :: k

    k = findloc(sim%contacts%feature(:sim%contacts%n), l, 1)
    tension_of = tension(sim%scene, sim%contacts, k)/sim%options%time_step
  end function tension_of
end module link_scenes
