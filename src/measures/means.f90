!> Means over the interval between two recorded steps ([output] record_mean): forces, stress, fabric, friction, kinetic energy.
!!
!! In every step the sums from which indicators follow are added up, each rank its share: impulse times branch, impulses on walls,
!! normals, tangential and normal impulses, and kinetic energy times the step. In a recorded step the same formulas as for one step
!! are applied to the sums over the interval.
module sg_means
  use sg_balance, only: carried_share, force_on_walls
  use sg_body_energy, only: kinetic_energy_at
  use sg_comm, only: comm_t
  use sg_compactness, only: area_of_box
  use sg_contacts, only: contacts_t
  use sg_fabric, only: add_fabric, fabric_sums, n_fabric_sums
  use sg_grains, only: grains_of, grains_t
  use sg_kinds, only: wp
  use sg_mobilised_friction, only: add_friction, friction_sums, n_friction_sums
  use sg_scene, only: scene_t
  use sg_stress, only: stress_sums
  use sg_tally, only: pass_columns, pass_sums, tally_t
  implicit none
  private
  public :: means_t, measure_means

  !> Places of the sums: kinetic energy times time, impulse on walls, impulse times branch, fabric, friction
  integer, parameter :: at_kinetic = 1, at_walls = 2, at_stress = 5, at_fabric = 14, at_friction = at_fabric + n_fabric_sums, &
                        n_values = at_friction + n_friction_sums - 1

  !> Sums since the last recorded step; shares of this rank
  type :: means_t
    !> Are means asked for?
    logical :: is_on = .false.
    !> Is the interval recorded, so that the next step begins another?
    logical :: is_recorded = .false.
    !> Length of the interval [s], and its sums
    real(wp) :: span = 0
    real(wp) :: sum(n_values) = 0
  contains
    procedure :: add_step => means_add_step
    procedure :: pack => means_pack
    procedure :: unpack => means_unpack
    procedure :: reduce => means_reduce
    procedure :: leave_to_first => means_leave_to_first
  end type means_t

contains

  !> Add a step that is solved but not updated: `free_velocity` is the velocity of its end.
  subroutine means_add_step(self, scene, contacts, h)
    class(means_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene after the solve, before the update
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    real(wp) :: values(n_values), stress(3, 3)

    if (.not. self%is_on) return
    if (self%is_recorded) then
      self%is_recorded = .false.
      self%span = 0
      self%sum = 0
    end if
    associate (d => scene%dimension)
      stress = 0
      stress(:d, :d) = stress_sums(scene, contacts)
      values = 0
      values(at_kinetic) = h*kinetic_energy_at(scene%bodies, scene%bodies%free_velocity)
      values(at_walls:at_walls + d - 1) = h*force_on_walls(scene, contacts, h)
      values(at_stress:at_fabric - 1) = reshape(stress, [9])
      values(at_fabric:at_friction - 1) = fabric_sums(scene, contacts)
      values(at_friction:) = friction_sums(scene, contacts)
    end associate
    self%span = self%span + h
    self%sum = self%sum + values
  end subroutine means_add_step

  !> Columns of the means.
  pure subroutine measure_means(scene, means, tally)
    type(scene_t), intent(in) :: scene !! scene of the step
    type(means_t), intent(in) :: means !! sums of the interval that ends with the step
    type(tally_t), intent(inout) :: tally !! tally of the measure
    type(grains_t) :: grains
    real(wp) :: sums(n_values), stress(3, 3), box
    character(len=*), parameter :: axis = 'xyz'
    integer :: a, b

    if (.not. means%is_on) return
    if (tally%pass == pass_sums) call tally%sums%put('means', means%sum)
    if (tally%pass /= pass_columns) return
    sums = tally%sums%get('means', n_values)
    if (means%span > 0) sums(:at_fabric - 1) = sums(:at_fabric - 1)/means%span
    box = area_of_box(scene, tally)
    stress = 0
    if (box > 0) stress = reshape(sums(at_stress:at_fabric - 1), [3, 3])/box
    grains = grains_of(tally)
    associate (d => scene%dimension, force => sums(at_walls:at_walls + scene%dimension - 1))
      call tally%add('mean_kinetic_energy', sums(at_kinetic))
      call tally%add('mean_pressure', sum([(stress(a, a), a=1, d)])/real(d, wp))
      call tally%add('mean_floor_share', carried_share(force, scene%gravity, grains%mass))
      do a = 1, d
        call tally%add('mean_wall_force_'//axis(a:a), force(a))
      end do
      do a = 1, d
        do b = 1, d
          call tally%add('mean_stress_'//axis(a:a)//axis(b:b), stress(a, b))
        end do
      end do
      call add_fabric(sums(at_fabric:at_friction - 1), d, 'mean_fabric_', tally)
      call add_friction(sums(at_friction:), 'mean_', tally)
    end associate
  end subroutine measure_means

  !> From the shares of each rank to the sums of the whole scene, for restart files. Collective.
  subroutine means_reduce(self, comm)
    class(means_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm !! the ranks

    if (self%is_on .and. comm%size > 1) call comm%sum(self%sum)
  end subroutine means_reduce

  !> The other way round: the first rank keeps the sums of the whole scene, and the others begin at zero.
  pure subroutine means_leave_to_first(self, comm)
    class(means_t), intent(inout) :: self
    type(comm_t), intent(in) :: comm !! the ranks

    if (comm%rank > 0) self%sum = 0
  end subroutine means_leave_to_first

  !> All that outlives a step as a list of reals, for restart files; empty where no means are asked for.
  pure function means_pack(self) result(values)
    class(means_t), intent(in) :: self
    real(wp), allocatable :: values(:)

    allocate (values(0))
    if (self%is_on) values = [merge(1.0_wp, 0.0_wp, self%is_recorded), self%span, self%sum]
  end function means_pack

  !> What `pack` gave; where a file holds none, means begin with the next step.
  pure subroutine means_unpack(self, values)
    class(means_t), intent(inout) :: self
    real(wp), intent(in) :: values(:) !! of a restart file

    if (.not. self%is_on .or. size(values) /= n_values + 2) return
    self%is_recorded = values(1) > 0
    self%span = values(2)
    self%sum = values(3:)
  end subroutine means_unpack
end module sg_means
