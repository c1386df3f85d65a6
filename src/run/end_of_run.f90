!> End of a run: its status and reason, costs of all ranks, the verdict.
module sg_end_of_run
  use, intrinsic :: iso_fortran_env, only: output_unit
  use sg_after_step, only: measure_now
  use sg_error, only: error_t, exit_not_converged, exit_stopped
  use sg_kinds, only: wp
  use sg_moments_of_run, only: moment_t
  use sg_print, only: print_line
  use sg_run_summary, only: run_done, run_failed, run_not_converged, run_stopped
  use sg_simulation, only: simulation_t
  use sg_system, only: stop_signal
  use sg_text, only: to_text
  use sg_timed, only: timed
  use sg_totals, only: phase_measure, totals_t, worst_contact_words
  use sg_verdict, only: print_verdict
  use sg_writers, only: writers_t
  implicit none
  private
  public :: finish_run, print_end

contains

  !> Measure the end of a run, and note in its summary how and why it ended. Collective.
  subroutine finish_run(sim, code, error)
    type(simulation_t), intent(inout) :: sim !! after its last step
    integer, intent(in) :: code !! exit code where there is no error
    type(error_t), allocatable, intent(in) :: error !! error that ended the run, where there is one
    type(error_t), allocatable :: none
    type(totals_t) :: totals
    integer :: signal

    call sim%writers%progress%finish()
    if (sim%writers%has_stepped .and. .not. allocated(error)) call timed(measure_now, sim, phase_measure, none)
    ! A signal may have come to one rank alone.
    signal = stop_signal()
    call sim%comm%maximum(signal)
    call sim%totals%tick()
    totals = sim%totals
    call collect_costs(sim)
    call totals%reduce(sim%comm)
    call name_moment(sim, totals%penetration_at, sim%writers%summary%penetration_bodies)
    call name_moment(sim, totals%violation_at, sim%writers%summary%violation_bodies)
    associate (summary => sim%writers%summary)
      if (allocated(error)) then
        call conclude(merge(run_stopped, run_failed//' ', error%code == exit_stopped), error%sentence())
      else if (code == exit_stopped .and. signal > 0) then
        call conclude(run_stopped, 'stopped by signal '//to_text(signal)//' after step '//to_text(sim%step))
      else if (code == exit_stopped) then
        call conclude(run_stopped, 'stopped by the walltime after step '//to_text(sim%step))
      else if (code == exit_not_converged .and. totals%worst_step == sim%step) then
        call conclude(run_not_converged, 'step '//to_text(sim%step)//' did not converge: '// &
                      worst_contact_words(totals, summary%fall_speed))
      else if (code == exit_not_converged) then
        call conclude(run_not_converged, 'step '//to_text(sim%step)//' did not converge')
      else if (sim%stop%met > 0) then
        summary%stop_condition = sim%stop%texts(sim%stop%met)%s
        summary%stop_time = sim%stop%time
        summary%stop_value = sim%stop%value
        call conclude(run_done, sim%stop%reason())
      else
        call conclude(run_done, '')
      end if
    end associate
  contains
    subroutine conclude(status, reason)
      character(len=*), intent(in) :: status, reason

      sim%writers%summary%stages = sim%stages
      call sim%writers%summary%conclude(trim(status), reason, sim%time(), totals, sim%writers%measures)
    end subroutine conclude
  end subroutine finish_run

  !> Name the bodies of a worst value; unallocated where there are none.
  subroutine name_moment(sim, moment, words)
    type(simulation_t), intent(in) :: sim
    type(moment_t), intent(in) :: moment
    character(len=:), allocatable, intent(out) :: words

    if (moment%step > 0 .and. moment%bodies(1) > 0) &
      words = name_of(sim, moment%bodies(1))//' and '//name_of(sim, moment%bodies(2))
  end subroutine name_moment

  !> Name of a body that all ranks have: of a wall, of a tracked one, on one rank of any; else its number.
  function name_of(sim, number) result(name)
    type(simulation_t), intent(in) :: sim
    integer, intent(in) :: number
    character(len=:), allocatable :: name
    integer :: i

    name = ''
    if (allocated(sim%tracks%number)) then
      i = findloc(int(sim%tracks%number), number, 1)
      if (i > 0) name = sim%tracks%name(i)%s
    end if
    if (name == '' .and. allocated(sim%scene%names) .and. sim%comm%size == 1) name = sim%scene%names(number)%s
    if (name == '' .or. name == to_text(number)) then
      name = 'body '//to_text(number)
    else
      name = '"'//name//'"'
    end if
  end function name_of

  !> Collect from all ranks what sharing the scene cost.
  subroutine collect_costs(sim)
    type(simulation_t), intent(inout) :: sim

    associate (shared => sim%writers%summary%shared, subdomain => sim%decomposition%subdomain)
      shared%split = trim(sim%options%partition%split)
      shared%gluing = trim(sim%options%partition%gluing)
      shared%splits = subdomain%splits
      shared%moved = subdomain%moved
      shared%imbalance_at_splits = subdomain%imbalance_sums/real(max(1, subdomain%splits - 1), wp)
      call shared%collect(sim%comm, sim%effort, sim%gluing_traffic%messages, sim%gluing_traffic%bytes)
    end associate
    associate (summary => sim%writers%summary)
      summary%start_cpu = sim%preparation%cpu
      summary%start_wall = sim%preparation%wall
      call sim%comm%sum(summary%start_cpu)
      call sim%comm%maximum(summary%start_wall)
    end associate
  end subroutine collect_costs

  !> Print the verdict, and the table of traces. A run that failed before its first step has its error alone, and the trace of that
  !! step.
  subroutine print_end(writers, has_failed)
    type(writers_t), intent(in) :: writers !! of a run that has ended
    logical, intent(in) :: has_failed !! did an error end it?
    logical :: has_moved

    has_moved = writers%has_stepped .or. .not. has_failed
    if (has_moved) call print_verdict(output_unit, writers%summary)
    if (.not. (writers%trace%is_on .and. writers%is_root)) return
    if (has_moved .or. writers%trace%has_rows()) call print_line(writers%trace%table(writers%summary%totals))
  end subroutine print_end
end module sg_end_of_run
