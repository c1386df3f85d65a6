!> Contacts with arms and Coulomb friction in groups side by side, for vector registers (doc/theory/nlgs.md): records of lanes, and
!! the sweep over them, which sweep_arm_lanes.cpp holds.
!!
!! No movable body is twice in a group, so that its contacts may be updated at once. Lanes hold what unilateral contacts with
!! friction need of their records, the first values in the same order; cohesion, compliance and linear laws have no place there.
module sg_sweep_arm_lanes
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use sg_group_dealing, only: lanes
  use sg_kinds, only: wp, i4
  use sg_records, only: arm_cohesion, arm_compliance_n, arm_compliance_t, arm_friction, arm_frictional, arm_law, arm_wnn, arm_wtt, &
                        least_active, least_linear, record_length
  implicit none
  private
  public :: lane_length_of_arms, put_arm_lanes, sweep_arm_lanes

  !> Reals of a contact in a lane
  integer, parameter :: lane_length_of_arms = arm_friction

  interface
    !> One sweep with Coulomb friction, group by group.
    pure subroutine sweep_arm_lanes(n_groups, pair, record, relaxation, impulse, body) bind(c, name='sg_sweep_arm_groups')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: n_groups !! groups
      integer(c_int), intent(in) :: pair(*) !! slots of candidate and antagonist, shape (lanes, 2, groups)
      real(c_double), intent(in) :: record(*) !! records of `put_arm_lanes`, shape (lanes, lane_length_of_arms, groups)
      real(c_double), intent(in), value :: relaxation !! share of each change taken
      real(c_double), intent(inout) :: impulse(*) !! impulses [N s], shape (lanes, 2, groups)
      real(c_double), intent(inout) :: body(*) !! records of bodies, whose velocities change, shape (body_length, slots)
    end subroutine sweep_arm_lanes

    !> Put contacts side by side, up to the first group with a law that has no place in lanes, or with a contact without a part.
    pure subroutine put_groups(n_groups, group_size, left, contact, pair, record, impulse, lane_pair, lane_record, lane_impulse, &
                               put) bind(c, name='sg_put_arm_groups')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: n_groups !! groups to put
      integer(c_int), intent(in) :: group_size(*) !! contacts of each
      integer(c_int), intent(in), value :: left !! contacts that are left in the list
      integer(c_int), intent(in) :: contact(*), pair(*)
      real(c_double), intent(in) :: record(*), impulse(*)
      integer(c_int), intent(inout) :: lane_pair(*)
      real(c_double), intent(inout) :: lane_record(*), lane_impulse(*)
      integer(c_int), intent(out) :: put !! groups put
    end subroutine put_groups
  end interface

contains

  !> Put slots, records and impulses of contacts side by side, group by group.
  pure subroutine put_arm_lanes(first_group, last_group, first, group_size, contact, pair, record, impulse, lane_pair, &
                                lane_record, lane_impulse, is_done)
    integer, intent(in) :: first_group !! first group to fill
    integer, intent(in) :: last_group !! last one
    integer, intent(in) :: first !! first contact of the first group
    integer(i4), intent(in) :: group_size(*) !! contacts of each group
    integer(i4), intent(in) :: contact(*) !! contacts in the order of the groups
    integer(i4), intent(in) :: pair(2, *) !! slots of all contacts
    real(wp), intent(in) :: record(record_length(arm_frictional), *) !! their records
    real(wp), intent(in) :: impulse(2, *) !! and impulses [N s]
    integer(i4), intent(inout) :: lane_pair(lanes, 2, *) !! slots by lanes
    real(wp), intent(inout) :: lane_record(lanes, lane_length_of_arms, *) !! records by lanes
    real(wp), intent(inout) :: lane_impulse(lanes, 2, *) !! impulses by lanes
    logical, intent(out) :: is_done !! false where the law of a contact has no place in a lane
    integer :: g, e, last
    integer(c_int) :: put

    e = first - 1
    last = e + sum(group_size(first_group:last_group))
    is_done = .true.
    g = first_group
    do
      call put_groups(int(last_group - g + 1, c_int), group_size(g), int(last - e, c_int), contact(e + 1), pair, record, impulse, &
                      lane_pair(1, 1, g), lane_record(1, 1, g), lane_impulse(1, 1, g), put)
      e = e + sum(group_size(g:g + put - 1))
      g = g + put
      if (g > last_group) return
      call put_one_by_one(int(group_size(g)), contact(e + 1), pair, record, impulse, lane_pair(:, :, g), lane_record(:, :, g), &
                          lane_impulse(:, :, g), is_done)
      if (.not. is_done) return
      e = e + group_size(g)
      g = g + 1
      if (g > last_group) return
    end do
  end subroutine put_arm_lanes

  !> Put the contacts of a group side by side, some of which take no part.
  pure subroutine put_one_by_one(n, contact, pair, record, impulse, lane_pair, lane_record, lane_impulse, is_done)
    integer, intent(in) :: n
    integer(i4), intent(in) :: contact(n), pair(2, *)
    real(wp), intent(in) :: record(record_length(arm_frictional), *), impulse(2, *)
    integer(i4), intent(inout) :: lane_pair(lanes, 2)
    real(wp), intent(inout) :: lane_record(lanes, lane_length_of_arms), lane_impulse(lanes, 2)
    logical, intent(out) :: is_done
    integer :: i

    is_done = .true.
    do i = 1, lanes
      associate (k => contact(min(i, n)))
        lane_pair(i, :) = pair(:, merge(k, contact(1), i <= n))
        lane_impulse(i, :) = merge(impulse(:, k), 0.0_wp, i <= n)
        if (i > n .or. record(arm_law, k) < least_active) then
          call clear_lane(i, lane_record)
        else
          lane_record(i, :) = record(:lane_length_of_arms, k)
          is_done = is_done .and. is_plain(record(:, k))
        end if
      end associate
    end do
  end subroutine put_one_by_one

  !> Is the law of a contact unilateral, with friction alone?
  pure logical function is_plain(record)
    real(wp), intent(in) :: record(record_length(arm_frictional))

    is_plain = record(arm_law) < least_linear &
               .and. .not. max(abs(record(arm_cohesion)), abs(record(arm_compliance_n)), abs(record(arm_compliance_t))) > 0
  end function is_plain

  !> Write a lane that changes nothing: friction is -1.
  pure subroutine clear_lane(i, record)
    integer, intent(in) :: i
    real(wp), intent(inout) :: record(lanes, lane_length_of_arms)

    record(i, :) = 0
    record(i, arm_wnn) = 1
    record(i, arm_wtt) = 1
    record(i, arm_friction) = -1
  end subroutine clear_lane
end module sg_sweep_arm_lanes
