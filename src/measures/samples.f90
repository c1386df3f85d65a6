!> Samples for spectra: series sampled at every step, kept for the whole run.
module sg_samples
  use sg_balance, only: force_on_walls, momentum
  use sg_bodies, only: bodies_t, spin_of
  use sg_comm, only: comm_t
  use sg_contacts, only: contacts_t
  use sg_kinds, only: wp
  use sg_lists, only: reserve
  use sg_scene, only: scene_t
  implicit none
  private
  public :: samples_t, series_names

  character(len=14), parameter :: forces(3) = [character(len=14) :: 'wall_force_x', 'wall_force_y', 'wall_force_z'], &
                                  momenta(3) = [character(len=14) :: 'momentum_x', 'momentum_y', 'momentum_z']

  !> The samples of a run
  type :: samples_t
    !> Number of steps sampled
    integer :: n = 0
    !> Samples, shape (series, steps), in the order of `series_names`; unallocated until the first one
    real(wp), allocatable :: value(:, :)
  contains
    procedure :: add => samples_add
    procedure :: reduce => samples_reduce
  end type samples_t

contains

  !> Names of the series: kinetic energy of the grains [J], force of contacts on all walls [N] and momentum of the grains
  !! [kg m/s] along x, y, and z in space.
  pure function series_names(dimension) result(names)
    integer, intent(in) :: dimension !! of space
    character(len=14) :: names(1 + 2*dimension)

    names = [character(len=14) :: 'kinetic_energy', forces(:dimension), momenta(:dimension)]
  end function series_names

  !> Sample a step after its update: the shares of this rank, which `reduce` adds up at the end.
  subroutine samples_add(self, scene, contacts, h)
    class(samples_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene of the step
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]

    associate (d => scene%dimension)
      call reserve(self%value, 1 + 2*d, self%n + 1)
      self%value(2:d + 1, self%n + 1) = force_on_walls(scene, contacts, h)
      self%value(d + 2:, self%n + 1) = momentum(scene%bodies)
    end associate
    self%n = self%n + 1
    self%value(1, self%n) = kinetic_energy_of_grains(scene%bodies)
  end subroutine samples_add

  !> From the shares of each rank to the samples of the whole scene, once, after the last step.
  subroutine samples_reduce(self, comm)
    class(samples_t), intent(inout) :: self
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), allocatable :: flat(:)

    if (comm%size == 1 .or. self%n == 0) return
    flat = reshape(self%value(:, :self%n), [size(self%value, 1)*self%n])
    call comm%sum(flat)
    self%value(:, :self%n) = reshape(flat, [size(self%value, 1), self%n])
  end subroutine samples_reduce

  !> Kinetic energy of this rank's grains [J]; walls, whose motion is imposed, do not count.
  pure real(wp) function kinetic_energy_of_grains(bodies) result(energy)
    type(bodies_t), intent(in) :: bodies
    integer :: i

    energy = 0
    do i = 1, bodies%n_own
      if (.not. bodies%is_grain(i)) cycle
      if (bodies%dimension == 2) then
        energy = energy + (bodies%mass(i)*sum(bodies%velocity(1:2, i)**2) + bodies%inertia(i)*spin_of(bodies, i)**2)/2
      else
        energy = energy + bodies%mass(i)*sum(bodies%velocity(1:3, i)**2)/2
        if (bodies%n_velocity == 6) energy = energy + sum(bodies%principal(:, i)*bodies%velocity(4:6, i)**2)/2
      end if
    end do
  end function kinetic_energy_of_grains
end module sg_samples
