!> Detection: from the configuration of a step to its contacts, with the impulses of the last step as a guess.
module sg_detect
  use sg_add_contacts, only: add_contacts, add_kept, is_slow, keep_pair, kept_length, law_of
  use sg_contactors, only: kind_polygon, kind_polyhedron, place_contactors, place_corners
  use sg_contacts, only: contacts_t, drop_contacts, grow_contacts
  use sg_follow, only: follows
  use sg_follow_pairs, only: are_followed, follow_pairs, most_followed
  use sg_history, only: exchange_kept, fold_images, history_t, keep_contacts, keep_faces, keep_pairs, match_pairs, &
                        unwrap_images
  use sg_internal_values, only: n_internal_of
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: law_bond, status_broken
  use sg_link_laws, only: holds_across, is_torn, pulls_only
  use sg_list_margins, only: choose_margins, fitting_skin, neighbours_are_stale
  use sg_narrow_phase, only: are_found_apart, path_of_pair, touch_in_plane, touch_in_space
  use sg_neighbours, only: build_neighbours, neighbours_t, offset_of
  use sg_pair_alert, only: alert_of_pair
  use sg_scene, only: scene_t
  use sg_sees, only: alert_of
  use sg_shape_kinds, only: is_bounding
  use sg_timers, only: wall_now
  use sg_touch, only: touch_t
  use sg_touch_link, only: touch_link
  use sg_touch_space, only: touch_space_t
  implicit none
  private
  public :: detect, turn_link

  !> Pairs from one look at the time to the next
  integer, parameter :: pairs_per_look = 1024

