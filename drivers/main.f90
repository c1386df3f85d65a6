!> The program: one executable with subcommands.
program splitgrain
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_arguments, only: arguments_t, read_arguments
  use sg_comm, only: comm_t
  use sg_error, only: error_t, exit_done, exit_output, fail
  use sg_print, only: has_print_failed
  use sg_python_command, only: python_command
  use sg_python_tasks, only: is_in_python
  use sg_subcommands, only: call_subcommand, is_shared
  use sg_system, only: end_program, survive_full_disks
  implicit none
  type(arguments_t) :: arguments
  type(error_t), allocatable :: error
  type(comm_t) :: comm
  integer :: code

  code = exit_done
  call survive_full_disks()
  call read_arguments(arguments, error)
  ! Studies and drawing are another program: it begins before there are ranks, and has options of its own.
  if (is_in_python(arguments)) call python_command(arguments, error)
  call comm%start()
  call comm%agree(error)
  if (.not. allocated(error)) call share_command(error)
  if (.not. allocated(error)) call do_command()
  if (allocated(error)) then
    ! Ranks agree on errors: one of them prints.
    if (comm%rank == 0) write (error_unit, '(a)') error%report()
    code = error%code
  end if
  if (comm%any(has_print_failed())) then
    if (comm%rank == 0) write (error_unit, '(a)') 'error: standard output cannot be written: is the disk full, or its reader gone?'
    if (code == exit_done) code = exit_output
  end if
  call comm%finish()
  call end_program(code)

contains

  !> All ranks must be here for the same: some of them would wait for ever for those that are not. Collective.
  subroutine share_command(error)
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when they are not
    logical :: is_here, is_elsewhere

    is_here = comm%any(is_shared(arguments))
    is_elsewhere = comm%any(.not. is_shared(arguments))
    if (is_here .and. is_elsewhere) call fail(error, 'the ranks do not share one run: their commands differ')
  end subroutine share_command

  !> Call the subcommand: all ranks where they work together, else the first one, and the others wait for its exit code.
  subroutine do_command()
    type(comm_t) :: alone

    if (is_shared(arguments)) then
      call call_subcommand(arguments, comm, code, error)
      return
    end if
    if (comm%rank == 0) call call_subcommand(arguments, alone, code, error)
    call comm%agree(error)
    call comm%broadcast(code, 0)
  end subroutine do_command
end program splitgrain
