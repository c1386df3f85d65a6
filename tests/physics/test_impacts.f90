!> Impacts with known outcomes: restitution, a bouncing ball's end, cradles, a rocking block, a Painleve rod, clouds.
program test_impacts
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, g, put_disk, put_polygon, put_wall, run
  use sg_body_energy, only: kinetic_energy
  use sg_kinds, only: wp
  use sg_laws, only: law_restitution
  use sg_random, only: random_t
  use sg_simulation, only: simulation_t
  implicit none
  type(tests_t) :: t

  call test_restitution()
  call test_bouncing_ball()
  call test_cradle()
  call test_rocking_block()
  call test_painleve()
  call test_cloud(with_polygons=.false., friction=0.0_wp)
  call test_cloud(with_polygons=.false., friction=0.5_wp)
  call test_cloud(with_polygons=.true., friction=0.5_wp)
  call t%finish()

contains

  !> A ball on a floor leaves with e times its velocity; it touches when the step begins, so that the law acts.
  subroutine test_restitution()
    real(wp), parameter :: e(3) = [0.0_wp, 0.5_wp, 1.0_wp]
    type(simulation_t), pointer :: sim
    integer :: i

    do i = 1, 3
      sim => fresh()
      call begin_scene(sim%scene, 2, 0.0_wp, 0.1_wp)
      sim%scene%laws(1)%kind = law_restitution
      sim%scene%laws(1)%normal_restitution = e(i)
      sim%scene%gravity = 0
      call put_disk(sim%scene, 1, 0.5_wp, [0.0_wp, 0.5_wp])
      call put_wall(sim%scene, 2, 5.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
      sim%scene%bodies%velocity(1:2, 1) = [1.0_wp, -2.0_wp]
      call begin_run(sim, 1e-3_wp, 1e-12_wp)
      call run(sim, 3)
      call t%near(sim%scene%bodies%velocity(2, 1), 2*e(i), 1e-14_wp, 'restitution: normal velocity')
      call t%near(sim%scene%bodies%velocity(1, 1), 1.0_wp, 1e-14_wp, 'restitution: tangential velocity')
    end do
  end subroutine test_restitution

  !> A ball that bounces with e = 0.5: at rest after sqrt(2h/g) (1+e)/(1-e), mgh dissipated, and then it stays.
  subroutine test_bouncing_ball()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: e = 0.5_wp, height = 1, h = 1e-4_wp
    real(wp) :: rest_time, resting_height, closure

    sim => fresh()
    call begin_scene(sim%scene, 2, 0.0_wp, 0.1_wp)
    sim%scene%laws(1)%kind = law_restitution
    sim%scene%laws(1)%normal_restitution = e
    call put_disk(sim%scene, 1, 0.5_wp, [0.0_wp, 0.5_wp + height])
    call put_wall(sim%scene, 2, 5.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    call begin_run(sim, h, 1e-12_wp)
    rest_time = sqrt(2*height/g)*(1 + e)/(1 - e)
    ! Impacts are seen one step late at most, by v h = 4e-4 m of penetration, which costs e^n of it in each rebound.
    call run(sim, nint(0.9_wp*rest_time/h))
    call t%check(abs(sim%scene%bodies%velocity(2, 1)) > 0.01_wp, 'bouncing ball: still bounces at 0.9 of its time')
    call run(sim, nint(0.12_wp*rest_time/h))
    call t%near(sim%scene%bodies%velocity(2, 1), 0.0_wp, 2*g*h, 'bouncing ball: at rest at 1.02 of its time')
    resting_height = sim%scene%bodies%position(2, 1)
    call t%near(resting_height, 0.5_wp, 5e-4_wp, 'bouncing ball: lies on the floor')
    call run(sim, 20000)
    call t%near(sim%scene%bodies%velocity(2, 1), 0.0_wp, 2*g*h, 'bouncing ball: stays at rest')
    ! At rest a contact of this law parts by g h and closes again, so the ball trembles by g h^2, and does not creep.
    call t%near(sim%scene%bodies%position(2, 1), resting_height, 2*g*h**2, 'bouncing ball: does not creep')
    associate (mgh => sim%scene%bodies%mass(1)*g*height)
      call t%near(sim%energy%impact_loss/mgh, 1.0_wp, 1e-3_wp, 'bouncing ball: all energy is dissipated')
      closure = kinetic_energy(sim%scene%bodies) + sim%energy%impact_loss &
                - sim%scene%bodies%mass(1)*g*(0.5_wp + height - sim%scene%bodies%position(2, 1))
      ! Sums over 3e4 steps.
      call t%near(closure/mgh, 0.0_wp, 1e-11_wp, 'bouncing ball: the balance closes')
    end associate
  end subroutine test_bouncing_ball

  !> Three touching balls, the first at speed 1: (-1/3, 2/3, 2/3) for e = 1, (1/3, 1/3, 1/3) for e = 0.
  subroutine test_cradle()
    type(simulation_t), pointer :: sim
    integer :: i, b
    real(wp) :: expected(3)

    do i = 0, 1
      sim => fresh()
      call begin_scene(sim%scene, 3, 0.0_wp, 0.1_wp)
      sim%scene%laws(1)%kind = law_restitution
      sim%scene%laws(1)%normal_restitution = real(i, wp)
      sim%scene%gravity = 0
      do b = 1, 3
        call put_disk(sim%scene, b, 0.5_wp, [real(b, wp), 0.0_wp])
      end do
      sim%scene%bodies%velocity(1, 1) = 1
      ! Detection at the middle of the step sees balls that touch as overlapping or exactly touching.
      call begin_run(sim, 1e-6_wp, 1e-14_wp)
      call run(sim, 1)
      expected = 1/3.0_wp + real(i, wp)*[-2/3.0_wp, 1/3.0_wp, 1/3.0_wp]
      call t%near(maxval(abs(sim%scene%bodies%velocity(1, :) - expected)), 0.0_wp, 1e-12_wp, 'cradle: velocities')
      call t%near(kinetic_energy(sim%scene%bodies)/(sim%scene%bodies%mass(1)/2), merge(1.0_wp, 1/3.0_wp, i == 1), 1e-12_wp, &
                  'cradle: energy')
    end do
  end subroutine test_cradle

  !> A block rocks over from one corner to the other: Housner's ratio of spins 1 - 1.5 sin^2 a.
  !!
  !! It turns about its left corner and lands flat in one inelastic impact, the left corner leaving freely, with friction
  !! enough to stick. No gravity: nothing but the impact changes the spin, and the ratio holds to the solver's tolerance.
  subroutine test_rocking_block()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: b = 0.2_wp, c = 1, spin = 0.05_wp
    real(wp) :: sine2

    sim => fresh()
    call begin_scene(sim%scene, 2, 2.0_wp, 0.1_wp)
    call put_polygon(sim%scene, 1, reshape([-b, 0.0_wp, b, 0.0_wp, b, 2*c, -b, 2*c], [2, 4]))
    call put_wall(sim%scene, 2, 5.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    sim%scene%gravity = 0
    sim%scene%bodies%velocity(:, 1) = [spin*c, -spin*b, -spin]
    ! Flat at the beginning of the step: theta 1 puts the detection there.
    sim%options%theta = 1
    call begin_run(sim, 1e-5_wp, 1e-13_wp)
    call run(sim, 1)
    call t%equal(sim%contacts%n, 2, 'rocking block: two points of contact')
    sine2 = b**2/(b**2 + c**2)
    call t%near(sim%scene%bodies%velocity(3, 1)/(-spin), 1 - 1.5_wp*sine2, 1e-10_wp, 'rocking block: spin after the impact')
    call t%near(sim%scene%bodies%velocity(2, 1), -sim%scene%bodies%velocity(3, 1)*b, 1e-12_wp, &
                'rocking block: it turns about the other corner')
  end subroutine test_rocking_block

  !> A rod that slides on its end with so much friction that no force law has a solution: the impact stops it.
  subroutine test_painleve()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: friction = 1.8_wp, half = 0.5_wp, thick = 1e-4_wp
    real(wp) :: angle, u(2), foot(2), along(2), across(2)
    integer :: i

    angle = atan(2.0_wp)
    along = [cos(angle), sin(angle)]
    across = [-sin(angle), cos(angle)]
    do i = 1, 2
      sim => fresh()
      call begin_scene(sim%scene, 2, friction, 1e-3_wp)
      ! A thin rhomb of length 1, its lower end on the floor at the origin.
      call put_polygon(sim%scene, 1, reshape([[0.0_wp, 0.0_wp], half*along - thick*across, 2*half*along, &
                                              half*along + thick*across], [2, 4]))
      sim%scene%bodies%inertia(1) = sim%scene%bodies%mass(1)*(2*half)**2/12
      sim%scene%bodies%inverse_mass(3, 1) = 1/sim%scene%bodies%inertia(1)
      call put_wall(sim%scene, 2, 50.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
      ! It slides away from the side to which it leans, or towards it.
      sim%scene%bodies%velocity(1, 1) = merge(5.0_wp, -5.0_wp, i == 1)
      call begin_run(sim, 1e-4_wp, 1e-9_wp)
      call run(sim, 1)
      call t%check(sim%report%is_converged, 'Painleve: converged')
      call t%check(maxval(abs(sim%scene%bodies%velocity(:, 1))) < 50, 'Painleve: velocities stay finite')
      foot = -half*along
      u = sim%scene%bodies%velocity(1:2, 1) + sim%scene%bodies%velocity(3, 1)*[-foot(2), foot(1)]
      call t%check(u(2) > -1e-6_wp, 'Painleve: the foot does not enter the floor')
      call t%check(kinetic_energy(sim%scene%bodies) <= sim%scene%bodies%mass(1)*12.5_wp*(1 + 1e-3_wp), 'Painleve: no energy is won')
      call run(sim, 5000)
      call t%check(all(abs(sim%scene%bodies%velocity(:, 1)) < 50), 'Painleve: and later')
    end do
    call t%check(friction > (4 + tan(angle)**2)/(3*tan(angle)), 'Painleve: this is a paradox')
  end subroutine test_painleve

  !> A cloud of grains that rushes together, solved roughly: momentum is kept to rounding whatever the solver left undone.
  !!
  !! Each impulse acts on either body's own surface, and these are a gap apart: the moment about the origin changes by
  !! (gap n) x (r_n n + r_t t) = -gap r_t.
  subroutine test_cloud(with_polygons, friction)
    logical, intent(in) :: with_polygons
    real(wp), intent(in) :: friction
    type(simulation_t), pointer :: sim
    type(random_t) :: random
    integer, parameter :: n = 100
    real(wp) :: place(2), before(3), after(3), scale, energy, moment
    integer :: b, step, k

    sim => fresh()
    call random%seed(3)
    call begin_scene(sim%scene, n, friction, 0.05_wp)
    sim%scene%gravity = 0
    do b = 1, n
      place = 1.1_wp*[real(modulo(b - 1, 10), wp), real((b - 1)/10, wp)]
      if (with_polygons .and. modulo(b, 2) == 0) then
        call put_polygon(sim%scene, b, spread(place, 2, 4) + 0.45_wp*reshape([1.0_wp, 0.1_wp, -0.1_wp, 1.0_wp, -1.0_wp, -0.1_wp, &
                                                                              0.1_wp, -1.0_wp], [2, 4]))
      else
        call put_disk(sim%scene, b, random%uniform(0.4_wp, 0.5_wp), place)
      end if
      sim%scene%bodies%velocity(:, b) = [5 - place(1), 4 - place(2), 0.0_wp]
      if (friction > 0) sim%scene%bodies%velocity(3, b) = random%uniform(-2.0_wp, 2.0_wp)
    end do
    call begin_run(sim, 1e-3_wp, 1e-3_wp)
    before = momenta(sim)
    energy = kinetic_energy(sim%scene%bodies)
    scale = sum(sim%scene%bodies%mass*hypot(sim%scene%bodies%velocity(1, :), sim%scene%bodies%velocity(2, :)))
    moment = 0
    do step = 1, 400
      call run(sim, 1)
      do k = 1, sim%contacts%n
        if (friction > 0) moment = moment - sim%contacts%gap(k)*sim%contacts%impulse(2, k)
      end do
    end do
    call t%check(kinetic_energy(sim%scene%bodies) < 0.9_wp*energy, 'cloud: there were impacts')
    ! 400 steps with some 200 contacts, each rounded.
    after = momenta(sim)
    call t%near(maxval(abs(after(1:2) - before(1:2)))/scale, 0.0_wp, 1e-12_wp, 'cloud: momentum is kept')
    call t%near((after(3) - before(3) - moment)/scale, 0.0_wp, 1e-11_wp, 'cloud: angular momentum changes by gaps alone')
    call t%near(moment/scale, 0.0_wp, 1e-4_wp, 'cloud: and that is little')
  end subroutine test_cloud

  !> Linear and angular momentum.
  function momenta(sim) result(p)
    type(simulation_t), intent(in) :: sim
    real(wp) :: p(3)
    integer :: b

    p = 0
    associate (bodies => sim%scene%bodies)
      do b = 1, bodies%n
        associate (x => bodies%position(:, b), v => bodies%velocity(1:2, b))
          p = p + bodies%mass(b)*[v, x(1)*v(2) - x(2)*v(1)]
          if (bodies%n_velocity == 3) p(3) = p(3) + bodies%inertia(b)*bodies%velocity(3, b)
        end associate
      end do
    end associate
  end function momenta
end program test_impacts
