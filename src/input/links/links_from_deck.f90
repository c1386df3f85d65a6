!> Links from the blocks link (two bodies, a point on each, a law) and chain (doc/theory/links.md).
!!
!! The points are contactors of their own, numbered behind all others. Every rank keeps the bodies that a link names while it
!! reads, and so makes the same links.
module sg_links_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_laws, only: is_link_law, law_bond, law_linear
  use sg_laws_from_deck, only: law_of
  use sg_link_ends, only: add_ends, two_bodies
  use sg_link_network, only: nearest_image, place_of_point
  use sg_links, only: add_link
  use sg_local_numbers, only: local_body
  use sg_scene, only: scene_t
  implicit none
  private
  public :: links_from_deck

contains

  !> Add the links of all blocks, and their points.
  subroutine links_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(inout) :: deck !! checked deck; the number of all contactors grows
    type(scene_t), intent(inout) :: scene !! scene with bodies and laws
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: b

    do b = 1, deck%n
      if (deck%is_in(b, 'link')) call read_link(deck, b, scene, diagnostics)
      if (deck%is_in(b, 'chain')) call link_chain(deck, b, scene, diagnostics)
    end do
    if (allocated(scene%contactors%id)) scene%contactors%id = scene%contactors%id(:scene%contactors%n)
  end subroutine links_from_deck

  !> The link of one block.
  subroutine read_link(deck, b, scene, diagnostics)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: place(3, 2), length, area, mass
    integer :: body(2), law, errors
    logical :: are_found

    errors = diagnostics%count()
    law = law_of(deck, b, scene, diagnostics)
    call two_bodies(deck, b, 'a link', scene, body, are_found, diagnostics)
    if (diagnostics%count() > errors) return
    call find_places(deck, b, scene, body, place)
    associate (image => nearest_image(scene, place(:, 1) - place(:, 2)))
      length = norm2(place(:, 1) - place(:, 2) - [scene%period, scene%period_y, 0.0_wp]*real([image, 0], wp))
      if (deck%is_given(b, 'length')) length = deck%number(b, 'length')
      call check_link(deck, b, scene, law, length, diagnostics)
      if (diagnostics%count() > errors) return
      area = 0
      mass = 0
      if (scene%laws(law)%kind == law_bond) then
        area = deck%number(b, 'area')
        mass = deck%number(b, 'mass')
      end if
      call add_ends(deck, scene, body, place)
      call add_link(scene%links, deck%contactors + [-1, 0], image, law, length, area, mass)
    end associate
  end subroutine read_link

  !> The links of a [[chain]], from centre to centre.
  subroutine link_chain(deck, b, scene, diagnostics)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: place(3, 2), length
    integer :: body(2), law, i, errors

    errors = diagnostics%count()
    law = law_of(deck, b, scene, diagnostics)
    if (diagnostics%count() > errors) return
    length = norm2(deck%pair(b, 'to') - deck%pair(b, 'from'))/real(deck%integer(b, 'count') - 1, wp)
    call check_link(deck, b, scene, law, length, diagnostics)
    if (diagnostics%count() == errors .and. scene%laws(law)%kind == law_bond) &
      call deck%complain(diagnostics, 'the links of a chain have no NARD_ROD: take ROD, WIRE, RIGID_WIRE or LINEAR', b, 'law')
    if (diagnostics%count() > errors) return
    place = 0
    do i = deck%blocks(b)%first_body, deck%blocks(b)%last_body - 1
      body = [local_body(scene%bodies, int(i, i4)), local_body(scene%bodies, int(i + 1, i4))]
      place(:2, :) = scene%bodies%position(:, body)
      call add_ends(deck, scene, body, place)
      call add_link(scene%links, deck%contactors + [-1, 0], [0, 0], law, length, 0.0_wp, 0.0_wp)
    end do
  end subroutine link_chain

  !> Where the ends of a link are in the world [m].
  subroutine find_places(deck, b, scene, body, place)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, body(2)
    type(scene_t), intent(in) :: scene
    real(wp), intent(out) :: place(3, 2)
    character(len=12), parameter :: keys(2) = [character(len=12) :: 'first_point', 'second_point']
    real(wp), parameter :: centre(3) = 0
    integer :: side

    do side = 1, 2
      if (deck%is_given(b, trim(keys(side)))) then
        place(:, side) = deck%vector(b, trim(keys(side)))
      else
        place(:, side) = place_of_point(scene, body(side), centre(:scene%dimension))
      end if
    end do
  end subroutine find_places

  !> Does the law hold between points, and is there what it needs?
  subroutine check_link(deck, b, scene, law, length, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, law
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: length
    type(diagnostics_t), intent(inout) :: diagnostics

    if (.not. (is_link_law(scene%laws(law)) .or. scene%laws(law)%kind == law_linear)) then
      call deck%complain(diagnostics, 'the law "'//scene%laws(law)%name//'" holds between shapes that touch: a link needs ROD, '// &
                         'WIRE, RIGID_WIRE, NARD_ROD or LINEAR', b)
    else if (scene%laws(law)%kind /= law_linear .and. .not. length > 0) then
      call deck%complain(diagnostics, 'this link has no length: its points are one, and "length" is not given', b)
    end if
    if (scene%laws(law)%kind /= law_bond) return
    if (.not. (deck%is_given(b, 'area') .and. deck%is_given(b, 'mass'))) &
      call deck%complain(diagnostics, 'a NARD_ROD needs the keys "area" and "mass"', b)
  end subroutine check_link
end module sg_links_from_deck