contains

  !> Find the contacts of a step in the configuration `bodies%middle`.
  subroutine detect(scene, pairs, history, contacts)
    type(scene_t), intent(inout) :: scene !! scene; bodies that left the period come back into it
    type(neighbours_t), intent(inout) :: pairs !! pairs that may touch, rebuilt when stale
    type(history_t), intent(inout) :: history !! contacts of the last detection
    type(contacts_t), intent(inout) :: contacts !! contacts of the last step, replaced by those of this one; none where memory or
    !! time ran short, as `pairs` and `contacts` report
    real(wp) :: skin
    real(wp), allocatable :: margin(:)
    integer(i4) :: folds

    if (.not. history%is_loaded) then
      call keep_contacts(history, contacts)
      call exchange_kept(history, contacts)
    end if
    history%is_matched = .false.
    if (neighbours_are_stale(pairs, scene)) then
      if (.not. history%is_loaded .and. allocated(pairs%contactor)) call keep_pairs(history, pairs)
      call unwrap_images(history, scene)
      skin = pairs%asked_skin
      if (.not. skin > 0) skin = fitting_skin(scene, pairs%substeps)
      call choose_margins(scene, pairs, skin, margin)
      folds = scene%cell%folds
      call build_neighbours(pairs, scene, scene%bodies%middle, margin)
      call fold_images(history, scene%cell%folds - folds)
      call match_pairs(history, scene, pairs)
    else if (history%is_loaded) then
      call unwrap_images(history, scene)
      call match_pairs(history, scene, pairs)
    end if
    call place_contactors(scene%contactors, scene%bodies%middle, pairs%corners_wait)
    if (.not. allocated(pairs%alert)) allocate (pairs%alert(size(scene%sees)))
    pairs%alert(:) = alert_of(scene%sees, pairs%way)
    if (scene%cell%is_on) contacts%upwards = scene%cell%middle([4, 2])
    call touch_all(scene, pairs, history, contacts)
    history%is_loaded = .false.
    history%is_start = .false.
    history%is_untouched = history%is_untouched .and. contacts%n == 0
  end subroutine detect

  !> Narrow phase over all pairs.
  subroutine touch_all(scene, pairs, history, contacts)
    type(scene_t), intent(inout) :: scene
    type(neighbours_t), intent(inout) :: pairs
    type(history_t), intent(inout) :: history
    type(contacts_t), intent(inout) :: contacts
    integer(i4), allocatable :: first(:)
    real(wp) :: alert
    real(wp), allocatable :: near(:), longest(:)
    integer, allocatable :: law_of_line(:)
    logical :: is_apart, is_near, goes_on
    integer :: p, next, last

    ! About half of the neighbours touch; more room is made when it is wanted.
    contacts%is_cut = .false.
    call grow_contacts(contacts, max(contacts%n, pairs%n/2, 1))
    if (contacts%is_cut) call grow_contacts(contacts, max(contacts%n, 1))
    contacts%n = 0
    allocate (first(pairs%n + 1))
    if (sum(scene%contactors%n_rows([kind_polygon, kind_polyhedron])) > 0) &
      call keep_faces(history, pairs%n_near, scene%dimension - 1)
    goes_on = are_followed(scene, history, contacts)
    is_near = .false.
    near = pairs%alert
    if (pairs%is_reduced .and. .not. pairs%is_by_pair) near = min(near, pairs%least)
    longest = scene%sees%alert
    law_of_line = scene%sees%law
    next = 1
    do while (next <= pairs%n_near)
      if (ends_early(pairs, contacts, next)) exit
      last = pairs%n_near
      if (goes_on) then
        last = min(pairs%n_near, (next/pairs_per_look + 1)*pairs_per_look - 1)
        call grow_contacts(contacts, contacts%n + most_followed)
        if (.not. contacts%is_cut) call follow_pairs(scene, pairs, history, near, longest, law_of_line, last, contacts, first, &
                                                      next, alert, is_near)
        if (next > last .or. contacts%n + most_followed > size(contacts%gap)) cycle
        last = next
      end if
      do p = next, last
        if (ends_early(pairs, contacts, p)) exit
        first(p) = int(contacts%n, i4) + 1
        ! Most pairs end here.
        is_apart = .false.
        if (.not. is_near) call look_at_spheres(scene, pairs, p, contacts%n_kept, alert, is_apart)
        if (.not. is_apart) call touch_near(scene, pairs, history, p, alert, is_near, contacts)
      end do
      next = last + 1
    end do
    do p = pairs%n_near + 1, pairs%n
      if (ends_early(pairs, contacts, p)) exit
      first(p) = int(contacts%n, i4) + 1
      call follow_link(scene, pairs, history, p, contacts)
    end do
    if (contacts%is_cut .or. pairs%is_late) then
      call drop_contacts(contacts)
      first = 1
    end if
    first(pairs%n + 1) = int(contacts%n, i4) + 1
    call move_alloc(history%first, history%first_before)
    history%n_before = history%n_pairs
    call move_alloc(first, history%first)
    history%n_pairs = pairs%n
  end subroutine touch_all

  !> Is there no memory for more contacts, or no time for more pairs?
  logical function ends_early(pairs, contacts, p)
    type(neighbours_t), intent(inout) :: pairs
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: p

    if (pairs%deadline > 0 .and. modulo(p, pairs_per_look) == 0) pairs%is_late = wall_now() > pairs%deadline
    ends_early = contacts%is_cut .or. pairs%is_late
  end function ends_early

  !> Contacts of a pair whose circles or spheres are near: none, kept ones, or those that the narrow phase finds.
  subroutine touch_near(scene, pairs, history, p, near, is_known, contacts)
    type(scene_t), intent(inout) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(inout) :: history
    integer, intent(in) :: p
    real(wp), intent(in) :: near !! alert distance of the pair [m]
    logical, intent(in) :: is_known !! is it known that it has not been found apart, and that none of its contacts is kept?
    type(contacts_t), intent(inout) :: contacts
    real(wp) :: alert, path
    integer :: n
    logical :: keeps, is_kept

    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), contactors => scene%contactors)
      alert = near
      if (contacts%n_kept > 0) alert = near + kept_length(scene, c, a)
      path = path_of_pair(contactors, c, a)
      if (.not. is_known) then
        if (are_found_apart(scene, history, p, c, a, path, alert)) return
      end if
      keeps = contacts%n_kept > 0 .and. follows(contactors%kind(c))
      if (keeps .and. .not. is_known) then
        call add_kept(scene, pairs, history, p, near, contacts, is_kept)
        if (is_kept) return
      end if
      n = contacts%n
      if (scene%dimension == 2) then
        if (contactors%kind(c) == kind_polygon) call place_corners(contactors, c)
        if (contactors%kind(a) == kind_polygon) call place_corners(contactors, a)
        call find_in_plane(scene, pairs, history, p, alert, path, contacts)
      else
        call find_in_space(scene, pairs, history, p, alert, path, contacts)
      end if
      if (.not. keeps .or. contacts%n == n) return
      if (is_slow(scene, c, a, pairs%substeps)) call keep_pair(scene, pairs, p, near, contacts%n - n, contacts)
    end associate
  end subroutine touch_near

  !> Add the points that the narrow phase finds between two shapes in the plane.
  subroutine find_in_plane(scene, pairs, history, p, alert, path, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(inout) :: history
    integer, intent(in) :: p
    real(wp), intent(in) :: alert !! gap from which nothing is found [m]
    real(wp), intent(in) :: path !! path lengths of two polygons, added [m]
    type(contacts_t), intent(inout) :: contacts
    type(touch_t) :: touch

    call touch_in_plane(scene, pairs, history, p, alert, path, touch)
    if (touch%n > 0) call add_contacts(scene, pairs, history, p, law_of(scene, pairs, p), touch%n, touch%normal, touch%point, &
                                       touch%gap, touch%feature, contacts)
  end subroutine find_in_plane

  !> The same in space.
  subroutine find_in_space(scene, pairs, history, p, alert, path, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(inout) :: history
    integer, intent(in) :: p
    real(wp), intent(in) :: alert !! gap from which nothing is found [m]
    real(wp), intent(in) :: path !! path lengths of two polyhedra, added [m]
    type(contacts_t), intent(inout) :: contacts
    type(touch_space_t) :: touch

    call touch_in_space(scene, pairs, history, p, alert, path, touch)
    if (touch%n > 0) call add_contacts(scene, pairs, history, p, law_of(scene, pairs, p), touch%n, touch%normal, touch%point, &
                                       touch%gap, touch%feature, contacts)
  end subroutine find_in_space

  !> The contact of a link, which is there at any distance.
  subroutine follow_link(scene, pairs, history, p, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(in) :: history
    integer, intent(in) :: p
    type(contacts_t), intent(inout) :: contacts
    real(wp) :: offset(3), normal(scene%dimension), point(scene%dimension), length
    integer :: l

    l = pairs%link(p - pairs%n_near)
    offset = offset_of(scene, pairs, p)
    associate (centre => scene%contactors%centre, law => scene%laws(scene%links%law(l)))
      call touch_link(centre(:, pairs%contactor(1, p)), centre(:, pairs%contactor(2, p)) + offset(:scene%dimension), &
                      scene%links%length(l), pulls_only(law), normal, point, length)
    end associate
    call add_contacts(scene, pairs, history, p, scene%links%law(l), 1, normal, point, [length], [int(l, i4)], contacts)
    if (.not. contacts%is_cut) call turn_link(scene, contacts, contacts%n)
  end subroutine follow_link

  !> Turn the guess of a link whose ends have moved with it: that of a link which carries nothing across is the force along it. A
  !! bond that its ends have torn is broken.
  pure subroutine turn_link(scene, contacts, k)
    type(scene_t), intent(in) :: scene !! scene with its links
    type(contacts_t), intent(inout) :: contacts !! contacts, the link measured where its ends are now
    integer, intent(in) :: k !! contact, a link

    associate (normal => contacts%normal(:, k), impulse => contacts%impulse(:, k))
      if (contacts%n_components == 3 .and. .not. holds_across(scene%laws(contacts%law(k)))) &
        impulse = dot_product(impulse, normal)*normal
    end associate
    if (is_broken(scene, contacts, k, int(contacts%feature(k)))) contacts%status(k) = status_broken
  end subroutine turn_link

  !> Is a bond broken by where its ends are?
  pure logical function is_broken(scene, contacts, k, l)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    integer, intent(in) :: k, l !! contact and link
    real(wp) :: across(4)
    integer :: n

    is_broken = .false.
    if (scene%laws(contacts%law(k))%kind /= law_bond) return
    n = n_internal_of(scene%laws(contacts%law(k)), scene%dimension)
    across(:n) = contacts%internal(:n, k)
    ! In space the displacement counts across the bond as it lies now.
    if (n == 4) across(2:4) = across(2:4) - dot_product(across(2:4), contacts%normal(:, k))*contacts%normal(:, k)
    associate (links => scene%links)
      is_broken = is_torn(scene%laws(contacts%law(k)), contacts%gap(k), links%length(l), [links%area(l), links%mass(l)], across(:n))
    end associate
  end function is_broken

  !> Alert distance of a pair, and whether the circles or spheres about its shapes are farther apart. Squares decide.
  pure subroutine look_at_spheres(scene, pairs, p, n_kept, alert, is_apart)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    integer, intent(in) :: p
    integer, intent(in) :: n_kept !! values of a contact that is kept; 0 where none is
    real(wp), intent(out) :: alert !! [m]
    logical, intent(out) :: is_apart
    real(wp) :: offset(3), x, y, z, square, limit

    is_apart = .false.
    alert = pairs%alert(pairs%see(p))
    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), contactors => scene%contactors)
      if (.not. is_bounding(contactors%kind(a))) then
        offset = offset_of(scene, pairs, p)
        x = contactors%centre(1, c) - contactors%centre(1, a) - offset(1)
        y = contactors%centre(2, c) - contactors%centre(2, a) - offset(2)
        z = 0
        if (scene%dimension == 3) z = contactors%centre(3, c) - contactors%centre(3, a) - offset(3)
        square = x**2 + y**2 + z**2
        limit = contactors%reach(c) + contactors%reach(a)
        if (n_kept > 0) limit = limit + kept_length(scene, c, a)
        is_apart = square > (limit + alert)**2
      end if
      if (is_apart .or. .not. pairs%is_reduced) return
      alert = alert_of_pair(pairs, p)
      if (.not. is_bounding(contactors%kind(a))) is_apart = square > (limit + alert)**2
    end associate
  end subroutine look_at_spheres
end module sg_detect
