!> A unit of a scene, repeated along a shift: `[repeat]` copies bodies, samples and regions, and lengthens containers.
!!
!! Copy k of a body or region named "x" is "x.k", shifted by (k - 1) times the shift; copies of a sample draw other grains. The deck
!! that a run reports is the one that was written, with its one unit.
module sg_repeat_blocks
  use sg_blocks, only: block_t, deck_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp
  use sg_text, only: to_text
  use sg_values, only: value_t
  implicit none
  private
  public :: repeat_blocks

  !> By which the seeds of copies of a sample differ: a prime, so that they meet no seeds that a user counts up
  real(wp), parameter :: seed_step = 7919
  !> Sections of which each block is copied with all that stands within it
  character(len=6), parameter :: copied(3) = [character(len=6) :: 'body', 'sample', 'region']

contains

  !> Repeat what a checked deck asks to repeat.
  subroutine repeat_blocks(deck, diagnostics)
    type(deck_t), intent(inout) :: deck !! deck, or that of a stage
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    real(wp), allocatable :: shift(:)
    integer :: b, n, k, count

    b = deck%block_of('repeat')
    if (.not. deck%is_given(b, 'count')) return
    count = deck%integer(b, 'count')
    if (deck%is_given(deck%block_of('scene'), 'datbox')) then
      call deck%complain(diagnostics, 'a DATBOX cannot be repeated', b, 'count')
    else if (.not. deck%is_given(b, 'shift')) then
      call deck%complain(diagnostics, 'what is repeated needs a "shift"', b, 'count')
    end if
    if (diagnostics%count() > 0 .or. count == 1) return
    shift = deck%vector(b, 'shift')
    n = deck%n
    do k = 2, count
      do b = 1, n
        if (is_copied(deck, b)) call copy_block(deck, b, n, k, shift)
      end do
    end do
    do b = 1, n
      if (deck%is_in(b, 'container')) &
        call deck%give_numbers(b, 'size', deck%vector(b, 'size') + real(count - 1, wp)*abs(shift))
    end do
  end subroutine repeat_blocks

  !> Is a block one that is copied?
  pure logical function is_copied(deck, b)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    integer :: i

    is_copied = any([(deck%is_in(b, trim(copied(i))), i=1, size(copied))])
  end function is_copied

  !> Add copy k of a block, and of the blocks that stand within it, all among the first n.
  subroutine copy_block(deck, b, n, k, shift)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: b, n, k
    real(wp), intent(in) :: shift(:)
    type(value_t) :: value
    real(wp) :: seed
    integer :: place, inner

    call add_copy(deck, b, deck%blocks(b)%parent)
    place = deck%n
    call shift_numbers(deck, place, 'position', real(k - 1, wp)*shift)
    call shift_numbers(deck, place, 'box', real(k - 1, wp)*[shift, shift])
    if (deck%is_given(b, 'name')) then
      value = deck%value(b, 'name')
      value%words(1)%s = value%words(1)%s//'.'//to_text(k)
      call deck%put(place, value)
    end if
    if (deck%is_in(b, 'sample')) then
      seed = real(deck%integer(b, 'seed'), wp) + seed_step*real(k - 1, wp)
      call deck%give_numbers(place, 'seed', [modulo(seed, real(huge(1), wp))])
    end if
    do inner = b + 1, n
      if (deck%blocks(inner)%parent == b) call add_copy(deck, inner, place)
    end do
  end subroutine copy_block

  !> Shift the numbers of a key that the block has.
  subroutine shift_numbers(deck, b, name, shift)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: b
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: shift(:)
    type(value_t) :: value

    if (deck%table%find_key(deck%blocks(b)%section, name) == 0) return
    value = deck%value(b, name)
    if (value%n /= size(shift)) return
    value%numbers(:value%n) = value%numbers(:value%n) + shift
    call deck%put(b, value)
  end subroutine shift_numbers

  !> Add a copy of a block, within another or none.
  subroutine add_copy(deck, b, parent)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: b, parent
    type(block_t) :: copy

    copy = deck%blocks(b)
    copy%parent = parent
    call deck%add_block(copy)
  end subroutine add_copy
end module sg_repeat_blocks
