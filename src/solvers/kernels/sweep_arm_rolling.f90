!> Gauss-Seidel sweep over contacts of the plane of which some bear a moment that resists rolling, and their local problem
!! (doc/theory/laws.md, "Rolling and twisting").
module sg_sweep_arm_rolling
  use sg_kinds, only: wp, i4
  use sg_records, only: arm_bias_n, arm_bias_t, arm_bonded, arm_cohesion, arm_compliance_n, arm_compliance_t, arm_friction, &
                        arm_frictional, arm_gyration, arm_inverse_i, arm_inverse_mx, arm_inverse_my, arm_law, arm_mixed, &
                        arm_moment_na, arm_moment_nc, arm_moment_ta, arm_moment_tc, arm_rolling, arm_rolling_length, arm_spin, &
                        arm_stiffness_n, arm_stiffness_t, arm_wmm, arm_wnm, arm_wnn, arm_wnt, arm_wtm, arm_wtt, body_length, &
                        bond_shift, least_active, normal_x, normal_y, record_length, velocity_x, velocity_y
  use sg_sweep_arm, only: sweep_arm_bonded, sweep_arm_frictional
  implicit none
  private
  public :: sweep_arm_rolling, sweep_arm_mixed, rolling_step

contains

  !> One sweep; contacts that resist no rolling are those of the frictional kind.
  pure subroutine sweep_arm_rolling(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(arm_rolling), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(3, n) !! impulses [N s], and moments over the step [N m s]
    real(wp), intent(inout) :: body(body_length(arm_frictional), n_bodies) !! records of bodies; their velocities change
    integer :: k
    integer(i4) :: c, a
    real(wp) :: x, y, dx, dy, p_x, p_y, w(3, 3), q(3), old(3), r(3)

    do k = 1, n
      if (record(arm_law, k) < least_active) cycle
      if (.not. record(arm_rolling_length, k) > 0) then
        call sweep_arm_frictional(1, n_bodies, pair(:, k), record(:record_length(arm_frictional), k), relaxation, &
                                  impulse(:2, k), body)
        cycle
      end if
      c = pair(1, k)
      a = pair(2, k)
      x = record(normal_x, k)
      y = record(normal_y, k)
      dx = body(velocity_x, c) - body(velocity_x, a)
      dy = body(velocity_y, c) - body(velocity_y, a)
      associate (length => record(arm_gyration, k))
        w = reshape([record(arm_wnn, k), record(arm_wnt, k), length*record(arm_wnm, k), &
                     record(arm_wnt, k), record(arm_wtt, k), length*record(arm_wtm, k), &
                     length*record(arm_wnm, k), length*record(arm_wtm, k), length**2*record(arm_wmm, k)], [3, 3])
        old = [impulse(1, k) + record(arm_cohesion, k), impulse(2, k), impulse(3, k)/length]
        ! Velocity without this contact: what it does itself, cohesion included, is taken out again.
        q = [x*dx + y*dy + record(arm_moment_nc, k)*body(arm_spin, c) - record(arm_moment_na, k)*body(arm_spin, a) &
             + record(arm_bias_n, k) + record(arm_compliance_n, k)*impulse(1, k), &
             y*dx - x*dy + record(arm_moment_tc, k)*body(arm_spin, c) - record(arm_moment_ta, k)*body(arm_spin, a) &
             + record(arm_bias_t, k) + record(arm_compliance_t, k)*impulse(2, k), &
             length*(body(arm_spin, c) - body(arm_spin, a))] - matmul(w, old)
        call rolling_step(w, [record(arm_friction, k), record(arm_rolling_length, k)/length], q, r)
        r = relaxation*(r - old)
        r(3) = length*r(3)
      end associate
      impulse(:, k) = impulse(:, k) + r
      p_x = x*r(1) + y*r(2)
      p_y = y*r(1) - x*r(2)
      body(velocity_x, c) = body(velocity_x, c) + body(arm_inverse_mx, c)*p_x
      body(velocity_y, c) = body(velocity_y, c) + body(arm_inverse_my, c)*p_y
      body(arm_spin, c) = body(arm_spin, c) + body(arm_inverse_i, c)*(record(arm_moment_nc, k)*r(1) &
                          + record(arm_moment_tc, k)*r(2) + r(3))
      body(velocity_x, a) = body(velocity_x, a) - body(arm_inverse_mx, a)*p_x
      body(velocity_y, a) = body(velocity_y, a) - body(arm_inverse_my, a)*p_y
      body(arm_spin, a) = body(arm_spin, a) - body(arm_inverse_i, a)*(record(arm_moment_na, k)*r(1) &
                          + record(arm_moment_ta, k)*r(2) + r(3))
    end do
  end subroutine sweep_arm_rolling

  !> One sweep over contacts of which some are held by cohesive zones and others bear moments.
  pure subroutine sweep_arm_mixed(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(arm_mixed), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(3, n) !! impulses [N s], and moments over the step [N m s]
    real(wp), intent(inout) :: body(body_length(arm_frictional), n_bodies) !! records of bodies; their velocities change
    real(wp) :: bonded(record_length(arm_bonded))
    integer :: k, shift

    shift = bond_shift(arm_mixed)
    do k = 1, n
      if (record(arm_law, k) > least_active .and. &
          .not. max(record(arm_stiffness_n + shift, k), record(arm_stiffness_t + shift, k)) > 0) then
        call sweep_arm_rolling(1, n_bodies, pair(:, k), record(:record_length(arm_rolling), k), relaxation, impulse(:, k), body)
      else
        bonded(:arm_law) = record(:arm_law, k)
        bonded(arm_stiffness_n:) = record(arm_stiffness_n + shift:, k)
        call sweep_arm_bonded(1, n_bodies, pair(:, k), bonded, relaxation, impulse(:2, k), body)
      end if
    end do
  end subroutine sweep_arm_mixed

  !> The local problem, solved exactly: normal impulse, tangential one and moment of one contact, all others fixed, for u = W r + q
  !! with a symmetric positive definite block: 0 <= r_n complementary to u_n >= 0, and of the other two each |r_i| <= mu_i r_n,
  !! r_i = -mu_i r_n sign(u_i) where u_i is not zero.
  !!
  !! Each of the two holds, or slides one way or the other: nine cases, each a linear system, tried from holding on. At the border
  !! of two cases rounding may refuse both: then that which breaks the law least is taken.
  pure subroutine rolling_step(w, bound, q, r)
    real(wp), intent(in) :: w(3, 3) !! block of W, moments and spins in units of impulses and velocities [1/kg]
    real(wp), intent(in) :: bound(2) !! Coulomb's coefficient, and largest moment over the normal impulse
    real(wp), intent(in) :: q(3) !! velocity without this impulse [m/s]
    real(wp), intent(out) :: r(3) !! impulse [N s]
    real(wp) :: tried(3), broken, least
    integer :: i, j, sides(2)
    integer, parameter :: order(3) = [0, 1, -1]

    r = 0
    if (q(1) >= 0) return
    least = huge(least)
    do i = 1, 3
      do j = 1, 3
        sides = [order(j), order(i)]
        call solve_case(w, bound, q, sides, tried, broken)
        if (.not. broken < least) cycle
        least = broken
        r = tried
        if (.not. broken > 0) return
      end do
    end do
    if (least < huge(least)) return
    r = [-q(1)/w(1, 1), 0.0_wp, 0.0_wp]
  end subroutine rolling_step

  !> One case: which of the two slide, and to which side their impulses point; and by what velocity it breaks the law.
  pure subroutine solve_case(w, bound, q, sides, r, broken)
    real(wp), intent(in) :: w(3, 3), bound(2), q(3)
    integer, intent(in) :: sides(2) !! 0 for holding, else the sign of the impulse
    real(wp), intent(out) :: r(3)
    real(wp), intent(out) :: broken !! zero where the case holds, the largest number where it has no solution
    real(wp) :: m(3, 4), slope(2), pivot, u
    integer :: i, j

    ! Unknowns are r_n and what holds; what slides follows r_n.
    slope = real(sides, wp)*bound
    m(:, 4) = -q
    m(:, 1) = w(:, 1) + slope(1)*w(:, 2) + slope(2)*w(:, 3)
    m(:, 2:3) = w(:, 2:3)
    broken = huge(broken)
    ! What holds is eliminated first, with pivots of a positive block; the last one is the stiffness along the normal.
    do i = 3, 2, -1
      if (sides(i - 1) /= 0) then
        m(i, :) = 0
        m(:, i) = 0
        cycle
      end if
      pivot = m(i, i)
      if (.not. pivot > tiny(1.0_wp)) return
      do j = 1, i - 1
        m(j, :) = m(j, :) - m(j, i)/pivot*m(i, :)
      end do
    end do
    if (.not. m(1, 1) > tiny(1.0_wp)) return
    r(1) = m(1, 4)/m(1, 1)
    do i = 2, 3
      if (sides(i - 1) /= 0) then
        r(i) = slope(i - 1)*r(1)
      else
        r(i) = (m(i, 4) - m(i, 1)*r(1) - merge(m(i, 2)*r(2), 0.0_wp, i == 3))/m(i, i)
      end if
    end do
    if (r(1) < 0) return
    broken = 0
    do i = 2, 3
      if (sides(i - 1) == 0) then
        broken = max(broken, w(i, i)*(abs(r(i)) - bound(i - 1)*r(1)))
      else if (bound(i - 1) > 0) then
        u = q(i) + dot_product(w(:, i), r)
        broken = max(broken, real(sides(i - 1), wp)*u)
      end if
    end do
  end subroutine solve_case
end module sg_sweep_arm_rolling
