!> Errors of an answer to a contact problem given by matrices: e1, e2 and e8 from W, q and r alone (doc/theory/errors.md).
module sg_matrix_errors
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_report, only: ratio
  use sg_sparse, only: multiply
  implicit none
  private
  public :: matrix_errors_t, errors_of, project_on_cone, natural_map_squares

  !> Errors of one answer
  type :: matrix_errors_t
    !> Natural map with rho = 1: over |q|, and over the largest of |q|, |r|, |W r + q|
    real(wp) :: e1 = 0, e2 = 0
    !> Natural map with rho_a = 1/lambda_max(W_aa), over |r|
    real(wp) :: e8 = 0
  end type matrix_errors_t

contains

  !> Errors of an answer.
  pure function errors_of(problem, r) result(errors)
    type(matrix_problem_t), intent(in) :: problem !! the problem
    real(wp), intent(in), contiguous :: r(:, :) !! answer [N s], shape (d, n)
    type(matrix_errors_t) :: errors
    real(wp), allocatable :: u(:, :)
    real(wp) :: squares(2), q_norm

    allocate (u(problem%d, problem%n))
    call multiply(problem%w, r, u)
    u = u + problem%q
    squares = natural_map_squares(problem, r, u)
    q_norm = norm2(problem%q)
    errors%e1 = ratio(sqrt(squares(1)), q_norm)
    errors%e2 = ratio(sqrt(squares(1)), max(q_norm, norm2(r), norm2(u)))
    errors%e8 = ratio(sqrt(squares(2)), norm2(r))
  end function errors_of

  !> Squares of the natural map over all contacts, with rho = 1 and with rho_a = 1/lambda_max(W_aa).
  pure function natural_map_squares(problem, r, u) result(squares)
    type(matrix_problem_t), intent(in) :: problem !! the problem
    real(wp), intent(in), contiguous :: r(:, :) !! impulses [N s], shape (d, n)
    real(wp), intent(in), contiguous :: u(:, :) !! relative velocities [m/s], shape (d, n)
    real(wp) :: squares(2), shifted(size(r, 1)), rho
    integer :: a

    squares = 0
    do a = 1, problem%n
      shifted = u(:, a)
      shifted(1) = shifted(1) + problem%friction(a)*norm2(u(2:, a))
      squares(1) = squares(1) + sum((r(:, a) - project_on_cone(r(:, a) - shifted, problem%friction(a)))**2)
      rho = 0
      if (problem%w%diagonal(a) > 0) rho = inverse_largest_eigenvalue(problem%w%block(:, :, problem%w%diagonal(a)))
      squares(2) = squares(2) + sum((r(:, a) - project_on_cone(r(:, a) - rho*shifted, problem%friction(a)))**2)
    end do
  end function natural_map_squares

  !> Nearest point of Coulomb's cone |x_T| <= friction x_N.
  pure function project_on_cone(x, friction) result(p)
    real(wp), intent(in) :: x(:) !! normal first
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp) :: p(size(x)), tangential

    tangential = norm2(x(2:))
    if (friction*tangential <= -x(1)) then
      p = 0
    else if (tangential <= friction*x(1)) then
      p = x
    else
      p(1) = (x(1) + friction*tangential)/(1 + friction**2)
      p(2:) = friction*p(1)*x(2:)/tangential
    end if
  end function project_on_cone

  !> 1/lambda_max of the symmetric part of a block; zero for a block of zeros.
  pure real(wp) function inverse_largest_eigenvalue(w) result(inverse)
    real(wp), intent(in) :: w(:, :)
    real(wp) :: s(size(w, 1), size(w, 1)), x(size(w, 1)), y(size(w, 1)), largest
    integer :: i

    s = (w + transpose(w))/2
    inverse = 0
    if (.not. maxval(abs(s)) > 0) return
    ! Powers of the matrix, squared and scaled, leave its largest eigenvector in every column that has a part of it.
    x = 0
    do i = 1, 20
      s = matmul(s, s)
      s = s/maxval(abs(s))
    end do
    x = s(:, maxloc(sum(s**2, 1), 1))
    y = matmul((w + transpose(w))/2, x)
    largest = dot_product(x, y)/dot_product(x, x)
    if (largest > 0) inverse = 1/largest
  end function inverse_largest_eigenvalue
end module sg_matrix_errors
