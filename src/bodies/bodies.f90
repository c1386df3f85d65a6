!> The rigid bodies of a scene as a structure of arrays, one unit an array.
!!
!! Components of a planar body: x, y and, where the scene needs it, rotation. A scene in which nothing turns
!! (frictionless disks) drops the third component, and the angles where no body is turned: `n_velocity` is then 2. Components
!! of a body in space: x, y, z in the world and spin about its principal axes, or x, y, z alone; its orientation is a unit
!! quaternion.
module sg_bodies
  use sg_field_visitor, only: field_t, field_visitor_t, sync_always, sync_never, sync_on_copy, sync_on_owner
  use sg_fields, only: fields_t
  use sg_kinds, only: wp, i4
  implicit none
  private
  public :: bodies_t, drop_rotation, are_turned, spin_of, angle_of, make_bodies_like, no_bodies_like, is_absent
  public :: body_present, body_waiting, body_removed

  !> Presence of a body: it is there, its time to enter has not come, it has left for good; negative where it is no grain
  integer(i4), parameter :: body_present = 0, body_waiting = 1, body_removed = 2

  !> Rigid bodies, in the plane or in space
  type, extends(fields_t) :: bodies_t
    !> Number of bodies
    integer :: n = 0
    !> Number of bodies that this rank counts as its own: the first ones; all of them where the scene is not decomposed
    integer :: n_own = 0
    !> Dimension of space
    integer :: dimension = 2
    !> Velocity components of a body: 3 (x, y, rotation) or 6 (x, y, z, spin); 2 or 3 where nothing turns
    integer :: n_velocity = 3
    !> Values of each copy that the solver's method carries from step to step (sg_solver); 0 where it carries none
    integer :: n_carried = 0
    !> Is there an orientation of each body? Where nothing turns, only if a body is turned at the start
    logical :: has_orientation = .true.
    !> May bodies enter or leave? Elsewhere all are present, and no array is about it
    logical :: has_presence = .false.
    !> Are all axes periodic, as in a periodic cell?
    logical :: has_cell = .false.
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
    !> Periods crossed in x since the start, shape (n): position + crossings*period is the unwrapped one; in y, in space; in
    !! a periodic cell along all axes
    integer(i4), allocatable :: crossings(:), crossings_y(:), crossings_z(:)
    !> Is this body a grain (free in all components, or held in a plane), or a wall (driven or pressed)? shape (n)
    logical, allocatable :: is_grain(:)
    !> Bulk material, index into the scene's materials, shape (n)
    integer(i4), allocatable :: material(:)
    !> Is a body there, one of `body_*` or that negative, shape (n); an absent one has no velocity, no inverse mass and no contact,
    !! and is no grain
    integer(i4), allocatable :: presence(:)
    !> Velocity with which a waiting body enters [m/s, rad/s], shape (n_velocity, n)
    real(wp), allocatable :: entry_velocity(:, :)
    !> Values that the solver's method carries, those of this rank's copy, shape (n_carried, n)
    real(wp), allocatable :: carried(:, :)
    !> In a decomposed scene: number of the body in the whole scene, and the rank that owns it; shape (n). The bodies of
    !! this rank come first, then copies of others'; both by ascending number. Unallocated elsewhere
    integer(i4), allocatable :: id(:), owner(:)
  contains
    procedure :: allocate => bodies_allocate
    procedure :: visit => bodies_visit
    procedure :: n_configuration => bodies_n_configuration
  end type bodies_t

