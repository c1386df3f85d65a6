!> Contacts cut into blocks, and the blocks coloured: no two blocks of one colour touch the same body, so that threads may sweep
!! them side by side, and the result depends on no number of threads (doc/theory/nlgs.md).
!!
!! Bodies that many blocks touch (walls) would need as many colours: their contacts come in blocks of their own, after all
!! others. Bodies that nothing moves count like all others: threads do not even write the same value to the same place.
module sg_sweep_colouring
  use sg_kinds, only: i4, i8
  use sg_sorting, only: group_items
  implicit none
  private
  public :: sweep_colouring_t, colour_blocks

  !> Blocks of a large problem per colour and their size in contacts. Small blocks fill a colour with work for many threads,
  !! large ones keep the spatial order and lanes full.
  integer, parameter :: wanted_blocks = 128, least_size = 256, most_size = 2048
  !> Blocks of a smaller problem, and one more of contacts between them: threads would wait too often for more
  integer, parameter :: few_blocks = 4
  !> Blocks that may touch a body before it counts as a wall
  integer, parameter :: most_touching = 8
  !> Colours that bodies keep account of (bits of an integer)
  integer, parameter :: most_colours = 63

  !> Blocks, colour by colour
  type :: sweep_colouring_t
    !> Number of blocks; none where sweeps have no colours
    integer :: n = 0
    !> Number of colours
    integer :: n_colours = 0
    !> Last contact, last group of balls, last group and last row of solids of each block; the first place, 0, is zero
    integer, allocatable :: last(:), last_group(:), last_solid_group(:), last_row(:)
    !> Last block of each colour; the first place, 0, is zero
    integer, allocatable :: last_of_colour(:)
  end type sweep_colouring_t

