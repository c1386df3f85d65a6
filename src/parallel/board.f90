!> Shared memory of the subdomains of one process: rounds, in which each brings its contribution and takes the result, and letters
!! from one to another.
!!
!! Two slots take turns: a subdomain may begin a round while others still read the result of the last one, and no sooner than all
!! have come to a round can the next but one begin. Dummies are targets, as others change them during a wait.
module sg_board
  use sg_coroutines, only: note_progress, yield
  use sg_kinds, only: i1, i8, wp
  implicit none
  private
  public :: board_t, brought_t, slot_t

  !> Contributions and result of a round
  type :: slot_t
    !> Bytes, of which each subdomain fills its own, and in the end the result
    integer(i1), allocatable :: bytes(:)
    !> Reals of a swap for each subdomain here, from all: those from r begin after the first `first(r, here)`
    real(wp), allocatable :: values(:)
    integer, allocatable :: first(:, :), counts(:, :)
  end type slot_t

  !> What one subdomain brings to a swap
  type :: brought_t
    real(wp), allocatable :: values(:)
    integer, allocatable :: counts(:)
  end type brought_t

  !> Items on their way, from which subdomain, and their number among all that it sent to this one
  type :: letter_t
    integer :: from = 0
    integer(i8) :: number = 0
    real(wp), allocatable :: items(:, :)
  end type letter_t

  !> Letters that wait for a subdomain
  type :: box_t
    integer :: n = 0
    type(letter_t), allocatable :: letters(:)
  end type box_t

  !> The board of a process
  type :: board_t
    !> Subdomains of this process
    integer :: n = 0
    !> Rounds done, and how many have come to the next one
    integer :: round = 0, arrived = 0
    !> Rounds, even and odd ones; what each brings to a swap, shape (0:n-1)
    type(slot_t) :: slots(0:1)
    type(brought_t), allocatable :: brought(:)
    !> Letters for each, and how many were sent and are expected, shape (from, to), both from 0
    type(box_t), allocatable, private :: boxes(:)
    integer(i8), allocatable, private :: sent(:, :), expected(:, :)
  contains
    procedure :: open => board_open
    procedure :: arrive => board_arrive
    procedure :: is_complete => board_is_complete
    procedure :: release => board_release
    procedure :: wait => board_wait
    procedure :: post => board_post
    procedure :: expect => board_expect
    procedure :: take => board_take
  end type board_t

contains

  !> Make the board of so many subdomains.
  subroutine board_open(self, n)
    class(board_t), intent(inout), target :: self
    integer, intent(in) :: n !! subdomains of this process

    self%n = n
    allocate (self%brought(0:n - 1), self%boxes(0:n - 1))
    allocate (self%sent(0:n - 1, 0:n - 1), self%expected(0:n - 1, 0:n - 1), source=0_i8)
  end subroutine board_open

  !> Come to the next round: its slot is that of the parity of `turn`.
  integer function board_arrive(self, bytes) result(turn)
    class(board_t), intent(inout), target :: self
    integer, intent(in) :: bytes !! room in the slot, the same for all

    turn = self%round
    associate (slot => self%slots(modulo(turn, 2)))
      if (self%arrived == 0) then
        if (allocated(slot%bytes)) then
          if (size(slot%bytes) /= bytes) deallocate (slot%bytes)
        end if
        if (.not. allocated(slot%bytes)) allocate (slot%bytes(bytes))
      end if
    end associate
    self%arrived = self%arrived + 1
    call note_progress()
  end function board_arrive

  !> Have all come to the round? The last one makes its result, and releases the others.
  logical function board_is_complete(self)
    class(board_t), intent(in), target :: self

    board_is_complete = self%arrived == self%n
  end function board_is_complete

  !> End the round.
  subroutine board_release(self)
    class(board_t), intent(inout), target :: self

    self%arrived = 0
    self%round = self%round + 1
    call note_progress()
  end subroutine board_release

  !> Wait for the end of a round.
  subroutine board_wait(self, turn)
    class(board_t), intent(in), target :: self
    integer, intent(in) :: turn !! the round

    do while (self%round == turn)
      call yield()
    end do
  end subroutine board_wait

  !> Send items to a subdomain of this process; they are copied.
  subroutine board_post(self, from, to, items)
    class(board_t), intent(inout), target :: self
    integer, intent(in) :: from !! sender, from 0 within the process
    integer, intent(in) :: to !! receiver, likewise
    real(wp), intent(in) :: items(:, :) !! what to send
    type(letter_t), allocatable :: more(:)
    integer :: i

    self%sent(from, to) = self%sent(from, to) + 1
    associate (box => self%boxes(to))
      if (.not. allocated(box%letters)) allocate (box%letters(8))
      if (box%n == size(box%letters)) then
        allocate (more(2*box%n))
        do i = 1, box%n
          call move_letter(box%letters(i), more(i))
        end do
        call move_alloc(more, box%letters)
      end if
      box%n = box%n + 1
      box%letters(box%n)%from = from
      box%letters(box%n)%number = self%sent(from, to)
      ! Assignment to an array that is not allocated has the compiler compute with unset bounds.
      if (allocated(box%letters(box%n)%items)) deallocate (box%letters(box%n)%items)
      allocate (box%letters(box%n)%items(size(items, 1), size(items, 2)))
      box%letters(box%n)%items(:, :) = items
    end associate
    call note_progress()
  end subroutine board_post

  !> Number of the next letter that a subdomain expects from another.
  integer(i8) function board_expect(self, from, to) result(number)
    class(board_t), intent(inout), target :: self
    integer, intent(in) :: from !! sender, from 0 within the process
    integer, intent(in) :: to !! receiver, likewise

    self%expected(from, to) = self%expected(from, to) + 1
    number = self%expected(from, to)
  end function board_expect

  !> Take a letter out of the box, where it has come.
  logical function board_take(self, from, to, number, items) result(has_come)
    class(board_t), intent(inout), target :: self
    integer, intent(in) :: from !! sender, from 0 within the process
    integer, intent(in) :: to !! receiver, likewise
    integer(i8), intent(in) :: number !! number of the letter, as expected
    real(wp), intent(inout) :: items(:, :) !! what was sent, unchanged where nothing has come
    integer :: i

    associate (box => self%boxes(to))
      do i = 1, box%n
        has_come = box%letters(i)%from == from .and. box%letters(i)%number == number
        if (.not. has_come) cycle
        items = box%letters(i)%items
        call move_letter(box%letters(box%n), box%letters(i))
        box%n = box%n - 1
        call note_progress()
        return
      end do
    end associate
    has_come = .false.
  end function board_take

  !> Move a letter to another place.
  subroutine move_letter(letter, place)
    type(letter_t), intent(inout) :: letter
    type(letter_t), intent(inout) :: place

    place%from = letter%from
    place%number = letter%number
    call move_alloc(letter%items, place%items)
  end subroutine move_letter
end module sg_board
