!> The guard against values that are not finite: it names bodies and contacts, and the state before the step can be had back.
program test_guard
  use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, put_disk, put_wall, run
  use sg_error, only: error_t, exit_broken
  use sg_guard, only: find_broken
  use sg_history, only: revive
  use sg_kinds, only: wp
  use sg_simulation, only: advance, simulation_t
  implicit none
  type(tests_t) :: t
  type(simulation_t) :: sim
  type(error_t), allocatable :: error
  real(wp) :: impulse

  call begin_scene(sim%scene, 3, 0.3_wp, 0.1_wp)
  call put_disk(sim%scene, 1, 0.5_wp, [0.0_wp, 0.5_wp])
  call put_disk(sim%scene, 2, 0.5_wp, [3.0_wp, 0.5_wp])
  call put_wall(sim%scene, 3, 10.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
  call begin_run(sim, 1e-3_wp, 1e-8_wp)
  call run(sim, 3)
  call find_broken(sim%scene, sim%contacts, 4, error)
  call t%check(.not. allocated(error), 'finite velocities are no fault')
  call t%equal(sim%contacts%n, 2, 'both disks lie on the floor')

  sim%scene%bodies%free_velocity(2, 2) = ieee_value(1.0_wp, ieee_positive_inf)
  call find_broken(sim%scene, sim%contacts, 4, error)
  call t%check(allocated(error), 'an infinity is found')
  if (allocated(error)) then
    call t%equal(error%code, exit_broken, 'exit code')
    call t%check(index(error%message, 'step 4') > 0, 'the step is named: '//error%message)
    call t%check(index(error%message, 'of bodies 2;') > 0, 'the body is named, and no other: '//error%message)
    call t%check(index(error%message, ' 2-3 ') > 0 .and. index(error%message, ' 1-3 ') == 0, 'so is its contact: '//error%message)
  end if

  ! In a decomposed scene bodies go by their numbers in the whole one.
  sim%scene%bodies%id = [21, 22, 40]
  call find_broken(sim%scene, sim%contacts, 4, error)
  if (allocated(error)) then
    call t%check(index(error%message, 'of bodies 22;') > 0, 'the number in the whole scene: '//error%message)
    call t%check(index(error%message, ' 22-40 ') > 0, 'of the contact too: '//error%message)
  end if
  deallocate (sim%scene%bodies%id)

  ! What a step that breaks leaves behind: the contacts of the step before it, as a checkpoint wants them.
  impulse = sim%contacts%impulse(1, 1)
  call t%check(impulse > 0, 'the floor pushes')
  call advance(sim, error)
  sim%contacts%impulse = 0
  call revive(sim%history, sim%pairs, sim%contacts)
  call t%equal(sim%contacts%n, 2, 'contacts before the step')
  call t%near(sim%contacts%impulse(1, 1), impulse, 0.0_wp, 'and their impulses, to the last bit')
  call t%finish()
end program test_guard
