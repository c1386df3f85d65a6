!> Contacts dealt to groups in which no movable body appears twice.
!!
!! Consecutive contacts of the spatial order share bodies, and the chain of dependent updates limits a sweep. So blocks of
!! consecutive contacts, small enough to stay in cache, are dealt to small groups: the processor then works on several contacts at
!! once, and the order of the blocks stays spatial (doc/theory/nlgs.md).
module sg_group_dealing
  use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t
  use sg_kinds, only: i4, i8
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse, is_compact
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

  interface
    !> Deal one block: each contact goes to the first group that has room and neither of its movable bodies (group_dealing.cpp).
    pure subroutine deal_block(n, chosen, length, inverse, width, pair, body, groups_of, group, filled, top) &
      bind(c, name='sg_deal_block')
      import :: c_double, c_int, c_int64_t
      integer(c_int), intent(in), value :: n !! contacts of the block
      integer(c_int), intent(in) :: chosen(*) !! which ones
      integer(c_int), intent(in), value :: length !! reals of a body
      integer(c_int), intent(in), value :: inverse !! place of its first inverse mass
      integer(c_int), intent(in), value :: width !! contacts of a full group
      integer(c_int), intent(in) :: pair(*) !! slots of all contacts
      real(c_double), intent(in) :: body(*) !! records of bodies
      integer(c_int64_t), intent(inout) :: groups_of(*) !! room, by slot; zero before and after
      integer(c_int), intent(inout) :: group(*) !! group of each contact
      integer(c_int), intent(inout) :: filled(0:*) !! contacts of each group
      integer(c_int), intent(out) :: top !! last group with some
    end subroutine deal_block
  end interface

contains

  !> Deal contacts to groups, block by block. Where they are swept side by side, groups are counted.
  pure subroutine deal_blocks(chosen, problem, groups_of, contact, n_groups, group_size)
    integer(i4), intent(in), contiguous :: chosen(:) !! contacts to deal, in spatial order
    type(problem_t), intent(in) :: problem !! problem to sweep
    integer(i8), intent(inout), contiguous :: groups_of(:) !! room, by slot; zero before and after
    integer(i4), intent(inout), contiguous :: contact(:) !! the same contacts, group by group
    integer, intent(inout), optional :: n_groups !! groups so far
    integer(i4), intent(inout), contiguous, optional :: group_size(:) !! contacts of each
    logical, parameter :: are_first(0:most_groups) = .true.
    integer :: first, last, block_size, width, g, top, n, filled(0:most_groups), group(block_round)

    block_size = block_arm
    width = width_arm
    if (is_compact(problem%kind)) then
      block_size = block_round
      width = width_round
    end if
    do first = 1, size(chosen), block_size
      last = min(size(chosen), first + block_size - 1)
      n = last - first + 1
      call deal_block(n, chosen(first:last), size(problem%body, 1), first_inverse(problem%kind), width, problem%pair, &
                      problem%body, groups_of, group, filled, top)
      call spread_groups(n, chosen(first:last), group, top, filled, are_first, contact(first:last))
      if (.not. present(n_groups)) cycle
      do g = 0, top
        call note_group(filled(g), g == most_groups, n_groups, group_size)
      end do
    end do
  end subroutine deal_blocks

  !> The same for groups side by side, in which lanes to spare cost as much as contacts: groups that a block leaves open are
  !! dealt again with the next one.
  pure subroutine deal_lanes(chosen, problem, groups_of, contact, n_groups, group_size)
    integer(i4), intent(in), contiguous :: chosen(:) !! contacts to deal, in spatial order
    type(problem_t), intent(in) :: problem !! problem to sweep
    integer(i8), intent(inout), contiguous :: groups_of(:) !! room, by slot; zero before and after
    integer(i4), intent(inout), contiguous :: contact(:) !! the same contacts, group by group
    integer, intent(inout) :: n_groups !! groups so far
    integer(i4), intent(inout), contiguous :: group_size(:) !! contacts of each
    integer(i4) :: block(block_round)
    integer :: group(block_round), filled(0:most_groups), next, placed, left, n, g, top, size_of_block
    logical :: is_kept(0:most_groups)

    size_of_block = merge(block_round, block_arm_lanes, is_compact(problem%kind))
    next = 1
    placed = 0
    left = 0
    do while (next <= size(chosen))
      n = min(size_of_block, left + size(chosen) - next + 1)
      block(left + 1:n) = chosen(next:next + n - left - 1)
      next = next + n - left
      call deal_block(n, block, size(problem%body, 1), first_inverse(problem%kind), lanes, problem%pair, problem%body, &
                      groups_of, group, filled, top)
      is_kept(:top) = filled(:top) == lanes
      if (top == most_groups) is_kept(top) = .false.
      ! Where few groups are full, as about a large ball, dealing again would not help.
      if (next > size(chosen) .or. sum(filled(:top), .not. is_kept(:top)) > size_of_block/4) is_kept(:top) = .true.
      call spread_groups(n, block, group, top, filled, is_kept, contact(placed + 1:placed + n))
      do g = 0, top
        if (is_kept(g)) call note_group(filled(g), g == most_groups, n_groups, group_size)
      end do
      left = sum(filled(:top), .not. is_kept(:top))
      placed = placed + n - left
      block(:left) = contact(placed + 1:placed + left)
    end do
  end subroutine deal_lanes

  !> Write the groups of a block one after the other, some before the others.
  pure subroutine spread_groups(n, chosen, group, top, filled, are_first, contact)
    integer, intent(in) :: n
    integer(i4), intent(in) :: chosen(n)
    integer, intent(in) :: group(n), top, filled(0:top) !! contacts of each group up to the last one
    logical, intent(in) :: are_first(0:top) !! groups that come first
    integer(i4), intent(inout) :: contact(n)
    integer :: next(0:most_groups), i, first, other

    first = 1
    other = 1 + sum(filled, are_first)
    do i = 0, top
      next(i) = merge(first, other, are_first(i))
      first = first + merge(filled(i), 0, are_first(i))
      other = other + merge(0, filled(i), are_first(i))
    end do
    do i = 1, n
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
