!> Contact problem of a push: displacements of bodies that open gaps (doc/theory/recovery.md).
!!
!! Row k asks 0 <= J_k q + g_k <= room_k of the displacements q of two bodies, by a p_k that adds M^-1 J_k^T p_k to them: positive
!! where the gap is 0, negative where it is the room, zero between them. A room of zero makes the row linear. A row holds J and
!! M^-1 J^T of both bodies, so that one loop serves disks, polygons, balls and solids. Only rows of gaps within reach, of contacts
!! that carry, and of links are listed.
module sg_push_problem
  use sg_cell_motion, only: cell_bias
  use sg_contacts, only: contacts_t
  use sg_gap_laws, only: has_driven_spin
  use sg_kinds, only: wp, i4
  use sg_mapping, only: arms_of, relative_velocity
  use sg_mapping_space, only: space_arms, space_relative_velocity
  use sg_neighbours, only: neighbours_t
  use sg_plan, only: plan_t
  use sg_problem, only: problem_t
  use sg_problem_bodies, only: load_bodies
  use sg_records, only: arm_frictional, arm_frictionless, ball_frictional, ball_frictionless, body_length, first_inverse, &
                        plain_kind, round_frictional, round_frictionless, solid_frictionless, solid_inverse_mx, &
                        solid_inverse_xx, solid_inverse_xy, solid_inverse_xz, solid_inverse_yy, solid_inverse_yz, solid_inverse_zz
  use sg_scene, only: scene_t
  use sg_tables, only: per_body, per_contact, tables_t
  use sg_vectors, only: cross
  implicit none
  private
  public :: push_problem_t

  !> Room of a gap that may open as far as it does [m]; a mass times it does not overflow
  real(wp), parameter, public :: no_limit = sqrt(huge(1.0_wp))

  !> Problem of one push; its room is kept for the next one
  type :: push_problem_t
    !> Rows, and components of a displacement
    integer :: n = 0, width = 0
    !> Slots of the two bodies of each row, and bodies by slot with displacements [m] in the place of velocities. It has no records
    type(problem_t) :: bodies
    !> J of candidate and antagonist, M^-1 J^T of both, gap [m] and 1/(J M^-1 J^T) [kg], shape (4 width + 2, rows)
    real(wp), allocatable :: row(:, :)
    !> Impulses times the step [kg m], and the largest gap of each row [m]
    real(wp), allocatable :: impulse(:), room(:)
    !> Step of the velocities [s], and are there driven spins or a cell, which the records of bodies do not carry?
    real(wp), private :: h = 0
    logical, private :: has_more = .false.
  contains
    procedure :: begin => push_begin
    procedure :: find => push_find
    procedure :: add => push_add
    procedure :: finish => push_finish
    procedure :: divide => push_divide
    procedure :: measure => push_measure
    procedure :: list_tables => push_list_tables
  end type push_problem_t

