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
  use sg_contactors, only: kind_cylinder, kind_disk, kind_point, kind_sphere, place_contactors
  use sg_contacts, only: contacts_t
  use sg_detect, only: turn_link
  use sg_follow, only: face_of, follow_in_plane, follow_in_space, follows
  use sg_kinds, only: wp, i1, i8
  use sg_link_laws, only: pulls_only
  use sg_lists, only: reserve, room_for
  use sg_rotations, only: no_rotation, quaternion_product
  use sg_scene, only: scene_t
  use sg_tables, only: per_body, per_contact, tables_t
  use sg_touch, only: touch_t
  use sg_touch_link, only: touch_link
  use sg_touch_pair, only: touch_pair
  use sg_touch_space, only: touch_space_t
  use sg_touch_space_pair, only: touch_space_pair
  implicit none
  private
  public :: carry_t

  !> Alert distance of a pair that is measured again: none [m]
  real(wp), parameter :: far = 1e100_wp

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
      self%face(k) = face_of(scene%contactors, contacts%contactor(1, k), contacts%contactor(2, k), contacts%normal(:, k))
    end do
    if (allocated(self%before)) then
      if (any(shape(self%before) /= shape(scene%bodies%middle))) deallocate (self%before)
    end if
    if (.not. allocated(self%before)) allocate (self%before, mold=scene%bodies%middle)
    self%before = scene%bodies%middle
  end subroutine carry_begin

  !> Bring all contacts to where their bodies are now.
  subroutine carry_move(self, scene, contacts, places_shapes, is_fast)
    class(carry_t), intent(inout) :: self
    type(scene_t), intent(inout) :: scene !! scene, its `middle` configuration set; its contactors are placed where that is needed
    type(contacts_t), intent(inout) :: contacts !! contacts of the step
    logical, intent(in) :: places_shapes !! place the contactors in any case?
    logical, intent(in) :: is_fast !! may a body have left its neighbours since they were found?
    integer :: k

    if (places_shapes .or. is_fast .or. self%has_measured) call place_contactors(scene%contactors, scene%bodies%middle)
    if (self%has_followers) call find_turns(self, scene)
    do k = 1, contacts%n
      associate (kind_c => scene%contactors%kind(contacts%contactor(1, k)), &
                 kind_a => scene%contactors%kind(contacts%contactor(2, k)))
        if (kind_c == kind_disk .and. kind_a == kind_disk) then
          call measure_disks(scene, contacts, k)
        else if (kind_c == kind_sphere .and. kind_a == kind_sphere) then
          call measure_spheres(scene, contacts, k)
        else
          call move_any(self, scene, contacts, k)
        end if
      end associate
    end do
    if (self%has_followers) self%before = scene%bodies%middle
    if (self%has_followers .and. is_fast) call part(scene, contacts)
  end subroutine carry_move

  !> Let shapes whose circles or spheres are apart touch, if at all, as these do: the face that a body has left ends somewhere.
  pure subroutine part(scene, contacts)
    type(scene_t), intent(in) :: scene !! its contactors are placed
    type(contacts_t), intent(inout) :: contacts
    real(wp) :: way(scene%dimension), distance, gap
    integer :: k

    associate (centre => scene%contactors%centre, reach => scene%contactors%reach)
      do k = 1, contacts%n
        associate (c => contacts%contactor(1, k), a => contacts%contactor(2, k))
          if (scene%contactors%kind(c) == kind_point) cycle
          way = centre(:, c) - centre(:, a) - offset_of(scene, contacts, k)
          distance = norm2(way)
          gap = distance - (reach(c) + reach(a))
          if (gap > 0) call put(way/distance, centre(:, c) - (reach(c) + gap/2)*(way/distance), gap, contacts, k)
        end associate
      end do
    end associate
  end subroutine part

  !> Bring a contact of any shapes to where its bodies are now.
  pure subroutine move_any(self, scene, contacts, k)
    class(carry_t), intent(in) :: self
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(inout) :: contacts
    integer, intent(in) :: k
    logical :: is_measured

    associate (kind => scene%contactors%kind(contacts%contactor(1, k)))
      is_measured = kind == kind_point
      if (kind == kind_point) then
        call measure_link(scene, contacts, k)
      else if (.not. follows(kind)) then
        call measure(scene, contacts, k, is_measured)
      end if
    end associate
    if (is_measured) return
    call follow(self, scene, contacts, k)
  end subroutine move_any

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

  !> Let a contact follow its bodies from the last substep to this one.
  pure subroutine follow(self, scene, contacts, k)
    class(carry_t), intent(in) :: self
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(inout) :: contacts
    integer, intent(in) :: k
    real(wp) :: shift(scene%dimension), turn(merge(2, 4, scene%dimension == 2), 2)

    shift = offset_of(scene, contacts, k)
    turn = 0
    turn(1, :) = 1
    associate (c => contacts%body(1, k), a => contacts%body(2, k), n => scene%dimension, middle => scene%bodies%middle, &
               before => self%before)
      if (allocated(self%turn)) turn = self%turn(:, [c, a])
      if (n == 2) then
        call follow_in_plane(self%face(k), before(1:2, c), before(1:2, a) + shift, middle(1:2, c), middle(1:2, a) + shift, &
                             turn(:, 1), turn(:, 2), contacts%normal(:, k), contacts%point(:, k), contacts%gap(k))
      else
        call follow_in_space(self%face(k), before(1:3, c), before(1:3, a) + shift, middle(1:3, c), middle(1:3, a) + shift, &
                             turn(:, 1), turn(:, 2), contacts%normal(:, k), contacts%point(:, k), contacts%gap(k))
      end if
    end associate
  end subroutine follow

  !> Measure two disks again: nearly all contacts of many scenes. Where the centres coincide the normal stays.
  pure subroutine measure_disks(scene, contacts, k)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(inout) :: contacts
    integer, intent(in) :: k
    real(wp) :: x, y, square, distance, place

    associate (c => contacts%contactor(1, k), a => contacts%contactor(2, k), centre => scene%contactors%centre, &
               reach => scene%contactors%reach)
      x = centre(1, c) - centre(1, a) - scene%period*real(contacts%image(k), wp)
      y = centre(2, c) - centre(2, a)
      square = x**2 + y**2
      distance = sqrt(square)
      if (square > tiny(square)) then
        contacts%normal(1, k) = x/distance
        contacts%normal(2, k) = y/distance
      end if
      contacts%gap(k) = distance - (reach(c) + reach(a))
      place = reach(c) + contacts%gap(k)/2
      contacts%point(1, k) = centre(1, c) - place*contacts%normal(1, k)
      contacts%point(2, k) = centre(2, c) - place*contacts%normal(2, k)
    end associate
  end subroutine measure_disks

  !> The same of two spheres.
  pure subroutine measure_spheres(scene, contacts, k)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(inout) :: contacts
    integer, intent(in) :: k
    real(wp) :: x, y, z, square, distance, place

    associate (c => contacts%contactor(1, k), a => contacts%contactor(2, k), centre => scene%contactors%centre, &
               reach => scene%contactors%reach)
      x = centre(1, c) - centre(1, a) - scene%period*real(contacts%image(k), wp)
      y = centre(2, c) - centre(2, a) - scene%period_y*real(contacts%image_y(k), wp)
      z = centre(3, c) - centre(3, a)
      square = x**2 + y**2 + z**2
      distance = sqrt(square)
      if (square > tiny(square)) then
        contacts%normal(1, k) = x/distance
        contacts%normal(2, k) = y/distance
        contacts%normal(3, k) = z/distance
      end if
      contacts%gap(k) = distance - (reach(c) + reach(a))
      place = reach(c) + contacts%gap(k)/2
      contacts%point(1, k) = centre(1, c) - place*contacts%normal(1, k)
      contacts%point(2, k) = centre(2, c) - place*contacts%normal(2, k)
      contacts%point(3, k) = centre(3, c) - place*contacts%normal(3, k)
    end associate
  end subroutine measure_spheres

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
        call touch_pair(scene%contactors, c, a, [scene%period*real(contacts%image(k), wp), 0.0_wp], far, touch, scene%period)
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
