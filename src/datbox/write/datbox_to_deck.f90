!> A DATBOX to a deck that uses it, with keys from its COMMAND.DAT and POSTPRO.DAT and from settings.
module sg_datbox_to_deck
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_datbox, only: read_datbox
  use sg_datbox_command, only: read_command_file
  use sg_datbox_deck, only: write_datbox_deck
  use sg_datbox_postpro, only: read_postpro
  use sg_datbox_settings, only: datbox_settings_t
  use sg_error, only: diagnostics_t, error_t, exit_bad_input, exit_done
  use sg_scene, only: scene_t
  use sg_text, only: text_t
  implicit none
  private
  public :: datbox_to_deck

contains

  !> Write a deck that uses a DATBOX, with what its COMMAND.DAT and POSTPRO.DAT give, and settings over it.
  subroutine datbox_to_deck(folder, deck, set, code, error)
    character(len=*), intent(in) :: folder !! DATBOX folder
    character(len=*), intent(in) :: deck !! deck to write, not there yet
    type(text_t), intent(in) :: set(:) !! settings `section.key=value`, which go before all else
    integer, intent(out) :: code !! that of bad input where the folder or a setting has mistakes, which are printed
    type(error_t), allocatable, intent(out) :: error !! set when the deck cannot be written
    type(scene_t) :: scene
    type(datbox_settings_t) :: settings
    type(diagnostics_t) :: diagnostics
    logical :: is_setting
    integer :: i

    code = exit_done
    call read_datbox(folder, scene, diagnostics)
    if (diagnostics%count() == 0) then
      call read_command_file(folder, settings, diagnostics)
      call read_postpro(folder, scene%bodies%n, settings, diagnostics)
    end if
    do i = 1, size(set)
      call settings%put_setting(set(i)%s, is_setting)
      if (.not. is_setting) call diagnostics%add('"'//set(i)%s//'" is not of the form section.key=value', file='--set')
    end do
    call diagnostics%print(error_unit)
    if (diagnostics%count() > 0) code = exit_bad_input
    if (code == exit_done) call write_datbox_deck(folder, deck, scene, settings, error)
  end subroutine datbox_to_deck
end module sg_datbox_to_deck
