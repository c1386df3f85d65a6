!> Packings in space under gravity: the floor carries the weight, and compactness and coordination are those that friction
!! implies.
!!
!! Equal spheres that settle without friction come to random close packing, 0.63 to 0.64 (G. D. Scott, Nature 188, 1960), with
!! as many contacts as degrees of freedom: 6 a sphere in the bulk, 3 for each and each shared by two (isostatic; J.-N. Roux,
!! Phys. Rev. E 61, 2000). Friction lets them stop earlier: 0.55 (random loose) to 0.63, with 4 (isostatic with friction) to
!! 5.2 contacts; poured in by inertia they end well above the loosest.
program test_packing_in_space
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, density, g, run
  use scenes_space, only: begin_space_scene, force_in_space, put_plane, put_shape, put_sphere, turn_at_random
  use sg_contacts, only: normal_impulse
  use sg_error, only: error_t
  use sg_kinds, only: wp, pi
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: box_polyhedron, random_polyhedron
  use sg_random, only: random_t
  use sg_simulation, only: simulation_t
  implicit none
  real(wp), parameter :: radius = 0.5_wp, period = 6
  type(tests_t) :: t

  call test_spheres(0.0_wp, 2000)
  call test_spheres(0.5_wp, 1600)
  call test_polyhedra()
  call t%finish()

