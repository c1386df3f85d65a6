!> `splitgrain run`: read a deck, print its plan, simulate it.
module sg_run
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_alarm, only: end_after
  use sg_arguments, only: arguments_t
  use sg_blocks, only: deck_t
  use sg_comm, only: comm_t
  use sg_deck, only: parts_of_deck, read_share
  use sg_deck_inputs, only: deck_inputs
  use sg_dump, only: read_steps
  use sg_effective, only: fingerprint
  use sg_error, only: diagnostics_t, error_t, exit_bad_input, exit_done, fail
  use sg_former_results, only: has_results
  use sg_hdf5, only: hdf5_is_available, hdf5_is_parallel
  use sg_kinds, only: wp, i8
  use sg_run_lock, only: release_lock, take_lock
  use sg_run_summary, only: run_failed, run_summary_t, write_run_summary
  use sg_shared_start, only: check_shared_start
  use sg_signature, only: signature_of_replicated
  use sg_simulate, only: simulate
  use sg_simulation, only: simulation_t
  use sg_subdomain_runs, only: run_subdomains, subdomain_program_t
  use sg_system, only: catch_signals, file_exists, make_folder
  use sg_text, only: to_text
  use sg_timers, only: wall_now
  implicit none
  private
  public :: run_command

  !> The run of one of several subdomains: command line, and results, which are the same for all
  type, extends(subdomain_program_t) :: subdomain_run_t
    type(arguments_t) :: arguments
    integer :: code = exit_done
    type(error_t), allocatable :: error
  contains
    procedure :: run => run_subdomain
  end type subdomain_run_t

