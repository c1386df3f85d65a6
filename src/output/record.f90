!> record.csv: one row per recorded step, named columns, SI units (doc/guide/results.md lists them).
module sg_record
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_measures, only: measures_t, unmeasured
  use sg_report, only: report_t
  use sg_step_csv, only: cell, resume_rows
  use sg_text, only: to_text
  use sg_text_files, only: append_text, replace_file
  use sg_totals, only: n_phases, phase_names, totals_t
  implicit none
  private
  public :: record_t

  !> The record of a run
  type :: record_t
    !> Path of the file
    character(len=:), allocatable :: file
    !> Does this rank write it? Of ranks that share a run one alone does
    logical :: is_root = .true.
  contains
    procedure :: start => record_start
    procedure :: resume => record_resume
    procedure :: add => record_add
  end type record_t

contains

  !> Begin a new record; an older one is replaced.
  subroutine record_start(self, file, dimension, has_bonds, error)
    class(record_t), intent(inout) :: self
    character(len=*), intent(in) :: file !! path of the record
    integer, intent(in) :: dimension !! of space
    logical, intent(in) :: has_bonds !! are there cohesive zones?
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written

    self%file = file
    if (.not. self%is_root) return
    call replace_file(file, header(dimension, has_bonds)//new_line('a'), error)
  end subroutine record_start

  !> Go on with the record of a run that restarts after a step: rows of later steps, and a torn last row, are cut.
  subroutine record_resume(self, file, dimension, has_bonds, step, error)
    class(record_t), intent(inout) :: self
    character(len=*), intent(in) :: file !! path of the record
    integer, intent(in) :: dimension !! of space
    logical, intent(in) :: has_bonds !! are there cohesive zones?
    integer, intent(in) :: step !! step of the checkpoint
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be read or written, or has other columns

    self%file = file
    if (.not. self%is_root) return
    call resume_rows(file, header(dimension, has_bonds), step, error)
  end subroutine record_resume

  !> The names of the columns.
  pure function header(dimension, has_bonds) result(names)
    integer, intent(in) :: dimension
    logical, intent(in) :: has_bonds
    character(len=:), allocatable :: names
    type(measures_t) :: measures
    integer :: i

    names = 'step,time,contacts,active_contacts,sweeps,contact_updates,converged,criterion,e1,e2,e8,violation'// &
            ',cpu_seconds,wall_seconds'
    do i = 1, n_phases
      names = names//',cpu_'//trim(phase_names(i))
    end do
    measures = unmeasured(dimension, has_bonds)
    do i = 1, size(measures%column)
      names = names//','//trim(measures%column(i)%name)
    end do
    do i = 1, n_phases
      names = names//',wall_'//trim(phase_names(i))
    end do
  end function header

  !> Add the row of a step.
  subroutine record_add(self, step, time, contacts, report, totals, measures, error)
    class(record_t), intent(in) :: self
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: time !! end of the step [s]
    integer, intent(in) :: contacts !! number of contacts
    type(report_t), intent(in) :: report !! report of the solver on the step
    type(totals_t), intent(in) :: totals !! timers since the start
    type(measures_t), intent(in) :: measures !! indicators of the step
    type(error_t), allocatable, intent(out) :: error !! set when the row cannot be written
    character(len=:), allocatable :: row
    integer :: i

    if (.not. self%is_root) return
    row = to_text(step)//','//cell(time)//','//to_text(contacts)//','//to_text(report%active_contacts)//','// &
          to_text(report%sweeps)//','//to_text(report%contact_updates)//','//merge('1', '0', report%is_converged)//','// &
          cell(report%criterion)//','//cell(report%e1)//','//cell(report%e2)//','//cell(report%e8)//','// &
          cell(report%violation)//','//cell(totals%clock%cpu)//','//cell(totals%clock%wall)
    do i = 1, n_phases
      row = row//','//cell(totals%phase(i)%cpu)
    end do
    do i = 1, size(measures%column)
      if (measures%column(i)%is_count) then
        row = row//','//to_text(nint(measures%column(i)%value))
      else
        row = row//','//cell(measures%column(i)%value)
      end if
    end do
    do i = 1, n_phases
      row = row//','//cell(totals%phase(i)%wall)
    end do
    call append_text(self%file, row//new_line('a'), error)
  end subroutine record_add
end module sg_record
