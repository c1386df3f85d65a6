!> Writer of a scene as DATBOX files, at its start or in the state of a restart file.
module sg_write_state
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_bodies, only: angle_of
  use sg_checkpoint, only: load_checkpoint
  use sg_contacts, only: impulse_vector
  use sg_datbox_write, only: write_datbox
  use sg_datbox_write_contacts, only: contacts_at_start, datbox_contacts_t
  use sg_detect, only: detect
  use sg_error, only: diagnostics_t, error_t
  use sg_internal_values, only: most_internal
  use sg_kinds, only: wp
  use sg_mapping, only: relative_velocity
  use sg_mapping_space, only: space_relative_velocity
  use sg_motion, only: predict
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t, unwrapped
  use sg_simulation, only: simulation_t, start_simulation
  implicit none
  private
  public :: write_state

contains

  !> Write a scene as DATBOX files, in the state of a restart file where the options name one. Print what the files do not hold.
  subroutine write_state(options, scene, folder, error)
    type(run_options_t), intent(in) :: options !! options of the deck
    type(scene_t), intent(inout) :: scene !! scene as the deck has it; brought to the state
    character(len=*), intent(in) :: folder !! folder of the DATBOX files
    type(error_t), allocatable, intent(out) :: error !! set when a file cannot be used or written
    type(datbox_contacts_t) :: contacts
    real(wp) :: time
    integer :: step

    time = scene%start_time
    step = 0
    if (allocated(options%restart_file)) then
      call scene_at_restart(options, scene, contacts, time, step, error)
      if (allocated(error)) return
    else
      contacts = contacts_at_start(scene)
    end if
    call write_datbox(folder, scene, contacts, time, scene%start_step + step, error)
    if (scene%period > 0) write (error_unit, '(a)') 'note: a DATBOX does not hold the period in x'
    if (scene%links%n > 0) write (error_unit, '(a)') 'note: the script of LMGC90 must call '// &
      merge('PTPT2', 'PTPT3', scene%dimension == 2)//'_LoadNetwork, and LoadParams where there are NARD rods'
    if (size(scene%pressures) > 0) write (error_unit, '(a)') 'note: a DATBOX does not hold pressures'
  end subroutine write_state

  !> Bring a scene to the state of a restart file.
  !!
  !! Contacts are those that the next step would find, with the impulses of the last one.
  subroutine scene_at_restart(options, scene, contacts, time, step, error)
    type(run_options_t), intent(in) :: options
    type(scene_t), intent(inout) :: scene
    type(datbox_contacts_t), intent(out) :: contacts
    real(wp), intent(out) :: time
    integer, intent(out) :: step
    type(error_t), allocatable, intent(out) :: error
    type(simulation_t) :: sim
    type(diagnostics_t) :: warnings

    time = 0
    step = 0
    sim%scene = scene
    sim%options = options
    call start_simulation(sim)
    call load_checkpoint(sim, options%restart_file, warnings, error)
    call warnings%print(error_unit)
    if (allocated(error)) return
    time = sim%time()
    step = sim%step
    call take_motion(sim%scene, scene)
    call predict(sim%scene, time, options%substep_length(), options%theta)
    call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
    call take_contacts(sim, contacts)
  end subroutine scene_at_restart

  !> Positions, unwrapped, angles and velocities; where nothing turns, angles and spins stay as the deck has them.
  subroutine take_motion(moved, scene)
    type(scene_t), intent(in) :: moved
    type(scene_t), intent(inout) :: scene
    real(wp) :: place(3)
    integer :: b, n

    n = moved%bodies%n_velocity
    do b = 1, scene%bodies%n
      place = unwrapped(moved, moved%bodies, b)
      scene%bodies%position(:, b) = place(:scene%dimension)
      scene%bodies%velocity(:n, b) = moved%bodies%velocity(:, b)
      if (scene%dimension == 3) then
        if (n == 6) scene%bodies%orientation(:, b) = moved%bodies%orientation(:, b)
      else if (n == 3) then
        scene%bodies%angle(b) = angle_of(moved%bodies, b)
      end if
    end do
  end subroutine take_motion

  !> Contacts with mean forces instead of impulses.
  subroutine take_contacts(sim, contacts)
    type(simulation_t), intent(in) :: sim
    type(datbox_contacts_t), intent(inout) :: contacts
    integer :: k, n, m

    n = sim%contacts%n
    m = sim%contacts%n_components
    contacts%n = n
    contacts%contactor = sim%contacts%contactor(:, :n)
    contacts%point = sim%contacts%point(:, :n)
    contacts%normal = sim%contacts%normal(:, :n)
    contacts%gap = sim%contacts%gap(:n)
    contacts%status = sim%contacts%status(:n)
    allocate (contacts%internal(most_internal, n), source=0.0_wp)
    if (n > 0) contacts%internal(:sim%contacts%n_internal, :) = sim%contacts%internal(:, :n)
    allocate (contacts%force(sim%scene%dimension, n), contacts%velocity(sim%scene%dimension, n), source=0.0_wp)
    do k = 1, n
      if (sim%scene%dimension == 3) then
        contacts%force(:, k) = impulse_vector(sim%contacts, k)/sim%options%substep_length()
        contacts%velocity(:, k) = space_relative_velocity(sim%scene, sim%contacts, k, sim%scene%bodies%velocity)
      else
        contacts%force(:m, k) = sim%contacts%impulse(:, k)/sim%options%substep_length()
        contacts%velocity(:, k) = relative_velocity(sim%contacts, k, sim%scene%bodies%middle, sim%scene%period, &
                                                    sim%scene%bodies%velocity)
      end if
    end do
  end subroutine take_contacts
end module sg_write_state
