!> What a command line asks of a run, and the deck of the run: read by all ranks, judged together, the same for all.
module sg_run_request
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_blocks, only: deck_t
  use sg_comm, only: comm_t
  use sg_deck, only: read_share
  use sg_deck_inputs, only: deck_inputs
  use sg_effective, only: fingerprint
  use sg_error, only: diagnostics_t, error_t, fail
  use sg_former_results, only: has_results
  use sg_kinds, only: wp, i8
  use sg_run_lock, only: release_lock, take_lock
  use sg_run_summary, only: run_failed, run_summary_t, write_run_summary
  use sg_shared_start, only: check_shared_start
  use sg_signature, only: signature_of_replicated
  use sg_simulation, only: simulation_t
  use sg_stop_from_deck, only: stop_from_deck
  use sg_system, only: file_exists, make_folder
  use sg_text, only: text_t, to_text
  implicit none
  private
  public :: run_request_t, read_scene

  !> What is asked of a run
  type :: run_request_t
    !> Deck, and settings laid over it
    character(len=:), allocatable :: deck
    type(text_t), allocatable :: settings(:)
    !> Folder of the results, and file to restart from, or the folder that has it; empty where none is given
    character(len=:), allocatable :: folder, restart
    !> Wall time after which the run stops with a checkpoint [s]; 0 for never
    real(wp) :: walltime = 0
    !> Steps whose contact problem is written: first and last of each range, shape (2, ranges)
    integer, allocatable :: dump_steps(:, :)
    !> Replace other results? Print less? Report what the run has held in memory?
    logical :: is_forced = .false., is_quiet = .false., reports_memory = .false.
  end type run_request_t

contains

  !> Read the deck, of several ranks each its share of the scene, and print its mistakes. Collective.
  subroutine read_scene(request, sim, is_bad, error)
    type(run_request_t), intent(in) :: request !! what is asked
    type(simulation_t), intent(inout) :: sim !! its ranks are set; gets scene and options
    logical, intent(out) :: is_bad !! does the deck have mistakes?
    type(error_t), allocatable, intent(out) :: error !! set where the ranks do not read the same
    type(deck_t) :: deck
    type(diagnostics_t) :: diagnostics, shared

    call read_share(request%deck, request%settings, sim%comm, sim%scene, sim%options, deck, diagnostics, sim%stages)
    if (diagnostics%count() == 0) call stop_from_deck(deck, sim%scene, sim%options, sim%stop, diagnostics)
    call take_options(request, deck, sim)
    ! Warnings of the deck are printed once.
    if (sim%is_continued .and. allocated(diagnostics%warnings)) deallocate (diagnostics%warnings)
    call judge(diagnostics)
    if (is_bad .or. sim%comm%size == 1) return
    call check_sameness(sim, deck%absent%digest, request%restart, error)
    if (allocated(error)) return
    call check_shared_start(deck, sim%scene, sim%comm, shared)
    call judge(shared)
  contains
    subroutine judge(found)
      type(diagnostics_t), intent(in) :: found
      logical :: is_root

      call judge_deck(sim%comm, found, sim%stages%number > 0, is_bad, is_root)
      if (.not. (is_bad .and. is_root)) return
      if (len(request%folder) > 0 .or. file_exists(sim%options%folder)) &
        call report_failure(request, sim%options%folder, found%errors(1)%sentence())
    end subroutine judge
  end subroutine read_scene

  !> Options that stand on the command line, and what follows from the name of the deck.
  subroutine take_options(request, deck, sim)
    type(run_request_t), intent(in) :: request
    type(deck_t), intent(in) :: deck
    type(simulation_t), intent(inout) :: sim

    associate (options => sim%options)
      options%folder = request%folder
      if (len(request%folder) == 0) options%folder = stem(request%deck)//'.results'
      options%inputs = deck_inputs(deck)
      if (len(request%restart) > 0) options%restart_file = request%restart
      if (allocated(request%dump_steps)) options%dump_steps = request%dump_steps
      options%is_forced = request%is_forced
      options%is_quiet = request%is_quiet
      options%reports_memory = request%reports_memory
    end associate
  end subroutine take_options

  !> Has any rank found the deck wrong? Of those that have, the lowest one reports it. Warnings are printed by the first rank.
  subroutine judge_deck(comm, diagnostics, has_stages, is_bad, is_root)
    type(comm_t), intent(inout) :: comm
    type(diagnostics_t), intent(in) :: diagnostics
    logical, intent(in) :: has_stages !! stages that are not due are checked by rank 0 alone
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
    if (is_bad .and. found < comm%size .and. .not. (has_stages .and. root == 0 .and. found == 1)) then
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
  subroutine report_failure(request, folder, reason)
    type(run_request_t), intent(in) :: request
    character(len=*), intent(in) :: folder, reason
    type(run_summary_t) :: summary
    type(error_t), allocatable :: error

    if (has_results(folder) .and. .not. request%is_forced) return
    summary%status = run_failed
    summary%reason = reason
    summary%deck = request%deck
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
end module sg_run_request
