!> Bonds at tilts of rounding size: they hold what they should, whichever edges and corners the detection names.
program test_bonds
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use polyhedra, only: prism_polyhedron
  use scenes, only: begin_run, begin_scene, density, hold, put_polygon, run
  use scenes_space, only: begin_space_scene, put_box, put_plane, put_shape
  use sg_contactors, only: add_segment
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_laws, only: law_mohr, status_bonded
  use sg_polyhedron, only: polyhedron_t
  use sg_random, only: random_t
  use sg_rotations, only: quaternion_product, rotation_by, turned_by
  use sg_simulation, only: simulation_t
  implicit none
  real(wp), parameter :: h = 1e-3_wp, cohesion = 500
  !> Speed of a body that bonds hold [m/s]: the solver at 1e-10, and overlaps of the tilts below over a step
  real(wp), parameter :: still = 1e-5_wp
  type(tests_t) :: t

  call test_segment()
  call test_prism(on_plane=.true.)
  call test_prism(on_plane=.false.)
  call t%finish()

contains

  !> A free rounded segment lies on a longer face, bonded, without a load and with a pull of a third of its strength: its tilt
  !! changes sign from step to step.
  subroutine test_segment()
    real(wp), parameter :: half = 0.5_wp, radius = 0.05_wp
    real(wp), parameter :: tilts(7) = [0.0_wp, 1e-16_wp, -1e-16_wp, 1e-13_wp, -1e-13_wp, 1e-9_wp, -1e-9_wp]
    type(simulation_t), pointer :: sim
    integer :: i, j, step

    do i = 1, size(tilts)
      do j = 0, 1
        sim => fresh()
        call begin_scene(sim%scene, 2, 0.3_wp, 0.01_wp)
        call add_segment(sim%scene%contactors, 1, 1, half, radius, [0.0_wp, 0.0_wp], 0.0_wp)
        associate (bodies => sim%scene%bodies)
          bodies%position(:, 1) = [0.0_wp, radius]
          bodies%angle(1) = tilts(i)
          bodies%area(1) = 4*half*radius
          bodies%mass(1) = density*bodies%area(1)
          bodies%inertia(1) = bodies%mass(1)*half**2/3
          bodies%inverse_mass(:, 1) = 1/[bodies%mass(1), bodies%mass(1), bodies%inertia(1)]
        end associate
        call put_polygon(sim%scene, 2, reshape([-2.0_wp, -1.0_wp, 2.0_wp, -1.0_wp, 2.0_wp, 0.0_wp, -2.0_wp, 0.0_wp], [2, 4]))
        call hold(sim%scene, 2)
        sim%scene%laws(1)%kind = law_mohr
        sim%scene%laws(1)%normal_cohesion = cohesion
        sim%scene%gravity = 0
        sim%scene%gravity(2) = 2*cohesion/3*real(j, wp)/sim%scene%bodies%mass(1)
        call begin_run(sim, h, 1e-10_wp)
        do step = 1, 40
          ! Rocked by hand: next to nothing, to either side.
          sim%scene%bodies%angle(1) = tilts(i)*real(1 - 2*modulo(step, 2), wp)
          call run(sim, 1)
        end do
        call check_held(sim, 2, 'segment')
      end do
    end do
  end subroutine test_segment

  !> A hexagonal prism hangs by four of its six corners, and is rocked so that others are chosen: its bonds are handed on.
  subroutine test_prism(on_plane)
    logical, intent(in) :: on_plane
    type(simulation_t), pointer :: sim
    type(polyhedron_t) :: prism
    type(error_t), allocatable :: error
    type(random_t) :: random
    real(wp) :: axis(3), upright(4), q(4), up(3), tilt
    integer :: step, trial, c, changes
    integer, allocatable :: names(:)

    call random%seed(6)
    changes = 0
    do trial = 1, 6
      call prism_polyhedron(6, 0.5_wp, 0.3_wp, prism, error)
      if (allocated(error)) error stop 'a prism that is none'
      sim => fresh()
      q = rotation_by([random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)])
      up = turned_by(q, [0.0_wp, 0.0_wp, 1.0_wp])
      call begin_space_scene(sim%scene, 2, 0.3_wp, 0.01_wp)
      call put_shape(sim%scene, 1, prism, 0.3_wp*up, q)
      if (on_plane) call put_plane(sim%scene, 2, [2.0_wp, 2.0_wp, 0.1_wp], -0.1_wp*up, q)
      if (.not. on_plane) call put_box(sim%scene, 2, [2.0_wp, 2.0_wp, 0.1_wp], -0.1_wp*up, q)
      if (.not. on_plane) call hold(sim%scene, 2)
      sim%scene%laws(1)%kind = law_mohr
      sim%scene%laws(1)%normal_cohesion = cohesion
      sim%scene%gravity = 4*cohesion/3/sim%scene%bodies%mass(1)*up
      call begin_run(sim, h, 1e-10_wp, maximum_sweeps=5000)
      upright = sim%scene%bodies%orientation(:, 1)
      allocate (names(0))
      do step = 1, 40
        tilt = 1e-9_wp*random%uniform()
        axis = [(random%normal(), c=1, 3)]
        sim%scene%bodies%orientation(:, 1) = quaternion_product(rotation_by(tilt*axis/norm2(axis)), upright)
        call run(sim, 1)
        if (size(names) == 4 .and. sim%contacts%n == 4) then
          if (any([(all(names /= int(sim%contacts%feature(c))), c=1, 4)])) changes = changes + 1
        end if
        names = int(sim%contacts%feature(:sim%contacts%n))
      end do
      deallocate (names)
      call check_held(sim, 4, 'prism')
    end do
    call t%check(changes > 50, 'prism: other corners are chosen')
  end subroutine test_prism

  !> Is a body still held by all of its bonds?
  subroutine check_held(sim, bonds, name)
    type(simulation_t), intent(in) :: sim
    integer, intent(in) :: bonds
    character(len=*), intent(in) :: name

    call t%equal(count(sim%contacts%status(:sim%contacts%n) == status_bonded), bonds, name//': bonds')
    call t%near(maxval(abs(sim%scene%bodies%velocity(:, 1))), 0.0_wp, still, name//': held')
  end subroutine check_held
end program test_bonds
