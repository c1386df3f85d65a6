!> Gauss-Seidel sweeps over problems with any lever arms and any law (doc/theory/nlgs.md).
module sg_sweep_arm
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: sweep_arm_frictionless, sweep_arm_frictional, sweep_arm_bonded

contains

  !> One sweep without friction.
  pure subroutine sweep_arm_frictionless(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(6, n) !! n_x, n_y, turn_c, turn_a, bias, 1/W_nn
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(1, n) !! normal impulses [N s]
    real(wp), intent(inout) :: body(6, n_bodies) !! v_x, v_y, spin, inverse masses
    integer :: k
    integer(i4) :: c, a
    real(wp) :: u, change

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      u = record(1, k)*(body(1, c) - body(1, a)) + record(2, k)*(body(2, c) - body(2, a)) &
          + record(3, k)*body(3, c) - record(4, k)*body(3, a) + record(5, k)
      change = relaxation*(max(0.0_wp, impulse(1, k) - u*record(6, k)) - impulse(1, k))
      impulse(1, k) = impulse(1, k) + change
      body(1, c) = body(1, c) + body(4, c)*record(1, k)*change
      body(2, c) = body(2, c) + body(5, c)*record(2, k)*change
      body(3, c) = body(3, c) + body(6, c)*record(3, k)*change
      body(1, a) = body(1, a) - body(4, a)*record(1, k)*change
      body(2, a) = body(2, a) - body(5, a)*record(2, k)*change
      body(3, a) = body(3, a) - body(6, a)*record(4, k)*change
    end do
  end subroutine sweep_arm_frictionless

  !> One sweep with friction, cohesion, compliance and linear laws.
  pure subroutine sweep_arm_frictional(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(16, n) !! see `record_length` of sg_problem
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(2, n) !! impulses [N s]
    real(wp), intent(inout) :: body(6, n_bodies) !! v_x, v_y, spin, inverse masses
    integer :: k
    integer(i4) :: c, a
    real(wp) :: x, y, dx, dy, q_n, q_t, r_n, r_t, old_n, old_t, p_x, p_y, determinant

    do k = 1, n
      if (record(16, k) < 0.5_wp) cycle
      c = pair(1, k)
      a = pair(2, k)
      x = record(1, k)
      y = record(2, k)
      old_n = impulse(1, k) + record(13, k)
      old_t = impulse(2, k)
      dx = body(1, c) - body(1, a)
      dy = body(2, c) - body(2, a)
      ! Velocity without this contact: what it does itself, cohesion included, is taken out again.
      q_n = x*dx + y*dy + record(3, k)*body(3, c) - record(5, k)*body(3, a) + record(7, k) + record(14, k)*impulse(1, k) &
            - record(9, k)*old_n - record(10, k)*old_t
      q_t = y*dx - x*dy + record(4, k)*body(3, c) - record(6, k)*body(3, a) + record(8, k) + record(15, k)*old_t &
            - record(10, k)*old_n - record(11, k)*old_t
      if (record(16, k) < 1.5_wp) then
        call coulomb_step(record(9, k), record(10, k), record(11, k), record(12, k), q_n, q_t, r_n, r_t)
      else if (record(16, k) > 2.5_wp) then
        r_n = -q_n/record(9, k)
        r_t = 0
      else
        determinant = record(9, k)*record(11, k) - record(10, k)**2
        r_n = (record(10, k)*q_t - record(11, k)*q_n)/determinant
        r_t = (record(10, k)*q_n - record(9, k)*q_t)/determinant
      end if
      r_n = relaxation*(r_n - old_n)
      r_t = relaxation*(r_t - old_t)
      impulse(1, k) = impulse(1, k) + r_n
      impulse(2, k) = impulse(2, k) + r_t
      p_x = x*r_n + y*r_t
      p_y = y*r_n - x*r_t
      body(1, c) = body(1, c) + body(4, c)*p_x
      body(2, c) = body(2, c) + body(5, c)*p_y
      body(3, c) = body(3, c) + body(6, c)*(record(3, k)*r_n + record(4, k)*r_t)
      body(1, a) = body(1, a) - body(4, a)*p_x
      body(2, a) = body(2, a) - body(5, a)*p_y
      body(3, a) = body(3, a) - body(6, a)*(record(5, k)*r_n + record(6, k)*r_t)
    end do
  end subroutine sweep_arm_frictional

  !> One sweep over contacts of which some are held by cohesive zones: r = r' - K (u + slip), and r' is unilateral with Coulomb
  !! friction.
  pure subroutine sweep_arm_bonded(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(19, n) !! see `record_length` of sg_problem
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(2, n) !! impulses, those of bonds included [N s]
    real(wp), intent(inout) :: body(6, n_bodies) !! v_x, v_y, spin, inverse masses
    integer :: k
    integer(i4) :: c, a
    real(wp) :: dx, dy, u_n, u_t, q_n, q_t, old_n, old_t, r_n, r_t, p_x, p_y

    do k = 1, n
      if (.not. max(record(17, k), record(18, k)) > 0) then
        call sweep_arm_frictional(1, n_bodies, pair(:, k), record(:16, k), relaxation, impulse(:, k), body)
        cycle
      end if
      c = pair(1, k)
      a = pair(2, k)
      dx = body(1, c) - body(1, a)
      dy = body(2, c) - body(2, a)
      u_n = record(1, k)*dx + record(2, k)*dy + record(3, k)*body(3, c) - record(5, k)*body(3, a) + record(7, k)
      u_t = record(2, k)*dx - record(1, k)*dy + record(4, k)*body(3, c) - record(6, k)*body(3, a)
      ! The unilateral impulse, and the velocity without it but with the bond.
      old_n = impulse(1, k) + record(17, k)*u_n
      old_t = impulse(2, k) + record(18, k)*(u_t + record(19, k))
      q_n = u_n - record(9, k)*old_n - record(10, k)*old_t
      q_t = u_t - record(10, k)*old_n - record(11, k)*old_t
      call coulomb_step(record(9, k), record(10, k), record(11, k), record(12, k), q_n, q_t, r_n, r_t)
      u_n = q_n + record(9, k)*r_n + record(10, k)*r_t
      u_t = q_t + record(10, k)*r_n + record(11, k)*r_t
      r_n = relaxation*(r_n - record(17, k)*u_n - impulse(1, k))
      r_t = relaxation*(r_t - record(18, k)*(u_t + record(19, k)) - impulse(2, k))
      impulse(1, k) = impulse(1, k) + r_n
      impulse(2, k) = impulse(2, k) + r_t
      p_x = record(1, k)*r_n + record(2, k)*r_t
      p_y = record(2, k)*r_n - record(1, k)*r_t
      body(1, c) = body(1, c) + body(4, c)*p_x
      body(2, c) = body(2, c) + body(5, c)*p_y
      body(3, c) = body(3, c) + body(6, c)*(record(3, k)*r_n + record(4, k)*r_t)
      body(1, a) = body(1, a) - body(4, a)*p_x
      body(2, a) = body(2, a) - body(5, a)*p_y
      body(3, a) = body(3, a) - body(6, a)*(record(5, k)*r_n + record(6, k)*r_t)
    end do
  end subroutine sweep_arm_bonded

  !> The local problem, solved exactly: impulse of one contact whose other impulses are fixed,
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
