!> The rigid bodies of a scene as a structure of arrays, one unit an array.
!!
!! Components of a planar body: x, y and, where the scene needs it, rotation. A scene in which nothing turns
!! (frictionless disks) drops the third component, and the angles where no body is turned: `n_velocity` is then 2. Components
!! of a body in space: x, y, z in the world and spin about its principal axes, or x, y, z alone; its orientation is a unit
!! quaternion.
module sg_bodies
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: bodies_t, clear_body, shorten, drop_rotation, drop_rotation_as, are_turned, spin_of, angle_of, no_bodies_like

  !> Rigid bodies, in the plane or in space
  type :: bodies_t
    !> Number of bodies
    integer :: n = 0
    !> Number of bodies that this rank counts as its own: the first ones; all of them where the scene is not decomposed
    integer :: n_home = 0
    !> Dimension of space
    integer :: dimension = 2
    !> Velocity components of a body: 3 (x, y, rotation) or 6 (x, y, z, spin); 2 or 3 where nothing turns
    integer :: n_velocity = 3
    !> Is there an orientation of each body? Where nothing turns, only if a body is turned at the start
    logical :: has_orientation = .true.
    !> Centre of mass [m], shape (dimension, n), at the beginning of the step; in a periodic scene within the period
    real(wp), allocatable :: position(:, :)
    !> Orientation in the plane [rad], shape (n); unallocated in space and without `has_orientation`
    real(wp), allocatable :: angle(:)
    !> Orientation in space, shape (4, n): unit quaternion (w, x, y, z) that turns principal axes into the world;
    !! unallocated in the plane and without `has_orientation`
    real(wp), allocatable :: orientation(:, :)
    !> Velocity [m/s, rad/s], shape (n_velocity, n)
    real(wp), allocatable :: velocity(:, :)
    !> Configuration in which contacts are sought: position [m] and orientation, angle [rad] or quaternion, if there is one;
    !! shape (3 or 2, n), in space (7 or 3, n)
    real(wp), allocatable :: middle(:, :)
    !> Mass [kg], in the plane per metre of depth, shape (n)
    real(wp), allocatable :: mass(:)
    !> Moment of inertia about the centre of mass [kg m2], shape (n); in the plane
    real(wp), allocatable :: inertia(:)
    !> Principal moments of inertia about the centre of mass [kg m2], shape (3, n); in space
    real(wp), allocatable :: principal(:, :)
    !> Inverse inertia of each component [1/kg, 1/(kg m2)], zero where driven; shape (n_velocity, n)
    real(wp), allocatable :: inverse_mass(:, :)
    !> External forces of the step [N, N m], shape (n_velocity, n)
    real(wp), allocatable :: force(:, :)
    !> Velocity at the end of the step without contacts, shape (n_velocity, n)
    real(wp), allocatable :: free_velocity(:, :)
    !> Area covered by the body's shapes [m2], in space their volume [m3], shape (n)
    real(wp), allocatable :: area(:)
    !> Periods crossed in x since the start, shape (n): position + crossings*period is the unwrapped one; in y, in space
    integer(i4), allocatable :: crossings(:), crossings_y(:)
    !> Is this body a grain (free in all components, or held in a plane), or a wall (driven or pressed)? shape (n)
    logical, allocatable :: is_grain(:)
    !> Bulk material, index into the scene's materials, shape (n)
    integer(i4), allocatable :: material(:)
    !> In a decomposed scene: number of the body in the whole scene, and the rank that is its home; shape (n). The bodies of
    !! this rank come first, then copies of others'; both by ascending number. Unallocated elsewhere
    integer(i4), allocatable :: id(:), home(:)
  contains
    procedure :: allocate => bodies_allocate
  end type bodies_t

