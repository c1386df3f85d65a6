!> Impulses carried from step to step in space: by pair, image and feature, while normals turn and lists are rebuilt; and runs
!! that are stopped, written, read and continued, bit for bit.
program test_history_space
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use kept_states, only: check_same_state, count_marks, mark_all
  use scenes, only: begin_run, drive, place_bodies, run
  use scenes_space, only: begin_space_scene, put_box, put_capsule, put_plane, put_sphere, turn_at_random
  use sg_checkpoint, only: load_checkpoint, save_checkpoint
  use sg_contacts, only: contacts_t, impulse_vector, normal_impulse
  use sg_detect, only: detect
  use sg_error, only: diagnostics_t, error_t
  use sg_hdf5, only: hdf5_is_available
  use sg_history, only: history_t, resume_history
  use sg_kinds, only: wp
  use sg_laws, only: status_slide
  use sg_neighbour_list, only: neighbours_t
  use sg_random, only: random_t
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t, start_simulation
  use sg_system, only: make_folder, remove_file
  use sg_time_functions, only: time_function_t
  implicit none
  character(len=*), parameter :: folder = 'continuation_in_space'
  integer, parameter :: rows = 4, n_grains = rows**3, rounds = 20
  type(tests_t) :: t

  call test_recovery([0.0_wp, 0.0_wp], 'box')
  call test_recovery([real(rows, wp), real(rows, wp)], 'periodic')
  call test_turning()
  call test_images()
  if (hdf5_is_available()) then
    call test_restart('spheres', 0, [0.0_wp, 0.0_wp], 0.4_wp)
    call test_restart('spheres without friction', 0, [0.0_wp, 0.0_wp], 0.0_wp)
    call test_restart('periodic polyhedra', 1, [5.5_wp, 5.5_wp], 0.4_wp)
    call test_restart('all shapes without friction', 2, [5.5_wp, 0.0_wp], 0.0_wp)
  else
    write (*, '(a)') 'skipped: this build has no HDF5'
  end if
  call t%finish()

