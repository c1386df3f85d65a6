!> Which rank a contact belongs to, from the homes of its two bodies, and which rank counts a body as its own.
module sg_homes
  use sg_kinds, only: i4
  implicit none
  private
  public :: owner_of, counts_on

contains

  !> The rank that a contact belongs to, from the homes of its two bodies; -1 is the home of replicated bodies here.
  !!
  !! Of two ranks now the lower, now the higher one takes all contacts between them: then only grains of the other side
  !! are shared, and loads stay even. What lies between two replicated bodies falls to rank 0.
  pure integer function owner_of(home)
    integer(i4), intent(in) :: home(2) !! homes of the two bodies, -1 for replicated ones

    owner_of = max(home(1), home(2), 0)
    if (any(home < 0)) return
    if (modulo(home(1) + home(2), 2) == 1) owner_of = minval(home)
  end function owner_of

  !> Does a rank count a body as its own? Grains at their homes; of replicated bodies, which all ranks hold, each counts those whose
  !! number modulo the number of ranks is its own.
  pure logical function counts_on(rank, ranks, home, number)
    integer, intent(in) :: rank !! rank that asks, from 0
    integer, intent(in) :: ranks !! number of ranks
    integer(i4), intent(in) :: home !! home of the body, -1 for replicated ones
    integer(i4), intent(in) :: number !! its number in the whole scene

    counts_on = home == rank .or. (home < 0 .and. modulo(number, int(ranks, i4)) == rank)
  end function counts_on
end module sg_homes
