!> The files of a run: who writes them, how they are opened and closed.
module sg_run_files
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use sg_error, only: error_t
  use sg_former_results, only: remove_results
  use sg_hdf5, only: hdf5_is_available
  use sg_kinds, only: wp
  use sg_measures, only: measures_t
  use sg_pictures, only: pictures_t
  use sg_progress, only: progress_t
  use sg_record, only: record_t
  use sg_restart_files, only: newest_restart
  use sg_run_options, only: criterion_names, run_options_t
  use sg_run_summary, only: run_summary_t, write_run_summary
  use sg_run_trace, only: run_trace_t, steps_file, trace_file, traced_steps
  use sg_samples, only: samples_t
  use sg_simulation, only: simulation_t
  use sg_spectrum_file, only: write_spectrum
  use sg_structure_file, only: structure_file_t
  use sg_structure_now, only: report_structure
  use sg_system, only: is_terminal, remove_file
  use sg_numbers, only: write_numbers
  use sg_text_files, only: replace_file
  implicit none
  private
  public :: close_files, open_files, remove_former, writers_t

  !> All that writes during a run
  type :: writers_t
    type(record_t) :: record
    type(pictures_t) :: pictures
    type(progress_t) :: progress
    type(run_summary_t) :: summary
    type(measures_t) :: measures
    type(samples_t) :: samples
    type(run_trace_t) :: trace
    type(structure_file_t) :: structure
    !> Is this the rank that writes texts?
    logical :: is_root = .true.
    logical :: has_pictures = .false., has_checkpoints = .false., has_saved = .false.
    !> Has this run claimed its folder, so that it may write there? Has it done a step?
    logical :: has_folder = .false., has_stepped = .false.
    !> Step of the last checkpoint written; negative where there is none
    integer :: saved_step = -1
    !> Was told that the energy balance does not close?
    logical :: has_warned = .false.
    real(wp) :: wall_start = 0
  end type writers_t

