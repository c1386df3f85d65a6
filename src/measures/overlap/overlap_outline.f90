!> Area shared by a disk and a convex shape, by walking round the shape.
!!
!! The walk adds, counter-clockwise, each piece of the shape's boundary that lies inside the disk. Where a piece does
!! not start at the end of the last one, the outline of what they share follows the disk's circle in between:
!!
!!          ___ circle        area = polygon of the pieces' ends + segment of every arc
!!       a /   \ b            (a to b along the circle, b to c and c to a along the shape)
!!        /_____\_
!!       |   c    |
!!
!! All points are about the disk's centre, all areas about the first of them, so that a thin sliver keeps its digits.
module sg_overlap_outline
  use sg_kinds, only: wp, pi
  use sg_overlap_disks, only: half_angle_inside, segment_area
  implicit none
  private
  public :: outline_t, add_edge, add_cap, close_outline

  !> What has been walked so far
  type :: outline_t
    !> Number of pieces
    integer :: n = 0
    !> Start of the first piece [m]
    real(wp) :: first(2) = 0
    !> End of the last piece [m]
    real(wp) :: last(2) = 0
    !> Area so far [m2]
    real(wp) :: area = 0
  end type outline_t

contains

  !> Add the part of a straight edge that lies inside the disk.
  pure subroutine add_edge(outline, radius, from, to)
    type(outline_t), intent(inout) :: outline !! outline to add to
    real(wp), intent(in) :: radius !! radius of the disk [m]
    real(wp), intent(in) :: from(2) !! start of the edge, about the disk's centre [m]
    real(wp), intent(in) :: to(2) !! its end [m]
    real(wp) :: direction(2), length, height, half, foot, low, high, ends(2, 2)

    length = norm2(to - from)
    if (length <= tiny(length)) return
    direction = (to - from)/length
    height = abs(direction(1)*from(2) - direction(2)*from(1))
    if (height >= radius) return
    half = sqrt((radius - height)*(radius + height))
    foot = -dot_product(direction, from)
    low = max(0.0_wp, foot - half)
    high = min(length, foot + half)
    if (low >= high) return
    ! Corners are taken as they are, so that two edges share them to the last digit.
    ends(:, 1) = from + low*direction
    ends(:, 2) = merge(to, from + high*direction, high >= length)
    call add_piece(outline, radius, ends(:, 1), ends(:, 2), 0.0_wp)
  end subroutine add_edge

  !> Add the parts of a half circle, from -90 to 90 degrees about a direction, that lie inside the disk.
  pure subroutine add_cap(outline, radius, centre, direction, cap_radius)
    type(outline_t), intent(inout) :: outline !! outline to add to
    real(wp), intent(in) :: radius !! radius of the disk [m]
    real(wp), intent(in) :: centre(2) !! centre of the half circle, about the disk's centre [m]
    real(wp), intent(in) :: direction(2) !! unit vector to the middle of the half circle
    real(wp), intent(in) :: cap_radius !! radius of the half circle [m]
    real(wp) :: distance, middle, half, low, high
    integer :: turn

    distance = norm2(centre)
    if (distance >= radius + cap_radius .or. distance <= cap_radius - radius) return
    middle = 0
    half = pi
    if (distance > radius - cap_radius) then
      half = half_angle_inside(cap_radius, radius, distance)
      middle = atan2(direction(2)*centre(1) - direction(1)*centre(2), -dot_product(direction, centre))
    end if
    do turn = -1, 1
      low = max(-pi/2, middle - half + 2*pi*real(turn, wp))
      high = min(pi/2, middle + half + 2*pi*real(turn, wp))
      if (low >= high) cycle
      call add_piece(outline, radius, centre + cap_radius*turned(direction, low), centre + cap_radius*turned(direction, high), &
                     cap_radius**2*segment_area(high - low))
    end do
  end subroutine add_cap

  !> A vector turned by an angle.
  pure function turned(vector, angle)
    real(wp), intent(in) :: vector(2), angle
    real(wp) :: turned(2)

    turned = [cos(angle)*vector(1) - sin(angle)*vector(2), sin(angle)*vector(1) + cos(angle)*vector(2)]
  end function turned

  !> Add a piece of the boundary that lies inside the disk.
  pure subroutine add_piece(outline, radius, from, to, bulge)
    type(outline_t), intent(inout) :: outline !! outline to add to
    real(wp), intent(in) :: radius !! radius of the disk [m]
    real(wp), intent(in) :: from(2) !! start of the piece, about the disk's centre [m]
    real(wp), intent(in) :: to(2) !! its end [m]
    real(wp), intent(in) :: bulge !! area between the piece and its chord [m2]

    if (outline%n == 0) then
      outline%first = from
    else
      call add_arc(outline, radius, from)
    end if
    call add_chord(outline, from, to)
    outline%area = outline%area + bulge
    outline%last = to
    outline%n = outline%n + 1
  end subroutine add_piece

  !> Area inside the outline [m2]; without any piece the disk is wholly inside the shape or outside.
  pure subroutine close_outline(outline, radius, is_centre_inside, area)
    type(outline_t), intent(inout) :: outline !! all pieces added
    real(wp), intent(in) :: radius !! radius of the disk [m]
    logical, intent(in) :: is_centre_inside !! is the disk's centre inside the shape?
    real(wp), intent(out) :: area !! shared by disk and shape [m2]

    if (outline%n == 0) then
      area = merge(pi*radius**2, 0.0_wp, is_centre_inside)
    else
      call add_arc(outline, radius, outline%first)
      area = max(0.0_wp, outline%area)
    end if
  end subroutine close_outline

  !> Follow the circle from the last point to another.
  pure subroutine add_arc(outline, radius, to)
    type(outline_t), intent(inout) :: outline
    real(wp), intent(in) :: radius, to(2)
    real(wp) :: angle

    ! The same corner reached along both its sides: no arc, and no direction to take an angle from.
    if (maxval(abs(to - outline%last)) <= 1e-12_wp*radius) return
    angle = atan2(outline%last(1)*to(2) - outline%last(2)*to(1), dot_product(outline%last, to))
    if (angle < 0) angle = angle + 2*pi
    call add_chord(outline, outline%last, to)
    outline%area = outline%area + radius**2*segment_area(angle)
  end subroutine add_arc

  !> Add the triangle between the first point and a chord.
  pure subroutine add_chord(outline, from, to)
    type(outline_t), intent(inout) :: outline
    real(wp), intent(in) :: from(2), to(2)
    real(wp) :: a(2), b(2)

    a = from - outline%first
    b = to - outline%first
    outline%area = outline%area + 0.5_wp*(a(1)*b(2) - a(2)*b(1))
  end subroutine add_chord
end module sg_overlap_outline
