!> run.json: one flat object with the identity of a run, its end and its results (doc/guide/results.md).
module sg_run_summary
  use sg_comm, only: comm_t
  use sg_error, only: error_t
  use sg_grains, only: count_grains, grains_t
  use sg_json, only: json_t
  use sg_kinds, only: wp, i8
  use sg_measures, only: measures_t, unmeasured
  use sg_moments_of_run, only: hint_words, moment_t
  use sg_report, only: coupled_effort_t
  use sg_run_options, only: criterion_names, run_options_t
  use sg_scene, only: largest_gravity, scene_t
  use sg_stages, only: stages_t
  use sg_system, only: peak_memory_bytes
  use sg_tally, only: column_t
  use sg_text, only: counted, text_t, to_text
  use sg_text_files, only: replace_file
  use sg_totals, only: n_phases, phase_names, totals_t
  use sg_version, only: commit, version
  implicit none
  private
  public :: run_summary_t, shared_cost_t, write_run_summary, ranks_words, run_done, run_failed, run_stopped, run_not_converged

  !> Words for how a run ended: all steps done, an error, stopped on request with a checkpoint, and ended because a
  !! step did not converge
  character(len=*), parameter :: run_done = 'done', run_failed = 'failed', run_stopped = 'stopped', &
                                 run_not_converged = 'not converged'

  !> How a scene was shared between ranks, and what that cost
  type :: shared_cost_t
    !> How grains were split and how their parts were glued, in the deck's words
    character(len=:), allocatable :: split, gluing
    !> Splits made, and bodies that changed owner in all of them
    integer :: splits = 0
    real(wp) :: moved = 0
    !> Largest load of a rank over the mean one, before and after a split: mean over all splits but the first
    real(wp) :: imbalance_at_splits(2) = 1
    !> Of all solves: gluings, iterations of the interface, interface systems without convergence; of all subdomains together,
    !! factorisations of their matrices, and those that failed
    integer(i8) :: solves = 0, gluings = 0, iterations = 0, failed_systems = 0, factorisations = 0, failed_factors = 0
    !> Contact updates of a subdomain: fewest, mean and most; imbalance: most over mean
    real(wp) :: least_updates = 0, mean_updates = 0, most_updates = 0, imbalance = 1
    !> Messages and bytes that all subdomains together send at a gluing, in the mean
    real(wp) :: messages = 0, bytes = 0
    !> Wall seconds that a subdomain waited for others: mean and most; 0 where all share one process
    real(wp) :: mean_wait = 0, most_wait = 0
    !> Largest memory of a rank, and of all ranks together [byte]
    real(wp) :: most_memory = 0, all_memory = 0
  contains
    procedure :: collect => cost_collect
  end type shared_cost_t

  !> Content of run.json
  type :: run_summary_t
    !> Does this rank write it, and the other texts of a run? Of ranks that share a run one alone does
    logical :: is_root = .true.
    !> Where ranks share the scene: how, and what that cost
    type(shared_cost_t) :: shared
    !> How the run ended, one of `run_*`, and the reason in one sentence (empty when all steps are done)
    character(len=:), allocatable :: status, reason
    !> The end condition that ended the run, where one did; when, and the value of its first variable
    character(len=:), allocatable :: stop_condition
    real(wp) :: stop_time = 0, stop_value = 0
    !> Stages of the run
    type(stages_t) :: stages
    !> Path, title, purpose and hash of the deck, folder of the results, solver, name of the stopping criterion
    character(len=:), allocatable :: deck, title, about, deck_hash, folder, method, criterion
    !> What a step of free fall brings [m/s]
    real(wp) :: fall_speed = 0
    !> Tolerance of the stopping criterion
    real(wp) :: tolerance = 0
    !> Dimension of space, number of ranks and of the subdomains that they share, bodies, and steps asked
    integer :: dimension = 2, ranks = 1, subdomains = 1, bodies = 0, steps_asked = 0
    !> Are there cohesive zones? Do laws in use resist rolling?
    logical :: has_bonds = .false., has_rolling = .false.
    !> The grains
    type(grains_t) :: grains
    !> Time reached [s]
    real(wp) :: time = 0
    !> Cost and convergence
    type(totals_t) :: totals
    !> Decks read and scenes made: CPU seconds of all ranks together, wall seconds of the slowest
    real(wp) :: start_cpu = 0, start_wall = 0
    !> Indicators of the last measure
    type(measures_t) :: measures
    !> Bodies of the deepest penetration and of the largest violation, by name or number
    character(len=:), allocatable :: penetration_bodies, violation_bodies
    !> Files written: what they hold and their names
    type(text_t), allocatable :: file_keys(:), files(:)
  contains
    procedure :: describe => summary_describe
    procedure :: add_file => summary_add_file
    procedure :: conclude => summary_conclude
    procedure :: columns => summary_columns
  end type run_summary_t

