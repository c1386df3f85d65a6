!> Bodies at rest or pressed in space: columns, pistons, stacks that do not creep, a box that tumbles and comes to rest; and
!! what the plan leaves out, which changes no motion.
program test_static_in_space
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, drive, g, run
  use scenes_space, only: begin_space_scene, force_in_space, put_box, put_capsule, put_dumbbell, put_plane, put_sphere
  use sg_drives, only: drive_t
  use sg_kinds, only: wp, pi
  use sg_laws, only: law_elastic
  use sg_random, only: random_t
  use sg_records, only: ball_frictional, ball_frictionless, solid_frictional, solid_frictionless
  use sg_rotations, only: frame_of, rotation_by
  use sg_simulation, only: simulation_t
  use sg_time_functions, only: time_function_t
  implicit none
  real(wp), parameter :: h = 1e-3_wp
  ! 10^-12 of the solver, over steps and sums.
  real(wp), parameter :: exactly = 1e-8_wp
  type(tests_t) :: t

  call test_column()
  call test_piston(0.0_wp)
  call test_piston(0.5_wp)
  call test_kinds()
  call test_same_motion(0.0_wp)
  call test_same_motion(0.4_wp)
  call test_creep()
  call test_tumble()
  call t%finish()

contains

  !> A column of frictionless spheres between four walls carries its weight, sphere by sphere, without drift.
  subroutine test_column()
    integer, parameter :: n = 10
    real(wp), parameter :: r = 0.1_wp
    type(simulation_t), pointer :: sim
    real(wp) :: weight
    integer :: b, k

    sim => fresh()
    call begin_space_scene(sim%scene, n + 1, 0.0_wp, 0.01_wp)
    do b = 1, n
      call put_sphere(sim%scene, b, r, [0.0_wp, 0.0_wp, (2*real(b, wp) - 1)*r])
    end do
    call put_plane(sim%scene, n + 1, [1.0_wp, 1.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    weight = sim%scene%bodies%mass(1)*g
    call begin_run(sim, h, 1e-13_wp)
    call run(sim, 200)
    do k = 1, sim%contacts%n
      ! The lower body of a contact is that of the smaller number, the floor before all.
      b = minval(modulo(sim%contacts%body(:, k), n + 1))
      call t%near(sim%contacts%impulse(1, k)/h, real(n - b, wp)*weight, exactly*weight, 'column: the weight above')
    end do
    call t%equal(sim%contacts%n, n, 'column: contacts')
    call t%near(maxval(abs(sim%scene%bodies%velocity)), 0.0_wp, exactly, 'column: at rest')
  end subroutine test_column

  !> A piston that only moves along z, pressed with a force, presses a layer of spheres between itself and the floor of a
  !! periodic cell: all of its force arrives there. How the spheres share it is not unique.
  subroutine test_piston(friction)
    real(wp), intent(in) :: friction
    integer, parameter :: n = 25
    real(wp), parameter :: force = 500, r = 0.1_wp
    type(simulation_t), pointer :: sim
    real(wp) :: floor(3), weight
    integer :: b, c

    sim => fresh()
    call begin_space_scene(sim%scene, n + 2, friction, 0.01_wp)
    sim%scene%period = 11*r
    sim%scene%period_y = 11*r
    do b = 1, n
      call put_sphere(sim%scene, b, r, r*[2.2_wp*real(modulo(b - 1, 5), wp) + 1.1_wp, 2.2_wp*real((b - 1)/5, wp) + 1.1_wp, 1.0_wp])
    end do
    call put_plane(sim%scene, n + 1, [5.0_wp, 5.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    ! It drops a millimetre first.
    call put_piston(sim, n + 2, [0.0_wp, 0.0_wp, 2*r + 0.1_wp + 1e-3_wp], -force)
    call begin_run(sim, h, 1e-12_wp)
    call run(sim, 100)
    c = merge(ball_frictional, ball_frictionless, friction > 0)
    call t%equal(sim%problem%kind, c, 'piston: arms are left out')
    if (friction > 0) then
      call t%near(sim%problem%body(8, sim%pairs%slot_of(n + 2)), -4.0_wp, 0.0_wp, 'piston: its record marks z as free')
    end if
    weight = g*(sum(sim%scene%bodies%mass(:n)) + sim%scene%bodies%mass(n + 2))
    floor = force_in_space(sim, n + 1)
    call t%near(floor(3), -force - weight, exactly*(force + weight), 'piston: its force arrives at the floor')
    call t%near(maxval(abs(sim%scene%bodies%velocity)), 0.0_wp, exactly, 'piston: at rest')
    call t%near(sim%scene%bodies%position(3, n + 2), 2*r + 0.1_wp, 1e-3_wp, 'piston: rests on the spheres')
    call t%near(maxval(abs(sim%scene%bodies%velocity([1, 2], n + 2))), 0.0_wp, 0.0_wp, 'piston: moves along z only')
  end subroutine test_piston

  !> A plane that faces down, free to move along z, with a force on it.
  subroutine put_piston(sim, body, place, force)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: body
    real(wp), intent(in) :: place(3), force
    integer :: i, n

    call put_plane(sim%scene, body, [5.0_wp, 5.0_wp, 0.1_wp], place, rotation_by([pi, 0.0_wp, 0.0_wp]))
    ! Take back the hold along z: the last of its drives but three.
    n = size(sim%scene%drives)
    do i = 1, n
      if (sim%scene%drives(i)%body == body .and. sim%scene%drives(i)%component == 3) exit
    end do
    sim%scene%drives(i) = drive_t(body=body, component=3, is_velocity=.false., value=time_function_t(constant=force))
    ! Light, so that it settles soon.
    sim%scene%bodies%mass(body) = 10
    sim%scene%bodies%inverse_mass(1:3, body) = 0.1_wp
  end subroutine put_piston

  !> The plan of each kind of scene: what it leaves out.
  subroutine test_kinds()
    type(simulation_t), pointer :: sim

    call begin_kind(sim, 0.0_wp)
    call check_kind(sim, 'spheres without friction', ball_frictionless, turns=.false.)
    call begin_kind(sim, 0.3_wp)
    call check_kind(sim, 'spheres with friction', ball_frictional, turns=.true.)
    call begin_kind(sim, 0.0_wp)
    sim%scene%bodies%velocity(5, 1) = 1
    call check_kind(sim, 'a spinning sphere without friction', ball_frictionless, turns=.true.)
    call begin_kind(sim, 0.0_wp)
    sim%scene%laws(1)%kind = law_elastic
    sim%scene%laws(1)%stiffness = 1e6_wp
    call check_kind(sim, 'an elastic law', solid_frictional, turns=.true.)
    call begin_kind(sim, 0.0_wp)
    call put_capsule(sim%scene, 3, 0.1_wp, 0.1_wp, [0.0_wp, 1.0_wp, 1.0_wp])
    call check_kind(sim, 'a capsule', solid_frictionless, turns=.true.)
    call begin_kind(sim, 0.3_wp)
    call put_dumbbell(sim%scene, 3, 0.1_wp, 0.1_wp, [0.0_wp, 1.0_wp, 1.0_wp])
    call check_kind(sim, 'a cluster', solid_frictional, turns=.true.)
    call begin_kind(sim, 0.3_wp)
    sim%scene%bodies%principal(2, 1) = 1.1_wp*sim%scene%bodies%principal(2, 1)
    call check_kind(sim, 'a sphere that is not the same all round', solid_frictional, turns=.true.)
    call begin_kind(sim, 0.3_wp)
    call drive(sim%scene, 1, 2, time_function_t())
    call check_kind(sim, 'a sphere held along y that turns', solid_frictional, turns=.true.)
    call begin_kind(sim, 0.3_wp)
    call put_box(sim%scene, 3, [0.1_wp, 0.1_wp, 0.1_wp], [0.0_wp, 1.0_wp, 1.0_wp])
    call check_kind(sim, 'a box', solid_frictional, turns=.true.)
    call begin_kind(sim, 0.3_wp)
    call put_box(sim%scene, 3, [0.1_wp, 0.1_wp, 0.1_wp], [0.0_wp, 1.0_wp, 1.0_wp])
    call hold_all(sim, 3)
    call check_kind(sim, 'a box that is held', ball_frictional, turns=.true.)
  end subroutine test_kinds

  !> A sphere on a plane, and room for a third body.
  subroutine begin_kind(sim, friction)
    type(simulation_t), pointer, intent(out) :: sim
    real(wp), intent(in) :: friction

    sim => fresh()
    call begin_space_scene(sim%scene, 3, friction, 0.01_wp)
    call put_sphere(sim%scene, 1, 0.2_wp, [0.0_wp, 0.0_wp, 0.2_wp])
    call put_plane(sim%scene, 2, [1.0_wp, 1.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    ! A body without shapes, unless it gets one, turns for nothing: it is given some mass.
    sim%scene%bodies%mass(3) = 1
    sim%scene%bodies%principal(:, 3) = 1
    sim%scene%bodies%inverse_mass(:, 3) = 1
  end subroutine begin_kind

  !> Hold all components of a body.
  subroutine hold_all(sim, body)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: body
    integer :: c

    do c = 1, 6
      call drive(sim%scene, body, c, time_function_t())
    end do
  end subroutine hold_all

  !> Check the kind of problem after a step, and whether bodies have spins at all.
  subroutine check_kind(sim, name, kind, turns)
    type(simulation_t), intent(inout) :: sim
    character(len=*), intent(in) :: name
    integer, intent(in) :: kind
    logical, intent(in) :: turns

    call begin_run(sim, h, 1e-12_wp)
    call run(sim, 20)
    call t%equal(sim%problem%kind, kind, name//': kind of problem')
    call t%equal(sim%scene%bodies%n_velocity, merge(6, 3, turns), name//': components')
    call t%check(allocated(sim%scene%bodies%orientation) .eqv. turns, name//': orientations')
  end subroutine check_kind

  !> Spheres that fall on a plane and on each other: the same motion with lever arms as without. A capsule far away, which
  !! touches nothing, makes the plan take them.
  subroutine test_same_motion(friction)
    real(wp), intent(in) :: friction
    type(simulation_t), pointer :: compact, whole
    integer :: met

    compact => fresh()
    whole => fresh()
    call make_spheres(compact, friction, .false.)
    call make_spheres(whole, friction, .true.)
    met = 0
    do while (compact%step < 400)
      call run(compact, 1)
      call run(whole, 1)
      met = met + compact%report%active_contacts
    end do
    call t%equal(compact%problem%kind, merge(ball_frictional, ball_frictionless, friction > 0), 'same motion: without arms')
    call t%equal(whole%problem%kind, merge(solid_frictional, solid_frictionless, friction > 0), 'same motion: with arms')
    call t%check(met > 50, 'same motion: contacts')
    call t%near(maxval(abs(compact%scene%bodies%position(:, :6) - whole%scene%bodies%position(:, :6))), 0.0_wp, 1e-7_wp, &
                'same motion: places')
    call t%near(maxval(abs(compact%scene%bodies%velocity(1:3, :6) - whole%scene%bodies%velocity(1:3, :6))), 0.0_wp, 1e-5_wp, &
                'same motion: velocities')
    if (.not. friction > 0) return
    call t%near(maxval(abs(compact%scene%bodies%velocity(4:6, :6) - whole%scene%bodies%velocity(4:6, :6))), 0.0_wp, 1e-4_wp, &
                'same motion: spins')
  end subroutine test_same_motion

  !> That scene.
  subroutine make_spheres(sim, friction, with_capsule)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: friction
    logical, intent(in) :: with_capsule
    type(random_t) :: random
    integer :: b, c

    call random%seed(32)
    call begin_space_scene(sim%scene, merge(8, 7, with_capsule), friction, 0.01_wp)
    do b = 1, 6
      call put_sphere(sim%scene, b, random%uniform(0.1_wp, 0.2_wp), [random%uniform(-0.2_wp, 0.2_wp), &
                                                                    random%uniform(-0.2_wp, 0.2_wp), 0.4_wp*real(b, wp)])
      do c = 1, 3
        sim%scene%bodies%velocity(c, b) = random%uniform(-1.0_wp, 1.0_wp)
        if (friction > 0) sim%scene%bodies%velocity(3 + c, b) = random%uniform(-5.0_wp, 5.0_wp)
      end do
    end do
    call put_plane(sim%scene, 7, [20.0_wp, 20.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    if (with_capsule) call put_capsule(sim%scene, 8, 0.2_wp, 0.1_wp, [15.0_wp, 0.0_wp, 30.0_wp])
    call begin_run(sim, h, 1e-13_wp)
  end subroutine make_spheres

  !> A stack of boxes, turned on each other, on a plane that leans: nothing creeps in 2000 steps.
  subroutine test_creep()
    integer, parameter :: n = 4
    type(simulation_t), pointer :: sim
    real(wp) :: place(3, n), turn(4, n)
    integer :: b

    sim => fresh()
    call begin_space_scene(sim%scene, n + 1, 0.6_wp, 0.005_wp)
    do b = 1, n
      call put_box(sim%scene, b, [0.2_wp, 0.25_wp, 0.1_wp], [0.0_wp, 0.0_wp, 0.2_wp*real(b, wp) - 0.1_wp], &
                   rotation_by([0.0_wp, 0.0_wp, 0.4_wp*real(b, wp)]))
    end do
    call put_plane(sim%scene, n + 1, [5.0_wp, 5.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    sim%scene%gravity = g*[0.1_wp, 0.05_wp, -1.0_wp]
    call begin_run(sim, h, 1e-6_wp)
    place = sim%scene%bodies%position(:, :n)
    turn = sim%scene%bodies%orientation(:, :n)
    call run(sim, 2000)
    ! The solver's tolerance leaves an acceleration of 10^-6 g: in 2 s, if it never changed its sign, 20 micrometres.
    call t%near(maxval(abs(sim%scene%bodies%position(:, :n) - place)), 0.0_wp, 2e-5_wp, 'stack: nothing creeps')
    call t%near(maxval(abs(sim%scene%bodies%orientation(:, :n) - turn)), 0.0_wp, 1e-4_wp, 'stack: nothing turns')
    call t%equal(sim%contacts%n, 4*n, 'stack: four points a joint')
  end subroutine test_creep

  !> A box thrown on the floor tumbles, and ends on one of its faces at rest.
  subroutine test_tumble()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: half(3) = [0.1_wp, 0.16_wp, 0.25_wp]
    real(wp) :: frame(3, 3), sorted(3), weight
    integer :: i

    do i = 1, 3
      sim => fresh()
      call begin_space_scene(sim%scene, 2, 0.5_wp, 0.01_wp)
      call put_box(sim%scene, 1, half, [0.0_wp, 0.0_wp, 0.8_wp], rotation_by(real(i, wp)*[0.3_wp, 0.7_wp, 0.2_wp]))
      call put_plane(sim%scene, 2, [50.0_wp, 50.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
      sim%scene%bodies%velocity(:, 1) = [2.0_wp, 1.0_wp, 0.0_wp, 3.0_wp, -6.0_wp, 2.0_wp]
      weight = sim%scene%bodies%mass(1)*g
      call begin_run(sim, h, 1e-10_wp)
      call run(sim, 4000)
      frame = frame_of(sim%scene%bodies%orientation(:, 1))
      sorted = abs(frame(3, :))
      call t%near(maxval(abs(sim%scene%bodies%velocity(:, 1))), 0.0_wp, 1e-6_wp, 'tumbling: at rest')
      ! A face that is not level by an angle would stand on a corner.
      call t%near(maxval(sorted), 1.0_wp, 1e-6_wp, 'tumbling: on a face')
      call t%check(any(abs(sim%scene%bodies%position(3, 1) - half) < 1e-3_wp), 'tumbling: at the height of a half side')
      call t%near(norm2(force_in_space(sim, 1) - [0.0_wp, 0.0_wp, weight]), 0.0_wp, 1e-5_wp*weight, 'tumbling: its weight')
    end do
  end subroutine test_tumble
end program test_static_in_space
