!> How deep shapes enter one another at the detection configuration.
module sg_penetration
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp
  implicit none
  private
  public :: penetration_sums, deepest_penetration

contains

  !> Number of contacts of this rank whose gap is negative, and sum of their penetrations [m].
  pure function penetration_sums(contacts) result(sums)
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    real(wp) :: sums(2)
    integer :: k

    sums = 0
    do k = 1, contacts%n
      if (.not. contacts%gap(k) < 0) cycle
      sums(1) = sums(1) + 1
      sums(2) = sums(2) - contacts%gap(k)
    end do
  end function penetration_sums

  !> Largest penetration alone [m], cheap enough for every step; zero without any.
  pure real(wp) function deepest_penetration(contacts) result(largest)
    type(contacts_t), intent(in) :: contacts !! contacts of the step

    largest = 0
    if (contacts%n > 0) largest = max(0.0_wp, -minval(contacts%gap(:contacts%n)))
  end function deepest_penetration
end module sg_penetration
