!> Contacts of disks with Coulomb friction in groups side by side, for vector registers (doc/theory/nlgs.md): records of lanes, and
!! the sweep over them, which sweep_round_lanes.cpp holds.
!!
!! No movable body is twice in a group, so that its contacts may be updated at once. Mostly all contacts of a problem have one
!! friction, no bias along the tangent, and one ratio of 1/W_tt to 1/W_nn, since disks that are all alike but in size have one ratio
!! of R^2/I to 1/m: then records of lanes are plain, normal, bias and 1/W_nn, and the rest is held once.
module sg_sweep_round_lanes
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use sg_group_dealing, only: lanes
  use sg_kinds, only: wp, i4
  use sg_records, only: record_length, round_friction, round_frictional, round_inverse_wnn, round_inverse_wtt
  implicit none
  private
  public :: lane_length_of_disks, plain_length_of_disks, put_round_lanes, shared_of, sweep_round_lanes

  !> Reals of a contact in a lane, where all are plain, and where they are not and records are those of sg_records
  integer, parameter :: plain_length_of_disks = 4, lane_length_of_disks = round_friction

  interface
    !> One sweep with Coulomb friction, group by group.
    pure subroutine sweep_round_lanes(n_groups, are_plain, n_bodies, pair, record, shared, relaxation, impulse, body) &
      bind(c, name='sg_sweep_round_groups')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: n_groups !! groups
      integer(c_int), intent(in), value :: are_plain !! 1 where records are plain, else 0
      integer(c_int), intent(in), value :: n_bodies !! slots
      integer(c_int), intent(in) :: pair(*) !! slots of candidate and antagonist, shape (lanes, 2, groups)
      real(c_double), intent(in) :: record(*) !! records of `put_round_lanes`, shape (lanes, reals of a lane, groups)
      real(c_double), intent(in) :: shared(2) !! friction and ratio that plain records share
      real(c_double), intent(in), value :: relaxation !! share of each change taken
      real(c_double), intent(inout) :: impulse(*) !! impulses [N s], shape (lanes, 2, groups)
      real(c_double), intent(inout) :: body(*) !! records of bodies, whose velocities change, shape (body_length, slots)
    end subroutine sweep_round_lanes

    !> Put contacts side by side, group by group.
    pure subroutine put_groups(n_groups, group_size, left, are_plain, shared, contact, pair, record, impulse, lane_pair, &
                               lane_record, lane_impulse, is_done) bind(c, name='sg_put_round_groups')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: n_groups !! groups to put
      integer(c_int), intent(in) :: group_size(*) !! contacts of each
      integer(c_int), intent(in), value :: left !! contacts that are left in the list
      integer(c_int), intent(in), value :: are_plain !! 1 where records are to be plain, else 0
      real(c_double), intent(in) :: shared(2) !! friction and ratio that plain records share
      integer(c_int), intent(in) :: contact(*), pair(*)
      real(c_double), intent(in) :: record(*), impulse(*)
      integer(c_int), intent(inout) :: lane_pair(*)
      real(c_double), intent(inout) :: lane_record(*), lane_impulse(*)
      integer(c_int), intent(out) :: is_done !! 0 where records are to be plain and one is not
    end subroutine put_groups
  end interface

contains

  !> Friction and ratio of the inverses of W that plain contacts of an order share: those of the first that takes part.
  pure function shared_of(n, contact, record) result(shared)
    integer, intent(in) :: n !! contacts of the order
    integer(i4), intent(in) :: contact(n) !! their numbers
    real(wp), intent(in) :: record(record_length(round_frictional), *) !! records of all contacts
    real(wp) :: shared(2)
    integer :: i

    shared = 0
    do i = 1, n
      associate (k => contact(i))
        shared(1) = record(round_friction, k)
        if (.not. record(round_inverse_wnn, k) > 0) cycle
        shared(2) = record(round_inverse_wtt, k)/record(round_inverse_wnn, k)
        return
      end associate
    end do
  end function shared_of

  !> Put slots, records and impulses of contacts side by side, group by group.
  pure subroutine put_round_lanes(first_group, last_group, first, length, shared, group_size, contact, pair, record, impulse, &
                                  lane_pair, lane_record, lane_impulse, is_done)
    integer, intent(in) :: first_group !! first group to fill
    integer, intent(in) :: last_group !! last one
    integer, intent(in) :: first !! first contact of the first group
    integer, intent(in) :: length !! reals of a lane: of plain records, or of others
    real(wp), intent(in) :: shared(2) !! friction and ratio that plain records share
    integer(i4), intent(in) :: group_size(*) !! contacts of each group
    integer(i4), intent(in) :: contact(*) !! contacts in the order of the groups
    integer(i4), intent(in) :: pair(2, *) !! slots of all contacts
    real(wp), intent(in) :: record(record_length(round_frictional), *) !! their records
    real(wp), intent(in) :: impulse(2, *) !! and impulses [N s]
    integer(i4), intent(inout) :: lane_pair(lanes, 2, *) !! slots by lanes
    real(wp), intent(inout) :: lane_record(lanes, length, *) !! records by lanes
    real(wp), intent(inout) :: lane_impulse(lanes, 2, *) !! impulses by lanes
    logical, intent(out) :: is_done !! false where records should be plain, and one is not
    integer(c_int) :: flag

    call put_groups(int(last_group - first_group + 1, c_int), group_size(first_group), &
                    sum(group_size(first_group:last_group)), merge(1_c_int, 0_c_int, length == plain_length_of_disks), shared, &
                    contact(first), pair, record, impulse, lane_pair(1, 1, first_group), lane_record(1, 1, first_group), &
                    lane_impulse(1, 1, first_group), flag)
    is_done = flag > 0
  end subroutine put_round_lanes
end module sg_sweep_round_lanes
