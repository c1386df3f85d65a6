!> A simulation: everything one run owns, made ready for its first step (sg_advance does the steps).
module sg_simulation
  use sg_body_interfaces, only: interfaces_t
  use sg_carry, only: carry_t
  use sg_cell, only: cell_t
  use sg_choose_solver, only: choose_solver
  use sg_comm, only: comm_t, traffic_t
  use sg_contacts, only: contacts_t
  use sg_decomposition, only: decomposition_t
  use sg_drives, only: fix_driven
  use sg_dump, only: dump_t
  use sg_energy, only: energy_t
  use sg_error, only: error_t, fail
  use sg_fields_on_grid, only: grid_field_t
  use sg_history, only: history_t, start_history
  use sg_kept_contacts, only: n_kept_in_plane, n_kept_in_space
  use sg_kinds, only: wp, i4
  use sg_means, only: means_t
  use sg_neighbour_list, only: neighbours_t
  use sg_tunnelling, only: tunnelling_t
  use sg_plan, only: make_plan, omissions_t, plan_t
  use sg_problem, only: problem_t
  use sg_pusher, only: pusher_t
  use sg_records, only: force_length
  use sg_regions, only: regions_t
  use sg_subdomain_means, only: subdomain_means_t
  use sg_report, only: coupled_effort_t, report_t
  use sg_restart_files, only: find_restarts
  use sg_restart_fit, only: holds, holds_spins
  use sg_run_options, only: partition_options_t, run_options_t
  use sg_scene, only: scene_t
  use sg_signature, only: n_signature, signature_of
  use sg_solver, only: solver_t
  use sg_stages, only: stages_t
  use sg_step_start, only: step_start_t
  use sg_stop, only: stop_t
  use sg_text, only: text_t, to_text
  use sg_timers, only: timer_t
  use sg_totals, only: totals_t
  use sg_tracks, only: tracks_t
  use sg_writers, only: writers_t
  implicit none
  private
  public :: simulation_t, start_simulation, reserve_carried, decompose

  !> One run: two of them fit in one program
  type :: simulation_t
    !> The scene, and the options of its run
    type(scene_t) :: scene
    type(run_options_t) :: options
    !> Needs of the scene, and parts that may be left out
    type(plan_t) :: plan
    type(omissions_t) :: omissions
    !> Pairs that may touch, contacts of the step, and those of the last one
    type(neighbours_t) :: pairs
    type(contacts_t) :: contacts
    type(history_t) :: history
    !> The contact problem of the step, its solver, and the report of the last solve
    type(problem_t) :: problem
    class(solver_t), allocatable :: solver
    !> Solver of pushes that undo overlap, made by the first one
    type(pusher_t), allocatable :: pusher
    type(report_t) :: report
    !> Report of the substeps of the present step that are done
    type(report_t) :: so_far
    !> The ranks, and this one's side of the decomposition
    type(comm_t) :: comm
    type(decomposition_t) :: decomposition
    !> Dump of the step's problem, where one is asked for or the step failed
    type(dump_t) :: dump
    !> Is the history of errors kept within the next steps?
    logical :: is_traced = .false.
    !> Is the guess of each solve kept, so that a step that breaks can be solved again? Its impulses, and free velocities by slot
    logical :: keeps_guess = .false.
    real(wp), allocatable :: guess_impulse(:, :), guess_body(:, :)
    !> Works and costs since the start
    type(energy_t) :: energy
    type(totals_t) :: totals
    !> Time spent on decks and scenes before steps, of all stages in this process
    type(timer_t) :: preparation
    !> Tracked bodies, and conditions that end the run
    type(tracks_t) :: tracks
    !> Regions in which indicators are measured
    type(regions_t) :: regions
    !> Means of each subdomain
    type(subdomain_means_t) :: subdomains
    !> Pairs of bodies whose interfaces are measured
    type(interfaces_t) :: interfaces
    !> Walls, and the cell that they enclose
    type(cell_t) :: cell
    !> Coarse-grained fields; unallocated where there are none
    type(grid_field_t), allocatable :: fields(:)
    !> Sums over the recorded interval
    type(means_t) :: means
    type(stop_t) :: stop
    !> Stages of the run. Has its present one begun in this process, from a checkpoint of the one before, in the same folder? Has
    !! it ended, so that the next one is due?
    type(stages_t) :: stages
    logical :: is_continued = .false., goes_on = .false.
    !> Phase whose clock runs, one of `phase_*`; 0 between phases
    integer :: phase = 0
    !> Bodies that passed through each other
    type(tunnelling_t) :: tunnelling
    !> Files of the run
    type(writers_t) :: writers
    !> Steps done, and number of the substep within the present one
    integer :: step = 0, substep = 1
    !> What carries contacts from substep to substep, and the state at the beginning of the step; unused where there is one substep
    type(carry_t) :: carry
    type(step_start_t) :: step_start
    !> May the problem of the next substep be made from that of this one?
    logical :: updates_problem = .false.
    !> Contacts of the last step, of all ranks
    integer :: all_contacts = 0
    !> Where ranks share the scene: effort of this rank in this run, and its messages in solves; signature of the whole scene
    type(coupled_effort_t) :: effort
    type(traffic_t) :: gluing_traffic
    real(wp) :: signature(n_signature) = 0
  contains
    procedure :: time => simulation_time
    procedure :: substep_time => simulation_substep_time
  end type simulation_t

