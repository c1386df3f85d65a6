!> Virtual ranks: several subdomains of a scene in one process, each of which sees the others as ranks.
!!
!! An operation of all ranks is a round on the board of each process: each brings its contribution, the last one makes the one
!! call between processes, and all take the result. Sums of reals are added in the order of the subdomains, so that they do not
!! depend on the number of processes. Without a board all operations are those of `ranks_t`. After Adaptive MPI
!! [HuangLawlorKale2003].
module sg_virtual_ranks
  use sg_kinds, only: i1, i4, i8, wp
  use sg_process_swap, only: swap_processes
  use sg_ranks, only: by_maximum, by_minimum, by_sum
  use sg_subdomain_group, only: subdomain_group_t
  use sg_timers, only: idle_now
  implicit none
  private
  public :: virtual_ranks_t

  !> Mould of transferred values
  integer(i1), parameter :: mould(1) = 0
  !> Bytes that each subdomain brings to one round of a reduction, at most; a multiple of 8
  integer, parameter :: most_bytes_each = 2**18

  !> Summands of one sum
  type :: summands_t
    real(wp), allocatable :: values(:)
  end type summands_t

  !> Ranks that may be subdomains of few processes, and what they do together
  type, extends(subdomain_group_t) :: virtual_ranks_t
    !> Summands of sums that have begun
    type(summands_t), private :: summands(2)
  contains
    procedure :: ranks_here => virtual_ranks_here
    procedure :: reduced_integers => virtual_reduced_integers
    procedure :: reduced_longs => virtual_reduced_longs
    procedure :: reduced_reals => virtual_reduced_reals
    procedure :: of_root => virtual_of_root
    procedure :: side_by_side => virtual_side_by_side
    procedure :: begin_sum => virtual_begin_sum
    procedure :: finish_sum => virtual_finish_sum
    procedure :: swap => virtual_swap
    procedure, private :: reduced_bytes, brought, gather_processes, note
  end type virtual_ranks_t

