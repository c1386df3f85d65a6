!> The area that a plane of a container closes now: between the planes next to it, wherever these have gone.
module sg_container_area
  use sg_blocks, only: deck_t
  use sg_drives, only: pressure_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_local_numbers, only: local_body
  use sg_scene, only: scene_t
  use sg_walls_from_deck, only: planes, thickness_of_container
  implicit none
  private
  public :: bound_by_container

contains

  !> Let a pressure act on the present area of a plane of a container. Along an axis with two planes that is the distance of their
  !! faces, along others the length of the room: the period, or that of the deck where a side is open.
  subroutine bound_by_container(deck, b, scene, direction, pressure, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck; its blocks hold their bodies
    integer, intent(in) :: b !! block of the pressure
    type(scene_t), intent(in) :: scene !! scene with its bodies
    real(wp), intent(in) :: direction(3) !! of the push
    type(pressure_t), intent(inout) :: pressure !! pressure with its body; gets what bounds its area
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=*), parameter :: letters = 'xyz'
    integer, allocatable :: list(:, :)
    integer :: number, container, axis, plane, i
    real(wp) :: room(3)

    number = pressure%body
    if (allocated(scene%bodies%id)) number = scene%bodies%id(number)
    container = deck%block_of_body(number)
    ! Bodies of a DATBOX come from no block.
    if (container > 0) then
      if (.not. deck%is_in(container, 'container')) container = 0
    end if
    if (container == 0) then
      call deck%complain(diagnostics, 'this pressure needs the key "area": its body is no plane of a [[container]]', b)
      return
    end if
    list = planes(deck, container, [scene%period, scene%period_y])
    axis = list(1, number - deck%blocks(container)%first_body + 1)
    if (any(abs(direction) > 0 .neqv. [(i == axis, i=1, 3)])) then
      call deck%complain(diagnostics, 'a plane of a [[container]] is pressed along its normal, '//letters(axis:axis)// &
                         ': another direction needs the key "area"', b, 'direction')
      return
    end if
    room = deck%vector(container, 'size')
    pressure%side_length = room
    do axis = 1, 3
      associate (pair => pack([(plane, plane=1, size(list, 2))], list(1, :) == axis))
        if (size(pair) < 2) cycle
        pressure%sides(:, axis) = [(local_body(scene%bodies, int(deck%blocks(container)%first_body + pair(i) - 1, i4)), i=1, 2)]
        pressure%side_length(axis) = -thickness_of_container(deck, container)
      end associate
    end do
  end subroutine bound_by_container
end module sg_container_area
