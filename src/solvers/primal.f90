!> The primal method: grains are distributed; contacts between the grains of two ranks are the (n+1)-th subdomain
!! (doc/theory/decomposition.md).
!!
!! Step 1 sweeps the contacts within each part, all parts at once and each as often as the deck says; step 2 sweeps the
!! contacts between parts, edge by edge in the order of their colours. Both are plain Gauss-Seidel with whole masses, only
!! the order is another one. Walls that impulses can move are held by all ranks, their mass divided among them.
module sg_primal
  use sg_comm, only: comm_t
  use sg_compact, only: add_impulses
  use sg_convergence, only: convergence_t
  use sg_delassus, only: share_mass
  use sg_edges, only: edges_t
  use sg_glued_solver, only: glued_solver_t
  use sg_home_sum, only: copy_from_home
  use sg_kinds, only: wp, i4
  use sg_parts, only: part_own, part_shared, parts_t
  use sg_problem, only: bytes_per_contact, first_inverse, problem_t
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e1, criterion_e2
  use sg_sharing, only: sharing_t
  use sg_subdomain, only: subdomain_t
  use sg_timers, only: cpu_now
  use sg_whole_errors, only: whole_errors_t
  implicit none
  private
  public :: primal_t

  !> The primal method
  type, extends(glued_solver_t) :: primal_t
    type(sharing_t), private :: sharing
    type(edges_t), private :: edges
    !> Contacts within this rank, and those of each edge that it owns
    type(parts_t), private :: parts
    type(convergence_t), private :: convergence
    type(whole_errors_t), private :: errors
  contains
    procedure :: solve => primal_solve
  end type primal_t

contains

  !> Solve a problem by sweeps within parts and between them.
  subroutine primal_solve(self, problem, subdomain, slot_of, comm, report)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's contacts, its bodies and the copies that they touch
    type(subdomain_t), intent(in) :: subdomain !! who shares which body
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(out) :: report !! effort and errors
    real(wp), allocatable :: whole(:, :)
    real(wp) :: start

    report%bytes_per_contact = bytes_per_contact(problem)
    call self%errors%prepare(problem, comm)
    if (self%errors%contacts == 0) return
    start = cpu_now()
    if (.not. self%options%warm_start) problem%impulse = 0
    report%is_converged = .false.
    call open_solve(self, problem, subdomain, slot_of, comm, whole)
    do while (report%sweeps < self%options%maximum_sweeps .and. .not. report%is_converged)
      call rounds_until_test(self, problem, comm, report)
      call test(self, problem, comm, report)
    end do
    problem%body(first_inverse(problem%kind):, self%sharing%wide%slot) = whole(first_inverse(problem%kind):, :)
    call self%errors%measure(problem, report, comm)
    call tell_result(problem, subdomain, slot_of, comm)
    report%cpu_seconds = cpu_now() - start
  end subroutine primal_solve

  !> Find edges and walls that move, divide the mass of these, and let the guess act.
  subroutine open_solve(self, problem, subdomain, slot_of, comm, whole)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(subdomain_t), intent(in) :: subdomain
    integer(i4), intent(in) :: slot_of(:)
    type(comm_t), intent(inout) :: comm
    real(wp), allocatable, intent(out) :: whole(:, :) !! records of wide bodies with their whole masses
    real(wp), allocatable :: before(:, :)
    integer :: i, width

    width = first_inverse(problem%kind) - 1
    call self%sharing%find(problem, subdomain, slot_of, comm)
    call self%edges%prepare(problem, subdomain, slot_of, self%sharing, comm)
    allocate (whole(size(problem%body, 1), size(self%sharing%wide%slot)))
    do i = 1, size(self%sharing%wide%slot)
      whole(:, i) = problem%body(:, self%sharing%wide%slot(i))
      call share_mass(problem%kind, max(1, self%sharing%wide%parts(i)), problem%body(:, self%sharing%wide%slot(i)))
    end do
    allocate (before(width, size(self%edges%borrowed)))
    before(:, :) = problem%body(:width, self%edges%borrowed)
    call add_impulses(problem)
    call self%edges%return_changes(before, problem, comm)
    call self%sharing%wide%glue(problem, .true., comm)
    call self%parts%begin(problem, parts_of(self, problem), part_own + size(subdomain%neighbour), .true., self%options)
    call self%convergence%begin(self%errors%fastest)
  end subroutine open_solve

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

  !> Sweep within parts, then on edges, colour by colour, as often as fits between two tests.
  subroutine rounds_until_test(self, problem, comm, report)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report
    integer :: i, c, limit

    limit = min(report%sweeps + self%options%check_every, self%options%maximum_sweeps)
    do while (report%sweeps < limit)
      do i = 1, self%partition%sweeps_of(comm%rank)
        call self%parts%sweep(part_shared, problem, self%options%relaxation, report)
        call self%parts%sweep(part_own, problem, self%options%relaxation, report)
      end do
      call self%sharing%wide%glue(problem, .true., comm)
      do c = 1, self%edges%n_colours
        call sweep_edge(self, c, problem, comm, report)
      end do
      report%sweeps = report%sweeps + self%partition%most_sweeps()
      report%gluings = report%gluings + 1
    end do
    call self%parts%give_impulses(problem)
    call self%edges%lend_all(problem, comm)
  end subroutine rounds_until_test

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
    call self%edges%lend_colour(c, problem, comm)
    if (self%edges%borrowed_first(i + 1) > self%edges%borrowed_first(i)) then
      do j = 1, self%partition%interface_sweeps
        call self%parts%sweep(part_own + i, problem, self%options%relaxation, report)
      end do
    end if
    call self%edges%return_colour(c, problem, comm)
  end subroutine sweep_edge

  !> Measure the errors of the whole problem, judge them, and choose anew whom to visit when it is time.
  subroutine test(self, problem, comm, report)
    class(primal_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report

    call self%errors%begin(problem, any(self%options%criterion == [criterion_e1, criterion_e2]), comm)
    call self%errors%finish(report, comm)
    call self%convergence%judge(self%options, self%errors%velocity_scale, report, 0.0_wp)
    if (self%convergence%is_choice_due) call self%parts%choose(problem, report)
  end subroutine test

  !> Give the velocities found to all copies: those of a grain stand at its home.
  subroutine tell_result(problem, subdomain, slot_of, comm)
    type(problem_t), intent(inout) :: problem
    type(subdomain_t), intent(in) :: subdomain
    integer(i4), intent(in) :: slot_of(:)
    type(comm_t), intent(inout) :: comm
    real(wp), allocatable :: velocity(:, :)
    integer :: width

    width = first_inverse(problem%kind) - 1
    allocate (velocity(width, size(slot_of)))
    velocity(:, :) = problem%body(:width, slot_of)
    call copy_from_home(subdomain, comm, velocity)
    problem%body(:width, slot_of(subdomain%body)) = velocity(:, subdomain%body)
  end subroutine tell_result
end module sg_primal
