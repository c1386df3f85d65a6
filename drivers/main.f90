!> The program: one executable with subcommands.
program splitgrain
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_arguments, only: arguments_t, read_arguments
  use sg_bench, only: bench_command
  use sg_check, only: check_command
  use sg_comm, only: comm_t
  use sg_convert, only: convert_command
  use sg_error, only: error_t, exit_bad_input, exit_done, exit_output, fail
  use sg_help, only: print_help, print_version
  use sg_partition, only: partition_command
  use sg_print, only: has_print_failed, print_line
  use sg_reference_text, only: reference_text
  use sg_run, only: run_command
  use sg_solve, only: solve_command
  use sg_spectra, only: spectrum_command
  use sg_study, only: study_command
  use sg_system, only: end_program, survive_full_disks
  use sg_text, only: append_word, nearest_word, text_t
  implicit none
  type(arguments_t) :: arguments
  type(error_t), allocatable :: error
  type(comm_t) :: comm
  integer :: code

  code = exit_done
  call survive_full_disks()
  call read_arguments(arguments, error)
  ! A study is another program, which starts this one again: it begins before there are ranks.
  if (.not. allocated(error) .and. arguments%command == 'study' .and. .not. asks_for_help()) call study_command(error)
  call comm%start()
  call comm%agree(error)
  if (.not. allocated(error)) call share_command(error)
  if (.not. allocated(error)) call choose()
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

  !> Do ranks work together? Splits are made by one rank; ranks that a prediction is started on time its pieces.
  logical function is_shared()
    is_shared = (arguments%command == 'run' .or. (arguments%command == 'partition' .and. arguments%has('predict'))) &
                .and. .not. (asks_for_help() .or. arguments%has('version'))
  end function is_shared

  !> Is help all that is wanted?
  logical function asks_for_help()
    asks_for_help = arguments%has('help') .or. arguments%has('h') .or. arguments%command == 'help'
  end function asks_for_help

  !> All ranks must be here for the same: some of them would wait for ever for those that are not. Collective.
  subroutine share_command(error)
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when they are not
    logical :: is_here, is_elsewhere

    is_here = comm%any(is_shared())
    is_elsewhere = comm%any(.not. is_shared())
    if (is_here .and. is_elsewhere) then
      call fail(error, 'the ranks do not share one run: their commands differ')
    end if
  end subroutine share_command

  !> Call the subcommand: all ranks where they work together, else the first one, and the others wait for its exit code.
  subroutine choose()
    if (is_shared()) then
      call choose_shared()
      return
    end if
    if (comm%rank == 0) call choose_alone()
    call comm%agree(error)
    call comm%broadcast(code, 0)
  end subroutine choose

  !> Call a subcommand of all ranks.
  subroutine choose_shared()
    if (arguments%command == 'run') then
      call run_command(arguments, comm, code, error)
    else
      call partition_command(arguments, comm, code, error)
    end if
  end subroutine choose_shared

  !> Call a subcommand of one rank.
  subroutine choose_alone()
    type(comm_t) :: alone

    if (asks_for_help()) then
      call print_help(arguments%command)
      return
    end if
    if (arguments%has('version')) then
      call print_version()
      return
    end if
    select case (arguments%command)
    case ('check')
      call arguments%expect('set', 1, 1, 'check DECK [--set section.key=value]', error)
      if (.not. allocated(error)) call check_command(arguments%words(1)%s, arguments%all_of('set'), code)
    case ('reference')
      call arguments%expect('', 0, 0, 'reference', error)
      if (.not. allocated(error)) call print_line(reference_text(), is_open=.true.)
    case ('convert')
      call arguments%expect('restart', 2, 2, 'convert SOURCE TARGET [--restart FILE]', error)
      if (.not. allocated(error)) then
        call convert_command(arguments%words(1)%s, arguments%words(2)%s, arguments%get('restart', ''), code)
      end if
    case ('bench')
      call bench_command(arguments, error)
    case ('partition')
      call partition_command(arguments, alone, code, error)
    case ('solve')
      call solve_command(arguments, code, error)
    case ('spectrum')
      call spectrum_command(arguments, code, error)
    case ('')
      call print_help('')
      code = exit_bad_input
    case default
      call unknown_command()
    end select
  end subroutine choose_alone

  !> Print that there is no such subcommand.
  subroutine unknown_command()
    character(len=*), parameter :: commands(9) = [character(len=9) :: 'run', 'check', 'reference', 'convert', 'bench', &
                                                  'partition', 'solve', 'spectrum', 'study']
    type(text_t), allocatable :: known(:)
    character(len=:), allocatable :: near
    integer :: i

    do i = 1, size(commands)
      call append_word(known, trim(commands(i)))
    end do
    near = nearest_word(arguments%command, known)
    if (len(near) > 0) near = '; did you mean "'//near//'"?'
    call fail(error, 'unknown command "'//arguments%command//'"'//near)
  end subroutine unknown_command
end program splitgrain
