!> Gauss-Seidel sweeps over round problems in their natural (spatial) order (doc/theory/nlgs.md).
module sg_sweep_round
  use sg_kinds, only: wp, i4
  use sg_records, only: body_length, normal_x, normal_y, record_length, round_bias_n, round_bias_t, round_friction, &
                        round_frictional, round_frictionless, round_frictionless_bias, round_frictionless_inverse_mx, &
                        round_frictionless_inverse_my, round_frictionless_inverse_wnn, round_inverse_i, round_inverse_mx, &
                        round_inverse_my, round_inverse_wnn, round_inverse_wtt, round_spin, velocity_x, velocity_y
  implicit none
  private
  public :: sweep_round_frictionless, sweep_round_frictional

contains

  !> One sweep without friction: each contact in turn gets the impulse that its law asks.
  pure subroutine sweep_round_frictionless(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(round_frictionless), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(1, n) !! normal impulses [N s]
    real(wp), intent(inout) :: body(body_length(round_frictionless), n_bodies) !! records of bodies; their velocities change
    integer :: k
    integer(i4) :: c, a
    real(wp) :: u, change, x, y

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      x = record(normal_x, k)
      y = record(normal_y, k)
      u = x*(body(velocity_x, c) - body(velocity_x, a)) + y*(body(velocity_y, c) - body(velocity_y, a)) &
          + record(round_frictionless_bias, k)
      change = relaxation*(max(0.0_wp, impulse(1, k) - u*record(round_frictionless_inverse_wnn, k)) - impulse(1, k))
      impulse(1, k) = impulse(1, k) + change
      x = x*change
      y = y*change
      body(velocity_x, c) = body(velocity_x, c) + body(round_frictionless_inverse_mx, c)*x
      body(velocity_y, c) = body(velocity_y, c) + body(round_frictionless_inverse_my, c)*y
      body(velocity_x, a) = body(velocity_x, a) - body(round_frictionless_inverse_mx, a)*x
      body(velocity_y, a) = body(velocity_y, a) - body(round_frictionless_inverse_my, a)*y
    end do
  end subroutine sweep_round_frictionless

  !> One sweep with Coulomb friction.
  pure subroutine sweep_round_frictional(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(record_length(round_frictional), n) !! records of contacts
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(2, n) !! impulses [N s]
    real(wp), intent(inout) :: body(body_length(round_frictional), n_bodies) !! records of bodies; their velocities change
    integer :: k
    integer(i4) :: c, a
    real(wp) :: x, y, dx, dy, u_n, u_t, r_n, r_t, limit, p_x, p_y

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      x = record(normal_x, k)
      y = record(normal_y, k)
      dx = body(velocity_x, c) - body(velocity_x, a)
      dy = body(velocity_y, c) - body(velocity_y, a)
      u_n = x*dx + y*dy + record(round_bias_n, k)
      u_t = y*dx - x*dy + body(round_spin, c) + body(round_spin, a) + record(round_bias_t, k)
      r_n = max(0.0_wp, impulse(1, k) - u_n*record(round_inverse_wnn, k))
      limit = record(round_friction, k)*r_n
      r_t = max(-limit, min(limit, impulse(2, k) - u_t*record(round_inverse_wtt, k)))
      r_n = relaxation*(r_n - impulse(1, k))
      r_t = relaxation*(r_t - impulse(2, k))
      impulse(1, k) = impulse(1, k) + r_n
      impulse(2, k) = impulse(2, k) + r_t
      p_x = x*r_n + y*r_t
      p_y = y*r_n - x*r_t
      body(velocity_x, c) = body(velocity_x, c) + body(round_inverse_mx, c)*p_x
      body(velocity_y, c) = body(velocity_y, c) + body(round_inverse_my, c)*p_y
      body(round_spin, c) = body(round_spin, c) + body(round_inverse_i, c)*r_t
      body(velocity_x, a) = body(velocity_x, a) - body(round_inverse_mx, a)*p_x
      body(velocity_y, a) = body(velocity_y, a) - body(round_inverse_my, a)*p_y
      body(round_spin, a) = body(round_spin, a) + body(round_inverse_i, a)*r_t
    end do
  end subroutine sweep_round_frictional
end module sg_sweep_round
