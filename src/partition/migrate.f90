!> Bodies that change their home: every rank sends what leaves it and keeps what stays.
module sg_migrate
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  use sg_local_numbers, only: contactors_of_bodies
  use sg_pack_bodies, only: drop_step_state, order_records, pack_body, rebuild_scene
  use sg_parcels, only: parcel_t
  use sg_scene, only: scene_t
  use sg_sorting, only: group_items
  implicit none
  private
  public :: migrate, take_part

contains

  !> Move bodies to their new homes; afterwards a rank holds its own bodies and the wide ones, and no copies. Collective.
  subroutine migrate(scene, home, comm)
    type(scene_t), intent(inout) :: scene !! this rank's part, replaced
    integer(i4), intent(in) :: home(:) !! new home of each own body, -1 for wide ones, shape (at least n_home)
    type(comm_t), intent(inout) :: comm !! the ranks
    type(parcel_t) :: leaving, bodies
    real(wp), allocatable :: values(:)
    integer, allocatable :: received(:), first_leaver(:), leaver(:)
    integer(i4), allocatable :: first(:), list(:)
    integer :: sent(0:comm%size - 1), r, i, b

    call group_items(home(:scene%bodies%n_home) + 1_i4, comm%size, first_leaver, leaver)
    call contactors_of_bodies(scene%contactors, scene%bodies%n, first, list)
    allocate (leaving%value(0))
    do r = 0, comm%size - 1
      sent(r) = leaving%n
      do i = first_leaver(r + 1), first_leaver(r + 2) - 1
        call pack_body(scene, leaver(i), first, list, r, leaving)
      end do
      sent(r) = leaving%n - sent(r)
    end do
    call comm%swap(leaving%value(:leaving%n), sent, values, received)
    deallocate (leaving%value)
    call bodies%adopt(values)
    do b = 1, scene%bodies%n
      if (scene%bodies%home(b) < 0) call pack_body(scene, b, first, list, -1, bodies)
    end do
    call settle(scene, bodies, comm)
  end subroutine migrate

  !> Take one rank's part of a whole scene: its own bodies and the wide ones.
  subroutine take_part(scene, home, comm)
    type(scene_t), intent(inout) :: scene !! the whole scene, replaced by the part
    integer(i4), intent(in) :: home(:) !! home of every body, -1 for wide ones
    type(comm_t), intent(in) :: comm !! the ranks
    integer, parameter :: sample = 256
    type(parcel_t) :: bodies
    integer(i4), allocatable :: first(:), list(:)
    integer :: b, packed
    real(wp) :: expected

    call drop_step_state(scene)
    call contactors_of_bodies(scene%contactors, scene%bodies%n, first, list)
    allocate (bodies%value(0))
    packed = 0
    do b = 1, scene%bodies%n
      if (.not. (home(b) == comm%rank .or. home(b) < 0)) cycle
      call pack_body(scene, b, first, list, int(home(b)), bodies)
      packed = packed + 1
      if (packed /= sample) cycle
      ! Room for all, judged by the first ones: a list that grows by and by would for moments need it twice.
      expected = 1.05_wp*real(bodies%n, wp)*real(count(home == comm%rank .or. home < 0), wp)/real(sample, wp)
      if (expected < real(huge(1), wp)) call reserve(bodies%value, int(expected))
    end do
    call settle(scene, bodies, comm)
  end subroutine take_part

  !> Make the scene from the records of its bodies.
  subroutine settle(scene, bodies, comm)
    type(scene_t), intent(inout) :: scene
    type(parcel_t), intent(inout) :: bodies
    type(comm_t), intent(in) :: comm
    integer, allocatable :: start(:)
    integer :: n_home

    call order_records(bodies, comm%rank, comm%size, start, n_home)
    call rebuild_scene(scene, bodies, start, n_home)
  end subroutine settle
end module sg_migrate
