!> Block distribution: records of all ranks in the order of their numbers, for files that do not depend on the number of ranks.
!!
!! Items are numbered from 1 to `total` over all ranks. Each rank holds some of them, in any order; a file has them by
!! number. Rank r of P writes the block of numbers from r total/P + 1 to (r + 1) total/P: `block_distribution_t` brings items held
!! into blocks, and `wanted_t` takes out of the blocks the records that a rank needs. No rank holds more than its share.
module sg_block_distribution
  use sg_ascending, only: distinct, place_in
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, i4, i8
  use sg_sorting, only: sort_permutation
  implicit none
  private
  public :: block_distribution_t, wanted_t

  !> A plan by which things that ranks hold come into blocks
  type :: block_distribution_t
    !> Things of all ranks, those in the blocks of lower ranks, and those in the block of this one
    integer :: total = 0, first = 0, n = 0
    !> Does each number from 1 to `total` occur on one rank, once?
    logical :: is_complete = .false.
    !> Things held, by the rank of their block, and how many go to each rank, shape (0:ranks-1)
    integer(i4), allocatable, private :: held(:)
    integer, allocatable, private :: send_count(:)
    !> Rows within the block of what comes, and how many come from each rank
    integer, allocatable, private :: row(:), receive_count(:)
  contains
    procedure :: plan => rows_plan
    procedure, private :: order_reals, order_records, order_integers
    !> Bring numbers of items held into the blocks
    generic :: order => order_reals, order_records, order_integers
    procedure :: back => rows_back
  end type block_distribution_t

  !> A plan by which a rank gets items from the blocks of others
  type :: wanted_t
    !> Numbers of the things wanted, ascending
    integer(i4), allocatable :: number(:)
    !> How many each rank gives to this one; rows of this block that are given away, and how many to each rank
    integer, allocatable, private :: receive_count(:), row(:), send_count(:)
  contains
    procedure :: plan => wanted_plan
    procedure :: fetch => wanted_fetch
    procedure :: place => wanted_place
  end type wanted_t

