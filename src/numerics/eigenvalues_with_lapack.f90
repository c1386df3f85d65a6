!> Eigenvalues by DGEEV of LAPACK [AndersonEtAl1999]: reduction to Hessenberg form and shifted QR iterations. LAPACK is opened
!! by the first call.
submodule(sg_eigenvalues) eigenvalues_with_lapack
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_f_procpointer, c_funptr, c_int, c_size_t
  use sg_error, only: exit_failure, fail
  use sg_library, only: find_procedures
  use sg_library_files, only: lapack_file
  implicit none

  !> Reals of workspace per row of the matrix: four do, more are faster
  integer, parameter :: workspace = 34

  abstract interface
    !> The last two arguments are the lengths of the texts, which Fortran compilers pass by themselves.
    subroutine dgeev(left, right, n, a, lda, wr, wi, vl, ldvl, vr, ldvr, work, lwork, info, left_length, right_length) bind(c)
      import :: c_char, c_double, c_int, c_size_t
      character(kind=c_char), intent(in) :: left(*), right(*)
      integer(c_int), intent(in) :: n, lda, ldvl, ldvr, lwork
      real(c_double), intent(inout) :: a(*)
      real(c_double), intent(out) :: wr(*), wi(*), vl(*), vr(*), work(*)
      integer(c_int), intent(out) :: info
      integer(c_size_t), value :: left_length, right_length
    end subroutine dgeev
  end interface

contains

  module procedure eigenvalues_are_available
  are_available = .true.
  end procedure eigenvalues_are_available

  module procedure find_eigenvalues
  procedure(dgeev), pointer :: solve
  type(c_funptr) :: address(1)
  real(c_double), allocatable :: a(:, :), real_part(:), imaginary_part(:), work(:)
  real(c_double) :: no_left(1), no_right(1)
  integer(c_int) :: n, info

  n = size(matrix, 1)
  values = 0
  if (n == 0) return
  call find_procedures('LAPACK, which eigenvalues need,', lapack_file, ['dgeev_'], address, error)
  if (allocated(error)) return
  call c_f_procpointer(address(1), solve)
  allocate (a, source=matrix)
  allocate (real_part(n), imaginary_part(n), work(workspace*n), source=0.0_c_double)
  call solve(['N'], ['N'], n, a, n, real_part, imaginary_part, no_left, 1_c_int, no_right, 1_c_int, work, &
             size(work, kind=c_int), info, 1_c_size_t, 1_c_size_t)
  if (info /= 0) then
    call fail(error, 'the eigenvalues of a matrix are not found: is a value of it not finite?', code=exit_failure)
  else
    values = cmplx(real_part, imaginary_part, wp)
  end if
  end procedure find_eigenvalues
end submodule eigenvalues_with_lapack
