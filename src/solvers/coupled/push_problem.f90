!> Contact problem of a push: displacements of bodies that open gaps (doc/theory/recovery.md).
!!
!! Contact k asks 0 <= H_n^T q + g_k <= room_k of the displacements q of two bodies, by an impulse p_k along its normal: positive
!! where the gap is 0, negative where it is the room, zero between them. A room of zero makes it linear. One that sticks asks
!! H_t^T q = 0 as well, by an impulse along its tangents. Contacts of gaps within reach, those that carry, and links are listed.
module sg_push_problem
  use sg_cell_motion, only: cell_bias
  use sg_contacts, only: contacts_t
  use sg_gap_laws, only: has_driven_spin
  use sg_kinds, only: wp, i4
  use sg_mapping, only: arms_of, relative_velocity
  use sg_mapping_space, only: space_arms, space_relative_velocity
  use sg_neighbour_list, only: neighbours_t
  use sg_plan, only: plan_t
  use sg_problem, only: problem_t
  use sg_problem_bodies, only: load_bodies
  use sg_push_records, only: plane_body, plane_gap, plane_inverse_wnn, plane_inverse_wtt, plane_moment_na, plane_moment_nc, &
                             plane_moment_ta, plane_moment_tc, plane_record, space_arm_a, space_arm_c, space_body, space_gap, &
                             space_inverse_wnn, space_inverse_wtt, space_record, weigh_in_plane, weigh_in_space
  use sg_records, only: arm_frictionless, ball_frictionless, body_length, first_inverse, is_in_space, round_frictionless, &
                        solid_frictionless
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
    !> Contacts, and components of a displacement
    integer :: n = 0, width = 0
    !> Slots of the two bodies of each contact, and bodies by slot with displacements [m] in the place of velocities, as those that
    !! turn have them. It has no records of its own
    type(problem_t) :: bodies
    !> Record of each contact, shape (length, contacts), and its impulse along the normal times the step [kg m]
    real(wp), allocatable :: record(:, :), impulse(:)
    !> Step of the velocities [s], and are there driven spins or a cell, which the records of bodies do not carry?
    real(wp), private :: h = 0
    logical, private :: has_more = .false.
  contains
    procedure :: begin => push_begin
    procedure :: place => push_place
    procedure :: add => push_add
    procedure :: finish => push_finish
    procedure :: divide => push_divide
    procedure :: measure => push_measure
    procedure :: list_tables => push_list_tables
  end type push_problem_t

