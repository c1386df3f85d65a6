!> The part of a scene that one rank holds: its own bodies, all replicated ones, and copies of those that may touch its own
!! before the next search for neighbours, or are linked to them; and the ranks that share them (doc/theory/decomposition.md).
module sg_halo
  use sg_comm, only: comm_t
  use sg_field_visitor, only: sync_on_copy, sync_on_owner
  use sg_kinds, only: wp, i4, i8
  use sg_link_copies, only: link_copies_t
  use sg_lists, only: reserve
  use sg_local_numbers, only: contactors_of_bodies, local_body
  use sg_owners, only: contact_owner
  use sg_pack_bodies, only: order_records, pack_bodies, rebuild_scene
  use sg_parcels, only: parcel_t
  use sg_rank_bounds, only: body_reach, rank_bounds_t
  use sg_replicated_data, only: localise, replicated_data_t
  use sg_scene, only: scene_t
  use sg_sorting, only: group_items, sort_permutation
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: make_halo

  !> Copies of a rank's own bodies on other ranks
  type :: copies_t
    !> Number of copies; the body and the rank of each, by rank, then by body
    integer :: n = 0
    integer(i4), allocatable :: body(:), rank(:)
    !> Copies on rank r are `first(r)` to `first(r + 1) - 1`, ranks from 0
    integer, allocatable :: first(:)
    !> Copies of body b are `of_body(start(b):start(b + 1) - 1)`, by rank
    integer, allocatable :: start(:), of_body(:)
  end type copies_t

