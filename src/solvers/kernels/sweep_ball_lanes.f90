!> Contacts of balls with friction in groups side by side, for vector registers (doc/theory/nlgs.md): records of lanes, and the
!! sweep over them, which sweep_ball_lanes.cpp holds.
!!
!! No movable body is twice in a group, so that its contacts may be updated at once. Unlike the sweep one by one this one
!! has no branch that a processor could guess wrong: sticking, sliding and open contacts take the same time.
module sg_sweep_ball_lanes
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use sg_group_dealing, only: lanes
  use sg_kinds, only: wp, i4
  use sg_records, only: ball_frictional, record_length
  implicit none
  private
  public :: put_ball_lanes, sweep_ball_lanes

  interface
    !> One sweep with Coulomb friction, group by group.
    pure subroutine sweep_ball_lanes(n_groups, pair, record, relaxation, impulse, body) bind(c, name='sg_sweep_ball_groups')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: n_groups !! groups
      integer(c_int), intent(in) :: pair(*) !! slots of candidate and antagonist, shape (lanes, 2, groups)
      real(c_double), intent(in) :: record(*) !! records, zero in lanes to spare, shape (lanes, record_length, groups)
      real(c_double), intent(in), value :: relaxation !! share of each change taken
      real(c_double), intent(inout) :: impulse(*) !! impulses [N s], shape (lanes, 3, groups)
      real(c_double), intent(inout) :: body(*) !! records of bodies, whose velocities change, shape (body_length, slots)
    end subroutine sweep_ball_lanes

    !> Put contacts side by side, group by group.
    pure subroutine put_groups(n_groups, group_size, left, contact, pair, record, impulse, lane_pair, lane_record, lane_impulse) &
      bind(c, name='sg_put_ball_groups')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: n_groups !! groups to put
      integer(c_int), intent(in) :: group_size(*) !! contacts of each
      integer(c_int), intent(in), value :: left !! contacts that are left in the list
      integer(c_int), intent(in) :: contact(*), pair(*)
      real(c_double), intent(in) :: record(*), impulse(*)
      integer(c_int), intent(inout) :: lane_pair(*)
      real(c_double), intent(inout) :: lane_record(*), lane_impulse(*)
    end subroutine put_groups
  end interface

contains

  !> Put slots, records and impulses of contacts side by side, group by group.
  pure subroutine put_ball_lanes(first_group, last_group, first, group_size, contact, pair, record, impulse, lane_pair, &
                                 lane_record, lane_impulse)
    integer, intent(in) :: first_group !! first group to fill
    integer, intent(in) :: last_group !! last one
    integer, intent(in) :: first !! first contact of the first group
    integer(i4), intent(in) :: group_size(*) !! contacts of each group
    integer(i4), intent(in) :: contact(*) !! contacts in the order of the groups
    integer(i4), intent(in) :: pair(2, *) !! slots of all contacts
    real(wp), intent(in) :: record(record_length(ball_frictional), *) !! their records
    real(wp), intent(in) :: impulse(3, *) !! and impulses [N s]
    integer(i4), intent(inout) :: lane_pair(lanes, 2, *) !! slots by lanes
    real(wp), intent(inout) :: lane_record(lanes, record_length(ball_frictional), *) !! records by lanes
    real(wp), intent(inout) :: lane_impulse(lanes, 3, *) !! impulses by lanes

    call put_groups(int(last_group - first_group + 1, c_int), group_size(first_group), &
                    sum(group_size(first_group:last_group)), contact(first), pair, record, impulse, lane_pair(1, 1, first_group), &
                    lane_record(1, 1, first_group), lane_impulse(1, 1, first_group))
  end subroutine put_ball_lanes
end module sg_sweep_ball_lanes
