!> Detection shared by threads: shapes and pairs in pieces, whose contacts are put together in the order of the list.
!!
!! Contacts are the same, bit for bit, for any number of threads and pieces (doc/theory/threads.md). Those of the first pieces are
!! found where they stay, those of the last ones, which other threads take, in lists of their own.
module sg_touch_pieces
  use sg_contactors, only: contactors_t, kind_polyhedron, place_all_corners, place_run
  use sg_contacts, only: begin_like, contacts_t, copy_run, grow_contacts
  use sg_history, only: history_t
  use sg_kinds, only: wp, i4
  use sg_neighbour_list, only: neighbours_t
  use sg_scene, only: scene_t
  use sg_threads, only: begin_share, is_first_thread, n_sharing, piece_t, share_t, takes
  use sg_touch_run, only: runs_t, touch_run
  implicit none
  private
  public :: place_pieces, touch_pieces

  !> Least shapes and pairs of a piece; placing a polyhedron takes as long as placing so many others
  integer, parameter :: least_shapes = 1024, least_pairs = 256, shapes_per_polyhedron = 16

contains

  !> Put all contactors where their bodies are.
  subroutine place_pieces(contactors, middle, corners_wait)
    type(contactors_t), intent(inout) :: contactors !! contactors to place
    real(wp), intent(in), contiguous :: middle(:, :) !! bodies' configuration, see `bodies_t`
    logical, intent(in) :: corners_wait !! do vertices and edges of polygons wait for `place_corners_once`?
    type(share_t) :: share
    type(piece_t) :: piece
    integer :: t

    call begin_share(share, contactors%n, least_shapes/merge(shapes_per_polyhedron, 1, contactors%n_rows(kind_polyhedron) > 0))
    !$omp taskloop default(shared) private(t, piece) grainsize(1) if (share%pieces > 1)
    do t = 1, n_sharing()
      do while (takes(share, piece))
        call place_run(contactors, middle, piece%first, piece%last)
        if (.not. corners_wait) call place_all_corners(contactors, piece%first, piece%last)
      end do
    end do
  end subroutine place_pieces

  !> Contacts of all pairs that are no links.
  subroutine touch_pieces(scene, pairs, history, runs, contacts, first)
    type(scene_t), intent(inout) :: scene !! scene, its contactors placed; corners of polygons where they are needed
    type(neighbours_t), intent(inout) :: pairs !! list of neighbours; it may turn out late
    type(history_t), intent(inout) :: history !! contacts of the last detection; what is tried first of the pairs is set
    type(runs_t), intent(in) :: runs !! what all pairs share
    type(contacts_t), intent(inout) :: contacts !! contacts of the step: none before
    integer(i4), intent(inout), contiguous :: first(:) !! first contact of each pair
    type(share_t) :: share
    type(piece_t) :: piece
    logical, allocatable :: is_late(:)
    integer, allocatable :: from(:)
    integer :: t

    if (.not. allocated(history%past)) allocate (history%past(0))
    call begin_share(share, pairs%n_near, least_pairs)
    allocate (is_late(share%pieces), source=.false.)
    ! First pair of the pieces whose contacts are found apart, 0 of others.
    allocate (from(share%pieces), source=0)
    call begin_pieces(share%pieces, contacts, history%found)
    !$omp taskloop default(shared) private(t, piece) grainsize(1) if (share%pieces > 1)
    do t = 1, n_sharing()
      do while (takes(share, piece))
        associate (i => piece%number)
          if (is_first_thread()) then
            call touch_run(scene, pairs, history, runs, piece%first, piece%last, contacts, first, is_late(i))
          else
            from(i) = piece%first
            call touch_run(scene, pairs, history, runs, piece%first, piece%last, history%found(i), first, is_late(i))
          end if
        end associate
      end do
    end do
    pairs%is_late = pairs%is_late .or. any(is_late)
    if (any(from > 0)) call put_together(from, pairs%n_near, history%found, contacts, first)
  end subroutine touch_pieces

  !> Empty lists for contacts of each piece that may be found apart: together with as much room as there is for all.
  subroutine begin_pieces(n, contacts, found)
    integer, intent(in) :: n
    type(contacts_t), intent(in) :: contacts
    type(contacts_t), allocatable, intent(inout) :: found(:)
    integer :: i

    if (n == 1) return
    if (allocated(found)) then
      if (size(found) /= n) deallocate (found)
    end if
    if (.not. allocated(found)) allocate (found(n))
    do i = 1, n
      call begin_like(found(i), contacts)
      call grow_contacts(found(i), size(contacts%gap)/n + 1)
    end do
  end subroutine begin_pieces

  !> Copy contacts that were found apart behind the others, piece by piece.
  subroutine put_together(from, n_pairs, found, contacts, first)
    integer, intent(in) :: from(:), n_pairs
    type(contacts_t), intent(in) :: found(:)
    type(contacts_t), intent(inout) :: contacts
    integer(i4), intent(inout), contiguous :: first(:)
    type(share_t) :: share
    type(piece_t) :: piece
    integer :: i, t, last(0:size(from)), last_pair(size(from))

    last(0) = contacts%n
    do i = 1, size(from)
      last(i) = last(i - 1) + merge(found(i)%n, 0, from(i) > 0)
      last_pair(i) = n_pairs
      if (i < size(from)) last_pair(i) = from(i + 1) - 1
    end do
    contacts%is_cut = contacts%is_cut .or. any(found%is_cut .and. from > 0)
    if (.not. contacts%is_cut) call grow_contacts(contacts, last(size(from)))
    ! Where memory is short nothing is left of the contacts; how many there were is reported.
    contacts%n = last(size(from))
    if (contacts%is_cut) return
    call begin_share(share, size(from), 1)
    !$omp taskloop default(shared) private(t, i, piece) grainsize(1) if (share%pieces > 1)
    do t = 1, n_sharing()
      do while (takes(share, piece))
        do i = piece%first, piece%last
          if (from(i) == 0) cycle
          call copy_run(found(i), last(i - 1), contacts)
          call shift_numbers(last(i - 1), first(from(i):last_pair(i)))
        end do
      end do
    end do
  end subroutine put_together

  !> Add to the numbers of contacts what stands before them.
  pure subroutine shift_numbers(before, first)
    integer, intent(in) :: before
    integer(i4), intent(inout), contiguous :: first(:)

    first = first + int(before, i4)
  end subroutine shift_numbers
end module sg_touch_pieces