contains

  !> Write the deck in force and open the record, the pictures and the progress lines. Collective.
  subroutine open_files(sim, writers, resumes, error)
    type(simulation_t), intent(inout) :: sim !! ready for its first step
    type(writers_t), intent(inout) :: writers !! those that this run needs are open
    logical, intent(in) :: resumes !! does the run go on from a checkpoint?
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when a file cannot be written

    if (writers%is_root) call replace_file(sim%options%folder//'/effective.toml', sim%options%deck_text, error)
    call sim%comm%agree(error)
    if (allocated(error)) return
    call writers%summary%add_file('deck', 'effective.toml')
    if (sim%options%record_every > 0) call open_record(sim, writers, resumes, error)
    if (.not. allocated(error) .and. sim%options%has_trace) call open_trace(sim, writers, resumes, error)
    call sim%comm%agree(error)
    if (allocated(error)) return
    if (writers%has_pictures) call open_pictures(sim, writers, resumes, error)
    if (allocated(error)) return
    call writers%progress%start(output_unit, sim%step, sim%options%steps, trim(criterion_names(sim%options%solver%criterion)), &
                                is_terminal() .and. sim%comm%size == 1, sim%options%is_quiet .or. .not. writers%is_root)
  end subroutine open_files

  !> Say what this run writes, and remove what a former run in its folder has left: where this one goes on with it, only what says
  !! how that ended.
  subroutine remove_former(options, writers, goes_on)
    type(run_options_t), intent(in) :: options !! what is asked for, and where
    type(writers_t), intent(inout) :: writers !! knows whether there are pictures and checkpoints
    logical, intent(in) :: goes_on !! does the run go on with the files of its folder?

    writers%has_pictures = options%output_every > 0
    writers%has_checkpoints = hdf5_is_available()
    if (.not. writers%is_root) return
    if (goes_on) then
      call remove_file(options%folder//'/run.json')
      call remove_file(options%folder//'/numbers.tag')
    else
      call remove_results(options%folder)
    end if
  end subroutine remove_former

  !> Open the pictures, and draw the beginning of a run that begins.
  subroutine open_pictures(sim, writers, resumes, error)
    type(simulation_t), intent(inout) :: sim
    type(writers_t), intent(inout) :: writers
    logical, intent(in) :: resumes
    type(error_t), allocatable, intent(out) :: error

    if (sim%decomposition%is_on) then
      if (sim%options%output_compressed .and. writers%is_root) then
        write (error_unit, '(a)') 'warning: output.compression is left aside: several ranks write their pictures uncompressed'
      end if
      call writers%pictures%open(sim%scene, sim%options, merge(sim%step, -1, resumes), error, sim%comm)
    else
      call writers%pictures%open(sim%scene, sim%options, merge(sim%step, -1, resumes), error)
    end if
    if (allocated(error)) return
    call name_pictures(writers)
    if (.not. resumes) call writers%pictures%write(sim%scene, sim%contacts, sim%time(), 0, error)
  end subroutine open_pictures

  !> Begin the record, or go on with it, and name it in the summary.
  subroutine open_record(sim, writers, resumes, error)
    type(simulation_t), intent(in) :: sim
    type(writers_t), intent(inout) :: writers
    logical, intent(in) :: resumes
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: file

    file = sim%options%folder//'/record.csv'
    call writers%summary%add_file('record', 'record.csv')
    if (resumes) then
      call writers%record%resume(file, sim%scene%dimension, sim%plan%has_bonds, sim%step, error)
    else
      call writers%record%start(file, sim%scene%dimension, sim%plan%has_bonds, error)
    end if
  end subroutine open_record

  !> Begin the traces, or go on with them, and name them in the summary.
  subroutine open_trace(sim, writers, resumes, error)
    type(simulation_t), intent(in) :: sim
    type(writers_t), intent(inout) :: writers
    logical, intent(in) :: resumes
    type(error_t), allocatable, intent(out) :: error

    call writers%trace%open(sim%options%folder, traced_steps(sim%options%trace_steps, sim%options%steps), &
                            merge(sim%step, 0, resumes), error)
    call writers%summary%add_file('trace', trace_file)
    call writers%summary%add_file('trace_steps', steps_file)
  end subroutine open_trace

  !> Name the picture files in the summary.
  subroutine name_pictures(writers)
    type(writers_t), intent(inout) :: writers

    call writers%summary%add_file('bodies', 'bodies.vtkhdf')
    call writers%summary%add_file('shapes', 'shapes.vtkhdf')
    call writers%summary%add_file('contacts', 'contacts.vtkhdf')
  end subroutine name_pictures

  !> Name the newest restart file in the summary.
  subroutine name_restart(folder, writers)
    character(len=*), intent(in) :: folder
    type(writers_t), intent(inout) :: writers
    character(len=:), allocatable :: file

    file = newest_restart(folder)
    call writers%summary%add_file('restart', file(len(folder) + 2:))
  end subroutine name_restart

  !> Close all files, write run.json and the tagged numbers; the first failure is told.
  subroutine close_files(sim, writers, error)
    type(simulation_t), intent(inout) :: sim !! ended
    type(writers_t), intent(inout) :: writers !! all are closed
    type(error_t), allocatable, intent(out) :: error !! the first failure
    type(error_t), allocatable :: next

    if (writers%has_pictures) call writers%pictures%close(error)
    if (writers%has_saved) call name_restart(sim%options%folder, writers)
    if (sim%options%has_spectrum) call writers%samples%reduce(sim%comm)
    if (writers%samples%n > 0 .and. writers%is_root) then
      call write_spectrum(writers%samples, sim%options%step, sim%options%folder//'/spectrum.csv', next)
      if (.not. allocated(next)) call writers%summary%add_file('spectrum', 'spectrum.csv')
      if (.not. allocated(error) .and. allocated(next)) call move_alloc(next, error)
    end if
    if (sim%options%has_structure .and. writers%has_stepped) then
      call report_structure(sim, writers%structure, writers%is_root, next)
      call writers%summary%add_file('radial_distribution', 'radial_distribution.csv')
      call writers%summary%add_file('structure_factor', 'structure_factor.csv')
      if (.not. allocated(error) .and. allocated(next)) call move_alloc(next, error)
    end if
    call write_numbers(writers%summary, sim%options%folder//'/numbers.tag', next)
    if (.not. allocated(error) .and. allocated(next)) call move_alloc(next, error)
    call write_run_summary(writers%summary, sim%options%folder//'/run.json', next)
    if (.not. allocated(error) .and. allocated(next)) call move_alloc(next, error)
  end subroutine close_files
end module sg_run_files
