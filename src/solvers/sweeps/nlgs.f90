!> Nonlinear Gauss-Seidel: the loop of all solvers that sweep, and the method of one rank (doc/theory/nlgs.md).
!!
!! Rounds of sweeps go on until the errors of the whole problem are small enough. Errors are always those of all contacts; sweeps
!! visit the active set, chosen again as errors fall. A coupled method (src/solvers/coupled) extends this type and replaces its
!! hooks: how a solve is opened, what a round is, what a test needs before it, how copies get the result.
module sg_nlgs
  use sg_comm, only: comm_t, traffic_t
  use sg_compact, only: add_impulses
  use sg_contact_sets, only: contact_sets_t
  use sg_convergence, only: convergence_t, looks_at_errors
  use sg_kinds, only: wp
  use sg_problem, only: bytes_per_contact, problem_t
  use sg_relax_cell, only: ask_rates, relax_cell
  use sg_report, only: report_t
  use sg_run_options, only: criterion_e1, criterion_e2, criterion_estimate, solver_options_t
  use sg_solver, only: solver_t
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: tables_t
  use sg_trace, only: point_of, trace_t
  use sg_whole_errors, only: whole_errors_t
  implicit none
  private
  public :: nlgs_t

  !> A test is likely to be the last one when the criterion of the one before is below so many tolerances
  real(wp), parameter :: likely_last = 3
  !> Least share of its relaxation that a method is damped to
  real(wp), parameter :: least_damping = 1.0_wp/16

  !> The Gauss-Seidel solver
  type, extends(solver_t) :: nlgs_t
    !> Options of the deck
    type(solver_options_t) :: options
    !> Do sweeps take momentum (doc/theory/nesterov.md)?
    logical :: has_momentum = .false.
    !> Contacts of this rank, set by set
    type(contact_sets_t) :: sets
    !> Do other ranks act on bodies of this one? Then sums of a test travel while the next round begins
    logical :: is_coupled = .false.
    !> Sweeps that a round counts as, and most updates of a contact in it
    integer :: sweeps_per_round = 1, most_updates = 1
    !> Share of its relaxation that a method takes which may diverge: halved where the error does not fall
    real(wp) :: damping = 1
    !> Errors of the whole problem, and the tests of this solve
    type(whole_errors_t) :: errors
    type(convergence_t), private :: convergence
    !> Is e1 of the last test measured? And e8 squares at the last test judged [N2 s2]
    logical, private :: has_e1 = .false.
    real(wp), private :: mean_square = 0
    !> History of the errors of this solve, and CPU seconds at the end of the last phase
    type(trace_t), private :: trace
    real(wp), private :: now = 0
    !> Messages of this rank before this solve
    type(traffic_t), private :: earlier
  contains
    procedure :: solve_coupled => nlgs_solve
    procedure :: list_tables => nlgs_list_tables
    procedure :: open => nlgs_open
    procedure :: mark => nlgs_mark
    procedure :: begin_round => nlgs_begin_round
    procedure :: finish_round => nlgs_finish_round
    procedure :: collect => nlgs_collect
    procedure :: close => nlgs_close
    procedure :: prepare_errors => nlgs_prepare_errors
    procedure :: note => nlgs_note
    procedure :: list_shared => nlgs_list_shared
  end type nlgs_t

