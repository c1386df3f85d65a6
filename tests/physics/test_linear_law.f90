!> The linear law r = -(1/epsilon) v: two bodies and a chain against closed forms, in the plane and in space, in all directions and
!! along the normal alone, with epsilon given in 1/kg and over the mean diagonal term of W.
program test_linear_law
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, put_disk, run
  use scenes_space, only: begin_space_scene, put_sphere
  use sg_kinds, only: wp, pi
  use sg_laws, only: law_linear
  use sg_simulation, only: simulation_t
  implicit none
  !> Of velocities about 1 m/s, the solver at 1e-13
  real(wp), parameter :: same = 1e-11_wp
  real(wp), parameter :: h = 1e-4_wp
  type(tests_t) :: t
  integer :: dimension, mode

  do dimension = 2, 3
    call test_pair(dimension, .true.)
    call test_pair(dimension, .false.)
    do mode = 1, 3
      call test_chain(dimension, mode, .true.)
      call test_chain(dimension, mode, .false.)
    end do
    call test_turning_pair(dimension)
  end do
  call t%finish()

contains

  !> Grains of one radius in a row along an oblique direction, just not touching, without gravity, with the linear law.
  subroutine make_row(sim, dimension, n, epsilon, relative_epsilon, is_along_normal, along)
    type(simulation_t), pointer, intent(out) :: sim
    integer, intent(in) :: dimension, n
    real(wp), intent(in) :: epsilon, relative_epsilon
    logical, intent(in) :: is_along_normal
    real(wp), intent(out) :: along(3)
    real(wp), parameter :: radius = 0.5_wp
    integer :: b

    sim => fresh()
    along = [0.6_wp, 0.8_wp, 0.0_wp]
    if (dimension == 3) along = [2.0_wp, 3.0_wp, 6.0_wp]/7
    if (dimension == 2) call begin_scene(sim%scene, n, 0.0_wp, 0.5_wp*radius)
    if (dimension == 3) call begin_space_scene(sim%scene, n, 0.0_wp, 0.5_wp*radius)
    sim%scene%gravity = 0
    associate (law => sim%scene%laws(1))
      law%kind = law_linear
      law%epsilon = epsilon
      law%relative_epsilon = relative_epsilon
      law%is_along_normal = is_along_normal
    end associate
    do b = 1, n
      if (dimension == 2) call put_disk(sim%scene, b, radius, 2.05_wp*radius*real(b, wp)*along(:2))
      if (dimension == 3) call put_sphere(sim%scene, b, radius, 2.05_wp*radius*real(b, wp)*along)
    end do
  end subroutine make_row

  !> Two grains that fly apart: the relative velocity falls by epsilon/(epsilon + W) per step. One that passes across changes
  !! nothing where the law acts along the normal, and turns both grains where it acts in all directions.
  subroutine test_pair(dimension, is_along_normal)
    integer, intent(in) :: dimension
    logical, intent(in) :: is_along_normal
    real(wp), parameter :: epsilon = 1e-3_wp, v0 = 1, across = 0.1_wp
    integer, parameter :: steps = 3
    type(simulation_t), pointer :: sim
    real(wp) :: along(3), tangent(3), w, w_tt, jump(3), spin

    call make_row(sim, dimension, 2, epsilon, 0.0_wp, is_along_normal, along)
    tangent = [-along(2), along(1), 0.0_wp]/norm2(along(:2))
    w = sum(1/sim%scene%bodies%mass)
    sim%scene%bodies%velocity(:dimension, 2) = v0*along(:dimension)
    call begin_run(sim, h, 1e-13_wp)
    call run(sim, steps)
    jump = 0
    jump(:dimension) = sim%scene%bodies%velocity(:dimension, 2) - sim%scene%bodies%velocity(:dimension, 1)
    call t%near(dot_product(jump, along), v0*(epsilon/(epsilon + w))**steps, same, 'pair: decay along the normal')
    call t%near(norm2(jump - dot_product(jump, along)*along), 0.0_wp, same, 'pair: nothing across')

    call make_row(sim, dimension, 2, epsilon, 0.0_wp, is_along_normal, along)
    sim%scene%bodies%velocity(:dimension, 2) = across*tangent(:dimension)
    call begin_run(sim, h, 1e-13_wp)
    call run(sim, 1)
    jump(:dimension) = sim%scene%bodies%velocity(:dimension, 2) - sim%scene%bodies%velocity(:dimension, 1)
    spin = 0
    if (size(sim%scene%bodies%velocity, 1) > dimension) spin = maxval(abs(sim%scene%bodies%velocity(dimension + 1:, :)))
    if (is_along_normal) then
      ! The line between the centres turns by across h over a distance of 1 m within half a step: second order.
      call t%near(dot_product(jump, tangent), across, 1e-8_wp, 'pair: velocity across stays')
      call t%near(spin, 0.0_wp, same, 'pair: nothing turns')
    else
      ! W_tt is W (1 + m r^2/I), up to the gap of a fortieth of the arms; I is m r^2/2, or 2 m r^2/5.
      w_tt = w*merge(3.0_wp, 3.5_wp, dimension == 2)
      call t%near(dot_product(jump, tangent), across*(1 - w/(w_tt + epsilon)), 0.02_wp*across, 'pair: velocity across is braked')
      call t%check(spin > 0.1_wp*across, 'pair: grains turn')
    end if
  end subroutine test_pair

  !> A free chain of n equal grains moves in its mode k, v_j = cos(k pi (j - 1/2)/n): the terms of W at its contacts are 2/m and
  !! -1/m, whose eigenvalue is (2/m)(1 - cos(k pi/n)), and the mean diagonal term is 2/m.
  subroutine test_chain(dimension, k, is_relative)
    integer, intent(in) :: dimension, k
    logical, intent(in) :: is_relative
    integer, parameter :: n = 7, steps = 4
    real(wp), parameter :: multiple = 0.3_wp
    type(simulation_t), pointer :: sim
    real(wp) :: along(3), mode(n), factor, moved(n), epsilon
    integer :: b

    call make_row(sim, dimension, n, 0.0_wp, 0.0_wp, .true., along)
    epsilon = multiple*2/sim%scene%bodies%mass(1)
    if (is_relative) then
      sim%scene%laws(1)%relative_epsilon = multiple
    else
      sim%scene%laws(1)%epsilon = epsilon
    end if
    mode = cos(real(k, wp)*pi*([(real(b, wp), b=1, n)] - 0.5_wp)/real(n, wp))
    do b = 1, n
      sim%scene%bodies%velocity(:dimension, b) = mode(b)*along(:dimension)
    end do
    call begin_run(sim, h, 1e-13_wp)
    call run(sim, steps)
    factor = multiple/(multiple + 1 - cos(real(k, wp)*pi/real(n, wp)))
    moved = matmul(along(:dimension), sim%scene%bodies%velocity(:dimension, :))
    call t%near(maxval(abs(moved - factor**steps*mode)), 0.0_wp, same, 'chain: decay of a mode')
  end subroutine test_chain

  !> Two grains that fly past each other: the normal turns from step to step, and impulses along it turn neither grain.
  subroutine test_turning_pair(dimension)
    integer, intent(in) :: dimension
    type(simulation_t), pointer :: sim
    real(wp) :: along(3), speed(3), spin

    call make_row(sim, dimension, 2, 1e-4_wp, 0.0_wp, .true., along)
    speed = 0.5_wp*along + [along(2), -along(1), 0.0_wp]
    sim%scene%bodies%velocity(:dimension, 2) = speed(:dimension)
    call begin_run(sim, 1e-2_wp, 1e-13_wp)
    call run(sim, 20)
    spin = 0
    if (size(sim%scene%bodies%velocity, 1) > dimension) spin = maxval(abs(sim%scene%bodies%velocity(dimension + 1:, :)))
    call t%near(spin, 0.0_wp, same, 'turning pair: nothing turns')
    call t%check(abs(sim%scene%bodies%velocity(1, 1)) > 0.01_wp, 'turning pair: the law acts')
  end subroutine test_turning_pair
end program test_linear_law
