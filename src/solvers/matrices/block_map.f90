!> The natural map of Coulomb's law, contact by contact: r - P_K(r - rho (u + (friction |u_T|, 0))), zero at a solution.
module sg_block_map
  use sg_kinds, only: wp
  use sg_natural_map, only: project_point => project
  implicit none
  private
  public :: natural_map, project_all, project

contains

  !> The map of all contacts.
  pure subroutine natural_map(friction, rho, r, u, f)
    real(wp), intent(in), contiguous :: friction(:) !! Coulomb coefficients, shape (n)
    real(wp), intent(in) :: rho !! impulse per velocity
    real(wp), intent(in), contiguous :: r(:, :) !! impulses, shape (d, n)
    real(wp), intent(in), contiguous :: u(:, :) !! relative velocities, shape (d, n)
    real(wp), intent(out), contiguous :: f(:, :) !! value of the map, shape (d, n)
    real(wp) :: x(size(r, 1))
    integer :: a

    do a = 1, size(friction)
      x = r(:, a) - rho*u(:, a)
      x(1) = x(1) - rho*friction(a)*sqrt(sum(u(2:, a)**2))
      call project(friction(a), x)
      f(:, a) = r(:, a) - x
    end do
  end subroutine natural_map

  !> Bring all impulses into their cones, each to the nearest point.
  pure subroutine project_all(friction, r)
    real(wp), intent(in), contiguous :: friction(:) !! Coulomb coefficients, shape (n)
    real(wp), intent(inout), contiguous :: r(:, :) !! impulses, shape (d, n)
    integer :: a

    do a = 1, size(friction)
      call project(friction(a), r(:, a))
    end do
  end subroutine project_all

  !> Replace x by the nearest point of |x_T| <= friction x_N.
  pure subroutine project(friction, x)
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(inout) :: x(:) !! normal first, shape (d)
    real(wp) :: length, normal, tangential

    length = sqrt(sum(x(2:)**2))
    ! A point of the cone stays to the last digit.
    if (x(1) > 0 .and. length <= friction*x(1)) return
    call project_point(x(1), length, friction, normal, tangential)
    x(1) = normal
    x(2:) = x(2:)*(tangential/max(length, tiny(1.0_wp)))
  end subroutine project
end module sg_block_map
