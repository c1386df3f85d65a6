!> Contacts carried from one substep to the next: points, normals and gaps that follow their bodies (doc/theory/substeps.md).
!!
!! Detection finds the contacts of a whole step. Between two substeps of it, bodies move, and each contact is brought to where they
!! are now:
!!
!! - of a disk, a sphere or a cylinder the narrow phase measures the pair again: normal and gap are those of a detection;
!! - of two polygons or polyhedra, or of one of them and a wall, the normal turns with the body whose face it is, the point is one
!!   of the other body's surface, and the gap is the height of that point over the face: exact for this point and this face;
!! - of a link, normal and length follow from its two ends, as in detection.
!!
!! Impulses, statuses and internal values stay: they are the guess and the past of the next solve.
module sg_carry
  use sg_contactors, only: contactors_t, kind_cylinder, kind_plane, kind_point, kind_polygon, kind_polyhedron, kind_segment, &
                           place_contactors
  use sg_contacts, only: contacts_t
  use sg_detect, only: turn_link
  use sg_kinds, only: wp, i1, i8
  use sg_link_laws, only: pulls_only
  use sg_lists, only: reserve, room_for
  use sg_rotations, only: no_rotation, quaternion_product, turned_by
  use sg_scene, only: scene_t
  use sg_tables, only: per_body, per_contact, tables_t
  use sg_touch, only: touch_t
  use sg_touch_link, only: touch_link
  use sg_touch_pair, only: touch_pair
  use sg_touch_space, only: touch_space_t
  use sg_touch_space_pair, only: plane_axes, touch_space_pair
  implicit none
  private
  public :: carry_t

  !> Alert distance of a pair that is measured again: none [m]
  real(wp), parameter :: far = 1e100_wp
  !> Bodies whose face may be the one that a contact lies on: the antagonist or the candidate
  integer(i1), parameter :: face_of_antagonist = 0, face_of_candidate = 1
  !> Cosine by which a face of the candidate must be squarer to the normal than all of the antagonist, as in the narrow phase
  real(wp), parameter :: squarer = 1e-10_wp

  !> What carries contacts between the substeps of a step
  type :: carry_t
    !> Body whose face each contact lies on, one of `face_of_*`, shape (contacts); not allocated where no scene has followers
    integer(i1), allocatable, private :: face(:)
    !> Configuration of the last substep, as `middle` of the bodies, and the turn of each body since: cosine and sine, in space a
    !! quaternion, shape (2 or 4, bodies)
    real(wp), allocatable, private :: before(:, :), turn(:, :)
    !> Are there contacts that the narrow phase measures again, and contacts whose points follow their bodies?
    logical, private :: has_measured = .false., has_followers = .false.
  contains
    procedure :: begin => carry_begin
    procedure :: move => carry_move
    procedure :: list_tables => carry_list_tables
    procedure :: growth => carry_growth
  end type carry_t

