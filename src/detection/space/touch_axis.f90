!> Small geometry about axes (segments) that the kernels of round shapes share; see doc/theory/detection_round.md.
module sg_touch_axis
  use sg_kinds, only: wp
  implicit none
  private
  public :: perpendicular, from_line, from_axis, clip_to_slab

contains

  !> A unit vector perpendicular to an axis, always the same one: where nothing else gives a direction.
  pure function perpendicular(axis)
    real(wp), intent(in) :: axis(3) !! unit vector
    real(wp) :: perpendicular(3), unit(3)

    unit = 0
    unit(minloc(abs(axis), 1)) = 1
    ! Along the least component of the axis, the projection keeps at least sqrt(2/3) of the length.
    perpendicular = unit - dot_product(unit, axis)*axis
    perpendicular = perpendicular/norm2(perpendicular)
  end function perpendicular

  !> Way from a line to a point: its direction, perpendicular to the line to rounding, and its length.
  pure subroutine from_line(between, axis, normal, distance)
    real(wp), intent(in) :: between(3) !! from a point of the line to the point [m]
    real(wp), intent(in) :: axis(3) !! unit vector of the line
    real(wp), intent(out) :: normal(3) !! unit vector from the line to the point; for a point on it, any perpendicular
    real(wp), intent(out) :: distance !! [m]

    normal = between - dot_product(axis, between)*axis
    distance = sqrt(normal(1)**2 + normal(2)**2 + normal(3)**2)
    ! Nearer than this the direction is nothing but rounding, and may even lie along the axis.
    if (distance <= 4*epsilon(distance)*sum(abs(between)) + tiny(distance)) then
      normal = perpendicular(axis)
    else
      normal = normal/distance
      normal = normal - dot_product(axis, normal)*axis
      normal = normal/sqrt(normal(1)**2 + normal(2)**2 + normal(3)**2)
    end if
  end subroutine from_line

  !> Way from a segment to a point: its direction, perpendicular beside the segment, and its length.
  !!
  !! A point on the segment is sent perpendicular to it, one on an end along it.
  pure subroutine from_axis(between, axis, half_height, normal, distance)
    real(wp), intent(in) :: between(3) !! from the middle of the segment to the point [m]
    real(wp), intent(in) :: axis(3) !! unit vector of the segment
    real(wp), intent(in) :: half_height !! half its length [m]
    real(wp), intent(out) :: normal(3) !! unit vector from the segment to the point
    real(wp), intent(out) :: distance !! [m]
    real(wp) :: along

    along = axis(1)*between(1) + axis(2)*between(2) + axis(3)*between(3)
    if (abs(along) < half_height) then
      call from_line(between, axis, normal, distance)
    else
      normal = between - sign(half_height, along)*axis
      distance = norm2(normal)
      if (distance > tiny(distance)) then
        normal = normal/distance
      else
        normal = sign(1.0_wp, along)*axis
      end if
    end if
  end subroutine from_axis

  !> Keep the part of a line on which |start + s slope| <= half.
  pure subroutine clip_to_slab(start, slope, half, low, high)
    real(wp), intent(in) :: start !! coordinate at s = 0 [m]
    real(wp), intent(in) :: slope !! its change with s
    real(wp), intent(in) :: half !! half width of the slab [m]
    real(wp), intent(inout) :: low !! first s that is kept [m]
    real(wp), intent(inout) :: high !! last s that is kept; nothing is left when it is below the first [m]
    real(wp) :: ends(2)

    ! Parallel to the slab to rounding: all of it or nothing.
    if (abs(slope) < 1e-14_wp) then
      if (abs(start) > half) high = low - 1
      return
    end if
    ends = ([-half, half] - start)/slope
    low = max(low, minval(ends))
    high = min(high, maxval(ends))
  end subroutine clip_to_slab
end module sg_touch_axis
