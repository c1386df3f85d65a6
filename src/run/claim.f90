!> Claim of a folder of results before a run writes there: made, locked, and free of files that must not be replaced.
module sg_claim
  use sg_comm, only: comm_t
  use sg_error, only: error_t, exit_output, fail
  use sg_former_results, only: check_former, check_inputs, is_within
  use sg_run_lock, only: release_lock, take_lock
  use sg_run_options, only: run_options_t
  use sg_system, only: file_exists, make_folder
  use sg_text, only: to_text
  implicit none
  private
  public :: claim_folder, leave_folder

contains

  !> Make and lock the folder of the results, which all ranks must find. Collective.
  subroutine claim_folder(options, comm, goes_on, error)
    type(run_options_t), intent(in) :: options !! folder, files that are read, and whether other results are replaced
    type(comm_t), intent(inout) :: comm !! the ranks
    logical, intent(out) :: goes_on !! does the run go on from a checkpoint of this very folder?
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when the folder is not for this run: it is left as it was

    goes_on = .false.
    if (allocated(options%restart_file)) goes_on = is_within(options%restart_file, options%folder)
    if (comm%rank == 0) call claim_alone(options, goes_on, error)
    call comm%agree(error)
    if (allocated(error)) return
    if (.not. file_exists(options%folder//'/.')) then
      call fail(error, 'rank '//to_text(comm%rank)//' does not find the folder of the results, which rank 0 has made', &
                file=options%folder, code=exit_output)
    end if
    call comm%agree(error)
    if (allocated(error)) call leave_folder(options, comm)
  end subroutine claim_folder

  !> Claim a folder for one process.
  subroutine claim_alone(options, goes_on, error)
    type(run_options_t), intent(in) :: options
    logical, intent(in) :: goes_on
    type(error_t), allocatable, intent(out) :: error

    if (allocated(options%inputs)) call check_inputs(options%folder, options%inputs, error)
    if (allocated(error)) return
    if (.not. make_folder(options%folder)) then
      call fail(error, 'cannot make the folder of the results', file=options%folder, code=exit_output)
      return
    end if
    call take_lock(options%folder, options%is_forced, error)
    if (allocated(error)) return
    if (.not. (goes_on .or. options%is_forced)) call check_former(options%folder, options%deck_text, error)
    if (allocated(error)) call release_lock(options%folder)
  end subroutine claim_alone

  !> Unlock the folder.
  subroutine leave_folder(options, comm)
    type(run_options_t), intent(in) :: options !! folder that was claimed
    type(comm_t), intent(in) :: comm !! the ranks

    if (comm%rank == 0) call release_lock(options%folder)
  end subroutine leave_folder
end module sg_claim
