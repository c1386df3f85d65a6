!> Which of the corners that two faces share carry the contact: at most four.
module sg_four_points
  use sg_kinds, only: wp
  use sg_vectors, only: cross
  implicit none
  private
  public :: choose_points

contains

  !> Choose the deepest point, the farthest from it, the farthest from their line, and the one that adds most area to these.
  !!
  !! Points that add less than `same` in length add nothing new: a line has two points, a spot one. Of points that add as much the
  !! deeper is chosen, so that the choice does not hang on the order of the corners.
  pure subroutine choose_points(n, point, normal, rounding, same, n_chosen, chosen)
    integer, intent(in) :: n !! number of points, one at least
    real(wp), intent(in) :: point(4, n) !! corners of a convex polygon, seen along the normal, and their gaps [m]
    real(wp), intent(in) :: normal(3) !! unit normal of the contact
    real(wp), intent(in) :: rounding !! gaps that differ by less are the same [m]
    real(wp), intent(in) :: same !! points nearer than this are one [m]
    integer, intent(out) :: n_chosen !! number of points chosen, 1 to 4
    integer, intent(out) :: chosen(4) !! the points
    real(wp) :: line(3), across(3), value, best
    integer :: i

    chosen = 0
    n_chosen = 1
    chosen(1) = 1
    do i = 2, n
      if (point(4, i) < point(4, chosen(1)) - rounding) chosen(1) = i
    end do

    best = same
    do i = 1, n
      value = sqrt(dot_product(flat(i, 1), flat(i, 1)))
      if (.not. is_better(i, chosen(2), rounding)) cycle
      best = value
      chosen(2) = i
    end do
    if (chosen(2) == 0) return
    n_chosen = 2

    line = flat(chosen(2), 1)
    across = cross(normal, line)/sqrt(dot_product(line, line))
    best = same
    do i = 1, n
      value = abs(dot_product(across, flat(i, 1)))
      if (.not. is_better(i, chosen(3), rounding)) cycle
      best = value
      chosen(3) = i
    end do
    if (chosen(3) == 0) return
    n_chosen = 3
    ! The triangle is to be seen counter-clockwise.
    if (dot_product(across, flat(chosen(3), 1)) < 0) chosen(2:3) = chosen([3, 2])

    best = same*sqrt(dot_product(line, line))
    do i = 1, n
      value = max(area(1, 2, i), area(2, 3, i), area(3, 1, i))
      if (.not. is_better(i, chosen(4), rounding*sqrt(dot_product(line, line)))) cycle
      best = value
      chosen(4) = i
    end do
    if (chosen(4) > 0) n_chosen = 4

  contains

    !> Does a point add more than the best one so far, or as much and is deeper?
    pure logical function is_better(i, now, tie)
      integer, intent(in) :: i, now
      real(wp), intent(in) :: tie

      is_better = value > best + tie
      if (is_better .or. now == 0 .or. value < best - tie) return
      is_better = point(4, i) < point(4, now) - rounding
    end function is_better

    !> From a chosen point to a point, within the plane of contact.
    pure function flat(i, k) result(way)
      integer, intent(in) :: i, k
      real(wp) :: way(3)

      way = point(1:3, i) - point(1:3, chosen(k))
      way = way - dot_product(normal, way)*normal
    end function flat

    !> Twice the area that a point adds beyond a side of the triangle, negative inside.
    pure real(wp) function area(k, l, i)
      integer, intent(in) :: k, l, i

      area = added_area(normal, point(1:3, chosen(k)), point(1:3, chosen(l)), point(1:3, i))
    end function area
  end subroutine choose_points

  !> Twice the area of the triangle of a side and a point, seen along a normal; negative where the point is left of the side.
  pure real(wp) function added_area(normal, first, second, place) result(area)
    real(wp), intent(in) :: normal(3) !! unit vector
    real(wp), intent(in) :: first(3), second(3) !! ends of the side [m]
    real(wp), intent(in) :: place(3) !! the point [m]
    real(wp) :: u(3), v(3)

    u = second - first
    v = place - first
    ! Written out, since the compiler calls a procedure of another file.
    area = -dot_product(normal, [u(2)*v(3) - u(3)*v(2), u(3)*v(1) - u(1)*v(3), u(1)*v(2) - u(2)*v(1)])
  end function added_area
end module sg_four_points
