!> Sieve curves: what passes the openings, by mass, in both dimensions; curves that are none.
program test_sieve
  use harness, only: tests_t
  use sg_kinds, only: wp
  use sg_sieve, only: named_sieve, sieve_t
  implicit none
  type(tests_t) :: t

  call test_curve()
  call test_mean()
  call test_named()
  call test_refused()
  call t%finish()

contains

  !> Of n grains the mass below each opening is that of the curve, to the mass of some of the largest grains; so is every stretch.
  subroutine test_curve()
    real(wp), parameter :: curve(2, 5) = reshape([1.0_wp, 0.0_wp, 2.0_wp, 30.0_wp, 3.0_wp, 30.0_wp, 4.0_wp, 80.0_wp, 5.0_wp, &
                                                  100.0_wp], [2, 5])
    integer, parameter :: n = 4000
    type(sieve_t) :: sieve
    character(len=:), allocatable :: message
    real(wp) :: size(n)
    integer :: dimension, i, first

    do dimension = 2, 3
      call sieve%begin(curve, dimension, 0.3_wp, message)
      call t%check(.not. allocated(message), 'a curve is taken')
      do i = 1, n
        size(i) = sieve%draw()
      end do
      call t%check(all(size >= 1 .and. size <= 5), 'sizes within the curve')
      do first = 1, n, n/4
        associate (mass => size(first:first + n/4 - 1)**dimension)
          do i = 2, 4
            ! A golden sequence of 1000 numbers counts each class to within some 4: so many of its largest grains.
            call t%near(sum(mass, size(first:first + n/4 - 1) <= curve(1, i))/sum(mass), curve(2, i)/100, &
                        4*5.0_wp**dimension/sum(mass), 'share of the mass that passes')
          end do
        end associate
      end do
      call t%equal(count(size > 2 .and. size < 3), 0, 'no grain where the curve is level')
      ! Straight over the logarithm: half of a class below the geometric middle.
      call t%near(sum(size**dimension, size > 3 .and. size < sqrt(12.0_wp))/sum(size**dimension), 0.25_wp, &
                  4*5.0_wp**dimension/sum(size**dimension), 'half of a class below its geometric middle')
    end do
  end subroutine test_curve

  !> The mean mass of a grain is that of the numbers drawn, and between two close openings their size.
  subroutine test_mean()
    type(sieve_t) :: sieve
    character(len=:), allocatable :: message
    real(wp) :: sum
    integer :: i

    call sieve%begin(reshape([1.0_wp, 0.0_wp, 3.0_wp, 100.0_wp], [2, 2]), 3, 0.0_wp, message)
    sum = 0
    do i = 1, 10000
      sum = sum + sieve%draw()**3
    end do
    call t%near(sum/10000, sieve%mean_power(), 27*4/10000.0_wp, 'mean mass')
    call sieve%begin(reshape([2.0_wp, 0.0_wp, 2.000001_wp, 100.0_wp], [2, 2]), 2, 0.0_wp, message)
    call t%near(sieve%mean_power(), 4.0_wp, 1e-5_wp, 'mean mass of equal grains')
  end subroutine test_mean

  !> Named curves are curves, within the limits of the standard: category A lets 0 to 3, 1 to 25, 30 to 65, 70 to 99 % pass.
  subroutine test_named()
    real(wp), parameter :: low(5) = [0.0_wp, 1.0_wp, 30.0_wp, 70.0_wp, 100.0_wp], high(5) = [3.0_wp, 25.0_wp, 65.0_wp, 99.0_wp, &
                                                                                           100.0_wp]
    type(sieve_t) :: sieve
    character(len=4), parameter :: category = 'adef'
    character(len=:), allocatable :: message
    integer :: i

    do i = 1, 4
      call sieve%begin(named_sieve('ballast_'//category(i:i)), 3, 0.5_wp, message)
      call t%check(.not. allocated(message), 'a named curve is one')
    end do
    call sieve%begin(named_sieve('ballast_a'), 3, 0.5_wp, message)
    call t%check(all(100*sieve%passing >= low .and. 100*sieve%passing <= high), 'category A within its limits')
  end subroutine test_named

  subroutine test_refused()
    call refuse([1.0_wp, 0.0_wp], 'two openings')
    call refuse([0.0_wp, 0.0_wp, 1.0_wp, 100.0_wp], 'larger than 0 m')
    call refuse([1.0_wp, 2.0_wp, 2.0_wp, 100.0_wp], 'begin with')
    call refuse([1.0_wp, 0.0_wp, 2.0_wp, 99.0_wp], 'end with')
    call refuse([1.0_wp, 0.0_wp, 1.0_wp, 50.0_wp, 2.0_wp, 100.0_wp], 'openings must rise')
    call refuse([1.0_wp, 0.0_wp, 2.0_wp, 50.0_wp, 3.0_wp, 40.0_wp, 4.0_wp, 100.0_wp], 'must not fall')
  end subroutine test_refused

  subroutine refuse(numbers, words)
    real(wp), intent(in) :: numbers(:)
    character(len=*), intent(in) :: words
    type(sieve_t) :: sieve
    character(len=:), allocatable :: message

    call sieve%begin(reshape(numbers, [2, size(numbers)/2]), 3, 0.0_wp, message)
    call t%check(allocated(message), 'refused: '//words)
    if (allocated(message)) call t%check(index(message, words) > 0, message//': '//words)
  end subroutine refuse
end program test_sieve
