!> Who shares which bodies in one step: a body is shared by the ranks that have contacts on it (doc/theory/decomposition.md).
!!
!! Copies without a contact take no part while a problem is solved; their ranks get the velocity found at the end, from
!! the home of the body or, where home has no contact on it either, from the lowest rank that has.
module sg_sharing
  use sg_comm, only: comm_t
  use sg_exchange, only: exchange_t
  use sg_kinds, only: wp, i4
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: per_body, tables_t
  use sg_wide_bodies, only: wide_bodies_t
  implicit none
  private
  public :: sharing_t

  !> Bodies shared in one step
  type :: sharing_t
    !> Has this rank, and has the neighbour, a contact on each body of `subdomain%body`?
    logical, allocatable :: is_here(:), is_there(:)
    !> Shared slots of this rank: bodies on which this rank and others have contacts; wide ones are not among them
    integer, allocatable :: slot(:)
    !> Ranks that have contacts on each of them
    integer, allocatable :: parts(:)
    !> Item j of messages to and from neighbours belongs to `slot(item(j))`
    integer, allocatable :: item(:)
    !> Items of neighbour i are `first(i)` to `first(i + 1) - 1`
    integer, allocatable :: first(:)
    !> Wide bodies that can move
    type(wide_bodies_t) :: wide
    !> Messages at the end: slots whose velocities this rank sends, and those that it receives
    type(exchange_t), private :: last
    integer, allocatable, private :: told(:), heard(:)
    !> Messages that say on which bodies ranks have contacts
    type(exchange_t), private :: activity
    integer, private :: serial = -1
  contains
    procedure :: find => sharing_find
    procedure :: tell_result => sharing_tell_result
    procedure :: list_tables => sharing_list_tables
  end type sharing_t

