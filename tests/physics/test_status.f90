!> Static and dynamic friction, and bonds that break: what a contact did in a step, for each kind of problem, solver and direction.
!!
!! Scenes are turned, gravity too: an answer that depends on rounding differs from direction to direction.
program test_status
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, drive, put_disk, put_polygon, put_wall, run
  use scenes_space, only: begin_space_scene, put_box, put_plane, put_sphere
  use sg_kinds, only: wp, i1, pi
  use sg_laws, only: law_mohr, status_bonded, status_stick
  use sg_methods, only: solver_names
  use sg_random, only: random_t
  use sg_records, only: arm_frictional, ball_frictional, round_frictional, solid_frictional
  use sg_rotations, only: normalised, turned_by
  use sg_run_options, only: criterion_estimate
  use sg_simulation, only: simulation_t
  use sg_time_functions, only: time_function_t
  implicit none
  !> Kinds of problem that have tangents: a disk and a sphere that do not turn, boxes of the plane and of space
  integer, parameter :: kinds(4) = [round_frictional, arm_frictional, ball_frictional, solid_frictional]
  !> Static and dynamic friction, gravity [m/s2], time step [s]
  real(wp), parameter :: static = 0.6_wp, dynamic = 0.2_wp, gravity = 10, h = 1e-3_wp
  !> Of speeds about 1 m/s after 100 steps, the solver at 1e-10
  real(wp), parameter :: same = 1e-6_wp
  type(tests_t) :: t
  type(random_t) :: random
  !> Axes of the scene being made: first tangent and normal of the floor
  real(wp) :: along(3), up(3)
  !> Points of contact of the body with the floor
  integer :: n_points

  call random%seed(14)
  call test_braking()
  call test_default_tolerance()
  call test_slopes()
  call test_rest_after_sliding()
  call test_pulls()
  call test_shear()
  call test_moving_bond()
  call t%finish()

