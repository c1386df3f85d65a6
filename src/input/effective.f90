!> The effective deck: all that a run was asked to do, defaults filled in, as a deck that can be read again.
module sg_effective
  use sg_blocks, only: deck_t
  use sg_kinds, only: i8
  use sg_values, only: from_nowhere, value_as_toml, value_t
  implicit none
  private
  public :: effective_deck, fingerprint

contains

  !> Text of the effective deck, one key a line.
  subroutine effective_deck(deck, text, hash)
    type(deck_t), intent(in) :: deck !! checked deck
    character(len=:), allocatable, intent(out) :: text !! its text
    character(len=:), allocatable, intent(out) :: hash !! fingerprint of the text behind its title
    character(len=:), allocatable :: room
    integer :: length, top, s, b, stage

    allocate (character(len=4096) :: room)
    length = 0
    top = 0
    stage = 0
    do s = 1, size(deck%table%sections)
      if (index(deck%table%sections(s)%name, '.') > 0) cycle
      do b = 1, deck%n
        if (deck%blocks(b)%section /= s .or. deck%table%sections(s)%last < deck%table%sections(s)%first) cycle
        call write_block(deck, b, room, length)
        if (deck%table%sections(s)%name /= 'stage') cycle
        stage = stage + 1
        call write_changes(deck, stage, room, length)
      end do
      if (deck%table%sections(s)%name == '') top = length
    end do
    text = room(:length)
    ! A blank line follows the title.
    hash = fingerprint(text(top + merge(2, 1, top > 0):))
  end subroutine effective_deck

  !> Write one block and the blocks within.
  recursive subroutine write_block(deck, b, room, length)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b
    character(len=:), allocatable, intent(inout) :: room
    integer, intent(inout) :: length
    type(value_t) :: value
    integer :: k, inner

    associate (section => deck%table%sections(deck%blocks(b)%section))
      if (length > 0) call write_line('', room, length)
      if (section%name /= '') call write_line(deck%heading(deck%blocks(b)%section), room, length)
      do k = section%first, section%last
        associate (key => deck%table%keys(k))
          value = deck%value(b, trim(key%name))
          if (value%origin == from_nowhere .or. .not. deck%applies(b, key)) cycle
          call write_line(trim(key%name)//' = '//value_as_toml(value, key), room, length)
        end associate
      end do
    end associate
    do inner = b + 1, deck%n
      if (deck%blocks(inner)%parent /= b) exit
      call write_block(deck, inner, room, length)
    end do
  end subroutine write_block

  !> Write what a stage changes: the keys that are given.
  subroutine write_changes(deck, stage, room, length)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: stage
    character(len=:), allocatable, intent(inout) :: room
    integer, intent(inout) :: length
    character(len=:), allocatable :: heading
    integer :: c, v, cut

    do c = 1, size(deck%changes)
      if (deck%changes(c)%parent /= stage) cycle
      heading = deck%heading(deck%changes(c)%section)
      cut = merge(2, 1, heading(:2) == '[[')
      call write_line('', room, length)
      call write_line(heading(:cut)//'stage.'//heading(cut + 1:), room, length)
      do v = 1, deck%changes(c)%n
        associate (value => deck%changes(c)%values(v), key => deck%table%keys(deck%changes(c)%values(v)%key))
          call write_line(trim(key%name)//' = '//value_as_toml(value, key), room, length)
        end associate
      end do
    end do
  end subroutine write_changes

  !> Add a line to a text that grows by doubling.
  subroutine write_line(line, room, length)
    character(len=*), intent(in) :: line
    character(len=:), allocatable, intent(inout) :: room
    integer, intent(inout) :: length
    character(len=:), allocatable :: grown
    integer :: wanted

    wanted = length + len(line) + 1
    if (wanted > len(room)) then
      allocate (character(len=2*wanted) :: grown)
      grown(:length) = room(:length)
      call move_alloc(grown, room)
    end if
    room(length + 1:wanted) = line//new_line('a')
    length = wanted
  end subroutine write_line

  !> Hash of a text, 16 hexadecimal digits: FNV-1a with 64 bits, in halves of 32 bits that cannot overflow.
  pure function fingerprint(text) result(digits)
    character(len=*), intent(in) :: text !! text to hash
    character(len=16) :: digits
    integer(i8), parameter :: half = 4294967296_i8
    integer(i8) :: high, low, product
    integer :: i

    ! Offset basis cbf29ce484222325; the prime is 2**40 + 435.
    high = 3421674724_i8
    low = 2216829733_i8
    do i = 1, len(text)
      low = ieor(low, int(iachar(text(i:i)), i8))
      product = low*435
      high = modulo(high*435 + product/half + modulo(low*256, half), half)
      low = modulo(product, half)
    end do
    write (digits, '(2z8.8)') high, low
  end function fingerprint
end module sg_effective
