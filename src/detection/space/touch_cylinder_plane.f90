!> Contact of a cylinder with round ends (CYLND) with a plane (PLANx): a box, thin along its third axis.
!!
!! A cylinder is a sphere swept along its axis. The kernel chooses points of the axis; each makes the contact that a
!! sphere there would make, with its own true distance to the box.
module sg_touch_cylinder_plane
  use sg_kinds, only: wp, i4
  use sg_touch_axis, only: clip_to_slab
  use sg_touch_space, only: touch_space_t, add_space_point
  use sg_touch_sphere_plane, only: normal_from_box
  implicit none
  private
  public :: touch_cylinder_plane, nearest_to_box

  !> Points of the axis nearer to each other than this, in radii, are one
  real(wp), parameter :: same_point = 1e-6_wp

contains

  !> Contact of both ends of what of the cylinder is over the face, and of the nearest point when that is another.
  !!
  !! Features: 1 and 2 for the ends on the negative and the positive side of the cylinder's axis, 3 for a nearest
  !! point between them (a cylinder across an edge of the box).
  pure subroutine touch_cylinder_plane(centre_c, axis_c, half_height_c, radius_c, centre_a, frame, half, alert, touch, rim)
    real(wp), intent(in) :: centre_c(3) !! centre of the cylinder, the candidate [m]
    real(wp), intent(in) :: axis_c(3) !! unit vector of its axis
    real(wp), intent(in) :: half_height_c !! half length of its axis, caps not counted [m]
    real(wp), intent(in) :: radius_c !! its radius [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the box, the antagonist [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: axes of the box in the world
    real(wp), intent(in) :: half(3) !! half lengths along these axes [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_space_t), intent(out) :: touch !! at most three points
    real(wp), intent(in), optional :: rim !! distance from the box that is touched as if it were its surface [m], zero unless given
    real(wp) :: between(3), start(3), slope(3), s(3), place(3), normal(3), distance, around
    integer(i4) :: feature(3)
    integer :: i, n, side

    around = 0
    if (present(rim)) around = rim
    between = centre_c - centre_a
    do i = 3, 1, -1
      start(i) = frame(1, i)*between(1) + frame(2, i)*between(2) + frame(3, i)*between(3)
      slope(i) = frame(1, i)*axis_c(1) + frame(2, i)*axis_c(2) + frame(3, i)*axis_c(3)
      if (abs(start(i)) - abs(slope(i))*half_height_c - (half(i) + (around + radius_c)) >= alert) return
    end do
    call choose_places(start, slope, half, half_height_c, radius_c, n, s, feature, side)
    do i = 1, n
      place = start + s(i)*slope
      if (side == 0) then
        call normal_from_box(place, frame, half, normal, distance)
      else
        normal = real(side, wp)*frame(:, 3)
        distance = real(side, wp)*place(3) - half(3)
      end if
      call add_space_point(touch, centre_c + s(i)*axis_c - radius_c*normal, normal, (distance - around) - radius_c, alert, &
                           feature(i))
    end do
  end subroutine touch_cylinder_plane

  !> Choose the points of the axis that make contacts.
  pure subroutine choose_places(start, slope, half, half_height, radius, n, s, feature, side)
    real(wp), intent(in) :: start(3) !! middle of the axis in the box's frame [m]
    real(wp), intent(in) :: slope(3) !! unit vector of the axis in the box's frame
    real(wp), intent(in) :: half(3) !! half lengths of the box [m]
    real(wp), intent(in) :: half_height !! half length of the axis [m]
    real(wp), intent(in) :: radius !! of the cylinder [m]
    integer, intent(out) :: n !! number of points
    real(wp), intent(out) :: s(3) !! places on the axis [m]
    integer(i4), intent(out) :: feature(3) !! their keys
    integer, intent(out) :: side !! of the large face by which an axis that enters the box leaves; 0 outside the box
    real(wp) :: low, high, height(2)
    logical :: is_free(3)

    is_free = .false.
    call part_over(start, slope, half, half_height, is_free, low, high)
    side = 0
    n = 1
    s = 0
    feature = [1_i4, 2_i4, 3_i4]
    if (low <= high) then
      is_free(3) = .true.
      call part_over(start, slope, half, half_height, is_free, s(1), s(2))
      height = start(3) + s(:2)*slope(3)
      side = merge(-1, 1, -minval(height) > maxval(height))
      if (s(2) - s(1) > same_point*radius) n = 2
    else
      s(3) = nearest_to_box(start, slope, half, half_height)
      call part_beside(start, slope, half, half_height, s(3), s(1), s(2))
      if (s(2) - s(1) <= same_point*radius) return
      n = 2
      associate (least => to_box(start + s(3)*slope, half), first => to_box(start + s(1)*slope, half), &
                 second => to_box(start + s(2)*slope, half))
        if (least < min(first, second) - same_point*radius) n = 3
      end associate
    end if
  end subroutine choose_places

  !> The part of an axis outside a box that faces the same side of it as the nearest point, which it holds.
  pure subroutine part_beside(start, slope, half, half_height, best, low, high)
    real(wp), intent(in) :: start(3) !! middle of the axis in the box's frame [m]
    real(wp), intent(in) :: slope(3) !! unit vector of the axis in the box's frame
    real(wp), intent(in) :: half(3) !! half lengths of the box [m]
    real(wp), intent(in) :: half_height !! half length of the axis [m]
    real(wp), intent(in) :: best !! where the axis is nearest to the box [m]
    real(wp), intent(out) :: low !! first place [m]
    real(wp), intent(out) :: high !! last place [m]
    real(wp) :: place(3)
    logical :: is_free(3)

    place = start + best*slope
    is_free = .false.
    is_free(maxloc(abs(place) - half, 1)) = .true.
    call part_over(start, slope, half, half_height, is_free, low, high)
    if (low > high) then
      ! Over no face, but perhaps beside an edge.
      is_free = .true.
      is_free(minloc(abs(place) - half, 1)) = .false.
      call part_over(start, slope, half, half_height, is_free, low, high)
    end if
    if (low > high) then
      low = best
      high = best
    end if
    ! The nearest point, a little beyond an edge of the face, stands for the end of what is over the face.
    low = min(low, best)
    high = max(high, best)
  end subroutine part_beside

  !> The part of an axis within the box's width along all axes of the box but some.
  pure subroutine part_over(start, slope, half, half_height, is_free, low, high)
    real(wp), intent(in) :: start(3) !! middle of the axis in the box's frame [m]
    real(wp), intent(in) :: slope(3) !! unit vector of the axis in the box's frame
    real(wp), intent(in) :: half(3) !! half lengths of the box [m]
    real(wp), intent(in) :: half_height !! half length of the axis [m]
    logical, intent(in) :: is_free(3) !! axes of the box that do not count
    real(wp), intent(out) :: low !! first place [m]
    real(wp), intent(out) :: high !! last place; below the first when there is none [m]
    integer :: i

    low = -half_height
    high = half_height
    do i = 1, 3
      if (.not. is_free(i)) call clip_to_slab(start(i), slope(i), half(i), low, high)
    end do
  end subroutine part_over

  !> Distance of a point outside a box [m].
  pure real(wp) function to_box(place, half)
    real(wp), intent(in) :: place(3) !! the point in the box's frame [m]
    real(wp), intent(in) :: half(3) !! half lengths of the box [m]

    to_box = norm2(max(0.0_wp, abs(place) - half))
  end function to_box

  !> Where on a segment the distance to a box is least [m], exactly.
  !!
  !! Half the derivative of the squared distance grows along the segment and is straight between the planes of the box.
  pure real(wp) function nearest_to_box(start, slope, half, half_height) result(best)
    real(wp), intent(in) :: start(3) !! middle of the segment in the box's frame [m]
    real(wp), intent(in) :: slope(3) !! unit vector of the segment in the box's frame
    real(wp), intent(in) :: half(3) !! half lengths of the box [m]
    real(wp), intent(in) :: half_height !! half length of the segment [m]
    real(wp) :: low, high, low_rise, high_rise, s, rise
    integer :: i, side

    low = -half_height
    high = half_height
    low_rise = growth(low)
    high_rise = growth(high)
    best = low
    if (low_rise >= 0) return
    best = high
    if (high_rise <= 0) return
    do i = 1, 3
      if (abs(slope(i)) < 1e-14_wp) cycle
      do side = -1, 1, 2
        s = (real(side, wp)*half(i) - start(i))/slope(i)
        if (s <= low .or. s >= high) cycle
        rise = growth(s)
        if (rise < 0) then
          low = s
          low_rise = rise
        else
          high = s
          high_rise = rise
        end if
      end do
    end do
    best = low + (high - low)*(low_rise/(low_rise - high_rise))
  contains
    !> Half the derivative of the squared distance.
    pure real(wp) function growth(s)
      real(wp), intent(in) :: s
      real(wp) :: place(3)

      place = start + s*slope
      growth = sum(slope*sign(max(0.0_wp, abs(place) - half), place))
    end function growth
  end function nearest_to_box
end module sg_touch_cylinder_plane