contains

  !> Run a deck: on the ranks there are, or as so many subdomains as it asks for.
  subroutine run_command(arguments, comm, code, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(comm_t), intent(in) :: comm !! the ranks
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! error of the command
    type(subdomain_run_t) :: program
    type(comm_t) :: ranks
    integer, allocatable :: all_parts(:)
    integer :: parts

    parts = 0
    if (size(arguments%words) == 1) parts = parts_of_deck(arguments%words(1)%s, arguments%all_of('set'))
    ! The messages of a run are counted from its beginning.
    ranks = comm
    call ranks%gather(parts, all_parts)
    if (any(all_parts /= parts)) then
      call fail(error, 'the ranks do not share one run: partition.parts differs between them')
    else if (parts < max(2, comm%size)) then
      call run_scene(arguments, comm, code, error)
    else
      program%arguments = arguments
      call run_subdomains(program, parts, comm)
      code = program%code
      if (allocated(program%error)) call move_alloc(program%error, error)
    end if
  end subroutine run_command

  !> Run a deck as one of several subdomains.
  subroutine run_subdomain(self, comm)
    class(subdomain_run_t), intent(inout) :: self
    type(comm_t), intent(in) :: comm !! the subdomains, as ranks
    type(error_t), allocatable :: error
    integer :: code

    call run_scene(self%arguments, comm, code, error)
    self%code = code
    if (allocated(error)) self%error = error
  end subroutine run_subdomain

  !> Run a deck as one of several ranks.
  subroutine run_scene(arguments, comm, code, error)
    type(arguments_t), intent(in) :: arguments
    type(comm_t), intent(in) :: comm
    integer, intent(out) :: code
    type(error_t), allocatable, intent(out) :: error
    type(simulation_t) :: sim
    real(wp) :: walltime, deadline
    integer, allocatable :: dump_steps(:, :)
    logical :: is_bad

    code = exit_done
    call arguments%expect('set output restart force walltime dump needs quiet', 1, 1, &
                          'run DECK [options]; see splitgrain run --help', error)
    if (.not. allocated(error)) call arguments%number('walltime', 0.0_wp, 0.0_wp, walltime, error)
    if (.not. allocated(error) .and. comm%n_processes() > 1) call check_for_ranks(error)
    if (.not. allocated(error) .and. arguments%has('dump')) call read_steps(arguments%get('dump', ''), dump_steps, error)
    if (.not. allocated(error) .and. arguments%has('dump') .and. .not. hdf5_is_available()) then
      call fail(error, 'this build has no HDF5, which dumps are written with')
    end if
    sim%comm = comm
    call sim%comm%agree(error)
    if (allocated(error)) return
    deadline = 0
    if (walltime > 0) then
      deadline = wall_now() + walltime
      call end_after(walltime)
    end if
    associate (deck => arguments%words(1)%s)
      call read_scene(arguments, deck, sim, is_bad, error)
      if (allocated(error)) return
      if (is_bad) then
        code = exit_bad_input
        return
      end if
      if (arguments%has('restart')) sim%options%restart_file = arguments%get('restart', '')
      sim%options%is_forced = arguments%has('force')
      sim%options%deadline = deadline
      if (allocated(dump_steps)) call move_alloc(dump_steps, sim%options%dump_steps)
      sim%options%is_quiet = arguments%has('quiet')
      sim%options%reports_memory = arguments%has('needs')
      call catch_signals()
      call simulate(sim, deck, code, error)
      if (.not. allocated(error)) return
      if (.not. allocated(error%file) .and. error%code == exit_bad_input) error%file = deck
    end associate
  end subroutine run_scene

  !> Read the deck, of several ranks each its share of the scene, and print its mistakes. Collective.
  subroutine read_scene(arguments, file, sim, is_bad, error)
    type(arguments_t), intent(in) :: arguments
    character(len=*), intent(in) :: file
    type(simulation_t), intent(inout) :: sim
    logical, intent(out) :: is_bad
    type(error_t), allocatable, intent(out) :: error
    type(deck_t) :: deck
    type(diagnostics_t) :: diagnostics, shared

    call read_share(file, arguments%all_of('set'), sim%comm, sim%scene, sim%options, deck, diagnostics)
    sim%options%folder = arguments%get('output', stem(file)//'.results')
    sim%options%inputs = deck_inputs(deck)
    call judge(diagnostics)
    if (is_bad .or. sim%comm%size == 1) return
    call check_sameness(sim, deck%absent%digest, arguments%get('restart', ''), error)
    if (allocated(error)) return
    call check_shared_start(deck, sim%scene, sim%comm, shared)
    call judge(shared)
  contains
    subroutine judge(found)
      type(diagnostics_t), intent(in) :: found
      logical :: is_root

      call judge_deck(sim%comm, found, is_bad, is_root)
      if (.not. (is_bad .and. is_root)) return
      if (arguments%has('output') .or. file_exists(sim%options%folder)) &
        call report_failure(file, sim%options%folder, arguments%has('force'), found%errors(1)%sentence())
    end subroutine judge
  end subroutine read_scene

  !> Refuse what several ranks cannot do.
  subroutine check_for_ranks(error)
    type(error_t), allocatable, intent(out) :: error

    if (hdf5_is_available() .and. .not. hdf5_is_parallel()) then
      call fail(error, 'the HDF5 of this build cannot write one file from several ranks; it must be a parallel one')
    end if
  end subroutine check_for_ranks

  !> Has any rank found the deck wrong? Of those that have, the lowest one reports it. Warnings are printed by the first rank.
  subroutine judge_deck(comm, diagnostics, is_bad, is_root)
    type(comm_t), intent(inout) :: comm
    type(diagnostics_t), intent(in) :: diagnostics
    logical, intent(out) :: is_bad, is_root
    integer :: root, found

    found = merge(1, 0, diagnostics%count() > 0)
    call comm%sum(found)
    root = merge(comm%rank, comm%size, diagnostics%count() > 0)
    call comm%minimum(root)
    is_bad = found > 0
    is_root = comm%rank == merge(root, 0, is_bad)
    if (.not. is_root) return
    call diagnostics%print(error_unit)
    if (is_bad .and. found < comm%size) then
      write (error_unit, '(a)') to_text(found)//' of '//to_text(comm%size)//' ranks report this, the first is rank '// &
        to_text(comm%rank)//': check that all ranks read the same files'
    end if
  end subroutine judge_deck

  !> Have all ranks read the same deck, with the same files, and will they write in the same folder? Collective.
  subroutine check_sameness(sim, digest, restart, error)
    type(simulation_t), intent(inout) :: sim
    integer(i8), intent(in) :: digest
    character(len=*), intent(in) :: restart
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: digits
    real(wp), allocatable :: own(:), first(:)
    integer :: i

    digits = fingerprint(sim%options%deck_text//sim%options%folder//restart)
    own = [(real(iachar(digits(i:i)), wp), i=1, len(digits)), signature_of_replicated(sim%scene), &
           real(ibits(digest, 0, 32), wp), real(ibits(digest, 32, 32), wp)]
    first = own
    call sim%comm%broadcast(first, 0)
    if (sim%comm%all(all(abs(own - first) <= 0))) return
    call fail(error, 'the ranks do not share one run: deck, files that it names, settings, --output and --restart '// &
              'differ between them')
  end subroutine check_sameness

  !> Report in run.json that the deck could not be run, so that scripts find it there. Results of a former run are replaced only
  !! with --force.
  subroutine report_failure(deck, folder, is_forced, reason)
    character(len=*), intent(in) :: deck, folder, reason
    logical, intent(in) :: is_forced
    type(run_summary_t) :: summary
    type(error_t), allocatable :: error

    if (has_results(folder) .and. .not. is_forced) return
    summary%status = run_failed
    summary%reason = reason
    summary%deck = deck
    if (.not. make_folder(folder)) return
    call take_lock(folder, .false., error)
    if (.not. allocated(error)) call write_run_summary(summary, folder//'/run.json', error)
    call release_lock(folder)
    if (allocated(error)) write (error_unit, '(a)') error%report()
  end subroutine report_failure

  !> Name of a file without folder and suffix.
  pure function stem(file)
    character(len=*), intent(in) :: file
    character(len=:), allocatable :: stem

    stem = file(index(file, '/', back=.true.) + 1:)
    if (index(stem, '.', back=.true.) > 1) stem = stem(:index(stem, '.', back=.true.) - 1)
  end function stem
end module sg_run
