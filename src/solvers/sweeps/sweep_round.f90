!> Gauss-Seidel sweeps over round problems in their natural (spatial) order (doc/theory/nlgs.md).
module sg_sweep_round
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: sweep_round_frictionless, sweep_round_frictional

contains

  !> One sweep without friction: each contact in turn gets the impulse that its law asks.
  pure subroutine sweep_round_frictionless(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(4, n) !! n_x, n_y, bias, 1/W_nn
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(1, n) !! normal impulses [N s]
    real(wp), intent(inout) :: body(4, n_bodies) !! v_x, v_y, inverse masses
    integer :: k
    integer(i4) :: c, a
    real(wp) :: u, change, x, y

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      x = record(1, k)
      y = record(2, k)
      u = x*(body(1, c) - body(1, a)) + y*(body(2, c) - body(2, a)) + record(3, k)
      change = relaxation*(max(0.0_wp, impulse(1, k) - u*record(4, k)) - impulse(1, k))
      impulse(1, k) = impulse(1, k) + change
      x = x*change
      y = y*change
      body(1, c) = body(1, c) + body(3, c)*x
      body(2, c) = body(2, c) + body(4, c)*y
      body(1, a) = body(1, a) - body(3, a)*x
      body(2, a) = body(2, a) - body(4, a)*y
    end do
  end subroutine sweep_round_frictionless

  !> One sweep with Coulomb friction.
  pure subroutine sweep_round_frictional(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(7, n) !! n_x, n_y, bias_n, bias_t, 1/W_nn, 1/W_tt, friction
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(2, n) !! impulses [N s]
    real(wp), intent(inout) :: body(6, n_bodies) !! v_x, v_y, R spin, inverse masses, R^2/I
    integer :: k
    integer(i4) :: c, a
    real(wp) :: x, y, dx, dy, u_n, u_t, r_n, r_t, limit, p_x, p_y

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      x = record(1, k)
      y = record(2, k)
      dx = body(1, c) - body(1, a)
      dy = body(2, c) - body(2, a)
      u_n = x*dx + y*dy + record(3, k)
      u_t = y*dx - x*dy + body(3, c) + body(3, a) + record(4, k)
      r_n = max(0.0_wp, impulse(1, k) - u_n*record(5, k))
      limit = record(7, k)*r_n
      r_t = max(-limit, min(limit, impulse(2, k) - u_t*record(6, k)))
      r_n = relaxation*(r_n - impulse(1, k))
      r_t = relaxation*(r_t - impulse(2, k))
      impulse(1, k) = impulse(1, k) + r_n
      impulse(2, k) = impulse(2, k) + r_t
      p_x = x*r_n + y*r_t
      p_y = y*r_n - x*r_t
      body(1, c) = body(1, c) + body(4, c)*p_x
      body(2, c) = body(2, c) + body(5, c)*p_y
      body(3, c) = body(3, c) + body(6, c)*r_t
      body(1, a) = body(1, a) - body(4, a)*p_x
      body(2, a) = body(2, a) - body(5, a)*p_y
      body(3, a) = body(3, a) + body(6, a)*r_t
    end do
  end subroutine sweep_round_frictional
end module sg_sweep_round
