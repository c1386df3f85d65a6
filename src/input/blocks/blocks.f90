!> A deck as blocks of values: what is left of the text once it is checked against the key table.
!!
!! Sections that stand once ([time], [solver], ...) are always there, with their defaults; `[[body]]` and the like
!! are one block each, in the order of the text, a `[[body.shape]]` after the body it belongs to.
module sg_blocks
  use sg_census, only: census_t
  use sg_error, only: diagnostics_t
  use sg_key_table, only: in_both, key_t, key_table_t
  use sg_kinds, only: wp, i4
  use sg_text, only: nearest_word, text_t
  use sg_toml, only: line_of
  use sg_values, only: from_default, from_setting, value_t
  use sg_words, only: is_choice
  implicit none
  private
  public :: block_t, deck_t

  !> Mistakes listed at most: a deck with more has one cause
  integer, parameter :: most_mistakes = 100

  !> One section of a deck
  type :: block_t
    !> Section of the key table
    integer :: section = 0
    !> Block that holds this one; 0 for none
    integer :: parent = 0
    !> Place of its header
    integer :: line = 0, column = 0
    !> Values given, shape (n)
    type(value_t), allocatable :: values(:)
    integer :: n = 0
    !> First and last of the bodies made of it; 0 where it makes none
    integer :: first_body = 0, last_body = 0
    !> Does it stand in a stage, whose times count from its start?
    logical :: is_of_stage = .false.
  end type block_t

  !> A deck
  type :: deck_t
    !> File, folder that its paths are relative to (ends with a slash, or empty), and text
    character(len=:), allocatable :: file, folder, content
    !> What a deck may hold, and the default of each key
    type(key_table_t) :: table
    type(value_t), allocatable :: defaults(:)
    !> Blocks, shape (n)
    type(block_t), allocatable :: blocks(:)
    integer :: n = 0
    !> What stages change: sections within `[[stage]]`, whose parent is the block of the stage
    type(block_t), allocatable :: changes(:)
    !> Do laws of any stage resist rolling or twisting?
    logical :: bears_moments = .false.
    !> In the deck of a stage: its number, when it begins [s], and its steps
    integer :: stage_number = 0
    real(wp) :: stage_time = 0
    integer :: stage_steps = 0
    !> Dimension of the scene
    integer :: dimension = 2
    !> Numbers of the bodies that have a name, ascending, and their names
    integer, allocatable :: named(:)
    type(text_t), allocatable :: names(:)
    !> Numbers of the bodies that the DRV_DOF.DAT of a DATBOX drives, ascending; unallocated where there is none
    integer(i4), allocatable :: driven(:)
    !> Number of the bodies of a DATBOX: those of the deck are numbered behind them
    integer :: folder_bodies = 0
    !> The rank that reads, and the number of ranks: of the bodies it keeps a share; `absent` describes the others
    integer :: rank = 0, ranks = 1
    type(census_t) :: absent
    !> Number of all contactors, whoever keeps them
    integer :: contactors = 0
  contains
    procedure :: block_of
    procedure :: block_of_body
    procedure :: is_in
    procedure :: is_in_stage
    procedure :: count_of
    procedure :: is_given
    procedure :: applies
    procedure :: value => deck_value
    procedure :: number => deck_number
    procedure :: pair => deck_pair
    procedure :: vector => deck_vector
    procedure :: integer => deck_integer
    procedure :: flag => deck_flag
    procedure :: word => deck_word
    procedure :: put => deck_put
    procedure :: add_block
    procedure :: give_numbers
    procedure :: complain
    procedure :: complain_unknown
    procedure :: complain_at
    procedure :: heading
    procedure :: warn => deck_warn
  end type deck_t

