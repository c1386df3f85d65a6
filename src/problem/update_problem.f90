!> The contact problem of the next substep from that of the substep before (doc/theory/substeps.md).
!!
!! Where all laws look at gaps alone, only free velocities, normals, biases and lever arms change from one substep to the next:
!! slots and the guess, which is the solution just found, stay where they are.
module sg_update_problem
  use sg_assemble_by_gaps, only: assemble_by_gaps
  use sg_contacts, only: contacts_t
  use sg_gap_laws, only: has_driven_spin, have_gap_laws
  use sg_kinds, only: wp
  use sg_neighbour_list, only: neighbours_t
  use sg_plan, only: plan_t
  use sg_problem, only: problem_t
  use sg_problem_bodies, only: load_bodies, take_velocities
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

    can_update = have_gap_laws(scene, plan, has_driven_spin(scene%bodies, scene%bodies%free_velocity))
    ! Masses of components that are released within a step change with it.
    do i = 1, size(scene%drives)
      can_update = can_update .and. .not. scene%drives(i)%releases()
    end do
  end function can_update

  !> Make the problem of a substep from the solved one of the substep before, of the same contacts.
  subroutine update_problem(scene, plan, pairs, contacts, time_step, problem)
    type(scene_t), intent(in) :: scene !! scene, its `middle` configuration set
    type(plan_t), intent(in) :: plan !! radii of round bodies
    type(neighbours_t), intent(in) :: pairs !! bodies of slots, and slots of bodies
    type(contacts_t), intent(in) :: contacts !! contacts where bodies are now
    real(wp), intent(in) :: time_step !! length of the substep [s]
    type(problem_t), intent(inout) :: problem !! its impulses are the guess

    call load_bodies(scene%bodies, problem%kind, pairs%body_of, plan%radius, problem%body, problem%moves, problem%fastest, &
                     problem%drives_spin)
    call assemble_by_gaps(scene, pairs%slot_of, contacts, time_step, .true., problem)
    problem%is_continued = .true.
    if (.not. problem%fall_speed > 0) problem%velocity_scale = problem%free_norm/sqrt(real(max(1, contacts%n), wp))
  end subroutine update_problem

  !> Take impulses and velocities of a solved problem whose laws ask for no status: a later substep finds it.
  subroutine take_impulses(problem, plan, pairs, scene, contacts)
    type(problem_t), intent(in) :: problem !! solved problem
    type(plan_t), intent(in) :: plan !! radii of round bodies
    type(neighbours_t), intent(in) :: pairs !! bodies of slots
    type(scene_t), intent(inout) :: scene !! its `free_velocity` is set
    type(contacts_t), intent(inout) :: contacts !! its impulses are set

    associate (n => contacts%n)
      contacts%impulse(:, :n) = problem%impulse(:, :n)
    end associate
    call take_velocities(problem, pairs%body_of, plan%radius, scene%bodies)
  end subroutine take_impulses
end module sg_update_problem
