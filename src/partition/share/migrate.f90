!> Bodies that change their home: every rank sends what leaves it and keeps what stays.
module sg_migrate
  use sg_comm, only: comm_t
  use sg_field_visitor, only: sync_on_owner
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  use sg_local_numbers, only: contactors_of_bodies
  use sg_pack_bodies, only: drop_bodies, drop_step_state, order_records, pack_body, rebuild_scene
  use sg_parcels, only: parcel_t
  use sg_scene, only: scene_t
  use sg_sorting, only: group_items
  implicit none
  private
  public :: migrate

contains

  !> Move bodies to their new homes; afterwards a rank holds its own bodies and the wide ones, and no copies. Collective.
  subroutine migrate(scene, home, comm)
    type(scene_t), intent(inout) :: scene !! this rank's part, replaced
    integer(i4), intent(in) :: home(:) !! new home of each own body, -1 for wide ones, shape (at least n_home)
    type(comm_t), intent(inout) :: comm !! the ranks
    integer, parameter :: sample = 256
    type(parcel_t) :: leaving, bodies
    real(wp), allocatable :: values(:)
    integer, allocatable :: received(:), first_leaver(:), leaver(:), start(:)
    integer(i4), allocatable :: first(:), list(:)
    integer :: sent(0:comm%size - 1), r, i, b, n_home

    call drop_step_state(scene)
    call group_items(home(:scene%bodies%n_home) + 1_i4, comm%size, first_leaver, leaver)
    call contactors_of_bodies(scene%contactors, scene%bodies%n, first, list)
    allocate (leaving%value(0))
    do r = 0, comm%size - 1
      sent(r) = leaving%n
      do i = first_leaver(r + 1), first_leaver(r + 2) - 1
        call pack_body(scene, leaver(i), first, list, r, sync_on_owner, leaving)
        ! Room for all, judged by the first ones: a list that grows by and by would for moments need it twice.
        if (i == sample) call make_room(leaving, real(size(leaver), wp)/real(sample, wp))
      end do
      ! Wide bodies stay: what a rank sends to itself.
      do b = 1, merge(scene%bodies%n, 0, r == comm%rank)
        if (scene%bodies%home(b) < 0) call pack_body(scene, b, first, list, -1, sync_on_owner, leaving)
      end do
      sent(r) = leaving%n - sent(r)
    end do
    deallocate (first, list, leaver)
    call drop_bodies(scene)
    call comm%swap(leaving%value(:leaving%n), sent, values, received)
    deallocate (leaving%value)
    call bodies%adopt(values)
    call order_records(bodies, comm%rank, comm%size, start, n_home)
    call rebuild_scene(scene, bodies, start, n_home)
  end subroutine migrate

  !> Make room for some times the values that a parcel has, and a little more.
  subroutine make_room(parcel, times)
    type(parcel_t), intent(inout) :: parcel
    real(wp), intent(in) :: times
    real(wp) :: expected

    expected = 1.05_wp*real(parcel%n, wp)*times
    if (expected < real(huge(1), wp)) call reserve(parcel%value, int(expected))
  end subroutine make_room
end module sg_migrate
