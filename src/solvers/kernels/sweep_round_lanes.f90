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
  use sg_records, only: normal_x, normal_y, record_length, round_bias_n, round_bias_t, round_friction, round_frictional, &
                        round_inverse_wnn, round_inverse_wtt
  implicit none
  private
  public :: lane_length_of_disks, plain_length_of_disks, put_round_lanes, shared_of, sweep_round_lanes

  !> Reals of a contact in a lane, where all are plain, and where they are not and records are those of sg_records
  integer, parameter :: plain_length_of_disks = 4, lane_length_of_disks = round_friction
  !> Relative difference of ratios that rounding leaves
  real(wp), parameter :: rounding = 8*epsilon(1.0_wp)

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

    !> Put eight contacts side by side.
    pure subroutine put_group(left, are_plain, shared, contact, pair, record, impulse, lane_pair, lane_record, lane_impulse, &
                              is_done) bind(c, name='sg_put_round_group')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: left !! contacts that are left in the list
      integer(c_int), intent(in), value :: are_plain !! 1 where records are to be plain, else 0
      real(c_double), intent(in) :: shared(2) !! friction and ratio that plain records share
      integer(c_int), intent(in) :: contact(*), pair(*)
      real(c_double), intent(in) :: record(*), impulse(*)
      integer(c_int), intent(inout) :: lane_pair(*)
      real(c_double), intent(inout) :: lane_record(*), lane_impulse(*)
      integer(c_int), intent(out) :: is_done !! 0 where records are to be plain and one is not
    end subroutine put_group
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
    integer :: g, e, last
    integer(c_int) :: flag, is_put

    flag = merge(1_c_int, 0_c_int, length == plain_length_of_disks)
    is_done = .true.
    e = first - 1
    last = e + sum(group_size(first_group:last_group))
    do g = first_group, last_group
      if (group_size(g) == lanes) then
        call put_group(int(last - e, c_int), flag, shared, contact(e + 1), pair, record, impulse, lane_pair(1, 1, g), &
                       lane_record(1, 1, g), lane_impulse(1, 1, g), is_put)
      else
        call put_some(int(group_size(g)), length, shared, contact(e + 1), pair, record, impulse, lane_pair(1, 1, g), &
                      lane_record(1, 1, g), lane_impulse(1, 1, g), is_put)
      end if
      e = e + group_size(g)
      if (is_put > 0) cycle
      is_done = .false.
      return
    end do
  end subroutine put_round_lanes

  !> Put a few contacts side by side; other lanes change nothing.
  pure subroutine put_some(n, length, shared, contact, pair, record, impulse, lane_pair, lane_record, lane_impulse, is_done)
    integer, intent(in) :: n, length
    real(wp), intent(in) :: shared(2)
    integer(i4), intent(in) :: contact(n), pair(2, *)
    real(wp), intent(in) :: record(record_length(round_frictional), *), impulse(2, *)
    integer(i4), intent(inout) :: lane_pair(lanes, 2)
    real(wp), intent(inout) :: lane_record(lanes, length), lane_impulse(lanes, 2)
    integer(c_int), intent(out) :: is_done
    integer :: i

    is_done = 1
    lane_record = 0
    lane_impulse = 0
    do i = 1, n
      associate (own => record(:, contact(i)))
        if (length > plain_length_of_disks) then
          lane_record(i, :) = own
        else
          lane_record(i, :) = own([normal_x, normal_y, round_bias_n, round_inverse_wnn])
          if (abs(own(round_friction) - shared(1)) > 0 .or. abs(own(round_bias_t)) > 0 &
              .or. abs(own(round_inverse_wtt) - shared(2)*own(round_inverse_wnn)) > rounding*own(round_inverse_wtt)) is_done = 0
        end if
      end associate
      lane_pair(i, :) = pair(:, contact(i))
      lane_impulse(i, :) = impulse(:, contact(i))
    end do
    do i = n + 1, lanes
      lane_pair(i, :) = lane_pair(1, :)
    end do
  end subroutine put_some
end module sg_sweep_round_lanes