contains

  !> Find out who shares what in a problem. Collective.
  subroutine sharing_find(self, problem, subdomain, slot_of, comm)
    class(sharing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! this rank's contacts
    type(subdomain_t), intent(in) :: subdomain !! who holds which body
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body
    type(comm_t), intent(inout) :: comm !! the ranks
    logical, allocatable :: is_touched(:)
    integer :: k

    allocate (is_touched(problem%n_bodies), source=.false.)
    do k = 1, problem%n_contacts
      is_touched(problem%pair(:, k)) = .true.
    end do
    self%is_here = is_touched(slot_of(subdomain%body))
    call share_activity(self, subdomain, comm)
    call list_shared(self, subdomain, slot_of(subdomain%body), problem%n_bodies)
    call share_wide(self, slot_of(subdomain%wide), is_touched, problem, comm)
  end subroutine sharing_find

  !> Tell neighbours on which shared bodies this rank has contacts, and hear it from them.
  subroutine share_activity(self, subdomain, comm)
    class(sharing_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: subdomain
    type(comm_t), intent(inout) :: comm

    if (self%serial /= subdomain%serial) then
      associate (counts => subdomain%first(2:) - subdomain%first(:size(subdomain%neighbour)))
        call self%activity%prepare(comm, 1, subdomain%neighbour, counts, counts)
      end associate
      self%serial = subdomain%serial
    end if
    self%activity%send(1, :) = merge(1.0_wp, 0.0_wp, self%is_here)
    call self%activity%begin(comm)
    call self%activity%finish(comm)
    self%is_there = self%activity%receive(1, :) > 0.5_wp
  end subroutine share_activity

  !> List the bodies on which this rank and others have contacts.
  subroutine list_shared(self, subdomain, slot, n_slots)
    class(sharing_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: subdomain
    integer, intent(in) :: slot(:) !! slots of the entries
    integer, intent(in) :: n_slots
    integer, allocatable :: place(:)
    integer :: i, e, n, items

    if (allocated(self%slot)) deallocate (self%slot, self%parts, self%item, self%first)
    allocate (place(n_slots), source=0)
    allocate (self%slot(size(slot)), self%parts(size(slot)), self%item(size(slot)), &
              self%first(size(subdomain%neighbour) + 1), source=1)
    n = 0
    items = 0
    do i = 1, size(subdomain%neighbour)
      self%first(i) = items + 1
      do e = subdomain%first(i), subdomain%first(i + 1) - 1
        if (.not. (self%is_here(e) .and. self%is_there(e))) cycle
        if (place(slot(e)) == 0) then
          n = n + 1
          place(slot(e)) = n
          self%slot(n) = slot(e)
          self%parts(n) = 1
        end if
        items = items + 1
        self%item(items) = place(slot(e))
        self%parts(place(slot(e))) = self%parts(place(slot(e))) + 1
      end do
    end do
    self%first(size(subdomain%neighbour) + 1) = items + 1
    self%slot = self%slot(:n)
    self%parts = self%parts(:n)
    self%item = self%item(:items)
  end subroutine list_shared

  !> List which rank sends the result for a body, and which receive it: the home sends if it has contacts on the body, else the
  !! lowest rank that has.
  subroutine list_result(self, problem, subdomain, slot_of, comm)
    class(sharing_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    type(subdomain_t), intent(in) :: subdomain
    integer(i4), intent(in) :: slot_of(:)
    type(comm_t), intent(in) :: comm
    integer, allocatable :: sender(:), slot(:)
    integer :: told(size(subdomain%neighbour)), heard(size(subdomain%neighbour)), i, e, n_told, n_heard

    slot = slot_of(subdomain%body)
    allocate (sender(problem%n_bodies), source=huge(1))
    do i = 1, size(subdomain%neighbour)
      do e = subdomain%first(i), subdomain%first(i + 1) - 1
        if (self%is_here(e)) call propose(sender(slot(e)), subdomain%rank, subdomain%home(e))
        if (self%is_there(e)) call propose(sender(slot(e)), subdomain%neighbour(i), subdomain%home(e))
      end do
    end do
    if (allocated(self%told)) deallocate (self%told, self%heard)
    allocate (self%told(size(slot)), self%heard(size(slot)))
    n_told = 0
    n_heard = 0
    do i = 1, size(subdomain%neighbour)
      told(i) = n_told
      heard(i) = n_heard
      do e = subdomain%first(i), subdomain%first(i + 1) - 1
        if (sender(slot(e)) == subdomain%rank .and. .not. self%is_there(e)) then
          n_told = n_told + 1
          self%told(n_told) = slot(e)
        else if (sender(slot(e)) == subdomain%neighbour(i) .and. .not. self%is_here(e)) then
          n_heard = n_heard + 1
          self%heard(n_heard) = slot(e)
        end if
      end do
      told(i) = n_told - told(i)
      heard(i) = n_heard - heard(i)
    end do
    self%told = self%told(:n_told)
    self%heard = self%heard(:n_heard)
    call self%last%prepare(comm, first_inverse(problem%kind) - 1, subdomain%neighbour, told, heard)
  contains
    !> The home sends if it has contacts, else the lowest rank.
    pure subroutine propose(sender, rank, home)
      integer, intent(inout) :: sender
      integer, intent(in) :: rank, home

      if (sender == home) return
      if (rank == home .or. rank < sender) sender = rank
    end subroutine propose
  end subroutine list_result

  !> Count the ranks that have contacts on wide bodies which impulses can move.
  subroutine share_wide(self, slot, is_touched, problem, comm)
    class(sharing_t), intent(inout) :: self
    integer, intent(in) :: slot(:)
    logical, intent(in) :: is_touched(:) !! by slot
    type(problem_t), intent(in) :: problem
    type(comm_t), intent(inout) :: comm
    integer :: i

    self%wide%slot = pack(slot, [(can_move(problem, slot(i)), i=1, size(slot))])
    self%wide%is_here = is_touched(self%wide%slot)
    self%wide%parts = merge(1, 0, self%wide%is_here)
    if (size(self%wide%parts) > 0) call comm%sum(self%wide%parts)
    call self%wide%mark(problem, first_inverse(problem%kind) - 1)
  end subroutine share_wide

  !> Can impulses move a body?
  pure logical function can_move(problem, slot)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: slot

    can_move = any(problem%body(first_inverse(problem%kind):, slot) > 0)
  end function can_move

  !> Give the velocities found to the copies that took no part. Collective among neighbours.
  subroutine sharing_tell_result(self, problem, subdomain, slot_of, comm)
    class(sharing_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! velocities of copies without contacts are set
    type(subdomain_t), intent(in) :: subdomain !! who holds which body
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body
    type(comm_t), intent(inout) :: comm !! the ranks
    integer :: i, width

    call list_result(self, problem, subdomain, slot_of, comm)
    width = size(self%last%send, 1)
    do i = 1, size(self%told)
      self%last%send(:, i) = problem%body(:width, self%told(i))
    end do
    call self%last%begin(comm)
    call self%last%finish(comm)
    do i = 1, size(self%heard)
      problem%body(:width, self%heard(i)) = self%last%receive(:, i)
    end do
  end subroutine sharing_tell_result

  !> List the tables of what is shared in a step, and the messages about it.
  subroutine sharing_list_tables(self, tables)
    class(sharing_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('sharing', per_body)
    call tables%note('is_here', self%is_here)
    call tables%note('is_there', self%is_there)
    call tables%note('slot', self%slot)
    call tables%note('parts', self%parts)
    call tables%note('item', self%item)
    call tables%note('first', self%first)
    call tables%note('told', self%told)
    call tables%note('heard', self%heard)
    call tables%add('last', self%last%table_bytes())
    call tables%add('activity', self%activity%table_bytes())
    call self%wide%list_tables(tables)
  end subroutine sharing_list_tables
end module sg_sharing