contains

  !> Solve a problem by rounds of sweeps. Collective.
  subroutine nlgs_solve(self, problem, coupling, comm, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! contacts of this rank, its bodies and the copies that they touch
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(out) :: report !! effort and errors

    report%bytes_per_contact = bytes_per_contact(problem)
    if (comm%size == 1 .and. problem%n_contacts == 0) return
    call self%trace%begin(self%with_trace)
    self%earlier = comm%traffic
    if (.not. self%options%warm_start) problem%impulse = 0
    ! A relaxed sweep would leave outside of its cone what momentum takes there.
    if (self%has_momentum) self%options%relaxation = 1
    self%damping = 1
    call self%sets%begin(problem, self%options)
    call self%sets%nesterov%begin(self%has_momentum)
    call self%open(problem, coupling, comm)
    if (problem%cell%is_on) call open_cell(self, problem, comm)
    call self%prepare_errors(problem, comm)
    if (self%errors%contacts == 0) return
    call find_free(self, problem, comm, report)
    if (.not. report%is_converged) call choose_first(self, problem, comm, report)
    call self%convergence%begin(self%options, self%sets%nesterov%is_on .and. .not. self%errors%is_guessed, self%errors%scales)
    self%now = self%trace%seconds()
    do while (.not. report%is_converged)
      call iterate(self, problem, comm, report)
      call confirm(self, problem, comm, report)
      if (report%sweeps >= self%options%maximum_sweeps) exit
    end do
    call self%sets%nesterov%finish(comm)
    if (problem%cell%is_on) problem%cell%rate = problem%cell%recorded
    if (.not. report%is_converged) call self%errors%find_worst(problem, self%sets, comm, report)
    call self%convergence%finish(report)
    call self%close(problem, coupling, comm)
    call lap(self, report%cpu_checks)
    report%cpu_seconds = self%now
    call count_messages(self, comm, report)
    call self%trace%finish(report%sweeps, report)
  end subroutine nlgs_solve

  !> Prepare the errors that the criterion asks for, after the coupling has opened: one that takes no momentum is judged by plain
  !! sweeps, whatever the method.
  subroutine nlgs_prepare_errors(self, problem, comm)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! this rank's part, opened
    type(comm_t), intent(inout) :: comm !! the ranks

    self%errors%criterion = self%options%criterion
    self%errors%with_change = self%sets%nesterov%is_on .and. self%options%criterion == criterion_estimate
    call self%sets%active_set%look(problem)
    call self%errors%prepare(problem, self%sets%active_set%is_calm, comm)
  end subroutine nlgs_prepare_errors

  !> Is the problem solved without impulses? Where none are guessed and no contact closes, one test finds out, and no sweep is
  !! needed.
  subroutine find_free(self, problem, comm, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report

    report%is_converged = .false.
    if (self%errors%is_guessed .or. self%errors%scales%closing > 0) return
    call gather(self, problem, comm)
    call self%errors%begin(problem, .true., self%sets, comm)
    call self%errors%finish(report, comm)
    report%is_converged = report%violation <= 0
  end subroutine find_free

  !> Begin with all contacts; or, where impulses are guessed, without those that stay open: in a calm problem by what opens without
  !! impulses, else by a test. Later tests bring back contacts that were missed. Criteria that look at increments begin with all,
  !! as LMGC90 does.
  subroutine choose_first(self, problem, comm, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report

    if (self%trace%is_on) call self%note(problem, comm, report)
    if (.not. (self%errors%is_guessed .and. looks_at_errors(self%options%criterion))) then
      call self%sets%active_set%want_all(problem%n_contacts)
    else if (self%errors%is_calm .and. .not. problem%cell%is_on) then
      call self%sets%active_set%choose_by_guess(problem)
    else
      call gather(self, problem, comm)
      call self%errors%begin(problem, .false., self%sets, comm)
      call self%errors%finish(report, comm)
      call self%sets%choose(problem, report, 0.0_wp)
      return
    end if
    call self%sets%arrange(problem)
  end subroutine choose_first

  !> Rounds until the criterion holds. Where ranks share the problem, the sums of a test travel while the next round begins, which
  !! is cut short if the test passes; and a choice of the active set follows the test after the one that asks for it.
  subroutine iterate(self, problem, comm, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report
    logical :: is_tested

    is_tested = .false.
    do while (report%sweeps < self%options%maximum_sweeps)
      if (.not. self%is_coupled) call choose_again(self, problem, report)
      if (self%sets%nesterov%is_on) then
        call self%sets%go_on(problem, .not. self%is_coupled, comm)
        if (self%sets%nesterov%has_stepped) call self%mark(problem)
      end if
      if (problem%cell%is_on) call self%sets%take_rates(problem%cell%rate, problem)
      call self%begin_round(problem, report)
      if (is_tested) then
        call finish_test(self, comm, report)
        call judge_fall(self, report)
        if (report%is_converged .and. self%sets%nesterov%has_stepped) then
          call self%sets%restore(problem)
          call self%mark(problem)
          return
        end if
      end if
      call self%finish_round(problem, report%is_converged, comm, report)
      if (report%is_converged) return
      if (problem%cell%is_on) call follow(self, problem, comm)
      report%sweeps = report%sweeps + self%sweeps_per_round
      if (self%is_coupled) report%gluings = report%gluings + 1
      if (self%trace%is_due(report%sweeps)) call self%note(problem, comm, report)
      is_tested = report%sweeps >= self%convergence%next_test .or. &
                  merge(self%convergence%is_choice_due, report%sweeps >= self%options%maximum_sweeps, self%is_coupled)
      if (.not. is_tested) cycle
      call begin_test(self, problem, comm, report)
      if (self%is_coupled) then
        call choose_again(self, problem, report)
      else
        call finish_test(self, comm, report)
        if (self%sets%nesterov%is_on) call judge_fall(self, report)
        is_tested = .false.
        if (report%is_converged) return
      end if
    end do
    if (is_tested) call finish_test(self, comm, report)
  end subroutine iterate

  !> Give a cell the rates that the guess asks for, and the share of later changes that converges, with momentum too
  !! (doc/theory/periodic_cell.md).
  subroutine open_cell(self, problem, comm)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm

    problem%cell%share = 1/(1 + real(self%most_updates, wp)*problem%cell%bound)
    call ask_rates(problem, comm, problem%cell%rate)
  end subroutine open_cell

  !> Let the rates of a cell follow the impulses of a round.
  subroutine follow(self, problem, comm)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm

    call self%sets%give_impulses(problem)
    call relax_cell(problem, comm)
  end subroutine follow

  !> Collect impulses and velocities in the problem; a test sees the rates of a cell that these impulses ask for.
  subroutine gather(self, problem, comm)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm
    real(wp) :: asked(4)

    call self%collect(problem, comm)
    if (.not. problem%cell%is_on) return
    call ask_rates(problem, comm, asked)
    call self%sets%take_rates(asked, problem)
  end subroutine gather

  !> Damp a method that may diverge, and pause momentum, where the error does not fall.
  subroutine judge_fall(self, report)
    class(nlgs_t), intent(inout) :: self
    type(report_t), intent(in) :: report
    logical :: is_stuck

    call self%convergence%find_stuck(self%options, report%sweeps, is_stuck)
    if (.not. is_stuck) return
    self%damping = max(least_damping, self%damping/2)
    call self%sets%nesterov%rest()
  end subroutine judge_fall

  !> Begin to sum the errors of all ranks.
  subroutine begin_test(self, problem, comm, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report

    call lap(self, report%cpu_sweeps)
    self%has_e1 = any(self%options%criterion == [criterion_e1, criterion_e2])
    ! e1 is measured with the others where this may be the last test: measuring all once more would cost far more.
    if (.not. self%is_coupled) self%has_e1 = self%has_e1 .or. report%sweeps >= self%options%maximum_sweeps .or. &
                                             report%checks == 0 .or. report%criterion <= likely_last*self%options%tolerance
    ! Rates of a cell couple all clusters.
    if ((self%convergence%is_choice_due .or. .not. self%is_coupled) .and. .not. problem%cell%is_on) &
      call self%sets%clusters%prepare(problem, self%options, report%sweeps)
    call gather(self, problem, comm)
    call self%errors%begin(problem, self%has_e1, self%sets, comm)
    call lap(self, report%cpu_checks)
  end subroutine begin_test

  !> Take the errors of the whole problem from the sums under way, and judge them.
  subroutine finish_test(self, comm, report)
    class(nlgs_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report

    call lap(self, report%cpu_sweeps)
    call self%errors%finish(report, comm)
    self%mean_square = self%errors%mean_square
    call self%convergence%judge(self%options, real(self%sweeps_per_round, wp)*self%sets%nesterov%rule%gain, report, &
                                self%errors%increments)
    call lap(self, report%cpu_checks)
  end subroutine finish_test

  !> Choose the active set again where that is due, by errors, criterion and squares of the test that asked for it.
  subroutine choose_again(self, problem, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(report_t), intent(inout) :: report

    if (.not. self%convergence%is_choice_due) return
    if (self%convergence%is_contested) self%sets%clusters%are_sought = .false.
    call self%sets%choose(problem, report, self%convergence%asked(self%options, report)**2*self%mean_square)
    self%convergence%is_choice_due = .false.
    call lap(self, report%cpu_checks)
  end subroutine choose_again

  !> Judge what is about to be handed over. Coupled rounds have changed it since the last test: the one cut short, too.
  subroutine confirm(self, problem, comm, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem
    type(comm_t), intent(inout) :: comm
    type(report_t), intent(inout) :: report

    if (self%is_coupled .or. .not. self%has_e1) then
      call gather(self, problem, comm)
      call self%errors%begin(problem, .true., self%sets, comm)
      if (self%is_coupled) call finish_test(self, comm, report)
      if (.not. self%is_coupled) call self%errors%finish(report, comm)
    end if
    if (.not. self%convergence%must_look(report)) return
    call self%errors%find_worst(problem, self%sets, comm, report)
    call self%convergence%confirm(report%worst_speed, report)
  end subroutine confirm

  !> Measure the errors of the whole problem for the history; what is sent for it does not count. Collective.
  subroutine nlgs_note(self, problem, comm, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part, opened
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(in) :: report !! sweeps and contact updates so far
    type(report_t) :: here
    type(traffic_t) :: before
    real(wp), allocatable :: impulse(:, :)

    call self%trace%pause()
    before = comm%traffic
    ! A test may drop small remains of a guess.
    allocate (impulse, source=problem%impulse)
    call gather(self, problem, comm)
    call self%errors%begin(problem, .true., self%sets, comm)
    call self%errors%finish(here, comm)
    here%contact_updates = report%contact_updates
    call move_alloc(impulse, problem%impulse)
    comm%traffic = before
    call count_messages(self, comm, here)
    call self%trace%add(point_of(report%sweeps, here))
  end subroutine nlgs_note

  !> Count what this rank has sent since the solve began.
  pure subroutine count_messages(self, comm, report)
    class(nlgs_t), intent(in) :: self
    type(comm_t), intent(in) :: comm
    type(report_t), intent(inout) :: report

    report%messages = comm%traffic%messages - self%earlier%messages
    report%bytes = comm%traffic%bytes - self%earlier%bytes
    report%collectives = comm%traffic%collectives - self%earlier%collectives
  end subroutine count_messages

  !> Add the CPU time since the last lap to a phase. Asking for the time costs as much as a small sweep: once per phase is enough.
  subroutine lap(self, phase)
    class(nlgs_t), intent(inout) :: self
    real(wp), intent(inout) :: phase
    real(wp) :: before

    before = self%now
    self%now = self%trace%seconds()
    phase = phase + self%now - before
  end subroutine lap

  !> Let the guess act.
  subroutine nlgs_open(self, problem, coupling, comm)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! guess and free velocities; then the velocities under the guess
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot: none
    type(comm_t), intent(inout) :: comm !! the ranks

    call add_impulses(problem)
  end subroutine nlgs_open

  !> Take the present velocities of copies for those that a round starts from: there are none.
  subroutine nlgs_mark(self, problem)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(in) :: problem !! this rank's part
  end subroutine nlgs_mark

  !> Sweep contacts of shared bodies, the first part of a round: there are none.
  subroutine nlgs_begin_round(self, problem, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(report_t), intent(inout) :: report !! contact updates are counted
  end subroutine nlgs_begin_round

  !> Sweep once.
  subroutine nlgs_finish_round(self, problem, is_cut, comm, report)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    logical, intent(in) :: is_cut !! only glue what has been swept, since the test has passed
    type(comm_t), intent(inout) :: comm !! the ranks
    type(report_t), intent(inout) :: report !! contact updates are counted

    if (.not. is_cut) call self%sets%sweep(1, problem, self%options%relaxation, report)
  end subroutine nlgs_finish_round

  !> Collect impulses and velocities in the problem, where those of a round may lie in orders and copies.
  subroutine nlgs_collect(self, problem, comm)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(comm_t), intent(inout) :: comm !! the ranks

    call self%sets%give_impulses(problem)
  end subroutine nlgs_collect

  !> Give the velocities found to all copies: there are none.
  subroutine nlgs_close(self, problem, coupling, comm)
    class(nlgs_t), intent(inout) :: self
    type(problem_t), intent(inout) :: problem !! this rank's part
    type(subdomain_t), intent(in) :: coupling !! bodies shared with other ranks, numbered by slot
    type(comm_t), intent(inout) :: comm !! the ranks
  end subroutine nlgs_close

  !> List the tables that are kept from one problem to the next: the same ones on all ranks.
  subroutine nlgs_list_tables(self, tables)
    class(nlgs_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call self%sets%list_tables(tables)
    call self%errors%list_tables(tables)
    call self%list_shared(tables)
  end subroutine nlgs_list_tables

  !> List the tables of what the method shares with other ranks: none.
  subroutine nlgs_list_shared(self, tables)
    class(nlgs_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to
  end subroutine nlgs_list_shared
end module sg_nlgs
