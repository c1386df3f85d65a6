!> The primal method: grains are distributed; contacts between the grains of two ranks are the (n+1)-th subdomain
!! (doc/theory/decomposition.md).
!!
!! Step 1 sweeps the contacts within each subdomain, all subdomains at once and each as often as the options ask; step 2
!! sweeps the contacts between subdomains, edge by edge in the order of their colours. Both are plain Gauss-Seidel with whole
!! masses, in another order. Replicated bodies that impulses can move have their mass divided among all ranks.
module sg_primal
  use sg_comm, only: comm_t
  use sg_compact, only: add_impulses
  use sg_contact_sets, only: inner_set, shared_set
  use sg_coupled_solver, only: coupled_solver_t
  use sg_edges, only: all_edges, edges_t
  use sg_gluing, only: gluing_t
  use sg_kinds, only: wp, i4
  use sg_options, only: option_t, option_visitor_t
  use sg_owner_sums, only: copy_from_owner
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: tables_t
  implicit none
  private
  public :: primal_t

  !> The primal method
  type, extends(coupled_solver_t) :: primal_t
    !> Sweeps over the contacts between subdomains at each gluing
    integer :: interface_sweeps = 1
    type(gluing_t), private :: gluing
    integer, allocatable, private :: replicated(:)
    type(edges_t), private :: edges
  contains
    procedure :: visit_options => primal_visit_options
    procedure :: open => primal_open
    procedure :: mark => primal_mark
    procedure :: begin_round => primal_begin_round
    procedure :: finish_round => primal_finish_round
    procedure :: collect => primal_collect
    procedure :: close => primal_close
    procedure :: list_shared => primal_list_shared
  end type primal_t

contains

  !> Options of the primal method.
  subroutine primal_visit_options(self, visitor)
    class(primal_t), intent(inout) :: self
    class(option_visitor_t), intent(inout) :: visitor !! key table, or values of a deck

    call visitor%option(option_t('interface_sweeps', 'Sweeps over the contacts between parts at each gluing.', least=1.0_wp, &
                                 former='partition.interface_sweeps'), self%interface_sweeps)
  end subroutine primal_visit_options

  !> Find edges and replicated bodies that move, divide the mass of these, and let the guess act.
  subroutine primal_open(self, problem, coupling, comm)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: before(:, :)

    call self%begin_coupled(problem)
    self%most_updates = max(self%most_updates, self%interface_sweeps)
    call self%gluing%prepare(problem, coupling, .true., .true., comm)
    associate (interface => self%gluing%interface)
      call self%edges%prepare(problem, coupling, interface, comm)
      self%replicated = interface%slot(interface%n_shared + 1:)
      call self%divide_masses(problem, self%replicated, interface%multiplicity(interface%n_shared + 1:))
    end associate
    allocate (before(self%width, size(self%edges%borrowed)))
    before(:, :) = problem%body(:self%width, self%edges%borrowed)
    call add_impulses(problem)
    call self%edges%return_changes(before, problem, comm)
    call self%gluing%glue_replicated(problem, comm)
    call self%sets%split(problem, sets_of(self, problem), inner_set + size(coupling%neighbour), .true., &
                         [self%edges%lent, self%edges%borrowed, self%replicated])
  end subroutine primal_open

  !> Set of each contact: 1 where a replicated body moves, 2 within this rank, 2 + i on the edge with neighbour i.
  pure function sets_of(self, problem) result(set)
    class(primal_t), intent(in) :: self
    type(problem_t), intent(in) :: problem
    integer(i4) :: set(problem%n_contacts), set_of_slot(problem%n_bodies)
    integer :: i, k

    set_of_slot = inner_set
    do i = 1, size(self%edges%colour)
      set_of_slot(self%edges%borrowed(self%edges%borrowed_first(i):self%edges%borrowed_first(i + 1) - 1)) = &
        int(inner_set + i, i4)
    end do
    set_of_slot(self%replicated) = shared_set
    do k = 1, problem%n_contacts
      set(k) = maxval(set_of_slot(problem%pair(:, k)))
      if (set(k) == inner_set .and. any(set_of_slot(problem%pair(:, k)) == shared_set)) set(k) = shared_set
    end do
  end function sets_of

  !> Take the present velocities of replicated bodies for those that a round starts from.
  subroutine primal_mark(self, problem)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! this rank's part

    call self%gluing%mark(problem)
  end subroutine primal_mark

  !> Sweep the contacts of replicated bodies that move.
  subroutine primal_begin_round(self, problem, report)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(report_t), intent(inout) :: report !! contact updates are counted

    call self%sets%sweep(shared_set, problem, self%options%relaxation, report)
  end subroutine primal_begin_round

  !> Sweep within subdomains, as often as the options ask, then on edges, colour by colour.
  subroutine primal_finish_round(self, problem, is_cut, comm, report)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    logical, intent(in) :: is_cut !! only glue
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(inout) :: report !! contact updates are counted
    integer :: i, c

    do i = 1, merge(0, self%partition%sweeps_of(comm%rank), is_cut)
      if (i > 1) call self%begin_round(problem, report)
      call self%sets%sweep(inner_set, problem, self%options%relaxation, report)
    end do
    call self%gluing%glue_replicated(problem, comm)
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
      do j = 1, self%interface_sweeps
        call self%sets%sweep(inner_set + i, problem, self%options%relaxation, report)
      end do
    end if
    call self%edges%carry(c, .true., problem, comm)
  end subroutine sweep_edge

  !> Collect the impulses in the problem, and bring all borrowed copies up to date.
  subroutine primal_collect(self, problem, comm)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%sets%give_impulses(problem)
    call self%edges%carry(all_edges, .false., problem, comm)
  end subroutine primal_collect

  !> Make masses whole, and give the velocities found to all copies: those of a grain stand on its owner rank.
  subroutine primal_close(self, problem, coupling, comm)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%make_masses_whole(problem)
    call copy_from_owner(coupling, comm, problem%body(:self%width, :))
  end subroutine primal_close

  !> List the tables of replicated bodies and of edges.
  subroutine primal_list_shared(self, tables)
    class(primal_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%list_masses(tables)
    call self%gluing%list_tables(tables)
    call self%edges%list_tables(tables)
  end subroutine primal_list_shared
end module sg_primal
