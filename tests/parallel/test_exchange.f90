!> Exchange with neighbours by plans, and what messages cost, on any number of ranks.
program test_exchange
  use harness, only: tests_t
  use sg_comm, only: comm_t
  use sg_exchange, only: exchange_t
  use sg_kinds, only: i8, wp
  use sg_message_costs, only: measure_messages, message_costs_t
  implicit none
  type(tests_t) :: t
  type(comm_t) :: comm

  call comm%start()
  call test_plan()
  call test_copies()
  call test_one_way()
  call test_message_costs()
  call t%finish(comm)

contains

  !> All others are neighbours; to the last rank go no items from the first one; the plan serves three times.
  subroutine test_plan()
    type(exchange_t), target :: plan
    integer, allocatable :: neighbour(:)
    integer(i8) :: messages, bytes
    integer :: r, round, sent

    neighbour = pack([(r, r=0, comm%size - 1)], [(r /= comm%rank, r=0, comm%size - 1)])
    call plan%prepare(comm, 2, neighbour, items(comm%rank, neighbour), items(neighbour, comm%rank))
    call t%equal(size(plan%send, 2), sum(items(comm%rank, neighbour)), 'room for what is sent')
    call t%equal(size(plan%receive, 2), sum(items(neighbour, comm%rank)), 'room for what comes')
    call t%equal(plan%messages, count(items(comm%rank, neighbour) > 0), 'messages to those that get something')
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
  end subroutine test_plan

  !> A copy of a plan, alone or in what holds it, has messages of its own: both send their own items, by turns or at once, and
  !! each is given back without the other.
  subroutine test_copies()
    type :: holder_t
      type(exchange_t) :: plan
    end type holder_t
    type(holder_t), target :: first, second
    type(holder_t), allocatable, target :: third
    integer, allocatable :: neighbour(:)
    integer :: r

    neighbour = pack([(r, r=0, comm%size - 1)], [(r /= comm%rank, r=0, comm%size - 1)])
    call first%plan%prepare(comm, 2, neighbour, items(comm%rank, neighbour), items(neighbour, comm%rank))
    second = first
    allocate (third, source=first)
    call fill(first%plan, 1)
    call fill(second%plan, 2)
    call second%plan%begin(comm)
    call second%plan%finish(comm)
    call look(second%plan, 2)
    call first%plan%begin(comm)
    call fill(third%plan, 3)
    call third%plan%begin(comm)
    call third%plan%finish(comm)
    call first%plan%finish(comm)
    call look(first%plan, 1)
    call look(third%plan, 3)
    call first%plan%release()
    call fill(second%plan, 4)
    call second%plan%begin(comm)
    call second%plan%finish(comm)
    call look(second%plan, 4)
    call second%plan%release()
    call third%plan%release()
    deallocate (third)
    ! A copy that never sent holds nothing to give back.
    call first%plan%prepare(comm, 2, neighbour, items(comm%rank, neighbour), items(neighbour, comm%rank))
    second = first
    call second%plan%release()
    call fill(first%plan, 5)
    call first%plan%begin(comm)
    call first%plan%finish(comm)
    call look(first%plan, 5)
    call first%plan%release()
  end subroutine test_copies

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
    call t%equal(size(up%receive), size(lower), 'the first one gets nothing from below')
    call up%release()
    call down%release()
  end subroutine test_one_way

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
      call t%check(all(abs(all_seconds(:, r) - costs%seconds) <= 0), 'the same on all ranks')
    end do
  end subroutine test_message_costs
end program test_exchange
