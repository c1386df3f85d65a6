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
  public :: find_shared, lane_length_of_disks, plain_length_of_disks, put_round_lanes, sweep_round_lanes

  !> Places of a plain contact in a lane; others have those of their record
  integer, parameter :: plain_bias_n = 3, plain_inverse_wnn = 4
  !> Reals of a contact in a lane, where all are plain and where they are not
  integer, parameter :: plain_length_of_disks = plain_inverse_wnn, lane_length_of_disks = round_friction
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
  end interface

contains

  !> Find friction and ratio of the inverses of W that contacts of an order share.
  pure subroutine find_shared(n, contact, record, shared, are_plain)
    integer, intent(in) :: n !! contacts of the order
    integer(i4), intent(in) :: contact(n) !! their numbers
    real(wp), intent(in) :: record(record_length(round_frictional), *) !! records of all contacts
    real(wp), intent(out) :: shared(2) !! friction, and 1/W_tt over 1/W_nn
    logical, intent(out) :: are_plain !! false where a contact differs, or has a bias along its tangent
    real(wp) :: differences
    integer :: i

    shared = 0
    do i = 1, n
      if (.not. record(round_inverse_wnn, contact(i)) > 0) cycle
      shared = [record(round_friction, contact(i)), &
                record(round_inverse_wtt, contact(i))/record(round_inverse_wnn, contact(i))]
      exit
    end do
    differences = 0
    do i = 1, n
      associate (k => contact(i))
        differences = differences + merge(0.0_wp, 1.0_wp, abs(record(round_friction, k) - shared(1)) <= 0 &
                                          .and. abs(record(round_bias_t, k)) <= 0 &
                                          .and. abs(record(round_inverse_wtt, k) - shared(2)*record(round_inverse_wnn, k)) &
                                          <= rounding*record(round_inverse_wtt, k))
      end associate
    end do
    are_plain = .not. differences > 0
  end subroutine find_shared

  !> Put slots, records and impulses of contacts side by side, group by group.
  pure subroutine put_round_lanes(first_group, last_group, first, length, group_size, contact, pair, record, impulse, lane_pair, &
                                  lane_record, lane_impulse)
    integer, intent(in) :: first_group !! first group to fill
    integer, intent(in) :: last_group !! last one
    integer, intent(in) :: first !! first contact of the first group
    integer, intent(in) :: length !! reals of a lane
    integer(i4), intent(in) :: group_size(*) !! contacts of each group
    integer(i4), intent(in) :: contact(*) !! contacts in the order of the groups
    integer(i4), intent(in) :: pair(2, *) !! slots of all contacts
    real(wp), intent(in) :: record(record_length(round_frictional), *) !! their records
    real(wp), intent(in) :: impulse(2, *) !! and impulses [N s]
    integer(i4), intent(inout) :: lane_pair(lanes, 2, *) !! slots by lanes
    real(wp), intent(inout) :: lane_record(lanes, length, *) !! records by lanes
    real(wp), intent(inout) :: lane_impulse(lanes, 2, *) !! impulses by lanes
    integer :: g, i, e, k

    e = first - 1
    do g = first_group, last_group
      do i = 1, group_size(g)
        e = e + 1
        k = contact(e)
        lane_pair(i, 1, g) = pair(1, k)
        lane_pair(i, 2, g) = pair(2, k)
        if (length == plain_length_of_disks) then
          lane_record(i, normal_x, g) = record(normal_x, k)
          lane_record(i, normal_y, g) = record(normal_y, k)
          lane_record(i, plain_bias_n, g) = record(round_bias_n, k)
          lane_record(i, plain_inverse_wnn, g) = record(round_inverse_wnn, k)
        else
          lane_record(i, :lane_length_of_disks, g) = record(:, k)
        end if
        lane_impulse(i, 1, g) = impulse(1, k)
        lane_impulse(i, 2, g) = impulse(2, k)
      end do
      do i = group_size(g) + 1, lanes
        lane_pair(i, :, g) = lane_pair(1, :, g)
        lane_record(i, :, g) = 0
        lane_impulse(i, :, g) = 0
      end do
    end do
  end subroutine put_round_lanes
end module sg_sweep_round_lanes
