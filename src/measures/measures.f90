!> All indicators of one moment under the names that record.csv and run.json share.
!!
!! Measure after the update of a step: positions and velocities are those of its end; contacts, shapes and gaps
!! those of its detection configuration. Scenes in space have a few measures more than those in the plane.
!!
!! Each indicator is made of what every rank says of its own bodies and contacts. Two exchanges with neighbours (how many
!! touch a grain), one largest value and one sum over the ranks make them those of the whole scene, on all ranks.
module sg_measures
  use sg_bonds, only: bond_sums
  use sg_balance, only: carried_share, force_on_walls, momentum
  use sg_comm, only: comm_t
  use sg_compactness, only: area_of_box, box_of_grains
  use sg_contacts, only: contacts_t
  use sg_coordination, only: coordination_of, coordination_sums, coordination_t, n_coordination_sums, neighbours_of, &
                             touching_pairs, touching_t
  use sg_energy, only: closure_of, energy_sums, energy_t, n_energy_sums
  use sg_grains, only: grain_sums, grains_of, grains_t, n_grain_sums
  use sg_home_sum, only: add_grains_at_home, copy_from_home
  use sg_inertia_number, only: field_sums, gradient_of, inertia_number, shear_rate
  use sg_internal_values, only: bond_slip
  use sg_kinds, only: wp
  use sg_penetration, only: deepest_penetration, penetration_sums
  use sg_scene, only: scene_t
  use sg_stress, only: stress_sums
  use sg_subdomain, only: subdomain_t
  use sg_velocities, only: speed_sums
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
    'mean_velocity', 'max_velocity', 'inertia_number', 'pressure', 'floor_share', &
    'rattlers']
  !> What follows in the plane
  character(len=name_length), parameter :: plane_names(7) = [character(len=name_length) :: &
    'stress_xx', 'stress_xy', 'stress_yx', 'stress_yy', 'shear_rate', 'momentum_x', 'momentum_y']
  !> What follows in space
  character(len=name_length), parameter :: space_names(14) = [character(len=name_length) :: 'quadruple_contacts', &
    'stress_xx', 'stress_xy', 'stress_xz', 'stress_yx', 'stress_yy', 'stress_yz', 'stress_zx', 'stress_zy', 'stress_zz', &
    'shear_rate', 'momentum_x', 'momentum_y', 'momentum_z']

  !> What follows both where there are cohesive zones
  character(len=name_length), parameter :: bond_names(4) = [character(len=name_length) :: &
    'bond_energy', 'bond_loss', 'bonds', 'damaged_bonds']

  !> What the measures are made of: sums over bodies and contacts, of one rank or of all
  type :: sums_t
    real(wp) :: energy(n_energy_sums) = 0, gaps(2) = 0, overlap(1) = 0, grains(n_grain_sums) = 0
    real(wp) :: touch(n_coordination_sums) = 0, speed(1) = 0
    !> Energy in bonds [J], bonds that hold, and those of them that are damaged
    real(wp) :: bonds(3) = 0
    !> Stress, force on the walls, momentum, and velocity field, by dimension of space
    real(wp), allocatable :: stress(:), force(:), momentum(:), field(:)
  end type sums_t

  !> Largest values, of one rank or of all
  type :: extremes_t
    !> Box of the grains, shape (dimension, 2), and largest speed and penetration
    real(wp), allocatable :: box(:, :)
    real(wp) :: speed = 0, penetration = 0
  end type extremes_t

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
  pure integer function n_measures(dimension, has_bonds)
    integer, intent(in) :: dimension !! of space
    logical, intent(in) :: has_bonds !! are there cohesive zones?

    n_measures = size(shared_names) + merge(size(plane_names), size(space_names), dimension == 2)
    if (has_bonds) n_measures = n_measures + size(bond_names)
  end function n_measures

  !> Their names, in the order of their values.
  pure function measure_names(dimension, has_bonds) result(names)
    integer, intent(in) :: dimension !! of space
    logical, intent(in) :: has_bonds !! are there cohesive zones?
    character(len=name_length) :: names(n_measures(dimension, has_bonds))
    integer :: n

    n = n_measures(dimension, .false.)
    names(:size(shared_names)) = shared_names
    if (dimension == 2) then
      names(size(shared_names) + 1:n) = plane_names
    else
      names(size(shared_names) + 1:n) = space_names
    end if
    if (has_bonds) names(n + 1:) = bond_names
  end function measure_names

  !> Is a measure a whole number?
  pure logical function is_count(name)
    character(len=*), intent(in) :: name !! one of `measure_names`

    select case (name)
    case ('single_contacts', 'double_contacts', 'triple_contacts', 'quadruple_contacts', 'rattlers', 'bonds', 'damaged_bonds')
      is_count = .true.
    case default
      is_count = .false.
    end select
  end function is_count

  !> Measure everything. In a decomposed scene all ranks call this, and all get the measures of the whole scene.
  subroutine measure(scene, contacts, h, energy, measures, subdomain, comm)
    type(scene_t), intent(in) :: scene !! scene after the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    type(energy_t), intent(in) :: energy !! works since the start
    type(measures_t), intent(out) :: measures !! the indicators
    type(subdomain_t), intent(in), optional :: subdomain !! who shares which bodies; with `comm`
    type(comm_t), intent(inout), optional :: comm !! the ranks of a decomposed scene
    type(touching_t) :: touching
    type(sums_t) :: sums
    type(extremes_t) :: extremes
    real(wp) :: neighbours(1, scene%bodies%n)
    logical :: is_shared

    is_shared = .false.
    if (present(comm) .and. present(subdomain)) is_shared = comm%size > 1
    touching = touching_pairs(contacts, scene%bodies%n)
    neighbours(1, :) = neighbours_of(touching, scene%bodies%n)
    call speed_sums(scene%bodies, sums%speed(1), extremes%speed)
    extremes%box = box_of_grains(scene)
    extremes%penetration = deepest_penetration(contacts)
    if (is_shared) then
      call add_grains_at_home(subdomain, comm, neighbours)
      call copy_from_home(subdomain, comm, neighbours)
      call share_extremes(comm, extremes)
      sums%field = field_sums(scene%bodies, middle_of(extremes%box))
    else
      sums%field = field_sums(scene%bodies)
    end if
    call sum_up(scene, contacts, h, energy, touching, neighbours(1, :), sums)
    if (is_shared) call share_sums(comm, sums)
    call conclude(scene, h, energy%is_started, contacts%n_internal >= bond_slip, sums, extremes, measures)
  end subroutine measure

  !> Sums over this rank's bodies and contacts, beside those of speeds and of the velocity field.
  pure subroutine sum_up(scene, contacts, h, energy, touching, neighbours, sums)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in) :: h, neighbours(:)
    type(energy_t), intent(in) :: energy
    type(touching_t), intent(in) :: touching
    type(sums_t), intent(inout) :: sums

    sums%energy = energy_sums(energy, scene, contacts)
    sums%gaps = penetration_sums(contacts)
    sums%bonds = bond_sums(scene, contacts)
    sums%overlap = shared_by_shapes(scene, contacts)
    sums%grains = grain_sums(scene%bodies)
    sums%touch = coordination_sums(touching, scene%bodies%is_grain, scene%bodies%n_home, neighbours)
    sums%stress = reshape(stress_sums(scene, contacts), [scene%dimension**2])
    sums%force = force_on_walls(scene, contacts, h)
    sums%momentum = momentum(scene%bodies)
  end subroutine sum_up

  !> Largest values of all ranks, by one reduction.
  subroutine share_extremes(comm, extremes)
    type(comm_t), intent(inout) :: comm
    type(extremes_t), intent(inout) :: extremes
    real(wp) :: values(2*size(extremes%box, 1) + 2)
    integer :: d

    d = size(extremes%box, 1)
    values = [-extremes%box(:, 1), extremes%box(:, 2), extremes%speed, extremes%penetration]
    call comm%maximum(values)
    extremes%box(:, 1) = -values(:d)
    extremes%box(:, 2) = values(d + 1:2*d)
    extremes%speed = values(2*d + 1)
    extremes%penetration = values(2*d + 2)
  end subroutine share_extremes

  !> Sums over all ranks, by one reduction.
  subroutine share_sums(comm, sums)
    type(comm_t), intent(inout) :: comm
    type(sums_t), intent(inout) :: sums
    real(wp), allocatable :: all(:)
    integer :: at

    all = [sums%energy, sums%gaps, sums%overlap, sums%grains, sums%touch, sums%speed, sums%bonds, sums%stress, &
           sums%force, sums%momentum, sums%field]
    call comm%sum(all)
    at = 0
    call take(sums%energy)
    call take(sums%gaps)
    call take(sums%overlap)
    call take(sums%grains)
    call take(sums%touch)
    call take(sums%speed)
    call take(sums%bonds)
    call take(sums%stress)
    call take(sums%force)
    call take(sums%momentum)
    call take(sums%field)
  contains
    subroutine take(part)
      real(wp), intent(inout) :: part(:)

      part = all(at + 1:at + size(part))
      at = at + size(part)
    end subroutine take
  end subroutine share_sums

  !> Middle of a box [m]; the origin where it is empty.
  pure function middle_of(box) result(middle)
    real(wp), intent(in) :: box(:, :)
    real(wp) :: middle(size(box, 1))

    middle = 0
    if (all(box(:, 1) <= box(:, 2))) middle = (box(:, 1) + box(:, 2))/2
  end function middle_of

  !> The indicators from sums and largest values of the whole scene.
  pure subroutine conclude(scene, h, has_energy, has_bonds, sums, extremes, measures)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: h
    logical, intent(in) :: has_energy, has_bonds
    type(sums_t), intent(in) :: sums
    type(extremes_t), intent(in) :: extremes
    type(measures_t), intent(inout) :: measures
    type(grains_t) :: grains
    type(coordination_t) :: touch
    real(wp) :: stress(scene%dimension, scene%dimension), pressure, box, rate, n
    integer :: last

    grains = grains_of(sums%grains)
    n = sums%grains(1)
    touch = coordination_of(sums%touch)
    box = area_of_box(scene, extremes%box)
    stress = 0
    if (box*h > 0) stress = reshape(sums%stress, shape(stress))/(box*h)
    pressure = mean_pressure(stress)
    rate = shear_rate(gradient_of(sums%field, scene%dimension))
    allocate (measures%value(n_measures(scene%dimension, has_bonds)))
    last = n_measures(scene%dimension, .false.)
    if (has_bonds) measures%value(last + 1:) = [sums%bonds(1), sums%energy(10) - sums%bonds(1), sums%bonds(2:3)]
    measures%value(:size(shared_names)) = &
      [sums%energy(1:2), sums%energy(6:9), closure_of(sums%energy, has_energy), &
       ratio(sums%gaps(2), sums%gaps(1)), extremes%penetration, ratio(sums%overlap(1), grains%area), ratio(grains%area, box), &
       touch%mean, touch%without_rattlers, real([touch%single, touch%double, touch%triple], wp), &
       ratio(sums%speed(1), n), extremes%speed, inertia_number(rate, mass_by_length(grains, scene%dimension), pressure), &
       pressure, carried_share(sums%force, scene%gravity, grains%mass), real(touch%rattlers, wp)]
    associate (rest => measures%value(size(shared_names) + 1:last))
      if (scene%dimension == 2) then
        measures%value(16) = real(touch%triple + touch%quadruple, wp)
        rest = [stress(1, :), stress(2, :), rate, sums%momentum]
      else
        rest = [real(touch%quadruple, wp), stress(1, :), stress(2, :), stress(3, :), rate, sums%momentum]
      end if
    end associate
  end subroutine conclude

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
    integer :: i, dimension, n
    logical :: has_bonds

    value = 0
    if (.not. allocated(self%value)) return
    n = size(self%value)
    has_bonds = any(n == [n_measures(2, .true.), n_measures(3, .true.)])
    dimension = merge(2, 3, n == n_measures(2, has_bonds))
    associate (names => measure_names(dimension, has_bonds))
      do i = 1, size(names)
        if (names(i) == name) value = self%value(i)
      end do
    end associate
  end function measures_get
end module sg_measures
