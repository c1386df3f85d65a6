!> `splitgrain convert`: an LMGC90 DATBOX folder to a deck that uses it, or the scene of a deck, at its start or in the state
!! of a restart file, to a DATBOX folder.
module sg_convert
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_arguments, only: arguments_t
  use sg_comm, only: comm_t
  use sg_datbox, only: read_datbox
  use sg_datbox_deck, only: write_datbox_deck
  use sg_error, only: diagnostics_t, error_t, exit_bad_input, exit_done, fail
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_scene_argument, only: read_scene_argument
  use sg_system, only: file_exists
  use sg_write_state, only: write_state
  implicit none
  private
  public :: convert_command

contains

  !> Convert; nothing that exists is written over.
  subroutine convert_command(arguments, comm, code, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(comm_t), intent(in) :: comm !! this rank alone
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! error of the command
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics

    code = exit_done
    call arguments%expect('restart', 2, 2, 'convert SOURCE TARGET [--restart FILE]', error)
    if (allocated(error)) return
    associate (source => arguments%words(1)%s, target => arguments%words(2)%s)
      if (is_deck(target) .eqv. is_deck(source)) then
        call fail(error, 'one of the two must be a deck, *.toml, and the other a DATBOX folder')
      else if (file_exists(target)) then
        call fail(error, 'this exists and is not written over', file=target)
      else if (is_deck(target)) then
        call read_datbox(source, scene, diagnostics)
        call diagnostics%print(error_unit)
        if (diagnostics%count() > 0) code = exit_bad_input
        if (code == exit_done) call write_datbox_deck(source, target, scene, error)
      else
        call read_scene_argument(arguments, comm, scene, options, code, error)
        if (code == exit_done) call write_state(options, scene, target, error)
      end if
    end associate
  end subroutine convert_command

  !> Is this the name of a deck?
  pure logical function is_deck(name)
    character(len=*), intent(in) :: name

    is_deck = index(name, '.toml', back=.true.) == len(name) - 4 .and. len(name) > 5
  end function is_deck
end module sg_convert
