!> How far a solve has come: the best answer so far, its error on the whole problem, effort, history, and when to stop.
module sg_block_progress
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_block_map, only: natural_map
  use sg_kinds, only: wp, i8
  use sg_matrix_errors, only: errors_of, find_worst_contact, matrix_errors_t, most_share
  use sg_matrix_problem, only: matrix_problem_t
  use sg_matrix_solver, only: matrix_options_t
  use sg_report, only: report_t, trace_point_t
  use sg_sparse, only: multiply
  use sg_trace, only: trace_t
  implicit none
  private
  public :: progress_t

  !> One solve under way
  type :: progress_t
    type(matrix_options_t) :: options
    !> Effort so far; sweeps and Newton steps both count as iterations
    integer :: sweeps = 0, iterations = 0, factorisations = 0, checks = 0
    !> Effort so far, in operations of a sweep that take as long; that of a sweep; and that at which the turn of a method ends
    real(wp) :: operations = 0, sweep_operations = 0, turn_end = huge(1.0_wp)
    !> e1 of the answer looked at last, of the best, and of the best since the turn began
    real(wp) :: e1 = huge(1.0_wp), best = huge(1.0_wp), turn_e1 = huge(1.0_wp)
    !> Is the best answer good enough; and is that, or the time or effort allowed, a reason to stop?
    logical :: is_converged = .false., is_over = .false.
    !> The best answer [N s], shape (d, n)
    real(wp), allocatable :: answer(:, :)
    real(wp), private :: q_norm = 0
    real(wp), allocatable, private :: r(:, :), u(:, :), f(:, :)
    type(trace_t), private :: trace
  contains
    procedure :: begin => progress_begin
    procedure :: look => progress_look
    procedure :: is_late => progress_is_late
    procedure :: count_sweeps => progress_count_sweeps
    procedure :: count_factorisation => progress_count_factorisation
    procedure :: begin_turn => progress_begin_turn
    procedure :: must_yield => progress_must_yield
    procedure :: finish => progress_finish
  end type progress_t

