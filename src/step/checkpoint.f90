!> Checkpoints of a simulation: what a restart file must hold so that the run goes on bit for bit.
!!
!! Ranks that share the scene write one file. Another number of ranks may go on from it, from the same bodies, velocities,
!! impulses and totals; only one rank that goes on from one rank also takes up its list of neighbours, and with it every bit.
module sg_checkpoint
  use sg_bodies, only: bodies_t
  use sg_bodies_rows, only: order_bodies
  use sg_comm, only: comm_t
  use sg_energy, only: energy_t, n_energy_values
  use sg_error, only: diagnostics_t, error_t, fail
  use sg_history, only: resume_history
  use sg_kinds, only: wp
  use sg_neighbours, only: build_neighbours
  use sg_restart, only: keep_state, newest_restart, read_restart, restart_t, restore_state, write_restart
  use sg_rows, only: rows_t
  use sg_signature, only: n_signature, signature_of
  use sg_simulation, only: simulation_t
  use sg_totals, only: n_totals_values, totals_t
  implicit none
  private
  public :: save_checkpoint, load_checkpoint

contains

  !> Write the state of a simulation to the older of the two restart files of its folder.
  subroutine save_checkpoint(sim, error, comm, signature)
    type(simulation_t), intent(in) :: sim !! simulation between two steps
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written; the older file stays
    type(comm_t), intent(inout), optional :: comm !! ranks that share the scene, all of which call this
    real(wp), intent(in), optional :: signature(n_signature) !! of the whole scene, where ranks share it
    type(restart_t) :: state
    type(energy_t) :: energy
    type(totals_t) :: totals
    type(comm_t) :: ranks
    real(wp) :: whole(n_signature)

    if (present(comm)) ranks = comm
    energy = sim%energy
    totals = sim%totals
    call energy%reduce(ranks)
    call totals%reduce(ranks)
    if (present(signature)) then
      whole = signature
    else
      whole = signature_of(sim%scene)
    end if
    call keep_shared(sim, ranks, state, error)
    if (allocated(error)) return
    state%step = sim%step
    state%time = sim%time()
    state%deck_hash = sim%options%deck_hash
    state%totals = [energy%pack(), totals%pack(), sim%pairs%skin, whole]
    allocate (state%built(size(sim%scene%bodies%middle, 1), 0))
    if (ranks%size == 1 .and. allocated(sim%pairs%built)) state%built = sim%pairs%built
    call write_restart(sim%options%folder, state, error, ranks)
  end subroutine save_checkpoint

  !> Copy the state of bodies and contacts, of bodies those that this rank writes.
  subroutine keep_shared(sim, ranks, state, error)
    type(simulation_t), intent(in) :: sim
    type(comm_t), intent(inout) :: ranks
    type(restart_t), intent(inout) :: state
    type(error_t), allocatable, intent(out) :: error
    type(bodies_t) :: block
    type(rows_t) :: rows

    if (ranks%size == 1) then
      call keep_state(sim%scene%bodies, sim%contacts, state)
      return
    end if
    call order_bodies(sim%scene%bodies, ranks, rows, block, error)
    if (allocated(error)) return
    if (allocated(sim%scene%contactors%id)) then
      call keep_state(block, sim%contacts, state, sim%scene%contactors%id)
    else
      call keep_state(block, sim%contacts, state)
    end if
  end subroutine keep_shared

  !> Bring a started simulation to the state of a restart file; a folder stands for its newest one. Each of several ranks then has a
  !! piece of the contacts, until the scene is split.
  subroutine load_checkpoint(sim, name, warnings, error, comm)
    type(simulation_t), intent(inout) :: sim !! started simulation, of the whole scene or of a rank's share
    character(len=*), intent(in) :: name !! restart file, or a folder of results
    type(diagnostics_t), intent(inout) :: warnings !! takes what is odd but harmless
    type(error_t), allocatable, intent(out) :: error !! set when the file does not serve
    type(comm_t), intent(inout), optional :: comm !! ranks that are to share the scene, all of which call this
    type(comm_t) :: ranks
    integer :: speaker

    if (present(comm)) ranks = comm
    call load_state(sim, name, warnings, ranks, error)
    call ranks%agree(error, speaker)
    if (allocated(error)) return
    call sim%energy%leave_to_first(ranks)
    call sim%totals%leave_to_first(ranks)
  end subroutine load_checkpoint

  !> Bring a simulation to the state of a restart file.
  subroutine load_state(sim, name, warnings, ranks, error)
    type(simulation_t), intent(inout) :: sim
    character(len=*), intent(in) :: name
    type(diagnostics_t), intent(inout) :: warnings
    type(comm_t), intent(inout) :: ranks !! one rank alone takes up its list of neighbours
    type(error_t), allocatable, intent(out) :: error
    type(restart_t) :: state
    character(len=:), allocatable :: file
    logical :: is_folder
    real(wp) :: signature(n_signature)

    signature = signature_of(sim%scene, ranks)
    file = name
    inquire (file=name//'/.', exist=is_folder)
    if (is_folder) file = newest_restart(name)
    if (len(file) == 0) then
      call fail(error, 'the folder holds no restart file', file=name)
      return
    end if
    call read_restart(file, sim%scene, sim%options%deck_hash, state, warnings, nint(signature(1)), nint(signature(2)), ranks)
    if (warnings%count() == 0 .and. size(state%totals) /= n_energy_values + n_totals_values + 1 + n_signature) then
      call warnings%add('the restart file is of another version of the program', file=file)
    end if
    if (warnings%count() == 0) then
      if (any(abs(state%totals(size(state%totals) - n_signature + 1:) - signature) > 0)) then
        call warnings%add('the restart file is of another scene: shapes, masses or drives differ', file=file)
      end if
    end if
    if (warnings%count() > 0) then
      error = warnings%errors(1)
      return
    end if
    call restore_state(state, sim%scene, sim%contacts)
    sim%step = state%step
    call keep_time(sim, state%time)
    call sim%energy%unpack(state%totals(:n_energy_values))
    call sim%totals%unpack(state%totals(n_energy_values + 1:n_energy_values + n_totals_values))
    ! Several ranks take up their contacts when they have split the scene.
    if (ranks%size == 1) call resume_history(sim%history, sim%contacts)
    if (ranks%size == 1 .and. size(state%built, 2) > 0) then
      call build_neighbours(sim%pairs, sim%scene, state%built, state%totals(size(state%totals) - n_signature))
    end if
  end subroutine load_state

  !> Go on from the time of a restart file, also where the step is another one now: times are the start's and so many steps.
  pure subroutine keep_time(sim, time)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: time !! of the file [s]

    if (abs(sim%time() - time) <= 16*epsilon(1.0_wp)*max(abs(time), abs(sim%scene%start_time))) return
    sim%scene%start_time = time - sim%options%step*real(sim%step, wp)
  end subroutine keep_time
end module sg_checkpoint
