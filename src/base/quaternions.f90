!> Orientations in space as unit quaternions (w, x, y, z) that turn vectors of a body's frame into the world.
module sg_quaternions
  use sg_kinds, only: wp
  implicit none
  private
  public :: frame_of, turned_by, turned_back, turned_on, cross

contains

  !> Columns: axes of the body's frame in the world.
  pure function frame_of(q) result(frame)
    real(wp), intent(in) :: q(4) !! unit quaternion
    real(wp) :: frame(3, 3), w, x, y, z

    w = q(1)
    x = q(2)
    y = q(3)
    z = q(4)
    frame(:, 1) = [1 - 2*(y**2 + z**2), 2*(x*y + w*z), 2*(x*z - w*y)]
    frame(:, 2) = [2*(x*y - w*z), 1 - 2*(x**2 + z**2), 2*(y*z + w*x)]
    frame(:, 3) = [2*(x*z + w*y), 2*(y*z - w*x), 1 - 2*(x**2 + y**2)]
  end function frame_of

  !> A vector of the body's frame in the world.
  pure function turned_by(q, v) result(turned)
    real(wp), intent(in) :: q(4) !! unit quaternion
    real(wp), intent(in) :: v(3) !! vector in the body's frame
    real(wp) :: turned(3), t(3)

    t = 2*cross(q(2:4), v)
    turned = v + q(1)*t + cross(q(2:4), t)
  end function turned_by

  !> A vector of the world in the body's frame.
  pure function turned_back(q, v) result(turned)
    real(wp), intent(in) :: q(4) !! unit quaternion
    real(wp), intent(in) :: v(3) !! vector in the world
    real(wp) :: turned(3), t(3)

    t = 2*cross(v, q(2:4))
    turned = v + q(1)*t + cross(t, q(2:4))
  end function turned_back

  !> Orientation after a rotation about axes of the body's frame; normalised, so that it stays orthonormal to rounding.
  pure function turned_on(q, rotation) result(turned)
    real(wp), intent(in) :: q(4) !! unit quaternion
    real(wp), intent(in) :: rotation(3) !! rotation vector in the body's frame [rad]
    real(wp) :: turned(4), p(4), angle

    angle = sqrt(rotation(1)**2 + rotation(2)**2 + rotation(3)**2)
    p(1) = cos(angle/2)
    if (angle > 1e-4_wp) then
      p(2:4) = sin(angle/2)/angle*rotation
    else
      p(2:4) = (0.5_wp - angle**2/48)*rotation
    end if
    turned(1) = q(1)*p(1) - dot_product(q(2:4), p(2:4))
    turned(2:4) = q(1)*p(2:4) + p(1)*q(2:4) + cross(q(2:4), p(2:4))
    turned = turned/norm2(turned)
  end function turned_on

  !> Cross product.
  pure function cross(a, b)
    real(wp), intent(in) :: a(3) !! first vector
    real(wp), intent(in) :: b(3) !! second vector
    real(wp) :: cross(3)

    cross = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross
end module sg_quaternions
