!> `splitgrain partition`: how the grains of a deck would be split, without a run.
module sg_partition
  use sg_arguments, only: arguments_t
  use sg_comm, only: comm_t
  use sg_cost_model, only: machine_t, prediction_t
  use sg_cost_text, only: print_costs
  use sg_error, only: error_t, exit_done, fail
  use sg_interface_blocks, only: block_structure_t
  use sg_kinds, only: i4
  use sg_partition_arguments, only: choose_split, find_messages
  use sg_predict_cost, only: predict_cost
  use sg_scene_argument, only: read_scene_argument
  use sg_simulation, only: simulation_t
  use sg_split_report, only: split_report_t
  use sg_split_text, only: print_split
  use sg_start_split, only: draw_split, split_at_start
  implicit none
  private
  public :: partition_command

contains

  !> Split and print.
  subroutine partition_command(arguments, comm, code, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(comm_t), intent(inout) :: comm !! ranks that measure what a prediction needs
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! error of the command
    type(simulation_t) :: sim
    integer :: parts, decks

    code = exit_done
    decks = merge(0, 1, arguments%has('lattice'))
    call arguments%expect('parts method boxes restart picture set json predict lattice shape latency bandwidth', decks, decks, &
                          'partition DECK --parts N [options]', error)
    if (.not. allocated(error)) call choose_split(arguments, sim%options%partition, parts, error)
    if (.not. allocated(error)) call read_scene_argument(arguments, comm, sim%scene, sim%options, code, error)
    if (allocated(error) .or. code /= exit_done) return
    call choose_split(arguments, sim%options%partition, parts, error)
    if (parts == 0 .and. .not. allocated(error)) call fail(error, 'how many parts? Give --parts N')
    if (allocated(error)) return
    if (arguments%has('predict')) then
      call predict(arguments, sim, parts, comm, error)
    else
      call split(arguments, sim, parts, error)
    end if
  end subroutine partition_command

  !> Split a scene and print the parts.
  subroutine split(arguments, sim, parts, error)
    type(arguments_t), intent(in) :: arguments
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: parts
    type(error_t), allocatable, intent(out) :: error
    type(split_report_t) :: report
    type(block_structure_t) :: blocks
    integer(i4), allocatable :: part(:)

    call split_at_start(sim, parts, part, report, blocks, error)
    if (.not. allocated(error) .and. arguments%has('picture')) call draw_split(sim, part, arguments%get('picture', ''), error)
    if (.not. allocated(error)) call print_split(report, blocks, arguments%has('json'))
  end subroutine split

  !> Predict what iterations cost on more and more ranks, and print it.
  subroutine predict(arguments, sim, most, comm, error)
    type(arguments_t), intent(in) :: arguments
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: most
    type(comm_t), intent(inout) :: comm
    type(error_t), allocatable, intent(out) :: error
    type(machine_t) :: machine
    type(prediction_t), allocatable :: predictions(:)
    logical :: are_measured

    call find_messages(arguments, comm, machine%messages, are_measured, error)
    if (.not. allocated(error)) call predict_cost(sim, most, comm, machine, predictions, error)
    if (.not. allocated(error) .and. comm%rank == 0) call print_costs(machine, are_measured, predictions, arguments%has('json'))
  end subroutine predict
end module sg_partition
