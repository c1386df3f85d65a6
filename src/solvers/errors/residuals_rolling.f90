!> What the error measures need of contacts with moments: the natural map on the cone that bounds tangential impulse and moments by
!! the normal impulse (doc/theory/errors.md, doc/theory/laws.md).
!!
!! Moments over the length of the record and spins times it have the units of impulses and velocities. Contacts are looked at one by
!! one: only scenes whose laws resist rolling come here.
module sg_residuals_rolling
  use sg_compact, only: compact_velocity, scaled_spin
  use sg_kinds, only: wp
  use sg_law_violation, only: rounding
  use sg_problem, only: friction_of, is_active, problem_t
  use sg_records, only: arm_cohesion, arm_gyration, arm_inverse_norm, arm_law, arm_rolling_length, arm_slip, arm_stiffness_n, &
                        arm_stiffness_t, bears_bonds, bond_shift, is_in_space, least_linear, least_normal, normal_x, normal_z, &
                        solid_cohesion, solid_gyration, solid_inverse_norm, solid_law, solid_rolling_length, solid_slip_x, &
                        solid_slip_z, solid_stiffness_n, solid_stiffness_t, solid_twisting_length
  use sg_residuals_space, only: n_error_sums
  implicit none
  private
  public :: add_rolling_contacts, find_worst_rolling, project_parts

  !> Parts of an impulse that the normal one bounds: tangential force, rolling moment, twisting moment; one column each
  type :: state_t
    !> Normal impulse with cohesion [N s], and opening velocity with bias and compliance [m/s]
    real(wp) :: r_n = 0, u_n = 0
    !> Parts of the impulse [N s] and of the velocity [m/s], shape (3, part), in axes that all parts share
    real(wp) :: r(3, 3) = 0, u(3, 3) = 0
    !> Largest size of each part over the normal impulse
    real(wp) :: bound(3) = 0
    !> Scale of velocities [kg]; zero where the contact takes no part
    real(wp) :: rho = 0
    !> Is u = 0 asked without any inequality? Does a bond hold?
    logical :: is_linear = .false., is_bonded = .false.
    !> Square of the impulse of the bond, which is taken out of the others [N2 s2]
    real(wp) :: bond = 0
  end type state_t

