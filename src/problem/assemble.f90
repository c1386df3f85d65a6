!> From contacts to a contact problem: local frames, lever arms, Delassus blocks, biases, the guess; and back.
module sg_assemble
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_assemble_by_gaps, only: assemble_by_gaps
  use sg_assemble_space, only: space_record
  use sg_compact, only: compact_velocity, scaled_spin
  use sg_contact_laws, only: law_of_contact
  use sg_contact_status, only: rest_speed, status_of
  use sg_contacts, only: contacts_t
  use sg_delassus, only: set_block
  use sg_gap_laws, only: have_gap_laws
  use sg_internal_values, only: bond_integrity
  use sg_kinds, only: wp, i1
  use sg_laws, only: is_cohesive_zone, kind_of_local_law, law_mohr, local_law_t, status_bonded, status_slide, status_stick
  use sg_link_contacts, only: is_link
  use sg_mapping, only: arms_of
  use sg_neighbour_list, only: neighbours_t
  use sg_plan, only: plan_t
  use sg_problem, only: problem_t, reserve_problem
  use sg_problem_bodies, only: load_bodies, take_velocities
  use sg_records, only: arm_bias_t, arm_cohesion, arm_compliance_n, arm_compliance_t, arm_friction, arm_frictionless, &
                        arm_frictionless_bias, arm_frictionless_inverse_wnn, arm_frictionless_moment_a, &
                        arm_frictionless_moment_c, arm_gyration, arm_law, arm_rolling_length, arm_slip, arm_stiffness_n, arm_wnn, &
                        arm_wtt, ball_frictional, bears_bonds, bond_shift, force_length, has_moments, is_compact, is_in_space, &
                        normal_x, normal_y, normal_z, plain_kind, round_bias_n, round_bias_t, round_friction, round_frictionless, &
                        round_frictionless_bias, round_frictionless_inverse_wnn, round_inverse_wnn, round_inverse_wtt, &
                        solid_frictional, solid_gyration, solid_wnn
  use sg_scene, only: largest_gravity, scene_t
  use sg_status_by_gaps, only: find_statuses
  implicit none
  private
  public :: assemble, disassemble, begin_problem, put_contact

  !> Velocity that counts as rest of a contact held by cohesion, over the velocity that the cohesion gives its bodies
  real(wp), parameter :: held_share = 1e-8_wp

  !> Gap at which a bond is broken, as a share of the smaller shape: rigid bodies share a load among several bonds only to rounding
  real(wp), parameter :: largest_stretch = 1e-8_wp

