!> Walls from the blocks wall, segments of the plane or planes in space, and the sides of the boxes that the blocks container
!! describe.
!!
!! The frame of a plane's body has the axes of the world; the normal gives the direction of the plane in it.
module sg_walls_from_deck
  use sg_blocks, only: deck_t
  use sg_contactors, only: add_segment
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_scene, only: colour_index, scene_t
  use sg_share, only: share_t
  use sg_space_contactors, only: add_plane
  use sg_text, only: to_text
  use sg_vectors, only: cross
  use sg_weights_from_deck, only: weigh_body
  implicit none
  private
  public :: add_wall_body, add_container, planes_of_container, name_of_plane, planes, thickness_of_container

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
    call add_segment(scene%contactors, n, colour, norm2(to - from)/2, deck%number(b, 'thickness')/2, [0.0_wp, 0.0_wp], 0.0_wp)
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

    n = size(planes(deck, b, period), 2)
  end function planes_of_container

  !> What a plane of a container is called.
  function name_of_plane(deck, b, period, plane) result(name)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the container
    real(wp), intent(in) :: period(2) !! periods in x and y [m], zero where there is none
    integer, intent(in) :: plane !! plane of the container, in the order in which they are made
    character(len=:), allocatable :: name
    integer, allocatable :: list(:, :)
    character(len=*), parameter :: names(3, 2) = reshape([character(len=5) :: 'left', 'front', 'floor', 'right', 'back', 'lid'], &
                                                         [3, 2])

    list = planes(deck, b, period)
    name = deck%word(b, 'name')//'.'//trim(names(list(1, plane), list(2, plane)))
  end function name_of_plane

  !> Axis and side of the planes of a container, from the floor on, shape (2, planes).
  function planes(deck, b, period) result(list)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the container
    real(wp), intent(in) :: period(2) !! periods in x and y [m], zero where there is none
    integer, allocatable :: list(:, :)

    list = reshape([3, 1], [2, 1])
    if (deck%flag(b, 'lid')) call add([3, 2])
    if (.not. deck%flag(b, 'sides')) return
    if (.not. period(2) > 0) call add([2, 1, 2, 2])
    if (.not. period(1) > 0) call add([1, 1, 1, 2])
  contains
    subroutine add(more)
      integer, intent(in) :: more(:)

      list = reshape([list, more], [2, size(list, 2) + size(more)/2])
    end subroutine add
  end function planes

  !> Thickness of the planes of a container [m].
  real(wp) function thickness_of_container(deck, b) result(thickness)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the container

    thickness = minval(deck%vector(b, 'size'))/10
    if (deck%is_given(b, 'thickness')) thickness = deck%number(b, 'thickness')
  end function thickness_of_container

  !> The planes of a [[container]] block. Each reaches beyond the room by its thickness, so that edges and corners are closed.
  subroutine add_container(deck, b, material, scene, share, n, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the container
    integer(i4), intent(in) :: material !! of the planes
    type(scene_t), intent(inout) :: scene !! scene with its bodies
    type(share_t), intent(inout) :: share !! what this rank keeps of them
    integer, intent(inout) :: n !! bodies kept so far
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    real(wp) :: corner(3), room(3), thickness, face(3), normal(3), sides(2), beyond(3), period(3)
    integer, allocatable :: list(:, :)
    integer :: axis, other, side, colour, plane

    period = [scene%period, scene%period_y, 0.0_wp]
    corner = deck%vector(b, 'corner')
    room = deck%vector(b, 'size')
    thickness = thickness_of_container(deck, b)
    beyond = merge(0.0_wp, 2*thickness, period > 0)
    do axis = 1, 2
      if (.not. period(axis) > 0 .or. abs(room(axis) - period(axis)) <= 1e-9_wp*period(axis)) cycle
      call deck%complain(diagnostics, 'the room is not as long as the period along '//merge('x', 'y', axis == 1)//': '// &
                         to_text(room(axis), 6)//' m against '//to_text(period(axis), 6)//' m', b, 'size')
    end do
    call colour_index(scene, deck%word(b, 'colour'), colour)
    list = planes(deck, b, period(:2))
    do plane = 1, size(list, 2)
      axis = list(1, plane)
      side = list(2, plane)
      normal = 0
      normal(axis) = merge(1.0_wp, -1.0_wp, side == 1)
      face = corner + room/2
      face(axis) = corner(axis) + merge(0.0_wp, room(axis), side == 1)
      other = 1 + mod(axis, 2)
      sides = room(:2) + beyond(:2)
      if (axis < 3) sides = [room(other) + beyond(other), room(3) + beyond(3)]
      scene%bodies%material(n + 1) = material
      call set_plane(scene, n + 1, colour, face, normal, sides, thickness)
      call share%settle(scene, n)
    end do
  end subroutine add_container
end module sg_walls_from_deck
