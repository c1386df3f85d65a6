!> The point nearest to the origin of a simplex of up to four points.
!!
!! The walk towards the nearest points of two bodies (polyhedra_apart.f90) needs it. Regions are found by trial, from
!! the inside to the edges, and the nearest of all wins: slower than a tree of cases, but nothing is lost on slivers.
module sg_nearest_simplex
  use sg_kinds, only: wp
  use sg_vectors, only: cross
  implicit none
  private
  public :: simplex_t, reduce_simplex

  !> Points of the difference of two bodies
  type :: simplex_t
    !> Number of points
    integer :: n = 0
    !> The points [m], shape (3, point)
    real(wp) :: point(3, 4) = 0
    !> Vertices of candidate and antagonist whose difference each point is, shape (2, point)
    integer :: vertex(2, 4) = 0
    !> Shares of the points in the nearest point
    real(wp) :: weight(4) = 0
  end type simplex_t

  !> A nearest point that is sought: its square and the points that carry it
  type :: trial_t
    real(wp) :: square = huge(1.0_wp), place(3) = 0, weight(3) = 0
    integer :: n = 0, corner(3) = 0
  end type trial_t

  !> A tetrahedron flatter than this share of its length does not determine what is inside
  real(wp), parameter :: flat = 1e-13_wp

contains

  !> Find the point nearest to the origin, and keep only those points of the simplex that carry it.
  pure subroutine reduce_simplex(simplex, nearest, is_inside)
    type(simplex_t), intent(inout) :: simplex !! points; reduced to those that carry the nearest point
    real(wp), intent(out) :: nearest(3) !! nearest point [m]
    logical, intent(out) :: is_inside !! does a tetrahedron hold the origin? Then the simplex stays
    type(trial_t) :: best

    is_inside = .false.
    select case (simplex%n)
    case (1)
      best = trial_t(0.0_wp, simplex%point(:, 1), [1.0_wp, 0.0_wp, 0.0_wp], 1, [1, 0, 0])
    case (2)
      call try_segment(simplex, 1, 2, best)
    case (3)
      call try_triangle(simplex, 1, 2, 3, best)
    case default
      is_inside = .true.
      call try_face(simplex, [1, 2, 4], 3, best, is_inside)
      call try_face(simplex, [2, 3, 4], 1, best, is_inside)
      call try_face(simplex, [3, 1, 4], 2, best, is_inside)
      call try_face(simplex, [1, 2, 3], 4, best, is_inside)
    end select
    nearest = 0
    if (is_inside) return
    nearest = best%place
    simplex%n = best%n
    simplex%weight(:3) = best%weight
    simplex%point(:, :best%n) = simplex%point(:, best%corner(:best%n))
    simplex%vertex(:, :best%n) = simplex%vertex(:, best%corner(:best%n))
  end subroutine reduce_simplex

  !> Try a face of a tetrahedron, unless the origin lies on the side of the fourth point.
  pure subroutine try_face(simplex, corner, opposite, best, is_inside)
    type(simplex_t), intent(in) :: simplex !! tetrahedron
    integer, intent(in) :: corner(3) !! points of the face
    integer, intent(in) :: opposite !! the fourth point
    type(trial_t), intent(inout) :: best !! nearest so far
    logical, intent(inout) :: is_inside !! cleared where the face has the origin outside
    real(wp) :: normal(3), p(3), to_origin, to_opposite, length

    p = simplex%point(:, corner(1))
    normal = cross(simplex%point(:, corner(2)) - p, simplex%point(:, corner(3)) - p)
    to_origin = -dot_product(normal, p)
    to_opposite = dot_product(normal, simplex%point(:, opposite) - p)
    length = sqrt(dot_product(normal, normal))*(maxval(abs(p)) + maxval(abs(simplex%point(:, opposite))))
    if (abs(to_opposite) > flat*length .and. (to_origin >= 0 .eqv. to_opposite > 0)) return
    is_inside = .false.
    call try_triangle(simplex, corner(1), corner(2), corner(3), best)
  end subroutine try_face

  !> Try a triangle: its inside, else its sides.
  pure subroutine try_triangle(simplex, i, j, k, best)
    type(simplex_t), intent(in) :: simplex !! points
    integer, intent(in) :: i, j, k !! corners of the triangle
    type(trial_t), intent(inout) :: best !! nearest so far
    real(wp) :: p(3), q(3), r(3), normal(3), square, weight(3), height

    p = simplex%point(:, i)
    q = simplex%point(:, j)
    r = simplex%point(:, k)
    normal = cross(q - p, r - p)
    square = dot_product(normal, normal)
    weight = [dot_product(normal, cross(q, r)), dot_product(normal, cross(r, p)), dot_product(normal, cross(p, q))]
    if (all(weight > 0) .and. square > tiny(square)) then
      height = dot_product(normal, p)
      if (height**2/square < best%square) then
        best = trial_t(height**2/square, (height/square)*normal, weight/sum(weight), 3, [i, j, k])
      end if
    else
      call try_segment(simplex, i, j, best)
      call try_segment(simplex, j, k, best)
      call try_segment(simplex, k, i, best)
    end if
  end subroutine try_triangle

  !> Try a segment: its inside, else its ends.
  pure subroutine try_segment(simplex, i, j, best)
    type(simplex_t), intent(in) :: simplex !! points
    integer, intent(in) :: i, j !! ends of the segment
    type(trial_t), intent(inout) :: best !! nearest so far
    real(wp) :: p(3), edge(3), place(3), length2, along, square

    p = simplex%point(:, i)
    edge = simplex%point(:, j) - p
    length2 = dot_product(edge, edge)
    along = -dot_product(edge, p)
    if (along <= 0) then
      square = dot_product(p, p)
      if (square < best%square) best = trial_t(square, p, [1.0_wp, 0.0_wp, 0.0_wp], 1, [i, 0, 0])
    else if (along >= length2) then
      place = simplex%point(:, j)
      square = dot_product(place, place)
      if (square < best%square) best = trial_t(square, place, [1.0_wp, 0.0_wp, 0.0_wp], 1, [j, 0, 0])
    else
      along = along/length2
      place = p + along*edge
      square = dot_product(place, place)
      if (square < best%square) best = trial_t(square, place, [1 - along, along, 0.0_wp], 2, [i, j, 0])
    end if
  end subroutine try_segment
end module sg_nearest_simplex
