!> Walls from the blocks wall, segments of the plane or planes in space, and the sides of the boxes that the blocks container
!! describe.
!!
!! The frame of a plane's body has the axes of the world; the plane lies in it as the normal says.
module sg_walls_from_deck
  use sg_blocks, only: deck_t
  use sg_contactors, only: add_wall
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_named_bodies, only: give_name
  use sg_scene, only: colour_index, scene_t
  use sg_space_contactors, only: add_plane
  use sg_text, only: to_text
  use sg_vectors, only: cross
  use sg_weights_from_deck, only: weigh_body
  implicit none
  private
  public :: add_wall_body, add_container, planes_of_container

  !> Cosine to z from which on a normal is taken for vertical: rounding
  real(wp), parameter :: vertical = 1 - 1e-12_wp

contains

  !> The body of a [[wall]] block.
  subroutine add_wall_body(deck, b, scene, n, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the wall
    type(scene_t), intent(inout) :: scene !! scene with its bodies
    integer, intent(in) :: n !! number of the body
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    real(wp) :: normal(3), velocity(3), from(2), to(2)
    integer :: colour

    velocity = deck%vector(b, 'velocity')
    scene%bodies%velocity(:scene%dimension, n) = velocity(:scene%dimension)
    call colour_index(scene, deck%word(b, 'colour'), colour)
    if (scene%dimension == 3) then
      normal = deck%vector(b, 'normal')
      if (norm2(normal) > 0) then
        call set_plane(scene, n, colour, deck%vector(b, 'centre'), normal/norm2(normal), deck%pair(b, 'size'), &
                       deck%number(b, 'thickness'))
      else
        call deck%complain(diagnostics, 'the normal has no length', b, 'normal')
      end if
      return
    end if
    from = deck%pair(b, 'from')
    to = deck%pair(b, 'to')
    if (.not. norm2(to - from) > 0) then
      call deck%complain(diagnostics, 'the wall has no length: "from" and "to" are the same point', b, 'to')
      return
    end if
    scene%bodies%position(:, n) = (from + to)/2
    scene%bodies%angle(n) = atan2(to(2) - from(2), to(1) - from(1))
    call add_wall(scene%contactors, n, colour, norm2(to - from)/2, deck%number(b, 'thickness')/2, [0.0_wp, 0.0_wp], 0.0_wp)
    call weigh_body(scene, n, scene%contactors%n)
  end subroutine add_wall_body

  !> Make a body of one plane.
  subroutine set_plane(scene, n, colour, face, normal, sides, thickness)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: n, colour
    real(wp), intent(in) :: face(3), normal(3), sides(2), thickness
    real(wp) :: frame(3, 3)

    ! The first side is level; where all sides are, it lies along x.
    frame(:, 1) = [1.0_wp, 0.0_wp, 0.0_wp]
    if (abs(normal(3)) < vertical) frame(:, 1) = [-normal(2), normal(1), 0.0_wp]/norm2(normal(:2))
    frame(:, 3) = normal
    frame(:, 2) = cross(frame(:, 3), frame(:, 1))
    frame(:, 2) = frame(:, 2)/norm2(frame(:, 2))
    scene%bodies%position(:, n) = face - thickness/2*normal
    call add_plane(scene%contactors, n, colour, [sides/2, thickness/2], [0.0_wp, 0.0_wp, 0.0_wp], frame)
    call weigh_body(scene, n, scene%contactors%n)
  end subroutine set_plane

  !> Number of planes of a container.
  integer function planes_of_container(deck, b, period) result(n)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the container
    real(wp), intent(in) :: period(2) !! periods in x and y [m], zero where there is none

    n = 1
    if (deck%flag(b, 'lid')) n = n + 1
    if (deck%flag(b, 'sides')) n = n + 2*count(.not. period > 0)
  end function planes_of_container

  !> The planes of a [[container]] block. Each reaches beyond the room by its thickness, so that edges and corners are closed.
  subroutine add_container(deck, b, scene, n, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the container
    type(scene_t), intent(inout) :: scene !! scene with its bodies and their materials
    integer, intent(inout) :: n !! bodies so far
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=*), parameter :: names(3, 2) = reshape([character(len=5) :: 'left', 'front', 'floor', 'right', 'back', 'lid'], &
                                                         [3, 2])
    real(wp) :: corner(3), room(3), thickness, face(3), normal(3), sides(2), beyond(3), period(3)
    integer :: axis, other, side, colour

    period = [scene%period, scene%period_y, 0.0_wp]
    corner = deck%vector(b, 'corner')
    room = deck%vector(b, 'size')
    thickness = minval(room)/10
    if (deck%is_given(b, 'thickness')) thickness = deck%number(b, 'thickness')
    beyond = merge(0.0_wp, 2*thickness, period > 0)
    do axis = 1, 2
      if (.not. period(axis) > 0 .or. abs(room(axis) - period(axis)) <= 1e-9_wp*period(axis)) cycle
      call deck%complain(diagnostics, 'the room is not as long as the period along '//merge('x', 'y', axis == 1)//': '// &
                         to_text(room(axis), 6)//' m against '//to_text(period(axis), 6)//' m', b, 'size')
    end do
    call colour_index(scene, deck%word(b, 'colour'), colour)
    do axis = 3, 1, -1
      do side = 1, 2
        if (period(axis) > 0) cycle
        if (axis < 3 .and. .not. deck%flag(b, 'sides')) cycle
        if (axis == 3 .and. side == 2 .and. .not. deck%flag(b, 'lid')) cycle
        normal = 0
        normal(axis) = merge(1.0_wp, -1.0_wp, side == 1)
        face = corner + room/2
        face(axis) = corner(axis) + merge(0.0_wp, room(axis), side == 1)
        other = 1 + mod(axis, 2)
        sides = room(:2) + beyond(:2)
        if (axis < 3) sides = [room(other) + beyond(other), room(3) + beyond(3)]
        n = n + 1
        call set_plane(scene, n, colour, face, normal, sides, thickness)
        call give_name(scene, n, deck%word(b, 'name')//'.'//trim(names(axis, side)))
      end do
    end do
  end subroutine add_container
end module sg_walls_from_deck