contains

  !> A body on a floor, in axes turned at random, or by quarters.
  subroutine make(sim, kind, turns, quarter)
    type(simulation_t), pointer, intent(out) :: sim !! body 1 on body 2; no velocity, no gravity, no friction
    integer, intent(in) :: kind !! kind of problem that it makes
    logical, intent(in) :: turns !! may the body turn?
    integer, intent(in), optional :: quarter !! turns by this many quarters about the last axis
    real(wp) :: q(4), angle, corners(2, 4)
    integer :: i, n

    sim => fresh()
    n_points = sum(merge([1, 2, 1, 4], 0, kinds == kind))
    if (kind < ball_frictional) then
      angle = random%uniform(-pi, pi)
      if (present(quarter)) angle = 0.5_wp*pi*real(quarter, wp)
      along = [cos(angle), sin(angle), 0.0_wp]
      up = [-sin(angle), cos(angle), 0.0_wp]
      call begin_scene(sim%scene, 2, 0.0_wp, 0.01_wp)
      if (kind == round_frictional) call put_disk(sim%scene, 1, 0.25_wp, 0.25_wp*up(:2))
      corners = reshape([-1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 0.5_wp, -1.0_wp, 0.5_wp], [2, 4])
      do i = 1, 4
        corners(:, i) = corners(1, i)*along(:2) + corners(2, i)*up(:2)
      end do
      if (kind == arm_frictional) call put_polygon(sim%scene, 1, corners)
      call put_wall(sim%scene, 2, 20.0_wp, 0.1_wp, -0.1_wp*up(:2), angle)
    else
      q = normalised([(random%normal(), i=1, 4)])
      angle = random%uniform(-pi, pi)
      if (present(quarter)) q = normalised([1.0_wp, real(merge(1, 0, quarter > 1), wp), 0.0_wp, real(modulo(quarter, 2), wp)])
      along = turned_by(q, [cos(angle), sin(angle), 0.0_wp])
      up = turned_by(q, [0.0_wp, 0.0_wp, 1.0_wp])
      call begin_space_scene(sim%scene, 2, 0.0_wp, 0.01_wp)
      if (kind == ball_frictional) call put_sphere(sim%scene, 1, 0.25_wp, 0.25_wp*up)
      if (kind == solid_frictional) call put_box(sim%scene, 1, [0.5_wp, 0.6_wp, 0.1_wp], 0.1_wp*up, q)
      call put_plane(sim%scene, 2, [20.0_wp, 20.0_wp, 0.1_wp], -0.1_wp*up, q)
    end if
    sim%scene%gravity = 0
    n = sim%scene%dimension
    do i = n + 1, merge(n, sim%scene%bodies%n_velocity, turns)
      call drive(sim%scene, 1, i, time_function_t())
    end do
  end subroutine make

  !> Give a scene gravity that leans, static and dynamic friction, and a body that slides.
  subroutine set_sliding(sim, lean, speed)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: lean, speed
    integer :: n

    n = sim%scene%dimension
    sim%scene%gravity = gravity*(sin(lean)*along - cos(lean)*up)
    sim%scene%laws(1)%static_friction = static
    sim%scene%laws(1)%dynamic_friction = dynamic
    sim%scene%bodies%velocity(:n, 1) = speed*along(:n)
  end subroutine set_sliding

  !> Speed of body 1 along the floor [m/s].
  real(wp) function speed_of(sim)
    type(simulation_t), intent(in) :: sim
    integer :: n

    n = sim%scene%dimension
    speed_of = dot_product(sim%scene%bodies%velocity(:n, 1), along(:n))
  end function speed_of

  !> Is the body of a kind of problem a box, which needs lever arms as long as it may turn?
  pure logical function is_box(kind)
    integer, intent(in) :: kind

    is_box = kind == arm_frictional .or. kind == solid_frictional
  end function is_box

  !> Have all contacts a status?
  pure logical function all_are(sim, status)
    type(simulation_t), intent(in) :: sim
    integer(i1), intent(in) :: status

    all_are = sim%contacts%n > 0 .and. all(sim%contacts%status(:sim%contacts%n) == status)
  end function all_are

  !> A body at 1 m/s is braked by the dynamic coefficient in each of 100 steps: 0.8 m/s are left.
  subroutine test_braking()
    type(simulation_t), pointer :: sim
    character(len=16), allocatable :: methods(:)
    integer :: i, method, direction

    methods = solver_names()
    do i = 1, size(kinds)
      do method = 1, size(methods)
        do direction = 1, 5
          call make(sim, kinds(i), turns=is_box(kinds(i)))
          call set_sliding(sim, 0.0_wp, 1.0_wp)
          sim%options%solver%method = methods(method)
          call begin_run(sim, h, 1e-10_wp, maximum_sweeps=5000)
          call run(sim, 100)
          call t%equal(sim%problem%kind, kinds(i), 'braking: kind of problem')
          call t%near(speed_of(sim), 0.8_wp, same, 'braking: '//trim(methods(method)))
          ! Of the corners of a box one may carry nothing.
          call t%check(.not. any(sim%contacts%status(:sim%contacts%n) == status_stick), 'braking: nothing sticks')
        end do
      end do
    end do
  end subroutine test_braking

  !> The same at the tolerance that decks have unless they choose one.
  subroutine test_default_tolerance()
    type(simulation_t), pointer :: sim, options
    integer :: i, direction

    options => fresh()
    do i = 1, size(kinds)
      do direction = 1, 5
        call make(sim, kinds(i), turns=.false.)
        call set_sliding(sim, 0.0_wp, 1.0_wp)
        call begin_run(sim, h, options%options%solver%tolerance)
        sim%options%solver%criterion = criterion_estimate
        call run(sim, 100)
        call t%near(speed_of(sim), 0.8_wp, 1e-3_wp, 'braking: default tolerance')
      end do
    end do
  end subroutine test_default_tolerance

  !> Thirty slopes: bodies that are free to turn are braked by the dynamic coefficient too. Spheres slide until they roll, which
  !! takes 0.14 s on the level.
  subroutine test_slopes()
    type(simulation_t), pointer :: sim
    real(wp) :: lean, expected
    integer :: i, slope

    do i = 1, size(kinds)
      do slope = 1, 30
        call make(sim, kinds(i), turns=.true.)
        lean = random%uniform(-0.2_wp, 0.1_wp)
        call set_sliding(sim, lean, 1.5_wp)
        call begin_run(sim, h, 1e-10_wp, maximum_sweeps=5000)
        call run(sim, 50)
        expected = 1.5_wp - gravity*(dynamic*cos(lean) - sin(lean))*50*h
        call t%near(speed_of(sim), expected, same, 'slopes: speed')
      end do
    end do
  end subroutine test_slopes

  !> What has come to rest sticks: on a slope between both coefficients a body slides down for ever unless it stuck before.
  subroutine test_rest_after_sliding()
    real(wp), parameter :: lean = 0.4_wp
    type(simulation_t), pointer :: sim
    real(wp) :: before
    integer :: i

    do i = 1, size(kinds)
      call make(sim, kinds(i), turns=.false.)
      call set_sliding(sim, 0.0_wp, 0.01_wp)
      call begin_run(sim, h, 1e-10_wp, maximum_sweeps=5000)
      call run(sim, 20)
      call t%near(speed_of(sim), 0.0_wp, same, 'rest: braked')
      call t%check(any(sim%contacts%status(:sim%contacts%n) == status_stick), 'rest: contacts stick')
      sim%scene%gravity = gravity*(sin(lean)*along - cos(lean)*up)
      call run(sim, 50)
      call t%near(speed_of(sim), 0.0_wp, same, 'rest: held by static friction')
      ! A push: from then on it slides.
      associate (velocity => sim%scene%bodies%velocity(:, 1))
        velocity(:sim%scene%dimension) = 0.1_wp*along(:sim%scene%dimension)
      end associate
      call run(sim, 1)
      before = speed_of(sim)
      call run(sim, 50)
      call t%near(speed_of(sim) - before, 50*h*gravity*(sin(lean) - dynamic*cos(lean)), same, 'rest: slides once pushed')
    end do
  end subroutine test_rest_after_sliding

  !> Bond a body to the floor; each contact holds 500 N. Gravity is the pull, as a share of what all contacts hold together.
  subroutine set_bond(sim, friction, share, direction)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: friction, share, direction(3)

    sim%scene%laws(1)%kind = law_mohr
    sim%scene%laws(1)%normal_cohesion = 500
    sim%scene%laws(1)%static_friction = friction
    sim%scene%laws(1)%dynamic_friction = friction
    sim%scene%gravity = direction*share*500*real(n_points, wp)/sim%scene%bodies%mass(1)
    call begin_run(sim, h, 1e-10_wp, maximum_sweeps=5000)
  end subroutine set_bond

  !> A bond holds below its limit, with and without friction, and opens above it; of a body that can move along the normal
  !! alone too.
  subroutine test_pulls()
    real(wp), parameter :: shares(5) = [0.0_wp, 0.2_wp, 0.999_wp, 1.001_wp, 3.0_wp], frictions(2) = [0.0_wp, 0.5_wp]
    type(simulation_t), pointer :: sim
    integer :: i, j, k, freedom, c

    do i = 1, size(kinds)
      do j = 1, size(shares)
        do k = 1, size(frictions)
          do freedom = 1, 3
            call make(sim, kinds(i), turns=freedom == 1, quarter=modulo(j + k, 4))
            do c = 1, merge(sim%scene%dimension, 0, freedom == 3)
              if (abs(up(c)) < 0.5_wp) call drive(sim%scene, 1, c, time_function_t())
            end do
            call set_bond(sim, frictions(k), shares(j), up)
            ! A bond above its limit stretches by 1e-8 of the body first.
            call run(sim, 100)
            call check_bond(sim, shares(j) < 1, 'pull')
          end do
        end do
      end do
    end do
  end subroutine test_pulls

  !> Shear: the limit is friction times cohesion; without friction there is none.
  subroutine test_shear()
    real(wp), parameter :: shares(3) = [0.3_wp, 0.499_wp, 0.501_wp]
    type(simulation_t), pointer :: sim
    integer :: i, j

    do i = 1, size(kinds)
      do j = 1, size(shares)
        call make(sim, kinds(i), turns=.false.)
        call set_bond(sim, 0.5_wp, shares(j), along)
        call run(sim, 30)
        call check_bond(sim, shares(j) < 0.5_wp, 'shear')
      end do
      call make(sim, kinds(i), turns=.false.)
      call set_bond(sim, 0.0_wp, 0.01_wp, along)
      call run(sim, 30)
      call check_bond(sim, .false., 'shear without friction')
    end do
  end subroutine test_shear

  !> A bond to a body that is driven along the floor slips and breaks; one that is carried along by the floor holds.
  subroutine test_moving_bond()
    type(simulation_t), pointer :: sim
    integer :: i, body, c, n

    do i = 1, size(kinds)
      do body = 1, 2
        call make(sim, kinds(i), turns=.false.)
        n = sim%scene%dimension
        if (body == 1) then
          do c = 1, n
            call drive(sim%scene, 1, c, time_function_t(constant=0.1_wp*along(c)))
          end do
        else
          sim%scene%bodies%velocity(:n, 1) = 0.1_wp*along(:n)
          do c = 1, size(sim%scene%drives)
            associate (one => sim%scene%drives(c))
              if (one%body == 2 .and. one%component <= n) one%value = time_function_t(constant=0.1_wp*along(one%component))
            end associate
          end do
        end if
        call set_bond(sim, 0.5_wp, merge(0.0_wp, 0.5_wp, body == 1), up)
        call run(sim, 10)
        call t%check(all_are(sim, status_bonded) .eqv. body == 2, 'moving bond')
      end do
    end do
  end subroutine test_moving_bond

  !> Does a body still stand on its bonds, or has it left them?
  subroutine check_bond(sim, holds, name)
    type(simulation_t), intent(in) :: sim
    logical, intent(in) :: holds
    character(len=*), intent(in) :: name
    real(wp) :: speed

    speed = norm2(sim%scene%bodies%velocity(:sim%scene%dimension, 1))
    if (holds) then
      call t%near(speed, 0.0_wp, same, name//': holds')
      call t%check(all_are(sim, status_bonded), name//': bonded')
    else
      call t%check(speed > same, name//': gives way')
      call t%check(.not. any(sim%contacts%status(:sim%contacts%n) == status_bonded), name//': broken')
    end if
  end subroutine check_bond
end program test_status
