!> Contact points of two faces that lie on each other, moved towards their middle: a smaller face that carries (LMGC90's
!! `PLPLx_ShrinkPolygFaces` and `PRPRx_ShrinkPolyrFaces`).
module sg_shrink_face
  use sg_kinds, only: wp
  implicit none
  private
  public :: shrink_face

  !> Normals of one pair that differ by less are one
  real(wp), parameter :: same_normal = 1e-9_wp

contains

  !> Move the points of a pair towards their middle; gaps vary linearly between them. Points of different faces stay.
  pure subroutine shrink_face(n, normal, point, gap, share)
    integer, intent(in) :: n !! points of the pair
    real(wp), intent(in) :: normal(:, :) !! their unit normals, shape (dimension, n or more)
    real(wp), intent(inout) :: point(:, :) !! the points [m], shape (dimension, n or more)
    real(wp), intent(inout) :: gap(:) !! their gaps [m], shape (n or more)
    real(wp), intent(in) :: share !! share of the way to the middle, 0 to 1
    real(wp) :: middle(size(point, 1)), mean
    integer :: i

    if (n < 2) return
    do i = 2, n
      if (maxval(abs(normal(:, i) - normal(:, 1))) > same_normal) return
    end do
    middle = sum(point(:, :n), 2)/real(n, wp)
    mean = sum(gap(:n))/real(n, wp)
    do i = 1, n
      point(:, i) = point(:, i) + share*(middle - point(:, i))
      gap(i) = gap(i) + share*(mean - gap(i))
    end do
  end subroutine shrink_face
end module sg_shrink_face
