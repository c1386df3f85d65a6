!> Gauss-Seidel sweeps over ball problems (spheres among bodies that do not turn), see doc/theory/nlgs.md.
module sg_sweep_ball
  use sg_kinds, only: wp, i4
  use sg_records, only: ball_bias_x, ball_bias_y, ball_bias_z, ball_friction, ball_frictional, ball_frictionless, &
                        ball_frictionless_bias, ball_frictionless_inverse_mx, ball_frictionless_inverse_my, &
                        ball_frictionless_inverse_mz, ball_frictionless_inverse_wnn, ball_inverse_i, ball_inverse_m, &
                        ball_inverse_wnn, ball_inverse_wtt, ball_spin_x, ball_spin_y, ball_spin_z, body_length, free_axes, &
                        normal_x, normal_y, normal_z, record_length, velocity_x, velocity_y, velocity_z
  implicit none
  private
  public :: sweep_ball_frictionless, sweep_ball_frictional, push_partly_driven

contains

  !> One sweep without friction: each contact in turn gets the impulse that its law asks.
  pure subroutine sweep_ball_frictionless(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(ball_frictionless), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(1, n) !! normal impulses [N s]
    real(wp), intent(inout) :: body(body_length(ball_frictionless), n_bodies) !! records of bodies; their velocities change
    integer :: k
    integer(i4) :: c, a
    real(wp) :: u, change, x, y, z

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      x = record(normal_x, k)
      y = record(normal_y, k)
      z = record(normal_z, k)
      u = x*(body(velocity_x, c) - body(velocity_x, a)) + y*(body(velocity_y, c) - body(velocity_y, a)) &
          + z*(body(velocity_z, c) - body(velocity_z, a)) + record(ball_frictionless_bias, k)
      change = relaxation*(max(0.0_wp, impulse(1, k) - u*record(ball_frictionless_inverse_wnn, k)) - impulse(1, k))
      impulse(1, k) = impulse(1, k) + change
      x = x*change
      y = y*change
      z = z*change
      body(velocity_x, c) = body(velocity_x, c) + body(ball_frictionless_inverse_mx, c)*x
      body(velocity_y, c) = body(velocity_y, c) + body(ball_frictionless_inverse_my, c)*y
      body(velocity_z, c) = body(velocity_z, c) + body(ball_frictionless_inverse_mz, c)*z
      body(velocity_x, a) = body(velocity_x, a) - body(ball_frictionless_inverse_mx, a)*x
      body(velocity_y, a) = body(velocity_y, a) - body(ball_frictionless_inverse_my, a)*y
      body(velocity_z, a) = body(velocity_z, a) - body(ball_frictionless_inverse_mz, a)*z
    end do
  end subroutine sweep_ball_frictionless

  !> One sweep with Coulomb friction. Impulses are vectors in the world's axes, so no tangents are needed: the normal part is
  !! taken first, and what is left is cut to the disk of friction.
  pure subroutine sweep_ball_frictional(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(ball_frictional), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(3, n) !! impulses [N s]
    real(wp), intent(inout) :: body(body_length(ball_frictional), n_bodies) !! records of bodies; their velocities change
    integer :: k
    integer(i4) :: c, a
    real(wp) :: x, y, z, sx, sy, sz, ux, uy, uz, u_n, px, py, pz, p_n, r_n, tx, ty, tz, square, limit, share

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      x = record(normal_x, k)
      y = record(normal_y, k)
      z = record(normal_z, k)
      sx = body(ball_spin_x, c) + body(ball_spin_x, a)
      sy = body(ball_spin_y, c) + body(ball_spin_y, a)
      sz = body(ball_spin_z, c) + body(ball_spin_z, a)
      ux = body(velocity_x, c) - body(velocity_x, a) + record(ball_bias_x, k) - sy*z + sz*y
      uy = body(velocity_y, c) - body(velocity_y, a) + record(ball_bias_y, k) - sz*x + sx*z
      uz = body(velocity_z, c) - body(velocity_z, a) + record(ball_bias_z, k) - sx*y + sy*x
      u_n = x*ux + y*uy + z*uz
      px = impulse(1, k)
      py = impulse(2, k)
      pz = impulse(3, k)
      p_n = x*px + y*py + z*pz
      r_n = max(0.0_wp, p_n - u_n*record(ball_inverse_wnn, k))
      ! Tangential impulse asked: the old one less the tangential velocity over W_tt.
      share = p_n - u_n*record(ball_inverse_wtt, k)
      tx = px - ux*record(ball_inverse_wtt, k) - share*x
      ty = py - uy*record(ball_inverse_wtt, k) - share*y
      tz = pz - uz*record(ball_inverse_wtt, k) - share*z
      limit = record(ball_friction, k)*r_n
      square = tx*tx + ty*ty + tz*tz
      share = min(1.0_wp, limit/sqrt(max(square, tiny(1.0_wp))))
      px = relaxation*(r_n*x + share*tx - px)
      py = relaxation*(r_n*y + share*ty - py)
      pz = relaxation*(r_n*z + share*tz - pz)
      impulse(1, k) = impulse(1, k) + px
      impulse(2, k) = impulse(2, k) + py
      impulse(3, k) = impulse(3, k) + pz
      if (min(body(ball_inverse_i, c), body(ball_inverse_i, a)) < 0) then
        call push_partly_driven(body(:, c), [px, py, pz], [x, y, z])
        call push_partly_driven(body(:, a), [-px, -py, -pz], [-x, -y, -z])
        cycle
      end if
      tx = py*z - pz*y
      ty = pz*x - px*z
      tz = px*y - py*x
      body(velocity_x, c) = body(velocity_x, c) + body(ball_inverse_m, c)*px
      body(velocity_y, c) = body(velocity_y, c) + body(ball_inverse_m, c)*py
      body(velocity_z, c) = body(velocity_z, c) + body(ball_inverse_m, c)*pz
      body(ball_spin_x, c) = body(ball_spin_x, c) + body(ball_inverse_i, c)*tx
      body(ball_spin_y, c) = body(ball_spin_y, c) + body(ball_inverse_i, c)*ty
      body(ball_spin_z, c) = body(ball_spin_z, c) + body(ball_inverse_i, c)*tz
      body(velocity_x, a) = body(velocity_x, a) - body(ball_inverse_m, a)*px
      body(velocity_y, a) = body(velocity_y, a) - body(ball_inverse_m, a)*py
      body(velocity_z, a) = body(velocity_z, a) - body(ball_inverse_m, a)*pz
      body(ball_spin_x, a) = body(ball_spin_x, a) + body(ball_inverse_i, a)*tx
      body(ball_spin_y, a) = body(ball_spin_y, a) + body(ball_inverse_i, a)*ty
      body(ball_spin_z, a) = body(ball_spin_z, a) + body(ball_inverse_i, a)*tz
    end do
  end subroutine sweep_ball_frictional

  !> Give an impulse p at the point R n to a body that may be driven in some directions; spin changes by p x n.
  pure subroutine push_partly_driven(body, p, n)
    real(wp), intent(inout) :: body(body_length(ball_frictional)) !! its record
    real(wp), intent(in) :: p(3) !! impulse [N s]
    real(wp), intent(in) :: n(3) !! unit vector from the point of contact to the centre

    body(velocity_x:velocity_z) = body(velocity_x:velocity_z) + body(ball_inverse_m)*free_axes(body(ball_inverse_i))*p
    if (body(ball_inverse_i) > 0) then
      body(ball_spin_x:ball_spin_z) = body(ball_spin_x:ball_spin_z) &
                                      + body(ball_inverse_i)*[p(2)*n(3) - p(3)*n(2), p(3)*n(1) - p(1)*n(3), p(1)*n(2) - p(2)*n(1)]
    end if
  end subroutine push_partly_driven
end module sg_sweep_ball
