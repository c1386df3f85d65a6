!> The discrete Fourier transform of a real series or of reals on a grid, without naming a library.
!!
!! The bodies live in `fourier_with_fftw` or `fourier_without_fftw`, chosen by CMake.
module sg_fourier
  use sg_error, only: error_t
  use sg_kinds, only: wp
  implicit none
  private
  public :: find_fourier, fourier_is_available, squared_transform, squared_transform_grid

  interface
    !> Was the program built with a Fourier transform?
    module function fourier_is_available() result(is_available)
      logical :: is_available
    end function fourier_is_available

    !> Make sure that the transform is there, before anything counts on it.
    module subroutine find_fourier(error)
      type(error_t), allocatable, intent(out) :: error !! set when it is not, or when the program was built without
    end subroutine find_fourier

    !> |X_k|^2 of X_k = sum over j of x_j exp(-2 pi i j k/n), j from 0, for k = 0 to n/2; nothing where there is no transform.
    module function squared_transform(series) result(squares)
      real(wp), intent(in) :: series(:) !! x, in any unit
      real(wp), allocatable :: squares(:) !! shape (n/2 + 1), in that unit squared
    end function squared_transform

    !> |X_klm|^2 of the transform of reals on a grid, for the first index from 0 to n/2 (the rest is its mirror image); all zero
    !! where there is no transform.
    module subroutine squared_transform_grid(grid, squares)
      real(wp), intent(in), contiguous :: grid(:, :, :) !! in any unit, periodic along each axis; one layer in the plane
      real(wp), allocatable, intent(out) :: squares(:, :, :) !! shape (0:n/2, 0:, 0:), in that unit squared
    end subroutine squared_transform_grid
  end interface
end module sg_fourier
