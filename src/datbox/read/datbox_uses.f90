!> Warnings about see tables of a DATBOX that earlier ones hide, about contact laws that none names, and about contactors that touch
!! nothing: one line per kind.
module sg_datbox_uses
  use sg_census, only: census_t
  use sg_datbox_lines, only: datbox_file_t, go_to, remark
  use sg_datbox_sees, only: datbox_kind_name
  use sg_error, only: diagnostics_t
  use sg_scene, only: scene_t
  use sg_sees_used, only: find_uses, see_uses_t
  use sg_text, only: to_text
  implicit none
  private
  public :: warn_of_unused_sees

contains

  !> Warn of what TACT_BEHAV.DAT lists in vain and of what it leaves out.
  subroutine warn_of_unused_sees(scene, others, see_lines, is_named, file, diagnostics)
    type(scene_t), intent(in) :: scene !! scene with bodies and see tables
    type(census_t), intent(in) :: others !! bodies that other ranks keep
    integer, intent(in) :: see_lines(:) !! line of each see table, which come before those of a deck
    logical, intent(in) :: is_named(:) !! of the laws of the folder, the first ones: do links or bonds of a deck name them?
    type(datbox_file_t), intent(inout) :: file !! TACT_BEHAV.DAT
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered
    type(see_uses_t) :: uses
    integer :: i

    call find_uses(scene, others%looks, uses)
    do i = 1, size(see_lines)
      if (uses%line(i) < 1) cycle
      call go_to(file, see_lines(i))
      call remark(file, 'hidden see table', 'this see table has no effect: that of line '//to_text(see_lines(uses%line(i)))// &
                  ' comes first and takes all its contactors', 1, diagnostics)
    end do
    do i = 1, size(is_named)
      if (is_named(i) .or. any(scene%sees%law == i)) cycle
      call diagnostics%warn('no see table names the contact law '''//scene%laws(i)%name//'''', file=file%path, kind='unused law')
    end do
    do i = 1, size(uses%alone, 2)
      call diagnostics%warn('no see table fits '//datbox_kind_name(uses%alone(1, i), scene%dimension)//' of colour '''// &
                            scene%colours(uses%alone(2, i))%s//''', which touches nothing; an [[interaction]] of a deck may '// &
                            'bring it together with others', file=file%path, kind='touches nothing')
    end do
  end subroutine warn_of_unused_sees
end module sg_datbox_uses
