!> Can two contactors be near each other? Cheap lower bounds of the gap decide which pairs become neighbours.
module sg_near
  use sg_contactors, only: contactors_t, kind_hollow, kind_hollow_cylinder, kind_plane, kind_segment
  use sg_kinds, only: wp, i4
  use sg_shape_kinds, only: is_bounding, is_round
  use sg_shape_pairs, only: is_pair
  implicit none
  private
  public :: is_near, candidate_first, farthest_arm, turning_arm, has_one_image

contains

  !> Is `i` the candidate of the pair? By the table of pairs; of one kind, the later contactor.
  pure logical function candidate_first(contactors, i, j)
    type(contactors_t), intent(in) :: contactors !! all contactors
    integer, intent(in) :: i !! one contactor
    integer, intent(in) :: j !! the other

    candidate_first = i > j
    if (contactors%kind(i) /= contactors%kind(j)) candidate_first = is_pair(int(contactors%kind(i)), int(contactors%kind(j)))
  end function candidate_first

  !> How far a contactor's bound moves per radian of its body [m].
  pure real(wp) function turning_arm(contactors, c) result(arm)
    type(contactors_t), intent(in) :: contactors !! all contactors
    integer, intent(in) :: c !! the one to look at

    arm = shift_length(contactors, c)
    if (is_bounding(contactors%kind(c)) .and. .not. is_round(contactors%kind(c))) arm = arm + contactors%reach(c)
  end function turning_arm

  !> Distance of the farthest point of a shape from the centre of its body [m], at most; zero for a round one about that centre, of
  !! which no turn moves anything towards others.
  pure real(wp) function farthest_arm(contactors, c) result(arm)
    type(contactors_t), intent(in) :: contactors !! all contactors
    integer, intent(in) :: c !! the one to look at

    arm = shift_length(contactors, c)
    if (.not. is_round(contactors%kind(c))) arm = arm + contactors%reach(c)
  end function farthest_arm

  !> How far the centre of a contactor is from that of its body [m], at most. Component by component: sums of unknown length are
  !! loops.
  pure real(wp) function shift_length(contactors, c) result(length)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c

    length = abs(contactors%shift(1, c)) + abs(contactors%shift(2, c))
    if (contactors%dimension == 3) length = length + abs(contactors%shift(3, c))
  end function shift_length

  !> Can the gap between two contactors, j moved by some periods, be below a distance?
  pure logical function is_near(contactors, i, j, offset, period, distance)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: i !! one contactor
    integer(i4), intent(in) :: j !! the other
    real(wp), intent(in) :: offset(3) !! by which j is moved [m]
    real(wp), intent(in) :: period(3) !! in x, y and z, zero where not periodic [m]
    real(wp), intent(in) :: distance !! [m]
    real(wp) :: apart(3), limit
    real(wp), parameter :: rounded = 1 + 16*epsilon(1.0_wp)

    ! Component by component: differences of unknown length go through memory that is allocated.
    apart(1) = contactors%centre(1, i) - contactors%centre(1, j) - offset(1)
    apart(2) = contactors%centre(2, i) - contactors%centre(2, j) - offset(2)
    apart(3) = -offset(3)
    if (contactors%dimension == 3) apart(3) = contactors%centre(3, i) - contactors%centre(3, j) - offset(3)
    if (is_bounding(contactors%kind(j))) then
      is_near = near_bounding(contactors, j, apart, contactors%reach(i), period, distance)
    else if (is_bounding(contactors%kind(i))) then
      is_near = near_bounding(contactors, i, -apart, contactors%reach(j), period, distance)
    else
      ! Most are far: a square decides, without a root. Where rounding might matter the distance itself decides.
      limit = rounded*max(0.0_wp, contactors%reach(i) + contactors%reach(j) + distance)
      is_near = apart(1)**2 + apart(2)**2 + apart(3)**2 <= limit**2
      if (is_near) is_near = norm2(apart) - contactors%reach(i) - contactors%reach(j) < distance
    end if
  end function is_near

  !> Can the gap to a bounding shape be below a distance? By the bound of its kind.
  pure logical function near_bounding(contactors, bounding, apart, reach, period, distance)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: bounding
    real(wp), intent(in) :: apart(3), reach, period(3), distance

    select case (contactors%kind(bounding))
    case (kind_hollow)
      near_bounding = contactors%reach(bounding) - norm2(apart) - reach < distance
    case (kind_plane)
      near_bounding = near_plane(contactors, bounding, apart, reach, distance)
    case (kind_hollow_cylinder)
      near_bounding = near_hollow_cylinder(contactors, bounding, apart, reach, distance)
    case default
      near_bounding = near_segment(contactors, bounding, apart, reach, distance)
    end select
    if (near_bounding) near_bounding = is_the_one(contactors, bounding, apart, period)
  end function near_bounding

  !> Against a rounded segment: distance to its axis.
  pure logical function near_segment(contactors, bounding, apart, reach, distance)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: bounding
    real(wp), intent(in) :: apart(3), reach, distance
    real(wp) :: axis(2), along, across, half_length

    associate (row => contactors%row(bounding))
      axis = contactors%segment_axis(:, row)
      half_length = contactors%segment_size(1, row)
      along = max(0.0_wp, abs(dot_product(apart(:2), axis)) - half_length)
      across = apart(1)*axis(2) - apart(2)*axis(1)
      ! The distance to its line decides for most.
      near_segment = abs(across) - contactors%segment_size(2, row) - reach < distance
      if (near_segment) near_segment = hypot(along, across) - contactors%segment_size(2, row) - reach < distance
    end associate
  end function near_segment

  !> Against a plane: distance to its box.
  pure logical function near_plane(contactors, bounding, apart, reach, distance)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: bounding
    real(wp), intent(in) :: apart(3), reach, distance
    real(wp) :: frame(3, 3), half(3), beyond(3)

    frame = reshape(contactors%space%plane_world(:, contactors%row(bounding)), [3, 3])
    half = contactors%space%plane_half(:, contactors%row(bounding))
    half(:2) = half(:2) + contactors%space%plane_rim(contactors%row(bounding))
    beyond = max(0.0_wp, abs(matmul(apart, frame)) - half)
    near_plane = norm2(beyond) - reach < distance
  end function near_plane

  !> Of the images of a contactor of which one alone is seen, is this the one?
  pure logical function is_the_one(contactors, bounding, apart, period)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: bounding
    real(wp), intent(in) :: apart(3), period(3)
    logical :: is_single(2)
    integer :: axis

    is_the_one = .true.
    is_single = has_one_image(contactors, bounding, period(:2))
    do axis = 1, 2
      if (is_single(axis)) is_the_one = is_the_one .and. is_nearest(apart(axis)/period(axis))
    end do
  end function is_the_one

  !> Is a contactor seen in one image alone, the nearest, in x and in y? The images of a segment or a plane as long as a period
  !! bound as one; of a hollow shape the nearest image holds what is within, and all others would draw it in.
  pure function has_one_image(contactors, c, period) result(is_single)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: c !! the one to look at
    real(wp), intent(in) :: period(2) !! in x and y, zero where not periodic [m]
    logical :: is_single(2)
    real(wp) :: frame(3, 3), half(3)
    integer :: axis

    is_single = .false.
    if (.not. any(period > 0)) return
    associate (row => contactors%row(c))
      select case (contactors%kind(c))
      case (kind_hollow, kind_hollow_cylinder)
        is_single = .true.
      case (kind_segment)
        is_single(1) = 2*contactors%segment_size(1, row)*abs(contactors%segment_axis(1, row)) >= period(1)
      case (kind_plane)
        frame = reshape(contactors%space%plane_world(:, row), [3, 3])
        half = contactors%space%plane_half(:, row)
        half(:2) = half(:2) + contactors%space%plane_rim(row)
        do axis = 1, 2
          is_single(axis) = 2*dot_product(half, abs(frame(axis, :))) >= period(axis)
        end do
      end select
    end associate
    is_single = is_single .and. period > 0
  end function has_one_image

  !> Against a hollow cylinder: between its ends, and not far inside its surface.
  pure logical function near_hollow_cylinder(contactors, bounding, apart, reach, distance) result(is_near)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: bounding
    real(wp), intent(in) :: apart(3), reach, distance
    real(wp) :: along, axis(3)

    axis = contactors%space%hollow_world(:, contactors%row(bounding))
    along = dot_product(apart, axis)
    associate (size => contactors%space%hollow_size(:, contactors%row(bounding)))
      is_near = abs(along) - size(1) - reach < distance .and. size(2) - norm2(apart - along*axis) - reach < distance
    end associate
  end function near_hollow_cylinder

  !> Is no other image nearer? Of two as near, it is the one on the right.
  pure logical function is_nearest(periods)
    real(wp), intent(in) :: periods !! how many periods the image is away

    is_nearest = periods >= -0.5_wp .and. periods < 0.5_wp
  end function is_nearest
end module sg_near
