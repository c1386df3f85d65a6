!> Run of a deck: on the ranks that there are, or as so many subdomains as the deck asks for.
module sg_run_deck
  use sg_alarm, only: end_after
  use sg_comm, only: comm_t
  use sg_deck, only: parts_of_deck
  use sg_error, only: error_t, exit_bad_input, exit_done, fail
  use sg_hdf5, only: hdf5_is_available, hdf5_is_parallel
  use sg_kinds, only: wp
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

  !> Run a deck as one of several ranks.
  subroutine run_scene(request, comm, code, error)
    type(run_request_t), intent(in) :: request
    type(comm_t), intent(in) :: comm
    integer, intent(out) :: code
    type(error_t), allocatable, intent(out) :: error
    type(simulation_t) :: sim
    real(wp) :: start
    logical :: is_bad

    code = exit_done
    call check_hdf5(request, comm, error)
    sim%comm = comm
    call sim%comm%agree(error)
    if (allocated(error)) return
    start = wall_now()
    if (request%walltime > 0) call end_after(request%walltime)
    call read_scene(request, sim, is_bad, error)
    if (is_bad) code = exit_bad_input
    if (is_bad .or. allocated(error)) return
    if (request%walltime > 0) sim%options%deadline = start + request%walltime
    call catch_signals()
    call simulate(sim, request%deck, code, error)
    if (.not. allocated(error)) return
    if (.not. allocated(error%file) .and. error%code == exit_bad_input) error%file = request%deck
  end subroutine run_scene

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
