!> Messages between ranks, on any number of them: every expected value is a formula of the ranks.
program test_comm
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use harness, only: tests_t
  use sg_comm, only: comm_t, sum_of_sweep, sum_of_test
  use sg_error, only: error_t, exit_broken, fail
  use sg_kinds, only: i4, i8, wp
  use sg_text, only: to_text
  implicit none
  type(tests_t) :: t
  type(comm_t) :: comm

  call comm%start()
  call t%check(comm%rank >= 0 .and. comm%rank < comm%size, 'a rank among the ranks')
  call test_reductions()
  call test_integers()
  call test_longs()
  call test_scalars()
  call test_any()
  call test_broadcast()
  call test_broadcast_text()
  call test_agree()
  call test_sum_meanwhile()
  call test_gather()
  call test_gather_scalars()
  call test_gather_lists()
  call test_traffic()
  call test_before()
  call test_swap()
  call test_empty_swap()
  call t%finish(comm)

contains

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

  !> The same for integers, of an array with gaps too.
  subroutine test_integers()
    integer(i4) :: r, n, values(4), spaced(7), empty(0)

    r = comm%rank
    n = comm%size
    values = [1, r, -r, r**2]
    call comm%sum(values)
    call t%check(all(values == [n, n*(n - 1)/2, -n*(n - 1)/2, (n - 1)*n*(2*n - 1)/6]), 'sums of integers')
    spaced = 7
    spaced(::2) = [1, r, -r, r**2]
    call comm%maximum(spaced(::2))
    call t%check(all(spaced == [1, 7, n - 1, 7, 0, 7, (n - 1)**2]), 'largest integers, in an array with gaps')
    values = [1, r, -r, r**2]
    call comm%minimum(values)
    call t%check(all(values == [1, 0, 1 - n, 0]), 'smallest integers')
    call comm%sum(empty)
    call comm%maximum(empty)
  end subroutine test_integers

  !> The same for long integers beyond 2^53, where reals would round them.
  subroutine test_longs()
    integer(i8), parameter :: many = 2_i8**53 + 1
    integer(i8) :: r, n, values(2), empty(0)

    r = int(comm%rank, i8)
    n = int(comm%size, i8)
    values = [many, -r*many]
    call comm%sum(values)
    call t%check(all(values == [n*many, -n*(n - 1)/2*many]), 'sums of long integers')
    values = [many + r, -r*many]
    call comm%maximum(values)
    call t%check(all(values == [many + n - 1, 0_i8]), 'largest long integers')
    values = [many + r, -r*many]
    call comm%minimum(values)
    call t%check(all(values == [many, (1 - n)*many]), 'smallest long integers')
    call comm%minimum(empty)
  end subroutine test_longs

  !> One value of each kind: sum, largest and smallest one of 3 r + 1 and, for long integers, of that times 2^40.
  subroutine test_scalars()
    integer(i8), parameter :: many = 2_i8**40
    integer(i4) :: short(3), own, n
    integer(i8) :: long(3)
    real(wp) :: part(3), zero

    n = comm%size
    own = 3*comm%rank + 1
    short = own
    long = many*int(own, i8)
    part = real(own, wp)/4
    call comm%sum(short(1))
    call comm%maximum(short(2))
    call comm%minimum(short(3))
    call comm%sum(long(1))
    call comm%maximum(long(2))
    call comm%minimum(long(3))
    call comm%sum(part(1))
    call comm%maximum(part(2))
    call comm%minimum(part(3))
    associate (expected => [n + 3*n*(n - 1)/2, 3*n - 2, 1])
      call t%check(all(short == expected), 'an integer summed, the largest, the smallest')
      call t%check(all(long == many*int(expected, i8)), 'a long integer summed, the largest, the smallest')
      call t%check(all(abs(part - real(expected, wp)/4) <= 0), 'a real summed, the largest, the smallest')
    end associate
    zero = -0.0_wp
    call comm%maximum(zero)
    call t%check(sign(1.0_wp, zero) < 0, 'the sign of a zero is kept')
  end subroutine test_scalars

  subroutine test_any()
    logical :: is_last
    integer :: r

    is_last = comm%rank == comm%size - 1
    call t%check(.not. comm%any(.false.), 'false on all ranks: not any')
    call t%check(comm%any(.true.), 'true on all ranks: any')
    call t%check(comm%any(is_last), 'true on the last rank: any')
    call t%check(.not. comm%all(.false.), 'false on all ranks: not all')
    call t%check(comm%all(.true.), 'true on all ranks: all')
    call t%check(comm%all(is_last) .eqv. comm%size == 1, 'true on the last rank alone: all only where it is the only one')
    call t%check(all(comm%any([.false., is_last, .true., comm%rank == 0]) .eqv. [.false., .true., .true., .true.]), &
                 'each flag by itself')
    call t%check(all(comm%any([(comm%rank == r, r=0, comm%size)]) .eqv. [(r < comm%size, r=0, comm%size)]), 'a flag per rank')
    call t%check(size(comm%any([logical ::])) == 0, 'no flags')
  end subroutine test_any

  !> Each rank is the root once; all others hold something else before. Bits arrive as they are: not a number too.
  subroutine test_broadcast()
    integer(i4) :: short, shorts(3), no_shorts(0)
    integer(i8) :: long, longs(2)
    real(wp) :: part, parts(3), nan
    logical :: is_so
    integer :: root

    nan = ieee_value(nan, ieee_quiet_nan)
    do root = 0, comm%size - 1
      associate (own => merge(root + 5, -comm%rank, comm%rank == root))
        short = own
        shorts = [own, -own, 2*own]
        long = int(own, i8)*2_i8**40
        longs = [long, -long]
        part = real(own, wp)/8
        parts = [part, -0.0_wp, nan]
        is_so = comm%rank == root
        if (comm%rank /= root) parts(2:3) = 1
      end associate
      call comm%broadcast(short, root)
      call comm%broadcast(shorts, root)
      call comm%broadcast(no_shorts, root)
      call comm%broadcast(long, root)
      call comm%broadcast(longs, root)
      call comm%broadcast(part, root)
      call comm%broadcast(parts, root)
      call comm%broadcast(is_so, root)
      call t%check(short == root + 5 .and. all(shorts == (root + 5)*[1, -1, 2]), 'integers of the root')
      call t%check(all([long, longs] == (int(root, i8) + 5)*2_i8**40*[1_i8, 1_i8, -1_i8]), 'long integers of the root')
      call t%check(all(abs([part, parts(1)] - real(root + 5, wp)/8) <= 0), 'reals of the root')
      call t%check(sign(1.0_wp, parts(2)) < 0 .and. ieee_is_nan(parts(3)), 'a negative zero and what is not a number')
      call t%check(is_so, 'the flag of the root')
      is_so = comm%rank /= root
      call comm%broadcast(is_so, root)
      call t%check(.not. is_so, 'and that it is false')
    end do
  end subroutine test_broadcast

  !> Texts of any length arrive, and that there is none.
  subroutine test_broadcast_text()
    character(len=:), allocatable :: text
    integer :: root

    do root = 0, comm%size - 1
      text = 'rank '//repeat('*', int(3*comm%rank, i8))
      call comm%broadcast(text, root)
      call t%check(len(text) == 5 + 3*root .and. text == 'rank '//repeat('*', int(3*root, i8)), 'the text of the root')
      if (comm%rank == root) text = ''
      call comm%broadcast(text, root)
      call t%check(allocated(text), 'an empty text is a text')
      if (allocated(text)) call t%equal(len(text), 0, 'of no length')
      text = 'x'
      if (comm%rank == root) deallocate (text)
      call comm%broadcast(text, root)
      call t%check(.not. allocated(text), 'no text where the root has none')
      if (comm%rank == root) text = 'from nothing'
      call comm%broadcast(text, root)
      call t%check(allocated(text), 'a text where ranks had none')
      if (allocated(text)) call t%check(text == 'from nothing', 'which is that of the root')
    end do
  end subroutine test_broadcast_text

  !> An error of one rank becomes one of all, with all that it says; of several, that of the lowest rank counts.
  subroutine test_agree()
    type(error_t), allocatable :: error
    integer :: root, last

    call comm%agree(error, root)
    call t%check(root == -1 .and. .not. allocated(error), 'all is well')

    last = comm%size - 1
    if (comm%rank == last) call fail(error, 'a sentence', file='deck.toml', line=7, column=3, text='gap = -1', code=exit_broken)
    call comm%agree(error, root)
    call t%equal(root, last, 'the rank that had the error')
    call expect(error, 'a sentence', 'deck.toml', 'gap = -1', [7, 3, exit_broken])

    if (allocated(error)) deallocate (error)
    if (comm%rank >= last/2) call fail(error, 'rank '//to_text(comm%rank))
    call comm%agree(error, root)
    call t%equal(root, last/2, 'the lowest rank that had one')
    if (allocated(error)) then
      call t%check(error%message == 'rank '//to_text(last/2), 'its message, whatever those of others')
      call t%check(.not. allocated(error%file), 'no file where it named none')
    end if
    call t%check(allocated(error), 'all ranks have it')
    call comm%agree(error)
    if (allocated(error)) call t%check(error%message == 'rank '//to_text(last/2), 'shared once more, it stays')
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

  !> Two sums of other sizes are under way at once, while other operations go on, and end in either order.
  subroutine test_sum_meanwhile()
    real(wp) :: values(3), sums(3), other(1), pair(2), both(2), one(1)
    integer :: i
    real(wp) :: n

    n = real(comm%size, wp)
    values = [1.0_wp, 2.0_wp, real(comm%rank, wp)]
    pair = [1.0_wp, real(-comm%rank, wp)]
    call comm%begin_sum(sum_of_test, values)
    call comm%begin_sum(sum_of_sweep, pair)
    values = -1
    pair = -1
    other = 1
    do i = 1, 10
      call comm%sum(other)
    end do
    call comm%finish_sum(sum_of_sweep, both)
    call comm%finish_sum(sum_of_test, sums)
    call t%near(maxval(abs(both - [n, -n*(n - 1)/2])), 0.0_wp, 0.0_wp, 'a sum that was begun second, and is finished first')
    call t%near(maxval(abs(sums - [n, 2*n, n*(n - 1)/2])), 0.0_wp, 0.0_wp, 'a sum that was begun before others')
    call t%near(other(1), n**10, 0.0_wp, 'and the others')
    call comm%begin_sum(sum_of_sweep, [real(comm%rank + 1, wp)])
    call comm%finish_sum(sum_of_sweep, one)
    call t%near(one(1), n*(n + 1)/2, 0.0_wp, 'another one')
  end subroutine test_sum_meanwhile

  subroutine test_gather()
    real(wp), allocatable :: all(:, :)
    integer :: r

    call comm%gather([real(comm%rank, wp), 10*real(comm%rank, wp)], all)
    call t%check(size(all, 1) == 2 .and. size(all, 2) == comm%size, 'a column per rank')
    call t%check(maxval(abs(all(1, :) - [(real(r, wp), r=0, comm%size - 1)])) <= 0, 'in the order of the ranks')
    call t%check(maxval(abs(all(2, :) - 10*all(1, :))) <= 0, 'with all values')
    call comm%gather([real(wp) ::], all)
    call t%check(size(all, 1) == 0 .and. size(all, 2) == comm%size, 'columns without rows')
  end subroutine test_gather

  !> One value per rank, beyond what reals hold exactly where it is long.
  subroutine test_gather_scalars()
    integer(i4), allocatable :: short(:)
    integer(i8), allocatable :: long(:)
    integer :: r

    call comm%gather(comm%rank**2 + 1, short)
    call t%equal(size(short), comm%size, 'an integer per rank')
    call t%check(all(short == [(r**2 + 1, r=0, comm%size - 1)]), 'in the order of the ranks')
    call comm%gather(2_i8**60 + int(comm%rank, i8), long)
    call t%equal(size(long), comm%size, 'a long integer per rank')
    call t%check(all(long == [(2_i8**60 + int(r, i8), r=0, comm%size - 1)]), 'in the order of the ranks, to the last bit')
  end subroutine test_gather_scalars

  !> Lists of any sizes, empty ones among them.
  subroutine test_gather_lists()
    integer, allocatable :: all(:), first(:)
    integer :: i, r, longest

    do longest = 0, 4
      call comm%gather([(100*comm%rank + i, i=1, length(comm%rank, longest))], all, first)
      call t%check(lbound(first, 1) == 0 .and. size(first) == comm%size + 1, 'a beginning per rank, and the end')
      call t%equal(size(all), sum([(length(r, longest), r=0, comm%size - 1)]), 'items of all ranks')
      do r = 0, comm%size - 1
        call t%equal(first(r + 1) - first(r), length(r, longest), 'items of a rank')
        call t%equal(count(all(first(r):first(r + 1) - 1) /= [(100*r + i, i=1, length(r, longest))]), 0, 'its own, in order')
      end do
    end do
  end subroutine test_gather_lists

  !> Length of the list of a rank.
  pure integer function length(rank, longest)
    integer, intent(in) :: rank, longest

    length = modulo(longest - rank, longest + 1)
  end function length

  !> Each operation of several ranks is counted once; one rank alone has none.
  subroutine test_traffic()
    integer(i8) :: collectives, before, total
    integer :: number
    integer, allocatable :: all(:), first(:)

    collectives = comm%traffic%collectives
    number = 1
    call comm%sum(number)
    call comm%broadcast(number, 0)
    call comm%gather(number, all)
    call comm%gather([number], all, first)
    call comm%before(1_i8, before, total)
    if (comm%any(.true.)) collectives = comm%traffic%collectives - collectives
    ! Lists of any sizes need their sizes first.
    call t%check(collectives == merge(7_i8, 0_i8, comm%size > 1), 'collective operations counted')
  end subroutine test_traffic

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
    call t%check(lbound(got, 1) == 0 .and. size(got) == comm%size, 'a count per rank')
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
end program test_comm
