!> Who sees whom: which line of the see tables holds between two contactors.
module sg_sees
  use sg_contactors, only: n_kinds
  use sg_scene, only: scene_t, see_t
  implicit none
  private
  public :: see_between, see_of, blind_pairs

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
      see = see_of(scene%sees, int([kind(c1), kind(c2)]), int([colour(c1), colour(c2)]))
    end associate
  end function see_between

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

      fits = (s%candidate_kind == 0 .or. s%candidate_kind == kind(1)) .and. &
             (s%candidate_colour == 0 .or. s%candidate_colour == colour(1)) .and. &
             (s%antagonist_kind == 0 .or. s%antagonist_kind == kind(2)) .and. &
             (s%antagonist_colour == 0 .or. s%antagonist_colour == colour(2))
    end function fits
  end function see_of

  !> Which kinds of shape a line of the see tables brings together in vain, shape (kinds, kinds): they cannot touch each
  !! other, although two bodies have them of which one at least counts.
  pure function blind_pairs(scene, line, counts, others) result(blind)
    type(scene_t), intent(in) :: scene !! scene with its see tables
    integer, intent(in) :: line !! line of the see tables
    logical, intent(in) :: counts(:) !! bodies that count, shape (bodies)
    integer, allocatable, intent(in) :: others(:, :) !! kinds and colours of other bodies, which all count, shape (2, any); perhaps
    !! unallocated
    logical :: blind(n_kinds, n_kinds)
    integer :: i, j

    blind = .false.
    if (scene%contactors%n == 0) return
    associate (kind => scene%contactors%kind(:scene%contactors%n), colour => scene%contactors%colour(:scene%contactors%n), &
               s => scene%sees(line))
      do j = 1, n_kinds
        do i = 1, n_kinds
          blind(i, j) = .not. can_touch(i, j) .and. any(s%candidate_kind == [0, i]) .and. any(s%antagonist_kind == [0, j])
          if (blind(i, j)) blind(i, j) = is_pair(kind == i .and. (s%candidate_colour == 0 .or. s%candidate_colour == colour), &
                                                 kind == j .and. (s%antagonist_colour == 0 .or. s%antagonist_colour == colour))
          if (can_touch(i, j)) cycle
          blind(i, j) = blind(i, j) .or. (is_other(i, [s%candidate_kind, s%candidate_colour]) .and. &
                                          is_here(j, [s%antagonist_kind, s%antagonist_colour])) .or. &
                        (is_other(j, [s%antagonist_kind, s%antagonist_colour]) .and. &
                         is_here(i, [s%candidate_kind, s%candidate_colour]))
        end do
      end do
      blind = blind .or. transpose(blind)
    end associate
  contains
    !> Is there a contactor of a kind and of a look that a line asks for? Zero asks for any.
    pure logical function is_here(kind, look)
      integer, intent(in) :: kind, look(2)

      associate (contactors => scene%contactors)
        is_here = any(look(1) == [0, kind]) .and. any(contactors%kind(:contactors%n) == kind .and. &
                                                      (look(2) == 0 .or. contactors%colour(:contactors%n) == look(2)))
      end associate
    end function is_here

    !> The same among the other bodies.
    pure logical function is_other(kind, look)
      integer, intent(in) :: kind, look(2)

      is_other = .false.
      if (.not. allocated(others)) return
      is_other = any(look(1) == [0, kind]) .and. any(others(1, :) == kind .and. (look(2) == 0 .or. others(2, :) == look(2)))
    end function is_other

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
