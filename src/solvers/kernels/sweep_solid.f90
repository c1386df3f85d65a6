!> Gauss-Seidel sweeps over solid problems (bodies of any shape in space), see doc/theory/nlgs.md.
module sg_sweep_solid
  use sg_kinds, only: wp, i4
  use sg_records, only: body_length, least_active, least_linear, normal_x, normal_y, normal_z, record_length, solid_arm_ax, &
                        solid_arm_ay, solid_arm_az, solid_arm_cx, solid_arm_cy, solid_arm_cz, solid_bias_x, solid_bias_y, &
                        solid_bias_z, solid_bonded, solid_cohesion, solid_compliance_n, solid_compliance_t, solid_friction, &
                        solid_frictional, solid_frictionless, solid_frictionless_bias, solid_frictionless_inverse_wnn, &
                        solid_frictionless_moment_ax, solid_frictionless_moment_ay, solid_frictionless_moment_az, &
                        solid_frictionless_moment_cx, solid_frictionless_moment_cy, solid_frictionless_moment_cz, &
                        solid_inverse_mx, solid_inverse_my, solid_inverse_mz, solid_inverse_xx, solid_inverse_xy, &
                        solid_inverse_xz, solid_inverse_yy, solid_inverse_yz, solid_inverse_zz, solid_law, solid_relief_22, &
                        solid_relief_nn, solid_s1, solid_s2, solid_slip_x, solid_slip_z, solid_spin_x, solid_spin_y, solid_spin_z, &
                        solid_stiffness_n, solid_stiffness_t, solid_tangent_x, solid_tangent_y, solid_tangent_z, solid_wn1, &
                        solid_wn2, solid_wnn, velocity_x, velocity_y, velocity_z
  use sg_vectors, only: cross
  implicit none
  private
  public :: sweep_solid_frictionless, sweep_solid_frictional, sweep_solid_bonded, slide

