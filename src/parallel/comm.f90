!> Communication between ranks: reductions, broadcasts and gathers of integers, long integers, reals, flags and texts.
!!
!! All operations are collective: every rank calls them, in the same order. Operations that need a library are in `ranks_t`;
!! broadcasts and gathers travel as bytes, exact to the last bit.
module sg_comm
  use sg_error, only: error_t
  use sg_kinds, only: i1, i4, i8, wp
  use sg_ranks, only: by_maximum, by_minimum, by_sum, sum_of_sweep, sum_of_test, traffic_t
  use sg_virtual_ranks, only: virtual_ranks_t
  implicit none
  private
  public :: comm_t, traffic_t, sum_of_sweep, sum_of_test

  !> Mould of transferred values, and its size for each kind
  integer(i1), parameter :: bytes(1) = 0
  integer, parameter :: bytes_of_i4 = storage_size(0_i4)/8, bytes_of_i8 = storage_size(0_i8)/8, bytes_of_wp = storage_size(0.0_wp)/8

  !> A group of ranks that work on one scene
  type, extends(virtual_ranks_t) :: comm_t
  contains
    procedure, private :: sum_integer, sum_long, sum_real, sum_integers, sum_longs, sum_reals
    procedure, private :: maximum_integer, maximum_long, maximum_real, maximum_integers, maximum_longs, maximum_reals
    procedure, private :: minimum_integer, minimum_long, minimum_real, minimum_integers, minimum_longs, minimum_reals
    procedure, private :: any_flag, any_flags
    procedure, private :: broadcast_integer, broadcast_long, broadcast_real, broadcast_flag
    procedure, private :: broadcast_integers, broadcast_longs, broadcast_reals, broadcast_text
    procedure, private :: gather_integer, gather_long, gather_reals, gather_lists
    !> Replace each value by its sum over the ranks, the same on all
    generic :: sum => sum_integer, sum_long, sum_real, sum_integers, sum_longs, sum_reals
    !> Replace each value by the largest of the ranks
    generic :: maximum => maximum_integer, maximum_long, maximum_real, maximum_integers, maximum_longs, maximum_reals
    !> Replace each value by the smallest of the ranks
    generic :: minimum => minimum_integer, minimum_long, minimum_real, minimum_integers, minimum_longs, minimum_reals
    !> Is a flag, or which of several flags, true on any rank?
    generic :: any => any_flag, any_flags
    !> Is a flag true on all ranks?
    procedure :: all => all_flag
    !> Replace a value, values, a flag or a text by those of the root rank
    generic :: broadcast => broadcast_integer, broadcast_long, broadcast_real, broadcast_flag, &
      broadcast_integers, broadcast_longs, broadcast_reals, broadcast_text
    !> Values of all ranks side by side: of one value per rank a list, of lists of one size the columns of a table, of lists of
    !! any sizes one list and where that of each rank begins
    generic :: gather => gather_integer, gather_long, gather_reals, gather_lists
    procedure :: agree => comm_agree
    procedure :: before => comm_before
  end type comm_t

