!> The contact problem of the next substep from that of the substep before (doc/theory/substeps.md).
!!
!! Where all laws look at gaps alone, only free velocities, normals, biases and lever arms change from one substep to the next:
!! slots and the guess, which is the solution just found, stay where they are. Blocks of disks and balls stay too, for they do
!! not depend on the normal; those of polygons are set again. Of solids the tangents turn with the normal, and the block stays
!! that of the first substep on them: sweeps find the same solution by any block, since they work with true relative velocities.
module sg_update_problem
  use sg_compact, only: compact_velocity
  use sg_contacts, only: contacts_t
  use sg_delassus, only: set_block
  use sg_gap_laws, only: have_gap_laws
  use sg_kinds, only: wp, i4
  use sg_laws, only: gap_bias
  use sg_mapping, only: arms_of
  use sg_mapping_space, only: space_arms
  use sg_plan, only: plan_t
  use sg_problem, only: problem_t
  use sg_problem_bodies, only: load_bodies, take_velocities
  use sg_records, only: arm_bias_n, arm_bias_t, arm_frictional, arm_moment_na, arm_moment_nc, arm_moment_ta, arm_moment_tc, &
                        ball_bias_x, ball_bias_z, ball_frictional, is_in_space, normal_x, normal_y, normal_z, &
                        round_bias_n, round_bias_t, round_frictional, round_inverse_mx, round_inverse_my, round_spin, &
                        solid_arm_ax, solid_arm_az, solid_arm_cx, solid_arm_cz, solid_bias_x, solid_bias_z, solid_frictional, &
                        solid_tangent_x, solid_tangent_z, velocity_x, velocity_y
  use sg_scene, only: scene_t
  implicit none
  private
  public :: can_update, update_problem, take_impulses

