!> The loop of a run: steps, and the output due after each of them (sg_after_step); beginning and end of a run.
module sg_simulate
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_advance, only: advance
  use sg_after_step, only: begin_stop, blank_measures, write_due
  use sg_alarm, only: end_after
  use sg_checkpoint, only: load_checkpoint, save_once
  use sg_claim, only: claim_folder, leave_folder
  use sg_end_of_run, only: finish_run, print_end
  use sg_comm, only: comm_t
  use sg_error, only: diagnostics_t, error_t, exit_done, exit_not_converged, exit_stopped
  use sg_failure, only: is_of_the_step, keep_failed_step, save_dump, trace_last
  use sg_former_results, only: is_within
  use sg_kinds, only: wp
  use sg_memory_report, only: report_memory
  use sg_methods, only: is_swept
  use sg_plan, only: describe_plan
  use sg_presence, only: hide_absent
  use sg_print, only: print_line
  use sg_run_files, only: close_fields, close_files, open_files, remove_former
  use sg_run_options, only: criterion_names, run_options_t
  use sg_run_summary, only: ranks_words
  use sg_simulation, only: decompose, simulation_t, start_simulation
  use sg_stages, only: stages_t
  use sg_system, only: file_exists, stop_signal
  use sg_text, only: counted, to_text
  use sg_timers, only: wall_now
  use sg_tunnelling, only: warn_of_tunnelling
  implicit none
  private
  public :: simulate

