!> Volume that a cylinder with round ends (CYLND) shares with a plane (PLANx), which is a box; see
!! doc/theory/detection_round.md.
!!
!! The box is cut at both ends of the cylinder's straight part. What is beyond an end is shared with a half ball. What is
!! between is shared with the straight part: the heights of its faces along the axis, integrated over the disk.
module sg_overlap_cylinders
  use sg_kinds, only: wp
  use sg_overlap_ball, only: ball_in_faces
  use sg_overlap_solid, only: box_solid, cut, solid_t
  use sg_touch_cylinder_plane, only: nearest_to_box
  implicit none
  private
  public :: overlap_cylinder_plane

  !> Sine of the angle between axis and face below which a face has no outline along the axis that is worth integrating;
  !! rounding over this sine is lost above it
  real(wp), parameter :: upright = 1e-8_wp

contains

  !> Volume shared by a cylinder with round ends and a plane [m3]: exact to rounding, but to 1e-7 of the cylinder's volume
  !! where the axis makes an angle of 1e-8 or so with a face.
  pure real(wp) function overlap_cylinder_plane(centre_c, axis_c, half_height_c, radius_c, centre_a, frame, half) result(volume)
    real(wp), intent(in) :: centre_c(3) !! centre of the cylinder, the candidate [m]
    real(wp), intent(in) :: axis_c(3) !! unit vector of its axis
    real(wp), intent(in) :: half_height_c !! half length of its axis, caps not counted [m]
    real(wp), intent(in) :: radius_c !! its radius [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the box, the antagonist [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: axes of the box in the world
    real(wp), intent(in) :: half(3) !! half lengths along these axes [m]
    type(solid_t) :: box, part
    real(wp) :: local(3), axis(3), end(3)
    integer :: i, side

    do i = 1, 3
      local(i) = dot_product(frame(:, i), centre_a - centre_c)
      axis(i) = dot_product(frame(:, i), axis_c)
    end do
    volume = 0
    if (any(abs(local) >= half + abs(axis)*half_height_c + radius_c)) return
    end = nearest_to_box(-local, axis, half, half_height_c)*axis
    if (norm2(max(0.0_wp, abs(end - local) - half)) >= radius_c) return
    call box_solid(half, box)
    do i = 1, 8
      box%vertex(:, i) = box%vertex(:, i) + local
    end do
    do side = -1, 1, 2
      part = box
      end = real(side, wp)*half_height_c*axis
      call cut(part, -real(side, wp)*axis, -half_height_c)
      do i = 1, part%n_vertices
        part%vertex(:, i) = part%vertex(:, i) - end
      end do
      volume = volume + ball_in_faces(radius_c, part%n_faces, part%normal, part%face_first, part%face_vertex, part%vertex)
      call cut(box, real(side, wp)*axis, half_height_c)
    end do
    if (half_height_c > 0) volume = volume + volume_in_tube(box, axis, radius_c)
  end function overlap_cylinder_plane

  !> Volume of a solid within a radius of a line through the origin [m3].
  pure real(wp) function volume_in_tube(solid, axis, radius) result(volume)
    type(solid_t), intent(in) :: solid !! any convex solid
    real(wp), intent(in) :: axis(3) !! unit vector of the line
    real(wp), intent(in) :: radius !! [m]
    real(wp) :: across(3, 2), slope(2), corner(2, size(solid%face_vertex)), height, cosine, area, moment(2)
    integer :: f, i, n, vertex

    volume = 0
    across(:, 1) = 0
    across(minloc(abs(axis), 1), 1) = 1
    across(:, 1) = across(:, 1) - dot_product(across(:, 1), axis)*axis
    across(:, 1) = across(:, 1)/norm2(across(:, 1))
    across(:, 2) = [axis(2)*across(3, 1) - axis(3)*across(2, 1), axis(3)*across(1, 1) - axis(1)*across(3, 1), &
                    axis(1)*across(2, 1) - axis(2)*across(1, 1)]
    do f = 1, solid%n_faces
      cosine = dot_product(axis, solid%normal(:, f))
      if (abs(cosine) < upright) cycle
      n = solid%face_first(f + 1) - solid%face_first(f)
      do i = 1, n
        ! Counter-clockwise as seen along the axis, from either side
        vertex = solid%face_vertex(merge(solid%face_first(f) + i - 1, solid%face_first(f + 1) - i, cosine > 0))
        corner(:, i) = matmul(solid%vertex(:, vertex), across)
        height = dot_product(axis, solid%vertex(:, vertex))
      end do
      slope = -matmul(solid%normal(:, f), across)/cosine
      call moments_in_disk(radius, corner(:, :n), area, moment)
      volume = volume + sign(1.0_wp, cosine)*(area*(height - dot_product(slope, corner(:, n))) + dot_product(slope, moment))
    end do
    volume = max(0.0_wp, volume)
  end function volume_in_tube

  !> Area and first moments about the origin of what a polygon shares with a disk about the origin: triangles and sectors.
  pure subroutine moments_in_disk(radius, corner, area, moment)
    real(wp), intent(in) :: radius !! of the disk [m]
    real(wp), intent(in) :: corner(:, :) !! corners of the polygon, counter-clockwise [m], shape (2, :)
    real(wp), intent(out) :: area !! [m2]
    real(wp), intent(out) :: moment(2) !! [m3]
    real(wp) :: along(2), foot(2), length, offset, from, to, half, inner(2), triangle
    integer :: i, next

    area = 0
    moment = 0
    do i = 1, size(corner, 2)
      next = merge(1, i + 1, i == size(corner, 2))
      along = corner(:, next) - corner(:, i)
      length = norm2(along)
      if (length <= tiny(length)) cycle
      along = along/length
      offset = corner(1, i)*along(2) - corner(2, i)*along(1)
      foot = offset*[along(2), -along(1)]
      from = dot_product(along, corner(:, i))
      to = from + length
      half = sqrt(max(0.0_wp, (radius - offset)*(radius + offset)))
      inner = max(-half, min(half, [from, to]))
      triangle = 0.5_wp*offset*(inner(2) - inner(1))
      area = area + triangle
      moment = moment + triangle/3*(2*foot + (inner(1) + inner(2))*along)
      call add_sector(radius, foot + from*along, foot + inner(1)*along, area, moment)
      call add_sector(radius, foot + inner(2)*along, foot + to*along, area, moment)
    end do
  end subroutine moments_in_disk

  !> Add area and first moments of the sector of a disk between the directions of two points.
  pure subroutine add_sector(radius, from, to, area, moment)
    real(wp), intent(in) :: radius !! of the disk [m]
    real(wp), intent(in) :: from(2) !! any point in the first direction [m]
    real(wp), intent(in) :: to(2) !! any point in the last direction [m]
    real(wp), intent(inout) :: area !! [m2]
    real(wp), intent(inout) :: moment(2) !! [m3]
    real(wp) :: a(2), b(2)

    if (.not. (norm2(from) > tiny(radius) .and. norm2(to) > tiny(radius))) return
    a = from/norm2(from)
    b = to/norm2(to)
    area = area + 0.5_wp*radius**2*atan2(a(1)*b(2) - a(2)*b(1), dot_product(a, b))
    moment = moment + radius**3/3*[b(2) - a(2), a(1) - b(1)]
  end subroutine add_sector
end module sg_overlap_cylinders
