!> Joints from the blocks `[[joint]]`: points of two bodies that stay together (doc/theory/links.md, "Joints").
!!
!! A joint is a link without length under a linear law without compliance; a hinge in space is two of them on its axis.
module sg_joints_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_laws, only: law_linear, law_t
  use sg_link_ends, only: add_ends, two_bodies
  use sg_link_network, only: nearest_image
  use sg_links, only: add_link
  use sg_scene, only: scene_t
  implicit none
  private
  public :: joints_from_deck

contains

  !> Add the joints of all blocks, their points, and the law that holds them, behind those of the deck.
  subroutine joints_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(inout) :: deck !! checked deck; the number of all contactors grows
    type(scene_t), intent(inout) :: scene !! scene with bodies and laws
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(law_t) :: law
    integer :: b

    if (deck%count_of('joint') == 0) return
    law%name = 'joint'
    law%kind = law_linear
    law%is_joint = .true.
    scene%laws = [scene%laws, law]
    do b = 1, deck%n
      if (deck%is_in(b, 'joint')) call read_joint(deck, b, scene, diagnostics)
    end do
    if (allocated(scene%contactors%id)) scene%contactors%id = scene%contactors%id(:scene%contactors%n)
  end subroutine joints_from_deck

  !> The joint of one block.
  subroutine read_joint(deck, b, scene, diagnostics)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: point(3), axis(3)
    integer :: body(2)
    logical :: are_found

    call two_bodies(deck, b, 'a joint', scene, body, are_found, diagnostics)
    if (.not. are_found) return
    point = deck%vector(b, 'point')
    if (.not. deck%is_given(b, 'axis')) then
      if (deck%is_given(b, 'width')) call deck%complain(diagnostics, '"width" has no meaning without "axis"', b, 'width')
      call hold(deck, scene, body, point)
      return
    end if
    axis = deck%vector(b, 'axis')
    if (.not. norm2(axis) > 0) then
      call deck%complain(diagnostics, 'the axis of a hinge must not be zero', b, 'axis')
    else if (.not. deck%is_given(b, 'width')) then
      call deck%complain(diagnostics, 'a hinge needs a "width", the distance of the two points that hold it', b, 'axis')
    else
      axis = axis/norm2(axis)*deck%number(b, 'width')/2
      call hold(deck, scene, body, point - axis)
      call hold(deck, scene, body, point + axis)
    end if
  end subroutine read_joint

  !> Hold two bodies together at a point.
  subroutine hold(deck, scene, body, point)
    type(deck_t), intent(inout) :: deck
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body(2)
    real(wp), intent(in) :: point(3)

    call add_ends(deck, scene, body, spread(point, 2, 2))
    call add_link(scene%links, deck%contactors + [-1, 0], nearest_image(scene, 0*point), size(scene%laws), 0.0_wp, 0.0_wp, 0.0_wp)
  end subroutine hold
end module sg_joints_from_deck
