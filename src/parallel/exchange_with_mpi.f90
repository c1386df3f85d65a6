!> Exchange with neighbours by persistent requests of MPI.
submodule(sg_exchange) exchange_with_mpi
  use mpi_f08, only: mpi_comm_world, mpi_double_precision, mpi_recv_init, mpi_request, mpi_request_free, mpi_request_null, &
                     mpi_send_init, mpi_startall, mpi_statuses_ignore, mpi_waitall
  use sg_kinds, only: i8
  use sg_timers, only: wall_now
  implicit none
  !> Tag of all messages: between two ranks they never overtake one another
  integer, parameter :: tag = 1

contains

  module procedure exchange_prepare
  call self%release()
  call lay_out(self, width, rank, send_count, receive_count)
  call open_requests(self)
  end procedure exchange_prepare

  !> Place of every neighbour's items.
  subroutine lay_out(self, width, rank, send_count, receive_count)
    class(exchange_t), intent(inout) :: self
    integer, intent(in) :: width, rank(:), send_count(:), receive_count(:)
    integer :: i

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
  end subroutine lay_out

  !> Prepare all messages that carry something.
  subroutine open_requests(self)
    class(exchange_t), intent(inout), target :: self
    type(mpi_request) :: request
    integer :: i, n, width

    width = size(self%send, 1)
    n = 0
    allocate (self%request(2*size(self%rank)))
    do i = 1, size(self%rank)
      associate (first => self%receive_first(i), count => self%receive_first(i + 1) - self%receive_first(i))
        if (count == 0) cycle
        call mpi_recv_init(self%receive(1, first), width*count, mpi_double_precision, self%rank(i), tag, mpi_comm_world, request)
        n = n + 1
        self%request(n) = request%mpi_val
      end associate
    end do
    do i = 1, size(self%rank)
      associate (first => self%send_first(i), count => self%send_first(i + 1) - self%send_first(i))
        if (count == 0) cycle
        call mpi_send_init(self%send(1, first), width*count, mpi_double_precision, self%rank(i), tag, mpi_comm_world, request)
        n = n + 1
        self%request(n) = request%mpi_val
      end associate
    end do
    self%request = self%request(:n)
  end subroutine open_requests

  module procedure exchange_begin
  type(mpi_request) :: requests(size(self%request))

  if (size(requests) == 0) return
  requests%mpi_val = self%request
  call mpi_startall(size(requests), requests)
  comm%traffic%messages = comm%traffic%messages + int(self%messages, i8)
  comm%traffic%bytes = comm%traffic%bytes + int(self%bytes, i8)
  end procedure exchange_begin

  module procedure exchange_finish
  type(mpi_request) :: requests(size(self%request))
  real(wp) :: start

  if (size(requests) == 0) return
  requests%mpi_val = self%request
  start = wall_now()
  call mpi_waitall(size(requests), requests, mpi_statuses_ignore)
  comm%traffic%wait_seconds = comm%traffic%wait_seconds + wall_now() - start
  end procedure exchange_finish

  module procedure exchange_release
  type(mpi_request) :: request
  integer :: i

  if (allocated(self%request)) then
    do i = 1, size(self%request)
      request%mpi_val = self%request(i)
      if (request%mpi_val /= mpi_request_null%mpi_val) call mpi_request_free(request)
    end do
    deallocate (self%request)
  end if
  if (allocated(self%rank)) deallocate (self%rank, self%send_first, self%receive_first, self%send, self%receive)
  end procedure exchange_release
end submodule exchange_with_mpi
