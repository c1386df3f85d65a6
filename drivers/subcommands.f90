!> Subcommands by their names: their calls, and which of them all ranks share.
module sg_subcommands
  use sg_arguments, only: arguments_t
  use sg_bench, only: bench_command
  use sg_check, only: check_command
  use sg_comm, only: comm_t
  use sg_convert, only: convert_command
  use sg_error, only: error_t, exit_bad_input, exit_done
  use sg_help, only: command_names, print_help
  use sg_partition, only: partition_command
  use sg_print_version, only: print_version
  use sg_reference, only: reference_command
  use sg_run, only: run_command
  use sg_solve, only: solve_command
  use sg_spectra, only: spectrum_command
  implicit none
  private
  public :: call_subcommand, is_shared

contains

  !> Do ranks work together? Splits are made by one rank; ranks that a prediction is started on time its pieces.
  pure logical function is_shared(arguments)
    type(arguments_t), intent(in) :: arguments !! the command line

    is_shared = arguments%task() == 'run' .or. (arguments%task() == 'partition' .and. arguments%has('predict'))
  end function is_shared

  !> Call the subcommand that the command line names. That of studies, which the main program calls before there are ranks, does
  !! not return.
  subroutine call_subcommand(arguments, comm, code, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(comm_t), intent(inout) :: comm !! the ranks that share the subcommand, or this one alone
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! error of the subcommand

    code = exit_done
    select case (arguments%task())
    case ('--help')
      call print_help(arguments%command)
    case ('--version')
      call print_version()
    case ('')
      call print_help('')
      code = exit_bad_input
    case ('run')
      call run_command(arguments, comm, code, error)
    case ('check')
      call check_command(arguments, comm, code, error)
    case ('reference')
      call reference_command(arguments, error)
    case ('convert')
      call convert_command(arguments, comm, code, error)
    case ('bench')
      call bench_command(arguments, error)
    case ('partition')
      call partition_command(arguments, comm, code, error)
    case ('solve')
      call solve_command(arguments, code, error)
    case ('spectrum')
      call spectrum_command(arguments, comm, code, error)
    case default
      call arguments%refuse_command(command_names, error)
    end select
  end subroutine call_subcommand
end module sg_subcommands
