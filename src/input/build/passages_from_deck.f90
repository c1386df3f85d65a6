!> Bodies that come after the start and bodies that leave: keys `at` of [[body]], [[wall]] and [[sample]], blocks
!! [[rain]] and [[remove]].
module sg_passages_from_deck
  use sg_ascending, only: distinct
  use sg_blocks, only: deck_t
  use sg_bodies, only: body_waiting
  use sg_called_bodies, only: add_bodies
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4
  use sg_passages, only: due_time, entry_t, exit_t
  use sg_scene, only: scene_t
  use sg_text, only: append_word, text_t
  use sg_values, only: value_t
  implicit none
  private
  public :: passages_from_deck

contains

  !> List entries and exits, and mark the bodies that wait. Nothing is allocated where a deck has none.
  subroutine passages_from_deck(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck whose blocks have their bodies
    type(scene_t), intent(inout) :: scene !! scene, or a rank's share, with its bodies
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found

    call list_entries(deck, scene, diagnostics)
    call list_exits(deck, scene, diagnostics)
    if (.not. (allocated(scene%entries) .or. allocated(scene%exits)) .or. diagnostics%count() > 0) return
    scene%bodies%has_presence = .true.
    call scene%bodies%resize(scene%bodies%n)
    if (allocated(scene%entries)) call mark_waiting(scene)
  end subroutine passages_from_deck

  !> List the blocks whose bodies come after the start.
  subroutine list_entries(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    logical :: enters(deck%n)
    integer :: b, e

    do b = 1, deck%n
      enters(b) = deck%is_in(b, 'rain')
      if (deck%is_in(b, 'body') .or. deck%is_in(b, 'wall') .or. deck%is_in(b, 'sample')) enters(b) = deck%is_given(b, 'at')
    end do
    if (.not. any(enters)) return
    allocate (scene%entries(count(enters)))
    e = 0
    do b = 1, deck%n
      if (.not. enters(b)) cycle
      e = e + 1
      associate (entry => scene%entries(e))
        entry%first = deck%blocks(b)%first_body
        entry%last = deck%blocks(b)%last_body
        entry%start = moment_of(deck, b, diagnostics)
        entry%waits = deck%is_in(b, 'rain')
        if (.not. entry%waits) cycle
        entry%interval = 1/deck%number(b, 'rate')
        entry%every = deck%integer(b, 'every')
      end associate
    end do
  end subroutine list_entries

  !> List the blocks by which bodies leave.
  subroutine list_exits(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: b, e

    if (deck%count_of('remove') == 0) return
    allocate (scene%exits(deck%count_of('remove')))
    e = 0
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'remove')) cycle
      e = e + 1
      call read_exit(deck, b, scene%bodies%n + deck%absent%n, scene%exits(e), diagnostics)
    end do
  end subroutine list_exits

  !> A block [[remove]].
  subroutine read_exit(deck, b, bodies, exit, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, bodies
    type(exit_t), intent(inout) :: exit
    type(diagnostics_t), intent(inout) :: diagnostics
    integer(i4), allocatable :: found(:)
    type(value_t) :: box

    if (.not. (deck%is_given(b, 'box') .or. deck%is_given(b, 'at'))) &
      call deck%complain(diagnostics, 'a [[remove]] needs the key "box" or "at": where or when bodies leave', b)
    if (deck%is_given(b, 'box')) then
      box = deck%value(b, 'box')
      associate (d => deck%dimension)
        exit%low(:d) = box%numbers(:d)
        exit%high(:d) = box%numbers(d + 1:2*d)
        if (any(exit%high(:d) <= exit%low(:d))) call deck%complain(diagnostics, 'the box is empty: its least coordinates come '// &
                                                                   'first, then the largest', b, 'box')
      end associate
      exit%is_inside = deck%word(b, 'where') == 'inside'
    end if
    if (deck%is_given(b, 'at')) exit%start = moment_of(deck, b, diagnostics)
    exit%every = deck%integer(b, 'every')
    if (.not. deck%is_given(b, 'body')) return
    allocate (found(0))
    call add_bodies(deck, b, bodies, found, diagnostics)
    exit%bodies = distinct(found)
  end subroutine read_exit

  !> The time of the key `at` [s]: of a stage its beginning; hugely early where it has begun before, hugely late where it
  !! is to come.
  real(wp) function moment_of(deck, b, diagnostics) result(time)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: at
    type(text_t), allocatable :: names(:)
    integer :: block, stage

    at = deck%value(b, 'at')
    if (at%n_words == 0) then
      time = at%numbers(1)
      return
    end if
    time = huge(time)
    stage = 0
    allocate (names(0))
    do block = 1, deck%n
      if (.not. deck%is_in(block, 'stage')) cycle
      call append_word(names, deck%word(block, 'name'))
      if (names(size(names))%s == at%words(1)%s) stage = size(names)
    end do
    if (stage == 0) then
      call deck%complain_unknown(diagnostics, 'stage', at%words(1)%s, names, b, 'at')
    else if (stage < deck%stage_number) then
      time = -huge(time)
    else if (stage == deck%stage_number) then
      time = deck%stage_time
    end if
  end function moment_of

  !> Mark the bodies that are not there at the start.
  pure subroutine mark_waiting(scene)
    type(scene_t), intent(inout) :: scene
    integer :: b, e, number

    associate (bodies => scene%bodies)
      bodies%entry_velocity = bodies%velocity
      do b = 1, bodies%n
        number = b
        if (allocated(bodies%id)) number = bodies%id(b)
        do e = 1, size(scene%entries)
          associate (entry => scene%entries(e))
            if (number < entry%first .or. number > entry%last) cycle
            if (entry%waits .or. due_time(entry, number) > scene%start_time) bodies%presence(b) = body_waiting
          end associate
        end do
      end do
    end associate
  end subroutine mark_waiting
end module sg_passages_from_deck
