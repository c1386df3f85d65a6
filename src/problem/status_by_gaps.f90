!> Statuses of solved contacts whose laws look at gaps alone: one pass per kind of problem, without a call per contact
!! (doc/theory/contact_problem.md). `status_of` of sg_contact_status has the same judgement for all laws.
module sg_status_by_gaps
  use sg_contact_status, only: least_rest
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: status_none, status_slide, status_stick
  use sg_problem, only: problem_t
  use sg_records, only: arm_bias_n, arm_bias_t, arm_friction, arm_frictional, arm_moment_na, arm_moment_nc, arm_moment_ta, &
                        arm_moment_tc, arm_spin, arm_wnn, arm_wnt, arm_wtt, ball_bias_x, ball_bias_y, ball_bias_z, &
                        ball_friction, ball_frictional, ball_inverse_wnn, ball_inverse_wtt, ball_spin_x, ball_spin_y, &
                        ball_spin_z, body_length, normal_x, normal_y, normal_z, record_length, round_bias_n, round_bias_t, &
                        round_friction, round_frictional, round_inverse_wnn, round_inverse_wtt, round_spin, solid_arm_ax, &
                        solid_arm_ay, solid_arm_az, solid_arm_cx, solid_arm_cy, solid_arm_cz, solid_bias_x, solid_bias_y, &
                        solid_bias_z, solid_friction, solid_frictional, solid_law, solid_s1, solid_s2, solid_spin_x, &
                        solid_spin_y, solid_spin_z, solid_wnn, velocity_x, velocity_y, velocity_z
  use sg_threads, only: begin_share, n_sharing, piece_t, share_t, takes
  implicit none
  private
  public :: find_statuses

  !> Least contacts of a piece
  integer, parameter :: least_contacts = 1024

