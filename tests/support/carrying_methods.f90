!> Methods of runs that carry values: velocities and impulses added up, step by step.
module carrying_methods
  use sg_comm, only: comm_t
  use sg_dual, only: dual_t
  use sg_kinds, only: wp
  use sg_nlgs, only: nlgs_t
  use sg_problem, only: problem_t
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: carrying_alone_t, carrying_dual_t

  !> Sweeps of one rank
  type, extends(nlgs_t) :: carrying_alone_t
  contains
    procedure :: close => close_alone
  end type carrying_alone_t

  !> The dual method
  type, extends(dual_t) :: carrying_dual_t
  contains
    procedure :: close => close_dual
  end type carrying_dual_t

contains

  !> Add the solution.
  subroutine close_alone(self, problem, coupling, comm)
    class(carrying_alone_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot: none
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%nlgs_t%close(problem, coupling, comm)
    call add_solution(problem, self%carried_body, self%carried_contact)
  end subroutine close_alone

  !> Add the solution.
  subroutine close_dual(self, problem, coupling, comm)
    class(carrying_dual_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%dual_t%close(problem, coupling, comm)
    call add_solution(problem, self%carried_body, self%carried_contact)
  end subroutine close_dual

  !> Add velocities, impulses, and steps as one more impulse.
  pure subroutine add_solution(problem, body, contact)
    type(problem_t), intent(in) :: problem
    real(wp), intent(inout) :: body(:, :), contact(:, :)

    body = body + problem%body(:size(body, 1), :problem%n_bodies)
    associate (d => size(problem%impulse, 1))
      contact(:d, :) = contact(:d, :) + problem%impulse(:, :problem%n_contacts)
      contact(d + 1:, :) = contact(d + 1:, :) + 1
    end associate
  end subroutine add_solution
end module carrying_methods