contains

  !> Can the problems of a scene be updated from substep to substep? Those with friction, of laws that look at the gap alone, where
  !! no driven spin enters as a bias and no drive begins or ends.
  pure logical function can_update(scene, plan)
    type(scene_t), intent(in) :: scene !! scene with its laws, free velocities set
    type(plan_t), intent(in) :: plan !! kind of problem
    integer :: i

    can_update = have_gap_laws(scene, plan)
    ! Masses of components that are released within a step change with it.
    do i = 1, size(scene%drives)
      can_update = can_update .and. .not. scene%drives(i)%releases()
    end do
  end function can_update

  !> Make the problem of a substep from the solved one of the substep before, of the same contacts.
  pure subroutine update_problem(scene, plan, body_of, contacts, time_step, problem)
    type(scene_t), intent(in) :: scene !! scene, its `middle` configuration set
    type(plan_t), intent(in) :: plan !! radii of round bodies
    integer(i4), intent(in) :: body_of(:) !! bodies of slots
    type(contacts_t), intent(in) :: contacts !! contacts where bodies are now
    real(wp), intent(in) :: time_step !! length of the substep [s]
    type(problem_t), intent(inout) :: problem !! its impulses are the guess
    real(wp) :: squares, fastest, bias, square, opening
    integer :: k

    call load_bodies(scene%bodies, problem%kind, body_of, plan%radius, problem%body)
    squares = 0
    fastest = 0
    do k = 1, contacts%n
      bias = bias_of(scene, contacts, k, time_step)
      if (problem%kind == round_frictional) then
        call update_round(contacts, k, bias, problem, opening, square)
      else
        call update_record(scene, contacts, k, bias, problem)
        call find_opening(contacts, k, problem, opening, square)
      end if
      squares = squares + square
      if (opening < 0) fastest = max(fastest, square)
    end do
    problem%free_norm = sqrt(squares)
    problem%closing_speed = sqrt(fastest)
    if (.not. problem%fall_speed > 0) problem%velocity_scale = problem%free_norm/sqrt(real(max(1, contacts%n), wp))
  end subroutine update_problem

  !> Normal bias of a contact [m/s].
  pure real(wp) function bias_of(scene, contacts, k, time_step) result(bias)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp), intent(in) :: time_step
    real(wp) :: reference

    reference = 0
    if (contacts%n_internal > 0) reference = contacts%internal(1, k)
    bias = gap_bias(scene%laws(contacts%law(k)), contacts%gap(k), time_step, reference)
  end function bias_of

  !> Velocity at which a contact opens without impulses [m/s], and square of its relative velocity [m2/s2].
  pure subroutine find_opening(contacts, k, problem, opening, square)
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    type(problem_t), intent(in) :: problem
    real(wp), intent(out) :: opening, square
    real(wp) :: q(3)

    q = compact_velocity(problem, k)
    opening = q(1)
    if (is_in_space(problem%kind)) opening = dot_product(contacts%normal(:, k), q)
    square = q(1)**2 + q(2)**2 + q(3)**2
  end subroutine find_opening

  !> The record of a contact that is not one of disks.
  pure subroutine update_record(scene, contacts, k, bias, problem)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp), intent(in) :: bias
    type(problem_t), intent(inout) :: problem

    select case (problem%kind)
    case (arm_frictional)
      call update_arms(scene, contacts, k, bias, problem)
    case (ball_frictional)
      problem%record(normal_x:normal_z, k) = contacts%normal(:, k)
      problem%record(ball_bias_x:ball_bias_z, k) = bias*contacts%normal(:, k)
    case default
      call update_solids(scene, contacts, k, bias, problem)
    end select
  end subroutine update_record

  !> The record of a contact of disks, and what `find_opening` finds, in one pass.
  pure subroutine update_round(contacts, k, bias, problem, opening, square)
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp), intent(in) :: bias
    type(problem_t), intent(inout) :: problem
    real(wp), intent(out) :: opening, square
    real(wp) :: x, y, u
    integer :: c, a

    c = problem%pair(1, k)
    a = problem%pair(2, k)
    associate (record => problem%record, body => problem%body)
      record(normal_x, k) = contacts%normal(1, k)
      record(normal_y, k) = contacts%normal(2, k)
      record(round_bias_n, k) = bias
      record(round_bias_t, k) = 0
      ! The block depends on the normal where a body is driven in one direction.
      if (abs(body(round_inverse_mx, c) - body(round_inverse_my, c)) &
          + abs(body(round_inverse_mx, a) - body(round_inverse_my, a)) > 0) &
        call set_block(problem%kind, body(:, c), body(:, a), record(:, k))
      x = body(velocity_x, c) - body(velocity_x, a)
      y = body(velocity_y, c) - body(velocity_y, a)
      opening = record(normal_x, k)*x + record(normal_y, k)*y + bias
      u = record(normal_y, k)*x - record(normal_x, k)*y + body(round_spin, c) + body(round_spin, a)
    end associate
    square = opening**2 + u**2
  end subroutine update_round

  !> That of a contact with any arms in the plane.
  pure subroutine update_arms(scene, contacts, k, bias, problem)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp), intent(in) :: bias
    type(problem_t), intent(inout) :: problem
    real(wp) :: arms(2, 2)

    arms = arms_of(contacts, k, scene%bodies%middle, scene%period)
    associate (record => problem%record(:, k), n => contacts%normal(:, k))
      record(normal_x:normal_y) = n
      record(arm_moment_nc) = arms(1, 1)*n(2) - arms(2, 1)*n(1)
      record(arm_moment_tc) = -arms(1, 1)*n(1) - arms(2, 1)*n(2)
      record(arm_moment_na) = arms(1, 2)*n(2) - arms(2, 2)*n(1)
      record(arm_moment_ta) = -arms(1, 2)*n(1) - arms(2, 2)*n(2)
      record(arm_bias_n) = bias
      record(arm_bias_t) = 0
      call set_block(problem%kind, problem%body(:, problem%pair(1, k)), problem%body(:, problem%pair(2, k)), record)
    end associate
  end subroutine update_arms

  !> That of a contact of solids.
  pure subroutine update_solids(scene, contacts, k, bias, problem)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp), intent(in) :: bias
    type(problem_t), intent(inout) :: problem
    real(wp) :: arms(3, 2), t(3)

    arms = space_arms(scene, contacts, k)
    associate (record => problem%record(:, k), n => contacts%normal(:, k))
      t = record(solid_tangent_x:solid_tangent_z)
      t = t - dot_product(t, n)*n
      record(normal_x:normal_z) = n
      record(solid_tangent_x:solid_tangent_z) = t/sqrt(dot_product(t, t))
      record(solid_arm_cx:solid_arm_cz) = arms(:, 1)
      record(solid_arm_ax:solid_arm_az) = arms(:, 2)
      record(solid_bias_x:solid_bias_z) = bias*n
    end associate
  end subroutine update_solids

  !> Take impulses and velocities of a solved problem whose laws ask for no status: a later substep finds it.
  pure subroutine take_impulses(problem, plan, body_of, scene, contacts)
    type(problem_t), intent(in) :: problem !! solved problem
    type(plan_t), intent(in) :: plan !! radii of round bodies
    integer(i4), intent(in) :: body_of(:) !! bodies of slots
    type(scene_t), intent(inout) :: scene !! its `free_velocity` is set
    type(contacts_t), intent(inout) :: contacts !! its impulses are set
    integer :: k

    do k = 1, contacts%n
      contacts%impulse(:, k) = problem%impulse(:, k)
    end do
    call take_velocities(problem, body_of, plan%radius, scene%bodies)
  end subroutine take_impulses
end module sg_update_problem
