!> The compact records of contacts and bodies taken apart, for any kind of problem: for callers that need H and M themselves.
module sg_problem_records
  use sg_kinds, only: wp
  use sg_mapping_space, only: tangent_of
  use sg_problem, only: friction_of, is_active, problem_t
  use sg_records, only: arm_bias_n, arm_bias_t, arm_cohesion, arm_compliance_n, arm_compliance_t, arm_frictional, &
                        arm_frictionless, arm_frictionless_bias, arm_frictionless_moment_a, arm_frictionless_moment_c, arm_law, &
                        arm_moment_na, arm_moment_nc, arm_moment_ta, arm_moment_tc, arm_rolling_length, arm_stiffness_n, &
                        arm_stiffness_t, ball_bias_x, ball_bias_z, ball_frictional, ball_frictionless, ball_frictionless_bias, &
                        bears_bonds, bond_shift, first_inverse, force_length, free_axes, has_moments, is_in_space, least_linear, &
                        least_normal, normal_x, normal_y, normal_z, plain_kind, round_bias_n, round_bias_t, round_frictional, &
                        round_frictionless, round_frictionless_bias, solid_arm_ax, solid_arm_az, solid_arm_cx, solid_arm_cz, &
                        solid_bias_x, solid_bias_z, solid_cohesion, solid_compliance_n, solid_compliance_t, solid_frictional, &
                        solid_frictionless, solid_frictionless_bias, solid_frictionless_moment_ax, solid_frictionless_moment_az, &
                        solid_frictionless_moment_cx, solid_frictionless_moment_cz, solid_law, solid_rolling_length, &
                        solid_stiffness_n, solid_stiffness_t, solid_tangent_x, solid_tangent_z, solid_twisting_length
  use sg_symmetric, only: principal_axes
  use sg_vectors, only: cross
  implicit none
  private
  public :: contact_record_t, body_record_t, contact_of, body_of

  !> A contact. Directions are the normal and the tangents; components those of velocities of bodies in the world's axes
  type :: contact_record_t
    !> Can it carry an impulse, is it linear, has it a tangent?
    logical :: is_active = .false., is_linear = .false., has_tangent = .true.
    !> Does a cohesive zone act beside the impulse, or a moment that resists rolling?
    logical :: is_bonded = .false., has_moment = .false.
    !> Relative velocity that a unit of a body's velocity makes, shape (direction, component, body)
    real(wp) :: h(3, 6, 2) = 0
    !> Bias [m/s], impulse [N s] and compliance [1/kg], by direction
    real(wp) :: bias(3) = 0, impulse(3) = 0, compliance(3) = 0
    !> Coulomb friction, and cohesion [N s]
    real(wp) :: friction = 0, cohesion = 0
  end type contact_record_t

  !> A body, with components in which its mass is diagonal
  type :: body_record_t
    !> Number of velocity components
    integer :: n = 0
    !> Velocity [m/s, rad/s] and inverse mass [1/kg, 1/(kg m^2)] by component; inverse masses of driven ones are zero
    real(wp) :: velocity(6) = 0, inverse_mass(6) = 0
    !> In space the columns are the axes of the spins; the unit matrix where the inverse inertia is a number
    real(wp) :: axes(3, 3) = 0
  end type body_record_t

  !> Inverse inertia that rounding leaves about a driven axis, over the largest
  real(wp), parameter :: driven_below = 1e-12_wp

