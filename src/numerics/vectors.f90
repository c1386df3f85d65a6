!> Products of vectors in space.
module sg_vectors
  use sg_kinds, only: wp
  implicit none
  private
  public :: cross, determinant

contains

  !> Cross product.
  pure function cross(a, b) result(c)
    real(wp), intent(in) :: a(3) !! first vector
    real(wp), intent(in) :: b(3) !! second vector
    real(wp) :: c(3)

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross

  !> Determinant of a 3x3 matrix: the volume that its columns span, positive where they are right-handed.
  pure real(wp) function determinant(m)
    real(wp), intent(in) :: m(3, 3) !! matrix

    determinant = dot_product(m(:, 1), cross(m(:, 2), m(:, 3)))
  end function determinant
end module sg_vectors
