!> The transform by FFTW 3, through the calls of its Fortran 2003 interface.
submodule(sg_fourier) fourier_with_fftw
  use, intrinsic :: iso_c_binding, only: c_double, c_double_complex, c_int, c_ptr
  implicit none

  !> Take a good plan without trying: a series is transformed once
  integer(c_int), parameter :: fftw_estimate = 64

  interface
    function fftw_plan_dft_r2c_1d(n, in, out, flags) bind(c, name='fftw_plan_dft_r2c_1d') result(plan)
      import :: c_double, c_double_complex, c_int, c_ptr
      integer(c_int), value :: n, flags
      real(c_double), intent(inout) :: in(*)
      complex(c_double_complex), intent(inout) :: out(*)
      type(c_ptr) :: plan
    end function fftw_plan_dft_r2c_1d
    function fftw_plan_dft_r2c_3d(n_slow, n_middle, n_fast, in, out, flags) bind(c, name='fftw_plan_dft_r2c_3d') result(plan)
      import :: c_double, c_double_complex, c_int, c_ptr
      integer(c_int), value :: n_slow, n_middle, n_fast, flags
      real(c_double), intent(inout) :: in(*)
      complex(c_double_complex), intent(inout) :: out(*)
      type(c_ptr) :: plan
    end function fftw_plan_dft_r2c_3d
    subroutine fftw_execute_dft_r2c(plan, in, out) bind(c, name='fftw_execute_dft_r2c')
      import :: c_double, c_double_complex, c_ptr
      type(c_ptr), value :: plan
      real(c_double), intent(inout) :: in(*)
      complex(c_double_complex), intent(inout) :: out(*)
    end subroutine fftw_execute_dft_r2c
    subroutine fftw_destroy_plan(plan) bind(c, name='fftw_destroy_plan')
      import :: c_ptr
      type(c_ptr), value :: plan
    end subroutine fftw_destroy_plan
  end interface

contains

  module procedure fourier_is_available
  is_available = .true.
  end procedure fourier_is_available

  module procedure squared_transform
  real(c_double), allocatable :: in(:)
  complex(c_double_complex), allocatable :: out(:)
  type(c_ptr) :: plan

  if (size(series) == 0) then
    allocate (squares(0))
    return
  end if
  allocate (in(size(series)), out(size(series)/2 + 1))
  plan = fftw_plan_dft_r2c_1d(int(size(series), c_int), in, out, fftw_estimate)
  in = series
  call fftw_execute_dft_r2c(plan, in, out)
  call fftw_destroy_plan(plan)
  squares = real(out, wp)**2 + aimag(out)**2
  end procedure squared_transform

  module procedure squared_transform_grid
  real(c_double), allocatable :: in(:, :, :)
  complex(c_double_complex), allocatable :: out(:, :, :)
  type(c_ptr) :: plan
  integer :: n(3)

  n = shape(grid)
  allocate (in(n(1), n(2), n(3)), out(0:n(1)/2, 0:n(2) - 1, 0:n(3) - 1))
  allocate (squares(0:n(1)/2, 0:n(2) - 1, 0:n(3) - 1))
  if (size(grid) == 0) return
  ! The library counts from the axis that varies slowest.
  plan = fftw_plan_dft_r2c_3d(int(n(3), c_int), int(n(2), c_int), int(n(1), c_int), in, out, fftw_estimate)
  in = grid
  call fftw_execute_dft_r2c(plan, in, out)
  call fftw_destroy_plan(plan)
  squares = real(out, wp)**2 + aimag(out)**2
  end procedure squared_transform_grid
end submodule fourier_with_fftw