contains

  !> Begin a problem without rows, of bodies with the velocities of the step that ends.
  subroutine push_begin(self, scene, plan, pairs, h)
    class(push_problem_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! after a step, its free velocities those of the end
    type(plan_t), intent(in) :: plan !! kind of its problems
    type(neighbours_t), intent(in) :: pairs !! bodies of slots
    real(wp), intent(in) :: h !! length of the step [s]

    associate (bodies => self%bodies)
      bodies%kind = kind_of_push(plan%kind)
      bodies%n_bodies = scene%bodies%n
      self%n = 0
      self%h = h
      self%width = first_inverse(bodies%kind) - 1
      self%has_more = scene%cell%is_on
      if (.not. self%has_more .and. self%width == scene%dimension) &
        self%has_more = has_driven_spin(scene%bodies, scene%bodies%free_velocity)
      if (allocated(bodies%body)) then
        if (size(bodies%body, 2) /= bodies%n_bodies) deallocate (bodies%body)
      end if
      if (.not. allocated(bodies%body)) allocate (bodies%body(body_length(bodies%kind), bodies%n_bodies))
      call load_bodies(scene%bodies, bodies%kind, pairs%body_of, plan%radius, bodies%body)
    end associate
    ! A rank without rows has tables too.
    if (.not. allocated(self%row)) call grow(self)
  end subroutine push_begin

  !> Make room for more rows.
  pure subroutine grow(self)
    class(push_problem_t), intent(inout) :: self
    integer(i4), allocatable :: pair(:, :)
    real(wp), allocatable :: row(:, :), impulse(:), rooms(:)
    integer :: n

    n = 16 + self%n + self%n/2
    allocate (pair(2, n), row(4*self%width + 2, n), impulse(n), rooms(n))
    if (self%n > 0) then
      pair(:, :self%n) = self%bodies%pair
      row(:, :self%n) = self%row
      impulse(:self%n) = self%impulse
      rooms(:self%n) = self%room
    end if
    call move_alloc(pair, self%bodies%pair)
    call move_alloc(row, self%row)
    call move_alloc(impulse, self%impulse)
    call move_alloc(rooms, self%room)
  end subroutine grow

  !> Kind of problem of a push: without friction.
  pure integer function kind_of_push(kind)
    integer, intent(in) :: kind !! kind of the problems of a run

    select case (plain_kind(kind))
    case (round_frictionless, round_frictional)
      kind_of_push = round_frictionless
    case (arm_frictionless, arm_frictional)
      kind_of_push = arm_frictionless
    case (ball_frictionless, ball_frictional)
      kind_of_push = ball_frictionless
    case default
      kind_of_push = solid_frictionless
    end select
  end function kind_of_push

  !> Find the opening that displacements of two bodies make at a contact, and by how much it opens in the rest of the step.
  pure subroutine push_find(self, scene, pairs, contacts, k, jacobian, opening)
    class(push_problem_t), intent(in) :: self !! begun
    type(scene_t), intent(in) :: scene !! scene in its `middle` configuration
    type(neighbours_t), intent(in) :: pairs !! slots of bodies
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp), intent(out) :: jacobian(6, 2) !! of displacements of candidate and antagonist
    real(wp), intent(out) :: opening !! [m]
    integer :: i, c, a

    call find_jacobian(self%width, scene, contacts, k, jacobian)
    if (self%has_more) then
      opening = self%h*opening_of(scene, contacts, k)
      return
    end if
    c = pairs%slot_of(contacts%body(1, k))
    a = pairs%slot_of(contacts%body(2, k))
    opening = 0
    do i = 1, self%width
      opening = opening + jacobian(i, 1)*self%bodies%body(i, c) + jacobian(i, 2)*self%bodies%body(i, a)
    end do
    opening = self%h*opening
  end subroutine push_find

  !> Opening by displacements of the bodies of a contact.
  pure subroutine find_jacobian(width, scene, contacts, k, jacobian)
    integer, intent(in) :: width
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp), intent(out) :: jacobian(6, 2)
    real(wp) :: arms(2, 2), solid_arms(3, 2)

    associate (n => contacts%normal(:, k), d => scene%dimension)
      jacobian(:d, 1) = n
      jacobian(:d, 2) = -n
      if (width == d) return
      if (d == 2) then
        arms = arms_of(contacts, k, scene%bodies%middle, scene%period)
        jacobian(3, 1) = arms(1, 1)*n(2) - arms(2, 1)*n(1)
        jacobian(3, 2) = arms(2, 2)*n(1) - arms(1, 2)*n(2)
      else
        solid_arms = space_arms(scene, contacts, k)
        jacobian(4:, 1) = cross(solid_arms(:, 1), n)
        jacobian(4:, 2) = cross(n, solid_arms(:, 2))
      end if
    end associate
  end subroutine find_jacobian

  !> Velocity at which a contact opens at the end of the step, with all that moves its bodies [m/s].
  pure real(wp) function opening_of(scene, contacts, k) result(u)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp) :: in_plane(2), of_cell(3)

    if (scene%dimension == 3) then
      u = dot_product(contacts%normal(:, k), space_relative_velocity(scene, contacts, k, scene%bodies%velocity))
    else
      in_plane = relative_velocity(contacts, k, scene%bodies%middle, scene%period, scene%bodies%velocity)
      u = in_plane(1)
    end if
    if (.not. scene%cell%is_on) return
    of_cell = cell_bias(scene, contacts, k)
    u = u + of_cell(1)
  end function opening_of

  !> Add a row, unless nothing can move its bodies.
  pure subroutine push_add(self, pair, jacobian, gap, room)
    class(push_problem_t), intent(inout) :: self !! begun
    integer(i4), intent(in) :: pair(2) !! slots of candidate and antagonist
    real(wp), intent(in) :: jacobian(6, 2) !! opening by displacements of the two
    real(wp), intent(in) :: gap !! opening without displacements [m]
    real(wp), intent(in) :: room !! largest opening with displacements [m]
    real(wp) :: moved(6), w
    integer :: i, side

    if (size(self%room) == self%n) call grow(self)
    w = 0
    associate (n => self%width, row => self%row(:, self%n + 1))
      do side = 1, 2
        call find_moved(n, jacobian(:, side), self%bodies%body(:, pair(side)), moved)
        do i = 1, n
          row((side - 1)*n + i) = jacobian(i, side)
          row((side + 1)*n + i) = moved(i)
          w = w + jacobian(i, side)*moved(i)
        end do
      end do
      if (.not. w > 0) return
      row(4*n + 1) = gap
      row(4*n + 2) = 1/w
    end associate
    self%n = self%n + 1
    self%bodies%pair(:, self%n) = pair
    self%impulse(self%n) = 0
    self%room(self%n) = room
  end subroutine push_add

  !> Displacement of a body by an impulse along a row, M^-1 J^T [1/kg].
  pure subroutine find_moved(width, jacobian, body, moved)
    integer, intent(in) :: width
    real(wp), intent(in) :: jacobian(6)
    real(wp), intent(in), contiguous :: body(:) !! its record
    real(wp), intent(out) :: moved(6)

    if (width < 6) then
      moved(:width) = body(width + 1:2*width)*jacobian(:width)
      return
    end if
    moved(:3) = body(solid_inverse_mx:solid_inverse_mx + 2)*jacobian(:3)
    associate (j => jacobian(4:))
      moved(4) = body(solid_inverse_xx)*j(1) + body(solid_inverse_xy)*j(2) + body(solid_inverse_xz)*j(3)
      moved(5) = body(solid_inverse_xy)*j(1) + body(solid_inverse_yy)*j(2) + body(solid_inverse_yz)*j(3)
      moved(6) = body(solid_inverse_xz)*j(1) + body(solid_inverse_yz)*j(2) + body(solid_inverse_zz)*j(3)
    end associate
  end subroutine find_moved

  !> All rows are listed: from here on bodies have displacements, which are zero.
  pure subroutine push_finish(self)
    class(push_problem_t), intent(inout) :: self
    integer :: s

    self%bodies%n_contacts = self%n
    do s = 1, self%bodies%n_bodies
      self%bodies%body(:self%width, s) = 0
    end do
  end subroutine push_finish

  !> Let bodies have parts of their masses alone: copies that other ranks hold have the rest.
  pure subroutine push_divide(self, copies)
    class(push_problem_t), intent(inout) :: self
    integer, intent(in) :: copies(:) !! of the body of each slot
    integer :: k, side, first

    do k = 1, self%n
      associate (n => self%width, row => self%row(:, k))
        do side = 1, 2
          first = (1 + side)*n + 1
          row(first:first + n - 1) = row(first:first + n - 1)*real(copies(self%bodies%pair(side, k)), wp)
        end do
        row(4*n + 2) = 1/dot_product(row(:2*n), row(2*n + 1:4*n))
      end associate
    end do
  end subroutine push_divide

  !> Squares of what rows lack or open too far [m2], without displacements and with them.
  pure subroutine push_measure(self, squares)
    class(push_problem_t), intent(in) :: self !! solved
    real(wp), intent(out) :: squares(2) !! sums over the rows of this rank
    real(wp) :: gap
    integer :: k

    squares = 0
    do k = 1, self%n
      associate (n => self%width, row => self%row(:, k), c => self%bodies%pair(1, k), a => self%bodies%pair(2, k))
        gap = row(4*n + 1) + dot_product(row(:n), self%bodies%body(:n, c)) + dot_product(row(n + 1:2*n), self%bodies%body(:n, a))
        squares = squares + max(-[row(4*n + 1), gap], [row(4*n + 1), gap] - self%room(k), 0.0_wp)**2
      end associate
    end do
  end subroutine push_measure

  !> List the tables of a push.
  subroutine push_list_tables(self, tables)
    class(push_problem_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('push', per_contact)
    call tables%note('row', self%row)
    call tables%note('pair', self%bodies%pair)
    call tables%note('impulse', self%impulse)
    call tables%note('room', self%room)
    call tables%begin('push', per_body)
    call tables%note('body', self%bodies%body)
  end subroutine push_list_tables
end module sg_push_problem
