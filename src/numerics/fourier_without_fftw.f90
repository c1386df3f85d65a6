!> A build without a Fourier transform: decks that ask for spectra are refused when they are read.
submodule(sg_fourier) fourier_without_fftw
  use sg_error, only: fail
  implicit none

contains

  module procedure fourier_is_available
  is_available = .false.
  end procedure fourier_is_available

  module procedure find_fourier
  call fail(error, 'this program was built without FFTW, which spectra need')
  end procedure find_fourier

  module procedure squared_transform
  allocate (squares(0))
  end procedure squared_transform

  module procedure squared_transform_grid
  allocate (squares(0:size(grid, 1)/2, 0:size(grid, 2) - 1, 0:size(grid, 3) - 1), source=0.0_wp)
  end procedure squared_transform_grid
end submodule fourier_without_fftw
