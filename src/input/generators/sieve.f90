!> Sieve curves: how much of the mass of a sample passes openings, and grain sizes drawn from that.
!!
!! Between two openings the curve is straight over the logarithm of the opening, as gradings are drawn. The mass of a grain goes
!! with its size to the power of the dimension, so of a class between two openings the number density goes as one over that power,
!! and over size once more. Sizes come from a golden sequence, of which every stretch is evenly spread: samples of some hundred
!! grains follow the curve more closely than independent numbers would.
module sg_sieve
  use sg_kinds, only: wp
  use sg_text, only: to_text
  use sg_words, only: short_real
  implicit none
  private
  public :: sieve_t, named_sieve

  !> A grain size curve
  type :: sieve_t
    !> Openings, rising [m], and share of the mass that passes them, from 0 to 1
    real(wp), allocatable :: opening(:), passing(:)
    !> Share of the number of grains below each opening
    real(wp), allocatable, private :: number(:)
    !> Dimension of space, and where the sequence stands
    integer, private :: dimension = 3
    real(wp), private :: place = 0
  contains
    procedure :: begin => sieve_begin
    procedure :: draw => sieve_draw
    procedure :: mean_power => sieve_mean_power
  end type sieve_t

contains

  !> The openings [m] and the percent of the mass that passes them, of a named curve, shape (2, n): for railway ballast the middle
  !! of the limits of a category of EN 13450.
  !!
  !! Limits of EN 13450:2013, table 1, at 22.4, 31.5, 40, 50, 63 and 80 mm, in percent: A 0 to 3, 1 to 25, 30 to 65, 70 to 99, 100;
  !! D 0 to 3, 1 to 25, 30 to 65, 65 to 99, 97 to 99, 100; E 0 to 3, 1 to 25, 25 to 75, 55 to 99, 95 to 99, 100; F 0 to 7, 0 to 7,
  !! 15 to 40, 45 to 70, 93 to 99, 100. Nothing passes 22.4 mm here.
  pure function named_sieve(name) result(curve)
    character(len=*), intent(in) :: name !! one of the names of the key table
    real(wp), allocatable :: curve(:, :)
    real(wp), parameter :: opening(6) = [22.4e-3_wp, 31.5e-3_wp, 40e-3_wp, 50e-3_wp, 63e-3_wp, 80e-3_wp]
    real(wp) :: passing(6)
    integer :: n

    select case (name)
    case ('ballast_a')
      passing = [0.0_wp, 13.0_wp, 47.5_wp, 84.5_wp, 100.0_wp, 100.0_wp]
    case ('ballast_d')
      passing = [0.0_wp, 13.0_wp, 47.5_wp, 82.0_wp, 98.0_wp, 100.0_wp]
    case ('ballast_e')
      passing = [0.0_wp, 13.0_wp, 50.0_wp, 77.0_wp, 97.0_wp, 100.0_wp]
    case default
      passing = [0.0_wp, 3.5_wp, 27.5_wp, 57.5_wp, 96.0_wp, 100.0_wp]
    end select
    n = findloc(passing >= 100, .true., 1)
    allocate (curve(2, n))
    curve(1, :) = opening(:n)
    curve(2, :) = passing(:n)
  end function named_sieve

  !> Take up a curve, and the start of the sequence.
  subroutine sieve_begin(self, curve, dimension, start, message)
    class(sieve_t), intent(out) :: self
    real(wp), intent(in) :: curve(:, :) !! openings [m] and percent of the mass that passes them, shape (2, n)
    integer, intent(in) :: dimension !! of space
    real(wp), intent(in) :: start !! where the sequence of sizes starts, from 0 to 1
    character(len=:), allocatable, intent(out) :: message !! what is wrong with the curve, unallocated when nothing is
    real(wp) :: d, total
    integer :: i, n

    n = size(curve, 2)
    call check(curve, message)
    if (allocated(message)) return
    allocate (self%opening(n), self%passing(n), self%number(n))
    self%opening(:) = curve(1, :)
    self%passing(:) = curve(2, :)/100
    self%dimension = dimension
    self%place = start
    d = real(dimension, wp)
    self%number(1) = 0
    do i = 2, n
      associate (low => self%opening(i - 1)/self%opening(n), high => self%opening(i)/self%opening(n), &
                 mass => self%passing(i) - self%passing(i - 1))
        self%number(i) = self%number(i - 1) + mass*(low**(-d) - high**(-d))/(d*log(high/low))
      end associate
    end do
    total = self%number(n)
    self%number = self%number/total
  end subroutine sieve_begin

  !> Is it a curve from nothing to all, its openings and what passes them rising?
  subroutine check(curve, message)
    real(wp), intent(in) :: curve(:, :)
    character(len=:), allocatable, intent(inout) :: message
    integer :: i, n

    n = size(curve, 2)
    if (n < 2) then
      message = 'a sieve curve needs two openings at least'
    else if (curve(1, 1) <= 0) then
      message = 'an opening must be larger than 0 m'
    else if (abs(curve(2, 1)) > 0) then
      message = 'must begin with the largest opening that nothing passes: [opening, 0]'
    else if (abs(curve(2, n) - 100) > 0) then
      message = 'must end with the smallest opening that all passes: [opening, 100]'
    end if
    do i = 2, n
      if (allocated(message)) return
      if (curve(1, i) <= curve(1, i - 1)) message = 'openings must rise: '//short_real(curve(1, i))//' m follows '// &
                                                    short_real(curve(1, i - 1))//' m'
      if (curve(2, i) < curve(2, i - 1)) message = 'what passes must not fall from opening to opening: '// &
                                                   short_real(curve(2, i))//' % follow '//short_real(curve(2, i - 1))//' %'
    end do
  end subroutine check

  !> The size of the next grain [m].
  real(wp) function sieve_draw(self) result(size)
    class(sieve_t), intent(inout) :: self
    real(wp), parameter :: golden = (sqrt(5.0_wp) - 1)/2
    real(wp) :: d, share, least, most
    integer :: i

    self%place = modulo(self%place + golden, 1.0_wp)
    d = real(self%dimension, wp)
    i = 2
    do while (self%number(i) <= self%place .and. self%number(i) < 1)
      i = i + 1
    end do
    share = (self%place - self%number(i - 1))/(self%number(i) - self%number(i - 1))
    least = (self%opening(i - 1)/self%opening(i))**(-d)
    most = 1
    size = self%opening(i)*(least + share*(most - least))**(-1/d)
  end function sieve_draw

  !> Mean over the grains of their size to the power of the dimension [m**dimension].
  pure real(wp) function sieve_mean_power(self) result(mean)
    class(sieve_t), intent(in) :: self
    real(wp) :: d, grains
    integer :: i

    d = real(self%dimension, wp)
    ! Grains per mass, where a grain of size s has mass s**d.
    grains = 0
    do i = 2, size(self%opening)
      associate (low => self%opening(i - 1), high => self%opening(i))
        grains = grains + (self%passing(i) - self%passing(i - 1))*(low**(-d) - high**(-d))/(d*log(high/low))
      end associate
    end do
    mean = 1/grains
  end function sieve_mean_power
end module sg_sieve
