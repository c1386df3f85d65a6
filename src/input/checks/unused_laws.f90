!> Warnings about interactions of a deck that hold between no shapes of its scene, about laws that no interaction
!! names, and about shapes that touch nothing: one line per kind.
module sg_unused_laws
  use sg_blocks, only: deck_t
  use sg_contactors, only: kind_names
  use sg_error, only: diagnostics_t
  use sg_scene, only: law_index, scene_t
  use sg_sees_used, only: find_uses, fits_nothing, see_uses_t
  use sg_text, only: to_text
  implicit none
  private
  public :: laws_of_links, warn_of_unused_laws

contains

  !> Warn of interactions that fit nothing or that earlier ones hide, of laws that none names, of shapes that touch nothing.
  subroutine warn_of_unused_laws(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(in) :: scene !! scene with bodies, laws and see tables, the last ones one line for each [[interaction]]
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings found
    type(see_uses_t) :: uses
    integer, allocatable :: interactions(:), laws(:)
    integer :: i, first

    interactions = blocks_of(deck, 'interaction')
    if (scene%bodies%n + deck%absent%n < 2) return
    if (size(interactions) == 0 .and. deck%folder_bodies == 0) return
    call find_uses(scene, deck%absent%looks, uses)
    first = size(scene%sees) - size(interactions)
    do i = 1, size(interactions)
      associate (use => uses%line(first + i))
        if (use == fits_nothing) then
          call deck%warn(diagnostics, 'this interaction fits no two shapes of the scene', interactions(i), kind='fits nothing')
        else if (use > first) then
          call deck%warn(diagnostics, 'an earlier interaction, of line '//to_text(deck%blocks(interactions(use - first))%line)// &
                         ', takes all shapes that fit this one: put the special before the general', interactions(i), kind='hidden')
        else if (use > 0) then
          call deck%warn(diagnostics, 'see tables of the DATBOX, which come first, take all shapes that fit this interaction', &
                         interactions(i), kind='hidden')
        end if
      end associate
    end do
    laws = blocks_of(deck, 'law')
    do i = 1, size(laws)
      if (deck%folder_bodies > 0 .and. .not. deck%is_given(laws(i), 'kind')) cycle
      if (any(scene%sees%law == law_index(scene, deck%word(laws(i), 'name'))) .or. has_link(deck, deck%word(laws(i), 'name'))) cycle
      call deck%warn(diagnostics, 'no interaction, no link and no bond names this law: it is not used', laws(i), kind='unused law')
    end do
    ! Next to a DATBOX shapes that touch nothing are reported for its see tables.
    if (deck%folder_bodies > 0) return
    do i = 1, size(uses%alone, 2)
      call deck%warn(diagnostics, 'no interaction fits this shape, which touches nothing: '//trim(kind_names(uses%alone(1, i)))// &
                     ' of colour "'//scene%colours(uses%alone(2, i))%s//'"', interactions(1), kind='touches nothing')
    end do
  end subroutine warn_of_unused_laws

  !> Which laws of a scene do links and bonds of the deck name, shape (laws)
  function laws_of_links(deck, scene) result(named)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(in) :: scene !! scene with its laws
    logical :: named(size(scene%laws))
    integer :: i

    named = [(has_link(deck, scene%laws(i)%name), i=1, size(scene%laws))]
  end function laws_of_links

  !> Does a link or a bond of the deck name a law? They are made after interactions are checked.
  logical function has_link(deck, law)
    type(deck_t), intent(in) :: deck
    character(len=*), intent(in) :: law
    integer, allocatable :: links(:)
    integer :: i

    links = [blocks_of(deck, 'link'), blocks_of(deck, 'chain'), blocks_of(deck, 'bond')]
    has_link = .false.
    do i = 1, size(links)
      has_link = has_link .or. deck%word(links(i), 'law') == law
    end do
  end function has_link

  !> Blocks of a section, in the order of the deck.
  pure function blocks_of(deck, section) result(blocks)
    type(deck_t), intent(in) :: deck
    character(len=*), intent(in) :: section
    integer, allocatable :: blocks(:)
    integer :: b

    blocks = pack([(b, b=1, deck%n)], [(deck%is_in(b, section), b=1, deck%n)])
  end function blocks_of
end module sg_unused_laws
