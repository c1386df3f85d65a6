!> The value of one key: taken from the entries of a TOML text, checked against the key table, written as TOML.
module sg_values
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_key_table, only: key_t, value_bodies, value_body, value_box, value_choice, value_counts, value_faces, value_function, &
                          value_integer, value_logical, value_moment, value_name, value_pair, value_pairs, value_points, &
                          value_range, value_real, value_sides, value_text, value_texts, value_triple, value_turn, value_vector
  use sg_kinds, only: wp, i4, i8
  use sg_lists, only: reserve
  use sg_text, only: joined, nearest_word, text_t, to_text
  use sg_toml, only: entry_t, toml_array, toml_integer, toml_logical, toml_names, toml_real, toml_string
  use sg_words, only: choice_index, is_choice, list_choices, quoted_string, short_real
  implicit none
  private
  public :: value_t, take_entry, finish_value, value_as_toml
  public :: from_nowhere, from_default, from_deck, from_setting

  !> Where a value comes from: not given, the key table, the deck, a `--set`
  integer, parameter :: from_nowhere = 0, from_default = 1, from_deck = 2, from_setting = 3

  !> Numbers beyond these in size would overflow in masses and moments, themselves or their inverses
  real(wp), parameter :: largest = 1e50_wp, smallest = 1e-50_wp

  !> The value of one key
  type :: value_t
    !> Line of the key table that it belongs to
    integer :: key = 0
    !> Where it comes from, one of `from_*`
    integer :: origin = from_nowhere
    !> The word of the deck where that is a former one, replaced by the present one
    character(len=:), allocatable :: former
    !> Was a mistake in it reported?
    logical :: is_bad = .false.
    !> Place of the value in the deck
    integer :: line = 0, column = 0
    !> Numbers, in the order of the text: shape (n); a logical is 1 or 0
    real(wp), allocatable :: numbers(:)
    integer :: n = 0
    !> Words (text, choice, name): shape (n_words), and line and column of each, shape (2, n_words)
    type(text_t), allocatable :: words(:)
    integer, allocatable :: word_places(:, :)
    integer :: n_words = 0
    !> Was it written as a list? Lists in it: how many, and how many numbers stand before each, shape (n_lists)
    logical :: is_list = .false.
    integer :: n_lists = 0
    integer(i4), allocatable :: before(:)
  end type value_t

