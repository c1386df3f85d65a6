!> `splitgrain run`: read a deck, say what it needs, simulate it.
module sg_run
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_arguments, only: arguments_t
  use sg_comm, only: comm_t
  use sg_deck, only: read_deck
  use sg_dump, only: read_steps
  use sg_error, only: diagnostics_t, error_t, exit_bad_input, exit_done, exit_output, fail
  use sg_hdf5, only: hdf5_is_available, hdf5_is_parallel
  use sg_kinds, only: wp
  use sg_run_summary, only: run_failed, run_summary_t, write_run_summary
  use sg_simulate, only: simulate
  use sg_simulation, only: simulation_t
  use sg_system, only: catch_signals, file_exists, make_folder
  implicit none
  private
  public :: run_command

contains

  !> Run a deck.
  subroutine run_command(arguments, comm, code, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(comm_t), intent(in) :: comm !! the ranks
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! what went wrong
    type(simulation_t) :: sim
    type(diagnostics_t) :: diagnostics
    real(wp) :: walltime
    integer, allocatable :: dump_steps(:, :)
    integer :: speaker

    code = exit_done
    call arguments%expect('set output restart walltime dump quiet', 1, 1, 'run DECK [options]; see splitgrain run --help', error)
    if (.not. allocated(error)) call arguments%number('walltime', 0.0_wp, 0.0_wp, walltime, error)
    if (.not. allocated(error) .and. comm%size > 1) call check_for_ranks(arguments, error)
    if (.not. allocated(error) .and. arguments%has('dump')) call read_steps(arguments%get('dump', ''), dump_steps, error)
    if (.not. allocated(error) .and. arguments%has('dump') .and. .not. hdf5_is_available()) then
      call fail(error, 'this build has no HDF5, which dumps are written with')
    end if
    if (allocated(error)) return
    associate (deck => arguments%words(1)%s)
      sim%comm = comm
      call read_deck(deck, arguments%all_of('set'), sim%scene, sim%options, diagnostics)
      sim%options%folder = arguments%get('output', stem(deck)//'.results')
      if (is_deck_bad(sim%comm, diagnostics)) then
        code = exit_bad_input
        if (diagnostics%count() > 0 .and. (arguments%has('output') .or. file_exists(sim%options%folder))) then
          call tell_failure(deck, sim%options%folder, diagnostics%errors(1)%sentence())
        end if
        return
      end if
      if (arguments%has('restart')) sim%options%restart_file = arguments%get('restart', '')
      sim%options%walltime = walltime
      if (allocated(dump_steps)) call move_alloc(dump_steps, sim%options%dump_steps)
      sim%options%is_quiet = arguments%has('quiet')
      if (comm%rank == 0) then
        if (.not. make_folder(sim%options%folder)) then
          call fail(error, 'cannot make the folder of the results', file=sim%options%folder, code=exit_output)
        end if
      end if
      call sim%comm%agree(error, speaker)
      if (allocated(error)) return
      call catch_signals()
      call simulate(sim, deck, code, error)
    end associate
  end subroutine run_command

  !> What does not go with several ranks.
  subroutine check_for_ranks(arguments, error)
    type(arguments_t), intent(in) :: arguments
    type(error_t), allocatable, intent(out) :: error

    if (arguments%has('dump')) then
      call fail(error, 'dumps are of whole problems; write them on one rank')
    else if (hdf5_is_available() .and. .not. hdf5_is_parallel()) then
      call fail(error, 'the HDF5 of this build cannot write one file from several ranks; it must be a parallel one')
    end if
  end subroutine check_for_ranks

  !> Has any rank found the deck wrong? Of those that have, the lowest one says so. Warnings are the first rank's to tell.
  logical function is_deck_bad(comm, diagnostics)
    type(comm_t), intent(inout) :: comm
    type(diagnostics_t), intent(in) :: diagnostics
    real(wp) :: speaker(1)

    speaker = real(merge(comm%rank, comm%size, diagnostics%count() > 0), wp)
    call comm%minimum(speaker)
    is_deck_bad = nint(speaker(1)) < comm%size
    if (comm%rank == merge(nint(speaker(1)), 0, is_deck_bad)) call diagnostics%print(error_unit)
  end function is_deck_bad

  !> Say in run.json that the deck could not be run, so that scripts do not take a former run in the folder for this one.
  subroutine tell_failure(deck, folder, reason)
    character(len=*), intent(in) :: deck, folder, reason
    type(run_summary_t) :: summary
    type(error_t), allocatable :: error

    summary%status = run_failed
    summary%reason = reason
    summary%deck = deck
    if (make_folder(folder)) call write_run_summary(summary, folder//'/run.json', error)
    if (allocated(error)) write (error_unit, '(a)') error%report()
  end subroutine tell_failure

  !> Name of a file without folder and suffix.
  pure function stem(file)
    character(len=*), intent(in) :: file
    character(len=:), allocatable :: stem

    stem = file(index(file, '/', back=.true.) + 1:)
    if (index(stem, '.', back=.true.) > 1) stem = stem(:index(stem, '.', back=.true.) - 1)
  end function stem
end module sg_run