contains

  !> What the contacts of a solved problem did in the step: nothing, stick or slide.
  subroutine find_statuses(problem, rest, status)
    type(problem_t), intent(in) :: problem !! solved problem with friction, its laws look at gaps
    real(wp), intent(in) :: rest !! velocity that counts as none [m/s]
    integer(i1), intent(inout), contiguous :: status(:) !! of its contacts
    type(share_t) :: share
    type(piece_t) :: piece
    integer :: t

    call begin_share(share, problem%n_contacts, least_contacts)
    !$omp taskloop default(shared) private(t, piece) grainsize(1) if (share%pieces > 1)
    do t = 1, n_sharing()
      do while (takes(share, piece))
        associate (a => piece%first, z => piece%last)
          call find_some(problem%kind, problem%n_bodies, problem%pair(:, a:z), problem%record(:, a:z), problem%impulse(:, a:z), &
                         problem%body, rest, status(a:z))
        end associate
      end do
    end do
  end subroutine find_statuses

  !> Those of some contacts.
  pure subroutine find_some(kind, m, pair, record, r, body, rest, status)
    integer, intent(in) :: kind, m
    integer(i4), intent(in), contiguous :: pair(:, :)
    real(wp), intent(in), contiguous :: record(:, :), r(:, :), body(:, :)
    real(wp), intent(in) :: rest
    integer(i1), intent(inout), contiguous :: status(:)
    integer :: n

    n = size(status)
    select case (kind)
    case (round_frictional)
      call find_round(n, m, pair, record, r, body, rest, status)
    case (arm_frictional)
      call find_arms(n, m, pair, record, r, body, rest, status)
    case (ball_frictional)
      call find_balls(n, m, pair, record, r, body, rest, status)
    case (solid_frictional)
      call find_solids(n, m, pair, record, r, body, rest, status)
    end select
  end subroutine find_some

  !> Those of disks.
  pure subroutine find_round(n, n_bodies, pair, record, r, body, rest, status)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: record(record_length(round_frictional), n), r(2, n), rest
    real(wp), intent(in) :: body(body_length(round_frictional), n_bodies)
    integer(i1), intent(inout) :: status(n)
    real(wp) :: x, y, opening, slip
    integer :: k

    do k = 1, n
      status(k) = status_none
      if (.not. r(1, k) > 0) cycle
      associate (c => pair(1, k), a => pair(2, k))
        x = body(velocity_x, c) - body(velocity_x, a)
        y = body(velocity_y, c) - body(velocity_y, a)
        opening = record(normal_x, k)*x + record(normal_y, k)*y + record(round_bias_n, k)
        slip = abs(record(normal_y, k)*x - record(normal_x, k)*y &
                   + (record(round_bias_t, k) + body(round_spin, c) + body(round_spin, a)))
      end associate
      call judge(opening, slip, r(1, k), abs(r(2, k)), record(round_friction, k), inverse(record(round_inverse_wnn, k)), &
                 inverse(record(round_inverse_wtt, k)), rest, status(k))
    end do
  end subroutine find_round

  !> Those of contacts with any arms in the plane.
  pure subroutine find_arms(n, n_bodies, pair, record, r, body, rest, status)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: record(record_length(arm_frictional), n), r(2, n), rest
    real(wp), intent(in) :: body(body_length(arm_frictional), n_bodies)
    integer(i1), intent(inout) :: status(n)
    real(wp) :: x, y, opening, slip
    integer :: k

    do k = 1, n
      status(k) = status_none
      if (.not. r(1, k) > 0) cycle
      associate (c => pair(1, k), a => pair(2, k))
        x = body(velocity_x, c) - body(velocity_x, a)
        y = body(velocity_y, c) - body(velocity_y, a)
        opening = record(normal_x, k)*x + record(normal_y, k)*y + record(arm_moment_nc, k)*body(arm_spin, c) &
                  - record(arm_moment_na, k)*body(arm_spin, a) + record(arm_bias_n, k)
        slip = abs(record(normal_y, k)*x - record(normal_x, k)*y + record(arm_moment_tc, k)*body(arm_spin, c) &
                   - record(arm_moment_ta, k)*body(arm_spin, a) + record(arm_bias_t, k))
      end associate
      call judge(opening, slip, r(1, k), abs(r(2, k)), record(arm_friction, k), record(arm_wnn, k), &
                 max(0.0_wp, record(arm_wtt, k) - record(arm_wnt, k)**2*inverse(record(arm_wnn, k))), rest, status(k))
    end do
  end subroutine find_arms

  !> Those of balls.
  pure subroutine find_balls(n, n_bodies, pair, record, r, body, rest, status)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: record(record_length(ball_frictional), n), r(3, n), rest
    real(wp), intent(in) :: body(body_length(ball_frictional), n_bodies)
    integer(i1), intent(inout) :: status(n)
    real(wp) :: normal(3), u(3), sx, sy, sz, pressing
    integer :: k

    do k = 1, n
      status(k) = status_none
      normal = record(normal_x:normal_z, k)
      pressing = normal(1)*r(1, k) + normal(2)*r(2, k) + normal(3)*r(3, k)
      if (.not. pressing > 0) cycle
      associate (c => pair(1, k), a => pair(2, k))
        sx = body(ball_spin_x, c) + body(ball_spin_x, a)
        sy = body(ball_spin_y, c) + body(ball_spin_y, a)
        sz = body(ball_spin_z, c) + body(ball_spin_z, a)
        u(1) = body(velocity_x, c) - body(velocity_x, a) - sy*normal(3) + sz*normal(2) + record(ball_bias_x, k)
        u(2) = body(velocity_y, c) - body(velocity_y, a) - sz*normal(1) + sx*normal(3) + record(ball_bias_y, k)
        u(3) = body(velocity_z, c) - body(velocity_z, a) - sx*normal(2) + sy*normal(1) + record(ball_bias_z, k)
      end associate
      call judge_in_space(normal, u, r(:, k), pressing, record(ball_friction, k), inverse(record(ball_inverse_wnn, k)), &
                          inverse(record(ball_inverse_wtt, k)), rest, status(k))
    end do
  end subroutine find_balls

  !> Those of contacts with any arms in space.
  pure subroutine find_solids(n, n_bodies, pair, record, r, body, rest, status)
    integer, intent(in) :: n, n_bodies
    integer(i4), intent(in) :: pair(2, n)
    real(wp), intent(in) :: record(record_length(solid_frictional), n), r(3, n), rest
    real(wp), intent(in) :: body(body_length(solid_frictional), n_bodies)
    integer(i1), intent(inout) :: status(n)
    real(wp) :: normal(3), u(3), pressing, active
    integer :: k

    do k = 1, n
      status(k) = status_none
      normal = record(normal_x:normal_z, k)
      pressing = normal(1)*r(1, k) + normal(2)*r(2, k) + normal(3)*r(3, k)
      if (.not. pressing > 0) cycle
      associate (c => pair(1, k), a => pair(2, k))
        u(1) = body(velocity_x, c) - body(velocity_x, a) &
               + (body(solid_spin_y, c)*record(solid_arm_cz, k) - body(solid_spin_z, c)*record(solid_arm_cy, k)) &
               - (body(solid_spin_y, a)*record(solid_arm_az, k) - body(solid_spin_z, a)*record(solid_arm_ay, k)) &
               + record(solid_bias_x, k)
        u(2) = body(velocity_y, c) - body(velocity_y, a) &
               + (body(solid_spin_z, c)*record(solid_arm_cx, k) - body(solid_spin_x, c)*record(solid_arm_cz, k)) &
               - (body(solid_spin_z, a)*record(solid_arm_ax, k) - body(solid_spin_x, a)*record(solid_arm_az, k)) &
               + record(solid_bias_y, k)
        u(3) = body(velocity_z, c) - body(velocity_z, a) &
               + (body(solid_spin_x, c)*record(solid_arm_cy, k) - body(solid_spin_y, c)*record(solid_arm_cx, k)) &
               - (body(solid_spin_x, a)*record(solid_arm_ay, k) - body(solid_spin_y, a)*record(solid_arm_ax, k)) &
               + record(solid_bias_z, k)
      end associate
      active = merge(1.0_wp, 0.0_wp, record(solid_law, k) > 0)
      call judge_in_space(normal, u, r(:, k), pressing, record(solid_friction, k), active*record(solid_wnn, k), &
                          active*max(record(solid_s1, k), record(solid_s2, k)), rest, status(k))
    end do
  end subroutine find_solids

  !> Status of a contact in space that is pressed.
  pure subroutine judge_in_space(normal, u, r, pressing, friction, mobility_n, mobility_t, rest, status)
    real(wp), intent(in) :: normal(3), u(3), r(3), pressing, friction, mobility_n, mobility_t, rest
    integer(i1), intent(inout) :: status
    real(wp) :: opening, slip, across

    opening = normal(1)*u(1) + normal(2)*u(2) + normal(3)*u(3)
    slip = sqrt((u(1) - opening*normal(1))**2 + (u(2) - opening*normal(2))**2 + (u(3) - opening*normal(3))**2)
    across = sqrt((r(1) - pressing*normal(1))**2 + (r(2) - pressing*normal(2))**2 + (r(3) - pressing*normal(3))**2)
    call judge(opening, slip, pressing, across, friction, mobility_n, mobility_t, rest, status)
  end subroutine judge_in_space

  !> Status of a contact that is pressed, none before: it stays where the contact opens by more than its impulse could bring about.
  pure subroutine judge(opening, slip, pressing, across, friction, mobility_n, mobility_t, rest, status)
    real(wp), intent(in) :: opening, slip !! relative velocities [m/s]
    real(wp), intent(in) :: pressing, across !! normal and tangential impulse [N s]
    real(wp), intent(in) :: friction, mobility_n, mobility_t !! Coulomb's coefficient, and velocity per impulse [1/kg]
    real(wp), intent(in) :: rest !! velocity that counts as none [m/s]
    integer(i1), intent(inout) :: status
    real(wp) :: reach, slow

    reach = mobility_n*pressing
    slow = rest + least_rest*abs(reach)
    if (opening > reach + slow) return
    status = merge(status_stick, status_slide, slip <= mobility_t*(friction*pressing - across) + slow)
  end subroutine judge

  !> Inverse of a stored inverse, zero where that is none.
  pure real(wp) function inverse(value)
    real(wp), intent(in) :: value

    inverse = 0
    if (value > 0) inverse = 1/value
  end function inverse
end module sg_status_by_gaps
