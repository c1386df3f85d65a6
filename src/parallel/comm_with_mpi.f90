!> Communication by MPI; with `exchange_with_mpi` the only file that names it.
submodule(sg_comm) comm_with_mpi
  use mpi_f08, only: mpi_abort, mpi_allgather, mpi_allreduce, mpi_alltoall, mpi_alltoallv, mpi_bcast, mpi_character, &
                     mpi_comm, mpi_comm_free, mpi_comm_rank, mpi_comm_size, mpi_comm_split_type, mpi_comm_type_shared, &
                     mpi_comm_world, mpi_double_precision, mpi_exscan, mpi_finalize, &
                     mpi_get_library_version, mpi_iallreduce, mpi_in_place, mpi_info_null, mpi_init_thread, mpi_initialized, &
                     mpi_integer, mpi_integer8, mpi_logical, mpi_lor, mpi_max, mpi_max_library_version_string, mpi_min, mpi_op, &
                     mpi_request, mpi_status_ignore, mpi_sum, mpi_thread_funneled, mpi_wait
  use sg_system, only: end_program
  use sg_timers, only: wall_now
  implicit none

contains

  module procedure comm_start
  integer :: provided

  if (.not. was_launched()) return
  ! Threads share sweeps alone: messages are the first one's.
  call mpi_init_thread(mpi_thread_funneled, provided)
  call mpi_comm_rank(mpi_comm_world, self%rank)
  call mpi_comm_size(mpi_comm_world, self%size)
  end procedure comm_start

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

  module procedure comm_finish
  logical :: started

  call mpi_initialized(started)
  if (started) call mpi_finalize()
  self%size = 1
  end procedure comm_finish

  module procedure comm_abort
  logical :: started

  call mpi_initialized(started)
  if (started .and. self%size > 1) call mpi_abort(mpi_comm_world, code)
  call comm_finish(self)
  call end_program(code)
  end procedure comm_abort

  module procedure comm_library
  character(len=mpi_max_library_version_string) :: version
  integer :: length

  call mpi_get_library_version(version, length)
  name = version(:length)
  if (index(name, ',') > 1) name = name(:index(name, ',') - 1)
  end procedure comm_library

  module procedure comm_handle
  handle = mpi_comm_world%mpi_val
  end procedure comm_handle

  module procedure comm_no_hints
  handle = mpi_info_null%mpi_val
  end procedure comm_no_hints

  module procedure comm_ranks_here
  type(mpi_comm) :: here

  comm_ranks_here = 1
  if (self%size == 1) return
  call mpi_comm_split_type(mpi_comm_world, mpi_comm_type_shared, 0, mpi_info_null, here)
  call mpi_comm_size(here, comm_ranks_here)
  call mpi_comm_free(here)
  end procedure comm_ranks_here

  module procedure comm_sum
  call reduce(self, values, mpi_sum)
  end procedure comm_sum

  module procedure comm_maximum
  call reduce(self, values, mpi_max)
  end procedure comm_maximum

  module procedure comm_minimum
  call reduce(self, values, mpi_min)
  end procedure comm_minimum

  !> Combine the values of all ranks.
  subroutine reduce(self, values, operation)
    class(comm_t), intent(inout) :: self
    real(wp), intent(inout) :: values(:)
    type(mpi_op), intent(in) :: operation
    real(wp) :: own(size(values)), start

    if (self%size == 1) return
    own = values
    start = wall_now()
    call mpi_allreduce(own, values, size(own), mpi_double_precision, operation, mpi_comm_world)
    call note_collective(self, start)
  end subroutine reduce

  !> Count a collective operation, and the time since it began as waiting.
  subroutine note_collective(self, start)
    class(comm_t), intent(inout) :: self
    real(wp), intent(in) :: start

    self%traffic%collectives = self%traffic%collectives + 1
    self%traffic%wait_seconds = self%traffic%wait_seconds + wall_now() - start
  end subroutine note_collective

  module procedure comm_any
  real(wp) :: start

  comm_any = is_so
  if (self%size == 1) return
  start = wall_now()
  call mpi_allreduce(is_so, comm_any, 1, mpi_logical, mpi_lor, mpi_comm_world)
  call note_collective(self, start)
  end procedure comm_any

  module procedure comm_agree
  real(wp) :: lowest(1)

  speaker = merge(0, -1, allocated(error))
  if (self%size == 1) return
  lowest = real(merge(self%rank, self%size, allocated(error)), wp)
  call self%minimum(lowest)
  speaker = nint(lowest(1))
  if (speaker == self%size) then
    speaker = -1
    return
  end if
  call share_error(error, speaker, self%rank)
  end procedure comm_agree

  !> Give all ranks the error of one.
  subroutine share_error(error, speaker, rank)
    type(error_t), allocatable, intent(inout) :: error
    integer, intent(in) :: speaker, rank
    integer :: numbers(3)

    if (rank /= speaker) then
      if (allocated(error)) deallocate (error)
      allocate (error)
    end if
    numbers = [error%line, error%column, error%code]
    call mpi_bcast(numbers, 3, mpi_integer, speaker, mpi_comm_world)
    error%line = numbers(1)
    error%column = numbers(2)
    error%code = numbers(3)
    call share_text(error%message, speaker)
    call share_text(error%file, speaker)
    call share_text(error%text, speaker)
  end subroutine share_error

  !> Give all ranks the text of one, or none where it has none.
  subroutine share_text(text, speaker)
    character(len=:), allocatable, intent(inout) :: text
    integer, intent(in) :: speaker
    integer :: length

    length = -1
    if (allocated(text)) length = len(text)
    call mpi_bcast(length, 1, mpi_integer, speaker, mpi_comm_world)
    if (length < 0) then
      if (allocated(text)) deallocate (text)
      return
    end if
    if (allocated(text)) then
      if (len(text) /= length) deallocate (text)
    end if
    if (.not. allocated(text)) allocate (character(len=length) :: text)
    call mpi_bcast(text, length, mpi_character, speaker, mpi_comm_world)
  end subroutine share_text

  module procedure comm_begin_sum
  type(mpi_request) :: request

  if (allocated(self%sending)) deallocate (self%sending)
  if (allocated(self%receiving)) deallocate (self%receiving)
  self%sending = values
  self%receiving = values
  if (self%size == 1) return
  call mpi_iallreduce(self%sending, self%receiving, size(values), mpi_double_precision, mpi_sum, mpi_comm_world, request)
  self%request = request%mpi_val
  end procedure comm_begin_sum

  module procedure comm_finish_sum
  type(mpi_request) :: request
  real(wp) :: start

  if (self%size > 1) then
    start = wall_now()
    request%mpi_val = self%request
    call mpi_wait(request, mpi_status_ignore)
    call note_collective(self, start)
  end if
  values = self%receiving
  end procedure comm_finish_sum

  module procedure comm_gather
  real(wp) :: start

  allocate (all(size(own), self%size))
  all(:, self%rank + 1) = own
  if (self%size == 1) return
  start = wall_now()
  call mpi_allgather(own, size(own), mpi_double_precision, all, size(own), mpi_double_precision, mpi_comm_world)
  call note_collective(self, start)
  end procedure comm_gather

  module procedure comm_before
  real(wp) :: start

  before = 0
  total = own
  if (self%size == 1) return
  start = wall_now()
  call mpi_exscan(own, before, 1, mpi_integer8, mpi_sum, mpi_comm_world)
  if (self%rank == 0) before = 0
  call mpi_allreduce(own, total, 1, mpi_integer8, mpi_sum, mpi_comm_world)
  call note_collective(self, start)
  end procedure comm_before

  module procedure comm_swap
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
  end procedure comm_swap
end submodule comm_with_mpi
