!> Detection: from the configuration of a step to its contacts, with the impulses of the last step as a guess.
module sg_detect
  use sg_contactors, only: contactors_t, kind_disk, kind_hollow, kind_polygon, kind_wall, place_contactors
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_history, only: history_t, keep_contacts, match_pairs, recall
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: law_mohr, status_bonded, status_new
  use sg_neighbours, only: build_neighbours, fitting_skin, neighbours_are_stale, neighbours_t
  use sg_scene, only: scene_t
  use sg_touch, only: touch_t
  use sg_touch_disk_disk, only: touch_disk_disk
  use sg_touch_disk_hollow, only: touch_disk_hollow
  use sg_touch_disk_polygon, only: touch_disk_polygon
  use sg_touch_disk_wall, only: touch_disk_wall
  use sg_touch_polygon_polygon, only: touch_polygon_polygon
  use sg_touch_polygon_wall, only: touch_polygon_wall
  implicit none
  private
  public :: detect, touch_pair

contains

  !> Find the contacts of a step in the configuration `bodies%middle`.
  subroutine detect(scene, pairs, history, contacts)
    type(scene_t), intent(inout) :: scene !! scene; bodies that left the period come back into it
    type(neighbours_t), intent(inout) :: pairs !! pairs that may touch, made anew when stale
    type(history_t), intent(inout) :: history !! contacts of the last detection
    type(contacts_t), intent(inout) :: contacts !! contacts of the last step, replaced by those of this one

    if (.not. history%is_loaded) call keep_contacts(history, contacts)
    history%is_matched = .false.
    if (neighbours_are_stale(pairs, scene)) then
      if (.not. history%is_loaded .and. allocated(pairs%contactor)) history%contactor = pairs%contactor(:, :pairs%n)
      call build_neighbours(pairs, scene, scene%bodies%middle, fitting_skin(scene))
      call match_pairs(history, scene%contactors%n, pairs)
    else if (history%is_loaded) then
      call match_pairs(history, scene%contactors%n, pairs)
    end if
    call place_contactors(scene%contactors, scene%bodies%middle)
    call touch_all(scene, pairs, history, contacts)
    history%is_loaded = .false.
    history%is_start = .false.
  end subroutine detect

  !> Narrow phase over all pairs.
  subroutine touch_all(scene, pairs, history, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(inout) :: history
    type(contacts_t), intent(inout) :: contacts
    type(touch_t) :: touch
    integer(i4), allocatable :: first(:)
    integer :: p, i

    ! About half of the neighbours touch; more room is made when it is wanted.
    call reserve_contacts(contacts, max(contacts%n, pairs%n/2))
    contacts%n = 0
    allocate (first(pairs%n + 1))
    do p = 1, pairs%n
      first(p) = int(contacts%n, i4) + 1
      associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), see => scene%sees(pairs%see(p)))
        if (circles_are_apart(scene, c, a, pairs%image(p), see%alert)) cycle
        call touch_pair(scene%contactors, c, a, scene%period*real(pairs%image(p), wp), see%alert, touch, &
                        scene%period)
        if (contacts%n + touch%n > size(contacts%gap)) call reserve_contacts(contacts, contacts%n + touch%n)
        do i = 1, touch%n
          call add_contact(scene, pairs, history, p, touch, i, contacts)
        end do
      end associate
    end do
    first(pairs%n + 1) = int(contacts%n, i4) + 1
    call move_alloc(first, history%first)
    history%n_pairs = pairs%n
  end subroutine touch_all

  !> Are the circles about two shapes farther apart than the alert distance? Most neighbours' are; a square tells.
  pure logical function circles_are_apart(scene, c, a, image, alert) result(apart)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: c, a
    integer(i1), intent(in) :: image
    real(wp), intent(in) :: alert
    real(wp) :: x, y, limit

    apart = .false.
    associate (contactors => scene%contactors)
      if (contactors%kind(a) == kind_wall .or. contactors%kind(a) == kind_hollow) return
      x = contactors%centre(1, c) - contactors%centre(1, a) - scene%period*real(image, wp)
      y = contactors%centre(2, c) - contactors%centre(2, a)
      limit = contactors%reach(c) + contactors%reach(a) + alert
      apart = x**2 + y**2 > limit**2
    end associate
  end function circles_are_apart

  !> Add one point of contact, with the impulse of its past.
  subroutine add_contact(scene, pairs, history, p, touch, i, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(in) :: history
    integer, intent(in) :: p, i
    type(touch_t), intent(in) :: touch
    type(contacts_t), intent(inout) :: contacts
    integer :: k, past

    k = contacts%n + 1
    contacts%n = k
    contacts%contactor(1, k) = pairs%contactor(1, p)
    contacts%contactor(2, k) = pairs%contactor(2, p)
    contacts%body(1, k) = scene%contactors%body(pairs%contactor(1, p))
    contacts%body(2, k) = scene%contactors%body(pairs%contactor(2, p))
    contacts%image(k) = pairs%image(p)
    contacts%law(k) = int(scene%sees(pairs%see(p))%law, i4)
    contacts%feature(k) = touch%feature(i)
    contacts%normal(:, k) = touch%normal(:, i)
    contacts%point(:, k) = touch%point(:, i)
    contacts%gap(k) = touch%gap(i)
    past = recall(history, p, touch%feature(i), touch%point(:, i))
    if (past > 0) then
      contacts%impulse(:, k) = history%impulse(:, past)
      contacts%status(k) = history%status(past)
    else
      contacts%impulse(:, k) = 0
      contacts%status(k) = status_new
    end if
    if (history%is_start) contacts%status(k) = status_at_start(scene, contacts%law(k), contacts%status(k))
  end subroutine add_contact

  !> What a contact of the very first step is taken to have done before: Mohr-Coulomb contacts start bonded.
  pure integer(i1) function status_at_start(scene, law, status)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: law
    integer(i1), intent(in) :: status

    status_at_start = status
    if (status == status_new .and. scene%laws(law)%kind == law_mohr) status_at_start = status_bonded
  end function status_at_start

  !> Narrow phase of one pair: the kernel of its two kinds.
  pure subroutine touch_pair(contactors, c, a, offset, alert, touch, period)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: offset !! shift of the antagonist in x [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_t), intent(out) :: touch !! points of contact
    real(wp), intent(in), optional :: period !! period in x, makes a level wall endless that spans it [m]
    real(wp) :: centre(2), shift(2), half_length
    integer :: row_c, row_a, first, n, first_c, n_c

    shift = [offset, 0.0_wp]
    row_c = contactors%row(c)
    row_a = contactors%row(a)
    centre = contactors%centre(:, a) + shift
    if (contactors%kind(a) == kind_wall) half_length = facing_length(contactors, row_a, period)
    if (contactors%kind(a) == kind_polygon) then
      first = contactors%polygon_first(row_a)
      n = contactors%polygon_first(row_a + 1) - first
    end if
    if (contactors%kind(c) == kind_disk) then
      associate (own => contactors%centre(:, c), radius => contactors%disk_radius(row_c))
        select case (contactors%kind(a))
        case (kind_disk)
          call touch_disk_disk(own, radius, centre, contactors%disk_radius(row_a), alert, touch)
        case (kind_wall)
          call touch_disk_wall(own, radius, centre, contactors%wall_axis(:, row_a), half_length, contactors%wall_size(2, row_a), &
                               alert, touch)
        case (kind_hollow)
          call touch_disk_hollow(own, radius, centre, contactors%hollow_radius(row_a), alert, touch)
        case (kind_polygon)
          call touch_disk_polygon(own, radius, n, contactors%polygon_world(1, first), shift, alert, touch)
        end select
      end associate
    else
      first_c = contactors%polygon_first(row_c)
      n_c = contactors%polygon_first(row_c + 1) - first_c
      if (contactors%kind(a) == kind_polygon) then
        call touch_polygon_polygon(n_c, contactors%polygon_world(1, first_c), n, contactors%polygon_world(1, first), shift, &
                                   alert, touch)
      else
        call touch_polygon_wall(n_c, contactors%polygon_world(1, first_c), centre, contactors%wall_axis(:, row_a), half_length, &
                                contactors%wall_size(2, row_a), alert, touch)
      end if
    end if
  end subroutine touch_pair

  !> Half length of a wall's axis as its antagonists meet it [m].
  !!
  !! A level wall that spans the period goes on in its own images: grains at its ends must not feel round caps there.
  pure real(wp) function facing_length(contactors, row, period) result(half_length)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: row
    real(wp), intent(in), optional :: period
    real(wp), parameter :: level = 1e-6_wp ! slope below which neighbouring images meet

    half_length = contactors%wall_size(1, row)
    if (.not. present(period)) return
    if (period > 0 .and. 2*half_length >= period .and. abs(contactors%wall_axis(2, row)) < level) half_length = half_length + period
  end function facing_length
end module sg_detect
