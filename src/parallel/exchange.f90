!> Exchange with neighbours: a plan made once for many exchanges of items between the same ranks.
!!
!! Items are columns of reals, all of one width. The items for neighbour i are `send(:, send_first(i):send_first(i+1)-1)`,
!! those from it `receive(:, receive_first(i):receive_first(i+1)-1)`; both sides agree on their number and order.
!! Between `begin` and `finish` other work may go on; neither list may be touched.
module sg_exchange
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, i8
  implicit none
  private
  public :: exchange_t

  !> A plan of messages between neighbours; it must stay where it was made (no copy, no move) while it is in use
  type :: exchange_t
    !> Neighbours: ranks, ascending
    integer, allocatable :: rank(:)
    !> First item to and from each neighbour, shape (neighbours + 1)
    integer, allocatable :: send_first(:), receive_first(:)
    !> Items, shape (width, items)
    real(wp), allocatable :: send(:, :), receive(:, :)
    !> Handles of prepared messages
    integer, allocatable, private :: request(:)
    !> Messages and bytes that one exchange sends
    integer :: messages = 0, bytes = 0
  contains
    procedure :: prepare => exchange_prepare
    procedure :: begin => exchange_begin
    procedure :: finish => exchange_finish
    procedure :: release => exchange_release
    procedure :: table_bytes => exchange_table_bytes
  end type exchange_t

  interface
    !> Make the plan from the numbers of items that each rank and its neighbours will send. Neighbours without items get no message.
    module subroutine exchange_prepare(self, comm, width, rank, send_count, receive_count)
      class(exchange_t), intent(inout), target :: self
      type(comm_t), intent(in) :: comm !! the ranks
      integer, intent(in) :: width !! reals an item
      integer, intent(in) :: rank(:) !! neighbours, ascending
      integer, intent(in) :: send_count(:) !! items to each
      integer, intent(in) :: receive_count(:) !! items from each
    end subroutine exchange_prepare
    !> Start sending what is in `send`.
    module subroutine exchange_begin(self, comm)
      class(exchange_t), intent(inout), target :: self
      type(comm_t), intent(inout) :: comm !! its traffic grows
    end subroutine exchange_begin
    !> Wait until all has arrived in `receive` and `send` may be filled again.
    module subroutine exchange_finish(self, comm)
      class(exchange_t), intent(inout), target :: self
      type(comm_t), intent(inout) :: comm !! its traffic grows
    end subroutine exchange_finish
    !> Give back what the plan holds.
    module subroutine exchange_release(self)
      class(exchange_t), intent(inout), target :: self
    end subroutine exchange_release
  end interface

contains

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
