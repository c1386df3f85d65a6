!> Deck of a stage: the deck, and what the stage changes laid over it.
!!
!! A stage changes keys of sections that stand once, and of laws and containers by name. Its drives take the place of the deck's on
!! the same component of the same body, its pressures that of the deck's on the same body, its gravity that of the deck along the
!! same axis; the others stay.
module sg_stage_deck
  use sg_blocks, only: block_t, deck_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_stages, only: stages_t
  use sg_text, only: text_t, to_text
  use sg_values, only: value_t
  use sg_wildcards, only: matches
  use sg_words, only: quoted_string
  implicit none
  private
  public :: deck_of_stage, list_stages, split_changes

contains

  !> Set what stages change apart from the other blocks of a deck.
  subroutine split_changes(deck)
    type(deck_t), intent(inout) :: deck !! deck of which all entries are taken
    logical, allocatable :: is_change(:)
    integer :: b, n, outer

    is_change = [(deck%is_in_stage(b), b=1, deck%n)]
    allocate (deck%changes(count(is_change)))
    if (size(deck%changes) == 0) return
    n = 0
    do b = 1, deck%n
      if (.not. is_change(b)) cycle
      n = n + 1
      outer = deck%blocks(b)%parent
      do while (.not. deck%is_in(outer, 'stage'))
        outer = deck%blocks(outer)%parent
      end do
      call move_block(deck%blocks(b), deck%changes(n))
      deck%changes(n)%parent = stage_number(deck, outer)
      deck%changes(n)%is_of_stage = .true.
    end do
    call keep_blocks(deck, .not. is_change)
  end subroutine split_changes

  !> Number of the stage that a block is.
  pure integer function stage_number(deck, block) result(number)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    integer :: b

    number = count([(deck%is_in(b, 'stage'), b=1, block)])
  end function stage_number

  !> Block of a stage.
  pure integer function stage_block(deck, number) result(block)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: number
    integer :: found

    found = 0
    do block = 1, deck%n
      if (deck%is_in(block, 'stage')) found = found + 1
      if (found == number) return
    end do
  end function stage_block

  !> Move a block.
  pure subroutine move_block(from, to)
    type(block_t), intent(inout) :: from, to

    to%section = from%section
    to%parent = from%parent
    to%line = from%line
    to%column = from%column
    to%n = from%n
    to%first_body = from%first_body
    to%last_body = from%last_body
    to%is_of_stage = from%is_of_stage
    call move_alloc(from%values, to%values)
  end subroutine move_block

  !> Keep some blocks of a deck.
  pure subroutine keep_blocks(deck, is_kept)
    type(deck_t), intent(inout) :: deck
    logical, intent(in) :: is_kept(:) !! shape (n)
    type(block_t), allocatable :: kept(:)
    integer :: place(0:size(is_kept)), b, n

    allocate (kept(count(is_kept)))
    place = 0
    n = 0
    do b = 1, size(is_kept)
      if (.not. is_kept(b)) cycle
      n = n + 1
      place(b) = n
      call move_block(deck%blocks(b), kept(n))
      kept(n)%parent = place(kept(n)%parent)
    end do
    call move_alloc(kept, deck%blocks)
    deck%n = n
  end subroutine keep_blocks

  !> List the stages of a deck: names, steps and end conditions.
  subroutine list_stages(deck, stages, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck with stages
    type(stages_t), intent(inout) :: stages !! where they are stays
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: b, s, k

    if (deck%is_given(deck%block_of('stop'), 'when')) &
      call deck%complain(diagnostics, 'end conditions of a deck with stages stand in the stages: until', deck%block_of('stop'), &
                         'when')
    b = deck%block_of('report')
    if (deck%flag(b, 'spectrum')) call deck%complain(diagnostics, 'spectra do not go over several stages', b, 'spectrum')
    if (deck%flag(b, 'trace')) call deck%complain(diagnostics, 'traces do not go over several stages', b, 'trace')
    b = deck%block_of('time')
    stages%most_steps = huge(0)
    if (deck%is_given(b, 'steps')) stages%most_steps = deck%integer(b, 'steps')
    if (allocated(stages%list)) deallocate (stages%list)
    allocate (stages%list(deck%count_of('stage')))
    do s = 1, size(stages%list)
      b = stage_block(deck, s)
      associate (stage => stages%list(s))
        stage%name = deck%word(b, 'name')
        stage%conditions = conditions_of(deck, b)
        stage%most_steps = steps_of(deck, b, s, diagnostics)
        do k = 1, s - 1
          if (len(stage%name) > 0 .and. stages%list(k)%name == stage%name) &
            call deck%complain(diagnostics, 'two stages have the name '//quoted_string(stage%name), b, 'name')
        end do
      end associate
    end do
  end subroutine list_stages

  !> End conditions of a stage, as texts.
  pure function conditions_of(deck, b) result(conditions)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    type(text_t), allocatable :: conditions(:)
    type(value_t) :: until
    integer :: i

    until = deck%value(b, 'until')
    allocate (conditions(until%n_words))
    do i = 1, until%n_words
      conditions(i)%s = until%words(i)%s
    end do
  end function conditions_of

  !> Steps of a stage at most.
  integer function steps_of(deck, b, number, diagnostics) result(steps)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, number
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: wanted
    character(len=:), allocatable :: key

    steps = huge(0)
    key = trim(merge('steps   ', 'duration', deck%is_given(b, 'steps')))
    if (deck%is_given(b, 'steps') .and. deck%is_given(b, 'duration')) then
      call deck%complain(diagnostics, 'a stage has either "steps" or "duration"', b, 'duration')
    else if (.not. deck%is_given(b, key)) then
      if (deck%is_given(b, 'until') .and. deck%is_given(deck%block_of('time'), 'steps')) return
      call deck%complain(diagnostics, 'a stage needs "steps" or "duration"; where it has "until" alone, time.steps bounds it', b)
      return
    end if
    wanted = deck%number(b, key)
    ! A duration of so many steps gives no further one by rounding.
    if (key == 'duration') wanted = ceiling_of(wanted/time_step_of(deck, number)*(1 - 1e-9_wp))
    if (wanted < real(huge(0), wp)) then
      steps = nint(wanted)
    else
      call deck%complain(diagnostics, 'a stage has less than '//to_text(huge(0))//' steps', b, key)
    end if
  end function steps_of

  !> The next whole number, as a real.
  pure real(wp) function ceiling_of(number)
    real(wp), intent(in) :: number

    ceiling_of = aint(number)
    if (ceiling_of < number) ceiling_of = ceiling_of + 1
  end function ceiling_of

  !> Time step of a stage [s].
  pure real(wp) function time_step_of(deck, number) result(step)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: number
    integer :: c, v

    step = deck%number(deck%block_of('time'), 'step')
    do c = 1, size(deck%changes)
      if (deck%changes(c)%parent /= number .or. deck%table%sections(deck%changes(c)%section)%name /= 'time') cycle
      v = place_of_key(deck, deck%changes(c), 'step')
      if (v > 0) step = deck%changes(c)%values(v)%numbers(1)
    end do
  end function time_step_of

  !> Place of a key among the values of a block; 0 where it is not given.
  pure integer function place_of_key(deck, block, name) result(place)
    type(deck_t), intent(in) :: deck
    type(block_t), intent(in) :: block
    character(len=*), intent(in) :: name

    do place = 1, block%n
      if (deck%table%keys(block%values(place)%key)%name == name) return
    end do
    place = 0
  end function place_of_key

  !> Deck of a stage. Its time.steps is the step at which the stage ends, its [stop] holds the conditions of the stage.
  subroutine deck_of_stage(deck, stages, number, merged, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck with stages
    type(stages_t), intent(in) :: stages !! list of its stages
    integer, intent(in) :: number !! of the stage
    type(deck_t), intent(out) :: merged !! the deck, to be checked again
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: c, last

    merged = deck
    merged%stage_number = number
    do c = 1, size(deck%changes)
      if (deck%changes(c)%parent /= number) cycle
      associate (change => deck%changes(c), name => deck%table%sections(deck%changes(c)%section)%name)
        if (name == 'drive' .or. name == 'pressure' .or. name == 'gravity') then
          call add_block(merged, change)
        else if (name == 'law' .or. name == 'container') then
          call change_named(merged, change, trim(name), diagnostics)
        else
          call change_values(merged, change, merged%block_of(trim(name)))
        end if
      end associate
    end do
    call drop_replaced(merged)
    call take_conditions(merged, stage_block(merged, number))
    last = stages%list(number)%first_step
    if (number == stages%number) then
      last = stages%last_step()
      merged%stage_time = stages%list(number)%start_time
    else if (stages%list(number)%most_steps < stages%most_steps) then
      last = stages%list(number)%most_steps
    end if
    merged%stage_steps = max(1, last - stages%list(number)%first_step)
    call merged%give_numbers(merged%block_of('time'), 'steps', [real(last, wp)])
  end subroutine deck_of_stage

  !> Add a block of a stage to a deck.
  subroutine add_block(deck, change)
    type(deck_t), intent(inout) :: deck
    type(block_t), intent(in) :: change
    type(block_t), allocatable :: more(:)
    integer :: b

    allocate (more(deck%n + 1))
    do b = 1, deck%n
      call move_block(deck%blocks(b), more(b))
    end do
    more(deck%n + 1) = change
    more(deck%n + 1)%parent = 0
    call move_alloc(more, deck%blocks)
    deck%n = deck%n + 1
  end subroutine add_block

  !> Lay the values of a stage over those of a block.
  subroutine change_values(deck, change, block)
    type(deck_t), intent(inout) :: deck
    type(block_t), intent(in) :: change
    integer, intent(in) :: block
    integer :: v

    do v = 1, change%n
      call deck%put(block, change%values(v))
    end do
  end subroutine change_values

  !> Change the law or the container that a stage names, or the only one.
  subroutine change_named(deck, change, section, diagnostics)
    type(deck_t), intent(inout) :: deck
    type(block_t), intent(in) :: change
    character(len=*), intent(in) :: section
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: b, v

    v = place_of_key(deck, change, 'name')
    do b = 1, deck%n
      if (.not. deck%is_in(b, section)) cycle
      if (v == 0) then
        if (deck%count_of(section) > 1) exit
      else if (deck%word(b, 'name') /= change%values(v)%words(1)%s) then
        cycle
      end if
      call change_values(deck, change, b)
      return
    end do
    if (v > 0) then
      call deck%complain_at(diagnostics, 'there is no '//section//' named "'//change%values(v)%words(1)%s//'"', &
                            change%values(v)%line, change%values(v)%column)
    else if (deck%count_of(section) == 0) then
      call deck%complain_at(diagnostics, 'there is no '//section, change%line, change%column)
    else
      call deck%complain_at(diagnostics, '[[stage.'//section//']] lacks the key "name": there are several '//section//'s', &
                            change%line, change%column)
    end if
  end subroutine change_named

  !> Drop drives, pressures and gravity of the deck that those of the stage replace.
  subroutine drop_replaced(deck)
    type(deck_t), intent(inout) :: deck
    logical :: is_kept(deck%n)
    integer :: b, c

    is_kept = .true.
    do b = 1, deck%n
      if (.not. deck%blocks(b)%is_of_stage) cycle
      do c = 1, deck%n
        if (deck%blocks(c)%section /= deck%blocks(b)%section .or. deck%blocks(c)%is_of_stage) cycle
        if (.not. deck%is_in(b, 'gravity')) then
          if (.not. matches(deck%word(c, 'body'), deck%word(b, 'body'))) cycle
        else if (deck%word(b, 'component') /= deck%word(c, 'component')) then
          cycle
        end if
        if (deck%is_in(b, 'drive')) then
          if (deck%word(b, 'component') /= deck%word(c, 'component') .or. deck%word(b, 'kind') /= deck%word(c, 'kind')) cycle
        end if
        is_kept(c) = .false.
      end do
    end do
    if (.not. all(is_kept)) call keep_blocks(deck, is_kept)
  end subroutine drop_replaced

  !> Make the conditions of a stage those of the run.
  subroutine take_conditions(deck, block)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: block
    type(value_t) :: value
    character(len=*), parameter :: keys(3) = [character(len=5) :: 'until', 'for', 'after'], &
                                   stop_keys(3) = [character(len=5) :: 'when', 'for', 'after']
    integer :: i, b

    b = deck%block_of('stop')
    do i = 1, size(keys)
      if (.not. deck%is_given(block, trim(keys(i)))) cycle
      value = deck%value(block, trim(keys(i)))
      value%key = deck%table%find_key(deck%blocks(b)%section, trim(stop_keys(i)))
      call deck%put(b, value)
    end do
  end subroutine take_conditions
end module sg_stage_deck
