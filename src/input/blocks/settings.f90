!> Settings from the command line, `--set section.key=value`, laid over the values of a deck.
!!
!! `stage[2].solver.tolerance=1e-6` is a key that the second stage changes, whether the deck has it there or not;
!! `stage[2].drive[1].value=0.1` is one of its first [[stage.drive]].
!! `law.friction=0.5` holds for every [[law]] of the deck, `law[2].friction=0.5` for the second alone. A value is
!! read as TOML; what is no TOML value is taken as a string, so that words need no quotes.
module sg_settings
  use sg_blocks, only: block_t, deck_t
  use sg_collect, only: set_value
  use sg_error, only: diagnostics_t, error_t
  use sg_numerals, only: is_integer_word, read_integer
  use sg_stage_keys, only: may_stand_in_stage
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
    if (index(path, 'stage[') == 1 .and. index(path, '].') > 0 .and. index(path, '.') < index(path, '.', back=.true.)) then
      call apply_to_stage(path, trim(adjustl(setting(equals + 1:))), deck, message)
      return
    end if
    call find_target(path, deck, section, number, key, message)
    if (allocated(message)) return
    call take_value(path, trim(adjustl(setting(equals + 1:))), key, deck, value, message)
    if (allocated(message)) return
    if (path == deck%table%keys(key)%former_key) value%former = path
    n = 0
    do i = 1, deck%n
      if (deck%blocks(i)%section /= section) cycle
      n = n + 1
      if (number == 0 .or. number == n) call deck%put(i, value)
    end do
    if (n < max(number, 1)) message = 'the deck has no '//deck%heading(section)//' number '//to_text(max(number, 1))
  end subroutine apply

  !> The value of a setting.
  subroutine take_value(path, text, key, deck, value, message)
    character(len=*), intent(in) :: path, text
    integer, intent(in) :: key
    type(deck_t), intent(in) :: deck
    type(value_t), intent(out) :: value
    character(len=:), allocatable, intent(out) :: message

    call set_value(as_toml(text), deck%table%keys(key), value, message)
    if (allocated(message)) message = '"'//path//'" '//message
    value%key = key
    value%origin = from_setting
  end subroutine take_value

  !> Apply a setting of a key that a stage changes, `stage[number].section.key` or `stage[number].section[number].key`.
  subroutine apply_to_stage(path, text, deck, message)
    character(len=*), intent(in) :: path, text
    type(deck_t), intent(inout) :: deck
    character(len=:), allocatable, intent(out) :: message
    type(value_t) :: value
    character(len=:), allocatable :: inner
    integer :: stage, section, number, key, c, n
    logical :: is_number

    n = index(path, '].')
    call read_integer(path(len('stage[') + 1:n - 1), stage, is_number)
    if (.not. is_number .or. stage < 1 .or. stage > deck%count_of('stage')) then
      message = '"'//path//'": the deck has '//to_text(deck%count_of('stage'))//' stages, counted from 1'
      return
    end if
    inner = path(n + 2:)
    call find_target(inner, deck, section, number, key, message)
    if (allocated(message)) return
    if (.not. may_stand_in_stage(trim(deck%table%sections(section)%name), trim(deck%table%keys(key)%name))) then
      message = '"'//inner//'" cannot change between stages'
      return
    end if
    call take_value(path, text, key, deck, value, message)
    if (allocated(message)) return
    n = 0
    do c = 1, size(deck%changes)
      if (deck%changes(c)%section /= section .or. deck%changes(c)%parent /= stage) cycle
      n = n + 1
      if (number == 0 .or. number == n) call put(deck%changes(c), value)
    end do
    if (n >= max(number, 1)) return
    if (deck%table%sections(section)%is_list) then
      message = 'stage '//to_text(stage)//' has no '//deck%heading(section)//' number '//to_text(max(number, 1))
    else
      call add_change(deck, section, stage, value)
    end if
  end subroutine apply_to_stage

  !> Put a value into a block that a stage changes, in place of one that is there.
  pure subroutine put(block, value)
    type(block_t), intent(inout) :: block
    type(value_t), intent(in) :: value
    type(value_t), allocatable :: grown(:)
    integer :: i

    do i = 1, block%n
      if (block%values(i)%key == value%key) exit
    end do
    if (i > size(block%values)) then
      allocate (grown(i))
      grown(:block%n) = block%values(:block%n)
      call move_alloc(grown, block%values)
    end if
    block%values(i) = value
    block%n = max(block%n, i)
  end subroutine put

  !> Add a section that a stage changes, with one value.
  pure subroutine add_change(deck, section, stage, value)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: section, stage
    type(value_t), intent(in) :: value
    type(block_t), allocatable :: more(:)
    integer :: c, n

    n = size(deck%changes)
    allocate (more(n + 1))
    do c = 1, n
      more(c) = deck%changes(c)
    end do
    more(n + 1)%section = section
    more(n + 1)%parent = stage
    more(n + 1)%is_of_stage = .true.
    allocate (more(n + 1)%values(0))
    call put(more(n + 1), value)
    call move_alloc(more, deck%changes)
  end subroutine add_change

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
