!> Overlap that is undone: refused where a law needs it (doc/theory/recovery.md).
module sg_recovery_checks
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_laws, only: allows_pushes
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  implicit none
  private
  public :: check_recovery

contains

  !> Refuse to undo overlap under laws that need it.
  subroutine check_recovery(deck, scene, options, diagnostics)
    type(deck_t), intent(inout) :: deck !! checked deck
    type(scene_t), intent(in) :: scene !! scene with its laws
    type(run_options_t), intent(in) :: options !! options read from the deck
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: i

    if (.not. options%recovery > 0 .or. .not. allocated(scene%laws)) return
    do i = 1, size(scene%laws)
      if (allows_pushes(scene%laws(i))) cycle
      call deck%complain(diagnostics, 'overlap cannot be undone under the law "'//scene%laws(i)%name//'": it loads an elastic '// &
                         'contact, or shapes are held together', deck%block_of('time'), 'recovery')
      return
    end do
  end subroutine check_recovery
end module sg_recovery_checks
