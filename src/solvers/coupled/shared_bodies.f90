!> Shared bodies of one step and their multiplicity: a body is shared by the ranks that have contacts on it
!! (doc/theory/decomposition.md).
!!
!! Copies without a contact take no part while a problem is solved; their ranks get the velocity found at the end, from
!! the home of the body or, where home has no contact on it either, from the lowest rank that has.
module sg_shared_bodies
  use sg_comm, only: comm_t
  use sg_exchange, only: exchange_t
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse
  use sg_replicated_bodies, only: replicated_bodies_t
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: per_body, tables_t
  implicit none
  private
  public :: shared_bodies_t

  !> Bodies shared in one step
  type :: shared_bodies_t
    !> Has this rank, and has the neighbour, a contact on each body of `coupling%body`?
    logical, allocatable :: is_here(:), is_there(:)
    !> Shared slots of this rank: bodies on which this rank and others have contacts; replicated ones are not among them
    integer, allocatable :: slot(:)
    !> Ranks that have contacts on each of them
    integer, allocatable :: multiplicity(:)
    !> Item j of messages to and from neighbours belongs to `slot(item(j))`
    integer, allocatable :: item(:)
    !> Items of neighbour i are `first(i)` to `first(i + 1) - 1`
    integer, allocatable :: first(:)
    !> Replicated bodies that can move
    type(replicated_bodies_t) :: replicated
    !> Messages at the end: slots of the velocities that this rank sends, and of those that it receives
    type(exchange_t), private :: last
    integer, allocatable, private :: send_slots(:), receive_slots(:)
    !> Messages about the bodies on which ranks have contacts
    type(exchange_t), private :: activity
    integer, private :: serial = -1
  contains
    procedure :: find => shared_find
    procedure :: broadcast_velocities => shared_broadcast_velocities
    procedure :: list_tables => shared_list_tables
  end type shared_bodies_t

