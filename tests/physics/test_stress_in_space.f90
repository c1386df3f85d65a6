!> Packings at rest under known forces: a column of cubes, and lattices of spheres pressed by planes.
!!
!! Where every grain is in equilibrium and nothing weighs, the mean stress of what a box of planes holds follows from the
!! forces on the planes alone: sigma_ab = sum of f_a x_b over V, f the force on a plane at x.
program test_stress_in_space
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use measured, only: box_of_scene, mean_stress
  use scenes, only: begin_run, density, g, run
  use scenes_space, only: begin_space_scene, force_in_space, put_box, put_plane, put_sphere
  use sg_contacts, only: impulse_vector
  use sg_kinds, only: wp, pi
  use sg_measures, only: measure, measures_t
  use sg_rotations, only: rotation_by
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  implicit none
  real(wp), parameter :: h = 1e-3_wp, push = 1e6_wp, radius = 0.5_wp
  ! Of the forces: a solver that stops at 1e-11, some times more in slow modes, and gaps of 1e-16 m that the next step closes, with
  ! 1e-6 N or so.
  real(wp), parameter :: solved = 1e-9_wp
  type(tests_t) :: t

  call test_column()
  call test_simple_cubic(0.0_wp)
  call test_simple_cubic(0.5_wp)
  call test_stretched_lattice(0.0_wp)
  call test_stretched_lattice(0.4_wp)
  call test_fcc(0.0_wp)
  call test_fcc(0.3_wp)
  call t%finish()