contains

  !> Sum of the ranks' integers.
  subroutine sum_integer(self, value)
    class(comm_t), intent(inout) :: self
    integer(i4), intent(inout) :: value
    value = transfer(self%reduced([value], by_sum), value)
  end subroutine sum_integer

  !> Sum of the ranks' long integers.
  subroutine sum_long(self, value)
    class(comm_t), intent(inout) :: self
    integer(i8), intent(inout) :: value
    value = transfer(self%reduced([value], by_sum), value)
  end subroutine sum_long

  !> Sum of the ranks' reals.
  subroutine sum_real(self, value)
    class(comm_t), intent(inout) :: self
    real(wp), intent(inout) :: value
    value = transfer(self%reduced([value], by_sum), value)
  end subroutine sum_real

  !> Sums of the ranks' integers, place by place.
  subroutine sum_integers(self, values)
    class(comm_t), intent(inout) :: self
    integer(i4), intent(inout) :: values(:)
    values = self%reduced(values, by_sum)
  end subroutine sum_integers

  !> Sums of the ranks' long integers, place by place.
  subroutine sum_longs(self, values)
    class(comm_t), intent(inout) :: self
    integer(i8), intent(inout) :: values(:)
    values = self%reduced(values, by_sum)
  end subroutine sum_longs

  !> Sums of the ranks' reals, place by place.
  subroutine sum_reals(self, values)
    class(comm_t), intent(inout) :: self
    real(wp), intent(inout) :: values(:)
    values = self%reduced(values, by_sum)
  end subroutine sum_reals

  !> Largest of the ranks' integers.
  subroutine maximum_integer(self, value)
    class(comm_t), intent(inout) :: self
    integer(i4), intent(inout) :: value
    value = transfer(self%reduced([value], by_maximum), value)
  end subroutine maximum_integer

  !> Largest of the ranks' long integers.
  subroutine maximum_long(self, value)
    class(comm_t), intent(inout) :: self
    integer(i8), intent(inout) :: value
    value = transfer(self%reduced([value], by_maximum), value)
  end subroutine maximum_long

  !> Largest of the ranks' reals.
  subroutine maximum_real(self, value)
    class(comm_t), intent(inout) :: self
    real(wp), intent(inout) :: value
    value = transfer(self%reduced([value], by_maximum), value)
  end subroutine maximum_real

  !> Largest of the ranks' integers, place by place.
  subroutine maximum_integers(self, values)
    class(comm_t), intent(inout) :: self
    integer(i4), intent(inout) :: values(:)
    values = self%reduced(values, by_maximum)
  end subroutine maximum_integers

  !> Largest of the ranks' long integers, place by place.
  subroutine maximum_longs(self, values)
    class(comm_t), intent(inout) :: self
    integer(i8), intent(inout) :: values(:)
    values = self%reduced(values, by_maximum)
  end subroutine maximum_longs

  !> Largest of the ranks' reals, place by place.
  subroutine maximum_reals(self, values)
    class(comm_t), intent(inout) :: self
    real(wp), intent(inout) :: values(:)
    values = self%reduced(values, by_maximum)
  end subroutine maximum_reals

  !> Smallest of the ranks' integers.
  subroutine minimum_integer(self, value)
    class(comm_t), intent(inout) :: self
    integer(i4), intent(inout) :: value
    value = transfer(self%reduced([value], by_minimum), value)
  end subroutine minimum_integer

  !> Smallest of the ranks' long integers.
  subroutine minimum_long(self, value)
    class(comm_t), intent(inout) :: self
    integer(i8), intent(inout) :: value
    value = transfer(self%reduced([value], by_minimum), value)
  end subroutine minimum_long

  !> Smallest of the ranks' reals.
  subroutine minimum_real(self, value)
    class(comm_t), intent(inout) :: self
    real(wp), intent(inout) :: value
    value = transfer(self%reduced([value], by_minimum), value)
  end subroutine minimum_real

  !> Smallest of the ranks' integers, place by place.
  subroutine minimum_integers(self, values)
    class(comm_t), intent(inout) :: self
    integer(i4), intent(inout) :: values(:)
    values = self%reduced(values, by_minimum)
  end subroutine minimum_integers

  !> Smallest of the ranks' long integers, place by place.
  subroutine minimum_longs(self, values)
    class(comm_t), intent(inout) :: self
    integer(i8), intent(inout) :: values(:)
    values = self%reduced(values, by_minimum)
  end subroutine minimum_longs

  !> Smallest of the ranks' reals, place by place.
  subroutine minimum_reals(self, values)
    class(comm_t), intent(inout) :: self
    real(wp), intent(inout) :: values(:)
    values = self%reduced(values, by_minimum)
  end subroutine minimum_reals

  !> Is a flag true on any rank?
  logical function any_flag(self, is_so)
    class(comm_t), intent(inout) :: self
    logical, intent(in) :: is_so

    any_flag = any(self%any([is_so]))
  end function any_flag

  !> Which flags are true on any rank?
  function any_flags(self, is_so)
    class(comm_t), intent(inout) :: self
    logical, intent(in) :: is_so(:)
    logical :: any_flags(size(is_so))
    integer(i4) :: numbers(size(is_so))

    numbers = merge(1_i4, 0_i4, is_so)
    call self%maximum(numbers)
    any_flags = numbers > 0
  end function any_flags

  !> Is a flag true on all ranks?
  logical function all_flag(self, is_so)
    class(comm_t), intent(inout) :: self
    logical, intent(in) :: is_so !! flag of this rank

    all_flag = .not. self%any(.not. is_so)
  end function all_flag

  !> The root's integer.
  subroutine broadcast_integer(self, value, root)
    class(comm_t), intent(inout) :: self
    integer(i4), intent(inout) :: value
    integer, intent(in) :: root
    value = transfer(self%of_root(transfer(value, bytes), root), value)
  end subroutine broadcast_integer

  !> The root's long integer.
  subroutine broadcast_long(self, value, root)
    class(comm_t), intent(inout) :: self
    integer(i8), intent(inout) :: value
    integer, intent(in) :: root
    value = transfer(self%of_root(transfer(value, bytes), root), value)
  end subroutine broadcast_long

  !> The root's real.
  subroutine broadcast_real(self, value, root)
    class(comm_t), intent(inout) :: self
    real(wp), intent(inout) :: value
    integer, intent(in) :: root
    value = transfer(self%of_root(transfer(value, bytes), root), value)
  end subroutine broadcast_real

  !> The root's flag.
  subroutine broadcast_flag(self, value, root)
    class(comm_t), intent(inout) :: self
    logical, intent(inout) :: value
    integer, intent(in) :: root
    value = transfer(self%of_root(transfer(value, bytes), root), value)
  end subroutine broadcast_flag

  !> The root's integers.
  subroutine broadcast_integers(self, values, root)
    class(comm_t), intent(inout) :: self
    integer(i4), intent(inout) :: values(:)
    integer, intent(in) :: root
    values = transfer(self%of_root(transfer(values, bytes), root), values)
  end subroutine broadcast_integers

  !> The root's long integers.
  subroutine broadcast_longs(self, values, root)
    class(comm_t), intent(inout) :: self
    integer(i8), intent(inout) :: values(:)
    integer, intent(in) :: root
    values = transfer(self%of_root(transfer(values, bytes), root), values)
  end subroutine broadcast_longs

  !> The root's reals.
  subroutine broadcast_reals(self, values, root)
    class(comm_t), intent(inout) :: self
    real(wp), intent(inout) :: values(:)
    integer, intent(in) :: root
    values = transfer(self%of_root(transfer(values, bytes), root), values)
  end subroutine broadcast_reals

  !> The root's text, unallocated where it has none.
  subroutine broadcast_text(self, text, root)
    class(comm_t), intent(inout) :: self
    character(len=:), allocatable, intent(inout) :: text
    integer, intent(in) :: root
    integer :: length

    length = -1
    if (allocated(text)) length = len(text)
    call self%broadcast(length, root)
    if (self%rank /= root .and. allocated(text)) deallocate (text)
    if (length < 0) return
    if (self%rank /= root) allocate (character(len=length) :: text)
    text(:) = transfer(self%of_root(transfer(text, bytes), root), text)
  end subroutine broadcast_text

  !> Integers of all ranks, in their order.
  subroutine gather_integer(self, own, all)
    class(comm_t), intent(inout) :: self
    integer(i4), intent(in) :: own
    integer(i4), allocatable, intent(out) :: all(:)

    all = transfer(self%side_by_side(transfer(own, bytes), spread(bytes_of_i4, 1, self%size)), [own])
  end subroutine gather_integer

  !> Long integers of all ranks, in their order.
  subroutine gather_long(self, own, all)
    class(comm_t), intent(inout) :: self
    integer(i8), intent(in) :: own
    integer(i8), allocatable, intent(out) :: all(:)

    all = transfer(self%side_by_side(transfer(own, bytes), spread(bytes_of_i8, 1, self%size)), [own])
  end subroutine gather_long

  !> Lists of reals, all of one size: column r + 1 is that of rank r.
  subroutine gather_reals(self, own, all)
    class(comm_t), intent(inout) :: self
    real(wp), intent(in) :: own(:)
    real(wp), allocatable, intent(out) :: all(:, :)

    all = reshape(transfer(self%side_by_side(transfer(own, bytes), spread(bytes_of_wp*size(own), 1, self%size)), own), &
                  [size(own), self%size])
  end subroutine gather_reals

  !> Lists of integers of any sizes, one after the other: that of rank r begins at `first(r)`, the last one ends before
  !! `first(ranks)`.
  subroutine gather_lists(self, own, all, first)
    class(comm_t), intent(inout) :: self
    integer(i4), intent(in) :: own(:)
    integer(i4), allocatable, intent(out) :: all(:)
    integer, allocatable, intent(out) :: first(:)
    integer, allocatable :: length(:)
    integer :: r

    call self%gather(size(own), length)
    all = transfer(self%side_by_side(transfer(own, bytes), bytes_of_i4*length), own)
    allocate (first(0:self%size), source=[(1 + sum(length(:r)), r=0, self%size)])
  end subroutine gather_lists

  !> Share an error: afterwards all ranks have one if any had, that of the lowest rank that had one.
  subroutine comm_agree(self, error, root)
    class(comm_t), intent(inout) :: self
    type(error_t), allocatable, intent(inout) :: error !! of this rank; of the root afterwards
    integer, intent(out), optional :: root !! lowest rank that had an error, -1 where all is well
    integer :: first, numbers(3)

    first = merge(self%rank, self%size, allocated(error))
    call self%minimum(first)
    if (present(root)) root = merge(first, -1, first < self%size)
    if (first == self%size) return
    if (self%rank /= first) then
      if (allocated(error)) deallocate (error)
      allocate (error)
    end if
    numbers = [error%line, error%column, error%code]
    call self%broadcast(numbers, first)
    error%line = numbers(1)
    error%column = numbers(2)
    error%code = numbers(3)
    call self%broadcast(error%message, first)
    call self%broadcast(error%file, first)
    call self%broadcast(error%text, first)
  end subroutine comm_agree

  !> Sum over the ranks below this one, and over all.
  subroutine comm_before(self, own, before, total)
    class(comm_t), intent(inout) :: self
    integer(i8), intent(in) :: own !! of this rank
    integer(i8), intent(out) :: before !! sum over lower ranks
    integer(i8), intent(out) :: total !! sum over all ranks
    integer(i8), allocatable :: all(:)

    call self%gather(own, all)
    before = sum(all(:self%rank))
    total = sum(all)
  end subroutine comm_before
end module sg_comm
