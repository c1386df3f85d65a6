!> The order in which a sweep visits contacts, and their records copied into that order.
!!
!! In *groups* order the contacts of blocks are dealt to groups that the processor works on at once (sg_group_dealing,
!! doc/theory/nlgs.md). In *coloured* order that is done within each of the larger blocks that threads sweep side by side.
!! *Shuffled* order is random, for studies of what order does: a seed and the number of contacts give it, so that a run goes on
!! from a restart as it would have. Contacts that are open and stay so need not be visited at all: the order holds the ones chosen.
module sg_sweep_order
  use sg_contact_lanes, only: contact_lanes_t, fill_lanes
  use sg_convergence, only: looks_at_errors
  use sg_group_dealing, only: deal_blocks, deal_lanes
  use sg_kept_dealing, only: kept_dealing_t
  use sg_kinds, only: wp, i4, i8
  use sg_lists, only: reserve
  use sg_problem, only: problem_t
  use sg_random, only: random_t
  use sg_records, only: arm_frictional, ball_frictional, record_length, round_frictional, solid_frictional
  use sg_run_options, only: solver_options_t
  use sg_sweep_colouring, only: colour_blocks, sweep_colouring_t
  use sg_sweep_solid_order, only: begin_rows, deal_chains, fill_rows, reserve_rows, solid_lanes_t
  implicit none
  private
  public :: sweep_order_t, set_order, slack, update_order, refill_order

  !> An order is rebuilt when more than one over this many of its contacts are missing, or need no visit any more
  integer, parameter :: slack = 16

  !> Contacts in the order of the sweep
  type :: sweep_order_t
    !> Number of contacts that a sweep visits; and times that contacts were chosen or added
    integer :: n = 0, serial = 0
    !> Their indices in the problem
    integer(i4), allocatable :: contact(:)
    !> Slots, records and impulses in that order; not where contacts stand side by side, unless the criterion looks at them
    logical :: has_copies = .false.
    integer(i4), allocatable :: pair(:, :)
    real(wp), allocatable :: record(:, :), impulse(:, :)
    !> Groups of contacts of disks, of balls, or with arms in the plane, with friction, side by side
    type(contact_lanes_t) :: lanes
    !> Groups of pairs of solids with friction, side by side
    type(solid_lanes_t) :: solids
    !> Blocks that may be swept side by side, in coloured order; and by how many threads
    type(sweep_colouring_t) :: blocks
    integer :: threads = 1
    !> What `chosen` was dealt by, in groups and in coloured order; and was that of the problem before taken when it was set?
    type(kept_dealing_t) :: dealt
    logical :: has_last_groups = .false.
    !> Room for dealing: contacts chosen and missed, and groups of each body as bits
    integer(i4), allocatable :: chosen(:), missed(:)
    integer(i8), allocatable :: groups_of(:)
  end type sweep_order_t

