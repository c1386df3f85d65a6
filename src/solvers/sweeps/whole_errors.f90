!> Errors of the whole problem from those of the ranks: sums that travel while sweeps go on.
module sg_whole_errors
  use sg_comm, only: comm_t, sum_of_test
  use sg_contact_sets, only: contact_sets_t
  use sg_convergence, only: looks_at_errors, scales_of, scales_t
  use sg_extremes, only: are_finite
  use sg_increments, only: increment_value, increments_t, n_increment_maxima, n_increment_sums
  use sg_kinds, only: wp
  use sg_problem, only: problem_t
  use sg_report, only: ratio, report_t
  use sg_residuals, only: find_worst, n_error_sums, set_errors, sum_errors
  use sg_run_options, only: criterion_estimate, criterion_quad, solver_options_t
  use sg_order_tables, only: list_order
  use sg_sweep_order, only: set_order, sweep_order_t
  use sg_tables, only: per_contact, tables_t
  implicit none
  private
  public :: whole_errors_t

  !> Scales of a whole problem, and a sum that may be under way
  type :: whole_errors_t
    !> Contacts of all ranks
    integer :: contacts = 0
    !> Norm of q over all of them [m/s]
    real(wp), private :: free_norm = 0
    !> What convergence is judged by
    type(scales_t) :: scales
    !> Mean over all contacts of the squares that e8 is made of, at the last sum taken [N2 s2]
    real(wp) :: mean_square = 0
    !> Are impulses guessed, on any rank? Are all parts calm?
    logical :: is_guessed = .false., is_calm = .false.
    !> What is being summed: e1 too? And contacts of this rank that carry an impulse
    logical, private :: with_e1 = .false.
    integer, private :: active = 0
    !> Criterion that the solve ends by; one that looks at increments is summed too
    integer :: criterion = criterion_estimate
    real(wp) :: increments = 0
    type(increments_t), private :: asked
    type(sweep_order_t), private :: order
    real(wp), private :: maxima(n_increment_maxima) = 0
    !> Does the criterion need what the solve has changed impulses by? Then the impulses that it starts from, shape (components,
    !> contacts)
    logical :: with_change = .false.
    real(wp), allocatable, private :: start(:, :)
    !> Bounds of chunks of contacts from the last test that measured e1, by which `find_worst` looks at few of them; are they those
    !! of the last test of all?
    real(wp), allocatable, private :: bounds(:)
    logical, private :: has_bounds = .false.
  contains
    procedure :: prepare => errors_prepare
    procedure :: begin => errors_begin
    procedure :: finish => errors_finish
    procedure :: find_worst => errors_find_worst
    procedure :: list_tables => errors_list_tables
  end type whole_errors_t

