!> record.csv: one row per recorded step, named columns, SI units (doc/guide/results.md lists them).
module sg_record
  use sg_error, only: error_t
  use sg_kinds, only: wp, i8
  use sg_measures, only: measures_t
  use sg_report, only: report_t
  use sg_step_csv, only: cell
  use sg_step_file, only: step_file_t
  use sg_tally, only: column_t
  use sg_text, only: to_text
  use sg_text_files, only: append_text
  use sg_totals, only: n_phases, phase_names, totals_t
  implicit none
  private
  public :: record_t, record_columns

  !> The record of a run
  type, extends(step_file_t) :: record_t
  contains
    procedure :: start => record_start
    procedure :: resume => record_resume
    procedure :: add => record_add
  end type record_t

contains

  !> Begin a new record; an older one is replaced.
  subroutine record_start(self, file, measures, error)
    class(record_t), intent(inout) :: self
    character(len=*), intent(in) :: file !! path of the record
    type(measures_t), intent(in) :: measures !! indicators of the run, measured or not
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written

    call self%begin(file, header(measures, self%has_stages), -1, error)
  end subroutine record_start

  !> Go on with the record of a run that restarts after a step: rows of later steps, and a torn last row, are cut.
  subroutine record_resume(self, file, measures, step, error)
    class(record_t), intent(inout) :: self
    character(len=*), intent(in) :: file !! path of the record
    type(measures_t), intent(in) :: measures !! indicators of the run, measured or not
    integer, intent(in) :: step !! step of the checkpoint
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be read or written, or has other columns

    call self%begin(file, header(measures, self%has_stages), step, error)
  end subroutine record_resume

  !> The names of the columns.
  pure function header(measures, has_stages) result(names)
    type(measures_t), intent(in) :: measures
    logical, intent(in) :: has_stages
    character(len=:), allocatable :: names
    type(column_t), allocatable :: columns(:)
    type(report_t) :: report
    type(totals_t) :: totals
    integer :: i

    columns = record_columns(0, 0.0_wp, 0, report, totals, measures, merge(1, 0, has_stages))
    names = trim(columns(1)%name)
    do i = 2, size(columns)
      names = names//','//trim(columns(i)%name)
    end do
  end function header

  !> All columns of a step: names and values, in the order of the record.
  pure function record_columns(step, time, contacts, report, totals, measures, stage) result(columns)
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: time !! end of the step [s]
    integer, intent(in) :: contacts !! number of contacts
    type(report_t), intent(in) :: report !! report of the solver on the step
    type(totals_t), intent(in) :: totals !! timers since the start
    type(measures_t), intent(in) :: measures !! indicators of the step
    integer, intent(in), optional :: stage !! number of the stage; without it, or where it is 0, there is no such column
    type(column_t), allocatable :: columns(:)
    integer :: i

    columns = [count_of('step', step), value_of('time', time), count_of('contacts', contacts), &
               count_of('active_contacts', report%active_contacts), count_of('sweeps', report%sweeps), &
               column_t('contact_updates', real(report%contact_updates, wp), .true.), &
               count_of('converged', merge(1, 0, report%is_converged)), value_of('criterion', report%criterion), &
               value_of('e1', report%e1), value_of('e2', report%e2), value_of('e8', report%e8), &
               value_of('violation', report%violation), value_of('cpu_seconds', totals%clock%cpu), &
               value_of('wall_seconds', totals%clock%wall), &
               (value_of('cpu_'//phase_names(i), totals%phase(i)%cpu), i=1, n_phases), measures%column, &
               (value_of('wall_'//phase_names(i), totals%phase(i)%wall), i=1, n_phases)]
    if (.not. present(stage)) return
    if (stage > 0) columns = [columns(:2), count_of('stage', stage), columns(3:)]
  end function record_columns

  !> A column of a whole number.
  pure function count_of(name, number) result(column)
    character(len=*), intent(in) :: name
    integer, intent(in) :: number
    type(column_t) :: column

    column = column_t(name, real(number, wp), .true.)
  end function count_of

  !> A column of a real.
  pure function value_of(name, value) result(column)
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: value
    type(column_t) :: column

    column = column_t(name, value)
  end function value_of

  !> Add the row of a step.
  subroutine record_add(self, columns, error)
    class(record_t), intent(in) :: self
    type(column_t), intent(in) :: columns(:) !! of `record_columns`
    type(error_t), allocatable, intent(out) :: error !! set when the row cannot be written
    character(len=:), allocatable :: row
    integer :: i

    if (.not. self%is_root) return
    row = ''
    do i = 1, size(columns)
      if (i > 1) row = row//','
      if (columns(i)%is_count) then
        row = row//to_text(nint(columns(i)%value, i8))
      else
        row = row//cell(columns(i)%value)
      end if
    end do
    call append_text(self%file, row//new_line('a'), error)
  end subroutine record_add
end module sg_record
