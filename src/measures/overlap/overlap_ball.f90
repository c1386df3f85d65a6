!> Volume that a ball shares with a convex polyhedron, exact; see doc/theory/detection_round.md.
!!
!! Seen from the ball's centre, each face closes off a cone: where the face is inside the ball, the cone has the volume
!! of a pyramid, elsewhere that of a part of the ball. Cones of faces seen from behind count as positive, those of faces
!! seen from the front as negative. A face is a sum of triangles between the foot of the centre and its edges.
module sg_overlap_ball
  use sg_kinds, only: wp, pi
  implicit none
  private
  public :: ball_below_plane, ball_in_faces

contains

  !> Volume of the part of a ball below a plane [m3].
  pure real(wp) function ball_below_plane(radius, height) result(volume)
    real(wp), intent(in) :: radius !! of the ball [m]
    real(wp), intent(in) :: height !! of the plane above the centre [m]
    real(wp) :: thickness

    thickness = max(0.0_wp, min(2*radius, radius + height))
    volume = pi*thickness**2*(3*radius - thickness)/3
  end function ball_below_plane

  !> Volume that a ball about the origin shares with a convex polyhedron [m3].
  pure real(wp) function ball_in_faces(radius, n_faces, normal, face_first, face_vertex, vertex) result(volume)
    real(wp), intent(in) :: radius !! of the ball [m]
    integer, intent(in) :: n_faces !! faces of the polyhedron
    real(wp), intent(in) :: normal(:, :) !! outward unit normals of the faces, shape (3, n_faces)
    integer, intent(in) :: face_first(:) !! where the vertices of each face start, shape (n_faces + 1)
    integer, intent(in) :: face_vertex(:) !! vertices of the faces, counter-clockwise seen from outside
    real(wp), intent(in) :: vertex(:, :) !! vertices about the ball's centre [m], shape (3, :)
    real(wp) :: height(n_faces), share
    logical :: is_met, is_any_met
    integer :: f, lowest

    volume = 0
    if (n_faces == 0) return
    do f = 1, n_faces
      height(f) = dot_product(normal(:, f), vertex(:, face_vertex(face_first(f))))
      if (height(f) <= -radius) return
    end do
    lowest = minloc(height, 1)
    if (is_cut_once(radius, n_faces, normal, height, lowest)) then
      volume = ball_below_plane(radius, height(lowest))
      return
    end if
    is_any_met = .false.
    do f = 1, n_faces
      call cone_of_face(radius, height(f), normal(:, f), vertex(:, face_vertex(face_first(f):face_first(f + 1) - 1)), share, is_met)
      volume = volume + share
      is_any_met = is_any_met .or. is_met
    end do
    if (.not. is_any_met) volume = all_or_nothing(radius, volume)
    volume = max(0.0_wp, volume)
  end function ball_in_faces

  !> A ball that meets no face is wholly inside or outside; faces of no width may hide that it meets others.
  pure real(wp) function all_or_nothing(radius, volume)
    real(wp), intent(in) :: radius !! of the ball [m]
    real(wp), intent(in) :: volume !! shared, up to rounding [m3]
    real(wp) :: whole

    whole = 4*pi*radius**3/3
    all_or_nothing = volume
    if (volume < 1e-12_wp*whole) all_or_nothing = 0
    if (whole - volume < 1e-12_wp*whole) all_or_nothing = whole
  end function all_or_nothing

  !> Does no face but the lowest cut what of the ball is below that? Then cones need not cancel for a thin slice.
  pure logical function is_cut_once(radius, n_faces, normal, height, lowest)
    real(wp), intent(in) :: radius
    integer, intent(in) :: n_faces
    real(wp), intent(in) :: normal(:, :), height(:)
    integer, intent(in) :: lowest
    real(wp) :: cosine, sine, rim
    integer :: f

    is_cut_once = .true.
    if (height(lowest) >= radius) return
    rim = sqrt((radius - height(lowest))*(radius + height(lowest)))
    do f = 1, n_faces
      if (f == lowest .or. height(f) >= radius) cycle
      ! The farthest point of the slice along the other normal: on the rim, or the pole when it is below the rim.
      cosine = dot_product(normal(:, f), normal(:, lowest))
      sine = sqrt(max(0.0_wp, 1 - cosine**2))
      is_cut_once = radius*cosine > height(lowest) .and. height(lowest)*cosine + rim*sine <= height(f)
      if (.not. is_cut_once) return
    end do
  end function is_cut_once

  !> Volume of the cone that a face closes off, negative for a face below the centre.
  pure subroutine cone_of_face(radius, height, normal, corner, volume, is_met)
    real(wp), intent(in) :: radius !! of the ball [m]
    real(wp), intent(in) :: height !! of the face above the ball's centre [m]
    real(wp), intent(in) :: normal(3) !! unit normal of the face
    real(wp), intent(in) :: corner(:, :) !! corners of the face about the ball's centre, counter-clockwise [m]
    real(wp), intent(out) :: volume !! [m3]
    logical, intent(out) :: is_met !! does a part of the face lie in the ball?
    real(wp) :: along(3), across(3), length, offset, from, to, half, rim2
    logical :: is_foot_inside
    integer :: i, n

    n = size(corner, 2)
    volume = 0
    is_met = .false.
    is_foot_inside = .true.
    rim2 = (radius - height)*(radius + height)
    do i = 1, n
      along = corner(:, merge(1, i + 1, i == n)) - corner(:, i)
      length = norm2(along)
      if (length <= tiny(length)) cycle
      along = along/length
      across = [along(2)*normal(3) - along(3)*normal(2), along(3)*normal(1) - along(1)*normal(3), &
                along(1)*normal(2) - along(2)*normal(1)]
      offset = dot_product(across, corner(:, i))
      from = dot_product(along, corner(:, i))
      to = from + length
      is_foot_inside = is_foot_inside .and. offset >= 0
      if (rim2 > offset**2) then
        half = sqrt(rim2 - offset**2)
        if (from < half .and. to > -half) then
          is_met = .true.
          volume = volume + height*offset*(min(to, half) - max(from, -half))/6
        end if
        if (from < -half) volume = volume + cone_of_arc(radius, height, offset, from, min(to, -half))
        if (to > half) volume = volume + cone_of_arc(radius, height, offset, max(from, half), to)
      else
        volume = volume + cone_of_arc(radius, height, offset, from, to)
      end if
    end do
    if (rim2 > 0 .and. is_foot_inside) is_met = .true.
  end subroutine cone_of_face

  !> Volume of the cone of the triangle between the centre's foot and a piece of an edge outside the ball.
  !!
  !! A sector of the disk that ball and face share closes a pyramid, what is beyond it a part of the ball. Its solid
  !! angle is the angle at the foot less the growth of atan(h t/(p l)) along the piece, l being the distance of its points.
  pure real(wp) function cone_of_arc(radius, height, offset, from, to) result(volume)
    real(wp), intent(in) :: radius !! of the ball [m]
    real(wp), intent(in) :: height !! of the face above the centre [m]
    real(wp), intent(in) :: offset !! of the edge from the centre's foot, positive when the foot is on the face's side [m]
    real(wp), intent(in) :: from !! start of the piece, from the foot's foot on the edge [m]
    real(wp), intent(in) :: to !! its end [m]
    real(wp) :: p, angle, less

    volume = 0
    p = abs(offset)
    ! No triangle when the edge goes through the foot.
    if (p <= tiny(p)) return
    angle = atan2(to, p) - atan2(from, p)
    less = atan2(height*to, p*norm2([height, p, to])) - atan2(height*from, p*norm2([height, p, from]))
    if (abs(height) < radius) then
      volume = height*angle*(3*radius**2 - height**2)/6 - radius**3*less/3
    else
      volume = radius**3*(sign(angle, height) - less)/3
    end if
    volume = sign(1.0_wp, offset)*volume
  end function cone_of_arc
end module sg_overlap_ball
