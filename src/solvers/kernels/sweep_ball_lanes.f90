!> Gauss-Seidel sweep over balls with friction in groups side by side, for vector registers (doc/theory/nlgs.md).
!!
!! No movable body is twice in a group, so that its contacts may be updated at once. Unlike the sweep one by one this one
!! has no branch that a processor could guess wrong: sticking, sliding and open contacts take the same time.
module sg_sweep_ball_lanes
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use sg_group_dealing, only: lanes
  use sg_kinds, only: wp, i4
  use sg_records, only: ball_bias_x, ball_bias_y, ball_bias_z, ball_friction, ball_frictional, ball_inverse_i, ball_inverse_m, &
                        ball_inverse_wnn, ball_inverse_wtt, ball_spin_x, ball_spin_y, ball_spin_z, body_length, normal_x, &
                        normal_y, normal_z, velocity_x, velocity_y, velocity_z
  use sg_sweep_ball, only: push_partly_driven
  implicit none
  private
  public :: sweep_ball_lanes

  !> How many groups ahead records and bodies are asked for: later, they come too late; earlier, they are gone again
  integer, parameter :: records_ahead = 6, bodies_ahead = 3

  interface
    !> Ask for records, impulses and slots of a group (prefetch.cpp).
    pure subroutine prefetch_group(record, impulse, pair) bind(c, name='sg_prefetch_group')
      import :: c_double, c_int
      real(c_double), intent(in) :: record(*), impulse(*)
      integer(c_int), intent(in) :: pair(*)
    end subroutine prefetch_group

    !> Ask for the bodies of a group.
    pure subroutine prefetch_bodies(pair, body) bind(c, name='sg_prefetch_bodies')
      import :: c_double, c_int
      integer(c_int), intent(in) :: pair(*)
      real(c_double), intent(in) :: body(*)
    end subroutine prefetch_bodies
  end interface

