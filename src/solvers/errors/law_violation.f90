!> Velocity by which one contact breaks its law, normal part and friction apart (doc/theory/errors.md).
!!
!! The natural map of the other errors adds friction times the slip to the normal velocity, so that large friction hides a
!! normal velocity in it: at zero impulse by the factor sqrt(1 + friction^2). Here each part has its own map [AlartCurnier1991].
!! Large impulses on light bodies leave a velocity of rounding, which is no violation.
module sg_law_violation
  use sg_kinds, only: wp
  implicit none
  private
  public :: law_violation, most_hidden

  !> Velocity that rounding leaves, over the velocity that the impulse gives the lighter body
  real(wp), parameter :: rounding = 16*epsilon(1.0_wp)

contains

  !> Velocity by which a contact breaks its law [m/s]; zero exactly where it obeys.
  pure real(wp) function law_violation(u, r, friction, rho, is_linear) result(speed)
    real(wp), intent(in) :: u(:) !! relative velocity with bias and compliance, normal first [m/s]
    real(wp), intent(in) :: r(:) !! impulse with cohesion, normal first [N s]
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(in) :: rho !! 1/lambda_max(W_aa) [kg]; zero where the contact takes no part
    logical, intent(in) :: is_linear !! is u = 0 asked?
    real(wp) :: tried(size(u) - 1), radius, length

    speed = 0
    if (.not. rho > 0) return
    if (is_linear) then
      speed = norm2(u)
      return
    end if
    radius = friction*max(0.0_wp, r(1))
    tried = r(2:) - rho*u(2:)
    length = norm2(tried)
    if (length > radius) tried = tried*(radius/length)
    speed = hypot(min(u(1), r(1)/rho), norm2(r(2:) - tried)/rho)
    speed = max(0.0_wp, speed - rounding*norm2(r)/rho)
  end function law_violation

  !> How many times larger than the velocity error of the natural map that velocity is at most.
  pure real(wp) function most_hidden(friction)
    real(wp), intent(in) :: friction !! largest Coulomb coefficient

    most_hidden = sqrt(2.0_wp)*hypot(1.0_wp, min(friction, 1e100_wp))
  end function most_hidden
end module sg_law_violation
