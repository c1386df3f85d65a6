!> A free body of three different moments: energy and angular momentum are kept, the orientation stays orthonormal, the
!! middle axis flips, and the angle converges to Euler's solution at second order.
program test_rotation
  use harness, only: tests_t
  use sg_bodies, only: bodies_t
  use sg_kinds, only: wp
  use sg_motion, only: predict, update
  use sg_rotations, only: frame_of, turned_by
  use sg_scene, only: scene_t
  implicit none
  type(tests_t) :: t

  call test_flip()
  call test_order()
  call test_symmetric_top()
  call test_many_steps()
  call t%finish()

contains

  !> One free body without gravity.
  subroutine begin(scene, principal, spin)
    type(scene_t), intent(out) :: scene
    real(wp), intent(in) :: principal(3), spin(3)

    scene%dimension = 3
    scene%contactors%dimension = 3
    call scene%bodies%allocate(1, 3)
    allocate (scene%drives(0), scene%pressures(0))
    scene%bodies%mass = 1
    scene%bodies%principal(:, 1) = principal
    scene%bodies%inverse_mass(:, 1) = [1.0_wp, 1.0_wp, 1.0_wp, 1/principal(1), 1/principal(2), 1/principal(3)]
    scene%bodies%velocity(4:6, 1) = spin
  end subroutine begin

  !> A time step of a free body.
  subroutine move(scene, h)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: h

    call predict(scene, 0.0_wp, h, 0.5_wp)
    call update(scene%bodies, h, 0.5_wp)
  end subroutine move

  !> Rotational energy [J].
  real(wp) function energy(bodies)
    type(bodies_t), intent(in) :: bodies

    energy = sum(bodies%principal(:, 1)*bodies%velocity(4:6, 1)**2)/2
  end function energy

  !> Angular momentum in the world [kg m2/s].
  function angular_momentum(bodies) result(l)
    type(bodies_t), intent(in) :: bodies
    real(wp) :: l(3)

    l = turned_by(bodies%orientation(:, 1), bodies%principal(:, 1)*bodies%velocity(4:6, 1))
  end function angular_momentum

  !> Spun about the axis of the middle moment, with a touch of the others, it turns over again and again.
  subroutine test_flip()
    type(scene_t) :: scene
    real(wp) :: start, momentum(3), drift(2), lowest
    integer :: i, flips
    logical :: was_up

    call begin(scene, [1.0_wp, 2.0_wp, 3.0_wp], [1e-3_wp, 5.0_wp, 1e-3_wp])
    start = energy(scene%bodies)
    momentum = angular_momentum(scene%bodies)
    drift = 0
    lowest = 1
    flips = 0
    was_up = .true.
    do i = 1, 20000
      call move(scene, 1e-3_wp)
      drift(1) = max(drift(1), abs(energy(scene%bodies) - start)/start)
      drift(2) = max(drift(2), norm2(angular_momentum(scene%bodies) - momentum)/norm2(momentum))
      associate (spin => scene%bodies%velocity(5, 1))
        lowest = min(lowest, spin/5)
        if ((spin > 0) .neqv. was_up) flips = flips + 1
        was_up = spin > 0
      end associate
    end do
    ! Each of 20,000 steps rounds a few times; the errors add up like a random walk or, at worst, straight.
    call t%near(drift(1), 0.0_wp, 20000*8*epsilon(1.0_wp), 'free rotation keeps its energy')
    call t%near(drift(2), 0.0_wp, 20000*8*epsilon(1.0_wp), 'free rotation keeps its angular momentum')
    call t%check(flips >= 3, 'the axis of the middle moment flips')
    call t%near(lowest, -1.0_wp, 1e-3_wp, 'it turns over wholly')
    call begin(scene, [1.0_wp, 2.0_wp, 3.0_wp], [1e-3_wp, 1e-3_wp, 5.0_wp])
    do i = 1, 20000
      call move(scene, 1e-3_wp)
    end do
    call t%near(scene%bodies%velocity(6, 1), 5.0_wp, 1e-4_wp, 'the axis of the largest moment does not')
  end subroutine test_flip

  !> Half the step, a quarter of the error.
  subroutine test_order()
    real(wp) :: fine(3), error(2)
    integer :: level

    fine = spin_after(0.02_wp/64)
    do level = 1, 2
      error(level) = norm2(spin_after(merge(0.02_wp, 0.01_wp, level == 1)) - fine)
    end do
    ! 4 for order two; terms of higher order are h |w| = 5 % of it.
    call t%near(error(1)/error(2), 4.0_wp, 0.3_wp, 'free rotation is of order two')
  end subroutine test_order

  !> Spin of a tumbling body after two seconds.
  function spin_after(h) result(spin)
    real(wp), intent(in) :: h
    real(wp) :: spin(3)
    type(scene_t) :: scene
    integer :: i

    call begin(scene, [1.0_wp, 2.0_wp, 3.5_wp], [1.0_wp, 2.0_wp, 0.5_wp])
    do i = 1, nint(2/h)
      call move(scene, h)
    end do
    spin = scene%bodies%velocity(4:6, 1)
  end function spin_after

  !> A symmetric top precesses about its axis at (I3 - I1)/I1 w3.
  subroutine test_symmetric_top()
    type(scene_t) :: scene
    real(wp) :: angle
    integer :: i

    call begin(scene, [2.0_wp, 2.0_wp, 3.0_wp], [1.0_wp, 0.0_wp, 4.0_wp])
    do i = 1, 1000
      call move(scene, 1e-3_wp)
    end do
    angle = atan2(scene%bodies%velocity(5, 1), scene%bodies%velocity(4, 1))
    ! Precession by 2 rad in a second; the error of order two is about (h w)^2 of it.
    call t%near(angle, 2.0_wp, 1e-4_wp, 'a symmetric top precesses')
  end subroutine test_symmetric_top

  !> A million steps of fast spin leave the frame orthonormal to rounding.
  subroutine test_many_steps()
    type(scene_t) :: scene
    real(wp) :: frame(3, 3), unit(3, 3), start
    integer :: i

    call begin(scene, [1.0_wp, 1.5_wp, 2.2_wp], [20.0_wp, -30.0_wp, 10.0_wp])
    start = energy(scene%bodies)
    do i = 1, 1000000
      call move(scene, 1e-2_wp)
    end do
    frame = frame_of(scene%bodies%orientation(:, 1))
    unit = matmul(transpose(frame), frame)
    do i = 1, 3
      unit(i, i) = unit(i, i) - 1
    end do
    call t%near(maxval(abs(unit)), 0.0_wp, 16*epsilon(1.0_wp), 'after 10^6 steps the frame is orthonormal')
    call t%near(energy(scene%bodies)/start, 1.0_wp, 1e6_wp*8*epsilon(1.0_wp), 'after 10^6 steps of 0.37 rad the energy is kept')
  end subroutine test_many_steps
end program test_rotation
