!> `splitgrain convert`: an LMGC90 DATBOX folder to a deck that uses it, or the scene of a deck, at its start or in the state
!! of a restart file, to a DATBOX folder.
module sg_convert
  use sg_arguments, only: arguments_t
  use sg_comm, only: comm_t
  use sg_datbox_to_deck, only: datbox_to_deck
  use sg_error, only: error_t, exit_done, fail
  use sg_python_tasks, only: is_deck
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

    code = exit_done
    call arguments%expect('restart script set', 2, 2, 'convert SOURCE TARGET [options]', error)
    if (allocated(error)) return
    associate (source => arguments%words(1)%s, target => arguments%words(2)%s)
      if (is_deck(target) .eqv. is_deck(source)) then
        call fail(error, 'one of the two must be a deck, *.toml, and the other a DATBOX folder')
      else if (arguments%has('script') .and. .not. is_deck(target)) then
        call fail(error, 'option --script is for a DATBOX that becomes a deck')
      else if (file_exists(target)) then
        call fail(error, 'this exists and is not written over', file=target)
      else if (is_deck(target)) then
        call datbox_to_deck(source, target, arguments%all_of('set'), code, error)
      else
        call read_scene_argument(arguments, comm, scene, options, code, error)
        if (code == exit_done) call write_state(options, scene, target, error)
      end if
    end associate
  end subroutine convert_command
end module sg_convert
