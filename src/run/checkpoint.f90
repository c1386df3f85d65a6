!> Checkpoints of a simulation: all that a run needs to go on bit for bit.
!!
!! Ranks that share the scene write one file. Another number of ranks may go on from it, from the same bodies, velocities,
!! impulses and totals; only one rank that goes on from one rank also loads its list of neighbours, and with it every bit.
module sg_checkpoint
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_block_distribution, only: block_distribution_t
  use sg_bodies, only: bodies_t, body_present
  use sg_bodies_rows, only: order_bodies
  use sg_energy, only: energy_t, n_energy_values
  use sg_error, only: diagnostics_t, error_t, fail
  use sg_fields_on_grid, only: pack_fields, unpack_fields
  use sg_former_deck, only: warn_of_differences
  use sg_history, only: resume_history
  use sg_kinds, only: wp
  use sg_means, only: means_t
  use sg_neighbours, only: build_neighbours
  use sg_periodic_cell, only: n_cell_values
  use sg_restart, only: keep_state, read_restart, restart_t, restore_state, write_restart
  use sg_restart_fields, only: values_of
  use sg_restart_files, only: find_restarts
  use sg_scene, only: set_edges
  use sg_signature, only: n_of_bodies, n_signature, signature_of
  use sg_simulation, only: simulation_t
  use sg_text, only: text_t, to_text
  use sg_totals, only: n_totals_values, totals_t
  use sg_tracks, only: tracks_t
  implicit none
  private
  public :: save_checkpoint, save_once, load_checkpoint

  !> Numbers at the end of the totals of a file: gravity, skin and way of the list of neighbours, way of the last step, and the
  !! signature of the scene
  integer, parameter :: n_gravity = 3, n_list = 3, n_after_totals = n_gravity + n_list + n_signature