contains

  !> Make a simulation ready for its first step: plan, driven components, guess of the first impulses, solver. Collective where
  !! each rank of `sim%comm` has a part of the scene.
  subroutine start_simulation(sim)
    type(simulation_t), intent(inout) :: sim !! its scene and options are set
    type(error_t), allocatable :: refused

    if (allocated(sim%options%restart_file)) call keep_parts(sim)
    call make_plan(sim%scene, sim%plan, sim%comm, sim%omissions)
    sim%signature = signature_of(sim%scene, sim%comm)
    call fix_driven(sim%scene%drives, sim%scene%bodies)
    sim%pairs%memory%sharers = sim%comm%ranks_here()
    sim%pairs%memory%subdomains = sim%comm%n_here()
    sim%pairs%deadline = sim%options%deadline
    sim%pairs%substeps = sim%options%substeps
    sim%contacts%memory = sim%pairs%memory
    sim%contacts%dimension = sim%scene%dimension
    sim%contacts%has_cell = sim%scene%cell%is_on
    sim%contacts%n_components = force_length(sim%plan%kind)
    sim%contacts%n_moments = sim%plan%n_moments
    sim%contacts%n_internal = sim%plan%n_internal
    sim%contacts%n_kept = 0
    if (sim%plan%keeps_contacts) sim%contacts%n_kept = merge(n_kept_in_plane, n_kept_in_space, sim%scene%dimension == 2)
    ! Contacts known to a scene that is held in part travel first, see `decompose`.
    if (.not. allocated(sim%scene%bodies%id)) &
      call start_history(sim%history, sim%scene, sim%options%substep_length(), sim%contacts%n_components, &
                         sim%contacts%n_internal)
    ! What a method carries must be known before a restart file is read; a method that these ranks cannot have is refused later.
    call choose_solver(sim%options%solver, sim%options%partition, sim%comm%size, sim%solver, refused)
    if (allocated(refused)) call choose_solver(sim%options%solver, sim%solver)
    if (any(sim%scene%cell%is_stress)) sim%scene%cell%inertia = sim%scene%cell%inertia*weight_of_grains(sim%scene, sim%comm)
    call reserve_carried(sim)
    call track_bodies(sim)
    sim%means%is_on = sim%options%record_mean .and. sim%options%record_every > 0
    call sim%totals%clock%start()
  end subroutine start_simulation

  !> Sum over all grains of mass times square of the width [kg m2], the unit of a cell's inertia. Collective where each rank has a
  !! part of the scene.
  real(wp) function weight_of_grains(scene, comm) result(weight)
    type(scene_t), intent(in) :: scene
    type(comm_t), intent(inout) :: comm
    real(wp) :: reach(scene%bodies%n)
    integer :: c

    reach = 0
    do c = 1, scene%contactors%n
      associate (b => scene%contactors%body(c))
        reach(b) = max(reach(b), norm2(scene%contactors%shift(:, c)) + scene%contactors%reach(c))
      end associate
    end do
    associate (own => scene%bodies%n_own)
      weight = sum(scene%bodies%mass(:own)*(2*reach(:own))**2)
    end associate
    if (allocated(scene%bodies%id)) call comm%sum(weight)
  end function weight_of_grains

  !> Begin fields, regions and interfaces; track the bodies that the deck asks for, and walls where there is a record.
  subroutine track_bodies(sim)
    type(simulation_t), intent(inout) :: sim
    type(text_t), allocatable :: names(:)

    integer :: i

    if (allocated(sim%options%fields)) then
      allocate (sim%fields(size(sim%options%fields)))
      do i = 1, size(sim%fields)
        call sim%fields(i)%begin(sim%options%fields(i))
      end do
    end if
    if (allocated(sim%options%regions)) sim%regions%options = sim%options%regions
    sim%subdomains%is_on = sim%options%has_subdomain_means
    if (allocated(sim%options%interfaces)) sim%interfaces%options = sim%options%interfaces
    if (sim%options%walls%is_periodic .and. sim%options%record_every > 0) call sim%cell%begin(sim%options%walls)
    if (sim%options%walls%count() == 0 .or. sim%options%record_every == 0) then
      if (allocated(sim%options%tracked)) &
        call sim%tracks%track(sim%options%tracked, sim%options%tracked_names, [integer(i4) ::], [text_t ::])
      return
    end if
    call sim%cell%begin(sim%options%walls)
    if (allocated(sim%options%tracked)) then
      call sim%tracks%track(sim%options%tracked, sim%options%tracked_names, sim%options%walls%wall%number, sim%options%wall_names)
    else
      allocate (names(0))
      call sim%tracks%track([integer(i4) ::], names, sim%options%walls%wall%number, sim%options%wall_names)
    end if
  end subroutine track_bodies

  !> Leave rotation in the plan where the checkpoint to go on from holds spins, as that of a stage with friction; and keep bodies
  !! absent that are so in it.
  subroutine keep_parts(sim)
    type(simulation_t), intent(inout) :: sim
    type(text_t), allocatable :: names(:)
    type(error_t), allocatable :: error
    logical :: are_held, has_presence
    integer :: i

    call find_restarts(sim%options%restart_file, names, error)
    are_held = .false.
    has_presence = .false.
    if (.not. allocated(error)) then
      are_held = any([(holds_spins(names(i)%s, sim%scene%dimension), i=1, size(names))])
      has_presence = any([(holds(names(i)%s, '/bodies/presence'), i=1, size(names))])
    end if
    if (sim%comm%any(are_held)) sim%omissions%rotation = .false.
    has_presence = sim%comm%any(has_presence)
    if (sim%scene%bodies%has_presence .or. .not. has_presence) return
    sim%scene%bodies%has_presence = .true.
    call sim%scene%bodies%resize(sim%scene%bodies%n)
  end subroutine keep_parts

  !> Make room for what the solver's method carries from step to step; values of another number of columns are dropped.
  subroutine reserve_carried(sim)
    type(simulation_t), intent(inout) :: sim !! its solver is chosen
    integer :: columns(2), room

    columns = [sim%solver%carried_velocities*sim%scene%bodies%n_velocity, sim%solver%carried_impulses*sim%contacts%n_components]
    if (sim%scene%bodies%n_carried /= columns(1)) then
      sim%scene%bodies%n_carried = columns(1)
      if (allocated(sim%scene%bodies%carried)) deallocate (sim%scene%bodies%carried)
      call sim%scene%bodies%resize(sim%scene%bodies%n)
    end if
    if (sim%contacts%n_carried == columns(2)) return
    sim%contacts%n_carried = columns(2)
    if (allocated(sim%contacts%carried)) deallocate (sim%contacts%carried)
    room = 0
    if (allocated(sim%contacts%gap)) room = size(sim%contacts%gap)
    if (room > 0) call sim%contacts%resize(room)
  end subroutine reserve_carried

  !> Split a started simulation over the ranks of `sim%comm`, where there are several: each keeps its part. Collective.
  subroutine decompose(sim, error)
    type(simulation_t), intent(inout) :: sim !! started, perhaps brought to the state of a restart file; whole on all ranks, or
    !! a part on each
    type(error_t), allocatable, intent(out) :: error !! set on all ranks where the deck has an impossible split

    if (sim%comm%size == 1) return
    call check_sweeps(sim%options%partition, sim%comm%size, error)
    if (allocated(error)) return
    call choose_solver(sim%options%solver, sim%options%partition, sim%comm%size, sim%solver, error)
    if (allocated(error)) return
    call reserve_carried(sim)
    call sim%decomposition%begin(sim%scene, sim%contacts, sim%step > 0, sim%options%partition, sim%comm, error)
    if (allocated(error)) return
    if (allocated(sim%pairs%built)) deallocate (sim%pairs%built)
    sim%pairs%rank = sim%comm%rank
    sim%contacts%n = 0
  end subroutine decompose

  !> Are there sweeps for every part?
  subroutine check_sweeps(partition, ranks, error)
    type(partition_options_t), intent(in) :: partition
    integer, intent(in) :: ranks
    type(error_t), allocatable, intent(out) :: error

    if (.not. allocated(partition%sweeps)) return
    if (any(size(partition%sweeps) == [1, ranks])) return
    call fail(error, 'partition.sweeps has '//to_text(size(partition%sweeps))//' numbers; it takes one for all parts, or one '// &
              'for each of the '//to_text(ranks)//' ranks')
  end subroutine check_sweeps

  !> Time reached, or that of the end of another step [s]; a product, so that a restarted run has the very same times.
  pure real(wp) function simulation_time(self, step) result(time)
    class(simulation_t), intent(in) :: self
    integer, intent(in), optional :: step !! number of the step
    integer :: number

    number = self%step
    if (present(step)) number = step
    time = self%scene%start_time + self%options%time_step*real(number, wp)
  end function simulation_time

  !> Time at which the present substep begins, or at which another one does [s]; the one after the last begins with the next step.
  pure real(wp) function simulation_substep_time(self, substep) result(time)
    class(simulation_t), intent(in) :: self
    integer, intent(in), optional :: substep !! number of the substep within the step, from 1
    integer :: number

    number = self%substep
    if (present(substep)) number = substep
    if (number > self%options%substeps) then
      time = self%time(self%step + 1)
    else
      time = self%time() + self%options%substep_length()*real(number - 1, wp)
    end if
  end function simulation_substep_time
end module sg_simulation
