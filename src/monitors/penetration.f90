!> How deep shapes enter one another at the detection configuration.
module sg_penetration
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp
  implicit none
  private
  public :: penetrations, deepest_penetration

contains

  !> Mean and largest penetration over the contacts whose gap is negative [m]; zero without any.
  pure subroutine penetrations(contacts, mean, largest)
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    real(wp), intent(out) :: mean !! mean penetration [m]
    real(wp), intent(out) :: largest !! largest penetration [m]
    integer :: k, n

    mean = 0
    largest = 0
    n = 0
    do k = 1, contacts%n
      if (.not. contacts%gap(k) < 0) cycle
      n = n + 1
      mean = mean - contacts%gap(k)
      largest = max(largest, -contacts%gap(k))
    end do
    if (n > 0) mean = mean/real(n, wp)
  end subroutine penetrations

  !> Largest penetration alone [m], cheap enough for every step; zero without any.
  pure real(wp) function deepest_penetration(contacts) result(largest)
    type(contacts_t), intent(in) :: contacts !! contacts of the step

    largest = 0
    if (contacts%n > 0) largest = max(0.0_wp, -minval(contacts%gap(:contacts%n)))
  end function deepest_penetration
end module sg_penetration
