!> Owner rank of a contact, from the owner ranks of its two bodies; rank that counts a body as its own.
module sg_owners
  use sg_kinds, only: i4
  implicit none
  private
  public :: contact_owner, counts_on

contains

  !> The owner rank of a contact, from those of its two bodies; -1 is the owner of replicated bodies here.
  !!
  !! Of two ranks now the lower, now the higher one takes all contacts between them: then only grains of the other side
  !! are shared, and loads stay even. What lies between two replicated bodies falls to rank 0.
  pure integer function contact_owner(owner)
    integer(i4), intent(in) :: owner(2) !! owners of the two bodies, -1 for replicated ones

    contact_owner = max(owner(1), owner(2), 0)
    if (any(owner < 0)) return
    if (modulo(owner(1) + owner(2), 2) == 1) contact_owner = minval(owner)
  end function contact_owner

  !> Does a rank count a body as its own? Grains are counted by their owner ranks; of replicated bodies, which all ranks hold, each
  !! rank counts those whose number modulo the number of ranks is its own.
  pure logical function counts_on(rank, ranks, owner, number)
    integer, intent(in) :: rank !! rank that asks, from 0
    integer, intent(in) :: ranks !! number of ranks
    integer(i4), intent(in) :: owner !! owner of the body, -1 for replicated ones
    integer(i4), intent(in) :: number !! its number in the whole scene

    counts_on = owner == rank .or. (owner < 0 .and. modulo(number, int(ranks, i4)) == rank)
  end function counts_on
end module sg_owners
