!> `splitgrain partition`: how the grains of a deck would be split, without a run.
module sg_partition
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use sg_arguments, only: arguments_t
  use sg_benchmark_scenes, only: check_lattice, make_lattice
  use sg_comm, only: comm_t
  use sg_cost_model, only: machine_t, prediction_t
  use sg_cost_text, only: costs_json, print_costs
  use sg_deck, only: read_deck
  use sg_error, only: diagnostics_t, error_t, exit_bad_input, exit_done, fail
  use sg_interface_blocks, only: block_structure_t
  use sg_kinds, only: wp, i4
  use sg_message_costs, only: given_messages, measure_messages
  use sg_numerals, only: read_integer
  use sg_predict_cost, only: predict_cost
  use sg_print, only: print_line
  use sg_run_options, only: partition_options_t, split_names
  use sg_simulation, only: simulation_t
  use sg_split_report, only: split_report_t
  use sg_split_text, only: print_split, split_json
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
    type(diagnostics_t) :: diagnostics
    type(split_report_t) :: report
    type(block_structure_t) :: blocks
    integer(i4), allocatable :: part(:)
    integer :: parts

    code = exit_done
    call arguments%expect('parts method boxes restart picture set json predict lattice shape latency bandwidth', &
                          merge(0, 1, arguments%has('lattice')), merge(0, 1, arguments%has('lattice')), &
                          'partition DECK --parts N [options]', error)
    if (.not. allocated(error)) call choose_split(arguments, sim%options%partition, parts, error)
    if (allocated(error)) return
    if (arguments%has('lattice')) then
      call make_scene(arguments, sim, error)
      if (allocated(error)) return
    else
      call read_deck(arguments%words(1)%s, arguments%all_of('set'), sim%scene, sim%options, diagnostics)
      if (comm%rank == 0) call diagnostics%print(error_unit)
      if (diagnostics%count() > 0) then
        code = exit_bad_input
        return
      end if
    end if
    ! The command line goes before the deck.
    call choose_split(arguments, sim%options%partition, parts, error)
    if (parts == 0) parts = sim%options%partition%parts
    if (parts == 0 .and. .not. allocated(error)) call fail(error, 'how many parts? Give --parts N')
    if (arguments%has('restart')) sim%options%restart_file = arguments%get('restart', '')
    if (.not. allocated(error) .and. arguments%has('predict')) then
      call predict(arguments, sim, parts, comm, error)
      return
    end if
    if (.not. allocated(error)) call split_at_start(sim, parts, part, report, blocks, error)
    if (.not. allocated(error) .and. arguments%has('picture')) &
      call draw_split(sim, part, arguments%get('picture', ''), error)
    if (allocated(error)) return
    if (arguments%has('json')) then
      call print_line(split_json(report, blocks))
    else
      call print_split(output_unit, report, blocks)
    end if
  end subroutine partition_command

  !> Make the lattice that `splitgrain bench` measures on, in place of a deck.
  subroutine make_scene(arguments, sim, error)
    type(arguments_t), intent(in) :: arguments
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: shape
    integer :: contacts

    shape = arguments%get('shape', 'disk')
    call arguments%whole('lattice', 0, 12, contacts, error)
    if (.not. allocated(error)) call check_lattice(shape, contacts, error)
    if (allocated(error)) return
    call make_lattice(sim%scene, shape, contacts, 0.3_wp)
    sim%options%time_step = 1e-4_wp
  end subroutine make_scene

  !> Predict what iterations cost on more and more ranks, and print it.
  subroutine predict(arguments, sim, most, comm, error)
    type(arguments_t), intent(in) :: arguments
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: most
    type(comm_t), intent(inout) :: comm
    type(error_t), allocatable, intent(out) :: error
    type(machine_t) :: machine
    type(prediction_t), allocatable :: predictions(:)
    real(wp) :: microseconds, gigabytes
    logical :: are_measured

    call arguments%number('latency', 2.0_wp, 0.0_wp, microseconds, error)
    if (.not. allocated(error)) call arguments%number('bandwidth', 10.0_wp, 0.0_wp, gigabytes, error)
    if (allocated(error)) return
    if (.not. gigabytes > 0) then
      call fail(error, 'option --bandwidth needs a number above zero')
      return
    end if
    are_measured = comm%size > 1 .and. .not. (arguments%has('latency') .or. arguments%has('bandwidth'))
    if (are_measured) then
      call measure_messages(comm, machine%messages)
    else
      machine%messages = given_messages(1e-6_wp*microseconds, 1e9_wp*gigabytes)
    end if
    call predict_cost(sim, most, comm, machine, predictions, error)
    if (allocated(error) .or. comm%rank > 0) return
    if (arguments%has('json')) then
      call print_line(costs_json(machine, are_measured, predictions))
    else
      call print_costs(output_unit, machine, are_measured, predictions)
    end if
  end subroutine predict

  !> Take method, boxes and number of parts, 0 where it gives none, from the command line.
  subroutine choose_split(arguments, options, parts, error)
    type(arguments_t), intent(in) :: arguments
    type(partition_options_t), intent(inout) :: options
    integer, intent(out) :: parts
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: method

    parts = 0
    method = arguments%get('method', trim(options%split))
    if (all(method /= split_names)) then
      call fail(error, 'method is boxes or graph, not "'//method//'"')
    else if (arguments%has('boxes')) then
      if (.not. arguments%has('method')) method = 'boxes'
      call read_boxes(arguments%get('boxes', ''), options%boxes, error)
      if (.not. allocated(error) .and. method /= 'boxes') call fail(error, 'option --boxes goes with the method boxes alone')
      parts = product(options%boxes)
    end if
    if (allocated(error)) return
    options%split = method
    if (arguments%has('parts')) call arguments%whole('parts', 0, 1, parts, error)
  end subroutine choose_split

  !> Numbers of boxes as they are written, 2x3 or 2x3x1.
  subroutine read_boxes(word, boxes, error)
    character(len=*), intent(in) :: word
    integer, intent(out) :: boxes(3)
    type(error_t), allocatable, intent(out) :: error
    integer :: axis, first, cut
    logical :: is_number

    boxes = 1
    first = 1
    do axis = 1, 3
      cut = index(word(first:)//'x', 'x')
      call read_integer(word(first:first + cut - 2), boxes(axis), is_number)
      if (.not. is_number .or. boxes(axis) < 0 .or. boxes(axis) > 100000) exit
      first = first + cut
      if (first > len(word) + 1) exit
    end do
    if (.not. is_number .or. axis == 1 .or. first <= len(word) + 1) then
      call fail(error, 'option --boxes needs two or three numbers such as 2x3 or 2x3x1, not "'//word//'"')
      boxes = 1
    else if (product(real(boxes, wp)) > 1e6_wp) then
      call fail(error, 'option --boxes has more than a million boxes')
      boxes = 1
    end if
  end subroutine read_boxes
end module sg_partition
