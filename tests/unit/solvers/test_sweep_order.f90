!> Orders of sweeps whose groups are kept from problem to problem: the same as orders made of nothing, whatever changes between.
program test_sweep_order
  use harness, only: tests_t
  use sg_kinds, only: wp, i4
  use sg_order_values, only: give_impulses
  use sg_problem, only: problem_t, reserve_problem
  use sg_problem_bodies, only: find_movable
  use sg_random, only: random_t
  use sg_records, only: arm_frictional, ball_frictional, first_inverse, normal_x, normal_z, round_frictional, solid_frictional, &
                        solid_cohesion, solid_law, solid_tangent_x, solid_tangent_z
  use sg_run_options, only: solver_options_t
  use sg_sweep_order, only: refill_order, set_order, sweep_order_t, update_order
  use sg_text, only: to_text
  implicit none
  integer, parameter :: kinds(4) = [round_frictional, arm_frictional, ball_frictional, solid_frictional]
  ! Impulses of order one, turned into a local frame and back.
  real(wp), parameter :: rounding = 1e-14_wp
  type(tests_t) :: tests
  type(random_t) :: random
  integer :: i

  call random%seed(11)
  do i = 1, size(kinds)
    call orders_are_as_new(kinds(i), random)
    call orders_are_refilled(kinds(i), random)
    call room_does_not_matter(kinds(i), random)
  end do
  call tests%finish()