contains

  !> Set the identity of a run; until `conclude` the run counts as failed.
  subroutine summary_describe(self, scene, options, deck, comm)
    class(run_summary_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! what exists, or the part of this rank
    type(run_options_t), intent(in) :: options !! what is done with it
    character(len=*), intent(in) :: deck !! path of the deck
    type(comm_t), intent(inout) :: comm !! the ranks, all of which call this

    self%status = run_failed
    self%reason = 'the run did not come to its end'
    self%deck = deck
    if (allocated(options%title)) self%title = options%title
    if (allocated(options%about)) self%about = options%about
    if (allocated(options%deck_hash)) self%deck_hash = options%deck_hash
    if (allocated(options%folder)) self%folder = options%folder
    self%method = trim(options%solver%method)
    self%criterion = trim(criterion_names(options%solver%criterion))
    self%tolerance = options%solver%tolerance
    self%dimension = scene%dimension
    self%fall_speed = largest_gravity(scene)*options%substep_length()
    self%steps_asked = options%steps
    self%time = scene%start_time
    self%bodies = scene%bodies%n_own
    self%ranks = comm%n_processes()
    self%subdomains = comm%size
    if (allocated(scene%bodies%id)) then
      call comm%sum(self%bodies)
      call count_grains(scene%bodies, self%grains, comm)
    else
      call count_grains(scene%bodies, self%grains)
    end if
  end subroutine summary_describe

  !> Gather the cost of sharing from all ranks. Collective.
  subroutine cost_collect(self, comm, effort, messages, bytes)
    class(shared_cost_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    type(coupled_effort_t), intent(in) :: effort !! of this rank
    integer(i8), intent(in) :: messages !! sent by this rank in all gluings
    integer(i8), intent(in) :: bytes !! sent by this rank in all gluings
    real(wp), allocatable :: all(:, :)

    call comm%gather([real(effort%contact_updates, wp), comm%traffic%wait_seconds, &
                      merge(real(peak_memory_bytes(), wp), 0.0_wp, comm%leads_process()), real(messages, wp), real(bytes, wp), &
                      real([effort%factorisations, effort%failed_factors], wp)], all)
    self%solves = effort%solves
    self%gluings = effort%gluings
    self%iterations = effort%iterations
    self%failed_systems = effort%failed_systems
    self%least_updates = minval(all(1, :))
    self%mean_updates = sum(all(1, :))/real(comm%size, wp)
    self%most_updates = maxval(all(1, :))
    self%imbalance = 1
    if (self%mean_updates > 0) self%imbalance = self%most_updates/self%mean_updates
    ! Subdomains of one process work in turns: where none works, the machine does something else.
    if (comm%n_processes() > 1) then
      self%mean_wait = sum(all(2, :))/real(comm%size, wp)
      self%most_wait = maxval(all(2, :))
    end if
    self%most_memory = maxval(all(3, :))
    self%all_memory = sum(all(3, :))
    self%messages = sum(all(4, :))/real(max(1_i8, self%gluings), wp)
    self%bytes = sum(all(5, :))/real(max(1_i8, self%gluings), wp)
    self%factorisations = nint(sum(all(6, :)), i8)
    self%failed_factors = nint(sum(all(7, :)), i8)
  end subroutine cost_collect

  !> Number of ranks, and of subdomains where they have several.
  pure function ranks_words(subdomains, ranks) result(words)
    integer, intent(in) :: subdomains !! subdomains of all ranks
    integer, intent(in) :: ranks !! ranks that share them
    character(len=:), allocatable :: words

    words = to_text(ranks)
    if (subdomains > ranks) words = to_text(subdomains)//' subdomains on '//counted(ranks, 'rank')
  end function ranks_words

  !> Name a file that was written.
  subroutine summary_add_file(self, key, file)
    class(run_summary_t), intent(inout) :: self
    character(len=*), intent(in) :: key !! what it holds, such as `bodies`
    character(len=*), intent(in) :: file !! its name in the folder of the results
    integer :: i

    if (allocated(self%file_keys)) then
      ! Stages of a run open the same files.
      if (any([(self%file_keys(i)%s == key, i=1, size(self%file_keys))])) return
    end if
    call append(self%file_keys, key)
    call append(self%files, file)
  end subroutine summary_add_file

  !> Append a word to a list.
  subroutine append(list, word)
    type(text_t), allocatable, intent(inout) :: list(:)
    character(len=*), intent(in) :: word
    type(text_t), allocatable :: longer(:)
    integer :: n

    n = 0
    if (allocated(list)) n = size(list)
    allocate (longer(n + 1))
    if (n > 0) longer(:n) = list
    longer(n + 1)%s = word
    call move_alloc(longer, list)
  end subroutine append

  !> Set the end of the run and its results.
  subroutine summary_conclude(self, status, reason, time, totals, measures)
    class(run_summary_t), intent(inout) :: self
    character(len=*), intent(in) :: status !! one of `run_*`
    character(len=*), intent(in) :: reason !! why; empty when done
    real(wp), intent(in) :: time !! time reached [s]
    type(totals_t), intent(in) :: totals !! cost and convergence
    type(measures_t), intent(in) :: measures !! indicators of the end

    self%status = status
    self%reason = reason
    self%time = time
    self%totals = totals
    self%measures = measures
  end subroutine summary_conclude

  !> Indicators of the last measure; zeros of the same names where the run ended before the first one.
  pure function summary_columns(self) result(columns)
    class(run_summary_t), intent(in) :: self
    type(column_t), allocatable :: columns(:)
    type(measures_t) :: measures

    measures = self%measures
    if (.not. allocated(measures%column)) measures = unmeasured(self%dimension, self%has_bonds, with_rolling=self%has_rolling)
    call move_alloc(measures%column, columns)
  end function summary_columns

  !> Write run.json, wholly or not at all.
  subroutine write_run_summary(summary, file, error)
    type(run_summary_t), intent(in) :: summary !! the run, concluded
    character(len=*), intent(in) :: file !! path of the file
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    type(json_t) :: json
    type(column_t), allocatable :: columns(:)
    integer :: i

    if (.not. summary%is_root) return
    call add_identity(json, summary)
    call add_totals(json, summary%totals)
    call json%add('start_cpu_seconds', summary%start_cpu)
    call json%add('start_wall_seconds', summary%start_wall)
    call add_moment(json, 'worst_penetration_', summary%totals%penetration_at, summary%dimension, summary%penetration_bodies)
    call add_moment(json, 'worst_violation_', summary%totals%violation_at, summary%dimension, summary%violation_bodies)
    if (summary%stages%number > 0) call add_stages(json, summary%stages)
    if (summary%subdomains > 1) call add_shared(json, summary%shared)
    columns = summary%columns()
    do i = 1, size(columns)
      if (columns(i)%is_count) then
        call json%add(trim(columns(i)%name), nint(columns(i)%value))
      else
        call json%add(trim(columns(i)%name), columns(i)%value)
      end if
    end do
    if (allocated(summary%files)) then
      do i = 1, size(summary%files)
        call json%add('file_'//summary%file_keys(i)%s, summary%files(i)%s)
      end do
    end if
    call replace_file(file, json%text()//new_line('a'), error)
  end subroutine write_run_summary

  !> What was run, and how it ended.
  subroutine add_identity(json, summary)
    type(json_t), intent(inout) :: json
    type(run_summary_t), intent(in) :: summary

    call json%add('status', known(summary%status, run_failed))
    call json%add('reason', known(summary%reason, ''))
    if (allocated(summary%stop_condition)) then
      call json%add('stop_condition', summary%stop_condition)
      call json%add('stop_time', summary%stop_time)
      call json%add('stop_value', summary%stop_value)
    end if
    call json%add('version', version)
    call json%add('commit', commit)
    call json%add('deck', known(summary%deck, ''))
    call json%add('title', known(summary%title, ''))
    call json%add('about', known(summary%about, ''))
    call json%add('deck_hash', known(summary%deck_hash, ''))
    call json%add('solver', known(summary%method, ''))
    call json%add('criterion', known(summary%criterion, ''))
    call json%add('tolerance', summary%tolerance)
    call json%add('dimension', summary%dimension)
    call json%add('ranks', summary%ranks)
    call json%add('subdomains', summary%subdomains)
    call json%add('bodies', summary%bodies)
    call json%add('grains', summary%grains%n)
    call json%add('mean_radius', summary%grains%mean_radius)
    call json%add('steps_asked', summary%steps_asked)
    call json%add('time', summary%time)
  end subroutine add_identity

  !> Where and when a worst value was found.
  subroutine add_moment(json, prefix, moment, dimension, bodies)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: prefix
    type(moment_t), intent(in) :: moment
    integer, intent(in) :: dimension
    character(len=:), allocatable, intent(in) :: bodies
    character(len=*), parameter :: axis = 'xyz'
    integer :: a

    if (moment%step == 0) return
    call json%add(prefix//'step', moment%step)
    call json%add(prefix//'time', moment%time)
    if (moment%bodies(1) == 0) return
    call json%add(prefix//'bodies', known(bodies, ''))
    call json%add(prefix//'body_1', moment%bodies(1))
    call json%add(prefix//'body_2', moment%bodies(2))
    do a = 1, dimension
      call json%add(prefix//axis(a:a), moment%place(a))
    end do
    call json%add(prefix//'hint', hint_words(moment))
  end subroutine add_moment

  !> Cost and convergence.
  subroutine add_totals(json, totals)
    type(json_t), intent(inout) :: json
    type(totals_t), intent(in) :: totals
    integer :: i

    call json%add('steps', totals%steps)
    call json%add('converged_steps', totals%converged_steps)
    call json%add('unconverged_steps', totals%unconverged_steps)
    call json%add('fast_steps', totals%fast_steps)
    if (totals%repeated_steps > 0) call json%add('repeated_steps', totals%repeated_steps)
    call json%add('passings', totals%tunnellings)
    if (totals%recoveries > 0) call json%add('recoveries', totals%recoveries)
    call json%add('worst_e1', totals%worst_e1)
    call json%add('worst_e2', totals%worst_e2)
    call json%add('worst_e8', totals%worst_e8)
    call json%add('worst_violation', totals%worst_violation)
    call json%add('worst_penetration', totals%worst_penetration)
    if (totals%worst_step > 0) then
      call json%add('worst_step', totals%worst_step)
      call json%add('worst_body_1', totals%worst_bodies(1))
      call json%add('worst_body_2', totals%worst_bodies(2))
      call json%add('worst_speed', totals%worst_speed)
    end if
    call json%add('sweeps', totals%sweeps)
    call json%add('contact_updates', totals%contact_updates)
    call json%add('contacts', totals%contacts)
    call json%add('active_contacts', totals%active_contacts)
    call json%add('most_contacts', totals%most_contacts)
    call json%add('bytes_per_contact', totals%bytes_per_contact)
    call json%add('peak_memory_bytes', peak_memory_bytes())
    call json%add('cpu_seconds', totals%clock%cpu)
    call json%add('wall_seconds', totals%clock%wall)
    do i = 1, n_phases
      call json%add('cpu_'//trim(phase_names(i)), totals%phase(i)%cpu)
      call json%add('wall_'//trim(phase_names(i)), totals%phase(i)%wall)
    end do
  end subroutine add_totals

  !> The stages that have begun.
  subroutine add_stages(json, stages)
    type(json_t), intent(inout) :: json
    type(stages_t), intent(in) :: stages
    type(json_t) :: object(stages%number)
    integer :: i

    do i = 1, stages%number
      associate (stage => stages%list(i))
        call object(i)%add('stage', i)
        call object(i)%add('name', stage%name)
        call object(i)%add('first_step', stage%first_step + 1)
        call object(i)%add('last_step', stage%last_step)
        call object(i)%add('start_time', stage%start_time)
        call object(i)%add('end_time', stage%end_time)
        call object(i)%add('unconverged_steps', stage%unconverged)
        call object(i)%add('reason', stage%reason())
      end associate
    end do
    call json%add_objects('stages', object)
  end subroutine add_stages

  !> How the scene was shared, and what that cost.
  subroutine add_shared(json, shared)
    type(json_t), intent(inout) :: json
    type(shared_cost_t), intent(in) :: shared

    call json%add('split', known(shared%split, ''))
    call json%add('gluing', known(shared%gluing, ''))
    call json%add('splits', shared%splits)
    call json%add('moved_bodies', shared%moved)
    if (shared%splits > 1) then
      call json%add('imbalance_before_splits', shared%imbalance_at_splits(1))
      call json%add('imbalance_after_splits', shared%imbalance_at_splits(2))
    end if
    call json%add('gluings', shared%gluings)
    call json%add('interface_iterations', shared%iterations)
    call json%add('factorisations', shared%factorisations)
    call json%add('failed_systems', shared%failed_systems)
    call json%add('failed_factors', shared%failed_factors)
    call json%add('rank_updates_min', shared%least_updates)
    call json%add('rank_updates_mean', shared%mean_updates)
    call json%add('rank_updates_max', shared%most_updates)
    call json%add('imbalance', shared%imbalance)
    call json%add('messages_per_gluing', shared%messages)
    call json%add('bytes_per_gluing', shared%bytes)
    call json%add('wait_seconds_mean', shared%mean_wait)
    call json%add('wait_seconds_max', shared%most_wait)
    call json%add('rank_memory_bytes_max', shared%most_memory)
    call json%add('memory_bytes_sum', shared%all_memory)
  end subroutine add_shared

  !> A text, or another one where it was never set.
  pure function known(text, otherwise)
    character(len=:), allocatable, intent(in) :: text
    character(len=*), intent(in) :: otherwise
    character(len=:), allocatable :: known

    known = otherwise
    if (allocated(text)) known = text
  end function known
end module sg_run_summary