contains

  !> Write a checkpoint, unless that of this step is written, or the program has no HDF5.
  subroutine save_once(sim, error)
    type(simulation_t), intent(inout) :: sim !! simulation between two steps
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written

    if (.not. sim%writers%has_checkpoints .or. sim%writers%saved_step == sim%step) return
    call sim%totals%tick()
    call save_checkpoint(sim, error)
    if (.not. allocated(error)) sim%writers%saved_step = sim%step
  end subroutine save_once

  !> Write the state of a simulation to the older of the two restart files of its folder.
  subroutine save_checkpoint(sim, error)
    type(simulation_t), intent(inout) :: sim !! simulation between two steps; its messages are counted
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written; the older file stays
    type(restart_t) :: state
    type(energy_t) :: energy
    type(totals_t) :: totals
    type(tracks_t) :: tracks
    type(means_t) :: means

    energy = sim%energy
    totals = sim%totals
    call energy%reduce(sim%comm)
    call totals%reduce(sim%comm)
    tracks = sim%tracks
    call tracks%reduce(sim%comm)
    call keep_shared(sim, state, error)
    if (allocated(error)) return
    state%step = sim%step
    state%time = sim%time()
    state%deck_hash = sim%options%deck_hash
    state%totals = [energy%pack(), totals%pack(), energy%gravity_for(sim%scene), sim%pairs%skin, &
                    sim%pairs%listed_way, sim%pairs%way, sim%signature]
    state%tracks = tracks%pack()
    means = sim%means
    call means%reduce(sim%comm)
    state%means = means%pack()
    call pack_fields(sim%fields, sim%comm, state%fields)
    state%stop = sim%stop%pack()
    call sim%stages%note(sim%step, sim%time(), sim%totals%unconverged_steps, sim%stop%met, sim%stop%value)
    state%stages = sim%stages%pack()
    state%cell = sim%scene%cell%pack()
    state%length = [sim%options%substep_length()]
    if (sim%writers%measured_step == sim%step) state%measures = sim%writers%measures%column%value
    call keep_list(sim, state%built)
    call write_restart(sim%options%folder, state, sim%comm, error)
  end subroutine save_checkpoint

  !> Configuration and margins of the list of neighbours, one below the other; none where another list will be made.
  pure subroutine keep_list(sim, built)
    type(simulation_t), intent(in) :: sim
    real(wp), allocatable, intent(out) :: built(:, :)
    integer :: n

    n = size(sim%scene%bodies%middle, 1)
    if (sim%comm%size > 1 .or. .not. allocated(sim%pairs%built)) then
      allocate (built(n + 1, 0))
    else
      allocate (built(n + 1, sim%scene%bodies%n))
      built(:n, :) = sim%pairs%built
      built(n + 1, :) = sim%pairs%margin
    end if
  end subroutine keep_list

  !> Copy the state of bodies and contacts, of bodies those that this rank writes.
  subroutine keep_shared(sim, state, error)
    type(simulation_t), intent(inout) :: sim
    type(restart_t), intent(inout) :: state
    type(error_t), allocatable, intent(out) :: error
    type(bodies_t) :: block
    type(block_distribution_t) :: rows

    if (sim%comm%size == 1) then
      call keep_state(sim%scene%bodies, sim%contacts, state)
      return
    end if
    call order_bodies(sim%scene%bodies, sim%comm, rows, block, error)
    if (allocated(error)) return
    call keep_state(block, sim%contacts, state, sim%scene%contactors%id)
  end subroutine keep_shared

  !> Bring a started simulation to the state of a restart file; a folder stands for its newest one. Each of several ranks then has a
  !! piece of the contacts, until the scene is split.
  subroutine load_checkpoint(sim, name, warnings, error)
    type(simulation_t), intent(inout) :: sim !! started simulation, of the whole scene or of a rank's share
    character(len=*), intent(in) :: name !! restart file, or a folder of results
    type(diagnostics_t), intent(inout) :: warnings !! gets findings that are odd but harmless
    type(error_t), allocatable, intent(out) :: error !! set when the file cannot be used
    type(text_t), allocatable :: names(:)
    type(restart_t) :: state
    type(error_t), allocatable :: first
    integer :: i
    logical :: is_damaged

    call find_restarts(name, names, error)
    call sim%comm%agree(error)
    if (allocated(error)) return
    do i = 1, size(names)
      call read_state(sim, names(i)%s, state, warnings, is_damaged, error)
      is_damaged = sim%comm%any(is_damaged)
      call sim%comm%agree(error)
      if (.not. allocated(error)) exit
      if (.not. allocated(first)) first = error
      if (.not. is_damaged) return
    end do
    if (allocated(error)) then
      ! The newest file is the one that was asked for.
      call move_alloc(first, error)
      return
    end if
    call check_stage(sim, state, names(i)%s, error)
    if (allocated(error)) return
    if (i > 1) call warnings%warn('this checkpoint is not used, the run goes on from the older '//names(i)%s//' of step '// &
                                  to_text(state%step)//' ('//first%message//')', file=names(1)%s)
    call take_state(sim, state)
  end subroutine load_checkpoint

  !> Refuse an older file where the stage that is due was found in the newest one.
  subroutine check_stage(sim, state, file, error)
    type(simulation_t), intent(in) :: sim
    type(restart_t), intent(in) :: state
    character(len=*), intent(in) :: file
    type(error_t), allocatable, intent(out) :: error

    if (sim%stages%number == 0 .or. sim%stages%step == state%step) return
    call fail(error, 'the newest restart file is damaged; this one is of step '//to_text(state%step)// &
              ': --restart and its name goes on from it', file=file)
  end subroutine check_stage

  !> Read a restart file; one that cannot be used is an error, and `is_damaged` where the file itself is broken.
  subroutine read_state(sim, file, state, warnings, is_damaged, error)
    type(simulation_t), intent(inout) :: sim
    character(len=*), intent(in) :: file
    type(restart_t), intent(out) :: state
    type(diagnostics_t), intent(inout) :: warnings
    logical, intent(out) :: is_damaged
    type(error_t), allocatable, intent(out) :: error
    type(diagnostics_t) :: found
    real(wp) :: signature(n_signature)

    signature = signature_of(sim%scene, sim%comm)
    call read_restart(file, sim%scene, sim%comm, state, found, nint(signature(1)), nint(signature(2)), &
                      sim%contacts%n_components, sim%contacts%n_internal, is_damaged, sim%contacts%n_carried, &
                      sim%contacts%n_kept, sim%contacts%n_moments)
    if (found%count() == 0) then
      if (size(state%totals) /= n_energy_values + n_totals_values + n_after_totals) then
        call found%add('the restart file is of another version of the program', file=file)
      else if (size(state%cell) /= merge(n_cell_values, 0, sim%scene%cell%is_on)) then
        call found%add('the restart file is of another scene: one of both has no periodic cell', file=file)
      else if (any(abs(signature_in(state) - signature(:n_of_bodies)) > 0)) then
        call found%add('the restart file is of another scene: shapes or masses differ', file=file)
      else if (len(fault_of(state)) > 0) then
        is_damaged = .true.
        call found%add('this restart file is damaged: '//fault_of(state), file=file)
      end if
    end if
    if (found%count() > 0) then
      error = found%errors(1)
    else
      if (.not. sim%is_continued) call warn_of_differences(file, state%deck_hash, sim%options, warnings)
    end if
  end subroutine read_state

  !> Sums over the bodies in the signature that a file holds.
  pure function signature_in(state) result(signature)
    type(restart_t), intent(in) :: state
    real(wp) :: signature(n_of_bodies)

    associate (last => size(state%totals))
      signature = state%totals(last - n_signature + 1:last - n_signature + n_of_bodies)
    end associate
  end function signature_in

  !> Fault of the totals, values that no run can have written; empty where there is none. Errors of steps may have any value.
  pure function fault_of(state) result(fault)
    type(restart_t), intent(in) :: state
    character(len=:), allocatable :: fault
    type(totals_t) :: totals

    fault = ''
    associate (energies => state%totals(:n_energy_values), list => list_in(state), gravity => gravity_in(state), &
               counted => state%totals(n_energy_values + 1:n_energy_values + n_totals_values))
      if (.not. all(ieee_is_finite([energies, gravity, state%tracks, state%stop, state%stages, state%means, state%fields, &
                                     state%cell, state%length, list]))) then
        fault = 'it holds sums that are not finite'
      else if (.not. totals%are_sound(counted)) then
        fault = 'it holds counts that are none'
      else if (state%step > nint(counted(1))) then
        fault = 'it is of step '//to_text(state%step)//', but counts '//to_text(nint(counted(1)))//' steps'
      end if
    end associate
  end function fault_of

  !> Bring a simulation to a state that was read.
  subroutine take_state(sim, state)
    type(simulation_t), intent(inout) :: sim
    type(restart_t), intent(in) :: state
    real(wp) :: list(n_list)

    list = list_in(state)
    sim%pairs%listed_way = list(2)
    sim%pairs%way = list(3)
    call restore_state(state, sim%scene, sim%contacts)
    call fit_impulses_to_step(sim, state%length)
    ! A file that holds nothing about presence is of a run in which all bodies were there.
    if (sim%scene%bodies%has_presence .and. size(values_of(state%bodies, 'presence')) == 0) &
      sim%scene%bodies%presence = body_present
    sim%step = state%step
    call keep_time(sim, state%time)
    call sim%energy%unpack(state%totals(:n_energy_values))
    call sim%totals%unpack(state%totals(n_energy_values + 1:n_energy_values + n_totals_values))
    sim%history%is_untouched = sim%totals%most_contacts == 0
    ! Several ranks take up their contacts when they have split the scene.
    if (sim%comm%size == 1) call resume_history(sim%history, sim%contacts)
    if (sim%scene%cell%is_on) then
      call sim%scene%cell%unpack(state%cell)
      call set_edges(sim%scene, (sim%scene%cell%built))
    end if
    if (sim%comm%size == 1 .and. size(state%built, 2) > 0) then
      sim%pairs%skin = list(1)
      associate (n => size(state%built, 1) - 1)
        call build_neighbours(sim%pairs, sim%scene, state%built(:n, :), state%built(n + 1, :))
      end associate
    end if
    if (sim%scene%cell%is_on) call set_edges(sim%scene, (sim%scene%cell%now))
    call sim%tracks%unpack(state%tracks)
    call sim%means%unpack(state%means)
    call unpack_fields(sim%fields, state%fields, sim%comm)
    call take_measures(sim, state%measures)
    if (.not. sim%stages%begins) call sim%stop%unpack(state%stop, state%time)
    call sim%energy%leave_to_first(sim%comm)
    call sim%tracks%leave_to_first(sim%comm)
    call sim%means%leave_to_first(sim%comm)
    call sim%totals%leave_to_first(sim%comm)
    ! Where it changes with time, the next step goes on from this one.
    if (allocated(sim%scene%gravity_changes)) sim%scene%gravity = gravity_in(state)
    call sim%energy%change_gravity(sim%scene, gravity_in(state))
  end subroutine take_state

  !> Take the measures of the state, where they are those that this run takes.
  pure subroutine take_measures(sim, measures)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: measures(:)

    if (size(measures) == 0 .or. .not. allocated(sim%writers%measures%column)) return
    if (size(measures) /= size(sim%writers%measures%column)) return
    sim%writers%measures%column%value = measures
    sim%writers%measured_step = sim%step
  end subroutine take_measures

  !> Give impulses the length of the substeps to come: forces stay as they are, and impulses are those of forces over a substep.
  pure subroutine fit_impulses_to_step(sim, length)
    type(simulation_t), intent(inout) :: sim !! its contacts are those of the file
    real(wp), intent(in) :: length(:) !! of the substeps of the file [s]; empty where it is unknown
    real(wp) :: ratio

    if (size(length) /= 1) return
    if (.not. (length(1) > 0 .and. abs(length(1) - sim%options%substep_length()) > 0)) return
    ratio = sim%options%substep_length()/length(1)
    associate (contacts => sim%contacts, last => sim%contacts%n_internal)
      contacts%impulse(:, :contacts%n) = ratio*contacts%impulse(:, :contacts%n)
      if (contacts%n_moments > 0) contacts%internal(last - contacts%n_moments + 1:last, :contacts%n) = &
        ratio*contacts%internal(last - contacts%n_moments + 1:last, :contacts%n)
    end associate
  end subroutine fit_impulses_to_step

  !> Gravity [m/s2] under which a file was written.
  pure function gravity_in(state) result(gravity)
    type(restart_t), intent(in) :: state
    real(wp) :: gravity(n_gravity)

    associate (last => size(state%totals) - n_signature - n_list)
      gravity = state%totals(last - n_gravity + 1:last)
    end associate
  end function gravity_in

  !> Skin and way of the list of neighbours in a file, and way of its last step [m].
  pure function list_in(state) result(list)
    type(restart_t), intent(in) :: state
    real(wp) :: list(n_list)

    associate (last => size(state%totals) - n_signature)
      list = state%totals(last - n_list + 1:last)
    end associate
  end function list_in

  !> Go on from the time of a restart file, also where the step is another one now: times are the start's and so many steps.
  pure subroutine keep_time(sim, time)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: time !! of the file [s]

    if (abs(sim%time() - time) <= 16*epsilon(1.0_wp)*max(abs(time), abs(sim%scene%start_time))) return
    sim%scene%start_time = time - sim%options%time_step*real(sim%step, wp)
  end subroutine keep_time
end module sg_checkpoint
