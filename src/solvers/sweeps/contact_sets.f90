!> Contacts of a rank in several sets, each with an order of sweep of its own: contacts of shared bodies, swept before messages
!! leave; those of inner bodies, swept while messages travel; those on edges between subdomains. One rank alone has one set.
module sg_contact_sets
  use sg_active_set, only: active_set_t, limit_of
  use sg_comm, only: comm_t
  use sg_delassus, only: set_block
  use sg_kinds, only: wp, i4, i8
  use sg_nesterov, only: nesterov_t
  use sg_order_errors, only: order_errors_t
  use sg_order_tables, only: list_order
  use sg_order_values, only: give_impulses, put_biases
  use sg_problem, only: problem_t
  use sg_relax_cell, only: record_rates
  use sg_report, only: report_t
  use sg_run_options, only: solver_options_t
  use sg_solved_clusters, only: solved_clusters_t
  use sg_residuals, only: n_error_sums
  use sg_sweep_order, only: refill_order, sweep_order_t, update_order
  use sg_sweeps, only: sweep
  use sg_tables, only: per_contact, tables_t
  implicit none
  private
  public :: contact_sets_t, shared_set, inner_set

  !> The first two sets of a split: contacts of bodies with a mass that may be divided among copies, and those of no shared body
  integer, parameter :: shared_set = 1, inner_set = 2

  !> Contacts of one rank, set by set
  type :: contact_sets_t
    !> Number of sets, and the contacts of each in the order of its sweep
    integer :: n = 1
    type(sweep_order_t), allocatable :: order(:)
    !> Set of each contact where there are several; and the active set
    integer(i4), allocatable, private :: set_of(:)
    type(active_set_t) :: active_set
    !> Contacts of divided bodies, and their records with blocks for a part of the mass
    integer(i4), allocatable, private :: contact(:)
    real(wp), allocatable, private :: record(:, :)
    !> Slots of bodies on which other ranks act too, and clusters of others that are solved before the rest
    integer, allocatable, private :: shared(:)
    type(solved_clusters_t) :: clusters
    !> Momentum from sweep to sweep
    type(nesterov_t) :: nesterov
    !> Errors of contacts side by side
    type(order_errors_t) :: errors
    type(solver_options_t), private :: options
    !> Do the orders hold contacts of this problem yet? And if not, those of the problem before, which are the same?
    logical :: is_arranged = .false.
    logical, private :: holds_last = .false.
  contains
    procedure :: begin => sets_begin
    procedure :: split => sets_split
    procedure :: arrange => sets_arrange
    procedure :: measure => sets_measure
    procedure :: find_worst => sets_find_worst
    procedure :: choose => sets_choose
    procedure :: mark_hit => sets_mark_hit
    procedure :: go_on => sets_go_on
    procedure :: restore => sets_restore
    procedure :: sweep => sets_sweep
    procedure :: give_impulses => sets_give_impulses
    procedure :: take_rates => sets_take_rates
    procedure :: list_tables => sets_list_tables
    procedure :: list_split_tables => sets_list_split_tables
  end type contact_sets_t