contains

  !> One sweep without friction: each contact in turn gets the impulse that its law asks.
  pure subroutine sweep_solid_frictionless(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(solid_frictionless), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(1, n) !! normal impulses [N s]
    real(wp), intent(inout) :: body(body_length(solid_frictionless), n_bodies) !! records of bodies; their velocities change
    integer :: k
    integer(i4) :: c, a
    real(wp) :: u, change

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      u = record(normal_x, k)*(body(velocity_x, c) - body(velocity_x, a)) &
          + record(normal_y, k)*(body(velocity_y, c) - body(velocity_y, a)) &
          + record(normal_z, k)*(body(velocity_z, c) - body(velocity_z, a)) + record(solid_frictionless_bias, k) &
          + record(solid_frictionless_moment_cx, k)*body(solid_spin_x, c) &
          + record(solid_frictionless_moment_cy, k)*body(solid_spin_y, c) &
          + record(solid_frictionless_moment_cz, k)*body(solid_spin_z, c) &
          - record(solid_frictionless_moment_ax, k)*body(solid_spin_x, a) &
          - record(solid_frictionless_moment_ay, k)*body(solid_spin_y, a) &
          - record(solid_frictionless_moment_az, k)*body(solid_spin_z, a)
      change = relaxation*(max(0.0_wp, impulse(1, k) - u*record(solid_frictionless_inverse_wnn, k)) - impulse(1, k))
      impulse(1, k) = impulse(1, k) + change
      call push(body(:, c), change*record(normal_x, k), change*record(normal_y, k), change*record(normal_z, k), &
                change*record(solid_frictionless_moment_cx, k), change*record(solid_frictionless_moment_cy, k), &
                change*record(solid_frictionless_moment_cz, k))
      call push(body(:, a), -change*record(normal_x, k), -change*record(normal_y, k), -change*record(normal_z, k), &
                -change*record(solid_frictionless_moment_ax, k), -change*record(solid_frictionless_moment_ay, k), &
                -change*record(solid_frictionless_moment_az, k))
    end do
  end subroutine sweep_solid_frictionless

  !> One sweep with friction, cohesion, compliance and linear laws.
  pure subroutine sweep_solid_frictional(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(solid_frictional), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(3, n) !! impulses [N s]
    real(wp), intent(inout) :: body(body_length(solid_frictional), n_bodies) !! records of bodies; their velocities change
    integer :: k
    integer(i4) :: c, a
    real(wp) :: x, y, z, tx, ty, tz, bx, by, bz, ux, uy, uz, px, py, pz
    real(wp) :: q_n, q_1, q_2, r_n, r_1, r_2, old_n, old_1, old_2, lead, slip, square, inverse, g_1, g_2

    do k = 1, n
      if (record(solid_law, k) < least_active) cycle
      c = pair(1, k)
      a = pair(2, k)
      x = record(normal_x, k)
      y = record(normal_y, k)
      z = record(normal_z, k)
      tx = record(solid_tangent_x, k)
      ty = record(solid_tangent_y, k)
      tz = record(solid_tangent_z, k)
      bx = y*tz - z*ty
      by = z*tx - x*tz
      bz = x*ty - y*tx
      ux = body(velocity_x, c) - body(velocity_x, a) + record(solid_bias_x, k) + body(solid_spin_y, c)*record(solid_arm_cz, k) &
           - body(solid_spin_z, c)*record(solid_arm_cy, k) - body(solid_spin_y, a)*record(solid_arm_az, k) &
           + body(solid_spin_z, a)*record(solid_arm_ay, k)
      uy = body(velocity_y, c) - body(velocity_y, a) + record(solid_bias_y, k) + body(solid_spin_z, c)*record(solid_arm_cx, k) &
           - body(solid_spin_x, c)*record(solid_arm_cz, k) - body(solid_spin_z, a)*record(solid_arm_ax, k) &
           + body(solid_spin_x, a)*record(solid_arm_az, k)
      uz = body(velocity_z, c) - body(velocity_z, a) + record(solid_bias_z, k) + body(solid_spin_x, c)*record(solid_arm_cy, k) &
           - body(solid_spin_y, c)*record(solid_arm_cx, k) - body(solid_spin_x, a)*record(solid_arm_ay, k) &
           + body(solid_spin_y, a)*record(solid_arm_ax, k)
      px = impulse(1, k)
      py = impulse(2, k)
      pz = impulse(3, k)
      old_n = x*px + y*py + z*pz
      old_1 = tx*px + ty*py + tz*pz
      old_2 = bx*px + by*py + bz*pz
      ! Velocity without this contact: what it does itself, cohesion included, is taken out again. With W = S + w w^T/W_nn
      ! on the tangents, W r is W_nn lead, w lead + S r_t.
      q_n = x*ux + y*uy + z*uz + record(solid_compliance_n, k)*old_n
      q_1 = tx*ux + ty*uy + tz*uz
      q_2 = bx*ux + by*uy + bz*uz
      slip = q_1**2 + q_2**2
      square = old_1**2 + old_2**2
      q_1 = q_1 + (record(solid_compliance_t, k) - record(solid_s1, k))*old_1
      q_2 = q_2 + (record(solid_compliance_t, k) - record(solid_s2, k))*old_2
      old_n = old_n + record(solid_cohesion, k)
      inverse = 1/record(solid_wnn, k)
      g_1 = record(solid_wn1, k)*inverse
      g_2 = record(solid_wn2, k)*inverse
      lead = old_n + g_1*old_1 + g_2*old_2
      q_n = q_n - record(solid_wnn, k)*lead
      q_1 = q_1 - record(solid_wn1, k)*lead
      q_2 = q_2 - record(solid_wn2, k)*lead
      call local_step(inverse, g_1, g_2, record(solid_s1, k), record(solid_s2, k), record(solid_friction, k), &
                      record(solid_law, k) > least_linear, q_n, q_1, q_2, slip, square, r_n, r_1, r_2)
      r_n = relaxation*(r_n - old_n)
      r_1 = relaxation*(r_1 - old_1)
      r_2 = relaxation*(r_2 - old_2)
      px = x*r_n + tx*r_1 + bx*r_2
      py = y*r_n + ty*r_1 + by*r_2
      pz = z*r_n + tz*r_1 + bz*r_2
      impulse(1, k) = impulse(1, k) + px
      impulse(2, k) = impulse(2, k) + py
      impulse(3, k) = impulse(3, k) + pz
      call push(body(:, c), px, py, pz, record(solid_arm_cy, k)*pz - record(solid_arm_cz, k)*py, record(solid_arm_cz, k)*px &
                - record(solid_arm_cx, k)*pz, record(solid_arm_cx, k)*py - record(solid_arm_cy, k)*px)
      call push(body(:, a), -px, -py, -pz, record(solid_arm_az, k)*py - record(solid_arm_ay, k)*pz, record(solid_arm_ax, k)*pz &
                - record(solid_arm_az, k)*px, record(solid_arm_ay, k)*px - record(solid_arm_ax, k)*py)
    end do
  end subroutine sweep_solid_frictional

  !> One sweep over contacts of which some are held by cohesive zones: r = r' - K (u + slip), and r' is unilateral with Coulomb
  !! friction.
  pure subroutine sweep_solid_bonded(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(solid_bonded), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(3, n) !! impulses, those of bonds included [N s]
    real(wp), intent(inout) :: body(body_length(solid_frictional), n_bodies) !! records of bodies; their velocities change
    integer :: k
    integer(i4) :: c, a
    real(wp) :: frame(3, 3), relief(3, 3), w(3), u(3), slip(3), q(3), unilateral(3), solved(3), change(3), moment(3), lead, inverse
    logical :: is_active

    do k = 1, n
      if (.not. max(record(solid_stiffness_n, k), record(solid_stiffness_t, k)) > 0 .and. record(solid_law, k) > least_active) then
        call sweep_solid_frictional(1, n_bodies, pair(:, k), record(:record_length(solid_frictional), k), relaxation, &
                                    impulse(:, k), body)
        cycle
      end if
      c = pair(1, k)
      a = pair(2, k)
      frame(:, 1) = record(normal_x:normal_z, k)
      frame(:, 2) = record(solid_tangent_x:solid_tangent_z, k)
      frame(:, 3) = cross(frame(:, 1), frame(:, 2))
      u = matmul(body(velocity_x:velocity_z, c) - body(velocity_x:velocity_z, a) &
          + cross(body(solid_spin_x:solid_spin_z, c), record(solid_arm_cx:solid_arm_cz, k)) &
          - cross(body(solid_spin_x:solid_spin_z, a), record(solid_arm_ax:solid_arm_az, k)) &
          + record(solid_bias_x:solid_bias_z, k), frame)
      slip = matmul(record(solid_slip_x:solid_slip_z, k), frame)
      slip(1) = 0
      ! The unilateral impulse, and the velocity without it but with the bond: W r is W_nn lead, w lead + S r_t.
      unilateral = matmul(impulse(:, k), frame) + record([solid_stiffness_n, solid_stiffness_t, solid_stiffness_t], k)*(u + slip)
      is_active = record(solid_law, k) > least_active
      inverse = 0
      if (is_active) inverse = 1/record(solid_wnn, k)
      w = record(solid_wnn:solid_wn2, k)
      lead = dot_product(w, unilateral)*inverse
      q = u - w*lead - [0.0_wp, record(solid_s1, k), record(solid_s2, k)]*unilateral
      if (is_active) then
        call local_step(inverse, w(2)*inverse, w(3)*inverse, record(solid_s1, k), record(solid_s2, k), record(solid_friction, k), &
                        .false., q(1), q(2), q(3), u(2)**2 + u(3)**2, unilateral(2)**2 + unilateral(3)**2, &
                        solved(1), solved(2), solved(3))
      else
        ! Nothing moves along the normal: the bond acts alone, does not push, and carries nothing once it is broken.
        solved = [min(0.0_wp, record(solid_stiffness_n, k)*u(1)), 0.0_wp, 0.0_wp]
      end if
      ! The bond gives way to the change.
      relief = reshape(record(solid_relief_nn:solid_relief_22, k), [3, 3])
      change = matmul(frame, relaxation*matmul(relief, solved - unilateral))
      ! What is broken and moves nothing along the normal carries nothing, to the last bit.
      if (.not. max(record(solid_stiffness_n, k), record(solid_stiffness_t, k)) > 0) change = -relaxation*impulse(:, k)
      impulse(:, k) = impulse(:, k) + change
      moment = cross(record(solid_arm_cx:solid_arm_cz, k), change)
      call push(body(:, c), change(1), change(2), change(3), moment(1), moment(2), moment(3))
      moment = cross(record(solid_arm_ax:solid_arm_az, k), change)
      call push(body(:, a), -change(1), -change(2), -change(3), -moment(1), -moment(2), -moment(3))
    end do
  end subroutine sweep_solid_bonded

  !> Give a body an impulse (x, y, z) and an angular one (a, b, c) about its centre.
  pure subroutine push(body, x, y, z, a, b, c)
    real(wp), intent(inout) :: body(body_length(solid_frictional))
    real(wp), intent(in) :: x, y, z, a, b, c

    body(velocity_x) = body(velocity_x) + body(solid_inverse_mx)*x
    body(velocity_y) = body(velocity_y) + body(solid_inverse_my)*y
    body(velocity_z) = body(velocity_z) + body(solid_inverse_mz)*z
    body(solid_spin_x) = body(solid_spin_x) + body(solid_inverse_xx)*a + body(solid_inverse_xy)*b + body(solid_inverse_xz)*c
    body(solid_spin_y) = body(solid_spin_y) + body(solid_inverse_xy)*a + body(solid_inverse_yy)*b + body(solid_inverse_yz)*c
    body(solid_spin_z) = body(solid_spin_z) + body(solid_inverse_xz)*a + body(solid_inverse_yz)*b + body(solid_inverse_zz)*c
  end subroutine push

  !> The local problem, solved to rounding: impulse of one contact, all other impulses fixed (doc/theory/laws.md).
  !!
  !! With W = S + w w^T/W_nn on the tangents and S diagonal there, sticking is r_i = -s_i/S_i with s = q_t - w q_n/W_nn.
  !! Sliding with velocity alpha r_t against itself is r_i = -s_i/(S_i + alpha), and alpha >= 0 is where |r_t| meets
  !! friction r_n: below zero or infinite at alpha = 0, above as alpha grows, so that it lies in a bracket that only
  !! shrinks. Private, so that it is compiled into the sweep.
  pure subroutine local_step(inverse, g_1, g_2, s_1, s_2, friction, is_linear, q_n, q_1, q_2, slip, before, r_n, r_1, r_2)
    real(wp), intent(in) :: inverse, g_1, g_2 !! 1/W_nn [kg], and w/W_nn
    real(wp), intent(in) :: s_1, s_2 !! Schur complement, diagonal [1/kg]
    real(wp), intent(in) :: friction !! Coulomb coefficient
    logical, intent(in) :: is_linear !! does the law ask u = 0 without any inequality?
    real(wp), intent(in) :: q_n, q_1, q_2 !! velocity without this impulse [m/s]
    real(wp), intent(in) :: slip, before !! squares of tangential velocity and impulse at the last visit
    real(wp), intent(out) :: r_n, r_1, r_2 !! impulse [N s]
    real(wp) :: h_n, t_1, t_2, both

    r_n = 0
    r_1 = 0
    r_2 = 0
    if (q_n >= 0 .and. .not. is_linear) return
    h_n = -q_n*inverse
    t_1 = g_1*q_n - q_1
    t_2 = g_2*q_n - q_2
    if (.not. is_linear .and. .not. friction > 0) then
      r_n = h_n
      return
    end if
    both = 1/(s_1*s_2)
    r_1 = t_1*(s_2*both)
    r_2 = t_2*(s_1*both)
    r_n = h_n - g_1*r_1 - g_2*r_2
    if (is_linear) return
    if (r_n >= 0 .and. r_1**2 + r_2**2 <= (friction*r_n)**2) return
    call slide(g_1, g_2, s_1, s_2, friction, h_n, t_1, t_2, slip, before, r_n, r_1, r_2)
  end subroutine local_step

  !> The sliding case: Newton's method for friction r_n/|r_t| = 1, a nearly straight line in alpha, within a bracket.
  pure subroutine slide(g_1, g_2, s_1, s_2, friction, h_n, t_1, t_2, slip, before, r_n, r_1, r_2)
    real(wp), intent(in) :: g_1, g_2, s_1, s_2, friction
    real(wp), intent(in) :: h_n !! normal impulse without a tangential one [N s]
    real(wp), intent(in) :: t_1, t_2, slip, before
    real(wp), intent(out) :: r_n, r_1, r_2
    integer, parameter :: most_rounds = 60
    real(wp), parameter :: enough = 1e-13_wp
    real(wp) :: alpha, low, high, a_1, a_2, d_1, d_2, square, length, value, slope, inverse
    integer :: round

    low = 0
    high = huge(high)
    if (before > tiny(before)*(1 + slip)) then
      alpha = sqrt(slip/before)
    else
      length = sqrt(t_1**2 + t_2**2)
      alpha = 0
      if (friction*h_n > tiny(alpha)*length) alpha = max(0.0_wp, length/(friction*h_n) - 0.5_wp*(s_1 + s_2))
    end if
    do round = 1, most_rounds
      a_1 = s_1 + alpha
      a_2 = s_2 + alpha
      inverse = 1/(a_1*a_2)
      d_1 = a_2*inverse
      d_2 = a_1*inverse
      r_1 = t_1*d_1
      r_2 = t_2*d_2
      r_n = h_n - g_1*r_1 - g_2*r_2
      square = r_1**2 + r_2**2
      length = sqrt(square)
      value = friction*r_n - length
      if (abs(value) <= enough*length) exit
      if (value < 0) low = alpha
      if (value > 0) high = alpha
      ! The slope of friction r_n/length, times length^3: a step to the root, bisection where it leaves the bracket.
      d_1 = r_1*d_1
      d_2 = r_2*d_2
      slope = friction*((g_1*d_1 + g_2*d_2)*square + r_n*(r_1*d_1 + r_2*d_2))
      if (slope > tiny(slope)) then
        alpha = alpha - value*square/slope
        if (alpha > low .and. alpha < high) cycle
      end if
      if (high < huge(high)) then
        alpha = 0.5_wp*(low + high)
        if (high > 4*(low + s_1 + s_2)) alpha = sqrt(high)*sqrt(low + s_1 + s_2)
      else
        alpha = 4*low + s_1 + s_2
      end if
    end do
    r_n = max(0.0_wp, r_n)
    if (length > 0) then
      value = friction*r_n/length
      r_1 = r_1*value
      r_2 = r_2*value
    end if
  end subroutine slide
end module sg_sweep_solid
