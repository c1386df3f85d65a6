!> Contacts of one step: geometry, law, and the impulses carried from step to step.
!!
!! A contact lies between a candidate and an antagonist contactor. Its normal points from the antagonist to the
!! candidate, its tangent in the plane is t = (n_y, -n_x); a positive normal impulse pushes the two apart. In space no
!! tangents are kept: an impulse is the vector that the candidate feels, in the world's axes. Contacts stand in spatial
!! order. A pair of polygons may have two contacts, one of polyhedra four, distinguished by their feature key.
module sg_contacts
  use sg_field_visitor, only: field_t, field_visitor_t, sync_never, sync_on_owner
  use sg_fields, only: fields_t
  use sg_internal_values, only: bond_slip
  use sg_kinds, only: wp, i1, i4, i8
  use sg_lists, only: copy_bytes, copy_integers, copy_reals, room_for
  use sg_memory, only: memory_t
  implicit none
  private
  public :: begin_like, contacts_t, copy_run, drop_contacts, grow_contacts, has_bonds, image_of, is_own_image, reserve_contacts
  public :: normal_impulse, normal_impulses, impulse_vector, moment_vector

  !> All contacts of one step
  type, extends(fields_t) :: contacts_t
    !> Room before the number of contacts, which a thread of detection writes: it shares no cache line with what others read
    integer, private :: apart(32) = 0
    !> Number of contacts
    integer :: n = 0
    !> Dimension of space
    integer :: dimension = 2
    !> Impulse components: 2 (normal, tangential), in space 3 (x, y, z), or 1 (normal) where nothing rubs
    integer :: n_components = 2
    !> Internal values that the laws in use keep of a contact (sg_internal_values); 0 where none keeps any
    integer :: n_internal = 0
    !> Components of a contact's moment, the last of its internal values [N m s]: 1 in the plane, 3 in space, 0 where no law resists
    !! rolling
    integer :: n_moments = 0
    !> Values of a contact that the solver's method carries from step to step (sg_solver); 0 where it carries none
    integer :: n_carried = 0
    !> Values of a contact that detection keeps from step to step (sg_kept_contacts); 0 where it keeps none
    integer :: n_kept = 0
    !> Are all axes periodic, as in a periodic cell? In the plane the way by which a period along y moves an image [m] then
    logical :: has_cell = .false.
    real(wp) :: upwards(2) = 0
    !> Contactors, candidate and antagonist, shape (2, n)
    integer(i4), allocatable :: contactor(:, :)
    !> Bodies, candidate and antagonist, shape (2, n)
    integer(i4), allocatable :: body(:, :)
    !> Feature key of the point within its pair, shape (n)
    integer(i4), allocatable :: feature(:)
    !> Law, index into the scene's laws, shape (n)
    integer(i4), allocatable :: law(:)
    !> Normal from antagonist to candidate, shape (dimension, n)
    real(wp), allocatable :: normal(:, :)
    !> Point of contact [m], in the candidate's periodic image, shape (dimension, n)
    real(wp), allocatable :: point(:, :)
    !> Gap [m], negative where shapes overlap, shape (n)
    real(wp), allocatable :: gap(:)
    !> Periods by which the antagonist's image is moved in x, and in space in y, shape (n); in a periodic cell along all axes
    integer(i1), allocatable :: image(:), image_y(:), image_z(:)
    !> Impulse over the step [N s], shape (n_components, n): normal and tangential; in space x, y, z; or normal alone
    real(wp), allocatable :: impulse(:, :)
    !> What the contact did in the last step, one of `status_*`, shape (n)
    integer(i1), allocatable :: status(:)
    !> What the law of the contact keeps from step to step, shape (n_internal, n)
    real(wp), allocatable :: internal(:, :)
    !> Values that the solver's method carries, shape (n_carried, n)
    real(wp), allocatable :: carried(:, :)
    !> Does detection keep something of the contact and its pair (1), or nothing (0)? What it keeps, which counts only then, shape
    !! (n_kept, n)
    integer(i1), allocatable :: is_kept(:)
    real(wp), allocatable :: kept(:, :)
    !> Memory that detection may grow in, and did it end early because there was none? Contacts found before
    type(memory_t) :: memory
    logical :: is_cut = .false.
    integer :: n_cut = 0
  contains
    procedure :: visit => contacts_visit
  end type contacts_t

