!> Overlap that is undone: not where a law needs it (doc/theory/recovery.md).
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

  !> Leave overlap alone under laws that need it; a deck that asks to undo it there is refused.
  subroutine check_recovery(deck, scene, options, diagnostics)
    type(deck_t), intent(inout) :: deck !! checked deck
    type(scene_t), intent(in) :: scene !! scene with its laws
    type(run_options_t), intent(inout) :: options !! options read from the deck
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer :: i, b

    if (.not. options%recovery > 0 .or. .not. allocated(scene%laws)) return
    b = deck%block_of('time')
    do i = 1, size(scene%laws)
      if (allows_pushes(scene%laws(i))) cycle
      if (deck%is_given(b, 'recovery')) &
        call deck%complain(diagnostics, 'overlap cannot be undone under the law "'//scene%laws(i)%name//'": it loads an '// &
                           'elastic contact, or shapes are held together', b, 'recovery')
      options%recovery = 0
      return
    end do
  end subroutine check_recovery
end module sg_recovery_checks
