!> Gravity of a deck: the vector of the scene, and components that change with time.
module sg_gravity_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_gravity_changes, only: gravity_change_t
  use sg_kinds, only: wp
  use sg_scene, only: scene_t, set_gravity
  use sg_time_function_from_deck, only: read_time_function
  use sg_words, only: choice_index
  implicit none
  private
  public :: gravity_from_deck

contains

  !> Take gravity that is set for a scene as that which holds at the start, and read what changes it.
  subroutine gravity_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(scene_t), intent(inout) :: scene !! scene with the gravity that does not change
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: b, n

    if (deck%count_of('gravity') == 0) return
    scene%steady_gravity = scene%gravity
    allocate (scene%gravity_changes(deck%count_of('gravity')))
    n = 0
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'gravity')) cycle
      n = n + 1
      associate (change => scene%gravity_changes(n))
        change%component = choice_index(deck%word(b, 'component'), 'x|y|z')
        call read_time_function(deck, b, change%value, diagnostics)
        if (is_given_then(scene%gravity_changes(:n - 1), change)) &
          call deck%complain(diagnostics, 'this component of gravity is given twice at a time', b, 'component')
      end associate
    end do
    if (diagnostics%count() == 0) call set_gravity(scene, scene%start_time, 0.0_wp, 0.0_wp)
  end subroutine gravity_from_deck

  !> Do others give a component of gravity at a time at which this one does?
  pure logical function is_given_then(changes, change)
    type(gravity_change_t), intent(in) :: changes(:), change

    is_given_then = any(changes%component == change%component .and. changes%value%start < change%value%finish .and. &
                        change%value%start < changes%value%finish)
  end function is_given_then
end module sg_gravity_from_deck
