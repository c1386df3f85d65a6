!> Checks of the state at the start: grains within the period, and no wider than it.
module sg_start_checks
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_named_bodies, only: name_of
  use sg_scene, only: periods_of, scene_t
  use sg_shape_kinds, only: is_round
  use sg_text, only: to_text
  implicit none
  private
  public :: check_range, first_wide, lies_outside, complain_of_wide, complain_of_outside

contains

  !> In a periodic scene every grain lies within the period, and none would touch itself.
  subroutine check_range(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(in) :: scene !! scene with its bodies
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    real(wp) :: period(3)
    integer :: axis, c, b

    period = periods_of(scene)
    do axis = 1, scene%dimension
      if (.not. period(axis) > 0) cycle
      c = first_wide(scene, period(axis))
      if (c > 0) then
        call complain_of_wide(deck, int(scene%contactors%body(c)), scene%contactors%reach(c), period(axis), diagnostics)
        cycle
      end if
      do b = 1, scene%bodies%n
        if (lies_outside(scene, b, axis)) call complain_of_outside(deck, scene, b, axis, scene%bodies%position(axis, b), &
                                                                   diagnostics)
      end do
    end do
  end subroutine check_range

  !> First round contactor of a grain that is wider than a period; 0 when there is none.
  pure integer function first_wide(scene, period) result(contactor)
    type(scene_t), intent(in) :: scene !! scene with its bodies
    real(wp), intent(in) :: period !! [m]

    do contactor = 1, scene%contactors%n
      if (.not. scene%bodies%is_grain(scene%contactors%body(contactor)) .or. &
          .not. is_round(scene%contactors%kind(contactor))) cycle
      if (2*scene%contactors%reach(contactor) > period) return
    end do
    contactor = 0
  end function first_wide

  !> Does a grain lie outside of the period?
  pure logical function lies_outside(scene, body, axis)
    type(scene_t), intent(in) :: scene !! scene with its bodies
    integer, intent(in) :: body !! body of the scene
    integer, intent(in) :: axis !! 1 for x, 2 for y, 3 for z

    real(wp) :: period(3)

    period = periods_of(scene)
    associate (coordinate => scene%bodies%position(axis, body))
      lies_outside = scene%bodies%is_grain(body) .and. .not. (coordinate >= 0 .and. coordinate < period(axis))
    end associate
  end function lies_outside

  !> Report a grain that is wider than the period.
  subroutine complain_of_wide(deck, number, reach, period, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: number !! number of the body in the whole scene
    real(wp), intent(in) :: reach !! radius of the grain [m]
    real(wp), intent(in) :: period !! [m]
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    call deck%complain(diagnostics, name_of(deck, number)//' is wider than the period: '//to_text(2*reach, 6)//' m against '// &
                       to_text(period, 6)//' m', deck%block_of_body(number))
  end subroutine complain_of_wide

  !> Report a grain that lies outside of the period.
  subroutine complain_of_outside(deck, scene, number, axis, coordinate, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(in) :: scene !! scene with its period
    integer, intent(in) :: number !! number of the body in the whole scene
    integer, intent(in) :: axis !! 1 for x, 2 for y, 3 for z
    real(wp), intent(in) :: coordinate !! of the grain along it [m]
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=*), parameter :: letters = 'xyz'
    real(wp) :: period(3)

    period = periods_of(scene)
    call deck%complain(diagnostics, name_of(deck, number)//' lies outside of the period: '//letters(axis:axis)//' = '// &
                       to_text(coordinate, 6)//' m is not within 0 to '// &
                       to_text(period(axis), 6)//' m', deck%block_of_body(number))
  end subroutine complain_of_outside
end module sg_start_checks
