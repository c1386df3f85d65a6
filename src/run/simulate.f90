!> The loop of a run: steps, and between them what is recorded, drawn, saved and said; and how a run ends.
module sg_simulate
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use sg_advance, only: advance
  use sg_alarm, only: end_after
  use sg_checkpoint, only: load_checkpoint, save_checkpoint
  use sg_claim, only: claim_folder, leave_folder
  use sg_dump, only: finish_dump
  use sg_energy, only: kinetic_energy
  use sg_error, only: diagnostics_t, error_t, exit_done, exit_not_converged, exit_stopped
  use sg_failure, only: is_of_the_step, trace_broken
  use sg_guard, only: judge_energy
  use sg_history, only: revive
  use sg_kinds, only: wp
  use sg_measures, only: measure
  use sg_needs, only: tell_needs
  use sg_passing, only: tell_passing
  use sg_plan, only: describe_plan
  use sg_print, only: print_line
  use sg_report, only: report_t
  use sg_run_files, only: close_files, open_files, remove_former, writers_t
  use sg_run_options, only: criterion_names, run_options_t
  use sg_run_summary, only: run_done, run_failed, run_not_converged, run_stopped
  use sg_simulation, only: decompose, simulation_t, start_simulation
  use sg_structure_now, only: report_structure
  use sg_system, only: checkpoint_requested, stop_signal
  use sg_text, only: to_text
  use sg_timers, only: wall_now
  use sg_totals, only: phase_measure, phase_output, reduce_report, totals_t, worst_contact_words
  use sg_verdict, only: print_verdict
  implicit none
  private
  public :: simulate

