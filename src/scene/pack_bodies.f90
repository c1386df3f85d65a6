!> Bodies as records of reals, with their contactors, and scenes made of such records: how bodies travel between ranks.
!!
!! A record is its length, number in the whole scene, owner, number of contactors, and the lowest rule of the fields that it holds
!! (sg_fields); those fields; then the records of its contactors. What a step recomputes (forces, free velocities, the configuration
!! of detection) is no part of it.
module sg_pack_bodies
  use sg_bodies, only: bodies_t, make_bodies_like, no_bodies_like
  use sg_contactors, only: contactors_t
  use sg_field_visitor, only: sync_always, sync_never
  use sg_kinds, only: wp, i4, i8
  use sg_links, only: locate_links
  use sg_owners, only: counts_on
  use sg_pack_shapes, only: pack_contactors, unpack_contactors
  use sg_parcels, only: parcel_t
  use sg_scene, only: scene_t
  use sg_sorting, only: sort_permutation
  implicit none
  private
  public :: pack_bodies, order_records, rebuild_scene, drop_bodies, drop_step_state

  !> Places of values in a record; the first two are those of a record of a contactor too
  integer, parameter :: place_length = 1, place_number = 2, place_owner = 3
  !> Bodies whose fields are moved in one visit: few enough to stay in the cache
  integer, parameter :: per_visit = 256

