!> A run that is stopped, written, read and continued is the straight run, bit for bit, with new lists of neighbours in between.
program test_continuation
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use kept_states, only: check_same_state
  use scenes, only: begin_scene, drive, put_disk, put_polygon, put_wall, run
  use sg_checkpoint, only: load_checkpoint, save_checkpoint
  use sg_error, only: diagnostics_t, error_t
  use sg_hdf5, only: hdf5_is_available
  use sg_kinds, only: wp
  use sg_laws, only: law_iqs_g0, law_mohr
  use sg_random, only: random_t
  use sg_simulation, only: simulation_t, start_simulation
  use sg_system, only: make_folder, remove_file
  use sg_time_functions, only: time_function_t
  implicit none
  character(len=*), parameter :: folder = 'continuation'
  integer, parameter :: columns = 8, rows = 8, n = columns*rows
  type(tests_t) :: t

  if (hdf5_is_available()) then
    call test_scene('disks', with_polygons=.false., period=0.0_wp, friction=0.4_wp)
    call test_scene('disks without friction', with_polygons=.false., period=0.0_wp, friction=0.0_wp)
    call test_scene('periodic polygons', with_polygons=.true., period=9.0_wp, friction=0.4_wp)
    call test_scene('periodic, bonded', with_polygons=.false., period=9.0_wp, friction=0.3_wp, kind=law_mohr)
    call test_scene('gaps from the start', with_polygons=.true., period=0.0_wp, friction=0.3_wp, kind=law_iqs_g0)
  else
    write (*, '(a)') 'skipped: this build has no HDF5'
    call t%check(.true., 'skipped')
  end if
  call t%finish()

contains

  !> Straight run against runs split in two places.
  subroutine test_scene(name, with_polygons, period, friction, kind)
    character(len=*), intent(in) :: name
    logical, intent(in) :: with_polygons
    real(wp), intent(in) :: period, friction
    integer, intent(in), optional :: kind !! of law; inelastic quasi-shock unless given
    type(simulation_t), pointer :: straight, first, second
    type(error_t), allocatable :: error
    type(diagnostics_t) :: warnings
    integer, parameter :: steps = 500
    integer :: i, split, builds

    straight => fresh()
    first => fresh()
    second => fresh()
    call t%check(make_folder(folder), name//': the folder is there')
    call make(straight, with_polygons, period, friction, kind)
    call run(straight, steps)
    builds = straight%pairs%builds
    call t%check(builds > 4, name//': lists were made again')
    call t%check(straight%contacts%n > n, name//': there are contacts')
    do i = 1, 2
      split = merge(1, 237, i == 1)
      call remove_file(folder//'/restart_a.h5')
      call remove_file(folder//'/restart_b.h5')
      call make(first, with_polygons, period, friction, kind)
      call run(first, split)
      call save_checkpoint(first, error)
      call t%check(.not. allocated(error), name//': a checkpoint is written')
      call make(second, with_polygons, period, friction, kind)
      call load_checkpoint(second, folder, warnings, error)
      call t%check(.not. allocated(error), name//': it is read')
      if (allocated(error)) return
      call t%equal(second%step, split, name//': step')
      call run(second, steps - split)
      call t%check(second%pairs%builds > 2, name//': lists were made again after the split')
      call check_same_state(t, straight, second, name)
      first => fresh()
      second => fresh()
    end do
  end subroutine test_scene

  !> Grains of two shapes fall onto a shaken floor, between walls or in a period that a wind carries them through.
  subroutine make(sim, with_polygons, period, friction, kind)
    type(simulation_t), intent(inout) :: sim
    logical, intent(in) :: with_polygons
    real(wp), intent(in) :: period, friction
    integer, intent(in), optional :: kind
    type(random_t) :: random
    real(wp) :: place(2)
    integer :: b

    call random%seed(12)
    call begin_scene(sim%scene, n + 3, friction, 0.05_wp)
    sim%scene%period = period
    do b = 1, n
      place = 1.1_wp*[real(modulo(b - 1, columns), wp) + 0.6_wp, real((b - 1)/columns, wp) + 0.6_wp]
      if (with_polygons .and. modulo(b, 3) > 0) then
        call put_polygon(sim%scene, b, spread(place, 2, 4) + 0.5_wp*reshape([1.0_wp, 0.1_wp, -0.1_wp, 1.0_wp, -1.0_wp, -0.1_wp, &
                                                                             0.1_wp, -1.0_wp], [2, 4]))
      else
        call put_disk(sim%scene, b, random%uniform(0.4_wp, 0.5_wp), place)
      end if
      sim%scene%bodies%velocity(1:2, b) = [merge(4.0_wp, 0.0_wp, period > 0) + random%uniform(-1.0_wp, 1.0_wp), random%uniform()]
    end do
    call put_wall(sim%scene, n + 1, 30.0_wp, 0.1_wp, [5.0_wp, -0.1_wp], 0.0_wp)
    call put_wall(sim%scene, n + 2, merge(0.5_wp, 30.0_wp, period > 0), 0.1_wp, [-0.5_wp, 0.4_wp], 1.5_wp)
    call put_wall(sim%scene, n + 3, merge(0.5_wp, 30.0_wp, period > 0), 0.1_wp, [9.5_wp, 0.4_wp], 1.6_wp)
    call drive(sim%scene, n + 1, 2, time_function_t(amplitude=0.2_wp, omega=30.0_wp))
    if (present(kind)) then
      sim%scene%laws(1)%kind = kind
      sim%scene%laws(1)%normal_cohesion = 1e4_wp
      sim%scene%laws(1)%dynamic_friction = 0.1_wp
    end if
    sim%options%folder = folder
    sim%options%deck_hash = 'cafe'
    sim%options%time_step = 2e-3_wp
    ! Bit for bit, converged or not.
    sim%options%solver%maximum_sweeps = 100
    call start_simulation(sim)
  end subroutine make
end program test_continuation
