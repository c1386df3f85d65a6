!> Moments that resist rolling and twisting (doc/theory/laws.md, "Rolling and twisting") against closed forms: grains that rest on a
!! slope below the bound and roll above it, that roll to rest, spheres that spin to rest; in other units, turned, and with the
!! energy that the moments take.
program test_rolling_resistance
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, g, hold, put_disk, put_polygon, put_wall, run
  use scenes_space, only: begin_space_scene, put_plane, put_sphere
  use sg_contacts, only: moment_vector
  use sg_kinds, only: wp
  use sg_measures, only: measure, measures_t
  use sg_rotations, only: no_rotation, normalised, turned_by
  use sg_run_options, only: criterion_quad
  use sg_simulation, only: simulation_t
  implicit none
  real(wp), parameter :: h = 1e-3_wp, radius = 0.2_wp
  !> Of the acceleration g: 10^-12 of the solver over steps and sums
  real(wp), parameter :: exactly = 1e-8_wp
  type(tests_t) :: t

  call test_slopes()
  call test_without_friction()
  call test_to_rest()
  call test_twisting()
  call test_block()
  call test_units_and_turn()
  call test_increments()
  call t%finish()

contains

  !> A grain on a flat wall through the origin, in the plane or in space.
  subroutine put_grain(sim, dimension, friction, scale, q)
    type(simulation_t), pointer, intent(out) :: sim
    integer, intent(in) :: dimension
    real(wp), intent(in) :: friction
    real(wp), intent(in), optional :: scale !! unit of length [m], one unless given
    real(wp), intent(in), optional :: q(4) !! rotation of the whole scene in space, none unless given
    real(wp) :: unit, turn(4)

    sim => fresh()
    unit = 1
    turn = no_rotation
    if (present(scale)) unit = scale
    if (present(q)) turn = q
    if (dimension == 2) then
      call begin_scene(sim%scene, 2, friction, 0.01_wp*unit)
      call put_disk(sim%scene, 1, radius*unit, [0.0_wp, radius*unit])
      call put_wall(sim%scene, 2, 50*unit, 0.1_wp*unit, [0.0_wp, -0.1_wp*unit], 0.0_wp)
    else
      call begin_space_scene(sim%scene, 2, friction, 0.01_wp*unit)
      call put_sphere(sim%scene, 1, radius*unit, turned_by(turn, [0.0_wp, 0.0_wp, radius*unit]))
      call put_plane(sim%scene, 2, [50.0_wp, 50.0_wp, 0.1_wp]*unit, turned_by(turn, [0.0_wp, 0.0_wp, -0.1_wp*unit]), turn)
    end if
    sim%scene%gravity = g*unit*direction(dimension, 0.0_wp)
  end subroutine put_grain

  !> Direction of gravity on a slope whose tangent is given, down along x.
  pure function direction(dimension, slope) result(down)
    integer, intent(in) :: dimension
    real(wp), intent(in) :: slope
    real(wp) :: down(3)

    down = 0
    down(1) = slope
    down(dimension) = -1
    down = down/norm2(down)
  end function direction

  !> Moment of inertia over m R^2 of a disk and of a sphere.
  pure real(wp) function share_of(dimension)
    integer, intent(in) :: dimension

    share_of = merge(0.5_wp, 0.4_wp, dimension == 2)
  end function share_of

  !> Gravity of a slope whose tangent is given.
  subroutine tilt(sim, slope)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: slope

    sim%scene%gravity = g*direction(sim%scene%dimension, slope)
  end subroutine tilt

  !> Moment at the only contact over a step [N m].
  function moment_of(sim) result(moment)
    type(simulation_t), intent(in) :: sim
    real(wp) :: moment(3)

    moment = moment_vector(sim%contacts, 1)/sim%options%time_step
  end function moment_of

  !> On a slope the grain rests as long as tan a <= k, and rolls with g (sin a - k cos a)/(1 + I/(m R^2)) beyond, whether k is a
  !! coefficient or a length over the radius, or the sum of both.
  subroutine test_slopes()
    real(wp), parameter :: bound = 0.1_wp, slopes(4) = [0.05_wp, 0.0999_wp, 0.1001_wp, 0.3_wp], &
                           shares(3) = [1.0_wp, 0.0_wp, 0.25_wp]
    type(simulation_t), pointer :: sim
    type(measures_t) :: measures
    real(wp) :: expected, weight, normal
    integer :: i, d, way

    do d = 2, 3
      do i = 1, size(slopes)
        do way = 1, size(shares)
          call put_grain(sim, d, 0.6_wp)
          sim%scene%laws(1)%rolling_friction = shares(way)*bound
          sim%scene%laws(1)%rolling_length = (1 - shares(way))*bound*radius
          call tilt(sim, slopes(i))
          weight = sim%scene%bodies%mass(1)*g
          normal = weight/hypot(1.0_wp, slopes(i))
          call begin_run(sim, h, 1e-13_wp)
          call run(sim, 200)
          expected = max(0.0_wp, g*(slopes(i) - bound)/hypot(1.0_wp, slopes(i))/(1 + share_of(d)))
          call t%near(sim%scene%bodies%velocity(1, 1)/sim%time(), expected, exactly*g, 'slope: acceleration')
          call t%check(sim%report%is_converged, 'slope: converged')
          ! The moment balances the torque of the weight about the contact, or stands at its bound.
          call t%near(norm2(moment_of(sim)), radius*normal*min(slopes(i), bound), exactly*radius*weight, 'slope: moment')
          call measure(sim%scene, sim%contacts, h, sim%energy, measures)
          call t%near(measures%get('energy_closure'), 0.0_wp, 1e-8_wp, 'slope: the balance closes')
          call t%near(measures%get('rolling_loss'), bound*normal*sim%scene%bodies%position(1, 1), exactly*weight, &
                      'slope: work of the moment')
        end do
      end do
    end do
  end subroutine test_slopes

  !> Without friction a grain slides on as it did, and its spin is lost at l N/I all the same.
  subroutine test_without_friction()
    real(wp), parameter :: length = 0.02_wp, spin = 5.0_wp
    type(simulation_t), pointer :: sim
    real(wp) :: slowing
    integer :: d

    do d = 2, 3
      call put_grain(sim, d, 0.0_wp)
      sim%scene%laws(1)%rolling_length = length
      sim%scene%bodies%velocity(1, 1) = 1
      sim%scene%bodies%velocity(d + 1, 1) = spin
      slowing = length*g/(share_of(d)*radius**2)
      call begin_run(sim, h, 1e-13_wp)
      call run(sim, 100)
      call t%near(sim%scene%bodies%velocity(d + 1, 1), spin - slowing*sim%time(), exactly*spin, 'no friction: spin')
      call run(sim, nint(spin/slowing/h) - 99)
      call t%near(sim%scene%bodies%velocity(d + 1, 1), 0.0_wp, exactly, 'no friction: spin is lost')
      call t%near(sim%scene%bodies%velocity(1, 1), 1.0_wp, exactly, 'no friction: velocity stays')
    end do
  end subroutine test_without_friction

  !> A grain that rolls at v0 on level ground stops after v0/a and v0^2/(2 a), a = k g/(1 + I/(m R^2)), and stays.
  subroutine test_to_rest()
    real(wp), parameter :: bound = 0.05_wp, speed = 0.2_wp
    type(simulation_t), pointer :: sim
    real(wp) :: slowing
    integer :: d

    do d = 2, 3
      call put_grain(sim, d, 0.6_wp)
      sim%scene%laws(1)%rolling_friction = bound
      slowing = bound*g/(1 + share_of(d))
      sim%scene%bodies%velocity(1, 1) = speed
      if (d == 2) sim%scene%bodies%velocity(3, 1) = -speed/radius
      if (d == 3) sim%scene%bodies%velocity(5, 1) = speed/radius
      call begin_run(sim, h, 1e-13_wp)
      call run(sim, 200)
      call t%near(sim%scene%bodies%velocity(1, 1), speed - slowing*sim%time(), exactly, 'to rest: slows down')
      call run(sim, nint(speed/slowing/h) - 198)
      call t%near(maxval(abs(sim%scene%bodies%velocity(:, 1))), 0.0_wp, exactly, 'to rest: stands')
      ! The last step ends before its velocity would turn: a share of one step is not a whole one.
      call t%near(sim%scene%bodies%position(1, 1), speed**2/(2*slowing), slowing*h**2, 'to rest: distance')
      call run(sim, 100)
      call t%near(sim%scene%bodies%position(1, 1), speed**2/(2*slowing), slowing*h**2, 'to rest: stays')
    end do
  end subroutine test_to_rest

  !> A sphere that spins about the vertical stops after I w0/(l m g), on a plane with l = k R + length, on an equal sphere with
  !! l = k R/2 + length; without a law it spins on.
  subroutine test_twisting()
    real(wp), parameter :: bound = 0.04_wp, length = 0.002_wp, spin = 10.0_wp
    type(simulation_t), pointer :: sim
    real(wp) :: slowing, arm
    integer :: i

    do i = 1, 3
      if (i < 3) then
        call put_grain(sim, 3, 0.6_wp)
      else
        sim => fresh()
        call begin_space_scene(sim%scene, 2, 0.6_wp, 0.01_wp)
        call put_sphere(sim%scene, 1, radius, [0.0_wp, 0.0_wp, radius])
        call put_sphere(sim%scene, 2, radius, [0.0_wp, 0.0_wp, -radius])
        call hold(sim%scene, 2)
      end if
      ! A rolling bound keeps the sphere on the other one where rounding would have it roll off.
      sim%scene%laws(1)%rolling_friction = 0.01_wp
      sim%scene%bodies%velocity(6, 1) = spin
      arm = 0
      if (i > 1) then
        sim%scene%laws(1)%twisting_friction = bound
        sim%scene%laws(1)%twisting_length = length
        arm = bound*radius*merge(0.5_wp, 1.0_wp, i == 3) + length
      end if
      slowing = arm*g/(0.4_wp*radius**2)
      call begin_run(sim, h, 1e-13_wp)
      call run(sim, 200)
      call t%near(sim%scene%bodies%velocity(6, 1), spin - slowing*sim%time(), exactly*spin, 'twisting: slows down')
      if (i == 1) cycle
      call run(sim, nint(spin/slowing/h) - 198)
      call t%near(sim%scene%bodies%velocity(6, 1), 0.0_wp, exactly, 'twisting: stands')
      call t%near(norm2(sim%scene%bodies%velocity(:5, 1)), 0.0_wp, exactly, 'twisting: nothing else moves')
    end do
  end subroutine test_twisting

  !> A block on two points, each with a moment of up to l N, tips about its lower edge from tan a = (b + l)/c on, b half its width
  !! and c the height of its centre: moments act at any contact.
  subroutine test_block()
    real(wp), parameter :: half = 0.1_wp, height = 0.6_wp, length = 0.03_wp, limit = (half + length)/(height/2)
    real(wp), parameter :: slopes(2) = limit*[0.999_wp, 1.001_wp]
    type(simulation_t), pointer :: sim
    real(wp) :: inertia, expected
    integer :: i

    do i = 1, 2
      sim => fresh()
      call begin_scene(sim%scene, 2, 2.0_wp, 0.01_wp)
      call put_polygon(sim%scene, 1, reshape([-half, 0.0_wp, half, 0.0_wp, half, height, -half, height], [2, 4]))
      call put_wall(sim%scene, 2, 50.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
      sim%scene%laws(1)%rolling_length = length
      call tilt(sim, slopes(i))
      call begin_run(sim, h, 1e-13_wp)
      call run(sim, 50)
      if (i == 1) call t%near(sim%scene%bodies%velocity(3, 1), 0.0_wp, exactly, 'block: stands')
      if (i == 1) cycle
      ! It turns about the edge, I a = m g (c sin a - b cos a) - l N with N = m (g cos a + b a) at first, and falls faster as its
      ! centre comes over the edge: w = a t (1 + k^2 t^2/6), k^2 = m g c/I.
      inertia = sim%scene%bodies%inertia(1)/sim%scene%bodies%mass(1) + half**2 + (height/2)**2 + length*half
      expected = g*height/2*(slopes(2) - limit)/hypot(1.0_wp, slopes(2))/inertia
      expected = expected*(1 + g*height/2/inertia*sim%time()**2/6)
      call t%near(-sim%scene%bodies%velocity(3, 1)/sim%time(), expected, 1e-3_wp*expected, 'block: tips')
    end do
  end subroutine test_block

  !> A sphere that slides, spins, twists and rolls to rest: the same in millimetres, and with the scene turned.
  subroutine test_units_and_turn()
    real(wp), parameter :: v0(3) = [0.5_wp, 0.2_wp, 0.0_wp], w0(3) = [2.0_wp, -3.0_wp, 4.0_wp]
    real(wp) :: q(4), worst(2), spin(3)
    type(simulation_t), pointer :: one, large, turned
    integer :: i

    q = normalised([0.3_wp, -0.5_wp, 0.6_wp, 0.4_wp])
    call put_grain(one, 3, 0.3_wp)
    call put_grain(large, 3, 0.3_wp, scale=1000.0_wp)
    call put_grain(turned, 3, 0.3_wp, q=q)
    turned%scene%gravity = turned_by(q, turned%scene%gravity)
    one%scene%bodies%velocity(:, 1) = [v0, w0]
    large%scene%bodies%velocity(:, 1) = [1000*v0, w0]
    turned%scene%bodies%velocity(:, 1) = [turned_by(q, v0), turned_by(q, w0)]
    call set_law(one, 1.0_wp)
    call set_law(large, 1000.0_wp)
    call set_law(turned, 1.0_wp)
    worst = 0
    do i = 1, 20
      call run(one, 40)
      call run(large, 40)
      call run(turned, 40)
      spin = turned_by(one%scene%bodies%orientation(:, 1), one%scene%bodies%velocity(4:6, 1))
      worst(1) = max(worst(1), norm2(large%scene%bodies%velocity(1:3, 1)/1000 - one%scene%bodies%velocity(1:3, 1)), &
                     norm2(large%scene%bodies%velocity(4:6, 1) - one%scene%bodies%velocity(4:6, 1)))
      worst(2) = max(worst(2), norm2(turned%scene%bodies%velocity(1:3, 1) - turned_by(q, one%scene%bodies%velocity(1:3, 1))), &
                     norm2(turned_by(turned%scene%bodies%orientation(:, 1), turned%scene%bodies%velocity(4:6, 1)) &
                           - turned_by(q, spin)))
      if (i == 2) call t%check(norm2(spin) > 1, 'units and turn: it turns')
    end do
    call t%near(worst(1), 0.0_wp, exactly, 'the same in other units')
    call t%near(worst(2), 0.0_wp, exactly, 'the same with the scene turned')
    call t%near(maxval(abs(one%scene%bodies%velocity(:, 1))), 0.0_wp, exactly, 'units and turn: it comes to rest')
  end subroutine test_units_and_turn

  !> The law of that sphere, and the start of its run.
  subroutine set_law(sim, unit)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: unit

    sim%scene%laws(1)%rolling_friction = 0.15_wp
    sim%scene%laws(1)%twisting_length = 0.05_wp*radius*unit
    sim%scene%laws(1)%rolling_length = 0.05_wp*radius*unit
    call begin_run(sim, h, 1e-13_wp)
  end subroutine set_law

  !> Criteria of increments see moments too: solved by one of them, a grain rolls as it should.
  subroutine test_increments()
    real(wp), parameter :: bound = 0.1_wp, slope = 0.3_wp
    type(simulation_t), pointer :: sim
    integer :: d

    do d = 2, 3
      call put_grain(sim, d, 0.6_wp)
      sim%scene%laws(1)%rolling_friction = bound
      call tilt(sim, slope)
      sim%options%solver%criterion = criterion_quad
      call begin_run(sim, h, 1e-12_wp)
      call run(sim, 100)
      call t%near(sim%scene%bodies%velocity(1, 1)/sim%time(), g*(slope - bound)/hypot(1.0_wp, slope)/(1 + share_of(d)), &
                  1e-6_wp*g, 'increments: acceleration')
    end do
  end subroutine test_increments
end program test_rolling_resistance
