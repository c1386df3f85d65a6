!> Checkpoints of a simulation: what a restart file must hold so that the run goes on bit for bit.
module sg_checkpoint
  use sg_energy, only: n_energy_values
  use sg_error, only: diagnostics_t, error_t, fail
  use sg_history, only: resume_history
  use sg_kinds, only: wp
  use sg_neighbours, only: build_neighbours
  use sg_restart, only: keep_state, newest_restart, read_restart, restart_t, restore_state, write_restart
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  use sg_totals, only: n_totals_values
  implicit none
  private
  public :: save_checkpoint, load_checkpoint

  !> Numbers of a scene's signature
  integer, parameter :: n_signature = 5

contains

  !> Write the state of a simulation to the older of the two restart files of its folder.
  subroutine save_checkpoint(sim, error)
    type(simulation_t), intent(in) :: sim !! simulation between two steps
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written; the older file stays
    type(restart_t) :: state

    call keep_state(sim%scene%bodies, sim%contacts, state)
    state%step = sim%step
    state%time = sim%time()
    state%deck_hash = sim%options%deck_hash
    state%totals = [sim%energy%pack(), sim%totals%pack(), sim%pairs%skin, signature(sim%scene)]
    allocate (state%built(size(sim%scene%bodies%middle, 1), 0))
    if (allocated(sim%pairs%built)) state%built = sim%pairs%built
    call write_restart(sim%options%folder, state, error)
  end subroutine save_checkpoint

  !> Bring a started simulation to the state of a restart file; a folder stands for its newest one.
  subroutine load_checkpoint(sim, name, warnings, error)
    type(simulation_t), intent(inout) :: sim !! started simulation
    character(len=*), intent(in) :: name !! restart file, or a folder of results
    type(diagnostics_t), intent(inout) :: warnings !! takes what is odd but harmless
    type(error_t), allocatable, intent(out) :: error !! set when the file does not serve
    type(restart_t) :: state
    character(len=:), allocatable :: file
    logical :: is_folder

    file = name
    inquire (file=name//'/.', exist=is_folder)
    if (is_folder) file = newest_restart(name)
    if (len(file) == 0) then
      call fail(error, 'the folder holds no restart file', file=name)
      return
    end if
    call read_restart(file, sim%scene, sim%options%deck_hash, state, warnings)
    if (warnings%count() == 0 .and. size(state%totals) /= n_energy_values + n_totals_values + 1 + n_signature) then
      call warnings%add('the restart file is of another version of the program', file=file)
    end if
    if (warnings%count() == 0) then
      if (any(abs(state%totals(size(state%totals) - n_signature + 1:) - signature(sim%scene)) > 0)) then
        call warnings%add('the restart file is of another scene: shapes, masses or drives differ', file=file)
      end if
    end if
    if (warnings%count() > 0) then
      error = warnings%errors(1)
      return
    end if
    call restore_state(state, sim%scene, sim%contacts)
    sim%step = state%step
    call sim%energy%unpack(state%totals(:n_energy_values))
    call sim%totals%unpack(state%totals(n_energy_values + 1:n_energy_values + n_totals_values))
    call resume_history(sim%history, sim%contacts)
    if (size(state%built, 2) > 0) call build_neighbours(sim%pairs, sim%scene, state%built, &
                                                          state%totals(size(state%totals) - n_signature))
  end subroutine load_checkpoint

  !> What tells scenes apart that have as many bodies: sums over bodies and contactors, each weighted by its place.
  pure function signature(scene)
    type(scene_t), intent(in) :: scene
    real(wp) :: signature(n_signature)
    real(wp) :: inertia(scene%bodies%n)
    integer :: i, n

    n = scene%contactors%n
    if (scene%dimension == 2) then
      inertia = scene%bodies%inertia
    else
      inertia = sum(scene%bodies%principal, 1)
    end if
    signature = [real(n, wp), sum(scene%bodies%mass*[(real(i, wp), i=1, scene%bodies%n)]), &
                 sum(inertia*[(real(i, wp), i=1, scene%bodies%n)]), &
                 sum(scene%contactors%reach(:n)*[(real(i, wp), i=1, n)]), real(size(scene%drives), wp)]
  end function signature
end module sg_checkpoint