contains

  !> Append the records of bodies with their contactors.
  subroutine pack_bodies(scene, body, first, list, owner, least, parcel)
    type(scene_t), intent(in) :: scene !! whole scene, or the part of this rank
    integer(i4), intent(in) :: body(:) !! bodies of that scene
    integer(i4), intent(in) :: first(:) !! contactors of body b are list(first(b):first(b + 1) - 1)
    integer(i4), intent(in) :: list(:) !! see `contactors_of_bodies`
    integer(i4), intent(in) :: owner(:) !! rank that owns each, or will; -1 for replicated bodies
    integer, intent(in) :: least !! `sync_on_copy` where the records are of copies, else `sync_on_owner`
    type(parcel_t), intent(inout) :: parcel !! takes the records
    integer :: b

    do b = 1, size(body), per_visit
      associate (some => body(b:min(b + per_visit - 1, size(body))))
        call pack_some(scene, some, first, list, owner(b:b + size(some) - 1), least, parcel)
      end associate
    end do
  end subroutine pack_bodies

  !> Append the records of a few bodies.
  subroutine pack_some(scene, body, first, list, owner, least, parcel)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: body(:), first(:), list(:), owner(:)
    integer, intent(in) :: least
    type(parcel_t), intent(inout) :: parcel
    type(parcel_t) :: shapes
    real(wp), allocatable :: values(:, :)
    integer, allocatable :: shape_start(:)
    integer(i4) :: number(size(body)), carried(size(body))
    integer :: start, i, c, k

    number = body
    if (allocated(scene%bodies%id)) number = scene%bodies%id(body)
    carried = first(body + 1) - first(body)
    call scene%bodies%pack(body, values, least)
    call pack_contactors(scene%contactors, [(list(first(body(i)):first(body(i) + 1) - 1), i=1, size(body))], shapes, shape_start)
    c = 1
    do i = 1, size(body)
      start = parcel%n + 1
      call parcel%put(0) ! the length, known at the end
      call parcel%put([number(i), owner(i), carried(i), int(least, i4)])
      call parcel%put(values(:, i))
      k = c + carried(i)
      if (k > c) call parcel%put(shapes%value(shape_start(c):shape_start(k) - 1))
      c = k
      parcel%value(start) = real(parcel%n - start + 1, wp)
    end do
  end subroutine pack_some

  !> Where the records of a parcel begin, in the order of a rank's bodies: first those it counts as its own, then copies of
  !! others', both by ascending number. No body may stand in the parcel twice.
  !!
  !! Of replicated bodies each rank counts as its own those whose number modulo the number of ranks is its own.
  pure subroutine order_records(parcel, rank, ranks, start, n_own)
    type(parcel_t), intent(in) :: parcel !! records of bodies and nothing else
    integer, intent(in) :: rank !! rank whose bodies they are
    integer, intent(in) :: ranks !! number of ranks
    integer, allocatable, intent(out) :: start(:) !! first value of each record, shape (bodies)
    integer, intent(out) :: n_own !! bodies that the rank counts as its own
    integer(i8), allocatable :: keys(:)
    integer(i8) :: last
    integer :: at, n, owner, number

    n = 0
    at = 1
    last = 0
    do while (at <= parcel%n)
      n = n + 1
      last = max(last, nint(parcel%value(at + place_number - 1), i8))
      at = at + nint(parcel%value(at + place_length - 1))
    end do
    allocate (start(n), keys(n))
    n_own = 0
    at = 1
    do n = 1, size(start)
      start(n) = at
      number = nint(parcel%value(at + place_number - 1))
      owner = nint(parcel%value(at + place_owner - 1))
      keys(n) = int(number, i8) + last
      if (counts_on(rank, ranks, int(owner, i4), int(number, i4))) then
        keys(n) = int(number, i8)
        n_own = n_own + 1
      end if
      at = at + nint(parcel%value(at + place_length - 1))
    end do
    start = start(sort_permutation(keys))
  end subroutine order_records

  !> Rebuild a scene from records of bodies; contactors stand by ascending number in the whole scene. What it held is given back
  !! before the new bodies ask for room.
  !!
  !! Forces, free velocities and the configuration of detection are zero. Drives, pressures and names (see `localise`) and contacts
  !! known at the start are dropped; all else stays.
  subroutine rebuild_scene(scene, parcel, start, n_own)
    type(scene_t), intent(inout) :: scene !! any scene of the run, whole or in part, of any bodies
    type(parcel_t), intent(inout) :: parcel !! records of bodies; used up
    integer, intent(in) :: start(:) !! first value of the record of each body, shape (bodies)
    integer, intent(in) :: n_own !! bodies that the rank counts as its own: the first ones

    call drop_bodies(scene)
    if (allocated(scene%drives)) deallocate (scene%drives)
    if (allocated(scene%pressures)) deallocate (scene%pressures)
    if (allocated(scene%start_contacts)) deallocate (scene%start_contacts)
    if (allocated(scene%names)) deallocate (scene%names)
    call make_bodies_like(no_bodies_like(scene%bodies), size(start), scene%bodies)
    scene%bodies%n_own = n_own
    call unpack_bodies(parcel, start, scene%bodies, scene%contactors)
    call locate_links(scene%links, scene%contactors)
    if (allocated(parcel%value)) deallocate (parcel%value)
  end subroutine rebuild_scene

  !> Give back what a step recomputes and no record holds: a scene that is only packed needs none of it.
  subroutine drop_step_state(scene)
    type(scene_t), intent(inout) :: scene !! scene about to be packed and then rebuilt

    if (allocated(scene%bodies%middle)) deallocate (scene%bodies%middle)
    if (allocated(scene%bodies%force)) deallocate (scene%bodies%force)
    if (allocated(scene%bodies%free_velocity)) deallocate (scene%bodies%free_velocity)
    if (allocated(scene%contactors%centre)) deallocate (scene%contactors%centre)
  end subroutine drop_step_state

  !> Give back the bodies and contactors of a scene whose records are all in parcels, before it is rebuilt from others.
  subroutine drop_bodies(scene)
    type(scene_t), intent(inout) :: scene !! scene without bodies afterwards
    type(contactors_t) :: no_contactors

    no_contactors%dimension = scene%contactors%dimension
    scene%bodies = no_bodies_like(scene%bodies)
    scene%contactors = no_contactors
  end subroutine drop_bodies

  !> Read bodies in the order of `start`, then their contactors by ascending number.
  subroutine unpack_bodies(parcel, start, bodies, contactors)
    type(parcel_t), intent(inout) :: parcel
    integer, intent(in) :: start(:)
    type(bodies_t), intent(inout) :: bodies
    type(contactors_t), intent(inout) :: contactors
    integer(i4) :: rule(size(start)), carried(size(start))
    integer :: behind(size(start)), least, b, width

    do b = 1, size(start)
      parcel%at = start(b) + place_number - 2
      call parcel%take(bodies%id(b))
      call parcel%take(bodies%owner(b))
      call parcel%take(carried(b))
      call parcel%take(rule(b))
      behind(b) = parcel%at
    end do
    do least = sync_never, sync_always
      width = bodies%width(least)
      call unpack_fields(parcel, behind, pack([(int(b, i4), b=1, size(start))], rule == least), width, least, bodies)
      where (rule == least) behind = behind + width
    end do
    call unpack_shapes(parcel, behind, carried, contactors)
  end subroutine unpack_bodies

  !> Read the fields of some bodies, which stand behind a value of each record.
  subroutine unpack_fields(parcel, behind, body, width, least, bodies)
    type(parcel_t), intent(in) :: parcel
    integer, intent(in) :: behind(:), width, least
    integer(i4), intent(in) :: body(:)
    type(bodies_t), intent(inout) :: bodies
    real(wp) :: values(width, min(per_visit, size(body)))
    integer :: b, i, n

    do b = 1, size(body), per_visit
      n = min(per_visit, size(body) - b + 1)
      do i = 1, n
        associate (at => behind(body(b + i - 1)))
          values(:, i) = parcel%value(at + 1:at + width)
        end associate
      end do
      call bodies%unpack(body(b:b + n - 1), values(:, :n), least)
    end do
  end subroutine unpack_fields

  !> Read the contactors that stand behind a value of each record, by ascending number.
  subroutine unpack_shapes(parcel, behind, carried, contactors)
    type(parcel_t), intent(inout) :: parcel
    integer, intent(in) :: behind(:)
    integer(i4), intent(in) :: carried(:) !! contactors of each body
    type(contactors_t), intent(inout) :: contactors
    integer, allocatable :: start(:)
    integer(i4), allocatable :: body(:), order(:)
    integer(i8), allocatable :: number(:)
    integer :: at, b, c, k

    allocate (start(sum(carried)), body(sum(carried)), number(sum(carried)))
    c = 0
    do b = 1, size(behind)
      at = behind(b) + 1
      do k = 1, carried(b)
        c = c + 1
        start(c) = at
        body(c) = int(b, i4)
        number(c) = nint(parcel%value(at + place_number - 1), i8)
        at = at + nint(parcel%value(at + place_length - 1))
      end do
    end do
    order = sort_permutation(number)
    deallocate (number)
    call unpack_contactors(contactors, parcel, start(order), body(order))
  end subroutine unpack_shapes
end module sg_pack_bodies
