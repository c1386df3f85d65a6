!> Entries of H that other ranks' contacts have on the unknowns that this rank's contacts push.
!!
!! Each rank sends its entries to the ranks that own their unknowns, and these send each of them on to all others that have some
!! of the same unknown. So every rank gets the rows of H that rows of W of its contacts are made of, and no others.
module sg_shared_entries
  use sg_ascending, only: first_at_least
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, i4, i8
  use sg_lists, only: reserve
  use sg_shared_unknowns, only: shared_unknowns_t
  use sg_sorting, only: group_items
  implicit none
  private
  public :: entries_t, exchange_entries

  !> Reals of an entry in a message to its owner: number of the unknown, its place at the sender, then what follows below
  integer, parameter :: n_sent = 6
  !> Reals of an entry that is sent on: place of the unknown at the receiver, column, value, impulse and cohesion
  integer, parameter :: n_passed = 5

  !> Entries of H, in no order
  type :: entries_t
    !> How many
    integer :: n = 0
    !> Place of the unknown of each among those of this rank, and component of a contact in the whole problem
    integer(i4), allocatable :: row(:), column(:)
    !> Value, and along that component impulse and cohesion [N s]
    real(wp), allocatable :: value(:), impulse(:), cohesion(:)
  end type entries_t

contains

  !> Learn the entries of others, and what all impulses and cohesions do to the unknowns of this rank. Collective.
  subroutine exchange_entries(own, unknowns, comm, others, pushed)
    type(entries_t), intent(in) :: own !! of this rank's contacts
    type(shared_unknowns_t), intent(in) :: unknowns !! unknowns that this rank has to do with
    type(comm_t), intent(inout) :: comm !! the ranks
    type(entries_t), intent(out) :: others !! of other ranks' contacts
    real(wp), allocatable, intent(out) :: pushed(:, :) !! H r and H c of its own unknowns, shape (2, n_own)
    real(wp), allocatable :: received(:), passed(:)
    integer, allocatable :: counts(:), pass_counts(:)
    integer :: i

    call send_to_owners(own, unknowns, comm, received, counts)
    call pass_on(received, counts/n_sent, unknowns, comm, passed, pass_counts, pushed)
    others%n = size(passed)/n_passed
    allocate (others%row(others%n), others%column(others%n), others%value(others%n), others%impulse(others%n), &
              others%cohesion(others%n))
    do i = 1, others%n
      associate (entry => passed(n_passed*(i - 1) + 1:n_passed*i))
        others%row(i) = nint(entry(1), i4)
        others%column(i) = nint(entry(2), i4)
        others%value(i) = entry(3)
        others%impulse(i) = entry(4)
        others%cohesion(i) = entry(5)
      end associate
    end do
  end subroutine exchange_entries

  !> Send the entries to the owners of their unknowns.
  subroutine send_to_owners(own, unknowns, comm, received, counts)
    type(entries_t), intent(in) :: own
    type(shared_unknowns_t), intent(in) :: unknowns
    type(comm_t), intent(inout) :: comm
    real(wp), allocatable, intent(out) :: received(:)
    integer, allocatable, intent(out) :: counts(:) !! reals from each rank
    real(wp), allocatable :: send(:)
    integer(i4) :: owner(own%n)
    integer(i8), allocatable :: last(:)
    integer, allocatable :: first(:), item(:)
    integer :: i, e

    call comm%gather(unknowns%before + int(unknowns%n_own, i8), last)
    ! An unknown is of the first rank whose last number is not below it.
    do e = 1, own%n
      owner(e) = int(first_at_least(last, int(unknowns%number(own%row(e)), i8)), i4)
    end do
    call group_items(owner, comm%size, first, item)
    allocate (send(n_sent*own%n))
    do i = 1, own%n
      e = item(i)
      send(n_sent*(i - 1) + 1:n_sent*i) = [real(unknowns%number(own%row(e)), wp), real(own%row(e), wp), real(own%column(e), wp), &
                                           own%value(e), own%impulse(e), own%cohesion(e)]
    end do
    call comm%swap(send, n_sent*(first(2:) - first(:comm%size)), received, counts)
  end subroutine send_to_owners

  !> Sum what the entries received do to their unknowns, and send each to all ranks that have others of its unknown.
  subroutine pass_on(received, from, unknowns, comm, passed, counts, pushed)
    real(wp), intent(in) :: received(:)
    integer, intent(in) :: from(0:) !! entries from each rank
    type(shared_unknowns_t), intent(in) :: unknowns
    type(comm_t), intent(inout) :: comm
    real(wp), allocatable, intent(out) :: passed(:)
    integer, allocatable, intent(out) :: counts(:)
    real(wp), allocatable, intent(out) :: pushed(:, :)
    real(wp), allocatable :: entry(:, :), send(:)
    integer, allocatable :: first(:), item(:)
    integer(i4), allocatable :: row(:), rank(:), copy(:, :)
    integer :: i

    entry = reshape(received, [n_sent, size(received)/n_sent])
    row = int(nint(entry(1, :), i8) - unknowns%before, i4)
    rank = senders(from)
    allocate (pushed(2, unknowns%n_own), source=0.0_wp)
    do i = 1, size(row)
      pushed(:, row(i)) = pushed(:, row(i)) + entry(4, i)*entry(5:6, i)
    end do
    call group_items(row, unknowns%n_own, first, item)
    call list_copies(first, item, rank, copy)
    call group_items(rank(copy(1, :)), comm%size, first, item)
    allocate (send(n_passed*size(item)))
    do i = 1, size(item)
      associate (at_receiver => entry(2, copy(1, item(i))), passed_on => entry(3:6, copy(2, item(i))))
        send(n_passed*(i - 1) + 1:n_passed*i) = [at_receiver, passed_on]
      end associate
    end do
    call comm%swap(send, n_passed*(first(2:) - first(:comm%size)), passed, counts)
  end subroutine pass_on

  !> The rank, from 1, that each entry received came from.
  pure function senders(from) result(rank)
    integer, intent(in) :: from(0:) !! entries from each rank
    integer(i4) :: rank(sum(from))
    integer :: r, n

    n = 0
    do r = 0, ubound(from, 1)
      rank(n + 1:n + from(r)) = int(r + 1, i4)
      n = n + from(r)
    end do
  end function senders

  !> Each entry for each other rank, once, that has entries of the same unknown: an entry that identifies that rank and its place of
  !! the unknown, and the entry to send there.
  subroutine list_copies(first, item, rank, copy)
    integer, intent(in) :: first(:), item(:) !! entries of each unknown, those of a rank one after the other
    integer(i4), intent(in) :: rank(:) !! of each entry
    integer(i4), allocatable, intent(out) :: copy(:, :) !! shape (2, copies)
    integer :: u, i, j, n

    n = 0
    allocate (copy(2, 0))
    do u = 1, size(first) - 1
      do i = first(u), first(u + 1) - 1
        ! The first entry of each rank stands for it.
        if (i > first(u)) then
          if (rank(item(i - 1)) == rank(item(i))) cycle
        end if
        do j = first(u), first(u + 1) - 1
          if (rank(item(j)) == rank(item(i))) cycle
          n = n + 1
          call reserve(copy, 2, n)
          copy(:, n) = int([item(i), item(j)], i4)
        end do
      end do
    end do
    copy = copy(:, :n)
  end subroutine list_copies
end module sg_shared_entries
