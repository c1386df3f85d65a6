!> Moments against rolling and twisting that a deck adds to the laws of a DATBOX, which has no place for them (doc/theory/laws.md,
!! "Rolling and twisting"). A block with another name is a law of the deck, if it gives its kind.
module sg_rolling_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_law_parameters, only: set_parameter
  use sg_laws, only: is_cohesive_zone, is_link_law, law_linear
  use sg_rolling_checks, only: rolling_keys
  use sg_scene, only: law_index, scene_t
  use sg_sense_checks, only: is_default
  use sg_text, only: nearest_word, text_t
  implicit none
  private
  public :: rolling_from_deck

contains

  !> Give the laws of a scene the moments of the blocks law that name them.
  subroutine rolling_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(inout) :: scene !! scene with the laws of a DATBOX
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(text_t), allocatable :: names(:)
    integer :: b, law, i

    allocate (names(size(scene%laws)))
    do i = 1, size(names)
      names(i)%s = scene%laws(i)%name
    end do
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'law')) cycle
      law = law_index(scene, deck%word(b, 'name'))
      if (law == 0) then
        if (deck%is_given(b, 'kind')) cycle
        call complain_of_none(deck, b, names, diagnostics)
      else if (scene%laws(law)%kind == law_linear .or. is_link_law(scene%laws(law)) .or. is_cohesive_zone(scene%laws(law))) then
        call deck%complain(diagnostics, 'the law "'//scene%laws(law)%name//'" bears no moments against rolling or twisting', &
                           b, 'name')
      else
        call add_moments(deck, b, scene, law, diagnostics)
      end if
    end do
  end subroutine rolling_from_deck

  !> Report a law that the folder does not have.
  subroutine complain_of_none(deck, b, names, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(text_t), intent(in) :: names(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: near

    near = nearest_word(deck%word(b, 'name'), names)
    if (near /= '') near = '; did you mean "'//near//'"?'
    call deck%complain(diagnostics, 'the DATBOX has no law named "'//deck%word(b, 'name')//'", and a law of the deck needs the '// &
                       'key "kind" next to it'//near, b, 'name')
  end subroutine complain_of_none

  !> Take the keys of a block for one law. What else a law has is that of the folder; effective decks hold its defaults.
  subroutine add_moments(deck, b, scene, law, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, law
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: i

    do i = 1, deck%blocks(b)%n
      associate (value => deck%blocks(b)%values(i), key => deck%table%keys(deck%blocks(b)%values(i)%key))
        if (key%name == 'name') cycle
        if (any(rolling_keys == key%name)) then
          call set_parameter(scene%laws(law), trim(key%name), value%numbers(1))
        else if (.not. is_default(deck, value)) then
          call deck%complain(diagnostics, 'laws of a DATBOX are given there: next to scene.datbox a [[law]] of their name adds '// &
                             'moments against rolling or twisting alone', b, trim(key%name))
        end if
      end associate
    end do
  end subroutine add_moments
end module sg_rolling_from_deck
