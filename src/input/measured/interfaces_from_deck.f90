!> Interfaces from the blocks `[[interface]]`: two bodies or patterns of names, two colours, or all pairs.
module sg_interfaces_from_deck
  use sg_ascending, only: distinct
  use sg_blocks, only: deck_t
  use sg_called_bodies, only: add_called
  use sg_colours_from_deck, only: find_colour
  use sg_error, only: diagnostics_t
  use sg_interface_options, only: interface_options_t, interface_pairs_t
  use sg_kinds, only: i4
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_values, only: value_t
  implicit none
  private
  public :: interfaces_from_deck

contains

  !> List the pairs that the deck asks for, and the names of all bodies that have one; all ranks list the same.
  subroutine interfaces_from_deck(deck, scene, options, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck with its names
    type(scene_t), intent(in) :: scene !! scene with its bodies and colours
    type(run_options_t), intent(inout) :: options !! gets the pairs
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    type(interface_options_t), allocatable :: found
    integer :: b, n

    if (deck%count_of('interface') == 0) return
    allocate (found)
    allocate (found%blocks(deck%count_of('interface')), found%number(0), found%name(0))
    n = 0
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'interface')) cycle
      n = n + 1
      call read_pairs(deck, b, scene, found%blocks(n), diagnostics)
    end do
    if (allocated(deck%names)) then
      found%number = int(deck%named, i4)
      found%name = deck%names
    end if
    if (options%record_every == 0 .and. options%output_every == 0) &
      call deck%warn(diagnostics, '[[interface]] has no effect with output.record_every = 0 and output.every = 0', &
                     deck%block_of('interface'), kind='interface without record')
    call move_alloc(found, options%interfaces)
  end subroutine interfaces_from_deck

  !> The pairs of one block.
  subroutine read_pairs(deck, b, scene, pairs, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(scene_t), intent(in) :: scene
    type(interface_pairs_t), intent(inout) :: pairs
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: value
    integer(i4), allocatable :: numbers(:)
    integer :: side

    if (deck%is_given(b, 'between')) then
      if (deck%is_given(b, 'colours')) then
        call deck%complain(diagnostics, 'an interface is between two bodies or between two colours: drop one of both keys', b, &
                           'colours')
        return
      end if
      value = deck%value(b, 'between')
      do side = 1, 2
        allocate (numbers(0))
        call add_called(deck, b, 'between', value%words(side)%s, scene%bodies%n + deck%absent%n, numbers, diagnostics)
        if (side == 1) pairs%first = distinct(numbers)
        if (side == 2) pairs%second = distinct(numbers)
        deallocate (numbers)
      end do
    else if (deck%is_given(b, 'colours')) then
      value = deck%value(b, 'colours')
      if (value%n_words /= 2) then
        call deck%complain(diagnostics, '"colours" are the two colours of an interface, or "any"', b, 'colours')
        return
      end if
      do side = 1, 2
        call find_colour(deck, b, 'colours', value%words(side)%s, scene, pairs%colour(side), diagnostics)
      end do
    end if
  end subroutine read_pairs
end module sg_interfaces_from_deck
