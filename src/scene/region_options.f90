!> A region as a deck asks for it: a box in which indicators are measured (doc/guide/regions.md).
module sg_region_options
  use sg_kinds, only: wp
  implicit none
  private
  public :: region_options_t

  !> One region
  type :: region_options_t
    !> Name in regions.csv
    character(len=:), allocatable :: name
    !> Least and largest coordinates of the box [m]; in the plane from 0 to 1 along z
    real(wp) :: lower(3) = 0, upper(3) = 1
  end type region_options_t
end module sg_region_options
