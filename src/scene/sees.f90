!> Who sees whom: which line of the see tables holds between two contactors.
module sg_sees
  use sg_contactors, only: n_kinds
  use sg_scene, only: scene_t
  implicit none
  private
  public :: can_touch, see_between

  !> Which kinds of shape can touch each other, shape (kinds, kinds)
  logical, parameter :: can_touch(n_kinds, n_kinds) = reshape([ &
    ! disk    wall    hollow  polygon
    .true., .true., .true., .true., &
    .true., .false., .false., .true., &
    .true., .false., .false., .false., &
    .true., .true., .false., .true.], [n_kinds, n_kinds])

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

end module sg_sees
