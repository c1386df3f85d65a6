!> Files of a run: opened, and closed at its end.
module sg_run_files
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use sg_after_step, only: report_structure
  use sg_error, only: error_t, fail
  use sg_field_file, only: field_name
  use sg_former_results, only: remove_results
  use sg_hdf5, only: hdf5_is_available
  use sg_interface_file, only: interfaces_name
  use sg_numbers, only: write_numbers
  use sg_pictures_interfaces, only: interfaces_picture_name
  use sg_region_file, only: regions_name
  use sg_subdomain_file, only: subdomains_name
  use sg_restart_files, only: newest_restart
  use sg_run_options, only: criterion_names
  use sg_run_summary, only: write_run_summary
  use sg_run_trace, only: steps_file, trace_file, traced_steps
  use sg_simulation, only: simulation_t
  use sg_spectrum_file, only: write_spectrum
  use sg_system, only: is_terminal, remove_file
  use sg_text, only: to_text
  use sg_text_files, only: replace_file
  use sg_track_file, only: tracks_name
  use sg_wall_file, only: walls_name
  implicit none
  private
  public :: close_fields, close_files, open_files, remove_former

contains

  !> Write the deck in force and open the record, the pictures and the progress lines. Collective.
  subroutine open_files(sim, resumes, error)
    type(simulation_t), intent(inout) :: sim !! ready for its first step
    logical, intent(in) :: resumes !! does the run go on from a checkpoint?
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when a file cannot be written

    if (sim%writers%is_root) call replace_file(sim%options%folder//'/effective.toml', sim%options%deck_text, error)
    call sim%comm%agree(error)
    if (allocated(error)) return
    call sim%writers%summary%add_file('deck', 'effective.toml')
    sim%writers%record%has_stages = sim%stages%number > 0
    sim%writers%tracks%has_stages = sim%stages%number > 0
    sim%writers%walls%has_stages = sim%stages%number > 0
    sim%writers%regions%has_stages = sim%stages%number > 0
    sim%writers%subdomains%has_stages = sim%stages%number > 0
    sim%writers%interfaces%has_stages = sim%stages%number > 0
    if (sim%options%record_every > 0) call open_record(sim, resumes, error)
    if (.not. allocated(error) .and. sim%options%record_every > 0 .and. allocated(sim%options%tracked)) then
      call sim%writers%tracks%open(sim%options%folder, sim%scene%dimension, merge(sim%step, -1, resumes), error)
      call sim%writers%summary%add_file('tracks', tracks_name)
    end if
    if (.not. allocated(error) .and. sim%cell%walls%count() > 0) then
      call sim%writers%walls%open(sim%options%folder, sim%scene%dimension, merge(sim%step, -1, resumes), error)
      call sim%writers%summary%add_file('walls', walls_name)
    end if
    if (.not. allocated(error) .and. sim%options%record_every > 0 .and. sim%regions%is_on()) then
      call sim%writers%regions%open(sim%options%folder, sim%scene%dimension, merge(sim%step, -1, resumes), error)
      call sim%writers%summary%add_file('regions', regions_name)
    end if
    if (.not. allocated(error) .and. sim%options%record_every > 0 .and. sim%subdomains%is_on) then
      call sim%writers%subdomains%open(sim%options%folder, sim%scene%dimension, merge(sim%step, -1, resumes), error)
      call sim%writers%summary%add_file('subdomains', subdomains_name)
    end if
    if (.not. allocated(error) .and. sim%options%record_every > 0 .and. sim%interfaces%is_on()) then
      call sim%writers%interfaces%open(sim%options%folder, sim%scene%dimension, merge(sim%step, -1, resumes), error)
      call sim%writers%summary%add_file('interfaces', interfaces_name)
    end if
    if (.not. allocated(error) .and. allocated(sim%fields)) call open_fields(sim, resumes, error)
    if (.not. allocated(error) .and. sim%options%has_trace) call open_trace(sim, resumes, error)
    call sim%comm%agree(error)
    if (allocated(error)) return
    if (sim%writers%has_pictures) call open_pictures(sim, resumes, error)
    if (allocated(error)) return
    call sim%writers%progress%start(output_unit, sim%step, sim%options%steps, trim(criterion_names(sim%options%solver%criterion)), &
                                    is_terminal() .and. sim%comm%size == 1, sim%options%is_quiet .or. .not. sim%writers%is_root, &
                                    sim%stages%number > 0)
  end subroutine open_files

  !> Note which files this run writes, and remove those of a former run in its folder; where this run goes on with them, run.json
  !! and tagged numbers alone.
  subroutine remove_former(sim, goes_on)
    type(simulation_t), intent(inout) :: sim !! its folder is claimed
    logical, intent(in) :: goes_on !! does the run go on with the files of its folder?

    sim%writers%has_pictures = sim%options%output_every > 0
    sim%writers%has_checkpoints = hdf5_is_available()
    if (sim%comm%rank > 0) return
    if (goes_on) then
      call remove_file(sim%options%folder//'/run.json')
      call remove_file(sim%options%folder//'/numbers.tag')
    else
      call remove_results(sim%options%folder)
    end if
  end subroutine remove_former

  !> Open the pictures, and draw the beginning of a run that begins.
  subroutine open_pictures(sim, resumes, error)
    type(simulation_t), intent(inout) :: sim
    logical, intent(in) :: resumes
    type(error_t), allocatable, intent(out) :: error

    if (sim%comm%size > 1 .and. sim%options%output_compressed .and. sim%writers%is_root) &
      write (error_unit, '(a)') 'warning: output.compression is ignored: several ranks write their pictures uncompressed'
    call sim%writers%pictures%open(sim%scene, sim%options, merge(sim%step, -1, resumes), error, sim%comm)
    if (allocated(error)) return
    call sim%writers%summary%add_file('bodies', 'bodies.vtkhdf')
    call sim%writers%summary%add_file('shapes', 'shapes.vtkhdf')
    call sim%writers%summary%add_file('contacts', 'contacts.vtkhdf')
    if (sim%interfaces%is_on()) call sim%writers%summary%add_file('interfaces_picture', interfaces_picture_name)
    if (.not. resumes) call sim%writers%pictures%write(sim%scene, sim%contacts, sim%time(), 0, sim%comm, error)
  end subroutine open_pictures

  !> Begin the files of fields, or go on with them, and name them in the summary.
  subroutine open_fields(sim, resumes, error)
    type(simulation_t), intent(inout) :: sim
    logical, intent(in) :: resumes
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    if (.not. hdf5_is_available()) then
      call fail(error, '[[field]] needs a program with HDF5')
      return
    end if
    if (.not. allocated(sim%writers%fields)) allocate (sim%writers%fields(size(sim%fields)))
    do i = 1, size(sim%fields)
      if (sim%writers%is_root .and. .not. allocated(error)) &
        call sim%writers%fields(i)%open(sim%options%folder//'/'//field_name(i), sim%fields(i), sim%options, &
                                        merge(sim%step, -1, resumes), error)
      call sim%writers%summary%add_file('field_'//to_text(i), field_name(i))
    end do
  end subroutine open_fields

  !> Begin the record, or go on with it, and name it in the summary.
  subroutine open_record(sim, resumes, error)
    type(simulation_t), intent(inout) :: sim
    logical, intent(in) :: resumes
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: file

    file = sim%options%folder//'/record.csv'
    call sim%writers%summary%add_file('record', 'record.csv')
    if (resumes) then
      call sim%writers%record%resume(file, sim%writers%measures, sim%step, error)
    else
      call sim%writers%record%start(file, sim%writers%measures, error)
    end if
  end subroutine open_record

  !> Begin the traces, or go on with them, and name them in the summary.
  subroutine open_trace(sim, resumes, error)
    type(simulation_t), intent(inout) :: sim
    logical, intent(in) :: resumes
    type(error_t), allocatable, intent(out) :: error

    call sim%writers%trace%open(sim%options%folder, traced_steps(sim%options%trace_steps, sim%options%steps), &
                            merge(sim%step, 0, resumes), error)
    call sim%writers%summary%add_file('trace', trace_file)
    call sim%writers%summary%add_file('trace_steps', steps_file)
  end subroutine open_trace

  !> Close the files of fields.
  subroutine close_fields(sim)
    type(simulation_t), intent(inout) :: sim !! ended, or at the end of a stage
    integer :: i

    if (.not. (allocated(sim%writers%fields) .and. sim%writers%is_root)) return
    do i = 1, size(sim%writers%fields)
      call sim%writers%fields(i)%close()
    end do
  end subroutine close_fields

  !> Close all files, write run.json and the tagged numbers; the first failure is returned.
  subroutine close_files(sim, error)
    type(simulation_t), intent(inout) :: sim !! ended
    type(error_t), allocatable, intent(out) :: error !! the first failure
    type(error_t), allocatable :: next
    character(len=:), allocatable :: file

    call close_fields(sim)
    if (sim%writers%has_pictures) call sim%writers%pictures%close(sim%comm, error)
    if (sim%writers%saved_step >= 0) then
      file = newest_restart(sim%options%folder)
      call sim%writers%summary%add_file('restart', file(len(sim%options%folder) + 2:))
    end if
    if (sim%options%has_spectrum) call sim%writers%samples%reduce(sim%comm)
    if (sim%writers%samples%n > 0 .and. sim%writers%is_root) then
      call write_spectrum(sim%writers%samples, sim%options%time_step, sim%options%folder//'/spectrum.csv', next)
      if (.not. allocated(next)) call sim%writers%summary%add_file('spectrum', 'spectrum.csv')
      if (.not. allocated(error) .and. allocated(next)) call move_alloc(next, error)
    end if
    if (sim%options%has_structure .and. sim%writers%has_stepped) then
      call report_structure(sim, next)
      call sim%writers%summary%add_file('radial_distribution', 'radial_distribution.csv')
      call sim%writers%summary%add_file('structure_factor', 'structure_factor.csv')
      if (.not. allocated(error) .and. allocated(next)) call move_alloc(next, error)
    end if
    call write_numbers(sim%writers%summary, sim%options%folder//'/numbers.tag', next)
    if (.not. allocated(error) .and. allocated(next)) call move_alloc(next, error)
    call write_run_summary(sim%writers%summary, sim%options%folder//'/run.json', next)
    if (.not. allocated(error) .and. allocated(next)) call move_alloc(next, error)
  end subroutine close_files
end module sg_run_files