contains

  !> Contacts of one body, one to a group, are added to an order that has just room for the others, and to one that has held as many
  !! groups before: both are the same, as those of a run and of one that goes on from its restart must be.
  subroutine room_does_not_matter(kind, random)
    integer, intent(in) :: kind
    type(random_t), intent(inout) :: random
    type(problem_t) :: problem, crowded
    type(sweep_order_t) :: order(2)
    type(solver_options_t) :: options
    logical, allocatable :: is_wanted(:), is_ordered(:)
    integer :: k, i

    call make_problem(kind, random, problem)
    options%order = 'groups'
    allocate (is_wanted(problem%n_contacts), source=.true.)
    do k = 1, problem%n_contacts, 20
      problem%pair(1, k) = merge(1, 2, problem%pair(2, k) > 1)
      is_wanted(k) = .false.
    end do
    crowded = problem
    crowded%pair(1, :) = merge(1, 2, problem%pair(2, :) > 1)
    call set_order(order(1), crowded, spread(.true., 1, problem%n_contacts), options)
    do i = 1, 2
      call set_order(order(i), problem, is_wanted, options)
      is_ordered = is_wanted
      call update_order(order(i), problem, spread(.true., 1, problem%n_contacts), is_ordered, options)
      call tests%check(all(is_ordered), 'room: the order holds all contacts')
    end do
    call tests%check(are_alike(order(1), order(2)), 'room: the same order')
    call tests%check(any(order(2)%contact(:order(2)%n/2) /= [(k, k=1, order(2)%n/2)]), 'room: contacts were dealt')
  end subroutine room_does_not_matter

  !> An order of other records and impulses, to which contacts were added, gives the impulses of the new problem back and has its
  !! records; and nothing is added again to an order that holds all.
  subroutine orders_are_refilled(kind, random)
    integer, intent(in) :: kind
    type(random_t), intent(inout) :: random
    type(problem_t) :: problem, back
    type(sweep_order_t) :: order
    type(solver_options_t) :: options
    logical, allocatable :: is_wanted(:), is_ordered(:)
    logical :: is_done
    integer :: k, i, serial

    call make_problem(kind, random, problem)
    options%order = 'groups'
    allocate (is_wanted(problem%n_contacts), source=.true.)
    do k = 1, problem%n_contacts, 40
      is_wanted(k) = .false.
    end do
    is_ordered = is_wanted
    call set_order(order, problem, is_wanted, options)
    is_wanted(1::80) = .true.
    is_wanted(2::90) = .false.
    call update_order(order, problem, is_wanted, is_ordered, options)
    call tests%check(all(is_ordered .or. .not. is_wanted), 'added: the order holds all that are wanted')
    serial = order%serial
    call update_order(order, problem, is_wanted, is_ordered, options)
    call tests%equal(order%serial, serial, 'added: an order that holds all stays')
    do k = 1, problem%n_contacts
      do i = 1, size(problem%record, 1)
        problem%record(i, k) = random%uniform()
      end do
      if (kind == solid_frictional) call put_law_and_frame(problem%record(:, k))
      problem%impulse(:, k) = random%uniform(1.0_wp, 2.0_wp)
    end do
    call refill_order(order, problem, is_done)
    call tests%check(is_done, 'refilled: all contacts fit')
    back = problem
    back%impulse = -1
    call give_impulses(order, back)
    do k = 1, problem%n_contacts
      if (is_ordered(k)) call tests%check(all(abs(back%impulse(:, k) - problem%impulse(:, k)) < rounding), &
                                          'refilled: impulses')
    end do
    if (.not. order%has_copies) return
    do i = 1, order%n
      call tests%check(all(.not. abs(order%record(:, i) - problem%record(:, order%contact(i))) > 0), 'refilled: records')
    end do
  end subroutine orders_are_refilled

  !> Rows of solids hold impulses of contacts that take part, in their local frames.
  subroutine put_law_and_frame(record)
    real(wp), intent(inout) :: record(:)

    record(normal_x:normal_z) = [0.0_wp, 0.0_wp, 1.0_wp]
    record(solid_tangent_x:solid_tangent_z) = [1.0_wp, 0.0_wp, 0.0_wp]
    record(solid_law) = 1
    record(solid_cohesion) = 0
  end subroutine put_law_and_frame

  !> Problems one after the other, each like the one before up to a change, which may be none: the order that goes on from
  !! problem to problem next to one of its own for each.
  subroutine orders_are_as_new(kind, random)
    integer, intent(in) :: kind
    type(random_t), intent(inout) :: random
    type(problem_t) :: problem
    type(sweep_order_t) :: kept, new
    type(solver_options_t) :: options
    logical, allocatable :: is_wanted(:), is_ordered(:)
    integer :: round, k, b

    call make_problem(kind, random, problem)
    allocate (is_wanted(problem%n_contacts), source=.true.)
    options%order = 'groups'
    do round = 1, 120
      k = place(random, problem%n_contacts)
      b = place(random, problem%n_bodies)
      select case (place(random, 8))
      case (1)
        is_wanted(k) = .not. is_wanted(k)
      case (2)
        problem%pair(1, k) = int(1 + modulo(problem%pair(2, k), problem%n_bodies), i4)
      case (3)
        problem%body(first_inverse(kind):, b) = merge(0.0_wp, 1.0_wp, problem%body(first_inverse(kind), b) > 0)
      case (4)
        is_wanted = .false.
      case (5)
        is_wanted = .true.
      end select
      ! Bodies that were loaded from a scene come with marks of those that move.
      if (allocated(problem%moves)) deallocate (problem%moves)
      if (modulo(round, 3) > 0) then
        allocate (problem%moves(problem%n_bodies))
        call find_movable(problem%n_bodies, size(problem%body, 1), first_inverse(kind), problem%body, problem%moves)
      end if
      problem%record = problem%record*random%uniform(1.0_wp, 1.1_wp)
      problem%impulse = random%uniform()
      call set_order(kept, problem, is_wanted, options)
      block
        type(sweep_order_t) :: empty
        new = empty
      end block
      call set_order(new, problem, is_wanted, options)
      call tests%check(are_alike(kept, new), 'kind '//to_text(kind)//', round '//to_text(round))
      ! More contacts in groups of their own, which the next order has not.
      if (place(random, 3) > 1) cycle
      is_ordered = is_wanted
      is_wanted(k) = .true.
      call update_order(kept, problem, is_wanted, is_ordered, options)
      is_wanted(k) = place(random, 2) == 1
    end do
  end subroutine orders_are_as_new

  !> A random whole number from 1 to n.
  integer function place(random, n)
    type(random_t), intent(inout) :: random
    integer, intent(in) :: n

    place = min(n, 1 + int(random%uniform()*real(n, wp)))
  end function place

  !> A problem of neighbours along a chain, some of which touch by several points.
  subroutine make_problem(kind, random, problem)
    integer, intent(in) :: kind
    type(random_t), intent(inout) :: random
    type(problem_t), intent(out) :: problem
    integer, parameter :: bodies = 300, contacts = 900
    integer :: k

    call reserve_problem(problem, kind, bodies, contacts)
    problem%record = 1
    problem%body = 1
    do k = 1, contacts
      problem%pair(1, k) = int(1 + k*(bodies - 20)/(contacts + 1), i4)
      problem%pair(2, k) = problem%pair(1, k) + int(place(random, 4), i4)
    end do
  end subroutine make_problem

  !> Do two orders sweep the same contacts in the same groups, with the same data?
  logical function are_alike(a, b)
    type(sweep_order_t), intent(in) :: a, b
    integer :: n

    n = a%n
    are_alike = a%n == b%n .and. a%lanes%n_groups == b%lanes%n_groups .and. a%solids%n_groups == b%solids%n_groups .and. &
                a%solids%n_rows == b%solids%n_rows
    if (.not. are_alike .or. n == 0) return
    are_alike = all(a%contact(:n) == b%contact(:n))
    if (a%lanes%n_groups > 0) then
      n = a%lanes%n_groups
      are_alike = are_alike .and. all(a%lanes%group_size(:n) == b%lanes%group_size(:n)) .and. &
                  all(a%lanes%pair(:, :, :n) == b%lanes%pair(:, :, :n)) .and. &
                  .not. any(abs(a%lanes%record(:, :, :n) - b%lanes%record(:, :, :n)) > 0)
    else if (a%solids%n_groups > 0) then
      n = a%solids%n_groups
      are_alike = are_alike .and. all(a%solids%last_row(:n) == b%solids%last_row(:n)) .and. &
                  all(a%solids%pair(:, :, :n) == b%solids%pair(:, :, :n)) .and. &
                  .not. any(abs(a%solids%row(:, :, :a%solids%n_rows) - b%solids%row(:, :, :a%solids%n_rows)) > 0)
    else
      are_alike = are_alike .and. all(a%pair(:, :n) == b%pair(:, :n)) .and. &
                  .not. any(abs(a%record(:, :n) - b%record(:, :n)) > 0)
    end if
  end function are_alike
end program test_sweep_order
