!> All indicators of one moment under the names that record.csv and run.json share.
!!
!! Measure after the update of a step: positions and velocities are those of its end; contacts, shapes and gaps
!! those of its detection configuration.
module sg_measures
  use sg_balance, only: floor_share, momentum
  use sg_compactness, only: box_area
  use sg_contacts, only: contacts_t
  use sg_coordination, only: coordinate, coordination_t
  use sg_energy, only: energy_closure, energy_t, kinetic_energy, potential_energy
  use sg_grains, only: count_grains, grains_t
  use sg_inertia_number, only: inertia_number, shear_rate, velocity_gradient
  use sg_kinds, only: wp
  use sg_penetration, only: penetrations
  use sg_scene, only: scene_t
  use sg_stress, only: mean_stress
  use sg_velocities, only: speeds
  use sg_volume_error, only: overlap_area
  implicit none
  private
  public :: measures_t, measure, n_measures, measure_names, is_count

  !> Number of measures
  integer, parameter :: n_measures = 29
  !> Their names (doc/guide/results.md says what each one is)
  character(len=29), parameter :: measure_names(n_measures) = [character(len=29) :: &
    'kinetic_energy', 'potential_energy', 'external_work', 'drive_work', 'friction_loss', 'impact_loss', 'energy_closure', &
    'mean_penetration', 'max_penetration', 'volume_error', 'compactness', &
    'coordination', 'coordination_without_rattlers', 'single_contacts', 'double_contacts', 'triple_contacts', &
    'mean_velocity', 'max_velocity', 'inertia_number', 'pressure', 'floor_share', &
    'rattlers', 'stress_xx', 'stress_xy', 'stress_yx', 'stress_yy', 'shear_rate', 'momentum_x', 'momentum_y']
  !> Is a measure a whole number?
  logical, parameter :: is_count(n_measures) = [spread(.false., 1, 13), spread(.true., 1, 3), spread(.false., 1, 5), &
                                                .true., spread(.false., 1, 7)]

  !> The indicators of one moment
  type :: measures_t
    !> Values in the order of `measure_names`; before the first measure all are zero
    real(wp) :: value(n_measures) = 0
  contains
    procedure :: get => measures_get
  end type measures_t

contains

  !> Measure everything.
  pure subroutine measure(scene, contacts, h, energy, measures)
    type(scene_t), intent(in) :: scene !! scene after the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    type(energy_t), intent(in) :: energy !! works since the start
    type(measures_t), intent(out) :: measures !! the indicators
    type(grains_t) :: grains
    type(coordination_t) :: touch
    real(wp) :: penetration(2), speed(2), stress(2, 2), pressure, box, rate, overlap

    grains = count_grains(scene%bodies)
    touch = coordinate(contacts, scene%bodies%is_grain)
    call penetrations(contacts, penetration(1), penetration(2))
    call speeds(scene%bodies, speed(1), speed(2))
    overlap = overlap_area(scene%contactors, contacts, scene%period)
    box = box_area(scene)
    stress = mean_stress(scene, contacts, h, box)
    pressure = (stress(1, 1) + stress(2, 2))/2
    rate = shear_rate(velocity_gradient(scene%bodies))
    measures%value = [kinetic_energy(scene%bodies), potential_energy(scene), energy%external_work, energy%drive_work, &
                      energy%friction_loss, energy%impact_loss, energy_closure(energy, scene), &
                      penetration, ratio(overlap, grains%area), ratio(grains%area, box), &
                      touch%mean, touch%without_rattlers, real([touch%single, touch%double, touch%triple], wp), &
                      speed, inertia_number(rate, ratio(grains%mass, real(grains%n, wp)), pressure), pressure, &
                      floor_share(scene, contacts, h, grains%mass), &
                      real(touch%rattlers, wp), stress(1, :), stress(2, :), rate, momentum(scene%bodies)]
  end subroutine measure

  !> A ratio, zero where its denominator is not positive.
  pure real(wp) function ratio(part, whole)
    real(wp), intent(in) :: part, whole

    ratio = 0
    if (whole > 0) ratio = part/whole
  end function ratio

  !> The measure of a name; the name must be one of `measure_names`.
  pure real(wp) function measures_get(self, name) result(value)
    class(measures_t), intent(in) :: self
    character(len=*), intent(in) :: name !! one of `measure_names`
    integer :: i

    value = 0
    do i = 1, n_measures
      if (measure_names(i) == name) value = self%value(i)
    end do
  end function measures_get
end module sg_measures
