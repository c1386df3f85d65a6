!> Indicators of one moment, under the names that record.csv and run.json share: THE list of indicators.
!!
!! Measure after the update of a step: positions and velocities are those of its end; contacts, shapes and gaps those of its
!! detection configuration. Two exchanges with neighbours (how many bodies touch a grain), one reduction of largest values and one
!! of sums make the indicators those of the whole scene, on all ranks.
module sg_measures
  use sg_balance, only: measure_floor_share, measure_momentum
  use sg_bond_energy, only: measure_bonds
  use sg_body_kinds, only: n_body_kinds
  use sg_comm, only: comm_t
  use sg_compactness, only: measure_compactness
  use sg_contacts, only: contacts_t, has_bonds
  use sg_coordination, only: measure_by_kind, measure_coordination, measure_kinds_of_pairs, measure_rattlers, neighbours_of, &
                             touching_pairs, touching_t
  use sg_energy, only: energy_t, measure_energy, measure_rolling
  use sg_fabric, only: measure_fabric
  use sg_grains, only: sum_grains
  use sg_inertia_number, only: measure_inertia, measure_shear_rate
  use sg_kinds, only: wp
  use sg_means, only: means_t, measure_means
  use sg_mobilised_friction, only: measure_friction
  use sg_owner_sums, only: add_grains_at_owner, copy_from_owner
  use sg_penetration, only: measure_penetration
  use sg_scene, only: scene_t
  use sg_stress, only: measure_pressure, measure_stress
  use sg_subdomain, only: subdomain_t
  use sg_tally, only: column_t, pass_columns, tally_t
  use sg_velocities, only: measure_velocities
  use sg_volume_error, only: measure_volume_error
  implicit none
  private
  public :: measures_t, measure, unmeasured

  !> Indicators of one moment
  type :: measures_t
    !> Columns in the order of record.csv; unallocated before the first measure
    type(column_t), allocatable :: column(:)
  contains
    procedure :: get => measures_get
  end type measures_t

  !> Measure a scene that ranks share, or that one rank holds
  interface measure
    module procedure measure_shared, measure_alone
  end interface measure

contains

  !> THE list: one line per indicator, in the order of columns (doc/guide/results.md has their meanings and units).
  pure subroutine visit_indicators(scene, contacts, energy, touching, neighbours, means, tally)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    type(energy_t), intent(in) :: energy
    type(touching_t), intent(in) :: touching
    real(wp), intent(in) :: neighbours(:)
    type(means_t), intent(in) :: means
    type(tally_t), intent(inout) :: tally

    call sum_grains(scene%bodies, tally)
    call measure_energy(scene, contacts, energy, tally)
    call measure_penetration(contacts, tally)
    call measure_volume_error(scene, contacts, tally)
    call measure_compactness(scene, tally)
    call measure_coordination(scene%bodies, touching, neighbours, tally)
    call measure_velocities(scene%bodies, tally)
    call measure_inertia(scene, tally)
    call measure_pressure(scene, contacts, tally)
    call measure_floor_share(scene, contacts, tally)
    call measure_rattlers(scene%dimension, tally)
    call measure_stress(scene, tally)
    call measure_shear_rate(scene%dimension, tally)
    call measure_momentum(scene%bodies, tally)
    call measure_fabric(scene, contacts, tally)
    call measure_friction(scene, contacts, tally)
    call measure_kinds_of_pairs(tally)
    call measure_by_kind(scene%bodies, scene%contactors, neighbours, tally)
    call measure_means(scene, means, tally)
    call measure_bonds(scene, contacts, tally)
    call measure_rolling(tally)
  end subroutine visit_indicators

  !> Measure everything. Collective: all ranks get the measures of the whole scene.
  subroutine measure_shared(scene, contacts, h, energy, measures, subdomain, comm, means, kinds)
    type(scene_t), intent(in) :: scene !! scene after the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    type(energy_t), intent(in) :: energy !! works since the start
    type(measures_t), intent(out) :: measures !! the indicators
    type(subdomain_t), intent(in) :: subdomain !! which ranks hold which bodies
    type(comm_t), intent(inout) :: comm !! the ranks
    type(means_t), intent(in), optional :: means !! sums of the interval that ends with the step, none unless given
    logical, intent(in), optional :: kinds(n_body_kinds) !! kinds of bodies of the whole scene; one unless given
    type(means_t) :: interval
    type(tally_t) :: tally
    type(touching_t) :: touching
    real(wp) :: neighbours(1, scene%bodies%n)

    if (present(means)) interval = means
    tally%is_shared = comm%size > 1
    tally%h = h
    tally%has_bonds = has_bonds(contacts)
    tally%has_rolling = contacts%n_moments > 0
    if (present(kinds)) call tally%set_kinds(kinds)
    touching = touching_pairs(contacts, scene%bodies%n)
    neighbours(1, :) = neighbours_of(touching, scene%bodies%n)
    if (tally%is_shared) then
      call add_grains_at_owner(subdomain, comm, neighbours)
      call copy_from_owner(subdomain, comm, neighbours)
    end if
    do while (tally%pass <= pass_columns)
      call visit_indicators(scene, contacts, energy, touching, neighbours(1, :), interval, tally)
      call tally%reduce(comm)
    end do
    call move_alloc(tally%column, measures%column)
  end subroutine measure_shared

  !> Measure a scene that one rank holds.
  subroutine measure_alone(scene, contacts, h, energy, measures)
    type(scene_t), intent(in) :: scene !! scene after the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    type(energy_t), intent(in) :: energy !! works since the start
    type(measures_t), intent(out) :: measures !! the indicators
    type(subdomain_t) :: undivided
    type(comm_t) :: alone

    call measure_shared(scene, contacts, h, energy, measures, undivided, alone)
  end subroutine measure_alone

  !> Columns of a scene that is not measured yet: their values are zero.
  pure function unmeasured(dimension, with_bonds, has_means, kinds, with_rolling) result(measures)
    integer, intent(in) :: dimension !! of space
    logical, intent(in) :: with_bonds !! are there cohesive zones?
    logical, intent(in), optional :: has_means !! are there means over the recorded interval? None unless given
    logical, intent(in), optional :: kinds(n_body_kinds) !! kinds of bodies of the whole scene; one unless given
    logical, intent(in), optional :: with_rolling !! do laws in use resist rolling? None does unless given
    type(measures_t) :: measures
    type(means_t) :: means
    type(tally_t) :: tally
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(energy_t) :: energy
    type(touching_t) :: touching

    scene%dimension = dimension
    scene%bodies%dimension = dimension
    tally%has_bonds = with_bonds
    if (present(with_rolling)) tally%has_rolling = with_rolling
    if (present(has_means)) means%is_on = has_means
    if (present(kinds)) call tally%set_kinds(kinds)
    tally%pass = pass_columns
    call visit_indicators(scene, contacts, energy, touching, [real(wp) ::], means, tally)
    call move_alloc(tally%column, measures%column)
  end function unmeasured

  !> The measure of a name; zero where the scene has none of this name, and before the first measure.
  pure real(wp) function measures_get(self, name) result(value)
    class(measures_t), intent(in) :: self
    character(len=*), intent(in) :: name !! name of a column
    integer :: i

    value = 0
    if (.not. allocated(self%column)) return
    do i = 1, size(self%column)
      if (self%column(i)%name == name) value = self%column(i)%value
    end do
  end function measures_get
end module sg_measures
