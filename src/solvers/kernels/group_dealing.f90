!> Contacts dealt to groups in which no movable body appears twice.
!!
!! Consecutive contacts of the spatial order share bodies, and the chain of dependent updates limits a sweep. So blocks of
!! consecutive contacts, small enough to stay in cache, are dealt to small groups: the processor then works on several contacts at
!! once, and the order of the blocks stays spatial (doc/theory/nlgs.md).
module sg_group_dealing
  use sg_kept_dealing, only: is_movable
  use sg_kinds, only: i4, i8
  use sg_problem, only: problem_t
  use sg_records, only: is_compact
  implicit none
  private
  public :: deal_blocks, deal_lanes, lanes

  !> Contacts of a group that balls, and shapes with arms in the plane, are swept by in vector registers where there is friction
  integer, parameter :: lanes = 8

  !> Contacts of a group and of a block, for round problems and for problems with arms; and of a block of these in lanes.
  !!
  !! Larger ones overlap more updates, smaller ones keep the spatial order better. Polygons pay for lost order: with
  !! the sizes of disks they need half as many sweeps again (doc/performance.md).
  integer, parameter :: width_round = 8, block_round = 256, width_arm = 4, block_arm = 32, block_arm_lanes = 64
  !> The most groups that a block may open (bits of an integer)
  integer, parameter :: most_groups = 63

contains

  !> Deal contacts to groups, block by block. Where they are swept side by side, groups are counted.
  pure subroutine deal_blocks(chosen, problem, groups_of, contact, n_groups, group_size)
    integer(i4), intent(in), contiguous :: chosen(:) !! contacts to deal, in spatial order
    type(problem_t), intent(in) :: problem !! problem to sweep
    integer(i8), intent(inout) :: groups_of(:) !! room, by slot; zero before and after
    integer(i4), intent(inout), contiguous :: contact(:) !! the same contacts, group by group
    integer, intent(inout), optional :: n_groups !! groups so far
    integer(i4), intent(inout), contiguous, optional :: group_size(:) !! contacts of each
    integer :: first, last, block_size, width, g, filled(0:most_groups)

    block_size = block_arm
    width = width_arm
    if (is_compact(problem%kind)) then
      block_size = block_round
      width = width_round
    end if
    do first = 1, size(chosen), block_size
      last = min(size(chosen), first + block_size - 1)
      call deal_block(chosen(first:last), problem, width, groups_of, contact(first:last), filled)
      if (.not. present(n_groups)) cycle
      do g = 0, most_groups
        call note_group(filled(g), g == most_groups, n_groups, group_size)
      end do
    end do
  end subroutine deal_blocks

  !> The same for groups side by side, in which lanes to spare cost as much as contacts: groups that a block leaves open are
  !! dealt again with the next one.
  pure subroutine deal_lanes(chosen, problem, groups_of, contact, n_groups, group_size)
    integer(i4), intent(in), contiguous :: chosen(:) !! contacts to deal, in spatial order
    type(problem_t), intent(in) :: problem !! problem to sweep
    integer(i8), intent(inout) :: groups_of(:) !! room, by slot; zero before and after
    integer(i4), intent(inout), contiguous :: contact(:) !! the same contacts, group by group
    integer, intent(inout) :: n_groups !! groups so far
    integer(i4), intent(inout), contiguous :: group_size(:) !! contacts of each
    integer(i4) :: block(block_round), dealt(block_round)
    integer :: filled(0:most_groups), next, placed, left, n, last, g, size_of_block
    logical :: is_kept(0:most_groups)

    size_of_block = merge(block_round, block_arm_lanes, is_compact(problem%kind))
    next = 1
    placed = 0
    left = 0
    do while (next <= size(chosen))
      n = min(size_of_block, left + size(chosen) - next + 1)
      block(left + 1:n) = chosen(next:next + n - left - 1)
      next = next + n - left
      call deal_block(block(:n), problem, lanes, groups_of, dealt(:n), filled)
      is_kept = filled == lanes
      is_kept(most_groups) = .false.
      ! Where few groups are full, as about a large ball, dealing again would not help.
      if (next > size(chosen) .or. sum(filled, .not. is_kept) > size_of_block/4) is_kept = .true.
      left = 0
      last = 0
      do g = 0, most_groups
        associate (group => dealt(last + 1:last + filled(g)))
          if (is_kept(g)) then
            contact(placed + 1:placed + filled(g)) = group
            placed = placed + filled(g)
            call note_group(filled(g), g == most_groups, n_groups, group_size)
          else
            block(left + 1:left + filled(g)) = group
            left = left + filled(g)
          end if
        end associate
        last = last + filled(g)
      end do
    end do
  end subroutine deal_lanes

  !> Deal one block: each contact goes to the first group that has room and neither of its movable bodies.
  pure subroutine deal_block(chosen, problem, width, groups_of, contact, filled)
    integer(i4), intent(in), contiguous :: chosen(:)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: width
    integer(i8), intent(inout) :: groups_of(:) !! bit g: the body is in group g of this block
    integer(i4), intent(inout), contiguous :: contact(:)
    integer, intent(out) :: filled(0:most_groups) !! contacts of each group
    integer(i8) :: full
    integer :: group(block_round), i, g, side
    integer(i4) :: pair(2)

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
        if (is_movable(problem, pair(side))) groups_of(pair(side)) = ibset(groups_of(pair(side)), g)
      end do
    end do
    call spread_groups(chosen, group, filled, contact)
    ! One by one: a list of two would be rebuilt for each contact.
    do i = 1, size(chosen)
      groups_of(problem%pair(1, chosen(i))) = 0
      groups_of(problem%pair(2, chosen(i))) = 0
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

  !> Note the next groups: of the last group of a block any number may have come together, in no order.
  pure subroutine note_group(filled, is_last, n_groups, group_size)
    integer, intent(in) :: filled
    logical, intent(in) :: is_last
    integer, intent(inout) :: n_groups
    integer(i4), intent(inout), contiguous :: group_size(:)
    integer :: left, n

    left = filled
    do while (left > 0)
      n = merge(1, min(left, lanes), is_last)
      n_groups = n_groups + 1
      group_size(n_groups) = int(n, i4)
      left = left - n
    end do
  end subroutine note_group
end module sg_group_dealing
