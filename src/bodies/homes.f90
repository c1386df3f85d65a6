!> Which rank a contact belongs to, from the homes of its two bodies.
module sg_homes
  use sg_kinds, only: i4
  implicit none
  private
  public :: owner_of

contains

  !> The rank that a contact belongs to, from the homes of its two bodies; -1 is the home of wide bodies here.
  !!
  !! Of two ranks now the lower, now the higher one takes all contacts between them: then only grains of the other side
  !! are shared, and loads stay even. What lies between two wide bodies falls to rank 0.
  pure integer function owner_of(home)
    integer(i4), intent(in) :: home(2) !! homes of the two bodies, -1 for wide ones

    owner_of = max(home(1), home(2), 0)
    if (any(home < 0)) return
    if (modulo(home(1) + home(2), 2) == 1) owner_of = minval(home)
  end function owner_of
end module sg_homes
