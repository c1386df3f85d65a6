!> Verdict at the end of a run: status, errors, cost, files.
module sg_verdict
  use sg_columns, only: fixed
  use sg_kinds, only: wp, i8
  use sg_measures, only: measures_t
  use sg_methods, only: find_method, is_swept, list_couplings, method_t, quoted_names, robust_solver
  use sg_moments_of_run, only: hint_words, moment_t, place_words
  use sg_print, only: print_line
  use sg_run_summary, only: ranks_words, run_summary_t, shared_cost_t
  use sg_stages, only: stage_t
  use sg_system, only: peak_memory_bytes
  use sg_text, only: counted, joined, text_t, to_text
  use sg_totals, only: n_phases, phase_names, phase_solve, totals_t, worst_contact_words
  implicit none
  private
  public :: print_verdict

  !> Values from which on a line names where they were found: violation in g h, penetration in mean radii
  real(wp), parameter :: least_violation = 0.1_wp, least_penetration = 1e-3_wp

contains

  !> Print about ten lines on a run that has ended.
  subroutine print_verdict(unit, summary)
    integer, intent(in) :: unit !! open unit to write on
    type(run_summary_t), intent(in) :: summary !! the run, concluded
    character(len=:), allocatable :: headline
    integer :: i

    if (.not. summary%is_root) return
    associate (totals => summary%totals, measures => summary%measures)
      headline = summary%status//': '//to_text(totals%steps)//' of '//to_text(summary%steps_asked)//' steps, time '// &
                 to_text(summary%time, 4)//' s, '//counted(summary%grains%n, 'grain')//', '// &
                 counted(totals%contacts, 'contact')
      if (len(summary%reason) > 0) headline = headline//' ('//summary%reason//')'
      call print_line(headline, unit)
      do i = 1, summary%stages%number
        call line(merge('stages', '      ', i == 1), stage_words(summary%stages%list(i), i))
      end do
      call line('converged', to_text(totals%converged_steps)//' of '//to_text(totals%steps)//' steps to '// &
                summary%criterion//' <= '//to_text(summary%tolerance, 2))
      if (totals%unconverged_steps > 0) then
        if (totals%worst_step > 0) call line('worst step', to_text(totals%worst_step)//': '// &
                                             worst_contact_words(totals, summary%fall_speed))
        call line('try', advice(summary))
      end if
      call line('worst errors', 'e1 '//to_text(totals%worst_e1, 2)//', e2 '//to_text(totals%worst_e2, 2)//', e8 '// &
                to_text(totals%worst_e8, 2)//', violation '//to_text(totals%worst_violation, 2)//' g h')
      if (totals%worst_violation > least_violation .and. allocated(summary%violation_bodies)) &
        call line('violation', moment_words(totals%violation_at, summary%dimension, summary%violation_bodies))
      call line('penetration', penetration_words(totals%worst_penetration, summary%grains%mean_radius)// &
                '; at the end '//to_text(measures%get('max_penetration'), 2)//' m, volume error '// &
                percent(measures%get('volume_error')))
      if (totals%worst_penetration > least_penetration*summary%grains%mean_radius .and. allocated(summary%penetration_bodies)) &
        call line('deepest', moment_words(totals%penetration_at, summary%dimension, summary%penetration_bodies))
      if (totals%fast_steps > 0) then
        call line('too fast', 'in '//to_text(totals%fast_steps)//' steps a body moved farther than the alert distance: '// &
                  'contacts may have been missed; take shorter steps or a larger alert')
      end if
      if (totals%tunnellings > 0) then
        call line('passed', &
                  to_text(totals%tunnellings)//' times two bodies went through each other within a step: take shorter ones')
      end if
      if (measures%get('waiting') + measures%get('entered') + measures%get('removed') > 0) &
        call line('bodies', passage_words(measures))
      if (totals%recoveries > 0) call line('recovered', 'bodies were pushed apart after '//counted(totals%recoveries, 'step'))
      call line('energy', to_text(measures%get('kinetic_energy'), 3)//' J kinetic, balance closed to '// &
                to_text(measures%get('energy_closure'), 2)//' of its largest term')
      if (summary%grains%n == 0) then
        call line('packing', 'not measured: there is no grain, all bodies are walls (driven or pressed)')
      else
        call line('packing', 'compactness '//fixed(measures%get('compactness'), 3)//', coordination '// &
                  fixed(measures%get('coordination'), 2)//', walls carry '//percent(measures%get('floor_share'))// &
                  ' of the weight')
      end if
      call line('cost', fixed(totals%clock%cpu, 2)//' s CPU ('//phase_words(totals)//'), '//fixed(totals%clock%wall, 2)//' s wall')
      call line('start', fixed(summary%start_cpu, 2)//' s CPU, '//fixed(summary%start_wall, 2)//' s wall, for deck and scene'// &
                start_words(summary))
      call line('solver', effort_words(totals, is_swept(summary%method)))
      if (summary%subdomains > 1) then
        call line('ranks', ranks_words(summary%subdomains, summary%ranks)//' by '//split_words(summary))
        call line('gluing', gluing_words(summary))
        if (summary%shared%factorisations > 0) call line('interface', interface_words(summary%shared, summary%subdomains))
      end if
      call line('memory', memory_words(summary)//', '//to_text(nint(totals%bytes_per_contact))// &
                ' bytes per contact in the contact problem')
      if (allocated(summary%files)) call line('files', file_words(summary%files)//' in '//summary%folder)
    end associate

  contains

    !> One line with its title.
    subroutine line(title, text)
      character(len=*), intent(in) :: title, text
      character(len=14) :: column

      column = title
      call print_line('  '//column//text, unit)
    end subroutine line
  end subroutine print_verdict

  !> Bodies that entered, wait or left, and their masses.
  pure function passage_words(measures) result(words)
    type(measures_t), intent(in) :: measures
    character(len=:), allocatable :: words

    words = to_text(nint(measures%get('entered')))//' entered ('//to_text(measures%get('mass_entered'), 3)//' kg), '// &
            to_text(nint(measures%get('waiting')))//' wait, '//to_text(nint(measures%get('removed')))//' were removed ('// &
            to_text(measures%get('mass_removed'), 3)//' kg)'
  end function passage_words

  !> How a stage went.
  pure function stage_words(stage, number) result(words)
    type(stage_t), intent(in) :: stage
    integer, intent(in) :: number
    character(len=:), allocatable :: words

    words = stage%words(number)//': '//counted(stage%last_step - stage%first_step, 'step')//' to '//to_text(stage%end_time, 4)// &
            ' s, '//to_text(stage%unconverged)//' not converged; '//stage%reason()
  end function stage_words

  !> Step, time, bodies, place and cause of a worst value.
  pure function moment_words(moment, dimension, bodies) result(words)
    type(moment_t), intent(in) :: moment
    integer, intent(in) :: dimension
    character(len=*), intent(in) :: bodies
    character(len=:), allocatable :: words

    words = 'step '//to_text(moment%step)//' ('//to_text(moment%time, 4)//' s), '//bodies//' at '//place_words(moment, dimension)
    if (hint_words(moment) /= '') words = words//': '//hint_words(moment)
  end function moment_words

  !> What may help where steps did not converge.
  function advice(summary) result(words)
    type(run_summary_t), intent(in) :: summary
    character(len=:), allocatable :: words

    if (summary%subdomains > 1) then
      words = coupling_advice(summary%shared%gluing)
      if (.not. summary%has_bonds) words = words//'; on one rank solver.method = "'//robust_solver//'"'
    else if (summary%has_bonds) then
      ! Their scenes are swept, whatever the method.
      words = 'a larger solver.maximum_sweeps'
    else if (is_swept(summary%method)) then
      words = 'solver.method = "'//robust_solver//'", which goes on where sweeps stall, or a larger solver.maximum_sweeps'
    else
      words = 'a larger solver.maximum_sweeps (iterations), or a shorter time step'
    end if
    if (summary%has_bonds) words = words//'; a shorter time.step where the damage of bonds does not settle, or, of '// &
                                   '"IQS_MAC_CZM", a larger damage_viscosity'
  end function advice

  !> The same on several ranks.
  function coupling_advice(gluing) result(words)
    character(len=*), intent(in) :: gluing
    character(len=:), allocatable :: words
    type(method_t), allocatable :: couplings(:)
    integer :: i

    call list_couplings(couplings)
    i = find_method(couplings, gluing)
    if (couplings(i)%caution == '') then
      words = 'a larger solver.maximum_sweeps or a shorter time step'
    else
      words = 'partition.gluing = '//quoted_names(couplings, couplings%caution == '')//': "'//gluing//'" '// &
              trim(couplings(i)%caution)
    end if
  end function coupling_advice

  !> How the scene was split, and how evenly.
  pure function split_words(summary) result(words)
    type(run_summary_t), intent(in) :: summary
    character(len=:), allocatable :: words

    words = ''
    associate (shared => summary%shared)
      if (allocated(shared%split)) words = shared%split
      words = words//', '//counted(shared%splits, 'split')//', '//to_text(nint(shared%moved, i8))//' bodies moved'
      associate (at => shared%imbalance_at_splits)
        if (shared%splits > 1) words = words//' (imbalance of loads '//fixed(at(1), 2)//' before, '//fixed(at(2), 2)//' after)'
      end associate
      words = words//'; '// &
              'contact updates '//to_text(nint(shared%least_updates, i8))//' to '//to_text(nint(shared%most_updates, i8))// &
              ' per '//trim(unit_word(summary))//', imbalance '//fixed(shared%imbalance, 2)
    end associate
  end function split_words

  !> How often decks are read and scenes made.
  pure function start_words(summary) result(words)
    type(run_summary_t), intent(in) :: summary
    character(len=:), allocatable :: words

    words = ''
    if (summary%subdomains > 1) words = ' by each of '//to_text(summary%subdomains)//' subdomains'
    if (summary%stages%number > 1) words = words//', again in each stage'
  end function start_words

  !> What gluing cost.
  pure function gluing_words(summary) result(words)
    type(run_summary_t), intent(in) :: summary
    character(len=:), allocatable :: words

    words = ''
    associate (shared => summary%shared)
      if (allocated(shared%gluing)) words = shared%gluing//', '
      words = words//to_text(shared%gluings)//' gluings of '//fixed(shared%messages, 1)//' messages and '// &
              fixed(shared%bytes/1e3_wp, 1)//' kB; a '//trim(unit_word(summary))//' waited '//fixed(shared%mean_wait, 2)// &
              ' s in the mean, '//fixed(shared%most_wait, 2)//' s at most'
    end associate
  end function gluing_words

  !> What systems of the interface cost, and how often they failed.
  pure function interface_words(shared, subdomains) result(words)
    type(shared_cost_t), intent(in) :: shared
    integer, intent(in) :: subdomains
    character(len=:), allocatable :: words

    associate (solves => real(max(1_i8, shared%solves), wp))
      words = fixed(real(shared%iterations, wp)/solves, 1)//' iterations and '// &
              fixed(real(shared%factorisations, wp)/solves/real(subdomains, wp), 1)//' factorisations of a subdomain per step'
    end associate
    if (shared%failed_systems + shared%failed_factors == 0) return
    words = words//'; '//to_text(shared%failed_systems)//' systems did not converge and '//to_text(shared%failed_factors)// &
            ' matrices had no factor: the dual method went on there'
  end function interface_words

  !> What shares the work: ranks, or their subdomains.
  pure character(len=9) function unit_word(summary)
    type(run_summary_t), intent(in) :: summary

    unit_word = merge('rank     ', 'subdomain', summary%ranks == summary%subdomains)
  end function unit_word

  !> Memory of the program, or of the largest rank and of all.
  function memory_words(summary) result(words)
    type(run_summary_t), intent(in) :: summary
    character(len=:), allocatable :: words

    if (summary%ranks == 1) then
      words = megabytes(peak_memory_bytes())
    else
      words = megabytes(nint(summary%shared%most_memory, i8))//' the largest rank, '// &
              megabytes(nint(summary%shared%all_memory, i8))//' all'
    end if
  end function memory_words

  !> Names of the files, and how many more there are (dumps of many steps).
  pure function file_words(files) result(words)
    type(text_t), intent(in) :: files(:)
    character(len=:), allocatable :: words
    integer, parameter :: most = 8

    words = joined(files(:min(most, size(files))), ', ')
    if (size(files) > most) words = words//' and '//to_text(size(files) - most)//' more'
  end function file_words

  !> The deepest penetration, absolute and over the mean radius.
  pure function penetration_words(deepest, radius) result(words)
    real(wp), intent(in) :: deepest, radius
    character(len=:), allocatable :: words

    words = to_text(deepest, 2)//' m at the deepest contact of all steps'
    if (radius > 0) words = words//', '//percent(deepest/radius)//' of the mean radius'
  end function penetration_words

  !> Share of the CPU time by phase, those above one percent.
  pure function phase_words(totals) result(words)
    type(totals_t), intent(in) :: totals
    character(len=:), allocatable :: words
    real(wp) :: share
    integer :: i

    words = ''
    do i = 1, n_phases
      share = totals%phase(i)%cpu/max(totals%clock%cpu, tiny(share))
      if (share < 0.01_wp) cycle
      if (len(words) > 0) words = words//', '
      words = words//trim(phase_names(i))//' '//percent(share)
    end do
  end function phase_words

  !> Sweeps per step, and contact updates per CPU second of the solver; of solvers that do more than sweep, iterations.
  pure function effort_words(totals, sweeps) result(words)
    type(totals_t), intent(in) :: totals
    logical, intent(in) :: sweeps
    character(len=:), allocatable :: words

    words = fixed(real(totals%sweeps, wp)/real(max(1, totals%steps), wp), 1)//merge(' sweeps    ', ' iterations', sweeps)
    words = trim(words)//' per step'
    if (.not. sweeps) return
    words = words//', '// &
            to_text(totals%contact_updates)//' contact updates'
    if (.not. totals%phase(phase_solve)%cpu > 0) return
    words = words//', '//fixed(real(totals%contact_updates, wp)/totals%phase(phase_solve)%cpu/1e6_wp, 1)// &
            ' million per CPU second'
  end function effort_words

  !> A share as a percentage.
  pure function percent(share) result(word)
    real(wp), intent(in) :: share
    character(len=:), allocatable :: word

    word = fixed(100*share, 2)//' %'
  end function percent

  !> Bytes as megabytes.
  pure function megabytes(bytes) result(word)
    integer(i8), intent(in) :: bytes
    character(len=:), allocatable :: word

    word = to_text(nint(real(bytes, wp)/1e6_wp))//' MB'
  end function megabytes
end module sg_verdict
