!> Sums that the errors of a solution are made of (sg_residuals), over contacts side by side: error_lanes.cpp holds them.
module sg_error_lanes
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  implicit none
  private
  public :: groups_of_bound, measure_lanes, lanes_of_disks, lanes_of_arms, lanes_of_balls, lanes_of_plain_disks

  !> Groups that share a bound
  integer, parameter :: groups_of_bound = 16
  !> Kinds of contacts side by side
  integer(c_int), parameter :: lanes_of_disks = 0, lanes_of_arms = 1, lanes_of_balls = 2, lanes_of_plain_disks = 3

  interface
    !> Measure groups of contacts. The result is 0 where a record is not there, since its contact takes no part; else 1.
    integer(c_int) function measure_lanes(kind, n_groups, length, group_size, pair, record, shared, impulse, body, &
                                          with_e1, sums, closing, bounds) bind(c, name='sg_measure_lanes')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: kind !! one of the kinds above
      integer(c_int), intent(in), value :: n_groups !! groups
      integer(c_int), intent(in), value :: length !! reals of a lane
      integer(c_int), intent(in) :: group_size(*) !! contacts of each group
      integer(c_int), intent(in) :: pair(*) !! slots, shape (lanes, 2, groups)
      real(c_double), intent(in) :: record(*) !! records of lanes, shape (lanes, length, groups)
      real(c_double), intent(in) :: shared(2) !! what plain records of disks share
      real(c_double), intent(in) :: impulse(*) !! impulses [N s], shape (lanes, components, groups)
      real(c_double), intent(in) :: body(*) !! records of bodies
      integer(c_int), intent(in), value :: with_e1 !! 1 where e1 and bounds are wanted too, else 0
      real(c_double), intent(out) :: sums(6) !! as those of `sum_errors`
      real(c_double), intent(inout) :: closing(*) !! what determines the active set (sg_active_set), shape (lanes, groups)
      real(c_double), intent(inout) :: bounds(*) !! bound of each run of groups, where e1 is wanted [m2/s2]
    end function measure_lanes
  end interface
end module sg_error_lanes
