!> Contact of a convex polyhedron and a plane: a box, thin as a rule, whose face along its third axis is the one touched.
module sg_touch_polyhedron_plane
  use sg_clip_faces, only: facing_face
  use sg_four_points, only: choose_points
  use sg_kinds, only: wp, i4
  use sg_polyhedron, only: place_polyhedron, polyhedron_t
  use sg_touch_polyhedron_polyhedron, only: touch_polyhedron_polyhedron
  use sg_touch_space, only: add_space_point, most_points, touch_space_t
  implicit none
  private
  public :: touch_polyhedron_plane

  !> Corners of a face that are looked at; a face with more goes the general way
  integer, parameter :: most_corners = 64

contains

  !> Points of contact of a convex polyhedron and a plane.
  !!
  !! Where the whole polyhedron stands over the face and no other way out of the box is as short, the plane's face is the
  !! reference, and nothing is cut: corners of the polyhedron's facing face are the points. Else the plane is the box that it is.
  pure subroutine touch_polyhedron_plane(c, centre_a, frame_a, half_a, alert, touch)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    real(wp), intent(in) :: centre_a(3) !! centre of the plane's box [m]
    real(wp), intent(in) :: frame_a(3, 3) !! columns: axes of the plane in the world; the third is the normal of its face
    real(wp), intent(in) :: half_a(3) !! half axes of the box [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_space_t), intent(out) :: touch !! up to four points
    real(wp) :: place(3), lowest, highest, aside(2), height, margin
    integer :: i, low, face

    if (dot_product(frame_a(:, 3), c%centre - centre_a) >= half_a(3) + c%reach + alert) return
    lowest = huge(lowest)
    highest = -huge(highest)
    aside = 0
    low = 1
    do i = 1, c%n_vertices
      place = c%world_vertex(:, i) - centre_a
      height = dot_product(frame_a(:, 3), place) - half_a(3)
      highest = max(highest, height)
      aside(1) = max(aside(1), abs(dot_product(frame_a(:, 1), place)))
      aside(2) = max(aside(2), abs(dot_product(frame_a(:, 2), place)))
      if (height >= lowest) cycle
      lowest = height
      low = i
    end do
    if (lowest >= alert .or. highest + 2*half_a(3) <= -alert) return
    ! Edges that meet once the shapes are parted by the depth were no farther than that from each other.
    margin = max(-lowest, 0.0_wp) + 1e-10_wp*c%reach
    face = facing_face(c, low, -frame_a(:, 3))
    if (all(aside < half_a(1:2) - margin) .and. -lowest <= highest + 2*half_a(3) &
        .and. c%face_first(face + 1) - c%face_first(face) <= most_corners) then
      call add_corners(c, face, centre_a + half_a(3)*frame_a(:, 3), frame_a(:, 3), alert, touch)
    else
      call touch_box(c, centre_a, frame_a, half_a, alert, touch)
    end if
  end subroutine touch_polyhedron_plane

  !> Add the corners of a face that are low enough.
  pure subroutine add_corners(c, face, origin, normal, alert, touch)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    integer, intent(in) :: face !! its face that faces the plane
    real(wp), intent(in) :: origin(3) !! a point of the plane [m]
    real(wp), intent(in) :: normal(3) !! unit normal of the plane
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_space_t), intent(inout) :: touch !! points found
    real(wp) :: corner(4, most_corners), height, rounding
    integer :: n, n_chosen, chosen(most_points), i, k
    integer(i4) :: vertex(most_corners)

    n = 0
    do k = c%face_first(face), c%face_first(face + 1) - 1
      height = dot_product(normal, c%world_vertex(:, c%face_vertex(k)) - origin)
      if (height >= alert) cycle
      n = n + 1
      vertex(n) = c%face_vertex(k)
      corner(:, n) = [c%world_vertex(:, vertex(n)), height]
    end do
    if (n == 0) return
    rounding = 1e-10_wp*c%reach + 16*epsilon(rounding)*(maxval(abs(origin)) + maxval(abs(c%centre)))
    call choose_points(n, corner, normal, rounding, max(1e-6_wp*c%reach, 4*rounding), n_chosen, chosen)
    do k = 1, n_chosen
      i = chosen(k)
      call add_space_point(touch, corner(1:3, i), normal, corner(4, i), alert, vertex(i))
    end do
  end subroutine add_corners

  !> Points of contact with the box as a polyhedron.
  pure subroutine touch_box(c, centre_a, frame_a, half_a, alert, touch)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    real(wp), intent(in) :: centre_a(3) !! centre of the box [m]
    real(wp), intent(in) :: frame_a(3, 3) !! columns: axes of the box in the world
    real(wp), intent(in) :: half_a(3) !! half axes of the box [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_space_t), intent(inout) :: touch !! points found
    ! Vertex 1 + i + 2 j + 4 k lies at the far end of the axes for which i, j, k are 1; faces are -1, +1, -2, +2, -3, +3.
    integer(i4), parameter :: faces(24) = [1, 5, 7, 3, 2, 4, 8, 6, 1, 2, 6, 5, 3, 7, 8, 4, 1, 3, 4, 2, 5, 6, 8, 7]
    integer(i4), parameter :: edges(4, 12) = reshape([1, 2, 3, 5, 3, 4, 5, 4, 5, 6, 6, 3, 7, 8, 4, 6, &
                                                      1, 3, 5, 1, 2, 4, 2, 5, 5, 7, 1, 6, 6, 8, 6, 2, &
                                                      1, 5, 1, 3, 2, 6, 3, 2, 3, 7, 4, 1, 4, 8, 2, 4], [4, 12])
    type(polyhedron_t) :: box
    integer :: i

    box%n_vertices = 8
    box%n_faces = 6
    box%n_edges = 12
    allocate (box%vertex(3, 8), box%face_first(7), box%face_vertex(24), box%normal(3, 6), box%edge(4, 12))
    do i = 0, 7
      box%vertex(:, i + 1) = half_a*real([2*modulo(i, 2) - 1, 2*modulo(i/2, 2) - 1, 2*(i/4) - 1], wp)
    end do
    box%face_first = [1_i4, 5_i4, 9_i4, 13_i4, 17_i4, 21_i4, 25_i4]
    box%face_vertex = faces
    box%edge = edges
    box%normal = 0
    do i = 1, 3
      box%normal(i, 2*i - 1) = -1
      box%normal(i, 2*i) = 1
    end do
    box%reach = sqrt(dot_product(half_a, half_a))
    call place_polyhedron(box, centre_a, frame_a)
    call touch_polyhedron_polyhedron(c, box, [0.0_wp, 0.0_wp, 0.0_wp], alert, touch)
  end subroutine touch_box
end module sg_touch_polyhedron_plane
