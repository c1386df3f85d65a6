!> spectrum.csv: power spectra of what was sampled during a run, one row a frequency (doc/guide/results.md).
module sg_spectrum_file
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_samples, only: samples_t, series_names
  use sg_spectrum, only: power_spectrum
  use sg_text, only: to_text
  use sg_text_files, only: replace_file
  implicit none
  private
  public :: write_spectrum

  !> Most characters of a number and what follows it
  integer, parameter :: cell = 26

contains

  !> Write the spectra; nothing where no step was sampled.
  subroutine write_spectrum(samples, h, file, error)
    type(samples_t), intent(in) :: samples !! samples of the run
    real(wp), intent(in) :: h !! time step [s]
    character(len=*), intent(in) :: file !! path of the file
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    character(len=:), allocatable :: text
    real(wp), allocatable :: power(:, :)
    character(len=14), allocatable :: names(:)
    integer :: s, k, length, n_series

    if (samples%n == 0) return
    n_series = size(samples%value, 1)
    names = series_names((n_series - 1)/2)
    allocate (power(0:samples%n/2, n_series))
    do s = 1, n_series
      power(:, s) = power_spectrum(samples%value(s, :samples%n))
    end do
    allocate (character(len=(samples%n/2 + 2)*(n_series + 1)*cell) :: text)
    length = 0
    call put('frequency_hz')
    do s = 1, n_series
      call put(','//trim(names(s)))
    end do
    do k = 0, samples%n/2
      call put(new_line('a')//to_text(real(k, wp)/(h*real(samples%n, wp))))
      do s = 1, n_series
        call put(','//to_text(power(k, s)))
      end do
    end do
    call put(new_line('a'))
    call replace_file(file, text(:length), error)

  contains

    subroutine put(word)
      character(len=*), intent(in) :: word

      text(length + 1:length + len(word)) = word
      length = length + len(word)
    end subroutine put
  end subroutine write_spectrum
end module sg_spectrum_file