contains

  !> First block of a section; 0 when there is none.
  pure integer function block_of(self, section) result(block)
    class(deck_t), intent(in) :: self
    character(len=*), intent(in) :: section !! name of the section

    do block = 1, self%n
      if (self%is_in(block, section)) return
    end do
    block = 0
  end function block_of

  !> Block that a body comes from: the one whose last body is the next; 0 for a body of a DATBOX.
  pure integer function block_of_body(self, body) result(block)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: body !! number of the body

    associate (blocks => self%blocks(:self%n))
      block = minloc(blocks%last_body, 1, blocks%first_body <= body .and. blocks%last_body >= body)
    end associate
  end function block_of_body

  !> Does a block belong to a section?
  pure logical function is_in(self, block, section)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block !! index of the block
    character(len=*), intent(in) :: section !! name of the section

    is_in = self%table%sections(self%blocks(block)%section)%name == section
  end function is_in

  !> Does a block stand within a stage? Only while the text is read: then they stand apart.
  pure logical function is_in_stage(self, block)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block !! index of the block
    integer :: outer

    is_in_stage = .false.
    outer = self%blocks(block)%parent
    do while (outer > 0 .and. .not. is_in_stage)
      is_in_stage = self%is_in(outer, 'stage')
      outer = self%blocks(outer)%parent
    end do
  end function is_in_stage

  !> Number of blocks of a section.
  pure integer function count_of(self, section) result(count)
    class(deck_t), intent(in) :: self
    character(len=*), intent(in) :: section !! name of the section
    integer :: i

    count = 0
    do i = 1, self%n
      if (self%is_in(i, section)) count = count + 1
    end do
  end function count_of

  !> Position of a key among the values of a block; 0 when it is not given.
  pure integer function given(self, block, name) result(position)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block
    character(len=*), intent(in) :: name

    do position = 1, self%blocks(block)%n
      if (self%table%keys(self%blocks(block)%values(position)%key)%name == name) return
    end do
    position = 0
  end function given

  !> Is a key given by the deck or by a setting?
  pure logical function is_given(self, block, name)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block !! index of the block
    character(len=*), intent(in) :: name !! name of the key

    is_given = given(self, block, name) > 0
  end function is_given

  !> Does a key apply to a block, by the dimension and the word of its selector?
  pure logical function applies(self, block, key)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block !! index of the block
    type(key_t), intent(in) :: key !! line of the key table

    applies = key%dimension == in_both .or. key%dimension == self%dimension
    if (.not. applies .or. key%selector == '') return
    if (key%only == '') then
      applies = self%is_given(block, trim(key%selector))
    else
      applies = is_choice(self%word(block, trim(key%selector)), trim(key%only))
    end if
  end function applies

  !> Value of a key: as given, or its default, or empty.
  pure function deck_value(self, block, name) result(value)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block !! index of the block
    character(len=*), intent(in) :: name !! name of the key
    type(value_t) :: value
    integer :: position

    position = given(self, block, name)
    if (position > 0) then
      value = self%blocks(block)%values(position)
    else
      value = self%defaults(self%table%find_key(self%blocks(block)%section, name))
    end if
  end function deck_value

  !> A number, in the unit of the key table.
  pure real(wp) function deck_number(self, block, name) result(number)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block !! index of the block
    character(len=*), intent(in) :: name !! name of the key
    type(value_t) :: value

    value = self%value(block, name)
    number = value%numbers(1)
  end function deck_number

  !> Two numbers; one given stands for both.
  pure function deck_pair(self, block, name) result(pair)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block !! index of the block
    character(len=*), intent(in) :: name !! name of the key
    real(wp) :: pair(2)
    type(value_t) :: value

    value = self%value(block, name)
    pair = value%numbers([1, value%n])
  end function deck_pair

  !> The first three numbers; those that are not there are zero.
  pure function deck_vector(self, block, name) result(vector)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block !! index of the block
    character(len=*), intent(in) :: name !! name of the key
    real(wp) :: vector(3)
    type(value_t) :: value
    integer :: n

    value = self%value(block, name)
    n = min(3, value%n)
    vector = 0
    vector(:n) = value%numbers(:n)
  end function deck_vector

  !> A whole number.
  pure integer function deck_integer(self, block, name) result(number)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block !! index of the block
    character(len=*), intent(in) :: name !! name of the key

    number = nint(self%number(block, name))
  end function deck_integer

  !> A logical.
  pure logical function deck_flag(self, block, name) result(flag)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block !! index of the block
    character(len=*), intent(in) :: name !! name of the key

    flag = self%number(block, name) > 0
  end function deck_flag

  !> A word; empty when it is not given and has no default.
  pure function deck_word(self, block, name) result(word)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block !! index of the block
    character(len=*), intent(in) :: name !! name of the key
    character(len=:), allocatable :: word
    type(value_t) :: value

    value = self%value(block, name)
    word = ''
    if (value%n_words > 0) word = value%words(1)%s
  end function deck_word

  !> Put a value into a block, in place of one that is there.
  subroutine deck_put(self, block, value)
    class(deck_t), intent(inout) :: self
    integer, intent(in) :: block !! index of the block
    type(value_t), intent(in) :: value !! value with its key and origin
    type(value_t), allocatable :: grown(:)
    integer :: i

    associate (here => self%blocks(block))
      do i = 1, here%n
        if (here%values(i)%key == value%key) exit
      end do
      if (i > size(here%values)) then
        allocate (grown(i))
        grown(:here%n) = here%values(:here%n)
        call move_alloc(grown, here%values)
      end if
      here%values(i) = value
      here%n = max(here%n, i)
    end associate
  end subroutine deck_put

  !> Add a block behind all others.
  subroutine add_block(self, block)
    class(deck_t), intent(inout) :: self
    type(block_t), intent(in) :: block !! the block; a copy of one of the deck must be a copy
    type(block_t), allocatable :: more(:)

    if (self%n == size(self%blocks)) then
      allocate (more(2*self%n + 1))
      more(:self%n) = self%blocks(:self%n)
      call move_alloc(more, self%blocks)
    end if
    self%n = self%n + 1
    self%blocks(self%n) = block
  end subroutine add_block

  !> Give numbers that the deck left open, so that the effective deck holds them.
  subroutine give_numbers(self, block, name, numbers)
    class(deck_t), intent(inout) :: self
    integer, intent(in) :: block !! index of the block
    character(len=*), intent(in) :: name !! name of the key
    real(wp), intent(in) :: numbers(:) !! the numbers; one alone is no list
    type(value_t) :: value

    value%key = self%table%find_key(self%blocks(block)%section, name)
    value%origin = from_default
    value%is_list = size(numbers) > 1
    value%n = size(numbers)
    value%numbers = numbers
    call self%put(block, value)
  end subroutine give_numbers

  !> A section as it is written: `[name]` or `[[name]]`.
  pure function heading(self, section)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: section !! section of the key table
    character(len=:), allocatable :: heading

    heading = 'the top of the deck'
    if (self%table%sections(section)%name == '') return
    heading = '['//trim(self%table%sections(section)%name)//']'
    if (self%table%sections(section)%is_list) heading = '['//heading//']'
  end function heading

  !> Report a mistake at a block, or at the value of one of its keys.
  subroutine complain(self, diagnostics, message, block, name)
    class(deck_t), intent(in) :: self
    type(diagnostics_t), intent(inout) :: diagnostics !! list to add to
    character(len=*), intent(in) :: message !! one sentence
    integer, intent(in) :: block !! block at fault
    character(len=*), intent(in), optional :: name !! key at fault
    integer :: line, column
    logical :: is_setting

    call place_of(self, block, name, line, column, is_setting)
    if (is_setting) then
      call diagnostics%add(message, file='--set')
    else
      call self%complain_at(diagnostics, message, line, column)
    end if
  end subroutine complain

  !> Add a mistake: a name that nothing has, with the nearest one that something has.
  subroutine complain_unknown(self, diagnostics, what, word, known, block, name)
    class(deck_t), intent(in) :: self
    type(diagnostics_t), intent(inout) :: diagnostics !! list to add to
    character(len=*), intent(in) :: what !! kind of thing, such as `law`
    character(len=*), intent(in) :: word !! the name
    type(text_t), intent(in) :: known(:) !! names that there are
    integer, intent(in) :: block !! block concerned
    character(len=*), intent(in) :: name !! key whose value is wrong
    character(len=:), allocatable :: near

    near = nearest_word(word, known)
    if (near /= '') near = '; did you mean "'//near//'"?'
    call self%complain(diagnostics, 'there is no '//what//' named "'//word//'"'//near, block, name)
  end subroutine complain_unknown

  !> Report a mistake at a place of the deck.
  subroutine complain_at(self, diagnostics, message, line, column)
    class(deck_t), intent(in) :: self
    type(diagnostics_t), intent(inout) :: diagnostics !! list to add to
    character(len=*), intent(in) :: message !! one sentence
    integer, intent(in) :: line !! line at fault; 0 when there is none
    integer, intent(in) :: column !! column at fault

    if (diagnostics%count() > most_mistakes) return
    if (diagnostics%count() == most_mistakes) then
      call diagnostics%add('more mistakes follow, which are not listed', file=self%file)
    else if (line > 0) then
      call diagnostics%add(message, file=self%file, line=line, column=column, text=line_of(self%content, line))
    else
      call diagnostics%add(message, file=self%file)
    end if
  end subroutine complain_at

  !> Report something harmless.
  subroutine deck_warn(self, diagnostics, message, block, name, kind)
    class(deck_t), intent(in) :: self
    type(diagnostics_t), intent(inout) :: diagnostics !! list to add to
    character(len=*), intent(in) :: message !! one sentence
    integer, intent(in) :: block !! block concerned
    character(len=*), intent(in), optional :: name !! key concerned
    character(len=*), intent(in), optional :: kind !! kind of finding, of which the first stands for all
    integer :: line, column
    logical :: is_setting

    if (allocated(diagnostics%warnings)) then
      if (size(diagnostics%warnings) >= most_mistakes) return
    end if
    call place_of(self, block, name, line, column, is_setting)
    if (is_setting) then
      call diagnostics%warn(message, file='--set', kind=kind)
    else if (line > 0) then
      call diagnostics%warn(message, file=self%file, line=line, column=column, text=line_of(self%content, line), kind=kind)
    else
      call diagnostics%warn(message, file=self%file, kind=kind)
    end if
  end subroutine deck_warn

  !> Where a block, or a value of it, stands in the deck.
  pure subroutine place_of(self, block, name, line, column, is_setting)
    class(deck_t), intent(in) :: self
    integer, intent(in) :: block
    character(len=*), intent(in), optional :: name
    integer, intent(out) :: line, column
    logical, intent(out) :: is_setting
    integer :: position

    line = self%blocks(block)%line
    column = self%blocks(block)%column
    is_setting = .false.
    if (.not. present(name)) return
    position = given(self, block, name)
    if (position == 0) return
    line = self%blocks(block)%values(position)%line
    column = self%blocks(block)%values(position)%column
    is_setting = self%blocks(block)%values(position)%origin == from_setting
  end subroutine place_of
end module sg_blocks
