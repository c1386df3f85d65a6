!> Gauss-Seidel sweeps over solid problems (bodies of any shape in space), see doc/theory/nlgs.md.
module sg_sweep_solid
  use sg_kinds, only: wp, i4
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
    real(wp), intent(in) :: record(11, n) !! n, arm_c x n, arm_a x n, bias, 1/W_nn
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(1, n) !! normal impulses [N s]
    real(wp), intent(inout) :: body(16, n_bodies) !! velocity, spin, inverse masses, inverse inertia
    integer :: k
    integer(i4) :: c, a
    real(wp) :: u, change

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      u = record(1, k)*(body(1, c) - body(1, a)) + record(2, k)*(body(2, c) - body(2, a)) &
          + record(3, k)*(body(3, c) - body(3, a)) + record(10, k) &
          + record(4, k)*body(4, c) + record(5, k)*body(5, c) + record(6, k)*body(6, c) &
          - record(7, k)*body(4, a) - record(8, k)*body(5, a) - record(9, k)*body(6, a)
      change = relaxation*(max(0.0_wp, impulse(1, k) - u*record(11, k)) - impulse(1, k))
      impulse(1, k) = impulse(1, k) + change
      call push(body(:, c), change*record(1, k), change*record(2, k), change*record(3, k), &
                change*record(4, k), change*record(5, k), change*record(6, k))
      call push(body(:, a), -change*record(1, k), -change*record(2, k), -change*record(3, k), &
                -change*record(7, k), -change*record(8, k), -change*record(9, k))
    end do
  end subroutine sweep_solid_frictionless

  !> One sweep with friction, cohesion, compliance and linear laws.
  pure subroutine sweep_solid_frictional(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(26, n) !! see `record_length` of sg_problem
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(3, n) !! impulses [N s]
    real(wp), intent(inout) :: body(16, n_bodies) !! velocity, spin, inverse masses, inverse inertia
    integer :: k
    integer(i4) :: c, a
    real(wp) :: x, y, z, tx, ty, tz, bx, by, bz, ux, uy, uz, px, py, pz
    real(wp) :: q_n, q_1, q_2, r_n, r_1, r_2, old_n, old_1, old_2, lead, slip, square, inverse, g_1, g_2

    do k = 1, n
      if (record(25, k) < 0.5_wp) cycle
      c = pair(1, k)
      a = pair(2, k)
      x = record(1, k)
      y = record(2, k)
      z = record(3, k)
      tx = record(4, k)
      ty = record(5, k)
      tz = record(6, k)
      bx = y*tz - z*ty
      by = z*tx - x*tz
      bz = x*ty - y*tx
      ux = body(1, c) - body(1, a) + record(13, k) + body(5, c)*record(9, k) - body(6, c)*record(8, k) &
           - body(5, a)*record(12, k) + body(6, a)*record(11, k)
      uy = body(2, c) - body(2, a) + record(14, k) + body(6, c)*record(7, k) - body(4, c)*record(9, k) &
           - body(6, a)*record(10, k) + body(4, a)*record(12, k)
      uz = body(3, c) - body(3, a) + record(15, k) + body(4, c)*record(8, k) - body(5, c)*record(7, k) &
           - body(4, a)*record(11, k) + body(5, a)*record(10, k)
      px = impulse(1, k)
      py = impulse(2, k)
      pz = impulse(3, k)
      old_n = x*px + y*py + z*pz
      old_1 = tx*px + ty*py + tz*pz
      old_2 = bx*px + by*py + bz*pz
      ! Velocity without this contact: what it does itself, cohesion included, is taken out again. With W = S + w w^T/W_nn
      ! on the tangents, W r is W_nn lead, w lead + S r_t.
      q_n = x*ux + y*uy + z*uz + record(23, k)*old_n
      q_1 = tx*ux + ty*uy + tz*uz
      q_2 = bx*ux + by*uy + bz*uz
      slip = q_1**2 + q_2**2
      square = old_1**2 + old_2**2
      q_1 = q_1 + (record(24, k) - record(19, k))*old_1
      q_2 = q_2 + (record(24, k) - record(20, k))*old_2
      old_n = old_n + record(22, k)
      inverse = 1/record(16, k)
      g_1 = record(17, k)*inverse
      g_2 = record(18, k)*inverse
      lead = old_n + g_1*old_1 + g_2*old_2
      q_n = q_n - record(16, k)*lead
      q_1 = q_1 - record(17, k)*lead
      q_2 = q_2 - record(18, k)*lead
      call local_step(inverse, g_1, g_2, record(19, k), record(20, k), record(21, k), &
                      record(25, k) > 1.5_wp, q_n, q_1, q_2, slip, square, r_n, r_1, r_2)
      r_n = relaxation*(r_n - old_n)
      r_1 = relaxation*(r_1 - old_1)
      r_2 = relaxation*(r_2 - old_2)
      px = x*r_n + tx*r_1 + bx*r_2
      py = y*r_n + ty*r_1 + by*r_2
      pz = z*r_n + tz*r_1 + bz*r_2
      impulse(1, k) = impulse(1, k) + px
      impulse(2, k) = impulse(2, k) + py
      impulse(3, k) = impulse(3, k) + pz
      call push(body(:, c), px, py, pz, record(8, k)*pz - record(9, k)*py, record(9, k)*px - record(7, k)*pz, &
                record(7, k)*py - record(8, k)*px)
      call push(body(:, a), -px, -py, -pz, record(12, k)*py - record(11, k)*pz, record(10, k)*pz - record(12, k)*px, &
                record(11, k)*px - record(10, k)*py)
    end do
  end subroutine sweep_solid_frictional

  !> One sweep over contacts of which some are held by cohesive zones: r = r' - K (u + slip), and r' is unilateral with Coulomb
  !! friction.
  pure subroutine sweep_solid_bonded(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(31, n) !! see `record_length` of sg_problem
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(3, n) !! impulses, those of bonds included [N s]
    real(wp), intent(inout) :: body(16, n_bodies) !! velocity, spin, inverse masses, inverse inertia
    integer :: k
    integer(i4) :: c, a
    real(wp) :: frame(3, 3), w(3), u(3), old(3), new(3), slip(3), q(3), change(3), lead, inverse

    do k = 1, n
      if (.not. max(record(27, k), record(28, k)) > 0) then
        call sweep_solid_frictional(1, n_bodies, pair(:, k), record(:26, k), relaxation, impulse(:, k), body)
        cycle
      end if
      if (record(25, k) < 0.5_wp) cycle
      c = pair(1, k)
      a = pair(2, k)
      frame(:, 1) = record(1:3, k)
      frame(:, 2) = record(4:6, k)
      frame(:, 3) = cross(frame(:, 1), frame(:, 2))
      u = matmul(body(1:3, c) - body(1:3, a) + cross(body(4:6, c), record(7:9, k)) - cross(body(4:6, a), record(10:12, k)) &
                 + record(13:15, k), frame)
      slip = matmul(record(29:31, k), frame)
      slip(1) = 0
      ! The unilateral impulse, and the velocity without it but with the bond: W r is W_nn lead, w lead + S r_t.
      old = matmul(impulse(:, k), frame)
      new = old + record([27, 28, 28], k)*(u + slip)
      inverse = 1/record(16, k)
      w = record(16:18, k)
      lead = dot_product(w, new)*inverse
      q = u - w*lead - [0.0_wp, record(19, k), record(20, k)]*new
      call local_step(inverse, w(2)*inverse, w(3)*inverse, record(19, k), record(20, k), record(21, k), .false., q(1), q(2), q(3), &
                      u(2)**2 + u(3)**2, new(2)**2 + new(3)**2, change(1), change(2), change(3))
      new = change
      lead = dot_product(w, new)*inverse
      u = q + w*lead + [0.0_wp, record(19, k), record(20, k)]*new
      change = matmul(frame, relaxation*(new - record([27, 28, 28], k)*(u + slip) - old))
      impulse(:, k) = impulse(:, k) + change
      old = cross(record(7:9, k), change)
      call push(body(:, c), change(1), change(2), change(3), old(1), old(2), old(3))
      old = cross(record(10:12, k), change)
      call push(body(:, a), -change(1), -change(2), -change(3), -old(1), -old(2), -old(3))
    end do
  end subroutine sweep_solid_bonded

  !> Give a body an impulse (x, y, z) and an angular one (a, b, c) about its centre.
  pure subroutine push(body, x, y, z, a, b, c)
    real(wp), intent(inout) :: body(16)
    real(wp), intent(in) :: x, y, z, a, b, c

    body(1) = body(1) + body(7)*x
    body(2) = body(2) + body(8)*y
    body(3) = body(3) + body(9)*z
    body(4) = body(4) + body(10)*a + body(13)*b + body(14)*c
    body(5) = body(5) + body(13)*a + body(11)*b + body(15)*c
    body(6) = body(6) + body(14)*a + body(15)*b + body(12)*c
  end subroutine push

  !> The local problem, solved to rounding: impulse of one contact whose other impulses are fixed (doc/theory/laws.md).
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