contains

  !> Equal spheres rain into a periodic cell and settle.
  subroutine test_spheres(friction, steps)
    real(wp), intent(in) :: friction
    integer, intent(in) :: steps
    integer, parameter :: n = 500
    type(simulation_t), pointer :: sim
    type(random_t) :: random
    real(wp) :: solid, coordination, deepest
    integer :: b

    sim => fresh()
    call random%seed(41)
    call begin_space_scene(sim%scene, n + 1, friction, 0.02_wp)
    sim%scene%period = period
    sim%scene%period_y = period
    do b = 1, n
      call put_sphere(sim%scene, b, radius, place_of(b, 1.15_wp, 5, random))
      sim%scene%bodies%velocity(1:3, b) = [random%uniform(-0.5_wp, 0.5_wp), random%uniform(-0.5_wp, 0.5_wp), 0.0_wp]
    end do
    call settle(sim, n, steps, 'spheres')
    call bulk(sim, n, solid, coordination, deepest)
    write (*, '(a,f4.1,a,f7.4,a,f6.3,a,es8.1)') 'friction', friction, ': compactness', solid, ', coordination', coordination, &
      ', deepest overlap', deepest
    if (friction > 0) then
      call t%check(solid > 0.55_wp .and. solid < 0.625_wp, 'spheres with friction: compactness')
      call t%check(coordination > 4 .and. coordination < 5.2_wp, 'spheres with friction: coordination')
    else
      call t%check(solid > 0.62_wp .and. solid < 0.65_wp, 'spheres without friction: compactness')
      call t%near(coordination, 6.0_wp, 0.3_wp, 'spheres without friction: coordination')
    end if
    ! What the few sweeps of the fall leave; nothing takes an overlap back.
    call t%check(deepest < 0.03_wp*radius, 'spheres: overlaps stay small')
  end subroutine test_spheres

  !> Places of a loose lattice, layer by layer, shaken a little.
  function place_of(b, spacing, side, random) result(place)
    integer, intent(in) :: b, side
    real(wp), intent(in) :: spacing
    type(random_t), intent(inout) :: random
    real(wp) :: place(3)
    integer :: i

    place = spacing*[real(modulo(b - 1, side), wp) + 0.5_wp, real(modulo((b - 1)/side, side), wp) + 0.5_wp, &
                     real((b - 1)/side**2, wp) + 0.6_wp]
    do i = 1, 3
      place(i) = place(i) + random%uniform(-0.05_wp, 0.05_wp)
    end do
  end function place_of

  !> Let them fall on a floor for some steps, and until they are at rest; in the end it carries their weight, and momentum is
  !! balanced in the last step.
  !!
  !! Without friction grains stir long before they jam, and rounding decides how long: 3500 to 7500 steps in runs that differ
  !! in nothing else.
  subroutine settle(sim, n, steps, name)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: n, steps
    character(len=*), intent(in) :: name
    real(wp), parameter :: h = 4e-3_wp
    real(wp) :: weight, before(3), floor(3)
    integer :: block

    call put_plane(sim%scene, n + 1, [period, period, 0.5_wp], [0.0_wp, 0.0_wp, -0.5_wp])
    weight = g*sum(sim%scene%bodies%mass(:n))
    call begin_run(sim, h, 1e-3_wp)
    sim%options%solver%maximum_sweeps = 100
    call restart_solver(sim, 1e-3_wp, 60)
    call run(sim, steps - 100)
    do block = 1, 100
      if (stirring(sim, n) < 5e-3_wp*sqrt(g*radius)) exit
      call run(sim, 100)
    end do
    call restart_solver(sim, 1e-5_wp, 600)
    call run(sim, 99)
    before = matmul(sim%scene%bodies%velocity(1:3, :n), sim%scene%bodies%mass(:n))
    call run(sim, 1)
    floor = force_in_space(sim, n + 1)
    before = (matmul(sim%scene%bodies%velocity(1:3, :n), sim%scene%bodies%mass(:n)) - before)/h
    call t%near(maxval(abs(floor + before + [0.0_wp, 0.0_wp, weight])), 0.0_wp, 1e-9_wp*weight, name//': balance of momentum')
    ! A few grains still rattle.
    call t%near(floor(3)/weight, -1.0_wp, 1e-2_wp, name//': the floor carries the weight')
    call t%check(stirring(sim, n) < 1e-2_wp*sqrt(g*radius), name//': at rest')
  end subroutine settle

  !> Root of the mean square of the grains' speeds beside that of all [m/s]: a periodic pack on a floor without friction keeps
  !! its horizontal momentum.
  pure real(wp) function stirring(sim, n)
    type(simulation_t), intent(in) :: sim
    integer, intent(in) :: n
    real(wp) :: drift(2)

    associate (velocity => sim%scene%bodies%velocity(:, :n), mass => sim%scene%bodies%mass(:n))
      drift = matmul(velocity(1:2, :), mass)/sum(mass)
      stirring = sqrt((sum((velocity(1:2, :) - spread(drift, 2, n))**2) + sum(velocity(3, :)**2))/real(n, wp))
    end associate
  end function stirring

  !> Tolerance and most sweeps from now on.
  subroutine restart_solver(sim, tolerance, sweeps)
    use sg_choose_solver, only: choose_solver
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: tolerance
    integer, intent(in) :: sweeps

    sim%options%solver%tolerance = tolerance
    sim%options%solver%maximum_sweeps = sweeps
    sim%options%solver%check_every = 10
    deallocate (sim%solver)
    call choose_solver(sim%options%solver, sim%solver)
  end subroutine restart_solver

  !> Compactness between two heights in the bulk, contacts that press for each sphere there that has some, deepest overlap.
  subroutine bulk(sim, n, solid, coordination, deepest)
    type(simulation_t), intent(in) :: sim
    integer, intent(in) :: n
    real(wp), intent(out) :: solid, coordination, deepest
    real(wp) :: low, high, weight
    integer :: presses(n), b, k, i, counted

    low = 4*radius
    high = maxval(sim%scene%bodies%position(3, :n)) - 5*radius
    solid = 0
    do b = 1, n
      associate (z => sim%scene%bodies%position(3, b))
        solid = solid + volume_below(high - z) - volume_below(low - z)
      end associate
    end do
    solid = solid/(period**2*(high - low))
    weight = density*4*pi*radius**3/3*g*sim%options%time_step
    presses = 0
    do k = 1, sim%contacts%n
      if (normal_impulse(sim%contacts, k) <= 1e-3_wp*weight) cycle
      do i = 1, 2
        b = sim%contacts%body(i, k)
        if (b <= n) presses(b) = presses(b) + 1
      end do
    end do
    counted = 0
    coordination = 0
    do b = 1, n
      ! Fewer than three contacts hold nothing: it rattles.
      if (presses(b) < 3 .or. sim%scene%bodies%position(3, b) < low .or. sim%scene%bodies%position(3, b) > high) cycle
      counted = counted + 1
      coordination = coordination + real(presses(b), wp)
    end do
    coordination = coordination/real(max(1, counted), wp)
    deepest = -minval(sim%contacts%gap(:sim%contacts%n))
  end subroutine bulk

  !> Volume of a sphere below a height above its centre [m3].
  pure real(wp) function volume_below(height) result(volume)
    real(wp), intent(in) :: height
    real(wp) :: z

    z = max(-radius, min(radius, height))
    volume = pi*(radius**2*(z + radius) - (z**3 + radius**3)/3)
  end function volume_below

  !> Random polyhedra rain into a periodic cell and settle.
  subroutine test_polyhedra()
    integer, parameter :: n = 200
    type(simulation_t), pointer :: sim
    type(random_t) :: random
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error
    integer :: b, steps

    sim => fresh()
    steps = 1400
    call random%seed(42)
    call begin_space_scene(sim%scene, n + 1, 0.4_wp, 0.02_wp)
    sim%scene%period = period
    sim%scene%period_y = period
    do b = 1, n
      call random_polyhedron(8 + modulo(b, 9), radius*[1.0_wp, 0.9_wp, 0.8_wp], random, shape, error)
      ! A build without hulls makes do with boxes, of which the last ones rock for a while.
      if (allocated(error)) then
        deallocate (error)
        steps = 2600
        call box_polyhedron(radius*[0.6_wp, 0.5_wp, 0.7_wp], shape, error)
        if (allocated(error)) error stop 'a box that is none'
      end if
      call put_shape(sim%scene, b, shape, place_of(b, 1.2_wp, 5, random))
      call turn_at_random(sim%scene, b, random)
    end do
    call settle(sim, n, steps, 'polyhedra')
    call t%check(-minval(sim%contacts%gap(:sim%contacts%n)) < 0.05_wp*radius, 'polyhedra: no deep overlap')
    write (*, '(a,es9.2)') 'polyhedra: deepest overlap', -minval(sim%contacts%gap(:sim%contacts%n))
  end subroutine test_polyhedra
end program test_packing_in_space