contains

  !> Run a simulation to its end; run.json is written however it ends, unless the folder of the results is not for this run or there
  !! is nothing to do: then all files stay as they are.
  !!
  !! Where there are several ranks, all of them call this, each with the whole scene or its share; the root rank alone prints.
  subroutine simulate(sim, deck, code, error)
    type(simulation_t), intent(inout) :: sim !! scene, options and ranks are set
    character(len=*), intent(in) :: deck !! path of the deck
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! what ended the run, when something did
    type(writers_t) :: writers
    type(error_t), allocatable :: late

    code = exit_done
    writers%wall_start = wall_now()
    writers%is_root = sim%comm%rank == 0
    writers%summary%is_root = writers%is_root
    writers%record%is_root = writers%is_root
    writers%trace%is_root = writers%is_root
    call writers%summary%describe(sim%scene, sim%options, deck, sim%comm)
    call start_simulation(sim)
    writers%summary%has_bonds = sim%plan%has_bonds
    if (writers%is_root .and. .not. sim%options%is_quiet) then
      if (allocated(sim%options%title)) then
        if (sim%options%title /= '') call print_line('title      '//sim%options%title)
      end if
      call print_line(describe_plan(sim%plan, sim%scene, sim%comm%size))
      call print_line(describe_run(sim%options, sim%comm%size))
    end if
    call begin(sim, writers, error)
    ! From now on steps and searches look at the time themselves, and a checkpoint can be written.
    call end_after(0.0_wp)
    if (.not. writers%has_folder) then
      if (.not. allocated(error)) call tell_nothing_to_do(sim, writers%is_root)
      return
    end if
    if (.not. allocated(error)) call loop(sim, writers, code, error)
    call conclude(sim, writers, code, error)
    call close_files(sim, writers, late)
    call sim%comm%agree(late)
    if (.not. allocated(error) .and. allocated(late)) call move_alloc(late, error)
    if (.not. sim%options%is_quiet) call tell_end(writers, allocated(error))
    if (sim%options%tells_needs .and. .not. allocated(error)) call tell_needs(sim, error)
    call leave_folder(sim%options, sim%comm)
  end subroutine simulate

  !> The checkpoint is of the last step, or of a later one.
  subroutine tell_nothing_to_do(sim, is_root)
    type(simulation_t), intent(in) :: sim
    logical, intent(in) :: is_root

    if (is_root .and. .not. sim%options%is_quiet) call print_line(&
      'nothing to do: step '//to_text(sim%step)//' of '//to_text(sim%options%steps)//' ('//sim%options%restart_file//')')
  end subroutine tell_nothing_to_do

  !> The verdict, and the table of traces. A run that failed before it moved has nothing but its error and the trace of its step.
  subroutine tell_end(writers, has_failed)
    type(writers_t), intent(in) :: writers
    logical, intent(in) :: has_failed
    logical :: has_moved

    has_moved = writers%has_stepped .or. .not. has_failed
    if (has_moved) call print_verdict(output_unit, writers%summary)
    if (.not. (writers%trace%is_on .and. writers%is_root)) return
    if (has_moved .or. writers%trace%has_rows()) call print_line(writers%trace%table(writers%summary%totals))
  end subroutine tell_end

  !> What is done with the scene, in a few lines.
  function describe_run(options, ranks) result(text)
    type(run_options_t), intent(in) :: options
    integer, intent(in) :: ranks
    character(len=:), allocatable :: text

    text = ''
    if (ranks > 1) text = 'ranks      '//to_text(ranks)//', split by '//trim(options%partition%split)//', glued by '// &
                          trim(options%partition%gluing)//new_line('a')
    text = text//'solver     '//trim(options%solver%method)//' until '//trim(criterion_names(options%solver%criterion))//' <= ' &
           //to_text(options%solver%tolerance, 2)//', at most '//to_text(options%solver%maximum_sweeps) &
           //trim(merge(' sweeps    ', ' iterations', options%solver%method == 'nlgs'))//new_line('a') &
           //'outputs    '//every('record', options%record_every)//', '//every('pictures', options%output_every)//', ' &
           //every('checkpoints', options%restart_every)//at_end(options)//new_line('a')//'time       ' &
           //to_text(options%steps)//' steps of '//to_text(options%step, 4)//' s; results in '//options%folder
  contains
    pure function every(what, steps)
      character(len=*), intent(in) :: what
      integer, intent(in) :: steps
      character(len=:), allocatable :: every

      every = 'no '//what
      if (steps == 1) every = what//' every step'
      if (steps > 1) every = what//' every '//to_text(steps)//' steps'
    end function every

    pure function at_end(options) result(text)
      type(run_options_t), intent(in) :: options
      character(len=:), allocatable :: text

      text = ''
      if (options%restart_at_end) text = trim(merge(' and at the end       ', ' except one at the end', options%restart_every > 0))
    end function at_end
  end function describe_run

  !> The steps.
  subroutine loop(sim, writers, code, error)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers
    integer, intent(out) :: code
    type(error_t), allocatable, intent(out) :: error

    code = exit_done
    do while (sim%step < sim%options%steps)
      sim%is_traced = writers%trace%wants(sim%step + 1)
      sim%keeps_guess = writers%trace%is_on .and. .not. sim%is_traced
      if (writers%trace%is_on) call writers%trace%begin_step(sim%totals)
      call advance(sim, error)
      if (sim%dump%is_begun) call save_dump(sim, writers, sim%step + merge(1, 0, allocated(error)))
      if (allocated(error)) then
        call save_broken(sim, writers)
        if (is_of_the_step(error)) call trace_last(sim, writers, sim%step + 1)
        return
      end if
      writers%has_stepped = .true.
      call tell_passing(sim%passing, sim%comm, error_unit)
      call write_due(sim, writers, error)
      if (allocated(error)) then
        if (is_of_the_step(error)) call trace_last(sim, writers, sim%step)
        return
      end if
      if (sim%options%solver%stop_unconverged .and. .not. sim%report%is_converged) code = exit_not_converged
      if (sim%is_traced) then
        call writers%trace%end_step(sim%step, sim%time(), sim%all_contacts, sim%report, sim%totals, sim%comm, error)
      else if (code == exit_not_converged) then
        call trace_last(sim, writers, sim%step)
      end if
      if (allocated(error)) return
      if (sim%comm%any(must_stop(sim))) code = exit_stopped
      if (code == exit_done) cycle
      if (code == exit_stopped .or. sim%options%restart_at_end) call save(sim, writers, error)
      return
    end do
  end subroutine loop

  !> Write the history of the step that ends the run; that it cannot be written is told, and does not hide why the run ends.
  subroutine trace_last(sim, writers, step)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers
    integer, intent(in) :: step
    type(error_t), allocatable :: error

    call trace_broken(sim, step, writers%trace, error)
    if (allocated(error) .and. writers%is_root) write (error_unit, '(a)') error%report('warning')
  end subroutine trace_last

  !> Write the dump of a step; that it cannot be written is told, and does not end the run.
  subroutine save_dump(sim, writers, step)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers
    integer, intent(in) :: step
    type(error_t), allocatable :: error
    character(len=:), allocatable :: name

    call finish_dump(sim%dump, sim%problem, sim%options%folder, writers%summary%deck, step, sim%comm, name, error)
    if (allocated(error)) then
      if (writers%is_root) write (error_unit, '(a)') error%report('warning')
    else
      call writers%summary%add_file('dump_'//to_text(step), name)
    end if
  end subroutine save_dump

  !> Has a signal or the walltime asked for an end before the last step?
  logical function must_stop(sim)
    type(simulation_t), intent(in) :: sim

    must_stop = stop_signal() /= 0
    if (sim%options%deadline > 0) must_stop = must_stop .or. wall_now() > sim%options%deadline
    must_stop = must_stop .and. sim%step < sim%options%steps
  end function must_stop

  !> Record, draw, save and say what is due after a step.
  subroutine write_due(sim, writers, error)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: late
    logical :: is_last

    is_last = sim%step == sim%options%steps
    if (sim%options%has_spectrum) call sample_now(sim, writers)
    if (sim%options%has_structure .and. is_due(sim%options%structure_every)) then
      call report_structure(sim, writers%structure, writers%is_root, error)
      if (allocated(error)) return
    end if
    if (sim%options%record_every > 0 .and. (is_due(sim%options%record_every) .or. is_last)) then
      call measure_now(sim, writers)
      call watch_energy(sim, writers, error)
      call sim%totals%phase(phase_output)%start()
      call record_now(sim, writers, late)
      call sim%totals%phase(phase_output)%stop()
    end if
    if (.not. allocated(error) .and. allocated(late)) call move_alloc(late, error)
    if (allocated(error)) return
    call sim%totals%phase(phase_output)%start()
    if (writers%has_pictures .and. (is_due(sim%options%output_every) .or. is_last)) then
      call writers%pictures%write(sim%scene, sim%contacts, sim%time(), sim%step, error)
    end if
    if (.not. allocated(error) .and. writers%has_checkpoints) then
      if (is_due(sim%options%restart_every) .or. (is_last .and. sim%options%restart_at_end) .or. &
          sim%comm%any(checkpoint_requested())) call save(sim, writers, error)
    end if
    if (writers%progress%is_due()) then
      call writers%progress%show(sim%step, sim%time(), sim%all_contacts, sim%report, present_energy(sim, writers))
    end if
    call sim%totals%phase(phase_output)%stop()
  contains
    logical function is_due(every)
      integer, intent(in) :: every

      is_due = .false.
      if (every > 0) is_due = mod(sim%step, every) == 0
    end function is_due
  end subroutine write_due

  !> Do the energies just measured, which all ranks have, end the run, or ask for a warning?
  subroutine watch_energy(sim, writers, error)
    type(simulation_t), intent(in) :: sim
    type(writers_t), intent(inout) :: writers
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: warning
    logical :: has_warned

    ! With another theta positions move otherwise than works are summed: the balance is open by the order of the step.
    has_warned = writers%has_warned .or. abs(sim%options%theta - 0.5_wp) > 0
    call judge_energy(writers%measures, sim%options%guard, sim%step, has_warned, warning, error)
    if (len(warning) == 0) return
    writers%has_warned = .true.
    if (writers%is_root) write (error_unit, '(a)') 'warning: '//warning
  end subroutine watch_energy

  !> Add a row to the record.
  subroutine record_now(sim, writers, error)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers
    type(error_t), allocatable, intent(out) :: error
    type(report_t) :: report
    type(totals_t) :: totals

    call sim%totals%tick()
    report = sim%report
    totals = sim%totals
    call reduce_report(report, sim%comm)
    call totals%reduce(sim%comm)
    call writers%record%add(sim%step, sim%time(), sim%all_contacts, report, totals, writers%measures, error)
    call sim%comm%agree(error)
  end subroutine record_now

  !> Kinetic energy to show [J]: that of now on one rank; of several ranks the last one measured, which costs no message.
  real(wp) function present_energy(sim, writers)
    type(simulation_t), intent(in) :: sim
    type(writers_t), intent(in) :: writers

    if (sim%decomposition%is_on) then
      present_energy = writers%measures%get('kinetic_energy')
    else
      present_energy = kinetic_energy(sim%scene%bodies)
    end if
  end function present_energy

  !> Sample what spectra are made of.
  subroutine sample_now(sim, writers)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers

    call sim%totals%phase(phase_measure)%start()
    call writers%samples%add(sim%scene, sim%contacts, sim%options%step)
    call sim%totals%phase(phase_measure)%stop()
  end subroutine sample_now

  !> Measure all indicators.
  subroutine measure_now(sim, writers)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers

    call sim%totals%phase(phase_measure)%start()
    if (sim%decomposition%is_on) then
      call measure(sim%scene, sim%contacts, sim%options%step, sim%energy, writers%measures, sim%decomposition%subdomain, sim%comm)
    else
      call measure(sim%scene, sim%contacts, sim%options%step, sim%energy, writers%measures)
    end if
    call sim%totals%phase(phase_measure)%stop()
  end subroutine measure_now

  !> Write a checkpoint, unless that of this step is written, or the program has no HDF5.
  subroutine save(sim, writers, error)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers
    type(error_t), allocatable, intent(out) :: error

    if (.not. writers%has_checkpoints .or. writers%saved_step == sim%step) return
    call sim%totals%tick()
    call save_checkpoint(sim, error)
    if (allocated(error)) return
    writers%has_saved = .true.
    writers%saved_step = sim%step
  end subroutine save

  !> Keep the state at the beginning of a step that broke, so that it can be tried again.
  subroutine save_broken(sim, writers)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers
    type(error_t), allocatable :: error

    if (.not. writers%has_checkpoints .or. writers%saved_step == sim%step) return
    call revive(sim%history, sim%pairs, sim%contacts)
    call save(sim, writers, error)
  end subroutine save_broken

  !> Take up a checkpoint where there is one, claim the folder of the results unless there is nothing to do, split the scene over
  !! the ranks, and open all files.
  subroutine begin(sim, writers, error)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers
    type(error_t), allocatable, intent(out) :: error
    logical :: resumes, goes_on

    resumes = allocated(sim%options%restart_file)
    if (resumes) call resume(sim, writers, error)
    if (allocated(error) .or. (resumes .and. sim%step >= sim%options%steps)) return
    call claim_folder(sim%options, sim%comm, goes_on, error)
    if (allocated(error)) return
    writers%has_folder = .true.
    call remove_former(sim%options, writers, goes_on)
    call decompose(sim, error)
    if (.not. allocated(error)) call open_files(sim, writers, resumes, error)
  end subroutine begin

  !> Go on from a checkpoint.
  subroutine resume(sim, writers, error)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(in) :: writers
    type(error_t), allocatable, intent(out) :: error
    type(diagnostics_t) :: warnings

    call load_checkpoint(sim, sim%options%restart_file, warnings, error)
    if (.not. allocated(error) .and. writers%is_root) call warnings%print(error_unit)
  end subroutine resume

  !> Say how the run ended.
  subroutine conclude(sim, writers, code, error)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers
    integer, intent(in) :: code
    type(error_t), allocatable, intent(in) :: error
    character(len=:), allocatable :: status, reason
    type(totals_t) :: totals
    integer :: signal

    call writers%progress%finish()
    if (writers%has_stepped .and. .not. allocated(error)) call measure_now(sim, writers)
    ! A signal may have come to one rank alone.
    signal = stop_signal()
    call sim%comm%maximum(signal)
    call sim%totals%tick()
    totals = sim%totals
    if (sim%decomposition%is_on) call collect_costs(sim, writers)
    call totals%reduce(sim%comm)
    status = run_done
    reason = ''
    if (allocated(error)) then
      status = run_failed
      if (error%code == exit_stopped) status = run_stopped
      reason = error%sentence()
    else if (code == exit_stopped) then
      status = run_stopped
      reason = 'stopped by the walltime after step '//to_text(sim%step)
      if (signal > 0) reason = 'stopped by signal '//to_text(signal)//' after step '//to_text(sim%step)
    else if (code == exit_not_converged) then
      status = run_not_converged
      reason = 'step '//to_text(sim%step)//' did not converge'
      if (totals%worst_step == sim%step) reason = reason//': '//worst_contact_words(totals, writers%summary%fall_speed)
    end if
    call writers%summary%conclude(status, reason, sim%time(), totals, writers%measures)
  end subroutine conclude

  !> Learn from all ranks what sharing the scene cost.
  subroutine collect_costs(sim, writers)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers

    associate (shared => writers%summary%shared, subdomain => sim%decomposition%subdomain)
      shared%split = trim(sim%options%partition%split)
      shared%gluing = trim(sim%options%partition%gluing)
      shared%splits = subdomain%splits
      shared%moved = subdomain%moved
      call shared%collect(sim%comm, sim%own_updates, sim%gluings, sim%gluing_traffic%messages, &
                          sim%gluing_traffic%bytes)
    end associate
  end subroutine collect_costs

end module sg_simulate
