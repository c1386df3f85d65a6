!> Sums over all copies of shared bodies by messages between neighbours, in the order of ranks, so that all copies get the very same
!! numbers (doc/theory/decomposition.md).
module sg_copy_sums
  use sg_comm, only: comm_t
  use sg_exchange, only: exchange_t
  use sg_kinds, only: wp
  use sg_tables, only: tables_t
  implicit none
  private
  public :: copy_sums_t

  !> Which neighbours share which body, the messages, and the sums
  type :: copy_sums_t
    !> Item j of messages to and from neighbours belongs to shared body `item(j)`: they are its other sharers
    integer, allocatable :: item(:)
    !> Items of neighbour i are `first(i)` to `first(i + 1) - 1`
    integer, allocatable :: first(:)
    type(exchange_t), private :: messages
    real(wp), allocatable, private :: total(:, :)
    integer, private :: rank = 0
  contains
    procedure :: prepare => sums_prepare
    procedure :: begin => sums_begin
    procedure :: finish => sums_finish
    procedure :: rehearse => sums_rehearse
    procedure :: rehearse_sum => sums_rehearse_sum
    procedure :: note_tables => sums_note_tables
  end type copy_sums_t

contains

  !> Prepare messages of some values per body.
  subroutine sums_prepare(self, width, n, neighbour, comm)
    class(copy_sums_t), intent(inout) :: self !! its items are known
    integer, intent(in) :: width !! values per body
    integer, intent(in) :: n !! shared bodies
    integer, intent(in) :: neighbour(:) !! ranks, ascending
    type(comm_t), intent(in) :: comm !! the ranks

    self%rank = comm%rank
    associate (counts => self%first(2:) - self%first(:size(neighbour)))
      call self%messages%prepare(comm, width, neighbour, counts, counts)
    end associate
    if (allocated(self%total)) deallocate (self%total)
    allocate (self%total(width, n), source=0.0_wp)
  end subroutine sums_prepare

  !> Send the values of this rank's copies to the neighbours.
  subroutine sums_begin(self, values, comm)
    class(copy_sums_t), intent(inout) :: self
    real(wp), intent(in) :: values(:, :) !! of this rank's copies, shape (width, at least the shared bodies)
    type(comm_t), intent(inout) :: comm !! the ranks

    call pack_values(self, values)
    call self%messages%begin(comm)
  end subroutine sums_begin

  !> Take what neighbours sent, and sum the changes of all copies.
  subroutine sums_finish(self, before, values, comm)
    class(copy_sums_t), intent(inout) :: self
    real(wp), intent(in) :: before(:, :) !! values that changes are counted from, the same in all copies
    real(wp), intent(inout) :: values(:, :) !! those that were sent, then the sums over copies of value minus `before`
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%messages%finish(comm)
    call add_up(self, before, values)
  end subroutine sums_finish

  !> Write down the values that neighbours get.
  pure subroutine pack_values(self, values)
    class(copy_sums_t), intent(inout) :: self
    real(wp), intent(in) :: values(:, :)
    integer :: j

    do j = 1, size(self%item)
      self%messages%send(:, j) = values(:, self%item(j))
    end do
  end subroutine pack_values

  !> Sum changes in the order of ranks. Bodies that no rank changes keep their values bit for bit.
  pure subroutine add_up(self, before, values)
    class(copy_sums_t), intent(inout) :: self
    real(wp), intent(in) :: before(:, :)
    real(wp), intent(inout) :: values(:, :)
    integer :: i, j
    logical :: is_own_added

    associate (n => size(self%total, 2), total => self%total)
      total = 0
      is_own_added = .false.
      do i = 1, size(self%messages%rank)
        if (.not. is_own_added .and. self%messages%rank(i) > self%rank) then
          total(:, :) = total + values(:, :n) - before(:, :n)
          is_own_added = .true.
        end if
        do j = self%first(i), self%first(i + 1) - 1
          associate (k => self%item(j))
            total(:, k) = total(:, k) + self%messages%receive(:, j) - before(:, k)
          end associate
        end do
      end do
      if (.not. is_own_added) total(:, :) = total + values(:, :n) - before(:, :n)
      values(:, :n) = total
    end associate
  end subroutine add_up

  !> Items of one neighbour that holds a copy of each body: for timings.
  pure subroutine sums_rehearse(self, width, n)
    class(copy_sums_t), intent(inout) :: self
    integer, intent(in) :: width !! values per body
    integer, intent(in) :: n !! shared bodies
    integer :: i

    self%item = [(i, i=1, n)]
    self%first = [1, n + 1]
    self%messages%rank = [1]
    allocate (self%messages%send(width, n), self%messages%receive(width, n), self%total(width, n), source=0.0_wp)
  end subroutine sums_rehearse

  !> A sum over copies without its messages: that neighbour's values are the same.
  pure subroutine sums_rehearse_sum(self, before, values)
    class(copy_sums_t), intent(inout) :: self
    real(wp), intent(in) :: before(:, :) !! values that changes are counted from
    real(wp), intent(inout) :: values(:, :) !! of this rank's copies, then the sums of changes

    call pack_values(self, values)
    self%messages%receive(:, :) = self%messages%send
    call add_up(self, before, values)
  end subroutine sums_rehearse_sum

  !> Add these tables to those of the interface.
  subroutine sums_note_tables(self, tables)
    class(copy_sums_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%note('item', self%item)
    call tables%note('first', self%first)
    call tables%note('total', self%total)
    call tables%add('sums', self%messages%table_bytes())
  end subroutine sums_note_tables
end module sg_copy_sums
