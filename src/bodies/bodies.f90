!> The rigid bodies of a scene as a structure of arrays, one unit an array.
!!
!! Components of a planar body: x, y and, where the scene needs it, rotation. A scene in which nothing turns
!! (frictionless disks) drops the third component and the angles: `n_velocity` is then 2.
module sg_bodies
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: bodies_t, drop_rotation, spin_of, angle_of

  !> Rigid bodies in the plane
  type :: bodies_t
    !> Number of bodies
    integer :: n = 0
    !> Velocity components of a body: 3 (x, y, rotation), or 2 where nothing turns
    integer :: n_velocity = 3
    !> Centre of mass [m], shape (2, n), at the beginning of the step; in a periodic scene within the period
    real(wp), allocatable :: position(:, :)
    !> Orientation [rad], shape (n); unallocated where nothing turns
    real(wp), allocatable :: angle(:)
    !> Velocity [m/s, m/s, rad/s], shape (n_velocity, n)
    real(wp), allocatable :: velocity(:, :)
    !> Configuration in which contacts are sought [m, m, rad], shape (n_velocity, n)
    real(wp), allocatable :: middle(:, :)
    !> Mass [kg] per metre of depth, shape (n)
    real(wp), allocatable :: mass(:)
    !> Moment of inertia about the centre of mass [kg m2], shape (n)
    real(wp), allocatable :: inertia(:)
    !> Inverse inertia of each component [1/kg, 1/kg, 1/(kg m2)], zero where driven; shape (n_velocity, n)
    real(wp), allocatable :: inverse_mass(:, :)
    !> External forces of the step [N, N, N m], shape (n_velocity, n)
    real(wp), allocatable :: force(:, :)
    !> Velocity at the end of the step without contacts, shape (n_velocity, n)
    real(wp), allocatable :: free_velocity(:, :)
    !> Area covered by the body's shapes [m2], shape (n)
    real(wp), allocatable :: area(:)
    !> Periods crossed since the start, shape (n): position + crossings*period is the unwrapped one
    integer(i4), allocatable :: crossings(:)
    !> Is this body a grain (free in all components), or a wall (driven or pressed)? shape (n)
    logical, allocatable :: is_grain(:)
    !> Bulk material, index into the scene's materials, shape (n)
    integer(i4), allocatable :: material(:)
  contains
    procedure :: allocate => bodies_allocate
  end type bodies_t

contains

  !> Make room for `n` bodies at rest at the origin.
  subroutine bodies_allocate(self, n)
    class(bodies_t), intent(inout) :: self
    integer, intent(in) :: n !! number of bodies

    self%n = n
    self%n_velocity = 3
    allocate (self%position(2, n), self%velocity(3, n), self%middle(3, n), self%inverse_mass(3, n), &
              self%force(3, n), self%free_velocity(3, n), source=0.0_wp)
    allocate (self%angle(n), self%mass(n), self%inertia(n), self%area(n), source=0.0_wp)
    allocate (self%crossings(n), self%material(n), source=0_i4)
    allocate (self%is_grain(n), source=.true.)
  end subroutine bodies_allocate

  !> Leave out all that belongs to rotation: for scenes in which nothing turns.
  subroutine drop_rotation(bodies)
    type(bodies_t), intent(inout) :: bodies !! bodies that never turn

    if (bodies%n_velocity == 2) return
    bodies%n_velocity = 2
    deallocate (bodies%angle)
    call cut(bodies%velocity)
    call cut(bodies%middle)
    call cut(bodies%inverse_mass)
    call cut(bodies%force)
    call cut(bodies%free_velocity)
  end subroutine drop_rotation

  !> Keep the first two components.
  subroutine cut(records)
    real(wp), allocatable, intent(inout) :: records(:, :)
    real(wp), allocatable :: kept(:, :)

    allocate (kept(2, size(records, 2)))
    kept = records(:2, :)
    call move_alloc(kept, records)
  end subroutine cut

  !> Angular velocity of a body [rad/s]; zero where nothing turns.
  pure real(wp) function spin_of(bodies, body)
    type(bodies_t), intent(in) :: bodies !! the bodies
    integer, intent(in) :: body !! index of the body

    spin_of = 0
    if (bodies%n_velocity == 3) spin_of = bodies%velocity(3, body)
  end function spin_of

  !> Orientation of a body [rad]; zero where nothing turns.
  pure real(wp) function angle_of(bodies, body)
    type(bodies_t), intent(in) :: bodies !! the bodies
    integer, intent(in) :: body !! index of the body

    angle_of = 0
    if (allocated(bodies%angle)) angle_of = bodies%angle(body)
  end function angle_of
end module sg_bodies