contains

  !> The list of fields. A field of a contact is a line here, and its declaration above.
  subroutine contacts_visit(self, visitor)
    class(contacts_t) :: self
    type(field_visitor_t), intent(inout) :: visitor !! what the visit does
    integer :: d

    d = self%dimension
    call visitor%visit(field_t('contactor', sync_on_owner, 2, in_files=.true.), self%contactor)
    call visitor%visit(field_t('body', sync_never, 2), self%body)
    call visitor%visit(field_t('feature', sync_on_owner, in_files=.true.), self%feature)
    call visitor%visit(field_t('law', sync_on_owner, in_files=.true.), self%law)
    call visitor%visit(field_t('normal', sync_never, d), self%normal)
    call visitor%visit(field_t('point', sync_never, d), self%point)
    call visitor%visit(field_t('gap', sync_never), self%gap)
    call visitor%visit(field_t('image', sync_on_owner, in_files=.true.), self%image)
    call visitor%visit(field_t('image_y', sync_on_owner, is_there=d == 3 .or. self%has_cell, in_files=.true.), self%image_y)
    call visitor%visit(field_t('image_z', sync_on_owner, is_there=d == 3 .and. self%has_cell, in_files=.true.), self%image_z)
    call visitor%visit(field_t('impulse', sync_on_owner, self%n_components, in_files=.true.), self%impulse)
    call visitor%visit(field_t('status', sync_on_owner, in_files=.true.), self%status)
    call visitor%visit(field_t('internal', sync_on_owner, self%n_internal, in_files=.true.), self%internal)
    call visitor%visit(field_t('carried', sync_on_owner, self%n_carried, self%n_carried > 0, .true., is_optional=.true.), &
                       self%carried)
    call visitor%visit(field_t('is_kept', sync_on_owner, is_there=self%n_kept > 0, in_files=.true., is_optional=.true.), &
                       self%is_kept)
    call visitor%visit(field_t('kept', sync_on_owner, self%n_kept, self%n_kept > 0, .true., is_optional=.true.), self%kept)
  end subroutine contacts_visit

  !> Begin without contacts, of the same kind as others.
  subroutine begin_like(self, others)
    type(contacts_t), intent(inout) :: self !! its room is kept, if its fields are those of the others
    type(contacts_t), intent(in) :: others !! contacts whose fields these have

    if (any([self%dimension, self%n_components, self%n_internal, self%n_carried, self%n_kept] /= &
            [others%dimension, others%n_components, others%n_internal, others%n_carried, others%n_kept]) .or. &
        (self%has_cell .neqv. others%has_cell)) self = contacts_t()
    self%n = 0
    self%is_cut = .false.
    self%dimension = others%dimension
    self%n_components = others%n_components
    self%n_internal = others%n_internal
    self%n_moments = others%n_moments
    self%n_carried = others%n_carried
    self%n_kept = others%n_kept
    self%has_cell = others%has_cell
    self%upwards = others%upwards
    self%memory = others%memory
  end subroutine begin_like

  !> Copy all contacts of one list behind the first ones of another, whose fields are the same and which has room.
  subroutine copy_run(from, before, to)
    type(contacts_t), intent(in) :: from !! contacts to copy
    integer, intent(in) :: before !! contacts of the other list that stand before them
    type(contacts_t), intent(inout) :: to !! the other list; its number of contacts is for the caller to set

    if (from%n == 0) return
    associate (n => from%n, a => before + 1, d => from%dimension, m => from%n_components)
      call copy_integers(2*n, from%contactor, to%contactor(1, a))
      call copy_integers(2*n, from%body, to%body(1, a))
      call copy_integers(n, from%feature, to%feature(a))
      call copy_integers(n, from%law, to%law(a))
      call copy_reals(d*n, from%normal, to%normal(1, a))
      call copy_reals(d*n, from%point, to%point(1, a))
      call copy_reals(n, from%gap, to%gap(a))
      call copy_bytes(n, from%image, to%image(a))
      if (allocated(from%image_y)) call copy_bytes(n, from%image_y, to%image_y(a))
      if (allocated(from%image_z)) call copy_bytes(n, from%image_z, to%image_z(a))
      call copy_reals(m*n, from%impulse, to%impulse(1, a))
      call copy_bytes(n, from%status, to%status(a))
      if (from%n_internal > 0) call copy_reals(from%n_internal*n, from%internal, to%internal(1, a))
      if (from%n_carried > 0) call copy_reals(from%n_carried*n, from%carried, to%carried(1, a))
      if (from%n_kept > 0) call copy_bytes(n, from%is_kept, to%is_kept(a))
      if (from%n_kept > 0) call copy_reals(from%n_kept*n, from%kept, to%kept(1, a))
    end associate
  end subroutine copy_run

  !> Make room for `n` contacts where there is memory; else `is_cut` is set.
  subroutine grow_contacts(contacts, n)
    type(contacts_t), intent(inout) :: contacts !! contacts to make room in
    integer, intent(in) :: n !! contacts wanted
    integer(i8) :: bytes
    integer :: now

    now = 0
    if (allocated(contacts%gap)) now = size(contacts%gap)
    if (n <= now) return
    ! While a table grows there are both the old one and the new one.
    bytes = contacts%bytes_per_item()*int(room_for(n, now) - now, i8) + 8*int(contacts%dimension, i8)*int(now, i8)
    contacts%is_cut = .not. contacts%memory%fits(bytes)
    if (.not. contacts%is_cut) call reserve_contacts(contacts, n)
  end subroutine grow_contacts

  !> Drop contacts that were not found to the end, with their memory, which what follows and a checkpoint need.
  subroutine drop_contacts(contacts)
    type(contacts_t), intent(inout) :: contacts !! none are left

    contacts%n_cut = contacts%n
    contacts%n = 0
    call contacts%resize(0)
  end subroutine drop_contacts

  !> Make room for `n` contacts.
  subroutine reserve_contacts(contacts, n)
    type(contacts_t), intent(inout) :: contacts !! contacts to make room in
    integer, intent(in) :: n !! contacts wanted

    integer :: now

    now = -1
    if (allocated(contacts%gap)) now = size(contacts%gap)
    if (n > now) call contacts%resize(merge(room_for(n, max(0, now)), 0, n > 0))
  end subroutine reserve_contacts

  !> Periods along x, y, z by which the antagonist of a contact is moved.
  pure function image_of(contacts, k) result(image)
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    integer :: image(3)

    image = [int(contacts%image(k)), 0, 0]
    if (allocated(contacts%image_y)) image(2) = int(contacts%image_y(k))
    if (allocated(contacts%image_z)) image(3) = int(contacts%image_z(k))
  end function image_of

  !> Does the candidate meet the antagonist itself, not an image of it?
  pure logical function is_own_image(contacts, k)
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact

    is_own_image = int(contacts%image(k)) == 0
    if (allocated(contacts%image_y)) is_own_image = is_own_image .and. int(contacts%image_y(k)) == 0
    if (allocated(contacts%image_z)) is_own_image = is_own_image .and. int(contacts%image_z(k)) == 0
  end function is_own_image

  !> Are there cohesive zones among the laws in use?
  pure logical function has_bonds(contacts)
    type(contacts_t), intent(in) :: contacts !! contacts of the step

    has_bonds = contacts%n_internal - contacts%n_moments >= bond_slip
  end function has_bonds

  !> Moment that the candidate of a contact feels over the step, in the world's axes [N m s]; in the plane the third component.
  pure function moment_vector(contacts, k) result(moment)
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp) :: moment(3)

    moment = 0
    if (contacts%n_moments == 0) return
    moment(4 - contacts%n_moments:) = contacts%internal(contacts%n_internal - contacts%n_moments + 1:, k)
  end function moment_vector

  !> Normal impulse of a contact [N s].
  pure real(wp) function normal_impulse(contacts, k)
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact

    normal_impulse = contacts%impulse(1, k)
    if (contacts%n_components == 3) &
      normal_impulse = normal_impulse*contacts%normal(1, k) + contacts%impulse(2, k)*contacts%normal(2, k) &
                       + contacts%impulse(3, k)*contacts%normal(3, k)
  end function normal_impulse

  !> Those of all contacts [N s]: without a call for each from another file.
  pure subroutine normal_impulses(contacts, normal)
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    real(wp), allocatable, intent(out) :: normal(:) !! shape (contacts)
    integer :: k

    allocate (normal(contacts%n))
    do k = 1, contacts%n
      normal(k) = normal_impulse(contacts, k)
    end do
  end subroutine normal_impulses

  !> Impulse that the candidate of a contact feels, in the world's axes [N s]; its third component is zero in the plane.
  pure function impulse_vector(contacts, k) result(p)
    type(contacts_t), intent(in) :: contacts !! contacts of the step
    integer, intent(in) :: k !! contact
    real(wp) :: p(3)

    p = 0
    associate (n => contacts%normal(:, k), r => contacts%impulse(:, k))
      select case (contacts%n_components)
      case (1)
        p(:contacts%dimension) = r(1)*n
      case (2)
        p(:2) = r(1)*n + r(2)*[n(2), -n(1)]
      case (3)
        p = r
      end select
    end associate
  end function impulse_vector
end module sg_contacts
