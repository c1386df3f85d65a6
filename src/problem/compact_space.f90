!> The mapping H on compact records in space: relative velocities at contacts, and impulses made felt by bodies.
module sg_compact_space
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: ball_bias_x, ball_bias_y, ball_bias_z, ball_frictional, ball_frictionless, ball_frictionless_bias, &
                        ball_frictionless_inverse_mx, ball_frictionless_inverse_mz, ball_inverse_i, ball_inverse_m, ball_spin_x, &
                        ball_spin_z, free_axes, has_moments, normal_x, normal_z, plain_kind, solid_arm_ax, solid_arm_az, &
                        solid_arm_cx, solid_arm_cz, solid_bias_x, solid_bias_z, solid_compliance_n, solid_compliance_t, &
                        solid_frictional, solid_frictionless, solid_frictionless_bias, solid_frictionless_moment_ax, &
                        solid_frictionless_moment_az, solid_frictionless_moment_cx, solid_frictionless_moment_cz, &
                        solid_inverse_mx, solid_inverse_mz, solid_inverse_xx, solid_inverse_yz, solid_spin_x, solid_spin_z, &
                        velocity_x, velocity_z
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

    do k = 1, problem%n_contacts
      if (.not. any(abs(problem%impulse(:, k)) > 0)) cycle
      if (problem%kind == ball_frictional) then
        associate (c => problem%pair(1, k), a => problem%pair(2, k))
          if (min(problem%body(ball_inverse_i, c), problem%body(ball_inverse_i, a)) >= 0) then
            call push_balls(problem%body(:, c), problem%body(:, a), problem%impulse(:, k), problem%record(:, k))
            cycle
          end if
        end associate
      end if
      call push_bodies(problem, k, problem%impulse(:, k))
    end do
  end subroutine add_space_impulses

  !> What an impulse does to two balls that are free in all directions or in none, the most frequent case.
  pure subroutine push_balls(c, a, p, n)
    real(wp), intent(inout) :: c(8), a(8)
    real(wp), intent(in) :: p(3), n(3)
    real(wp) :: turn(3)

    turn(1) = p(2)*n(3) - p(3)*n(2)
    turn(2) = p(3)*n(1) - p(1)*n(3)
    turn(3) = p(1)*n(2) - p(2)*n(1)
    c(1:3) = c(1:3) + c(7)*p
    a(1:3) = a(1:3) - a(7)*p
    c(4:6) = c(4:6) + c(8)*turn
    a(4:6) = a(4:6) + a(8)*turn
  end subroutine push_balls

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
      case (ball_frictional)
        body(velocity_x:velocity_z, c) = body(velocity_x:velocity_z, c) &
                                         + body(ball_inverse_m, c)*free_axes(body(ball_inverse_i, c))*p
        body(velocity_x:velocity_z, a) = body(velocity_x:velocity_z, a) &
                                         - body(ball_inverse_m, a)*free_axes(body(ball_inverse_i, a))*p
        body(ball_spin_x:ball_spin_z, c) = body(ball_spin_x:ball_spin_z, c) &
                                           + max(0.0_wp, body(ball_inverse_i, c))*cross(p, record(normal_x:normal_z))
        body(ball_spin_x:ball_spin_z, a) = body(ball_spin_x:ball_spin_z, a) &
                                           + max(0.0_wp, body(ball_inverse_i, a))*cross(p, record(normal_x:normal_z))
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
