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
  use sg_carry_loops, only: chunk, follow_faces, measure_disks, measure_spheres, turn_by
  use sg_contactors, only: kind_cylinder, kind_disk, kind_point, kind_polygon, kind_sphere, place_contactors
  use sg_contacts, only: contacts_t
  use sg_detect, only: turn_link
  use sg_follow, only: face_of, follow_in_space, follows
  use sg_kinds, only: wp, i1, i4, i8
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
  !> Manners to carry a contact: one by one, with its neighbours as two disks or two spheres, or with them as following in the plane
  integer(i1), parameter :: by_itself = 0, by_centres = 1, by_faces = 2

  !> What carries contacts between the substeps of a step
  type :: carry_t
    !> Body whose face each contact lies on, one of `face_of_*`, shape (contacts); not allocated where no scene has followers
    integer(i1), allocatable, private :: face(:)
    !> How each contact is carried, one of `by_*`, shape (contacts); not allocated where all are carried one by one
    integer(i1), allocatable, private :: manner(:)
    !> Configuration of the last substep, as `middle` of the bodies, and the turn of each body since: cosine and sine, in space a
    !! quaternion, shape (2 or 4, bodies)
    real(wp), allocatable, private :: before(:, :), turn(:, :)
    !> Are there contacts that the narrow phase measures again, contacts whose points follow their bodies, and runs of either that
    !! are carried together?
    logical, private :: has_measured = .false., has_followers = .false., has_runs = .false.
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
    self%has_runs = .false.
    do k = 1, contacts%n
      associate (kind => scene%contactors%kind(contacts%contactor(1, k)))
        self%has_followers = self%has_followers .or. follows(kind) .or. kind == kind_cylinder
        self%has_measured = self%has_measured .or. .not. follows(kind)
        self%has_runs = self%has_runs .or. any(kind == [kind_disk, kind_sphere, kind_polygon])
      end associate
    end do
    if (self%has_runs) call find_manners(self, scene, contacts)
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

  !> Find how each contact is carried.
  subroutine find_manners(self, scene, contacts)
    class(carry_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer :: k

    call reserve(self%manner, contacts%n)
    do k = 1, contacts%n
      associate (kind_c => scene%contactors%kind(contacts%contactor(1, k)), &
                 kind_a => scene%contactors%kind(contacts%contactor(2, k)))
        self%manner(k) = merge(by_centres, by_itself, kind_c == kind_a .and. (kind_c == kind_disk .or. kind_c == kind_sphere))
        if (kind_c == kind_polygon) self%manner(k) = by_faces
      end associate
    end do
  end subroutine find_manners

  !> Bring all contacts to where their bodies are now.
  subroutine carry_move(self, scene, contacts, places_shapes, is_fast)
    class(carry_t), intent(inout) :: self
    type(scene_t), intent(inout) :: scene !! scene, its `middle` configuration set; its contactors are placed where that is needed
    type(contacts_t), intent(inout) :: contacts !! contacts of the step
    logical, intent(in) :: places_shapes !! place the contactors in any case?
    logical, intent(in) :: is_fast !! may a body have left its neighbours since they were found?
    integer :: k, last

    if (places_shapes .or. is_fast .or. self%has_measured) call place_contactors(scene%contactors, scene%bodies%middle)
    if (self%has_followers) call find_turns(self, scene)
    k = 1
    do while (k <= contacts%n)
      last = last_alike(self, k, contacts%n)
      if (last < k) then
        call move_any(self, scene, contacts, k)
        k = k + 1
        cycle
      end if
      if (self%manner(k) == by_faces) then
        call follow_faces(last - k + 1, size(self%before, 1), scene%bodies%n, self%face(k:last), contacts%body(:, k:last), &
                          contacts%image(k:last), scene%period, self%before, scene%bodies%middle, self%turn, &
                          contacts%normal(:, k:last), contacts%point(:, k:last), contacts%gap(k:last))
      else if (scene%dimension == 2) then
        call measure_disks(last - k + 1, contacts%contactor(:, k:last), contacts%image(k:last), scene%period, &
                           scene%contactors%n, scene%contactors%centre, scene%contactors%reach, contacts%normal(:, k:last), &
                           contacts%point(:, k:last), contacts%gap(k:last))
      else
        call measure_spheres(last - k + 1, contacts%contactor(:, k:last), contacts%image(k:last), contacts%image_y(k:last), &
                             [scene%period, scene%period_y], scene%contactors%n, scene%contactors%centre, &
                             scene%contactors%reach, contacts%normal(:, k:last), contacts%point(:, k:last), contacts%gap(k:last))
      end if
      k = last + 1
    end do
    if (self%has_followers) self%before = scene%bodies%middle
    if (self%has_followers .and. is_fast) call part(scene, contacts)
  end subroutine carry_move

  !> Last contact of a run, of a chunk at most, that begins with a contact and is carried together; the one before for none.
  pure integer function last_alike(self, first, n) result(last)
    type(carry_t), intent(in) :: self
    integer, intent(in) :: first, n

    last = first - 1
    if (.not. self%has_runs) return
    if (self%manner(first) == by_itself) return
    do while (last < min(n, first + chunk - 1))
      if (self%manner(last + 1) /= self%manner(first)) exit
      last = last + 1
    end do
  end function last_alike

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
    if (allocated(self%turn)) then
      if (size(self%turn, 2) /= scene%bodies%n) deallocate (self%turn)
    end if
    if (.not. allocated(self%turn)) allocate (self%turn(merge(2, 4, n == 2), scene%bodies%n))
    associate (middle => scene%bodies%middle, before => self%before, turn => self%turn)
      do b = 1, scene%bodies%n
        if (size(before, 1) == n) then
          turn(:, b) = no_rotation(:size(turn, 1))
        else if (n == 2) then
          turn(:, b) = turn_by(middle(3, b) - before(3, b))
        else
          turn(:, b) = no_rotation
          if (any(abs(middle(4:7, b) - before(4:7, b)) > 0)) &
            turn(:, b) = quaternion_product(middle(4:7, b), [before(4, b), -before(5:7, b)])
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
    real(wp) :: offset(3)

    if (scene%dimension == 2) then
      call follow_faces(1, size(self%before, 1), scene%bodies%n, self%face(k:k), contacts%body(:, k:k), contacts%image(k:k), &
                        scene%period, self%before, scene%bodies%middle, self%turn, contacts%normal(:, k:k), &
                        contacts%point(:, k:k), contacts%gap(k:k))
      return
    end if
    offset = offset_of(scene, contacts, k)
    associate (c => contacts%body(1, k), a => contacts%body(2, k), before => self%before, middle => scene%bodies%middle, &
               turn => self%turn)
      call follow_in_space(self%face(k), before(1:3, c), before(1:3, a) + offset, middle(1:3, c), middle(1:3, a) + offset, &
                           turn(:, c), turn(:, a), contacts%normal(:, k), contacts%point(:, k), contacts%gap(k))
    end associate
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
    call tables%note('manner', self%manner)
    call tables%begin('carry', per_body)
    call tables%note('before', self%before)
    call tables%note('turn', self%turn)
  end subroutine carry_list_tables

  !> What making room to carry so many contacts takes at most [bytes].
  pure integer(i8) function carry_growth(self, n_contacts) result(bytes)
    class(carry_t), intent(in) :: self
    integer, intent(in) :: n_contacts !! contacts of a step

    bytes = growth_of(self%face, n_contacts) + growth_of(self%manner, n_contacts)
  end function carry_growth

  !> That of one list of bytes.
  pure integer(i8) function growth_of(list, n_contacts) result(bytes)
    integer(i1), allocatable, intent(in) :: list(:)
    integer, intent(in) :: n_contacts
    integer :: now

    now = 0
    if (allocated(list)) now = size(list)
    bytes = 0
    if (n_contacts > now) bytes = int(room_for(n_contacts, now), i8)
  end function growth_of
end module sg_carry