contains

  !> Add all contacts to the sums of the errors.
  pure subroutine add_rolling_contacts(problem, with_e1, sums, squares, closing)
    type(problem_t), intent(in) :: problem !! problem with impulses and the velocities that they cause
    logical, intent(in) :: with_e1 !! is the map with rho = 1 wanted too?
    real(wp), intent(inout) :: sums(n_error_sums) !! sums to add to, as in `sum_errors`
    real(wp), allocatable, intent(inout), optional :: squares(:) !! squares of the map with rho_a, shape (contacts)
    real(wp), allocatable, intent(inout), optional :: closing(:) !! what determines the active set (sg_active_set), shape (contacts)
    type(state_t) :: state
    real(wp) :: square
    logical :: carries
    integer :: k

    do k = 1, problem%n_contacts
      state = state_of(problem, k)
      carries = max(abs(state%r_n), maxval(abs(state%r))) > 0
      if (with_e1) sums(1) = sums(1) + map_square(state, merge(1.0_wp, 0.0_wp, state%rho > 0))
      square = map_square(state, state%rho)
      sums(2) = sums(2) + square
      if (state%rho > 0) sums(3) = sums(3) + square/state%rho**2
      sums(4) = sums(4) + state%r_n**2 + sum(state%r**2) + state%bond
      sums(5) = sums(5) + state%u_n**2 + sum(state%u**2)
      if (carries) sums(6) = sums(6) + 1
      if (present(squares)) squares(k) = square
      if (.not. present(closing)) cycle
      closing(k) = merge(merge(-huge(1.0_wp), state%u_n, carries .or. state%is_linear), huge(1.0_wp), state%rho > 0)
      if (bears_bonds(problem%kind) .and. (state%is_bonded .or. carries)) closing(k) = -huge(1.0_wp)
    end do
  end subroutine add_rolling_contacts

  !> The contact that breaks its law by the largest velocity, each part with a map of its own.
  pure subroutine find_worst_rolling(problem, contact, speed)
    type(problem_t), intent(in) :: problem !! problem with impulses and the velocities that they cause
    integer, intent(inout) :: contact !! number of that contact; stays where all obey
    real(wp), intent(inout) :: speed !! its velocity [m/s]
    type(state_t) :: state
    real(wp) :: broken, across(3, 3)
    integer :: k, part

    do k = 1, problem%n_contacts
      state = state_of(problem, k)
      if (.not. state%rho > 0) cycle
      if (state%is_linear) then
        broken = hypot(state%u_n, norm2(state%u))
      else
        do part = 1, 3
          across(:, part) = state%r(:, part) - cut(state%r(:, part) - state%rho*state%u(:, part), &
                                                   state%bound(part)*max(0.0_wp, state%r_n))
        end do
        broken = hypot(min(state%u_n, state%r_n/state%rho), norm2(across)/state%rho)
        broken = broken - rounding*hypot(state%r_n, norm2(state%r))/state%rho
      end if
      if (.not. broken > speed) cycle
      contact = k
      speed = broken
    end do
  end subroutine find_worst_rolling

  !> Square of the natural map r - P_K(r - rho (u + g)), g adding to the opening velocity what each part slips times its bound.
  pure real(wp) function map_square(state, rho) result(square)
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: rho
    real(wp) :: normal, parts(3, 3)

    if (state%is_linear) then
      square = rho**2*(state%u_n**2 + sum(state%u**2))
      return
    end if
    normal = state%r_n - rho*(state%u_n + dot_product(state%bound, norm2(state%u, 1)))
    parts = state%r - rho*state%u
    call project_parts(state%bound, normal, parts)
    square = (state%r_n - normal)**2 + sum((state%r - parts)**2)
  end function map_square

  !> Nearest point of the cone |part_i| <= bound_i normal, normal >= 0.
  !!
  !! Its height h is the root of h - normal = sum of bound_i (|part_i| - bound_i h) over parts that are too large; both sides are
  !! straight between the heights at which a part fits, and Newton's method from below takes one round for each of them.
  pure subroutine project_parts(bound, normal, parts)
    real(wp), intent(in) :: bound(3) !! largest size of each part over the height
    real(wp), intent(inout) :: normal !! height of the point, then of the nearest one
    real(wp), intent(inout) :: parts(3, 3) !! its parts, one column each
    real(wp) :: length(3), height
    logical :: is_large(3)
    integer :: round, part

    length = norm2(parts, 1)
    height = normal
    do round = 1, 4
      is_large = length > bound*height
      height = (normal + sum(bound*length, is_large))/(1 + sum(bound**2, is_large))
    end do
    normal = max(0.0_wp, height)
    do part = 1, 3
      parts(:, part) = cut(parts(:, part), bound(part)*normal)
    end do
  end subroutine project_parts

  !> A part cut to its largest size.
  pure function cut(part, largest) result(short)
    real(wp), intent(in) :: part(3), largest
    real(wp) :: short(3), length

    short = part
    length = norm2(part)
    if (length > largest) short = part*(largest/length)
  end function cut

  !> Impulse and velocity of a contact by parts.
  pure function state_of(problem, k) result(state)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    type(state_t) :: state

    if (is_in_space(problem%kind)) then
      call take_space_parts(problem, k, state)
      if (bears_bonds(problem%kind)) call take_out_space_bond(problem, k, state)
    else
      call take_plane_parts(problem, k, state)
      if (bears_bonds(problem%kind)) call take_out_plane_bond(problem, k, state)
    end if
    state%bound(1) = friction_of(problem, k)
  end function state_of

  !> Those of a contact of the plane; each part has one component.
  pure subroutine take_plane_parts(problem, k, state)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    type(state_t), intent(inout) :: state
    real(wp) :: u(3), spin(3)

    u = compact_velocity(problem, k)
    spin = scaled_spin(problem, k)
    associate (record => problem%record(:, k), r => problem%impulse(:, k))
      state%rho = record(arm_inverse_norm)
      state%is_linear = record(arm_law) > least_linear
      state%r_n = r(1)
      if (is_active(problem, k)) state%r_n = r(1) + record(arm_cohesion)
      state%u_n = u(1)
      state%r(1, 1) = r(2)
      state%u(1, 1) = u(2)
      if (record(arm_law) > least_normal) state%u(1, 1) = r(2)/state%rho
      if (.not. record(arm_gyration) > 0) return
      state%r(1, 2) = r(3)/record(arm_gyration)
      state%u(1, 2) = spin(3)
      state%bound(2) = record(arm_rolling_length)/record(arm_gyration)
    end associate
  end subroutine take_plane_parts

  !> Take the impulse of a cohesive zone of the plane out of that of its contact. Bodies that nothing moves may come closer: their
  !! bond does not push, and what it carries is no measure of the others.
  pure subroutine take_out_plane_bond(problem, k, state)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    type(state_t), intent(inout) :: state
    real(wp) :: bond(2), u_n

    associate (record => problem%record(1 + bond_shift(problem%kind):, k))
      state%is_bonded = max(record(arm_stiffness_n), record(arm_stiffness_t)) > 0
      if (.not. state%is_bonded) return
      u_n = merge(state%u_n, max(0.0_wp, state%u_n), state%rho > 0)
      bond = [record(arm_stiffness_n)*u_n, record(arm_stiffness_t)*(state%u(1, 1) + record(arm_slip))]
    end associate
    state%r_n = state%r_n + bond(1)
    state%r(1, 1) = state%r(1, 1) + bond(2)
    if (state%rho > 0) state%bond = sum(bond**2)
  end subroutine take_out_plane_bond

  !> The same in space.
  pure subroutine take_out_space_bond(problem, k, state)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    type(state_t), intent(inout) :: state
    real(wp) :: along, across(3), u_n

    associate (record => problem%record(1 + bond_shift(problem%kind):, k))
      state%is_bonded = max(record(solid_stiffness_n), record(solid_stiffness_t)) > 0
      if (.not. state%is_bonded) return
      u_n = merge(state%u_n, max(0.0_wp, state%u_n), state%rho > 0)
      along = record(solid_stiffness_n)*u_n
      across = record(solid_stiffness_t)*(state%u(:, 1) + record(solid_slip_x:solid_slip_z))
    end associate
    state%r_n = state%r_n + along
    state%r(:, 1) = state%r(:, 1) + across
    if (state%rho > 0) state%bond = along**2 + sum(across**2)
  end subroutine take_out_space_bond

  !> Those of a contact in space, in the world's axes.
  pure subroutine take_space_parts(problem, k, state)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    type(state_t), intent(inout) :: state
    real(wp) :: u(3), spin(3), moment(3)

    u = compact_velocity(problem, k)
    associate (record => problem%record(:, k), n => problem%record(normal_x:normal_z, k), r => problem%impulse(:, k))
      state%rho = record(solid_inverse_norm)
      state%is_linear = record(solid_law) > least_linear
      state%u_n = dot_product(n, u)
      state%u(:, 1) = u - state%u_n*n
      state%r_n = dot_product(n, r(:3))
      state%r(:, 1) = r(:3) - state%r_n*n
      if (record(solid_law) > least_normal) state%u(:, 1) = state%r(:, 1)/state%rho
      if (is_active(problem, k)) state%r_n = state%r_n + record(solid_cohesion)
      if (.not. record(solid_gyration) > 0) return
      spin = scaled_spin(problem, k)
      moment = r(4:)/record(solid_gyration)
      state%u(:, 3) = dot_product(n, spin)*n
      state%u(:, 2) = spin - state%u(:, 3)
      state%r(:, 3) = dot_product(n, moment)*n
      state%r(:, 2) = moment - state%r(:, 3)
      state%bound(2:) = record(solid_rolling_length:solid_twisting_length)/record(solid_gyration)
    end associate
  end subroutine take_space_parts
end module sg_residuals_rolling
