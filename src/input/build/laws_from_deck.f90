!> Materials and contact laws from the blocks of a deck.
module sg_laws_from_deck
  use sg_blocks, only: deck_t
  use sg_cohesive_zones, only: zone_fault
  use sg_error, only: diagnostics_t
  use sg_keys_scene, only: law_kinds
  use sg_law_parameters, only: set_parameter
  use sg_laws, only: is_cohesive_zone, law_linear, law_mohr, law_t, needs_surface
  use sg_scene, only: law_index, material_index, material_t, scene_t
  use sg_text, only: text_t
  use sg_values, only: value_t
  use sg_words, only: choice_index, choices_of
  implicit none
  private
  public :: materials_from_deck, laws_from_deck, material_of, law_of

contains

  !> Add materials to those that the scene has from a DATBOX.
  subroutine materials_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(inout) :: scene !! scene to fill
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(material_t) :: material
    integer :: b, n_folder, other

    if (.not. allocated(scene%materials)) allocate (scene%materials(0))
    n_folder = size(scene%materials)
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'material')) cycle
      material%name = deck%word(b, 'name')
      material%density = deck%number(b, 'density')
      other = material_index(scene, material%name)
      if (other > n_folder) then
        call deck%complain(diagnostics, 'there are two materials named "'//material%name//'"', b, 'name')
      else if (other > 0) then
        call deck%complain(diagnostics, 'the DATBOX has a material named "'//material%name//'": bodies of the deck may call it '// &
                           'by this name, and one of the deck needs another name', b, 'name')
      end if
      scene%materials = [scene%materials, material]
    end do
  end subroutine materials_from_deck

  !> Add laws to those that the scene has from a DATBOX. Blocks that name one of these are not for here.
  subroutine laws_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(inout) :: scene !! scene to fill
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(law_t) :: law
    integer :: b, n_folder, other

    if (.not. allocated(scene%laws)) allocate (scene%laws(0))
    n_folder = size(scene%laws)
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'law')) cycle
      call read_law(deck, b, law)
      if (any([(scene%laws(other)%name == law%name, other=1, n_folder)])) cycle
      if (is_cohesive_zone(law)) then
        if (len(zone_fault(law)) > 0) call deck%complain(diagnostics, zone_fault(law), b, 'normal_stiffness')
      else if (law%kind == law_linear .and. deck%is_given(b, 'epsilon') .and. deck%is_given(b, 'relative_epsilon')) then
        call deck%complain(diagnostics, 'the velocity per impulse is given both in 1/kg and as a multiple', b, 'relative_epsilon')
      else if (law%kind == law_linear .and. .not. (deck%is_given(b, 'epsilon') .or. deck%is_given(b, 'relative_epsilon'))) then
        call deck%complain(diagnostics, 'a LINEAR law needs the key "epsilon" or "relative_epsilon"', b)
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
    type(value_t) :: value
    integer :: k

    law%name = deck%word(b, 'name')
    law%kind = choice_index(deck%word(b, 'kind'), choices_of(law_kinds))
    associate (section => deck%table%sections(deck%blocks(b)%section))
      do k = section%first, section%last
        associate (key => deck%table%keys(k))
          if (.not. deck%applies(b, key)) cycle
          value = deck%value(b, trim(key%name))
          if (value%n > 0) call set_parameter(law, trim(key%name), value%numbers(1))
        end associate
      end do
    end associate
    law%is_along_normal = deck%word(b, 'directions') == 'normal'
  end subroutine read_law

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
