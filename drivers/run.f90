!> `splitgrain run`: read a deck, say what it needs, simulate it.
module sg_run
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_arguments, only: arguments_t
  use sg_comm, only: comm_t
  use sg_deck, only: read_deck
  use sg_dump, only: read_steps
  use sg_error, only: diagnostics_t, error_t, exit_bad_input, exit_done, exit_output, fail
  use sg_hdf5, only: hdf5_is_available
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

    code = exit_done
    call arguments%expect('set output restart walltime dump quiet', 1, 1, 'run DECK [options]; see splitgrain run --help', error)
    if (.not. allocated(error)) call arguments%number('walltime', 0.0_wp, 0.0_wp, walltime, error)
    if (.not. allocated(error) .and. comm%size > 1) then
      call fail(error, 'this version runs on one rank; start it without mpirun or with -n 1')
    end if
    if (.not. allocated(error) .and. arguments%has('dump')) call read_steps(arguments%get('dump', ''), dump_steps, error)
    if (.not. allocated(error) .and. arguments%has('dump') .and. .not. hdf5_is_available()) then
      call fail(error, 'this build has no HDF5, which dumps are written with')
    end if
    if (allocated(error)) return
    associate (deck => arguments%words(1)%s)
      call read_deck(deck, arguments%all_of('set'), sim%scene, sim%options, diagnostics)
      sim%options%folder = arguments%get('output', stem(deck)//'.results')
      call diagnostics%print(error_unit)
      if (diagnostics%count() > 0) then
        code = exit_bad_input
        if (arguments%has('output') .or. file_exists(sim%options%folder)) then
          call tell_failure(deck, sim%options%folder, diagnostics%errors(1)%sentence())
        end if
        return
      end if
      if (arguments%has('restart')) sim%options%restart_file = arguments%get('restart', '')
      sim%options%walltime = walltime
      if (allocated(dump_steps)) call move_alloc(dump_steps, sim%options%dump_steps)
      sim%options%is_quiet = arguments%has('quiet')
      if (.not. make_folder(sim%options%folder)) then
        call fail(error, 'cannot make the folder of the results', file=sim%options%folder, code=exit_output)
        return
      end if
      call catch_signals()
      call simulate(sim, deck, comm%size, code, error)
    end associate
  end subroutine run_command

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
