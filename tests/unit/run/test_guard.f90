!> The guard against values that are not finite: it names bodies and contacts, and the state before the step can be had back.
program test_guard
  use, intrinsic :: ieee_arithmetic, only: ieee_flag_type, ieee_get_halting_mode, ieee_invalid, ieee_overflow, ieee_positive_inf, &
                                           ieee_quiet_nan, ieee_set_flag, ieee_set_halting_mode, ieee_value
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, put_disk, put_wall, run
  use sg_advance, only: advance
  use sg_error, only: error_t, exit_broken, exit_unbalanced
  use sg_guard, only: find_broken, judge_energy
  use sg_history, only: revive
  use sg_kinds, only: wp
  use sg_measures, only: measure, measures_t
  use sg_simulation, only: simulation_t
  implicit none
  type(tests_t) :: t
  type(simulation_t), pointer :: sim
  type(error_t), allocatable :: error
  real(wp) :: impulse
  !> What builds with all checks stop at, and whether this one does
  type(ieee_flag_type), parameter :: kinds(2) = [ieee_overflow, ieee_invalid]
  logical :: halts(2)

  sim => fresh()
  call begin_scene(sim%scene, 3, 0.3_wp, 0.1_wp)
  call put_disk(sim%scene, 1, 0.5_wp, [0.0_wp, 0.5_wp])
  call put_disk(sim%scene, 2, 0.5_wp, [3.0_wp, 0.5_wp])
  call put_wall(sim%scene, 3, 10.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
  call begin_run(sim, 1e-3_wp, 1e-8_wp)
  call run(sim, 3)
  call find_broken(sim%scene, sim%contacts, 4, sim%options%time_step, .true., error)
  call t%check(.not. allocated(error), 'finite velocities are no fault')
  call t%equal(sim%contacts%n, 2, 'both disks lie on the floor')

  sim%scene%bodies%free_velocity(2, 2) = ieee_value(1.0_wp, ieee_positive_inf)
  call find_broken(sim%scene, sim%contacts, 4, sim%options%time_step, .true., error)
  call t%check(allocated(error), 'an infinity is found')
  if (allocated(error)) then
    call t%equal(error%code, exit_broken, 'exit code')
    call t%check(index(error%message, 'step 4') > 0, 'the step is named: '//error%message)
    call t%check(index(error%message, 'of bodies 2;') > 0, 'the body is named, and no other: '//error%message)
    call t%check(index(error%message, ' 2-3 ') > 0 .and. index(error%message, ' 1-3 ') == 0, 'so is its contact: '//error%message)
  end if

  ! In a decomposed scene bodies go by their numbers in the whole one.
  sim%scene%bodies%id = [21, 22, 40]
  call find_broken(sim%scene, sim%contacts, 4, sim%options%time_step, .true., error)
  if (allocated(error)) then
    call t%check(index(error%message, 'of bodies 22;') > 0, 'the number in the whole scene: '//error%message)
    call t%check(index(error%message, ' 22-40 ') > 0, 'of the contact too: '//error%message)
  end if
  deallocate (sim%scene%bodies%id)

  ! What a step that breaks leaves behind: the contacts of the step before it, as a checkpoint wants them.
  impulse = sim%contacts%impulse(1, 1)
  call t%check(impulse > 0, 'the floor pushes')
  call trap(.false.)
  call test_other_contacts()
  call trap(.true.)
  call advance(sim, error)
  sim%contacts%impulse = 0
  call revive(sim%history, sim%pairs, sim%contacts)
  call t%equal(sim%contacts%n, 2, 'contacts before the step')
  call t%near(sim%contacts%impulse(1, 1), impulse, 0.0_wp, 'and their impulses, to the last bit')
  call trap(.false.)
  call test_positions()
  call trap(.true.)
  call test_energy()
  if (allocated(error)) deallocate (error)
  call t%finish()
contains

  !> Builds with all checks stop where a number overflows or is none, before the guard can look: in some tests it shall.
  subroutine trap(numbers)
    logical, intent(in) :: numbers

    if (.not. numbers) call ieee_get_halting_mode(kinds, halts)
    if (numbers) call ieee_set_flag(kinds, .false.)
    call ieee_set_halting_mode(kinds, numbers .and. halts)
  end subroutine trap

  !> A step that breaks without contacts solved, and with fewer contacts than the one before, which come back nonetheless.
  subroutine test_other_contacts()
    type(simulation_t), pointer :: other

    other => fresh(sim)
    other%scene%bodies%position(2, 2) = 5
    other%scene%bodies%velocity(1, 1) = 1e200_wp
    call advance(other, error)
    call t%check(allocated(error), 'velocities beyond energies end the step before its contacts are solved')
    if (.not. allocated(error)) return
    call t%check(index(error%message, 'without contacts') > 0 .and. index(error%message, 'of bodies 1;') > 0, error%message)
    call t%equal(other%step, sim%step, 'no step is done')
    call t%equal(other%contacts%n, 0, 'what flies touches nothing')
    call revive(other%history, other%pairs, other%contacts)
    call t%equal(other%contacts%n, 2, 'the two contacts before it')
    call t%near(other%contacts%impulse(1, 1), impulse, 0.0_wp, 'with their impulses')
  end subroutine test_other_contacts

  !> Positions out of range, and impulses and gaps that are no numbers.
  subroutine test_positions()
    type(simulation_t), pointer :: other

    other => fresh(sim)
    other%scene%bodies%free_velocity = 0
    other%contacts%impulse(:, :other%contacts%n) = 0
    call find_broken(other%scene, other%contacts, 1, 1e-3_wp, .true., error)
    call t%check(.not. allocated(error), 'nothing is wrong')
    other%contacts%gap(2) = ieee_value(1.0_wp, ieee_quiet_nan)
    call find_broken(other%scene, other%contacts, 1, 1e-3_wp, .true., error)
    call t%check(allocated(error), 'a gap that is no number')
    if (allocated(error)) call t%check(index(error%message, 'contacts are not finite of bodies') > 0, error%message)
    other%contacts%gap(2) = 0
    other%scene%bodies%position(1, 2) = 1e160_wp
    call find_broken(other%scene, other%contacts, 1, 1e-3_wp, .true., error)
    call t%check(allocated(error), 'a place whose distances have no squares')
    if (allocated(error)) call t%check(index(error%message, 'positions are not finite of bodies 2;') > 0, error%message)
  end subroutine test_positions

  !> The energy balance: what is open is told, or ends the run.
  subroutine test_energy()
    type(simulation_t), pointer :: other
    type(measures_t) :: measures
    character(len=:), allocatable :: warning

    other => fresh(sim)
    call measure(other%scene, other%contacts, other%options%time_step, other%energy, measures)
    call judge_energy(measures, other%options%guard, 7, .false., warning, error)
    call t%check(.not. allocated(error) .and. warning == '', 'a balance that closes')
    ! Work that no force did.
    other%energy%external_work = other%energy%external_work + 1e6_wp
    call measure(other%scene, other%contacts, other%options%time_step, other%energy, measures)
    call judge_energy(measures, other%options%guard, 7, .false., warning, error)
    call t%check(.not. allocated(error) .and. index(warning, 'step 7: the energy balance is open by 1.0E+00') > 0, warning)
    call judge_energy(measures, other%options%guard, 7, .true., warning, error)
    call t%check(.not. allocated(error) .and. warning == '', 'told once')
    other%options%guard%energy = 'ignore'
    call judge_energy(measures, other%options%guard, 7, .false., warning, error)
    call t%check(.not. allocated(error) .and. warning == '', 'or not at all')
    other%options%guard%energy = 'stop'
    call judge_energy(measures, other%options%guard, 7, .false., warning, error)
    call t%check(allocated(error), 'or it ends the run')
    if (allocated(error)) call t%equal(error%code, exit_unbalanced, 'with a code of its own')
  end subroutine test_energy
end program test_guard
