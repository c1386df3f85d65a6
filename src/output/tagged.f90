!> Tagged numbers: results of a run as text with names, for regression tests that compare quantity by quantity
!! (tests/decks/run_cases.py).
!!
!! A quantity is a line `name kind size`, then `size` numbers, one per line with 17 digits. The kind selects the tolerance
!! of the quantity: for instance `energy`, `count` or `position`.
module sg_tagged
  use sg_kinds, only: wp
  use sg_text, only: to_text
  implicit none
  private
  public :: tagged_text

contains

  !> A quantity as lines of text, each with its end.
  pure function tagged_text(name, kind, values) result(text)
    character(len=*), intent(in) :: name !! of the quantity, one word
    character(len=*), intent(in) :: kind !! chooses the tolerance, one word
    real(wp), intent(in) :: values(:) !! the numbers
    character(len=:), allocatable :: text
    integer :: i

    text = name//' '//kind//' '//to_text(size(values))//new_line('a')
    do i = 1, size(values)
      text = text//to_text(values(i))//new_line('a')
    end do
  end function tagged_text
end module sg_tagged
