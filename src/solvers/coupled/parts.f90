!> A rank's contacts in several parts, each in an order of its own: those of shared bodies, swept before messages leave;
!! those of its own bodies, swept while they travel; those on edges between subdomains.
module sg_parts
  use sg_active_set, only: active_set_t
  use sg_delassus, only: set_block
  use sg_kinds, only: wp, i4, i8
  use sg_problem, only: problem_t
  use sg_report, only: report_t
  use sg_run_options, only: solver_options_t
  use sg_solved_clusters, only: solved_clusters_t
  use sg_sweep_order, only: give_impulses, list_order, set_order, sweep_order_t, update_order
  use sg_sweeps, only: sweep
  use sg_tables, only: per_contact, tables_t
  implicit none
  private
  public :: parts_t, part_shared, part_own

  !> The first two parts: contacts of bodies whose mass may be divided among copies, and those of no shared body
  integer, parameter :: part_shared = 1, part_own = 2

  !> Contacts of one rank, part by part
  type :: parts_t
    !> Contacts of each part in the order of its sweep
    type(sweep_order_t), allocatable, private :: order(:)
    !> Part of each contact, and the active set
    integer(i4), allocatable, private :: part(:)
    type(active_set_t) :: active_set
    !> Contacts of divided bodies, and their records with blocks for a part of the mass
    integer(i4), allocatable, private :: contact(:)
    real(wp), allocatable, private :: record(:, :)
    !> Slots of bodies on which other ranks act too, and clusters of others that are solved before the rest
    integer, allocatable, private :: shared(:)
    type(solved_clusters_t) :: clusters
    type(solver_options_t), private :: options
    !> Do the orders hold contacts of this problem yet?
    logical, private :: is_arranged = .false.
  contains
    procedure :: begin => parts_begin
    procedure :: arrange => parts_arrange
    procedure :: choose => parts_choose
    procedure :: sweep => parts_sweep
    procedure :: give_impulses => parts_give_impulses
    procedure :: list_tables => parts_list_tables
  end type parts_t

contains

  !> Take the parts of a problem. Before the first sweep follows `arrange`, or `choose` where a guess determines the active set.
  subroutine parts_begin(self, problem, part, n_parts, are_masses_divided, shared, options)
    class(parts_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem whose shared bodies may have divided masses
    integer(i4), intent(in) :: part(:) !! of each contact, from 1
    integer, intent(in) :: n_parts !! number of parts
    logical, intent(in) :: are_masses_divided !! recompute the blocks of the first part
    integer, intent(in) :: shared(:) !! slots of bodies on which other ranks act too
    type(solver_options_t), intent(in) :: options !! order and threads of the sweeps
    integer :: k

    self%options = options
    self%shared = shared
    call self%clusters%begin()
    if (allocated(self%order)) then
      if (size(self%order) /= n_parts) deallocate (self%order)
    end if
    if (.not. allocated(self%order)) allocate (self%order(n_parts))
    if (allocated(self%record)) deallocate (self%record)
    self%part = part
    call self%active_set%begin(size(part))
    self%contact = pack([(int(k, i4), k=1, size(part))], part == part_shared .and. are_masses_divided)
    allocate (self%record(size(problem%record, 1), size(self%contact)))
    do k = 1, size(self%contact)
      self%record(:, k) = problem%record(:, self%contact(k))
      call set_block(problem%kind, problem%body(:, problem%pair(1, self%contact(k))), &
                     problem%body(:, problem%pair(2, self%contact(k))), self%record(:, k))
    end do
    self%is_arranged = .false.
  end subroutine parts_begin

  !> Copy the contacts to visit into the orders of their parts.
  subroutine parts_arrange(self, problem)
    class(parts_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem whose present impulses are taken; it comes back as it was
    integer :: p

    call swap_records(self, problem)
    do p = 1, size(self%order)
      call set_order(self%order(p), problem, self%active_set%is_ordered(:problem%n_contacts) .and. self%part == p, self%options)
    end do
    call swap_records(self, problem)
    self%is_arranged = .true.
  end subroutine parts_arrange

  !> Exchange the records of contacts of divided bodies with those for whole masses.
  subroutine swap_records(self, problem)
    class(parts_t), intent(inout) :: self
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
  subroutine parts_choose(self, problem, report, asked)
    class(parts_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! problem with its present impulses, from which new orders take them, and velocities
    type(report_t), intent(in) :: report !! errors of the whole problem
    real(wp), intent(in) :: asked !! mean over all contacts of the squares that are asked for; not used unless clusters are sought
    logical, allocatable :: is_ordered(:)
    integer :: p

    associate (n => problem%n_contacts, active_set => self%active_set)
      call active_set%choose(n, report, problem%velocity_scale)
      if (self%clusters%are_sought) then
        call self%clusters%leave_out(problem, report%sweeps, asked, active_set%is_wanted(:n), self%shared)
        self%clusters%are_sought = .false.
      end if
      if (.not. self%is_arranged) then
        active_set%is_ordered(:n) = active_set%is_wanted(:n)
        call self%arrange(problem)
        return
      end if
      call swap_records(self, problem)
      do p = 1, size(self%order)
        is_ordered = active_set%is_ordered(:n) .and. self%part == p
        call update_order(self%order(p), problem, active_set%is_wanted(:n) .and. self%part == p, is_ordered, self%options)
        where (self%part == p) active_set%is_ordered(:n) = is_ordered
      end do
      call swap_records(self, problem)
    end associate
  end subroutine parts_choose

  !> Update the contacts of a part once.
  subroutine parts_sweep(self, part, problem, relaxation, report)
    class(parts_t), intent(inout) :: self
    integer, intent(in) :: part !! which one
    type(problem_t), intent(inout) :: problem !! velocities change
    real(wp), intent(in) :: relaxation !! share of each change taken
    type(report_t), intent(inout) :: report !! updates are counted

    call sweep(problem%kind, self%order(part), problem%n_bodies, relaxation, problem%body)
    report%contact_updates = report%contact_updates + int(self%order(part)%n, i8)
  end subroutine parts_sweep

  !> Copy impulses back to the problem, where sweeps have them.
  pure subroutine parts_give_impulses(self, problem)
    class(parts_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! its impulses are set
    integer :: p

    if (.not. self%is_arranged) return
    do p = 1, size(self%order)
      call give_impulses(self%order(p), problem)
    end do
  end subroutine parts_give_impulses

  !> List the tables of all parts together, however many there are.
  subroutine parts_list_tables(self, tables)
    class(parts_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to
    type(sweep_order_t) :: none
    integer :: p

    call list_order(none, tables)
    if (allocated(self%order)) then
      do p = 1, size(self%order)
        call list_order(self%order(p), tables)
      end do
    end if
    call tables%begin('parts', per_contact)
    call tables%note('part', self%part)
    call tables%note('contact', self%contact)
    call tables%note('record', self%record)
    call tables%note('shared', self%shared)
    call self%active_set%list_tables(tables)
    call self%clusters%list_tables(tables)
  end subroutine parts_list_tables
end module sg_parts
