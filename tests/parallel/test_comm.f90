!> What ranks say to one another, on any number of them: every expected value is a formula of the ranks.
program test_comm
  use harness, only: tests_t
  use sg_comm, only: comm_t
  use sg_error, only: error_t, exit_broken, fail
  use sg_exchange, only: exchange_t
  use sg_kinds, only: wp, i8
  use sg_message_costs, only: measure_messages, message_costs_t
  use sg_text, only: to_text
  implicit none
  type(tests_t) :: t
  type(comm_t) :: comm

  call comm%start()
  call t%check(comm%rank >= 0 .and. comm%rank < comm%size, 'a rank among the ranks')
  call test_reductions()
  call test_any()
  call test_agree()
  call test_sum_meanwhile()
  call test_gather()
  call test_before()
  call test_swap()
  call test_empty_swap()
  call test_exchange()
  call test_one_way()
  call test_message_costs()
  call t%finish(comm)

contains

  !> What messages cost is positive, grows with their length, and is the same on all ranks.
  subroutine test_message_costs()
    type(message_costs_t) :: costs
    real(wp), allocatable :: all_seconds(:, :)
    integer :: r

    if (comm%size == 1) return
    call measure_messages(comm, costs)
    call t%check(all(costs%seconds > 0), 'messages take time')
    call t%check(all(costs%seconds(2:) >= costs%seconds(:size(costs%seconds) - 1)), 'longer ones no less')
    call comm%gather(costs%seconds, all_seconds)
    do r = 1, comm%size
      call t%check(all(abs(all_seconds(:, r) - costs%seconds) <= 0), 'all ranks know the same')
    end do
  end subroutine test_message_costs

  !> Sums, largest and smallest values of 1, r, -r and r**2.
  subroutine test_reductions()
    real(wp) :: r, n, values(4), empty(0)

    r = real(comm%rank, wp)
    n = real(comm%size, wp)
    values = [1.0_wp, r, -r, r**2]
    call comm%sum(values)
    call t%near(maxval(abs(values - [n, n*(n - 1)/2, -n*(n - 1)/2, (n - 1)*n*(2*n - 1)/6])), 0.0_wp, 0.0_wp, 'sums over the ranks')
    values = [1.0_wp, r, -r, r**2]
    call comm%maximum(values)
    call t%near(maxval(abs(values - [1.0_wp, n - 1, 0.0_wp, (n - 1)**2])), 0.0_wp, 0.0_wp, 'largest values')
    values = [1.0_wp, r, -r, r**2]
    call comm%minimum(values)
    call t%near(maxval(abs(values - [1.0_wp, 0.0_wp, 1 - n, 0.0_wp])), 0.0_wp, 0.0_wp, 'smallest values')
    call comm%sum(empty)
  end subroutine test_reductions

  subroutine test_any()
    call t%check(.not. comm%any(.false.), 'nobody says yes')
    call t%check(comm%any(.true.), 'all say yes')
    call t%check(comm%any(comm%rank == comm%size - 1), 'the last one says yes')
  end subroutine test_any

  !> An error of one rank becomes one of all, with all that it says; of several, that of the lowest rank counts.
  subroutine test_agree()
    type(error_t), allocatable :: error
    integer :: speaker, last

    call comm%agree(error, speaker)
    call t%check(speaker == -1 .and. .not. allocated(error), 'all is well')

    last = comm%size - 1
    if (comm%rank == last) call fail(error, 'a sentence', file='deck.toml', line=7, column=3, text='gap = -1', code=exit_broken)
    call comm%agree(error, speaker)
    call t%equal(speaker, last, 'who had the error')
    call expect(error, 'a sentence', 'deck.toml', 'gap = -1', [7, 3, exit_broken])

    if (allocated(error)) deallocate (error)
    if (comm%rank >= last/2) call fail(error, 'rank '//to_text(comm%rank))
    call comm%agree(error, speaker)
    call t%equal(speaker, last/2, 'the lowest rank speaks')
    if (allocated(error)) then
      call t%check(error%message == 'rank '//to_text(last/2), 'its message, whatever the others said')
      call t%check(.not. allocated(error%file), 'no file where it named none')
    end if
    call t%check(allocated(error), 'all ranks have it')
  end subroutine test_agree

  !> Check all that an error says.
  subroutine expect(error, message, file, text, numbers)
    type(error_t), allocatable, intent(in) :: error
    character(len=*), intent(in) :: message, file, text
    integer, intent(in) :: numbers(3)

    call t%check(allocated(error), 'an error arrives')
    if (.not. allocated(error)) return
    call t%check(error%message == message, 'its message')
    call t%check(all([error%line, error%column, error%code] == numbers), 'its line, column and code')
    call t%check(allocated(error%file) .and. allocated(error%text), 'its file and text')
    if (.not. (allocated(error%file) .and. allocated(error%text))) return
    call t%check(error%file == file .and. error%text == text, 'file and text say the same')
  end subroutine expect

  !> A sum is under way while other operations go on; a second one of another size follows.
  subroutine test_sum_meanwhile()
    real(wp) :: values(3), sums(3), other(1), one(1)
    integer :: i
    real(wp) :: n

    n = real(comm%size, wp)
    values = [1.0_wp, 2.0_wp, real(comm%rank, wp)]
    call comm%begin_sum(values)
    values = -1
    other = 1
    do i = 1, 10
      call comm%sum(other)
    end do
    call comm%finish_sum(sums)
    call t%near(maxval(abs(sums - [n, 2*n, n*(n - 1)/2])), 0.0_wp, 0.0_wp, 'a sum that was begun before others')
    call t%near(other(1), n**10, 0.0_wp, 'and the others')
    call comm%begin_sum([real(comm%rank + 1, wp)])
    call comm%finish_sum(one)
    call t%near(one(1), n*(n + 1)/2, 0.0_wp, 'another one')
  end subroutine test_sum_meanwhile

  subroutine test_gather()
    real(wp), allocatable :: all(:, :)
    integer :: r

    call comm%gather([real(comm%rank, wp), 10*real(comm%rank, wp)], all)
    call t%check(size(all, 1) == 2 .and. size(all, 2) == comm%size, 'a column a rank')
    call t%check(maxval(abs(all(1, :) - [(real(r, wp), r=0, comm%size - 1)])) <= 0, 'in the order of the ranks')
    call t%check(maxval(abs(all(2, :) - 10*all(1, :))) <= 0, 'with all values')
  end subroutine test_gather

  !> Counts beyond 2^31; one rank has nothing.
  subroutine test_before()
    integer(i8), parameter :: many = 3000000000_i8
    integer(i8) :: before, total, below

    call comm%before(many*int(modulo(comm%rank, 2) + 1, i8), before, total)
    below = int(comm%rank/2, i8)*3 + int(modulo(comm%rank, 2), i8)
    call t%check(before == many*below, 'sum over the ranks below')
    below = int(comm%size/2, i8)*3 + int(modulo(comm%size, 2), i8)
    call t%check(total == many*below, 'sum over all')
    call comm%before(merge(0_i8, 1_i8, comm%rank == 0), before, total)
    call t%check(before == int(max(0, comm%rank - 1), i8) .and. total == int(comm%size - 1, i8), 'the first one has nothing')
  end subroutine test_before

  !> Number of reals that one rank sends to another: none to the next one, some to itself.
  pure integer function part(from, to)
    integer, intent(in) :: from, to

    part = 2*from + to + 1
    if (to == from + 1) part = 0
  end function part

  !> Each real says where it comes from, where it goes, and its place.
  subroutine test_swap()
    integer :: count(0:comm%size - 1), r, i, at
    integer, allocatable :: got(:)
    real(wp), allocatable :: send(:), receive(:)
    integer(i8) :: messages, bytes

    count = [(part(comm%rank, r), r=0, comm%size - 1)]
    allocate (send(sum(count)))
    at = 0
    do r = 0, comm%size - 1
      send(at + 1:at + count(r)) = [(real(10000*comm%rank + 100*r + i, wp), i=1, count(r))]
      at = at + count(r)
    end do
    messages = comm%traffic%messages
    bytes = comm%traffic%bytes
    call comm%swap(send, count, receive, got)
    call t%check(lbound(got, 1) == 0 .and. size(got) == comm%size, 'a count a rank')
    call t%check(all(got == [(part(r, comm%rank), r=0, comm%size - 1)]), 'counts received')
    call t%equal(size(receive), sum(got), 'reals received')
    at = 0
    do r = 0, comm%size - 1
      call t%check(all(abs(receive(at + 1:at + got(r)) - [(real(10000*r + 100*comm%rank + i, wp), i=1, got(r))]) <= 0), &
                   'the part of each rank, in order')
      at = at + got(r)
    end do
    count(comm%rank) = 0
    i = 0
    do r = 0, comm%size - 1
      if (count(r) > 0) i = i + 1
    end do
    call t%check(comm%traffic%messages - messages == int(i, i8), 'messages to others that hold something')
    call t%check(comm%traffic%bytes - bytes == 8*int(sum(count), i8), 'their bytes')
  end subroutine test_swap

  subroutine test_empty_swap()
    real(wp), allocatable :: receive(:)
    integer, allocatable :: got(:)
    real(wp) :: nothing(0)
    integer :: count(0:comm%size - 1)

    count = 0
    call comm%swap(nothing, count, receive, got)
    call t%check(size(receive) == 0 .and. all(got == 0), 'nothing swapped')
  end subroutine test_empty_swap

  !> All others are neighbours; to the last rank go no items from the first one; the plan serves three times.
  subroutine test_exchange()
    type(exchange_t), target :: plan
    integer, allocatable :: neighbour(:)
    integer(i8) :: messages, bytes
    integer :: r, round, sent

    neighbour = pack([(r, r=0, comm%size - 1)], [(r /= comm%rank, r=0, comm%size - 1)])
    call plan%prepare(comm, 2, neighbour, items(comm%rank, neighbour), items(neighbour, comm%rank))
    call t%equal(size(plan%send, 2), sum(items(comm%rank, neighbour)), 'room for what is sent')
    call t%equal(size(plan%receive, 2), sum(items(neighbour, comm%rank)), 'room for what comes')
    call t%equal(plan%messages, count(items(comm%rank, neighbour) > 0), 'messages to those who get something')
    call t%equal(plan%bytes, 16*size(plan%send, 2), 'bytes of an exchange')
    messages = comm%traffic%messages
    bytes = comm%traffic%bytes
    do round = 1, 3
      call fill(plan, round)
      call plan%begin(comm)
      sent = 0
      do r = 1, 1000
        sent = sent + r
      end do
      call plan%finish(comm)
      call look(plan, round)
    end do
    call t%equal(sent, 500500, 'work between begin and finish')
    call t%check(comm%traffic%messages - messages == 3*int(plan%messages, i8), 'messages of three exchanges')
    call t%check(comm%traffic%bytes - bytes == 3*int(plan%bytes, i8), 'bytes of three exchanges')
    call plan%prepare(comm, 1, neighbour, 0*neighbour, 0*neighbour)
    call plan%begin(comm)
    call plan%finish(comm)
    call t%equal(plan%messages + size(plan%receive), 0, 'a new plan without items')
    call plan%release()
    call t%check(.not. allocated(plan%send), 'a plan that is given back')
    call plan%release()
  end subroutine test_exchange

  !> Items that one rank sends to another.
  elemental integer function items(from, to)
    integer, intent(in) :: from, to

    items = from + 2*to + 1
    if (from == 0 .and. to == comm%size - 1) items = 0
  end function items

  !> Items that say where they come from, where they go, and when.
  subroutine fill(plan, round)
    type(exchange_t), intent(inout) :: plan
    integer, intent(in) :: round
    integer :: i, k

    do i = 1, size(plan%rank)
      do k = plan%send_first(i), plan%send_first(i + 1) - 1
        plan%send(:, k) = real([1000*comm%rank + 10*plan%rank(i) + round, k - plan%send_first(i)], wp)
      end do
    end do
  end subroutine fill

  !> Are they what was sent?
  subroutine look(plan, round)
    type(exchange_t), intent(in) :: plan
    integer, intent(in) :: round
    logical :: is_right
    integer :: i, k

    is_right = .true.
    do i = 1, size(plan%rank)
      do k = plan%receive_first(i), plan%receive_first(i + 1) - 1
        is_right = is_right .and. &
                   all(nint(plan%receive(:, k)) == [1000*plan%rank(i) + 10*comm%rank + round, k - plan%receive_first(i)])
      end do
    end do
    call t%check(is_right, 'items arrive in their order')
  end subroutine look

  !> Two plans at a time between the same ranks: up the ranks, and down.
  subroutine test_one_way()
    type(exchange_t), target :: up, down
    integer, allocatable :: higher(:), lower(:)
    integer :: r

    lower = [(r, r=max(0, comm%rank - 1), comm%rank - 1)]
    higher = [(r, r=comm%rank + 1, min(comm%rank + 1, comm%size - 1))]
    call up%prepare(comm, 1, [lower, higher], [0*lower, 0*higher + 1], [0*lower + 1, 0*higher])
    call down%prepare(comm, 1, [lower, higher], [0*lower + 1, 0*higher], [0*lower, 0*higher + 1])
    up%send = real(comm%rank, wp)
    down%send = -real(comm%rank, wp)
    call up%begin(comm)
    call down%begin(comm)
    call down%finish(comm)
    call up%finish(comm)
    if (size(lower) == 1) call t%near(up%receive(1, 1), real(comm%rank - 1, wp), 0.0_wp, 'from below')
    if (size(higher) == 1) call t%near(down%receive(1, 1), -real(comm%rank + 1, wp), 0.0_wp, 'from above')
    call t%equal(size(up%receive), size(lower), 'the first one hears nothing from below')
    call up%release()
    call down%release()
  end subroutine test_one_way
end program test_comm
