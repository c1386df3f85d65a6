!> Several subdomains per rank: every operation between ranks gives what it gives where each subdomain is a process, in
!! whatever order the subdomains of a process come to it.
module subdomain_operations
  use harness, only: tests_t
  use sg_comm, only: comm_t, sum_of_sweep, sum_of_test
  use sg_coroutines, only: note_progress, yield
  use sg_error, only: error_t, fail
  use sg_exchange, only: exchange_t
  use sg_kinds, only: i4, i8, wp
  use sg_random, only: random_t
  use sg_subdomain_runs, only: subdomain_program_t
  use sg_text, only: to_text
  use sg_timers, only: cpu_now
  implicit none
  private
  public :: operations_t

  !> All operations, several times, with data that depend on the subdomain, the round and nothing else
  type, extends(subdomain_program_t) :: operations_t
    type(tests_t) :: t
    !> Subdomains that have run, CPU seconds that each of them counts, together
    integer :: runs = 0
    real(wp) :: cpu = 0
  contains
    procedure :: run => run_operations
  end type operations_t

contains

  !> Do all operations.
  subroutine run_operations(self, comm)
    class(operations_t), intent(inout) :: self
    type(comm_t), intent(in) :: comm
    type(comm_t) :: own
    type(random_t) :: random
    real(wp) :: start
    integer :: round

    own = comm
    start = cpu_now()
    call random%seed(100 + own%rank)
    do round = 1, 12
      call dawdle(own, random)
      call test_reductions(self%t, own, round, random)
      call test_lists(self%t, own, round, random)
      call test_swap(self%t, own, round, random)
      call test_exchanges(self%t, own, round, random)
    end do
    call test_long_sum(self%t, own)
    self%runs = self%runs + 1
    self%cpu = self%cpu + cpu_now() - start
  end subroutine run_operations

  !> Give others some turns, so that the order of arrival is another one each time.
  subroutine dawdle(comm, random)
    type(comm_t), intent(in) :: comm
    type(random_t), intent(inout) :: random
    integer :: i

    if (.not. comm%is_virtual()) return
    do i = 1, int(4*random%uniform())
      call note_progress()
      call yield()
    end do
  end subroutine dawdle

  !> A real that a subdomain brings, of a size that makes the order of a sum visible.
  elemental real(wp) function summand(rank, place, round)
    integer, intent(in) :: rank, place, round

    summand = sin(real(1 + rank + 7*place + 31*round, wp))*10.0_wp**modulo(rank + place, 9)
  end function summand

  !> Sums, largest and smallest values; sums that are begun and finished later; ranks on this machine.
  subroutine test_reductions(t, comm, round, random)
    type(tests_t), intent(inout) :: t
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: round
    type(random_t), intent(inout) :: random
    real(wp) :: values(3), begun(3), second(2), expected(3), largest
    integer(i8) :: long
    integer :: number, r, k

    values = [(summand(comm%rank, k, round), k=1, 3)]
    expected = 0
    do r = 0, comm%size - 1
      expected = expected + [(summand(r, k, round), k=1, 3)]
    end do
    call comm%begin_sum(sum_of_test, values)
    call dawdle(comm, random)
    call comm%begin_sum(sum_of_sweep, values(:2))
    number = comm%rank*round
    call comm%sum(number)
    call t%equal(number, round*comm%size*(comm%size - 1)/2, 'sum of integers, one is begun')
    call dawdle(comm, random)
    call comm%finish_sum(sum_of_test, begun)
    call dawdle(comm, random)
    call comm%finish_sum(sum_of_sweep, second)
    call comm%sum(values)
    if (comm%is_virtual()) then
      call t%check(all(abs(values - expected) <= 0), 'sums in the order of subdomains, bit for bit')
      call t%check(all(abs(begun - expected) <= 0), 'sums that were begun, bit for bit')
      call t%check(all(abs(second - expected(:2)) <= 0), 'a second sum that was begun, bit for bit')
    else
      ! Sums of ranks may be added in any order: an error of rounding for each of their terms.
      call t%check(all(abs(values - expected) <= 1e-16_wp*1e9_wp*real(comm%size**2, wp)), 'sums')
    end if
    largest = summand(comm%rank, 1, round)
    call comm%maximum(largest)
    call t%near(largest, maxval(summand([(r, r=0, comm%size - 1)], 1, round)), 0.0_wp, 'largest real')
    long = 2_i8**40 - int(comm%rank, i8)
    call comm%minimum(long)
    call t%check(long == 2_i8**40 - int(comm%size - 1, i8), 'smallest long integer')
    call t%check(comm%any(comm%rank == modulo(round, comm%size)), 'a flag of one')
    call t%check(.not. comm%all(comm%rank /= modulo(round, comm%size)), 'not a flag of all')
    call t%equal(comm%ranks_here(), comm%size, 'ranks on this machine')
  end subroutine test_reductions

  !> A text of one root, lists of unequal lengths side by side, and an error of one.
  subroutine test_lists(t, comm, round, random)
    type(tests_t), intent(inout) :: t
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: round
    type(random_t), intent(inout) :: random
    type(error_t), allocatable :: error
    character(len=:), allocatable :: text
    integer(i4), allocatable :: all(:)
    integer, allocatable :: first(:)
    integer :: root, r, k
    logical :: is_right

    root = modulo(round, comm%size)
    if (comm%rank == root) text = 'round '//to_text(round)
    call comm%broadcast(text, root)
    call t%check(text == 'round '//to_text(round), 'text of a root')
    call dawdle(comm, random)
    call comm%gather([(100*comm%rank + k, k=1, modulo(comm%rank + round, 3))], all, first)
    is_right = .true.
    do r = 0, comm%size - 1
      is_right = is_right .and. first(r + 1) - first(r) == modulo(r + round, 3)
      do k = 1, first(r + 1) - first(r)
        is_right = is_right .and. all(first(r) + k - 1) == 100*r + k
      end do
    end do
    call t%check(is_right, 'lists of all side by side')
    if (comm%rank == root) call fail(error, 'failure of '//to_text(root))
    call comm%agree(error, r)
    call t%check(allocated(error) .and. r == root, 'error of one')
    if (allocated(error)) call t%check(error%message == 'failure of '//to_text(root), 'sentence of an error of one')
  end subroutine test_lists

  !> Every subdomain sends to every other, some of them nothing.
  subroutine test_swap(t, comm, round, random)
    type(tests_t), intent(inout) :: t
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: round
    type(random_t), intent(inout) :: random
    real(wp), allocatable :: send(:), came(:), expected(:)
    integer, allocatable :: came_count(:)
    integer(i8) :: before
    integer :: r, k

    send = [real(wp) :: ((summand(comm%rank, r + k, round), k=1, items(comm%rank, r, round)), r=0, comm%size - 1)]
    before = comm%traffic%messages
    call comm%swap(send, [(items(comm%rank, r, round), r=0, comm%size - 1)], came, came_count)
    call dawdle(comm, random)
    expected = [real(wp) :: ((summand(r, comm%rank + k, round), k=1, items(r, comm%rank, round)), r=0, comm%size - 1)]
    call t%check(size(came) == size(expected), 'number of what came')
    if (size(came) == size(expected)) call t%check(all(abs(came - expected) <= 0), 'what came from each')
    call t%check(all(came_count == [(items(r, comm%rank, round), r=0, comm%size - 1)]), 'how many came from each')
    call t%equal(int(comm%traffic%messages - before), count([(items(comm%rank, r, round) > 0 .and. r /= comm%rank, &
                                                              r=0, comm%size - 1)]), 'messages of a swap')
  end subroutine test_swap

  !> Items that one sends to another.
  elemental integer function items(from, to, round)
    integer, intent(in) :: from, to, round

    items = modulo(from + 2*to + round, 4)
  end function items

  !> Two plans at once, finished in the other order, with neighbours to which nothing goes.
  subroutine test_exchanges(t, comm, round, random)
    type(tests_t), intent(inout) :: t
    type(comm_t), intent(inout) :: comm
    integer, intent(in) :: round
    type(random_t), intent(inout) :: random
    type(exchange_t), target :: plans(2)
    integer, allocatable :: neighbour(:)
    integer :: r, p, turn

    neighbour = pack([(r, r=0, comm%size - 1)], [(r /= comm%rank, r=0, comm%size - 1)])
    do p = 1, 2
      call plans(p)%prepare(comm, p, neighbour, items(comm%rank, neighbour, round + p), items(neighbour, comm%rank, round + p))
    end do
    do turn = 1, 3
      do p = 1, 2
        do r = 1, size(neighbour)
          plans(p)%send(:, plans(p)%send_first(r):plans(p)%send_first(r + 1) - 1) = summand(comm%rank, neighbour(r) + p, turn)
        end do
        call plans(p)%begin(comm)
        call dawdle(comm, random)
      end do
      do p = 2, 1, -1
        call plans(p)%finish(comm)
        do r = 1, size(neighbour)
          call t%check(all(abs(plans(p)%receive(:, plans(p)%receive_first(r):plans(p)%receive_first(r + 1) - 1) &
                               - summand(neighbour(r), comm%rank + p, turn)) <= 0), 'items of a neighbour')
        end do
      end do
    end do
    do p = 1, 2
      call plans(p)%release()
    end do
  end subroutine test_exchanges

  !> More reals than go in one piece.
  subroutine test_long_sum(t, comm)
    type(tests_t), intent(inout) :: t
    type(comm_t), intent(inout) :: comm
    real(wp), allocatable :: values(:)
    integer :: k

    values = [(real(k, wp), k=1, 70000)]
    call comm%sum(values)
    call t%check(all(abs(values - real(comm%size, wp)*[(real(k, wp), k=1, 70000)]) <= 0), 'sums of a long list')
  end subroutine test_long_sum
end module subdomain_operations

program test_subdomain_runs
  use harness, only: tests_t
  use sg_comm, only: comm_t
  use sg_kinds, only: wp
  use sg_subdomain_runs, only: run_subdomains
  use sg_timers, only: cpu_now
  use subdomain_operations, only: operations_t
  implicit none
  type(tests_t) :: t
  type(comm_t) :: comm
  integer :: extra

  call comm%start()
  call test_ranks()
  do extra = 0, 9, 3
    call test_subdomains(comm%size + extra)
  end do
  call t%finish(comm)

contains

  !> Each rank is a process.
  subroutine test_ranks()
    type(operations_t) :: program

    call program%run(comm)
    call add(program)
  end subroutine test_ranks

  !> So many subdomains on the ranks there are; each counts its own CPU seconds alone.
  subroutine test_subdomains(n)
    integer, intent(in) :: n
    type(operations_t) :: program
    real(wp) :: start
    integer :: runs

    start = cpu_now()
    call run_subdomains(program, n, comm)
    call t%check(program%cpu <= (1 + 1e-9_wp)*(cpu_now() - start) + 1e-5_wp, 'CPU seconds add up')
    runs = program%runs
    call comm%sum(runs)
    call t%equal(runs, n, 'each subdomain has run')
    call add(program)
  end subroutine test_subdomains

  !> Count the checks of a run.
  subroutine add(program)
    type(operations_t), intent(in) :: program

    t%passed = t%passed + program%t%passed
    t%failed = t%failed + program%t%failed
  end subroutine add
end program test_subdomain_runs
