!> Status of a contact after a solve: open, sticking, sliding or bonded (doc/theory/laws.md, static and dynamic friction).
!!
!! A law leaves both sides of a complementarity at zero or not: the slip and the distance of the impulse from Coulomb's cone, the
!! opening and the normal impulse. A solver fulfils either to its error, so that comparing one of them with zero decides by
!! rounding. Each pair is compared in one unit instead, velocities: what the velocity is against what the impulse could still bring
!! about. Below the velocity error of the solution a contact is at rest.
module sg_contact_status
  use sg_compact, only: compact_velocity
  use sg_kinds, only: wp, i1
  use sg_laws, only: status_none, status_slide, status_stick
  use sg_problem, only: friction_of, is_active, problem_t
  use sg_records, only: arm_bias_n, arm_cohesion, arm_slip, arm_stiffness_n, arm_stiffness_t, arm_wnn, arm_wnt, arm_wtt, &
                        ball_frictional, ball_inverse_wnn, ball_inverse_wtt, bears_bonds, bond_shift, friction_place, &
                        is_in_space, normal_x, normal_z, round_frictional, round_inverse_wnn, round_inverse_wtt, solid_bias_x, &
                        solid_bias_z, solid_cohesion, solid_s1, solid_s2, solid_slip_x, solid_slip_z, solid_stiffness_n, &
                        solid_stiffness_t, solid_wnn, velocity_y, velocity_z
  implicit none
  private
  public :: status_of, rest_speed, least_rest

  !> Share of the velocity scale that counts as rest: at least, so that rounding sums up over 10^7 steps of rest before it counts,
  !! and at most, however far a solution is from convergence
  real(wp), parameter :: least_rest = 1e-9_wp, largest_rest = 1e-3_wp

  !> What the status of a contact follows from
  type :: state_t
    !> Normal impulse with cohesion [N s], size of the tangential one [N s], opening velocity with bias and slip [m/s]
    real(wp) :: normal = 0, tangential = 0, opening = 0, slip = 0
    !> Coulomb friction
    real(wp) :: friction = 0
    !> Velocity per impulse, normal and, with the normal one free to follow, tangential [1/kg]; zero where nothing can move
    real(wp) :: mobility(2) = 0
  end type state_t

