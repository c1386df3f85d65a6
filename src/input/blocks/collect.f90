!> From the entries of a TOML text to blocks of values: unknown words, wrong kinds, numbers out of range.
module sg_collect
  use sg_blocks, only: block_t, deck_t
  use sg_error, only: diagnostics_t, error_t
  use sg_key_table, only: key_t, key_table_t
  use sg_stage_keys, only: may_stand_in_stage, section_for_stage
  use sg_toml, only: document_t, entry_t, parse_toml, toml_array, toml_table
  use sg_values, only: finish_value, from_deck, from_default, take_entry, value_t
  implicit none
  private
  public :: open_deck, collect, set_value, choose_dimension

  !> What an entry turned out to be: of no use, a list of blocks, a block, a value
  integer, parameter :: is_skipped = 0, is_blocks = 1, is_block = 2, is_value = 3

  !> What became of one entry
  type :: role_t
    integer :: role = is_skipped
    !> Section of a list of blocks; block of a block or a value
    integer :: section = 0, block = 0
    !> Position among the block's values, and depth within the value
    integer :: value = 0, depth = 0
  end type role_t

contains

  !> Begin a deck: sections that stand once, and defaults.
  subroutine open_deck(deck, table, n)
    type(deck_t), intent(inout) :: deck !! deck to fill
    type(key_table_t), intent(in) :: table !! what it may hold
    integer, intent(in) :: n !! blocks to make room for, besides those that stand once
    character(len=:), allocatable :: name
    integer :: i, parent

    deck%table = table
    allocate (deck%blocks(n + size(table%sections)))
    do i = 1, size(table%sections)
      associate (section => table%sections(i))
        if (section%is_list) cycle
        name = trim(section%name)
        parent = 0
        if (index(name, '.') > 0) parent = deck%block_of(name(:index(name, '.') - 1))
        call add_block(deck, i, parent, max(0, section%last - section%first + 1))
      end associate
    end do
    allocate (deck%defaults(size(table%keys)))
    do i = 1, size(table%keys)
      if (table%keys(i)%default /= '') call set_default(deck%defaults(i), table%keys(i))
    end do
  end subroutine open_deck

  !> Add a block with room for `n` values.
  subroutine add_block(deck, section, parent, n)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: section, parent, n

    deck%n = deck%n + 1
    if (deck%n > size(deck%blocks)) call grow(deck)
    deck%blocks(deck%n)%section = section
    deck%blocks(deck%n)%parent = parent
    allocate (deck%blocks(deck%n)%values(n))
  end subroutine add_block

  !> Make room for more blocks.
  subroutine grow(deck)
    type(deck_t), intent(inout) :: deck
    type(block_t), allocatable :: more(:)
    integer :: i

    allocate (more(2*size(deck%blocks)))
    do i = 1, size(deck%blocks)
      call move_alloc(deck%blocks(i)%values, more(i)%values)
      more(i)%section = deck%blocks(i)%section
      more(i)%parent = deck%blocks(i)%parent
      more(i)%line = deck%blocks(i)%line
      more(i)%column = deck%blocks(i)%column
      more(i)%n = deck%blocks(i)%n
    end do
    call move_alloc(more, deck%blocks)
  end subroutine grow

  !> Decide for a dimension: from now on the deck has its defaults.
  subroutine choose_dimension(deck, dimension)
    type(deck_t), intent(inout) :: deck !! deck of which all entries are taken
    integer, intent(in) :: dimension !! 2 or 3
    type(key_t) :: key
    integer :: i

    deck%dimension = dimension
    if (dimension == 2) return
    do i = 1, size(deck%table%keys)
      key = deck%table%keys(i)
      if (key%space_default == '') cycle
      key%default = key%space_default
      call set_default(deck%defaults(i), key)
    end do
  end subroutine choose_dimension

  !> The default of a key as a value.
  subroutine set_default(value, key)
    type(value_t), intent(out) :: value
    type(key_t), intent(in) :: key
    character(len=:), allocatable :: message

    call set_value(trim(key%default), key, value, message)
    value%origin = from_default
  end subroutine set_default

  !> A value from its TOML text.
  subroutine set_value(text, key, value, message)
    character(len=*), intent(in) :: text !! value as TOML text
    type(key_t), intent(in) :: key !! key that it belongs to
    type(value_t), intent(out) :: value !! the value
    character(len=:), allocatable, intent(out) :: message !! what is wrong, unallocated when nothing is
    type(document_t) :: document
    type(error_t), allocatable :: error
    integer, allocatable :: depth(:)
    integer :: i

    call parse_toml('x = '//text, document, error)
    if (allocated(error)) then
      message = 'is no TOML value: '//error%message
      return
    end if
    allocate (depth(0:size(document%entries)), source=-1)
    do i = 1, size(document%entries)
      depth(i) = depth(document%entries(i)%parent) + 1
      call take_entry(value, key, document%entries(i), depth(i), message)
      if (allocated(message)) return
    end do
    call finish_value(value, key, 0, message)
  end subroutine set_value

  !> Sort all entries of a text into blocks.
  subroutine collect(document, deck, diagnostics, is_again)
    type(document_t), intent(in) :: document !! entries of the text, or of one of its pieces
    type(deck_t), intent(inout) :: deck !! deck to fill
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    logical, intent(out) :: is_again !! does a section that stands once stand in a piece before this one, too? Then not all is taken
    type(role_t), allocatable :: roles(:)
    integer, allocatable :: n_children(:)
    integer :: i, parent

    is_again = .false.
    allocate (roles(size(document%entries)))
    allocate (n_children(0:size(document%entries)), source=0)
    do i = 1, size(document%entries)
      parent = document%entries(i)%parent
      n_children(parent) = n_children(parent) + 1
    end do
    do i = 1, size(document%entries)
      parent = document%entries(i)%parent
      if (parent == 0) then
        is_again = stands(deck, document%entries(i))
        if (is_again) return
        call take_section(document%entries(i), deck, roles(i), n_children(i), diagnostics)
      else
        select case (roles(parent)%role)
        case (is_blocks)
          call take_block(document%entries(i), roles(parent), deck, roles(i), n_children(i), diagnostics)
        case (is_block)
          call take_key(document, i, roles(parent), deck, roles(i), diagnostics)
        case (is_value)
          call take_element(document%entries(i), roles(parent), deck, roles(i), diagnostics)
        end select
      end if
    end do
  end subroutine collect

  !> Is this a section, and not a list of blocks?
  pure logical function stands_once(deck, section)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: section !! number, or 0 for none

    stands_once = .false.
    if (section > 0) stands_once = .not. deck%table%sections(section)%is_list
  end function stands_once

  !> Does a section that is to stand once stand in the deck?
  pure logical function stands(deck, entry)
    type(deck_t), intent(in) :: deck
    type(entry_t), intent(in) :: entry
    integer :: section

    stands = .false.
    section = deck%table%find_section(entry%path)
    if (section == 0) return
    if (deck%table%sections(section)%is_list) return
    stands = deck%blocks(deck%block_of(entry%path))%line > 0
  end function stands

  !> An entry at the top: a section, or a list of blocks.
  subroutine take_section(entry, deck, role, n_children, diagnostics)
    type(entry_t), intent(in) :: entry
    type(deck_t), intent(inout) :: deck
    type(role_t), intent(inout) :: role
    integer, intent(in) :: n_children
    type(diagnostics_t), intent(inout) :: diagnostics
    integer :: section, top, key

    top = deck%table%find_section('')
    key = deck%table%find_key(top, entry%path)
    section = deck%table%find_section(entry%path)
    if (key > 0 .and. entry%kind /= toml_table) then
      call take_value(entry, deck, key, deck%block_of(''), role, diagnostics)
    else if (section == 0) then
      if (entry%kind == toml_table .or. entry%kind == toml_array) then
        call at_key(deck, entry, 'unknown section ['//entry%path//']'// &
                    deck%table%nearest_section(entry%path), diagnostics)
      else
        call at_key(deck, entry, 'the key "'//entry%path//'" stands outside of any section'// &
                    deck%table%nearest_key(top, entry%path), diagnostics)
      end if
    else if (deck%table%sections(section)%is_list) then
      if (entry%kind == toml_array) then
        role%role = is_blocks
        role%section = section
      else
        call at_key(deck, entry, deck%heading(section)//' needs double brackets: there may be several', diagnostics)
      end if
    else if (entry%kind == toml_table) then
      role%role = is_block
      role%block = deck%block_of(entry%path)
      associate (block => deck%blocks(role%block))
        block%line = entry%line
        block%column = entry%column
        deallocate (block%values)
        allocate (block%values(n_children))
      end associate
    else
      call at_key(deck, entry, deck%heading(section)//' needs single brackets: it stands once', diagnostics)
    end if
  end subroutine take_section

  !> An element of a list of blocks.
  subroutine take_block(entry, parent, deck, role, n_children, diagnostics)
    type(entry_t), intent(in) :: entry
    type(role_t), intent(in) :: parent
    type(deck_t), intent(inout) :: deck
    type(role_t), intent(inout) :: role
    integer, intent(in) :: n_children
    type(diagnostics_t), intent(inout) :: diagnostics

    if (entry%kind /= toml_table) then
      call at_key(deck, entry, deck%heading(parent%section)//' must hold keys', diagnostics)
      return
    end if
    call add_block(deck, parent%section, parent%block, n_children)
    role%role = is_block
    role%block = deck%n
    deck%blocks(deck%n)%line = entry%line
    deck%blocks(deck%n)%column = entry%column
  end subroutine take_block

  !> An entry of a block: a key, or a list of blocks within.
  subroutine take_key(document, i, parent, deck, role, diagnostics)
    type(document_t), intent(in) :: document
    integer, intent(in) :: i
    type(role_t), intent(in) :: parent
    type(deck_t), intent(inout) :: deck
    type(role_t), intent(inout) :: role
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: name, outer
    integer :: section, key, former

    associate (entry => document%entries(i), block => deck%blocks(parent%block))
      name = entry%path(len(document%entries(entry%parent)%path) + 2:)
      outer = trim(deck%table%sections(block%section)%name)
      ! Constants have stood for themselves before (sg_constants).
      if (outer == 'constants') return
      section = deck%table%find_section(outer//'.'//name)
      key = deck%table%find_key(block%section, name)
      former = 0
      if (deck%is_in_stage(parent%block) .or. (outer == 'stage' .and. key == 0)) then
        call take_change(document, i, parent, deck, role, name, diagnostics)
        return
      end if
      if (key == 0) former = deck%table%find_former(outer//'.'//name)
      if (section > 0 .and. holds_tables(document, i)) then
        role%role = is_blocks
        role%section = section
        role%block = parent%block
      else if (stands_once(deck, section) .and. entry%kind == toml_table) then
        role%role = is_block
        role%block = deck%block_of(outer//'.'//name)
        deck%blocks(role%block)%line = entry%line
        deck%blocks(role%block)%column = entry%column
      else if (former > 0) then
        call take_value(entry, deck, former, deck%block_of(trim(deck%table%keys(former)%section)), role, diagnostics)
        if (role%role == is_value) deck%blocks(role%block)%values(role%value)%former = outer//'.'//name
      else if (key == 0) then
        call at_key(deck, entry, 'unknown key "'//name//'" in '//deck%heading(block%section)// &
                    deck%table%nearest_key(block%section, name), diagnostics)
      else
        call take_value(entry, deck, key, parent%block, role, diagnostics)
      end if
    end associate
  end subroutine take_key

  !> An entry of a stage, or of a section within it: a section with keys that change, or such a key.
  subroutine take_change(document, i, parent, deck, role, name, diagnostics)
    type(document_t), intent(in) :: document
    integer, intent(in) :: i
    type(role_t), intent(in) :: parent
    type(deck_t), intent(inout) :: deck
    type(role_t), intent(inout) :: role
    character(len=*), intent(in) :: name !! of the entry, without the names around it
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: full, outer, message
    integer :: section, key

    associate (entry => document%entries(i))
      outer = trim(deck%table%sections(deck%blocks(parent%block)%section)%name)
      full = outer//'.'//name
      if (outer == 'stage') full = name
      section = deck%table%find_section(full)
      key = deck%table%find_key(deck%blocks(parent%block)%section, name)
      message = ''
      if (outer == 'stage') message = section_for_stage(name)
      if (len(message) > 0) then
        call at_key(deck, entry, message, diagnostics)
      else if (section > 0 .and. (entry%kind == toml_table .or. holds_tables(document, i))) then
        if (deck%table%sections(section)%is_list .neqv. holds_tables(document, i)) then
          message = trim(merge('[[stage.'//full//']] needs double', '[stage.'//full//'] needs single  ', &
                               deck%table%sections(section)%is_list))//' brackets'
          call at_key(deck, entry, message, diagnostics)
        else if (entry%kind == toml_table) then
          call begin_change(deck, section, parent%block, entry, role)
        else
          role%role = is_blocks
          role%section = section
          role%block = parent%block
        end if
      else if (key == 0 .or. outer == 'stage') then
        call at_key(deck, entry, 'unknown key "'//name//'" in [[stage]]', diagnostics)
      else if (.not. may_stand_in_stage(outer, name)) then
        call at_key(deck, entry, '"'//name//'" cannot change between stages', diagnostics)
      else
        call take_value(entry, deck, key, parent%block, role, diagnostics)
      end if
    end associate
  end subroutine take_change

  !> Begin a section within a stage that stands once there.
  subroutine begin_change(deck, section, parent, entry, role)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: section, parent
    type(entry_t), intent(in) :: entry
    type(role_t), intent(inout) :: role

    call add_block(deck, section, parent, 4)
    role%role = is_block
    role%block = deck%n
    deck%blocks(deck%n)%line = entry%line
    deck%blocks(deck%n)%column = entry%column
  end subroutine begin_change

  !> A value of a key.
  subroutine take_value(entry, deck, key, block, role, diagnostics)
    type(entry_t), intent(in) :: entry
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: key, block
    type(role_t), intent(inout) :: role
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: value
    integer :: n

    value%key = key
    value%origin = from_deck
    n = deck%blocks(block)%n
    call deck%put(block, value)
    if (deck%blocks(block)%n == n) then
      call at_key(deck, entry, '"'//trim(deck%table%keys(key)%name)//'" is given twice: it is the former key "'// &
                  trim(deck%table%keys(key)%former_key)//'"', diagnostics)
      return
    end if
    role%role = is_value
    role%block = block
    role%value = deck%blocks(block)%n
    call take(entry, deck, role, diagnostics)
  end subroutine take_value

  !> An element of a value.
  subroutine take_element(entry, parent, deck, role, diagnostics)
    type(entry_t), intent(in) :: entry
    type(role_t), intent(inout) :: parent
    type(deck_t), intent(inout) :: deck
    type(role_t), intent(inout) :: role
    type(diagnostics_t), intent(inout) :: diagnostics

    role = parent
    role%depth = parent%depth + 1
    call take(entry, deck, role, diagnostics)
    if (role%role == is_skipped) parent%role = is_skipped
  end subroutine take_element

  !> Take an entry into its value; after a mistake the rest of the value is passed over.
  subroutine take(entry, deck, role, diagnostics)
    type(entry_t), intent(in) :: entry
    type(deck_t), intent(inout) :: deck
    type(role_t), intent(inout) :: role
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: message

    associate (value => deck%blocks(role%block)%values(role%value))
      call take_entry(value, deck%table%keys(value%key), entry, role%depth, message)
      if (.not. allocated(message)) return
      value%is_bad = .true.
      role%role = is_skipped
      call deck%complain_at(diagnostics, '"'//trim(deck%table%keys(value%key)%name)//'" '//message, entry%line, entry%column)
    end associate
  end subroutine take

  !> Does an entry hold tables, as `[[outer.inner]]` does?
  pure logical function holds_tables(document, i)
    type(document_t), intent(in) :: document
    integer, intent(in) :: i

    holds_tables = .false.
    if (document%entries(i)%kind /= toml_array .or. i == size(document%entries)) return
    holds_tables = document%entries(i + 1)%parent == i .and. document%entries(i + 1)%kind == toml_table
  end function holds_tables

  !> Report a mistake at the key of an entry.
  subroutine at_key(deck, entry, message, diagnostics)
    type(deck_t), intent(in) :: deck
    type(entry_t), intent(in) :: entry
    character(len=*), intent(in) :: message
    type(diagnostics_t), intent(inout) :: diagnostics

    call deck%complain_at(diagnostics, message, entry%key_line, entry%key_column)
  end subroutine at_key
end module sg_collect
