!> Split of a scene at its start or restart: one detection, no step.
module sg_start_split
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_assemble, only: assemble
  use sg_boxes, only: choose_boxes, split_boxes
  use sg_checkpoint, only: load_checkpoint
  use sg_comm, only: comm_t
  use sg_contact_graph, only: build_contact_graph, contact_graph_t
  use sg_curve_order, only: curve_order
  use sg_detect, only: detect
  use sg_error, only: diagnostics_t, error_t, exit_output, fail
  use sg_former_results, only: has_results
  use sg_graph_split, only: split_graph
  use sg_interface_blocks, only: block_structure_t, interface_blocks_t
  use sg_kinds, only: wp, i4
  use sg_limits, only: check_limits
  use sg_load, only: measured_weights
  use sg_motion, only: predict
  use sg_pictures, only: pictures_t
  use sg_problem, only: is_active
  use sg_simulation, only: simulation_t, start_simulation
  use sg_split_report, only: report_split, split_report_t
  use sg_system, only: make_folder
  use sg_text, only: to_text
  implicit none
  private
  public :: split_at_start, find_contacts, split_bodies, draw_split

  !> Largest weight of a part over the mean one that is asked of METIS, which seldom finds a better one worth its cut
  real(wp), parameter :: imbalance = 1.03_wp

