!> The primal method: grains are distributed; contacts between the grains of two ranks are the (n+1)-th subdomain
!! (doc/theory/decomposition.md).
!!
!! Step 1 sweeps the contacts within each part, all parts at once and each as often as the deck says; step 2 sweeps the
!! contacts between parts, edge by edge in the order of their colours. Both are plain Gauss-Seidel with whole masses, only
!! the order is another one. Walls that impulses can move are held by all ranks, their mass divided among them.
module sg_primal
  use sg_comm, only: comm_t
  use sg_compact, only: add_impulses
  use sg_edges, only: all_edges, edges_t
  use sg_glued_solver, only: glued_solver_t
  use sg_home_sum, only: copy_from_home
  use sg_kinds, only: wp, i4
  use sg_parts, only: part_own, part_shared
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_sharing, only: sharing_t
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: tables_t
  implicit none
  private
  public :: primal_t

  !> The primal method
  type, extends(glued_solver_t) :: primal_t
    type(sharing_t), private :: sharing
    type(edges_t), private :: edges
  contains
    procedure :: open => primal_open
    procedure :: begin_round => primal_begin_round
    procedure :: finish_round => primal_finish_round
    procedure :: begin_test => primal_begin_test
    procedure :: tell_result => primal_tell_result
    procedure :: list_shared => primal_list_shared
  end type primal_t

contains

  !> Find edges and walls that move, divide the mass of these, and let the guess act.
  subroutine primal_open(self, problem, subdomain, slot_of, comm)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: subdomain !! who holds which body
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: before(:, :)

    call self%sharing%find(problem, subdomain, slot_of, comm)
    call self%edges%prepare(problem, subdomain, slot_of, self%sharing, comm)
    call self%divide_masses(problem, self%sharing%wide%slot, self%sharing%wide%parts)
    allocate (before(self%width, size(self%edges%borrowed)))
    before(:, :) = problem%body(:self%width, self%edges%borrowed)
    call add_impulses(problem)
    call self%edges%return_changes(before, problem, comm)
    call self%sharing%wide%glue(problem, .true., comm)
    call self%parts%begin(problem, parts_of(self, problem), part_own + size(subdomain%neighbour), .true., &
                          [self%edges%lent, self%edges%borrowed, self%sharing%wide%slot], self%options)
  end subroutine primal_open

  !> Part of each contact: 1 where a wall moves, 2 within this rank, 2 + i on the edge with neighbour i.
  pure function parts_of(self, problem) result(part)
    class(primal_t), intent(in) :: self
    type(problem_t), intent(in) :: problem
    integer(i4) :: part(problem%n_contacts), part_of_slot(problem%n_bodies)
    integer :: i, k

    part_of_slot = part_own
    do i = 1, size(self%edges%colour)
      part_of_slot(self%edges%borrowed(self%edges%borrowed_first(i):self%edges%borrowed_first(i + 1) - 1)) = &
        int(part_own + i, i4)
    end do
    part_of_slot(self%sharing%wide%slot) = part_shared
    do k = 1, problem%n_contacts
      part(k) = maxval(part_of_slot(problem%pair(:, k)))
      if (part(k) == part_own .and. any(part_of_slot(problem%pair(:, k)) == part_shared)) part(k) = part_shared
    end do
  end function parts_of

  !> Sweep where walls move.
  subroutine primal_begin_round(self, problem, report)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(report_t), intent(inout) :: report !! contact updates are counted

    call self%parts%sweep(part_shared, problem, self%options%relaxation, report)
  end subroutine primal_begin_round

  !> Sweep within parts, as often as the deck says, then on edges, colour by colour.
  subroutine primal_finish_round(self, problem, is_cut, comm, report)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    logical, intent(in) :: is_cut !! only glue
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(inout) :: report !! contact updates are counted
    integer :: i, c

    do i = 1, merge(0, self%partition%sweeps_of(comm%rank), is_cut)
      if (i > 1) call self%begin_round(problem, report)
      call self%parts%sweep(part_own, problem, self%options%relaxation, report)
    end do
    call self%sharing%wide%glue(problem, .true., comm)
    do c = 1, merge(0, self%edges%n_colours, is_cut)
      call sweep_edge(self, c, problem, comm, report)
    end do
  end subroutine primal_finish_round

  !> The turn of one colour on this rank: lend or borrow, sweep what this rank owns, give back.
  subroutine sweep_edge(self, c, problem, comm, report)
    class(primal_t), intent(inout) :: self
    integer, intent(in) :: c
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report
    integer :: i, j

    i = findloc(self%edges%colour, c, 1)
    if (i == 0) return
    call self%edges%carry(c, .false., problem, comm)
    if (self%edges%borrowed_first(i + 1) > self%edges%borrowed_first(i)) then
      do j = 1, self%partition%interface_sweeps
        call self%parts%sweep(part_own + i, problem, self%options%relaxation, report)
      end do
    end if
    call self%edges%carry(c, .true., problem, comm)
  end subroutine sweep_edge

  !> Copy the impulses to the problem, bring all borrowed copies up to date, and begin to sum the errors.
  subroutine primal_begin_test(self, problem, with_e1, comm)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    logical, intent(in) :: with_e1 !! measure e1 and e2 too
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%parts%give_impulses(problem)
    call self%edges%carry(all_edges, .false., problem, comm)
    if (self%parts%clusters%are_sought) then
      call self%errors%begin(problem, with_e1, comm, self%parts%active_set%closing, self%parts%clusters%squares)
    else
      call self%errors%begin(problem, with_e1, comm, self%parts%active_set%closing)
    end if
  end subroutine primal_begin_test

  !> Give the velocities found to all copies: those of a grain stand at its home.
  subroutine primal_tell_result(self, problem, subdomain, slot_of, comm)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: subdomain !! who holds which body
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: velocity(:, :)

    allocate (velocity(self%width, size(slot_of)))
    velocity(:, :) = problem%body(:self%width, slot_of)
    call copy_from_home(subdomain, comm, velocity)
    problem%body(:self%width, slot_of(subdomain%body)) = velocity(:, subdomain%body)
  end subroutine primal_tell_result

  !> List the tables of walls that move and of edges.
  subroutine primal_list_shared(self, tables)
    class(primal_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%sharing%list_tables(tables)
    call self%edges%list_tables(tables)
  end subroutine primal_list_shared
end module sg_primal
