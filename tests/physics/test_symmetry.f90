!> A scene that is its own mirror image stays so, although sweeps take its contacts in an order that is not.
!!
!! The mirror is the plane x = 0. What breaks the symmetry is what the solver leaves undone in a step, grown by impacts.
!! The runs end before grains wedge: then frictional steps have many solutions, and corners choose their side by rounding.
program test_symmetry
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, put_disk, put_polygon, put_wall, run
  use sg_kinds, only: wp
  use sg_random, only: random_t
  use sg_simulation, only: simulation_t
  implicit none
  integer, parameter :: columns = 5, rows = 6, n = columns*rows
  real(wp), parameter :: tolerance = 1e-12_wp
  ! The solver's 10^-12 grows to some 10^-11 over the impacts of 0.3 s, measured.
  real(wp), parameter :: allowed = 1e-9_wp
  type(tests_t) :: t

  call test_collapse('disks without friction', friction=0.0_wp, with_polygons=.false.)
  call test_collapse('disks', friction=0.4_wp, with_polygons=.false.)
  call test_collapse('polygons without friction', friction=0.0_wp, with_polygons=.true.)
  call test_collapse('polygons', friction=0.4_wp, with_polygons=.true.)
  call t%finish()

contains

  !> Two heaps, one the image of the other, fall onto a floor and against each other.
  subroutine test_collapse(name, friction, with_polygons)
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: friction
    logical, intent(in) :: with_polygons
    type(simulation_t), pointer :: sim
    type(random_t) :: random
    real(wp) :: place(2), radius, worst, moved
    integer :: b

    sim => fresh()
    call random%seed(6)
    call begin_scene(sim%scene, 2*n + 1, friction, 0.05_wp)
    do b = 1, n
      place = [real(modulo(b - 1, columns), wp) + 0.55_wp, real((b - 1)/columns, wp) + 0.52_wp]
      radius = random%uniform(0.4_wp, 0.5_wp)
      call put_grain(sim, b, radius, place, 1.0_wp, with_polygons .and. modulo(b, 2) == 0)
      call put_grain(sim, n + b, radius, place, -1.0_wp, with_polygons .and. modulo(b, 2) == 0)
      sim%scene%bodies%velocity(1:2, b) = [-1.0_wp, random%uniform(-1.0_wp, 1.0_wp)]
      sim%scene%bodies%velocity(1:2, n + b) = [-1.0_wp, 1.0_wp]*sim%scene%bodies%velocity(1:2, b)
    end do
    call put_wall(sim%scene, 2*n + 1, 50.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    call begin_run(sim, 2e-3_wp, tolerance)
    call run(sim, 150)
    worst = 0
    moved = 0
    associate (bodies => sim%scene%bodies)
      do b = 1, n
        worst = max(worst, abs(bodies%position(1, b) + bodies%position(1, n + b)), &
                    abs(bodies%position(2, b) - bodies%position(2, n + b)))
        if (allocated(bodies%angle)) worst = max(worst, abs(bodies%angle(b) + bodies%angle(n + b)))
        moved = max(moved, hypot(bodies%velocity(1, b), bodies%velocity(2, b)))
      end do
    end associate
    call t%check(sim%contacts%n > n/2, name//': there are contacts')
    call t%check(moved > 0.1_wp, name//': grains move')
    call t%near(worst, 0.0_wp, allowed, name//': mirror images')
  end subroutine test_collapse

  !> A disk, or a square that stands on its side, at a place or its mirror image.
  subroutine put_grain(sim, body, radius, place, side, is_polygon)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: body
    real(wp), intent(in) :: radius, place(2), side
    logical, intent(in) :: is_polygon
    real(wp) :: corners(2, 4), centre(2)

    centre = [side, 1.0_wp]*place
    if (is_polygon) then
      corners = 0.9_wp*radius*reshape([0.9_wp, 0.1_wp, -0.1_wp, 1.0_wp, -0.9_wp, -0.1_wp, 0.1_wp, -1.0_wp], [2, 4])
      if (side < 0) then
        ! The image of a counter-clockwise polygon runs clockwise.
        corners(1, :) = -corners(1, :)
        corners = corners(:, 4:1:-1)
      end if
      call put_polygon(sim%scene, body, corners + spread(centre, 2, 4))
    else
      call put_disk(sim%scene, body, radius, centre)
    end if
  end subroutine put_grain
end program test_symmetry