contains

  !> Take up the contacts that a detection has found.
  subroutine carry_begin(self, scene, contacts)
    class(carry_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! its contactors are placed in its `middle` configuration
    type(contacts_t), intent(in) :: contacts !! contacts found there
    integer :: k

    self%has_followers = .false.
    self%has_measured = .false.
    do k = 1, contacts%n
      associate (kind => scene%contactors%kind(contacts%contactor(1, k)))
        self%has_followers = self%has_followers .or. follows(kind) .or. kind == kind_cylinder
        self%has_measured = self%has_measured .or. .not. follows(kind)
      end associate
    end do
    if (.not. self%has_followers) return
    call reserve(self%face, contacts%n)
    do k = 1, contacts%n
      self%face(k) = face_of(scene%contactors, contacts, k)
    end do
    if (allocated(self%before)) then
      if (any(shape(self%before) /= shape(scene%bodies%middle))) deallocate (self%before)
    end if
    if (.not. allocated(self%before)) allocate (self%before, mold=scene%bodies%middle)
    self%before = scene%bodies%middle
  end subroutine carry_begin

  !> Bring all contacts to where their bodies are now.
  subroutine carry_move(self, scene, contacts, places_shapes)
    class(carry_t), intent(inout) :: self
    type(scene_t), intent(inout) :: scene !! scene, its `middle` configuration set; its contactors are placed where that is needed
    type(contacts_t), intent(inout) :: contacts !! contacts of the step
    logical, intent(in) :: places_shapes !! place the contactors in any case?
    logical :: is_measured
    integer :: k

    if (places_shapes .or. self%has_measured) call place_contactors(scene%contactors, scene%bodies%middle)
    if (self%has_followers) call find_turns(self, scene)
    do k = 1, contacts%n
      associate (kind => scene%contactors%kind(contacts%contactor(1, k)))
        is_measured = .false.
        if (kind == kind_point) then
          call measure_link(scene, contacts, k)
          is_measured = .true.
        else if (.not. follows(kind)) then
          call measure(scene, contacts, k, is_measured)
        end if
        if (.not. is_measured) call follow(self, scene, contacts, k)
      end associate
    end do
    if (self%has_followers) self%before = scene%bodies%middle
  end subroutine carry_move

  !> Do the points of contact of a candidate of this kind follow their bodies?
  pure logical function follows(kind)
    integer, intent(in) :: kind

    follows = kind == kind_polygon .or. kind == kind_polyhedron
  end function follows

  !> Body whose face a contact lies on: the one with the face most square to the normal, of faces as square the antagonist.
  pure integer(i1) function face_of(contactors, contacts, k) result(face)
    type(contactors_t), intent(in) :: contactors
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k

    face = face_of_antagonist
    associate (normal => contacts%normal(:, k), c => contacts%contactor(1, k), a => contacts%contactor(2, k))
      if (squareness(contactors, int(c), -normal) > squareness(contactors, int(a), normal) + squarer) face = face_of_candidate
    end associate
  end function face_of

  !> Cosine between a direction and the outward normal of the face of a shape that is most square to it; -1 without faces.
  pure real(wp) function squareness(contactors, c, direction) result(cosine)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp), intent(in) :: direction(:)
    real(wp) :: frame(3, 3)
    integer :: i

    cosine = -1
    associate (row => contactors%row(c))
      select case (contactors%kind(c))
      case (kind_polygon)
        do i = contactors%polygon_first(row), contactors%polygon_first(row + 1) - 1
          cosine = max(cosine, dot_product(direction, contactors%polygon_edge(1:2, i)))
        end do
      case (kind_segment)
        cosine = abs(direction(2)*contactors%segment_axis(1, row) - direction(1)*contactors%segment_axis(2, row))
      case (kind_polyhedron)
        associate (normals => contactors%space%polyhedra(row)%world_normal)
          do i = 1, size(normals, 2)
            cosine = max(cosine, dot_product(direction, normals(:, i)))
          end do
        end associate
      case (kind_plane)
        frame = plane_axes(contactors, row)
        do i = 1, 3
          cosine = max(cosine, abs(dot_product(direction, frame(:, i))))
        end do
      end select
    end associate
  end function squareness

  !> Find by how much each body has turned since the last substep; one that has not turned at all has no rotation, exactly.
  pure subroutine find_turns(self, scene)
    class(carry_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    integer :: b, n

    n = scene%dimension
    if (size(self%before, 1) == n) return
    if (.not. allocated(self%turn)) allocate (self%turn(merge(2, 4, n == 2), scene%bodies%n))
    if (size(self%turn, 2) /= scene%bodies%n) then
      deallocate (self%turn)
      allocate (self%turn(merge(2, 4, n == 2), scene%bodies%n))
    end if
    associate (middle => scene%bodies%middle, before => self%before)
      do b = 1, scene%bodies%n
        if (n == 2) then
          self%turn(:, b) = [cos(middle(3, b) - before(3, b)), sin(middle(3, b) - before(3, b))]
        else
          self%turn(:, b) = no_rotation
          if (any(abs(middle(4:7, b) - before(4:7, b)) > 0)) &
            self%turn(:, b) = quaternion_product(middle(4:7, b), [before(4, b), -before(5:7, b)])
        end if
      end do
    end associate
  end subroutine find_turns

  !> A vector of the world that has turned with a body.
  pure function with_body(self, b, v) result(image)
    class(carry_t), intent(in) :: self
    integer, intent(in) :: b
    real(wp), intent(in) :: v(:)
    real(wp) :: image(size(v))

    image = v
    if (.not. allocated(self%turn)) return
    if (size(v) == 2) then
      image = [self%turn(1, b)*v(1) - self%turn(2, b)*v(2), self%turn(2, b)*v(1) + self%turn(1, b)*v(2)]
    else
      image = turned_by(self%turn(:, b), v)
    end if
  end function with_body

  !> Let a contact follow: the normal turns with the body of its face, the point moves with the other one.
  pure subroutine follow(self, scene, contacts, k)
    class(carry_t), intent(in) :: self
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(inout) :: contacts
    integer, intent(in) :: k
    real(wp), dimension(scene%dimension) :: half, arm_c, arm_a, between, normal, shift
    integer :: c, a, n

    n = scene%dimension
    c = contacts%body(1, k)
    a = contacts%body(2, k)
    shift = offset_of(scene, contacts, k)
    half = contacts%gap(k)/2*contacts%normal(:, k)
    arm_c = with_body(self, c, contacts%point(:, k) + half - self%before(:n, c))
    arm_a = with_body(self, a, contacts%point(:, k) - half - shift - self%before(:n, a))
    between = scene%bodies%middle(:n, c) - scene%bodies%middle(:n, a) - shift + arm_c - arm_a
    if (self%face(k) == face_of_candidate) then
      normal = with_body(self, c, contacts%normal(:, k))
      contacts%gap(k) = dot_product(normal, between)
      contacts%point(:, k) = scene%bodies%middle(:n, a) + shift + arm_a + contacts%gap(k)/2*normal
    else
      normal = with_body(self, a, contacts%normal(:, k))
      contacts%gap(k) = dot_product(normal, between)
      contacts%point(:, k) = scene%bodies%middle(:n, c) + arm_c - contacts%gap(k)/2*normal
    end if
    contacts%normal(:, k) = normal
  end subroutine follow

  !> Measure the pair of a contact again by the narrow phase. A cylinder may have lost the point: then it follows its bodies.
  pure subroutine measure(scene, contacts, k, is_measured)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(inout) :: contacts
    integer, intent(in) :: k
    logical, intent(out) :: is_measured
    type(touch_t) :: touch
    type(touch_space_t) :: in_space
    real(wp) :: offset(3)
    integer :: i

    is_measured = .false.
    associate (c => contacts%contactor(1, k), a => contacts%contactor(2, k))
      if (scene%dimension == 2) then
        call touch_pair(scene%contactors, c, a, scene%period*real(contacts%image(k), wp), far, touch, scene%period)
        is_measured = touch%n > 0
        if (is_measured) call put(touch%normal(:, 1), touch%point(:, 1), touch%gap(1), contacts, k)
      else
        offset = offset_of(scene, contacts, k)
        call touch_space_pair(scene%contactors, c, a, offset, far, [scene%period, scene%period_y], in_space)
        do i = 1, in_space%n
          if (in_space%feature(i) /= contacts%feature(k) .and. scene%contactors%kind(c) == kind_cylinder) cycle
          call put(in_space%normal(:, i), in_space%point(:, i), in_space%gap(i), contacts, k)
          is_measured = .true.
          exit
        end do
      end if
    end associate
  end subroutine measure

  !> Set the geometry of a contact.
  pure subroutine put(normal, point, gap, contacts, k)
    real(wp), intent(in) :: normal(:), point(:), gap
    type(contacts_t), intent(inout) :: contacts
    integer, intent(in) :: k

    contacts%normal(:, k) = normal
    contacts%point(:, k) = point
    contacts%gap(k) = gap
  end subroutine put

  !> Measure a link again.
  pure subroutine measure_link(scene, contacts, k)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(inout) :: contacts
    integer, intent(in) :: k
    real(wp), dimension(scene%dimension) :: ends(scene%dimension, 2)

    associate (centre => scene%contactors%centre, pair => contacts%contactor(:, k), l => contacts%feature(k))
      ends(:, 1) = centre(:, pair(1))
      ends(:, 2) = centre(:, pair(2)) + offset_of(scene, contacts, k)
      call touch_link(ends(:, 1), ends(:, 2), scene%links%length(l), pulls_only(scene%laws(contacts%law(k))), &
                      contacts%normal(:, k), contacts%point(:, k), contacts%gap(k))
    end associate
    call turn_link(scene, contacts, k)
  end subroutine measure_link

  !> Shift of the antagonist of a contact [m].
  pure function offset_of(scene, contacts, k) result(offset)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k
    real(wp) :: offset(scene%dimension)

    offset = 0
    offset(1) = scene%period*real(contacts%image(k), wp)
    if (scene%dimension == 3) offset(2) = scene%period_y*real(contacts%image_y(k), wp)
  end function offset_of

  !> List the tables.
  subroutine carry_list_tables(self, tables)
    class(carry_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('carry', per_contact)
    call tables%note('face', self%face)
    call tables%begin('carry', per_body)
    call tables%note('before', self%before)
    call tables%note('turn', self%turn)
  end subroutine carry_list_tables

  !> What making room to carry so many contacts takes at most [bytes].
  pure integer(i8) function carry_growth(self, n_contacts) result(bytes)
    class(carry_t), intent(in) :: self
    integer, intent(in) :: n_contacts !! contacts of a step
    integer :: now

    now = 0
    if (allocated(self%face)) now = size(self%face)
    bytes = 0
    if (n_contacts > now) bytes = int(room_for(n_contacts, now), i8)
  end function carry_growth
end module sg_carry