contains

  !> Rebuild the copies of a rank: bodies of the scene that are its own, and replicated ones, stay; all other copies are replaced.
  !! Collective.
  subroutine make_halo(scene, replicated, subdomain, margin, comm)
    type(scene_t), intent(inout) :: scene !! this rank's part, replaced
    type(replicated_data_t), intent(in) :: replicated !! drives, pressures and names of the whole scene
    type(subdomain_t), intent(inout) :: subdomain !! lists of shared bodies, rebuilt
    real(wp), intent(in) :: margin !! how near another rank's grains a body must come to be copied there [m]
    type(comm_t), intent(inout) :: comm !! the ranks
    type(parcel_t) :: bodies, holders
    integer, allocatable :: start(:), share(:, :)
    integer :: n_own

    call gather_records(scene, margin, comm, bodies, holders)
    call order_records(bodies, comm%rank, comm%size, start, n_own)
    call rebuild_scene(scene, bodies, start, n_own)
    call localise(replicated, scene)
    call read_holders(holders, share)
    call list_shares(scene, share, comm%rank, subdomain)
  end subroutine make_halo

  !> Records of all bodies that this rank is to hold, and the ranks that hold the shared ones.
  subroutine gather_records(scene, margin, comm, bodies, holders)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: margin
    type(comm_t), intent(inout) :: comm
    type(parcel_t), intent(inout) :: bodies, holders
    type(rank_bounds_t) :: bounds
    real(wp) :: reach(scene%bodies%n_own)
    integer(i4), allocatable :: first(:), list(:), kept(:)
    integer :: sent(0:comm%size - 1), n_words(0:comm%size - 1), r, b, i
    type(copies_t) :: copies
    type(link_copies_t) :: linked
    type(parcel_t) :: records, words

    reach = body_reach(scene, scene%bodies%n_own)
    call bounds%survey(scene, reach, margin, comm)
    call linked%find(scene, comm)
    call find_copies(scene, bounds, reach, linked, comm, copies)
    call contactors_of_bodies(scene%contactors, scene%bodies%n, first, list)
    do r = 0, comm%size - 1
      sent(r) = records%n
      n_words(r) = words%n
      associate (copied => copies%body(copies%first(r):copies%first(r + 1) - 1))
        call pack_bodies(scene, copied, first, list, scene%bodies%owner(copied), sync_on_copy, records)
        do i = 1, size(copied)
          call put_holders(scene%bodies%id(copied(i)), copies, int(copied(i)), words)
        end do
      end associate
      sent(r) = records%n - sent(r)
      n_words(r) = words%n - n_words(r)
    end do
    call swap_parcel(records, sent, comm, bodies)
    call swap_parcel(words, n_words, comm, holders)
    ! Own bodies and replicated ones stay; the words that this rank sends to itself name the other holders of its own.
    kept = [(int(b, i4), b=1, scene%bodies%n)]
    kept = pack(kept, kept <= scene%bodies%n_own .or. scene%bodies%owner(kept) < 0)
    call pack_bodies(scene, kept, first, list, scene%bodies%owner(kept), sync_on_owner, bodies)
    do b = 1, scene%bodies%n_own
      if (copies%start(b + 1) > copies%start(b)) call put_holders(scene%bodies%id(b), copies, b, holders)
    end do
  end subroutine gather_records

  !> Which ranks hold a copy of which own grains: only ranks whose grains come near, or are linked, are looked at.
  subroutine find_copies(scene, bounds, reach, linked, comm, copies)
    type(scene_t), intent(in) :: scene
    type(rank_bounds_t), intent(in) :: bounds
    real(wp), intent(in) :: reach(:)
    type(link_copies_t), intent(in) :: linked
    type(comm_t), intent(in) :: comm
    type(copies_t), intent(out) :: copies
    logical :: is_linked(scene%bodies%n_own), is_near
    integer :: r, b

    allocate (copies%first(0:comm%size), source=1)
    do r = 0, comm%size - 1
      copies%first(r) = copies%n + 1
      if (r == comm%rank) cycle
      is_near = bounds%first(r + 1) > bounds%first(r)
      call linked%mark(r, is_linked)
      if (.not. (is_near .or. any(is_linked))) cycle
      ! All contacts between two ranks belong to one of them: the other needs no copies.
      if (contact_owner(int([comm%rank, r], i4)) /= r) cycle
      do b = 1, scene%bodies%n_own
        if (scene%bodies%owner(b) < 0) cycle
        if (.not. is_linked(b)) then
          if (.not. is_near) cycle
          if (.not. bounds%is_near(r, scene%bodies%position(:, b), reach(b))) cycle
        end if
        copies%n = copies%n + 1
        call reserve(copies%body, copies%n)
        call reserve(copies%rank, copies%n)
        copies%body(copies%n) = int(b, i4)
        copies%rank(copies%n) = int(r, i4)
      end do
    end do
    copies%first(comm%size) = copies%n + 1
    if (.not. allocated(copies%body)) allocate (copies%body(0), copies%rank(0))
    call group_items(copies%body(:copies%n), scene%bodies%n_own, copies%start, copies%of_body)
  end subroutine find_copies

  !> Append the ranks that hold a body next to its owner: number, number of ranks, ranks.
  subroutine put_holders(number, copies, body, holders)
    integer(i4), intent(in) :: number
    type(copies_t), intent(in) :: copies
    integer, intent(in) :: body
    type(parcel_t), intent(inout) :: holders

    associate (held => copies%of_body(copies%start(body):copies%start(body + 1) - 1))
      call holders%put(number)
      call holders%put(size(held))
      call holders%put(copies%rank(held))
    end associate
  end subroutine put_holders

  !> Send each rank its part of a parcel, and take what comes back for another.
  subroutine swap_parcel(send, sent, comm, receive)
    type(parcel_t), intent(inout) :: send
    integer, intent(in) :: sent(0:)
    type(comm_t), intent(inout) :: comm
    type(parcel_t), intent(inout) :: receive
    real(wp), allocatable :: values(:)
    integer, allocatable :: received(:)

    if (.not. allocated(send%value)) allocate (send%value(0))
    call comm%swap(send%value(:send%n), sent, values, received)
    deallocate (send%value)
    call receive%adopt(values)
  end subroutine swap_parcel

  !> Read the holders of bodies, as pairs of rank and body number: a body with its holders and, of those that are not our own, its
  !! owner, which is looked up later.
  subroutine read_holders(holders, share)
    type(parcel_t), intent(inout) :: holders
    integer, allocatable, intent(out) :: share(:, :) !! rank and number of the body, shape (2, shares)
    integer(i4) :: number, ranks, r
    integer :: n, i, pass

    do pass = 1, 2
      n = 0
      holders%at = 0
      do while (holders%at < holders%n)
        call holders%take(number)
        call holders%take(ranks)
        do i = 1, ranks
          call holders%take(r)
          n = n + 1
          if (pass == 2) share(:, n) = [r, number]
        end do
      end do
      if (pass == 1) allocate (share(2, n))
    end do
  end subroutine read_holders

  !> Lists of the bodies shared with each neighbour.
  subroutine list_shares(scene, share, rank, subdomain)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: share(:, :), rank
    type(subdomain_t), intent(inout) :: subdomain
    integer(i8), allocatable :: keys(:)
    integer, allocatable :: entry(:, :)
    integer :: b, i, n

    ! A copy is shared with its owner too.
    associate (bodies => scene%bodies)
      entry = share(:, pack([(i, i=1, size(share, 2))], share(1, :) /= rank))
      n = size(entry, 2)
      entry = reshape([reshape(entry, [2*n]), [([int(bodies%owner(b)), int(bodies%id(b))], b=bodies%n_own + 1, bodies%n)]], &
                      [2, n + bodies%n - bodies%n_own])
      entry = entry(:, pack([(i, i=1, size(entry, 2))], entry(1, :) >= 0))
      allocate (keys(size(entry, 2)))
      keys = int(entry(1, :), i8)*int(subdomain%all_bodies + 1, i8) + int(entry(2, :), i8)
      entry = entry(:, sort_permutation(keys))
      if (allocated(subdomain%neighbour)) deallocate (subdomain%neighbour, subdomain%first, subdomain%body, subdomain%owner)
      subdomain%neighbour = pack(entry(1, :), [(is_first(i), i=1, size(entry, 2))])
      subdomain%first = [pack([(i, i=1, size(entry, 2))], [(is_first(i), i=1, size(entry, 2))]), size(entry, 2) + 1]
      subdomain%body = [(local_body(bodies, int(entry(2, i), i4)), i=1, size(entry, 2))]
      subdomain%owner = int(bodies%owner(subdomain%body))
      subdomain%replicated = pack([(b, b=1, bodies%n)], bodies%owner < 0)
      subdomain%replicated = subdomain%replicated(sort_permutation(int(bodies%id(subdomain%replicated), i8)))
    end associate
    subdomain%serial = subdomain%serial + 1
  contains
    !> Does a new neighbour begin here?
    pure logical function is_first(i)
      integer, intent(in) :: i

      is_first = i == 1
      if (.not. is_first) is_first = entry(1, i) /= entry(1, i - 1)
    end function is_first
  end subroutine list_shares
end module sg_halo