contains

  !> Choose the order of the marked contacts and copy them into it.
  subroutine set_order(order, problem, is_wanted, options)
    type(sweep_order_t), intent(inout) :: order !! order to set
    type(problem_t), intent(in) :: problem !! problem to sweep
    logical, intent(in), contiguous :: is_wanted(:) !! which contacts to visit
    type(solver_options_t), intent(in) :: options !! order and threads; whether the criterion looks at records in their order
    logical :: is_done

    call make_room(order, problem, count(is_wanted(:problem%n_contacts)))
    order%has_last_groups = options%order == merge('coloured', 'groups  ', order%blocks%n > 0)
    if (order%has_last_groups) order%has_last_groups = order%dealt%holds(problem, is_wanted(:problem%n_contacts))
    order%serial = order%serial + 1
    order%lanes%n_groups = 0
    order%solids%n_groups = 0
    order%threads = options%threads
    if (order%has_last_groups) then
      call take_groups(order)
    else
      order%blocks%n = 0
      order%dealt%n = 0
      call choose(is_wanted(:problem%n_contacts), order%n, order%chosen)
      call put_in_order(order, problem, is_wanted(:problem%n_contacts), options)
    end if
    if (order%lanes%n_groups > 0) then
      call fill_lanes(order%lanes, problem, order%contact(:order%n), 1, 1, is_done)
      if (.not. is_done) order%lanes%n_groups = 0
    end if
    order%has_copies = order%lanes%n_groups + order%solids%n_groups == 0 .or. .not. looks_at_errors(options%criterion)
    call fill_others(order, problem)
  end subroutine set_order

  !> Put the chosen contacts in the order that the options ask for.
  pure subroutine put_in_order(order, problem, is_wanted, options)
    type(sweep_order_t), intent(inout) :: order
    type(problem_t), intent(in) :: problem
    logical, intent(in), contiguous :: is_wanted(:)
    type(solver_options_t), intent(in) :: options
    type(random_t) :: random

    select case (options%order)
    case ('natural')
      order%contact(:order%n) = order%chosen(:order%n)
    case ('shuffled')
      order%contact(:order%n) = order%chosen(:order%n)
      call random%seed(options%order_seed)
      call random%shuffle(order%contact(:order%n))
    case default
      call deal_all(order, problem, is_wanted, options%order == 'coloured')
    end select
  end subroutine put_in_order

  !> Copy slots, records and impulses of a problem to an order that holds its contacts already, however old its copies are.
  subroutine refill_order(order, problem, is_done)
    type(sweep_order_t), intent(inout) :: order !! its copies are set
    type(problem_t), intent(in) :: problem !! problem to sweep
    logical, intent(out) :: is_done !! not where a contact no longer fits beside others: the order must be set again

    is_done = .true.
    if (order%lanes%n_groups > 0) call fill_lanes(order%lanes, problem, order%contact(:order%n), 1, 1, is_done)
    if (is_done) call fill_others(order, problem)
  end subroutine refill_order

  !> Copies one by one, and rows of solids.
  subroutine fill_others(order, problem)
    type(sweep_order_t), intent(inout) :: order
    type(problem_t), intent(in) :: problem
    logical :: is_done

    if (order%has_copies) call fill_copies(order, problem, 1)
    if (order%solids%n_groups > 0) call fill_rows(problem, order%contact(:order%n), order%solids, 1, is_done)
  end subroutine fill_others

  !> List the marked contacts: without branches, and with room for one more.
  pure subroutine choose(is_wanted, n, chosen)
    logical, intent(in), contiguous :: is_wanted(:)
    integer, intent(out) :: n
    integer(i4), intent(inout), contiguous :: chosen(:)
    integer :: k

    n = 0
    do k = 1, size(is_wanted)
      chosen(n + 1) = int(k, i4)
      n = n + merge(1, 0, is_wanted(k))
    end do
  end subroutine choose

  !> Bring an order up to date with a new choice: where little has changed it stays, with the contacts that it missed at its end.
  !! An empty order is set.
  subroutine update_order(order, problem, is_wanted, is_ordered, options)
    type(sweep_order_t), intent(inout) :: order !! order to change; its impulses are those of the problem
    type(problem_t), intent(in) :: problem !! problem being swept
    logical, intent(in), contiguous :: is_wanted(:) !! which contacts to visit, shape (contacts)
    logical, intent(inout), contiguous :: is_ordered(:) !! which ones the order holds, shape (contacts)
    type(solver_options_t), intent(in) :: options !! those that the order was set with
    integer :: wanted, missed
    logical :: is_done

    if (order%n > 0) then
      call list_missed(is_wanted, is_ordered, order%missed, wanted, missed)
      if (wanted >= order%n - order%n/slack) then
        if (missed == 0) return
        if (missed <= order%n/slack .and. options%order == 'groups') then
          call append(order, problem, missed, is_done)
          if (is_done) is_ordered(order%missed(:missed)) = .true.
          if (is_done) return
        end if
      end if
    end if
    call set_order(order, problem, is_wanted, options)
    is_ordered = is_wanted
  end subroutine update_order

  !> List the marked contacts that an order does not hold, and count all marked ones: without branches, which contacts that open and
  !! close by turns would make slow.
  pure subroutine list_missed(is_wanted, is_ordered, list, wanted, missed)
    logical, intent(in), contiguous :: is_wanted(:), is_ordered(:)
    integer(i4), allocatable, intent(inout) :: list(:)
    integer, intent(out) :: wanted, missed
    integer :: k, n

    n = size(is_wanted)
    if (allocated(list)) then
      if (size(list) <= n) deallocate (list)
    end if
    if (.not. allocated(list)) allocate (list(n + n/8 + 1))
    wanted = 0
    missed = 0
    do k = 1, n
      list(missed + 1) = int(k, i4)
      wanted = wanted + merge(1, 0, is_wanted(k))
      missed = missed + merge(1, 0, is_wanted(k))*merge(0, 1, is_ordered(k))
    end do
  end subroutine list_missed

  !> Add the first contacts that were missed to groups of their own at the end of an order. What room there was must not matter: an
  !! order that goes on from a restart is the same.
  subroutine append(order, problem, missed, is_done)
    type(sweep_order_t), intent(inout) :: order
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: missed
    logical, intent(out) :: is_done !! not where a law has no place beside the others
    integer :: first, first_group, first_solid_group
    logical :: are_lanes

    first = order%n + 1
    first_group = order%lanes%n_groups + 1
    first_solid_group = order%solids%n_groups + 1
    are_lanes = order%lanes%n_groups > 0
    is_done = .true.
    order%serial = order%serial + 1
    order%n = order%n + missed
    call reserve_contacts(order, order%n + 1)
    order%chosen(first:order%n) = order%missed(:missed)
    ! Sizes of the groups dealt stay, for the next problem, also where this one has a law that these have no place for.
    if (.not. are_lanes) order%lanes%n_groups = order%dealt%groups(1)
    call deal(order, problem, first, order%n)
    if (.not. are_lanes) order%lanes%n_groups = 0
    if (order%has_copies) call fill_copies(order, problem, first)
    if (are_lanes) call fill_lanes(order%lanes, problem, order%contact(:order%n), first_group, first, is_done)
    if (order%solids%n_groups > 0) call fill_rows(problem, order%contact(:order%n), order%solids, first_solid_group, is_done)
  end subroutine append

  !> Room for more contacts, beside those of an order.
  subroutine reserve_contacts(order, n)
    type(sweep_order_t), intent(inout) :: order
    integer, intent(in) :: n

    call reserve(order%contact, n)
    call reserve(order%chosen, n)
    if (allocated(order%lanes%group_size)) call reserve(order%lanes%group_size, n)
    if (allocated(order%solids%last_row)) call reserve_rows(order%solids, n)
    if (.not. order%has_copies) return
    call reserve(order%pair, size(order%pair, 1), n)
    call reserve(order%record, size(order%record, 1), n)
    call reserve(order%impulse, size(order%impulse, 1), n)
  end subroutine reserve_contacts

  !> Room for the contacts wanted.
  pure subroutine make_room(order, problem, wanted)
    type(sweep_order_t), intent(inout) :: order
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: wanted
    integer :: n
    logical :: fits, have_lanes

    have_lanes = any(problem%kind == [round_frictional, arm_frictional, ball_frictional])
    fits = allocated(order%contact)
    if (fits) fits = size(order%contact) > wanted .and. size(order%groups_of) == problem%n_bodies
    if (fits) fits = allocated(order%lanes%group_size) .or. .not. have_lanes
    if (fits) return
    if (allocated(order%contact)) deallocate (order%contact, order%chosen, order%groups_of)
    n = wanted + wanted/8 + 1
    allocate (order%contact(n), order%chosen(n))
    order%dealt%n = 0
    allocate (order%groups_of(problem%n_bodies), source=0_i8)
    if (allocated(order%lanes%group_size)) deallocate (order%lanes%group_size)
    if (have_lanes) allocate (order%lanes%group_size(n))
  end subroutine make_room

  !> Copy slots, records and impulses one by one, from a first contact on.
  pure subroutine fill_copies(order, problem, first)
    type(sweep_order_t), intent(inout) :: order
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: first
    integer :: i, k, n

    if (allocated(order%pair)) then
      if (size(order%pair, 2) < order%n) deallocate (order%pair, order%record, order%impulse)
    end if
    if (.not. allocated(order%pair)) then
      n = order%n + order%n/8
      allocate (order%pair(2, n), order%record(size(problem%record, 1), n), order%impulse(size(problem%impulse, 1), n))
    end if
    associate (last => order%n, contact => order%contact, pair => problem%pair, record => problem%record, r => problem%impulse)
      if (problem%kind == round_frictional) then
        call copy_round(first, last, contact, pair, record, r, order%pair, order%record, order%impulse)
        return
      end if
      do i = first, last
        k = contact(i)
        order%pair(:, i) = pair(:, k)
        order%record(:, i) = record(:, k)
        order%impulse(:, i) = r(:, k)
      end do
    end associate
  end subroutine fill_copies

  !> The same for disks: a record of constant length is a few moves.
  pure subroutine copy_round(first, last, contact, pair, record, impulse, own_pair, own_record, own_impulse)
    integer, intent(in) :: first, last
    integer(i4), intent(in) :: contact(*), pair(2, *)
    real(wp), intent(in) :: record(record_length(round_frictional), *), impulse(2, *)
    integer(i4), intent(inout) :: own_pair(2, *)
    real(wp), intent(inout) :: own_record(record_length(round_frictional), *), own_impulse(2, *)
    integer :: i

    do i = first, last
      own_pair(:, i) = pair(:, contact(i))
      own_record(:, i) = record(:, contact(i))
      own_impulse(:, i) = impulse(:, contact(i))
    end do
  end subroutine copy_round

  !> Deal contacts to groups, all at once or within each coloured block.
  pure subroutine deal_all(order, problem, is_wanted, are_coloured)
    type(sweep_order_t), intent(inout) :: order
    type(problem_t), intent(in) :: problem
    logical, intent(in), contiguous :: is_wanted(:)
    logical, intent(in) :: are_coloured
    integer :: b

    if (problem%kind == solid_frictional) call begin_rows(order%solids, size(order%contact))
    if (are_coloured) call colour_blocks(order%blocks, problem%pair, order%groups_of, order%chosen(:order%n))
    if (order%blocks%n == 0) call deal(order, problem, 1, order%n)
    do b = 1, order%blocks%n
      call deal(order, problem, order%blocks%last(b - 1) + 1, order%blocks%last(b))
      order%blocks%last_group(b) = order%lanes%n_groups
      order%blocks%last_solid_group(b) = order%solids%n_groups
      order%blocks%last_row(b) = order%solids%n_rows
    end do
    call order%dealt%note(problem, is_wanted, [order%lanes%n_groups, order%solids%n_groups, order%solids%n_rows])
  end subroutine deal_all

  !> Take the groups of the last dealing, without those that were added to them.
  pure subroutine take_groups(order)
    type(sweep_order_t), intent(inout) :: order

    order%n = order%dealt%n
    order%lanes%n_groups = order%dealt%groups(1)
    order%solids%n_groups = order%dealt%groups(2)
    order%solids%n_rows = order%dealt%groups(3)
  end subroutine take_groups

  !> Deal a run of contacts to groups, block by block.
  pure subroutine deal(order, problem, begin, end)
    type(sweep_order_t), intent(inout) :: order
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: begin, end

    select case (problem%kind)
    case (solid_frictional)
      call deal_chains(order%chosen(begin:end), problem, order%groups_of, order%contact(begin:end), order%solids)
    case (round_frictional)
      call deal_blocks(order%chosen(begin:end), problem, order%groups_of, order%contact(begin:end), order%lanes%n_groups, &
                       order%lanes%group_size)
    case (arm_frictional, ball_frictional)
      call deal_lanes(order%chosen(begin:end), problem, order%groups_of, order%contact(begin:end), order%lanes%n_groups, &
                      order%lanes%group_size)
    case default
      call deal_blocks(order%chosen(begin:end), problem, order%groups_of, order%contact(begin:end))
    end select
  end subroutine deal
end module sg_sweep_order
