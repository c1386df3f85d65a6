!> Contact of two cylinders with round ends (CYLND): the points within a radius of an axis.
!!
!! The nearest points of two segments are an end of one and its foot on the other, or points between the ends of both
!! where the segments cross. Nearly parallel cylinders also touch by the ends of what they share.
module sg_touch_cylinder_cylinder
  use sg_kinds, only: wp, i4
  use sg_touch_axis, only: perpendicular
  use sg_touch_space, only: touch_space_t, add_space_point
  use sg_vectors, only: cross
  implicit none
  private
  public :: touch_cylinder_cylinder

  !> Points nearer to each other than this, in radii, are one; a point this much nearer than another counts as nearer
  real(wp), parameter :: same_point = 1e-6_wp
  !> Sine of the angle up to which cylinders are nearly parallel: at a larger one, ends as near as the alert distance
  !! stand so close to the nearest point that they steady nothing
  real(wp), parameter :: nearly_parallel = 0.1_wp

contains

  !> Contact of two cylinders: the nearest points; for nearly parallel ones both ends of what they share, and the nearest
  !! points between these only where they are nearer by more than rounding and sagging.
  !!
  !! Features: 1 and 2 for the ends on the negative and the positive side of the candidate's axis, 3 for other points.
  pure subroutine touch_cylinder_cylinder(centre_c, axis_c, half_height_c, radius_c, centre_a, axis_a, half_height_a, &
                                          radius_a, alert, touch)
    real(wp), intent(in) :: centre_c(3) !! centre of the candidate [m]
    real(wp), intent(in) :: axis_c(3) !! unit vector of its axis
    real(wp), intent(in) :: half_height_c !! half length of its axis, caps not counted [m]
    real(wp), intent(in) :: radius_c !! its radius [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the antagonist [m]
    real(wp), intent(in) :: axis_a(3) !! unit vector of its axis
    real(wp), intent(in) :: half_height_a !! half length of its axis [m]
    real(wp), intent(in) :: radius_a !! its radius [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_space_t), intent(out) :: touch !! at most three points
    real(wp) :: between(3), reach, slack, normal(3), sine2, s(5), t(5), distance(5), along(5), turn
    logical :: is_shared(5), is_beside
    integer :: best, low, high

    between = centre_c - centre_a
    reach = max(0.0_wp, radius_c + radius_a + alert)
    if (between(1)**2 + between(2)**2 + between(3)**2 >= (half_height_c + half_height_a + reach)**2) return
    normal = cross(axis_c, axis_a)
    sine2 = normal(1)**2 + normal(2)**2 + normal(3)**2
    slack = same_point*(radius_c + radius_a)
    call pairs_of_ends(between, axis_c, half_height_c, axis_a, half_height_a, slack, s, t, is_shared)
    call pair_of_lines(between, axis_c, half_height_c, axis_a, half_height_a, normal, sine2, s(5), t(5), is_shared(5))
    do best = 1, 5
      distance(best) = norm2(between + s(best)*axis_c - t(best)*axis_a)
    end do
    best = minloc(distance, 1)
    if (distance(best) >= reach) return
    is_beside = .false.
    if (sine2 > nearly_parallel**2 .or. .not. any(is_shared)) then
      call add(touch, best, 3_i4)
      return
    end if
    turn = sign(1.0_wp, dot_product(axis_c, axis_a))
    along = s + turn*t
    low = minloc(along, 1, is_shared)
    high = maxloc(along, 1, is_shared)
    ! Twice as far apart along both axes together as along one
    is_beside = along(high) - along(low) > 4*slack
    call add(touch, low, 1_i4)
    if (is_beside) call add(touch, high, 2_i4)
    if (distance(best) < min(distance(low), distance(high)) - slack) call add(touch, best, 3_i4)
  contains
    !> Add the contact of one pair of points of the axes.
    pure subroutine add(touch, i, feature)
      type(touch_space_t), intent(inout) :: touch
      integer, intent(in) :: i
      integer(i4), intent(in) :: feature
      real(wp) :: unit(3)

      if (distance(i) > 4*epsilon(reach)*(sum(abs(between)) + half_height_c + half_height_a) + tiny(reach)) then
        unit = (between + s(i)*axis_c - t(i)*axis_a)/distance(i)
      else
        unit = normal_of_crossing(between, normal, sine2, axis_a, is_beside)
      end if
      call add_space_point(touch, centre_c + s(i)*axis_c - radius_c*unit, unit, distance(i) - (radius_c + radius_a), alert, feature)
    end subroutine add
  end subroutine touch_cylinder_cylinder

  !> Each end of either segment with the nearest point of the other: the first two are the candidate's ends.
  pure subroutine pairs_of_ends(between, axis_c, half_height_c, axis_a, half_height_a, slack, s, t, is_shared)
    real(wp), intent(in) :: between(3) !! from the antagonist's centre to the candidate's [m]
    real(wp), intent(in) :: axis_c(3), axis_a(3) !! unit vectors of the axes
    real(wp), intent(in) :: half_height_c, half_height_a !! half lengths of the axes [m]
    real(wp), intent(in) :: slack !! an end this far beyond the other's still counts as beside it [m]
    real(wp), intent(inout) :: s(5) !! place on the candidate's axis, the first four are set [m]
    real(wp), intent(inout) :: t(5) !! place on the antagonist's axis, the first four are set [m]
    logical, intent(inout) :: is_shared(5) !! is the other segment beside this end?
    real(wp) :: foot
    integer :: i

    do i = 1, 2
      s(i) = real(2*i - 3, wp)*half_height_c
      foot = dot_product(axis_a, between + s(i)*axis_c)
      is_shared(i) = abs(foot) <= half_height_a + slack
      t(i) = max(-half_height_a, min(half_height_a, foot))
      t(i + 2) = real(2*i - 3, wp)*half_height_a
      foot = dot_product(axis_c, t(i + 2)*axis_a - between)
      is_shared(i + 2) = abs(foot) <= half_height_c + slack
      s(i + 2) = max(-half_height_c, min(half_height_c, foot))
    end do
  end subroutine pairs_of_ends

  !> The nearest points of the lines through both segments, drawn back to the segments.
  pure subroutine pair_of_lines(between, axis_c, half_height_c, axis_a, half_height_a, normal, sine2, s, t, is_shared)
    real(wp), intent(in) :: between(3) !! from the antagonist's centre to the candidate's [m]
    real(wp), intent(in) :: axis_c(3), axis_a(3) !! unit vectors of the axes
    real(wp), intent(in) :: half_height_c, half_height_a !! half lengths of the axes [m]
    real(wp), intent(in) :: normal(3) !! vector product of the axes
    real(wp), intent(in) :: sine2 !! its square
    real(wp), intent(out) :: s !! place on the candidate's axis [m]
    real(wp), intent(out) :: t !! place on the antagonist's axis [m]
    logical, intent(out) :: is_shared !! never an end of what the segments share

    is_shared = .false.
    s = 0
    ! Below 1e-12 the angle is rounding, and an end is as near as any point.
    if (sine2 > 1e-24_wp) s = max(-half_height_c, min(half_height_c, -dot_product(cross(between, axis_a), normal)/sine2))
    t = max(-half_height_a, min(half_height_a, dot_product(axis_a, between + s*axis_c)))
    s = max(-half_height_c, min(half_height_c, dot_product(axis_c, t*axis_a - between)))
  end subroutine pair_of_lines

  !> Normal where axes meet: perpendicular to both, or away from the other's centre where two ends meet.
  pure function normal_of_crossing(between, normal, sine2, axis_a, is_beside)
    real(wp), intent(in) :: between(3) !! from the antagonist's centre to the candidate's [m]
    real(wp), intent(in) :: normal(3) !! vector product of the axes
    real(wp), intent(in) :: sine2 !! its square
    real(wp), intent(in) :: axis_a(3) !! unit vector of the antagonist's axis
    logical, intent(in) :: is_beside !! do the axes run beside each other?
    real(wp) :: normal_of_crossing(3)

    if (sine2 > 1e-24_wp) then
      normal_of_crossing = normal/sqrt(sine2)
    else if (is_beside .or. .not. norm2(between) > tiny(sine2)) then
      normal_of_crossing = perpendicular(axis_a)
    else
      normal_of_crossing = between/norm2(between)
      return
    end if
    if (dot_product(normal_of_crossing, between) < 0) normal_of_crossing = -normal_of_crossing
  end function normal_of_crossing
end module sg_touch_cylinder_cylinder
