!> Projection on Coulomb's cone |x_T| <= friction x_N (doc/theory/errors.md).
!!
!! `matrix_errors` has one of its own on purpose: it judges answers independently of what found them.
module sg_coulomb_cone
  use sg_kinds, only: wp
  implicit none
  private
  public :: project, project_all

contains

  !> Nearest point of the cone: on its surface (or the tip), unless the point lies inside. Without friction the cone is a ray, and
  !! behind its tip the point is not inside. No branch, so that a loop goes through vector registers.
  pure elemental subroutine project(x, t, friction, normal, tangential)
    real(wp), intent(in) :: x !! normal part of the point
    real(wp), intent(in) :: t !! its tangential part in the plane; in space the length of that
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(out) :: normal !! normal part of the nearest point
    real(wp), intent(out) :: tangential !! its tangential part, or the length of that; the direction stays
    real(wp) :: height, inside

    inside = merge(1.0_wp, 0.0_wp, x > 0 .and. abs(t) <= friction*x)
    height = max(0.0_wp, (x + friction*abs(t))/(1 + friction*friction))
    normal = height + inside*(x - height)
    ! Inside the cone this is t.
    tangential = sign(min(friction*height, abs(t)), t)
  end subroutine project

  !> The same for many points at once: a call from another file for each would keep loops out of vector registers.
  pure subroutine project_all(n, x, t, friction, normal, tangential)
    integer, intent(in) :: n !! points
    real(wp), intent(in) :: x(n) !! normal parts
    real(wp), intent(in) :: t(n) !! tangential parts, or their lengths
    real(wp), intent(in) :: friction(n) !! Coulomb coefficients
    real(wp), intent(out) :: normal(n) !! normal parts of the nearest points
    real(wp), intent(out) :: tangential(n) !! their tangential parts, or the lengths of those
    integer :: i

    do i = 1, n
      call project(x(i), t(i), friction(i), normal(i), tangential(i))
    end do
  end subroutine project_all
end module sg_coulomb_cone