contains

  !> Sum of the squares of what a solve has changed impulses by [N2 s2], where the estimate needs it.
  pure real(wp) function square_of_change(self, problem) result(square)
    type(whole_errors_t), intent(in) :: self
    type(problem_t), intent(in) :: problem
    integer :: k

    square = 0
    if (.not. self%with_change) return
    do k = 1, problem%n_contacts
      square = square + sum((problem%impulse(:, k) - self%start(:, k))**2)
    end do
  end function square_of_change

  !> Find the scales of a problem that is about to be solved. Collective.
  subroutine errors_prepare(self, problem, is_calm, comm)
    class(whole_errors_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! this rank's part, with free velocities
    logical, intent(in) :: is_calm !! is this part calm (sg_active_set)?
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp) :: sums(2), largest(5)

    self%scales = scales_of(problem)
    self%has_bounds = .false.
    if (self%with_change) self%start = problem%impulse(:, :problem%n_contacts)
    self%contacts = problem%n_contacts
    self%free_norm = problem%free_norm
    largest = [self%scales%fastest, 0.0_wp, self%scales%closing, self%scales%friction, merge(0.0_wp, 1.0_wp, is_calm)]
    if (any(abs(problem%impulse(:, :problem%n_contacts)) > 0)) largest(2) = 1
    if (comm%size > 1) then
      ! A count travels with reals where that saves a message per step.
      sums = [real(problem%n_contacts, wp), problem%free_norm**2]
      call comm%sum(sums)
      self%contacts = nint(sums(1))
      self%free_norm = sqrt(sums(2))
    end if
    call comm%maximum(largest)
    self%is_guessed = largest(2) > 0
    self%is_calm = .not. largest(5) > 0
    self%scales%contacts = self%contacts
    self%scales%fastest = largest(1)
    self%scales%velocity = problem%fall_speed
    if (.not. self%scales%velocity > 0) self%scales%velocity = self%free_norm/sqrt(real(max(1, self%contacts), wp))
    self%scales%closing = largest(3)
    self%scales%friction = largest(4)
  end subroutine errors_prepare

  !> Find the contact of all ranks that breaks its law by the largest velocity, right after a test. Collective.
  subroutine errors_find_worst(self, problem, sets, comm, report)
    class(whole_errors_t), intent(in) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part, its copies glued; comes back as it was
    type(contact_sets_t), intent(inout) :: sets !! its contacts
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(inout) :: report !! the velocity is set, and the contact where this rank has it, else 0
    real(wp) :: own

    if (self%has_bounds .and. sets%errors%is_set) then
      call sets%find_worst(problem, report%worst_contact, own)
    else if (self%has_bounds) then
      call find_worst(problem, report%worst_contact, own, self%bounds)
    else
      call find_worst(problem, report%worst_contact, own)
    end if
    report%worst_speed = own
    call comm%maximum(report%worst_speed)
    if (self%contacts == 0 .or. own < report%worst_speed) report%worst_contact = 0
  end subroutine errors_find_worst

  !> Begin to sum the errors of all ranks, and what the active set and clusters need of them.
  subroutine errors_begin(self, problem, with_e1, sets, comm)
    class(whole_errors_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part, its copies glued; comes back as it was
    logical, intent(in) :: with_e1 !! measure e1 and e2 too, and look for velocities that are not finite
    type(contact_sets_t), intent(inout) :: sets !! its contacts; closing speeds and, where sought, squares are set
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp) :: sums(n_error_sums + 2), increments(n_increment_sums)

    sums(n_error_sums + 1) = 0
    self%has_bounds = with_e1
    call sets%measure(problem, with_e1, sums(:n_error_sums))
    if (.not. sets%errors%is_set) call sum_one_by_one(self, problem, with_e1, sets, sums(:n_error_sums))
    ! A velocity that is not finite is one of its contacts, too; bodies without contacts keep their free velocities.
    if (with_e1) sums(n_error_sums + 1) = merge(0.0_wp, 1.0_wp, are_finite(n_error_sums, sums))
    sums(n_error_sums + 2) = square_of_change(self, problem)
    increments = 0
    if (.not. looks_at_errors(self%criterion)) call measure_increments(self, problem, sets, increments)
    self%with_e1 = with_e1
    self%active = nint(sums(6))
    call comm%begin_sum(sum_of_test, [sums, increments])
  end subroutine errors_begin

  !> Sum the errors of the contacts of this rank from the records of the problem.
  subroutine sum_one_by_one(self, problem, with_e1, sets, sums)
    class(whole_errors_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    logical, intent(in) :: with_e1
    type(contact_sets_t), intent(inout) :: sets
    real(wp), intent(out) :: sums(n_error_sums)

    call sets%active_set%reserve(problem%n_contacts)
    if (sets%clusters%are_sought) then
      call sum_errors(problem, with_e1, sums, sets%clusters%squares, sets%active_set%closing, self%bounds)
    else
      call sum_errors(problem, with_e1, sums, closing=sets%active_set%closing, bounds=self%bounds)
    end if
  end subroutine sum_one_by_one

  !> What all contacts of this rank ask, after their errors are measured: in the order of the sweep where there is one, with those
  !! that are not visited and are hit; else in their natural order.
  subroutine measure_increments(self, problem, sets, sums)
    class(whole_errors_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    type(contact_sets_t), intent(in) :: sets
    real(wp), intent(out) :: sums(n_increment_sums)
    real(wp) :: more(n_increment_sums), maxima(n_increment_maxima)
    logical :: is_wanted(problem%n_contacts)

    if (.not. (sets%n == 1 .and. sets%is_arranged)) then
      is_wanted = .true.
      call measure_marked(self, problem, is_wanted, sums, self%maxima)
      return
    end if
    call self%asked%measure(problem, sets%order(1), sums, self%maxima)
    call sets%mark_hit(is_wanted)
    if (.not. any(is_wanted)) return
    call measure_marked(self, problem, is_wanted, more, maxima)
    sums = sums + more
    self%maxima = max(self%maxima, maxima)
  end subroutine measure_increments

  !> The same for some contacts, in their natural order.
  subroutine measure_marked(self, problem, is_wanted, sums, maxima)
    class(whole_errors_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem
    logical, intent(in) :: is_wanted(:)
    real(wp), intent(out) :: sums(n_increment_sums), maxima(n_increment_maxima)
    type(solver_options_t) :: natural

    natural%order = 'natural'
    call set_order(self%order, problem, is_wanted, natural)
    call self%asked%measure(problem, self%order, sums, maxima)
  end subroutine measure_marked

  !> Take the errors of the whole problem from the sums that were begun.
  subroutine errors_finish(self, report, comm)
    class(whole_errors_t), intent(inout) :: self
    type(report_t), intent(inout) :: report !! errors of all ranks' contacts and active contacts of this one are set
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp) :: sums(n_error_sums + 2 + n_increment_sums)

    call comm%finish_sum(sum_of_test, sums)
    report%is_finite = .not. sums(n_error_sums + 1) > 0
    if (.not. looks_at_errors(self%criterion)) then
      if (self%criterion /= criterion_quad) call comm%maximum(self%maxima)
      self%increments = increment_value(self%criterion, sums(n_error_sums + 3:), self%maxima)
    end if
    call set_errors(sums(:n_error_sums), self%contacts, self%free_norm, self%scales%velocity, self%with_e1, report)
    report%change = 1
    if (self%with_change) report%change = min(1.0_wp, ratio(sqrt(sums(n_error_sums + 2)), sqrt(sums(4))))
    self%mean_square = sums(2)/real(max(1, self%contacts), wp)
    report%active_contacts = self%active
  end subroutine errors_finish

  !> List the tables of the estimate and of criteria that look at increments; those of an order of its own are listed with the
  !! others.
  subroutine errors_list_tables(self, tables)
    class(whole_errors_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('errors', per_contact)
    call tables%note('start', self%start)
    call tables%note('bounds', self%bounds)
    call list_order(self%order, tables)
    call self%asked%list_tables(tables)
  end subroutine errors_list_tables
end module sg_whole_errors
