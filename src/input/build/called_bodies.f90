!> Bodies that blocks of a deck call by name, by a pattern of names or by number.
module sg_called_bodies
  use sg_ascending, only: distinct
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: i4
  use sg_local_numbers, only: local_body
  use sg_named_bodies, only: number_named
  use sg_scene, only: scene_t
  use sg_text, only: nearest_word, text_t, to_text
  use sg_values, only: value_t
  use sg_wildcards, only: has_wildcard, matches
  implicit none
  private
  public :: add_bodies, add_called, body_of, count_called, find_called, numbers_called

contains

  !> Numbers of the bodies that a deck calls, by number or by name, ascending, each once.
  subroutine numbers_called(deck, called)
    type(deck_t), intent(in) :: deck !! checked deck
    integer(i4), allocatable, intent(out) :: called(:) !! numbers, positive
    integer(i4), allocatable :: found(:)
    type(value_t) :: value
    character(len=*), parameter :: keys(3) = [character(len=7) :: 'body', 'between', 'bodies']
    integer :: b, k, i, number, status

    allocate (found(0))
    do b = 1, deck%n
      ! Links join the bodies of a chain.
      if (deck%is_in(b, 'chain')) found = [found, [(int(i, i4), i=deck%blocks(b)%first_body, deck%blocks(b)%last_body)]]
      do k = 1, size(keys)
        if (.not. (deck%is_in(b, 'drive') .or. deck%is_in(b, 'pressure') .or. deck%is_in(b, 'wall') .or. &
                   deck%is_in(b, 'link') .or. deck%is_in(b, 'joint'))) cycle
        if (.not. deck%is_given(b, trim(keys(k)))) cycle
        value = deck%value(b, trim(keys(k)))
        do i = 1, value%n_words
          if (index(value%words(i)%s, '#') == 1) then
            read (value%words(i)%s(2:), *, iostat=status) number
            if (status == 0 .and. number > 0) found = [found, int(number, i4)]
          else
            call add_matches(deck, value%words(i)%s, found)
          end if
        end do
      end do
    end do
    called = distinct(found)
  end subroutine numbers_called

  !> Find the bodies that the key `body` of a block calls, by name, by a pattern of names or by number; none after a mistake.
  subroutine find_called(deck, b, scene, bodies, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck with its names
    integer, intent(in) :: b !! block
    type(scene_t), intent(in) :: scene !! scene with its bodies
    integer, allocatable, intent(out) :: bodies(:) !! places of the bodies in the scene
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer(i4), allocatable :: numbers(:)
    integer :: i

    allocate (numbers(0))
    call add_bodies(deck, b, scene%bodies%n + deck%absent%n, numbers, diagnostics)
    bodies = [(local_body(scene%bodies, numbers(i)), i=1, size(numbers))]
    bodies = pack(bodies, bodies > 0)
  end subroutine find_called

  !> Most bodies that the blocks of a section call: for each block those of its pattern, and at least one.
  integer function count_called(deck, section) result(n)
    type(deck_t), intent(in) :: deck !! checked deck with its names
    character(len=*), intent(in) :: section !! name of the section
    integer(i4), allocatable :: numbers(:)
    integer :: b

    n = 0
    do b = 1, deck%n
      if (.not. deck%is_in(b, section)) cycle
      allocate (numbers(0))
      call add_matches(deck, deck%word(b, 'body'), numbers)
      n = n + max(1, size(numbers))
      deallocate (numbers)
    end do
  end function count_called

  !> Body that a deck means by a word: a name, or `#` and a number; 0 after a mistake.
  integer function body_of(deck, b, key, word, scene, diagnostics) result(body)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block with the word
    character(len=*), intent(in) :: key !! key of the word
    character(len=*), intent(in) :: word !! name or number
    type(scene_t), intent(in) :: scene !! scene with its bodies
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: status

    if (word(1:min(1, len(word))) == '#') then
      read (word(2:), *, iostat=status) body
      if (status == 0) body = local_body(scene%bodies, int(body, i4))
      if (status == 0 .and. body > 0) return
      call deck%complain(diagnostics, 'there is no body '//word(2:)//': the scene has '// &
                         to_text(scene%bodies%n + deck%absent%n), b, key)
    else
      body = number_named(deck, word)
      if (body > 0) body = local_body(scene%bodies, int(body, i4))
      if (body > 0) return
      if (allocated(deck%names)) then
        call deck%complain_unknown(diagnostics, 'body', word, deck%names, b, key)
      else
        call deck%complain_unknown(diagnostics, 'body', word, [text_t ::], b, key)
      end if
    end if
    body = 0
  end function body_of

  !> Add the numbers of the bodies whose names match a pattern.
  pure subroutine add_matches(deck, pattern, found)
    type(deck_t), intent(in) :: deck !! deck with its names
    character(len=*), intent(in) :: pattern !! name, with wildcards or without
    integer(i4), allocatable, intent(inout) :: found(:) !! numbers to add to
    integer :: i

    if (.not. allocated(deck%names)) return
    do i = 1, size(deck%names)
      if (matches(deck%names(i)%s, pattern)) found = [found, int(deck%named(i), i4)]
    end do
  end subroutine add_matches

  !> Add the bodies that the key `body` of a block calls by number, by name or by a pattern of names.
  subroutine add_bodies(deck, b, bodies, found, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck with its names
    integer, intent(in) :: b !! block
    integer, intent(in) :: bodies !! of the whole scene
    integer(i4), allocatable, intent(inout) :: found(:) !! numbers to add to
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(value_t) :: value

    value = deck%value(b, 'body')
    call add_called(deck, b, 'body', value%words(1)%s, bodies, found, diagnostics)
  end subroutine add_bodies

  !> Add the bodies that a word calls: `#` and a number, a name, or a pattern of names.
  subroutine add_called(deck, b, key, word, bodies, found, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck with its names
    integer, intent(in) :: b !! block with the word
    character(len=*), intent(in) :: key !! key of the word
    character(len=*), intent(in) :: word !! name, pattern or number
    integer, intent(in) :: bodies !! of the whole scene
    integer(i4), allocatable, intent(inout) :: found(:) !! numbers to add to
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: number, status, n

    n = size(found)
    if (word(1:min(1, len(word))) == '#') then
      read (word(2:), *, iostat=status) number
      if (status /= 0) number = 0
      if (number >= 1 .and. number <= bodies) then
        found = [found, int(number, i4)]
      else
        call deck%complain(diagnostics, 'there is no body '//word(2:)//': the scene has '//to_text(bodies), b, key)
      end if
      return
    end if
    call add_matches(deck, word, found)
    if (size(found) == n) call complain_of_none(deck, b, key, word, diagnostics)
  end subroutine add_called

  !> Report a name or a pattern that no body has, with the nearest name.
  subroutine complain_of_none(deck, b, key, word, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    character(len=*), intent(in) :: key, word
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: near
    logical :: has_names

    has_names = allocated(deck%names)
    if (has_names) has_names = size(deck%names) > 0
    if (.not. has_names) then
      call deck%complain(diagnostics, 'there is no body named "'//word//'": no body of this scene has a name, give its number', &
                         b, key)
    else if (has_wildcard(word)) then
      near = nearest_word(word, deck%names)
      if (near /= '') near = '; the nearest one is "'//near//'"'
      call deck%complain(diagnostics, 'no body has a name that matches "'//word//'"'//near, b, key)
    else
      call deck%complain_unknown(diagnostics, 'body', word, deck%names, b, key)
    end if
  end subroutine complain_of_none
end module sg_called_bodies
