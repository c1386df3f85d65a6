!> Traces of a run: errors against CPU time within chosen steps (trace.csv), and what these steps reached and cost by phase
!! (trace_steps.csv, and a table at the end of the run).
module sg_run_trace
  use sg_columns, only: fixed, right
  use sg_comm, only: comm_t
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_report, only: report_t, trace_point_t
  use sg_step_csv, only: cell, resume_rows
  use sg_text, only: to_text
  use sg_text_files, only: append_text, replace_file
  use sg_totals, only: n_phases, phase_names, reduce_report, totals_t
  use sg_trace_csv, only: point_cells, point_names
  implicit none
  private
  public :: run_trace_t, traced_steps, trace_file, steps_file

  !> Steps that are traced where the deck names none
  integer, parameter :: some = 8
  !> Phases with less than this share of the CPU time have no column in the table
  real(wp), parameter :: least_share = 0.01_wp
  !> Names of the columns of what ranks have sent, after those of a point
  character(len=*), parameter :: message_names = ',messages,bytes,collectives'
  !> Names of the files in the folder of the results
  character(len=*), parameter :: trace_file = 'trace.csv', steps_file = 'trace_steps.csv'

  !> One traced step
  type :: traced_step_t
    !> Number of the step, contacts and sweeps; its errors, and its CPU seconds by phase, of all ranks
    integer :: step = 0, contacts = 0, sweeps = 0
    real(wp) :: e1 = 0, e2 = 0, e8 = 0, phase(n_phases) = 0
  end type traced_step_t

  !> The traces of a run
  type :: run_trace_t
    !> Is any step traced? Does this rank write? Of ranks that share a run one alone does
    logical :: is_on = .false., is_root = .true.
    !> Steps to trace, and those that this run has traced
    integer, allocatable, private :: steps(:)
    type(traced_step_t), allocatable, private :: traced(:)
    !> Folder of the results, and CPU seconds by phase before the step
    character(len=:), allocatable, private :: folder
    real(wp), private :: before(n_phases) = 0
  contains
    procedure :: open => trace_open
    procedure :: wants => trace_wants
    procedure :: begin_step => trace_begin_step
    procedure :: end_step => trace_end_step
    procedure :: has_rows => trace_has_rows
    procedure :: table => trace_table
  end type run_trace_t

