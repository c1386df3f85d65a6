!> The interface of one subdomain: shared bodies and their multiplicity, interface contacts, and sums over all copies of a body
!! (doc/theory/decomposition.md).
!!
!! A body is shared by the ranks that have contacts on it. Replicated bodies that impulses can move are shared by all ranks with
!! contacts on them, and summed over all ranks.
!!
!! Values of copies are columns, one per body of `slot`. The signed Boolean operator A_E takes differences between copies: its rows
!! are the items of messages, item j of neighbour i being the difference between two copies of `slot(sums%item(j))`. What all copies
!! have in common it takes to zero, so that A^T (A A^T)^+ A subtracts the mean over copies (`balance`).
module sg_interface
  use sg_comm, only: comm_t
  use sg_copy_sums, only: copy_sums_t
  use sg_exchange, only: exchange_t
  use sg_idle_copies, only: idle_copies_t
  use sg_kinds, only: wp, i4
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: per_body, tables_t
  implicit none
  private
  public :: interface_t

  !> The interface of the contact problem of one step
  type :: interface_t
    !> Has this rank, and has the neighbour, a contact on each body of `coupling%body`?
    logical, allocatable :: is_here(:), is_there(:)
    !> Slots of shared bodies: `n_shared` that neighbours share, then replicated ones that impulses can move
    integer :: n_shared = 0
    integer, allocatable :: slot(:)
    !> Ranks that have contacts on each of them
    integer, allocatable :: multiplicity(:)
    !> Messages of sums over copies, and which neighbours share which body
    type(copy_sums_t) :: sums
    !> Interface contacts: those of this rank on shared bodies, ascending. Do they lie between grains of two subdomains?
    integer, allocatable :: contact(:)
    logical, allocatable :: is_between(:)
    integer, private :: width = 0
    type(idle_copies_t), private :: idle
    !> Messages about the bodies on which ranks have contacts
    type(exchange_t), private :: activity
    integer, private :: serial = -1
  contains
    procedure :: find => interface_find
    procedure :: prepare_sums => interface_prepare_sums
    procedure :: finish_sum => interface_finish_sum
    procedure :: sum_replicated => interface_sum_replicated
    procedure :: sum => interface_sum
    procedure :: balance => interface_balance
    procedure :: rehearse => interface_rehearse
    procedure :: update_idle => interface_update_idle
    procedure :: list_tables => interface_list_tables
  end type interface_t

