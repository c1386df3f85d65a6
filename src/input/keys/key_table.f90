!> What a deck may hold: the types of the key table, and how a line of it is written and found.
!!
!! The table itself stands in keys_*.f90, every key once. From it come the checks, the defaults, the effective
!! deck and the reference.
module sg_key_table
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_kinds, only: wp
  use sg_options, only: option_t, option_visitor_t
  use sg_text, only: nearest_word, text_t, to_text
  use sg_words, only: quoted_string, short_real, true_or_false
  implicit none
  private
  public :: key_t, section_t, key_table_t, value_name
  public :: value_integer, value_real, value_logical, value_text, value_choice, value_pair, value_range, value_box, &
            value_points, value_sides, value_body, value_bodies, value_vector, value_turn, value_triple, value_faces, &
            value_counts, value_texts, value_function, value_pairs, value_moment
  public :: in_both, in_plane, in_space

  !> What a value may be: whole number, number, true or false, free text, one of several words, two numbers, one or two
  !> numbers (low and high), a box, a list of points, one or two whole numbers, a body (name or number), two bodies, a
  !> vector, what is a number in the plane and a vector in space (spin), three numbers, lists of whole numbers, one or more
  !> whole numbers, one or more texts, a number or an expression of time, a list of pairs of numbers, a time or the
  !> name of a stage
  integer, parameter :: value_integer = 1, value_real = 2, value_logical = 3, value_text = 4, value_choice = 5, &
                        value_pair = 6, value_range = 7, value_box = 8, value_points = 9, value_sides = 10, &
                        value_body = 11, value_bodies = 12, value_vector = 13, value_turn = 14, value_triple = 15, &
                        value_faces = 16, value_counts = 17, value_texts = 18, value_function = 19, value_pairs = 20, &
                        value_moment = 21
  !> Words for them in the plane, as in the reference and in messages
  character(len=29), parameter :: plane_names(21) = [character(len=29) :: 'an integer', 'a number', 'true or false', &
    'a string', 'one of the words', 'a list of 2 numbers', 'a number or a list of 2', 'a list of 4 numbers', &
    'a list of [x, y]', 'an integer or a list of 2', 'the name or number of a body', 'a list of 2 bodies', &
    'a list of 2 numbers', 'a number', 'a list of 3 numbers', 'a list of lists of integers', &
    'an integer or a list of them', 'a string or a list of them', 'a number or an expression', 'a list of lists of 2 numbers', &
    'a time or the name of a stage']
  !> Words for them in space
  character(len=29), parameter :: space_names(21) = [character(len=29) :: plane_names(:7), 'a list of 6 numbers', &
    'a list of [x, y, z]', plane_names(10:12), 'a list of 3 numbers', 'a list of 3 numbers', plane_names(15:21)]

  !> Where a key or a section has a meaning: in scenes of both dimensions, of two, of three
  integer, parameter :: in_both = 0, in_plane = 2, in_space = 3

  !> Angles beyond a full turn are hardly meant [rad]; rounded up, so that 6.3 is accepted
  real(wp), parameter :: full_turn = 6.3_wp

  !> One key of the table
  type :: key_t
    !> Section and name
    character(len=24) :: section = '', name = ''
    !> Kind of value, one of `value_*`
    integer :: kind = 0
    !> Unit, empty for none
    character(len=24) :: unit = ''
    !> Default as TOML text, empty when there is none, and where it is another one in space
    character(len=24) :: default = '', space_default = ''
    !> Dimension in which it has a meaning, one of `in_*`, and the key to use instead in the other
    integer :: dimension = in_both
    character(len=24) :: twin = ''
    !> Must it be given (where it applies)?
    logical :: is_required = .false.
    !> Range of each number; `lowest` itself is out of it when `is_open`
    real(wp) :: lowest = -huge(1.0_wp), highest = huge(1.0_wp)
    logical :: is_open = .false.
    !> Why numbers above `highest` are refused; empty where that needs no words
    character(len=72) :: why_highest = ''
    !> Words to choose from, with a bar between two; where `space_choices` is not empty, `choices` are those of the plane
    character(len=400) :: choices = '', space_choices = ''
    !> A former word, still read with a note, and the present one: `former=present`
    character(len=48) :: former = ''
    !> The key of older decks that this one replaces, still read with a note: `section.key`, empty for none
    character(len=48) :: former_key = ''
    !> When it applies: another key of the section, empty for always, and its words for which it does; without words the other key
    !! must be given
    character(len=24) :: selector = ''
    character(len=400) :: only = ''
    !> When it has an effect: another key of the section, or of the one around it, empty for always, and its words for which it
    !! has. Else it is ignored, with a warning
    character(len=24) :: switch = ''
    character(len=48) :: used_for = ''
    !> Size above which a number is probably a mistake, and a hint at what was meant
    real(wp) :: usual = huge(1.0_wp)
    character(len=100) :: hint = ''
    !> What it is, one sentence
    character(len=480) :: sentence = ''
  end type key_t

  !> One section of the table
  type :: section_t
    !> Name; a section within another is `outer.inner`
    character(len=24) :: name = ''
    !> Is it a list of blocks, `[[name]]`?
    logical :: is_list = .false.
    !> Dimension in which it has a meaning, one of `in_*`
    integer :: dimension = in_both
    !> What it is, one sentence
    character(len=400) :: sentence = ''
    !> When its keys have an effect, as in `key_t`; empty for always
    character(len=48) :: used_for = ''
    !> Its keys in the table: first and last
    integer :: first = 1, last = 0
  end type section_t

  !> The whole table
  type, extends(option_visitor_t) :: key_table_t
    type(section_t), allocatable :: sections(:)
    !> Keys; while the table is filled there is room for more, which `finish` takes away
    type(key_t), allocatable :: keys(:)
    !> Number of keys added
    integer :: n_keys = 0
  contains
    procedure :: integer_option
    procedure :: real_option
    procedure :: flag_option
    procedure :: word_option
    procedure :: open_section
    procedure :: close_section
    procedure :: finish
    procedure :: add
    procedure :: find_section
    procedure :: find_key
    procedure :: find_former
    procedure :: nearest_key
    procedure :: nearest_section
  end type key_table_t

