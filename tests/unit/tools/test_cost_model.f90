!> The cost model: what parts share against counting one by one, and iterations against sums made by hand.
program test_cost_model
  use harness, only: tests_t
  use sg_contacts, only: contacts_t
  use sg_cost_model, only: dual_iteration, iteration_t, machine_t, primal_iteration
  use sg_interfaces, only: find_interfaces, interfaces_t
  use sg_kinds, only: wp, i4
  use sg_message_costs, only: given_messages, message_costs_t
  use sg_owners, only: contact_owner
  use sg_random, only: random_t
  use sg_sorting, only: group_items
  implicit none
  type(tests_t) :: t
  !> Sums of a few products of the same numbers
  real(wp), parameter :: tolerance = 1e-14_wp

  call test_groups()
  call test_messages()
  call test_interfaces(60, 200, 5)
  call test_interfaces(40, 90, 40)
  call test_interfaces(30, 50, 1)
  call test_iterations()
  call t%finish()

contains

  !> Items stay in order within their groups; those of no group are left out.
  subroutine test_groups()
    integer, allocatable :: first(:), item(:)

    call group_items([3_i4, 0_i4, 1_i4, 3_i4, 5_i4, 1_i4], 4, first, item)
    call t%check(all(first == [1, 3, 3, 5, 5]), 'where groups begin')
    call t%check(all(item == [3, 6, 1, 4]), 'items of groups')
    call group_items([integer(i4) ::], 2, first, item)
    call t%check(all(first == 1) .and. size(item) == 0, 'no item')
  end subroutine test_groups

  !> Straight lines between what was measured, and beyond.
  subroutine test_messages()
    type(message_costs_t) :: costs

    costs%bytes = [8.0_wp, 1008.0_wp, 3008.0_wp]
    costs%seconds = [1.0_wp, 2.0_wp, 6.0_wp]
    call t%near(costs%of(508.0_wp), 1.5_wp, tolerance, 'between the first two')
    call t%near(costs%of(2008.0_wp), 4.0_wp, tolerance, 'between the last two')
    call t%near(costs%of(4008.0_wp), 8.0_wp, tolerance, 'beyond')
    call t%near(costs%of(0.0_wp), 1.0_wp, tolerance, 'nothing costs the latency')
    call t%near(costs%bandwidth(), 500.0_wp, tolerance, 'bandwidth')
    costs = given_messages(2e-6_wp, 1e9_wp)
    call t%near(costs%of(4e6_wp), 2e-6_wp + 4e-3_wp, tolerance, 'a network that is given')
    call t%near(costs%bandwidth(), 1e9_wp, 1e-10_wp, 'its bandwidth')
  end subroutine test_messages

  !> Random contacts of random parts, with a wall, against tables of who has a contact on what.
  subroutine test_interfaces(grains, n, parts)
    integer, intent(in) :: grains, n, parts
    type(contacts_t) :: contacts
    type(interfaces_t) :: found
    type(random_t) :: random
    integer(i4) :: part(grains + 1)
    integer(i4), allocatable :: owner(:)
    logical :: holds(grains + 1, parts), lends(grains + 1, parts)
    integer :: edge(parts, parts), k, p, q, i, pair(2)

    call random%seed(grains)
    part(grains + 1) = 0
    do k = 1, grains
      part(k) = int(min(parts, 1 + int(random%uniform(0.0_wp, real(parts, wp)))), i4)
    end do
    contacts%n = n
    allocate (contacts%body(2, n))
    holds = .false.
    lends = .false.
    edge = 0
    do k = 1, n
      contacts%body(1, k) = int(1 + int(random%uniform(0.0_wp, 0.999_wp)*real(grains, wp)), i4)
      contacts%body(2, k) = int(1 + int(random%uniform(0.0_wp, 0.999_wp)*real(grains + 1, wp)), i4)
    end do
    call find_interfaces(contacts, part, parts, owner, found)
    do k = 1, n
      pair = part(contacts%body(:, k))
      p = contact_owner(int(pair - 1, i4)) + 1
      call t%check(owner(k) == p, 'owner')
      holds(contacts%body(:, k), p) = .true.
      if (any(pair == 0) .or. pair(1) == pair(2)) cycle
      edge(minval(pair), maxval(pair)) = edge(minval(pair), maxval(pair)) + 1
      lends(contacts%body(merge(2, 1, pair(1) == p), k), p) = .true.
    end do
    holds(grains + 1, :) = .false.
    call t%check(all(found%owned == [(count(owner == p), p=1, parts)]), 'contacts owned')
    call t%check(sum(found%inner) == n - sum(edge), 'contacts within parts')
    call t%check(found%shared_grains == count(count(holds, 2) > 1), 'shared grains')
    call t%check(all(found%shared == [(count(holds(:, p) .and. count(holds, 2) > 1), p=1, parts)]), 'shared by part')
    i = 0
    do p = 1, parts
      do q = p + 1, parts
        if (.not. any(holds(:, p) .and. holds(:, q))) cycle
        i = i + 1
        call t%check(all(found%common%part(:, i) == [p, q] - 1), 'a pair that shares')
        call t%check(found%common%items(i) == count(holds(:, p) .and. holds(:, q)), 'what it shares')
      end do
    end do
    call t%check(size(found%common%items) == i, 'pairs that share')
    i = 0
    do p = 1, parts
      do q = p + 1, parts
        if (edge(p, q) == 0) cycle
        i = i + 1
        call t%check(found%edge%items(i) == edge(p, q), 'contacts of an edge')
        call t%check(found%lent(i) == count(lends(:, p) .and. part == q) + count(lends(:, q) .and. part == p), 'grains lent')
      end do
    end do
    call t%check(size(found%edge%items) == i, 'edges')
  end subroutine test_interfaces

  !> Three parts in a row: 0 shares two grains with 1, which shares one with 2.
  subroutine test_iterations()
    type(machine_t) :: machine
    type(interfaces_t) :: split
    type(iteration_t) :: iteration

    machine%update = 1
    machine%glue = 10
    machine%item_bytes = 24
    machine%check_every = 4
    machine%messages = given_messages(100.0_wp, 0.024_wp)
    split%owned = [50, 40, 45]
    split%inner = [47, 40, 42]
    split%shared = [2, 3, 1]
    split%common%part = reshape([0, 1, 1, 2], [2, 2])
    split%common%items = [2, 1]
    split%edge = split%common
    split%edge%items = [3, 3]
    split%lent = [2, 1]
    iteration = dual_iteration(machine, split, [0, 1, 2])
    ! Part 1: 40 updates, 3 grains, messages of 100 + 2000 and 100 + 1000; the reduction is log2(3) latencies in 4 rounds.
    call t%near(iteration%seconds, 40 + 30 + 3200 + 25*log(3.0_wp)/log(2.0_wp), 1e-12_wp, 'dual')
    call t%check(iteration%messages == 4 .and. iteration%most_neighbours == 2, 'its messages')
    call t%near(iteration%bytes, 144.0_wp, tolerance, 'its bytes')
    iteration = primal_iteration(machine, split, [0, 1, 2])
    ! Two turns, as part 1 has two edges: 47 updates, then 3 and two messages each.
    call t%near(iteration%seconds, 47 + (3 + 2*2100) + (3 + 2*1100) + 25*log(3.0_wp)/log(2.0_wp), 1e-12_wp, 'primal')
    call t%check(iteration%colours == 2, 'its turns')
    iteration = dual_iteration(machine, split, [0, 0, 1])
    ! Rank 0 has two parts: 50 + 40 updates, 2 + 3 grains, one message of 100 + 1000; the reduction is one latency in 4 rounds.
    call t%near(iteration%seconds, 1265.0_wp, 1e-12_wp, 'dual, two parts on a rank')
    call t%check(iteration%messages == 2 .and. iteration%most_neighbours == 1, 'messages between ranks alone')
    call t%near(iteration%bytes, 48.0_wp, tolerance, 'and their bytes')
    iteration = primal_iteration(machine, split, [0, 0, 1])
    ! 47 + 40 updates, 3 in the turn of the edge within the rank, 3 and two messages in the other turn.
    call t%near(iteration%seconds, 2318.0_wp, 1e-12_wp, 'primal, two parts on a rank')
    call t%check(iteration%messages == 2 .and. iteration%most_neighbours == 1, 'its messages')
    iteration = dual_iteration(machine, split, [0, 1, 2])
    machine%messages = given_messages(0.0_wp, 1e30_wp)
    machine%glue = 0
    iteration = dual_iteration(machine, split, [0, 1, 2])
    call t%near(iteration%seconds, 50.0_wp, 1e-12_wp, 'where nothing but updates costs, the largest part counts')
  end subroutine test_iterations
end program test_cost_model
