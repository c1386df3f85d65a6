!> Factors of a full matrix, LU with partial pivoting or Cholesky: for small systems, and for builds without a sparse library.
module sg_dense_factor
  use sg_kinds, only: wp
  implicit none
  private
  public :: dense_factorise, dense_solve, dense_cholesky, dense_cholesky_solve

contains

  !> Replace a matrix by its factors, P A = L U; the diagonal of L, all ones, is not kept.
  pure subroutine dense_factorise(a, pivot, is_singular)
    real(wp), intent(inout), contiguous :: a(:, :) !! matrix, then L below the diagonal and U above, shape (n, n)
    integer, intent(out) :: pivot(:) !! row that row k was exchanged with, shape (n)
    logical, intent(out) :: is_singular !! is a pivot zero?
    real(wp) :: swapped(size(a, 2))
    integer :: n, k, j, p

    n = size(a, 1)
    is_singular = .false.
    do k = 1, n
      p = k - 1 + maxloc(abs(a(k:, k)), 1)
      pivot(k) = p
      if (.not. abs(a(p, k)) > 0) then
        is_singular = .true.
        return
      end if
      if (p /= k) then
        swapped = a(k, :)
        a(k, :) = a(p, :)
        a(p, :) = swapped
      end if
      a(k + 1:, k) = a(k + 1:, k)/a(k, k)
      do j = k + 1, n
        if (abs(a(k, j)) > 0) a(k + 1:, j) = a(k + 1:, j) - a(k, j)*a(k + 1:, k)
      end do
    end do
  end subroutine dense_factorise

  !> Solve A x = b by the factors.
  pure subroutine dense_solve(a, pivot, x)
    real(wp), intent(in), contiguous :: a(:, :) !! factors, shape (n, n)
    integer, intent(in) :: pivot(:) !! exchanged rows
    real(wp), intent(inout), contiguous :: x(:) !! b, then x, shape (n)
    integer :: k, n
    real(wp) :: swapped

    n = size(a, 1)
    do k = 1, n
      swapped = x(k)
      x(k) = x(pivot(k))
      x(pivot(k)) = swapped
    end do
    do k = 1, n
      x(k + 1:) = x(k + 1:) - x(k)*a(k + 1:, k)
    end do
    do k = n, 1, -1
      x(k) = x(k)/a(k, k)
      x(:k - 1) = x(:k - 1) - x(k)*a(:k - 1, k)
    end do
  end subroutine dense_solve

  !> Replace the lower triangle of a symmetric positive definite matrix by L of A = L L^T; the rest is not read.
  pure subroutine dense_cholesky(a, lost)
    real(wp), intent(inout), contiguous :: a(:, :) !! matrix, then L, shape (n, n)
    integer, intent(out) :: lost !! column at which the matrix proves not to be positive definite; 0 where it is
    integer :: n, k, j

    n = size(a, 1)
    lost = 0
    do k = 1, n
      if (.not. a(k, k) > 0) then
        lost = k
        return
      end if
      a(k, k) = sqrt(a(k, k))
      a(k + 1:, k) = a(k + 1:, k)/a(k, k)
      do j = k + 1, n
        if (abs(a(j, k)) > 0) a(j:, j) = a(j:, j) - a(j, k)*a(j:, k)
      end do
    end do
  end subroutine dense_cholesky

  !> Solve A x = b by L.
  pure subroutine dense_cholesky_solve(a, x)
    real(wp), intent(in), contiguous :: a(:, :) !! L in the lower triangle, shape (n, n)
    real(wp), intent(inout), contiguous :: x(:) !! b, then x, shape (n)
    integer :: k, n

    n = size(a, 1)
    do k = 1, n
      x(k) = x(k)/a(k, k)
      x(k + 1:) = x(k + 1:) - x(k)*a(k + 1:, k)
    end do
    do k = n, 1, -1
      x(k) = (x(k) - dot_product(a(k + 1:, k), x(k + 1:)))/a(k, k)
    end do
  end subroutine dense_cholesky_solve
end module sg_dense_factor
