!> `splitgrain convert`: an LMGC90 DATBOX folder to a deck that uses it, or the scene of a deck, at its start or in the state
!! of a restart file, to a DATBOX folder.
module sg_convert
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_datbox, only: read_datbox
  use sg_datbox_deck, only: write_datbox_deck
  use sg_datbox_write, only: write_datbox
  use sg_datbox_write_contacts, only: contacts_at_start, datbox_contacts_t
  use sg_deck, only: read_deck
  use sg_error, only: diagnostics_t, error_t, exit_bad_input, exit_done, fail
  use sg_kinds, only: wp
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_scene_at_restart, only: scene_at_restart
  use sg_system, only: file_exists
  use sg_text, only: text_t
  implicit none
  private
  public :: convert_command

contains

  !> Convert; nothing that exists is written over.
  subroutine convert_command(source, target, restart, code)
    character(len=*), intent(in) :: source !! DATBOX folder, or deck
    character(len=*), intent(in) :: target !! deck, or DATBOX folder
    character(len=*), intent(in) :: restart !! restart file or folder of results; empty for the start of the deck
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
      if (diagnostics%count() == 0) call write_state(restart, options, scene, target, diagnostics, error)
    end if
    call diagnostics%print(error_unit)
    if (allocated(error)) write (error_unit, '(a)') error%report()
    code = exit_done
    if (diagnostics%count() > 0) code = exit_bad_input
    if (allocated(error)) code = error%code
  end subroutine convert_command

  !> Write a scene as DATBOX files, in the state of a restart file where one is given.
  subroutine write_state(restart, options, scene, target, warnings, error)
    character(len=*), intent(in) :: restart, target
    type(run_options_t), intent(in) :: options
    type(scene_t), intent(inout) :: scene
    type(diagnostics_t), intent(inout) :: warnings
    type(error_t), allocatable, intent(out) :: error
    type(datbox_contacts_t) :: contacts
    real(wp) :: time
    integer :: step

    time = scene%start_time
    step = scene%start_step
    if (len(restart) == 0) then
      contacts = contacts_at_start(scene)
    else
      call scene_at_restart(restart, options, scene, contacts, time, step, warnings, error)
      if (allocated(error)) return
      step = step + scene%start_step
    end if
    call write_datbox(target, scene, contacts, time, step, error)
    if (scene%period > 0) write (error_unit, '(a)') 'note: a DATBOX does not hold the period in x'
    if (scene%links%n > 0) write (error_unit, '(a)') 'note: the script of LMGC90 must call '// &
      merge('PTPT2', 'PTPT3', scene%dimension == 2)//'_LoadNetwork, and LoadParams where there are NARD rods'
    if (size(scene%pressures) > 0) write (error_unit, '(a)') 'note: a DATBOX does not hold pressures'
  end subroutine write_state

  !> Is this the name of a deck?
  pure logical function is_deck(name)
    character(len=*), intent(in) :: name

    is_deck = index(name, '.toml', back=.true.) == len(name) - 4 .and. len(name) > 5
  end function is_deck
end module sg_convert