contains

  !> Number of ranks on this machine, this one included.
  integer function virtual_ranks_here(self) result(ranks_here)
    class(virtual_ranks_t), intent(in) :: self
    integer(i1) :: bytes(storage_size(1)/8)
    integer :: turn

    if (.not. associated(self%board)) then
      ranks_here = self%ranks_t%ranks_here()
      return
    end if
    turn = self%board%arrive(size(bytes))
    associate (slot => self%board%slots(modulo(turn, 2)))
      if (self%board%is_complete()) then
        slot%bytes = transfer(self%processes%ranks_here(), mould)
        call self%board%release()
      end if
      call self%board%wait(turn)
      ranks_here = transfer(slot%bytes, ranks_here)
    end associate
    ! Processes have as many subdomains as others, or one more.
    ranks_here = (ranks_here*self%size + self%processes%size - 1)/self%processes%size
  end function virtual_ranks_here

  !> Integers combined over the ranks.
  function virtual_reduced_integers(self, values, operation) result(reduced)
    class(virtual_ranks_t), intent(inout) :: self
    integer(i4), intent(in), contiguous :: values(:) !! values of this rank
    integer, intent(in) :: operation !! one of `by_*`
    integer(i4) :: reduced(size(values))

    if (associated(self%board)) then
      reduced = int(self%reduced_longs(int(values, i8), operation), i4)
    else
      reduced = self%ranks_t%reduced_integers(values, operation)
    end if
  end function virtual_reduced_integers

  !> Long integers combined over the ranks.
  function virtual_reduced_longs(self, values, operation) result(reduced)
    class(virtual_ranks_t), intent(inout) :: self
    integer(i8), intent(in), contiguous :: values(:) !! values of this rank
    integer, intent(in) :: operation !! one of `by_*`
    integer(i8) :: reduced(size(values))

    if (associated(self%board)) then
      reduced = transfer(self%reduced_bytes(transfer(values, mould), operation, .false.), values)
    else
      reduced = self%ranks_t%reduced_longs(values, operation)
    end if
  end function virtual_reduced_longs

  !> Reals combined over the ranks.
  function virtual_reduced_reals(self, values, operation) result(reduced)
    class(virtual_ranks_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: values(:) !! values of this rank
    integer, intent(in) :: operation !! one of `by_*`
    real(wp) :: reduced(size(values))

    if (associated(self%board)) then
      reduced = transfer(self%reduced_bytes(transfer(values, mould), operation, .true.), values)
    else
      reduced = self%ranks_t%reduced_reals(values, operation)
    end if
  end function virtual_reduced_reals

  !> Reals or long integers, as bytes, combined over the ranks in their order; piece by piece where there are many.
  function reduced_bytes(self, own, operation, are_reals) result(reduced)
    class(virtual_ranks_t), intent(inout) :: self
    integer(i1), intent(in), contiguous :: own(:)
    integer, intent(in) :: operation
    logical, intent(in) :: are_reals
    integer(i1) :: reduced(size(own))
    integer :: first, last, turn
    real(wp) :: start

    start = idle_now()
    do first = 1, size(own), most_bytes_each
      last = min(size(own), first + most_bytes_each - 1)
      turn = self%brought(own(first:last))
      associate (slot => self%board%slots(modulo(turn, 2)))
        if (self%board%is_complete()) then
          if (are_reals) then
            slot%bytes = transfer(combined_reals(transfer(slot%bytes, [0.0_wp]), self%size, operation), mould)
          else
            slot%bytes = transfer(combined_longs(transfer(slot%bytes, [0_i8]), self%size, operation), mould)
          end if
          call self%board%release()
        end if
        call self%board%wait(turn)
        reduced(first:last) = slot%bytes
      end associate
    end do
    call self%note(start)
  end function reduced_bytes

  !> Bring bytes to a round, as many as all others bring; the last rank of a process finds those of all ranks side by side.
  integer function brought(self, own) result(turn)
    class(virtual_ranks_t), intent(inout) :: self
    integer(i1), intent(in) :: own(:)
    integer :: p

    turn = self%board%arrive(size(own)*self%size)
    associate (slot => self%board%slots(modulo(turn, 2)))
      slot%bytes(size(own)*self%rank + 1:size(own)*(self%rank + 1)) = own
      if (self%board%is_complete()) &
        call self%gather_processes(slot%bytes, [(size(own)*self%first_of(p), p=0, self%processes%size)])
    end associate
  end function brought

  !> Bring together what processes have of a list.
  subroutine gather_processes(self, bytes, first)
    class(virtual_ranks_t), intent(inout) :: self
    integer(i1), intent(inout) :: bytes(:)
    integer, intent(in) :: first(0:) !! bytes before those of each process
    integer :: p

    p = self%processes%size
    if (p > 1) bytes = self%processes%side_by_side(bytes(first(self%processes%rank) + 1:first(self%processes%rank + 1)), &
                                                   first(1:p) - first(0:p - 1))
  end subroutine gather_processes

  !> Columns of reals combined in their order.
  pure function combined_reals(values, n, operation) result(combined)
    real(wp), intent(in) :: values(:)
    integer, intent(in) :: n, operation
    real(wp) :: combined(size(values)/n)
    integer :: r

    combined = values(:size(combined))
    do r = 1, n - 1
      associate (next => values(r*size(combined) + 1:(r + 1)*size(combined)))
        if (operation == by_sum) combined = combined + next
        if (operation == by_maximum) combined = max(combined, next)
        if (operation == by_minimum) combined = min(combined, next)
      end associate
    end do
  end function combined_reals

  !> Columns of long integers combined.
  pure function combined_longs(values, n, operation) result(combined)
    integer(i8), intent(in) :: values(:)
    integer, intent(in) :: n, operation
    integer(i8) :: combined(size(values)/n)
    integer :: r

    combined = values(:size(combined))
    do r = 1, n - 1
      associate (next => values(r*size(combined) + 1:(r + 1)*size(combined)))
        if (operation == by_sum) combined = combined + next
        if (operation == by_maximum) combined = max(combined, next)
        if (operation == by_minimum) combined = min(combined, next)
      end associate
    end do
  end function combined_longs

  !> Count a collective operation, and the time since it began as waiting.
  subroutine note(self, start)
    class(virtual_ranks_t), intent(inout) :: self
    real(wp), intent(in) :: start !! as of `idle_now`

    self%traffic%collectives = self%traffic%collectives + 1
    self%traffic%wait_seconds = self%traffic%wait_seconds + idle_now() - start
  end subroutine note

  !> Bytes of the root rank.
  function virtual_of_root(self, own, root) result(bytes)
    class(virtual_ranks_t), intent(inout) :: self
    integer(i1), intent(in), contiguous :: own(:) !! of this rank, as many on all
    integer, intent(in) :: root !! rank whose bytes all get
    integer(i1) :: bytes(size(own))
    integer :: turn
    real(wp) :: start

    if (.not. associated(self%board)) then
      bytes = self%ranks_t%of_root(own, root)
      return
    end if
    start = idle_now()
    turn = self%board%arrive(size(own))
    associate (slot => self%board%slots(modulo(turn, 2)))
      if (self%rank == root) slot%bytes = own
      if (self%board%is_complete()) then
        if (self%processes%size > 1) slot%bytes = self%processes%of_root(slot%bytes, self%process_of(root))
        call self%board%release()
      end if
      call self%board%wait(turn)
      bytes = slot%bytes
    end associate
    call self%note(start)
  end function virtual_of_root

  !> Bytes of all ranks side by side.
  function virtual_side_by_side(self, own, length) result(bytes)
    class(virtual_ranks_t), intent(inout) :: self
    integer(i1), intent(in), contiguous :: own(:) !! of this rank
    integer, intent(in), contiguous :: length(:) !! number of bytes of each rank, shape (ranks)
    integer(i1) :: bytes(sum(length))
    integer :: p, before, turn
    real(wp) :: start

    if (.not. associated(self%board)) then
      bytes = self%ranks_t%side_by_side(own, length)
      return
    end if
    start = idle_now()
    before = sum(length(:self%rank))
    turn = self%board%arrive(size(bytes))
    associate (slot => self%board%slots(modulo(turn, 2)))
      slot%bytes(before + 1:before + size(own)) = own
      if (self%board%is_complete()) then
        call self%gather_processes(slot%bytes, [(sum(length(:self%first_of(p))), p=0, self%processes%size)])
        call self%board%release()
      end if
      call self%board%wait(turn)
      bytes = slot%bytes
    end associate
    call self%note(start)
  end function virtual_side_by_side

  !> Begin to sum over the ranks. Of virtual ranks the sum is made when it is finished: sums that run beside other work hide the
  !! time of messages, of which there are few.
  subroutine virtual_begin_sum(self, which, values)
    class(virtual_ranks_t), intent(inout) :: self
    integer, intent(in) :: which !! one of `sum_of_*`; not begun already
    real(wp), intent(in) :: values(:) !! summands of this rank

    if (associated(self%board)) then
      self%summands(which)%values = values
    else
      call self%ranks_t%begin_sum(which, values)
    end if
  end subroutine virtual_begin_sum

  !> Finish a sum that was begun.
  subroutine virtual_finish_sum(self, which, values)
    class(virtual_ranks_t), intent(inout) :: self
    integer, intent(in) :: which !! the same
    real(wp), intent(out) :: values(:) !! sums, of the size that was begun

    if (associated(self%board)) then
      values = self%reduced(self%summands(which)%values, by_sum)
    else
      call self%ranks_t%finish_sum(which, values)
    end if
  end subroutine virtual_finish_sum

  !> Send to every rank its part of a list, and receive from every rank: parts are in the order of ranks.
  subroutine virtual_swap(self, send, send_count, receive, receive_count)
    class(virtual_ranks_t), intent(inout) :: self
    real(wp), intent(in) :: send(:) !! parts one after the other
    integer, intent(in) :: send_count(0:) !! reals for each rank, shape (0:size-1)
    real(wp), allocatable, intent(out) :: receive(:) !! parts one after the other
    integer, allocatable, intent(out) :: receive_count(:) !! reals from each rank, shape (0:size-1)
    integer :: r, before, turn
    real(wp) :: start

    if (.not. associated(self%board)) then
      call self%ranks_t%swap(send, send_count, receive, receive_count)
      return
    end if
    start = idle_now()
    do r = 0, self%size - 1
      if (r == self%rank .or. send_count(r) == 0) cycle
      self%traffic%messages = self%traffic%messages + 1
      self%traffic%bytes = self%traffic%bytes + 8*int(send_count(r), i8)
    end do
    turn = self%board%arrive(0)
    associate (slot => self%board%slots(modulo(turn, 2)), mine => self%board%brought(self%place))
      mine%values = send(:sum(send_count))
      mine%counts = send_count
      if (self%board%is_complete()) then
        call swap_processes(self%board%brought, slot, self%processes, self%size)
        call self%board%release()
      end if
      call self%board%wait(turn)
      allocate (receive_count(0:self%size - 1), source=slot%counts(:, self%place))
      allocate (receive(sum(receive_count)))
      before = 0
      do r = 0, self%size - 1
        receive(before + 1:before + receive_count(r)) = &
          slot%values(slot%first(r, self%place) + 1:slot%first(r, self%place) + receive_count(r))
        before = before + receive_count(r)
      end do
    end associate
    call self%note(start)
  end subroutine virtual_swap
end module sg_virtual_ranks
