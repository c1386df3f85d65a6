!> The order in which a sweep visits contacts, and their records copied into that order.
!!
!! Consecutive contacts of the spatial order share bodies, and the chain of dependent updates limits a sweep. In
!! *groups* order, blocks of consecutive contacts, small enough to stay in cache, are dealt to small groups in which
!! no movable body appears twice: the processor then works on several contacts at once, and the order of the blocks
!! stays spatial (doc/theory/nlgs.md). Contacts that are open and stay so need not be visited at all: the order holds
!! the ones chosen.
module sg_sweep_order
  use sg_kinds, only: wp, i4, i8
  use sg_problem, only: first_inverse, is_compact, problem_t
  implicit none
  private
  public :: sweep_order_t, set_order, give_impulses

  !> Contacts of a group and of a block, for round problems and for problems with arms.
  !!
  !! Larger ones overlap more updates, smaller ones keep the spatial order better. Polygons pay for lost order: with
  !! the sizes of disks they need half as many sweeps again (doc/performance.md).
  integer, parameter :: width_round = 8, block_round = 256, width_arm = 4, block_arm = 32
  !> The most groups that a block may open (bits of an integer)
  integer, parameter :: most_groups = 63

  !> Contacts in the order of the sweep
  type :: sweep_order_t
    !> Number of contacts that a sweep visits
    integer :: n = 0
    !> Their indices in the problem
    integer(i4), allocatable :: contact(:)
    !> Slots, records and impulses in that order
    integer(i4), allocatable :: pair(:, :)
    real(wp), allocatable :: record(:, :), impulse(:, :)
    !> Room for dealing: contacts chosen, and groups of each body as bits
    integer(i4), allocatable, private :: chosen(:)
    integer(i8), allocatable, private :: groups_of(:)
  end type sweep_order_t

contains

  !> Choose the order of the marked contacts and copy them into it.
  pure subroutine set_order(order, problem, is_wanted, in_groups)
    type(sweep_order_t), intent(inout) :: order !! order to set
    type(problem_t), intent(in) :: problem !! problem to sweep
    logical, intent(in), contiguous :: is_wanted(:) !! which contacts to visit
    logical, intent(in) :: in_groups !! groups order; natural otherwise
    integer :: i, k

    call make_room(order, problem)
    order%n = 0
    do k = 1, problem%n_contacts
      if (.not. is_wanted(k)) cycle
      order%n = order%n + 1
      order%chosen(order%n) = int(k, i4)
    end do
    if (in_groups) then
      call deal(order%n, order%chosen, problem, order%groups_of, order%contact)
    else
      order%contact(:order%n) = order%chosen(:order%n)
    end if
    do i = 1, order%n
      k = order%contact(i)
      order%pair(:, i) = problem%pair(:, k)
      order%record(:, i) = problem%record(:, k)
    end do
    call take_impulses(order, problem)
  end subroutine set_order

  !> Room for all contacts of a problem.
  pure subroutine make_room(order, problem)
    type(sweep_order_t), intent(inout) :: order
    type(problem_t), intent(in) :: problem
    integer :: n
    logical :: fits

    fits = allocated(order%contact)
    if (fits) fits = size(order%contact) >= problem%n_contacts .and. size(order%groups_of) == problem%n_bodies
    if (fits) return
    if (allocated(order%contact)) then
      deallocate (order%contact, order%pair, order%record, order%impulse, order%chosen, order%groups_of)
    end if
    n = problem%n_contacts + problem%n_contacts/8
    allocate (order%contact(n), order%chosen(n), order%pair(2, n))
    allocate (order%record(size(problem%record, 1), n), order%impulse(size(problem%impulse, 1), n))
    allocate (order%groups_of(problem%n_bodies), source=0_i8)
  end subroutine make_room

  !> Deal contacts to groups, block by block.
  pure subroutine deal(n, chosen, problem, groups_of, contact)
    integer, intent(in) :: n
    integer(i4), intent(in), contiguous :: chosen(:)
    type(problem_t), intent(in) :: problem
    integer(i8), intent(inout) :: groups_of(:)
    integer(i4), intent(inout), contiguous :: contact(:)
    integer :: first, last, block_size, width

    block_size = block_arm
    width = width_arm
    if (is_compact(problem%kind)) then
      block_size = block_round
      width = width_round
    end if
    do first = 1, n, block_size
      last = min(n, first + block_size - 1)
      call deal_block(chosen(first:last), problem, width, groups_of, contact(first:last))
    end do
  end subroutine deal

  !> Deal one block: each contact goes to the first group that has room and neither of its movable bodies.
  pure subroutine deal_block(chosen, problem, width, groups_of, contact)
    integer(i4), intent(in), contiguous :: chosen(:)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: width
    integer(i8), intent(inout) :: groups_of(:) !! bit g: the body is in group g of this block
    integer(i4), intent(inout), contiguous :: contact(:)
    integer(i8) :: full
    integer :: filled(0:most_groups), group(block_round), i, g, side, inverse
    integer(i4) :: pair(2)

    inverse = first_inverse(problem%kind)
    full = 0
    filled = 0
    do i = 1, size(chosen)
      pair = problem%pair(:, chosen(i))
      g = min(trailz(not(ior(full, ior(groups_of(pair(1)), groups_of(pair(2)))))), most_groups)
      group(i) = g
      filled(g) = filled(g) + 1
      if (g == most_groups) cycle
      if (filled(g) == width) full = ibset(full, g)
      do side = 1, 2
        if (any(problem%body(inverse:, pair(side)) > 0)) groups_of(pair(side)) = ibset(groups_of(pair(side)), g)
      end do
    end do
    call spread_groups(chosen, group, filled, contact)
    do i = 1, size(chosen)
      groups_of(problem%pair(:, chosen(i))) = 0
    end do
  end subroutine deal_block

  !> Write the groups of a block one after the other.
  pure subroutine spread_groups(chosen, group, filled, contact)
    integer(i4), intent(in), contiguous :: chosen(:)
    integer, intent(in) :: group(:), filled(0:)
    integer(i4), intent(inout), contiguous :: contact(:)
    integer :: next(0:most_groups), i

    next(0) = 1
    do i = 1, most_groups
      next(i) = next(i - 1) + filled(i - 1)
    end do
    do i = 1, size(chosen)
      contact(next(group(i))) = chosen(i)
      next(group(i)) = next(group(i)) + 1
    end do
  end subroutine spread_groups

  !> Copy impulses from the problem into the order.
  pure subroutine take_impulses(order, problem)
    type(sweep_order_t), intent(inout) :: order !! order to fill
    type(problem_t), intent(in) :: problem !! its impulses
    integer :: i

    do i = 1, order%n
      order%impulse(:, i) = problem%impulse(:, order%contact(i))
    end do
  end subroutine take_impulses

  !> Copy impulses from the order back to the problem.
  pure subroutine give_impulses(order, problem)
    type(sweep_order_t), intent(in) :: order !! swept order
    type(problem_t), intent(inout) :: problem !! its impulses are set
    integer :: i

    do i = 1, order%n
      problem%impulse(:, order%contact(i)) = order%impulse(:, i)
    end do
  end subroutine give_impulses
end module sg_sweep_order
