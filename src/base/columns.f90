!> Words in columns of printed tables, and numbers as such words.
module sg_columns
  use sg_kinds, only: wp
  use sg_text, only: to_text
  implicit none
  private
  public :: padded, right, fixed

contains

  !> A word at the left of a column, with blanks behind; a longer one stays whole.
  pure function padded(word, width) result(text)
    character(len=*), intent(in) :: word !! what to print
    integer, intent(in) :: width !! characters of the column
    character(len=:), allocatable :: text
    integer :: length

    length = max(width, len(word))
    allocate (character(len=length) :: text)
    text(:) = word
  end function padded

  !> A word at the right of a column, with blanks before; a longer one stays whole.
  pure function right(word, width) result(text)
    character(len=*), intent(in) :: word !! what to print
    integer, intent(in) :: width !! characters of the column
    character(len=:), allocatable :: text

    text = adjustr(padded(word, width))
  end function right

  !> A number with a number of decimals.
  pure function fixed(value, decimals) result(word)
    real(wp), intent(in) :: value !! any number
    integer, intent(in) :: decimals !! digits behind the point
    character(len=:), allocatable :: word
    character(len=40) :: buffer

    write (buffer, '(f40.'//to_text(decimals)//')') value
    word = trim(adjustl(buffer))
  end function fixed
end module sg_columns
