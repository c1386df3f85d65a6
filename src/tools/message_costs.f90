!> Cost of a message between two ranks by its length: measured by messages to and fro, or given as latency and bandwidth.
module sg_message_costs
  use sg_comm, only: comm_t
  use sg_exchange, only: exchange_t
  use sg_kinds, only: wp
  use sg_timers, only: wall_now
  implicit none
  private
  public :: message_costs_t, given_messages, measure_messages

  !> Lengths at which messages are timed [reals]: libraries treat short and long ones differently
  integer, parameter :: lengths(6) = [1, 64, 256, 1024, 8192, 65536]

  !> Seconds of an exchange with one neighbour, both ways at once, by the length of the message each way
  type :: message_costs_t
    !> Lengths [bytes], ascending, and seconds at each
    real(wp), allocatable :: bytes(:), seconds(:)
  contains
    procedure :: of => costs_of
    procedure :: latency => costs_latency
    procedure :: bandwidth => costs_bandwidth
  end type message_costs_t

contains

  !> Costs of a network of given latency and bandwidth.
  pure function given_messages(latency, bandwidth) result(costs)
    real(wp), intent(in) :: latency !! seconds of an empty message
    real(wp), intent(in) :: bandwidth !! [bytes/s]
    type(message_costs_t) :: costs

    costs%bytes = [0.0_wp, 1e6_wp]
    costs%seconds = latency + costs%bytes/bandwidth
  end function given_messages

  !> Time messages between neighbours in number, all pairs at once. Collective; there must be two ranks at least.
  subroutine measure_messages(comm, costs)
    type(comm_t), intent(inout) :: comm !! the ranks
    type(message_costs_t), intent(out) :: costs !! of the slowest pair, the same on all ranks
    integer :: i

    allocate (costs%seconds(size(lengths)))
    costs%bytes = 8*real(lengths, wp)
    do i = 1, size(lengths)
      costs%seconds(i) = seconds_of(comm, lengths(i))
    end do
    call comm%maximum(costs%seconds)
    ! A longer message is not cheaper: where it seems so, something disturbed the shorter one.
    do i = size(lengths) - 1, 1, -1
      costs%seconds(i) = min(costs%seconds(i), costs%seconds(i + 1))
    end do
  end subroutine measure_messages

  !> Seconds of an exchange of so many reals: the least of some tries is the undisturbed one.
  real(wp) function seconds_of(comm, length) result(seconds)
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: length
    integer, parameter :: tries = 20
    type(exchange_t) :: messages
    real(wp) :: start
    integer :: partner, try, i, exchanges

    seconds = 0
    partner = ieor(comm%rank, 1)
    if (partner >= comm%size) return
    exchanges = max(5, 20000/length)
    exchanges = min(exchanges, 200)
    call messages%prepare(comm, 1, [partner], [length], [length])
    messages%send = 1
    seconds = huge(1.0_wp)
    do try = 0, tries
      start = wall_now()
      do i = 1, exchanges
        call messages%begin(comm)
        call messages%finish(comm)
      end do
      if (try > 0) seconds = min(seconds, (wall_now() - start)/real(exchanges, wp))
    end do
    call messages%release()
  end function seconds_of

  !> Seconds of a message of a length between those measured, or beyond.
  pure real(wp) function costs_of(self, bytes) result(seconds)
    class(message_costs_t), intent(in) :: self
    real(wp), intent(in) :: bytes !! length each way
    integer :: i

    do i = 2, size(self%bytes) - 1
      if (bytes <= self%bytes(i)) exit
    end do
    i = min(i, size(self%bytes))
    seconds = self%seconds(i - 1) + max(0.0_wp, bytes - self%bytes(i - 1))*(self%seconds(i) - self%seconds(i - 1)) &
              /(self%bytes(i) - self%bytes(i - 1))
  end function costs_of

  !> Seconds of the shortest message.
  pure real(wp) function costs_latency(self) result(seconds)
    class(message_costs_t), intent(in) :: self

    seconds = self%seconds(1)
  end function costs_latency

  !> Bytes per second that long messages reach.
  pure real(wp) function costs_bandwidth(self) result(bandwidth)
    class(message_costs_t), intent(in) :: self
    integer :: n

    n = size(self%bytes)
    bandwidth = (self%bytes(n) - self%bytes(n - 1))/max(self%seconds(n) - self%seconds(n - 1), tiny(1.0_wp)*1e20_wp)
  end function costs_bandwidth
end module sg_message_costs
