!> Run of a deck: on the ranks that there are, or as so many subdomains as the deck asks for.
module sg_run_deck
  use sg_alarm, only: end_after
  use sg_claim, only: leave_folder
  use sg_comm, only: comm_t
  use sg_deck, only: parts_of_deck
  use sg_error, only: error_t, exit_bad_input, exit_done, fail
  use sg_hdf5, only: hdf5_is_available, hdf5_is_parallel
  use sg_kinds, only: wp
  use sg_restart_stages, only: read_stages
  use sg_run_request, only: read_scene, run_request_t
  use sg_simulate, only: simulate
  use sg_simulation, only: simulation_t
  use sg_subdomain_runs, only: run_subdomains, subdomain_program_t
  use sg_system, only: catch_signals
  use sg_timers, only: wall_now
  implicit none
  private
  public :: run_deck

  !> The run of one of several subdomains: what is asked, and results, which are the same for all
  type, extends(subdomain_program_t) :: subdomain_run_t
    type(run_request_t) :: request
    integer :: code = exit_done
    type(error_t), allocatable :: error
  contains
    procedure :: run => run_subdomain
  end type subdomain_run_t

contains

  !> Run a deck. Collective.
  subroutine run_deck(request, comm, code, error)
    type(run_request_t), intent(in) :: request !! what is asked
    type(comm_t), intent(in) :: comm !! the ranks
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when the run failed
    type(subdomain_run_t) :: program
    type(comm_t) :: ranks
    integer, allocatable :: all_parts(:)
    integer :: parts

    code = exit_done
    parts = parts_of_deck(request%deck, request%settings)
    ! The messages of a run are counted from its beginning.
    ranks = comm
    call ranks%gather(parts, all_parts)
    if (any(all_parts /= parts)) then
      call fail(error, 'the ranks do not share one run: partition.parts differs between them')
    else if (parts < max(2, comm%size)) then
      call run_scene(request, comm, code, error)
    else
      program%request = request
      call run_subdomains(program, parts, comm)
      code = program%code
      if (allocated(program%error)) call move_alloc(program%error, error)
    end if
  end subroutine run_deck

  !> Run a deck as one of several subdomains.
  subroutine run_subdomain(self, comm)
    class(subdomain_run_t), intent(inout) :: self
    type(comm_t), intent(in) :: comm !! the subdomains, as ranks
    type(error_t), allocatable :: error
    integer :: code

    call run_scene(self%request, comm, code, error)
    self%code = code
    if (allocated(error)) self%error = error
  end subroutine run_subdomain

  !> Run a deck as one of several ranks: one simulation, or one per stage.
  subroutine run_scene(request, comm, code, error)
    type(run_request_t), intent(in) :: request
    type(comm_t), intent(in) :: comm
    integer, intent(out) :: code
    type(error_t), allocatable, intent(out) :: error
    type(simulation_t), allocatable :: sim, former
    type(run_request_t) :: present_request
    real(wp) :: start
    logical :: is_bad

    code = exit_done
    allocate (sim)
    call check_hdf5(request, comm, error)
    sim%comm = comm
    call sim%comm%agree(error)
    if (allocated(error)) return
    start = wall_now()
    if (request%walltime > 0) call end_after(request%walltime)
    present_request = request
    if (len(request%restart) > 0) call read_stages(request%restart, sim%stages)
    do
      call sim%preparation%start()
      call read_scene(present_request, sim, is_bad, error)
      if (.not. (is_bad .or. allocated(error))) call check_stages(sim, error)
      call sim%preparation%stop()
      if (is_bad) code = exit_bad_input
      if (is_bad .or. allocated(error)) exit
      if (request%walltime > 0) sim%options%deadline = start + request%walltime
      if (.not. sim%is_continued) call catch_signals()
      call simulate(sim, request%deck, code, error)
      if (.not. sim%goes_on) exit
      call move_alloc(sim, former)
      allocate (sim)
      call hand_over(former, sim)
      present_request%restart = sim%options%folder
      deallocate (former)
    end do
    if (sim%is_continued .and. .not. sim%writers%has_folder) call leave_folder(sim%options, sim%comm)
    if (.not. allocated(error)) return
    if (.not. allocated(error%file) .and. error%code == exit_bad_input) error%file = request%deck
  end subroutine run_scene

  !> Refuse stages where none can go on from the one before.
  subroutine check_stages(sim, error)
    type(simulation_t), intent(in) :: sim
    type(error_t), allocatable, intent(out) :: error

    if (sim%stages%number == 0 .or. hdf5_is_available()) return
    call fail(error, 'this build has no HDF5, with which each stage goes on from the one before')
  end subroutine check_stages

  !> Hand what goes over all stages of a run from one that is done to the next; its state stands in the checkpoint.
  subroutine hand_over(former, sim)
    type(simulation_t), intent(in) :: former
    type(simulation_t), intent(inout) :: sim

    sim%comm = former%comm
    sim%options%folder = former%options%folder
    sim%is_continued = .true.
    sim%stages%loaded = former%stages%pack()
    sim%stages%are_checked = .true.
    sim%stages%step = former%step
    sim%stages%time = former%time()
    sim%preparation = former%preparation
    sim%effort = former%effort
    sim%gluing_traffic = former%gluing_traffic
    sim%writers%outputs = former%writers%outputs
    sim%writers%has_stepped = former%writers%has_stepped
    sim%writers%has_warned = former%writers%has_warned
    sim%writers%saved_step = former%writers%saved_step
    sim%writers%summary%file_keys = former%writers%summary%file_keys
    sim%writers%summary%files = former%writers%summary%files
  end subroutine hand_over

  !> Refuse what the HDF5 of this build cannot write.
  subroutine check_hdf5(request, comm, error)
    type(run_request_t), intent(in) :: request
    type(comm_t), intent(in) :: comm
    type(error_t), allocatable, intent(out) :: error

    if (comm%n_processes() > 1 .and. hdf5_is_available() .and. .not. hdf5_is_parallel()) then
      call fail(error, 'the HDF5 of this build cannot write one file from several ranks; it must be a parallel one')
    else if (allocated(request%dump_steps) .and. .not. hdf5_is_available()) then
      call fail(error, 'this build has no HDF5, which dumps are written with')
    end if
  end subroutine check_hdf5
end module sg_run_deck
