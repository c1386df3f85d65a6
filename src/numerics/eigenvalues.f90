!> Eigenvalues of a full matrix, without naming a library.
!!
!! The bodies live in `eigenvalues_with_lapack` or `eigenvalues_without_lapack`, chosen by CMake.
module sg_eigenvalues
  use sg_error, only: error_t
  use sg_kinds, only: wp
  implicit none
  private
  public :: eigenvalues_are_available, find_eigenvalues

  interface
    !> Was the program built with eigenvalues?
    module function eigenvalues_are_available() result(are_available)
      logical :: are_available
    end function eigenvalues_are_available

    !> All eigenvalues of a real matrix, in no order.
    module subroutine find_eigenvalues(matrix, values, error)
      real(wp), intent(in) :: matrix(:, :) !! any real matrix, shape (n, n)
      complex(wp), intent(out) :: values(:) !! its eigenvalues, in its unit, shape (n)
      type(error_t), allocatable, intent(out) :: error !! set when the library is missing, or does not find them
    end subroutine find_eigenvalues
  end interface
end module sg_eigenvalues
