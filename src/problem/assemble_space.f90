!> Records of contacts in space (doc/theory/contact_problem.md).
module sg_assemble_space
  use sg_cohesive_zones, only: slip_across
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp
  use sg_laws, only: kind_of_local_law, local_law_t
  use sg_mapping_space, only: space_arms, space_relative_velocity, tangent_of
  use sg_records, only: ball_bias_x, ball_bias_z, ball_friction, ball_frictional, ball_frictionless, ball_frictionless_bias, &
                        ball_frictionless_inverse_wnn, ball_inverse_wnn, ball_inverse_wtt, bears_bonds, bond_shift, has_moments, &
                        normal_x, normal_z, plain_kind, solid_arm_ax, solid_arm_az, solid_arm_cx, solid_arm_cz, solid_bias_x, &
                        solid_bias_z, solid_cohesion, solid_compliance_n, solid_compliance_t, solid_friction, solid_frictional, &
                        solid_frictionless, solid_frictionless_bias, solid_frictionless_inverse_wnn, &
                        solid_frictionless_moment_ax, solid_frictionless_moment_az, solid_frictionless_moment_cx, &
                        solid_frictionless_moment_cz, solid_inverse_lambda, solid_law, solid_rolling_length, solid_s2, &
                        solid_slip_x, solid_slip_z, solid_stiffness_n, solid_stiffness_t, solid_tangent_x, solid_tangent_z, &
                        solid_twisting_length, solid_wnn
  use sg_rotations, only: turned_by
  use sg_scene, only: scene_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: space_record, velocity_before

contains

  !> Relative velocity at the beginning of a step [m/s]: normal, and on the tangents that `tangent_of` gives.
  pure function velocity_before(scene, contacts, k) result(u)
    type(scene_t), intent(in) :: scene !! scene at the beginning of the step
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp) :: u(3), jump(3), n(3), t(3)

    jump = space_relative_velocity(scene, contacts, k, scene%bodies%velocity)
    n = contacts%normal(:, k)
    t = tangent_of(n)
    u = [dot_product(n, jump), dot_product(t, jump), dot_product(cross(n, t), jump)]
  end function velocity_before

  !> Record of a contact without its block, in whose place stands whether the contact takes part.
  pure subroutine space_record(scene, contacts, k, kind, law, record)
    type(scene_t), intent(in) :: scene !! scene, its `middle` configuration set
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    integer, intent(in) :: kind !! kind of problem
    type(local_law_t), intent(in) :: law !! what the law asks
    real(wp), intent(inout) :: record(:) !! record to fill, except its block
    real(wp) :: n(3), t(3), bias(3), arms(3, 2), active

    n = contacts%normal(:, k)
    active = merge(1.0_wp, 0.0_wp, law%is_active)
    bias = law%bias(1)*n
    t = 0
    if (plain_kind(kind) == solid_frictional .or. any(abs(law%bias(2:)) > 0)) then
      t = tangent_of(n)
      bias = bias + law%bias(2)*t + law%bias(3)*cross(n, t)
    end if
    ! Part by part: an array constructor would be made aside and copied.
    record(normal_x:normal_z) = n
    select case (plain_kind(kind))
    case (ball_frictionless)
      record(ball_frictionless_bias) = law%bias(1) + dot_product(n, driven_spin(scene, contacts, k))
      record(ball_frictionless_inverse_wnn) = active
    case (ball_frictional)
      record(ball_bias_x:ball_bias_z) = bias + driven_spin(scene, contacts, k)
      record(ball_inverse_wnn:ball_inverse_wtt) = active
      record(ball_friction) = law%friction
    case (solid_frictionless)
      arms = space_arms(scene, contacts, k)
      record(solid_frictionless_moment_cx:solid_frictionless_moment_cz) = cross(arms(:, 1), n)
      record(solid_frictionless_moment_ax:solid_frictionless_moment_az) = cross(arms(:, 2), n)
      record(solid_frictionless_bias) = law%bias(1)
      record(solid_frictionless_inverse_wnn) = active
    case (solid_frictional)
      if (law%is_along_normal) t = 0
      arms = space_arms(scene, contacts, k)
      record(solid_tangent_x:solid_tangent_z) = t
      record(solid_arm_cx:solid_arm_cz) = arms(:, 1)
      record(solid_arm_ax:solid_arm_az) = arms(:, 2)
      record(solid_bias_x:solid_bias_z) = bias
      record(solid_wnn:solid_s2) = 0
      record(solid_friction) = law%friction
      record(solid_cohesion) = law%cohesion
      record(solid_compliance_n:solid_compliance_t) = law%compliance
      record(solid_law) = kind_of_local_law(law)
      record(solid_inverse_lambda) = 0
      if (has_moments(kind)) record(solid_rolling_length:solid_twisting_length) = law%moment_arm
      if (.not. bears_bonds(kind)) return
      associate (bond => record(1 + bond_shift(kind):))
        bond(solid_stiffness_n:solid_stiffness_t) = law%stiffness
        bond(solid_slip_x:solid_slip_z) = slip_across(law%slip, n)
      end associate
    end select
  end subroutine space_record

  !> Relative velocity due to driven spins, which the records of balls do not carry [m/s].
  pure function driven_spin(scene, contacts, k) result(u)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp) :: u(3), arms(3, 2)
    integer :: side, b

    u = 0
    if (scene%bodies%n_velocity < 6) return
    do side = 1, 2
      b = contacts%body(side, k)
      if (scene%bodies%inverse_mass(4, b) > 0) cycle
      if (.not. any(abs(scene%bodies%free_velocity(4:6, b)) > 0)) cycle
      arms = space_arms(scene, contacts, k)
      u = u + real(3 - 2*side, wp)*cross(turned_by(scene%bodies%middle(4:7, b), scene%bodies%free_velocity(4:6, b)), &
                                         arms(:, side))
    end do
  end function driven_spin
end module sg_assemble_space
