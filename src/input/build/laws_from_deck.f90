!> Materials and contact laws from the blocks of a deck.
module sg_laws_from_deck
  use sg_blocks, only: deck_t
  use sg_cohesive_zones, only: zone_fault
  use sg_error, only: diagnostics_t
  use sg_keys_scene, only: law_kinds
  use sg_kinds, only: wp
  use sg_laws, only: is_cohesive_zone, is_link_law, law_abp, law_bond, law_elastic, law_elastic_g0, law_expo, &
                     law_gap_shifted, law_linear, law_mac, law_mohr, law_restitution, law_rod, law_t, law_th, &
                     law_viscoelastic, law_wet, law_wire, &
                     needs_surface
  use sg_scene, only: law_index, material_index, material_t, scene_t
  use sg_text, only: text_t
  use sg_words, only: choice_index, choices_of
  implicit none
  private
  public :: materials_from_deck, laws_from_deck, material_of, law_of

contains

  !> Fill the scene's materials.
  subroutine materials_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(inout) :: scene !! scene to fill
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(material_t) :: material
    integer :: b

    allocate (scene%materials(0))
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'material')) cycle
      material%name = deck%word(b, 'name')
      material%density = deck%number(b, 'density')
      if (material_index(scene, material%name) > 0) &
        call deck%complain(diagnostics, 'there are two materials named "'//material%name//'"', b, 'name')
      scene%materials = [scene%materials, material]
    end do
  end subroutine materials_from_deck

  !> Fill the scene's laws.
  subroutine laws_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(inout) :: scene !! scene to fill
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(law_t) :: law
    integer :: b

    allocate (scene%laws(0))
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'law')) cycle
      call read_law(deck, b, law)
      if (is_cohesive_zone(law)) then
        if (len(zone_fault(law)) > 0) call deck%complain(diagnostics, zone_fault(law), b, 'normal_stiffness')
      else if (max(law%normal_cohesion, law%tangential_cohesion) > 0 .and. needs_surface(law)) then
        call deck%complain(diagnostics, 'the cohesion is given both as a force and as a stress', b, 'normal_bond_stress')
      else if (law%tangential_cohesion > 0 .and. .not. law%normal_cohesion > 0) then
        call deck%complain(diagnostics, 'a tangential cohesion needs a normal_cohesion', b, 'tangential_cohesion')
      else if (law%kind == law_mohr .and. law%tangential_strength > 0 .and. .not. law%normal_strength > 0) then
        call deck%complain(diagnostics, 'a tangential bond stress needs a normal_bond_stress', b, 'tangential_bond_stress')
      end if
      if (law_index(scene, law%name) > 0) &
        call deck%complain(diagnostics, 'there are two laws named "'//law%name//'"', b, 'name')
      scene%laws = [scene%laws, law]
    end do
  end subroutine laws_from_deck

  !> One law.
  subroutine read_law(deck, b, law)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(law_t), intent(out) :: law

    law%name = deck%word(b, 'name')
    law%kind = choice_index(deck%word(b, 'kind'), choices_of(law_kinds))
    if (is_link_law(law)) then
      call read_link_law(deck, b, law)
      return
    else if (law%kind /= law_linear) then
      law%static_friction = deck%number(b, 'friction')
      law%dynamic_friction = law%static_friction
      if (deck%is_given(b, 'static_friction')) law%static_friction = deck%number(b, 'static_friction')
      if (deck%is_given(b, 'dynamic_friction')) law%dynamic_friction = deck%number(b, 'dynamic_friction')
    end if
    select case (law%kind)
    case (law_restitution)
      law%normal_restitution = deck%number(b, 'normal_restitution')
      law%tangential_restitution = deck%number(b, 'tangential_restitution')
    case (law_wet)
      law%wet_thickness = deck%number(b, 'wet_thickness')
    case (law_gap_shifted)
      law%gap_shift = deck%number(b, 'gap_shift')
    case (law_elastic, law_elastic_g0, law_viscoelastic)
      law%stiffness = deck%number(b, 'stiffness')
      if (law%kind == law_viscoelastic) law%viscosity = deck%number(b, 'viscosity')
    case (law_linear)
      law%epsilon = deck%number(b, 'epsilon')
    end select
    if (law%kind == law_wet .or. law%kind == law_mohr) then
      law%normal_cohesion = deck%number(b, 'normal_cohesion')
    end if
    if (law%kind == law_mohr) then
      if (deck%is_given(b, 'tangential_cohesion')) law%tangential_cohesion = deck%number(b, 'tangential_cohesion')
      if (deck%is_given(b, 'normal_bond_stress')) law%normal_strength = deck%number(b, 'normal_bond_stress')
      if (deck%is_given(b, 'tangential_bond_stress')) law%tangential_strength = deck%number(b, 'tangential_bond_stress')
    end if
    if (is_cohesive_zone(law)) call read_zone(deck, b, law)
  end subroutine read_law

  !> What a cohesive zone has.
  subroutine read_zone(deck, b, law)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(law_t), intent(inout) :: law

    law%zone_stiffness = pair_of('stiffness')
    if (law%kind == law_mac) then
      law%zone_energy(1) = deck%number(b, 'adhesion_energy')
      law%zone_viscosity = deck%number(b, 'damage_viscosity')
      return
    end if
    law%normal_strength = deck%number(b, 'normal_strength')
    law%tangential_strength = deck%number(b, 'tangential_strength')
    law%zone_energy = pair_of('energy')
    if (law%kind == law_th) law%zone_plateau = pair_of('plateau')
    if (law%kind == law_abp) law%zone_opening = pair_of('opening')
    if (law%kind == law_abp) law%zone_share = deck%number(b, 'knee_share')
    if (law%kind == law_expo) law%zone_residual = deck%number(b, 'cut_off')
  contains
    !> Numbers of the normal and of tangents.
    function pair_of(what) result(pair)
      character(len=*), intent(in) :: what
      real(wp) :: pair(2)

      pair = [deck%number(b, 'normal_'//what), deck%number(b, 'tangential_'//what)]
    end function pair_of
  end subroutine read_zone

  !> What a law of rods, wires or bonds has.
  subroutine read_link_law(deck, b, law)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(law_t), intent(inout) :: law

    select case (law%kind)
    case (law_rod, law_wire)
      law%axial_stiffness = deck%number(b, 'axial_stiffness')
      law%axial_damping = deck%number(b, 'axial_damping')
      law%prestrain = deck%number(b, 'prestrain')
      if (law%kind == law_wire) law%breaking_force = deck%number(b, 'breaking_force')
    case (law_bond)
      law%young = deck%number(b, 'young')
      law%poisson = deck%number(b, 'poisson')
      law%normal_strength = deck%number(b, 'normal_strength')
      law%tangential_strength = deck%number(b, 'tangential_strength')
    end select
  end subroutine read_link_law

  !> Material of a block: the one it names, or the only one; 0 after a mistake.
  integer function material_of(deck, b, scene, diagnostics) result(material)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the bodies
    type(scene_t), intent(in) :: scene !! scene with its materials
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(text_t), allocatable :: names(:)
    integer :: i

    allocate (names(size(scene%materials)))
    do i = 1, size(names)
      names(i)%s = scene%materials(i)%name
    end do
    material = named_or_only(deck, b, 'material', names, diagnostics)
  end function material_of

  !> Law of a block: the one it names, or the only one; 0 after a mistake.
  integer function law_of(deck, b, scene, diagnostics) result(law)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the interaction
    type(scene_t), intent(in) :: scene !! scene with its laws
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(text_t), allocatable :: names(:)
    integer :: i

    allocate (names(size(scene%laws)))
    do i = 1, size(names)
      names(i)%s = scene%laws(i)%name
    end do
    law = named_or_only(deck, b, 'law', names, diagnostics)
  end function law_of

  !> Which of the things that bear names a block means by the key that is called like them.
  integer function named_or_only(deck, b, what, names, diagnostics) result(found)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    character(len=*), intent(in) :: what
    type(text_t), intent(in) :: names(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: name

    name = deck%word(b, what)
    do found = 1, size(names)
      if (names(found)%s == name) return
    end do
    found = 0
    if (name == '' .and. size(names) == 1) then
      found = 1
    else if (size(names) == 0) then
      call deck%complain(diagnostics, 'the deck has no [['//what//']]', b, what)
    else if (name == '') then
      call deck%complain(diagnostics, 'there are several '//what//'s: this block needs the key "'//what//'"', b)
    else
      call deck%complain_unknown(diagnostics, what, name, names, b, what)
    end if
  end function named_or_only
end module sg_laws_from_deck
