!> Ends of links and joints: the two bodies that a block names, and points on them, contactors of their own.
module sg_link_ends
  use sg_blocks, only: deck_t
  use sg_called_bodies, only: body_of
  use sg_contactors, only: add_point
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  use sg_rotations, only: turned_back
  use sg_scene, only: colour_index, scene_t
  use sg_values, only: value_t
  implicit none
  private
  public :: add_ends, two_bodies

contains

  !> The two different bodies that a block names.
  subroutine two_bodies(deck, b, what, scene, body, are_found, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block with the key "bodies"
    character(len=*), intent(in) :: what !! what it is: a link or a joint
    type(scene_t), intent(in) :: scene !! scene with its bodies
    integer, intent(out) :: body(2) !! the bodies
    logical, intent(out) :: are_found !! are there two?
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(value_t) :: bodies
    integer :: side, errors

    errors = diagnostics%count()
    bodies = deck%value(b, 'bodies')
    do side = 1, 2
      body(side) = body_of(deck, b, 'bodies', bodies%words(side)%s, scene, diagnostics)
    end do
    if (diagnostics%count() == errors .and. body(1) == body(2)) &
      call deck%complain(diagnostics, what//' needs two different bodies', b, 'bodies')
    are_found = diagnostics%count() == errors
  end subroutine two_bodies

  !> Put a point on each of two bodies.
  subroutine add_ends(deck, scene, body, place)
    type(deck_t), intent(inout) :: deck !! checked deck; the number of all contactors grows
    type(scene_t), intent(inout) :: scene !! scene with its bodies
    integer, intent(in) :: body(2) !! the bodies
    real(wp), intent(in) :: place(3, 2) !! where the points are in the world [m]
    real(wp) :: way(3)
    integer :: side, colour

    call colour_index(scene, 'link', colour)
    do side = 1, 2
      associate (bodies => scene%bodies, b => body(side))
        way = place(:, side)
        way(:scene%dimension) = way(:scene%dimension) - bodies%position(:, b)
        if (scene%dimension == 3) then
          way = turned_back(bodies%orientation(:, b), way)
        else
          way(:2) = [cos(bodies%angle(b))*way(1) + sin(bodies%angle(b))*way(2), &
                     cos(bodies%angle(b))*way(2) - sin(bodies%angle(b))*way(1)]
        end if
        call add_point(scene%contactors, b, colour, way(:scene%dimension))
      end associate
      deck%contactors = deck%contactors + 1
      if (.not. allocated(scene%contactors%id)) cycle
      call reserve(scene%contactors%id, scene%contactors%n)
      scene%contactors%id(scene%contactors%n) = int(deck%contactors, i4)
    end do
  end subroutine add_ends
end module sg_link_ends
