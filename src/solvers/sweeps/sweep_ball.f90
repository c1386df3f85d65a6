!> Gauss-Seidel sweeps over ball problems (spheres among bodies that do not turn), see doc/theory/nlgs.md.
module sg_sweep_ball
  use sg_kinds, only: wp, i4
  use sg_records, only: free_axes
  implicit none
  private
  public :: sweep_ball_frictionless, sweep_ball_frictional, push_partly_driven

contains

  !> One sweep without friction: each contact in turn gets the impulse that its law asks.
  pure subroutine sweep_ball_frictionless(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(5, n) !! n, bias, 1/W_nn
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(1, n) !! normal impulses [N s]
    real(wp), intent(inout) :: body(6, n_bodies) !! velocity, inverse masses
    integer :: k
    integer(i4) :: c, a
    real(wp) :: u, change, x, y, z

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      x = record(1, k)
      y = record(2, k)
      z = record(3, k)
      u = x*(body(1, c) - body(1, a)) + y*(body(2, c) - body(2, a)) + z*(body(3, c) - body(3, a)) + record(4, k)
      change = relaxation*(max(0.0_wp, impulse(1, k) - u*record(5, k)) - impulse(1, k))
      impulse(1, k) = impulse(1, k) + change
      x = x*change
      y = y*change
      z = z*change
      body(1, c) = body(1, c) + body(4, c)*x
      body(2, c) = body(2, c) + body(5, c)*y
      body(3, c) = body(3, c) + body(6, c)*z
      body(1, a) = body(1, a) - body(4, a)*x
      body(2, a) = body(2, a) - body(5, a)*y
      body(3, a) = body(3, a) - body(6, a)*z
    end do
  end subroutine sweep_ball_frictionless

  !> One sweep with Coulomb friction. Impulses are vectors in the world's axes, so no tangents are needed: the normal part is
  !! taken first, and what is left is cut to the disk of friction.
  pure subroutine sweep_ball_frictional(n, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n !! contacts
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(2, n) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(9, n) !! n, bias, 1/W_nn, 1/W_tt, friction
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(3, n) !! impulses [N s]
    real(wp), intent(inout) :: body(8, n_bodies) !! velocity, R spin, inverse mass, R^2/I or marks of free directions
    integer :: k
    integer(i4) :: c, a
    real(wp) :: x, y, z, sx, sy, sz, ux, uy, uz, u_n, px, py, pz, p_n, r_n, tx, ty, tz, square, limit, share

    do k = 1, n
      c = pair(1, k)
      a = pair(2, k)
      x = record(1, k)
      y = record(2, k)
      z = record(3, k)
      sx = body(4, c) + body(4, a)
      sy = body(5, c) + body(5, a)
      sz = body(6, c) + body(6, a)
      ux = body(1, c) - body(1, a) + record(4, k) - sy*z + sz*y
      uy = body(2, c) - body(2, a) + record(5, k) - sz*x + sx*z
      uz = body(3, c) - body(3, a) + record(6, k) - sx*y + sy*x
      u_n = x*ux + y*uy + z*uz
      px = impulse(1, k)
      py = impulse(2, k)
      pz = impulse(3, k)
      p_n = x*px + y*py + z*pz
      r_n = max(0.0_wp, p_n - u_n*record(7, k))
      ! Tangential impulse asked: the old one less the tangential velocity over W_tt.
      share = p_n - u_n*record(8, k)
      tx = px - ux*record(8, k) - share*x
      ty = py - uy*record(8, k) - share*y
      tz = pz - uz*record(8, k) - share*z
      limit = record(9, k)*r_n
      square = tx*tx + ty*ty + tz*tz
      share = min(1.0_wp, limit/sqrt(max(square, tiny(1.0_wp))))
      px = relaxation*(r_n*x + share*tx - px)
      py = relaxation*(r_n*y + share*ty - py)
      pz = relaxation*(r_n*z + share*tz - pz)
      impulse(1, k) = impulse(1, k) + px
      impulse(2, k) = impulse(2, k) + py
      impulse(3, k) = impulse(3, k) + pz
      if (min(body(8, c), body(8, a)) < 0) then
        call push_partly_driven(body(:, c), [px, py, pz], [x, y, z])
        call push_partly_driven(body(:, a), [-px, -py, -pz], [-x, -y, -z])
        cycle
      end if
      tx = py*z - pz*y
      ty = pz*x - px*z
      tz = px*y - py*x
      body(1, c) = body(1, c) + body(7, c)*px
      body(2, c) = body(2, c) + body(7, c)*py
      body(3, c) = body(3, c) + body(7, c)*pz
      body(4, c) = body(4, c) + body(8, c)*tx
      body(5, c) = body(5, c) + body(8, c)*ty
      body(6, c) = body(6, c) + body(8, c)*tz
      body(1, a) = body(1, a) - body(7, a)*px
      body(2, a) = body(2, a) - body(7, a)*py
      body(3, a) = body(3, a) - body(7, a)*pz
      body(4, a) = body(4, a) + body(8, a)*tx
      body(5, a) = body(5, a) + body(8, a)*ty
      body(6, a) = body(6, a) + body(8, a)*tz
    end do
  end subroutine sweep_ball_frictional

  !> Give an impulse p at the point R n to a body that may be driven in some directions; spin changes by p x n.
  pure subroutine push_partly_driven(body, p, n)
    real(wp), intent(inout) :: body(8) !! its record
    real(wp), intent(in) :: p(3) !! impulse [N s]
    real(wp), intent(in) :: n(3) !! unit vector from the point of contact to the centre

    body(1:3) = body(1:3) + body(7)*free_axes(body(8))*p
    if (body(8) > 0) then
      body(4:6) = body(4:6) + body(8)*[p(2)*n(3) - p(3)*n(2), p(3)*n(1) - p(1)*n(3), p(1)*n(2) - p(2)*n(1)]
    end if
  end subroutine push_partly_driven
end module sg_sweep_ball
