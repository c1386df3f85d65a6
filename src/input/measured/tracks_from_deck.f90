!> Tracked bodies from the blocks `[[track]]`: names, patterns of names, and numbers; names of walls and of all bodies.
module sg_tracks_from_deck
  use sg_ascending, only: distinct
  use sg_blocks, only: deck_t
  use sg_called_bodies, only: add_bodies
  use sg_error, only: diagnostics_t
  use sg_kinds, only: i4
  use sg_run_options, only: run_options_t
  use sg_text, only: append_word, joined, text_t, to_text
  implicit none
  private
  public :: tracks_from_deck, name_walls, list_body_names

contains

  !> List the bodies that the deck tracks, each once; all ranks list the same.
  subroutine tracks_from_deck(deck, bodies, options, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck with its names
    integer, intent(in) :: bodies !! of the whole scene
    type(run_options_t), intent(inout) :: options !! gets the bodies
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    integer(i4), allocatable :: found(:)
    integer :: b, i

    if (deck%count_of('track') == 0) return
    allocate (found(0))
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'track')) cycle
      call add_bodies(deck, b, bodies, found, diagnostics)
      if (options%record_every == 0) call deck%warn(diagnostics, '[[track]] has no effect with output.record_every = 0', b, &
                                                    kind='track without record')
    end do
    options%tracked = distinct(found)
    allocate (options%tracked_names(0))
    do i = 1, size(options%tracked)
      call append_word(options%tracked_names, name_or_number(deck, options%tracked(i)))
    end do
  end subroutine tracks_from_deck

  !> Name the walls.
  subroutine name_walls(deck, options)
    type(deck_t), intent(in) :: deck !! checked deck with its names
    type(run_options_t), intent(inout) :: options !! its walls are listed
    integer :: i

    allocate (options%wall_names(0))
    do i = 1, options%walls%count()
      call append_word(options%wall_names, name_or_number(deck, options%walls%wall(i)%number))
    end do
  end subroutine name_walls

  !> List the names of all bodies as one text, for pictures; line ends within a name become blanks.
  subroutine list_body_names(deck, options)
    type(deck_t), intent(in) :: deck !! checked deck with its names
    type(run_options_t), intent(inout) :: options !! gets the text
    type(text_t), allocatable :: lines(:)
    integer :: i, k

    if (.not. allocated(deck%names)) return
    if (size(deck%names) == 0) return
    allocate (lines(size(deck%names)))
    do i = 1, size(lines)
      lines(i)%s = to_text(deck%named(i))//' '//deck%names(i)%s
      do k = 1, len(lines(i)%s)
        if (iachar(lines(i)%s(k:k)) < iachar(' ')) lines(i)%s(k:k) = ' '
      end do
    end do
    options%body_names = joined(lines, new_line('a'))
  end subroutine list_body_names

  !> Name of a body, or its number where it has none.
  function name_or_number(deck, number) result(name)
    type(deck_t), intent(in) :: deck
    integer(i4), intent(in) :: number
    character(len=:), allocatable :: name
    integer :: named

    named = 0
    if (allocated(deck%named)) named = findloc(deck%named, int(number), 1)
    if (named > 0) then
      name = deck%names(named)%s
    else
      name = to_text(int(number))
    end if
  end function name_or_number
end module sg_tracks_from_deck