contains

  !> Begin a section; the keys added next belong to it.
  subroutine open_section(self, name, sentence, is_list, dimension, used_for)
    class(key_table_t), intent(inout) :: self
    character(len=*), intent(in) :: name !! name of the section
    character(len=*), intent(in) :: sentence !! what it is
    logical, intent(in), optional :: is_list !! is it written `[[name]]`?
    integer, intent(in), optional :: dimension !! where it has a meaning, one of `in_*`
    character(len=*), intent(in), optional :: used_for !! when its keys are looked at, `key=word|word`
    type(section_t) :: section

    if (.not. allocated(self%sections)) allocate (self%sections(0), self%keys(0))
    call put(section%name, name)
    call put(section%sentence, sentence)
    if (present(is_list)) section%is_list = is_list
    if (present(dimension)) section%dimension = dimension
    if (present(used_for)) call put(section%used_for, used_for)
    section%first = self%n_keys + 1
    section%last = self%n_keys
    self%sections = [self%sections, section]
  end subroutine open_section

  !> Take the section opened last away again: it has no key.
  subroutine close_section(self)
    class(key_table_t), intent(inout) :: self

    self%sections = self%sections(:size(self%sections) - 1)
  end subroutine close_section

  !> Add a key to the section opened last.
  subroutine add(self, name, kind, sentence, unit, default, is_required, least, above, most, choices, only, space_default, &
                 space_choices, former, former_key, dimension, twin, why_most, used_for, usual, hint)
    class(key_table_t), intent(inout) :: self
    character(len=*), intent(in) :: name !! name of the key
    integer, intent(in) :: kind !! kind of value
    character(len=*), intent(in) :: sentence !! what it is
    character(len=*), intent(in), optional :: unit !! unit
    character(len=*), intent(in), optional :: default !! default as TOML text
    logical, intent(in), optional :: is_required !! must it be given?
    real(wp), intent(in), optional :: least !! smallest number allowed
    real(wp), intent(in), optional :: above !! numbers must be larger than this
    real(wp), intent(in), optional :: most !! largest number allowed
    character(len=*), intent(in), optional :: choices !! words to choose from
    character(len=*), intent(in), optional :: only !! when it applies, `key=word|word`, or `key` that must be given
    character(len=*), intent(in), optional :: space_default !! default in space, where it is another
    character(len=*), intent(in), optional :: space_choices !! words to choose from in space, where they are others
    character(len=*), intent(in), optional :: former !! a word of older decks and what it is now, `former=present`
    character(len=*), intent(in), optional :: former_key !! the key of older decks, `section.key`
    integer, intent(in), optional :: dimension !! where it has a meaning, one of `in_*`
    character(len=*), intent(in), optional :: twin !! key to use in its place in the other dimension
    character(len=*), intent(in), optional :: why_most !! why larger numbers are refused
    character(len=*), intent(in), optional :: used_for !! when it is looked at, `key=word|word`
    real(wp), intent(in), optional :: usual !! size above which a number is probably a mistake
    character(len=*), intent(in), optional :: hint !! what was probably meant then
    type(key_t) :: key

    associate (section => self%sections(size(self%sections)))
      key%section = section%name
      section%last = self%n_keys + 1
      call put_condition(trim(section%used_for), key%switch, key%used_for)
    end associate
    call put(key%name, name)
    key%kind = kind
    call put(key%sentence, sentence)
    if (present(unit)) call put(key%unit, unit)
    if (present(default)) call put(key%default, default)
    if (present(is_required)) key%is_required = is_required
    if (present(least)) key%lowest = least
    if (present(above)) key%lowest = above
    key%is_open = present(above)
    if (present(most)) key%highest = most
    if (present(why_most)) call put(key%why_highest, why_most)
    if (present(choices)) call put(key%choices, choices)
    if (present(space_default)) call put(key%space_default, space_default)
    if (present(space_choices)) call put(key%space_choices, space_choices)
    if (present(former)) call put(key%former, former)
    if (present(former_key)) call put(key%former_key, former_key)
    if (present(dimension)) key%dimension = dimension
    if (present(twin)) call put(key%twin, twin)
    if (present(only)) call put_condition(only, key%selector, key%only)
    if (present(used_for)) call put_condition(used_for, key%switch, key%used_for)
    if (key%unit == 'rad') then
      key%usual = full_turn
      key%hint = 'angles are in radians: 45 degrees are 0.785'
    end if
    if (present(usual)) key%usual = usual
    if (present(hint)) call put(key%hint, hint)
    if (self%n_keys == size(self%keys)) call resize(self, max(32, 2*self%n_keys))
    self%n_keys = self%n_keys + 1
    self%keys(self%n_keys) = key
  end subroutine add

  !> End the table: it has no room beyond its last key.
  subroutine finish(self)
    class(key_table_t), intent(inout) :: self

    call resize(self, self%n_keys)
  end subroutine finish

  !> Change the room for keys. It doubles while the table is filled: hundreds of keys of 2 kB are not copied for each one added.
  subroutine resize(table, n)
    class(key_table_t), intent(inout) :: table
    integer, intent(in) :: n
    type(key_t), allocatable :: keys(:)

    allocate (keys(n))
    keys(:table%n_keys) = table%keys(:table%n_keys)
    call move_alloc(keys, table%keys)
  end subroutine resize

  !> Add a whole number of a method, whose value is the default, as key.
  subroutine integer_option(self, option, value)
    class(key_table_t), intent(inout) :: self
    type(option_t), intent(in) :: option !! its key
    integer, intent(inout) :: value !! component of the method

    call add_option(self, option, value_integer, to_text(value))
  end subroutine integer_option

  !> Add a number of a method as key.
  subroutine real_option(self, option, value)
    class(key_table_t), intent(inout) :: self
    type(option_t), intent(in) :: option !! its key
    real(wp), intent(inout) :: value !! component of the method

    call add_option(self, option, value_real, short_real(value))
  end subroutine real_option

  !> Add a logical of a method as key.
  subroutine flag_option(self, option, value)
    class(key_table_t), intent(inout) :: self
    type(option_t), intent(in) :: option !! its key
    logical, intent(inout) :: value !! component of the method

    call add_option(self, option, value_logical, true_or_false(value))
  end subroutine flag_option

  !> Add a word of a method as key.
  subroutine word_option(self, option, value)
    class(key_table_t), intent(inout) :: self
    type(option_t), intent(in) :: option !! its key
    character(len=*), intent(inout) :: value !! component of the method

    call add_option(self, option, value_choice, quoted_string(trim(value)))
  end subroutine word_option

  !> Add an option of a method as key.
  subroutine add_option(table, option, kind, default)
    class(key_table_t), intent(inout) :: table
    type(option_t), intent(in) :: option
    integer, intent(in) :: kind
    character(len=*), intent(in) :: default

    call table%add(trim(option%name), kind, trim(option%sentence), unit=trim(option%unit), default=default, least=option%least, &
                   most=option%most, choices=trim(option%choices), former_key=trim(option%former))
    associate (key => table%keys(table%n_keys))
      key%is_open = option%above > option%least
      if (key%is_open) key%lowest = option%above
    end associate
  end subroutine add_option

  !> What a value may be, in words: in the plane, in space, or (dimension 0) in both.
  pure function value_name(kind, dimension) result(words)
    integer, intent(in) :: kind !! one of `value_*`
    integer, intent(in) :: dimension !! 2, 3, or 0 where it is not known
    character(len=:), allocatable :: words

    words = trim(plane_names(kind))
    if (dimension == 3) words = trim(space_names(kind))
    if (dimension == 0 .and. plane_names(kind) /= space_names(kind)) words = words//', in space '//trim(space_names(kind))
  end function value_name

  !> A condition, `key=word|word` or `key`, as the key and its words.
  subroutine put_condition(condition, name, words)
    character(len=*), intent(in) :: condition
    character(len=*), intent(out) :: name, words
    integer :: cut

    cut = index(condition//'=', '=')
    call put(name, condition(:cut - 1))
    call put(words, condition(min(len(condition), cut) + 1:))
  end subroutine put_condition

  !> Fill a text of the table. One that does not fit is a mistake in keys_*.f90, which the first deck brings to light.
  subroutine put(field, text)
    character(len=*), intent(out) :: field
    character(len=*), intent(in) :: text

    if (len(text) > len(field)) then
      write (error_unit, '(3a)') 'the key table has no room for "', text, '"'
      error stop
    end if
    field = text
  end subroutine put

  !> Index of a section; 0 when there is none of this name.
  pure integer function find_section(self, name) result(found)
    class(key_table_t), intent(in) :: self
    character(len=*), intent(in) :: name !! name to look for

    do found = 1, size(self%sections)
      if (self%sections(found)%name == name) return
    end do
    found = 0
  end function find_section

  !> Index of a key of a section; 0 when there is none of this name.
  pure integer function find_key(self, section, name) result(found)
    class(key_table_t), intent(in) :: self
    integer, intent(in) :: section !! index of the section
    character(len=*), intent(in) :: name !! name to look for

    do found = self%sections(section)%first, self%sections(section)%last
      if (self%keys(found)%name == name) return
    end do
    found = 0
  end function find_key

  !> Index of the key that replaces one of older decks; 0 when there is none.
  pure integer function find_former(self, path) result(found)
    class(key_table_t), intent(in) :: self
    character(len=*), intent(in) :: path !! `section.key`

    found = findloc(self%keys%former_key == path, .true., 1)
  end function find_former

  !> `; did you mean "word"?` for the key of a section nearest to a word; empty when none is near.
  pure function nearest_key(self, section, word) result(hint)
    class(key_table_t), intent(in) :: self
    integer, intent(in) :: section !! index of the section
    character(len=*), intent(in) :: word !! unknown word
    character(len=:), allocatable :: hint
    type(text_t), allocatable :: known(:)
    integer :: i, first

    first = self%sections(section)%first
    allocate (known(self%sections(section)%last - first + 1))
    do i = 1, size(known)
      known(i)%s = trim(self%keys(first + i - 1)%name)
    end do
    hint = asked(nearest_word(word, known))
  end function nearest_key

  !> The same for the names of sections.
  pure function nearest_section(self, word) result(hint)
    class(key_table_t), intent(in) :: self
    character(len=*), intent(in) :: word !! unknown word
    character(len=:), allocatable :: hint
    type(text_t), allocatable :: known(:)
    integer :: i

    allocate (known(size(self%sections)))
    do i = 1, size(known)
      known(i)%s = trim(self%sections(i)%name)
    end do
    hint = asked(nearest_word(word, known))
  end function nearest_section

  !> The question that ends a message.
  pure function asked(word) result(hint)
    character(len=*), intent(in) :: word
    character(len=:), allocatable :: hint

    hint = ''
    if (word /= '') hint = '; did you mean "'//word//'"?'
  end function asked
end module sg_key_table
