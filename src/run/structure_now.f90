!> Structure of the packing after a step: computed on all ranks, written by the root rank.
module sg_structure_now
  use sg_centres, only: centres_t, take_centres
  use sg_error, only: error_t
  use sg_radial_distribution, only: radial_distribution, radial_distribution_t
  use sg_simulation, only: simulation_t
  use sg_structure_factor, only: structure_factor, structure_factor_t
  use sg_timed, only: timed
  use sg_totals, only: phase_measure, phase_output
  implicit none
  private
  public :: report_structure

contains

  !> Add the present structure to its files, unless it is in them. Collective.
  subroutine report_structure(sim, error)
    type(simulation_t), intent(inout) :: sim !! between two steps
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when a file cannot be written

    if (sim%writers%structure%step == sim%step) return
    call timed(add_structure, sim, phase_measure, error)
    call timed(write_structure, sim, phase_output, error)
  end subroutine report_structure

  !> Add the present structure to the texts of its files. Collective.
  subroutine add_structure(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error
    type(centres_t) :: centres
    type(radial_distribution_t) :: distribution
    type(structure_factor_t) :: factor

    call take_centres(sim%scene, sim%options%structure_box, sim%comm, centres)
    call radial_distribution(centres, sim%comm, distribution)
    call structure_factor(centres, sim%comm, factor)
    call sim%writers%structure%add(sim%step, sim%time(), centres%diameter, distribution, factor)
  end subroutine add_structure

  !> Write both files. Collective.
  subroutine write_structure(sim, error)
    type(simulation_t), intent(inout) :: sim
    type(error_t), allocatable, intent(out) :: error

    if (sim%writers%is_root) call sim%writers%structure%write(sim%options%folder, error)
    call sim%comm%agree(error)
  end subroutine write_structure
end module sg_structure_now
