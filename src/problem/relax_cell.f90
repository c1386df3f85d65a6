!> Rates of a periodic cell that follow the impulses of a contact problem (doc/theory/periodic_cell.md, "Imposed stress").
!!
!! Ranks sum over their own contacts, and all have the same rates bit for bit.
module sg_relax_cell
  use sg_contacts, only: contacts_t
  use sg_cell_motion, only: cell_branch
  use sg_comm, only: comm_t
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_records, only: bias_place, force_length, is_in_space, normal_x, normal_y, normal_z
  use sg_scene, only: scene_t
  implicit none
  private
  public :: begin_cell, ask_rates, relax_cell, record_rates

contains

  !> Add the unknown rates of a cell to an assembled problem. Collective where there are some.
  subroutine begin_cell(scene, contacts, comm, problem)
    type(scene_t), intent(in) :: scene !! scene, its `middle` configuration set
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    type(comm_t), intent(inout) :: comm !! the ranks
    type(problem_t), intent(inout) :: problem !! assembled
    real(wp) :: bound(4), mass
    integer :: k

    associate (cell => problem%cell)
      cell%is_on = any(scene%cell%is_stress)
      if (.not. cell%is_on) return
      cell%is_free = scene%cell%is_stress
      cell%free = scene%cell%rate
      cell%rate = cell%free
      cell%recorded = cell%free
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
      call comm%sum(bound)
      cell%bound = sum(bound/cell%inertia, cell%is_free)
    end associate
  end subroutine begin_cell

  !> Rates that the present impulses of all ranks ask for [1/s]; imposed ones stay. Collective.
  subroutine ask_rates(problem, comm, asked)
    type(problem_t), intent(in) :: problem !! with unknown rates; impulses of all contacts are in it
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(out) :: asked(4) !! the rates
    real(wp) :: sums(4), r(3)
    integer :: k

    sums = 0
    do k = 1, problem%n_contacts
      r = impulse_of(problem, k)
      associate (l => problem%cell%branch(:, k))
        sums = sums + [r(1)*l(1), r(2)*l(2), r(3)*l(3), r(1)*l(2)]
      end associate
    end do
    call comm%sum(sums)
    associate (cell => problem%cell)
      asked = cell%free
      where (cell%is_free) asked = cell%free + sums/cell%inertia
    end associate
  end subroutine ask_rates

  !> Bring the rates nearer to those that the present impulses ask for. Collective.
  subroutine relax_cell(problem, comm)
    type(problem_t), intent(inout) :: problem !! with unknown rates; impulses of all contacts are in it
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp) :: asked(4)

    call ask_rates(problem, comm, asked)
    problem%cell%rate = problem%cell%rate + problem%cell%share*(asked - problem%cell%rate)
  end subroutine relax_cell

  !> Bring the biases of all records to some rates.
  pure subroutine record_rates(rate, problem)
    real(wp), intent(in) :: rate(4) !! the rates [1/s]
    type(problem_t), intent(inout) :: problem !! with unknown rates; its records change
    real(wp) :: change(4)
    integer :: k

    change = rate - problem%cell%recorded
    do k = 1, problem%n_contacts
      associate (l => problem%cell%branch(:, k))
        call add_bias(problem%kind, change(:3)*l + [change(4)*l(2), 0.0_wp, 0.0_wp], problem%record(:, k))
      end associate
    end do
    problem%cell%recorded = rate
  end subroutine record_rates

  !> Impulse of a contact in the world's axes [N s].
  pure function impulse_of(problem, k) result(r)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: k
    real(wp) :: r(3)

    r = 0
    associate (impulse => problem%impulse(:, k), record => problem%record(:, k))
      if (force_length(problem%kind) == 3) then
        r = impulse(:3)
      else if (is_in_space(problem%kind)) then
        r = impulse(1)*record(normal_x:normal_z)
      else
        r(:2) = impulse(1)*record(normal_x:normal_y)
        if (force_length(problem%kind) == 2) r(:2) = r(:2) + impulse(2)*[record(normal_y), -record(normal_x)]
      end if
    end associate
  end function impulse_of

  !> Add a relative velocity to the bias of a record.
  pure subroutine add_bias(kind, jump, record)
    integer, intent(in) :: kind
    real(wp), intent(in) :: jump(3)
    real(wp), intent(inout) :: record(:)
    integer :: n

    n = merge(3, 2, is_in_space(kind))
    associate (place => bias_place(kind), normal => record(normal_x:normal_x + n - 1))
      if (force_length(kind) == 3) then
        record(place:place + 2) = record(place:place + 2) + jump
      else
        record(place) = record(place) + dot_product(normal, jump(:n))
        if (force_length(kind) == 2) record(place + 1) = record(place + 1) + normal(2)*jump(1) - normal(1)*jump(2)
      end if
    end associate
  end subroutine add_bias
end module sg_relax_cell