contains

  !> Run a simulation to its end; run.json is written however it ends, unless the folder of the results is not for this run or there
  !! is nothing to do: then all files stay as they are.
  !!
  !! Of a run in stages this is one stage; where another one follows, `goes_on` is set, and the folder stays claimed for it.
  !!
  !! Where there are several ranks, all of them call this, each with the whole scene or its share; the root rank alone prints.
  subroutine simulate(sim, deck, code, error)
    type(simulation_t), intent(inout) :: sim !! scene, options and ranks are set
    character(len=*), intent(in) :: deck !! path of the deck
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! error that ended the run, where there is one
    type(error_t), allocatable :: late
    logical :: is_stopped

    code = exit_done
    associate (writers => sim%writers)
      writers%is_root = sim%comm%rank == 0
      writers%summary%is_root = writers%is_root
      writers%record%is_root = writers%is_root
      writers%tracks%is_root = writers%is_root
      writers%walls%is_root = writers%is_root
      writers%regions%is_root = writers%is_root
      writers%subdomains%is_root = writers%is_root
      writers%interfaces%is_root = writers%is_root
      writers%trace%is_root = writers%is_root
      call writers%summary%describe(sim%scene, sim%options, deck, sim%comm)
      call start_simulation(sim)
      writers%summary%has_bonds = sim%plan%has_bonds
      writers%summary%has_rolling = sim%plan%has_rolling
      writers%measures = blank_measures(sim)
    end associate
    if (sim%writers%is_root .and. .not. sim%options%is_quiet) call print_opening(sim)
    call begin(sim, error)
    ! From now on steps and searches compare the time themselves, and a checkpoint can be written.
    call end_after(0.0_wp)
    if (.not. sim%writers%has_folder) then
      if (.not. (allocated(error) .or. sim%options%is_quiet) .and. sim%writers%is_root) call print_line(nothing_to_do(sim))
      return
    end if
    if (.not. allocated(error)) call loop_in_team(sim, code, error)
    call end_stage(sim, code, error)
    if (sim%goes_on) return
    call finish_run(sim, code, error)
    call close_files(sim, late)
    call sim%comm%agree(late)
    if (.not. allocated(error) .and. allocated(late)) call move_alloc(late, error)
    if (.not. sim%options%is_quiet) call print_end(sim%writers, allocated(error))
    is_stopped = code == exit_stopped
    if (allocated(error)) is_stopped = error%code == exit_stopped
    if (sim%options%reports_memory .and. (is_stopped .or. .not. allocated(error))) call report_memory(sim, is_stopped, late)
    if (.not. allocated(error) .and. allocated(late)) call move_alloc(late, error)
    call leave_folder(sim%options, sim%comm)
  end subroutine simulate

  !> Where the run had ended already, in a line.
  function nothing_to_do(sim) result(text)
    type(simulation_t), intent(in) :: sim
    character(len=:), allocatable :: text

    text = 'nothing to do: step '//to_text(sim%step)//' of '//to_text(sim%options%steps)//' ('//sim%options%restart_file//')'
    if (sim%stop%met > 0) text = text//', '//sim%stop%reason()
  end function nothing_to_do

  !> Print title, plan, solver, outputs and number of steps; of a stage that goes on after another one what differs.
  subroutine print_opening(sim)
    type(simulation_t), intent(inout) :: sim !! its line of outputs is set
    character(len=:), allocatable :: former

    if (allocated(sim%writers%outputs)) former = sim%writers%outputs
    sim%writers%outputs = describe_outputs(sim%options)
    if (sim%is_continued) then
      call print_line(describe_stage(sim))
      if (allocated(former)) then
        if (former /= sim%writers%outputs) call print_line(sim%writers%outputs)
      end if
      return
    end if
    if (allocated(sim%options%title)) then
      if (sim%options%title /= '') call print_line('title      '//sim%options%title)
    end if
    call print_line(describe_plan(sim%plan, sim%scene, sim%comm%size, sim%options%recovery))
    call print_line(describe_run(sim%options, sim%stages, sim%comm))
    if (sim%stages%number > 0) call print_line(describe_stage(sim))
  end subroutine print_opening

  !> The stage that begins or goes on, in a line.
  function describe_stage(sim) result(text)
    type(simulation_t), intent(in) :: sim
    character(len=:), allocatable :: text
    integer :: i

    associate (stage => sim%stages%list(sim%stages%number))
      text = 'stage      '//stage%words(sim%stages%number)//' of '//to_text(size(sim%stages%list))//': steps '// &
             to_text(stage%first_step + 1)//' to '//to_text(sim%options%steps)//' of '//to_text(sim%options%time_step, 4)//' s'
      do i = 1, size(stage%conditions)
        text = text//trim(merge(', until', ' or    ', i == 1))//' "'//stage%conditions(i)%s//'"'
      end do
    end associate
  end function describe_stage

  !> Note how far the present stage came. Where it is done and another one follows, write the checkpoint from which that goes on,
  !! and close what it opens again. Collective.
  subroutine end_stage(sim, code, error)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: code
    type(error_t), allocatable, intent(inout) :: error

    call sim%stages%note(sim%step, sim%time(), sim%totals%unconverged_steps, sim%stop%met, sim%stop%value)
    sim%goes_on = code == exit_done .and. .not. allocated(error) .and. sim%stages%go_on()
    if (.not. sim%goes_on) return
    call sim%writers%progress%finish()
    call save_once(sim, error)
    if (.not. allocated(error) .and. sim%writers%has_pictures) call sim%writers%pictures%close(sim%comm, error)
    call close_fields(sim)
    sim%goes_on = .not. allocated(error)
    if (.not. sim%goes_on .or. sim%options%is_quiet .or. .not. sim%writers%is_root) return
    associate (stage => sim%stages%list(sim%stages%number))
      call print_line('stage      '//stage%words(sim%stages%number)//' ended after '// &
                      counted(stage%last_step - stage%first_step, 'step')//', time '//to_text(sim%time(), 4)//' s ('// &
                      stage%reason()//')')
    end associate
  end subroutine end_stage

  !> Solver, outputs and number of steps, in a few lines.
  function describe_run(options, stages, comm) result(text)
    type(run_options_t), intent(in) :: options
    type(stages_t), intent(in) :: stages
    type(comm_t), intent(in) :: comm
    character(len=:), allocatable :: text

    text = ''
    if (comm%size > 1) &
      text = 'ranks      '//ranks_words(comm%size, comm%n_processes())//', split by '//trim(options%partition%split)// &
             ', coupled by '//trim(options%partition%gluing)//new_line('a')
    text = text//'solver     '//trim(options%solver%method)//' until '//trim(criterion_names(options%solver%criterion))//' <= ' &
           //to_text(options%solver%tolerance, 2)//', at most '//to_text(options%solver%maximum_sweeps) &
           //trim(merge(' sweeps    ', ' iterations', is_swept(options%solver%method)))//new_line('a') &
           //describe_outputs(options)//new_line('a')//'time       '//steps()//'; results in '//options%folder
  contains
    pure function steps()
      character(len=:), allocatable :: steps

      if (stages%number > 0) then
        steps = counted(size(stages%list), 'stage')//', at most '//to_text(stages%all_steps())//' steps'
      else
        steps = to_text(options%steps)//' steps of '//to_text(options%time_step, 4)//' s'//substeps(options%substeps)
      end if
    end function steps

    pure function substeps(number)
      integer, intent(in) :: number
      character(len=:), allocatable :: substeps

      substeps = ''
      if (number > 1) substeps = ' in '//to_text(number)//' substeps each'
    end function substeps
  end function describe_run

  !> What is written and when, in a line.
  pure function describe_outputs(options) result(text)
    type(run_options_t), intent(in) :: options
    character(len=:), allocatable :: text

    text = 'outputs    '//every('record', options%record_every)//', '//every('pictures', options%output_every)//', '// &
           every('checkpoints', options%restart_every)
    if (options%restart_at_end) &
      text = text//trim(merge(' and at the end       ', ' except one at the end', options%restart_every > 0))
  contains
    pure function every(what, steps)
      character(len=*), intent(in) :: what
      integer, intent(in) :: steps
      character(len=:), allocatable :: every

      every = 'no '//what
      if (steps == 1) every = what//' every step'
      if (steps > 1) every = what//' every '//to_text(steps)//' steps'
    end function every
  end function describe_outputs

  !> Load a checkpoint where there is one, claim the folder of the results unless there is nothing to do, split the scene over the
  !! ranks, and open all files.
  subroutine begin(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    type(diagnostics_t) :: warnings
    logical :: resumes, goes_on

    resumes = allocated(sim%options%restart_file)
    sim%writers%has_folder = sim%is_continued
    call begin_stop(sim, error)
    if (allocated(error)) return
    if (resumes) call load_checkpoint(sim, sim%options%restart_file, warnings, error)
    if (allocated(error)) return
    if (sim%writers%is_root) call warnings%print(error_unit)
    if (sim%stages%number > 0) sim%stages%list(sim%stages%number)%origin = sim%scene%start_time
    if (resumes .and. is_at_end(sim)) then
      if (.not. lacks_end(sim)) return
    end if
    goes_on = .true.
    if (.not. sim%is_continued) call claim_folder(sim%options, sim%comm, goes_on, error)
    if (allocated(error)) return
    sim%writers%has_folder = .true.
    call remove_former(sim, goes_on)
    if (resumes .and. goes_on) sim%writers%saved_step = sim%step
    call decompose(sim, error)
    if (allocated(error)) return
    if (sim%scene%bodies%has_presence) call hide_absent(sim%scene%bodies)
    call sim%tracks%begin(sim%scene, sim%comm)
    call open_files(sim, resumes, error)
  end subroutine begin

  !> Was the run killed after its last checkpoint, before it closed its files? Then they are closed now. Collective.
  logical function lacks_end(sim)
    type(simulation_t), intent(inout) :: sim

    associate (options => sim%options)
      lacks_end = sim%comm%rank == 0 .and. sim%step <= options%steps .and. sim%writers%measured_step == sim%step
      if (lacks_end) lacks_end = is_within(options%restart_file, options%folder) .and. &
                                 .not. file_exists(options%folder//'/run.json')
    end associate
    lacks_end = sim%comm%any(lacks_end)
  end function lacks_end

  !> The loop in a team of threads, if there are several: the first thread runs the loop, the others take pieces of the work that it
  !! shares. Subdomains of one process take turns in one thread: their sweeps alone are shared.
  subroutine loop_in_team(sim, code, error)
    type(simulation_t), intent(inout) :: sim
    integer, intent(out) :: code
    type(error_t), allocatable, intent(out) :: error

    if (sim%options%solver%threads == 1 .or. sim%comm%n_here() > 1) then
      call loop(sim, code, error)
      return
    end if
    !$omp parallel default(shared) num_threads(sim%options%solver%threads)
    !$omp master
    call loop(sim, code, error)
    !$omp end master
    !$omp end parallel
  end subroutine loop_in_team

  !> The steps.
  subroutine loop(sim, code, error)
    type(simulation_t), intent(inout) :: sim
    integer, intent(out) :: code
    type(error_t), allocatable, intent(out) :: error

    code = exit_done
    do while (code == exit_done .and. .not. is_at_end(sim))
      call begin_trace(sim)
      call advance(sim, error)
      if (sim%dump%is_begun) call save_dump(sim, sim%step + merge(1, 0, allocated(error)))
      if (allocated(error)) then
        call keep_failed_step(sim, error)
        return
      end if
      sim%writers%has_stepped = .true.
      call warn_of_tunnelling(sim%tunnelling, sim%comm, error_unit)
      call write_due(sim, error)
      if (allocated(error)) then
        if (is_of_the_step(error)) call trace_last(sim, sim%step)
        return
      end if
      if (sim%options%solver%stop_unconverged .and. .not. sim%report%is_converged) code = exit_not_converged
      if (sim%is_traced) then
        call sim%writers%trace%end_step(sim%step, sim%time(), sim%all_contacts, sim%report, sim%totals, sim%comm, error)
        if (allocated(error)) return
      else if (code == exit_not_converged) then
        call trace_last(sim, sim%step)
      end if
      if (sim%comm%any(must_stop(sim))) code = exit_stopped
    end do
    if (code == exit_stopped .or. (code == exit_not_converged .and. sim%options%restart_at_end)) call save_once(sim, error)
  end subroutine loop

  !> Decide whether the next step is traced, and whether its guess is kept.
  subroutine begin_trace(sim)
    type(simulation_t), intent(inout) :: sim

    associate (trace => sim%writers%trace)
      sim%is_traced = trace%wants(sim%step + 1)
      sim%keeps_guess = trace%is_on .and. .not. sim%is_traced
      if (trace%is_on) call trace%begin_step(sim%totals)
    end associate
  end subroutine begin_trace

  !> Has a signal or the walltime asked for an end before the last step?
  logical function must_stop(sim)
    type(simulation_t), intent(in) :: sim

    must_stop = stop_signal() /= 0
    if (sim%options%deadline > 0) must_stop = must_stop .or. wall_now() > sim%options%deadline
    must_stop = must_stop .and. .not. is_at_end(sim)
  end function must_stop

  !> Are all steps done, or has an end condition been met?
  pure logical function is_at_end(sim)
    type(simulation_t), intent(in) :: sim

    is_at_end = sim%step >= sim%options%steps .or. sim%stop%met > 0
  end function is_at_end
end module sg_simulate
