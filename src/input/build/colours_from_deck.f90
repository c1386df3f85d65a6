!> Colours that blocks of a deck name.
module sg_colours_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_scene, only: scene_t
  use sg_text, only: nearest_word
  implicit none
  private
  public :: find_colour

contains

  !> Colour of a name; 0 for any.
  subroutine find_colour(deck, b, key, name, scene, colour, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block with the name
    character(len=*), intent(in) :: key !! key of the name
    character(len=*), intent(in) :: name !! a colour, or any
    type(scene_t), intent(in) :: scene !! scene with its colours
    integer, intent(out) :: colour !! index into the colours of the scene
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=:), allocatable :: near

    colour = 0
    if (name == 'any' .or. .not. allocated(scene%colours)) return
    do colour = 1, size(scene%colours)
      if (scene%colours(colour)%s == name) return
    end do
    colour = 0
    near = nearest_word(name, scene%colours)
    if (near /= '') near = '; did you mean "'//near//'"?'
    call deck%complain(diagnostics, 'no body has the colour "'//name//'"'//near, b, key)
  end subroutine find_colour
end module sg_colours_from_deck
