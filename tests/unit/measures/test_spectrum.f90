!> Spectra: two sines give their peaks and the variance, whatever the length; and the file that a run writes.
program test_spectrum
  use harness, only: tests_t
  use sg_error, only: error_t
  use sg_fourier, only: fourier_is_available, squared_transform_grid
  use sg_kinds, only: wp, pi
  use sg_random, only: random_t
  use sg_samples, only: samples_t
  use sg_spectrum, only: power_spectrum
  use sg_spectrum_file, only: write_spectrum
  use sg_text, only: read_lines, text_t
  implicit none
  ! Sums of 10^3 terms of order one, and the rounding of the transform: 1e-14 expected.
  real(wp), parameter :: rounding = 1e-12_wp
  type(tests_t) :: t

  if (fourier_is_available()) then
    call test_two_sines()
    call test_variance()
    call test_file()
    call test_grid()
  else
    call t%equal(size(power_spectrum([1.0_wp, 2.0_wp])), 0, 'without FFTW a spectrum is empty')
  end if
  call t%finish()

contains

  !> Amplitudes 3 and 1 at 50 and 120 Hz on an offset, 1000 samples at 1 ms: a bin is 1 Hz.
  subroutine test_two_sines()
    integer, parameter :: n = 1000
    real(wp) :: series(n), power(0:n/2)
    integer :: j

    series = [(7 + 3*sin(2*pi*50*real(j, wp)/n) + sin(2*pi*120*real(j, wp)/n), j=1, n)]
    power = power_spectrum(series)
    ! A sine of amplitude a has the variance a^2/2; the Hann window spreads it over three bins as 1/6, 2/3, 1/6.
    call t%near(power(50), 9/2.0_wp*2/3.0_wp, 3*rounding, 'first peak')
    call t%near(power(120), 1/2.0_wp*2/3.0_wp, rounding, 'second peak')
    call t%near(sum(power(49:51)), 4.5_wp, 5*rounding, 'variance of the first sine')
    call t%near(sum(power(119:121)), 0.5_wp, rounding, 'variance of the second sine')
    call t%near(power(0), 0.0_wp, rounding, 'the mean is gone')
    call t%near(sum(power), 5.0_wp, 5*rounding, 'the sum is the variance')
  end subroutine test_two_sines

  !> Noise of any length, with a trend: the sum is the variance.
  subroutine test_variance()
    integer, parameter :: lengths(6) = [2, 3, 4, 97, 100, 1024]
    type(random_t) :: random
    real(wp), allocatable :: series(:), power(:)
    real(wp) :: variance
    integer :: i, j

    call random%seed(3)
    do i = 1, size(lengths)
      associate (n => lengths(i))
        series = [(random%normal() + real(j, wp)/real(n, wp), j=1, n)]
        variance = sum((series - sum(series)/real(n, wp))**2)/real(n, wp)
        power = power_spectrum(series)
        call t%equal(size(power), n/2 + 1, 'number of frequencies')
        call t%near(sum(power), variance, rounding, 'variance of noise')
        call t%check(all(power >= 0), 'no power is negative')
      end associate
    end do
    call t%check(.not. any(abs(power_spectrum([2.0_wp, 2.0_wp, 2.0_wp])) > 0), 'a constant has no power')
    call t%near(sum(power_spectrum([2.0_wp])), 0.0_wp, 0.0_wp, 'neither has a single sample')
    call t%equal(size(power_spectrum([real(wp) ::])), 0, 'no sample, no frequency')
  end subroutine test_variance

  !> A grid of random numbers against the sum that defines its transform, in the plane and in space.
  subroutine test_grid()
    integer, parameter :: shapes(3, 3) = reshape([6, 4, 1, 5, 3, 4, 1, 1, 1], [3, 3])
    type(random_t) :: random
    real(wp), allocatable :: grid(:, :, :), squares(:, :, :)
    complex(wp) :: sum_of_all
    real(wp) :: phase
    integer :: i, j, k, l, m, n, s

    call random%seed(5)
    do s = 1, size(shapes, 2)
      associate (a => shapes(1, s), b => shapes(2, s), c => shapes(3, s))
        grid = reshape([(random%normal(), i=1, a*b*c)], [a, b, c])
        call squared_transform_grid(grid, squares)
        call t%equal(size(squares), (a/2 + 1)*b*c, 'half of the transform of a grid')
        do k = 0, a/2
          do l = 0, b - 1
            do m = 0, c - 1
              sum_of_all = 0
              do i = 1, a
                do j = 1, b
                  do n = 1, c
                    phase = 2*pi*sum(real([k*(i - 1), l*(j - 1), m*(n - 1)], wp)/real(shapes(:, s), wp))
                    sum_of_all = sum_of_all + cmplx(grid(i, j, n), 0, wp)*exp(cmplx(0, -phase, wp))
                  end do
                end do
              end do
              call t%near(squares(k, l, m), abs(sum_of_all)**2, 100*rounding, 'transform of a grid')
            end do
          end do
        end do
      end associate
    end do
  end subroutine test_grid

  !> Frequencies and columns of the file.
  subroutine test_file()
    type(samples_t) :: samples
    type(error_t), allocatable :: error
    type(text_t), allocatable :: lines(:)
    real(wp) :: row(6)
    integer :: j

    samples%n = 8
    ! Room for more than was sampled, as growing leaves it.
    allocate (samples%value(5, 10), source=1.0_wp)
    samples%value(2, :8) = [(cos(pi*real(j, wp)/2), j=1, 8)]
    call write_spectrum(samples, 0.125_wp, 'spectrum.csv', error)
    call t%check(.not. allocated(error), 'the file is written')
    call read_lines('spectrum.csv', lines, error)
    call t%equal(size(lines), 6, 'a header and n/2 + 1 rows')
    call t%check(lines(1)%s == 'frequency_hz,kinetic_energy,wall_force_x,wall_force_y,momentum_x,momentum_y', 'header')
    read (lines(4)%s, *) row
    call t%near(row(1), 2.0_wp, 0.0_wp, 'frequency')
    call t%near(row(3), 0.5_wp*2/3, rounding, 'power')
    call t%near(row(4), 0.0_wp, 0.0_wp, 'power of a constant')
    call write_spectrum(samples, 0.125_wp, 'no_such_folder/spectrum.csv', error)
    call t%check(allocated(error), 'a missing folder is an error')
  end subroutine test_file
end program test_spectrum
