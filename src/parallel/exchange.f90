!> Exchange with neighbours: a plan made once for many exchanges of items between the same ranks.
!!
!! Items are columns of reals, all of one width. The items for neighbour i are `send(:, send_first(i):send_first(i+1)-1)`,
!! those from it `receive(:, receive_first(i):receive_first(i+1)-1)`; both sides agree on their number and order.
!! Between `begin` and `finish` other work may go on; neither list may be touched. Neighbours in other processes get messages of
!! the library (`exchange_with_mpi`), other subdomains of this process letters (sg_board).
module sg_exchange
  use, intrinsic :: iso_c_binding, only: c_associated, c_loc, c_null_ptr, c_ptr
  use sg_comm, only: comm_t
  use sg_coroutines, only: note_progress, yield
  use sg_kinds, only: wp, i8
  use sg_timers, only: idle_now
  implicit none
  private
  public :: exchange_t

  !> A plan of messages between neighbours. A copy prepares messages of its own when it first begins; a plan that gets a copy gives
  !! its messages back by `release` first
  type :: exchange_t
    !> Neighbours: ranks, ascending
    integer, allocatable :: rank(:)
    !> First item to and from each neighbour, shape (neighbours + 1)
    integer, allocatable :: send_first(:), receive_first(:)
    !> Items, shape (width, items)
    real(wp), allocatable :: send(:, :), receive(:, :)
    !> Handles of prepared messages, and where the plan lay that prepared them: their buffers are those of that plan
    integer, allocatable, private :: request(:)
    type(c_ptr), private :: home = c_null_ptr
    !> Is each neighbour a subdomain of this process, and the letter that is expected from it: 0 where there is none
    logical, allocatable, private :: is_here(:)
    integer(i8), allocatable, private :: letter(:)
    !> Messages and bytes that one exchange sends
    integer :: messages = 0, bytes = 0
  contains
    procedure :: prepare => exchange_prepare
    procedure :: begin => exchange_begin
    procedure :: finish => exchange_finish
    procedure :: release => exchange_release
    procedure :: table_bytes => exchange_table_bytes
  end type exchange_t

  ! Messages of a library, between processes.
  interface
    !> Prepare all messages that carry something.
    module subroutine open_messages(self, comm)
      class(exchange_t), intent(inout), target :: self
      type(comm_t), intent(in) :: comm
    end subroutine open_messages
    !> Start all messages.
    module subroutine start_messages(self)
      class(exchange_t), intent(inout), target :: self
    end subroutine start_messages
    !> Wait for all messages, or look whether they have come.
    module subroutine finish_messages(self, may_wait, have_come)
      class(exchange_t), intent(inout), target :: self
      logical, intent(in) :: may_wait
      logical, intent(out) :: have_come
    end subroutine finish_messages
    !> Give back the handles.
    module subroutine close_messages(self)
      class(exchange_t), intent(inout), target :: self
    end subroutine close_messages
  end interface

