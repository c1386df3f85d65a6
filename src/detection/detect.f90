!> Detection: from the configuration of a step to its contacts, with the impulses of the last step as a guess.
module sg_detect
  use sg_contactors, only: contactors_t, kind_disk, kind_hollow, kind_polygon, kind_wall, place_contactors
  use sg_contacts, only: contacts_t, reserve_contacts
  use sg_history, only: history_t, match, recall, remember
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: law_mohr, status_bonded, status_new
  use sg_neighbours, only: build_neighbours, neighbours_are_stale, neighbours_t
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

    if (.not. history%is_start) call remember(history, contacts)
    if (neighbours_are_stale(pairs, scene)) call build_neighbours(pairs, scene, scene%bodies%middle)
    if (history%n_pairs > 0) call match(history, scene%contactors%n, pairs%n, pairs%contactor)
    call place_contactors(scene%contactors, scene%bodies%middle)
    call touch_all(scene, pairs, history, contacts)
    history%is_start = .false.
  end subroutine detect

  !> Narrow phase over all pairs.
  subroutine touch_all(scene, pairs, history, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(in) :: history
    type(contacts_t), intent(inout) :: contacts
    type(touch_t) :: touch
    integer :: p, i, k

    contacts%n = 0
    call reserve_contacts(contacts, pairs%n)
    do p = 1, pairs%n
      call touch_pair(scene%contactors, pairs%contactor(1, p), pairs%contactor(2, p), scene%period*real(pairs%image(p), wp), &
                      scene%sees(pairs%see(p))%alert, touch)
      if (touch%n == 0) cycle
      call reserve_contacts(contacts, contacts%n + touch%n)
      do i = 1, touch%n
        k = contacts%n + 1
        contacts%n = k
        contacts%contactor(:, k) = pairs%contactor(:, p)
        contacts%body(:, k) = scene%contactors%body(pairs%contactor(:, p))
        contacts%image(k) = pairs%image(p)
        contacts%law(k) = int(scene%sees(pairs%see(p))%law, i4)
        contacts%feature(k) = touch%feature(i)
        contacts%normal(:, k) = touch%normal(:, i)
        contacts%point(:, k) = touch%point(:, i)
        contacts%gap(k) = touch%gap(i)
        call recall(history, p, touch%feature(i), touch%point(:, i), contacts%impulse(:, k), contacts%status(k))
        if (history%is_start) contacts%status(k) = status_at_start(scene, contacts%law(k), contacts%status(k))
      end do
    end do
  end subroutine touch_all

  !> What a contact of the very first step is taken to have done before: Mohr-Coulomb contacts start bonded.
  pure integer(i1) function status_at_start(scene, law, status)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: law
    integer(i1), intent(in) :: status

    status_at_start = status
    if (status == status_new .and. scene%laws(law)%kind == law_mohr) status_at_start = status_bonded
  end function status_at_start

  !> Narrow phase of one pair: the kernel of its two kinds.
  pure subroutine touch_pair(contactors, c, a, offset, alert, touch)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist
    real(wp), intent(in) :: offset !! shift of the antagonist in x [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_t), intent(out) :: touch !! points of contact
    real(wp) :: centre(2), shift(2)
    integer :: row_c, row_a, first, n, first_c, n_c

    shift = [offset, 0.0_wp]
    row_c = contactors%row(c)
    row_a = contactors%row(a)
    centre = contactors%centre(:, a) + shift
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
          call touch_disk_wall(own, radius, centre, contactors%wall_axis(:, row_a), contactors%wall_size(1, row_a), &
                               contactors%wall_size(2, row_a), alert, touch)
        case (kind_hollow)
          call touch_disk_hollow(own, radius, centre, contactors%hollow_radius(row_a), alert, touch)
        case (kind_polygon)
          call touch_disk_polygon(own, radius, n, contactors%polygon_world(:, first:first + n - 1), shift, alert, touch)
        end select
      end associate
    else
      first_c = contactors%polygon_first(row_c)
      n_c = contactors%polygon_first(row_c + 1) - first_c
      associate (vertices => contactors%polygon_world(:, first_c:first_c + n_c - 1))
        if (contactors%kind(a) == kind_polygon) then
          call touch_polygon_polygon(n_c, vertices, n, contactors%polygon_world(:, first:first + n - 1), shift, alert, touch)
        else
          call touch_polygon_wall(n_c, vertices, centre, contactors%wall_axis(:, row_a), contactors%wall_size(1, row_a), &
                                  contactors%wall_size(2, row_a), alert, touch)
        end if
      end associate
    end if
  end subroutine touch_pair
end module sg_detect