contains

  !> Make the contact problem of a step; `bodies%velocity` is the beginning's, `bodies%free_velocity` the free one.
  subroutine assemble(scene, plan, pairs, contacts, time_step, problem)
    type(scene_t), intent(in) :: scene !! scene, its `middle` configuration set
    type(plan_t), intent(in) :: plan !! kind of problem, and radii of round bodies
    type(neighbours_t), intent(in) :: pairs !! bodies of slots, and slots of bodies
    type(contacts_t), intent(in) :: contacts !! contacts with the guess of their impulses
    real(wp), intent(in) :: time_step !! time step [s]
    type(problem_t), intent(inout) :: problem !! the problem made

    call begin_problem(scene, plan, pairs, contacts%n, problem)
    if (have_gap_laws(scene, plan, problem%drives_spin)) then
      call assemble_by_gaps(scene, pairs%slot_of, contacts, time_step, .false., problem)
    else
      call assemble_by_laws(scene, pairs, contacts, time_step, problem)
    end if
    problem%fall_speed = largest_gravity(scene)*time_step
    problem%velocity_scale = problem%fall_speed
    if (.not. problem%velocity_scale > 0) problem%velocity_scale = problem%free_norm/sqrt(real(max(1, contacts%n), wp))
  end subroutine assemble

  !> Fill a begun problem, contact by contact as its law asks.
  subroutine assemble_by_laws(scene, pairs, contacts, time_step, problem)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in) :: time_step
    type(problem_t), intent(inout) :: problem
    real(wp) :: q(3), squares, held
    type(local_law_t) :: law
    integer :: k

    squares = 0
    problem%closing_speed = 0
    held = 0
    problem%most_friction = 0
    associate (kind => problem%kind)
      do k = 1, contacts%n
        call law_of_contact(scene, contacts, k, time_step, law)
        call put_contact(scene, pairs, contacts, k, law, problem)
        problem%opening(k) = huge(1.0_wp)
        if (.not. law%is_active) cycle
        q = compact_velocity(problem, k)
        problem%opening(k) = opening_of(kind, law, problem%record(:, k), q)
        squares = squares + sum(q**2)
        if (has_moments(kind)) squares = squares + sum(scaled_spin(problem, k)**2)
        problem%most_friction = max(problem%most_friction, largest_bound(kind, law, problem%record(:, k)))
        if (problem%opening(k) < 0) problem%closing_speed = max(problem%closing_speed, norm2(q))
        held = max(held, held_speed(kind, law, problem%record(:, k)))
        problem%impulse(:force_length(kind), k) = contacts%impulse(:, k)
        if (any(law%moment_arm > 0)) problem%impulse(force_length(kind) + 1:, k) = &
          contacts%internal(contacts%n_internal - contacts%n_moments + 1:, k)
        ! The normal may have turned since the guess was found; that of links is turned at detection.
        if (law%is_along_normal .and. plain_kind(kind) == solid_frictional .and. .not. is_link(scene, contacts, k)) &
          problem%impulse(:3, k) = dot_product(contacts%normal(:, k), contacts%impulse(:, k))*contacts%normal(:, k)
      end do
    end associate
    problem%free_norm = sqrt(squares)
    ! Without gravity, bodies that cohesion holds and nothing moves have no velocity but what the tolerance leaves.
    if (.not. largest_gravity(scene)*time_step > 0) problem%closing_speed = max(problem%closing_speed, held_share*held)
  end subroutine assemble_by_laws

  !> Make room for a problem, with the free velocities and inverse masses of its bodies.
  subroutine begin_problem(scene, plan, pairs, n_contacts, problem)
    type(scene_t), intent(in) :: scene !! scene, its `middle` configuration set
    type(plan_t), intent(in) :: plan !! kind of problem, and radii of round bodies
    type(neighbours_t), intent(in) :: pairs !! bodies of slots
    integer, intent(in) :: n_contacts !! contacts that follow by `put_contact`
    type(problem_t), intent(inout) :: problem !! the problem begun

    call reserve_problem(problem, plan%kind, scene%bodies%n, n_contacts)
    problem%is_continued = .false.
    call load_bodies(scene%bodies, plan%kind, pairs%body_of, plan%radius, problem%body, problem%moves, problem%fastest, &
                     problem%drives_spin)
  end subroutine begin_problem

  !> Put a contact into a problem, without a guess of its impulse.
  subroutine put_contact(scene, pairs, contacts, k, law, problem)
    type(scene_t), intent(in) :: scene !! scene, its `middle` configuration set
    type(neighbours_t), intent(in) :: pairs !! slots of bodies
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    type(local_law_t), intent(in) :: law !! what its law asks
    type(problem_t), intent(inout) :: problem !! begun

    problem%pair(:, k) = pairs%slot_of(contacts%body(:, k))
    if (is_in_space(problem%kind)) then
      call space_record(scene, contacts, k, problem%kind, law, problem%record(:, k))
    else if (is_compact(problem%kind)) then
      call round_record(scene, contacts, k, problem%kind, law, problem%record(:, k))
    else
      call arm_record(scene, contacts, k, problem%kind, law, problem%record(:, k))
    end if
    call set_block(problem%kind, problem%body(:, problem%pair(1, k)), problem%body(:, problem%pair(2, k)), problem%record(:, k))
    problem%impulse(:, k) = 0
  end subroutine put_contact

  !> Normal relative velocity without impulses; lowest where something may hold a contact that opens.
  pure real(wp) function opening_of(kind, law, record, q) result(opening)
    integer, intent(in) :: kind
    type(local_law_t), intent(in) :: law
    real(wp), intent(in) :: record(:), q(3) !! its record, and relative velocity without impulses [m/s]

    opening = q(1)
    if (kind == ball_frictional .or. plain_kind(kind) == solid_frictional) opening = dot_product(record(normal_x:normal_z), q)
    if (law%is_linear .or. law%cohesion > 0 .or. maxval(law%stiffness) > 0) opening = -huge(1.0_wp)
  end function opening_of

  !> Friction of a contact, and what bounds its moments in the units of impulses, as one number: by so much a slip can hide a normal
  !! velocity in errors.
  pure real(wp) function largest_bound(kind, law, record) result(bound)
    integer, intent(in) :: kind
    type(local_law_t), intent(in) :: law
    real(wp), intent(in) :: record(:)
    real(wp) :: length

    bound = law%friction
    if (.not. has_moments(kind)) return
    length = record(merge(solid_gyration, arm_gyration, is_in_space(kind)))
    if (length > 0) bound = norm2([law%friction, law%moment_arm/length])
  end function largest_bound

  !> Velocity that cohesion gives the bodies of a contact [m/s].
  pure real(wp) function held_speed(kind, law, record) result(speed)
    integer, intent(in) :: kind
    type(local_law_t), intent(in) :: law
    real(wp), intent(in) :: record(:)

    speed = 0
    if (law%cohesion > 0) speed = law%cohesion*record(merge(solid_wnn, arm_wnn, is_in_space(kind)))
  end function held_speed

  !> Record of a contact whose arms lie along the normal, without its block, in whose place stands whether the contact takes
  !! part. A driven spin enters as a bias.
  pure subroutine round_record(scene, contacts, k, kind, law, record)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k, kind
    type(local_law_t), intent(in) :: law
    real(wp), intent(inout) :: record(:)
    real(wp) :: bias(2), active

    bias = law%bias(:2) + driven_spin(scene, contacts, k)
    active = merge(1.0_wp, 0.0_wp, law%is_active)
    record(normal_x:normal_y) = contacts%normal(:, k)
    if (kind == round_frictionless) then
      record(round_frictionless_bias) = bias(1)
      record(round_frictionless_inverse_wnn) = active
    else
      record(round_bias_n:round_bias_t) = bias
      record(round_inverse_wnn:round_inverse_wtt) = active
      record(round_friction) = law%friction
    end if
  end subroutine round_record

  !> Relative velocity due to driven spins, which the records of round bodies do not carry.
  pure function driven_spin(scene, contacts, k) result(u)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp) :: u(2), arms(2, 2), jump(2), n(2)
    integer :: side, b
    logical :: is_driven(2)

    u = 0
    if (scene%bodies%n_velocity < 3) return
    do side = 1, 2
      b = contacts%body(side, k)
      is_driven(side) = .not. scene%bodies%inverse_mass(3, b) > 0 .and. abs(scene%bodies%free_velocity(3, b)) > 0
    end do
    if (.not. any(is_driven)) return
    arms = arms_of(contacts, k, scene%bodies%middle, scene%period)
    jump = 0
    do side = 1, 2
      if (.not. is_driven(side)) cycle
      jump = jump + real(3 - 2*side, wp)*scene%bodies%free_velocity(3, contacts%body(side, k))*[-arms(2, side), arms(1, side)]
    end do
    n = contacts%normal(:, k)
    u = [n(1)*jump(1) + n(2)*jump(2), n(2)*jump(1) - n(1)*jump(2)]
  end function driven_spin

  !> Record of a contact with any lever arms.
  pure subroutine arm_record(scene, contacts, k, kind, law, record)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k, kind
    type(local_law_t), intent(in) :: law
    real(wp), intent(inout) :: record(:)
    real(wp) :: n(2), arms(2, 2), moment_n(2), moment_t(2)

    n = contacts%normal(:, k)
    arms = arms_of(contacts, k, scene%bodies%middle, scene%period)
    moment_n = arms(1, :)*n(2) - arms(2, :)*n(1)
    moment_t = -arms(1, :)*n(1) - arms(2, :)*n(2)
    if (kind == arm_frictionless) then
      record(normal_x:normal_y) = n
      record(arm_frictionless_moment_c:arm_frictionless_moment_a) = moment_n
      record(arm_frictionless_bias) = law%bias(1)
      record(arm_frictionless_inverse_wnn) = merge(1.0_wp, 0.0_wp, law%is_active)
    else
      ! At once: one by one, the compiler rounds other products of the moments, and answers change in the last digit.
      record(normal_x:arm_bias_t) = [n, moment_n(1), moment_t(1), moment_n(2), moment_t(2), law%bias(:2)]
      record(arm_wnn:arm_wtt) = 0
      record(arm_friction) = law%friction
      record(arm_cohesion) = law%cohesion
      record(arm_compliance_n:arm_compliance_t) = law%compliance
      record(arm_law) = kind_of_local_law(law)
      if (bears_bonds(kind)) record(arm_stiffness_n + bond_shift(kind):arm_slip + bond_shift(kind)) = [law%stiffness, law%slip(1)]
      if (has_moments(kind)) record(arm_rolling_length) = law%moment_arm(1)
    end if
  end subroutine arm_record

  !> Bring the solution back: impulses and statuses of contacts, velocities of bodies (into `free_velocity`).
  subroutine disassemble(problem, plan, pairs, time_step, violation, scene, contacts)
    type(problem_t), intent(in) :: problem !! solved problem
    type(plan_t), intent(in) :: plan !! radii of round bodies
    type(neighbours_t), intent(in) :: pairs !! bodies of slots
    real(wp), intent(in) :: time_step !! time step [s]
    real(wp), intent(in) :: violation !! velocity error of the solution over the velocity scale of the problem
    type(scene_t), intent(inout) :: scene !! scene whose bodies move on
    type(contacts_t), intent(inout) :: contacts !! contacts that carry the impulses to the next step
    real(wp) :: rest
    integer :: k

    do k = 1, contacts%n
      contacts%impulse(:, k) = problem%impulse(:force_length(problem%kind), k)
    end do
    if (has_moments(problem%kind)) contacts%internal(contacts%n_internal - contacts%n_moments + 1:, :contacts%n) = &
      problem%impulse(force_length(problem%kind) + 1:, :contacts%n)
    ! A step that broke ends the run: its statuses stay those of the step before.
    if (is_finite(problem, violation)) then
      rest = rest_speed(problem, violation)
      if (have_gap_laws(scene, plan, problem%drives_spin)) then
        call find_statuses(problem, rest, contacts%status)
      else
        do k = 1, contacts%n
          contacts%status(k) = status_after(scene, problem, contacts, k, time_step, rest)
        end do
      end if
    end if
    call take_velocities(problem, pairs%body_of, plan%radius, scene%bodies)
  end subroutine disassemble

  !> Are all values of a solution finite?
  pure logical function is_finite(problem, violation)
    type(problem_t), intent(in) :: problem
    real(wp), intent(in) :: violation

    is_finite = ieee_is_finite(violation) .and. are_finite(size(problem%body), problem%body) .and. &
                are_finite(size(problem%impulse, 1)*problem%n_contacts, problem%impulse)
  end function is_finite

  !> Are so many values finite? Counted, since a loop without a branch per value is several times faster.
  pure logical function are_finite(n, values)
    integer, intent(in) :: n
    real(wp), intent(in) :: values(*)

    are_finite = count(abs(values(:n)) <= huge(1.0_wp)) == n
  end function are_finite

  !> What a contact did in this step. A bond that slips or opens is broken for good.
  pure integer(i1) function status_after(scene, problem, contacts, k, time_step, rest) result(status)
    type(scene_t), intent(in) :: scene
    type(problem_t), intent(in) :: problem
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp), intent(in) :: time_step, rest
    logical :: is_bonded
    real(wp) :: stretch

    ! Of links `finish_links` sets it.
    status = contacts%status(k)
    if (is_link(scene, contacts, k)) return
    if (is_cohesive_zone(scene%laws(contacts%law(k)))) then
      status = status_of(problem, k, .false., 0.0_wp, rest)
      if (status /= status_slide .and. contacts%internal(bond_integrity, k) > 0) status = status_bonded
      return
    end if
    is_bonded = contacts%status(k) == status_bonded .and. scene%laws(contacts%law(k))%kind == law_mohr
    stretch = 0
    if (is_bonded) stretch = (largest_stretch*minval(scene%contactors%reach(contacts%contactor(:, k))) - contacts%gap(k))/time_step
    status = status_of(problem, k, is_bonded, stretch, rest)
    if (status == status_stick .and. is_bonded) status = status_bonded
  end function status_after
end module sg_assemble
