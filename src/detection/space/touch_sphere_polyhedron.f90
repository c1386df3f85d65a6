!> Contact of a sphere and a convex polyhedron.
module sg_touch_sphere_polyhedron
  use sg_kinds, only: wp
  use sg_polyhedron, only: polyhedron_t
  use sg_touch_space, only: add_space_point, touch_space_t
  implicit none
  private
  public :: touch_sphere_polyhedron

contains

  !> The one point of contact: at the polyhedron's point nearest to the centre, or through the nearest face from inside.
  pure subroutine touch_sphere_polyhedron(centre_c, radius_c, a, offset, alert, touch)
    real(wp), intent(in) :: centre_c(3) !! centre of the sphere [m]
    real(wp), intent(in) :: radius_c !! its radius [m]
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates (its periodic image) [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_space_t), intent(out) :: touch !! no point or one
    real(wp) :: place(3), normal(3), way(3), best(3), height, highest, distance, square
    integer :: f, highest_face
    logical :: is_over

    place = centre_c - offset
    way = place - a%centre
    if (dot_product(way, way) >= (a%reach + radius_c + max(alert, 0.0_wp))**2) return
    highest = -huge(highest)
    highest_face = 1
    do f = 1, a%n_faces
      height = height_over(a, f, place)
      if (height <= highest) cycle
      highest = height
      highest_face = f
      if (height >= radius_c + alert) return
    end do
    normal = a%world_normal(:, highest_face)
    distance = highest
    if (highest > 0) then
      call nearest_of_face(a, highest_face, place, best, is_over)
      if (.not. is_over) then
        square = dot_product(best, best)
        do f = 1, a%n_faces
          if (f == highest_face) cycle
          if (height_over(a, f, place) <= 0) cycle
          call nearest_of_face(a, f, place, way, is_over)
          if (dot_product(way, way) >= square) cycle
          best = way
          square = dot_product(way, way)
        end do
        distance = sqrt(square)
        ! Nearer than rounding the direction of an edge or vertex is lost: the face keeps it.
        if (distance > 16*epsilon(distance)*(a%reach + maxval(abs(place)))) normal = best/distance
      end if
    end if
    call add_space_point(touch, centre_c - radius_c*normal, normal, distance - radius_c, alert, 0)
  end subroutine touch_sphere_polyhedron

  !> Height of a point over the plane of a face [m].
  pure real(wp) function height_over(a, face, place) result(height)
    type(polyhedron_t), intent(in) :: a !! polyhedron, in the world
    integer, intent(in) :: face !! one of its faces
    real(wp), intent(in) :: place(3) !! point [m]

    height = dot_product(a%world_normal(:, face), place - a%world_vertex(:, a%face_vertex(a%face_first(face))))
  end function height_over

  !> Way from the nearest point of a face to a point.
  pure subroutine nearest_of_face(a, face, place, way, is_over)
    type(polyhedron_t), intent(in) :: a !! polyhedron, in the world
    integer, intent(in) :: face !! one of its faces
    real(wp), intent(in) :: place(3) !! point [m]
    real(wp), intent(out) :: way(3) !! from the face to the point [m]
    logical, intent(out) :: is_over !! is the point over the inside of the face?
    real(wp) :: normal(3), start(3), edge(3), along(3), length2, share, least
    integer :: first, last, k

    normal = a%world_normal(:, face)
    first = a%face_first(face)
    last = a%face_first(face + 1) - 1
    is_over = .true.
    way = 0
    least = huge(least)
    do k = first, last
      start = a%world_vertex(:, a%face_vertex(k))
      edge = a%world_vertex(:, a%face_vertex(merge(first, k + 1, k == last))) - start
      along = place - start
      ! Left of the edge, seen from outside, is inside.
      if (dot_product([edge(2)*along(3) - edge(3)*along(2), edge(3)*along(1) - edge(1)*along(3), &
                       edge(1)*along(2) - edge(2)*along(1)], normal) >= 0) cycle
      is_over = .false.
      length2 = dot_product(edge, edge)
      share = 0
      if (length2 > tiny(length2)) share = min(max(dot_product(along, edge)/length2, 0.0_wp), 1.0_wp)
      along = along - share*edge
      if (dot_product(along, along) >= least) cycle
      least = dot_product(along, along)
      way = along
    end do
    if (is_over) way = dot_product(normal, place - start)*normal
  end subroutine nearest_of_face
end module sg_touch_sphere_polyhedron