contains

  !> Find the shared bodies of a problem, their multiplicity, and the interface contacts. Collective.
  subroutine interface_find(self, pair, body, width, coupling, comm)
    class(interface_t), intent(inout) :: self
    integer(i4), intent(in) :: pair(:, :) !! slots of candidate and antagonist of this rank's contacts, shape (2, contacts)
    real(wp), intent(in) :: body(:, :) !! velocities and inverse masses by slot
    integer, intent(in) :: width !! components of a velocity
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks
    logical, allocatable :: is_touched(:)
    integer :: k

    self%width = width
    allocate (is_touched(size(body, 2)), source=.false.)
    do k = 1, size(pair, 2)
      is_touched(pair(:, k)) = .true.
    end do
    self%is_here = is_touched(coupling%body)
    call share_activity(self, coupling, comm)
    call list_shared(self, coupling, size(body, 2))
    call add_replicated(self, coupling%replicated, is_touched, body, comm)
    call list_contacts(self, pair, coupling, size(body, 2))
  end subroutine interface_find

  !> Exchange with neighbours on which shared bodies ranks have contacts.
  subroutine share_activity(self, coupling, comm)
    class(interface_t), intent(inout) :: self
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
    class(interface_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: coupling
    integer, intent(in) :: n_slots
    integer, allocatable :: place(:)
    integer :: i, e, n, items

    if (allocated(self%slot)) deallocate (self%slot, self%multiplicity)
    if (allocated(self%sums%item)) deallocate (self%sums%item, self%sums%first)
    allocate (place(n_slots), source=0)
    allocate (self%slot(size(coupling%body)), self%multiplicity(size(coupling%body)), self%sums%item(size(coupling%body)), &
              self%sums%first(size(coupling%neighbour) + 1), source=1)
    n = 0
    items = 0
    do i = 1, size(coupling%neighbour)
      self%sums%first(i) = items + 1
      do e = coupling%first(i), coupling%first(i + 1) - 1
        if (.not. (self%is_here(e) .and. self%is_there(e))) cycle
        if (place(coupling%body(e)) == 0) then
          n = n + 1
          place(coupling%body(e)) = n
          self%slot(n) = coupling%body(e)
          self%multiplicity(n) = 1
        end if
        items = items + 1
        self%sums%item(items) = place(coupling%body(e))
        self%multiplicity(place(coupling%body(e))) = self%multiplicity(place(coupling%body(e))) + 1
      end do
    end do
    self%sums%first(size(coupling%neighbour) + 1) = items + 1
    self%n_shared = n
    self%sums%item = self%sums%item(:items)
  end subroutine list_shared

  !> Append the replicated bodies that impulses can move, and count the ranks that have contacts on them.
  subroutine add_replicated(self, slot, is_touched, body, comm)
    class(interface_t), intent(inout) :: self
    integer, intent(in) :: slot(:)
    logical, intent(in) :: is_touched(:) !! by slot
    real(wp), intent(in) :: body(:, :)
    type(comm_t), intent(inout) :: comm
    integer, allocatable :: movable(:), touching(:)

    movable = pack(slot, any(body(self%width + 1:, slot) > 0, 1))
    touching = merge(1, 0, is_touched(movable))
    if (size(touching) > 0) call comm%sum(touching)
    self%slot = [self%slot(:self%n_shared), movable]
    self%multiplicity = [self%multiplicity(:self%n_shared), touching]
  end subroutine add_replicated

  !> List the contacts on shared bodies. Those between grains of two subdomains are on a body whose owner is another rank.
  subroutine list_contacts(self, pair, coupling, n_slots)
    class(interface_t), intent(inout) :: self
    integer(i4), intent(in) :: pair(:, :)
    type(subdomain_t), intent(in) :: coupling
    integer, intent(in) :: n_slots
    logical :: is_shared(n_slots), is_foreign(n_slots)
    integer :: k

    is_shared = .false.
    is_shared(self%slot) = .true.
    is_foreign = .false.
    is_foreign(pack(coupling%body, coupling%owner /= coupling%rank)) = .true.
    self%contact = pack([(k, k=1, size(pair, 2))], [(any(is_shared(pair(:, k))), k=1, size(pair, 2))])
    self%is_between = [(any(is_foreign(pair(:, self%contact(k)))), k=1, size(self%contact))]
  end subroutine list_contacts

  !> Sum values over all copies of each shared body. Collective.
  subroutine interface_sum(self, values, comm)
    class(interface_t), intent(inout) :: self !! its sums are prepared
    real(wp), intent(inout) :: values(:, :) !! of this rank's copies, then the sums; shape (width, bodies of `slot`)
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: nothing(:, :)

    allocate (nothing(self%width, size(self%slot)), source=0.0_wp)
    call self%sums%begin(values, comm)
    call self%finish_sum(nothing, values, comm)
  end subroutine interface_sum

  !> Take off the mean over copies, so that the values of all copies of a body add up to nothing: A^T (A A^T)^+ A. Collective.
  subroutine interface_balance(self, values, comm)
    class(interface_t), intent(inout) :: self !! its sums are prepared
    real(wp), intent(inout) :: values(:, :) !! of this rank's copies; shape (width, bodies of `slot`)
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: sums(:, :)
    integer :: i

    allocate (sums, source=values)
    call self%sum(sums, comm)
    do i = 1, size(self%slot)
      values(:, i) = values(:, i) - sums(:, i)/real(max(1, self%multiplicity(i)), wp)
    end do
  end subroutine interface_balance

  !> Prepare the messages of sums over copies.
  subroutine interface_prepare_sums(self, coupling, comm)
    class(interface_t), intent(inout) :: self
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(in) :: comm !! the ranks

    call self%sums%prepare(self%width, self%n_shared, coupling%neighbour, comm)
  end subroutine interface_prepare_sums

  !> Sum the changes of copies that were sent, and those of replicated bodies over all ranks.
  subroutine interface_finish_sum(self, before, values, comm)
    class(interface_t), intent(inout) :: self !! its sums have begun
    real(wp), intent(in) :: before(:, :) !! values that changes are counted from, the same in all copies
    real(wp), intent(inout) :: values(:, :) !! those that were sent, then the sums over copies of value minus `before`
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%sums%finish(before, values, comm)
    call self%sum_replicated(before(:, self%n_shared + 1:), values(:, self%n_shared + 1:), comm)
  end subroutine interface_finish_sum

  !> Sum the changes of replicated bodies over all ranks.
  subroutine interface_sum_replicated(self, before, values, comm)
    class(interface_t), intent(in) :: self
    real(wp), intent(in) :: before(:, :) !! values that changes are counted from, columns of replicated bodies alone
    real(wp), intent(inout) :: values(:, :) !! the same columns, as before where this rank has no contact; then the sums
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: list(:)

    if (size(self%slot) == self%n_shared) return
    list = reshape(values - before, [size(values)])
    call comm%sum(list)
    values(:, :) = reshape(list, shape(values))
  end subroutine interface_sum_replicated

  !> Share some bodies as if one neighbour held a copy of each, with the same values: for timings.
  pure subroutine interface_rehearse(self, slots, width)
    class(interface_t), intent(inout) :: self
    integer, intent(in) :: slots(:) !! the bodies
    integer, intent(in) :: width !! components of a velocity
    integer :: i

    self%n_shared = size(slots)
    self%slot = slots
    self%multiplicity = [(2, i=1, size(slots))]
    call self%sums%rehearse(width, size(slots))
  end subroutine interface_rehearse

  !> Give the velocities found to the copies that took no part. Collective among neighbours.
  subroutine interface_update_idle(self, body, coupling, comm)
    class(interface_t), intent(inout) :: self
    real(wp), intent(inout) :: body(:, :) !! by slot, velocities first; those of copies without contacts are set
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%idle%update(body, self%width, coupling, self%is_here, self%is_there, comm)
  end subroutine interface_update_idle

  !> List the tables of the interface of a step, and of messages about it.
  subroutine interface_list_tables(self, tables)
    class(interface_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('interface', per_body)
    call tables%note('is_here', self%is_here)
    call tables%note('is_there', self%is_there)
    call tables%note('slot', self%slot)
    call tables%note('multiplicity', self%multiplicity)
    call tables%note('contact', self%contact)
    call tables%note('is_between', self%is_between)
    call self%sums%note_tables(tables)
    call self%idle%note_tables(tables)
    call tables%add('activity', self%activity%table_bytes())
  end subroutine interface_list_tables
end module sg_interface
