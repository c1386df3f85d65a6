!> The theta scheme of free and driven bodies: exact for what it integrates exactly, by hand for one step.
program test_motion
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, drive, g, hold, put_disk, run
  use sg_bodies, only: bodies_t
  use sg_drives, only: drive_t, mark_walls, pressure_t
  use sg_kinds, only: wp
  use sg_motion, only: predict, update
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  use sg_time_functions, only: time_function_t
  implicit none
  real(wp), parameter :: h = 0.01_wp
  type(tests_t) :: t

  call test_one_step()
  call test_flight()
  call test_driven()
  call test_forces()
  call test_time_functions()
  call test_walls()
  call t%finish()

contains

  !> One step by hand, theta = 0.75.
  subroutine test_one_step()
    type(scene_t) :: scene
    real(wp), parameter :: theta = 0.75_wp

    call begin_scene(scene, 1, 0.5_wp, 0.0_wp)
    call put_disk(scene, 1, 1.0_wp, [1.0_wp, 2.0_wp])
    scene%bodies%velocity(:, 1) = [3.0_wp, 4.0_wp, 5.0_wp]
    scene%bodies%angle(1) = 6
    call predict(scene, 0.0_wp, h, theta)
    call near(scene%bodies%middle(:, 1), [1.0_wp, 2.0_wp, 6.0_wp] + 0.25_wp*h*[3.0_wp, 4.0_wp, 5.0_wp], 'middle')
    call near(scene%bodies%free_velocity(:, 1), [3.0_wp, 4.0_wp - g*h, 5.0_wp], 'free velocity')
    scene%bodies%free_velocity(:, 1) = [7.0_wp, 8.0_wp, 9.0_wp]
    call update(scene%bodies, h, theta)
    call near([scene%bodies%position(:, 1), scene%bodies%angle(1)], [1.0_wp, 2.0_wp, 6.0_wp] &
              + h*(0.25_wp*[3.0_wp, 4.0_wp, 5.0_wp] + 0.75_wp*[7.0_wp, 8.0_wp, 9.0_wp]), 'position')
    call near(scene%bodies%velocity(:, 1), [7.0_wp, 8.0_wp, 9.0_wp], 'velocity')
  end subroutine test_one_step

  !> Check a list of numbers of order one to ten: to rounding.
  subroutine near(got, expected, what)
    real(wp), intent(in) :: got(:), expected(:)
    character(len=*), intent(in) :: what

    call t%near(maxval(abs(got - expected)), 0.0_wp, 1e-14_wp, what)
  end subroutine near

  !> Ballistic flight: velocities exact; positions y0 + v t - g t^2/2 + (1/2 - theta) g h t, so exact at theta 1/2.
  subroutine test_flight()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: thetas(3) = [0.5_wp, 0.6_wp, 1.0_wp]
    real(wp) :: time
    integer :: i

    do i = 1, 3
      sim => fresh()
      call begin_scene(sim%scene, 1, 0.5_wp, 0.0_wp)
      call put_disk(sim%scene, 1, 1.0_wp, [1.0_wp, 2.0_wp])
      sim%scene%bodies%velocity(:, 1) = [3.0_wp, 4.0_wp, 5.0_wp]
      sim%options%theta = thetas(i)
      call begin_run(sim, h, 1e-6_wp)
      call run(sim, 100)
      time = sim%time()
      ! A hundred additions of numbers up to ten: some 10^-15 each.
      call t%near(time, 100*h, 0.0_wp, 'flight: time')
      call t%near(maxval(abs(sim%scene%bodies%velocity(:, 1) - [3.0_wp, 4.0_wp - g*time, 5.0_wp])), 0.0_wp, 1e-13_wp, &
                  'flight: velocity')
      call t%near(sim%scene%bodies%position(1, 1), 1 + 3*time, 1e-13_wp, 'flight: x')
      call t%near(sim%scene%bodies%position(2, 1), 2 + 4*time - g*time**2/2 + (0.5_wp - thetas(i))*g*h*time, 1e-13_wp, 'flight: y')
      call t%near(sim%scene%bodies%angle(1), 5*time, 1e-13_wp, 'flight: angle')
    end do
  end subroutine test_flight

  !> A driven body: the imposed velocity at the end of each step, positions by the trapezium rule for theta 1/2.
  subroutine test_driven()
    type(simulation_t), pointer :: sim
    type(time_function_t) :: shaking
    real(wp) :: expected, exact
    integer :: i
    integer, parameter :: steps = 200

    sim => fresh()
    shaking = time_function_t(constant=0.1_wp, amplitude=2.0_wp, omega=7.0_wp, phase=0.3_wp)
    call begin_scene(sim%scene, 1, 0.5_wp, 0.0_wp)
    call put_disk(sim%scene, 1, 1.0_wp, [1.0_wp, 2.0_wp])
    call hold(sim%scene, 1)
    sim%scene%drives(1)%value = shaking
    sim%scene%bodies%velocity(1, 1) = shaking%at(0.0_wp)
    call begin_run(sim, h, 1e-6_wp)
    call run(sim, steps)
    expected = 1
    do i = 1, steps
      expected = expected + h/2*(shaking%at(h*real(i - 1, wp)) + shaking%at(h*real(i, wp)))
    end do
    call t%near(sim%scene%bodies%velocity(1, 1), shaking%at(sim%time()), 1e-14_wp, 'driven: velocity at the end of the step')
    call t%near(sim%scene%bodies%position(1, 1), expected, 1e-13_wp, 'driven: position by the trapezium rule')
    exact = 1 + 0.1_wp*sim%time() + 2/7.0_wp*(sin(7*sim%time() + 0.3_wp) - sin(0.3_wp))
    ! The rule's error is h^2/12 times the change of the acceleration, at most 2*2*7.
    call t%near(sim%scene%bodies%position(1, 1), exact, h**2/12*28, 'driven: position near the integral')
    call t%near(sim%scene%bodies%position(2, 1), 2.0_wp, 0.0_wp, 'driven: held components stay')
  end subroutine test_driven

  !> Imposed forces by (1 - theta) f(t) + theta f(t + h); pressures along their direction times their length.
  subroutine test_forces()
    type(scene_t) :: scene
    type(time_function_t) :: ramp

    ramp = time_function_t(constant=2.0_wp, ramp_start=0.0_wp, ramp_rate=10.0_wp)
    call begin_scene(scene, 3, 0.5_wp, 0.0_wp)
    call put_disk(scene, 1, 1.0_wp, [0.0_wp, 0.0_wp])
    call put_disk(scene, 2, 1.0_wp, [0.0_wp, 0.0_wp])
    call put_disk(scene, 3, 1.0_wp, [5.0_wp, 0.0_wp])
    scene%gravity = 0
    scene%drives = [drive_t(body=1, component=1, is_velocity=.false., value=ramp), &
                    drive_t(body=1, component=3, is_velocity=.false., value=time_function_t(constant=-3.0_wp))]
    deallocate (scene%pressures)
    allocate (scene%pressures(2))
    scene%pressures(1) = pressure_t(body=1, direction=[0.0_wp, -1.0_wp, 0.0_wp], length=4.0_wp, &
                                       value=time_function_t(constant=10.0_wp))
    scene%pressures(2) = pressure_t(body=2, direction=[0.0_wp, 1.0_wp, 0.0_wp], between=[2, 3], thickness=1.5_wp, value=ramp)
    call predict(scene, 0.02_wp, h, 0.75_wp)
    ! The ramp gives 0.4 at 0.02 s and 0.6 at 0.03 s.
    call near(scene%bodies%force(:, 1), [0.25_wp*0.4_wp + 0.75_wp*0.6_wp, -40.0_wp, -3.0_wp], 'force, moment and pressure')
    call near(scene%bodies%force(:, 2), [0.0_wp, 3.5_wp*0.55_wp, 0.0_wp], 'pressure between two bodies')
    call near(scene%bodies%free_velocity(:, 1), h*scene%bodies%inverse_mass(:, 1)*scene%bodies%force(:, 1), 'their velocity')
    call drive(scene, 2, 2, time_function_t(constant=0.7_wp))
    call predict(scene, 0.02_wp, h, 0.75_wp)
    call near(scene%bodies%free_velocity(2:2, 2), [0.7_wp], 'an imposed velocity wins over forces')
  end subroutine test_forces

  !> Values of functions of time.
  subroutine test_time_functions()
    type(time_function_t) :: value

    value = time_function_t(constant=2.0_wp, amplitude=3.0_wp, omega=2.0_wp, phase=0.5_wp, ramp_start=0.1_wp, ramp_rate=0.2_wp)
    call near([value%at(1.0_wp)], [(2 + 3*cos(2.5_wp))*0.3_wp], 'cosine and ramp')
    call near([value%at(100.0_wp)], [2 + 3*cos(200.5_wp)], 'the ramp ends at one')
    allocate (value%times(3), value%values(3))
    value%times = [1.0_wp, 2.0_wp, 4.0_wp]
    value%values = [10.0_wp, 20.0_wp, -20.0_wp]
    call near([value%at(0.0_wp), value%at(1.5_wp), value%at(2.0_wp), value%at(3.0_wp), value%at(9.0_wp)], &
              [10.0_wp, 15.0_wp, 20.0_wp, 0.0_wp, -20.0_wp], 'a table')
  end subroutine test_time_functions

  !> What is held in a plane is a grain; what is driven, or held otherwise, is none.
  subroutine test_walls()
    type(bodies_t) :: bodies
    type(drive_t), allocatable :: drives(:)
    integer :: i

    call bodies%allocate(6, 3)
    allocate (drives(0))
    ! Held along y; along y and about x and z; along y and about all; along x and y; moved along y; free.
    call impose(drives, 1, [2], 0.0_wp)
    call impose(drives, 2, [2, 4, 6], 0.0_wp)
    call impose(drives, 3, [2, 4, 5, 6], 0.0_wp)
    call impose(drives, 4, [1, 2], 0.0_wp)
    call impose(drives, 5, [2], 1.0_wp)
    call mark_walls(drives, [pressure_t ::], bodies)
    call t%check(all(bodies%is_grain .eqv. [(any(i == [1, 2, 6]), i=1, 6)]), 'grains in space, held in a plane')
    bodies%is_grain = .true.
    call mark_walls(drives, [pressure_t(body=2)], bodies)
    call t%check(all(bodies%is_grain .eqv. [(any(i == [1, 6]), i=1, 6)]), 'a pressed body is a wall')
    call bodies_of_the_plane()
  end subroutine test_walls

  !> Impose one velocity on components of a body.
  subroutine impose(drives, body, components, value)
    type(drive_t), allocatable, intent(inout) :: drives(:)
    integer, intent(in) :: body, components(:)
    real(wp), intent(in) :: value
    integer :: k

    do k = 1, size(components)
      drives = [drives, drive_t(body=body, component=components(k), value=time_function_t(constant=value))]
    end do
  end subroutine impose

  !> In the plane a held body is a wall, whatever is held.
  subroutine bodies_of_the_plane()
    type(bodies_t) :: bodies

    call bodies%allocate(2)
    call mark_walls([drive_t(body=1, component=3)], [pressure_t ::], bodies)
    call t%check(all(bodies%is_grain .eqv. [.false., .true.]), 'held bodies of the plane')
  end subroutine bodies_of_the_plane
end program test_motion
