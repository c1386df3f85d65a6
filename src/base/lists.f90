!> Arrays that grow: reserve room with doubling, so that appending costs constant time on average. And runs of one array copied to
!! another one, of any rank, from an element on.
module sg_lists
  use sg_kinds, only: wp, i1, i4
  implicit none
  private
  public :: copy_bytes, copy_flags, copy_integers, copy_reals, reserve, room_for

  !> Make the last dimension at least `n`, keeping what is there; grows by half or more
  interface reserve
    module procedure :: reserve_bytes, reserve_integers, reserve_integer_records, reserve_integer_lanes, reserve_reals, &
      reserve_real_records, reserve_real_lanes
  end interface reserve

contains

  !> Items that a list of `now` items grows to when `n` are wanted.
  pure integer function room_for(n, now)
    integer, intent(in) :: n !! items wanted, more than there are
    integer, intent(in) :: now !! items that there is room for

    room_for = max(n, now + min(now/2, huge(now) - now), 16)
  end function room_for

  !> Reserve room in a list of bytes.
  subroutine reserve_bytes(list, n)
    integer(i1), allocatable, intent(inout) :: list(:) !! list to grow
    integer, intent(in) :: n !! items wanted
    integer(i1), allocatable :: grown(:)

    if (.not. allocated(list)) allocate (list(0))
    if (size(list) >= n) return
    allocate (grown(room_for(n, size(list))), source=0_i1)
    grown(:size(list)) = list
    call move_alloc(grown, list)
  end subroutine reserve_bytes

  !> Reserve room in a list of integers.
  subroutine reserve_integers(list, n)
    integer(i4), allocatable, intent(inout) :: list(:) !! list to grow
    integer, intent(in) :: n !! items wanted
    integer(i4), allocatable :: grown(:)

    if (.not. allocated(list)) allocate (list(0))
    if (size(list) >= n) return
    allocate (grown(room_for(n, size(list))), source=0_i4)
    grown(:size(list)) = list
    call move_alloc(grown, list)
  end subroutine reserve_integers

  !> Reserve room in a list of integer records.
  subroutine reserve_integer_records(list, components, n)
    integer(i4), allocatable, intent(inout) :: list(:, :) !! records, shape (components, items)
    integer, intent(in) :: components !! size of a record
    integer, intent(in) :: n !! items wanted
    integer(i4), allocatable :: grown(:, :)

    if (.not. allocated(list)) allocate (list(components, 0))
    if (size(list, 2) >= n) return
    allocate (grown(components, room_for(n, size(list, 2))), source=0_i4)
    grown(:, :size(list, 2)) = list
    call move_alloc(grown, list)
  end subroutine reserve_integer_records

  !> Reserve room in a list of groups of integer records side by side.
  subroutine reserve_integer_lanes(list, n)
    integer(i4), allocatable, intent(inout) :: list(:, :, :) !! groups, shape (lanes, components, items)
    integer, intent(in) :: n !! items wanted
    integer(i4), allocatable :: grown(:, :, :)

    if (size(list, 3) >= n) return
    allocate (grown(size(list, 1), size(list, 2), room_for(n, size(list, 3))), source=0_i4)
    grown(:, :, :size(list, 3)) = list
    call move_alloc(grown, list)
  end subroutine reserve_integer_lanes

  !> Reserve room in a list of reals.
  subroutine reserve_reals(list, n)
    real(wp), allocatable, intent(inout) :: list(:) !! list to grow
    integer, intent(in) :: n !! items wanted
    real(wp), allocatable :: grown(:)

    if (.not. allocated(list)) allocate (list(0))
    if (size(list) >= n) return
    allocate (grown(room_for(n, size(list))), source=0.0_wp)
    grown(:size(list)) = list
    call move_alloc(grown, list)
  end subroutine reserve_reals

  !> Reserve room in a list of real records.
  subroutine reserve_real_records(list, components, n)
    real(wp), allocatable, intent(inout) :: list(:, :) !! records, shape (components, items)
    integer, intent(in) :: components !! size of a record
    integer, intent(in) :: n !! items wanted
    real(wp), allocatable :: grown(:, :)

    if (.not. allocated(list)) allocate (list(components, 0))
    if (size(list, 2) >= n) return
    allocate (grown(components, room_for(n, size(list, 2))), source=0.0_wp)
    grown(:, :size(list, 2)) = list
    call move_alloc(grown, list)
  end subroutine reserve_real_records

  !> Reserve room in a list of groups of real records side by side.
  subroutine reserve_real_lanes(list, n)
    real(wp), allocatable, intent(inout) :: list(:, :, :) !! groups, shape (lanes, components, items)
    integer, intent(in) :: n !! items wanted
    real(wp), allocatable :: grown(:, :, :)

    if (size(list, 3) >= n) return
    allocate (grown(size(list, 1), size(list, 2), room_for(n, size(list, 3))), source=0.0_wp)
    grown(:, :, :size(list, 3)) = list
    call move_alloc(grown, list)
  end subroutine reserve_real_lanes

  !> Copy reals that stand in a row.
  pure subroutine copy_reals(n, from, to)
    integer, intent(in) :: n !! how many
    real(wp), intent(in) :: from(n) !! what is copied
    real(wp), intent(inout) :: to(n) !! where to

    to = from
  end subroutine copy_reals

  !> Copy integers that stand in a row.
  pure subroutine copy_integers(n, from, to)
    integer, intent(in) :: n !! how many
    integer(i4), intent(in) :: from(n) !! what is copied
    integer(i4), intent(inout) :: to(n) !! where to

    to = from
  end subroutine copy_integers

  !> Copy bytes that stand in a row.
  pure subroutine copy_bytes(n, from, to)
    integer, intent(in) :: n !! how many
    integer(i1), intent(in) :: from(n) !! what is copied
    integer(i1), intent(inout) :: to(n) !! where to

    to = from
  end subroutine copy_bytes

  !> Copy flags that stand in a row.
  pure subroutine copy_flags(n, from, to)
    integer, intent(in) :: n !! how many
    logical, intent(in) :: from(n) !! what is copied
    logical, intent(inout) :: to(n) !! where to

    to = from
  end subroutine copy_flags
end module sg_lists
