!> Tracked bodies from the blocks `[[track]]`: names, patterns of names, and numbers; names of walls.
module sg_tracks_from_deck
  use sg_ascending, only: distinct
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: i4
  use sg_run_options, only: run_options_t
  use sg_text, only: append_word, nearest_word, text_t, to_text
  use sg_values, only: value_t
  use sg_wildcards, only: has_wildcard, matches
  implicit none
  private
  public :: tracks_from_deck, name_walls, add_bodies

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

  !> Add the bodies that the key `body` of a block calls by number, by name or by a pattern of names.
  subroutine add_bodies(deck, b, bodies, found, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck with its names
    integer, intent(in) :: b !! block
    integer, intent(in) :: bodies !! of the whole scene
    integer(i4), allocatable, intent(inout) :: found(:) !! numbers to add to
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(value_t) :: value
    integer :: number, status, i, n

    value = deck%value(b, 'body')
    n = size(found)
    associate (word => value%words(1)%s)
      if (word(1:min(1, len(word))) == '#') then
        read (word(2:), *, iostat=status) number
        if (status /= 0) number = 0
        if (number >= 1 .and. number <= bodies) then
          found = [found, int(number, i4)]
        else
          call deck%complain(diagnostics, 'there is no body '//word(2:)//': the scene has '//to_text(bodies), b, 'body')
        end if
        return
      end if
      if (allocated(deck%names)) then
        do i = 1, size(deck%names)
          if (matches(deck%names(i)%s, word)) found = [found, int(deck%named(i), i4)]
        end do
      end if
      if (size(found) == n) call complain_of_none(deck, b, word, diagnostics)
    end associate
  end subroutine add_bodies

  !> Report a name or a pattern that no body has, with the nearest name.
  subroutine complain_of_none(deck, b, word, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    character(len=*), intent(in) :: word
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: near
    logical :: has_names

    has_names = allocated(deck%names)
    if (has_names) has_names = size(deck%names) > 0
    if (.not. has_names) then
      call deck%complain(diagnostics, 'there is no body named "'//word//'": no body of this scene has a name, give its number', &
                         b, 'body')
    else if (has_wildcard(word)) then
      near = nearest_word(word, deck%names)
      if (near /= '') near = '; the nearest one is "'//near//'"'
      call deck%complain(diagnostics, 'no body has a name that matches "'//word//'"'//near, b, 'body')
    else
      call deck%complain_unknown(diagnostics, 'body', word, deck%names, b, 'body')
    end if
  end subroutine complain_of_none
end module sg_tracks_from_deck
