!> Copies without a contact on their rank: they take no part while a problem is solved, and get the velocity found at the end, from
!! the owner of the body or, where the owner has no contact on it either, from the lowest rank that has.
module sg_idle_copies
  use sg_comm, only: comm_t
  use sg_exchange, only: exchange_t
  use sg_kinds, only: wp
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: tables_t
  implicit none
  private
  public :: idle_copies_t

  !> Messages to copies without contacts
  type :: idle_copies_t
    !> Slots of the velocities that this rank sends, and of those that it receives
    integer, allocatable, private :: send_slots(:), receive_slots(:)
    type(exchange_t), private :: messages
  contains
    procedure :: update => idle_update
    procedure :: note_tables => idle_note_tables
  end type idle_copies_t

contains

  !> Give the velocities found to the copies that took no part. Collective among neighbours.
  subroutine idle_update(self, body, width, coupling, is_here, is_there, comm)
    class(idle_copies_t), intent(inout) :: self
    real(wp), intent(inout) :: body(:, :) !! by slot, velocities first; those of copies without contacts are set
    integer, intent(in) :: width !! components of a velocity
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    logical, intent(in) :: is_here(:) !! has this rank a contact on each body of `coupling%body`?
    logical, intent(in) :: is_there(:) !! has the neighbour one?
    type(comm_t), intent(inout) :: comm !! the ranks
    integer :: i

    call list_messages(self, coupling, is_here, is_there, size(body, 2), width, comm)
    do i = 1, size(self%send_slots)
      self%messages%send(:, i) = body(:width, self%send_slots(i))
    end do
    call self%messages%begin(comm)
    call self%messages%finish(comm)
    do i = 1, size(self%receive_slots)
      body(:width, self%receive_slots(i)) = self%messages%receive(:, i)
    end do
  end subroutine idle_update

  !> List which rank sends the result for a body, and which receive it: the owner sends if it has contacts on the body, else the
  !! lowest rank that has.
  subroutine list_messages(self, coupling, is_here, is_there, n_slots, width, comm)
    class(idle_copies_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: coupling
    logical, intent(in) :: is_here(:), is_there(:)
    integer, intent(in) :: n_slots, width
    type(comm_t), intent(in) :: comm
    integer, allocatable :: sender(:), slot(:)
    integer :: sent(size(coupling%neighbour)), received(size(coupling%neighbour)), i, e, n_send, n_receive

    slot = coupling%body
    allocate (sender(n_slots), source=huge(1))
    do i = 1, size(coupling%neighbour)
      do e = coupling%first(i), coupling%first(i + 1) - 1
        if (is_here(e)) call propose(sender(slot(e)), coupling%rank, coupling%owner(e))
        if (is_there(e)) call propose(sender(slot(e)), coupling%neighbour(i), coupling%owner(e))
      end do
    end do
    if (allocated(self%send_slots)) deallocate (self%send_slots, self%receive_slots)
    allocate (self%send_slots(size(slot)), self%receive_slots(size(slot)))
    n_send = 0
    n_receive = 0
    do i = 1, size(coupling%neighbour)
      sent(i) = n_send
      received(i) = n_receive
      do e = coupling%first(i), coupling%first(i + 1) - 1
        if (sender(slot(e)) == coupling%rank .and. .not. is_there(e)) then
          n_send = n_send + 1
          self%send_slots(n_send) = slot(e)
        else if (sender(slot(e)) == coupling%neighbour(i) .and. .not. is_here(e)) then
          n_receive = n_receive + 1
          self%receive_slots(n_receive) = slot(e)
        end if
      end do
      sent(i) = n_send - sent(i)
      received(i) = n_receive - received(i)
    end do
    self%send_slots = self%send_slots(:n_send)
    self%receive_slots = self%receive_slots(:n_receive)
    call self%messages%prepare(comm, width, coupling%neighbour, sent, received)
  contains
    !> The owner sends if it has contacts, else the lowest rank.
    pure subroutine propose(sender, rank, owner)
      integer, intent(inout) :: sender
      integer, intent(in) :: rank, owner

      if (sender == owner) return
      if (rank == owner .or. rank < sender) sender = rank
    end subroutine propose
  end subroutine list_messages

  !> Add these tables to those of the interface.
  subroutine idle_note_tables(self, tables)
    class(idle_copies_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%note('send_slots', self%send_slots)
    call tables%note('receive_slots', self%receive_slots)
    call tables%add('to_idle', self%messages%table_bytes())
  end subroutine idle_note_tables
end module sg_idle_copies
