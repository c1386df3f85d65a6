!> Mohr-Coulomb bonds whose cohesions are stresses: what they hold is the stress times the surface of the contact, for every pair of
!! shapes whose surface follows from their sizes; shear holds up to the tangential stress. The same with cohesions that are forces.
program test_bond_stress
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, hold, put_disk, put_polygon, put_wall, run
  use scenes_space, only: begin_space_scene, put_box, put_plane, put_sphere
  use sg_kinds, only: wp, pi
  use sg_laws, only: law_mohr, status_bonded
  use sg_simulation, only: simulation_t
  implicit none
  real(wp), parameter :: stress = 1e4_wp, shear = 3e3_wp
  ! Half sides of squares and boxes.
  real(wp), parameter :: half = 0.4_wp
  type(tests_t) :: t

  call test_pair('disks', 2, 0.5_wp*0.3_wp/0.8_wp)
  call test_pair('disk and wall', 2, 0.5_wp)
  call test_pair('squares', 2, 2*half)
  call test_pair('spheres', 3, pi*(0.5_wp*0.3_wp/0.8_wp)**2)
  call test_pair('sphere and plane', 3, pi*0.5_wp**2)
  call test_pair('boxes', 3, 4*half**2)
  call test_pair('disk and wall', 2)
  call test_pair('sphere and plane', 3)
  call t%finish()

contains

  !> A body of 1 kg on another one that is held.
  subroutine make(name, dimension, is_stress, sim)
    character(len=*), intent(in) :: name
    integer, intent(in) :: dimension
    logical, intent(in) :: is_stress !! else the same numbers are forces
    type(simulation_t), pointer, intent(out) :: sim
    real(wp), parameter :: square(2, 4) = half*reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])

    sim => fresh()
    if (dimension == 2) call begin_scene(sim%scene, 2, 0.0_wp, 0.05_wp)
    if (dimension == 3) call begin_space_scene(sim%scene, 2, 0.0_wp, 0.05_wp)
    select case (name)
    case ('disks')
      call put_disk(sim%scene, 1, 0.5_wp, [0.0_wp, 0.5_wp])
      call put_disk(sim%scene, 2, 0.3_wp, [0.0_wp, -0.3_wp])
      call hold(sim%scene, 2)
    case ('disk and wall')
      call put_disk(sim%scene, 1, 0.5_wp, [0.0_wp, 0.5_wp])
      call put_wall(sim%scene, 2, 3.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    case ('squares')
      call put_polygon(sim%scene, 1, square + spread([0.0_wp, half], 2, 4))
      call put_polygon(sim%scene, 2, square - spread([0.0_wp, half], 2, 4))
      call hold(sim%scene, 2)
    case ('spheres')
      call put_sphere(sim%scene, 1, 0.5_wp, [0.0_wp, 0.0_wp, 0.5_wp])
      call put_sphere(sim%scene, 2, 0.3_wp, [0.0_wp, 0.0_wp, -0.3_wp])
      call hold(sim%scene, 2)
    case ('sphere and plane')
      call put_sphere(sim%scene, 1, 0.5_wp, [0.0_wp, 0.0_wp, 0.5_wp])
      call put_plane(sim%scene, 2, [3.0_wp, 3.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    case ('boxes')
      call put_box(sim%scene, 1, [half, half, half], [0.0_wp, 0.0_wp, half])
      call put_box(sim%scene, 2, [half, half, half], [0.0_wp, 0.0_wp, -half])
      call hold(sim%scene, 2)
    end select
    ! No weight turns a body that is as heavy to turn as this.
    sim%scene%bodies%mass(1) = 1
    sim%scene%bodies%inverse_mass(:, 1) = [spread(1.0_wp, 1, dimension), spread(1e-9_wp, 1, 2*dimension - 3)]
    sim%scene%laws(1)%kind = law_mohr
    if (is_stress) then
      sim%scene%laws(1)%normal_strength = stress
      sim%scene%laws(1)%tangential_strength = shear
    else
      sim%scene%laws(1)%normal_cohesion = stress
      sim%scene%laws(1)%tangential_cohesion = shear
    end if
    call begin_run(sim, 1e-3_wp, 1e-10_wp, maximum_sweeps=5000)
  end subroutine make

  !> Pulls and shears one percent below and above what the bond holds.
  subroutine test_pair(name, dimension, surface)
    character(len=*), intent(in) :: name
    integer, intent(in) :: dimension
    real(wp), intent(in), optional :: surface !! of the contact; absent where cohesions are forces
    type(simulation_t), pointer :: sim
    real(wp) :: load, factor
    integer :: i, component

    factor = 1
    if (present(surface)) factor = surface
    do i = 1, 4
      call make(name, dimension, present(surface), sim)
      component = merge(dimension, 1, i <= 2)
      load = factor*merge(stress, shear, i <= 2)*merge(0.99_wp, 1.01_wp, modulo(i, 2) == 1)
      sim%scene%gravity = 0
      sim%scene%gravity(component) = load
      call run(sim, 20)
      if (modulo(i, 2) == 1) then
        call t%check(all(sim%contacts%status(:sim%contacts%n) == status_bonded) .and. sim%contacts%n > 0, name//': it holds')
        call t%near(sim%scene%bodies%velocity(component, 1), 0.0_wp, 1e-6_wp, name//': and rests')
      else
        call t%check(.not. any(sim%contacts%status(:sim%contacts%n) == status_bonded), name//': it breaks')
        call t%check(sim%scene%bodies%velocity(component, 1) > 0.1_wp*20e-3_wp*load, name//': and goes')
      end if
    end do
  end subroutine test_pair
end program test_bond_stress
