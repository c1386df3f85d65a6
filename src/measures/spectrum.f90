!> Power spectrum of an evenly sampled series (doc/theory/indicators.md, "Spectrum").
module sg_spectrum
  use sg_fourier, only: squared_transform
  use sg_kinds, only: wp, pi
  implicit none
  private
  public :: power_spectrum

contains

  !> Power at the frequencies k/(n h), k = 0 to n/2, in the unit of the series squared; the sum is the variance of the series.
  !! Empty where the program has no Fourier transform.
  function power_spectrum(series) result(power)
    real(wp), intent(in) :: series(:) !! samples at the same distance h in time, in any unit
    real(wp), allocatable :: power(:)
    real(wp) :: deviation(size(series))
    integer :: n, j

    n = size(series)
    deviation = series - sum(series)/real(max(n, 1), wp)
    power = squared_transform([(deviation(j)*(1 - cos(2*pi*real(j - 1, wp)/real(n, wp)))/2, j=1, n)])
    if (size(power) == 0) return
    ! Each frequency between zero and that of Nyquist stands for its negative, too.
    power(2:(n + 1)/2) = 2*power(2:(n + 1)/2)
    if (sum(power) > 0) power = power*(sum(deviation**2)/real(n, wp)/sum(power))
  end function power_spectrum
end module sg_spectrum
