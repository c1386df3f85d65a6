!> Spin of a free body whose principal moments differ (doc/theory/scheme.md, "Rotation in space").
!!
!! J w' = R(-h w_m) J w + h T with w_m = (1 - theta) w + theta w', the rotation that also turns the body: its angular
!! momentum in the world is kept exactly, and for theta = 1/2 its energy too [SimoWong1991]: w_m.(J w' - J w) = 0 because
!! w_m does not turn under a rotation about itself.
module sg_free_spin
  use sg_kinds, only: wp
  use sg_rotations, only: turned_back, turned_on
  use sg_vectors, only: cross
  implicit none
  private
  public :: free_spin

contains

  !> Spin at the end of a step without contacts. Driven components (inverse moment zero) stay as they are given.
  pure subroutine free_spin(principal, inverse, before, torque, h, theta, spin)
    real(wp), intent(in) :: principal(3) !! principal moments of inertia J [kg m2]
    real(wp), intent(in) :: inverse(3) !! their inverses, zero where driven [1/(kg m2)]
    real(wp), intent(in) :: before(3) !! spin w at the beginning, about principal axes [rad/s]
    real(wp), intent(in) :: torque(3) !! external torque T, about principal axes [N m]
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step
    real(wp), intent(inout) :: spin(3) !! guess, then spin at the end w' [rad/s]; driven components are given
    integer, parameter :: most_rounds = 50
    real(wp) :: mean(3), wanted(3), change(3), scale
    integer :: round

    if (.not. any(abs(before) + abs(spin) > 0)) return
    scale = maxval(abs(before)) + maxval(abs(spin))
    do round = 1, most_rounds
      mean = (1 - theta)*before + theta*spin
      wanted = inverse*(turned_back(turned_on([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], h*mean), principal*before) + h*torque)
      where (.not. inverse > 0) wanted = spin
      change = newton_change(wanted - spin, principal, inverse, mean, h*theta)
      spin = spin + change
      if (maxval(abs(change)) <= 2*epsilon(1.0_wp)*scale) exit
    end do
  end subroutine free_spin

  !> Newton's change for a residual, with the tangent for small rotations: x - h theta J^-1 (J w_m x x) = residual.
  pure function newton_change(residual, principal, inverse, mean, weight) result(x)
    real(wp), intent(in) :: residual(3), principal(3), inverse(3), mean(3), weight
    real(wp) :: x(3), tangent(3, 3), unit(3), determinant
    integer :: k

    do k = 1, 3
      unit = 0
      unit(k) = 1
      tangent(:, k) = unit - weight*inverse*cross(principal*mean, unit)
    end do
    determinant = dot_product(tangent(:, 1), cross(tangent(:, 2), tangent(:, 3)))
    x = residual
    if (.not. abs(determinant) > 1e-3_wp) return
    x = [dot_product(residual, cross(tangent(:, 2), tangent(:, 3))), dot_product(tangent(:, 1), cross(residual, tangent(:, 3))), &
         dot_product(tangent(:, 1), cross(tangent(:, 2), residual))]/determinant
  end function newton_change
end module sg_free_spin
