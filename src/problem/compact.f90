!> The mapping H on compact records: relative velocities at contacts, and impulses made felt by bodies.
module sg_compact
  use sg_compact_space, only: add_space_impulses, space_velocity
  use sg_kinds, only: wp, i4
  use sg_prefetch, only: prefetch, run => run_of_records, runs_ahead
  use sg_problem, only: problem_t
  use sg_records, only: arm_bias_n, arm_bias_t, arm_compliance_n, arm_compliance_t, arm_frictional, arm_frictionless, &
                        arm_frictionless_bias, arm_frictionless_moment_a, arm_frictionless_moment_c, arm_gyration, arm_inverse_i, &
                        arm_inverse_mx, arm_inverse_my, arm_moment_na, arm_moment_nc, arm_moment_ta, arm_moment_tc, arm_spin, &
                        body_length, has_moments, is_in_space, normal_x, normal_y, plain_kind, record_length, round_bias_n, &
                        round_bias_t, round_frictional, round_frictionless, round_frictionless_bias, &
                        round_frictionless_inverse_mx, round_frictionless_inverse_my, round_inverse_i, round_inverse_mx, &
                        round_inverse_my, round_spin, solid_gyration, solid_spin_x, solid_spin_z, velocity_x, velocity_y
  implicit none
  private
  public :: compact_velocity, relative_spin, scaled_spin, add_impulses

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
                + record(arm_compliance_n:arm_compliance_t, k)*r(:2, k)
      end select
    end associate
  end function compact_velocity

  !> Relative spin of a contact that may bear a moment, candidate minus antagonist, in the world's axes; in the plane the third
  !! component [rad/s].
  pure function relative_spin(problem, k) result(w)
    type(problem_t), intent(in) :: problem !! problem of a kind with moments
    integer, intent(in) :: k !! contact
    real(wp) :: w(3)

    associate (body => problem%body, c => problem%pair(1, k), a => problem%pair(2, k))
      if (is_in_space(problem%kind)) then
        w = body(solid_spin_x:solid_spin_z, c) - body(solid_spin_x:solid_spin_z, a)
      else
        w = [0.0_wp, 0.0_wp, body(arm_spin, c) - body(arm_spin, a)]
      end if
    end associate
  end function relative_spin

  !> That spin times the length that makes it comparable with velocities [m/s]; zero where the contact resists no rolling.
  pure function scaled_spin(problem, k) result(w)
    type(problem_t), intent(in) :: problem !! problem of a kind with moments
    integer, intent(in) :: k !! contact
    real(wp) :: w(3)

    w = problem%record(merge(solid_gyration, arm_gyration, is_in_space(problem%kind)), k)*relative_spin(problem, k)
  end function scaled_spin

  !> Add M^-1 H r to the velocities of all bodies: what the guess of a warm start does.
  pure subroutine add_impulses(problem)
    type(problem_t), intent(inout) :: problem !! problem whose bodies still have their free velocities

    associate (n => problem%n_contacts, m => problem%n_bodies, pair => problem%pair, record => problem%record, &
               r => problem%impulse, body => problem%body)
      select case (plain_kind(problem%kind))
      case (round_frictionless)
        call add_round_frictionless(n, m, pair, record, r, body)
      case (round_frictional)
        call add_round_frictional(n, m, pair, record, r, body)
      case (arm_frictionless)
        call add_arm_frictionless(n, m, pair, record, r, body)
      case (arm_frictional)
        call add_arm_frictional(n, m, size(record, 1), size(r, 1), pair, record, r, body)
        if (has_moments(problem%kind)) call add_plane_moments(n, m, pair, r, body)
      case default
        call add_space_impulses(problem)
      end select
    end associate
  end subroutine add_impulses

  !> Those of round contacts without friction. Here and below contacts without an impulse are passed over, their records unread.
  pure subroutine add_round_frictionless(n, n_bodies, pair, record, r, body)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: record(record_length(round_frictionless), n), r(1, n)
    real(wp), intent(inout) :: body(body_length(round_frictionless), n_bodies)
    real(wp) :: x, y
    integer :: k

    do k = 1, n
      if (abs(r(1, k)) <= 0) cycle
      x = r(1, k)*record(normal_x, k)
      y = r(1, k)*record(normal_y, k)
      associate (c => pair(1, k), a => pair(2, k))
        body(velocity_x, c) = body(velocity_x, c) + body(round_frictionless_inverse_mx, c)*x
        body(velocity_y, c) = body(velocity_y, c) + body(round_frictionless_inverse_my, c)*y
        body(velocity_x, a) = body(velocity_x, a) - body(round_frictionless_inverse_mx, a)*x
        body(velocity_y, a) = body(velocity_y, a) - body(round_frictionless_inverse_my, a)*y
      end associate
    end do
  end subroutine add_round_frictionless

  !> Those of round contacts with friction.
  pure subroutine add_round_frictional(n, n_bodies, pair, record, r, body)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: record(record_length(round_frictional), n), r(2, n)
    real(wp), intent(inout) :: body(body_length(round_frictional), n_bodies)
    real(wp) :: x, y, across
    integer :: k

    do k = 1, n
      if (abs(r(1, k)) <= 0 .and. abs(r(2, k)) <= 0) cycle
      across = -record(normal_x, k)
      x = r(2, k)*record(normal_y, k) + r(1, k)*record(normal_x, k)
      y = r(2, k)*across + r(1, k)*record(normal_y, k)
      associate (c => pair(1, k), a => pair(2, k))
        body(velocity_x, c) = body(velocity_x, c) + body(round_inverse_mx, c)*x
        body(velocity_y, c) = body(velocity_y, c) + body(round_inverse_my, c)*y
        body(round_spin, c) = body(round_spin, c) + body(round_inverse_i, c)*r(2, k)
        body(velocity_x, a) = body(velocity_x, a) - body(round_inverse_mx, a)*x
        body(velocity_y, a) = body(velocity_y, a) - body(round_inverse_my, a)*y
        body(round_spin, a) = body(round_spin, a) + body(round_inverse_i, a)*r(2, k)
      end associate
    end do
  end subroutine add_round_frictional

  !> Those of contacts with any arms, without friction.
  pure subroutine add_arm_frictionless(n, n_bodies, pair, record, r, body)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: record(record_length(arm_frictionless), n), r(1, n)
    real(wp), intent(inout) :: body(body_length(arm_frictionless), n_bodies)
    real(wp) :: x, y
    integer :: k

    do k = 1, n
      if (abs(r(1, k)) <= 0) cycle
      x = r(1, k)*record(normal_x, k)
      y = r(1, k)*record(normal_y, k)
      associate (c => pair(1, k), a => pair(2, k))
        body(velocity_x, c) = body(velocity_x, c) + body(arm_inverse_mx, c)*x
        body(velocity_y, c) = body(velocity_y, c) + body(arm_inverse_my, c)*y
        body(arm_spin, c) = body(arm_spin, c) + body(arm_inverse_i, c)*record(arm_frictionless_moment_c, k)*r(1, k)
        body(velocity_x, a) = body(velocity_x, a) - body(arm_inverse_mx, a)*x
        body(velocity_y, a) = body(velocity_y, a) - body(arm_inverse_my, a)*y
        body(arm_spin, a) = body(arm_spin, a) - body(arm_inverse_i, a)*record(arm_frictionless_moment_a, k)*r(1, k)
      end associate
    end do
  end subroutine add_arm_frictionless

  !> Moments of contacts.
  pure subroutine add_plane_moments(n, n_bodies, pair, r, body)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: r(3, n)
    real(wp), intent(inout) :: body(body_length(arm_frictional), n_bodies)
    integer :: k

    do k = 1, n
      if (abs(r(3, k)) <= 0) cycle
      associate (c => pair(1, k), a => pair(2, k))
        body(arm_spin, c) = body(arm_spin, c) + body(arm_inverse_i, c)*r(3, k)
        body(arm_spin, a) = body(arm_spin, a) - body(arm_inverse_i, a)*r(3, k)
      end associate
    end do
  end subroutine add_plane_moments

  !> Those of contacts with any arms and any law, with bonds and moments or without.
  pure subroutine add_arm_frictional(n, n_bodies, length, components, pair, record, r, body)
    integer, intent(in) :: n, n_bodies, length, components
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: record(length, n), r(components, n)
    real(wp), intent(inout) :: body(body_length(arm_frictional), n_bodies)
    real(wp) :: x, y, across
    integer :: k, first

    do first = 1, n, run
      call prefetch(record(1, first), runs_ahead*run*length, run*length)
      do k = first, min(n, first + run - 1)
        if (abs(r(1, k)) <= 0 .and. abs(r(2, k)) <= 0) cycle
        across = -record(normal_x, k)
        x = r(2, k)*record(normal_y, k) + r(1, k)*record(normal_x, k)
        y = r(2, k)*across + r(1, k)*record(normal_y, k)
        associate (c => pair(1, k), a => pair(2, k))
          body(velocity_x, c) = body(velocity_x, c) + body(arm_inverse_mx, c)*x
          body(velocity_y, c) = body(velocity_y, c) + body(arm_inverse_my, c)*y
          body(arm_spin, c) = body(arm_spin, c) + body(arm_inverse_i, c)*(record(arm_moment_nc, k)*r(1, k) &
                              + record(arm_moment_tc, k)*r(2, k))
          body(velocity_x, a) = body(velocity_x, a) - body(arm_inverse_mx, a)*x
          body(velocity_y, a) = body(velocity_y, a) - body(arm_inverse_my, a)*y
          body(arm_spin, a) = body(arm_spin, a) - body(arm_inverse_i, a)*(record(arm_moment_na, k)*r(1, k) &
                              + record(arm_moment_ta, k)*r(2, k))
        end associate
      end do
    end do
  end subroutine add_arm_frictional
end module sg_compact
