!> Blocks and disks on inclines and in a V: sticking, sliding, rolling, and static against dynamic friction.
!!
!! A constant acceleration makes the theta scheme exact: velocities grow by a h each step. What is left is the first step,
!! and rounding through the solver's tolerance.
program test_slopes
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, force_on, g, put_disk, put_polygon, put_wall, run
  use sg_kinds, only: wp, pi
  use sg_laws, only: status_slide, status_stick
  use sg_measures, only: measure, measures_t
  use sg_simulation, only: simulation_t
  implicit none
  real(wp), parameter :: h = 1e-3_wp, angle = 0.5_wp, slope(2) = [cos(angle), -sin(angle)]
  ! Of the acceleration g: 10^-10 of the solver over steps and sums.
  real(wp), parameter :: exactly = 1e-8_wp
  type(tests_t) :: t

  call test_block()
  call test_disk()
  call test_static_friction()
  call test_v()
  call test_locked_v()
  call t%finish()

contains

  !> A segment that falls to the right by the angle, its surface through the origin.
  subroutine put_slope(sim, body)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: body

    call put_wall(sim%scene, body, 20.0_wp, 0.1_wp, -0.1_wp*[sin(angle), cos(angle)], -angle)
  end subroutine put_slope

  !> Mean acceleration down the slope of body 1 over 200 steps, after one more.
  real(wp) function acceleration(sim)
    type(simulation_t), intent(inout) :: sim
    real(wp) :: before

    call run(sim, 1)
    before = dot_product(sim%scene%bodies%velocity(1:2, 1), slope)
    call run(sim, 200)
    acceleration = (dot_product(sim%scene%bodies%velocity(1:2, 1), slope) - before)/(200*h)
  end function acceleration

  !> A flat block, wide enough not to topple.
  subroutine put_block(sim)
    type(simulation_t), intent(inout) :: sim
    real(wp) :: corners(2, 4)
    integer :: i

    corners = reshape([-1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 0.5_wp, -1.0_wp, 0.5_wp], [2, 4])
    do i = 1, 4
      corners(:, i) = corners(1, i)*slope + corners(2, i)*[-slope(2), slope(1)]
    end do
    call put_polygon(sim%scene, 1, corners)
  end subroutine put_block

  !> The block sticks iff friction >= tan a, and slides with g (sin a - friction cos a) else.
  subroutine test_block()
    real(wp), parameter :: shares(6) = [0.0_wp, 0.5_wp, 0.95_wp, 0.999_wp, 1.001_wp, 2.0_wp]
    type(simulation_t), pointer :: sim
    type(measures_t) :: measures
    real(wp) :: expected, place(2)
    integer :: i

    do i = 1, size(shares)
      sim => fresh()
      call begin_scene(sim%scene, 2, shares(i)*tan(angle), 0.01_wp)
      call put_block(sim)
      call put_slope(sim, 2)
      call begin_run(sim, h, 1e-12_wp)
      place = sim%scene%bodies%position(:, 1)
      expected = g*max(0.0_wp, sin(angle)*(1 - shares(i)))
      call t%near(acceleration(sim), expected, exactly*g, 'block: acceleration')
      call t%near(sim%scene%bodies%velocity(3, 1), 0.0_wp, exactly, 'block: does not turn')
      call t%near(maxval(abs(sim%scene%bodies%position(:, 1) - place - slope*expected*(201*h)**2/2)), 0.0_wp, exactly, &
                  'block: where it is')
      call measure(sim%scene, sim%contacts, h, sim%energy, measures)
      call t%near(measures%get('mobilised_friction'), min(shares(i), 1.0_wp)*tan(angle), exactly, 'block: mobilised friction')
      call t%near(measures%get('sliding_share'), merge(1.0_wp, 0.0_wp, shares(i) > 0 .and. shares(i) < 1), 0.0_wp, &
                  'block: share of sliding contacts')
    end do
  end subroutine test_block

  !> A disk rolls with 2/3 g sin a iff friction >= tan(a)/3, and slides with g (sin a - friction cos a) else.
  subroutine test_disk()
    real(wp), parameter :: shares(5) = [0.0_wp, 0.5_wp, 0.99_wp, 1.01_wp, 3.0_wp]
    type(simulation_t), pointer :: sim
    real(wp), parameter :: r = 0.3_wp
    real(wp) :: friction, spin, speed
    integer :: i

    do i = 1, size(shares)
      sim => fresh()
      friction = shares(i)*tan(angle)/3
      call begin_scene(sim%scene, 2, friction, 0.01_wp)
      call put_disk(sim%scene, 1, r, r*[-slope(2), slope(1)])
      call put_slope(sim, 2)
      call begin_run(sim, h, 1e-12_wp)
      call t%near(acceleration(sim), merge(2/3.0_wp*g*sin(angle), g*(sin(angle) - friction*cos(angle)), shares(i) > 1), &
                  exactly*g, 'disk: acceleration')
      if (.not. friction > 0) cycle
      spin = sim%scene%bodies%velocity(3, 1)
      speed = dot_product(sim%scene%bodies%velocity(1:2, 1), slope)
      if (shares(i) > 1) call t%near(r*spin, -speed, exactly, 'disk: rolls')
      ! The friction's moment turns it: angular acceleration 2 mu g cos a / r.
      if (shares(i) < 1) call t%near(spin, -2*friction*g*cos(angle)/r*201*h, exactly*g/r, 'disk: spins up while it slides')
    end do
  end subroutine test_disk

  !> Static friction above tan a, dynamic below: a block at rest that was set down stuck stays, a pushed one slides on.
  subroutine test_static_friction()
    type(simulation_t), pointer :: sim
    integer :: i
    real(wp) :: pull
    real(wp), parameter :: static = 0.8_wp, dynamic = 0.3_wp

    do i = 1, 2
      sim => fresh()
      call begin_scene(sim%scene, 2, 0.0_wp, 0.01_wp)
      sim%scene%laws(1)%static_friction = static
      sim%scene%laws(1)%dynamic_friction = dynamic
      call put_block(sim)
      call put_slope(sim, 2)
      pull = g*(sin(angle) - dynamic*cos(angle))
      if (i == 1) then
        ! Set down with friction enough that both corners stick; the dynamic one falls when they do.
        sim%scene%laws(1)%dynamic_friction = 5
        call begin_run(sim, h, 1e-12_wp)
        call run(sim, 2)
        sim%scene%laws(1)%dynamic_friction = dynamic
        call t%near(acceleration(sim), 0.0_wp, exactly*g, 'static friction: holds what sticks')
        call t%check(all(sim%contacts%status(:sim%contacts%n) == status_stick), 'static friction: sticking contacts')
      else
        sim%scene%bodies%velocity(1:2, 1) = 0.1_wp*slope
        call begin_run(sim, h, 1e-12_wp)
        call t%near(acceleration(sim), pull, exactly*g, 'dynamic friction: brakes what slides')
        call t%check(all(sim%contacts%status(:sim%contacts%n) == status_slide), 'dynamic friction: sliding contacts')
      end if
    end do
  end subroutine test_static_friction

  !> A V whose walls stand at `half_opening` from the vertical, a disk in it.
  subroutine make_v(sim, half_opening, friction)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: half_opening, friction
    integer :: side
    real(wp) :: outward(2)

    call begin_scene(sim%scene, 3, friction, 0.01_wp)
    call put_disk(sim%scene, 1, 0.5_wp, [0.0_wp, 1.0_wp])
    do side = 1, 2
      outward = real(2*side - 3, wp)*[cos(half_opening), 0.0_wp] + [0.0_wp, -sin(half_opening)]
      call put_wall(sim%scene, side + 1, 5.0_wp, 0.1_wp, [0.0_wp, 1.0_wp] + 0.6_wp*outward, &
                    pi/2 - real(2*side - 3, wp)*half_opening)
    end do
  end subroutine make_v

  !> Without friction each wall of the V carries m g/(2 sin b).
  subroutine test_v()
    real(wp), parameter :: openings(3) = [0.3_wp, 0.8_wp, 1.4_wp]
    type(simulation_t), pointer :: sim
    real(wp) :: weight
    integer :: i, side

    do i = 1, 3
      sim => fresh()
      call make_v(sim, openings(i), 0.0_wp)
      call begin_run(sim, h, 1e-13_wp)
      call run(sim, 20)
      weight = sim%scene%bodies%mass(1)*g
      do side = 1, 2
        call t%near(norm2(force_on(sim, side + 1))/weight, 1/(2*sin(openings(i))), 1e-10_wp/sin(openings(i))**2, 'V: wall force')
      end do
      call t%near(maxval(abs(sim%scene%bodies%position(:, 1) - [0.0_wp, 1.0_wp])), 0.0_wp, 1e-9_wp, 'V: the disk stays')
    end do
  end subroutine test_v

  !> With friction, also above tan b where the V locks, the disk stays and the walls together carry its weight.
  subroutine test_locked_v()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: opening = 0.3_wp
    integer :: i

    do i = 1, 2
      sim => fresh()
      call make_v(sim, opening, merge(1.5_wp, 0.5_wp, i == 1)*tan(opening))
      call begin_run(sim, h, 1e-10_wp)
      call run(sim, 20)
      call t%near(sim%scene%bodies%position(2, 1), 1.0_wp, 1e-8_wp, 'V with friction: the disk stays')
      call t%near(sum(force_on(sim, 1)), sim%scene%bodies%mass(1)*g, 1e-6_wp*sim%scene%bodies%mass(1)*g, &
                  'V with friction: it is carried')
    end do
  end subroutine test_locked_v
end program test_slopes
