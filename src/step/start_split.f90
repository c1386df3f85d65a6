!> The split of a scene as it starts: contacts are sought once, and no step is made.
module sg_start_split
  use sg_boxes, only: fitting_boxes, split_boxes
  use sg_contact_graph, only: build_contact_graph, contact_graph_t
  use sg_detect, only: detect
  use sg_error, only: error_t, fail
  use sg_graph_split, only: split_graph
  use sg_kinds, only: wp, i4
  use sg_motion, only: predict
  use sg_simulation, only: simulation_t, start_simulation
  use sg_split_report, only: report_split, split_report_t
  use sg_text, only: to_text
  implicit none
  private
  public :: split_at_start

  !> Largest weight of a part over the mean one that is asked of METIS, which seldom finds a better one worth its cut
  real(wp), parameter :: imbalance = 1.03_wp

contains

  !> Split a scene and look at the parts.
  subroutine split_at_start(sim, method, parts, report, error)
    type(simulation_t), intent(inout) :: sim !! its scene and options are set
    character(len=*), intent(in) :: method !! boxes or graph
    integer, intent(in) :: parts !! number of parts
    type(split_report_t), intent(out) :: report !! figures of the split
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be split
    type(contact_graph_t) :: graph
    integer(i4), allocatable :: part(:)
    real(wp), allocatable :: position(:, :)
    integer :: boxes(2)

    call start_simulation(sim)
    call predict(sim%scene, sim%time(), 0.0_wp, sim%options%theta)
    call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
    call build_contact_graph(sim%contacts, sim%scene%bodies%is_grain, graph)
    boxes = 0
    if (graph%n < parts) then
      call fail(error, 'the scene has '//to_text(graph%n)//' grains, too few for '//to_text(parts)//' parts')
    else if (method == 'graph') then
      call split_graph(graph, parts, imbalance, part, error)
    else
      position = sim%scene%bodies%position(:, graph%body)
      boxes = fitting_boxes(parts, maxval(position, 2) - minval(position, 2))
      part = split_boxes(position, graph%weight, boxes)
    end if
    if (allocated(error)) return
    report = report_split(graph, part, parts)
    report%method = method
    report%boxes = boxes
  end subroutine split_at_start
end module sg_start_split
