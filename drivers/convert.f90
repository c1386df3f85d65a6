!> `splitgrain convert`: an LMGC90 DATBOX folder to a deck that uses it, or the scene of a deck to a DATBOX folder.
module sg_convert
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_datbox, only: read_datbox
  use sg_datbox_deck, only: write_datbox_deck
  use sg_datbox_write, only: contacts_at_start, write_datbox
  use sg_deck, only: read_deck
  use sg_error, only: diagnostics_t, error_t, exit_bad_input, exit_done, fail
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_system, only: file_exists
  use sg_text, only: text_t
  implicit none
  private
  public :: convert_command

contains

  !> Convert; nothing that exists is written over.
  subroutine convert_command(source, target, code)
    character(len=*), intent(in) :: source !! DATBOX folder, or deck
    character(len=*), intent(in) :: target !! deck, or DATBOX folder
    integer, intent(out) :: code !! exit code
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error
    type(text_t) :: no_settings(0)

    if (is_deck(target) .eqv. is_deck(source)) then
      call fail(error, 'one of the two must be a deck, *.toml, and the other a DATBOX folder')
    else if (file_exists(target)) then
      call fail(error, 'this exists and is not written over', file=target)
    else if (is_deck(target)) then
      call read_datbox(source, scene, diagnostics)
      if (diagnostics%count() == 0) call write_datbox_deck(source, target, scene, error)
    else
      call read_deck(source, no_settings, scene, options, diagnostics)
      if (diagnostics%count() == 0) then
        call write_datbox(target, scene, contacts_at_start(scene), scene%start_time, int(scene%start_step), error)
        if (scene%period > 0) write (error_unit, '(a)') 'note: a DATBOX does not hold the period in x'
        if (size(scene%pressures) > 0) write (error_unit, '(a)') 'note: a DATBOX does not hold pressures'
      end if
    end if
    call diagnostics%print(error_unit)
    if (allocated(error)) write (error_unit, '(a)') error%report()
    code = exit_done
    if (diagnostics%count() > 0) code = exit_bad_input
    if (allocated(error)) code = error%code
  end subroutine convert_command

  !> Is this the name of a deck?
  pure logical function is_deck(name)
    character(len=*), intent(in) :: name

    is_deck = index(name, '.toml', back=.true.) == len(name) - 4 .and. len(name) > 5
  end function is_deck
end module sg_convert