contains

  !> Numbers in the blocks of the ranks below one.
  pure integer function numbers_before(rank, size, total) result(before)
    integer, intent(in) :: rank, size, total

    before = int(int(rank, i8)*int(total, i8)/int(size, i8))
  end function numbers_before

  !> Rank that holds the block of a number.
  pure integer function rank_of(number, size, total) result(rank)
    integer, intent(in) :: number, size, total

    rank = int((int(number, i8) - 1)*int(size, i8)/int(total, i8))
    do while (numbers_before(rank + 1, size, total) < number)
      rank = rank + 1
    end do
  end function rank_of

  !> Make the plan.
  subroutine rows_plan(self, comm, number, total)
    class(block_distribution_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    integer(i4), intent(in) :: number(:) !! numbers of items that this rank holds, from 1 over all ranks
    integer, intent(in) :: total !! things of all ranks
    real(wp), allocatable :: came(:)
    integer(i8) :: goal(size(number))
    logical, allocatable :: has_come(:)
    logical :: is_known(size(number))
    integer :: i

    self%total = total
    self%first = numbers_before(comm%rank, comm%size, total)
    self%n = numbers_before(comm%rank + 1, comm%size, total) - self%first
    is_known = number >= 1 .and. number <= total
    self%held = pack([(int(i, i4), i=1, size(number))], is_known)
    do i = 1, size(self%held)
      goal(i) = int(rank_of(number(self%held(i)), comm%size, total), i8)
    end do
    self%held = self%held(sort_permutation(goal(:size(self%held))))
    call count_goals(int(goal(:size(self%held))), comm%size, self%send_count)
    call comm%swap(real(number(self%held), wp), self%send_count, came, self%receive_count)
    self%row = nint(came) - self%first
    allocate (has_come(self%n), source=.false.)
    has_come(self%row) = .true.
    self%is_complete = comm%all(all(is_known) .and. all(has_come) .and. size(self%row) == self%n)
  end subroutine rows_plan

  !> How many things go to each rank.
  subroutine count_goals(goal, ranks, counts)
    integer, intent(in) :: goal(:), ranks
    integer, allocatable, intent(out) :: counts(:)
    integer :: i

    allocate (counts(0:ranks - 1), source=0)
    do i = 1, size(goal)
      counts(goal(i)) = counts(goal(i)) + 1
    end do
  end subroutine count_goals

  !> Bring records into the blocks.
  subroutine order_records(self, comm, values, rows)
    class(block_distribution_t), intent(in) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(in) :: values(:, :) !! of items held, shape (width, held)
    real(wp), allocatable, intent(out) :: rows(:, :) !! of the block, shape (width, n)
    real(wp), allocatable :: came(:, :)

    call exchange(comm, values(:, self%held), self%send_count, came)
    allocate (rows(size(values, 1), self%n), source=0.0_wp)
    rows(:, self%row) = came
  end subroutine order_records

  !> Bring reals into the blocks.
  subroutine order_reals(self, comm, values, rows)
    class(block_distribution_t), intent(in) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(in) :: values(:) !! of items held
    real(wp), allocatable, intent(out) :: rows(:) !! of the block
    real(wp), allocatable :: came(:, :)

    call order_records(self, comm, reshape(values, [1, size(values)]), came)
    rows = came(1, :)
  end subroutine order_reals

  !> Bring integers into the blocks.
  subroutine order_integers(self, comm, values, rows)
    class(block_distribution_t), intent(in) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    integer(i4), intent(in) :: values(:) !! of items held
    integer(i4), allocatable, intent(out) :: rows(:) !! of the block
    real(wp), allocatable :: came(:)

    call order_reals(self, comm, real(values, wp), came)
    rows = nint(came, i4)
  end subroutine order_integers

  !> Bring records from the blocks to the ranks that hold the items.
  subroutine rows_back(self, comm, rows, values)
    class(block_distribution_t), intent(in) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(in) :: rows(:, :) !! of the block, shape (width, n)
    real(wp), allocatable, intent(out) :: values(:, :) !! of items held, shape (width, held); zero where numbers are unknown
    real(wp), allocatable :: came(:, :)

    call exchange(comm, rows(:, self%row), self%receive_count, came)
    allocate (values(size(rows, 1), size(self%held)), source=0.0_wp)
    values(:, self%held) = came
  end subroutine rows_back

  !> Send records to their goals, and receive.
  subroutine exchange(comm, send, counts, came)
    type(comm_t), intent(inout) :: comm
    real(wp), intent(in) :: send(:, :)
    integer, intent(in) :: counts(0:)
    real(wp), allocatable, intent(out) :: came(:, :)
    real(wp), allocatable :: reals(:)
    integer, allocatable :: came_count(:)
    integer :: width

    width = size(send, 1)
    call comm%swap(reshape(send, [size(send)]), width*counts, reals, came_count)
    came = reshape(reals, [width, size(reals)/max(1, width)])
  end subroutine exchange

  !> Make the plan.
  subroutine wanted_plan(self, comm, rows, number)
    class(wanted_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    type(block_distribution_t), intent(in) :: rows !! the blocks
    integer(i4), intent(in) :: number(:) !! numbers of the things wanted, in any order, also several times
    real(wp), allocatable :: asked(:)
    integer, allocatable :: goal(:)
    integer :: i

    self%number = distinct(number)
    goal = [(rank_of(self%number(i), comm%size, rows%total), i=1, size(self%number))]
    call count_goals(goal, comm%size, self%receive_count)
    call comm%swap(real(self%number, wp), self%receive_count, asked, self%send_count)
    self%row = nint(asked) - rows%first
  end subroutine wanted_plan

  !> Get the wanted items from the blocks.
  subroutine wanted_fetch(self, comm, rows, values)
    class(wanted_t), intent(in) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(in) :: rows(:, :) !! of the block of this rank, shape (width, n)
    real(wp), allocatable, intent(out) :: values(:, :) !! of the things wanted, shape (width, wanted)

    call exchange(comm, rows(:, self%row), self%send_count, values)
  end subroutine wanted_fetch

  !> Place of a number in the list of those wanted, from 1; 0 where it is not wanted.
  pure elemental integer function wanted_place(self, number) result(place)
    class(wanted_t), intent(in) :: self
    integer(i4), intent(in) :: number !! any number

    place = place_in(self%number, number)
  end function wanted_place
end module sg_block_distribution
