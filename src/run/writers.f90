!> Writers of a run: record, tracked bodies, walls, regions, subdomains, interfaces, pictures, progress, summary, traces,
!! structure files.
module sg_writers
  use sg_field_file, only: field_file_t
  use sg_interface_file, only: interface_file_t
  use sg_measures, only: measures_t
  use sg_pictures, only: pictures_t
  use sg_progress, only: progress_t
  use sg_record, only: record_t
  use sg_region_file, only: region_file_t
  use sg_run_summary, only: run_summary_t
  use sg_run_trace, only: run_trace_t
  use sg_samples, only: samples_t
  use sg_structure_file, only: structure_file_t
  use sg_subdomain_file, only: subdomain_file_t
  use sg_track_file, only: track_file_t
  use sg_wall_file, only: wall_file_t
  implicit none
  private
  public :: writers_t

  !> All writers of a run, and the last measures
  type :: writers_t
    type(record_t) :: record
    type(track_file_t) :: tracks
    type(wall_file_t) :: walls
    type(region_file_t) :: regions
    type(subdomain_file_t) :: subdomains
    type(interface_file_t) :: interfaces
    type(field_file_t), allocatable :: fields(:)
    type(pictures_t) :: pictures
    type(progress_t) :: progress
    type(run_summary_t) :: summary
    type(measures_t) :: measures
    type(samples_t) :: samples
    type(run_trace_t) :: trace
    type(structure_file_t) :: structure
    !> Is this the rank that writes texts?
    logical :: is_root = .true.
    !> Are there pictures and checkpoints?
    logical :: has_pictures = .false., has_checkpoints = .false.
    !> Has this run claimed its folder, so that it may write there? Has it done a step?
    logical :: has_folder = .false., has_stepped = .false.
    !> Step of the last checkpoint written, and of the last measures; negative where there is none
    integer :: saved_step = -1, measured_step = -1
    !> What is written and when, as it was printed last
    character(len=:), allocatable :: outputs
    !> Has a warning been given that the energy balance does not close?
    logical :: has_warned = .false.
  end type writers_t
end module sg_writers