contains

  !> Boxes and spheres that nearly touch, on a floor.
  subroutine make_scene(scene, period)
    type(scene_t), intent(out) :: scene
    real(wp), intent(in) :: period(2)
    integer :: b

    call begin_space_scene(scene, n_grains + 1, 0.3_wp, 0.3_wp)
    scene%period = period(1)
    scene%period_y = period(2)
    do b = 1, n_grains
      associate (place => real([modulo(b - 1, rows), modulo((b - 1)/rows, rows), (b - 1)/rows**2], wp) + 0.5_wp)
        if (modulo(b, 3) == 0) then
          call put_sphere(scene, b, 0.5_wp, place)
        else
          call put_box(scene, b, [0.5_wp, 0.48_wp, 0.46_wp], place)
        end if
      end associate
    end do
    call put_plane(scene, n_grains + 1, [20.0_wp, 20.0_wp, 0.1_wp], [2.0_wp, 2.0_wp, -0.1_wp])
    call place_bodies(scene)
  end subroutine make_scene

  !> Bodies move a little and far; contacts that were there keep their impulses, new ones take over the remaining ones of
  !! their pair or start at zero.
  subroutine test_recovery(period, name)
    real(wp), intent(in) :: period(2)
    character(len=*), intent(in) :: name
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts, before
    type(random_t) :: random
    integer :: round, wrong, new, b, kept

    call random%seed(1)
    call make_scene(scene, period)
    contacts%dimension = 3
    contacts%n_components = 3
    call detect(scene, pairs, history, contacts)
    call count_marks(before, contacts, wrong, new)
    call t%equal(new, contacts%n, name//': at first all contacts are new')
    kept = 0
    do round = 1, rounds
      call mark_all(contacts)
      before = contacts
      do b = 1, n_grains
        scene%bodies%position(:, b) = scene%bodies%position(:, b) + 0.01_wp*[random%uniform() + 4, random%uniform() + 2, &
                                                                            random%uniform() - 0.5_wp]
      end do
      call place_bodies(scene)
      call detect(scene, pairs, history, contacts)
      call count_marks(before, contacts, wrong, new)
      call t%equal(wrong, 0, name//': impulses are those of the same pair and feature')
      kept = kept + contacts%n - new
      call t%check(new < contacts%n/3, name//': most contacts go on')
    end do
    call t%check(pairs%builds > 6, name//': the list was made again several times')
    call t%check(kept > rounds*150, name//': contacts were kept')
  end subroutine test_recovery

  !> A sphere rolls over another that is held: the normal turns by a quarter and more, and yet the impulse of the last step is
  !! always the guess of the next, as a vector in the world.
  subroutine test_turning()
    type(simulation_t), pointer :: sim
    real(wp) :: last(3), n(3)
    integer :: i, lost
    type(scene_t) :: copy
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts

    sim => fresh()
    call begin_space_scene(sim%scene, 2, 0.5_wp, 0.01_wp)
    call put_sphere(sim%scene, 1, 0.2_wp, [0.0_wp, 0.0_wp, 0.7_wp])
    call put_sphere(sim%scene, 2, 0.5_wp, [0.0_wp, 0.0_wp, 0.0_wp])
    do i = 1, 6
      call drive(sim%scene, 2, i, time_function_t())
    end do
    sim%scene%bodies%velocity(1:3, 1) = [0.5_wp, 0.0_wp, 0.0_wp]
    call begin_run(sim, 1e-3_wp, 1e-12_wp)
    call run(sim, 1)
    lost = 0
    do i = 1, 300
      last = impulse_vector(sim%contacts, 1)
      copy = sim%scene
      pairs = sim%pairs
      history = sim%history
      contacts = sim%contacts
      call detect(copy, pairs, history, contacts)
      if (contacts%n /= 1) exit
      if (any(abs(contacts%impulse(:, 1) - last) > 0)) lost = lost + 1
      call run(sim, 1)
      if (sim%contacts%n /= 1) exit
    end do
    n = sim%contacts%normal(:, 1)
    call t%check(n(3) < 0.8_wp, 'turning normal: it has turned')
    call t%equal(lost, 0, 'turning normal: no impulse is lost')
    call t%check(i > 150, 'turning normal: over many steps')
    call t%check(normal_impulse(sim%contacts, 1) >= 0, 'turning normal: it presses')
  end subroutine test_turning

  !> Two spheres in a narrow period touch each other on both sides, in x or in y, or on all four sides at once: each image keeps
  !! its own impulse when the list is rebuilt, when contacts are loaded from a restart, and when one or both cross borders.
  subroutine test_images()
    type(scene_t) :: scene
    type(neighbours_t) :: pairs
    type(history_t) :: history
    type(contacts_t) :: contacts
    type(random_t) :: random
    integer :: i, round, sides, n_apart

    call random%seed(5)
    do i = 1, 3
      sides = merge(4, 2, i == 3)
      call begin_space_scene(scene, 2, 0.3_wp, 0.05_wp)
      scene%period = 2
      scene%period_y = 2
      call put_sphere(scene, 1, 0.5_wp*sqrt(real(sides/2, wp)), [0.4_wp, 0.4_wp, 0.0_wp])
      call put_sphere(scene, 2, 0.5_wp*sqrt(real(sides/2, wp)), [merge(0.4_wp, 1.4_wp, i == 2), merge(0.4_wp, 1.4_wp, i == 1), &
                                                                   0.0_wp])
      call place_bodies(scene)
      contacts = contacts_t()
      contacts%dimension = 3
      contacts%n_components = 3
      pairs = neighbours_t()
      history = history_t()
      n_apart = 0
      call detect(scene, pairs, history, contacts)
      do round = 1, 40
        call t%equal(contacts%n, sides, 'images: all sides touch')
        contacts%impulse(:, :sides) = contacts%normal(:, :sides)
        contacts%status(:sides) = status_slide
        if (modulo(round, 3) == 0) then
          history = history_t()
          call resume_history(history, contacts)
          pairs = neighbours_t()
        end if
        associate (way => random%uniform(0.5_wp, 5.0_wp)*[random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp), 1.0_wp])
          scene%bodies%position = scene%bodies%position + spread(way, 2, 2)
        end associate
        call place_bodies(scene)
        call detect(scene, pairs, history, contacts)
        call t%near(maxval(abs(contacts%impulse(:, :sides) - contacts%normal(:, :sides))), 0.0_wp, 1e-12_wp, &
                    'images: each side keeps its own impulse')
        associate (x => scene%bodies%crossings, y => scene%bodies%crossings_y)
          if (x(1) /= x(2) .or. y(1) /= y(2)) n_apart = n_apart + 1
        end associate
      end do
      call t%check(n_apart > 5, 'images: one of the two was beyond a border')
    end do
  end subroutine test_images

  !> Straight run against runs split in two places.
  subroutine test_restart(name, shapes, period, friction)
    character(len=*), intent(in) :: name
    integer, intent(in) :: shapes
    real(wp), intent(in) :: period(2), friction
    type(simulation_t), pointer :: straight, first, second
    type(error_t), allocatable :: error
    type(diagnostics_t) :: warnings
    integer, parameter :: steps = 200
    integer :: i, split

    straight => fresh()
    first => fresh()
    second => fresh()
    call t%check(make_folder(folder), name//': the folder is there')
    call make(straight, shapes, period, friction)
    call run(straight, steps)
    call t%check(straight%pairs%builds > 4, name//': lists were made again')
    call t%check(straight%contacts%n > 60, name//': there are contacts')
    do i = 1, 2
      split = merge(1, 117, i == 1)
      call remove_file(folder//'/restart_a.h5')
      call remove_file(folder//'/restart_b.h5')
      call make(first, shapes, period, friction)
      call run(first, split)
      call save_checkpoint(first, error)
      call t%check(.not. allocated(error), name//': a checkpoint is written')
      call make(second, shapes, period, friction)
      call load_checkpoint(second, folder, warnings, error)
      call t%check(.not. allocated(error), name//': it is read')
      if (allocated(error)) return
      call t%equal(second%step, split, name//': step')
      call run(second, steps - split)
      call check_same_state(t, straight, second, name)
      first => fresh()
      second => fresh()
    end do
  end subroutine test_restart

  !> Grains fall onto a shaken floor, between planes or in a period that a wind carries them through.
  subroutine make(sim, shapes, period, friction)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: shapes
    real(wp), intent(in) :: period(2), friction
    integer, parameter :: n = 75
    type(random_t) :: random
    integer :: b

    call random%seed(12)
    call begin_space_scene(sim%scene, n + 1, friction, 0.05_wp)
    sim%scene%period = period(1)
    sim%scene%period_y = period(2)
    do b = 1, n
      associate (place => 1.1_wp*real([modulo(b - 1, 5), modulo((b - 1)/5, 5), (b - 1)/25], wp) + 0.55_wp)
        select case (shapes*modulo(b, 1 + shapes))
        case (0)
          call put_sphere(sim%scene, b, random%uniform(0.4_wp, 0.5_wp), place)
        case (1:2)
          call put_box(sim%scene, b, [0.3_wp, 0.25_wp, 0.35_wp], place)
        case default
          call put_capsule(sim%scene, b, 0.2_wp, 0.3_wp, place)
        end select
      end associate
      call turn_at_random(sim%scene, b, random)
      sim%scene%bodies%velocity(1:3, b) = [merge(4.0_wp, 0.0_wp, period(1) > 0), merge(-3.0_wp, 0.0_wp, period(2) > 0), -2.0_wp] &
                                          + [random%uniform(), random%uniform(), random%uniform()]
    end do
    call put_plane(sim%scene, n + 1, [20.0_wp, 20.0_wp, 0.1_wp], [2.75_wp, 2.75_wp, -0.1_wp])
    ! Take back the hold along z.
    do b = 1, size(sim%scene%drives)
      if (sim%scene%drives(b)%component == 3) sim%scene%drives(b)%value = time_function_t(amplitude=0.2_wp, omega=30.0_wp)
    end do
    sim%options%folder = folder
    sim%options%deck_hash = 'cafe'
    sim%options%time_step = 4e-3_wp
    ! Bit for bit, converged or not.
    sim%options%solver%maximum_sweeps = 60
    call start_simulation(sim)
  end subroutine make
end program test_history_space