contains

  !> Cubes on one another: the stress grows from the top down, by their weight over their section; its mean is half.
  subroutine test_column()
    integer, parameter :: n = 4
    type(simulation_t), pointer :: sim
    type(measures_t) :: measures
    integer :: i
    real(wp) :: weight

    sim => fresh()
    call begin_space_scene(sim%scene, n + 1, 0.0_wp, 0.01_wp)
    do i = 1, n
      call put_box(sim%scene, i, [0.5_wp, 0.5_wp, 0.5_wp], [0.0_wp, 0.0_wp, real(i, wp) - 0.5_wp])
    end do
    call put_plane(sim%scene, n + 1, [5.0_wp, 5.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    call begin_run(sim, h, 1e-13_wp)
    call run(sim, 3)
    call measure(sim%scene, sim%contacts, h, sim%energy, measures)
    weight = n*density*g
    call t%near(measures%get('stress_zz')/weight, 0.5_wp, solved, 'column: mean stress is half of that at the foot')
    call t%near(measures%get('pressure')/weight, 1/6.0_wp, solved, 'column: pressure')
    call t%near(max(abs(measures%get('stress_xx')), abs(measures%get('stress_yz')), abs(measures%get('stress_xy')))/weight, &
                0.0_wp, solved, 'column: no other stress')
    call t%near(measures%get('floor_share'), 1.0_wp, solved, 'column: the floor carries the weight')
    call t%near(measures%get('quadruple_contacts'), real(n, wp), 0.0_wp, 'column: cubes stand on four points')
    call t%near(measures%get('triple_contacts'), 0.0_wp, 0.0_wp, 'column: none on three')
    call t%near(measures%get('coordination'), (2*(n - 1) + 1)/real(n, wp), 1e-14_wp, 'column: neighbours')
    call t%near(measures%get('rattlers'), 1.0_wp, 0.0_wp, 'column: the cube at the top has one')
    call t%near(measures%get('compactness'), 1.0_wp, 1e-9_wp, 'column: cubes fill their box')
    call t%near(measures%get('momentum_z'), 0.0_wp, solved*weight, 'column: rests')
  end subroutine test_column

  !> Six planes, the last of them a lid free along z and pressed down, about a room; bodies `first` to `first` + 5.
  subroutine put_room(scene, first, size)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: first
    real(wp), intent(in) :: size(3)
    real(wp), parameter :: half(3) = [9.0_wp, 9.0_wp, 0.1_wp]
    real(wp) :: middle(3)

    middle = size/2
    call put_plane(scene, first, half, [middle(1), middle(2), -0.1_wp])
    call put_plane(scene, first + 1, half, [-0.1_wp, middle(2), middle(3)], rotation_by([0.0_wp, pi/2, 0.0_wp]))
    call put_plane(scene, first + 2, half, [size(1) + 0.1_wp, middle(2), middle(3)], rotation_by([0.0_wp, -pi/2, 0.0_wp]))
    call put_plane(scene, first + 3, half, [middle(1), -0.1_wp, middle(3)], rotation_by([-pi/2, 0.0_wp, 0.0_wp]))
    call put_plane(scene, first + 4, half, [middle(1), size(2) + 0.1_wp, middle(3)], rotation_by([pi/2, 0.0_wp, 0.0_wp]))
    call put_lid(scene, first + 5, half, [middle(1), middle(2), size(3) + 0.1_wp])
  end subroutine put_room

  !> A plane that faces down, is free along z and pressed down.
  subroutine put_lid(scene, body, half, position)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: body
    real(wp), intent(in) :: half(3), position(3)
    integer :: i

    call put_plane(scene, body, half, position, rotation_by([pi, 0.0_wp, 0.0_wp]))
    do i = 1, size(scene%drives)
      if (scene%drives(i)%body /= body .or. scene%drives(i)%component /= 3) cycle
      scene%drives(i)%is_velocity = .false.
      scene%drives(i)%value%constant = -push
    end do
  end subroutine put_lid

  !> Solve three steps without gravity.
  subroutine press(sim)
    type(simulation_t), intent(inout) :: sim

    sim%scene%gravity = 0
    call begin_run(sim, h, 1e-11_wp)
    call run(sim, 3)
  end subroutine press

  !> Mean stress of the grains over their box from the forces on walls and where they act, without those between grains [Pa].
  function stress_at_walls(sim) result(stress)
    type(simulation_t), intent(in) :: sim
    real(wp) :: stress(3, 3), force(3), volume
    integer :: k, b

    stress = 0
    volume = box_of_scene(sim%scene)
    do k = 1, sim%contacts%n
      associate (is_grain => sim%scene%bodies%is_grain(sim%contacts%body(:, k)))
        if (all(is_grain)) cycle
        force = merge(-1.0_wp, 1.0_wp, is_grain(1))*impulse_vector(sim%contacts, k)/h
      end associate
      do b = 1, 3
        stress(:, b) = stress(:, b) + force*sim%contacts%point(b, k)/volume
      end do
    end do
  end function stress_at_walls

  !> Spheres on a simple cubic lattice carry the lid by columns: stress is force over area, and there is no other.
  subroutine test_simple_cubic(friction)
    real(wp), intent(in) :: friction
    integer, parameter :: n = 3
    type(simulation_t), pointer :: sim
    real(wp) :: expected(3, 3)
    integer :: i

    sim => fresh()
    call begin_space_scene(sim%scene, n**3 + 6, friction, 0.01_wp)
    do i = 1, n**3
      call put_sphere(sim%scene, i, radius, real([modulo(i - 1, n), modulo((i - 1)/n, n), (i - 1)/n**2], wp) + radius)
    end do
    call put_room(sim%scene, n**3 + 1, spread(real(n, wp), 1, 3))
    call press(sim)
    expected = 0
    expected(3, 3) = push/n**2
    call t%near(maxval(abs(mean_stress(sim%scene, sim%contacts, h) - expected))/push, 0.0_wp, solved, &
                'simple cubic: force over area')
  end subroutine test_simple_cubic

  !> Layers of spheres that touch those above and below alone, without end along x and y: sigma_xx/sigma_zz hangs on the slope.
  subroutine test_stretched_lattice(friction)
    real(wp), intent(in) :: friction
    integer, parameter :: n = 3, layers = 4
    real(wp), parameter :: spacing = 2.1_wp*radius, rise = sqrt(4*radius**2 - spacing**2/2)
    real(wp), parameter :: width = n*spacing, height = 2*radius + real(layers - 1, wp)*rise
    type(simulation_t), pointer :: sim
    real(wp) :: stress(3, 3), across, shift
    integer :: i, layer

    sim => fresh()
    call begin_space_scene(sim%scene, layers*n**2 + 2, friction, 0.01_wp)
    sim%scene%period = width
    sim%scene%period_y = width
    do i = 1, layers*n**2
      layer = (i - 1)/n**2
      shift = spacing*(0.25_wp + 0.5_wp*real(modulo(layer, 2), wp))
      call put_sphere(sim%scene, i, radius, [shift + spacing*real(modulo(i - 1, n), wp), &
                                             shift + spacing*real(modulo((i - 1)/n, n), wp), radius + rise*real(layer, wp)])
    end do
    call put_plane(sim%scene, layers*n**2 + 1, [width, width, 0.1_wp], [width/2, width/2, -0.1_wp])
    call put_lid(sim%scene, layers*n**2 + 2, [width, width, 0.1_wp], [width/2, width/2, height + 0.1_wp])
    call press(sim)
    stress = mean_stress(sim%scene, sim%contacts, h)
    call t%equal(sim%contacts%n, n**2*(2 + 4*(layers - 1)), 'stretched lattice: four neighbours above and below')
    call t%near(stress(3, 3)*width**2/push, 1.0_wp, solved, 'stretched lattice: stress is force over area')
    if (friction > 0) return
    call t%near(max(abs(stress(1, 3)), abs(stress(2, 3)))*width**2/push, 0.0_wp, solved, 'stretched lattice: nothing rubs')
    ! Each of the gaps between layers carries the push by normals of the same slope; the branch is two radii.
    across = real(layers - 1, wp)*(spacing/2)**2/rise
    call t%near(stress(1, 1)*width**2*height/push, across, solved, 'stretched lattice: along x')
    call t%near(stress(2, 2)*width**2*height/push, across, solved, 'stretched lattice: along y')
  end subroutine test_stretched_lattice

  !> Spheres on an fcc lattice in a room, layers of 9, 4 and 9: they lean on its sides, and these tell the whole stress.
  subroutine test_fcc(friction)
    real(wp), intent(in) :: friction
    real(wp), parameter :: rise = sqrt(2.0_wp)*radius, room(3) = [3.0_wp, 3.0_wp, 1 + 2*rise]
    type(simulation_t), pointer :: sim
    real(wp) :: stress(3, 3), side(3)
    integer :: i, body, layer, n

    sim => fresh()
    call begin_space_scene(sim%scene, 22 + 6, friction, 0.01_wp)
    body = 0
    do layer = 0, 2
      n = merge(2, 3, layer == 1)
      do i = 1, n**2
        body = body + 1
        call put_sphere(sim%scene, body, radius, [real(modulo(i - 1, n), wp), real((i - 1)/n, wp), rise*real(layer, wp)] &
                        + radius*[real(5 - n, wp) - 1, real(5 - n, wp) - 1, 1.0_wp])
      end do
    end do
    call put_room(sim%scene, 23, room)
    call press(sim)
    stress = mean_stress(sim%scene, sim%contacts, h)
    call t%near(maxval(abs(stress - stress_at_walls(sim)))*9/push, 0.0_wp, solved, 'fcc: what walls feel')
    side = force_in_space(sim, 25)
    call t%check(side(1) > 0.1_wp*push, 'fcc: spheres lean on the side')
    if (friction > 0) return
    call t%near(stress(3, 3)*9/push, 1.0_wp, solved, 'fcc: force over area')
    call t%near(stress(1, 1)*room(2)*room(3)/side(1), 1.0_wp, solved, 'fcc: force on a side over its area')
  end subroutine test_fcc
end program test_stress_in_space
