!> Quaternions, frames, and principal axes of symmetric matrices.
program test_rotations
  use harness, only: tests_t
  use polyhedra, only: expect
  use sg_error, only: error_t
  use sg_kinds, only: wp, pi
  use sg_random, only: random_t
  use sg_rotations, only: frame_of, nearest_rotation, no_rotation, normalised, quaternion_of, quaternion_product, rotation_by, &
                          turned_on
  use sg_symmetric, only: largest_eigenvalue, principal_axes
  use sg_vectors, only: determinant
  implicit none
  type(tests_t) :: t
  ! A few roundings of numbers of order one.
  real(wp), parameter :: rounding = 20*epsilon(1.0_wp)

  call test_known_rotations()
  call test_random_rotations()
  call test_half_turns()
  call test_long_rotation()
  call test_nearest()
  call test_axes()
  call test_equal_values()
  call test_largest()
  call t%finish()

contains

  subroutine test_known_rotations()
    real(wp) :: frame(3, 3)

    frame = frame_of(rotation_by([0.0_wp, 0.0_wp, pi/2]))
    call t%check(maxval(abs(frame(:, 1) - [0.0_wp, 1.0_wp, 0.0_wp])) < rounding, 'a quarter turn about z carries x to y')
    call t%check(maxval(abs(frame(:, 2) - [-1.0_wp, 0.0_wp, 0.0_wp])) < rounding, 'and y to -x')
    frame = frame_of(quaternion_product(rotation_by([pi/2, 0.0_wp, 0.0_wp]), rotation_by([0.0_wp, 0.0_wp, pi/2])))
    call t%check(maxval(abs(frame(:, 1) - [0.0_wp, 0.0_wp, 1.0_wp])) < rounding, 'about z, then about x: x goes to y, then to z')
    call t%check(maxval(abs(normalised([0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]) - no_rotation)) < rounding, 'zero is no rotation')
    call t%check(maxval(abs(normalised([0.0_wp, -3.0_wp, 0.0_wp, 4.0_wp]) - [0.0_wp, -0.6_wp, 0.0_wp, 0.8_wp])) < rounding, &
                 'normalised')
    frame = frame_of(rotation_by([0.0_wp, 1e-9_wp, 0.0_wp]))
    call t%near(frame(1, 3), 1e-9_wp, 1e-9_wp*rounding, 'a small angle keeps its digits')
    call test_small_angles()
  end subroutine test_known_rotations

  !> Series of small angles and sine and cosine of others agree, on both sides of where one takes over from the other.
  subroutine test_small_angles()
    real(wp) :: axis(3), q(4), angle, worst(2)
    integer :: i

    axis = [2.0_wp, -3.0_wp, 6.0_wp]/7
    worst = 0
    do i = 0, 400
      angle = 10.0_wp**(-8 + 0.02_wp*real(i, wp))
      q = rotation_by(angle*axis)
      worst(1) = max(worst(1), abs(q(1) - cos(angle/2)))
      worst(2) = max(worst(2), maxval(abs(q(2:4) - sin(angle/2)*axis))/angle)
    end do
    call t%check(maxval(worst) < 4*epsilon(1.0_wp), 'cosine and sine of half the angle, from 1e-8 to 1 rad')
  end subroutine test_small_angles

  !> Products of quaternions are products of frames; frames are orthonormal; and there and back.
  subroutine test_random_rotations()
    type(random_t) :: random
    real(wp) :: p(4), q(4), a(3, 3), b(3, 3), worst(4)
    integer :: i, k

    call random%seed(1)
    worst = 0
    do i = 1, 1000
      p = [(random%normal(), k=1, 4)]
      q = [(random%normal(), k=1, 4)]
      a = frame_of(p)
      b = frame_of(q)
      worst(1) = max(worst(1), maxval(abs(frame_of(quaternion_product(p, q)) - matmul(a, b))))
      worst(2) = max(worst(2), maxval(abs(matmul(transpose(a), a) - frame_of(no_rotation))))
      worst(3) = max(worst(3), maxval(abs(quaternion_of(a) - sign(1.0_wp, p(1))*normalised(p))))
      worst(4) = max(worst(4), maxval(abs(frame_of(quaternion_of(a)) - a)))
    end do
    call t%check(worst(1) < rounding, 'the frame of a product is the product of frames')
    call t%check(worst(2) < rounding, 'frames are orthonormal')
    call t%check(worst(3) < rounding, 'the quaternion of a frame')
    call t%check(worst(4) < rounding, 'and its frame again')
  end subroutine test_random_rotations

  !> Half turns, where w is zero and each of the other components is the largest in turn.
  subroutine test_half_turns()
    real(wp) :: axis(3), frame(3, 3)
    integer :: i

    do i = 1, 3
      axis = 0.1_wp
      axis(i) = 1
      axis = axis/norm2(axis)
      frame = frame_of(rotation_by(pi*axis))
      call t%check(maxval(abs(matmul(frame, axis) - axis)) < rounding, 'the axis stays')
      call t%check(maxval(abs(frame_of(quaternion_of(frame)) - frame)) < rounding, 'half turn there and back')
    end do
  end subroutine test_half_turns

  !> A million small turns about one axis: the orientation stays a rotation, and the angle is their sum.
  subroutine test_long_rotation()
    real(wp) :: q(4), frame(3, 3), step(3)
    integer :: i
    integer, parameter :: n = 1000000

    step = [2.0_wp, -1.0_wp, 2.0_wp]/3*1.1e-3_wp
    q = no_rotation
    do i = 1, n
      q = turned_on(q, step)
    end do
    frame = frame_of(q)
    call t%check(maxval(abs(matmul(transpose(frame), frame) - frame_of(no_rotation))) < rounding, &
                 'orthonormal after a million turns')
    ! Each turn is off by a rounding, in one direction at worst.
    call t%check(maxval(abs(frame - frame_of(rotation_by(n*step)))) < 2e-10_wp, 'the turns add up')
  end subroutine test_long_rotation

  subroutine test_nearest()
    type(error_t), allocatable :: error
    real(wp) :: frame(3, 3), given(3, 3), found(3, 3), distance

    frame = frame_of([0.3_wp, -0.5_wp, 0.7_wp, 0.2_wp])
    given = real(nint(frame*1e7_wp), wp)*1e-7_wp
    call nearest_rotation(given, found, distance, error)
    call t%check(.not. allocated(error), 'seven digits are enough')
    call t%check(maxval(abs(matmul(transpose(found), found) - frame_of(no_rotation))) < rounding, 'the nearest is orthonormal')
    call t%check(maxval(abs(found - frame)) < 1e-7_wp, 'and near')
    call t%check(distance > 1e-9_wp .and. distance < 1e-7_wp, 'the distance tells the digits')
    ! Nearest: the difference is orthogonal to every way to turn, so that found^T given is symmetric.
    given = given + 0.05_wp*reshape([1.0_wp, 0.2_wp, -0.3_wp, 0.9_wp, -1.0_wp, 0.4_wp, 0.1_wp, -0.2_wp, 0.8_wp], [3, 3])
    call nearest_rotation(given, found, distance, error)
    given = matmul(transpose(found), given)
    call t%check(maxval(abs(given - transpose(given))) < rounding, 'no rotation is nearer')
    frame(:, 3) = -frame(:, 3)
    call nearest_rotation(frame, found, distance, error)
    call expect(t, error, 'the axes of the frame are left-handed')
    frame(:, 3) = frame(:, 1)
    call nearest_rotation(frame, found, distance, error)
    call expect(t, error, 'the axes of the frame are not independent')
    frame(:, 3) = 0
    call nearest_rotation(frame, found, distance, error)
    call expect(t, error, 'axis 3 of the frame has length 0.00E+00, not 1')
    frame(1, 1) = huge(1.0_wp)
    call nearest_rotation(frame, found, distance, error)
    call t%check(allocated(error), 'a huge axis is refused')
  end subroutine test_nearest

  !> Random axes and values of any size are found again.
  subroutine test_axes()
    type(random_t) :: random
    real(wp) :: values(3), axes(3, 3), matrix(3, 3), worst(3), scale, turn(3, 3)
    integer :: i, k

    call random%seed(2)
    worst = 0
    do i = 1, 2000
      scale = 10.0_wp**random%uniform(-60.0_wp, 60.0_wp)
      values = scale*[(10.0_wp**random%uniform(-6.0_wp, 0.0_wp), k=1, 3)]
      turn = frame_of([(random%normal(), k=1, 4)])
      matrix = rebuilt(values, turn)
      scale = maxval(abs(matrix))
      call principal_axes(matrix, values, axes)
      worst(1) = max(worst(1), maxval(abs(rebuilt(values, axes) - matrix))/scale)
      worst(2) = max(worst(2), maxval(abs(matmul(transpose(axes), axes) - frame_of(no_rotation))))
      worst(3) = max(worst(3), abs(determinant(axes) - 1))
    end do
    call t%check(worst(1) < rounding, 'axes and values give the matrix again')
    call t%check(worst(2) < rounding, 'axes are orthonormal')
    call t%check(worst(3) < rounding, 'and right-handed')
    ! Diagonal: nothing is turned, and the values keep their order.
    call principal_axes(rebuilt([3.0_wp, 1.0_wp, 2.0_wp], frame_of(no_rotation)), values, axes)
    call t%check(maxval(abs(axes - frame_of(no_rotation))) < rounding, 'a diagonal matrix keeps its axes')
    call t%check(maxval(abs(values - [3.0_wp, 1.0_wp, 2.0_wp])) < rounding, 'and their order')
    ! Turned by 20 degrees: that turn and no other is found.
    turn = frame_of(rotation_by([0.1_wp, -0.2_wp, 0.3_wp]))
    call principal_axes(rebuilt([3.0_wp, 1.0_wp, 2.0_wp], turn), values, axes)
    call t%check(maxval(abs(axes - turn)) < rounding, 'the least turn is taken')
    matrix = 0
    call principal_axes(matrix, values, axes)
    call t%check(maxval(abs(values)) <= 0 .and. maxval(abs(axes - frame_of(no_rotation))) < rounding, 'zero')
  end subroutine test_axes

  !> Values that are equal, or nearly so.
  subroutine test_equal_values()
    type(random_t) :: random
    real(wp) :: values(3), axes(3, 3), matrix(3, 3), worst
    integer :: i, k

    call random%seed(3)
    worst = 0
    do i = 1, 2000
      values = [1.0_wp, 1.0_wp, merge(2.0_wp, 1.0_wp, mod(i, 2) == 0)] &
               + 10.0_wp**random%uniform(-16.0_wp, -6.0_wp)*[(random%normal(), k=1, 3)]
      matrix = rebuilt(values, frame_of([(random%normal(), k=1, 4)]))
      call principal_axes(matrix, values, axes)
      worst = max(worst, maxval(abs(rebuilt(values, axes) - matrix)), &
                  maxval(abs(matmul(transpose(axes), axes) - frame_of(no_rotation))), abs(determinant(axes) - 1))
    end do
    call t%check(worst < rounding, 'nearly equal values')
    matrix = frame_of(no_rotation)
    matrix(1, 2) = 1e-10_wp
    matrix(2, 1) = 1e-10_wp
    call principal_axes(matrix, values, axes, tolerance=1e-9_wp)
    call t%check(maxval(abs(axes - frame_of(no_rotation))) < rounding, 'what is equal to the tolerance keeps its axes')
    call principal_axes(matrix, values, axes)
    call t%near(maxval(values) - minval(values), 2e-10_wp, rounding, 'without a tolerance they differ by this')
  end subroutine test_equal_values

  !> The largest value alone. Rounding of the determinant moves it by more the nearer another value is, and by its root at most.
  subroutine test_largest()
    type(random_t) :: random
    real(wp) :: values(3), axes(3, 3), matrix(3, 3), error, apart, worst(2)
    integer :: i, k

    call random%seed(4)
    worst = 0
    do i = 1, 3000
      values = [(random%normal(), k=1, 3)]
      if (mod(i, 3) == 0) values(2) = values(1) + 10.0_wp**random%uniform(-17.0_wp, -3.0_wp)
      matrix = 10.0_wp**random%uniform(-9.0_wp, 9.0_wp)*rebuilt(values, frame_of([(random%normal(), k=1, 4)]))
      call principal_axes(matrix, values, axes)
      k = maxloc(values, 1)
      error = abs(largest_eigenvalue(matrix) - values(k))/maxval(abs(values))
      values = values/maxval(abs(values))
      apart = minval(values(k) - values([1 + mod(k, 3), 1 + mod(k + 1, 3)]))
      worst = max(worst, [error*min(1.0_wp, apart), error])
    end do
    call t%check(worst(1) < rounding, 'the largest value')
    call t%check(worst(2) < sqrt(rounding), 'the largest of values of which two are nearly equal')
    call t%near(largest_eigenvalue(reshape([3.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 2.0_wp], [3, 3])), &
                3.0_wp, rounding, 'of a diagonal matrix')
    call t%near(largest_eigenvalue(frame_of(no_rotation)), 1.0_wp, 0.0_wp, 'of the identity')
    call t%near(largest_eigenvalue(0*frame_of(no_rotation)), 0.0_wp, 0.0_wp, 'of nothing')
  end subroutine test_largest

  pure function rebuilt(values, axes) result(matrix)
    real(wp), intent(in) :: values(3), axes(3, 3)
    real(wp) :: matrix(3, 3)
    integer :: i, j, k

    matrix = 0
    do k = 1, 3
      do j = 1, 3
        do i = 1, 3
          matrix(i, j) = matrix(i, j) + axes(i, k)*values(k)*axes(j, k)
        end do
      end do
    end do
  end function rebuilt
end program test_rotations
