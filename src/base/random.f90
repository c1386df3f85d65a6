!> A seeded random generator that gives the same numbers on every machine and compiler.
!!
!! Combined multiple recursive generator MRG32k3a [LEcuyer1999]: exact in doubles.
module sg_random
  use sg_kinds, only: wp, i4, i8
  implicit none
  private
  public :: random_t

  real(wp), parameter :: m1 = 4294967087.0_wp, m2 = 4294944443.0_wp

  !> A stream of random numbers; two streams with the same seed give the same numbers
  type :: random_t
    real(wp), private :: s(6) = 12345.0_wp
  contains
    procedure :: seed => random_seed_stream
    procedure :: uniform => random_uniform
    procedure :: normal => random_normal
    procedure :: shuffle => random_shuffle
  end type random_t

contains

  !> Start the stream at a seed.
  pure subroutine random_seed_stream(self, seed)
    class(random_t), intent(inout) :: self
    integer, intent(in) :: seed !! any integer
    integer(i8) :: x
    integer :: i

    x = modulo(int(seed, i8), 2147483647_i8) + 1
    do i = 1, 6
      x = modulo(x*48271_i8 + 11_i8, 2147483647_i8) + 1
      self%s(i) = real(x, wp)
    end do
    do i = 1, 20
      call advance(self%s)
    end do
  end subroutine random_seed_stream

  !> One step of both recurrences.
  pure subroutine advance(s)
    real(wp), intent(inout) :: s(6)
    real(wp) :: p1, p2

    p1 = remainder_of(1403580.0_wp*s(2) - 810728.0_wp*s(1), m1)
    p2 = remainder_of(527612.0_wp*s(6) - 1370589.0_wp*s(4), m2)
    s = [s(2), s(3), p1, s(5), s(6), p2]
  end subroutine advance

  !> What `modulo` gives for whole numbers below 2^53 and a quotient below 2^21, by one division as in [LEcuyer1999]: the C library
  !! takes several times as long, bit by bit. The quotient is off by one at most, and all products are exact.
  pure elemental real(wp) function remainder_of(p, m) result(rest)
    real(wp), intent(in) :: p, m

    rest = p - m*aint(p/m)
    if (rest < 0) rest = rest + m
    if (rest >= m) rest = rest - m
  end function remainder_of

  !> The next number, evenly spread over 0 to 1, ends excluded.
  pure subroutine draw(s, x)
    real(wp), intent(inout) :: s(6)
    real(wp), intent(out) :: x

    call advance(s)
    x = s(3) - s(6)
    if (x <= 0) x = x + m1
    x = x/(m1 + 1)
  end subroutine draw

  !> A number evenly spread over 0 to 1, ends excluded, or over the range given.
  function random_uniform(self, low, high) result(x)
    class(random_t), intent(inout) :: self
    real(wp), intent(in), optional :: low !! lower end, 0 when absent
    real(wp), intent(in), optional :: high !! upper end, 1 when absent
    real(wp) :: x

    call draw(self%s, x)
    if (present(low) .and. present(high)) x = low + (high - low)*x
  end function random_uniform

  !> A number from the normal law of mean 0 and variance 1 (Box and Muller).
  function random_normal(self) result(x)
    use sg_kinds, only: pi
    class(random_t), intent(inout) :: self
    real(wp) :: x, radius

    radius = sqrt(-2*log(self%uniform()))
    x = radius*cos(2*pi*self%uniform())
  end function random_normal

  !> Bring a list into random order, each order as likely as the others (Fisher and Yates).
  pure subroutine random_shuffle(self, list)
    class(random_t), intent(inout) :: self
    integer(i4), intent(inout) :: list(:) !! the same entries in another order
    integer :: i, j
    real(wp) :: x

    do i = size(list), 2, -1
      call draw(self%s, x)
      j = min(i, 1 + int(real(i, wp)*x))
      list([i, j]) = list([j, i])
    end do
  end subroutine random_shuffle
end module sg_random