contains

  !> Make the plan from the numbers of items that each rank and its neighbours will send. Neighbours without items get no message.
  subroutine exchange_prepare(self, comm, width, rank, send_count, receive_count)
    class(exchange_t), intent(inout), target :: self
    type(comm_t), intent(in) :: comm !! the ranks
    integer, intent(in) :: width !! reals an item
    integer, intent(in) :: rank(:) !! neighbours, ascending
    integer, intent(in) :: send_count(:) !! items to each
    integer, intent(in) :: receive_count(:) !! items from each
    integer :: i

    call self%release()
    allocate (self%rank(size(rank)), self%send_first(size(rank) + 1), self%receive_first(size(rank) + 1))
    self%rank = rank
    self%send_first(1) = 1
    self%receive_first(1) = 1
    do i = 1, size(rank)
      self%send_first(i + 1) = self%send_first(i) + send_count(i)
      self%receive_first(i + 1) = self%receive_first(i) + receive_count(i)
    end do
    allocate (self%send(width, self%send_first(size(rank) + 1) - 1), &
              self%receive(width, self%receive_first(size(rank) + 1) - 1), source=0.0_wp)
    self%messages = count(send_count > 0)
    self%bytes = 8*size(self%send)
    self%is_here = [(comm%is_here(rank(i)), i=1, size(rank))]
    call own_messages(self, comm)
  end subroutine exchange_prepare

  !> Prepare messages from and to the lists of this plan.
  subroutine own_messages(self, comm)
    class(exchange_t), intent(inout), target :: self
    type(comm_t), intent(in) :: comm
    integer :: i

    self%letter = [(0_i8, i=1, size(self%rank))]
    call open_messages(self, comm)
    self%home = c_loc(self%send_first)
  end subroutine own_messages

  !> Were the messages prepared by the plan that this one is a copy of?
  logical function is_copy(self)
    class(exchange_t), intent(in), target :: self

    is_copy = .not. c_associated(self%home, c_loc(self%send_first))
  end function is_copy

  !> Forget messages of the plan that this one is a copy of.
  subroutine forget_messages(self)
    class(exchange_t), intent(inout) :: self

    if (allocated(self%request)) deallocate (self%request)
  end subroutine forget_messages

  !> Start sending what is in `send`.
  subroutine exchange_begin(self, comm)
    class(exchange_t), intent(inout), target :: self
    type(comm_t), intent(inout) :: comm !! its traffic grows
    integer :: i

    if (is_copy(self)) then
      call forget_messages(self)
      call own_messages(self, comm)
    end if
    call start_messages(self)
    do i = 1, size(self%rank)
      if (.not. self%is_here(i)) cycle
      if (self%send_first(i + 1) > self%send_first(i)) &
        call comm%post(self%rank(i), self%send(:, self%send_first(i):self%send_first(i + 1) - 1))
      if (self%receive_first(i + 1) > self%receive_first(i)) self%letter(i) = comm%expect(self%rank(i))
    end do
    comm%traffic%messages = comm%traffic%messages + int(self%messages, i8)
    comm%traffic%bytes = comm%traffic%bytes + int(self%bytes, i8)
  end subroutine exchange_begin

  !> Wait until all has arrived in `receive` and `send` may be filled again.
  subroutine exchange_finish(self, comm)
    class(exchange_t), intent(inout), target :: self
    type(comm_t), intent(inout) :: comm !! its traffic grows
    logical :: have_come
    integer :: i
    real(wp) :: start

    start = idle_now()
    do
      call finish_messages(self, .not. comm%is_virtual(), have_come)
      do i = 1, size(self%rank)
        if (self%letter(i) == 0) cycle
        if (comm%take(self%rank(i), self%letter(i), self%receive(:, self%receive_first(i):self%receive_first(i + 1) - 1))) &
          self%letter(i) = 0
      end do
      if (have_come .and. all(self%letter == 0)) exit
      ! What comes from another process is no event that this one could see.
      if (.not. have_come) call note_progress()
      call yield()
    end do
    comm%traffic%wait_seconds = comm%traffic%wait_seconds + idle_now() - start
  end subroutine exchange_finish

  !> Give back what the plan holds.
  subroutine exchange_release(self)
    class(exchange_t), intent(inout), target :: self

    if (.not. allocated(self%rank)) return
    if (is_copy(self)) call forget_messages(self)
    call close_messages(self)
    deallocate (self%rank, self%send_first, self%receive_first, self%send, self%receive, self%is_here, self%letter)
  end subroutine exchange_release

  !> Bytes that a plan holds; negative where there is none.
  pure integer(i8) function exchange_table_bytes(self) result(bytes)
    class(exchange_t), intent(in) :: self

    bytes = -1
    if (.not. allocated(self%rank)) return
    bytes = (storage_size(self%send)/8)*(size(self%send, kind=i8) + size(self%receive, kind=i8)) &
            + (storage_size(self%rank)/8)*(size(self%rank, kind=i8) + size(self%send_first, kind=i8) &
                                           + size(self%receive_first, kind=i8))
    if (allocated(self%request)) bytes = bytes + (storage_size(self%request)/8)*size(self%request, kind=i8)
  end function exchange_table_bytes
end module sg_exchange