contains

  !> Make room for `n` bodies at rest at the origin.
  subroutine bodies_allocate(self, n, dimension)
    class(bodies_t), intent(inout) :: self
    integer, intent(in) :: n !! number of bodies
    integer, intent(in), optional :: dimension !! of space, 2 unless given
    integer :: m

    self%n = n
    self%n_home = n
    self%dimension = 2
    if (present(dimension)) self%dimension = dimension
    m = merge(3, 6, self%dimension == 2)
    self%n_velocity = m
    allocate (self%position(self%dimension, n), self%velocity(m, n), self%middle(merge(3, 7, m == 3), n), &
              self%inverse_mass(m, n), self%force(m, n), self%free_velocity(m, n), source=0.0_wp)
    allocate (self%mass(n), self%area(n), source=0.0_wp)
    allocate (self%crossings(n), self%material(n), source=0_i4)
    allocate (self%is_grain(n), source=.true.)
    if (self%dimension == 2) then
      allocate (self%angle(n), self%inertia(n), source=0.0_wp)
    else
      allocate (self%principal(3, n), self%orientation(4, n), source=0.0_wp)
      allocate (self%crossings_y(n), source=0_i4)
      self%orientation(1, :) = 1
    end if
  end subroutine bodies_allocate

  !> Put a body back at rest at the origin, as `allocate` left it.
  pure subroutine clear_body(bodies, b)
    type(bodies_t), intent(inout) :: bodies !! bodies of a scene being made
    integer, intent(in) :: b !! the body

    bodies%position(:, b) = 0
    bodies%velocity(:, b) = 0
    bodies%inverse_mass(:, b) = 0
    bodies%mass(b) = 0
    bodies%area(b) = 0
    bodies%material(b) = 0
    bodies%is_grain(b) = .true.
    if (bodies%dimension == 2) then
      bodies%angle(b) = 0
      bodies%inertia(b) = 0
    else
      bodies%principal(:, b) = 0
      bodies%orientation(:, b) = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    end if
  end subroutine clear_body

  !> Keep the first bodies of a scene being made, in which everything still may turn.
  subroutine shorten(bodies, n)
    type(bodies_t), intent(inout) :: bodies !! all bodies
    integer, intent(in) :: n !! bodies to keep
    type(bodies_t) :: kept

    call kept%allocate(n, bodies%dimension)
    kept%position(:, :) = bodies%position(:, :n)
    kept%velocity(:, :) = bodies%velocity(:, :n)
    kept%inverse_mass(:, :) = bodies%inverse_mass(:, :n)
    kept%mass(:) = bodies%mass(:n)
    kept%area(:) = bodies%area(:n)
    kept%crossings(:) = bodies%crossings(:n)
    kept%material(:) = bodies%material(:n)
    kept%is_grain(:) = bodies%is_grain(:n)
    if (bodies%dimension == 2) then
      kept%angle(:) = bodies%angle(:n)
      kept%inertia(:) = bodies%inertia(:n)
    else
      kept%principal(:, :) = bodies%principal(:, :n)
      kept%orientation(:, :) = bodies%orientation(:, :n)
      kept%crossings_y(:) = bodies%crossings_y(:n)
    end if
    if (allocated(bodies%id)) kept%id = bodies%id(:n)
    if (allocated(bodies%home)) kept%home = bodies%home(:n)
    bodies = kept
  end subroutine shorten

  !> Leave out all that belongs to rotation, for scenes in which nothing turns: spins always, orientations if none is wanted.
  subroutine drop_rotation(bodies, keep_orientation)
    type(bodies_t), intent(inout) :: bodies !! bodies that never turn
    logical, intent(in) :: keep_orientation !! is a body turned, so that shapes and pictures need its orientation?

    if (bodies%n_velocity == bodies%dimension) return
    bodies%n_velocity = bodies%dimension
    call cut(bodies%dimension, bodies%velocity)
    call cut(bodies%dimension, bodies%inverse_mass)
    call cut(bodies%dimension, bodies%force)
    call cut(bodies%dimension, bodies%free_velocity)
    bodies%has_orientation = keep_orientation
    if (keep_orientation) return
    if (allocated(bodies%angle)) deallocate (bodies%angle)
    if (allocated(bodies%orientation)) deallocate (bodies%orientation)
    call cut(bodies%dimension, bodies%middle)
  end subroutine drop_rotation

  !> Leave out of bodies what a template has left out.
  subroutine drop_rotation_as(template, bodies)
    type(bodies_t), intent(in) :: template !! other bodies of the same scene
    type(bodies_t), intent(inout) :: bodies !! bodies with all components

    if (template%n_velocity == template%dimension) call drop_rotation(bodies, template%has_orientation)
  end subroutine drop_rotation_as

  !> No bodies, of the dimension and the components of others.
  pure function no_bodies_like(template) result(bodies)
    type(bodies_t), intent(in) :: template !! bodies of the same scene
    type(bodies_t) :: bodies

    bodies%dimension = template%dimension
    bodies%n_velocity = template%n_velocity
    bodies%has_orientation = template%has_orientation
  end function no_bodies_like

  !> Is any body turned away from the axes of the world?
  pure logical function are_turned(bodies)
    type(bodies_t), intent(in) :: bodies !! bodies with orientations

    if (bodies%dimension == 2) then
      are_turned = any(abs(bodies%angle) > 0)
    else
      are_turned = any(abs(bodies%orientation(2:4, :)) > 0)
    end if
  end function are_turned

  !> Keep the first components.
  subroutine cut(n, records)
    integer, intent(in) :: n
    real(wp), allocatable, intent(inout) :: records(:, :)
    real(wp), allocatable :: kept(:, :)

    allocate (kept(n, size(records, 2)))
    kept = records(:n, :)
    call move_alloc(kept, records)
  end subroutine cut

  !> Angular velocity of a planar body [rad/s]; zero where nothing turns.
  pure real(wp) function spin_of(bodies, body)
    type(bodies_t), intent(in) :: bodies !! the bodies
    integer, intent(in) :: body !! index of the body

    spin_of = 0
    if (bodies%n_velocity == 3) spin_of = bodies%velocity(3, body)
  end function spin_of

  !> Orientation of a planar body [rad]; zero where none is kept.
  pure real(wp) function angle_of(bodies, body)
    type(bodies_t), intent(in) :: bodies !! the bodies
    integer, intent(in) :: body !! index of the body

    angle_of = 0
    if (allocated(bodies%angle)) angle_of = bodies%angle(body)
  end function angle_of
end module sg_bodies
