!> `splitgrain run`: read a deck, print its plan, simulate it.
module sg_run
  use sg_arguments, only: arguments_t
  use sg_comm, only: comm_t
  use sg_dump, only: read_steps
  use sg_error, only: error_t, exit_done
  use sg_run_deck, only: run_deck
  use sg_run_request, only: run_request_t
  use sg_walltime, only: read_walltime
  implicit none
  private
  public :: run_command

contains

  !> Run a deck.
  subroutine run_command(arguments, comm, code, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(comm_t), intent(in) :: comm !! the ranks
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! error of the command
    type(run_request_t) :: request
    type(comm_t) :: ranks

    code = exit_done
    call read_request(arguments, request, error)
    ! The messages of a run are counted from its beginning.
    ranks = comm
    call ranks%agree(error)
    if (.not. allocated(error)) call run_deck(request, comm, code, error)
  end subroutine run_command

  !> Take the request from the command line.
  subroutine read_request(arguments, request, error)
    type(arguments_t), intent(in) :: arguments
    type(run_request_t), intent(out) :: request
    type(error_t), allocatable, intent(out) :: error

    call arguments%expect('set output restart force walltime dump needs quiet', 1, 1, &
                          'run DECK [options]; see splitgrain run --help', error)
    if (.not. allocated(error) .and. arguments%has('walltime')) &
      call read_walltime(arguments%get('walltime', ''), request%walltime, error)
    if (.not. allocated(error) .and. arguments%has('dump')) call read_steps(arguments%get('dump', ''), request%dump_steps, error)
    if (allocated(error)) return
    request%deck = arguments%words(1)%s
    request%settings = arguments%all_of('set')
    request%folder = arguments%get('output', '')
    request%restart = arguments%get('restart', '')
    request%is_forced = arguments%has('force')
    request%is_quiet = arguments%has('quiet')
    request%reports_memory = arguments%has('needs')
  end subroutine read_request
end module sg_run
