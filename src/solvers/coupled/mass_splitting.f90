!> Mass splitting: sweeps of all ranks over their own contacts, glued after each round. Common part of the dual method and of the
!! exchange of momentum (doc/theory/decomposition.md).
module sg_mass_splitting
  use sg_comm, only: comm_t
  use sg_compact, only: add_impulses
  use sg_contact_sets, only: inner_set, shared_set
  use sg_coupled_solver, only: coupled_solver_t
  use sg_gluing, only: gluing_t
  use sg_kinds, only: wp, i4
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: tables_t
  implicit none
  private
  public :: mass_splitting_t

  !> A solver that sweeps and glues
  type, abstract, extends(coupled_solver_t) :: mass_splitting_t
    !> Gluing of the last solve
    type(gluing_t) :: gluing
    !> Share of each change that contacts of shared bodies take; and may a large one have the rounds diverge?
    real(wp), private :: relaxation = 1
    logical, private :: may_diverge = .false.
  contains
    procedure :: open => splitting_open
    procedure :: mark => splitting_mark
    procedure :: begin_round => splitting_begin_round
    procedure :: finish_round => splitting_finish_round
    procedure :: collect => splitting_collect
    procedure :: close => splitting_close
    procedure :: list_shared => splitting_list_shared
    procedure(rule), deferred :: rule
  end type mass_splitting_t

  abstract interface
    !> How copies are treated.
    pure subroutine rule(self, is_mean, relaxation)
      import :: mass_splitting_t, wp
      class(mass_splitting_t), intent(in) :: self
      logical, intent(out) :: is_mean !! divide masses among copies and take their mean velocity, or add up their changes
      real(wp), intent(out) :: relaxation !! share of each change that contacts of shared bodies take
    end subroutine rule
  end interface

contains

  !> Find the shared bodies, divide their masses where the method does so, and let the guess act.
  subroutine splitting_open(self, problem, coupling, comm)
    class(mass_splitting_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks
    logical :: is_mean
    integer(i4), allocatable :: set(:)

    call self%begin_coupled(problem)
    call self%rule(is_mean, self%relaxation)
    self%may_diverge = .not. is_mean
    ! Relaxed sweeps leave impulses outside their cones, and rounds that add up changes overshoot: neither bears momentum.
    if (.not. is_mean) call self%sets%nesterov%begin(.false.)
    call self%gluing%prepare(problem, coupling, is_mean, .false., comm)
    associate (interface => self%gluing%interface)
      call self%divide_masses(problem, interface%slot, merge(interface%multiplicity, 1, is_mean))
      call add_impulses(problem)
      call self%gluing%begin(problem, comm)
      allocate (set(problem%n_contacts), source=int(inner_set, i4))
      set(interface%contact) = shared_set
      call self%sets%split(problem, set, 2, is_mean, interface%slot)
    end associate
    call self%gluing%finish(problem, comm)
  end subroutine splitting_open

  !> Take the present velocities of copies for those that a round starts from.
  subroutine splitting_mark(self, problem)
    class(mass_splitting_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! this rank's part

    call self%gluing%mark(problem)
  end subroutine splitting_mark

  !> Sweep contacts of shared bodies, so that their messages travel while the others are swept.
  subroutine splitting_begin_round(self, problem, report)
    class(mass_splitting_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(report_t), intent(inout) :: report !! contact updates are counted

    call self%sets%sweep(shared_set, problem, self%relaxation*merge(self%damping, 1.0_wp, self%may_diverge), report)
  end subroutine splitting_begin_round

  !> Sweep the others, repeat as often as the options ask, and glue.
  subroutine splitting_finish_round(self, problem, is_cut, comm, report)
    class(mass_splitting_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    logical, intent(in) :: is_cut !! only glue
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(inout) :: report !! contact updates are counted
    integer :: i, sweeps

    sweeps = merge(0, self%partition%sweeps_of(comm%rank), is_cut)
    do i = 1, sweeps - 1
      call self%sets%sweep(inner_set, problem, self%options%relaxation, report)
      call self%begin_round(problem, report)
    end do
    call self%gluing%begin(problem, comm)
    if (.not. is_cut) call self%sets%sweep(inner_set, problem, self%options%relaxation, report)
    call self%gluing%finish(problem, comm)
  end subroutine splitting_finish_round

  !> Collect the impulses in the problem; all copies are glued already.
  subroutine splitting_collect(self, problem, comm)
    class(mass_splitting_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%sets%give_impulses(problem)
    if (self%may_diverge .or. self%relaxation < 1) call drop_traces(problem%n_contacts, problem%impulse)
  end subroutine splitting_collect

  !> Drop what is left of impulses of contacts that have opened: relaxed sweeps let them fade, but never vanish, and a contact
  !! that carries anything counts as one. What is dropped is lost in the rounding of the others.
  pure subroutine drop_traces(n, impulse)
    integer, intent(in) :: n
    real(wp), intent(inout) :: impulse(:, :)
    real(wp) :: largest
    integer :: k

    largest = 0
    if (n > 0) largest = maxval(abs(impulse(:, :n)))
    do k = 1, n
      if (all(abs(impulse(:, k)) <= 1e-12_wp*largest)) impulse(:, k) = 0
    end do
  end subroutine drop_traces

  !> Make masses whole, and give the velocities found to the copies that took no part.
  subroutine splitting_close(self, problem, coupling, comm)
    class(mass_splitting_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%make_masses_whole(problem)
    call self%gluing%interface%update_idle(problem%body, coupling, comm)
  end subroutine splitting_close

  !> List the tables of the gluing.
  subroutine splitting_list_shared(self, tables)
    class(mass_splitting_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%list_masses(tables)
    call self%gluing%list_tables(tables)
  end subroutine splitting_list_shared
end module sg_mass_splitting
