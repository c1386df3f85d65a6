!> Report of a solver on one contact problem: effort, and errors of the whole problem.
module sg_report
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use sg_kinds, only: wp, i8
  use sg_timers, only: timer_t
  implicit none
  private
  public :: report_t, coupled_effort_t, trace_point_t, add_effort, add_substep, ratio, unsolved, worse

  !> One point of the history of a solve: what had been done, and how far the answer was
  type :: trace_point_t
    !> Iterations or sweeps done, contact updates, and CPU seconds since the start, those of measuring these points left out
    integer :: iteration = 0
    integer(i8) :: contact_updates = 0
    real(wp) :: cpu_seconds = 0
    !> Errors of the whole problem there
    real(wp) :: e1 = 0, e2 = 0, e8 = 0
    !> Messages to single ranks, their bytes, and collective operations since the start, likewise
    integer(i8) :: messages = 0, bytes = 0, collectives = 0
  end type trace_point_t

  !> Report of one solve
  type :: report_t
    !> Has the stopping criterion reached its tolerance?
    logical :: is_converged = .true.
    !> Are all velocities of the solution finite, on all ranks?
    logical :: is_finite = .true.
    !> Sweeps over all contacts, and single contact updates
    integer :: sweeps = 0
    integer(i8) :: contact_updates = 0
    !> Times that the parts of a decomposed problem were glued
    integer :: gluings = 0
    !> Messages to single ranks, their bytes, and collective operations
    integer(i8) :: messages = 0, bytes = 0, collectives = 0
    !> Iterations of solvers that do not only sweep, and factorisations of their matrices
    integer :: iterations = 0, factorisations = 0
    !> Of a coupled method that goes on without them: matrices of this rank that have no factor, and interface systems whose
    !! conjugate gradients do not converge
    integer :: failed_factors = 0, failed_systems = 0
    !> Tests of the criterion
    integer :: checks = 0
    !> Last value of the stopping criterion
    real(wp) :: criterion = 0
    !> Errors of the solution (doc/theory/errors.md): natural map over |q|, over the largest term, scaled one over |r|,
    !! and rms velocity error over g h
    real(wp) :: e1 = 0, e2 = 0, e8 = 0, violation = 0
    !> What the violation is relative to [m/s]
    real(wp) :: velocity_scale = 0
    !> What sweeps with momentum have changed the impulses by, over them, at most 1
    real(wp) :: change = 0
    !> Estimated relative error of the impulses, from e8 and the rate at which it fell
    real(wp) :: estimate = 0
    !> Where not converged: velocity by which the worst contact of all breaks its law [m/s], and its number where this rank has it
    real(wp) :: worst_speed = 0
    integer :: worst_contact = 0
    !> Number of contacts that carry an impulse
    integer :: active_contacts = 0
    !> CPU seconds of the whole solve; in sweeps (or iterations), and in tests
    real(wp) :: cpu_seconds = 0, cpu_sweeps = 0, cpu_checks = 0
    !> History of errors, where asked for, and what measuring it took, which no other number holds
    type(trace_point_t), allocatable :: trace(:)
    type(timer_t) :: apart
    !> Bytes that the problem holds per contact
    real(wp) :: bytes_per_contact = 0
  end type report_t

  !> Effort of this rank in all coupled solves of a run: the counts of their reports
  type :: coupled_effort_t
    integer(i8) :: solves = 0, gluings = 0, contact_updates = 0, iterations = 0, factorisations = 0, failed_factors = 0, &
                   failed_systems = 0
  contains
    procedure :: add => effort_add
  end type coupled_effort_t

contains

  !> Add the counts of a solve.
  pure subroutine effort_add(self, report)
    class(coupled_effort_t), intent(inout) :: self
    type(report_t), intent(in) :: report !! of this rank

    self%solves = self%solves + 1
    self%gluings = self%gluings + int(report%gluings, i8)
    self%contact_updates = self%contact_updates + report%contact_updates
    self%iterations = self%iterations + int(report%iterations, i8)
    self%factorisations = self%factorisations + int(report%factorisations, i8)
    self%failed_factors = self%failed_factors + int(report%failed_factors, i8)
    self%failed_systems = self%failed_systems + int(report%failed_systems, i8)
  end subroutine effort_add

  !> Report for an unsolved problem: zero effort, errors not a number.
  pure function unsolved() result(report)
    type(report_t) :: report

    report%is_converged = .false.
    report%is_finite = .false.
    report%e1 = ieee_value(report%e1, ieee_quiet_nan)
    report%e2 = report%e1
    report%e8 = report%e1
    report%violation = report%e1
    report%criterion = report%e1
    report%estimate = report%e1
  end function unsolved

  !> Add the effort of earlier solves of a step to the report of the last one.
  pure subroutine add_effort(before, report)
    type(report_t), intent(in) :: before !! of the solves before
    type(report_t), intent(inout) :: report !! of the last solve

    report%sweeps = report%sweeps + before%sweeps
    report%contact_updates = report%contact_updates + before%contact_updates
    report%gluings = report%gluings + before%gluings
    report%iterations = report%iterations + before%iterations
    report%factorisations = report%factorisations + before%factorisations
    report%failed_factors = report%failed_factors + before%failed_factors
    report%failed_systems = report%failed_systems + before%failed_systems
    report%checks = report%checks + before%checks
    report%cpu_sweeps = report%cpu_sweeps + before%cpu_sweeps
    report%cpu_checks = report%cpu_checks + before%cpu_checks
    report%cpu_seconds = report%cpu_seconds + before%cpu_seconds
  end subroutine add_effort

  !> Make the report of the last substep that of all so far: its own contacts, the effort of all, and the worst errors of any.
  pure subroutine add_substep(before, report)
    type(report_t), intent(in) :: before !! of the substeps before
    type(report_t), intent(inout) :: report !! of the last substep

    call add_effort(before, report)
    report%messages = report%messages + before%messages
    report%bytes = report%bytes + before%bytes
    report%collectives = report%collectives + before%collectives
    report%is_converged = report%is_converged .and. before%is_converged
    report%criterion = worse(before%criterion, report%criterion)
    report%e1 = worse(before%e1, report%e1)
    report%e2 = worse(before%e2, report%e2)
    report%e8 = worse(before%e8, report%e8)
    report%violation = worse(before%violation, report%violation)
    report%change = worse(before%change, report%change)
    report%estimate = worse(before%estimate, report%estimate)
  end subroutine add_substep

  !> The larger of two errors; one that is not a number is the worst and stays.
  pure real(wp) function worse(so_far, new)
    real(wp), intent(in) :: so_far !! an error
    real(wp), intent(in) :: new !! another one

    worse = so_far
    if (ieee_is_nan(so_far)) return
    if (ieee_is_nan(new)) then
      worse = new
    else
      worse = max(so_far, new)
    end if
  end function worse

  !> A ratio of norms, as errors are; 0 where both vanish, 1 where only the scale does.
  pure real(wp) function ratio(norm, scale)
    real(wp), intent(in) :: norm !! of what is wrong
    real(wp), intent(in) :: scale !! of what it is compared with

    if (scale > 0) then
      ratio = norm/scale
    else
      ratio = merge(1.0_wp, 0.0_wp, norm > 0)
    end if
  end function ratio
end module sg_report
