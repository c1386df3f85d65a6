!> List of the walls of a deck, from the blocks wall and container or from a DATBOX: all ranks list all of them, whichever rank
!! keeps their bodies.
module sg_wall_list_from_deck
  use sg_blocks, only: deck_t
  use sg_datbox_walls, only: list_datbox_walls
  use sg_kinds, only: wp, i4
  use sg_scene, only: scene_t
  use sg_walls, only: wall_t, walls_t
  use sg_walls_from_deck, only: planes, thickness_of_container
  implicit none
  private
  public :: wall_list_from_deck

contains

  !> List the walls, ascending by number, and find the cell that they enclose.
  subroutine wall_list_from_deck(deck, scene, walls)
    type(deck_t), intent(in) :: deck !! checked deck; its blocks hold their bodies
    type(scene_t), intent(in) :: scene !! scene with its dimension and periods
    type(walls_t), intent(out) :: walls !! the walls
    type(wall_t) :: wall
    integer :: b

    if (allocated(deck%driven)) call list_datbox_walls(scene, deck%driven, walls)
    do b = 1, deck%n
      if (deck%is_in(b, 'wall')) then
        if (scene%dimension == 2) then
          wall = segment(deck, b)
        else
          wall = plane(deck%vector(b, 'centre'), deck%vector(b, 'normal'), product(deck%pair(b, 'size')), &
                       deck%number(b, 'thickness'))
        end if
        wall%number = int(deck%blocks(b)%first_body, i4)
        call add(walls, wall)
      else if (deck%is_in(b, 'container')) then
        call add_planes(deck, b, scene, walls)
      end if
    end do
    if (scene%cell%is_on) then
      walls%has_cell = .true.
      walls%is_periodic = .true.
      walls%start = scene%cell%start(:3)
    end if
    if (walls%count() > 0) call walls%find_cell(scene%dimension, [scene%period, scene%period_y, 0.0_wp])
  end subroutine wall_list_from_deck

  !> Add a wall in the order of numbers.
  subroutine add(walls, wall)
    type(walls_t), intent(inout) :: walls
    type(wall_t), intent(in) :: wall
    integer :: n

    if (.not. allocated(walls%wall)) allocate (walls%wall(0))
    n = count(walls%wall%number < wall%number)
    walls%wall = [walls%wall(:n), wall, walls%wall(n + 1:)]
  end subroutine add

  !> A wall of the plane, which has two sides.
  type(wall_t) function segment(deck, b) result(wall)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    real(wp) :: from(2), to(2)

    from = deck%pair(b, 'from')
    to = deck%pair(b, 'to')
    wall%position(:2) = (from + to)/2
    wall%area = norm2(to - from)
    wall%normal(:2) = [from(2) - to(2), to(1) - from(1)]/wall%area
    wall%thickness = deck%number(b, 'thickness')
  end function segment

  !> A wall of space, which faces along its normal.
  pure type(wall_t) function plane(face, normal, area, thickness) result(wall)
    real(wp), intent(in) :: face(3), normal(3), area, thickness

    wall%normal = normal/norm2(normal)
    wall%position = face - thickness/2*wall%normal
    wall%area = area
    wall%thickness = thickness
    wall%has_side = .true.
  end function plane

  !> Add the planes of a container; their area is that of the room's side.
  subroutine add_planes(deck, b, scene, walls)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(in) :: scene
    type(walls_t), intent(inout) :: walls
    type(wall_t) :: wall
    real(wp) :: corner(3), room(3), face(3), normal(3)
    integer, allocatable :: list(:, :)
    integer :: i, a

    corner = deck%vector(b, 'corner')
    room = deck%vector(b, 'size')
    list = planes(deck, b, [scene%period, scene%period_y])
    do i = 1, size(list, 2)
      associate (axis => list(1, i))
        normal = 0
        normal(axis) = merge(1.0_wp, -1.0_wp, list(2, i) == 1)
        face = corner + room/2
        face(axis) = corner(axis) + merge(0.0_wp, room(axis), list(2, i) == 1)
        wall = plane(face, normal, product(room, mask=[(a /= axis, a=1, 3)]), thickness_of_container(deck, b))
      end associate
      wall%number = int(deck%blocks(b)%first_body + i - 1, i4)
      call add(walls, wall)
    end do
  end subroutine add_planes
end module sg_wall_list_from_deck