contains

  !> One sweep with Coulomb friction, group by group.
  pure subroutine sweep_ball_lanes(n_groups, n_bodies, pair, record, relaxation, impulse, body)
    integer, intent(in) :: n_groups !! groups
    integer, intent(in) :: n_bodies !! slots
    integer(i4), intent(in) :: pair(lanes, 2, n_groups) !! slots of candidate and antagonist
    real(wp), intent(in) :: record(lanes, ball_friction, n_groups) !! records of contacts; zero in lanes to spare
    real(wp), intent(in) :: relaxation !! share of each change taken
    real(wp), intent(inout) :: impulse(lanes, 3, n_groups) !! impulses [N s]
    real(wp), intent(inout) :: body(body_length(ball_frictional), n_bodies) !! records of bodies; their velocities change
    real(wp), dimension(lanes) :: vx, vy, vz, sx, sy, sz, px, py, pz
    real(wp) :: lowest
    integer :: g, i, next
    integer(i4) :: c, a

    do g = 1, n_groups
      next = min(g + records_ahead, n_groups)
      call prefetch_group(record(:, :, next), impulse(:, :, next), pair(:, :, next))
      call prefetch_bodies(pair(:, :, min(g + bodies_ahead, n_groups)), body)
      lowest = 0
      do i = 1, lanes
        c = pair(i, 1, g)
        a = pair(i, 2, g)
        vx(i) = body(velocity_x, c) - body(velocity_x, a)
        vy(i) = body(velocity_y, c) - body(velocity_y, a)
        vz(i) = body(velocity_z, c) - body(velocity_z, a)
        sx(i) = body(ball_spin_x, c) + body(ball_spin_x, a)
        sy(i) = body(ball_spin_y, c) + body(ball_spin_y, a)
        sz(i) = body(ball_spin_z, c) + body(ball_spin_z, a)
        lowest = min(lowest, body(ball_inverse_i, c), body(ball_inverse_i, a))
      end do
      call update_group(record(:, :, g), relaxation, vx, vy, vz, sx, sy, sz, impulse(:, :, g), px, py, pz)
      if (lowest < 0) then
        do i = 1, lanes
          call push_partly_driven(body(:, pair(i, 1, g)), [px(i), py(i), pz(i)], record(i, normal_x:normal_z, g))
          call push_partly_driven(body(:, pair(i, 2, g)), -[px(i), py(i), pz(i)], -record(i, normal_x:normal_z, g))
        end do
        cycle
      end if
      do i = 1, lanes
        c = pair(i, 1, g)
        a = pair(i, 2, g)
        body(velocity_x, c) = body(velocity_x, c) + body(ball_inverse_m, c)*px(i)
        body(velocity_y, c) = body(velocity_y, c) + body(ball_inverse_m, c)*py(i)
        body(velocity_z, c) = body(velocity_z, c) + body(ball_inverse_m, c)*pz(i)
        body(ball_spin_x, c) = body(ball_spin_x, c) + body(ball_inverse_i, c)*sx(i)
        body(ball_spin_y, c) = body(ball_spin_y, c) + body(ball_inverse_i, c)*sy(i)
        body(ball_spin_z, c) = body(ball_spin_z, c) + body(ball_inverse_i, c)*sz(i)
        body(velocity_x, a) = body(velocity_x, a) - body(ball_inverse_m, a)*px(i)
        body(velocity_y, a) = body(velocity_y, a) - body(ball_inverse_m, a)*py(i)
        body(velocity_z, a) = body(velocity_z, a) - body(ball_inverse_m, a)*pz(i)
        body(ball_spin_x, a) = body(ball_spin_x, a) + body(ball_inverse_i, a)*sx(i)
        body(ball_spin_y, a) = body(ball_spin_y, a) + body(ball_inverse_i, a)*sy(i)
        body(ball_spin_z, a) = body(ball_spin_z, a) + body(ball_inverse_i, a)*sz(i)
      end do
    end do
  end subroutine sweep_ball_lanes

  !> New impulses of a group from the relative velocities of its contacts.
  pure subroutine update_group(record, relaxation, vx, vy, vz, sx, sy, sz, impulse, px, py, pz)
    real(wp), intent(in) :: record(lanes, ball_friction), relaxation
    real(wp), intent(in) :: vx(lanes), vy(lanes), vz(lanes) !! difference of the centres' velocities [m/s]
    real(wp), intent(inout) :: sx(lanes), sy(lanes), sz(lanes) !! sum of R spin [m/s]; then p x n, what changes the spins
    real(wp), intent(inout) :: impulse(lanes, 3)
    real(wp), intent(out) :: px(lanes), py(lanes), pz(lanes) !! change of the impulses [N s]
    real(wp) :: x, y, z, ux, uy, uz, tx, ty, tz, u_n, p_n, r_n, share
    integer :: i

    do i = 1, lanes
      x = record(i, normal_x)
      y = record(i, normal_y)
      z = record(i, normal_z)
      ux = vx(i) + record(i, ball_bias_x) - sy(i)*z + sz(i)*y
      uy = vy(i) + record(i, ball_bias_y) - sz(i)*x + sx(i)*z
      uz = vz(i) + record(i, ball_bias_z) - sx(i)*y + sy(i)*x
      u_n = x*ux + y*uy + z*uz
      p_n = x*impulse(i, 1) + y*impulse(i, 2) + z*impulse(i, 3)
      r_n = max(0.0_wp, p_n - u_n*record(i, ball_inverse_wnn))
      share = p_n - u_n*record(i, ball_inverse_wtt)
      tx = impulse(i, 1) - ux*record(i, ball_inverse_wtt) - share*x
      ty = impulse(i, 2) - uy*record(i, ball_inverse_wtt) - share*y
      tz = impulse(i, 3) - uz*record(i, ball_inverse_wtt) - share*z
      share = min(1.0_wp, record(i, ball_friction)*r_n/sqrt(max(tx*tx + ty*ty + tz*tz, tiny(1.0_wp))))
      px(i) = relaxation*(r_n*x + share*tx - impulse(i, 1))
      py(i) = relaxation*(r_n*y + share*ty - impulse(i, 2))
      pz(i) = relaxation*(r_n*z + share*tz - impulse(i, 3))
      impulse(i, 1) = impulse(i, 1) + px(i)
      impulse(i, 2) = impulse(i, 2) + py(i)
      impulse(i, 3) = impulse(i, 3) + pz(i)
      sx(i) = py(i)*z - pz(i)*y
      sy(i) = pz(i)*x - px(i)*z
      sz(i) = px(i)*y - py(i)*x
    end do
  end subroutine update_group
end module sg_sweep_ball_lanes