contains

  !> Relative velocity below which a solution cannot distinguish motion from rest [m/s].
  pure real(wp) function rest_speed(problem, violation)
    type(problem_t), intent(in) :: problem !! solved problem
    real(wp), intent(in) :: violation !! velocity error of the solution over the velocity scale of the problem
    integer :: n

    n = merge(velocity_z, velocity_y, is_in_space(problem%kind))
    rest_speed = max(least_rest, min(violation, largest_rest))*problem%velocity_scale
    if (problem%n_bodies > 0) rest_speed = rest_speed + 16*epsilon(1.0_wp)*maxval(abs(problem%body(:n, :)))
  end function rest_speed

  !> What a contact did in a step: nothing, stick or slide. Problems without tangents have no sticking contacts.
  !!
  !! A bond whose impulse stands at the limit of its cohesion sticks as long as its bodies do not part: where several bonds hold
  !! a body, rigid as it is, one of them may stand there because of the load or because of a gap that it cannot close.
  pure integer(i1) function status_of(problem, k, is_bonded, stretch, rest) result(status)
    type(problem_t), intent(in) :: problem !! solved problem
    integer, intent(in) :: k !! contact
    logical, intent(in) :: is_bonded !! does a bond hold the contact together?
    real(wp), intent(in) :: stretch !! opening velocity by which a bond is not yet broken [m/s]; not used where there is none
    real(wp), intent(in) :: rest !! velocity that counts as none [m/s]
    type(state_t) :: state
    real(wp) :: reach(2), slow

    status = status_none
    if (friction_place(problem%kind) == 0) then
      if (problem%impulse(1, k) > 0) status = status_slide
      return
    else if (is_in_space(problem%kind)) then
      state = spatial_state(problem, k, is_bonded)
    else
      state = planar_state(problem, k, is_bonded)
    end if
    if (.not. (state%normal > 0 .or. is_bonded)) return
    ! What the impulse could bring about.
    reach = state%mobility*[state%normal, state%friction*state%normal - state%tangential]
    slow = rest + least_rest*abs(reach(1))
    if (state%opening > reach(1) + max(slow, merge(stretch, 0.0_wp, is_bonded))) return
    status = status_slide
    if (state%slip <= reach(2) + slow) status = status_stick
  end function status_of

  !> State of a contact of the plane.
  pure type(state_t) function planar_state(problem, k, is_bonded) result(state)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    logical, intent(in) :: is_bonded
    real(wp) :: u(3)

    associate (record => problem%record(:, k))
      state%normal = problem%impulse(1, k)
      if (problem%kind /= round_frictional) state%normal = state%normal + record(arm_cohesion)
      if (.not. (state%normal > 0 .or. is_bonded .or. bears_bonds(problem%kind))) return
      u = compact_velocity(problem, k)
      state%opening = u(1)
      if (is_bonded) state%opening = u(1) - record(arm_bias_n)
      state%slip = abs(u(2))
      state%tangential = abs(problem%impulse(2, k))
      if (bears_bonds(problem%kind)) then
        ! Without what a bond adds.
        associate (bond => problem%record(1 + bond_shift(problem%kind):, k))
          state%normal = state%normal + bond(arm_stiffness_n)*u(1)
          state%tangential = abs(problem%impulse(2, k) + bond(arm_stiffness_t)*(u(2) + bond(arm_slip)))
        end associate
      end if
      state%friction = friction_of(problem, k)
      if (problem%kind == round_frictional) then
        state%mobility = [inverse(record(round_inverse_wnn)), inverse(record(round_inverse_wtt))]
      else
        state%mobility = [record(arm_wnn), max(0.0_wp, record(arm_wtt) - record(arm_wnt)**2*inverse(record(arm_wnn)))]
      end if
    end associate
  end function planar_state

  !> State of a contact in space.
  pure type(state_t) function spatial_state(problem, k, is_bonded) result(state)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    logical, intent(in) :: is_bonded
    real(wp) :: u(3), r_n

    associate (record => problem%record(:, k), n => problem%record(normal_x:normal_z, k), r => problem%impulse(:3, k))
      r_n = dot_product(n, r)
      state%normal = r_n
      if (problem%kind /= ball_frictional) state%normal = r_n + record(solid_cohesion)
      if (.not. (state%normal > 0 .or. is_bonded .or. bears_bonds(problem%kind))) return
      u = compact_velocity(problem, k)
      state%opening = dot_product(n, u)
      state%slip = norm2(u - state%opening*n)
      if (is_bonded) state%opening = state%opening - dot_product(n, record(solid_bias_x:solid_bias_z))
      state%tangential = norm2(r - r_n*n)
      if (bears_bonds(problem%kind)) then
        ! Without what a bond adds.
        associate (bond => problem%record(1 + bond_shift(problem%kind):, k))
          state%normal = state%normal + bond(solid_stiffness_n)*state%opening
          state%tangential = norm2(r - r_n*n + bond(solid_stiffness_t)*(u - state%opening*n + bond(solid_slip_x:solid_slip_z)))
        end associate
      end if
      state%friction = friction_of(problem, k)
      if (problem%kind == ball_frictional) then
        state%mobility = [inverse(record(ball_inverse_wnn)), inverse(record(ball_inverse_wtt))]
      else if (is_active(problem, k)) then
        state%mobility = [record(solid_wnn), maxval(record(solid_s1:solid_s2))]
      end if
    end associate
  end function spatial_state

  !> Inverse of a stored inverse, zero where that is none.
  pure real(wp) function inverse(value)
    real(wp), intent(in) :: value

    inverse = 0
    if (value > 0) inverse = 1/value
  end function inverse
end module sg_contact_status
