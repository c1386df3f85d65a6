!> The transform by FFTW 3, through the calls of its Fortran 2003 interface. FFTW is opened by the first transform.
submodule(sg_fourier) fourier_with_fftw
  use, intrinsic :: iso_c_binding, only: c_double, c_double_complex, c_f_procpointer, c_funptr, c_int, c_ptr
  use sg_library, only: find_procedures
  use sg_library_files, only: fftw_file
  implicit none

  !> Take a good plan without trying: a series is transformed once
  integer(c_int), parameter :: fftw_estimate = 64
  !> FFTW's procedures, and their places in a list of addresses
  character(len=*), parameter :: names(4) = [character(len=20) :: 'fftw_plan_dft_r2c_1d', 'fftw_plan_dft_r2c_3d', &
                                             'fftw_execute_dft_r2c', 'fftw_destroy_plan']
  integer, parameter :: plan_1d = 1, plan_3d = 2, execute_plan = 3, destroy_plan = 4

  abstract interface
    function fftw_plan_dft_r2c_1d(n, in, out, flags) bind(c) result(plan)
      import :: c_double, c_double_complex, c_int, c_ptr
      integer(c_int), value :: n, flags
      real(c_double), intent(inout) :: in(*)
      complex(c_double_complex), intent(inout) :: out(*)
      type(c_ptr) :: plan
    end function fftw_plan_dft_r2c_1d
    function fftw_plan_dft_r2c_3d(n_slow, n_middle, n_fast, in, out, flags) bind(c) result(plan)
      import :: c_double, c_double_complex, c_int, c_ptr
      integer(c_int), value :: n_slow, n_middle, n_fast, flags
      real(c_double), intent(inout) :: in(*)
      complex(c_double_complex), intent(inout) :: out(*)
      type(c_ptr) :: plan
    end function fftw_plan_dft_r2c_3d
    subroutine fftw_execute_dft_r2c(plan, in, out) bind(c)
      import :: c_double, c_double_complex, c_ptr
      type(c_ptr), value :: plan
      real(c_double), intent(inout) :: in(*)
      complex(c_double_complex), intent(inout) :: out(*)
    end subroutine fftw_execute_dft_r2c
    subroutine fftw_destroy_plan(plan) bind(c)
      import :: c_ptr
      type(c_ptr), value :: plan
    end subroutine fftw_destroy_plan
  end interface

contains

  module procedure fourier_is_available
  is_available = .true.
  end procedure fourier_is_available

  module procedure find_fourier
  type(c_funptr) :: address(size(names))

  call find_all(address, error)
  end procedure find_fourier

  !> Where FFTW's procedures are.
  subroutine find_all(address, error)
    type(c_funptr), intent(out) :: address(:)
    type(error_t), allocatable, intent(out) :: error

    call find_procedures('FFTW, which spectra need,', fftw_file, names, address, error)
  end subroutine find_all

  module procedure squared_transform
  procedure(fftw_plan_dft_r2c_1d), pointer :: make_plan
  type(c_funptr) :: address(size(names))
  type(error_t), allocatable :: error
  real(c_double), allocatable :: in(:)
  complex(c_double_complex), allocatable :: out(:)
  type(c_ptr) :: plan

  call find_all(address, error)
  if (size(series) == 0 .or. allocated(error)) then
    allocate (squares(0))
    return
  end if
  allocate (in(size(series)), out(size(series)/2 + 1))
  call c_f_procpointer(address(plan_1d), make_plan)
  plan = make_plan(int(size(series), c_int), in, out, fftw_estimate)
  in = series
  call follow_plan(address, plan, in, out)
  squares = real(out, wp)**2 + aimag(out)**2
  end procedure squared_transform

  module procedure squared_transform_grid
  procedure(fftw_plan_dft_r2c_3d), pointer :: make_plan
  type(c_funptr) :: address(size(names))
  type(error_t), allocatable :: error
  real(c_double), allocatable :: in(:, :, :)
  complex(c_double_complex), allocatable :: out(:, :, :)
  type(c_ptr) :: plan
  integer :: n(3)

  n = shape(grid)
  allocate (in(n(1), n(2), n(3)), out(0:n(1)/2, 0:n(2) - 1, 0:n(3) - 1))
  allocate (squares(0:n(1)/2, 0:n(2) - 1, 0:n(3) - 1), source=0.0_wp)
  call find_all(address, error)
  if (size(grid) == 0 .or. allocated(error)) return
  ! The library counts from the axis that varies slowest.
  call c_f_procpointer(address(plan_3d), make_plan)
  plan = make_plan(int(n(3), c_int), int(n(2), c_int), int(n(1), c_int), in, out, fftw_estimate)
  in = grid
  call follow_plan(address, plan, in, out)
  squares = real(out, wp)**2 + aimag(out)**2
  end procedure squared_transform_grid

  !> Transform as planned, and give the plan back.
  subroutine follow_plan(address, plan, in, out)
    type(c_funptr), intent(in) :: address(:)
    type(c_ptr), intent(in) :: plan
    real(c_double), intent(inout) :: in(*)
    complex(c_double_complex), intent(inout) :: out(*)
    procedure(fftw_execute_dft_r2c), pointer :: execute
    procedure(fftw_destroy_plan), pointer :: destroy

    call c_f_procpointer(address(execute_plan), execute)
    call c_f_procpointer(address(destroy_plan), destroy)
    call execute(plan, in, out)
    call destroy(plan)
  end subroutine follow_plan
end submodule fourier_with_fftw
