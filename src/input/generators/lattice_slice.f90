!> The grains of a lattice that one of several ranks keeps while a deck is read: those of one piece of Hilbert's curve.
!!
!! Grains are numbered along the curve, so that a piece of it is a range of numbers, and near in space. Every rank goes through
!! the whole lattice twice, once to find where pieces of equal numbers begin, once to take its own: no list is as long as the
!! lattice, and no message is sent. Radii and shifts come from one stream of random numbers, first all radii, then all shifts;
!! a copy of the stream stands where shifts begin.
module sg_lattice_slice
  use sg_census, only: census_t
  use sg_generators, only: draw_radius
  use sg_kinds, only: wp, i4, i8, pi
  use sg_lattice, only: lattice_t
  use sg_random, only: random_t
  use sg_sorting, only: hilbert_key, hilbert_key_in_space, sort_permutation
  use sg_space_generators, only: random_direction
  implicit none
  private
  public :: sizes_t, slice_t, take_slice, shift_grain

  !> Bits of a place on the curve by which pieces are distinguished: this many buckets are counted
  integer, parameter :: bucket_bits = 18

  !> How grains are drawn
  type :: sizes_t
    !> Spread of radii, one of `size_*`, and their range [m]
    integer :: distribution = 1
    real(wp) :: range(2) = 0
    !> Random shift at most [m]
    real(wp) :: room = 0
  end type sizes_t

  !> Grains of a piece
  type :: slice_t
    !> Grains of the sample before the first one
    integer :: before = 0
    !> Centres, shape (dimension, n), and radii [m], along the curve
    real(wp), allocatable :: centre(:, :), radius(:)
  end type slice_t

contains

  !> Take the piece of a rank.
  subroutine take_slice(lattice, sizes, random, box, period, rank, ranks, slice, census)
    type(lattice_t), intent(inout) :: lattice !! the lattice, opened
    type(sizes_t), intent(in) :: sizes !! how grains are drawn
    type(random_t), intent(in) :: random !! stream of numbers, before the first radius
    real(wp), intent(in) :: box(:) !! least, then largest coordinates [m]
    real(wp), intent(in) :: period(2) !! periods in x and y [m], 0 for none
    integer, intent(in) :: rank !! rank whose piece is wanted, from 0
    integer, intent(in) :: ranks !! number of ranks
    type(slice_t), intent(out) :: slice !! its grains
    type(census_t), intent(inout) :: census !! learns about all others
    type(random_t) :: radii, shifts, here
    integer(i8), allocatable :: key(:)
    real(wp) :: point(size(box)/2), radius
    integer :: bucket(2), n, i
    integer(i8) :: place

    radii = random
    shifts = random
    do i = 1, lattice%count()
      radius = draw_radius(shifts, sizes%distribution, sizes%range, size(point))
    end do
    call find_piece(lattice, sizes, shifts, box, rank, ranks, bucket, slice%before, n)
    allocate (slice%centre(size(point), n), slice%radius(n), key(n))
    here = shifts
    n = 0
    call lattice%restart()
    do while (lattice%next(point))
      radius = draw_radius(radii, sizes%distribution, sizes%range, size(point))
      call shift_grain(point, sizes%room, here)
      place = place_on_curve(point, box)
      if (bucket_of(place, size(point)) < bucket(1) .or. bucket_of(place, size(point)) > bucket(2)) then
        where (period(:size(point) - 1) > 0) point(:size(point) - 1) = modulo(point(:size(point) - 1), period(:size(point) - 1))
        call census%note(point, radius)
      else
        n = n + 1
        slice%centre(:, n) = point
        slice%radius(n) = radius
        key(n) = place
      end if
    end do
    call order(slice, key)
  end subroutine take_slice

  !> First and last bucket of a rank's piece, grains before it, and grains in it: a bucket is whose share its first grain
  !! falls into.
  subroutine find_piece(lattice, sizes, shifts, box, rank, ranks, bucket, before, n)
    type(lattice_t), intent(inout) :: lattice
    type(sizes_t), intent(in) :: sizes
    type(random_t), intent(in) :: shifts
    real(wp), intent(in) :: box(:)
    integer, intent(in) :: rank, ranks
    integer, intent(out) :: bucket(2), before, n
    integer, allocatable :: count(:)
    type(random_t) :: here
    real(wp) :: point(size(box)/2)
    integer :: b, passed, total

    allocate (count(0:2**bucket_bits - 1), source=0)
    here = shifts
    call lattice%restart()
    do while (lattice%next(point))
      call shift_grain(point, sizes%room, here)
      b = bucket_of(place_on_curve(point, box), size(point))
      count(b) = count(b) + 1
    end do
    total = sum(count)
    bucket = [1, 0]
    before = 0
    n = 0
    passed = 0
    do b = 0, size(count) - 1
      if (count(b) == 0) cycle
      if (int(passed, i8)*int(ranks, i8)/int(total, i8) == int(rank, i8)) then
        if (n == 0) then
          before = passed
          bucket(1) = b
        end if
        n = n + count(b)
        bucket(2) = b
      end if
      passed = passed + count(b)
    end do
  end subroutine find_piece

  !> Put the grains of a piece in their order along the curve.
  subroutine order(slice, key)
    type(slice_t), intent(inout) :: slice
    integer(i8), intent(in) :: key(:)
    integer(i4), allocatable :: permutation(:)

    permutation = sort_permutation(key)
    slice%centre = slice%centre(:, permutation)
    slice%radius = slice%radius(permutation)
  end subroutine order

  !> Place of a point along the curve through the square or cube that holds a box.
  pure integer(i8) function place_on_curve(point, box) result(place)
    real(wp), intent(in) :: point(:), box(:)
    real(wp) :: share(size(point))

    share = (point - box(:size(point)))/maxval(box(size(point) + 1:) - box(:size(point)))
    if (size(point) == 2) then
      place = hilbert_key(share)
    else
      place = hilbert_key_in_space(share)
    end if
  end function place_on_curve

  !> Bucket of a place: its first bits. The curve has 2^20 cells a side.
  pure integer function bucket_of(place, dimension) result(bucket)
    integer(i8), intent(in) :: place
    integer, intent(in) :: dimension

    bucket = int(shiftr(place, 20*dimension - bucket_bits))
  end function bucket_of

  !> Shift a grain at random by up to some length.
  subroutine shift_grain(centre, room, random)
    real(wp), intent(inout) :: centre(:) !! [m], shape (dimension)
    real(wp), intent(in) :: room !! [m]
    type(random_t), intent(inout) :: random !! stream of numbers
    real(wp) :: angle

    if (size(centre) == 2) then
      angle = random%uniform(0.0_wp, 2*pi)
      centre = centre + room*random%uniform()*[cos(angle), sin(angle)]
    else if (room > 0) then
      centre = centre + room*random%uniform()**(1.0_wp/3)*random_direction(random)
    end if
  end subroutine shift_grain
end module sg_lattice_slice