contains

  !> Open the files for steps to trace.
  subroutine trace_open(self, folder, steps, done, error)
    class(run_trace_t), intent(inout) :: self
    character(len=*), intent(in) :: folder !! of the results
    integer, intent(in) :: steps(:) !! to trace
    integer, intent(in) :: done !! step from which the run goes on, whose files stay; 0 where it begins
    type(error_t), allocatable, intent(out) :: error !! set when they cannot be written

    self%is_on = .true.
    self%folder = folder
    self%steps = steps
    allocate (self%traced(0))
    if (.not. self%is_root) return
    call open_file(folder//'/'//trace_file, 'step,time,'//point_names//message_names, done, error)
    if (.not. allocated(error)) call open_file(folder//'/'//steps_file, step_names(), done, error)
  end subroutine trace_open

  !> Begin a file, or go on with it.
  subroutine open_file(file, names, done, error)
    character(len=*), intent(in) :: file, names
    integer, intent(in) :: done
    type(error_t), allocatable, intent(out) :: error

    if (done > 0) then
      call resume_rows(file, names, done, error)
    else
      call replace_file(file, names//new_line('a'), error)
    end if
  end subroutine open_file

  !> The steps to trace: those asked for, or some, evenly spread up to the last.
  pure function traced_steps(asked, steps) result(list)
    integer, allocatable, intent(in) :: asked(:) !! by the deck
    integer, intent(in) :: steps !! of the run
    integer, allocatable :: list(:)
    integer :: i, n

    if (allocated(asked)) then
      list = asked
    else
      n = min(some, steps)
      list = [(nint(real(i, wp)*real(steps, wp)/real(n, wp)), i=1, n)]
    end if
  end function traced_steps

  !> Is a step to be traced?
  pure logical function trace_wants(self, step) result(wants)
    class(run_trace_t), intent(in) :: self
    integer, intent(in) :: step !! number of the step

    wants = .false.
    if (self%is_on) wants = any(self%steps == step)
  end function trace_wants

  !> Remember what phases had taken before a step that is traced.
  pure subroutine trace_begin_step(self, totals)
    class(run_trace_t), intent(inout) :: self
    type(totals_t), intent(in) :: totals !! since the start

    self%before = totals%phase%cpu
  end subroutine trace_begin_step

  !> Write what a traced step did. Collective.
  subroutine trace_end_step(self, step, time, contacts, solved, totals, comm, error)
    class(run_trace_t), intent(inout) :: self
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: time !! its end [s]
    integer, intent(in) :: contacts !! of all ranks
    type(report_t), intent(in) :: solved !! report of the solver, with a history unless there was no contact
    type(totals_t), intent(in) :: totals !! since the start, of this rank
    type(comm_t), intent(inout) :: comm !! the ranks
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when a file cannot be written
    type(report_t) :: report
    type(traced_step_t) :: row
    character(len=:), allocatable :: points
    integer :: i

    report = solved
    call reduce_report(report, comm)
    row = traced_step_t(step, contacts, report%sweeps, report%e1, report%e2, report%e8, totals%phase%cpu - self%before)
    call comm%sum(row%phase)
    self%traced = [self%traced, row]
    if (self%is_root) then
      points = ''
      if (allocated(report%trace)) then
        do i = 1, size(report%trace)
          points = points//to_text(step)//','//cell(time)//','//point_cells(report%trace(i))// &
                   message_cells(report%trace(i))//new_line('a')
        end do
      end if
      call append_text(self%folder//'/'//trace_file, points, error)
      if (.not. allocated(error)) call append_text(self%folder//'/'//steps_file, step_cells(row, time, report), error)
    end if
    call comm%agree(error)
  end subroutine trace_end_step

  !> What all ranks had sent at a point, as cells of a row.
  pure function message_cells(point) result(text)
    type(trace_point_t), intent(in) :: point
    character(len=:), allocatable :: text

    text = ','//to_text(point%messages)//','//to_text(point%bytes)//','//to_text(point%collectives)
  end function message_cells

  !> Names of the columns of traced steps.
  pure function step_names() result(names)
    character(len=:), allocatable :: names
    integer :: i

    names = 'step,time,contacts,active_contacts,sweeps,contact_updates,converged,criterion,e1,e2,e8,cpu_seconds'
    do i = 1, n_phases
      names = names//',cpu_'//trim(phase_names(i))
    end do
  end function step_names

  !> A traced step as a row.
  pure function step_cells(row, time, report) result(text)
    type(traced_step_t), intent(in) :: row
    real(wp), intent(in) :: time
    type(report_t), intent(in) :: report
    character(len=:), allocatable :: text
    integer :: i

    text = to_text(row%step)//','//cell(time)//','//to_text(row%contacts)//','//to_text(report%active_contacts)//','// &
           to_text(row%sweeps)//','//to_text(report%contact_updates)//','//merge('1', '0', report%is_converged)//','// &
           cell(report%criterion)//','//cell(row%e1)//','//cell(row%e2)//','//cell(row%e8)//','//cell(sum(row%phase))
    do i = 1, n_phases
      text = text//','//cell(row%phase(i))
    end do
    text = text//new_line('a')
  end function step_cells

  !> Has a step been traced?
  pure logical function trace_has_rows(self) result(has_rows)
    class(run_trace_t), intent(in) :: self

    has_rows = .false.
    if (allocated(self%traced)) has_rows = size(self%traced) > 0
  end function trace_has_rows

  !> The table at the end: traced steps and the whole run, errors reached, and CPU seconds by phase; empty without traces.
  pure function trace_table(self, totals) result(text)
    class(run_trace_t), intent(in) :: self
    type(totals_t), intent(in) :: totals !! of the run and of all ranks
    character(len=:), allocatable :: text
    logical :: is_shown(n_phases)
    integer :: i

    text = ''
    if (.not. self%is_on) return
    is_shown = totals%phase%cpu >= least_share*totals%clock%cpu
    text = 'traced steps: errors reached, and CPU seconds by phase'//new_line('a')// &
           right('step', 9)//right('contacts', 10)//right('sweeps', 9)//right('e1', 9)//right('e2', 9)//right('e8', 9)
    do i = 1, n_phases
      if (is_shown(i)) text = text//right(trim(phase_names(i)), 9)
    end do
    text = text//right('all', 9)
    do i = 1, size(self%traced)
      associate (row => self%traced(i))
        text = text//new_line('a')//right(to_text(row%step), 9)//right(to_text(row%contacts), 10)// &
               right(to_text(row%sweeps), 9)//errors_text(row%e1, row%e2, row%e8)//phases_text(row%phase, is_shown)// &
               right(seconds(sum(row%phase)), 9)
      end associate
    end do
    if (totals%steps == 0) return
    text = text//new_line('a')//right('1 to '//to_text(totals%steps), 9)//right('<= '//to_text(totals%most_contacts), 10)// &
           right(to_text(totals%sweeps), 9)//errors_text(totals%worst_e1, totals%worst_e2, totals%worst_e8)// &
           phases_text(totals%phase%cpu, is_shown)//right(seconds(totals%clock%cpu), 9)//new_line('a')// &
           '  the last line: the largest errors, the sums of sweeps and seconds; histories of errors in '//trace_file// &
           ', measuring them counts as measure'
  end function trace_table

  !> Errors as columns.
  pure function errors_text(e1, e2, e8) result(text)
    real(wp), intent(in) :: e1, e2, e8
    character(len=:), allocatable :: text

    text = right(to_text(e1, 2), 9)//right(to_text(e2, 2), 9)//right(to_text(e8, 2), 9)
  end function errors_text

  !> CPU seconds of the phases shown.
  pure function phases_text(phase, is_shown) result(text)
    real(wp), intent(in) :: phase(n_phases)
    logical, intent(in) :: is_shown(n_phases)
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, n_phases
      if (is_shown(i)) text = text//right(seconds(phase(i)), 9)
    end do
  end function phases_text

  !> Seconds in a few digits.
  pure function seconds(value) result(word)
    real(wp), intent(in) :: value
    character(len=:), allocatable :: word
    character(len=16) :: buffer

    if (value >= 100) then
      word = fixed(value, 1)
    else if (value >= 1e-3_wp) then
      word = fixed(value, 4)
    else
      write (buffer, '(es16.1)') value
      word = trim(adjustl(buffer))
    end if
  end function seconds
end module sg_run_trace