contains

  !> Find the shared bodies of a problem and their multiplicity. Collective.
  subroutine shared_find(self, problem, coupling, comm)
    class(shared_bodies_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! this rank's contacts
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks
    logical, allocatable :: is_touched(:)
    integer :: k

    allocate (is_touched(problem%n_bodies), source=.false.)
    do k = 1, problem%n_contacts
      is_touched(problem%pair(:, k)) = .true.
    end do
    self%is_here = is_touched(coupling%body)
    call share_activity(self, coupling, comm)
    call list_shared(self, coupling, problem%n_bodies)
    call share_replicated(self, coupling%wide, is_touched, problem, comm)
  end subroutine shared_find

  !> Exchange with neighbours on which shared bodies ranks have contacts.
  subroutine share_activity(self, coupling, comm)
    class(shared_bodies_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: coupling
    type(comm_t), intent(inout) :: comm

    if (self%serial /= coupling%serial) then
      associate (counts => coupling%first(2:) - coupling%first(:size(coupling%neighbour)))
        call self%activity%prepare(comm, 1, coupling%neighbour, counts, counts)
      end associate
      self%serial = coupling%serial
    end if
    self%activity%send(1, :) = merge(1.0_wp, 0.0_wp, self%is_here)
    call self%activity%begin(comm)
    call self%activity%finish(comm)
    self%is_there = self%activity%receive(1, :) > 0.5_wp
  end subroutine share_activity

  !> List the bodies on which this rank and others have contacts.
  subroutine list_shared(self, coupling, n_slots)
    class(shared_bodies_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: coupling
    integer, intent(in) :: n_slots
    integer, allocatable :: place(:)
    integer :: i, e, n, items

    if (allocated(self%slot)) deallocate (self%slot, self%multiplicity, self%item, self%first)
    allocate (place(n_slots), source=0)
    allocate (self%slot(size(coupling%body)), self%multiplicity(size(coupling%body)), self%item(size(coupling%body)), &
              self%first(size(coupling%neighbour) + 1), source=1)
    n = 0
    items = 0
    do i = 1, size(coupling%neighbour)
      self%first(i) = items + 1
      do e = coupling%first(i), coupling%first(i + 1) - 1
        if (.not. (self%is_here(e) .and. self%is_there(e))) cycle
        if (place(coupling%body(e)) == 0) then
          n = n + 1
          place(coupling%body(e)) = n
          self%slot(n) = coupling%body(e)
          self%multiplicity(n) = 1
        end if
        items = items + 1
        self%item(items) = place(coupling%body(e))
        self%multiplicity(place(coupling%body(e))) = self%multiplicity(place(coupling%body(e))) + 1
      end do
    end do
    self%first(size(coupling%neighbour) + 1) = items + 1
    self%slot = self%slot(:n)
    self%multiplicity = self%multiplicity(:n)
    self%item = self%item(:items)
  end subroutine list_shared

  !> List which rank sends the result for a body, and which receive it: the home sends if it has contacts on the body, else the
  !! lowest rank that has.
  subroutine list_result(self, problem, coupling, comm)
    class(shared_bodies_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    type(subdomain_t), intent(in) :: coupling
    type(comm_t), intent(in) :: comm
    integer, allocatable :: sender(:), slot(:)
    integer :: sent(size(coupling%neighbour)), received(size(coupling%neighbour)), i, e, n_send, n_receive

    slot = coupling%body
    allocate (sender(problem%n_bodies), source=huge(1))
    do i = 1, size(coupling%neighbour)
      do e = coupling%first(i), coupling%first(i + 1) - 1
        if (self%is_here(e)) call propose(sender(slot(e)), coupling%rank, coupling%home(e))
        if (self%is_there(e)) call propose(sender(slot(e)), coupling%neighbour(i), coupling%home(e))
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
        if (sender(slot(e)) == coupling%rank .and. .not. self%is_there(e)) then
          n_send = n_send + 1
          self%send_slots(n_send) = slot(e)
        else if (sender(slot(e)) == coupling%neighbour(i) .and. .not. self%is_here(e)) then
          n_receive = n_receive + 1
          self%receive_slots(n_receive) = slot(e)
        end if
      end do
      sent(i) = n_send - sent(i)
      received(i) = n_receive - received(i)
    end do
    self%send_slots = self%send_slots(:n_send)
    self%receive_slots = self%receive_slots(:n_receive)
    call self%last%prepare(comm, first_inverse(problem%kind) - 1, coupling%neighbour, sent, received)
  contains
    !> The home sends if it has contacts, else the lowest rank.
    pure subroutine propose(sender, rank, home)
      integer, intent(inout) :: sender
      integer, intent(in) :: rank, home

      if (sender == home) return
      if (rank == home .or. rank < sender) sender = rank
    end subroutine propose
  end subroutine list_result

  !> Count the ranks that have contacts on replicated bodies which impulses can move.
  subroutine share_replicated(self, slot, is_touched, problem, comm)
    class(shared_bodies_t), intent(inout) :: self
    integer, intent(in) :: slot(:)
    logical, intent(in) :: is_touched(:) !! by slot
    type(problem_t), intent(in) :: problem
    type(comm_t), intent(inout) :: comm
    integer :: i

    self%replicated%slot = pack(slot, [(can_move(problem, slot(i)), i=1, size(slot))])
    self%replicated%is_here = is_touched(self%replicated%slot)
    self%replicated%multiplicity = merge(1, 0, self%replicated%is_here)
    if (size(self%replicated%multiplicity) > 0) call comm%sum(self%replicated%multiplicity)
    call self%replicated%mark(problem, first_inverse(problem%kind) - 1)
  end subroutine share_replicated

  !> Can impulses move a body?
  pure logical function can_move(problem, slot)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: slot

    can_move = any(problem%body(first_inverse(problem%kind):, slot) > 0)
  end function can_move

  !> Give the velocities found to the copies that took no part. Collective among neighbours.
  subroutine shared_broadcast_velocities(self, problem, coupling, comm)
    class(shared_bodies_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! velocities of copies without contacts are set
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks
    integer :: i, width

    call list_result(self, problem, coupling, comm)
    width = size(self%last%send, 1)
    do i = 1, size(self%send_slots)
      self%last%send(:, i) = problem%body(:width, self%send_slots(i))
    end do
    call self%last%begin(comm)
    call self%last%finish(comm)
    do i = 1, size(self%receive_slots)
      problem%body(:width, self%receive_slots(i)) = self%last%receive(:, i)
    end do
  end subroutine shared_broadcast_velocities

  !> List the tables of what is shared in a step, and the messages about it.
  subroutine shared_list_tables(self, tables)
    class(shared_bodies_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('shared_bodies', per_body)
    call tables%note('is_here', self%is_here)
    call tables%note('is_there', self%is_there)
    call tables%note('slot', self%slot)
    call tables%note('multiplicity', self%multiplicity)
    call tables%note('item', self%item)
    call tables%note('first', self%first)
    call tables%note('send_slots', self%send_slots)
    call tables%note('receive_slots', self%receive_slots)
    call tables%add('last', self%last%table_bytes())
    call tables%add('activity', self%activity%table_bytes())
    call self%replicated%list_tables(tables)
  end subroutine shared_list_tables
end module sg_shared_bodies
