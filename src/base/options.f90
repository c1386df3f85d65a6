!> Options of a method, and the visitors that go through them.
!!
!! A method lists each of its options once: `call visitor%option(option_t(name, sentence, ...), component)`. The key table, which is
!! such a visitor, makes a key of each, with the value of the component as default; values read from a deck, another visitor, fill
!! the components.
module sg_options
  use sg_kinds, only: wp
  implicit none
  private
  public :: option_t, option_visitor_t, option_values_t

  !> An option and its key in decks
  type :: option_t
    !> Name of its key, and one sentence: what it is
    character(len=24) :: name = ''
    character(len=280) :: sentence = ''
    !> Unit of a number, empty for none
    character(len=24) :: unit = ''
    !> Range of a number: least and largest allowed, and what it must be larger than
    real(wp) :: least = -huge(1.0_wp), most = huge(1.0_wp), above = -huge(1.0_wp)
    !> Words to choose from, with a bar between two
    character(len=400) :: choices = ''
    !> Former key of older decks, `section.key`, still read with a note
    character(len=48) :: former = ''
  end type option_t

  !> Visitor of options
  type, abstract :: option_visitor_t
  contains
    procedure(integer_option), deferred :: integer_option
    procedure(real_option), deferred :: real_option
    procedure(flag_option), deferred :: flag_option
    procedure(word_option), deferred :: word_option
    !> Visit an option
    generic :: option => integer_option, real_option, flag_option, word_option
  end type option_visitor_t

  abstract interface
    !> Visit a whole number.
    subroutine integer_option(self, option, value)
      import :: option_t, option_visitor_t
      class(option_visitor_t), intent(inout) :: self
      type(option_t), intent(in) :: option !! its key
      integer, intent(inout) :: value !! component of the method
    end subroutine integer_option
    !> Visit a number.
    subroutine real_option(self, option, value)
      import :: option_t, option_visitor_t, wp
      class(option_visitor_t), intent(inout) :: self
      type(option_t), intent(in) :: option !! its key
      real(wp), intent(inout) :: value !! component of the method
    end subroutine real_option
    !> Visit a logical.
    subroutine flag_option(self, option, value)
      import :: option_t, option_visitor_t
      class(option_visitor_t), intent(inout) :: self
      type(option_t), intent(in) :: option !! its key
      logical, intent(inout) :: value !! component of the method
    end subroutine flag_option
    !> Visit one of several words.
    subroutine word_option(self, option, value)
      import :: option_t, option_visitor_t
      class(option_visitor_t), intent(inout) :: self
      type(option_t), intent(in) :: option !! its key
      character(len=*), intent(inout) :: value !! component of the method
    end subroutine word_option
  end interface

  !> A value by name: a word, or a number; a logical is 1 or 0
  type :: option_value_t
    character(len=24) :: name = '', word = ''
    real(wp) :: number = 0
  end type option_value_t

  !> Values by name, the visitor that fills options; those without a value keep what they hold
  type, extends(option_visitor_t) :: option_values_t
    type(option_value_t), allocatable, private :: list(:)
  contains
    procedure :: put => values_put
    procedure :: integer_option => values_integer
    procedure :: real_option => values_real
    procedure :: flag_option => values_flag
    procedure :: word_option => values_word
  end type option_values_t

contains

  !> Add a value.
  subroutine values_put(self, name, number, word)
    class(option_values_t), intent(inout) :: self
    character(len=*), intent(in) :: name !! name of the key
    real(wp), intent(in) :: number !! its number; 0 where it has none
    character(len=*), intent(in) :: word !! its word; empty where it has none

    if (.not. allocated(self%list)) allocate (self%list(0))
    self%list = [self%list, option_value_t(name, word, number)]
  end subroutine values_put

  !> Position of the value of an option; 0 when there is none.
  pure integer function place_of(self, option) result(place)
    class(option_values_t), intent(in) :: self
    type(option_t), intent(in) :: option

    place = 0
    if (allocated(self%list)) place = findloc(self%list%name == option%name, .true., 1)
  end function place_of

  !> Fill a whole number.
  subroutine values_integer(self, option, value)
    class(option_values_t), intent(inout) :: self
    type(option_t), intent(in) :: option !! its key
    integer, intent(inout) :: value !! component of the method

    if (place_of(self, option) > 0) value = nint(self%list(place_of(self, option))%number)
  end subroutine values_integer

  !> Fill a number.
  subroutine values_real(self, option, value)
    class(option_values_t), intent(inout) :: self
    type(option_t), intent(in) :: option !! its key
    real(wp), intent(inout) :: value !! component of the method

    if (place_of(self, option) > 0) value = self%list(place_of(self, option))%number
  end subroutine values_real

  !> Fill a logical.
  subroutine values_flag(self, option, value)
    class(option_values_t), intent(inout) :: self
    type(option_t), intent(in) :: option !! its key
    logical, intent(inout) :: value !! component of the method

    if (place_of(self, option) > 0) value = self%list(place_of(self, option))%number > 0
  end subroutine values_flag

  !> Fill a word.
  subroutine values_word(self, option, value)
    class(option_values_t), intent(inout) :: self
    type(option_t), intent(in) :: option !! its key
    character(len=*), intent(inout) :: value !! component of the method

    if (place_of(self, option) > 0) value = self%list(place_of(self, option))%word
  end subroutine values_word
end module sg_options