contains

  !> Begin a problem without contacts, of bodies with the velocities of the step that ends.
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
      if (.not. allocated(bodies%body)) allocate (bodies%body(merge(plane_body, space_body, scene%dimension == 2), bodies%n_bodies))
      if (self%width == scene%dimension) then
        call load_without_turn(scene, plan, pairs, bodies)
      else
        call load_bodies(scene%bodies, bodies%kind, pairs%body_of, plan%radius, bodies%body)
      end if
    end associate
    ! A rank without contacts has tables too.
    if (.not. allocated(self%record)) call grow(self)
  end subroutine push_begin

  !> Load bodies that do not turn into records of those that do.
  subroutine load_without_turn(scene, plan, pairs, bodies)
    type(scene_t), intent(in) :: scene
    type(plan_t), intent(in) :: plan
    type(neighbours_t), intent(in) :: pairs
    type(problem_t), intent(inout) :: bodies
    real(wp), allocatable :: body(:, :)
    integer :: turning

    allocate (body(body_length(bodies%kind), bodies%n_bodies))
    call load_bodies(scene%bodies, bodies%kind, pairs%body_of, plan%radius, body)
    turning = merge(arm_frictionless, solid_frictionless, scene%dimension == 2)
    associate (d => scene%dimension, inverse => first_inverse(turning))
      bodies%body = 0
      bodies%body(:d, :) = body(:d, :)
      bodies%body(inverse:inverse + d - 1, :) = body(d + 1:2*d, :)
    end associate
  end subroutine load_without_turn

  !> Make room for more contacts.
  pure subroutine grow(self)
    class(push_problem_t), intent(inout) :: self
    integer(i4), allocatable :: pair(:, :)
    real(wp), allocatable :: record(:, :), impulse(:)
    integer :: n

    n = 16 + self%n + self%n/2
    allocate (pair(2, n), record(merge(space_record, plane_record, is_in_space(self%bodies%kind)), n), impulse(n))
    if (self%n > 0) then
      pair(:, :self%n) = self%bodies%pair
      record(:, :self%n) = self%record
      impulse(:self%n) = self%impulse
    end if
    call move_alloc(pair, self%bodies%pair)
    call move_alloc(record, self%record)
    call move_alloc(impulse, self%impulse)
  end subroutine grow

  !> Kind of problem of a push: what turns in that of a run turns in it, by the records of any shape.
  pure integer function kind_of_push(kind)
    integer, intent(in) :: kind !! kind of the problems of a run

    kind_of_push = kind
    if (any(kind == [round_frictionless, ball_frictionless])) return
    kind_of_push = merge(solid_frictionless, arm_frictionless, is_in_space(kind))
  end function kind_of_push

  !> Place the next contact, and find by how much it opens in the rest of the step.
  pure subroutine push_place(self, scene, pairs, contacts, k, opening)
    class(push_problem_t), intent(inout) :: self !! begun
    type(scene_t), intent(in) :: scene !! scene in its `middle` configuration
    type(neighbours_t), intent(in) :: pairs !! slots of bodies
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp), intent(out) :: opening !! [m]
    real(wp) :: arms(2, 2), space(3, 2)

    if (size(self%impulse) == self%n) call grow(self)
    self%bodies%pair(1, self%n + 1) = pairs%slot_of(contacts%body(1, k))
    self%bodies%pair(2, self%n + 1) = pairs%slot_of(contacts%body(2, k))
    associate (record => self%record(:, self%n + 1), n => contacts%normal(:, k))
      record(:scene%dimension) = n
      if (scene%dimension == 2) then
        arms = arms_of(contacts, k, scene%bodies%middle, scene%period)
        record(plane_moment_nc:plane_moment_na) = arms(1, :)*n(2) - arms(2, :)*n(1)
        record(plane_moment_tc:plane_moment_ta) = -arms(1, :)*n(1) - arms(2, :)*n(2)
      else
        space = space_arms(scene, contacts, k)
        record(space_arm_c:space_arm_c + 2) = space(:, 1)
        record(space_arm_a:space_arm_a + 2) = space(:, 2)
      end if
    end associate
    if (self%has_more) then
      opening = self%h*opening_of(scene, contacts, k)
    else
      opening = self%h*displacement_of(self, self%n + 1)
    end if
  end subroutine push_place

  !> Displacement of a contact along its normal by those of its bodies [m]; or velocity, by velocities.
  pure real(wp) function displacement_of(self, k) result(u)
    type(push_problem_t), intent(in) :: self
    integer, intent(in) :: k

    associate (record => self%record(:, k), body => self%bodies%body, c => self%bodies%pair(1, k), a => self%bodies%pair(2, k))
      if (is_in_space(self%bodies%kind)) then
        u = dot_product(record(:3), body(:3, c) + cross(body(4:6, c), record(space_arm_c:space_arm_c + 2)) &
                                    - body(:3, a) - cross(body(4:6, a), record(space_arm_a:space_arm_a + 2)))
      else
        u = dot_product(record(:2), body(:2, c) - body(:2, a)) + record(plane_moment_nc)*body(3, c) - &
            record(plane_moment_na)*body(3, a)
      end if
    end associate
  end function displacement_of

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

  !> Add the contact that is placed, unless nothing can move its bodies.
  pure subroutine push_add(self, gap, room, sticks)
    class(push_problem_t), intent(inout) :: self !! a contact is placed
    real(wp), intent(in) :: gap !! opening without displacements [m]
    real(wp), intent(in) :: room !! largest opening with displacements [m]
    logical, intent(in) :: sticks !! may it not slide?

    self%n = self%n + 1
    self%impulse(self%n) = 0
    associate (n => self%n)
      if (is_in_space(self%bodies%kind)) then
        self%record(space_gap:space_gap + 1, n) = [gap, room]
        call weigh_in_space(self%bodies%body, self%bodies%pair(:, n), sticks, self%record(:, n))
        if (.not. self%record(space_inverse_wnn, n) > 0) self%n = n - 1
      else
        self%record(plane_gap:plane_gap + 1, n) = [gap, room]
        call weigh_in_plane(self%bodies%body, self%bodies%pair(:, n), sticks, self%record(:, n))
        if (.not. self%record(plane_inverse_wnn, n) > 0) self%n = n - 1
      end if
    end associate
  end subroutine push_add

  !> All contacts are listed: from here on bodies have displacements, which are zero.
  pure subroutine push_finish(self)
    class(push_problem_t), intent(inout) :: self
    integer :: s

    self%bodies%n_contacts = self%n
    do s = 1, self%bodies%n_bodies
      self%bodies%body(:merge(6, 3, is_in_space(self%bodies%kind)), s) = 0
    end do
  end subroutine push_finish

  !> Let bodies have parts of their masses alone: copies that other ranks hold have the rest.
  pure subroutine push_divide(self, copies)
    class(push_problem_t), intent(inout) :: self
    integer, intent(in) :: copies(:) !! of the body of each slot
    integer :: k, s, first

    first = merge(7, 4, is_in_space(self%bodies%kind))
    do s = 1, self%bodies%n_bodies
      self%bodies%body(first:, s) = self%bodies%body(first:, s)*real(copies(s), wp)
    end do
    associate (pair => self%bodies%pair)
      do k = 1, self%n
        if (all(copies(pair(:, k)) == 1)) cycle
        if (first == 7) then
          call weigh_in_space(self%bodies%body, pair(:, k), self%record(space_inverse_wtt, k) > 0, self%record(:, k))
        else
          call weigh_in_plane(self%bodies%body, pair(:, k), self%record(plane_inverse_wtt, k) > 0, self%record(:, k))
        end if
      end do
    end associate
  end subroutine push_divide

  !> Squares of what contacts lack or open too far [m2], without displacements and with them.
  pure subroutine push_measure(self, squares)
    class(push_problem_t), intent(in) :: self !! solved
    real(wp), intent(out) :: squares(2) !! sums over the contacts of this rank
    real(wp) :: gap(2)
    integer :: k, place

    squares = 0
    place = merge(space_gap, plane_gap, is_in_space(self%bodies%kind))
    do k = 1, self%n
      gap = self%record(place, k)
      gap(2) = gap(2) + displacement_of(self, k)
      squares = squares + max(-gap, gap - self%record(place + 1, k), 0.0_wp)**2
    end do
  end subroutine push_measure

  !> List the tables of a push.
  subroutine push_list_tables(self, tables)
    class(push_problem_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('push', per_contact)
    call tables%note('record', self%record)
    call tables%note('pair', self%bodies%pair)
    call tables%note('impulse', self%impulse)
    call tables%begin('push', per_body)
    call tables%note('body', self%bodies%body)
  end subroutine push_list_tables
end module sg_push_problem
