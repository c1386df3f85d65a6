!> Constants of a deck: numbers with a name in `[constants]`, and expressions of them in braces in any string.
!!
!! `"{2*width}"` is a number, `"-{speed}*min(1, t/0.1)"` a string in which the braces are replaced by one. It is done in the entries
!! of the text, before they are checked against the key table; a deck without the section is left as it is.
module sg_constants
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_expression_parser, only: parse_expression
  use sg_expressions, only: expression_t, functions
  use sg_kinds, only: wp, i8
  use sg_text, only: append_word, nearest_word, text_t, to_text
  use sg_toml, only: document_t, entry_t, toml_integer, toml_real, toml_string, toml_table
  use sg_words, only: short_real
  implicit none
  private
  public :: constants_t, take_constant_settings, put_constants, check_constant_settings

  !> Name of the section, and how a setting of a constant begins
  character(len=*), parameter :: section = 'constants', prefix = section//'.'
  !> Words that expressions have already
  character(len=5), parameter :: taken(7) = [character(len=5) :: 't', 'pi', 'and', 'or', 'not', 'true', 'false']
  character(len=*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ', digits = '0123456789_'

  !> Constants read so far
  type :: constants_t
    !> Names and values, shape (n)
    type(text_t), allocatable :: names(:)
    real(wp), allocatable :: values(:)
    !> Settings laid over them: names and texts
    type(text_t), allocatable :: set_names(:), set_texts(:)
    !> Has the deck such a section?
    logical :: is_there = .false.
    !> Were mistakes in constants or braces reported?
    logical :: are_bad = .false.
  end type constants_t

contains

  !> Take the settings of constants, `constants.name=value`, out of all settings.
  subroutine take_constant_settings(settings, constants, others)
    type(text_t), intent(in) :: settings(:) !! each `section.key=value`
    type(constants_t), intent(out) :: constants !! no constants yet, with their settings
    type(text_t), allocatable, intent(out) :: others(:) !! settings of everything else, in order
    character(len=:), allocatable :: word
    integer :: i, equals

    allocate (constants%names(0), constants%values(0), constants%set_names(0), constants%set_texts(0), others(0))
    do i = 1, size(settings)
      word = adjustl(settings(i)%s)
      equals = index(word, '=')
      if (index(word, prefix) == 1 .and. equals > 0) then
        call append_word(constants%set_names, trim(word(len(prefix) + 1:equals - 1)))
        call append_word(constants%set_texts, trim(adjustl(word(equals + 1:))))
      else
        call append_word(others, settings(i)%s)
      end if
    end do
  end subroutine take_constant_settings

  !> Read the constants of a text, and replace expressions in braces by their numbers.
  subroutine put_constants(document, constants, deck, diagnostics)
    type(document_t), intent(inout) :: document !! entries of the text
    type(constants_t), intent(inout) :: constants !! settings of constants, to which the constants are added
    type(deck_t), intent(in) :: deck !! deck of which this is the text
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: i, table, before

    before = diagnostics%count()
    table = document%find(section)
    if (table > 0) constants%is_there = document%entries(table)%kind == toml_table
    if (constants%is_there) then
      do i = table + 1, size(document%entries)
        if (document%entries(i)%parent == table) call take_constant(document%entries(i), constants, deck, diagnostics)
      end do
      do i = 1, size(document%entries)
        if (document%entries(i)%kind /= toml_string .or. index(document%entries(i)%path, prefix) == 1) cycle
        if (index(document%entries(i)%text, '{') > 0) call fill_braces(document%entries(i), constants, deck, diagnostics)
      end do
    end if
    constants%are_bad = diagnostics%count() > before
  end subroutine put_constants

  !> Report settings of constants that the deck does not have.
  subroutine check_constant_settings(constants, diagnostics)
    type(constants_t), intent(in) :: constants !! those of the whole deck
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: i

    do i = 1, size(constants%set_names)
      if (place_of(constants%set_names(i)%s, constants%names) == 0) &
        call diagnostics%add(unknown(constants%set_names(i)%s, constants), file='--set')
    end do
  end subroutine check_constant_settings

  !> Read one constant, or the setting in its place.
  subroutine take_constant(entry, constants, deck, diagnostics)
    type(entry_t), intent(in) :: entry
    type(constants_t), intent(inout) :: constants
    type(deck_t), intent(in) :: deck
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: name, message
    real(wp) :: value
    integer :: i, column

    name = entry%path(len(prefix) + 1:)
    message = fault_of(name)
    if (len(message) > 0) then
      call deck%complain_at(diagnostics, message, entry%key_line, entry%key_column)
      return
    end if
    value = entry%real
    deallocate (message)
    column = 0
    if (entry%kind == toml_string) then
      call evaluate(entry%text, constants, value, message, column)
    else if (all(entry%kind /= [toml_integer, toml_real])) then
      message = 'a constant must be a number, or an expression of constants above it'
    end if
    if (allocated(message)) call deck%complain_at(diagnostics, message, entry%line, entry%column + column)
    do i = 1, size(constants%set_names)
      if (constants%set_names(i)%s /= name) cycle
      call evaluate(constants%set_texts(i)%s, constants, value, message, column)
      if (allocated(message)) call diagnostics%add('"'//prefix//name//'": '//message, file='--set')
    end do
    call append_word(constants%names, name)
    constants%values = [constants%values, value]
  end subroutine take_constant

  !> What is wrong with the name of a constant; empty where nothing is.
  pure function fault_of(name) result(message)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: message

    message = ''
    if (verify(name, letters//digits) > 0 .or. scan(name, letters) /= 1) then
      message = 'the name of a constant must be letters, digits and _, a letter first'
    else if (any(taken == name) .or. any(functions%name == name)) then
      message = '"'//name//'" is a word of expressions: give the constant another name'
    end if
  end function fault_of

  !> Value of an expression of the constants.
  subroutine evaluate(text, constants, value, message, column)
    character(len=*), intent(in) :: text
    type(constants_t), intent(in) :: constants
    real(wp), intent(out) :: value
    character(len=:), allocatable, intent(out) :: message !! unallocated where nothing is wrong
    integer, intent(out) :: column !! place of the mistake in the text
    type(expression_t) :: expression

    value = 0
    call parse_expression(text, constants%names, expression, message, column)
    if (allocated(message)) return
    value = expression%at(constants%values)
    column = 1
    if (ieee_is_nan(value)) then
      message = '"'//text//'" has no value'
      return
    end if
    ! Products of decimal fractions miss whole numbers by rounding: 900*2.14 is to count 1926 grains.
    if (abs(value - anint(value)) <= 1e-12_wp*abs(value)) value = anint(value)
  end subroutine evaluate

  !> Replace expressions in braces in a string; one that is nothing else becomes a number.
  subroutine fill_braces(entry, constants, deck, diagnostics)
    type(entry_t), intent(inout) :: entry
    type(constants_t), intent(in) :: constants
    type(deck_t), intent(in) :: deck
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: text, filled, message
    real(wp) :: value
    integer :: open, close, column

    text = entry%text
    filled = ''
    do
      open = index(text, '{')
      if (open == 0) exit
      close = index(text(open:), '}') + open - 1
      column = 0
      if (close < open) then
        message = 'a "{" lacks its "}"'
      else
        call evaluate(text(open + 1:close - 1), constants, value, message, column)
      end if
      if (allocated(message)) then
        column = entry%column + len(entry%text) - len(text) + open + column
        call deck%complain_at(diagnostics, message, entry%line, column)
        entry%text = ''
        return
      end if
      if (open == 1 .and. close == len(entry%text)) then
        call make_number(entry, value)
        return
      end if
      filled = filled//text(:open - 1)//written(value)
      text = text(close + 1:)
    end do
    entry%text = filled//text
  end subroutine fill_braces

  !> Make an entry a number, whole where it is.
  pure subroutine make_number(entry, value)
    type(entry_t), intent(inout) :: entry
    real(wp), intent(in) :: value

    entry%kind = toml_real
    entry%real = value
    if (.not. is_whole(value)) return
    entry%kind = toml_integer
    entry%integer = nint(value, i8)
  end subroutine make_number

  !> A number within a string: negative ones in brackets, so that a sign may stand before it.
  pure function written(value) result(word)
    real(wp), intent(in) :: value
    character(len=:), allocatable :: word

    if (is_whole(value)) then
      word = to_text(nint(value))
    else
      word = short_real(value)
    end if
    if (value < 0) word = '('//word//')'
  end function written

  !> Is a number whole, and small enough for an integer?
  pure logical function is_whole(value)
    real(wp), intent(in) :: value

    is_whole = abs(value) < 2e9_wp
    if (is_whole) is_whole = .not. abs(value - anint(value)) > 0
  end function is_whole

  !> The sentence about a constant that does not exist.
  function unknown(name, constants) result(message)
    character(len=*), intent(in) :: name
    type(constants_t), intent(in) :: constants
    character(len=:), allocatable :: message, near

    near = nearest_word(name, constants%names)
    if (near /= '') near = '; did you mean "'//near//'"?'
    message = 'there is no constant named "'//name//'"'//near
  end function unknown

  !> Place of a word in a list; 0 where it is not there.
  pure integer function place_of(word, list) result(place)
    character(len=*), intent(in) :: word
    type(text_t), intent(in) :: list(:)

    do place = 1, size(list)
      if (list(place)%s == word) return
    end do
    place = 0
  end function place_of
end module sg_constants
