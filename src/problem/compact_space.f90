!> The mapping H on compact records in space: relative velocities at contacts, and impulses made felt by bodies.
module sg_compact_space
  use sg_kinds, only: wp, i4
  use sg_prefetch, only: prefetch, run => run_of_records, runs_ahead
  use sg_problem, only: problem_t
  use sg_records, only: ball_bias_x, ball_bias_y, ball_bias_z, ball_frictional, ball_frictionless, ball_frictionless_bias, &
                        ball_frictionless_inverse_mx, ball_frictionless_inverse_mz, ball_inverse_i, ball_inverse_m, ball_spin_x, &
                        ball_spin_y, ball_spin_z, body_length, free_axes, has_moments, normal_x, normal_y, normal_z, plain_kind, &
                        record_length, solid_arm_ax, solid_arm_az, solid_arm_cx, solid_arm_cz, solid_bias_x, solid_bias_z, &
                        solid_compliance_n, solid_compliance_t, solid_frictional, solid_frictionless, solid_frictionless_bias, &
                        solid_frictionless_moment_ax, solid_frictionless_moment_az, solid_frictionless_moment_cx, &
                        solid_frictionless_moment_cz, solid_inverse_mx, solid_inverse_my, solid_inverse_mz, solid_inverse_xx, &
                        solid_inverse_xy, solid_inverse_xz, solid_inverse_yy, solid_inverse_yz, solid_inverse_zz, solid_spin_x, &
                        solid_spin_y, solid_spin_z, velocity_x, velocity_y, velocity_z
  use sg_vectors, only: cross
  implicit none
  private
  public :: space_velocity, add_space_impulses

