!> Words in columns of printed tables.
module sg_columns
  implicit none
  private
  public :: padded, right

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
end module sg_columns
