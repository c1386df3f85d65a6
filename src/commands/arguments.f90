!> The command line: words, options with values, and their mistakes.
module sg_arguments
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp
  use sg_numerals, only: read_integer, read_real
  use sg_text, only: append_word, nearest_word, text_t, to_text
  implicit none
  private
  public :: arguments_t, read_arguments

  !> A command line taken apart
  type :: arguments_t
    !> Subcommand, and the words after it that are no options
    character(len=:), allocatable :: command
    type(text_t), allocatable :: words(:)
    !> Names of the options given, without their dashes, and their values (empty for switches)
    type(text_t), allocatable :: names(:), values(:)
    !> Which of them are switches to which a value was given
    logical, allocatable :: is_overfed(:)
  contains
    procedure :: task => arguments_task
    procedure :: has => arguments_has
    procedure :: get => arguments_get
    procedure :: all_of => arguments_all_of
    procedure :: number => arguments_number
    procedure :: whole => arguments_whole
    procedure :: expect => arguments_expect
    procedure :: refuse_command => arguments_refuse_command
  end type arguments_t

  !> Options that are followed by a value; all others are switches
  character(len=*), parameter :: valued(28) = [character(len=12) :: 'set', 'output', 'restart', 'walltime', 'contacts', 'shape', &
                                               'sweeps', 'order', 'check-every', 'friction', 'parts', 'method', &
                                               'solver', 'tolerance', 'iterations', 'seconds', 'trace', &
                                               'dump', 'boxes', 'picture', 'threads', 'lattice', 'latency', 'bandwidth', &
                                               'epsilon', 'points', 'csv', 'script']

