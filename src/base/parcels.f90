!> Parcels: lists of reals that travel between ranks, written value by value and read back in the same order.
!!
!! Whole numbers up to 2^53 travel in reals exactly.
module sg_parcels
  use sg_kinds, only: wp, i4
  use sg_lists, only: reserve
  implicit none
  private
  public :: parcel_t

  !> A growing list of reals with a place to read from
  type :: parcel_t
    !> Number of values
    integer :: n = 0
    !> Values read so far: the next one stands behind them
    integer :: at = 0
    !> The values, shape (at least n)
    real(wp), allocatable :: value(:)
  contains
    procedure, private :: put_real, put_reals, put_real_records, put_integer, put_integers, put_integer_records
    procedure, private :: take_real, take_reals, take_real_records, take_integer, take_integers, take_integer_records
    !> Append a value, a list or records
    generic :: put => put_real, put_reals, put_real_records, put_integer, put_integers, put_integer_records
    !> Read the next values: as many as there is room for
    generic :: take => take_real, take_reals, take_real_records, take_integer, take_integers, take_integer_records
    procedure :: adopt => parcel_adopt
  end type parcel_t

contains

  !> Take over a list that was received; it is unallocated afterwards. Reading begins at its first value.
  subroutine parcel_adopt(self, list)
    class(parcel_t), intent(inout) :: self
    real(wp), allocatable, intent(inout) :: list(:) !! values

    self%n = size(list)
    self%at = 0
    call move_alloc(list, self%value)
  end subroutine parcel_adopt

  !> Append a real.
  subroutine put_real(self, value)
    class(parcel_t), intent(inout) :: self
    real(wp), intent(in) :: value !! to append

    call reserve(self%value, self%n + 1)
    self%n = self%n + 1
    self%value(self%n) = value
  end subroutine put_real

  !> Append reals.
  subroutine put_reals(self, values)
    class(parcel_t), intent(inout) :: self
    real(wp), intent(in) :: values(:) !! to append

    call reserve(self%value, self%n + size(values))
    self%value(self%n + 1:self%n + size(values)) = values
    self%n = self%n + size(values)
  end subroutine put_reals

  !> Append records of reals.
  subroutine put_real_records(self, records)
    class(parcel_t), intent(inout) :: self
    real(wp), intent(in) :: records(:, :) !! to append, shape (components, items)
    integer :: i

    do i = 1, size(records, 2)
      call self%put_reals(records(:, i))
    end do
  end subroutine put_real_records

  !> Append a whole number.
  subroutine put_integer(self, value)
    class(parcel_t), intent(inout) :: self
    integer(i4), intent(in) :: value !! to append

    call self%put_real(real(value, wp))
  end subroutine put_integer

  !> Append whole numbers.
  subroutine put_integers(self, values)
    class(parcel_t), intent(inout) :: self
    integer(i4), intent(in) :: values(:) !! to append

    call self%put_reals(real(values, wp))
  end subroutine put_integers

  !> Append records of whole numbers.
  subroutine put_integer_records(self, records)
    class(parcel_t), intent(inout) :: self
    integer(i4), intent(in) :: records(:, :) !! to append, shape (components, items)
    integer :: i

    do i = 1, size(records, 2)
      call self%put_integers(records(:, i))
    end do
  end subroutine put_integer_records

  !> Read a real.
  pure subroutine take_real(self, value)
    class(parcel_t), intent(inout) :: self
    real(wp), intent(out) :: value !! the next value

    self%at = self%at + 1
    value = self%value(self%at)
  end subroutine take_real

  !> Read reals.
  pure subroutine take_reals(self, values)
    class(parcel_t), intent(inout) :: self
    real(wp), intent(out) :: values(:) !! the next values

    values = self%value(self%at + 1:self%at + size(values))
    self%at = self%at + size(values)
  end subroutine take_reals

  !> Read records of reals.
  pure subroutine take_real_records(self, records)
    class(parcel_t), intent(inout) :: self
    real(wp), intent(out) :: records(:, :) !! the next values, shape (components, items)
    integer :: i

    do i = 1, size(records, 2)
      call self%take_reals(records(:, i))
    end do
  end subroutine take_real_records

  !> Read a whole number.
  pure subroutine take_integer(self, value)
    class(parcel_t), intent(inout) :: self
    integer(i4), intent(out) :: value !! the next value

    self%at = self%at + 1
    value = nint(self%value(self%at), i4)
  end subroutine take_integer

  !> Read whole numbers.
  pure subroutine take_integers(self, values)
    class(parcel_t), intent(inout) :: self
    integer(i4), intent(out) :: values(:) !! the next values

    values = nint(self%value(self%at + 1:self%at + size(values)), i4)
    self%at = self%at + size(values)
  end subroutine take_integers

  !> Read records of whole numbers.
  pure subroutine take_integer_records(self, records)
    class(parcel_t), intent(inout) :: self
    integer(i4), intent(out) :: records(:, :) !! the next values, shape (components, items)
    integer :: i

    do i = 1, size(records, 2)
      call self%take_integers(records(:, i))
    end do
  end subroutine take_integer_records
end module sg_parcels
