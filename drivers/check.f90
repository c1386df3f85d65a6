!> `splitgrain check`: everything but the run; what a deck holds, what its run needs, and every mistake in it.
module sg_check
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_deck, only: read_deck
  use sg_error, only: diagnostics_t, exit_bad_input, exit_done
  use sg_kinds, only: wp
  use sg_plan, only: describe_plan, make_plan, plan_t
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_text, only: text_t, to_text
  implicit none
  private
  public :: check_command

  !> Memory of a body with its contactor, and of a contact with its share of the pairs [bytes], rounded up
  real(wp), parameter :: bytes_per_body = 400, bytes_per_contact = 500
  !> Contacts for each grain of a dense pack, those that are near but open included
  real(wp), parameter :: contacts_per_grain = 3

contains

  !> Check a deck and print what it holds.
  subroutine check_command(file, settings, code)
    character(len=*), intent(in) :: file !! deck
    type(text_t), intent(in) :: settings(:) !! settings laid over it
    integer, intent(out) :: code !! exit code
    type(scene_t) :: scene
    type(run_options_t) :: options
    type(diagnostics_t) :: diagnostics
    type(plan_t) :: plan

    call read_deck(file, settings, scene, options, diagnostics)
    call diagnostics%print(error_unit)
    code = exit_bad_input
    if (diagnostics%count() > 0) return
    code = exit_done
    call print_counts(file, scene, options)
    call make_plan(scene, plan)
    write (*, '(a)') describe_plan(plan, scene, ranks=1)
  end subroutine check_command

  !> Print what the plan does not say: time, laws, drives, memory.
  subroutine print_counts(file, scene, options)
    character(len=*), intent(in) :: file
    type(scene_t), intent(in) :: scene
    type(run_options_t), intent(in) :: options
    real(wp) :: bytes

    bytes = bytes_per_body*real(scene%bodies%n, wp) + bytes_per_contact*contacts_per_grain*real(count(scene%bodies%is_grain), wp)
    write (*, '(a)') file//': no mistakes'
    write (*, '(a)') 'deck       '//options%deck_hash
    write (*, '(a)') 'time       '//to_text(options%steps)//' steps of '//to_text(options%step, 4)//' s'
    write (*, '(a)') 'sees       '//to_text(size(scene%laws))//' laws in '//to_text(size(scene%sees))//' lines'
    write (*, '(a)') 'imposed    '//to_text(size(scene%drives))//' components, '//to_text(size(scene%pressures))//' pressures'
    write (*, '(a)') 'memory     about '//to_text(nint(bytes/1e6_wp) + 1)//' MB'
  end subroutine print_counts
end module sg_check
