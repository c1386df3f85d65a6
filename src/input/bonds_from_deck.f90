!> Bonds between bodies that touch at the start, from the blocks bond: between named bodies, or between all shapes of a colour
!! (doc/guide/decks.md, "Bonds").
!!
!! A bond is a line of the see tables whose law holds contacts together. Lines of a colour come before all interactions, lines of
!! named bodies take the place of whatever these give to a pair.
module sg_bonds_from_deck
  use sg_blocks, only: deck_t
  use sg_called_bodies, only: add_called
  use sg_colours_from_deck, only: find_colour
  use sg_error, only: diagnostics_t
  use sg_interactions_from_deck, only: default_alert, read_law
  use sg_kinds, only: wp, i4
  use sg_laws, only: is_cohesive_zone, law_mohr
  use sg_run_options, only: run_options_t
  use sg_scene, only: body_group_t, scene_t, see_t
  use sg_values, only: value_t
  implicit none
  private
  public :: bonds_from_deck

contains

  !> Add the bonds of all blocks to the see tables of a scene.
  subroutine bonds_from_deck(deck, options, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck with its names
    type(run_options_t), intent(in) :: options !! options of the run
    type(scene_t), intent(inout) :: scene !! scene with bodies, laws and see tables
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(see_t), allocatable :: of_colours(:), of_bodies(:)
    type(see_t) :: see
    real(wp) :: alert(2)
    integer :: b, n_groups

    if (deck%count_of('bond') == 0) return
    n_groups = count([(deck%is_in(b, 'bond') .and. deck%is_given(b, 'bodies'), b=1, deck%n)])
    if (n_groups > 0) allocate (scene%groups(n_groups))
    allocate (of_colours(0), of_bodies(0))
    alert = default_alert(scene, options, deck%absent)
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'bond')) cycle
      if (deck%is_given(b, 'bodies') .eqv. deck%is_given(b, 'colour')) then
        call deck%complain(diagnostics, 'a bond holds two bodies, or all shapes of a colour: give "bodies" or "colour"', b)
        cycle
      end if
      call read_bond(deck, b, scene, alert, see, diagnostics)
      if (deck%is_given(b, 'colour')) then
        call find_colour(deck, b, 'colour', deck%word(b, 'colour'), scene, see%candidate_colour, diagnostics)
        see%antagonist_colour = see%candidate_colour
        of_colours = [of_colours, see]
      else
        see%group = size(of_bodies) + 1
        call name_bodies(deck, b, scene, scene%groups(see%group), diagnostics)
        of_bodies = [of_bodies, see]
      end if
    end do
    scene%sees = [of_colours, scene%sees, of_bodies]
  end subroutine bonds_from_deck

  !> Law and alert distance of a bond, whose law must hold something together.
  subroutine read_bond(deck, b, scene, alert, see, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: alert(2)
    type(see_t), intent(out) :: see
    type(diagnostics_t), intent(inout) :: diagnostics

    call read_law(deck, b, scene, alert, see, diagnostics)
    if (see%law == 0) return
    associate (law => scene%laws(see%law))
      if (.not. (is_cohesive_zone(law) .or. law%kind == law_mohr)) &
        call deck%complain(diagnostics, 'the law "'//law%name//'" holds nothing together: a bond takes IQS_MAC_CZM, '// &
                           'IQS_MAL_CZM, IQS_TH_CZM, IQS_ABP_CZM, IQS_EXPO_CZM or IQS_MOHR_DS_CLB', b, 'law')
    end associate
  end subroutine read_bond

  !> Mark the bodies of either side of a bond.
  subroutine name_bodies(deck, b, scene, group, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(in) :: scene
    type(body_group_t), intent(inout) :: group
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: bodies

    bodies = deck%value(b, 'bodies')
    call mark_bodies(deck, b, bodies%words(1)%s, scene%bodies%n + deck%absent%n, group%is_one, diagnostics)
    call mark_bodies(deck, b, bodies%words(2)%s, scene%bodies%n + deck%absent%n, group%is_other, diagnostics)
  end subroutine name_bodies

  !> Mark the bodies that a word calls: by `#` and a number, by a name, or by a pattern of names.
  subroutine mark_bodies(deck, b, word, bodies, marks, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    character(len=*), intent(in) :: word
    integer, intent(in) :: bodies !! of the whole scene
    logical, allocatable, intent(inout) :: marks(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    integer(i4), allocatable :: found(:)

    allocate (found(0))
    call add_called(deck, b, 'bodies', word, bodies, found, diagnostics)
    allocate (marks(maxval([0_i4, found])), source=.false.)
    marks(found) = .true.
  end subroutine mark_bodies
end module sg_bonds_from_deck