contains

  !> Take the command line apart.
  subroutine read_arguments(arguments, error)
    type(arguments_t), intent(out) :: arguments !! its parts
    type(error_t), allocatable, intent(out) :: error !! set when an option lacks its value
    character(len=:), allocatable :: word, value
    integer :: i, equals

    arguments%command = ''
    allocate (arguments%words(0), arguments%names(0), arguments%values(0), arguments%is_overfed(0))
    i = 1
    do while (i <= command_argument_count())
      word = argument(i)
      i = i + 1
      if (word(:min(1, len(word))) /= '-' .or. len(word) < 2) then
        if (len(arguments%command) == 0) then
          arguments%command = word
        else
          call append_word(arguments%words, word)
        end if
        cycle
      end if
      word = word(verify(word//'.', '-'):)
      value = ''
      equals = index(word, '=')
      if (equals > 0) then
        value = word(equals + 1:)
        word = word(:equals - 1)
      else if (any(valued == word)) then
        call value_after(i, word, value, error)
        if (allocated(error)) return
        i = i + 1
      end if
      call append_word(arguments%names, word)
      call append_word(arguments%values, value)
      arguments%is_overfed = [arguments%is_overfed, equals > 0 .and. all(valued /= word)]
    end do
  end subroutine read_arguments

  !> The word after an option that needs a value. Another option is none: the value was forgotten.
  subroutine value_after(i, name, value, error)
    integer, intent(in) :: i
    character(len=*), intent(in) :: name
    character(len=:), allocatable, intent(out) :: value
    type(error_t), allocatable, intent(out) :: error

    value = ''
    if (i <= command_argument_count()) value = argument(i)
    if (i > command_argument_count()) then
      call fail(error, 'option --'//name//' needs a value after it')
    else if (index(value, '--') == 1) then
      call fail(error, 'option --'//name//' needs a value after it, not the option '//value// &
                '; a value that begins with dashes is written --'//name//'='//value)
    end if
  end subroutine value_after

  !> One word of the command line.
  function argument(i) result(word)
    integer, intent(in) :: i
    character(len=:), allocatable :: word
    integer :: length

    call get_command_argument(i, length=length)
    allocate (character(len=length) :: word)
    call get_command_argument(i, word)
  end function argument

  !> What is asked for: `--help` and `--version`, which go before any subcommand, or else the subcommand.
  pure function arguments_task(self) result(task)
    class(arguments_t), intent(in) :: self
    character(len=:), allocatable :: task

    task = self%command
    if (self%has('version')) task = '--version'
    if (self%has('help') .or. self%has('h') .or. self%command == 'help') task = '--help'
  end function arguments_task

  !> Was an option given?
  pure logical function arguments_has(self, name) result(has)
    class(arguments_t), intent(in) :: self
    character(len=*), intent(in) :: name !! without dashes
    integer :: i

    has = .false.
    do i = 1, size(self%names)
      has = has .or. self%names(i)%s == name
    end do
  end function arguments_has

  !> Value of an option, the last one given; a default when there is none.
  pure function arguments_get(self, name, default) result(value)
    class(arguments_t), intent(in) :: self
    character(len=*), intent(in) :: name !! without dashes
    character(len=*), intent(in) :: default !! when it was not given
    character(len=:), allocatable :: value
    integer :: i

    value = default
    do i = 1, size(self%names)
      if (self%names(i)%s == name) value = self%values(i)%s
    end do
  end function arguments_get

  !> All values of an option that may be given several times.
  pure function arguments_all_of(self, name) result(values)
    class(arguments_t), intent(in) :: self
    character(len=*), intent(in) :: name !! without dashes
    type(text_t), allocatable :: values(:)
    integer :: i

    allocate (values(0))
    do i = 1, size(self%names)
      if (self%names(i)%s == name) call append_word(values, self%values(i)%s)
    end do
  end function arguments_all_of

  !> Value of an option as a number from `least`, a whole number, to the largest integer.
  subroutine arguments_number(self, name, default, least, value, error)
    class(arguments_t), intent(in) :: self
    character(len=*), intent(in) :: name !! without dashes
    real(wp), intent(in) :: default !! when it was not given
    real(wp), intent(in) :: least !! smallest value allowed
    real(wp), intent(out) :: value !! the number
    type(error_t), allocatable, intent(out) :: error !! set when it is no such number
    logical :: is_number

    value = default
    if (.not. self%has(name)) return
    call read_real(self%get(name, ''), value, is_number)
    if (is_number .and. value >= least .and. value <= huge(1)) return
    call refuse(self, name, 'a number', nint(least), error)
  end subroutine arguments_number

  !> Value of an option as a whole number from `least` to the largest integer.
  subroutine arguments_whole(self, name, default, least, value, error)
    class(arguments_t), intent(in) :: self
    character(len=*), intent(in) :: name !! without dashes
    integer, intent(in) :: default !! when it was not given
    integer, intent(in) :: least !! smallest value allowed
    integer, intent(out) :: value !! the number
    type(error_t), allocatable, intent(out) :: error !! set when it is no such number
    logical :: is_number

    value = default
    if (.not. self%has(name)) return
    call read_integer(self%get(name, ''), value, is_number)
    if (is_number .and. value >= least) return
    call refuse(self, name, 'a whole number', least, error)
  end subroutine arguments_whole

  !> Refuse the value of an option.
  subroutine refuse(self, name, kind, least, error)
    type(arguments_t), intent(in) :: self
    character(len=*), intent(in) :: name, kind
    integer, intent(in) :: least
    type(error_t), allocatable, intent(out) :: error

    call fail(error, 'option --'//name//' needs '//kind//' of at least '//to_text(least)//' and at most '// &
              to_text(huge(1))//', not "'//self%get(name, '')//'"')
  end subroutine refuse

  !> Refuse options that the command does not have, values of switches, and a wrong number of words.
  subroutine arguments_expect(self, known, fewest, most, usage, error)
    class(arguments_t), intent(in) :: self
    character(len=*), intent(in) :: known !! names of the known options, with a blank between two
    integer, intent(in) :: fewest !! fewest words
    integer, intent(in) :: most !! most words
    character(len=*), intent(in) :: usage !! printed when the number of words is wrong
    type(error_t), allocatable, intent(out) :: error !! set when something is wrong
    character(len=:), allocatable :: near
    integer :: i

    do i = 1, size(self%names)
      if (index(' '//known//' ', ' '//self%names(i)%s//' ') > 0) then
        if (self%is_overfed(i)) then
          call fail(error, 'option --'//self%names(i)%s//' takes no value, not "'//self%values(i)%s//'"')
        else if (any(valued == self%names(i)%s) .and. len_trim(self%values(i)%s) == 0) then
          call fail(error, 'option --'//self%names(i)%s//' needs a value that is not empty')
        end if
        if (.not. allocated(error)) cycle
        return
      end if
      near = nearest_word(self%names(i)%s, split(known))
      if (len(near) > 0) near = '; did you mean --'//near//'?'
      call fail(error, 'unknown option --'//self%names(i)%s//' of '//self%command//near)
      return
    end do
    if (size(self%words) < fewest .or. size(self%words) > most) call fail(error, 'usage: splitgrain '//usage)
  end subroutine arguments_expect

  !> Refuse a subcommand that is none of those known.
  subroutine arguments_refuse_command(self, known, error)
    class(arguments_t), intent(in) :: self
    character(len=*), intent(in) :: known !! names of the subcommands, with a blank between two
    type(error_t), allocatable, intent(out) :: error !! set always
    character(len=:), allocatable :: near

    near = nearest_word(self%command, split(known))
    if (len(near) > 0) near = '; did you mean "'//near//'"?'
    call fail(error, 'unknown command "'//self%command//'"'//near)
  end subroutine arguments_refuse_command

  !> Words of a text.
  pure function split(text) result(words)
    character(len=*), intent(in) :: text
    type(text_t), allocatable :: words(:)
    integer :: first, blank

    allocate (words(0))
    first = 1
    do while (first <= len(text))
      blank = index(text(first:)//' ', ' ')
      if (blank > 1) call append_word(words, text(first:first + blank - 2))
      first = first + blank
    end do
  end function split
end module sg_arguments
