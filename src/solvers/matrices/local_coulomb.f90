!> The local problem of one contact with Coulomb friction: given a positive definite block W and a velocity q, find r with
!! K* containing u + (friction |u_T|, 0), orthogonal to r in K, where u = W r + q (doc/theory/solvers_local.md).
!!
!! Open where q_N >= 0. Otherwise u_N = 0 leaves (S + alpha I) r_T = -s with the Schur complement S of W_NN: sticking is
!! alpha = 0; sliding is the alpha > 0 with |r_T| = friction r_N, which exists whenever sticking leaves the cone. Numbers in,
!! numbers out; W need not be symmetric; no input makes it loop for ever, and no finite input of ordinary size gives NaN.
module sg_local_coulomb
  use sg_kinds, only: wp
  implicit none
  private
  public :: solve_local_2, solve_local_3

contains

  !> The impulse of one contact in the plane, in closed form.
  pure subroutine solve_local_2(w, q, friction, r)
    real(wp), intent(in) :: w(2, 2) !! block of W [1/kg]
    real(wp), intent(in) :: q(2) !! velocity without this contact's impulse [m/s]
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(out) :: r(2) !! impulse [N s]
    real(wp) :: ratio, schur, s, side

    r = 0
    if (q(1) >= 0 .or. w(1, 1) <= 0) return
    ratio = w(2, 1)/w(1, 1)
    schur = max(w(2, 2) - ratio*w(1, 2), epsilon(s)*(w(1, 1) + w(2, 2)))
    s = q(2) - ratio*q(1)
    side = -sign(1.0_wp, s)
    ! Sliding towards `side` unless the cone holds what sticking needs.
    r(1) = -(q(1) - w(1, 2)*(s/schur))/w(1, 1)
    if (abs(s) <= schur*friction*r(1)) then
      r(2) = -s/schur
    else
      r(1) = -q(1)/max(w(1, 1) + friction*side*w(1, 2), epsilon(s)*w(1, 1))
      r(2) = side*friction*r(1)
    end if
  end subroutine solve_local_2

  !> The impulse of one contact in space; sliding by Newton's method on one number, kept between bounds.
  pure subroutine solve_local_3(w, q, friction, r)
    real(wp), intent(in) :: w(3, 3) !! block of W [1/kg]
    real(wp), intent(in) :: q(3) !! velocity without this contact's impulse [m/s]
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(out) :: r(3) !! impulse [N s]
    integer, parameter :: most_steps = 100
    real(wp), parameter :: negligible = 1e-100_wp
    real(wp) :: schur(2, 2), s(2), least, reserve, slope, alpha, low, high, next, length
    integer :: step

    r = 0
    if (q(1) >= 0 .or. w(1, 1) <= 0) return
    s = q(2:3) - w(2:3, 1)*(q(1)/w(1, 1))
    length = length_2(s)
    if (.not. -q(1)*friction > negligible*length) then
      ! Next to nothing holds the contact back: it slides as if it felt no friction, or goes nowhere.
      r(1) = -q(1)/w(1, 1)
      if (length > 0) r(2:3) = -s*(friction*r(1)/length)
      return
    end if
    schur(:, 1) = w(2:3, 2) - w(2:3, 1)*(w(1, 2)/w(1, 1))
    schur(:, 2) = w(2:3, 3) - w(2:3, 1)*(w(1, 3)/w(1, 1))
    least = epsilon(least)*(w(1, 1) + max(w(2, 2), 0.0_wp) + max(w(3, 3), 0.0_wp))
    call slide(w, q, friction, schur, s, least, 0.0_wp, r, reserve, slope)
    if (reserve >= 0) return

    ! At `high` the cone surely holds the impulse.
    low = 0
    high = length_2(s)*((w(1, 1)/friction + length_2(w(1, 2:3)))/(-q(1)))
    alpha = 0
    do step = 1, most_steps
      next = low + (high - low)/2
      if (low > 0 .and. high > 16*low) next = sqrt(low)*sqrt(high)
      if (slope > 0) then
        if (alpha - reserve/slope > low .and. alpha - reserve/slope < high) next = alpha - reserve/slope
      end if
      if (.not. (next > low .and. next < high)) exit
      alpha = next
      call slide(w, q, friction, schur, s, least, alpha, r, reserve, slope)
      if (reserve < 0) low = alpha
      if (reserve >= 0) high = alpha
      if (abs(reserve) <= 4*epsilon(reserve)) exit
    end do

    ! On the cone to the last digit, whatever the last step left.
    length = length_2(r(2:3))
    if (friction > 1) then
      r(1) = length/friction
    else
      r(1) = max(r(1), 0.0_wp)
      if (length > 0) r(2:3) = r(2:3)*(friction*r(1)/length)
    end if
  end subroutine solve_local_3

  !> The impulse with u_N = 0 and u_T = -alpha r_T, and the cone's reserve friction r_N/|r_T| - 1, which is nearly linear in alpha.
  pure subroutine slide(w, q, friction, schur, s, least, alpha, r, reserve, slope)
    real(wp), intent(in) :: w(3, 3), q(3), friction, schur(2, 2), s(2), least, alpha
    real(wp), intent(out) :: r(3)
    real(wp), intent(out) :: reserve, slope
    real(wp) :: change(2), length, normal_change

    r(2:3) = -solve_2(schur, least, alpha, s)
    r(1) = -(q(1) + w(1, 2)*r(2) + w(1, 3)*r(3))/w(1, 1)
    length = length_2(r(2:3))
    reserve = huge(reserve)
    slope = 0
    if (.not. length > tiny(length)) return
    change = -solve_2(schur, least, alpha, r(2:3))
    normal_change = -(w(1, 2)*change(1) + w(1, 3)*change(2))/w(1, 1)
    reserve = friction*(r(1)/length) - 1
    slope = friction*(normal_change/length - (r(1)/length)*(dot_product(r(2:3)/length, change)/length))
  end subroutine slide

  !> Length of a vector in the plane.
  pure real(wp) function length_2(x)
    real(wp), intent(in) :: x(2)

    length_2 = sqrt(x(1)**2 + x(2)**2)
  end function length_2

  !> (S + alpha I)^-1 b by elimination from the larger diagonal term; pivots below `least` are rounding.
  pure function solve_2(schur, least, alpha, b) result(x)
    real(wp), intent(in) :: schur(2, 2), least, alpha, b(2)
    real(wp) :: x(2), first, second, factor
    integer :: i, j

    i = merge(1, 2, schur(1, 1) >= schur(2, 2))
    j = 3 - i
    first = max(schur(i, i) + alpha, least)
    factor = schur(j, i)/first
    second = max(schur(j, j) + alpha - factor*schur(i, j), least)
    x(j) = (b(j) - factor*b(i))/second
    x(i) = (b(i) - schur(i, j)*x(j))/first
  end function solve_2
end module sg_local_coulomb
