!> Sweeps of all ranks over their own contacts, glued after each round: what the dual method and the exchange of momentum
!! share (doc/theory/decomposition.md).
module sg_shared_sweeps
  use sg_comm, only: comm_t
  use sg_compact, only: add_impulses
  use sg_glued_solver, only: glued_solver_t
  use sg_gluing, only: gluing_t
  use sg_kinds, only: wp, i4
  use sg_parts, only: part_own, part_shared
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: tables_t
  implicit none
  private
  public :: shared_sweeps_t

  !> A solver that sweeps and glues
  type, abstract, extends(glued_solver_t) :: shared_sweeps_t
    !> Gluing of the last solve
    type(gluing_t) :: gluing
    !> Share of each change that contacts of shared bodies take; and may a large one have the rounds diverge?
    real(wp), private :: relaxation = 1
    logical, private :: may_diverge = .false.
  contains
    procedure :: open => shared_open
    procedure :: begin_round => shared_begin_round
    procedure :: finish_round => shared_finish_round
    procedure :: begin_test => shared_begin_test
    procedure :: tell_result => shared_tell_result
    procedure :: list_shared => shared_list_shared
    procedure(rule), deferred :: rule
  end type shared_sweeps_t

  abstract interface
    !> How copies are treated.
    pure subroutine rule(self, is_mean, relaxation)
      import :: shared_sweeps_t, wp
      class(shared_sweeps_t), intent(in) :: self
      logical, intent(out) :: is_mean !! divide masses among copies and take their mean velocity, or add up their changes
      real(wp), intent(out) :: relaxation !! share of each change that contacts of shared bodies take
    end subroutine rule
  end interface

contains

  !> Find the shared bodies, divide their masses where the method does so, and let the guess act.
  subroutine shared_open(self, problem, subdomain, slot_of, comm)
    class(shared_sweeps_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: subdomain !! who holds which body
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body
    type(comm_t), intent(inout) :: comm !! the ranks
    logical :: is_mean

    call self%rule(is_mean, self%relaxation)
    self%may_diverge = .not. is_mean
    call self%gluing%prepare(problem, subdomain, slot_of, is_mean, comm)
    associate (sharing => self%gluing%sharing)
      associate (slot => [sharing%slot, sharing%wide%slot], copies => [sharing%parts, sharing%wide%parts])
        call self%divide_masses(problem, slot, merge(copies, 1, is_mean))
        call add_impulses(problem)
        call self%gluing%begin(problem, comm)
        call self%parts%begin(problem, parts_of(problem, slot), 2, is_mean, slot, self%options)
      end associate
    end associate
    call self%gluing%finish(problem, comm)
  end subroutine shared_open

  !> Part of each contact: does it touch a shared body?
  pure function parts_of(problem, shared) result(part)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: shared(:) !! slots of shared bodies
    integer(i4) :: part(problem%n_contacts)
    logical :: is_shared(problem%n_bodies)
    integer :: k

    is_shared = .false.
    is_shared(shared) = .true.
    do k = 1, problem%n_contacts
      part(k) = part_own
      if (is_shared(problem%pair(1, k)) .or. is_shared(problem%pair(2, k))) part(k) = part_shared
    end do
  end function parts_of

  !> Sweep contacts of shared bodies, so that their messages travel while the others are swept.
  subroutine shared_begin_round(self, problem, report)
    class(shared_sweeps_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(report_t), intent(inout) :: report !! contact updates are counted

    call self%parts%sweep(part_shared, problem, self%relaxation*merge(self%damping, 1.0_wp, self%may_diverge), report)
  end subroutine shared_begin_round

  !> Sweep the others, go on with all as often as the deck says, and glue.
  subroutine shared_finish_round(self, problem, is_cut, comm, report)
    class(shared_sweeps_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    logical, intent(in) :: is_cut !! only glue
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(inout) :: report !! contact updates are counted
    integer :: i, sweeps

    sweeps = merge(0, self%partition%sweeps_of(comm%rank), is_cut)
    do i = 1, sweeps - 1
      call self%parts%sweep(part_own, problem, self%options%relaxation, report)
      call self%begin_round(problem, report)
    end do
    call self%gluing%begin(problem, comm)
    if (.not. is_cut) call self%parts%sweep(part_own, problem, self%options%relaxation, report)
    call self%gluing%finish(problem, comm)
  end subroutine shared_finish_round

  !> Copy the impulses to the problem, and begin to sum its errors; all copies are glued already.
  subroutine shared_begin_test(self, problem, with_e1, comm)
    class(shared_sweeps_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    logical, intent(in) :: with_e1 !! measure e1 and e2 too
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%parts%give_impulses(problem)
    if (self%may_diverge .or. self%relaxation < 1) call drop_traces(problem%n_contacts, problem%impulse)
    if (self%parts%clusters%are_sought) then
      call self%errors%begin(problem, with_e1, comm, self%parts%active_set%closing, self%parts%clusters%squares)
    else
      call self%errors%begin(problem, with_e1, comm, self%parts%active_set%closing)
    end if
  end subroutine shared_begin_test

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

  !> Give the velocities found to the copies that took no part.
  subroutine shared_tell_result(self, problem, subdomain, slot_of, comm)
    class(shared_sweeps_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: subdomain !! who holds which body
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%gluing%sharing%tell_result(problem, subdomain, slot_of, comm)
  end subroutine shared_tell_result

  !> List the tables of the gluing.
  subroutine shared_list_shared(self, tables)
    class(shared_sweeps_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%gluing%list_tables(tables)
  end subroutine shared_list_shared
end module sg_shared_sweeps
