!> Settings from the command line, `--set section.key=value`, laid over the values of a deck.
!!
!! `law.friction=0.5` holds for every [[law]] of the deck, `law[2].friction=0.5` for the second alone. A value is
!! read as TOML; what is no TOML value is taken as a string, so that words need no quotes.
module sg_settings
  use sg_blocks, only: deck_t
  use sg_collect, only: set_value
  use sg_error, only: diagnostics_t, error_t
  use sg_numerals, only: is_integer_word, read_integer
  use sg_text, only: text_t, to_text
  use sg_toml, only: document_t, parse_toml
  use sg_values, only: from_setting, value_t
  use sg_words, only: quoted_string
  implicit none
  private
  public :: apply_settings

contains

  !> Apply all settings, in order.
  subroutine apply_settings(settings, deck, diagnostics)
    type(text_t), intent(in) :: settings(:) !! each `section.key=value`
    type(deck_t), intent(inout) :: deck !! deck to change
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=:), allocatable :: message
    integer :: i

    do i = 1, size(settings)
      call apply(settings(i)%s, deck, message)
      if (allocated(message)) call diagnostics%add(message, file='--set')
    end do
  end subroutine apply_settings

  !> Apply one setting.
  subroutine apply(setting, deck, message)
    character(len=*), intent(in) :: setting
    type(deck_t), intent(inout) :: deck
    character(len=:), allocatable, intent(out) :: message
    type(value_t) :: value
    character(len=:), allocatable :: path
    integer :: equals, section, number, key, i, n

    equals = index(setting, '=')
    if (equals == 0) then
      message = '"'//setting//'" is not of the form section.key=value'
      return
    end if
    path = trim(adjustl(setting(:equals - 1)))
    call find_target(path, deck, section, number, key, message)
    if (allocated(message)) return
    call set_value(as_toml(trim(adjustl(setting(equals + 1:)))), deck%table%keys(key), value, message)
    if (allocated(message)) then
      message = '"'//path//'" '//message
      return
    end if
    value%key = key
    value%origin = from_setting
    if (path == deck%table%keys(key)%former_key) value%former = path
    n = 0
    do i = 1, deck%n
      if (deck%blocks(i)%section /= section) cycle
      n = n + 1
      if (number == 0 .or. number == n) call deck%put(i, value)
    end do
    if (n < max(number, 1)) message = 'the deck has no '//deck%heading(section)//' number '//to_text(max(number, 1))
  end subroutine apply

  !> Section, block number (0 for all) and key that `section[number].key` means.
  subroutine find_target(path, deck, section, number, key, message)
    character(len=*), intent(in) :: path
    type(deck_t), intent(in) :: deck
    integer, intent(out) :: section, number, key
    character(len=:), allocatable, intent(out) :: message
    character(len=:), allocatable :: name
    integer :: dot, bracket
    logical :: is_number

    section = 0
    key = 0
    number = 0
    dot = index(path, '.', back=.true.)
    name = path(:dot - 1)
    bracket = index(name, '[')
    if (bracket > 1 .and. index(name//' ', '] ') == len(name)) then
      call read_integer(name(bracket + 1:len(name) - 1), number, is_number)
      if (.not. is_number .or. number < 1) message = '"'//path//'": blocks are counted from 1'
      name = name(:bracket - 1)
    end if
    if (allocated(message)) return
    if (dot > 1) section = deck%table%find_section(name)
    if (dot == 0) then
      section = deck%table%find_section('')
      key = deck%table%find_key(section, path)
      if (key > 0) return
    end if
    if (dot < 2) then
      message = '"'//path//'" is not of the form section.key'
    else if (section == 0) then
      message = 'unknown section ['//name//']'//deck%table%nearest_section(name)
    else
      key = deck%table%find_key(section, path(dot + 1:))
      if (key == 0) key = deck%table%find_former(path)
      if (key > 0) section = deck%table%find_section(trim(deck%table%keys(key)%section))
      if (key == 0) message = 'unknown key "'//path(dot + 1:)//'" in '//deck%heading(section)// &
                              deck%table%nearest_key(section, path(dot + 1:))
    end if
  end subroutine find_target

  !> A value as given, or as a string when it is no TOML. Integers that TOML cannot hold are no strings.
  function as_toml(text) result(value)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: value
    type(document_t) :: document
    type(error_t), allocatable :: error

    value = text
    call parse_toml('x = '//text, document, error)
    if (.not. allocated(error)) return
    value = quoted_string(text)
    if (is_integer_word(text)) value = text//'.0'
  end function as_toml
end module sg_settings
