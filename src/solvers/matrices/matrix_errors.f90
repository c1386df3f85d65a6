!> Errors of an answer to a contact problem given by matrices: e1, e2 and e8 from W, q and r alone (doc/theory/errors.md).
module sg_matrix_errors
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  use sg_report, only: ratio
  use sg_sparse, only: multiply
  implicit none
  private
  public :: matrix_errors_t, errors_of, find_worst_contact, project_on_cone, most_share

  !> Share of what acts on a contact that it may leave undone in an answer
  real(wp), parameter :: most_share = 0.1_wp
  !> What acts below this part of the largest velocity is rounding, whatever contact it acts on
  real(wp), parameter :: rounding = 1e-13_wp

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

  !> The contact that leaves the largest share of what acts on it undone, normal part and friction apart: e1 compares all contacts
  !! with the largest, and friction times the slip may swallow a normal velocity. The share is about 1 where an impulse is missing.
  !!
  !! What acts along the normal is |q_N| + sum |W_Nb| |r_b|. What acts along the tangents is that, or as much of its counterpart as
  !! friction can hold.
  pure subroutine find_worst_contact(problem, r, contact, share)
    type(matrix_problem_t), intent(in) :: problem !! the problem
    real(wp), intent(in), contiguous :: r(:, :) !! answer [N s], shape (d, n)
    integer, intent(out) :: contact !! its number; 0 where all contacts obey
    real(wp), intent(out) :: share !! what it leaves undone over what acts on it
    real(wp) :: u(problem%d), acting(problem%d), own, least
    integer :: a, e

    contact = 0
    share = 0
    least = 0
    if (problem%n > 0) least = rounding*maxval(abs(problem%q))
    do a = 1, problem%n
      if (problem%w%diagonal(a) == 0) cycle
      u = problem%q(:, a)
      acting = abs(u) + least
      do e = problem%w%first(a), problem%w%first(a + 1) - 1
        u = u + matmul(problem%w%block(:, :, e), r(:, problem%w%column(e)))
        acting = acting + matmul(abs(problem%w%block(:, :, e)), abs(r(:, problem%w%column(e))))
      end do
      own = undone(problem%w%block(:, :, problem%w%diagonal(a)), r(:, a), u, acting, problem%friction(a))
      if (.not. own > share) cycle
      contact = a
      share = own
    end do
  end subroutine find_worst_contact

  !> Share of what acts on one contact that it leaves undone.
  pure real(wp) function undone(w, r, u, acting, friction) result(share)
    real(wp), intent(in) :: w(:, :), r(:), u(:), acting(:), friction
    real(wp) :: tried(size(r) - 1), mobility, radius, length, held
    integer :: k

    share = 0
    if (.not. w(1, 1) > 0) return
    mobility = 0
    do k = 2, size(r)
      mobility = max(mobility, w(k, k))
    end do
    share = ratio(abs(min(u(1), w(1, 1)*r(1))), acting(1))
    radius = friction*max(0.0_wp, r(1))
    if (.not. mobility > 0) return
    tried = mobility*r(2:) - u(2:)
    length = norm2(tried)
    if (length > mobility*radius) tried = tried*(mobility*radius/length)
    held = max(acting(1), min(norm2(acting(2:)), mobility*radius))
    share = max(share, ratio(norm2(mobility*r(2:) - tried), held))
  end function undone

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