contains

  !> Cut contacts into coloured blocks, and bring them into their order.
  pure subroutine colour_blocks(blocks, pair, colours_of, chosen)
    type(sweep_colouring_t), intent(inout) :: blocks !! blocks to make
    integer(i4), intent(in), contiguous :: pair(:, :) !! slots of all contacts
    integer(i8), intent(inout) :: colours_of(:) !! room, by slot; zero before and after
    integer(i4), intent(inout), contiguous :: chosen(:) !! contacts to sweep in spatial order; then block by block
    integer, allocatable :: last(:), last_of_walls(:), colour(:)
    integer :: n_inner

    if (size(chosen) > 0 .and. size(chosen) < wanted_blocks*least_size) then
      call cut_bodies(blocks, pair, chosen)
      return
    end if
    call cut(pair, chosen, last)
    call put_walls_last(pair, last, chosen, n_inner)
    if (n_inner < size(chosen)) then
      call cut(pair, chosen(:n_inner), last)
      call cut(pair, chosen(n_inner + 1:), last_of_walls)
      last = [last, n_inner + last_of_walls(2:)]
    end if
    blocks%n = size(last) - 1
    call choose_colours(pair, chosen, last, colours_of, colour, blocks%n_colours)
    call arrange(blocks, last, colour, chosen)
  end subroutine colour_blocks

  !> Cut the bodies into few parts with as many contacts each: contacts within parts are blocks of the first colour, those
  !! between parts one block of the second. Bodies that nothing moves belong to a part, too: most contacts of walls are of the
  !! second colour.
  pure subroutine cut_bodies(blocks, pair, chosen)
    type(sweep_colouring_t), intent(inout) :: blocks
    integer(i4), intent(in), contiguous :: pair(:, :)
    integer(i4), intent(inout), contiguous :: chosen(:)
    integer, allocatable :: part(:), block_of(:), first(:), place(:)
    integer :: i, b

    call find_parts(pair, chosen, part)
    allocate (block_of(size(chosen)))
    do i = 1, size(chosen)
      associate (c => part(pair(1, chosen(i))), a => part(pair(2, chosen(i))))
        block_of(i) = merge(c, few_blocks + 1, c == a)
      end associate
    end do
    call group_items(block_of, few_blocks + 1, first, place)
    chosen(:) = chosen(place)
    call make_room(blocks, few_blocks + 1, 2)
    do b = 1, few_blocks + 1
      blocks%last(b) = first(b + 1) - 1
    end do
    blocks%last_of_colour(1:2) = [few_blocks, few_blocks + 1]
  end subroutine cut_bodies

  !> Part of each slot: slots stand in spatial order.
  pure subroutine find_parts(pair, chosen, part)
    integer(i4), intent(in), contiguous :: pair(:, :), chosen(:)
    integer, allocatable, intent(out) :: part(:)
    integer :: i, slot, before, here

    allocate (part(maxval(pair(:, chosen))), source=0)
    do i = 1, size(chosen)
      part(pair(1, chosen(i))) = part(pair(1, chosen(i))) + 1
    end do
    before = 0
    do slot = 1, size(part)
      here = part(slot)
      part(slot) = min(few_blocks, 1 + int(int(few_blocks, i8)*int(before, i8)/int(size(chosen), i8)))
      before = before + here
    end do
  end subroutine find_parts

  !> Cut a list of contacts into blocks of about one size, never between contacts of one pair.
  pure subroutine cut(pair, chosen, last)
    integer(i4), intent(in), contiguous :: pair(:, :), chosen(:)
    integer, allocatable, intent(out) :: last(:) !! last contact of each block, after a zero
    integer :: n, b, i, wanted, length

    length = max(least_size, min(most_size, size(chosen)/wanted_blocks))
    wanted = (size(chosen) + length - 1)/length
    allocate (last(wanted + 1), source=0)
    n = 1
    do b = 1, wanted
      i = max(int(int(size(chosen), i8)*int(b, i8)/int(wanted, i8)), last(n) + 1)
      if (i > size(chosen)) exit
      do while (i < size(chosen))
        if (any(pair(:, chosen(i)) /= pair(:, chosen(i + 1)))) exit
        i = i + 1
      end do
      n = n + 1
      last(n) = i
    end do
    last = last(:n)
  end subroutine cut

  !> Put contacts of bodies that many blocks touch behind the others.
  pure subroutine put_walls_last(pair, last, chosen, n_inner)
    integer(i4), intent(in), contiguous :: pair(:, :)
    integer, intent(in) :: last(:)
    integer(i4), intent(inout), contiguous :: chosen(:)
    integer, intent(out) :: n_inner !! contacts of other bodies
    integer, allocatable :: seen(:), touching(:)
    logical, allocatable :: is_inner(:)
    integer :: b, i, side, slot, slots

    n_inner = size(chosen)
    if (size(last) - 1 <= most_touching) return
    slots = maxval(pair(:, chosen))
    allocate (seen(slots), touching(slots), source=0)
    do b = 1, size(last) - 1
      do i = last(b) + 1, last(b + 1)
        do side = 1, 2
          slot = pair(side, chosen(i))
          if (seen(slot) /= b) touching(slot) = touching(slot) + 1
          seen(slot) = b
        end do
      end do
    end do
    allocate (is_inner(size(chosen)))
    do i = 1, size(chosen)
      is_inner(i) = all(touching(pair(:, chosen(i))) <= most_touching)
    end do
    n_inner = count(is_inner)
    chosen(:) = [pack(chosen, is_inner), pack(chosen, .not. is_inner)]
  end subroutine put_walls_last

  !> Give each block the colour with the fewest blocks of those that none of its bodies has yet; where no colour is left, one
  !! that it shares with none.
  pure subroutine choose_colours(pair, chosen, last, colours_of, colour, n_colours)
    integer(i4), intent(in), contiguous :: pair(:, :), chosen(:)
    integer, intent(in) :: last(:)
    integer(i8), intent(inout) :: colours_of(:)
    integer, allocatable, intent(out) :: colour(:) !! of each block, from 1
    integer, intent(out) :: n_colours
    integer :: filled(most_colours), b, c, i
    integer(i8) :: taken

    n_colours = 0
    filled = 0
    allocate (colour(size(last) - 1))
    do b = 1, size(colour)
      taken = 0
      do i = last(b) + 1, last(b + 1)
        taken = ior(taken, ior(colours_of(pair(1, chosen(i))), colours_of(pair(2, chosen(i)))))
      end do
      colour(b) = n_colours + 1
      do c = 1, min(n_colours, most_colours)
        if (btest(taken, c - 1)) cycle
        if (colour(b) <= n_colours) then
          if (filled(c) >= filled(colour(b))) cycle
        end if
        colour(b) = c
      end do
      n_colours = max(n_colours, colour(b))
      if (colour(b) > most_colours) cycle
      filled(colour(b)) = filled(colour(b)) + 1
      do i = last(b) + 1, last(b + 1)
        colours_of(pair(:, chosen(i))) = ibset(colours_of(pair(:, chosen(i))), colour(b) - 1)
      end do
    end do
    do i = 1, size(chosen)
      colours_of(pair(:, chosen(i))) = 0
    end do
  end subroutine choose_colours

  !> Put blocks in the order of their colours, those of one colour in spatial order.
  pure subroutine arrange(blocks, last, colour, chosen)
    type(sweep_colouring_t), intent(inout) :: blocks
    integer, intent(in) :: last(:), colour(:)
    integer(i4), intent(inout), contiguous :: chosen(:)
    integer(i4), allocatable :: arranged(:)
    integer, allocatable :: first(:), place(:)
    integer :: b, n

    call make_room(blocks, blocks%n, blocks%n_colours)
    call group_items(colour(:blocks%n), blocks%n_colours, first, place)
    blocks%last_of_colour(:) = first - 1
    allocate (arranged(size(chosen)))
    do b = 1, blocks%n
      n = last(place(b) + 1) - last(place(b))
      arranged(blocks%last(b - 1) + 1:blocks%last(b - 1) + n) = chosen(last(place(b)) + 1:last(place(b) + 1))
      blocks%last(b) = blocks%last(b - 1) + n
    end do
    chosen(:) = arranged
  end subroutine arrange

  !> Room for so many blocks and colours.
  pure subroutine make_room(blocks, n, n_colours)
    type(sweep_colouring_t), intent(inout) :: blocks
    integer, intent(in) :: n, n_colours

    blocks%n = n
    blocks%n_colours = n_colours
    if (allocated(blocks%last)) deallocate (blocks%last, blocks%last_group, blocks%last_solid_group, blocks%last_row, &
                                            blocks%last_of_colour)
    allocate (blocks%last(0:n), blocks%last_group(0:n), blocks%last_solid_group(0:n), blocks%last_row(0:n), &
              blocks%last_of_colour(0:n_colours), source=0)
  end subroutine make_room
end module sg_sweep_colouring
