!> The structure of the packing at a step: worked out on all ranks, written by one.
module sg_structure_now
  use sg_centres, only: centres_t, take_centres
  use sg_error, only: error_t
  use sg_radial_distribution, only: radial_distribution, radial_distribution_t
  use sg_simulation, only: simulation_t
  use sg_structure_factor, only: structure_factor, structure_factor_t
  use sg_structure_file, only: structure_file_t
  use sg_totals, only: phase_measure, phase_output
  implicit none
  private
  public :: report_structure

contains

  !> Add the present structure to its files, unless it is in them. Collective.
  subroutine report_structure(sim, file, is_root, error)
    type(simulation_t), intent(inout) :: sim !! between two steps
    type(structure_file_t), intent(inout) :: file !! what was written before
    logical, intent(in) :: is_root !! is this the rank that writes?
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when a file cannot be written
    type(centres_t) :: centres
    type(radial_distribution_t) :: distribution
    type(structure_factor_t) :: factor

    if (file%step == sim%step) return
    call sim%totals%phase(phase_measure)%start()
    call take_centres(sim%scene, sim%options%structure_box, sim%comm, centres)
    call radial_distribution(centres, sim%comm, distribution)
    call structure_factor(centres, sim%comm, factor)
    call sim%totals%phase(phase_measure)%stop()
    call sim%totals%phase(phase_output)%start()
    call file%add(sim%step, sim%time(), centres%diameter, distribution, factor)
    if (is_root) call file%write(sim%options%folder, error)
    call sim%comm%agree(error)
    call sim%totals%phase(phase_output)%stop()
  end subroutine report_structure
end module sg_structure_now
