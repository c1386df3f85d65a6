!> An arch of 27 voussoirs in space stands when it is thicker than its limit and falls when it is thinner; a wall of bricks
!! stands, and its courses carry what lies above.
!!
!! The arch is that of the plane drawn out along y: its limit is t/R = 0.10672 for straight-sided voussoirs (see test_arch).
program test_masonry_in_space
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, g, hold, run
  use scenes_space, only: begin_space_scene, force_in_space, put_box, put_plane, put_shape
  use sg_error, only: error_t
  use sg_kinds, only: wp, pi
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_build, only: polyhedron_from_faces
  use sg_simulation, only: simulation_t
  implicit none
  integer, parameter :: voussoirs = 27, crown = 14
  real(wp), parameter :: limit = 0.10672_wp, step = 4e-3_wp
  ! The fall feeds on itself: after 1.5 s the thinner arch has fallen deep. The thicker one sinks by what the solver's
  ! tolerance leaves in its joints.
  real(wp), parameter :: stands = 2e-3_wp, falls = 0.1_wp
  type(tests_t) :: t

  call t%check(sag(1.005_wp*limit) < stands, 'an arch 0.5 % above the limit stands')
  call t%check(sag(0.995_wp*limit) > falls, 'an arch 0.5 % below the limit falls')
  call test_wall()
  call t%finish()

contains

  !> How far the crown of an arch of mean radius 1 m sinks in 1.5 s, or until it has fallen [m].
  real(wp) function sag(thickness)
    real(wp), intent(in) :: thickness !! [m]
    type(simulation_t), pointer :: sim
    real(wp) :: height
    integer :: i

    sim => fresh()
    call build(sim, thickness)
    call begin_run(sim, step, 1e-5_wp)
    height = sim%scene%bodies%position(3, crown)
    do i = 1, nint(1.5_wp/step)
      call run(sim, 1)
      sag = height - sim%scene%bodies%position(3, crown)
      ! What has sunk this far falls on, and its impacts would take most of the CPU time.
      if (sag > falls) exit
    end do
    write (*, '(a,f8.5,a,es10.2)') 'arch t/R', thickness, ': sag', sag
  end function sag

  !> Voussoirs from right to left, and a fixed block under either springing.
  subroutine build(sim, thickness)
    type(simulation_t), intent(inout) :: sim
    real(wp), intent(in) :: thickness
    integer :: b, side

    call begin_space_scene(sim%scene, voussoirs + 2, friction=0.8_wp, alert=2e-3_wp)
    do b = 1, voussoirs
      call put_voussoir(sim, b, 1 - thickness/2, 1 + thickness/2, pi*real(b - 1, wp)/voussoirs, pi*real(b, wp)/voussoirs)
    end do
    do side = 1, 2
      b = voussoirs + side
      call put_box(sim%scene, b, [0.2_wp, 0.2_wp, 0.1_wp], [real(3 - 2*side, wp), 0.0_wp, -0.1_wp])
      call hold(sim%scene, b)
    end do
  end subroutine build

  !> A voussoir between two angles, 0.1 m deep.
  subroutine put_voussoir(sim, body, inner, outer, first, last)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: body
    real(wp), intent(in) :: inner, outer, first, last
    integer, parameter :: first_corner(7) = [1, 5, 9, 13, 17, 21, 25]
    integer, parameter :: corner(24) = [1, 2, 3, 4, 8, 7, 6, 5, 1, 5, 6, 2, 2, 6, 7, 3, 3, 7, 8, 4, 4, 8, 5, 1]
    real(wp) :: corners(3, 8), centre(3)
    type(polyhedron_t) :: shape
    type(error_t), allocatable :: error

    corners(:, 1) = inner*[cos(first), 0.0_wp, sin(first)]
    corners(:, 2) = outer*[cos(first), 0.0_wp, sin(first)]
    corners(:, 3) = outer*[cos(last), 0.0_wp, sin(last)]
    corners(:, 4) = inner*[cos(last), 0.0_wp, sin(last)]
    corners(:, 5:8) = corners(:, 1:4)
    corners(2, 1:4) = -0.05_wp
    corners(2, 5:8) = 0.05_wp
    centre = sum(corners, 2)/8
    corners = corners - spread(centre, 2, 8)
    call polyhedron_from_faces(corners, first_corner, corner, shape, error, may_turn=.true.)
    if (allocated(error)) then
      write (*, '(a)') error%message
      error stop 1
    end if
    call put_shape(sim%scene, body, shape, centre)
  end subroutine put_voussoir

  !> A running-bond wall, 6 courses of 4 bricks and halves: it stands, and every course carries what lies above.
  subroutine test_wall()
    integer, parameter :: courses = 6, row = 4
    real(wp), parameter :: half(3) = [0.1_wp, 0.05_wp, 0.03_wp]
    type(simulation_t), pointer :: sim
    real(wp) :: weight, force(3), place(3), start
    integer :: b, c, i, n

    sim => fresh()
    n = 0
    do c = 1, courses
      n = n + row + merge(1, 0, modulo(c, 2) == 0)
    end do
    call begin_space_scene(sim%scene, n + 1, 0.6_wp, 2e-3_wp)
    b = 0
    do c = 1, courses
      do i = 1, row + merge(1, 0, modulo(c, 2) == 0)
        b = b + 1
        place = [2*half(1)*real(i, wp), 0.0_wp, half(3)*real(2*c - 1, wp)]
        if (modulo(c, 2) == 1) then
          call put_box(sim%scene, b, half, place + [half(1), 0.0_wp, 0.0_wp])
        else if (i == 1) then
          call put_box(sim%scene, b, half*[0.5_wp, 1.0_wp, 1.0_wp], place + [half(1)/2, 0.0_wp, 0.0_wp])
        else if (i == row + 1) then
          call put_box(sim%scene, b, half*[0.5_wp, 1.0_wp, 1.0_wp], place - [half(1)/2, 0.0_wp, 0.0_wp])
        else
          call put_box(sim%scene, b, half, place)
        end if
      end do
    end do
    call put_plane(sim%scene, n + 1, [5.0_wp, 5.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    call begin_run(sim, 2e-3_wp, 1e-6_wp)
    start = sum(sim%scene%bodies%position(3, :n))
    call run(sim, 500)
    weight = g*sum(sim%scene%bodies%mass(:n))
    force = force_in_space(sim, n + 1)
    call t%near(force(3), -weight, 1e-4_wp*weight, 'wall: the floor carries it')
    call t%near(sum(sim%scene%bodies%position(3, :n)) - start, 0.0_wp, 1e-4_wp, 'wall: does not sink')
    call t%near(maxval(abs(sim%scene%bodies%velocity(1:3, :n))), 0.0_wp, 1e-4_wp, 'wall: at rest')
    call t%check(sim%contacts%n >= 4*n, 'wall: bricks lie on four corners or more')
  end subroutine test_wall
end program test_masonry_in_space
