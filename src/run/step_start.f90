!> State at the beginning of a step that is cut into substeps: kept so that a step which fails in a later substep leaves bodies
!! where the step began.
module sg_step_start
  use sg_bodies, only: bodies_t
  use sg_energy, only: energy_t
  use sg_kinds, only: wp
  use sg_tables, only: per_body, tables_t
  use sg_totals, only: totals_t
  use sg_means, only: means_t
  use sg_tracks, only: tracks_t
  implicit none
  private
  public :: step_start_t

  !> What substeps change, as it was before the first one
  type :: step_start_t
    !> State of the bodies, shapes as in `bodies_t`
    real(wp), allocatable, private :: position(:, :), velocity(:, :), angle(:), orientation(:, :)
    !> Works and counts of the run so far
    type(energy_t), private :: energy
    type(totals_t), private :: totals
    type(tracks_t), private :: tracks
    type(means_t), private :: means
  contains
    procedure :: keep => step_start_keep
    procedure :: restore => step_start_restore
    procedure :: list_tables => step_start_list_tables
  end type step_start_t

contains

  !> Keep the state.
  pure subroutine step_start_keep(self, bodies, energy, totals, tracks, means)
    class(step_start_t), intent(inout) :: self
    type(bodies_t), intent(in) :: bodies !! bodies within the first substep, detection done: within the period
    type(energy_t), intent(in) :: energy !! of the steps before
    type(totals_t), intent(in) :: totals !! the same
    type(tracks_t), intent(in) :: tracks !! the same
    type(means_t), intent(in) :: means !! the same

    self%position = bodies%position
    self%velocity = bodies%velocity
    if (allocated(bodies%angle)) self%angle = bodies%angle
    if (allocated(bodies%orientation)) self%orientation = bodies%orientation
    self%energy = energy
    self%totals = totals
    self%tracks = tracks
    self%means = means
  end subroutine step_start_keep

  !> Bring the state back; what clocks have counted since stays.
  pure subroutine step_start_restore(self, bodies, energy, totals, tracks, means)
    class(step_start_t), intent(in) :: self
    type(bodies_t), intent(inout) :: bodies !! bodies of the same step
    type(energy_t), intent(inout) :: energy !! works to bring back
    type(totals_t), intent(inout) :: totals !! counts to bring back
    type(tracks_t), intent(inout) :: tracks !! sums to bring back
    type(means_t), intent(inout) :: means !! sums to bring back
    type(totals_t) :: now

    bodies%position = self%position
    bodies%velocity = self%velocity
    if (allocated(bodies%angle)) bodies%angle = self%angle
    if (allocated(bodies%orientation)) bodies%orientation = self%orientation
    energy = self%energy
    now = totals
    totals = self%totals
    totals%phase = now%phase
    totals%clock = now%clock
    tracks = self%tracks
    means = self%means
  end subroutine step_start_restore

  !> List the tables.
  subroutine step_start_list_tables(self, tables)
    class(step_start_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('step_start', per_body)
    call tables%note('position', self%position)
    call tables%note('velocity', self%velocity)
    call tables%note('angle', self%angle)
    call tables%note('orientation', self%orientation)
  end subroutine step_start_list_tables
end module sg_step_start
