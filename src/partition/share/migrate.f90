!> Bodies that change their owner: every rank sends what leaves it and keeps what stays.
module sg_migrate
  use sg_comm, only: comm_t
  use sg_field_visitor, only: sync_on_owner
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  use sg_local_numbers, only: contactors_of_bodies
  use sg_pack_bodies, only: drop_bodies, drop_step_state, order_records, pack_bodies, rebuild_scene
  use sg_parcels, only: parcel_t
  use sg_scene, only: scene_t
  use sg_sorting, only: group_items
  implicit none
  private
  public :: migrate

contains

  !> Move bodies to their new owners; afterwards a rank holds its own bodies and the replicated ones, and no copies. Collective.
  subroutine migrate(scene, owner, comm)
    type(scene_t), intent(inout) :: scene !! this rank's part, replaced
    integer(i4), intent(in) :: owner(:) !! new owner of each own body, -1 for replicated ones, shape (at least n_own)
    type(comm_t), intent(inout) :: comm !! the ranks
    integer, parameter :: sample = 256
    type(parcel_t) :: leaving, bodies, some
    real(wp), allocatable :: values(:)
    real(wp) :: expected
    integer, allocatable :: received(:), first_leaver(:), leaver(:), start(:)
    integer(i4), allocatable :: first(:), list(:), replicated(:)
    integer :: sent(0:comm%size - 1), r, b, n_own

    call drop_step_state(scene)
    call group_items(owner(:scene%bodies%n_own) + 1_i4, comm%size, first_leaver, leaver)
    call contactors_of_bodies(scene%contactors, scene%bodies%n, first, list)
    replicated = pack([(int(b, i4), b=1, scene%bodies%n)], scene%bodies%owner(:scene%bodies%n) < 0)
    ! Room for all, judged by some: a list that grows by and by would for moments need it twice.
    associate (body => leaver(:min(sample, size(leaver))))
      call pack_bodies(scene, body, first, list, owner(body), sync_on_owner, some)
      expected = 1.05_wp*real(some%n, wp)*real(size(leaver), wp)/real(max(1, size(body)), wp)
    end associate
    if (expected < real(huge(1), wp)) call reserve(leaving%value, int(expected))
    do r = 0, comm%size - 1
      sent(r) = leaving%n
      associate (body => leaver(first_leaver(r + 1):first_leaver(r + 2) - 1))
        call pack_bodies(scene, body, first, list, owner(body), sync_on_owner, leaving)
      end associate
      ! Replicated bodies stay: what a rank sends to itself.
      if (r == comm%rank) call pack_bodies(scene, replicated, first, list, scene%bodies%owner(replicated), sync_on_owner, leaving)
      sent(r) = leaving%n - sent(r)
    end do
    deallocate (first, list, leaver)
    call drop_bodies(scene)
    call comm%swap(leaving%value(:leaving%n), sent, values, received)
    deallocate (leaving%value)
    call bodies%adopt(values)
    call order_records(bodies, comm%rank, comm%size, start, n_own)
    call rebuild_scene(scene, bodies, start, n_own)
  end subroutine migrate
end module sg_migrate
