!> Output due after a step: record, spectra, structure, pictures, checkpoints, progress.
module sg_after_step
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_body_energy, only: kinetic_energy
  use sg_cell, only: cell_columns
  use sg_centres, only: centres_t, take_centres
  use sg_checkpoint, only: save_once
  use sg_contactors, only: place_all_corners
  use sg_error, only: error_t
  use sg_guard, only: judge_energy
  use sg_kinds, only: wp
  use sg_measures, only: measure, measures_t, unmeasured
  use sg_passage_counts, only: count_passages, n_passage_sums, passage_columns
  use sg_radial_distribution, only: radial_distribution, radial_distribution_t
  use sg_record, only: record_columns
  use sg_report, only: report_t
  use sg_simulation, only: simulation_t
  use sg_stop, only: stop_variables
  use sg_structure_factor, only: structure_factor, structure_factor_t
  use sg_system, only: checkpoint_requested
  use sg_tally, only: column_t
  use sg_text, only: text_t
  use sg_timed, only: timed
  use sg_totals, only: phase_measure, phase_output, reduce_report, totals_t
  implicit none
  private
  public :: begin_stop, blank_measures, measure_now, report_structure, write_due

contains

  !> Record, draw, save and print what is due after a step. Collective.
  subroutine write_due(sim, error)
    type(simulation_t), intent(inout) :: sim !! after a step
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when the run must end
    type(error_t), allocatable :: late
    logical :: records, draws

    if (sim%options%has_spectrum) call timed(sample_now, sim, phase_measure, error)
    if (sim%options%has_structure .and. is_due(sim, sim%options%structure_every)) call report_structure(sim, error)
    if (allocated(sim%fields) .and. .not. allocated(error)) call timed(sample_fields, sim, phase_measure, error)
    if (allocated(error)) return
    records = sim%options%record_every > 0 .and. (is_due(sim, sim%options%record_every) .or. is_last(sim))
    draws = sim%writers%has_pictures .and. (is_due(sim, sim%options%output_every) .or. is_last(sim))
    if (sim%interfaces%is_on() .and. (records .or. draws)) call timed(measure_interfaces, sim, phase_measure, error)
    if (records) then
      call timed(measure_now, sim, phase_measure, error)
      if (sim%tracks%is_on()) call timed(measure_tracks, sim, phase_measure, error)
      if (sim%regions%is_on()) call timed(measure_regions, sim, phase_measure, error)
      if (sim%subdomains%is_on) call timed(measure_subdomains, sim, phase_measure, error)
      call watch_energy(sim, error)
      call timed(record_now, sim, phase_output, late)
      if (.not. allocated(error) .and. allocated(late)) call move_alloc(late, error)
    end if
    call timed(write_files, sim, phase_output, error)
  end subroutine write_due

  !> Pictures, checkpoint and progress line, where they are due.
  subroutine write_files(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: none

    associate (writers => sim%writers)
      if (writers%has_pictures .and. (is_due(sim, sim%options%output_every) .or. is_last(sim))) &
        call writers%pictures%write(sim%scene, sim%contacts, sim%time(), sim%step, sim%comm, error, &
                                    interfaces=sim%interfaces)
      if (.not. allocated(error) .and. writers%has_checkpoints) then
        ! From the last checkpoint a run that is killed before its files are closed closes them with these measures.
        if (is_last(sim)) call timed(measure_now, sim, phase_measure, none)
        if (is_due(sim, sim%options%restart_every) .or. (is_last(sim) .and. sim%options%restart_at_end) .or. &
            sim%comm%any(checkpoint_requested())) call save_once(sim, error)
      end if
      if (writers%progress%is_due()) &
        call writers%progress%show(sim%step, sim%time(), sim%all_contacts, sim%report, present_energy(sim))
    end associate
  end subroutine write_files

  !> Is output due after this step that is written every so many steps?
  pure logical function is_due(sim, every)
    type(simulation_t), intent(in) :: sim
    integer, intent(in) :: every

    is_due = .false.
    if (every > 0) is_due = mod(sim%step, every) == 0
  end function is_due

  !> Is this step the last one of the run?
  pure logical function is_last(sim)
    type(simulation_t), intent(in) :: sim

    is_last = sim%step == sim%options%steps .or. sim%stop%met > 0
  end function is_last

  !> Do the energies just measured, which all ranks have, end the run, or ask for a warning?
  subroutine watch_energy(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: warning
    logical :: has_warned

    ! With another theta positions move otherwise than works are summed: the balance is open by the order of the step.
    has_warned = sim%writers%has_warned .or. abs(sim%options%theta - 0.5_wp) > 0
    call judge_energy(sim%writers%measures, sim%options%guard, sim%step, has_warned, warning, error)
    if (len(warning) == 0) return
    sim%writers%has_warned = .true.
    if (sim%writers%is_root) write (error_unit, '(a)') 'warning: '//warning
  end subroutine watch_energy

  !> Add a row to the record, and one per tracked body, wall, region, subdomain and interface to theirs; test the end conditions.
  subroutine record_now(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    type(report_t) :: report
    type(totals_t) :: totals
    type(column_t), allocatable :: columns(:)

    call sim%totals%tick()
    report = sim%report
    totals = sim%totals
    call reduce_report(report, sim%comm)
    call totals%reduce(sim%comm)
    columns = record_columns(sim%step, sim%time(), sim%all_contacts, report, totals, sim%writers%measures, sim%stages%number)
    call sim%writers%record%add(columns, error)
    if (allocated(sim%options%tracked) .and. .not. allocated(error)) &
      call sim%writers%tracks%add(sim%step, sim%time(), sim%tracks, sim%stages%number, error)
    if (sim%cell%walls%count() > 0 .and. .not. allocated(error)) &
      call sim%writers%walls%add(sim%step, sim%time(), sim%scene%dimension, sim%tracks, sim%cell, sim%stages%number, error)
    if (sim%regions%is_on() .and. .not. allocated(error)) &
      call sim%writers%regions%add(sim%step, sim%time(), sim%scene%dimension, sim%regions, sim%stages%number, error)
    if (sim%subdomains%is_on .and. .not. allocated(error)) &
      call sim%writers%subdomains%add(sim%step, sim%time(), sim%subdomains, sim%stages%number, error)
    if (sim%interfaces%is_on() .and. .not. allocated(error)) &
      call sim%writers%interfaces%add(sim%step, sim%time(), sim%interfaces, sim%stages%number, error)
    sim%means%is_recorded = .true.
    call sim%comm%agree(error)
    if (sim%stop%is_on() .and. .not. allocated(error)) call test_end(sim, columns)
  end subroutine record_now

  !> Test the end conditions on the columns of the record and of the tracked bodies. Collective.
  subroutine test_end(sim, columns)
    type(simulation_t), intent(inout) :: sim
    type(column_t), intent(in) :: columns(:)
    real(wp), allocatable :: values(:)

    values = columns%value
    if (sim%tracks%is_on()) values = [values, reshape(sim%tracks%value, [size(sim%tracks%value)])]
    call sim%stop%test(sim%time(), values, sim%comm)
  end subroutine test_end

  !> Names of the values that end conditions may use.
  function end_variables(sim, columns) result(names)
    type(simulation_t), intent(in) :: sim !! a started simulation
    type(column_t), intent(in) :: columns(:) !! of its record
    type(text_t), allocatable :: names(:)

    if (sim%tracks%is_on()) then
      names = stop_variables(columns, sim%scene%dimension, sim%tracks%name)
    else
      names = stop_variables(columns, sim%scene%dimension, [text_t ::])
    end if
  end function end_variables

  !> Make the end conditions of a started simulation ready.
  subroutine begin_stop(sim, error)
    type(simulation_t), intent(inout) :: sim !! started
    type(error_t), allocatable, intent(out) :: error !! set where one names a column that the run does not record
    type(report_t) :: report
    type(totals_t) :: totals

    if (.not. sim%stop%is_on()) return
    call sim%stop%begin(end_variables(sim, record_columns(0, 0.0_wp, 0, report, totals, blank_measures(sim), &
                                                          sim%stages%number)), error)
  end subroutine begin_stop

  !> Indicators of a started simulation before the first measure.
  function blank_measures(sim) result(measures)
    type(simulation_t), intent(in) :: sim !! started
    type(measures_t) :: measures

    measures = unmeasured(sim%scene%dimension, sim%plan%has_bonds, sim%means%is_on, sim%plan%body_kinds, sim%plan%has_rolling)
    measures%column = [measures%column, cell_columns(sim%cell, sim%scene%dimension)]
    if (sim%scene%bodies%has_presence) measures%column = [measures%column, passage_columns(spread(0.0_wp, 1, n_passage_sums))]
  end function blank_measures

  !> Kinetic energy to show [J]: that of now on one rank; of several ranks the last one measured, which costs no message.
  real(wp) function present_energy(sim)
    type(simulation_t), intent(in) :: sim

    if (sim%comm%size == 1) then
      present_energy = kinetic_energy(sim%scene%bodies)
    else
      present_energy = sim%writers%measures%get('kinetic_energy')
    end if
  end function present_energy

  !> Add the velocities of this step to the samples of spectra.
  subroutine sample_now(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call sim%writers%samples%add(sim%scene, sim%contacts, sim%options%substep_length())
  end subroutine sample_now

  !> Sample the coarse-grained fields, and write those that are due. Collective.
  subroutine sample_fields(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: values(:, :)
    integer :: i

    do i = 1, size(sim%fields)
      associate (field => sim%fields(i))
        if (field%wants_sample(sim%step)) call field%add_sample(sim%scene, sim%contacts, sim%options%substep_length())
        if (.not. field%is_due(sim%step)) cycle
        call field%finish(sim%comm, values)
        if (sim%writers%is_root .and. .not. allocated(error)) &
          call sim%writers%fields(i)%add(field, values, sim%step, sim%time(), error)
      end associate
    end do
    call sim%comm%agree(error)
  end subroutine sample_fields

  !> Add the present structure to its files, unless it is in them. Collective.
  subroutine report_structure(sim, error)
    type(simulation_t), intent(inout) :: sim !! between two steps
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when a file cannot be written

    if (sim%writers%structure%step == sim%step) return
    call timed(add_structure, sim, phase_measure, error)
    call timed(write_structure, sim, phase_output, error)
  end subroutine report_structure

  !> Add the present structure to the texts of its files. Collective.
  subroutine add_structure(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    type(centres_t) :: centres
    type(radial_distribution_t) :: distribution
    type(structure_factor_t) :: factor

    call take_centres(sim%scene, sim%options%structure_box, sim%comm, centres)
    call radial_distribution(centres, sim%comm, distribution)
    call structure_factor(centres, sim%comm, factor)
    call sim%writers%structure%add(sim%step, sim%time(), centres%diameter, distribution, factor)
  end subroutine add_structure

  !> Write both files. Collective.
  subroutine write_structure(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    if (sim%writers%is_root) call sim%writers%structure%write(sim%options%folder, error)
    call sim%comm%agree(error)
  end subroutine write_structure

  !> Measure the tracked bodies. Collective.
  subroutine measure_tracks(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call sim%tracks%measure(sim%scene, sim%comm)
  end subroutine measure_tracks

  !> Measure the indicators in the regions. Collective.
  subroutine measure_regions(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call place_all_corners(sim%scene%contactors)
    call sim%regions%measure(sim%scene, sim%contacts, sim%options%substep_length(), sim%decomposition%subdomain, sim%comm)
  end subroutine measure_regions

  !> Measure the means of all subdomains. Collective.
  subroutine measure_subdomains(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call place_all_corners(sim%scene%contactors)
    call sim%subdomains%measure(sim%scene, sim%contacts, sim%options%substep_length(), sim%comm)
  end subroutine measure_subdomains

  !> Measure the interfaces of pairs of bodies. Collective.
  subroutine measure_interfaces(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    call place_all_corners(sim%scene%contactors)
    call sim%interfaces%measure(sim%scene, sim%contacts, sim%options%substep_length(), sim%comm)
  end subroutine measure_interfaces

  !> Measure all indicators. Collective.
  subroutine measure_now(sim, error)
    type(simulation_t), intent(inout) :: sim !! after a step; its measures are set
    type(error_t), allocatable, intent(out) :: error !! never set

    if (sim%writers%measured_step == sim%step) return
    call take_measures(sim)
    sim%writers%measured_step = sim%step
  end subroutine measure_now

  !> Take all measures of the present step.
  subroutine take_measures(sim)
    type(simulation_t), intent(inout) :: sim
    real(wp) :: sums(n_passage_sums)

    call place_all_corners(sim%scene%contactors)
    call measure(sim%scene, sim%contacts, sim%options%substep_length(), sim%energy, sim%writers%measures, &
                 sim%decomposition%subdomain, sim%comm, sim%means, sim%plan%body_kinds)
    associate (measures => sim%writers%measures)
      if (sim%cell%walls%has_cell) then
        call sim%cell%measure(sim%scene, sim%comm)
        measures%column = [measures%column, cell_columns(sim%cell, sim%scene%dimension)]
      end if
      if (.not. sim%scene%bodies%has_presence) return
      call count_passages(sim%scene, sim%comm, sums)
      measures%column = [measures%column, passage_columns(sums)]
    end associate
  end subroutine take_measures
end module sg_after_step
