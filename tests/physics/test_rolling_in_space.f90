!> Round bodies that roll in space: from sliding to rolling, capsules on a slope, a sphere in a drum, in a corner; and the same
!! motion whichever way the whole scene is turned.
program test_rolling_in_space
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, g, run
  use scenes_space, only: begin_space_scene, force_in_space, put_box, put_capsule, put_drum, put_plane, put_sphere
  use sg_kinds, only: wp, pi
  use sg_rotations, only: frame_of, no_rotation, normalised, quaternion_product, rotation_by, turned_by
  use sg_simulation, only: simulation_t
  use sg_vectors, only: cross
  implicit none
  real(wp), parameter :: h = 1e-3_wp
  ! 10^-12 of the solver, over steps and sums.
  real(wp), parameter :: exactly = 1e-8_wp
  type(tests_t) :: t

  call test_to_rolling()
  call test_capsule()
  call test_drum()
  call test_corner()
  call test_turned()
  call t%finish()

contains

  !> A sphere that spins or slides on a table ends rolling with v0 5/7 + 2/7 R w0 x n: its momentum about the point of contact
  !! is kept to the last, whatever the friction. Its spin about the vertical stays.
  subroutine test_to_rolling()
    real(wp), parameter :: radius = 0.2_wp, frictions(2) = [0.1_wp, 0.7_wp]
    type(simulation_t), pointer :: sim
    real(wp) :: v0(3), w0(3), expected(3), slip
    integer :: i, j

    do i = 1, 3
      do j = 1, 2
        v0 = merge(0.0_wp, 1.0_wp, i == 1)*[1.0_wp, -0.4_wp, 0.0_wp]
        w0 = merge(0.0_wp, 10.0_wp, i == 2)*[0.6_wp, 0.9_wp, 0.7_wp]
        sim => fresh()
        call begin_space_scene(sim%scene, 2, frictions(j), 0.01_wp)
        call put_sphere(sim%scene, 1, radius, [0.0_wp, 0.0_wp, radius])
        call put_plane(sim%scene, 2, [20.0_wp, 20.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
        sim%scene%bodies%velocity(:, 1) = [v0, w0]
        call begin_run(sim, h, 1e-12_wp)
        slip = norm2(v0 + cross(w0, [0.0_wp, 0.0_wp, -radius]))
        ! Slip is lost at 7/2 mu g: still sliding at 90 % of that time, rolling at 110 %.
        call run(sim, nint(0.9_wp*slip/(3.5_wp*frictions(j)*g)/h))
        call t%near(slip_of(sim, radius), 0.1_wp*slip, 3.5_wp*frictions(j)*g*h, 'to rolling: slip left at nine tenths')
        call run(sim, nint(0.2_wp*slip/(3.5_wp*frictions(j)*g)/h) + 2)
        expected = 5*v0/7 + 2*cross(w0, [0.0_wp, 0.0_wp, radius])/7
        call t%near(slip_of(sim, radius), 0.0_wp, exactly, 'to rolling: rolls')
        call t%near(norm2(sim%scene%bodies%velocity(1:3, 1) - expected), 0.0_wp, exactly, 'to rolling: 5/7 v + 2/7 R w')
        call t%near(dot_product(turned_by(sim%scene%bodies%orientation(:, 1), sim%scene%bodies%velocity(4:6, 1)), &
                                [0.0_wp, 0.0_wp, 1.0_wp]), w0(3), exactly, 'to rolling: spin about the vertical')
        call run(sim, 200)
        call t%near(norm2(sim%scene%bodies%velocity(1:3, 1) - expected), 0.0_wp, exactly, 'to rolling: goes on')
      end do
    end do
  end subroutine test_to_rolling

  !> Speed of the sphere's lowest point.
  real(wp) function slip_of(sim, radius)
    type(simulation_t), intent(in) :: sim
    real(wp), intent(in) :: radius
    real(wp) :: spin(3), u(3)

    spin = turned_by(sim%scene%bodies%orientation(:, 1), sim%scene%bodies%velocity(4:6, 1))
    u = sim%scene%bodies%velocity(1:3, 1) + cross(spin, [0.0_wp, 0.0_wp, -radius])
    slip_of = norm2(u(1:2))
  end function slip_of

  !> A lying capsule rolls down at g sin a/(1 + I/(m R^2)), rests on two points with half its weight each, and stands upright
  !! on its cap as long as nothing disturbs it.
  subroutine test_capsule()
    real(wp), parameter :: radius = 0.1_wp, half = 0.3_wp, angle = 0.3_wp
    type(simulation_t), pointer :: sim
    real(wp) :: cylinder, caps, share, weight
    integer :: i, k

    cylinder = 2*half*pi*radius**2
    caps = 4*pi*radius**3/3
    share = (cylinder/2 + 2*caps/5)/(cylinder + caps)
    do i = 1, 3
      sim => fresh()
      call begin_space_scene(sim%scene, 2, 0.6_wp, 0.01_wp)
      call put_capsule(sim%scene, 1, half, radius, [0.0_wp, 0.0_wp, merge(radius + half, radius, i == 3)])
      if (i < 3) sim%scene%bodies%orientation(:, 1) = quaternion_product(rotation_by([-pi/2, 0.0_wp, 0.0_wp]), &
                                                                         sim%scene%bodies%orientation(:, 1))
      call put_plane(sim%scene, 2, [20.0_wp, 20.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
      if (i == 1) sim%scene%gravity = g*[sin(angle), 0.0_wp, -cos(angle)]
      weight = sim%scene%bodies%mass(1)*g
      call begin_run(sim, h, 1e-12_wp)
      call run(sim, 300)
      select case (i)
      case (1)
        call t%near(sim%scene%bodies%velocity(1, 1)/sim%time(), g*sin(angle)/(1 + share), exactly*g, 'capsule: rolls')
        call t%near(abs(sim%scene%bodies%velocity(2, 1)), 0.0_wp, exactly, 'capsule: straight')
      case (2)
        call t%equal(sim%contacts%n, 2, 'capsule: lies on two points')
        do k = 1, sim%contacts%n
          call t%near(sim%contacts%impulse(3, k)/h, weight/2, exactly*weight, 'capsule: each carries half')
        end do
        call t%near(maxval(abs(sim%scene%bodies%velocity(:, 1))), 0.0_wp, exactly, 'capsule: at rest')
      case (3)
        call t%equal(sim%contacts%n, 1, 'capsule: stands on one point')
        call t%near(sim%contacts%impulse(3, 1)/h, weight, exactly*weight, 'capsule: stands')
        call t%near(maxval(abs(sim%scene%bodies%velocity(:, 1))), 0.0_wp, exactly, 'capsule: stands at rest')
      end select
    end do
  end subroutine test_capsule

  !> In a drum a sphere rests at the bottom, and about it rolls to and fro with omega^2 = 5/7 g/(R - r), 1 - a^2/16 slower for
  !! an amplitude of a; without friction it slides with omega^2 = g/(R - r).
  subroutine test_drum()
    real(wp), parameter :: outer = 1.0_wp, radius = 0.1_wp, amplitude = 0.1_wp
    type(simulation_t), pointer :: sim
    real(wp) :: omega, x, crossing(2), weight
    integer :: i, crossings

    do i = 1, 3
      sim => fresh()
      call begin_space_scene(sim%scene, 2, merge(0.0_wp, 0.5_wp, i == 2), 0.01_wp)
      associate (a => merge(0.0_wp, amplitude, i == 1))
        call put_sphere(sim%scene, 1, radius, (outer - radius)*[sin(a), 0.0_wp, -cos(a)])
      end associate
      call put_drum(sim%scene, 2, 2.0_wp, outer, [0.0_wp, 0.0_wp, 0.0_wp])
      weight = sim%scene%bodies%mass(1)*g
      call begin_run(sim, h, 1e-12_wp)
      if (i == 1) then
        call run(sim, 100)
        call t%near(maxval(abs(sim%scene%bodies%velocity(:, 1))), 0.0_wp, exactly, 'drum: at rest')
        call t%near(maxval(abs(force_in_space(sim, 1) - [0.0_wp, 0.0_wp, weight])), 0.0_wp, exactly*weight, 'drum: its weight')
        cycle
      end if
      omega = sqrt(merge(1.0_wp, 5.0_wp/7, i == 2)*g/(outer - radius))
      crossings = 0
      do while (crossings < 5 .and. sim%step < 20000)
        x = sim%scene%bodies%position(1, 1)
        call run(sim, 1)
        if (x*sim%scene%bodies%position(1, 1) > 0) cycle
        crossings = crossings + 1
        if (crossings == 1) crossing(1) = sim%time()
        crossing(2) = sim%time()
      end do
      ! Four half periods, seen to a step each; the sphere bounces by rounding only.
      call t%near((crossing(2) - crossing(1))/4, pi/omega*(1 + amplitude**2/16), 2*h/4 + 1e-3_wp*pi/omega, 'drum: half period')
      ! It leaves along the tangent of each step's beginning: (h v)^2/(2 R) a step, v^2 a^2 omega^2 R^2/2 in the mean.
      call t%near(norm2(sim%scene%bodies%position([1, 3], 1)), outer - radius, &
                  1.2_wp*amplitude**2*omega**2*(outer - radius)*h*sim%time()/4, 'drum: on the wall')
    end do
  end subroutine test_drum

  !> Without friction a sphere in a corner of three planes leans on each with its share of the weight.
  subroutine test_corner()
    type(simulation_t), pointer :: sim
    real(wp), parameter :: radius = 0.1_wp, direction(3) = [0.3_wp, 0.5_wp, 0.8_wp]
    real(wp) :: weight
    integer :: axis

    sim => fresh()
    call begin_space_scene(sim%scene, 4, 0.0_wp, 0.01_wp)
    call put_sphere(sim%scene, 1, radius, [radius, radius, radius])
    call put_plane(sim%scene, 2, [5.0_wp, 5.0_wp, 0.1_wp], [-0.1_wp, 0.0_wp, 0.0_wp], rotation_by([0.0_wp, pi/2, 0.0_wp]))
    call put_plane(sim%scene, 3, [5.0_wp, 5.0_wp, 0.1_wp], [0.0_wp, -0.1_wp, 0.0_wp], rotation_by([-pi/2, 0.0_wp, 0.0_wp]))
    call put_plane(sim%scene, 4, [5.0_wp, 5.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    sim%scene%gravity = -g*direction/norm2(direction)
    weight = sim%scene%bodies%mass(1)*g
    call begin_run(sim, h, 1e-13_wp)
    call run(sim, 100)
    do axis = 1, 3
      call t%near(maxval(abs(force_in_space(sim, 1 + axis) + direction(axis)/norm2(direction)*weight*unit(axis))), 0.0_wp, &
                  exactly*weight, 'corner: each plane carries its share')
    end do
    call t%near(maxval(abs(sim%scene%bodies%velocity(:, 1))), 0.0_wp, exactly, 'corner: at rest')
  end subroutine test_corner

  !> Unit vector of an axis.
  pure function unit(axis)
    integer, intent(in) :: axis
    real(wp) :: unit(3)

    unit = 0
    unit(axis) = 1
  end function unit

  !> A sphere, a capsule and a box thrown on a plane, each into the next: turned as a whole, it all happens the same way.
  subroutine test_turned()
    type(simulation_t), pointer :: one, other
    real(wp) :: q(4), frame(3, 3), worst(2)
    integer :: b, met

    one => fresh()
    other => fresh()
    q = normalised([0.3_wp, -0.5_wp, 0.6_wp, 0.4_wp])
    frame = frame_of(q)
    call make_turned(one, no_rotation)
    call make_turned(other, q)
    met = 0
    worst = 0
    do while (one%step < 400)
      call run(one, 1)
      call run(other, 1)
      met = max(met, one%report%active_contacts)
      do b = 1, 3
        worst(1) = max(worst(1), norm2(matmul(frame, one%scene%bodies%position(:, b)) - other%scene%bodies%position(:, b)))
        worst(2) = max(worst(2), norm2(one%scene%bodies%velocity(4:6, b) - other%scene%bodies%velocity(4:6, b)))
      end do
    end do
    call t%check(met >= 3, 'turned: they meet')
    ! Errors of 10^-13 grow with each impact.
    call t%near(worst(1), 0.0_wp, 1e-7_wp, 'turned: the same way')
    call t%near(worst(2), 0.0_wp, 1e-5_wp, 'turned: the same spins about their own axes')
  end subroutine test_turned

  !> That scene, turned.
  subroutine make_turned(sim, q)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: q(4)
    integer :: b

    call begin_space_scene(sim%scene, 4, 0.3_wp, 0.01_wp)
    call put_sphere(sim%scene, 1, 0.2_wp, [0.0_wp, 0.0_wp, 0.25_wp])
    call put_capsule(sim%scene, 2, 0.2_wp, 0.1_wp, [0.7_wp, 0.1_wp, 0.35_wp])
    call put_box(sim%scene, 3, [0.1_wp, 0.2_wp, 0.15_wp], [1.1_wp, -0.1_wp, 0.4_wp], rotation_by([0.3_wp, 0.5_wp, 0.2_wp]))
    call put_plane(sim%scene, 4, [20.0_wp, 20.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    sim%scene%bodies%velocity(1:3, 1) = [4.0_wp, 0.2_wp, 0.0_wp]
    sim%scene%bodies%velocity(4:6, 2) = [1.0_wp, 2.0_wp, 0.5_wp]
    do b = 1, 4
      sim%scene%bodies%position(:, b) = turned_by(q, sim%scene%bodies%position(:, b))
      sim%scene%bodies%velocity(1:3, b) = turned_by(q, sim%scene%bodies%velocity(1:3, b))
      sim%scene%bodies%orientation(:, b) = quaternion_product(q, sim%scene%bodies%orientation(:, b))
    end do
    sim%scene%gravity = turned_by(q, sim%scene%gravity)
    call begin_run(sim, h, 1e-13_wp)
  end subroutine make_turned
end program test_rolling_in_space
