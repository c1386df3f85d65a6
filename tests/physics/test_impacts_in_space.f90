!> Impacts in space: a bouncing sphere, Newton's cradle, clouds of polyhedra that collide freely.
program test_impacts_in_space
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use polyhedra, only: prism_polyhedron
  use scenes, only: begin_run, g, run
  use scenes_space, only: begin_space_scene, put_box, put_plane, put_shape, put_sphere, turn_at_random
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_laws, only: law_iqs, law_restitution
  use sg_polyhedron, only: polyhedron_t
  use sg_random, only: random_t
  use sg_rotations, only: turned_by
  use sg_simulation, only: simulation_t
  use sg_vectors, only: cross
  implicit none
  type(tests_t) :: t

  call test_bounces()
  call test_cradle()
  call test_oblique()
  call test_cloud(law_iqs, 0.3_wp, 'inelastic polyhedra')
  call test_cloud(law_restitution, 0.3_wp, 'bouncing polyhedra')
  call test_cloud(law_restitution, 0.0_wp, 'bouncing polyhedra without friction')
  call t%finish()

contains

  !> Each bounce is e times as fast as the last: heights fall by e^2, flights last e times as long.
  subroutine test_bounces()
    real(wp), parameter :: h = 1e-4_wp, drop = 1, radius = 0.1_wp, shares(3) = [0.5_wp, 0.9_wp, 1.0_wp]
    type(simulation_t), pointer :: sim
    real(wp) :: peak(3), before, time(4)
    integer :: i, bounces

    do i = 1, size(shares)
      sim => fresh()
      call begin_space_scene(sim%scene, 2, 0.0_wp, 0.05_wp)
      call put_sphere(sim%scene, 1, radius, [0.0_wp, 0.0_wp, radius + drop])
      call put_plane(sim%scene, 2, [5.0_wp, 5.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
      sim%scene%laws(1)%kind = law_restitution
      sim%scene%laws(1)%normal_restitution = shares(i)
      call begin_run(sim, h, 1e-12_wp)
      bounces = 0
      peak = 0
      time = 0
      do while (bounces < 4 .and. sim%step < 100000)
        before = sim%scene%bodies%velocity(3, 1)
        call run(sim, 1)
        if (before < 0 .and. sim%scene%bodies%velocity(3, 1) > 0) then
          bounces = bounces + 1
          time(bounces) = sim%time()
        end if
        if (bounces > 0 .and. bounces < 4) peak(bounces) = max(peak(bounces), sim%scene%bodies%position(3, 1) - radius)
      end do
      ! Each impact is placed to a step: of the flight, h sqrt(2 g/H) = 4e-4 at first, over e^3 = 1/8 at the third.
      call t%near(time(1), sqrt(2*drop/g), 2*h, 'bounces: first impact')
      call t%near(peak(1), shares(i)**2*drop, 2e-3_wp*drop, 'bounces: first height')
      call t%near(peak(2), shares(i)**4*drop, 4e-3_wp*drop, 'bounces: second height')
      call t%near(peak(3), shares(i)**6*drop, 6e-3_wp*drop, 'bounces: third height')
      call t%near((time(3) - time(2))/(time(2) - time(1)), shares(i), 5e-3_wp, 'bounces: flights')
    end do
  end subroutine test_bounces

  !> Three spheres in line, in any direction, two of them touching: Newton's law for all contacts at once has the first fly
  !! back with a third of its speed, and the others go on together with two thirds.
  subroutine test_cradle()
    real(wp), parameter :: h = 1e-3_wp, radius = 0.1_wp
    type(simulation_t), pointer :: sim
    type(random_t) :: random
    real(wp) :: line(3), got(3)
    integer :: i, b, c

    call random%seed(21)
    do i = 1, 5
      do c = 1, 3
        line(c) = random%normal()
      end do
      line = line/norm2(line)
      sim => fresh()
      call begin_space_scene(sim%scene, 3, 0.0_wp, 0.01_wp)
      sim%scene%gravity = 0
      do b = 1, 3
        call put_sphere(sim%scene, b, radius, (2*radius - 1e-9_wp)*real(b, wp)*line)
      end do
      sim%scene%bodies%velocity(1:3, 1) = line
      sim%scene%laws(1)%kind = law_restitution
      sim%scene%laws(1)%normal_restitution = 1
      call begin_run(sim, h, 1e-14_wp)
      call run(sim, 1)
      got = matmul(line, sim%scene%bodies%velocity(1:3, :))
      call t%near(maxval(abs(got - [-1.0_wp, 2.0_wp, 2.0_wp]/3)), 0.0_wp, 1e-11_wp, 'cradle: (-1, 2, 2)/3')
      do b = 1, 3
        call t%near(norm2(sim%scene%bodies%velocity(1:3, b) - got(b)*line), 0.0_wp, 1e-11_wp, 'cradle: in line')
      end do
    end do
  end subroutine test_cradle

  !> A sphere meets another off its line of centres, with friction: the impulse lies in the cone, turns both the same way,
  !! and keeps linear and angular momentum.
  subroutine test_oblique()
    real(wp), parameter :: radius = 0.1_wp
    type(simulation_t), pointer :: sim
    real(wp) :: momentum(6), after(6), p(3), n(3), limit

    sim => fresh()
    call begin_space_scene(sim%scene, 2, 0.05_wp, 0.01_wp)
    sim%scene%gravity = 0
    call put_sphere(sim%scene, 1, radius, [-0.12_wp, 0.05_wp, 0.15_wp])
    call put_sphere(sim%scene, 2, radius, [0.0_wp, 0.0_wp, 0.0_wp])
    sim%scene%bodies%velocity(1:3, 1) = [2.0_wp, 0.3_wp, -2.0_wp]
    sim%scene%laws(1)%kind = law_restitution
    sim%scene%laws(1)%normal_restitution = 0.4_wp
    call begin_run(sim, 1e-3_wp, 1e-14_wp)
    momentum = all_momentum(sim)
    do while (norm2(sim%scene%bodies%velocity(:, 2)) <= 0 .and. sim%step < 200)
      call run(sim, 1)
    end do
    after = all_momentum(sim)
    call t%check(sim%step < 200, 'oblique impact: they meet')
    call t%near(norm2(after(1:3) - momentum(1:3)), 0.0_wp, 1e-13_wp*norm2(momentum), 'oblique impact: momentum')
    p = sim%contacts%impulse(:, 1)
    n = sim%contacts%normal(:, 1)
    limit = 0.05_wp*dot_product(p, n)
    ! 2/7 of the slip stops it: here it goes on slipping, at the edge of the cone.
    call t%near(norm2(p - dot_product(p, n)*n), limit, 1e-12_wp*limit, 'oblique impact: slips')
    call t%near(norm2(sim%scene%bodies%velocity(4:6, 1) - sim%scene%bodies%velocity(4:6, 2)), 0.0_wp, &
                1e-10_wp*norm2(sim%scene%bodies%velocity(4:6, 1)), 'oblique impact: both turn the same way')
    ! Spins change at the surfaces, a gap apart: of the orbit's momentum, less than the way of a step, 3 mm, over the radius.
    call t%near(norm2(after(4:6) - momentum(4:6)), 0.0_wp, 0.03_wp*norm2(momentum(4:6)), 'oblique impact: angular momentum')
  end subroutine test_oblique

  !> Linear momentum, and angular momentum about the origin.
  function all_momentum(sim) result(total)
    type(simulation_t), intent(in) :: sim
    real(wp) :: total(6)
    integer :: b

    total = 0
    associate (bodies => sim%scene%bodies)
      do b = 1, bodies%n
        total(1:3) = total(1:3) + bodies%mass(b)*bodies%velocity(1:3, b)
        total(4:6) = total(4:6) + bodies%mass(b)*cross(bodies%position(:, b), bodies%velocity(1:3, b))
        if (bodies%n_velocity < 6) cycle
        total(4:6) = total(4:6) + turned_by(bodies%orientation(:, b), bodies%principal(:, b)*bodies%velocity(4:6, b))
      end do
    end associate
  end function all_momentum

  !> Kinetic energy [J].
  real(wp) function energy(sim)
    type(simulation_t), intent(in) :: sim

    associate (bodies => sim%scene%bodies)
      energy = sum(bodies%mass*sum(bodies%velocity(1:3, :)**2, 1))/2 + sum(bodies%principal*bodies%velocity(4:6, :)**2)/2
    end associate
  end function energy

  !> A cloud of polyhedra falls together: its momentum stays, its energy only falls.
  subroutine test_cloud(law, friction, name)
    integer, intent(in) :: law
    real(wp), intent(in) :: friction
    character(len=*), intent(in) :: name
    real(wp) :: drift(2)
    integer :: i

    do i = 1, 2
      call run_cloud(law, friction, merge(2e-3_wp, 1e-3_wp, i == 1), name, drift(i))
    end do
    ! The frame of a body turns by h w between its velocity and that after the contact: h w, 2e-3, of what the spin changes,
    ! which is some tenth of the whole.
    call t%near(drift(1), 0.0_wp, 4e-4_wp, name//': angular momentum')
    call t%near(drift(2), 0.0_wp, 2e-4_wp, name//': angular momentum at half the step')
  end subroutine test_cloud

  !> The same with one step; drift of the angular momentum over that of all bodies.
  subroutine run_cloud(law, friction, h, name, drift)
    integer, intent(in) :: law
    real(wp), intent(in) :: friction, h
    character(len=*), intent(in) :: name
    real(wp), intent(out) :: drift
    integer, parameter :: side = 3, n = side**3
    type(simulation_t), pointer :: sim
    type(random_t) :: random
    real(wp) :: momentum(6), start, last, now, gain, scale(2)
    integer :: b, c, met

    sim => fresh()
    call random%seed(22)
    call begin_space_scene(sim%scene, n, friction, 0.01_wp)
    sim%scene%gravity = 0
    do b = 1, n
      call put_any(sim, b, 1.2_wp*real([modulo(b - 1, side) - 1, modulo((b - 1)/side, side) - 1, (b - 1)/side**2 - 1], wp))
      call turn_at_random(sim%scene, b, random)
      do c = 1, 6
        sim%scene%bodies%velocity(c, b) = random%uniform(-1.0_wp, 1.0_wp)
      end do
      sim%scene%bodies%velocity(1:3, b) = sim%scene%bodies%velocity(1:3, b) - 2*sim%scene%bodies%position(:, b)
    end do
    sim%scene%laws(1)%kind = law
    sim%scene%laws(1)%normal_restitution = 0.6_wp
    call begin_run(sim, h, 1e-10_wp)
    momentum = all_momentum(sim)
    start = energy(sim)
    scale(1) = sum(sim%scene%bodies%mass*norm2(sim%scene%bodies%velocity(1:3, :), 1))
    scale(2) = sum(sim%scene%bodies%mass*norm2(sim%scene%bodies%velocity(1:3, :), 1)*norm2(sim%scene%bodies%position, 1))
    last = start
    gain = 0
    met = 0
    do while (sim%time() < 0.6_wp)
      call run(sim, 1)
      now = energy(sim)
      gain = max(gain, now - last)
      last = now
      met = met + sim%report%active_contacts
    end do
    call t%check(met > 10, name//': they meet')
    call t%check(last < 0.8_wp*start, name//': energy is lost')
    ! Over 600 steps and 27 bodies.
    momentum = all_momentum(sim) - momentum
    call t%near(norm2(momentum(1:3)), 0.0_wp, 1e-12_wp*scale(1), name//': momentum')
    call t%near(gain, 0.0_wp, 1e-13_wp*start, name//': energy is never made')
    drift = norm2(momentum(4:6))/scale(2)
  end subroutine run_cloud

  !> A box or a prism.
  subroutine put_any(sim, body, place)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: body
    real(wp), intent(in) :: place(3)
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error

    if (modulo(body, 2) == 0) then
      call put_box(sim%scene, body, [0.2_wp, 0.3_wp, 0.4_wp], place)
    else
      call prism_polyhedron(5, 0.35_wp, 0.2_wp, shape, error)
      if (allocated(error)) error stop 'a prism that is none'
      call put_shape(sim%scene, body, shape, place)
    end if
  end subroutine put_any
end program test_impacts_in_space
