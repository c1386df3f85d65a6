!> Rates of a periodic cell that follow the impulses of a contact problem (doc/theory/periodic_cell.md, "Imposed stress").
module sg_relax_cell
  use sg_contacts, only: contacts_t
  use sg_cell_motion, only: cell_branch
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: arm_bias_n, arm_bias_t, arm_frictional, arm_frictionless, arm_frictionless_bias, ball_bias_x, ball_bias_z, &
                        ball_frictional, ball_frictionless, ball_frictionless_bias, is_in_space, normal_x, normal_y, normal_z, &
                        plain_kind, round_bias_n, round_bias_t, round_frictional, round_frictionless, round_frictionless_bias, &
                        solid_bias_x, solid_bias_z, solid_frictional, solid_frictionless, solid_frictionless_bias
  use sg_scene, only: scene_t
  implicit none
  private
  public :: begin_cell, relax_cell

contains

  !> Add the unknown rates of a cell to an assembled problem.
  subroutine begin_cell(scene, contacts, problem)
    type(scene_t), intent(in) :: scene !! scene, its `middle` configuration set
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    type(problem_t), intent(inout) :: problem !! assembled
    real(wp) :: bound(4), mass
    integer :: k

    associate (cell => problem%cell)
      cell%is_on = any(scene%cell%is_stress)
      if (.not. cell%is_on) return
      cell%is_free = scene%cell%is_stress
      cell%free = scene%cell%rate
      cell%rate = cell%free
      cell%inertia = scene%cell%inertia
      if (allocated(cell%branch)) then
        if (size(cell%branch, 2) < contacts%n) deallocate (cell%branch)
      end if
      if (.not. allocated(cell%branch)) allocate (cell%branch(3, contacts%n + contacts%n/8))
      bound = 0
      do k = 1, contacts%n
        cell%branch(:, k) = cell_branch(scene, contacts, k)
        ! Reduced mass: blocks of contacts are no smaller than its inverse.
        mass = 1/sum(1/scene%bodies%mass(contacts%body(:, k)))
        bound = bound + mass*cell%branch([1, 2, 3, 2], k)**2
      end do
      cell%share = 1/max(1.0_wp, 2*sum(bound/cell%inertia, cell%is_free))
    end associate
  end subroutine begin_cell

  !> Bring the rates to the present impulses, and the biases to the rates.
  subroutine relax_cell(problem)
    type(problem_t), intent(inout) :: problem !! with unknown rates; impulses of all contacts are in it
    real(wp) :: sums(4), change(4), r(3)
    integer :: k

    sums = 0
    do k = 1, problem%n_contacts
      r = impulse_of(problem, k)
      associate (l => problem%cell%branch(:, k))
        sums = sums + [r(1)*l(1), r(2)*l(2), r(3)*l(3), r(1)*l(2)]
      end associate
    end do
    associate (cell => problem%cell)
      change = 0
      where (cell%is_free) change = cell%share*(cell%free + sums/cell%inertia - cell%rate)
      cell%rate = cell%rate + change
      do k = 1, problem%n_contacts
        call add_bias(problem%kind, change(:3)*cell%branch(:, k) + [change(4)*cell%branch(2, k), 0.0_wp, 0.0_wp], &
                      problem%record(:, k))
      end do
    end associate
  end subroutine relax_cell

  !> Impulse of a contact in the world's axes [N s].
  pure function impulse_of(problem, k) result(r)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    real(wp) :: r(3)

    r = 0
    associate (impulse => problem%impulse(:, k), record => problem%record(:, k))
      if (size(impulse) == 3) then
        r = impulse
      else if (is_in_space(problem%kind)) then
        r = impulse(1)*record(normal_x:normal_z)
      else
        r(:2) = impulse(1)*record(normal_x:normal_y)
        if (size(impulse) == 2) r(:2) = r(:2) + impulse(2)*[record(normal_y), -record(normal_x)]
      end if
    end associate
  end function impulse_of

  !> Add a relative velocity to the bias of a record.
  pure subroutine add_bias(kind, jump, record)
    integer, intent(in) :: kind
    real(wp), intent(in) :: jump(3)
    real(wp), intent(inout) :: record(:)
    real(wp) :: normal, tangential

    if (is_in_space(kind)) then
      normal = dot_product(record(normal_x:normal_z), jump)
      tangential = 0
    else
      normal = record(normal_x)*jump(1) + record(normal_y)*jump(2)
      tangential = record(normal_y)*jump(1) - record(normal_x)*jump(2)
    end if
    select case (plain_kind(kind))
    case (round_frictionless)
      record(round_frictionless_bias) = record(round_frictionless_bias) + normal
    case (round_frictional)
      record(round_bias_n) = record(round_bias_n) + normal
      record(round_bias_t) = record(round_bias_t) + tangential
    case (arm_frictionless)
      record(arm_frictionless_bias) = record(arm_frictionless_bias) + normal
    case (arm_frictional)
      record(arm_bias_n) = record(arm_bias_n) + normal
      record(arm_bias_t) = record(arm_bias_t) + tangential
    case (ball_frictionless)
      record(ball_frictionless_bias) = record(ball_frictionless_bias) + normal
    case (ball_frictional)
      record(ball_bias_x:ball_bias_z) = record(ball_bias_x:ball_bias_z) + jump
    case (solid_frictionless)
      record(solid_frictionless_bias) = record(solid_frictionless_bias) + normal
    case (solid_frictional)
      record(solid_bias_x:solid_bias_z) = record(solid_bias_x:solid_bias_z) + jump
    end select
  end subroutine add_bias
end module sg_relax_cell
