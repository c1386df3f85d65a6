!> Exchange with neighbours in other processes by persistent requests of MPI.
submodule(sg_exchange) exchange_with_mpi
  use mpi_f08, only: mpi_comm_world, mpi_double_precision, mpi_recv_init, mpi_request, mpi_request_free, mpi_request_null, &
                     mpi_send_init, mpi_startall, mpi_statuses_ignore, mpi_testall, mpi_waitall
  implicit none

contains

  module procedure open_messages
  type(mpi_request) :: request
  integer :: i, n, width

  width = size(self%send, 1)
  n = 0
  allocate (self%request(2*size(self%rank)))
  do i = 1, size(self%rank)
    associate (first => self%receive_first(i), count => self%receive_first(i + 1) - self%receive_first(i))
      if (count == 0 .or. self%is_here(i)) cycle
      call mpi_recv_init(self%receive(1, first), width*count, mpi_double_precision, comm%process_of(self%rank(i)), &
                         comm%tag_between(self%rank(i), comm%rank), mpi_comm_world, request)
      n = n + 1
      self%request(n) = request%mpi_val
    end associate
  end do
  do i = 1, size(self%rank)
    associate (first => self%send_first(i), count => self%send_first(i + 1) - self%send_first(i))
      if (count == 0 .or. self%is_here(i)) cycle
      call mpi_send_init(self%send(1, first), width*count, mpi_double_precision, comm%process_of(self%rank(i)), &
                         comm%tag_between(comm%rank, self%rank(i)), mpi_comm_world, request)
      n = n + 1
      self%request(n) = request%mpi_val
    end associate
  end do
  self%request = self%request(:n)
  end procedure open_messages

  module procedure start_messages
  type(mpi_request) :: requests(size(self%request))

  if (size(requests) == 0) return
  requests%mpi_val = self%request
  call mpi_startall(size(requests), requests)
  end procedure start_messages

  module procedure finish_messages
  type(mpi_request) :: requests(size(self%request))

  have_come = .true.
  if (size(requests) == 0) return
  requests%mpi_val = self%request
  if (may_wait) then
    call mpi_waitall(size(requests), requests, mpi_statuses_ignore)
  else
    call mpi_testall(size(requests), requests, have_come, mpi_statuses_ignore)
  end if
  end procedure finish_messages

  module procedure close_messages
  type(mpi_request) :: request
  integer :: i

  if (.not. allocated(self%request)) return
  do i = 1, size(self%request)
    request%mpi_val = self%request(i)
    if (request%mpi_val /= mpi_request_null%mpi_val) call mpi_request_free(request)
  end do
  deallocate (self%request)
  end procedure close_messages
end submodule exchange_with_mpi
