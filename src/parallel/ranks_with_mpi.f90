!> Communication by MPI; with `exchange_with_mpi` the only file that names it.
submodule(sg_ranks) ranks_with_mpi
  use mpi_f08, only: mpi_allgatherv, mpi_allreduce, mpi_alltoall, mpi_alltoallv, mpi_bcast, mpi_byte, mpi_comm, &
                     mpi_comm_free, mpi_comm_rank, mpi_comm_size, mpi_comm_split_type, mpi_comm_type_shared, mpi_comm_world, &
                     mpi_double_precision, mpi_finalize, mpi_get_library_version, mpi_iallreduce, mpi_info_null, &
                     mpi_init_thread, mpi_initialized, mpi_integer, mpi_integer8, mpi_max, mpi_max_library_version_string, &
                     mpi_min, mpi_op, mpi_request, mpi_status_ignore, mpi_sum, mpi_thread_funneled, mpi_wait
  use sg_timers, only: wall_now
  implicit none

contains

  module procedure ranks_start
  integer :: provided

  if (.not. was_launched()) return
  ! Threads share sweeps alone: messages are the first one's.
  call mpi_init_thread(mpi_thread_funneled, provided)
  call mpi_comm_rank(mpi_comm_world, self%rank)
  call mpi_comm_size(mpi_comm_world, self%size)
  end procedure ranks_start

  !> Was this process started by an MPI launcher, and not alone? Starting MPI costs a second that a single process need not pay.
  logical function was_launched()
    character(len=*), parameter :: marks(4) = [character(len=24) :: 'OMPI_COMM_WORLD_SIZE', 'PMI_SIZE', 'MV2_COMM_WORLD_SIZE', &
                                               'PMIX_RANK']
    character(len=12) :: value
    integer :: i, length

    was_launched = .false.
    do i = 1, size(marks)
      call get_environment_variable(trim(marks(i)), value, length)
      if (length == 0) cycle
      was_launched = marks(i)(:5) == 'PMIX_' .or. value /= '1'
      return
    end do
  end function was_launched

  module procedure ranks_finish
  logical :: started

  call mpi_initialized(started)
  if (started) call mpi_finalize()
  self%size = 1
  end procedure ranks_finish

  module procedure ranks_library
  character(len=mpi_max_library_version_string) :: version
  integer :: length

  call mpi_get_library_version(version, length)
  name = version(:length)
  if (index(name, ',') > 1) name = name(:index(name, ',') - 1)
  end procedure ranks_library

  module procedure ranks_handle
  handle = mpi_comm_world%mpi_val
  end procedure ranks_handle

  module procedure ranks_no_hints
  handle = mpi_info_null%mpi_val
  end procedure ranks_no_hints

  module procedure ranks_here
  type(mpi_comm) :: here

  ranks_here = 1
  if (self%size == 1) return
  call mpi_comm_split_type(mpi_comm_world, mpi_comm_type_shared, 0, mpi_info_null, here)
  call mpi_comm_size(here, ranks_here)
  call mpi_comm_free(here)
  end procedure ranks_here

  module procedure reduced_integers
  real(wp) :: start

  reduced = values
  if (self%size == 1) return
  start = wall_now()
  call mpi_allreduce(values, reduced, size(values), mpi_integer, operation_of(operation), mpi_comm_world)
  call note_collective(self, start)
  end procedure reduced_integers

  module procedure reduced_longs
  real(wp) :: start

  reduced = values
  if (self%size == 1) return
  start = wall_now()
  call mpi_allreduce(values, reduced, size(values), mpi_integer8, operation_of(operation), mpi_comm_world)
  call note_collective(self, start)
  end procedure reduced_longs

  module procedure reduced_reals
  real(wp) :: start

  reduced = values
  if (self%size == 1) return
  start = wall_now()
  call mpi_allreduce(values, reduced, size(values), mpi_double_precision, operation_of(operation), mpi_comm_world)
  call note_collective(self, start)
  end procedure reduced_reals

  !> Operation of the library for one of `by_*`.
  type(mpi_op) function operation_of(operation)
    integer, intent(in) :: operation

    operation_of = mpi_sum
    if (operation == by_maximum) operation_of = mpi_max
    if (operation == by_minimum) operation_of = mpi_min
  end function operation_of

  !> Count a collective operation, and the time since it began as waiting.
  subroutine note_collective(self, start)
    class(ranks_t), intent(inout) :: self
    real(wp), intent(in) :: start

    self%traffic%collectives = self%traffic%collectives + 1
    self%traffic%wait_seconds = self%traffic%wait_seconds + wall_now() - start
  end subroutine note_collective

  module procedure bytes_of_root
  real(wp) :: start

  bytes = own
  if (self%size == 1) return
  start = wall_now()
  call mpi_bcast(bytes, size(bytes), mpi_byte, root, mpi_comm_world)
  call note_collective(self, start)
  end procedure bytes_of_root

  module procedure bytes_side_by_side
  integer :: first(self%size), r
  real(wp) :: start

  if (self%size == 1) then
    bytes = own
    return
  end if
  first = [(sum(length(:r - 1)), r=1, self%size)]
  start = wall_now()
  call mpi_allgatherv(own, size(own), mpi_byte, bytes, length, first, mpi_byte, mpi_comm_world)
  call note_collective(self, start)
  end procedure bytes_side_by_side

  module procedure ranks_begin_sum
  type(mpi_request) :: request

  self%pending(which)%sending = values
  self%pending(which)%receiving = values
  if (self%size == 1) return
  call mpi_iallreduce(self%pending(which)%sending, self%pending(which)%receiving, size(values), mpi_double_precision, mpi_sum, &
                      mpi_comm_world, request)
  self%pending(which)%request = request%mpi_val
  end procedure ranks_begin_sum

  module procedure ranks_finish_sum
  type(mpi_request) :: request
  real(wp) :: start

  if (self%size > 1) then
    start = wall_now()
    request%mpi_val = self%pending(which)%request
    call mpi_wait(request, mpi_status_ignore)
    call note_collective(self, start)
  end if
  values = self%pending(which)%receiving
  end procedure ranks_finish_sum

  module procedure ranks_swap
  integer, allocatable :: send_first(:), receive_first(:)
  real(wp) :: start
  integer :: r

  allocate (receive_count(0:self%size - 1), send_first(0:self%size), receive_first(0:self%size))
  if (self%size == 1) then
    receive_count = send_count
    receive = send
    return
  end if
  start = wall_now()
  call mpi_alltoall(send_count, 1, mpi_integer, receive_count, 1, mpi_integer, mpi_comm_world)
  send_first(0) = 0
  receive_first(0) = 0
  do r = 0, self%size - 1
    send_first(r + 1) = send_first(r) + send_count(r)
    receive_first(r + 1) = receive_first(r) + receive_count(r)
    if (r == self%rank .or. send_count(r) == 0) cycle
    self%traffic%messages = self%traffic%messages + 1
    self%traffic%bytes = self%traffic%bytes + 8*int(send_count(r), i8)
  end do
  allocate (receive(receive_first(self%size)))
  call mpi_alltoallv(send, send_count, send_first, mpi_double_precision, receive, receive_count, receive_first, &
                     mpi_double_precision, mpi_comm_world)
  call note_collective(self, start)
  end procedure ranks_swap
end submodule ranks_with_mpi
