!> Newton's step for the natural map of Coulomb's law, with a proximal term: f = r - P_K(r - rho (u + (friction |u_T|, 0))),
!! where u = W r + q + alpha (r - centre) (doc/theory/solvers_proximal.md).
!!
!! f' = 1 - J (1 - rho G (W + alpha)), with J the derivative of the projection and G that of u + (friction |u_T|, 0); both are
!! blocks on the diagonal. Contacts with J = 0 are open: their step is -r, and the linear system is that of the others.
module sg_newton_map
  use sg_error, only: error_t
  use sg_kinds, only: wp, i4
  use sg_matrix_problem, only: matrix_problem_t
  use sg_sparse, only: sparse_t
  use sg_sparse_factor, only: sparse_factor_t
  implicit none
  private
  public :: newton_step, newton_sweeps, derivative_of_projection

  !> Time of a step beside its factors, in sweeps: the matrix, and the map at the point reached
  integer, parameter :: newton_sweeps = 6

contains

  !> The step of Newton's method: step = -f'^-1 f.
  subroutine newton_step(problem, alpha, rho, r, u, f, factors, step, error)
    type(matrix_problem_t), intent(in) :: problem !! problem without units
    real(wp), intent(in) :: alpha !! weight of the proximal term
    real(wp), intent(in) :: rho !! impulse per velocity in the map
    real(wp), intent(in), contiguous :: r(:, :) !! impulses, shape (d, n)
    real(wp), intent(in), contiguous :: u(:, :) !! velocities with the proximal term, shape (d, n)
    real(wp), intent(in), contiguous :: f(:, :) !! the map there, shape (d, n)
    type(sparse_factor_t), intent(inout) :: factors !! factors; freed by the caller
    real(wp), intent(out), contiguous :: step(:, :) !! the step, shape (d, n)
    type(error_t), allocatable, intent(out) :: error !! why the system could not be solved
    type(sparse_t) :: matrix
    real(wp), allocatable :: jg(:, :, :), stay(:, :, :), right(:, :), x(:)
    integer, allocatable :: place(:)
    integer :: a

    allocate (jg(problem%d, problem%d, problem%n), stay(problem%d, problem%d, problem%n), place(problem%n))
    call linearise(problem, rho, r, u, jg, stay, place)
    allocate (right(problem%d, max(maxval(place), 0)), x(problem%d*max(maxval(place), 0)))
    step = -f
    call assemble(problem, alpha, jg, stay, place, step, right, matrix)
    if (size(x) == 0) return
    call factors%factorise(matrix, error)
    if (allocated(error)) return
    call factors%solve(reshape(right, [size(right)]), x)
    do a = 1, problem%n
      if (place(a) > 0) step(:, a) = x(problem%d*(place(a) - 1) + 1:problem%d*place(a))
    end do
  end subroutine newton_step

  !> Of each contact: rho J G, 1 - J, and its place among those that are not open (0: open).
  pure subroutine linearise(problem, rho, r, u, jg, stay, place)
    type(matrix_problem_t), intent(in) :: problem
    real(wp), intent(in) :: rho
    real(wp), intent(in), contiguous :: r(:, :), u(:, :)
    real(wp), intent(out), contiguous :: jg(:, :, :), stay(:, :, :)
    integer, intent(out) :: place(:)
    real(wp) :: j(problem%d, problem%d), g(problem%d, problem%d), x(problem%d), tangential
    integer :: a, k, last
    logical :: is_open

    last = 0
    do a = 1, problem%n
      tangential = sqrt(sum(u(2:, a)**2))
      x = r(:, a) - rho*u(:, a)
      x(1) = x(1) - rho*problem%friction(a)*tangential
      call derivative_of_projection(problem%friction(a), x, j, is_open)
      place(a) = 0
      if (is_open .or. problem%w%diagonal(a) == 0) cycle
      last = last + 1
      place(a) = last
      g = 0
      stay(:, :, a) = -j
      do k = 1, problem%d
        g(k, k) = 1
        stay(k, k, a) = 1 - j(k, k)
      end do
      if (tangential > 0) g(1, 2:) = problem%friction(a)*u(2:, a)/tangential
      jg(:, :, a) = rho*matmul(j, g)
    end do
  end subroutine linearise

  !> Derivative of the projection on the cone |x_T| <= friction x_N.
  pure subroutine derivative_of_projection(friction, x, j, is_open)
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(in) :: x(:) !! point, normal first, shape (d)
    real(wp), intent(out) :: j(:, :) !! derivative, shape (d, d)
    logical, intent(out) :: is_open !! is the derivative zero?
    real(wp) :: tangential, direction(size(x) - 1), ratio
    integer :: k

    j = 0
    tangential = sqrt(sum(x(2:)**2))
    is_open = friction*tangential <= -x(1)
    if (is_open) return
    if (tangential <= friction*x(1)) then
      do k = 1, size(x)
        j(k, k) = 1
      end do
      return
    end if
    direction = x(2:)/tangential
    j(1, 1) = 1
    j(1, 2:) = friction*direction
    j(2:, 1) = friction*direction
    ! Across the direction of sliding the point turns with x.
    ratio = friction*(x(1) + friction*tangential)/tangential
    do k = 2, size(x)
      j(2:, k) = (friction**2 - ratio)*direction*direction(k - 1)
      j(k, k) = j(k, k) + ratio
    end do
    j = j/(1 + friction**2)
  end subroutine derivative_of_projection

  !> The matrix of the contacts that are not open, and its right-hand side.
  pure subroutine assemble(problem, alpha, jg, stay, place, step, right, matrix)
    type(matrix_problem_t), intent(in) :: problem
    real(wp), intent(in) :: alpha
    real(wp), intent(in), contiguous :: jg(:, :, :), stay(:, :, :), step(:, :)
    integer, intent(in) :: place(:)
    real(wp), intent(out), contiguous :: right(:, :)
    type(sparse_t), intent(out) :: matrix
    real(wp) :: block(problem%d, problem%d)
    integer :: a, b, e, k, l, row, entries, kept

    associate (w => problem%w, d => problem%d)
      matrix%n_rows = size(right)
      matrix%n_columns = size(right)
      allocate (matrix%first(size(right) + 1), matrix%column(entries_of(w%first, w%column, place)*d**2))
      allocate (matrix%value(size(matrix%column)))
      entries = 0
      matrix%first(1) = 1
      do a = 1, problem%n
        if (place(a) == 0) cycle
        right(:, place(a)) = step(:, a)
        kept = 0
        do e = w%first(a), w%first(a + 1) - 1
          if (place(w%column(e)) > 0) kept = kept + 1
        end do
        l = 0
        do e = w%first(a), w%first(a + 1) - 1
          b = w%column(e)
          block = matmul(jg(:, :, a), w%block(:, :, e))
          if (place(b) == 0) then
            right(:, place(a)) = right(:, place(a)) - matmul(block, step(:, b))
            cycle
          end if
          if (b == a) block = block + stay(:, :, a) + alpha*jg(:, :, a)
          do row = 1, d
            do k = 1, d
              matrix%column(entries + (row - 1)*kept*d + l + k) = int(d*(place(b) - 1) + k, i4)
              matrix%value(entries + (row - 1)*kept*d + l + k) = block(row, k)
            end do
          end do
          l = l + d
        end do
        do row = 1, d
          matrix%first(d*(place(a) - 1) + row + 1) = int(entries + row*kept*d, i4) + 1_i4
        end do
        entries = entries + kept*d**2
      end do
    end associate
  end subroutine assemble

  !> Blocks whose row and column both belong to contacts that are not open.
  pure integer function entries_of(first, column, place) result(n)
    integer(i4), intent(in) :: first(:), column(:)
    integer, intent(in) :: place(:)
    integer :: a

    n = 0
    do a = 1, size(place)
      if (place(a) > 0) n = n + count(place(column(first(a):first(a + 1) - 1)) > 0)
    end do
  end function entries_of
end module sg_newton_map