contains

  !> A contact from its record.
  pure function contact_of(problem, k) result(contact)
    type(problem_t), intent(in) :: problem !! problem of a step
    integer, intent(in) :: k !! contact
    type(contact_record_t) :: contact

    if (is_in_space(problem%kind)) then
      contact = space_contact(problem%kind, problem%record(:, k), problem%impulse(:, k))
    else
      contact = plane_contact(problem%kind, problem%record(:, k), problem%impulse(:, k))
    end if
    contact%is_active = is_active(problem, k)
    contact%friction = friction_of(problem, k)
  end function contact_of

  !> A contact in the plane, without what `contact_of` adds: directions n and (n_y, -n_x).
  pure function plane_contact(kind, record, impulse) result(contact)
    integer, intent(in) :: kind
    real(wp), intent(in) :: record(:), impulse(:)
    type(contact_record_t) :: contact

    associate (h => contact%h)
      h(1:2, 1:2, 1) = reshape([record(normal_x), record(normal_y), record(normal_y), -record(normal_x)], [2, 2])
      h(1:2, 1:2, 2) = -h(1:2, 1:2, 1)
      contact%impulse(:force_length(kind)) = impulse(:force_length(kind))
      select case (plain_kind(kind))
      case (round_frictionless)
        contact%bias(1) = record(round_frictionless_bias)
        contact%has_tangent = .false.
      case (round_frictional)
        h(2, 3, :) = 1
        contact%bias(1:2) = record(round_bias_n:round_bias_t)
      case (arm_frictionless)
        h(1, 3, :) = [record(arm_frictionless_moment_c), -record(arm_frictionless_moment_a)]
        contact%bias(1) = record(arm_frictionless_bias)
        contact%has_tangent = .false.
      case (arm_frictional)
        h(1:2, 3, 1) = record(arm_moment_nc:arm_moment_tc)
        h(1:2, 3, 2) = -record(arm_moment_na:arm_moment_ta)
        contact%bias(1:2) = record(arm_bias_n:arm_bias_t)
        contact%cohesion = record(arm_cohesion)
        contact%compliance(1:2) = record(arm_compliance_n:arm_compliance_t)
        contact%is_linear = record(arm_law) > least_linear
        contact%has_tangent = record(arm_law) < least_normal
        if (has_moments(kind)) contact%has_moment = record(arm_rolling_length) > 0
        if (bears_bonds(kind)) &
          contact%is_bonded = any(record([arm_stiffness_n, arm_stiffness_t] + bond_shift(kind)) > 0)
      end select
    end associate
  end function plane_contact

  !> A contact in space: directions n, t and n x t, while records hold vectors in the world's axes.
  pure function space_contact(kind, record, impulse) result(contact)
    integer, intent(in) :: kind
    real(wp), intent(in) :: record(:), impulse(:)
    type(contact_record_t) :: contact
    real(wp) :: frame(3, 3)
    integer :: i

    frame(:, 1) = record(normal_x:normal_z)
    if (plain_kind(kind) == solid_frictional) then
      frame(:, 2) = record(solid_tangent_x:solid_tangent_z)
    else
      frame(:, 2) = tangent_of(record(normal_x:normal_z))
    end if
    frame(:, 3) = cross(frame(:, 1), frame(:, 2))
    contact%h(:, 1:3, 1) = transpose(frame)
    contact%h(:, 1:3, 2) = -transpose(frame)
    contact%impulse(1) = impulse(1)
    if (force_length(kind) == 3) contact%impulse = matmul(impulse(:3), frame)
    select case (plain_kind(kind))
    case (ball_frictionless)
      contact%bias(1) = record(ball_frictionless_bias)
      contact%has_tangent = .false.
    case (ball_frictional)
      do i = 2, 3
        contact%h(i, 4:6, 1) = cross(frame(:, i), frame(:, 1))
        contact%h(i, 4:6, 2) = contact%h(i, 4:6, 1)
      end do
      contact%bias = matmul(record(ball_bias_x:ball_bias_z), frame)
    case (solid_frictionless)
      contact%h(1, 4:6, 1) = record(solid_frictionless_moment_cx:solid_frictionless_moment_cz)
      contact%h(1, 4:6, 2) = -record(solid_frictionless_moment_ax:solid_frictionless_moment_az)
      contact%bias(1) = record(solid_frictionless_bias)
      contact%has_tangent = .false.
    case (solid_frictional)
      do i = 1, 3
        contact%h(i, 4:6, 1) = cross(record(solid_arm_cx:solid_arm_cz), frame(:, i))
        contact%h(i, 4:6, 2) = -cross(record(solid_arm_ax:solid_arm_az), frame(:, i))
      end do
      contact%bias = matmul(record(solid_bias_x:solid_bias_z), frame)
      contact%cohesion = record(solid_cohesion)
      contact%compliance = record([solid_compliance_n, solid_compliance_t, solid_compliance_t])
      contact%is_linear = record(solid_law) > least_linear
      contact%has_tangent = record(solid_law) < least_normal
      if (has_moments(kind)) contact%has_moment = any(record(solid_rolling_length:solid_twisting_length) > 0)
      if (bears_bonds(kind)) &
        contact%is_bonded = any(record([solid_stiffness_n, solid_stiffness_t] + bond_shift(kind)) > 0)
    end select
  end function space_contact

  !> A body from its record.
  pure function body_of(problem, slot) result(body)
    type(problem_t), intent(in) :: problem !! problem of a step
    integer, intent(in) :: slot !! slot of the body
    type(body_record_t) :: body
    integer :: i

    body%n = first_inverse(problem%kind) - 1
    do i = 1, 3
      body%axes(i, i) = 1
    end do
    associate (record => problem%body(:, slot), inverse => problem%body(first_inverse(problem%kind):, slot))
      body%velocity(:body%n) = record(:body%n)
      select case (problem%kind)
      case (ball_frictional)
        body%inverse_mass(1:3) = inverse(1)*free_axes(inverse(2))
        body%inverse_mass(4:6) = max(0.0_wp, inverse(2))
      case default
        body%inverse_mass(:min(3, body%n)) = inverse(:min(3, body%n))
      end select
      select case (plain_kind(problem%kind))
      case (solid_frictionless, solid_frictional)
        call principal_axes(reshape(inverse([4, 7, 8, 7, 5, 9, 8, 9, 6]), [3, 3]), body%inverse_mass(4:6), body%axes)
        where (body%inverse_mass(4:6) <= driven_below*maxval(body%inverse_mass(4:6))) body%inverse_mass(4:6) = 0
        body%velocity(4:6) = matmul(body%velocity(4:6), body%axes)
      end select
    end associate
  end function body_of
end module sg_problem_records
