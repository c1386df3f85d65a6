!> Options of `splitgrain partition` on the command line: how a scene is split, and what messages cost.
module sg_partition_arguments
  use sg_arguments, only: arguments_t
  use sg_comm, only: comm_t
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp
  use sg_message_costs, only: given_messages, measure_messages, message_costs_t
  use sg_numerals, only: read_integer
  use sg_run_options, only: partition_options_t, split_names
  implicit none
  private
  public :: choose_split, find_messages

contains

  !> Take method, boxes and number of parts from the command line.
  subroutine choose_split(arguments, options, parts, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(partition_options_t), intent(inout) :: options !! of the deck; the command line goes before it
    integer, intent(out) :: parts !! number of parts, 0 where neither gives one
    type(error_t), allocatable, intent(out) :: error !! set when an option is wrong
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
    if (parts == 0) parts = options%parts
    call arguments%whole('parts', (parts), 1, parts, error)
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

  !> Measure what messages cost between the ranks, or take it from the command line, or else assume it.
  subroutine find_messages(arguments, comm, messages, are_measured, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(comm_t), intent(inout) :: comm !! the ranks
    type(message_costs_t), intent(out) :: messages !! their cost
    logical, intent(out) :: are_measured !! measured, not given?
    type(error_t), allocatable, intent(out) :: error !! set when an option is wrong
    real(wp) :: microseconds, gigabytes

    are_measured = comm%size > 1 .and. .not. (arguments%has('latency') .or. arguments%has('bandwidth'))
    call arguments%number('latency', 2.0_wp, 0.0_wp, microseconds, error)
    if (.not. allocated(error)) call arguments%number('bandwidth', 10.0_wp, 0.0_wp, gigabytes, error)
    if (allocated(error)) return
    if (.not. gigabytes > 0) then
      call fail(error, 'option --bandwidth needs a number above zero')
    else if (are_measured) then
      call measure_messages(comm, messages)
    else
      messages = given_messages(1e-6_wp*microseconds, 1e9_wp*gigabytes)
    end if
  end subroutine find_messages
end module sg_partition_arguments
