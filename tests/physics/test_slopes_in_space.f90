!> Spheres and blocks on inclines in space: rolling, sliding, sticking, tipping, and a stack on its corners.
!!
!! The plane is level and gravity leans, in any direction: what happens must not depend on it. A constant acceleration
!! makes the theta scheme exact: velocities grow by a h each step. What is left is the first step, and rounding through
!! the solver's tolerance.
program test_slopes_in_space
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, g, run
  use scenes_space, only: begin_space_scene, force_in_space, put_box, put_plane, put_sphere
  use sg_kinds, only: wp, pi
  use sg_rotations, only: rotation_by, turned_by
  use sg_simulation, only: simulation_t
  implicit none
  real(wp), parameter :: h = 1e-3_wp, angle = 0.5_wp
  ! Of the acceleration g: 10^-12 of the solver, over steps and sums.
  real(wp), parameter :: exactly = 1e-8_wp
  type(tests_t) :: t

  call test_sphere()
  call test_block()
  call test_tipping()
  call test_stack()
  call t%finish()

contains

  !> Lean gravity by the angle towards a direction; unit vector down the slope.
  function lean(sim, direction, by) result(slope)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: direction, by
    real(wp) :: slope(3)

    slope = [cos(direction), sin(direction), 0.0_wp]
    sim%scene%gravity = g*(sin(by)*slope - [0.0_wp, 0.0_wp, cos(by)])
  end function lean

  !> Mean acceleration of body 1 over 200 steps, after one more.
  function acceleration(sim) result(mean)
    type(simulation_t), intent(inout) :: sim
    real(wp) :: mean(3)

    call run(sim, 1)
    mean = -sim%scene%bodies%velocity(1:3, 1)
    call run(sim, 200)
    mean = (mean + sim%scene%bodies%velocity(1:3, 1))/(200*h)
  end function acceleration

  !> A sphere rolls with 5/7 g sin a iff friction >= 2/7 tan a, and slides with g (sin a - friction cos a) else.
  subroutine test_sphere()
    real(wp), parameter :: shares(5) = [0.0_wp, 0.5_wp, 0.999_wp, 1.001_wp, 3.0_wp], directions(3) = [0.0_wp, 1.1_wp, 4.0_wp]
    type(simulation_t), pointer :: sim
    real(wp) :: slope(3), expected, friction, spin(3)
    integer :: i, j

    do j = 1, size(directions)
      do i = 1, size(shares)
        sim => fresh()
        friction = shares(i)*2/7*tan(angle)
        call begin_space_scene(sim%scene, 2, friction, 0.01_wp)
        slope = lean(sim, directions(j), angle)
        call put_sphere(sim%scene, 1, 0.2_wp, [0.0_wp, 0.0_wp, 0.2_wp])
        call put_plane(sim%scene, 2, [20.0_wp, 20.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
        call begin_run(sim, h, 1e-12_wp)
        call check_round(sim, friction)
        expected = g*merge(5*sin(angle)/7, sin(angle) - friction*cos(angle), shares(i) > 1)
        call t%near(maxval(abs(acceleration(sim) - expected*slope)), 0.0_wp, exactly*g, 'sphere: acceleration')
        if (friction > 0) then
          spin = turned_by(sim%scene%bodies%orientation(:, 1), sim%scene%bodies%velocity(4:6, 1))
          call t%near(dot_product(spin, slope), 0.0_wp, exactly, 'sphere: its axis lies across the slope')
          if (shares(i) > 1) call t%near(0.2_wp*norm2(spin), norm2(sim%scene%bodies%velocity(1:3, 1)), exactly, 'sphere: rolls')
        end if
      end do
    end do
  end subroutine test_sphere

  !> A sphere among planes needs no lever arms, and no rotation where nothing rubs.
  subroutine check_round(sim, friction)
    type(simulation_t), intent(in) :: sim
    real(wp), intent(in) :: friction

    call t%check(sim%plan%is_round, 'sphere: the plan leaves lever arms out')
    call t%check(sim%plan%has_rotation .eqv. friction > 0, 'sphere: the plan leaves rotation out where nothing rubs')
  end subroutine check_round

  !> A flat block sticks iff friction >= tan a, and slides with g (sin a - friction cos a) else; it does not turn.
  subroutine test_block()
    real(wp), parameter :: shares(5) = [0.0_wp, 0.5_wp, 0.999_wp, 1.001_wp, 2.0_wp], directions(3) = [0.0_wp, 0.7_wp, 2.5_wp]
    type(simulation_t), pointer :: sim
    real(wp) :: slope(3), expected
    integer :: i, j

    do j = 1, size(directions)
      do i = 1, size(shares)
        sim => fresh()
        call begin_space_scene(sim%scene, 2, shares(i)*tan(angle), 0.01_wp)
        slope = lean(sim, directions(j), angle)
        call put_box(sim%scene, 1, [0.5_wp, 0.6_wp, 0.1_wp], [0.0_wp, 0.0_wp, 0.1_wp])
        call put_plane(sim%scene, 2, [20.0_wp, 20.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
        call begin_run(sim, h, 1e-12_wp)
        expected = g*max(0.0_wp, sin(angle)*(1 - shares(i)))
        call t%near(maxval(abs(acceleration(sim) - expected*slope)), 0.0_wp, exactly*g, 'block: acceleration')
        call t%near(maxval(abs(sim%scene%bodies%velocity(4:6, 1))), 0.0_wp, exactly, 'block: does not turn')
        call t%equal(sim%contacts%n, 4, 'block: stands on four points')
      end do
    end do
  end subroutine test_block

  !> A tall box that cannot slide tips iff tan a exceeds width over height; one that slips slides without tipping.
  subroutine test_tipping()
    type(simulation_t), pointer :: sim
    real(wp) :: slope(3), limit
    integer :: i
    real(wp), parameter :: shares(2) = [0.99_wp, 1.01_wp]

    limit = atan(0.4_wp)
    do i = 1, 2
      sim => fresh()
      call begin_space_scene(sim%scene, 2, 1.0_wp, 0.01_wp)
      slope = lean(sim, 0.0_wp, shares(i)*limit)
      call put_box(sim%scene, 1, [0.2_wp, 0.3_wp, 0.5_wp], [0.0_wp, 0.0_wp, 0.5_wp])
      call put_plane(sim%scene, 2, [20.0_wp, 20.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
      call begin_run(sim, h, 1e-12_wp)
      call run(sim, 300)
      if (shares(i) < 1) then
        call t%near(maxval(abs(sim%scene%bodies%velocity(:, 1))), 0.0_wp, exactly, 'box: stands')
      else
        call t%check(sim%scene%bodies%velocity(1, 1) > 1e-3_wp, 'box: tips')
        call t%near(sum(slope*sim%scene%bodies%velocity(1:3, 1)), sim%scene%bodies%velocity(1, 1), exactly, 'box: down the slope')
      end if
    end do
    ! The same box on a slope that tips it, but too slippery: it slides on its whole face.
    sim => fresh()
    call begin_space_scene(sim%scene, 2, 0.2_wp, 0.01_wp)
    slope = lean(sim, 0.0_wp, 1.01_wp*limit)
    call put_box(sim%scene, 1, [0.2_wp, 0.3_wp, 0.5_wp], [0.0_wp, 0.0_wp, 0.5_wp])
    call put_plane(sim%scene, 2, [20.0_wp, 20.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    call begin_run(sim, h, 1e-12_wp)
    call t%near(maxval(abs(acceleration(sim) - g*(sin(1.01_wp*limit) - 0.2_wp*cos(1.01_wp*limit))*slope)), 0.0_wp, exactly*g, &
                'box: slides rather than tips')
    call t%near(maxval(abs(sim%scene%bodies%velocity(4:6, 1))), 0.0_wp, exactly, 'box: does not tip where it slides')
  end subroutine test_tipping

  !> A stack of cubes, one of them turned about the vertical, carries its weight on four corners each.
  subroutine test_stack()
    type(simulation_t), pointer :: sim
    integer, parameter :: n = 4
    real(wp) :: weight, force(3)
    integer :: i, k

    sim => fresh()
    call begin_space_scene(sim%scene, n + 1, 0.5_wp, 0.01_wp)
    do i = 1, n
      call put_box(sim%scene, i, [0.1_wp, 0.1_wp, 0.1_wp], [0.0_wp, 0.0_wp, 0.2_wp*real(i, wp) - 0.1_wp], &
                   rotation_by([0.0_wp, 0.0_wp, merge(pi/6, 0.0_wp, i == 3)]))
    end do
    call put_plane(sim%scene, n + 1, [1.0_wp, 1.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    call begin_run(sim, h, 1e-12_wp)
    call run(sim, 100)
    weight = sim%scene%bodies%mass(1)*g
    call t%equal(sim%contacts%n, 4*n, 'stack: four points a face')
    do i = 1, n
      force = force_in_space(sim, i)
      call t%near(maxval(abs(force - [0.0_wp, 0.0_wp, weight])), 0.0_wp, exactly*weight, 'stack: each cube is carried')
    end do
    force = 0
    do k = 1, sim%contacts%n
      if (sim%contacts%body(2, k) /= n + 1) cycle
      force = force + sim%contacts%impulse(3, k)/h*[1.0_wp, sim%contacts%point(1:2, k)]
      call t%check(sim%contacts%impulse(3, k) > 0, 'stack: every corner carries')
    end do
    call t%near(force(1), n*weight, exactly*weight, 'stack: the floor carries the weight')
    ! How the four corners share it is not unique, but they balance: any two on one side carry half of it.
    call t%near(maxval(abs(force(2:3))), 0.0_wp, exactly*weight, 'stack: evenly on both sides')
    call t%near(maxval(abs(sim%scene%bodies%velocity)), 0.0_wp, exactly, 'stack: at rest')
  end subroutine test_stack
end program test_slopes_in_space