contains

  !> Start the clock, and look at the guess, which is put into the problem.
  subroutine progress_begin(self, problem, options)
    class(progress_t), intent(inout) :: self
    type(matrix_problem_t), intent(inout) :: problem !! problem; its impulses become those to start from
    type(matrix_options_t), intent(in) :: options !! when to stop

    call self%trace%begin(options%with_trace)
    self%options = options
    self%q_norm = sqrt(sum(problem%q**2))
    allocate (self%r(problem%d, problem%n), self%u(problem%d, problem%n), self%f(problem%d, problem%n))
    ! A local problem takes as long as so many operations in its row of W (doc/verification_solvers.md).
    self%sweep_operations = 2*real(problem%d**2, wp)*real(size(problem%w%column), wp) + 260*real(problem%n, wp)
    if (.not. options%warm_start .or. .not. self%q_norm > 0) problem%r = 0
    allocate (self%answer, source=problem%r)
    call self%look(problem, problem%r)
  end subroutine progress_begin

  !> Measure an answer, keep it when it is the best, and see whether to stop.
  subroutine progress_look(self, problem, r, scale)
    class(progress_t), intent(inout) :: self
    type(matrix_problem_t), intent(in) :: problem !! problem to solve
    real(wp), intent(in), contiguous :: r(:, :) !! answer, shape (d, n)
    real(wp), intent(in), contiguous, optional :: scale(:) !! impulse [N s] that 1 stands for, shape (n)
    real(wp) :: norm, goal
    integer :: a

    self%r = r
    if (present(scale)) then
      do a = 1, problem%n
        self%r(:, a) = scale(a)*r(:, a)
      end do
    end if
    call multiply(problem%w, self%r, self%u)
    self%u = self%u + problem%q
    call natural_map(problem%friction, 1.0_wp, self%r, self%u, self%f)
    norm = sqrt(sum(self%f**2))
    self%checks = self%checks + 1
    self%operations = self%operations + self%sweep_operations
    self%e1 = huge(norm)
    if (ieee_is_finite(norm)) then
      if (self%q_norm > 0) norm = norm/self%q_norm
      self%e1 = norm
      self%turn_e1 = min(self%turn_e1, norm)
      if (norm < self%best) then
        self%best = norm
        self%answer = self%r
      end if
    end if
    ! The margin covers other orders of summation: whoever measures again finds no more than the tolerance.
    goal = self%options%tolerance*(1 - 1e-6_wp)
    if (self%e1 <= goal .and. self%options%with_contacts) then
      self%is_converged = obey_all(problem, self%r)
      if (self%is_converged) self%answer = self%r
    else
      self%is_converged = self%best <= goal .and. .not. self%options%with_contacts
    end if
    self%is_over = self%is_converged .or. self%iterations >= self%options%maximum_iterations
    if (.not. self%is_over) self%is_over = self%is_late()
    if (self%trace%is_on) call add_to_trace(self, problem)
  end subroutine progress_look

  !> Count sweeps, and what is done beside them.
  pure subroutine progress_count_sweeps(self, sweeps, others)
    class(progress_t), intent(inout) :: self
    integer, intent(in) :: sweeps !! sweeps made
    real(wp), intent(in), optional :: others !! operations beside them

    self%sweeps = self%sweeps + sweeps
    self%iterations = self%iterations + sweeps
    self%operations = self%operations + real(sweeps, wp)*self%sweep_operations
    if (present(others)) self%operations = self%operations + others
  end subroutine progress_count_sweeps

  !> Count an iteration with a factorisation, and what was done beside it in times of a sweep.
  pure subroutine progress_count_factorisation(self, operations, sweeps)
    class(progress_t), intent(inout) :: self
    real(wp), intent(in) :: operations !! of analysis, factors and solutions
    integer, intent(in) :: sweeps !! times of a sweep beside them

    self%factorisations = self%factorisations + 1
    self%iterations = self%iterations + 1
    self%operations = self%operations + operations + real(sweeps, wp)*self%sweep_operations
  end subroutine progress_count_factorisation

  !> Begin the turn of a method.
  pure subroutine progress_begin_turn(self, operations)
    class(progress_t), intent(inout) :: self
    real(wp), intent(in) :: operations !! after which it ends

    self%turn_end = self%operations + operations
    self%turn_e1 = huge(self%turn_e1)
  end subroutine progress_begin_turn

  !> Is the solve over, or the turn?
  pure logical function progress_must_yield(self) result(must_yield)
    class(progress_t), intent(in) :: self

    must_yield = self%is_over .or. self%operations >= self%turn_end
  end function progress_must_yield

  !> Does every contact do what acts on it, by itself?
  pure logical function obey_all(problem, r)
    type(matrix_problem_t), intent(in) :: problem
    real(wp), intent(in), contiguous :: r(:, :)
    real(wp) :: share
    integer :: contact

    call find_worst_contact(problem, r, contact, share)
    obey_all = share <= most_share
  end function obey_all

  !> Is the time up? For loops that are long without a look.
  logical function progress_is_late(self) result(is_late)
    class(progress_t), intent(in) :: self

    is_late = self%trace%seconds() >= self%options%maximum_seconds
  end function progress_is_late

  !> Note the errors of the answer looked at.
  subroutine add_to_trace(self, problem)
    type(progress_t), intent(inout) :: self
    type(matrix_problem_t), intent(in) :: problem
    type(matrix_errors_t) :: errors

    if (.not. self%e1 < huge(self%e1)) return
    call self%trace%pause()
    errors = errors_of(problem, self%r)
    call self%trace%add(trace_point_t(self%iterations, int(self%sweeps, i8)*int(problem%n, i8), 0.0_wp, errors%e1, errors%e2, &
                                      errors%e8))
  end subroutine add_to_trace

  !> Put the best answer into the problem; report its errors and its cost.
  subroutine progress_finish(self, problem, report)
    class(progress_t), intent(inout) :: self
    type(matrix_problem_t), intent(inout) :: problem !! gets the answer
    type(report_t), intent(inout) :: report !! effort and errors
    type(matrix_errors_t) :: errors

    problem%r = self%answer
    report%cpu_seconds = self%trace%seconds()
    errors = errors_of(problem, problem%r)
    report%e1 = errors%e1
    report%e2 = errors%e2
    report%e8 = errors%e8
    report%criterion = errors%e1
    report%is_converged = errors%e1 <= self%options%tolerance
    if (report%is_converged .and. self%options%with_contacts) report%is_converged = obey_all(problem, problem%r)
    report%sweeps = self%sweeps
    report%iterations = self%iterations
    report%factorisations = self%factorisations
    report%checks = self%checks
    report%contact_updates = int(self%sweeps, i8)*int(problem%n, i8)
    if (problem%n > 0) report%active_contacts = count(problem%r(1, :) > 0)
    call self%trace%finish(report%iterations, report)
  end subroutine progress_finish
end module sg_block_progress
