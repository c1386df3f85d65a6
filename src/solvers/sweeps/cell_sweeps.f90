!> Nonlinear Gauss-Seidel of one rank for a periodic cell under imposed stress: after each sweep the rates of the cell follow the
!! impulses (doc/theory/periodic_cell.md, "Imposed stress").
!!
!! Sweeps go over the records of the problem in their natural order, all contacts each time: no order holds copies of biases.
module sg_cell_sweeps
  use sg_comm, only: comm_t
  use sg_compact, only: add_impulses
  use sg_kinds, only: i8
  use sg_nlgs, only: nlgs_t
  use sg_problem, only: problem_t
  use sg_relax_cell, only: relax_cell
  use sg_report, only: report_t
  use sg_subdomain, only: subdomain_t
  use sg_sweeps, only: sweep_run
  implicit none
  private
  public :: cell_sweeps_t

  !> Sweeps with unknown rates of a cell
  type, extends(nlgs_t) :: cell_sweeps_t
  contains
    procedure :: open => cell_sweeps_open
    procedure :: finish_round => cell_sweeps_finish_round
    procedure :: collect => cell_sweeps_collect
  end type cell_sweeps_t

contains

  !> Let the guess act on bodies and cell.
  subroutine cell_sweeps_open(self, problem, coupling, comm)
    class(cell_sweeps_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! guess and free velocities; then the velocities under the guess
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks: none
    type(comm_t), intent(inout) :: comm !! the rank

    call add_impulses(problem)
    if (problem%cell%is_on) call relax_cell(problem)
  end subroutine cell_sweeps_open

  !> Sweep once, and let the cell follow.
  subroutine cell_sweeps_finish_round(self, problem, is_cut, comm, report)
    class(cell_sweeps_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! impulses and velocities change
    logical, intent(in) :: is_cut !! has the test passed?
    type(comm_t), intent(inout) :: comm !! the rank
    type(report_t), intent(inout) :: report !! contact updates are counted

    if (is_cut) return
    associate (n => problem%n_contacts)
      call sweep_run(problem%kind, n, problem%n_bodies, problem%pair(:, :n), problem%record(:, :n), self%options%relaxation, &
                     problem%impulse(:, :n), problem%body)
      report%contact_updates = report%contact_updates + int(n, i8)
    end associate
    if (problem%cell%is_on) call relax_cell(problem)
  end subroutine cell_sweeps_finish_round

  !> Collect impulses: they are in the problem.
  subroutine cell_sweeps_collect(self, problem, comm)
    class(cell_sweeps_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! the problem
    type(comm_t), intent(inout) :: comm !! the rank
  end subroutine cell_sweeps_collect
end module sg_cell_sweeps
