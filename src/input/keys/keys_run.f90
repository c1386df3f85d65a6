!> The key table, first part: what to do with a scene. Defaults are those of `run_options_t`.
module sg_keys_run
  use sg_key_table, only: key_table_t, value_bodies, value_body, value_box, value_choice, value_counts, value_integer, &
                          value_logical, value_real, value_text, value_texts
  use sg_field_options, only: field_options_t, kernel_names
  use sg_kinds, only: wp
  use sg_methods, only: coupling_names, list_couplings, list_solvers, method_t, solver_names
  use sg_run_options, only: criterion_names, default_recovery, energy_guards, run_options_t, split_names
  use sg_text, only: to_text
  use sg_words, only: choices_of, quoted_string, short_real, true_or_false
  implicit none
  private
  public :: add_run_keys

contains

  !> Add the sections time, stage, solver, partition, output, track, field, region, interface, stop, restart, guard and report.
  subroutine add_run_keys(table)
    type(key_table_t), intent(inout) :: table !! table to add to

    call add_time(table)
    call add_stages(table)
    call add_solver(table)
    call add_partition(table)
    call add_output(table)
  end subroutine add_run_keys

  !> Section time.
  subroutine add_time(table)
    type(key_table_t), intent(inout) :: table
    type(run_options_t) :: default

    call table%open_section('time', 'How long and how finely time is cut.')
    call table%add('step', value_real, 'Time step h.', unit='s', is_required=.true., above=0.0_wp)
    call table%add('steps', value_integer, 'Number of steps; in a deck with stages, which have their own, the most of all of '// &
                   'them together, and not needed.', is_required=.true., least=0.0_wp)
    call table%add('theta', value_real, 'Weight of the end of the step in the theta scheme; 0.5 is the mid-point rule.', &
                   default=short_real(default%theta), least=0.0_wp, most=1.0_wp)
    call table%add('substeps', value_integer, 'Substeps of a step: contacts are found once per step, and follow their bodies '// &
                   'from substep to substep, each of which solves them.', default=to_text(default%substeps), least=1.0_wp)
    call table%add('recovery', value_real, 'Overlap of two shapes, over the smaller one, from which on bodies are pushed '// &
                   'apart at the end of a step, until 0.4 of it is left; 0 for never.', &
                   default=short_real(default_recovery), least=0.0_wp, most=1.0_wp)
    call table%add('recovery_every', value_integer, 'Steps from one look for such overlap to the next.', &
                   default=to_text(default%recovery_every), least=1.0_wp)
  end subroutine add_time

  !> Section stage.
  subroutine add_stages(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('stage', 'One stage of a run: the stages follow each other, each from where the last one ended. '// &
                            '[stage.SECTION] and [[stage.SECTION]] below it hold the keys that differ in this stage '// &
                            '(guide/stages.md).', is_list=.true.)
    call table%add('name', value_text, 'Name of the stage, in the log and in run.json.')
    call table%add('steps', value_integer, 'Steps of the stage, at most.', least=1.0_wp)
    call table%add('duration', value_real, 'In place of steps: time of the stage, at most; rounded up to whole steps.', unit='s', &
                   above=0.0_wp)
    call table%add('until', value_texts, 'Conditions, as those of [stop], of which the first that holds ends the stage.')
    call table%add('for', value_integer, 'Recorded steps in a row in which a condition must hold.', default='1', least=1.0_wp, &
                   only='until')
    call table%add('after', value_real, 'Time from the start of the stage before which no condition is tested.', unit='s', &
                   default='0.0', least=0.0_wp, only='until')
  end subroutine add_stages

  !> Section solver.
  subroutine add_solver(table)
    type(key_table_t), intent(inout) :: table
    type(run_options_t) :: run
    integer :: i
    type(method_t), allocatable :: solvers(:)
    character(len=:), allocatable :: sweeps

    call list_solvers(solvers)
    sweeps = 'method='//choices_of(pack(solver_names(), [(allocated(solvers(i)%sweeps), i=1, size(solvers))]))
    associate (default => run%solver)
      call table%open_section('solver', 'How the contact problem of a step is solved, and when it counts as solved.')
      call table%add('method', value_choice, 'Solver: '//described(solvers)//'.', &
                     default=quoted_string(trim(default%method)), choices=choices_of(solver_names()))
      call table%add('criterion', value_choice, 'What must fall below the tolerance: the estimated error of the impulses, '// &
                     'a residual (e1, e2, e8), the velocity violation, or the increments that LMGC90 looks at (quad, maxm, '// &
                     'qm16).', &
                     default=quoted_string(trim(criterion_names(default%criterion))), choices=choices_of(criterion_names))
      call table%add('tolerance', value_real, 'Value of the criterion at which the solver stops.', &
                     default=short_real(default%tolerance), above=0.0_wp, most=1.0_wp)
      call table%add('check_every', value_integer, 'Sweeps between two tests of the criterion; 0 for tests that '// &
                     'come where the fall of the criterion lets it be reached.', default=to_text(default%check_every), &
                     least=0.0_wp, used_for=sweeps)
      call table%add('maximum_sweeps', value_integer, 'Sweeps after which the solver gives up on a step.', &
                     default=to_text(default%maximum_sweeps), least=1.0_wp)
      call table%add('relaxation', value_real, 'Share of each new impulse that is taken; 1 is plain Gauss-Seidel.', &
                     default=short_real(default%relaxation), above=0.0_wp, most=2.0_wp, used_for='method=nlgs')
      call table%add('warm_start', value_logical, 'Start from the impulses of the last step.', &
                     default=true_or_false(default%warm_start))
      call table%add('leave_solved', value_logical, 'In long solves, leave out clusters of contacts that are solved and touch '// &
                     'no other.', default=true_or_false(default%leave_solved), used_for=sweeps)
      call table%add('order', value_choice, 'Order of the sweep: natural (spatial), coloured groups that overlap, '// &
                     'coloured blocks of such groups, whose sweeps threads share, or shuffled (random, slower, for studies of '// &
                     'what order does).', default=quoted_string(trim(default%order)), choices='natural|groups|coloured|shuffled', &
                     used_for=sweeps)
      call table%add('order_seed', value_integer, 'Seed of the shuffled order.', default=to_text(default%order_seed), &
                     used_for='order=shuffled')
      call table%add('threads', value_integer, 'Threads that share the steps of each rank: detection, assembly and motion '// &
                     'of bodies, and in coloured order the sweeps; any number of them gives the same answer.', &
                     default=to_text(default%threads), least=1.0_wp, used_for=sweeps)
      call table%add('stop_unconverged', value_logical, 'End the run when a step does not converge.', &
                     default=true_or_false(default%stop_unconverged))
    end associate
  end subroutine add_solver

  !> Section partition.
  subroutine add_partition(table)
    type(key_table_t), intent(inout) :: table
    type(run_options_t) :: run
    type(method_t), allocatable :: couplings(:)
    integer :: i, first

    call list_couplings(couplings)
    associate (default => run%partition)
      call table%open_section('partition', 'How grains are split over ranks, and how their parts are glued; without a meaning '// &
                              'where there is one subdomain.')
      call table%add('parts', value_integer, 'Subdomains, dealt to the ranks in blocks of about equal numbers: any number of '// &
                     'ranks up to that gives the same answer, bit for bit; 0 for one per rank.', &
                     default=to_text(default%parts), least=0.0_wp, most=4096.0_wp)
      call table%add('split', value_choice, 'How grains are dealt to ranks: boxes of equal load, or METIS on the graph of '// &
                     'contacts.', default=quoted_string(trim(default%split)), choices=choices_of(split_names))
      call table%add('boxes', value_counts, 'Boxes along x, y and z, as many together as ranks; 0, or none given, where the '// &
                     'program chooses.', least=0.0_wp, most=1e6_wp, used_for='split=boxes')
      call table%add('gluing', value_choice, 'How parts are glued: '//described(couplings)//'.', &
                     default=quoted_string(trim(default%gluing)), choices=choices_of(coupling_names()), &
                     former=former_name(couplings))
      call table%add('sweeps', value_counts, 'Sweeps of a part between two gluings: one number for all parts, or one for each.', &
                     default='1', least=1.0_wp)
      call table%add('every', value_integer, 'Steps between repartitions; 0 for never, unless the imbalance asks '// &
                     'for it.', default=to_text(default%every), least=0.0_wp)
      call table%add('imbalance', value_real, 'Largest load of a rank over the mean one from which grains are repartitioned.', &
                     default=short_real(default%imbalance), above=1.0_wp)
    end associate
    do i = 1, size(couplings)
      first = table%n_keys
      call table%open_section('partition.'//trim(couplings(i)%name), 'Options of this gluing alone.', &
                              used_for='gluing='//trim(couplings(i)%name))
      call couplings(i)%coupled%visit_options(table)
      if (table%n_keys == first) call table%close_section()
    end do
  end subroutine add_partition

  !> The name of older decks that one of the methods has, as the key table writes it.
  pure function former_name(methods) result(rule)
    type(method_t), intent(in) :: methods(:)
    character(len=:), allocatable :: rule
    integer :: i

    i = findloc(methods%former /= '', .true., 1)
    rule = ''
    if (i > 0) rule = trim(methods(i)%former)//'='//trim(methods(i)%name)
  end function former_name

  !> Methods with what each is and needs: `nlgs (sweeps), auto (all others in turns; on one rank; with SuiteSparse)`.
  function described(methods) result(words)
    type(method_t), intent(in) :: methods(:)
    character(len=:), allocatable :: words
    integer :: i

    words = ''
    do i = 1, size(methods)
      if (i > 1) words = words//', '
      words = words//trim(methods(i)%name)//' ('//trim(methods(i)%sentence)
      if (methods(i)%runs_alone()) words = words//'; on one rank'
      if (methods(i)%needs_factors) words = words//', with SuiteSparse'
      words = words//')'
    end do
  end function described

  !> Sections output, track, stop, restart, guard and report.
  subroutine add_output(table)
    type(key_table_t), intent(inout) :: table
    type(run_options_t) :: default

    call table%open_section('output', 'What is written, and how often.')
    call table%add('every', value_integer, 'Steps between two pictures (VTKHDF); 0 for none.', &
                   default=to_text(default%output_every), least=0.0_wp)
    call table%add('record_every', value_integer, 'Steps between two rows of record.csv; 0 for none.', &
                   default=to_text(default%record_every), least=0.0_wp)
    call table%add('record_mean', value_logical, 'Record means over all steps since the last row next to values of one step: '// &
                   'kinetic energy, force on walls, pressure, stress, fabric, friction.', &
                   default=true_or_false(default%record_mean))
    call table%add('subdomain_means', value_logical, 'Write stress, fabric, compactness and velocity gradient of each '// &
                   'subdomain with each row of the record, in subdomains.csv (guide/regions.md).', &
                   default=true_or_false(default%has_subdomain_means))
    call table%add('precision', value_choice, 'Precision of the numbers in pictures.', &
                   default=merge('"single"', '"double"', default%output_single), choices='double|single')
    call table%add('compression', value_logical, 'Compress pictures: smaller files, slower writing.', &
                   default=true_or_false(default%output_compressed))
    call table%open_section('track', 'Bodies that are followed, one row each per recorded step in tracks.csv: place, velocity, '// &
                            'contact force and torque, works.', is_list=.true.)
    call table%add('body', value_body, 'Bodies, by name, in which * stands for any letters and ? for one, or by number. '// &
                   'The planes of a container "box" are box.floor, box.left and so on: its pattern is "box.*".', &
                   is_required=.true.)
    call add_fields(table)
    call add_regions(table)
    call add_interfaces(table)
    call table%open_section('stop', 'When a run ends before its last step: conditions on what is recorded, tested in each '// &
                            'recorded step. The first that holds ends it, with exit code 0.')
    call table%add('when', value_texts, 'Conditions of columns of record.csv and of tracked bodies: "max_velocity < 1e-4", '// &
                   '"displacement(sleeper) > 0.02 and time > 0.5".')
    call table%add('for', value_integer, 'Recorded steps in a row in which a condition must hold.', default='1', least=1.0_wp)
    call table%add('after', value_real, 'Time before which no condition is tested.', unit='s', default='0.0', least=0.0_wp)
    call table%open_section('restart', 'Checkpoints, from which a run can go on bit for bit.')
    call table%add('every', value_integer, 'Steps between two checkpoints; 0 for none.', &
                   default=to_text(default%restart_every), least=0.0_wp)
    call table%add('at_end', value_logical, 'Write a checkpoint after the last step, where the program has HDF5.', &
                   default=true_or_false(default%restart_at_end))
    call table%open_section('guard', 'What a run watches itself for; a value that is not finite always ends it.')
    call table%add('energy', value_choice, 'What to do when the energy balance does not close, looked at in each recorded '// &
                   'step: nothing, warn once (where theta is 0.5), or stop with exit code 6.', &
                   default=quoted_string(trim(default%guard%energy)), choices=choices_of(energy_guards))
    call table%add('energy_tolerance', value_real, 'Error of the balance over its largest term above which it counts as open.', &
                   default=short_real(default%guard%energy_tolerance), above=0.0_wp, used_for='energy=warn|stop')
    call table%open_section('report', 'Indicators that a run computes in addition to its record.')
    call table%add('spectrum', value_logical, 'Sample energy and momentum of the grains and wall forces at every step and '// &
                   'write their power spectra, spectrum.csv, at the end; needs FFTW.', default=true_or_false(default%has_spectrum))
    call table%add('structure', value_logical, 'Write the structure of the packing at the end: radial distribution g(r) and '// &
                   'structure factor S(k) of the centres of grains; needs FFTW.', default=true_or_false(default%has_structure))
    call table%add('structure_every', value_integer, 'Steps between two such structures; 0 for the end alone.', &
                   default=to_text(default%structure_every), least=0.0_wp, used_for='structure=true')
    call table%add('structure_box', value_box, 'Count but the grains of this box: [x least, y least, x most, y most], in space '// &
                   '[x least, y least, z least, x most, y most, z most]. Without it all '// &
                   'of them.', unit='m', used_for='structure=true')
    call table%add('trace', value_logical, 'Follow errors against CPU time within some steps, and end with a table of errors '// &
                   'reached and CPU time by phase: trace.csv, trace_steps.csv.', default=true_or_false(default%has_trace))
    call table%add('trace_steps', value_counts, 'Steps to trace; some spread over the run where none are given.', least=1.0_wp, &
                   used_for='trace=true')
  end subroutine add_output

  !> Section field.
  subroutine add_fields(table)
    type(key_table_t), intent(inout) :: table
    type(field_options_t) :: default

    call table%open_section('field', 'A coarse-grained field on the cells of a grid over a box, in field_1.vtkhdf and so on: '// &
                            'density, velocity and its gradient, stress, fabric.', is_list=.true.)
    call table%add('box', value_box, 'Box of the grid: [x least, y least, x most, y most], in space '// &
                   '[x least, y least, z least, x most, y most, z most].', unit='m', is_required=.true.)
    call table%add('cells', value_counts, 'Cells along each axis.', is_required=.true., least=1.0_wp, most=1e5_wp)
    call table%add('every', value_integer, 'Steps between two grids in the file.', is_required=.true., least=1.0_wp)
    call table%add('sample_every', value_integer, 'Steps between two samples, of which a grid is the mean; 0 for one sample, '// &
                   'that of its own step.', default=to_text(default%sample_every), least=0.0_wp)
    call table%add('kernel', value_choice, 'Kernel that spreads a grain or a contact: gaussian, cut off at three standard '// &
                   'deviations, or a box.', default=quoted_string(trim(kernel_names(default%kernel))), &
                   choices=choices_of(kernel_names))
    call table%add('width', value_real, 'Standard deviation of the gaussian, half side of the box; 0 for the longest side of a '// &
                   'cell.', unit='m', default=short_real(default%width), least=0.0_wp)
  end subroutine add_fields

  !> Section region.
  subroutine add_regions(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('region', 'A box in which indicators are measured, one row per recorded step in regions.csv: '// &
                            'volume error, compactness, coordination, contacts, velocities, pressure, inertia number '// &
                            '(guide/regions.md).', is_list=.true.)
    call table%add('name', value_text, 'Name in regions.csv; default: its number.')
    call table%add('box', value_box, 'The box, fixed in space: [x least, y least, x most, y most], in space '// &
                   '[x least, y least, z least, x most, y most, z most].', unit='m', is_required=.true.)
  end subroutine add_regions

  !> Section interface.
  subroutine add_interfaces(table)
    type(key_table_t), intent(inout) :: table

    call table%open_section('interface', 'Pairs of bodies of which the contacts have resultants, one row per pair and recorded '// &
                            'step in interfaces.csv, and in pictures: normal and tangential force, moment, centre of pressure, '// &
                            'eccentricity, area (guide/interfaces.md). Without a key all pairs.', is_list=.true.)
    call table%add('between', value_bodies, 'The two bodies, by name, in which * stands for any letters and ? for one, or by '// &
                   'number: all pairs of a body of the first pattern and one of the second.')
    call table%add('colours', value_texts, 'In place of bodies: two colours of shapes, or "any".')
  end subroutine add_interfaces
end module sg_keys_run
