!> The mapping H on compact records: relative velocities at contacts, and impulses made felt by bodies.
module sg_compact
  use sg_compact_space, only: add_space_impulses, space_velocity
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: arm_bias_n, arm_bias_t, arm_compliance_n, arm_compliance_t, arm_frictional, arm_frictionless, &
                        arm_frictionless_bias, arm_frictionless_moment_a, arm_frictionless_moment_c, arm_inverse_i, &
                        arm_moment_na, arm_moment_nc, arm_moment_ta, arm_moment_tc, arm_spin, first_inverse, is_in_space, &
                        normal_x, normal_y, plain_kind, round_bias_n, round_bias_t, round_frictional, round_frictionless, &
                        round_frictionless_bias, round_inverse_i, round_spin, velocity_x, velocity_y
  implicit none
  private
  public :: compact_velocity, add_impulses

contains

  !> Relative velocity of a contact with its bias and compliance, u' = H^T V + bias + C r [m/s]: normal, tangential and zero;
  !! in space a vector in the world's axes, or the normal one alone where nothing rubs.
  pure function compact_velocity(problem, k) result(u)
    type(problem_t), intent(in) :: problem !! problem
    integer, intent(in) :: k !! contact
    real(wp) :: u(3), x, y
    integer :: c, a

    if (is_in_space(problem%kind)) then
      u = space_velocity(problem, k)
      return
    end if

    c = problem%pair(1, k)
    a = problem%pair(2, k)
    associate (body => problem%body, record => problem%record, r => problem%impulse)
      x = body(velocity_x, c) - body(velocity_x, a)
      y = body(velocity_y, c) - body(velocity_y, a)
      u = [record(normal_x, k)*x + record(normal_y, k)*y, record(normal_y, k)*x - record(normal_x, k)*y, 0.0_wp]
      select case (plain_kind(problem%kind))
      case (round_frictionless)
        u = [u(1) + record(round_frictionless_bias, k), 0.0_wp, 0.0_wp]
      case (round_frictional)
        u(:2) = u(:2) + [record(round_bias_n, k), record(round_bias_t, k) + body(round_spin, c) + body(round_spin, a)]
      case (arm_frictionless)
        u = [u(1) + record(arm_frictionless_moment_c, k)*body(arm_spin, c) &
             - record(arm_frictionless_moment_a, k)*body(arm_spin, a) + record(arm_frictionless_bias, k), 0.0_wp, 0.0_wp]
      case (arm_frictional)
        u(:2) = u(:2) + record(arm_moment_nc:arm_moment_tc, k)*body(arm_spin, c) &
                - record(arm_moment_na:arm_moment_ta, k)*body(arm_spin, a) + record(arm_bias_n:arm_bias_t, k) &
                + record(arm_compliance_n:arm_compliance_t, k)*r(:, k)
      end select
    end associate
  end function compact_velocity

  !> Add M^-1 H r to the velocities of all bodies: what the guess of a warm start does.
  pure subroutine add_impulses(problem)
    type(problem_t), intent(inout) :: problem !! problem whose bodies still have their free velocities
    real(wp) :: p(2)
    integer :: k, c, a, inverse

    if (is_in_space(problem%kind)) then
      call add_space_impulses(problem)
      return
    end if
    inverse = first_inverse(problem%kind)
    associate (body => problem%body, record => problem%record, r => problem%impulse)
      do k = 1, problem%n_contacts
        c = problem%pair(1, k)
        a = problem%pair(2, k)
        p = r(1, k)*record(normal_x:normal_y, k)
        if (size(r, 1) == 2) p = p + r(2, k)*[record(normal_y, k), -record(normal_x, k)]
        body(velocity_x:velocity_y, c) = body(velocity_x:velocity_y, c) + body(inverse:inverse + 1, c)*p
        body(velocity_x:velocity_y, a) = body(velocity_x:velocity_y, a) - body(inverse:inverse + 1, a)*p
        select case (plain_kind(problem%kind))
        case (round_frictional)
          body(round_spin, c) = body(round_spin, c) + body(round_inverse_i, c)*r(2, k)
          body(round_spin, a) = body(round_spin, a) + body(round_inverse_i, a)*r(2, k)
        case (arm_frictionless)
          body(arm_spin, c) = body(arm_spin, c) + body(arm_inverse_i, c)*record(arm_frictionless_moment_c, k)*r(1, k)
          body(arm_spin, a) = body(arm_spin, a) - body(arm_inverse_i, a)*record(arm_frictionless_moment_a, k)*r(1, k)
        case (arm_frictional)
          body(arm_spin, c) = body(arm_spin, c) + body(arm_inverse_i, c)*(record(arm_moment_nc, k)*r(1, k) &
                              + record(arm_moment_tc, k)*r(2, k))
          body(arm_spin, a) = body(arm_spin, a) - body(arm_inverse_i, a)*(record(arm_moment_na, k)*r(1, k) &
                              + record(arm_moment_ta, k)*r(2, k))
        end select
      end do
    end associate
  end subroutine add_impulses
end module sg_compact