contains

  !> Split a scene by its options, in the state of a restart file where they name one, and report the parts.
  subroutine split_at_start(sim, parts, part, report, blocks, error)
    type(simulation_t), intent(inout) :: sim !! its scene and options are set
    integer, intent(in) :: parts !! number of parts
    integer(i4), allocatable, intent(out) :: part(:) !! part of each body, from 1; 0 for walls
    type(split_report_t), intent(out) :: report !! figures of the split
    type(block_structure_t), intent(out) :: blocks !! structure of the matrix of the primal interface
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be split
    real(wp), allocatable :: load(:)
    integer :: boxes(3)

    call find_contacts(sim, error)
    if (allocated(error)) return
    associate (bodies => sim%scene%bodies)
      load = measured_weights(sim%contacts, bodies%is_grain, bodies%n_own)
    end associate
    call split_bodies(sim, load, parts, boxes, part, error)
    if (allocated(error)) return
    report = report_split(sim%contacts, part, load, parts)
    report%method = trim(sim%options%partition%split)
    report%boxes = boxes
    call look_at_interface(sim, report%interfaces%cut, blocks)
  end subroutine split_at_start

  !> Bring a simulation to its start, or to the state of a restart file where its options name one, and seek contacts.
  subroutine find_contacts(sim, error)
    type(simulation_t), intent(inout) :: sim !! its scene and options are set
    type(error_t), allocatable, intent(out) :: error !! set when a restart file cannot be read, or memory is short
    type(diagnostics_t) :: warnings

    call start_simulation(sim)
    if (allocated(sim%options%restart_file)) call load_checkpoint(sim, sim%options%restart_file, warnings, error)
    if (allocated(error)) return
    call warnings%print(error_unit)
    call predict(sim%scene, sim%time(), 0.0_wp, sim%options%theta)
    call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
    call check_limits(sim, error)
  end subroutine find_contacts

  !> Split bodies by the method of the options.
  subroutine split_bodies(sim, load, parts, boxes, part, error)
    type(simulation_t), intent(in) :: sim !! its contacts are known
    real(wp), intent(in) :: load(:) !! load of each body [half contacts], shape (bodies)
    integer, intent(in) :: parts !! number of parts
    integer, intent(out) :: boxes(3) !! boxes along x, y and z, 0 where there are none
    integer(i4), allocatable, intent(out) :: part(:) !! part of each body, from 1; 0 for walls
    type(error_t), allocatable, intent(out) :: error !! set when they cannot be split so

    boxes = 0
    if (count(sim%scene%bodies%is_grain) < parts) then
      call fail(error, 'the scene has '//to_text(count(sim%scene%bodies%is_grain))//' grains, too few for '// &
                to_text(parts)//' parts')
    else if (sim%options%partition%split == 'graph') then
      call split_by_graph(sim, parts, part, error)
    else
      call split_by_boxes(sim, load, parts, boxes, part, error)
    end if
  end subroutine split_bodies

  !> Parts of all bodies by boxes.
  subroutine split_by_boxes(sim, load, parts, boxes, part, error)
    type(simulation_t), intent(in) :: sim
    real(wp), intent(in) :: load(:)
    integer, intent(in) :: parts
    integer, intent(out) :: boxes(3)
    integer(i4), allocatable, intent(out) :: part(:)
    type(error_t), allocatable, intent(out) :: error
    type(comm_t) :: alone
    real(wp), allocatable :: position(:, :)
    integer(i4), allocatable :: grain(:), box(:)
    integer :: b

    associate (bodies => sim%scene%bodies)
      grain = pack([(int(b, i4), b=1, bodies%n)], bodies%is_grain)
      position = bodies%position(:, grain)
      call choose_boxes(alone, position, parts, sim%options%partition%boxes, boxes, error)
      if (allocated(error)) return
      call split_boxes(alone, position, load(grain), grain, boxes, box)
      allocate (part(bodies%n), source=0_i4)
      part(grain) = box
    end associate
  end subroutine split_by_boxes

  !> Parts of all bodies by the graph of contacts, in full resolution.
  subroutine split_by_graph(sim, parts, part, error)
    type(simulation_t), intent(in) :: sim
    integer, intent(in) :: parts
    integer(i4), allocatable, intent(out) :: part(:)
    type(error_t), allocatable, intent(out) :: error
    type(contact_graph_t) :: graph
    type(comm_t) :: alone
    real(wp), allocatable :: position(:, :)
    integer(i4), allocatable :: vertex_part(:)
    integer :: b

    associate (bodies => sim%scene%bodies)
      position = bodies%position(:, pack([(b, b=1, bodies%n)], bodies%is_grain))
      call build_contact_graph(sim%contacts, bodies%is_grain, curve_order(alone, position), graph)
    end associate
    call split_graph(graph, parts, imbalance, vertex_part, error)
    if (allocated(error)) return
    allocate (part(sim%scene%bodies%n), source=0_i4)
    part(graph%body) = vertex_part
  end subroutine split_by_graph

  !> Work out the matrix of those contacts between parts that can carry an impulse.
  subroutine look_at_interface(sim, cut, blocks)
    type(simulation_t), intent(inout) :: sim
    integer, intent(in) :: cut(:)
    type(block_structure_t), intent(out) :: blocks
    type(interface_blocks_t) :: rows
    integer :: k

    call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, sim%options%substep_length(), sim%problem)
    call rows%build(sim%problem, pack(cut, [(is_active(sim%problem, cut(k)), k=1, size(cut))]))
    blocks = rows%structure()
  end subroutine look_at_interface

  !> Draw the scene into a folder, made where it is missing; each body has the number of its part, from 0, as its rank.
  subroutine draw_split(sim, part, folder, error)
    type(simulation_t), intent(inout) :: sim !! simulation that was split
    integer(i4), intent(in) :: part(:) !! part of each body, from 1; 0 for walls
    character(len=*), intent(in) :: folder !! folder for the pictures
    type(error_t), allocatable, intent(out) :: error !! set when a file cannot be written
    type(pictures_t) :: pictures
    type(comm_t) :: alone

    if (has_results(folder)) then
      call fail(error, 'this folder holds results of a run: --picture must name another one', file=folder)
    else if (.not. make_folder(folder)) then
      call fail(error, 'cannot make the folder of the pictures', file=folder, code=exit_output)
    end if
    if (allocated(error)) return
    sim%options%folder = folder
    call pictures%open(sim%scene, sim%options, -1, error, alone)
    if (.not. allocated(error)) call pictures%write(sim%scene, sim%contacts, sim%time(), sim%step, alone, error, part - 1_i4)
    if (.not. allocated(error)) call pictures%close(alone, error)
  end subroutine draw_split
end module sg_start_split
