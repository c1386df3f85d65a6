!> Orientations in space: unit quaternions (w, x, y, z) and frames, whose columns are the body's axes in the world.
!!
!! A quaternion turns a vector u of the body into the world's q u q*; the frame of q has the same effect as a matrix.
!! q and -q are the same orientation.
module sg_rotations
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp
  use sg_text, only: to_text
  use sg_vectors, only: cross
  implicit none
  private
  public :: no_rotation, quaternion_product, normalised, rotation_by, frame_of, quaternion_of, nearest_rotation
  public :: turned_on, turned_by, turned_back

  !> The orientation of a body whose axes are the world's
  real(wp), parameter :: no_rotation(4) = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
  !> Square of the angle [rad2] up to which three terms of the series of sine and cosine of its half are exact to rounding
  real(wp), parameter :: small_square = 1e-4_wp

contains

  !> The product p q: the rotation q, then the rotation p.
  pure function quaternion_product(p, q) result(r)
    real(wp), intent(in) :: p(4) !! the later rotation
    real(wp), intent(in) :: q(4) !! the earlier rotation
    real(wp) :: r(4)

    r(1) = p(1)*q(1) - p(2)*q(2) - p(3)*q(3) - p(4)*q(4)
    r(2) = p(1)*q(2) + p(2)*q(1) + p(3)*q(4) - p(4)*q(3)
    r(3) = p(1)*q(3) + p(3)*q(1) + p(4)*q(2) - p(2)*q(4)
    r(4) = p(1)*q(4) + p(4)*q(1) + p(2)*q(3) - p(3)*q(2)
  end function quaternion_product

  !> A quaternion of length one; no rotation where there is nothing to scale.
  pure function normalised(q) result(unit)
    real(wp), intent(in) :: q(4) !! of any length
    real(wp) :: unit(4)
    real(wp) :: length

    unit = no_rotation
    length = norm2(q)
    if (length > tiny(length)) unit = q/length
  end function normalised

  !> The rotation about a vector by its length. Bodies turn by little in a step: then without sine and cosine.
  pure function rotation_by(vector) result(q)
    real(wp), intent(in) :: vector(3) !! axis times angle [rad]
    real(wp) :: q(4)
    real(wp) :: square, angle, share

    square = vector(1)**2 + vector(2)**2 + vector(3)**2
    if (square < small_square) then
      q(1) = 1 - square*(0.125_wp - square/384)
      share = 0.5_wp - square*(1/48.0_wp - square/3840)
    else
      angle = norm2(vector)
      q(1) = cos(angle/2)
      share = sin(angle/2)/angle
    end if
    q(2:4) = share*vector
  end function rotation_by

  !> An orientation turned by a vector of the body's own frame, of length one again.
  pure function turned_on(q, vector) result(next)
    real(wp), intent(in) :: q(4) !! orientation, of length one
    real(wp), intent(in) :: vector(3) !! axis in the body's frame times angle [rad]: spin times time
    real(wp) :: next(4)

    next = quaternion_product(q, rotation_by(vector))
    next = next/sqrt(next(1)**2 + next(2)**2 + next(3)**2 + next(4)**2)
  end function turned_on

  !> A vector of the body's frame in the world.
  pure function turned_by(q, v) result(image)
    real(wp), intent(in) :: q(4) !! orientation, of length one
    real(wp), intent(in) :: v(3) !! vector in the body's frame
    real(wp) :: image(3), t(3)

    ! v + 2 w (x cross v) + 2 x cross (x cross v), written out: every body in space is turned several times per step.
    t(1) = 2*(q(3)*v(3) - q(4)*v(2))
    t(2) = 2*(q(4)*v(1) - q(2)*v(3))
    t(3) = 2*(q(2)*v(2) - q(3)*v(1))
    image(1) = v(1) + q(1)*t(1) + q(3)*t(3) - q(4)*t(2)
    image(2) = v(2) + q(1)*t(2) + q(4)*t(1) - q(2)*t(3)
    image(3) = v(3) + q(1)*t(3) + q(2)*t(2) - q(3)*t(1)
  end function turned_by

  !> A vector of the world in the body's frame.
  pure function turned_back(q, v) result(image)
    real(wp), intent(in) :: q(4) !! orientation, of length one
    real(wp), intent(in) :: v(3) !! vector in the world
    real(wp) :: image(3), t(3)

    ! As above, with the axis turned round.
    t(1) = 2*(q(4)*v(2) - q(3)*v(3))
    t(2) = 2*(q(2)*v(3) - q(4)*v(1))
    t(3) = 2*(q(3)*v(1) - q(2)*v(2))
    image(1) = v(1) + q(1)*t(1) - q(3)*t(3) + q(4)*t(2)
    image(2) = v(2) + q(1)*t(2) - q(4)*t(1) + q(2)*t(3)
    image(3) = v(3) + q(1)*t(3) - q(2)*t(2) + q(3)*t(1)
  end function turned_back

  !> The frame of a quaternion, orthonormal to rounding whatever the quaternion's length.
  pure function frame_of(q) result(frame)
    real(wp), intent(in) :: q(4) !! orientation, not zero
    real(wp) :: frame(3, 3)
    real(wp) :: u(4)

    u = normalised(q)
    associate (w => u(1), x => u(2), y => u(3), z => u(4))
      frame(:, 1) = [1 - 2*(y**2 + z**2), 2*(x*y + w*z), 2*(x*z - w*y)]
      frame(:, 2) = [2*(x*y - w*z), 1 - 2*(x**2 + z**2), 2*(y*z + w*x)]
      frame(:, 3) = [2*(x*z + w*y), 2*(y*z - w*x), 1 - 2*(x**2 + y**2)]
    end associate
  end function frame_of

  !> The quaternion of a frame; of the two with opposite signs the one with w >= 0.
  !!
  !! Of the four components the largest is found from the diagonal, the others from it: nothing small is divided by
  !! [Shepperd1978].
  pure function quaternion_of(frame) result(q)
    real(wp), intent(in) :: frame(3, 3) !! columns orthonormal and right-handed
    real(wp) :: q(4)
    real(wp) :: square(4)
    integer :: i, j, k, largest

    square(1) = 1 + frame(1, 1) + frame(2, 2) + frame(3, 3)
    do i = 1, 3
      square(1 + i) = 1 + 2*frame(i, i) - (frame(1, 1) + frame(2, 2) + frame(3, 3))
    end do
    largest = maxloc(square, 1)
    q(largest) = sqrt(square(largest))/2
    if (largest == 1) then
      q(2:) = [frame(3, 2) - frame(2, 3), frame(1, 3) - frame(3, 1), frame(2, 1) - frame(1, 2)]/(4*q(1))
    else
      i = largest - 1
      j = 1 + mod(i, 3)
      k = 1 + mod(j, 3)
      q(1) = (frame(k, j) - frame(j, k))/(4*q(largest))
      q(1 + j) = (frame(i, j) + frame(j, i))/(4*q(largest))
      q(1 + k) = (frame(i, k) + frame(k, i))/(4*q(largest))
    end if
    q = normalised(q)
    if (q(1) < 0) q = -q
  end function quaternion_of

  !> The rotation nearest to a frame that is one up to the digits of a file, and how far the frame was from it.
  !!
  !! The orthogonal factor of the polar decomposition, by Newton's iteration X <- (X + X^-T)/2: no other rotation has
  !! entries nearer by least squares [Higham1986].
  subroutine nearest_rotation(frame, rotation, distance, error)
    real(wp), intent(in) :: frame(3, 3) !! columns: the axes as given
    real(wp), intent(out) :: rotation(3, 3) !! orthonormal and right-handed; the identity on failure
    real(wp), intent(out) :: distance !! largest difference of an entry: what the caller may complain of
    type(error_t), allocatable, intent(out) :: error !! set when the axes are left-handed, dependent or not finite
    real(wp) :: x(3, 3), cofactors(3, 3), determinant, change
    integer :: i, j, iteration

    rotation = frame_of(no_rotation)
    distance = 0
    if (.not. all(ieee_is_finite(frame))) then
      call fail(error, 'an axis of the frame is not finite')
      return
    end if
    do i = 1, 3
      if (norm2(frame(:, i)) > 0.1_wp .and. norm2(frame(:, i)) < 10) cycle
      call fail(error, 'axis '//to_text(i)//' of the frame has length '//to_text(norm2(frame(:, i)), 3)//', not 1')
      return
    end do
    x = frame
    do iteration = 1, 50
      call invert(x, cofactors, determinant)
      if (.not. abs(determinant) > 1e-3_wp) then
        call fail(error, 'the axes of the frame are not independent')
        return
      else if (determinant < 0) then
        call fail(error, 'the axes of the frame are left-handed')
        return
      end if
      cofactors = (x + cofactors/determinant)/2
      change = maxval(abs(cofactors - x))
      x = cofactors
      if (change < 4*epsilon(change)) exit
    end do
    rotation = x
    do j = 1, 3
      distance = max(distance, maxval(abs(rotation(:, j) - frame(:, j))))
    end do
  end subroutine nearest_rotation

  !> Cofactors and determinant: the inverse's transpose is their quotient.
  pure subroutine invert(m, cofactors, determinant)
    real(wp), intent(in) :: m(3, 3)
    real(wp), intent(out) :: cofactors(3, 3), determinant

    cofactors(:, 1) = cross(m(:, 2), m(:, 3))
    cofactors(:, 2) = cross(m(:, 3), m(:, 1))
    cofactors(:, 3) = cross(m(:, 1), m(:, 2))
    determinant = dot_product(m(:, 1), cofactors(:, 1))
  end subroutine invert
end module sg_rotations
