!> Datasets with a check sum of their own, kept as an attribute: HDF5's one per chunk lets chunks of zeros pass, which disks leave
!! behind most often.
!!
!! The sum is that of all numbers, each as bits and weighted by its place, modulo a prime. It does not depend on how ranks share the
!! rows, neither when they are written nor when they are read.
module sg_sealed_datasets
  use sg_comm, only: comm_t
  use sg_error, only: exit_output, fail
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: wp, i4, i8
  use sg_text, only: text_t
  implicit none
  private
  public :: check_seals, put_sealed

  !> Name of the attribute, and rows that are read at once
  character(len=*), parameter :: seal = 'check_sum'
  integer(i8), parameter :: piece = 16384
  !> The prime 2^31 - 1: products of two numbers below it can be counted
  integer(i8), parameter :: prime = 2147483647_i8
  !> Weights of the middle and the highest bits of a number
  integer(i8), parameter :: middle = 1103515245_i8, highest = 12345701_i8

  !> Store a dataset with its check sum
  interface put_sealed
    module procedure put_reals, put_real_records, put_integers, put_integer_records
  end interface put_sealed

contains

  !> Store a list of reals.
  subroutine put_reals(file, path, values, is_common)
    type(hdf5_file_t), intent(inout) :: file !! open file, perhaps shared
    character(len=*), intent(in) :: path !! path within the file
    real(wp), intent(in), contiguous :: values(:) !! numbers to store
    logical, intent(in), optional :: is_common !! the same on all ranks, to be stored once?

    call file%put(path, values, is_common)
    call set_seal(file, path, reshape(values, [1, size(values)]), is_common)
  end subroutine put_reals

  !> Store records of reals.
  subroutine put_real_records(file, path, values)
    type(hdf5_file_t), intent(inout) :: file !! open file, perhaps shared
    character(len=*), intent(in) :: path !! path within the file
    real(wp), intent(in), contiguous :: values(:, :) !! records to store

    call file%put(path, values)
    call set_seal(file, path, values)
  end subroutine put_real_records

  !> Store a list of integers.
  subroutine put_integers(file, path, values)
    type(hdf5_file_t), intent(inout) :: file !! open file, perhaps shared
    character(len=*), intent(in) :: path !! path within the file
    integer(i4), intent(in), contiguous :: values(:) !! numbers to store

    call file%put(path, values)
    call set_seal(file, path, reshape(real(values, wp), [1, size(values)]))
  end subroutine put_integers

  !> Store records of integers.
  subroutine put_integer_records(file, path, values)
    type(hdf5_file_t), intent(inout) :: file !! open file, perhaps shared
    character(len=*), intent(in) :: path !! path within the file
    integer(i4), intent(in), contiguous :: values(:, :) !! records to store

    call file%put(path, values)
    call set_seal(file, path, real(values, wp))
  end subroutine put_integer_records

  !> Sum over all ranks, and store it.
  subroutine set_seal(file, path, values, is_common)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(wp), intent(in) :: values(:, :)
    logical, intent(in), optional :: is_common
    integer(i8) :: first, total
    logical :: is_shared

    is_shared = file%ranks%size > 1
    if (present(is_common)) is_shared = is_shared .and. .not. is_common
    first = 0
    if (is_shared) call file%ranks%before(size(values, 2, i8), first, total)
    total = sum_of(values, first)
    if (is_shared) call file%ranks%sum(total)
    call file%set(path, seal, modulo(total, prime))
  end subroutine set_seal

  !> Check sum of some rows.
  pure integer(i8) function sum_of(values, first) result(total)
    real(wp), intent(in) :: values(:, :)
    integer(i8), intent(in) :: first !! rows before them
    integer(i8) :: bits, place, number
    integer :: i, k

    total = 0
    place = modulo(first*size(values, 1, i8), prime)
    do k = 1, size(values, 2)
      do i = 1, size(values, 1)
        place = modulo(place + 1, prime)
        bits = transfer(values(i, k), bits)
        number = modulo(ibits(bits, 0, 31) + middle*ibits(bits, 31, 31), prime) + highest*ibits(bits, 62, 2)
        total = modulo(total + place*modulo(number + 1, prime), prime)
      end do
    end do
  end function sum_of

  !> Compare datasets with their check sums; each rank looks at a piece of each. Collective, of ranks that have each opened the file
  !! by themselves; where a dataset differs, the error of the file is set on all.
  subroutine check_seals(file, paths, ranks)
    type(hdf5_file_t), intent(inout) :: file !! open file, not shared; one that failed is not looked at
    type(text_t), intent(in) :: paths(:) !! datasets, the same number on all ranks
    type(comm_t), intent(inout) :: ranks !! the ranks
    integer(i8) :: parts(size(paths)), sealed
    integer :: i

    do i = 1, size(paths)
      parts(i) = sum_of_piece(file, paths(i)%s, int(ranks%rank, i8), int(ranks%size, i8))
    end do
    call ranks%sum(parts)
    do i = 1, size(paths)
      call file%look(paths(i)%s, seal, sealed)
      if (allocated(file%error)) return
      if (modulo(parts(i), prime) == sealed) cycle
      call fail(file%error, paths(i)%s//' is not what was written: its check sum differs', file=file%name, code=exit_output)
      return
    end do
  end subroutine check_seals

  !> Check sum of the rows of one of so many pieces of a dataset; 0 after a failure.
  integer(i8) function sum_of_piece(file, path, part, parts) result(total)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer(i8), intent(in) :: part, parts
    real(wp), allocatable :: values(:, :)
    integer(i8) :: rows, first, last

    total = 0
    rows = file%rows(path)
    last = rows*part/parts
    do while (last < rows*(part + 1)/parts .and. .not. allocated(file%error))
      first = last
      last = min(first + piece, rows*(part + 1)/parts)
      call file%get_rows(path, first, int(last - first), values)
      if (.not. allocated(file%error)) total = modulo(total + sum_of(values, first), prime)
    end do
  end function sum_of_piece
end module sg_sealed_datasets
