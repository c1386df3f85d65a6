!> All indicators of one moment under the names that record.csv and run.json share.
!!
!! Measure after the update of a step: positions and velocities are those of its end; contacts, shapes and gaps
!! those of its detection configuration. Scenes in space have a few measures more than those in the plane.
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
  use sg_volume_error_space, only: overlap_volume
  implicit none
  private
  public :: measures_t, measure, n_measures, measure_names, is_count

  !> Longest name
  integer, parameter :: name_length = 29
  !> Measures that scenes in the plane and in space share (doc/guide/results.md says what each one is)
  character(len=name_length), parameter :: shared_names(22) = [character(len=name_length) :: &
    'kinetic_energy', 'potential_energy', 'external_work', 'drive_work', 'friction_loss', 'impact_loss', 'energy_closure', &
    'mean_penetration', 'max_penetration', 'volume_error', 'compactness', &
    'coordination', 'coordination_without_rattlers', 'single_contacts', 'double_contacts', 'triple_contacts', &
    'mean_velocity', 'max_velocity', 'inertia_number', 'pressure', 'floor_share', 'rattlers']
  !> What follows in the plane
  character(len=name_length), parameter :: plane_names(7) = [character(len=name_length) :: &
    'stress_xx', 'stress_xy', 'stress_yx', 'stress_yy', 'shear_rate', 'momentum_x', 'momentum_y']
  !> What follows in space
  character(len=name_length), parameter :: space_names(14) = [character(len=name_length) :: 'quadruple_contacts', &
    'stress_xx', 'stress_xy', 'stress_xz', 'stress_yx', 'stress_yy', 'stress_yz', 'stress_zx', 'stress_zy', 'stress_zz', &
    'shear_rate', 'momentum_x', 'momentum_y', 'momentum_z']

  !> The indicators of one moment
  type :: measures_t
    !> Values in the order of `measure_names`; unallocated before the first measure
    real(wp), allocatable :: value(:)
  contains
    procedure :: at => measures_at
    procedure :: get => measures_get
  end type measures_t

contains

  !> Number of measures of a scene.
  pure integer function n_measures(dimension)
    integer, intent(in) :: dimension !! of space

    n_measures = size(shared_names) + merge(size(plane_names), size(space_names), dimension == 2)
  end function n_measures

  !> Their names, in the order of their values.
  pure function measure_names(dimension) result(names)
    integer, intent(in) :: dimension !! of space
    character(len=name_length) :: names(n_measures(dimension))

    names(:size(shared_names)) = shared_names
    if (dimension == 2) then
      names(size(shared_names) + 1:) = plane_names
    else
      names(size(shared_names) + 1:) = space_names
    end if
  end function measure_names

  !> Is a measure a whole number?
  pure logical function is_count(name)
    character(len=*), intent(in) :: name !! one of `measure_names`

    select case (name)
    case ('single_contacts', 'double_contacts', 'triple_contacts', 'quadruple_contacts', 'rattlers')
      is_count = .true.
    case default
      is_count = .false.
    end select
  end function is_count

  !> Measure everything.
  pure subroutine measure(scene, contacts, h, energy, measures)
    type(scene_t), intent(in) :: scene !! scene after the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    type(energy_t), intent(in) :: energy !! works since the start
    type(measures_t), intent(out) :: measures !! the indicators
    type(grains_t) :: grains
    type(coordination_t) :: touch
    real(wp) :: penetration(2), speed(2), stress(scene%dimension, scene%dimension), pressure, box, rate

    grains = count_grains(scene%bodies)
    touch = coordinate(contacts, scene%bodies%is_grain)
    call penetrations(contacts, penetration(1), penetration(2))
    call speeds(scene%bodies, speed(1), speed(2))
    box = box_area(scene)
    stress = mean_stress(scene, contacts, h, box)
    pressure = mean_pressure(stress)
    rate = shear_rate(velocity_gradient(scene%bodies))
    allocate (measures%value(n_measures(scene%dimension)))
    measures%value(:size(shared_names)) = &
      [kinetic_energy(scene%bodies), potential_energy(scene), energy%external_work, energy%drive_work, &
       energy%friction_loss, energy%impact_loss, energy_closure(energy, scene), &
       penetration, ratio(shared_by_shapes(scene, contacts), grains%area), ratio(grains%area, box), &
       touch%mean, touch%without_rattlers, real([touch%single, touch%double, touch%triple], wp), &
       speed, inertia_number(rate, mass_by_length(grains, scene%dimension), pressure), pressure, &
       floor_share(scene, contacts, h, grains%mass), real(touch%rattlers, wp)]
    associate (rest => measures%value(size(shared_names) + 1:))
      if (scene%dimension == 2) then
        measures%value(16) = real(touch%triple + touch%quadruple, wp)
        rest = [stress(1, :), stress(2, :), rate, momentum(scene%bodies)]
      else
        rest = [real(touch%quadruple, wp), stress(1, :), stress(2, :), stress(3, :), rate, momentum(scene%bodies)]
      end if
    end associate
  end subroutine measure

  !> Area, in space volume, of the overlaps of all pairs of shapes [m2, m3].
  pure real(wp) function shared_by_shapes(scene, contacts) result(overlap)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts

    if (scene%dimension == 2) then
      overlap = overlap_area(scene%contactors, contacts, scene%period)
    else
      overlap = overlap_volume(scene%contactors, contacts, [scene%period, scene%period_y])
    end if
  end function shared_by_shapes

  !> Mean of the normal stresses [Pa].
  pure real(wp) function mean_pressure(stress) result(pressure)
    real(wp), intent(in) :: stress(:, :)

    if (size(stress, 1) == 2) then
      pressure = (stress(1, 1) + stress(2, 2))/2
    else
      pressure = (stress(1, 1) + stress(2, 2) + stress(3, 3))/3
    end if
  end function mean_pressure

  !> What stands for inertia in the inertia number [kg/m]: the mean mass of a grain in the plane, rho d^2 in space.
  pure real(wp) function mass_by_length(grains, dimension) result(mass)
    type(grains_t), intent(in) :: grains
    integer, intent(in) :: dimension

    if (dimension == 2) then
      mass = ratio(grains%mass, real(grains%n, wp))
    else
      mass = ratio(grains%mass, grains%area)*(2*grains%mean_radius)**2
    end if
  end function mass_by_length

  !> A ratio, zero where its denominator is not positive.
  pure real(wp) function ratio(part, whole)
    real(wp), intent(in) :: part, whole

    ratio = 0
    if (whole > 0) ratio = part/whole
  end function ratio

  !> The measure of a number, from 1; zero before the first measure.
  pure real(wp) function measures_at(self, i) result(value)
    class(measures_t), intent(in) :: self
    integer, intent(in) :: i !! place in `measure_names`

    value = 0
    if (.not. allocated(self%value)) return
    if (i <= size(self%value)) value = self%value(i)
  end function measures_at

  !> The measure of a name; zero where the scene has none of this name, and before the first measure.
  pure real(wp) function measures_get(self, name) result(value)
    class(measures_t), intent(in) :: self
    character(len=*), intent(in) :: name !! one of `measure_names`
    integer :: i, dimension

    value = 0
    if (.not. allocated(self%value)) return
    dimension = merge(2, 3, size(self%value) == n_measures(2))
    associate (names => measure_names(dimension))
      do i = 1, size(names)
        if (names(i) == name) value = self%value(i)
      end do
    end associate
  end function measures_get
end module sg_measures
