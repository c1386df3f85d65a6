!> A contact problem without units: what solvers that mix impulses and velocities work on.
!!
!! r = scale_a r', u = (size of q/scale of W) u': each contact gets one factor, so that cones stay cones, the diagonal blocks of
!! W have mean diagonal 1, and q has root mean square 1.
module sg_block_scaling
  use sg_kinds, only: wp
  use sg_matrix_problem, only: matrix_problem_t
  implicit none
  private
  public :: scale_problem

contains

  !> The problem without units, and the impulse [N s] that 1 stands for at each contact.
  pure subroutine scale_problem(problem, scaled, scale)
    type(matrix_problem_t), intent(in) :: problem !! any problem
    type(matrix_problem_t), intent(out) :: scaled !! the same without units; no global form
    real(wp), intent(out) :: scale(:) !! impulse of contact a is scale(a) times that of `scaled` [N s], shape (n)
    real(wp) :: typical, q_size
    integer :: a, e, k

    do a = 1, problem%n
      scale(a) = 0
      e = problem%w%diagonal(a)
      if (e == 0) cycle
      do k = 1, problem%d
        scale(a) = scale(a) + max(problem%w%block(k, k, e), 0.0_wp)/real(problem%d, wp)
      end do
    end do
    typical = sum(scale)/real(max(problem%n, 1), wp)
    if (.not. typical > 0) typical = 1
    where (.not. scale > epsilon(typical)**2*typical) scale = typical
    scale = 1/sqrt(scale)

    scaled%d = problem%d
    scaled%n = problem%n
    scaled%is_symmetric = problem%is_symmetric
    scaled%friction = problem%friction
    scaled%w = problem%w
    allocate (scaled%q(problem%d, problem%n), scaled%r(problem%d, problem%n))
    do a = 1, problem%n
      do e = problem%w%first(a), problem%w%first(a + 1) - 1
        scaled%w%block(:, :, e) = problem%w%block(:, :, e)*scale(a)*scale(problem%w%column(e))
      end do
      scaled%q(:, a) = problem%q(:, a)*scale(a)
    end do
    q_size = sqrt(sum(scaled%q**2)/real(max(problem%n, 1), wp))
    if (.not. q_size > 0) q_size = 1
    scaled%q = scaled%q/q_size
    scale = scale*q_size
    do a = 1, problem%n
      scaled%r(:, a) = problem%r(:, a)/scale(a)
    end do
  end subroutine scale_problem
end module sg_block_scaling
