!> Periods: what rolls, flies or is driven through them moves as if there were none.
program test_periodic
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, drive, g, hold, put_disk, put_polygon, put_wall, run
  use sg_contactors, only: add_disk, add_hollow
  use sg_kinds, only: wp
  use sg_laws, only: status_stick
  use sg_random, only: random_t
  use sg_simulation, only: simulation_t
  use sg_time_functions, only: time_function_t
  implicit none
  type(tests_t) :: t

  call test_rolling()
  call test_stack()
  call test_cloud(with_polygons=.false.)
  call test_cloud(with_polygons=.true.)
  call test_rough_wall()
  call test_smooth_wall()
  call test_drum()
  call t%finish()

contains

  !> Position in x without periods.
  pure real(wp) function unwrapped(sim, body)
    type(simulation_t), intent(in) :: sim
    integer, intent(in) :: body

    unwrapped = sim%scene%bodies%position(1, body) + sim%scene%period*real(sim%scene%bodies%crossings(body), wp)
  end function unwrapped

  !> A disk rolls through five periods, to the right or to the left: its place is v t, its contact never forgets.
  subroutine test_rolling()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: h = 1e-3_wp, r = 0.3_wp, period = 2
    real(wp) :: speed, weight
    integer :: i, step
    integer, parameter :: steps = 3500
    logical :: keeps

    do i = 1, 2
      sim => fresh()
      speed = merge(3.0_wp, -3.0_wp, i == 1)
      call begin_scene(sim%scene, 2, 0.5_wp, 0.01_wp)
      sim%scene%period = period
      call put_disk(sim%scene, 1, r, [0.4_wp, r])
      sim%scene%bodies%velocity(:, 1) = [speed, 0.0_wp, -speed/r]
      call put_wall(sim%scene, 2, 5.0_wp, 0.1_wp, [1.0_wp, -0.1_wp], 0.0_wp)
      weight = sim%scene%bodies%mass(1)*g
      call begin_run(sim, h, 1e-12_wp)
      call run(sim, 2)
      keeps = .true.
      do step = 3, steps
        call run(sim, 1)
        keeps = keeps .and. sim%report%sweeps == 1 .and. sim%contacts%n == 1 .and. sim%contacts%status(1) == status_stick &
                .and. abs(sim%contacts%impulse(1, 1)/(h*weight) - 1) < 1e-9_wp
      end do
      ! A step that starts from the right impulse needs no more than the sweep that finds this out.
      call t%check(keeps, 'rolling: the impulse is recovered in every step')
      ! 3500 additions, and a rounding of the friction impulse in each.
      call t%near(unwrapped(sim, 1), 0.4_wp + speed*sim%time(), 1e-9_wp, 'rolling: position')
      call t%equal(int(sim%scene%bodies%crossings(1)), floor((0.4_wp + speed*sim%time())/period), 'rolling: periods crossed')
      call t%check(sim%scene%bodies%position(1, 1) > -0.4_wp .and. sim%scene%bodies%position(1, 1) < period + 0.4_wp, &
                   'rolling: it is in the period, or near')
    end do
  end subroutine test_rolling

  !> A stack of squares slides without friction through the period, its two-point contacts split by the border or not.
  subroutine test_stack()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: square(2, 4) = reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 4])
    integer :: b, step
    logical :: keeps

    sim => fresh()
    call begin_scene(sim%scene, 4, 0.0_wp, 0.01_wp)
    sim%scene%period = 3
    do b = 1, 3
      call put_polygon(sim%scene, b, square + spread([0.1_wp, real(b - 1, wp)], 2, 4))
      sim%scene%bodies%velocity(1, b) = 2
    end do
    call put_wall(sim%scene, 4, 5.0_wp, 0.1_wp, [1.5_wp, -0.1_wp], 0.0_wp)
    call begin_run(sim, 2e-3_wp, 1e-12_wp)
    call run(sim, 50)
    keeps = .true.
    do step = 1, 3000
      call run(sim, 1)
      keeps = keeps .and. sim%report%sweeps <= 2 .and. sim%contacts%n == 6
    end do
    call t%check(keeps, 'stack: impulses are recovered in every step')
    do b = 1, 3
      call t%near(unwrapped(sim, b), 0.6_wp + 2*sim%time(), 1e-9_wp, 'stack: position')
    end do
  end subroutine test_stack

  !> A cloud that collides while it flies through many periods, against the same cloud in the open.
  subroutine test_cloud(with_polygons)
    logical, intent(in) :: with_polygons
    type(simulation_t), pointer :: open, periodic
    integer, parameter :: n = 25, steps = 200
    real(wp) :: worst
    integer :: b

    open => fresh()
    periodic => fresh()
    call make_cloud(open, with_polygons, 0.0_wp)
    call make_cloud(periodic, with_polygons, 9.0_wp)
    call run(open, steps)
    call run(periodic, steps)
    call t%check(periodic%pairs%builds > 3, 'cloud: lists were made again')
    call t%check(minval(periodic%scene%bodies%crossings) >= 3, 'cloud: periods were crossed')
    worst = 0
    do b = 1, n
      worst = max(worst, abs(unwrapped(periodic, b) - open%scene%bodies%position(1, b)), &
                  abs(periodic%scene%bodies%position(2, b) - open%scene%bodies%position(2, b)))
    end do
    ! The solver's 10^-10, grown by some tens of impacts of each grain: an order of magnitude each few.
    call t%near(worst, 0.0_wp, 1e-6_wp, 'cloud: the same places as in the open')
  end subroutine test_cloud

  !> Five by five grains that rush together, and all to the right.
  subroutine make_cloud(sim, with_polygons, period)
    type(simulation_t), intent(inout) :: sim
    logical, intent(in) :: with_polygons
    real(wp), intent(in) :: period
    type(random_t) :: random
    real(wp) :: place(2)
    integer :: b

    call random%seed(5)
    call begin_scene(sim%scene, 25, 0.2_wp, 0.05_wp)
    sim%scene%gravity = 0
    sim%scene%period = period
    do b = 1, 25
      place = 1.1_wp*[real(modulo(b - 1, 5), wp) + 0.5_wp, real((b - 1)/5, wp)]
      if (with_polygons .and. modulo(b, 2) == 0) then
        call put_polygon(sim%scene, b, spread(place, 2, 3) + 0.5_wp*reshape([1.0_wp, 0.0_wp, -0.5_wp, 0.8_wp, -0.6_wp, -0.7_wp], &
                                                                            [2, 3]))
      else
        call put_disk(sim%scene, b, random%uniform(0.4_wp, 0.5_wp), place)
      end if
      sim%scene%bodies%velocity(1:2, b) = [90 + 3 - place(1), 2.2_wp - place(2)]
    end do
    call begin_run(sim, 2e-3_wp, 1e-10_wp)
  end subroutine make_cloud

  !> A rough wall of disks, driven through many periods, drags the grain that lies in its hollow.
  subroutine test_rough_wall()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: speed = 20
    integer :: i

    sim => fresh()
    call begin_scene(sim%scene, 2, 0.5_wp, 0.05_wp)
    sim%scene%period = 6
    do i = 0, 5
      call add_disk(sim%scene%contactors, 1, 1, 0.5_wp, [real(i, wp) - 2.5_wp, 0.0_wp])
    end do
    sim%scene%bodies%position(:, 1) = [3.0_wp, 0.0_wp]
    sim%scene%bodies%mass(1) = 1
    sim%scene%bodies%inertia(1) = 1
    call hold(sim%scene, 1)
    call drive(sim%scene, 1, 1, time_function_t(constant=speed))
    ! The grain bridges the ends of the wall, which meet at the border of the period.
    call put_disk(sim%scene, 2, 0.5_wp, [6.0_wp, sqrt(0.75_wp)])
    sim%scene%bodies%velocity(1, :) = speed
    ! Velocities of 20 m/s against impulses of g h leave e8 a rounding of 10^-11.
    call begin_run(sim, 1e-3_wp, 1e-9_wp)
    call run(sim, 5000)
    call t%equal(sim%contacts%n, 2, 'rough wall: two contacts')
    call t%near(unwrapped(sim, 1), 3 + speed*sim%time(), 1e-9_wp, 'rough wall: position of the wall')
    call t%near(unwrapped(sim, 2), 6 + speed*sim%time(), 1e-7_wp, 'rough wall: the grain goes with it')
    call t%near(sim%scene%bodies%position(2, 2), sqrt(0.75_wp), 1e-7_wp, 'rough wall: the grain is carried')
  end subroutine test_rough_wall

  !> A smooth wall longer than the period, driven through many periods, carries a grain anywhere.
  subroutine test_smooth_wall()
    type(simulation_t), pointer :: sim
    integer :: b

    sim => fresh()
    call begin_scene(sim%scene, 4, 0.0_wp, 0.05_wp)
    sim%scene%period = 6
    call put_wall(sim%scene, 1, 4.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    call drive(sim%scene, 1, 1, time_function_t(constant=20.0_wp))
    do b = 2, 4
      call put_disk(sim%scene, b, 0.5_wp, [2*real(b, wp) - 3, 0.5_wp])
    end do
    call begin_run(sim, 1e-3_wp, 1e-11_wp)
    call run(sim, 5000)
    call t%equal(sim%contacts%n, 3, 'smooth wall: a contact for each grain')
    do b = 2, 4
      call t%near(maxval(abs(sim%scene%bodies%position(:, b) - [2*real(b, wp) - 3, 0.5_wp])), 0.0_wp, 1e-9_wp, &
                  'smooth wall: grains stay where they are')
    end do
  end subroutine test_smooth_wall

  !> A disk falls in a drum whose images nearly touch it: it moves as in a single one.
  subroutine test_drum()
    type(simulation_t), allocatable :: sim(:)
    integer :: i

    allocate (sim(2))
    do i = 1, 2
      call begin_scene(sim(i)%scene, 2, 0.3_wp, 0.05_wp)
      if (i == 2) sim(i)%scene%period = 2.1_wp
      call put_disk(sim(i)%scene, 1, 0.1_wp, [1.8_wp, 1.0_wp])
      call add_hollow(sim(i)%scene%contactors, 2, 1, 1.0_wp, [0.0_wp, 0.0_wp])
      sim(i)%scene%bodies%position(:, 2) = [1.05_wp, 1.0_wp]
      call hold(sim(i)%scene, 2)
      call begin_run(sim(i), 1e-3_wp, 1e-12_wp)
      call run(sim(i), 1000)
      call t%equal(sim(i)%contacts%n, 1, 'drum: one contact')
    end do
    call t%near(maxval(abs(sim(1)%scene%bodies%position(:, 1) - sim(2)%scene%bodies%position(:, 1))), 0.0_wp, 1e-9_wp, &
                'drum: the same place')
    call t%check(sim(1)%scene%bodies%position(2, 1) < 0.9_wp, 'drum: it has fallen')
  end subroutine test_drum
end program test_periodic
