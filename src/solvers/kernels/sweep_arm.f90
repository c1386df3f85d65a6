!> Gauss-Seidel sweeps over problems with any lever arms and any law (doc/theory/nlgs.md).
module sg_sweep_arm
  use sg_kinds, only: wp, i4
  use sg_records, only: arm_bias_n, arm_bias_t, arm_bonded, arm_cohesion, arm_compliance_n, arm_compliance_t, arm_friction, &
                        arm_frictional, arm_frictionless, arm_frictionless_bias, arm_frictionless_inverse_wnn, &
                        arm_frictionless_moment_a, arm_frictionless_moment_c, arm_inverse_i, arm_inverse_mx, arm_inverse_my, &
                        arm_law, arm_moment_na, arm_moment_nc, arm_moment_ta, arm_moment_tc, arm_relief_nn, arm_relief_nt, &
                        arm_relief_tn, arm_relief_tt, arm_slip, arm_spin, arm_stiffness_n, arm_stiffness_t, arm_wnn, arm_wnt, &
                        arm_wtt, body_length, least_active, least_linear, least_normal, normal_x, normal_y, record_length, &
                        velocity_x, velocity_y
  implicit none
  private
  public :: sweep_arm_frictionless, sweep_arm_frictional, sweep_arm_bonded

contains

  !> One sweep without friction.
  pure subroutine sweep_arm_frictionless(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(arm_frictionless), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(1, n) !! normal impulses [N s]
    real(wp), intent(inout) :: body(body_length(arm_frictionless), n_bodies) !! records of bodies; their velocities change
    integer :: k
    integer(i4) :: c, a
    real(wp) :: u, change

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      u = record(normal_x, k)*(body(velocity_x, c) - body(velocity_x, a)) &
          + record(normal_y, k)*(body(velocity_y, c) - body(velocity_y, a)) &
          + record(arm_frictionless_moment_c, k)*body(arm_spin, c) - record(arm_frictionless_moment_a, k)*body(arm_spin, a) &
          + record(arm_frictionless_bias, k)
      change = relaxation*(max(0.0_wp, impulse(1, k) - u*record(arm_frictionless_inverse_wnn, k)) - impulse(1, k))
      impulse(1, k) = impulse(1, k) + change
      body(velocity_x, c) = body(velocity_x, c) + body(arm_inverse_mx, c)*record(normal_x, k)*change
      body(velocity_y, c) = body(velocity_y, c) + body(arm_inverse_my, c)*record(normal_y, k)*change
      body(arm_spin, c) = body(arm_spin, c) + body(arm_inverse_i, c)*record(arm_frictionless_moment_c, k)*change
      body(velocity_x, a) = body(velocity_x, a) - body(arm_inverse_mx, a)*record(normal_x, k)*change
      body(velocity_y, a) = body(velocity_y, a) - body(arm_inverse_my, a)*record(normal_y, k)*change
      body(arm_spin, a) = body(arm_spin, a) - body(arm_inverse_i, a)*record(arm_frictionless_moment_a, k)*change
    end do
  end subroutine sweep_arm_frictionless

  !> One sweep with friction, cohesion, compliance and linear laws.
  pure subroutine sweep_arm_frictional(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(arm_frictional), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(2, n) !! impulses [N s]
    real(wp), intent(inout) :: body(body_length(arm_frictional), n_bodies) !! records of bodies; their velocities change
    integer :: k
    integer(i4) :: c, a
    real(wp) :: x, y, dx, dy, q_n, q_t, r_n, r_t, old_n, old_t, p_x, p_y, determinant

    do k = 1, n
      if (record(arm_law, k) < least_active) cycle
      c = pair(1, k)
      a = pair(2, k)
      x = record(normal_x, k)
      y = record(normal_y, k)
      old_n = impulse(1, k) + record(arm_cohesion, k)
      old_t = impulse(2, k)
      dx = body(velocity_x, c) - body(velocity_x, a)
      dy = body(velocity_y, c) - body(velocity_y, a)
      ! Velocity without this contact: what it does itself, cohesion included, is taken out again.
      q_n = x*dx + y*dy + record(arm_moment_nc, k)*body(arm_spin, c) - record(arm_moment_na, k)*body(arm_spin, a) &
            + record(arm_bias_n, k) + record(arm_compliance_n, k)*impulse(1, k) - record(arm_wnn, k)*old_n &
            - record(arm_wnt, k)*old_t
      q_t = y*dx - x*dy + record(arm_moment_tc, k)*body(arm_spin, c) - record(arm_moment_ta, k)*body(arm_spin, a) &
            + record(arm_bias_t, k) + record(arm_compliance_t, k)*old_t - record(arm_wnt, k)*old_n - record(arm_wtt, k)*old_t
      if (record(arm_law, k) < least_linear) then
        call coulomb_step(record(arm_wnn, k), record(arm_wnt, k), record(arm_wtt, k), record(arm_friction, k), q_n, q_t, r_n, r_t)
      else if (record(arm_law, k) > least_normal) then
        r_n = -q_n/record(arm_wnn, k)
        r_t = 0
      else
        determinant = record(arm_wnn, k)*record(arm_wtt, k) - record(arm_wnt, k)**2
        r_n = (record(arm_wnt, k)*q_t - record(arm_wtt, k)*q_n)/determinant
        r_t = (record(arm_wnt, k)*q_n - record(arm_wnn, k)*q_t)/determinant
      end if
      r_n = relaxation*(r_n - old_n)
      r_t = relaxation*(r_t - old_t)
      impulse(1, k) = impulse(1, k) + r_n
      impulse(2, k) = impulse(2, k) + r_t
      p_x = x*r_n + y*r_t
      p_y = y*r_n - x*r_t
      body(velocity_x, c) = body(velocity_x, c) + body(arm_inverse_mx, c)*p_x
      body(velocity_y, c) = body(velocity_y, c) + body(arm_inverse_my, c)*p_y
      body(arm_spin, c) = body(arm_spin, c) + body(arm_inverse_i, c)*(record(arm_moment_nc, k)*r_n + record(arm_moment_tc, k)*r_t)
      body(velocity_x, a) = body(velocity_x, a) - body(arm_inverse_mx, a)*p_x
      body(velocity_y, a) = body(velocity_y, a) - body(arm_inverse_my, a)*p_y
      body(arm_spin, a) = body(arm_spin, a) - body(arm_inverse_i, a)*(record(arm_moment_na, k)*r_n + record(arm_moment_ta, k)*r_t)
    end do
  end subroutine sweep_arm_frictional

  !> One sweep over contacts of which some are held by cohesive zones: r = r' - K (u + slip), and r' is unilateral with Coulomb
  !! friction.
  pure subroutine sweep_arm_bonded(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(arm_bonded), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(2, n) !! impulses, those of bonds included [N s]
    real(wp), intent(inout) :: body(body_length(arm_frictional), n_bodies) !! records of bodies; their velocities change
    integer :: k
    integer(i4) :: c, a
    real(wp) :: dx, dy, u_n, u_t, q_n, q_t, old_n, old_t, r_n, r_t, change_n, change_t, p_x, p_y

    do k = 1, n
      if (.not. max(record(arm_stiffness_n, k), record(arm_stiffness_t, k)) > 0 .and. record(arm_law, k) > least_active) then
        call sweep_arm_frictional(1, n_bodies, pair(:, k), record(:record_length(arm_frictional), k), relaxation, &
                                  impulse(:, k), body)
        cycle
      end if
      c = pair(1, k)
      a = pair(2, k)
      dx = body(velocity_x, c) - body(velocity_x, a)
      dy = body(velocity_y, c) - body(velocity_y, a)
      u_n = record(normal_x, k)*dx + record(normal_y, k)*dy + record(arm_moment_nc, k)*body(arm_spin, c) &
            - record(arm_moment_na, k)*body(arm_spin, a) + record(arm_bias_n, k)
      u_t = record(normal_y, k)*dx - record(normal_x, k)*dy + record(arm_moment_tc, k)*body(arm_spin, c) &
            - record(arm_moment_ta, k)*body(arm_spin, a)
      ! The unilateral impulse, and the velocity without it but with the bond.
      old_n = impulse(1, k) + record(arm_stiffness_n, k)*u_n
      old_t = impulse(2, k) + record(arm_stiffness_t, k)*(u_t + record(arm_slip, k))
      q_n = u_n - record(arm_wnn, k)*old_n - record(arm_wnt, k)*old_t
      q_t = u_t - record(arm_wnt, k)*old_n - record(arm_wtt, k)*old_t
      if (record(arm_law, k) > least_active) then
        call coulomb_step(record(arm_wnn, k), record(arm_wnt, k), record(arm_wtt, k), record(arm_friction, k), q_n, q_t, r_n, r_t)
      else
        ! Nothing moves along the normal: the bond acts alone, does not push, and carries nothing once it is broken.
        r_n = min(0.0_wp, record(arm_stiffness_n, k)*u_n)
        r_t = 0
      end if
      ! The bond gives way to the change.
      change_n = relaxation*(r_n - old_n)
      change_t = relaxation*(r_t - old_t)
      r_n = record(arm_relief_nn, k)*change_n + record(arm_relief_nt, k)*change_t
      r_t = record(arm_relief_tn, k)*change_n + record(arm_relief_tt, k)*change_t
      impulse(1, k) = impulse(1, k) + r_n
      impulse(2, k) = impulse(2, k) + r_t
      p_x = record(normal_x, k)*r_n + record(normal_y, k)*r_t
      p_y = record(normal_y, k)*r_n - record(normal_x, k)*r_t
      body(velocity_x, c) = body(velocity_x, c) + body(arm_inverse_mx, c)*p_x
      body(velocity_y, c) = body(velocity_y, c) + body(arm_inverse_my, c)*p_y
      body(arm_spin, c) = body(arm_spin, c) + body(arm_inverse_i, c)*(record(arm_moment_nc, k)*r_n + record(arm_moment_tc, k)*r_t)
      body(velocity_x, a) = body(velocity_x, a) - body(arm_inverse_mx, a)*p_x
      body(velocity_y, a) = body(velocity_y, a) - body(arm_inverse_my, a)*p_y
      body(arm_spin, a) = body(arm_spin, a) - body(arm_inverse_i, a)*(record(arm_moment_na, k)*r_n + record(arm_moment_ta, k)*r_t)
    end do
  end subroutine sweep_arm_bonded

  !> The local problem, solved exactly: impulse of one contact, all other impulses fixed,
  !! 0 <= r_n complementary to u_n >= 0 and Coulomb friction,
  !! for u = W r + q with a symmetric positive definite block W.
  !!
  !! Open, sticking and the two ways of sliding are tried in turn. For friction so large that a sliding case has no
  !! positive normal stiffness (Painleve) only the other one remains. It is private so that it is compiled into the
  !! sweep: 20 % of a polygon run's time.
  pure subroutine coulomb_step(w_nn, w_nt, w_tt, friction, q_n, q_t, r_n, r_t)
    real(wp), intent(in) :: w_nn !! block of W, normal [1/kg]
    real(wp), intent(in) :: w_nt !! block of W, coupling [1/kg]
    real(wp), intent(in) :: w_tt !! block of W, tangential [1/kg]
    real(wp), intent(in) :: friction !! Coulomb coefficient
    real(wp), intent(in) :: q_n !! normal velocity without this impulse [m/s]
    real(wp), intent(in) :: q_t !! tangential velocity without this impulse [m/s]
    real(wp), intent(out) :: r_n !! normal impulse [N s]
    real(wp), intent(out) :: r_t !! tangential impulse [N s]
    real(wp) :: determinant, side, stiffness

    r_n = 0
    r_t = 0
    if (q_n >= 0) return
    determinant = w_nn*w_tt - w_nt**2
    side = -q_t
    if (determinant > 0) then
      r_n = (w_nt*q_t - w_tt*q_n)/determinant
      r_t = (w_nt*q_n - w_nn*q_t)/determinant
      if (r_n >= 0 .and. abs(r_t) <= friction*r_n) return
      if (abs(r_t) > 0) side = r_t
    end if
    side = sign(1.0_wp, side)
    stiffness = w_nn + side*friction*w_nt
    if (stiffness > 0) then
      r_n = -q_n/stiffness
      r_t = side*friction*r_n
      if (side*(q_t + w_nt*r_n + w_tt*r_t) <= 0) return
    end if
    stiffness = w_nn - side*friction*w_nt
    r_n = -q_n/merge(stiffness, w_nn, stiffness > 0)
    r_t = -side*friction*r_n
  end subroutine coulomb_step
end module sg_sweep_arm
