!> How deep shapes enter one another at the detection configuration.
module sg_penetration
  use sg_contacts, only: contacts_t
  use sg_extremes, only: lowest_value
  use sg_kinds, only: wp
  use sg_tally, only: pass_columns, pass_largest, pass_sums, ratio, tally_t
  implicit none
  private
  public :: measure_penetration, deepest_penetration

contains

  !> Mean and largest penetration [m].
  pure subroutine measure_penetration(contacts, tally)
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    type(tally_t), intent(inout) :: tally !! tally of the measure
    real(wp) :: sums(2), largest(1)

    select case (tally%pass)
    case (pass_largest)
      call tally%largest%put('penetration', [deepest_penetration(contacts)])
    case (pass_sums)
      call tally%sums%put('penetration', penetration_sums(contacts))
    case (pass_columns)
      sums = tally%sums%get('penetration', size(sums))
      largest = tally%largest%get('penetration', 1)
      call tally%add('mean_penetration', ratio(sums(2), sums(1)))
      call tally%add('max_penetration', largest(1))
    end select
  end subroutine measure_penetration

  !> Number of contacts of this rank whose gap is negative, and sum of their penetrations [m].
  pure function penetration_sums(contacts) result(sums)
    type(contacts_t), intent(in) :: contacts
    real(wp) :: sums(2)
    integer :: k

    sums = 0
    if (contacts%n > 0) sums(1) = real(count(contacts%gap(:contacts%n) < 0), wp)
    ! To add nothing for gaps that are open takes less time than to guess which ones are.
    do k = 1, contacts%n
      sums(2) = sums(2) - min(0.0_wp, contacts%gap(k))
    end do
  end function penetration_sums

  !> Largest penetration alone [m], cheap enough for every step; zero without any.
  pure real(wp) function deepest_penetration(contacts) result(largest)
    type(contacts_t), intent(in) :: contacts !! contacts of the step

    largest = 0
    if (contacts%n > 0) largest = max(0.0_wp, -lowest_value(contacts%n, contacts%gap))
  end function deepest_penetration
end module sg_penetration
