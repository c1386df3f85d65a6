!> The deck reference as Markdown, generated from the key table: `splitgrain reference` prints it, and
!! doc/deck_reference.md is a copy that a test keeps up to date.
module sg_reference_text
  use sg_key_table, only: key_t, key_table_t, section_t, value_choice, value_name, in_both, in_plane, in_space
  use sg_keys, only: all_keys
  use sg_kinds, only: wp
  use sg_text, only: text_t
  use sg_words, only: list_choices, short_real
  implicit none
  private
  public :: reference_text

  character(len=*), parameter :: nl = new_line('a')
  !> Width of lines of text; rows of tables may be longer
  integer, parameter :: columns = 120

contains

  !> The whole reference.
  function reference_text() result(text)
    character(len=:), allocatable :: text
    type(key_table_t) :: table
    integer :: s

    table = all_keys()
    text = '# Deck reference'//nl//nl// &
      'Generated from the key table by `splitgrain reference`; do not edit.'//nl//nl//wrapped( &
      'A deck is a TOML text. Sections and keys may come in any order; an unknown word is an error. `[name]` stands once '// &
      'or not at all, `[[name]]` as often as wanted. Units are SI, angles in radians; masses of planar scenes are per metre of '// &
      'depth. What is in space belongs to scenes with `scene.dimension = 3`. '// &
      'Paths are relative to the folder of the deck. Lists are written `[1.0, 2.0]`. `--set section.key=value` lays a '// &
      'value over the deck, for every block of a section or, as `section[2].key=value`, for one of them, counted from 1; '// &
      'words need no quotes there.')//nl//nl// &
      wrapped('The effective deck, with all defaults filled in, is written next to the results, and its hash stands in every '// &
              'output.')//nl
    do s = 1, size(table%sections)
      text = text//section_lines(table, table%sections(s))
    end do
  end function reference_text

  !> Heading, sentence and keys of one section.
  function section_lines(table, section) result(text)
    type(key_table_t), intent(in) :: table
    type(section_t), intent(in) :: section
    character(len=:), allocatable :: text
    integer :: k

    text = trim(section%name)
    if (section%is_list) text = '['//text//']'
    text = nl//'## `['//text//']`'//nl//nl
    if (section%name == '') text = nl//'## Top of the deck'//nl//nl
    text = text//wrapped(trim(section%sentence)//trim(merge('               ', ' Only in space.', section%dimension == in_both)))
    text = text//nl
    if (section%last < section%first) return
    text = text//nl// &
           '| key | value | unit | default | meaning |'//nl//'| --- | --- | --- | --- | --- |'//nl
    do k = section%first, section%last
      associate (key => table%keys(k))
        text = text//'| `'//trim(key%name)//'` | '//what_may(key)//' | '//trim(key%unit)//' | '//default_of(key)//' | '// &
               trim(key%sentence)//when_it_applies(key)//' |'//nl
      end associate
    end do
  end function section_lines

  !> A sentence in lines of 120 columns at most, each broken at its last blank.
  pure recursive function wrapped(sentence) result(text)
    character(len=*), intent(in) :: sentence
    character(len=:), allocatable :: text
    integer :: cut

    text = sentence
    if (len(sentence) <= columns) return
    cut = index(sentence(:columns + 1), ' ', back=.true.)
    text = sentence(:cut - 1)//nl//wrapped(sentence(cut + 1:))
  end function wrapped

  !> Kind of value with its range or choices.
  function what_may(key) result(words)
    type(key_t), intent(in) :: key
    character(len=:), allocatable :: words
    logical :: has_low, has_high

    if (key%kind == value_choice) then
      words = code_words(trim(key%choices), ', ')
      if (key%space_choices /= '') words = words//'; in space '//code_words(trim(key%space_choices), ', ')
      return
    end if
    words = value_name(key%kind, key%dimension)
    has_low = key%lowest > -huge(1.0_wp)
    has_high = key%highest < huge(1.0_wp)
    if (has_low) words = words//trim(merge(', above   ', ', at least', key%is_open))//' '//number(key%lowest)
    if (has_high) words = words//', at most '//number(key%highest)
  end function what_may

  !> A bound, whole numbers without a point.
  function number(value) result(word)
    real(wp), intent(in) :: value
    character(len=:), allocatable :: word
    integer :: cut

    word = short_real(value)
    cut = index(word, '.0', back=.true.)
    if (cut > 0 .and. cut == len(word) - 1) word = word(:cut - 1)
  end function number

  !> Default, or that there is none.
  function default_of(key) result(words)
    type(key_t), intent(in) :: key
    character(len=:), allocatable :: words

    words = ''
    if (key%default /= '') words = '`'//trim(key%default)//'`'
    if (key%space_default /= '') words = words//', in space `'//trim(key%space_default)//'`'
    if (key%is_required) words = 'required'
  end function default_of

  !> For which words of another key it has a meaning.
  function when_it_applies(key) result(words)
    type(key_t), intent(in) :: key
    character(len=:), allocatable :: words

    words = ''
    if (key%only /= '') then
      words = ' Only for '//trim(key%selector)//' '//code_words(trim(key%only), ', ')//'.'
    else if (key%selector /= '') then
      words = ' Only with `'//trim(key%selector)//'`.'
    end if
    if (key%switch /= '') words = words//' Ignored unless '//trim(key%switch)//' is '// &
                                  code_words(trim(key%used_for), ' or ')//'.'
    if (key%dimension == in_plane) words = words//' Only in the plane.'
    if (key%dimension == in_space) words = words//' Only in space.'
  end function when_it_applies

  !> Words with a bar between two, each set as code.
  function code_words(choices, separator) result(words)
    character(len=*), intent(in) :: choices, separator
    character(len=:), allocatable :: words
    type(text_t), allocatable :: list(:)
    integer :: i

    call list_choices(choices, list)
    words = '`'//list(1)%s//'`'
    do i = 2, size(list)
      words = words//separator//'`'//list(i)%s//'`'
    end do
  end function code_words
end module sg_reference_text
