!> Who sees whom: which line of the see tables holds between two contactors.
module sg_sees
  use sg_contactors, only: n_kinds
  use sg_scene, only: scene_t
  implicit none
  private
  public :: see_between, blind_pairs

  !> Which kinds of shape can touch each other, shape (kinds, kinds)
  logical, parameter :: can_touch(n_kinds, n_kinds) = reshape([ &
    ! disk   wall     hollow   polygon  sphere   plane    cylinder hollow c. polyhedron
    .true., .true., .true., .true., .false., .false., .false., .false., .false., &
    .true., .false., .false., .true., .false., .false., .false., .false., .false., &
    .true., .false., .false., .false., .false., .false., .false., .false., .false., &
    .true., .true., .false., .true., .false., .false., .false., .false., .false., &
    .false., .false., .false., .false., .true., .true., .true., .true., .true., &
    .false., .false., .false., .false., .true., .false., .true., .false., .true., &
    .false., .false., .false., .false., .true., .true., .true., .true., .false., &
    .false., .false., .false., .false., .true., .false., .true., .false., .false., &
    .false., .false., .false., .false., .true., .true., .false., .false., .true.], [n_kinds, n_kinds])

contains

  !> Line of the see tables that holds between two contactors; 0 when they do not see each other.
  pure integer function see_between(scene, c1, c2) result(see)
    type(scene_t), intent(in) :: scene !! scene with its see tables
    integer, intent(in) :: c1 !! one contactor
    integer, intent(in) :: c2 !! the other

    associate (kind => scene%contactors%kind, colour => scene%contactors%colour)
      if (can_touch(kind(c1), kind(c2))) then
        do see = 1, size(scene%sees)
          if (fits(see, kind(c1), colour(c1), kind(c2), colour(c2))) return
          if (fits(see, kind(c2), colour(c2), kind(c1), colour(c1))) return
        end do
      end if
    end associate
    see = 0
  contains
    pure logical function fits(line, kind_c, colour_c, kind_a, colour_a)
      integer, intent(in) :: line, kind_c, colour_c, kind_a, colour_a

      associate (s => scene%sees(line))
        fits = (s%candidate_kind == 0 .or. s%candidate_kind == kind_c) .and. &
               (s%candidate_colour == 0 .or. s%candidate_colour == colour_c) .and. &
               (s%antagonist_kind == 0 .or. s%antagonist_kind == kind_a) .and. &
               (s%antagonist_colour == 0 .or. s%antagonist_colour == colour_a)
      end associate
    end function fits
  end function see_between

  !> Which kinds of shape a line of the see tables brings together in vain, shape (kinds, kinds): they cannot touch each
  !! other, although two bodies have them of which one at least counts.
  pure function blind_pairs(scene, line, counts) result(blind)
    type(scene_t), intent(in) :: scene !! scene with its see tables
    integer, intent(in) :: line !! line of the see tables
    logical, intent(in) :: counts(:) !! bodies that count, shape (bodies)
    logical :: blind(n_kinds, n_kinds)
    integer :: i, j

    associate (kind => scene%contactors%kind(:scene%contactors%n), colour => scene%contactors%colour(:scene%contactors%n), &
               s => scene%sees(line))
      do j = 1, n_kinds
        do i = 1, n_kinds
          blind(i, j) = .not. can_touch(i, j) .and. any(s%candidate_kind == [0, i]) .and. any(s%antagonist_kind == [0, j])
          if (blind(i, j)) blind(i, j) = is_pair(kind == i .and. (s%candidate_colour == 0 .or. s%candidate_colour == colour), &
                                                 kind == j .and. (s%antagonist_colour == 0 .or. s%antagonist_colour == colour))
        end do
      end do
      blind = blind .or. transpose(blind)
    end associate
  contains
    !> Do two sets of contactors hold a pair of bodies of which one counts?
    pure logical function is_pair(first, second)
      logical, intent(in) :: first(:), second(:)

      is_pair = has_other(first, second) .or. has_other(second, first)
    end function is_pair

    !> Does a body that counts in the first set stand beside another body of the second?
    pure logical function has_other(first, second)
      logical, intent(in) :: first(:), second(:)

      associate (body => scene%contactors%body(:scene%contactors%n))
        has_other = any(second)
        if (has_other) has_other = any(first .and. counts(body) .and. &
                                       .not. (body == minval(body, second) .and. body == maxval(body, second)))
      end associate
    end function has_other
  end function blind_pairs
end module sg_sees