contains

  !> The list of fields. A field of a body is a line here, and its declaration above.
  subroutine bodies_visit(self, visitor)
    class(bodies_t) :: self
    type(field_visitor_t), intent(inout) :: visitor !! what the visit does
    logical :: is_plane, is_space, is_numbered
    integer :: d, v

    d = self%dimension
    v = self%n_velocity
    is_plane = d == 2
    is_space = d == 3
    is_numbered = allocated(self%id)
    call visitor%visit(field_t('position', sync_on_copy, d, in_files=.true.), self%position)
    call visitor%visit(field_t('angle', sync_on_copy, is_there=is_plane .and. self%has_orientation, in_files=.true.), self%angle)
    call visitor%visit(field_t('orientation', sync_on_copy, 4, is_space .and. self%has_orientation, .true., first=1.0_wp), &
                       self%orientation)
    call visitor%visit(field_t('velocity', sync_always, v, in_files=.true.), self%velocity)
    call visitor%visit(field_t('middle', sync_never, self%n_configuration()), self%middle)
    call visitor%visit(field_t('mass', sync_on_copy), self%mass)
    call visitor%visit(field_t('inertia', sync_on_copy, is_there=is_plane), self%inertia)
    call visitor%visit(field_t('principal', sync_on_copy, 3, is_there=is_space), self%principal)
    call visitor%visit(field_t('inverse_mass', sync_on_copy, v), self%inverse_mass)
    call visitor%visit(field_t('force', sync_never, v), self%force)
    call visitor%visit(field_t('free_velocity', sync_never, v), self%free_velocity)
    call visitor%visit(field_t('area', sync_on_owner), self%area)
    call visitor%visit(field_t('crossings', sync_on_copy, in_files=.true.), self%crossings)
    call visitor%visit(field_t('crossings_y', sync_on_copy, is_there=is_space .or. self%has_cell, in_files=.true.), &
                       self%crossings_y)
    call visitor%visit(field_t('crossings_z', sync_on_copy, is_there=is_space .and. self%has_cell, in_files=.true.), &
                       self%crossings_z)
    call visitor%visit(field_t('is_grain', sync_on_copy, first=1.0_wp), self%is_grain)
    call visitor%visit(field_t('material', sync_on_copy), self%material)
    call visitor%visit(field_t('presence', sync_on_copy, is_there=self%has_presence, in_files=.true., is_optional=.true.), &
                       self%presence)
    call visitor%visit(field_t('entry_velocity', sync_on_copy, v, self%has_presence), self%entry_velocity)
    call visitor%visit(field_t('carried', sync_on_owner, self%n_carried, self%n_carried > 0, .true., is_optional=.true.), &
                       self%carried)
    ! Messages hold these two before the fields: a body may be numbered, or change its owner, when it is sent.
    call visitor%visit(field_t('id', sync_never, is_there=is_numbered), self%id)
    call visitor%visit(field_t('owner', sync_never, is_there=is_numbered), self%owner)
  end subroutine bodies_visit

  !> Values of the configuration of a body: position and, where there is one, orientation.
  pure integer function bodies_n_configuration(self) result(n)
    class(bodies_t), intent(in) :: self

    n = self%dimension
    if (self%has_orientation) n = merge(3, 7, self%dimension == 2)
  end function bodies_n_configuration

  !> Make room for `n` bodies at rest at the origin.
  subroutine bodies_allocate(self, n, dimension)
    class(bodies_t), intent(inout) :: self
    integer, intent(in) :: n !! number of bodies
    integer, intent(in), optional :: dimension !! of space, 2 unless given

    self%n = n
    self%n_own = n
    self%dimension = 2
    if (present(dimension)) self%dimension = dimension
    self%n_velocity = merge(3, 6, self%dimension == 2)
    call self%resize(n)
  end subroutine bodies_allocate

  !> Leave out all that belongs to rotation, for scenes in which nothing turns: spins always, orientations if none is wanted.
  subroutine drop_rotation(bodies, keep_orientation)
    type(bodies_t), intent(inout) :: bodies !! bodies that never turn
    logical, intent(in) :: keep_orientation !! is a body turned, so that shapes and pictures need its orientation?

    if (bodies%n_velocity == bodies%dimension) return
    bodies%n_velocity = bodies%dimension
    bodies%has_orientation = keep_orientation
    call bodies%resize(bodies%n)
  end subroutine drop_rotation

  !> No bodies, of the dimension and the components of others.
  pure function no_bodies_like(template) result(bodies)
    type(bodies_t), intent(in) :: template !! bodies of the same scene
    type(bodies_t) :: bodies

    bodies%dimension = template%dimension
    bodies%n_velocity = template%n_velocity
    bodies%n_carried = template%n_carried
    bodies%has_orientation = template%has_orientation
    bodies%has_presence = template%has_presence
    bodies%has_cell = template%has_cell
  end function no_bodies_like

  !> Make room for `n` bodies at rest at the origin, with numbers and owners, and with the components of others.
  subroutine make_bodies_like(template, n, bodies)
    type(bodies_t), intent(in) :: template !! bodies of the same scene
    integer, intent(in) :: n !! number of bodies
    type(bodies_t), intent(out) :: bodies !! bodies made

    bodies = no_bodies_like(template)
    bodies%n = n
    bodies%n_own = n
    allocate (bodies%id(0), bodies%owner(0))
    call bodies%resize(n)
  end subroutine make_bodies_like

  !> Is a body absent: not yet there, or gone?
  pure logical function is_absent(bodies, body)
    type(bodies_t), intent(in) :: bodies !! the bodies
    integer, intent(in) :: body !! index of the body

    is_absent = .false.
    if (allocated(bodies%presence)) is_absent = bodies%presence(body) /= body_present
  end function is_absent

  !> Is any body turned away from the axes of the world?
  pure logical function are_turned(bodies)
    type(bodies_t), intent(in) :: bodies !! bodies with orientations

    if (bodies%dimension == 2) then
      are_turned = any(abs(bodies%angle) > 0)
    else
      are_turned = any(abs(bodies%orientation(2:4, :)) > 0)
    end if
  end function are_turned

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
