!> Numbers from words, read strictly: the whole word is one number, without blanks, repeat counts or separators that Fortran's
!! list-directed reading takes for a value.
module sg_numerals
  use sg_kinds, only: wp
  implicit none
  private
  public :: read_real, read_integer, is_integer_word

  !> Longest number: more than any double needs
  integer, parameter :: longest = 40
  !> Largest decimal exponent: with forty digits before it a double still holds the number, and no reading overflows
  integer, parameter :: largest_exponent = 200
  character(len=*), parameter :: digits = '0123456789'

contains

  !> A word as a real: sign, digits with at most one point, exponent (`e` or `d`).
  subroutine read_real(word, value, is_number)
    character(len=*), intent(in) :: word !! the word
    real(wp), intent(out) :: value !! the number, zero when the word is none
    logical, intent(out) :: is_number !! is the word one finite number?
    integer :: mark, exponent, status

    value = 0
    mark = scan(word//'e', 'eEdD')
    is_number = len(word) <= longest .and. is_mantissa(word(:mark - 1))
    if (is_number .and. mark <= len(word)) then
      call read_integer(word(mark + 1:), exponent, is_number)
      is_number = is_number .and. exponent <= largest_exponent
    end if
    if (.not. is_number) return
    read (word, *, iostat=status) value
    is_number = status == 0
    if (.not. is_number) value = 0
  end subroutine read_real

  !> A word as an integer: sign, digits.
  subroutine read_integer(word, value, is_number)
    character(len=*), intent(in) :: word !! the word
    integer, intent(out) :: value !! the number, zero when the word is none
    logical, intent(out) :: is_number !! is the word one integer that fits?
    integer :: status

    value = 0
    is_number = is_integer_word(word)
    if (.not. is_number) return
    read (word, *, iostat=status) value
    is_number = status == 0
    if (.not. is_number) value = 0
  end subroutine read_integer

  !> Is a word an optional sign, then digits, of any size?
  pure logical function is_integer_word(word)
    character(len=*), intent(in) :: word !! the word
    integer :: first

    first = first_digit(word)
    is_integer_word = len(word) >= first
    if (is_integer_word) is_integer_word = verify(word(first:), digits) == 0
  end function is_integer_word

  !> Is a word an optional sign, then digits with at most one point among them?
  pure logical function is_mantissa(word)
    character(len=*), intent(in) :: word
    integer :: first, point

    first = first_digit(word)
    point = index(word, '.')
    if (point == 0) then
      is_mantissa = is_integer_word(word)
    else
      is_mantissa = point >= first .and. len(word) > first
      if (is_mantissa) is_mantissa = verify(word(first:point - 1)//word(point + 1:), digits) == 0
    end if
  end function is_mantissa

  !> Place of the first letter after an optional sign.
  pure integer function first_digit(word) result(first)
    character(len=*), intent(in) :: word

    first = 1
    if (len(word) > 0) first = merge(2, 1, scan(word(1:1), '+-') > 0)
  end function first_digit
end module sg_numerals
