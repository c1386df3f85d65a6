!> Sweeps of all ranks over their own contacts, glued after each round: what the dual method and the exchange of momentum
!! share (doc/theory/decomposition.md).
module sg_shared_sweeps
  use sg_comm, only: comm_t
  use sg_compact, only: add_impulses
  use sg_convergence, only: convergence_t
  use sg_delassus, only: share_mass
  use sg_glued_solver, only: glued_solver_t
  use sg_gluing, only: gluing_t
  use sg_kinds, only: wp, i4
  use sg_parts, only: part_own, part_shared, parts_t
  use sg_problem, only: bytes_per_contact, problem_t
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e1, criterion_e2
  use sg_subdomain, only: subdomain_t
  use sg_timers, only: cpu_now
  use sg_whole_errors, only: whole_errors_t
  implicit none
  private
  public :: shared_sweeps_t

  !> A solver that sweeps and glues
  type, abstract, extends(glued_solver_t) :: shared_sweeps_t
    !> Gluing of the last solve
    type(gluing_t) :: gluing
    type(parts_t), private :: parts
    type(convergence_t), private :: convergence
    type(whole_errors_t), private :: errors
  contains
    procedure :: solve => shared_solve
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

  !> Solve a problem by sweeps and gluings.
  subroutine shared_solve(self, problem, subdomain, slot_of, comm, report)
    class(shared_sweeps_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's contacts, its bodies and the copies that they touch
    type(subdomain_t), intent(in) :: subdomain !! who shares which body
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(out) :: report !! effort and errors
    real(wp), allocatable :: whole(:, :)
    real(wp) :: start, relaxation
    logical :: is_mean

    report%bytes_per_contact = bytes_per_contact(problem)
    call self%errors%prepare(problem, comm)
    if (self%errors%contacts == 0) return
    start = cpu_now()
    if (.not. self%options%warm_start) problem%impulse = 0
    report%is_converged = .false.
    call self%rule(is_mean, relaxation)
    call open_solve(self, problem, subdomain, slot_of, is_mean, comm, whole)
    call rounds(self, problem, relaxation, comm, report)
    if (relaxation < 1) call drop_traces(problem%n_contacts, problem%impulse)
    call restore_masses(self, whole, problem)
    call self%errors%measure(problem, report, comm)
    call self%gluing%sharing%tell_result(problem, comm)
    report%cpu_seconds = cpu_now() - start
  end subroutine shared_solve

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

  !> Find the shared bodies, divide their masses, and let the guess act.
  subroutine open_solve(self, problem, subdomain, slot_of, is_mean, comm, whole)
    class(shared_sweeps_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(subdomain_t), intent(in) :: subdomain
    integer(i4), intent(in) :: slot_of(:)
    logical, intent(in) :: is_mean
    type(comm_t), intent(inout) :: comm
    real(wp), allocatable, intent(out) :: whole(:, :) !! records of shared bodies with their whole masses
    logical :: is_shared(problem%n_bodies)
    integer, allocatable :: slot(:), parts(:)
    integer :: i

    call self%gluing%prepare(problem, subdomain, slot_of, is_mean, comm)
    associate (sharing => self%gluing%sharing)
      slot = [sharing%slot, sharing%wide%slot]
      parts = [sharing%parts, sharing%wide%parts]
    end associate
    allocate (whole(size(problem%body, 1), size(slot)))
    is_shared = .false.
    do i = 1, size(slot)
      whole(:, i) = problem%body(:, slot(i))
      is_shared(slot(i)) = .true.
      if (is_mean) call share_mass(problem%kind, max(1, parts(i)), problem%body(:, slot(i)))
    end do
    call add_impulses(problem)
    call self%gluing%begin(problem, comm)
    call self%parts%begin(problem, parts_of(problem, is_shared), 2, is_mean, self%options)
    call self%gluing%finish(problem, comm)
    call self%convergence%begin(self%errors%fastest)
  end subroutine open_solve

  !> Part of each contact: does it touch a shared body?
  pure function parts_of(problem, is_shared) result(part)
    type(problem_t), intent(in) :: problem
    logical, intent(in) :: is_shared(:) !! by slot
    integer(i4) :: part(problem%n_contacts)
    integer :: k

    do k = 1, problem%n_contacts
      part(k) = part_own
      if (is_shared(problem%pair(1, k)) .or. is_shared(problem%pair(2, k))) part(k) = part_shared
    end do
  end function parts_of

  !> Give shared bodies their whole masses again.
  pure subroutine restore_masses(self, whole, problem)
    class(shared_sweeps_t), intent(in) :: self
    real(wp), intent(in) :: whole(:, :)
    type(problem_t), intent(inout) :: problem
    integer, allocatable :: slot(:)
    integer :: i, width

    slot = [self%gluing%sharing%slot, self%gluing%sharing%wide%slot]
    width = size(self%gluing%before, 1)
    do i = 1, size(slot)
      problem%body(width + 1:, slot(i)) = whole(width + 1:, i)
    end do
  end subroutine restore_masses

  !> Rounds of sweeps and gluings until the criterion holds. The sum of a test travels while the next round is swept.
  subroutine rounds(self, problem, relaxation, comm, report)
    class(shared_sweeps_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    real(wp), intent(in) :: relaxation !! of contacts of shared bodies
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report
    logical :: is_tested
    integer :: since_test

    is_tested = .false.
    since_test = 0
    do while (report%sweeps < self%options%maximum_sweeps)
      call one_round(self, problem, relaxation, comm, report)
      if (is_tested) then
        call self%errors%finish(report, comm)
        is_tested = .false.
        call self%convergence%judge(self%options, self%errors%velocity_scale, report, 0.0_wp)
        if (report%is_converged) exit
        if (self%convergence%is_choice_due) call self%parts%choose(problem, report)
      end if
      since_test = since_test + self%partition%most_sweeps()
      if (since_test < self%options%check_every) cycle
      since_test = 0
      call self%parts%give_impulses(problem)
      call self%errors%begin(problem, any(self%options%criterion == [criterion_e1, criterion_e2]), comm)
      is_tested = .true.
    end do
    if (is_tested) then
      call self%errors%finish(report, comm)
      call self%convergence%judge(self%options, self%errors%velocity_scale, report, 0.0_wp)
    end if
    call self%parts%give_impulses(problem)
  end subroutine rounds

  !> Sweep, and glue. Contacts of shared bodies come first, so that their messages travel while the others are swept.
  subroutine one_round(self, problem, relaxation, comm, report)
    class(shared_sweeps_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    real(wp), intent(in) :: relaxation
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report
    integer :: i, sweeps

    sweeps = self%partition%sweeps_of(comm%rank)
    do i = 1, sweeps
      call self%parts%sweep(part_shared, problem, relaxation, report)
      if (i == sweeps) call self%gluing%begin(problem, comm)
      call self%parts%sweep(part_own, problem, self%options%relaxation, report)
    end do
    call self%gluing%finish(problem, comm)
    report%sweeps = report%sweeps + self%partition%most_sweeps()
    report%gluings = report%gluings + 1
  end subroutine one_round
end module sg_shared_sweeps