contains

  !> Take all contacts of a problem in one set. Before the first sweep follows `arrange`, or `choose` where a guess determines the
  !! active set. Where the problem goes on from the last one, its order does too.
  subroutine sets_begin(self, problem, options)
    class(contact_sets_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! problem to sweep
    type(solver_options_t), intent(in) :: options !! order and threads of the sweeps

    self%holds_last = problem%is_continued .and. self%is_arranged .and. self%n == 1
    self%options = options
    self%n = 1
    self%shared = [integer ::]
    call self%clusters%begin()
    call self%active_set%begin(problem%n_contacts, self%holds_last)
    call self%errors%begin()
    self%is_arranged = .false.
  end subroutine sets_begin

  !> Split the contacts into several sets, before they are arranged.
  subroutine sets_split(self, problem, set_of, n, are_masses_divided, shared)
    class(contact_sets_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem; its shared bodies may have divided masses
    integer(i4), intent(in) :: set_of(:) !! set of each contact, from 1
    integer, intent(in) :: n !! number of sets
    logical, intent(in) :: are_masses_divided !! recompute the blocks of the first set
    integer, intent(in) :: shared(:) !! slots of bodies on which other ranks act too
    integer :: k

    self%n = n
    self%holds_last = .false.
    self%active_set%is_ordered = .false.
    self%set_of = set_of
    self%shared = shared
    self%contact = pack([(int(k, i4), k=1, size(set_of))], set_of == shared_set .and. are_masses_divided)
    if (allocated(self%record)) deallocate (self%record)
    allocate (self%record(size(problem%record, 1), size(self%contact)))
    do k = 1, size(self%contact)
      self%record(:, k) = problem%record(:, self%contact(k))
      call set_block(problem%kind, problem%body(:, problem%pair(1, self%contact(k))), &
                     problem%body(:, problem%pair(2, self%contact(k))), self%record(:, k))
    end do
  end subroutine sets_split

  !> Sum the errors of the contacts from their records in the order, where that can be.
  subroutine sets_measure(self, problem, with_e1, sums)
    class(contact_sets_t), intent(inout) :: self !! its errors are set, or not
    type(problem_t), intent(inout) :: problem !! its impulses are those of the order; comes back as it was
    logical, intent(in) :: with_e1 !! measure e1, and bounds, too?
    real(wp), intent(out) :: sums(n_error_sums) !! the sums, where errors are set

    self%errors%is_set = self%n == 1 .and. self%is_arranged .and. .not. self%clusters%are_sought
    if (self%errors%is_set) &
      call self%errors%measure(problem, self%order(1), self%active_set%is_ordered(:problem%n_contacts), with_e1, sums)
  end subroutine sets_measure

  !> Find the contact that breaks its law by the largest velocity, right after a test that has set errors.
  subroutine sets_find_worst(self, problem, contact, speed)
    class(contact_sets_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! comes back as it was
    integer, intent(out) :: contact !! number of that contact; zero where all obey
    real(wp), intent(out) :: speed !! its velocity [m/s]

    call self%errors%find_worst(problem, self%order(1), contact, speed)
  end subroutine sets_find_worst

  !> Copy the active contacts into the orders of their sets, or bring these up to date with the active set.
  subroutine sets_arrange(self, problem)
    class(contact_sets_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem with its present impulses; it comes back unchanged
    logical, allocatable :: is_ordered(:)
    integer :: s

    if (.not. self%is_arranged) call begin_orders(self, problem)
    associate (n => problem%n_contacts, active_set => self%active_set)
      if (self%n == 1) then
        call update_order(self%order(1), problem, active_set%is_wanted(:n), active_set%is_ordered(:n), self%options)
        return
      end if
      call swap_records(self, problem)
      do s = 1, self%n
        is_ordered = active_set%is_ordered(:n) .and. self%set_of == s
        call update_order(self%order(s), problem, active_set%is_wanted(:n) .and. self%set_of == s, is_ordered, self%options)
        where (self%set_of == s) active_set%is_ordered(:n) = is_ordered
      end do
      call swap_records(self, problem)
    end associate
  end subroutine sets_arrange

  !> One order per set, without contacts; the room of orders is kept. Or the order of the problem before, where that goes on.
  subroutine begin_orders(self, problem)
    class(contact_sets_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem

    self%is_arranged = .true.
    if (self%holds_last) then
      call refill_order(self%order(1), problem, self%holds_last)
      if (self%holds_last) return
      self%active_set%is_ordered = .false.
    end if
    if (allocated(self%order)) then
      if (size(self%order) /= self%n) deallocate (self%order)
    end if
    if (.not. allocated(self%order)) allocate (self%order(self%n))
    self%order%n = 0
  end subroutine begin_orders

  !> Exchange the records of contacts of divided bodies with those for whole masses.
  subroutine swap_records(self, problem)
    class(contact_sets_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    real(wp) :: record(size(problem%record, 1))
    integer :: i

    do i = 1, size(self%contact)
      record = problem%record(:, self%contact(i))
      problem%record(:, self%contact(i)) = self%record(:, i)
      self%record(:, i) = record
    end do
  end subroutine swap_records

  !> Choose the active set again, by the errors of the whole problem.
  subroutine sets_choose(self, problem, report, asked)
    class(contact_sets_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem with its present impulses, from which new orders take them, and velocities
    type(report_t), intent(in) :: report !! errors of the whole problem
    real(wp), intent(in) :: asked !! mean over all contacts of the squares that are asked for; not used unless clusters are sought
    logical :: goes_on

    goes_on = self%nesterov%is_on .and. self%is_arranged
    associate (n => problem%n_contacts, active_set => self%active_set)
      if (self%errors%is_set) then
        call self%errors%choose(self%order(1), active_set%is_ordered(:n), limit_of(report), active_set%is_wanted(:n))
      else
        call active_set%choose(n, report)
      end if
      if (goes_on) then
        call self%nesterov%carry(self%order, problem)
        call self%nesterov%keep_moving(active_set%is_wanted(:n))
      end if
      if (self%clusters%are_sought) then
        call self%clusters%leave_out(problem, report%sweeps, asked, active_set%is_wanted(:n), self%shared)
        self%clusters%are_sought = .false.
      end if
    end associate
    call self%arrange(problem)
    if (goes_on) call self%nesterov%resume(self%order, self%active_set%is_ordered(:problem%n_contacts), problem)
  end subroutine sets_choose

  !> Mark contacts of a single set that are not visited, and close or touch, right after errors are measured.
  pure subroutine sets_mark_hit(self, is_hit)
    class(contact_sets_t), intent(in) :: self !! arranged
    logical, intent(out), contiguous :: is_hit(:) !! the marks, shape (contacts)

    associate (n => size(is_hit), active_set => self%active_set)
      if (self%errors%is_set) then
        call self%errors%choose(self%order(1), active_set%is_ordered(:n), 0.0_wp, is_hit)
      else
        is_hit = active_set%closing(:n) <= 0
      end if
      is_hit = is_hit .and. .not. active_set%is_ordered(:n)
    end associate
  end subroutine sets_mark_hit

  !> Let impulses and velocities go on before the next round.
  subroutine sets_go_on(self, problem, is_sweep, comm)
    class(contact_sets_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! velocities change
    logical, intent(in) :: is_sweep !! is a round one sweep of the only set?
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%nesterov%go_on(self%order, problem, is_sweep, comm)
  end subroutine sets_go_on

  !> Take that back, with all sweeps since.
  subroutine sets_restore(self, problem)
    class(contact_sets_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! velocities change

    call self%nesterov%restore(self%order, problem)
  end subroutine sets_restore

  !> Update the contacts of a set once.
  subroutine sets_sweep(self, set, problem, relaxation, report)
    class(contact_sets_t), intent(inout) :: self
    integer, intent(in) :: set !! which one
    type(problem_t), intent(inout) :: problem !! velocities change
    real(wp), intent(in) :: relaxation !! share of each change taken
    type(report_t), intent(inout) :: report !! updates are counted

    if (self%nesterov%is_due) then
      call self%nesterov%sweep(self%order(set), problem)
    else
      call sweep(problem%kind, self%order(set), problem%n_bodies, relaxation, problem%body)
    end if
    report%contact_updates = report%contact_updates + int(self%order(set)%n, i8)
  end subroutine sets_sweep

  !> Copy impulses back to the problem, where sweeps have them.
  pure subroutine sets_give_impulses(self, problem)
    class(contact_sets_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! its impulses are set
    integer :: s

    if (.not. self%is_arranged) return
    do s = 1, self%n
      call give_impulses(self%order(s), problem)
    end do
  end subroutine sets_give_impulses

  !> Take the rates of a periodic cell into the biases of the problem and of all orders.
  pure subroutine sets_take_rates(self, rate, problem)
    class(contact_sets_t), intent(inout) :: self
    real(wp), intent(in) :: rate(4) !! the rates [1/s]
    type(problem_t), intent(inout) :: problem !! its records change
    integer :: s

    call record_rates(rate, problem)
    if (.not. self%is_arranged) return
    do s = 1, self%n
      call put_biases(self%order(s), problem)
    end do
  end subroutine sets_take_rates

  !> List the tables that every solve has: of all orders together, however many there are.
  subroutine sets_list_tables(self, tables)
    class(contact_sets_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to
    type(sweep_order_t) :: none
    integer :: s

    call list_order(none, tables)
    if (allocated(self%order)) then
      do s = 1, size(self%order)
        call list_order(self%order(s), tables)
      end do
    end if
    call self%active_set%list_tables(tables)
    call self%errors%list_tables(tables)
    call self%clusters%list_tables(tables)
    call self%nesterov%list_tables(tables)
  end subroutine sets_list_tables

  !> List the tables of contacts in several sets.
  subroutine sets_list_split_tables(self, tables)
    class(contact_sets_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('contact_sets', per_contact)
    call tables%note('set_of', self%set_of)
    call tables%note('contact', self%contact)
    call tables%note('record', self%record)
    call tables%note('shared', self%shared)
  end subroutine sets_list_split_tables
end module sg_contact_sets
