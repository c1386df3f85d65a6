!> Faces that are shrunk: a cube on a slope overturns where the weight leaves the part of its face that carries.
!!
!! A cube of half side a whose contact points are moved by a share s to the middle stands on a slope of tangent below 1 - s.
program test_shrunk_faces
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, g, hold, put_polygon, run
  use scenes_space, only: begin_space_scene, put_box
  use sg_kinds, only: wp
  use sg_shrink_face, only: shrink_face
  use sg_simulation, only: simulation_t
  implicit none
  real(wp), parameter :: shares(3) = [0.0_wp, 0.3_wp, 0.8_wp]
  integer, parameter :: steps = 20
  real(wp), parameter :: step = 1e-3_wp
  type(tests_t) :: t

  call test_by_hand()
  call test_overturning(2)
  call test_overturning(3)
  call t%finish()

contains

  !> Points and gaps of one pair; points with different normals stay.
  subroutine test_by_hand()
    real(wp) :: normal(2, 2), point(2, 2), gap(2)

    normal = reshape([0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 2])
    point = reshape([-1.0_wp, 0.0_wp, 3.0_wp, 0.0_wp], [2, 2])
    gap = [0.1_wp, 0.5_wp]
    call shrink_face(2, normal, point, gap, 0.25_wp)
    call t%near(maxval(abs(point(1, :) - [-0.5_wp, 2.5_wp])), 0.0_wp, 1e-15_wp, 'points moved by a quarter of the way')
    call t%near(maxval(abs(gap - [0.15_wp, 0.45_wp])), 0.0_wp, 1e-15_wp, 'gaps between them')
    normal(:, 2) = [0.6_wp, 0.8_wp]
    call shrink_face(2, normal, point, gap, 0.25_wp)
    call t%near(point(1, 1), -0.5_wp, 1e-15_wp, 'points of two faces stay')
    call shrink_face(1, normal, point, gap, 1.0_wp)
    call t%near(point(1, 1), -0.5_wp, 1e-15_wp, 'a point alone stays')
  end subroutine test_by_hand

  !> Just below the slope at which it overturns a cube rests, to the tolerance of the solver; just above it turns about the
  !! outermost points, with the spin of a rigid body about an axis: torque over moment, times time.
  subroutine test_overturning(dimension)
    integer, intent(in) :: dimension
    real(wp), parameter :: half = 0.5_wp
    integer :: i
    real(wp) :: arm, slope, expected

    do i = 1, size(shares)
      arm = half*(1 - shares(i))
      slope = 0.95_wp*arm/half
      call t%near(spin_of_cube(dimension, shares(i), slope), 0.0_wp, 1e-6_wp, 'a cube rests below its slope')
      slope = 1.05_wp*arm/half
      expected = g*(slope*half - arm)/(1/6.0_wp + half**2 + arm**2)*real(steps, wp)*step
      ! The cube turns by less than 1e-4 rad in this time.
      call t%near(spin_of_cube(dimension, shares(i), slope), expected, 1e-2_wp*expected, 'a cube overturns above its slope')
    end do
  end subroutine test_overturning

  !> Spin of a cube of side 1 m after some steps on a slope [rad/s].
  real(wp) function spin_of_cube(dimension, share, slope) result(spin)
    integer, intent(in) :: dimension
    real(wp), intent(in) :: share, slope
    real(wp), parameter :: square(2, 4) = &
                           reshape([-0.5_wp, -0.5_wp, 0.5_wp, -0.5_wp, 0.5_wp, 0.5_wp, -0.5_wp, 0.5_wp], [2, 4])
    type(simulation_t), pointer :: sim

    sim => fresh()
    if (dimension == 2) then
      call begin_scene(sim%scene, 2, 3.0_wp, 0.01_wp)
      call put_polygon(sim%scene, 1, square*2 + spread([0.0_wp, -1.0_wp], 2, 4))
      call put_polygon(sim%scene, 2, square + spread([0.0_wp, 0.5_wp], 2, 4))
    else
      call begin_space_scene(sim%scene, 2, 3.0_wp, 0.01_wp)
      call put_box(sim%scene, 1, [1.0_wp, 1.0_wp, 1.0_wp], [0.0_wp, 0.0_wp, -1.0_wp])
      call put_box(sim%scene, 2, [0.5_wp, 0.5_wp, 0.5_wp], [0.0_wp, 0.0_wp, 0.5_wp])
    end if
    call hold(sim%scene, 1)
    sim%scene%gravity(1) = slope*g
    sim%scene%shrink = share
    call begin_run(sim, step, 1e-8_wp)
    call run(sim, steps)
    spin = norm2(sim%scene%bodies%velocity(dimension + 1:, 2))
  end function spin_of_cube
end program test_shrunk_faces