contains

  !> Relative velocity of a contact with its bias and compliance, u' = H^T V + bias + C r [m/s]: a vector in the world's
  !! axes, or the normal one and two zeros where nothing rubs.
  pure function space_velocity(problem, k) result(u)
    type(problem_t), intent(in) :: problem !! problem
    integer, intent(in) :: k !! contact
    real(wp) :: u(3), n(3), s(3)
    integer :: c, a

    c = problem%pair(1, k)
    a = problem%pair(2, k)
    associate (body => problem%body, record => problem%record(:, k), r => problem%impulse(:, k))
      n = record(normal_x:normal_z)
      u = body(velocity_x:velocity_z, c) - body(velocity_x:velocity_z, a)
      select case (plain_kind(problem%kind))
      case (ball_frictionless)
        u = [dot_product(n, u) + record(ball_frictionless_bias), 0.0_wp, 0.0_wp]
      case (ball_frictional)
        ! Written out, as what `push_balls` does: the compiler calls a procedure of another file, and this is most of the work.
        s = body(ball_spin_x:ball_spin_z, c) + body(ball_spin_x:ball_spin_z, a)
        u(1) = u(1) - s(2)*n(3) + s(3)*n(2) + record(ball_bias_x)
        u(2) = u(2) - s(3)*n(1) + s(1)*n(3) + record(ball_bias_y)
        u(3) = u(3) - s(1)*n(2) + s(2)*n(1) + record(ball_bias_z)
      case (solid_frictionless)
        u = [dot_product(n, u) &
             + dot_product(record(solid_frictionless_moment_cx:solid_frictionless_moment_cz), body(solid_spin_x:solid_spin_z, c)) &
             - dot_product(record(solid_frictionless_moment_ax:solid_frictionless_moment_az), body(solid_spin_x:solid_spin_z, a)) &
             + record(solid_frictionless_bias), 0.0_wp, 0.0_wp]
      case (solid_frictional)
        u = u + cross(body(solid_spin_x:solid_spin_z, c), record(solid_arm_cx:solid_arm_cz)) &
            - cross(body(solid_spin_x:solid_spin_z, a), record(solid_arm_ax:solid_arm_az)) + record(solid_bias_x:solid_bias_z) &
            + record(solid_compliance_t)*r(:3) + (record(solid_compliance_n) - record(solid_compliance_t))*dot_product(n, r(:3))*n
      end select
    end associate
  end function space_velocity

  !> Add M^-1 H r to the velocities of all bodies: what the guess of a warm start does.
  pure subroutine add_space_impulses(problem)
    type(problem_t), intent(inout) :: problem !! problem whose bodies still have their free velocities
    integer :: k

    associate (n => problem%n_contacts, m => problem%n_bodies, pair => problem%pair, record => problem%record, &
               r => problem%impulse, body => problem%body)
      select case (problem%kind)
      case (ball_frictional)
        call push_balls(n, m, pair, record, r, body)
      case (solid_frictional)
        call push_solids(n, m, pair, record, r, body)
      case default
        do k = 1, n
          if (any(abs(r(:, k)) > 0)) call push_bodies(problem, k, r(:, k))
        end do
      end select
    end associate
  end subroutine add_space_impulses

  !> Those of balls with friction, on plain arrays, number by number: parts of bodies stored one by one and loaded as a whole would
  !! have the processor wait. Most balls are free in all directions or in none.
  pure subroutine push_balls(n, n_bodies, pair, record, r, body)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: record(record_length(ball_frictional), n), r(3, n)
    real(wp), intent(inout) :: body(body_length(ball_frictional), n_bodies)
    real(wp) :: x, y, z, turn_x, turn_y, turn_z, mx, my, mz, s
    integer :: k, side, b

    do k = 1, n
      x = r(1, k)
      y = r(2, k)
      z = r(3, k)
      if (.not. abs(x) + abs(y) + abs(z) > 0) cycle
      turn_x = y*record(normal_z, k) - z*record(normal_y, k)
      turn_y = z*record(normal_x, k) - x*record(normal_z, k)
      turn_z = x*record(normal_y, k) - y*record(normal_x, k)
      do side = 1, 2
        b = pair(side, k)
        mx = body(ball_inverse_m, b)
        my = mx
        mz = mx
        s = body(ball_inverse_i, b)
        if (s < 0) call hold_axes(s, mx, my, mz)
        body(velocity_x, b) = body(velocity_x, b) + mx*x
        body(velocity_y, b) = body(velocity_y, b) + my*y
        body(velocity_z, b) = body(velocity_z, b) + mz*z
        body(ball_spin_x, b) = body(ball_spin_x, b) + s*turn_x
        body(ball_spin_y, b) = body(ball_spin_y, b) + s*turn_y
        body(ball_spin_z, b) = body(ball_spin_z, b) + s*turn_z
        x = -x
        y = -y
        z = -z
      end do
    end do
  end subroutine push_balls

  !> Inverse masses of a ball that is held along some axes, which a mark below zero lists in place of its inverse inertia.
  pure subroutine hold_axes(mark, mx, my, mz)
    real(wp), intent(inout) :: mark, mx, my, mz
    real(wp) :: free(3)

    free = free_axes(mark)
    mx = mx*free(1)
    my = my*free(2)
    mz = mz*free(3)
    mark = 0
  end subroutine hold_axes

  !> Those of solids with friction.
  pure subroutine push_solids(n, n_bodies, pair, record, r, body)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: record(record_length(solid_frictional), n), r(3, n)
    real(wp), intent(inout) :: body(body_length(solid_frictional), n_bodies)
    real(wp) :: x, y, z, turn_x, turn_y, turn_z
    integer :: k, first, length, side, b, arm

    length = size(record, 1)
    do first = 1, n, run
      call prefetch(record(1, first), runs_ahead*run*length, run*length)
      do k = first, min(n, first + run - 1)
        x = r(1, k)
        y = r(2, k)
        z = r(3, k)
        if (.not. abs(x) + abs(y) + abs(z) > 0) cycle
        do side = 1, 2
          b = pair(side, k)
          arm = merge(solid_arm_cx, solid_arm_ax, side == 1)
          turn_x = record(arm + 1, k)*z - record(arm + 2, k)*y
          turn_y = record(arm + 2, k)*x - record(arm, k)*z
          turn_z = record(arm, k)*y - record(arm + 1, k)*x
          body(velocity_x, b) = body(velocity_x, b) + body(solid_inverse_mx, b)*x
          body(velocity_y, b) = body(velocity_y, b) + body(solid_inverse_my, b)*y
          body(velocity_z, b) = body(velocity_z, b) + body(solid_inverse_mz, b)*z
          body(solid_spin_x, b) = body(solid_spin_x, b) + (body(solid_inverse_xx, b)*turn_x + body(solid_inverse_xy, b)*turn_y &
                                                           + body(solid_inverse_xz, b)*turn_z)
          body(solid_spin_y, b) = body(solid_spin_y, b) + (body(solid_inverse_xy, b)*turn_x + body(solid_inverse_yy, b)*turn_y &
                                                           + body(solid_inverse_yz, b)*turn_z)
          body(solid_spin_z, b) = body(solid_spin_z, b) + (body(solid_inverse_xz, b)*turn_x + body(solid_inverse_yz, b)*turn_y &
                                                           + body(solid_inverse_zz, b)*turn_z)
          x = -x
          y = -y
          z = -z
        end do
      end do
    end do
  end subroutine push_solids

  !> Add to the velocities of its two bodies what an impulse at one contact does.
  pure subroutine push_bodies(problem, k, r)
    type(problem_t), intent(inout) :: problem !! problem
    integer, intent(in) :: k !! contact
    real(wp), intent(in) :: r(:) !! impulse as the kind of problem has it [N s]
    real(wp) :: p(3)
    integer :: c, a

    c = problem%pair(1, k)
    a = problem%pair(2, k)
    associate (body => problem%body, record => problem%record(:, k))
      if (size(r) == 1) then
        p = r(1)*record(normal_x:normal_z)
      else
        p = r(:3)
      end if
      select case (plain_kind(problem%kind))
      case (ball_frictionless)
        body(velocity_x:velocity_z, c) = body(velocity_x:velocity_z, c) &
                                         + body(ball_frictionless_inverse_mx:ball_frictionless_inverse_mz, c)*p
        body(velocity_x:velocity_z, a) = body(velocity_x:velocity_z, a) &
                                         - body(ball_frictionless_inverse_mx:ball_frictionless_inverse_mz, a)*p
      case default
        body(velocity_x:velocity_z, c) = body(velocity_x:velocity_z, c) + body(solid_inverse_mx:solid_inverse_mz, c)*p
        body(velocity_x:velocity_z, a) = body(velocity_x:velocity_z, a) - body(solid_inverse_mx:solid_inverse_mz, a)*p
        if (problem%kind == solid_frictionless) then
          body(solid_spin_x:solid_spin_z, c) = body(solid_spin_x:solid_spin_z, c) &
                                               + turned_spin(body(solid_inverse_xx:solid_inverse_yz, c), &
                                                             r(1)*record(solid_frictionless_moment_cx:solid_frictionless_moment_cz))
          body(solid_spin_x:solid_spin_z, a) = body(solid_spin_x:solid_spin_z, a) &
                                               - turned_spin(body(solid_inverse_xx:solid_inverse_yz, a), &
                                                             r(1)*record(solid_frictionless_moment_ax:solid_frictionless_moment_az))
        else
          body(solid_spin_x:solid_spin_z, c) = body(solid_spin_x:solid_spin_z, c) &
                                               + turned_spin(body(solid_inverse_xx:solid_inverse_yz, c), &
                                                             cross(record(solid_arm_cx:solid_arm_cz), p))
          body(solid_spin_x:solid_spin_z, a) = body(solid_spin_x:solid_spin_z, a) &
                                               - turned_spin(body(solid_inverse_xx:solid_inverse_yz, a), &
                                                             cross(record(solid_arm_ax:solid_arm_az), p))
        end if
        if (.not. has_moments(problem%kind)) return
        body(solid_spin_x:solid_spin_z, c) = body(solid_spin_x:solid_spin_z, c) &
                                             + turned_spin(body(solid_inverse_xx:solid_inverse_yz, c), r(4:6))
        body(solid_spin_x:solid_spin_z, a) = body(solid_spin_x:solid_spin_z, a) &
                                             - turned_spin(body(solid_inverse_xx:solid_inverse_yz, a), r(4:6))
      end select
    end associate
  end subroutine push_bodies

  !> Inverse inertia (xx, yy, zz, xy, xz, yz) times an angular impulse.
  pure function turned_spin(inverse, p) result(w)
    real(wp), intent(in) :: inverse(6), p(3)
    real(wp) :: w(3)

    w = [inverse(1)*p(1) + inverse(4)*p(2) + inverse(5)*p(3), inverse(4)*p(1) + inverse(2)*p(2) + inverse(6)*p(3), &
         inverse(5)*p(1) + inverse(6)*p(2) + inverse(3)*p(3)]
  end function turned_spin
end module sg_compact_space
