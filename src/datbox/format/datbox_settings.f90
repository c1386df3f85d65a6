!> Keys of a deck that files next to a DATBOX give, with where each was found: time step, solver, tracked bodies, interfaces.
module sg_datbox_settings
  use sg_kinds, only: wp
  use sg_numerals, only: read_real
  use sg_text, only: append_word, text_t
  use sg_words, only: quoted_string
  implicit none
  private
  public :: datbox_settings_t

  !> Values of keys, in the order in which they were found first
  type :: datbox_settings_t
    !> Keys as `section.key`, their values as TOML, and what stands behind each as a comment (empty for none)
    type(text_t), allocatable :: keys(:), values(:), notes(:)
    !> Numbers of bodies to track
    integer, allocatable :: tracked(:)
    !> Numbers of two bodies whose contacts are summed, shape (2, pairs)
    integer, allocatable :: pairs(:, :)
  contains
    procedure :: put => settings_put
    procedure :: put_setting => settings_put_setting
    procedure :: track => settings_track
    procedure :: add_pair => settings_add_pair
    procedure :: section_text => settings_section_text
    procedure, private :: place_of => settings_place_of
  end type datbox_settings_t

contains

  !> Set a key; the last value holds.
  pure subroutine settings_put(self, key, value, note)
    class(datbox_settings_t), intent(inout) :: self
    character(len=*), intent(in) :: key !! `section.key`
    character(len=*), intent(in) :: value !! value as TOML
    character(len=*), intent(in) :: note !! where it was found; empty for nothing to state
    integer :: i

    i = self%place_of(key)
    if (i > 0) then
      self%values(i)%s = value
      self%notes(i)%s = note
      return
    end if
    call append_word(self%keys, key)
    call append_word(self%values, value)
    call append_word(self%notes, note)
  end subroutine settings_put

  !> Set a key by a setting of the command line, `section.key=value # note`; words need no quotes.
  subroutine settings_put_setting(self, setting, is_setting)
    class(datbox_settings_t), intent(inout) :: self
    character(len=*), intent(in) :: setting !! the setting
    logical, intent(out) :: is_setting !! is it of this form?
    character(len=:), allocatable :: key, value, note
    integer :: equals, hash

    equals = index(setting, '=')
    is_setting = equals > 1
    if (.not. is_setting) return
    key = trim(adjustl(setting(:equals - 1)))
    value = trim(adjustl(setting(equals + 1:)))
    hash = index(value, ' # ')
    note = ''
    if (hash > 0) then
      note = trim(value(hash + 3:))
      value = trim(value(:hash - 1))
    end if
    is_setting = index(key, '.') > 1 .and. index(key, '.') < len(key) .and. len(value) > 0
    if (is_setting) call self%put(key, as_toml(value), note)
  end subroutine settings_put_setting

  !> Track a body, once.
  pure subroutine settings_track(self, body)
    class(datbox_settings_t), intent(inout) :: self
    integer, intent(in) :: body !! number of the body
    integer, allocatable :: grown(:)
    integer :: n

    n = 0
    if (allocated(self%tracked)) n = size(self%tracked)
    if (n > 0) then
      if (any(self%tracked == body)) return
    end if
    allocate (grown(n + 1))
    if (n > 0) grown(:n) = self%tracked
    grown(n + 1) = body
    call move_alloc(grown, self%tracked)
  end subroutine settings_track

  !> Sum the contacts of a pair of bodies, once.
  pure subroutine settings_add_pair(self, pair)
    class(datbox_settings_t), intent(inout) :: self
    integer, intent(in) :: pair(2) !! numbers of the two bodies
    integer, allocatable :: grown(:, :)
    integer :: i, n

    n = 0
    if (allocated(self%pairs)) n = size(self%pairs, 2)
    do i = 1, n
      if (all(self%pairs(:, i) == pair) .or. all(self%pairs(:, i) == pair([2, 1]))) return
    end do
    allocate (grown(2, n + 1))
    if (n > 0) grown(:, :n) = self%pairs
    grown(:, n + 1) = pair
    call move_alloc(grown, self%pairs)
  end subroutine settings_add_pair

  !> A section of the deck, with its heading and a line per key; empty where it has no key.
  pure function settings_section_text(self, section) result(text)
    class(datbox_settings_t), intent(in) :: self
    character(len=*), intent(in) :: section !! name of the section
    character(len=:), allocatable :: text
    character(len=*), parameter :: nl = new_line('a')
    integer :: i

    text = ''
    if (.not. allocated(self%keys)) return
    do i = 1, size(self%keys)
      if (index(self%keys(i)%s, section//'.') /= 1) cycle
      text = text//self%keys(i)%s(len(section) + 2:)//' = '//self%values(i)%s
      if (len(self%notes(i)%s) > 0) text = text//'  # '//self%notes(i)%s
      text = text//nl
    end do
    if (len(text) > 0) text = nl//'['//section//']'//nl//text
  end function settings_section_text

  !> Place of a key in the list; 0 for none.
  pure integer function settings_place_of(self, key) result(place)
    class(datbox_settings_t), intent(in) :: self
    character(len=*), intent(in) :: key !! `section.key`

    place = 0
    if (.not. allocated(self%keys)) return
    do place = size(self%keys), 1, -1
      if (self%keys(place)%s == key) return
    end do
  end function settings_place_of

  !> A value as TOML: as it stands where it is a number, a list, a string or true or false, else as a string.
  function as_toml(text) result(toml)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: toml
    real(wp) :: number
    logical :: is_number

    call read_real(text, number, is_number)
    toml = text
    if (is_number .or. scan(text(1:1), '["''{') > 0 .or. text == 'true' .or. text == 'false') return
    toml = quoted_string(text)
  end function as_toml
end module sg_datbox_settings
