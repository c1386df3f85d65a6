!> Gauss-Seidel sweeps over a stored W of d by d blocks: each contact in turn solves its local problem, the others held.
!!
!! W is used whole, row by row, so that it need not be symmetric. Kernels: numbers in, numbers out.
module sg_matrix_sweeps
  use sg_kinds, only: wp, i4
  use sg_local_coulomb, only: solve_local_2, solve_local_3
  use sg_matrix_problem, only: matrix_problem_t
  implicit none
  private
  public :: sweep

contains

  !> One sweep over all contacts in their order, or from the last to the first.
  pure subroutine sweep(problem, r, is_backward)
    type(matrix_problem_t), intent(in) :: problem !! W, q and friction
    real(wp), intent(inout), contiguous :: r(:, :) !! impulses, shape (d, n)
    logical, intent(in), optional :: is_backward !! last contact first?
    integer :: bounds(3)

    bounds = [1, problem%n, 1]
    if (present(is_backward)) then
      if (is_backward) bounds = [problem%n, 1, -1]
    end if
    associate (w => problem%w)
      if (problem%d == 2) then
        call sweep_2(bounds, w%first, w%column, w%diagonal, w%block, problem%q, problem%friction, r)
      else
        call sweep_3(bounds, w%first, w%column, w%diagonal, w%block, problem%q, problem%friction, r)
      end if
    end associate
  end subroutine sweep

  !> In the plane.
  pure subroutine sweep_2(bounds, first, column, diagonal, block, q, friction, r)
    integer, intent(in) :: bounds(3)
    integer(i4), intent(in), contiguous :: first(:), column(:), diagonal(:)
    real(wp), intent(in), contiguous :: block(:, :, :), q(:, :), friction(:)
    real(wp), intent(inout), contiguous :: r(:, :)
    real(wp) :: u(2)
    integer :: a, b, e

    do a = bounds(1), bounds(2), bounds(3)
      if (diagonal(a) == 0) cycle
      u = q(:, a)
      do e = first(a), first(a + 1) - 1
        if (e == diagonal(a)) cycle
        b = column(e)
        u(1) = u(1) + block(1, 1, e)*r(1, b) + block(1, 2, e)*r(2, b)
        u(2) = u(2) + block(2, 1, e)*r(1, b) + block(2, 2, e)*r(2, b)
      end do
      call solve_local_2(block(:, :, diagonal(a)), u, friction(a), r(:, a))
    end do
  end subroutine sweep_2

  !> In space.
  pure subroutine sweep_3(bounds, first, column, diagonal, block, q, friction, r)
    integer, intent(in) :: bounds(3)
    integer(i4), intent(in), contiguous :: first(:), column(:), diagonal(:)
    real(wp), intent(in), contiguous :: block(:, :, :), q(:, :), friction(:)
    real(wp), intent(inout), contiguous :: r(:, :)
    real(wp) :: u(3)
    integer :: a, b, e

    do a = bounds(1), bounds(2), bounds(3)
      if (diagonal(a) == 0) cycle
      u = q(:, a)
      do e = first(a), first(a + 1) - 1
        if (e == diagonal(a)) cycle
        b = column(e)
        u(1) = u(1) + block(1, 1, e)*r(1, b) + block(1, 2, e)*r(2, b) + block(1, 3, e)*r(3, b)
        u(2) = u(2) + block(2, 1, e)*r(1, b) + block(2, 2, e)*r(2, b) + block(2, 3, e)*r(3, b)
        u(3) = u(3) + block(3, 1, e)*r(1, b) + block(3, 2, e)*r(2, b) + block(3, 3, e)*r(3, b)
      end do
      call solve_local_3(block(:, :, diagonal(a)), u, friction(a), r(:, a))
    end do
  end subroutine sweep_3
end module sg_matrix_sweeps