contains

  !> Take one more entry of a key's value: the value itself, or an element of it.
  subroutine take_entry(value, key, entry, depth, message)
    type(value_t), intent(inout) :: value !! value to add to
    type(key_t), intent(in) :: key !! its line of the key table
    type(entry_t), intent(in) :: entry !! what the text holds
    integer, intent(in) :: depth !! 0 for the value itself, 1 for an element, 2 for an element of an element
    character(len=:), allocatable, intent(out) :: message !! what is wrong, unallocated when nothing is

    if (depth == 0) then
      value%line = entry%line
      value%column = entry%column
    end if
    if (.not. may_hold(key%kind, entry%kind, depth)) then
      ! An integer beyond what TOML holds comes as a real: it is too large before anything else.
      if (key%kind == value_integer .and. entry%kind == toml_real) call check_number(key, entry, message)
      if (allocated(message)) return
      message = 'must be '//value_name(key%kind, 0)//', not '//what_is(entry%kind, depth)
      if (key%kind == value_choice) message = 'must be one of '//listed(key%choices)//', not '//what_is(entry%kind, depth)
      return
    end if
    select case (entry%kind)
    case (toml_array)
      value%is_list = .true.
      if (depth == 1) then
        value%n_lists = value%n_lists + 1
        call reserve(value%before, value%n_lists)
        value%before(value%n_lists) = int(value%n, i4)
      end if
    case (toml_string)
      call add_word(value, present_word(entry%text, trim(key%former), value%former), [entry%line, entry%column])
    case default
      if (key%kind == value_body .or. key%kind == value_bodies) then
        call add_word(value, '#'//to_text(entry%integer), [entry%line, entry%column])
        return
      end if
      call check_number(key, entry, message)
      if (allocated(message)) return
      call add_number(value, merge(real(entry%integer, wp), entry%real, entry%kind == toml_logical))
    end select
  end subroutine take_entry

  !> The present word for a word of a deck.
  function present_word(word, rule, former) result(present)
    character(len=*), intent(in) :: word
    character(len=*), intent(in) :: rule !! `former=present`, or nothing
    character(len=:), allocatable, intent(out) :: former !! the word where it is a former one
    character(len=:), allocatable :: present

    present = word
    if (index(rule, word//'=') /= 1) return
    former = word
    present = rule(len(word) + 2:)
  end function present_word

  !> May an entry of this kind stand at this depth of a value of this kind?
  pure logical function may_hold(kind, entry_kind, depth) result(may)
    integer, intent(in) :: kind, entry_kind, depth
    logical :: number

    number = entry_kind == toml_integer .or. entry_kind == toml_real
    select case (kind)
    case (value_integer)
      may = entry_kind == toml_integer .and. depth == 0
    case (value_real)
      may = number .and. depth == 0
    case (value_logical)
      may = entry_kind == toml_logical .and. depth == 0
    case (value_text, value_choice)
      may = entry_kind == toml_string .and. depth == 0
    case (value_texts)
      may = (depth == 0 .and. entry_kind == toml_array) .or. (depth <= 1 .and. entry_kind == toml_string)
    case (value_function, value_moment)
      may = depth == 0 .and. (number .or. entry_kind == toml_string)
    case (value_turn)
      may = (depth == 0 .and. entry_kind == toml_array) .or. (depth <= 1 .and. number)
    case (value_faces)
      may = (depth <= 1 .and. entry_kind == toml_array) .or. (depth == 2 .and. entry_kind == toml_integer)
    case (value_pair, value_box, value_vector, value_triple)
      may = (depth == 0 .and. entry_kind == toml_array) .or. (depth == 1 .and. number)
    case (value_range)
      may = (depth == 0 .and. entry_kind == toml_array) .or. (depth <= 1 .and. number)
    case (value_sides, value_counts)
      may = (depth == 0 .and. entry_kind == toml_array) .or. (depth <= 1 .and. entry_kind == toml_integer)
    case (value_points, value_pairs)
      may = (depth <= 1 .and. entry_kind == toml_array) .or. (depth == 2 .and. number)
    case (value_body)
      may = depth == 0 .and. (entry_kind == toml_string .or. entry_kind == toml_integer)
    case (value_bodies)
      may = (depth == 0 .and. entry_kind == toml_array) .or. &
            (depth == 1 .and. (entry_kind == toml_string .or. entry_kind == toml_integer))
    case default
      may = .false.
    end select
  end function may_hold

  !> What was found, for a message.
  pure function what_is(kind, depth) result(words)
    integer, intent(in) :: kind, depth
    character(len=:), allocatable :: words

    words = trim(toml_names(kind))
    if (depth > 0) words = words//' in it'
  end function what_is

  !> Is a number finite, within its range, and not too large for a whole number?
  subroutine check_number(key, entry, message)
    type(key_t), intent(in) :: key
    type(entry_t), intent(in) :: entry
    character(len=:), allocatable, intent(inout) :: message

    if (entry%kind == toml_logical) return
    if (.not. ieee_is_finite(entry%real)) then
      message = 'must be a finite number'
    else if (abs(entry%real) > 2e9_wp .and. &
             any(key%kind == [value_integer, value_sides, value_counts, value_faces])) then
      message = 'is too large in size: it must be between -2000000000 and 2000000000'
    else if (abs(entry%real) > largest .or. (abs(entry%real) > 0 .and. abs(entry%real) < smallest)) then
      message = 'must be 0 or between '//short_real(smallest)//' and '//short_real(largest)//' in size'
    else if (key%highest <= key%lowest .and. abs(entry%real - key%lowest) > 0) then
      message = 'must be '//bound(key, key%lowest)
    else if (key%is_open .and. entry%real <= key%lowest) then
      message = 'must be larger than '//bound(key, key%lowest)
    else if (entry%real < key%lowest) then
      message = 'must be at least '//bound(key, key%lowest)
    else if (entry%real > key%highest) then
      message = 'must be at most '//bound(key, key%highest)
      if (key%why_highest /= '') message = message//', '//trim(key%why_highest)
    end if
  end subroutine check_number

  !> A bound as a word: `0`, `0.5`.
  pure function bound(key, number) result(word)
    type(key_t), intent(in) :: key
    real(wp), intent(in) :: number
    character(len=:), allocatable :: word

    word = short_real(number)
    if (abs(number - anint(number)) <= 0) word = to_text(nint(number))
    if (key%unit /= '') word = word//' '//trim(key%unit)
  end function bound

  !> Add a number; most values hold one or two.
  subroutine add_number(value, number)
    type(value_t), intent(inout) :: value
    real(wp), intent(in) :: number
    real(wp), allocatable :: grown(:)

    if (.not. allocated(value%numbers)) allocate (value%numbers(2))
    if (value%n == size(value%numbers)) then
      allocate (grown(2*value%n))
      grown(:value%n) = value%numbers
      call move_alloc(grown, value%numbers)
    end if
    value%n = value%n + 1
    value%numbers(value%n) = number
  end subroutine add_number

  !> Add a word; most values hold one or two.
  subroutine add_word(value, word, place)
    type(value_t), intent(inout) :: value
    character(len=*), intent(in) :: word
    integer, intent(in) :: place(2)
    type(text_t), allocatable :: more(:)
    integer, allocatable :: places(:, :)
    integer :: i

    if (.not. allocated(value%words)) allocate (value%words(2), value%word_places(2, 2))
    if (value%n_words == size(value%words)) then
      allocate (more(2*value%n_words), places(2, 2*value%n_words))
      do i = 1, value%n_words
        call move_alloc(value%words(i)%s, more(i)%s)
      end do
      places(:, :value%n_words) = value%word_places
      call move_alloc(more, value%words)
      call move_alloc(places, value%word_places)
    end if
    value%n_words = value%n_words + 1
    value%words(value%n_words)%s = word
    value%word_places(:, value%n_words) = place
  end subroutine add_word

  !> Check a value of which all entries are taken: number of elements, choice.
  subroutine finish_value(value, key, dimension, message)
    type(value_t), intent(in) :: value !! value to check
    type(key_t), intent(in) :: key !! its line of the key table
    integer, intent(in) :: dimension !! of the scene; 0 where it is not known yet
    character(len=:), allocatable, intent(out) :: message !! what is wrong, unallocated when nothing is
    integer :: i

    if (dimension > 0) then
      if (.not. has_right_count(value, key%kind, dimension)) message = 'must be '//value_name(key%kind, dimension)
    else if (.not. (has_right_count(value, key%kind, 2) .or. has_right_count(value, key%kind, 3))) then
      message = 'must be '//value_name(key%kind, 0)
    end if
    if (any(key%kind == [value_text, value_texts, value_moment]) .and. .not. allocated(message)) then
      if (any([(value%words(i)%s == '', i=1, value%n_words)])) message = 'must not be empty'
    end if
    if (key%kind == value_choice) call check_choice(value%words(1)%s, key, dimension, message)
    if ((key%kind == value_range .or. key%kind == value_sides) .and. value%n == 2) then
      if (value%numbers(2) < value%numbers(1)) message = 'must have the smaller number first'
    end if
  end subroutine finish_value

  !> Has a value as many elements as it must have?
  pure logical function has_right_count(value, kind, dimension) result(fits)
    type(value_t), intent(in) :: value
    integer, intent(in) :: kind, dimension

    select case (kind)
    case (value_pair)
      fits = value%n == 2
    case (value_triple)
      fits = value%n == 3
    case (value_vector)
      fits = value%n == dimension
    case (value_turn)
      fits = value%n == merge(1, 3, dimension == 2) .and. (value%is_list .eqv. dimension == 3)
    case (value_box)
      fits = value%n == 2*dimension
    case (value_range, value_sides)
      fits = value%n == 1 .or. value%n == 2
    case (value_points)
      fits = value%n == dimension*value%n_lists .and. value%n > 0
      if (fits) fits = all(value%before(2:value%n_lists) - value%before(:value%n_lists - 1) == dimension)
    case (value_pairs)
      fits = value%n == 2*value%n_lists .and. value%n > 0
      if (fits) fits = all(value%before(2:value%n_lists) - value%before(:value%n_lists - 1) == 2)
    case (value_faces, value_counts)
      fits = value%n > 0
    case (value_bodies)
      fits = value%n_words == 2
    case (value_texts)
      fits = value%n_words > 0
    case default
      fits = .true.
    end select
  end function has_right_count

  !> Is a word one of the choices that there are in this dimension?
  subroutine check_choice(word, key, dimension, message)
    character(len=*), intent(in) :: word
    type(key_t), intent(in) :: key
    integer, intent(in) :: dimension
    character(len=:), allocatable, intent(inout) :: message
    character(len=:), allocatable :: here, there, near
    type(text_t), allocatable :: words(:)
    integer :: position

    here = trim(key%choices)
    there = trim(key%space_choices)
    if (there /= '' .and. dimension == 0) here = here//'|'//there
    if (there /= '' .and. dimension == 3) then
      here = trim(key%space_choices)
      there = trim(key%choices)
    end if
    if (is_choice(word, here)) return
    message = bad_choice(word, here)
    if (dimension == 0 .or. .not. is_choice(word, there)) return
    ! Shapes stand in one order in both dimensions.
    position = choice_index(word, there)
    message = 'must be one of '//listed(here)//'; "'//word//'" is for scenes with dimension = '//to_text(5 - dimension)
    call list_choices(here, words)
    near = nearest_word(word, words)
    if (near == '') near = words(min(position, size(words)))%s
    message = message//'; did you mean "'//near//'"?'
  end subroutine check_choice

  !> Message for an unknown word.
  pure function bad_choice(word, choices) result(message)
    character(len=*), intent(in) :: word, choices
    character(len=:), allocatable :: message
    type(text_t), allocatable :: words(:)
    character(len=:), allocatable :: near

    call list_choices(choices, words)
    near = nearest_word(word, words)
    message = 'must be one of '//listed(choices)//', not "'//word//'"'
    if (near /= '') message = message//'; did you mean "'//near//'"?'
  end function bad_choice

  !> Choices with commas.
  pure function listed(choices)
    character(len=*), intent(in) :: choices
    character(len=:), allocatable :: listed
    type(text_t), allocatable :: words(:)
    integer :: i

    call list_choices(choices, words)
    listed = words(1)%s
    do i = 2, size(words)
      listed = listed//', '//words(i)%s
    end do
  end function listed

  !> A value as TOML text.
  function value_as_toml(value, key) result(text)
    type(value_t), intent(in) :: value !! value to write
    type(key_t), intent(in) :: key !! its line of the key table
    character(len=:), allocatable :: text

    select case (key%kind)
    case (value_logical)
      text = trim(merge('true ', 'false', value%numbers(1) > 0))
    case (value_text, value_choice)
      text = quoted_string(value%words(1)%s)
    case (value_texts)
      text = joined(quoted_words(value), ', ')
      if (value%is_list) text = '['//text//']'
    case (value_body)
      text = body_word(value%words(1)%s)
    case (value_bodies)
      text = '['//body_word(value%words(1)%s)//', '//body_word(value%words(2)%s)//']'
    case (value_points, value_pairs, value_faces)
      text = '['//joined(list_words(value, key), ', ')//']'
    case default
      text = joined(list_words(value, key), ', ')
      if (value%is_list) text = '['//text//']'
      ! An expression in place of a number
      if (value%n_words > 0) text = quoted_string(value%words(1)%s)
    end select
  end function value_as_toml

  !> The words of a value as TOML text.
  function quoted_words(value) result(words)
    type(value_t), intent(in) :: value
    type(text_t), allocatable :: words(:)
    integer :: i

    allocate (words(value%n_words))
    do i = 1, value%n_words
      words(i)%s = quoted_string(value%words(i)%s)
    end do
  end function quoted_words

  !> The numbers of a value as TOML text, one a word, with the brackets of the lists that begin or end there.
  function list_words(value, key) result(words)
    type(value_t), intent(in) :: value
    type(key_t), intent(in) :: key
    type(text_t), allocatable :: words(:)
    integer :: i, list

    allocate (words(value%n))
    do i = 1, value%n
      words(i)%s = number_word(value%numbers(i), key)
    end do
    if (.not. any(key%kind == [value_points, value_pairs, value_faces])) return
    do list = 1, value%n_lists
      i = int(value%before(list)) + 1
      if (i <= value%n) words(i)%s = '['//words(i)%s
      if (i > 1) words(i - 1)%s = words(i - 1)%s//']'
    end do
    if (value%n > 0) words(value%n)%s = words(value%n)%s//']'
  end function list_words

  !> One number as TOML text.
  function number_word(number, key) result(word)
    real(wp), intent(in) :: number
    type(key_t), intent(in) :: key
    character(len=:), allocatable :: word

    if (any(key%kind == [value_integer, value_sides, value_counts, value_faces])) then
      word = to_text(nint(number, i8))
    else
      word = short_real(number)
    end if
  end function number_word

  !> A body as TOML text: its name, or its number (kept as `#number`).
  function body_word(word) result(text)
    character(len=*), intent(in) :: word
    character(len=:), allocatable :: text

    text = quoted_string(word)
    if (word(1:min(1, len(word))) == '#') text = word(2:)
  end function body_word
end module sg_values
