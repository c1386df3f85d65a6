!> Checks of a deck's scene that ranks make together, each having read its share: all come to the same mistakes and warnings.
!!
!! Grains that another rank may hold are copied to see whether they overlap, as copies are made in a run (sg_halo); what was found
!! is gathered, of overlaps the deepest ones (doc/theory/decomposition.md).
module sg_shared_start
  use sg_blocks, only: deck_t
  use sg_comm, only: comm_t
  use sg_error, only: diagnostics_t
  use sg_field_visitor, only: sync_on_owner
  use sg_halo, only: make_halo
  use sg_kinds, only: wp, i4
  use sg_local_numbers, only: contactors_of_bodies
  use sg_pack_bodies, only: drop_step_state, order_records, pack_bodies, rebuild_scene
  use sg_parcels, only: parcel_t
  use sg_replicated_data, only: keep_replicated, localise, replicated_data_t
  use sg_scene, only: periods_of, scene_t, start_contact_t
  use sg_start_checks, only: complain_of_outside, complain_of_wide, first_wide, lies_outside
  use sg_start_overlaps, only: add_overlap, find_overlaps, most_pairs, overlaps_t, report_overlaps
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: check_shared_start

contains

  !> Check a scene, and put this rank's own bodies first. Collective, of ranks that have read the same deck.
  subroutine check_shared_start(deck, scene, comm, diagnostics)
    type(deck_t), intent(in) :: deck !! the deck
    type(scene_t), intent(inout) :: scene !! this rank's share; gets copies of others' grains
    type(comm_t), intent(inout) :: comm !! the ranks
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings, the same on all ranks
    type(overlaps_t) :: found
    type(subdomain_t) :: subdomain
    type(replicated_data_t) :: replicated
    type(start_contact_t), allocatable :: known(:)

    if (.not. allocated(scene%bodies%id)) return
    ! Of bodies of a DATBOX one rank does not ask more either.
    if (scene%bodies%n + deck%absent%n == deck%folder_bodies) then
      call order_share(scene, comm)
      return
    end if
    if (deck%folder_bodies == 0) call check_shared_range(deck, scene, comm, diagnostics)
    if (diagnostics%count() > 0) return
    if (allocated(scene%start_contacts)) call move_alloc(scene%start_contacts, known)
    subdomain%rank = comm%rank
    subdomain%size = comm%size
    subdomain%all_bodies = scene%bodies%n + deck%absent%n
    call keep_replicated(scene, replicated)
    call make_halo(scene, replicated, subdomain, 0.0_wp, comm)
    if (allocated(known)) call move_alloc(known, scene%start_contacts)
    call find_overlaps(scene, comm%rank, deck, found)
    call gather_overlaps(found, comm)
    call report_overlaps(deck, found, diagnostics)
  end subroutine check_shared_start

  !> Put first the bodies that a rank counts as its own; of those that all ranks hold it is some.
  subroutine order_share(scene, comm)
    type(scene_t), intent(inout) :: scene
    type(comm_t), intent(in) :: comm
    type(start_contact_t), allocatable :: known(:)
    type(replicated_data_t) :: replicated
    type(parcel_t) :: bodies
    integer(i4), allocatable :: first(:), list(:)
    integer, allocatable :: start(:)
    integer :: b, n_own

    call keep_replicated(scene, replicated)
    if (allocated(scene%start_contacts)) call move_alloc(scene%start_contacts, known)
    call contactors_of_bodies(scene%contactors, scene%bodies%n, first, list)
    call drop_step_state(scene)
    call pack_bodies(scene, [(int(b, i4), b=1, scene%bodies%n)], first, list, scene%bodies%owner, sync_on_owner, bodies)
    call order_records(bodies, comm%rank, comm%size, start, n_own)
    call rebuild_scene(scene, bodies, start, n_own)
    call localise(replicated, scene)
    if (allocated(known)) call move_alloc(known, scene%start_contacts)
  end subroutine order_share

  !> Every grain lies within the period, and none is wider: of grains that one rank alone holds the first one is reported.
  subroutine check_shared_range(deck, scene, comm, diagnostics)
    type(deck_t), intent(in) :: deck
    type(scene_t), intent(in) :: scene
    type(comm_t), intent(inout) :: comm
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: period(3), value
    integer :: axis, c, b, number

    period = periods_of(scene)
    do axis = 1, scene%dimension
      if (.not. period(axis) > 0) cycle
      number = huge(1)
      value = 0
      c = first_wide(scene, period(axis))
      if (c > 0) then
        number = scene%bodies%id(scene%contactors%body(c))
        value = scene%contactors%reach(c)
      end if
      call first_of_all(comm, number, value)
      if (number < huge(1)) then
        call complain_of_wide(deck, number, value, period(axis), diagnostics)
        cycle
      end if
      do b = 1, scene%bodies%n
        if (.not. lies_outside(scene, b, axis)) cycle
        if (scene%bodies%owner(b) < 0) then
          call complain_of_outside(deck, scene, int(scene%bodies%id(b)), axis, scene%bodies%position(axis, b), diagnostics)
        else if (number == huge(1)) then
          number = scene%bodies%id(b)
          value = scene%bodies%position(axis, b)
        end if
      end do
      call first_of_all(comm, number, value)
      if (number < huge(1)) call complain_of_outside(deck, scene, number, axis, value, diagnostics)
    end do
  end subroutine check_shared_range

  !> The least number that any rank has, and what goes with it.
  subroutine first_of_all(comm, number, value)
    type(comm_t), intent(inout) :: comm
    integer, intent(inout) :: number
    real(wp), intent(inout) :: value
    real(wp), allocatable :: all(:, :)
    integer :: first

    call comm%gather([real(number, wp), value], all)
    first = minloc(all(1, :), 1)
    number = nint(all(1, first))
    value = all(2, first)
  end subroutine first_of_all

  !> The overlaps of all ranks: how many, and the deepest ones.
  subroutine gather_overlaps(found, comm)
    type(overlaps_t), intent(inout) :: found
    type(comm_t), intent(inout) :: comm
    real(wp), allocatable :: all(:, :)
    real(wp) :: overlap(4, most_pairs)
    integer :: r, i

    overlap(:2, :) = real(found%pair, wp)
    overlap(3, :) = found%depth
    overlap(4, :) = found%share
    call comm%gather([real(found%n, wp), reshape(overlap, [4*most_pairs])], all)
    found = overlaps_t(n=nint(sum(all(1, :))))
    do r = 1, size(all, 2)
      overlap = reshape(all(2:, r), [4, most_pairs])
      do i = 1, count(overlap(4, :) > 0)
        call add_overlap(found, nint(overlap(:2, i)), overlap(3, i), overlap(4, i))
      end do
    end do
  end subroutine gather_overlaps
end module sg_shared_start
