!> Mass and moments of the bodies of a deck: those of their shapes, or those that it gives.
module sg_weights_from_deck
  use sg_blocks, only: deck_t
  use sg_bodies, only: bodies_t
  use sg_contactors, only: kind_point
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_moments, only: body_moments
  use sg_scene, only: scene_t
  use sg_solid_bodies, only: make_solid_body, set_inertia
  implicit none
  private
  public :: weigh_body, override_mass, invert_mass

contains

  !> Weigh a body of known material by the contactors from one to the last, given in the frame that it has; its frame moves to
  !! the centre, in space also to the principal axes.
  subroutine weigh_body(scene, n, first)
    type(scene_t), intent(inout) :: scene !! scene with its materials
    integer, intent(in) :: n !! number of the body
    integer, intent(in) :: first !! its first contactor
    real(wp) :: density

    density = 0
    if (scene%bodies%material(n) > 0) density = scene%materials(scene%bodies%material(n))%density
    if (scene%dimension == 2) then
      call weigh_in_plane(scene, n, first, density)
    else
      call make_solid_body(scene%bodies, scene%contactors, n, first, scene%contactors%n, density)
    end if
  end subroutine weigh_body

  !> The same in the plane: mass, inertia, area and centre; shifts become relative to the centre.
  subroutine weigh_in_plane(scene, n, first, density)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: n, first
    real(wp), intent(in) :: density
    real(wp) :: area, centre(2), moment, cosine, sine
    integer :: c

    call body_moments(scene%contactors, first, scene%contactors%n, area, centre, moment)
    do c = first, scene%contactors%n
      scene%contactors%shift(:, c) = scene%contactors%shift(:, c) - centre
    end do
    associate (bodies => scene%bodies)
      cosine = cos(bodies%angle(n))
      sine = sin(bodies%angle(n))
      bodies%position(:, n) = bodies%position(:, n) + [cosine*centre(1) - sine*centre(2), sine*centre(1) + cosine*centre(2)]
      bodies%area(n) = area
      bodies%mass(n) = density*area
      bodies%inertia(n) = density*moment
    end associate
    call invert_mass(scene%bodies, n)
  end subroutine weigh_in_plane

  !> Inverse inertia of a free body of the plane; zero where it weighs nothing.
  pure subroutine invert_mass(bodies, n)
    type(bodies_t), intent(inout) :: bodies !! bodies with mass and inertia
    integer, intent(in) :: n !! number of the body

    bodies%inverse_mass(:, n) = 0
    if (bodies%mass(n) > 0) bodies%inverse_mass(1:2, n) = 1/bodies%mass(n)
    if (bodies%inertia(n) > 0) bodies%inverse_mass(3, n) = 1/bodies%inertia(n)
  end subroutine invert_mass

  !> Take the mass and the moments that the deck gives; moments follow a mass that is given alone.
  subroutine override_mass(deck, b, scene, n, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the body
    type(scene_t), intent(inout) :: scene !! scene with the body weighed
    integer, intent(in) :: n !! number of the body
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    real(wp) :: least

    if (scene%dimension == 2) then
      call override_in_plane(deck, b, scene%bodies, n)
      least = scene%bodies%inertia(n)
    else
      call override_in_space(deck, b, scene%bodies, n, diagnostics)
      least = minval(scene%bodies%principal(:, n))
    end if
    if (is_point_mass(scene, n)) least = scene%bodies%mass(n)
    if (.not. min(scene%bodies%mass(n), least) > 0 .and. .not. deck%flag(b, 'fixed') .and. scene%bodies%material(n) > 0) &
      call deck%complain(diagnostics, 'this body weighs nothing: it needs "mass" and "inertia", or fixed = true', b)
  end subroutine override_mass

  !> Has a body nothing but points at its centre, about which it need not turn?
  pure logical function is_point_mass(scene, n)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: n
    integer :: c

    is_point_mass = .true.
    do c = scene%contactors%n, 1, -1
      if (scene%contactors%body(c) /= n) return
      is_point_mass = scene%contactors%kind(c) == kind_point .and. .not. any(abs(scene%contactors%shift(:, c)) > 0)
      if (.not. is_point_mass) return
    end do
  end function is_point_mass

  !> The same in the plane, for mass and inertia.
  subroutine override_in_plane(deck, b, bodies, n)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, n
    type(bodies_t), intent(inout) :: bodies

    if (deck%is_given(b, 'mass')) then
      if (bodies%mass(n) > 0) bodies%inertia(n) = bodies%inertia(n)*deck%number(b, 'mass')/bodies%mass(n)
      bodies%mass(n) = deck%number(b, 'mass')
    end if
    if (deck%is_given(b, 'inertia')) bodies%inertia(n) = deck%number(b, 'inertia')
    call invert_mass(bodies, n)
  end subroutine override_in_plane

  !> The same in space, for mass and principal moments.
  subroutine override_in_space(deck, b, bodies, n, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, n
    type(bodies_t), intent(inout) :: bodies
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: mass, principal(3)

    mass = bodies%mass(n)
    principal = bodies%principal(:, n)
    if (deck%is_given(b, 'mass')) then
      if (mass > 0) principal = principal*(deck%number(b, 'mass')/mass)
      mass = deck%number(b, 'mass')
    end if
    if (deck%is_given(b, 'inertia')) then
      principal = deck%vector(b, 'inertia')
      if (2*maxval(principal) > sum(principal)*(1 + 1e-9_wp)) &
        call deck%complain(diagnostics, 'no body has such moments: none is larger than the sum of the other two', b, 'inertia')
    end if
    call set_inertia(bodies, n, mass, principal)
  end subroutine override_in_space
end module sg_weights_from_deck
