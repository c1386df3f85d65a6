!> Interactions: the line of the see tables that holds between two contactors.
module sg_sees
  use sg_contactors, only: kind_point, n_kinds
  use sg_kinds, only: wp, i4
  use sg_scene, only: scene_t, see_t
  use sg_shape_pairs, only: can_touch
  implicit none
  private
  public :: alert_of, follows_motion, see_between, see_named, see_of, blind_pairs, links_points, widest_alert

contains

  !> Line of the see tables that holds between two contactors; 0 when they do not see each other.
  pure integer function see_between(scene, c1, c2) result(see)
    type(scene_t), intent(in) :: scene !! scene with its see tables
    integer, intent(in) :: c1 !! one contactor
    integer, intent(in) :: c2 !! the other

    associate (kind => scene%contactors%kind, colour => scene%contactors%colour)
      see = see_of(scene%sees, int([kind(c1), kind(c2)]), int([colour(c1), colour(c2)]))
    end associate
  end function see_between

  !> Line of the see tables that names the bodies of two contactors, the last one of several; else the line given.
  pure integer(i4) function see_named(scene, see, c1, c2) result(named)
    type(scene_t), intent(in) :: scene !! scene whose see tables name bodies
    integer(i4), intent(in) :: see !! line that holds by colours; 0 for none
    integer(i4), intent(in) :: c1 !! one contactor
    integer(i4), intent(in) :: c2 !! the other
    integer :: body(2), line

    named = see
    body = scene%contactors%body([c1, c2])
    if (allocated(scene%bodies%id)) body = scene%bodies%id(body)
    do line = size(scene%sees), 1, -1
      if (scene%sees(line)%group == 0) cycle
      associate (group => scene%groups(scene%sees(line)%group))
        if (.not. (is_in(group%is_one, body(1)) .and. is_in(group%is_other, body(2))) .and. &
            .not. (is_in(group%is_one, body(2)) .and. is_in(group%is_other, body(1)))) cycle
        if (can_touch(int(scene%contactors%kind(c1)), int(scene%contactors%kind(c2)))) named = int(line, i4)
        return
      end associate
    end do
  contains
    pure logical function is_in(marks, number)
      logical, intent(in) :: marks(:)
      integer, intent(in) :: number

      is_in = number <= size(marks)
      if (is_in) is_in = marks(number)
    end function is_in
  end function see_named

  !> Line of the see tables that holds between shapes of two kinds and colours; 0 when they do not see each other.
  pure integer function see_of(sees, kind, colour) result(see)
    type(see_t), intent(in) :: sees(:) !! the see tables
    integer, intent(in) :: kind(2) !! their kinds
    integer, intent(in) :: colour(2) !! their colours

    if (can_touch(kind(1), kind(2))) then
      do see = 1, size(sees)
        if (fits(sees(see), kind, colour)) return
        if (fits(sees(see), kind([2, 1]), colour([2, 1]))) return
      end do
    end if
    see = 0
  contains
    pure logical function fits(s, kind, colour)
      type(see_t), intent(in) :: s
      integer, intent(in) :: kind(2), colour(2)

      fits = s%group == 0 .and. &
             (s%candidate_kind == 0 .or. s%candidate_kind == kind(1)) .and. &
             (s%candidate_colour == 0 .or. s%candidate_colour == colour(1)) .and. &
             (s%antagonist_kind == 0 .or. s%antagonist_kind == kind(2)) .and. &
             (s%antagonist_colour == 0 .or. s%antagonist_colour == colour(2))
    end function fits
  end function see_of

  !> Does a line of the see tables link points? Such a line is used at the start alone.
  pure elemental logical function links_points(see)
    type(see_t), intent(in) :: see !! the line

    links_points = see%candidate_kind == kind_point .and. see%antagonist_kind == kind_point
  end function links_points

  !> Gap below which contacts exist under a line of the see tables [m].
  pure elemental real(wp) function alert_of(see, way)
    type(see_t), intent(in) :: see !! the line
    real(wp), intent(in) :: way !! by which two shapes may come nearer to each other [m]

    alert_of = min(see%alert, max(see%least_alert, way))
  end function alert_of

  !> Does the alert distance of a line follow the motion of each step?
  pure elemental logical function follows_motion(see)
    type(see_t), intent(in) :: see !! the line

    follows_motion = see%least_alert < see%alert
  end function follows_motion

  !> Largest alert distance at which contacts exist [m].
  pure real(wp) function widest_alert(sees, way)
    type(see_t), intent(in) :: sees(:) !! the see tables
    real(wp), intent(in) :: way !! by which two shapes may come nearer to each other [m]

    widest_alert = max(0.0_wp, maxval(alert_of(sees, way), .not. links_points(sees)))
  end function widest_alert

  !> Which kinds of shape a line of the see tables brings together in vain, shape (kinds, kinds): they cannot touch each
  !! other, although two bodies have them of which one at least counts.
  pure function blind_pairs(scene, line, counts, others) result(blind)
    type(scene_t), intent(in) :: scene !! scene with its see tables
    integer, intent(in) :: line !! line of the see tables
    logical, intent(in) :: counts(:) !! bodies that count, shape (bodies)
    integer, allocatable, intent(in) :: others(:, :) !! kinds and colours of other bodies, which all count, with the first and the
    !! last body of each, shape (4, any); perhaps unallocated
    logical :: blind(n_kinds, n_kinds)
    integer :: candidate(4, n_kinds), antagonist(4, n_kinds), i, j

    associate (s => scene%sees(line))
      candidate = bodies_seen(scene, [s%candidate_kind, s%candidate_colour], counts, others)
      antagonist = bodies_seen(scene, [s%antagonist_kind, s%antagonist_colour], counts, others)
    end associate
    do j = 1, n_kinds
      do i = 1, n_kinds
        blind(i, j) = .not. can_touch(i, j) .and. (has_other(candidate(:, i), antagonist(:, j)) .or. &
                                                   has_other(antagonist(:, j), candidate(:, i)))
      end do
    end do
    blind = blind .or. transpose(blind)
  contains
    !> Does a body that counts in the first set stand beside another body of the second?
    pure logical function has_other(first, second)
      integer, intent(in) :: first(4), second(4)

      has_other = first(3) <= first(4) .and. second(1) <= second(2)
      if (has_other) has_other = .not. all([first(3:4), second(1:2)] == first(3))
    end function has_other
  end function blind_pairs

  !> Of the bodies with a shape of each kind that a side of a see table asks for: numbers of the first and the last one, and of
  !! the first and the last that count.
  pure function bodies_seen(scene, look, counts, others) result(ends)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: look(2) !! kind and colour that are asked for; zero for any
    logical, intent(in) :: counts(:)
    integer, allocatable, intent(in) :: others(:, :)
    integer :: ends(4, n_kinds), c, number

    ends = spread([huge(1), 0, huge(1), 0], 2, n_kinds)
    do c = 1, scene%contactors%n
      associate (body => scene%contactors%body(c))
        number = body
        if (allocated(scene%bodies%id)) number = scene%bodies%id(body)
        call note(int(scene%contactors%kind(c)), int(scene%contactors%colour(c)), [number, number], counts(body))
      end associate
    end do
    if (.not. allocated(others)) return
    do c = 1, size(others, 2)
      call note(others(1, c), others(2, c), others(3:, c), .true.)
    end do
  contains
    pure subroutine note(kind, colour, numbers, is_counted)
      integer, intent(in) :: kind, colour, numbers(2)
      logical, intent(in) :: is_counted

      if (all(look(1) /= [0, kind]) .or. all(look(2) /= [0, colour])) return
      ends(1, kind) = min(ends(1, kind), numbers(1))
      ends(2, kind) = max(ends(2, kind), numbers(2))
      if (.not. is_counted) return
      ends(3, kind) = min(ends(3, kind), numbers(1))
      ends(4, kind) = max(ends(4, kind), numbers(2))
    end subroutine note
  end function bodies_seen
end module sg_sees
