!> Detection: from the configuration of a step to its contacts, with the impulses of the last step as a guess.
module sg_detect
  use sg_add_contacts, only: add_contacts, add_kept, is_slow, keep_pair, kept_length, law_of, offset_of
  use sg_contactors, only: kind_polygon, kind_polyhedron, kind_sphere, place_contactors, contactors_t
  use sg_contacts, only: contacts_t, drop_contacts, grow_contacts
  use sg_follow, only: follows
  use sg_history, only: exchange_kept, fold_images, history_t, keep_contacts, keep_faces, keep_pairs, match_pairs, &
                        unwrap_images
  use sg_internal_values, only: n_internal_of
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: law_bond, status_broken
  use sg_link_laws, only: holds_across, is_torn, pulls_only
  use sg_neighbours, only: build_neighbours, fitting_skin, neighbours_are_stale, neighbours_t
  use sg_path_bound, only: is_clear
  use sg_scene, only: scene_t
  use sg_sees, only: alert_of, reduced_alert
  use sg_shape_kinds, only: is_bounding
  use sg_shrink_face, only: shrink_face
  use sg_timers, only: wall_now
  use sg_touch, only: touch_t
  use sg_touch_link, only: touch_link
  use sg_touch_pair, only: touch_pair
  use sg_touch_space, only: touch_space_t
  use sg_touch_space_pair, only: touch_space_pair
  use sg_touch_sphere_sphere, only: touch_sphere_sphere
  implicit none
  private
  public :: detect, turn_link

contains

  !> Find the contacts of a step in the configuration `bodies%middle`.
  subroutine detect(scene, pairs, history, contacts)
    type(scene_t), intent(inout) :: scene !! scene; bodies that left the period come back into it
    type(neighbours_t), intent(inout) :: pairs !! pairs that may touch, rebuilt when stale
    type(history_t), intent(inout) :: history !! contacts of the last detection
    type(contacts_t), intent(inout) :: contacts !! contacts of the last step, replaced by those of this one; none where memory or
    !! time ran short, as `pairs` and `contacts` report
    real(wp) :: skin
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
      pairs%listed_way = 2*pairs%way
      folds = scene%cell%folds
      call build_neighbours(pairs, scene, scene%bodies%middle, skin)
      call fold_images(history, scene%cell%folds - folds)
      call match_pairs(history, scene, pairs)
    else if (history%is_loaded) then
      call unwrap_images(history, scene)
      call match_pairs(history, scene, pairs)
    end if
    call place_contactors(scene%contactors, scene%bodies%middle)
    if (.not. allocated(pairs%alert)) allocate (pairs%alert(size(scene%sees)))
    if (pairs%is_reduced) then
      pairs%alert(:) = reduced_alert(scene%sees, pairs%way)
    else
      pairs%alert(:) = alert_of(scene%sees, pairs%way)
    end if
    if (scene%cell%is_on) contacts%upwards = scene%cell%middle([4, 2])
    call touch_all(scene, pairs, history, contacts)
    history%is_loaded = .false.
    history%is_start = .false.
    history%is_untouched = history%is_untouched .and. contacts%n == 0
  end subroutine detect

  !> Narrow phase over all pairs.
  subroutine touch_all(scene, pairs, history, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(inout) :: pairs
    type(history_t), intent(inout) :: history
    type(contacts_t), intent(inout) :: contacts
    integer(i4), allocatable :: first(:)
    integer :: p

    ! About half of the neighbours touch; more room is made when it is wanted.
    contacts%is_cut = .false.
    call grow_contacts(contacts, max(contacts%n, pairs%n/2, 1))
    if (contacts%is_cut) call grow_contacts(contacts, max(contacts%n, 1))
    contacts%n = 0
    allocate (first(pairs%n + 1))
    if (sum(scene%contactors%n_rows([kind_polygon, kind_polyhedron])) > 0) &
      call keep_faces(history, pairs%n_near, scene%dimension - 1)
    do p = 1, pairs%n_near
      if (ends_early(pairs, contacts, p)) exit
      first(p) = int(contacts%n, i4) + 1
      ! Most pairs end here.
      if (are_apart(scene, pairs, p, contacts%n_kept)) cycle
      call touch_near(scene, pairs, history, p, contacts)
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
    integer, parameter :: pairs_per_look = 1024

    if (pairs%deadline > 0 .and. modulo(p, pairs_per_look) == 0) pairs%is_late = wall_now() > pairs%deadline
    ends_early = contacts%is_cut .or. pairs%is_late
  end function ends_early

  !> Contacts of a pair whose circles or spheres are near: none, kept ones, or those that the narrow phase finds.
  subroutine touch_near(scene, pairs, history, p, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(inout) :: history
    integer, intent(in) :: p
    type(contacts_t), intent(inout) :: contacts
    real(wp) :: alert, path
    integer :: n
    logical :: keeps, is_kept

    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), contactors => scene%contactors)
      alert = alert_between(scene, pairs, p, contacts%n_kept)
      path = 0
      if (contactors%kind(c) == contactors%kind(a) .and. follows(contactors%kind(c))) then
        path = path_of(contactors, c) + path_of(contactors, a)
        if (is_clear(history%clearance(p), path, alert) .and. .not. scene%cell%is_on) return
      end if
      keeps = contacts%n_kept > 0 .and. follows(contactors%kind(c))
      if (keeps) then
        call add_kept(scene, pairs, history, p, contacts, is_kept)
        if (is_kept) return
      end if
      n = contacts%n
      if (scene%dimension == 2) then
        call find_in_plane(scene, pairs, history, p, alert, path, contacts)
      else
        call find_in_space(scene, pairs, history, p, alert, path, contacts)
      end if
      if (.not. keeps .or. contacts%n == n) return
      if (is_slow(scene, c, a, pairs%substeps)) call keep_pair(scene, pairs, p, contacts%n - n, contacts)
    end associate
  end subroutine touch_near

  !> Gap from which nothing is found between two shapes [m].
  pure real(wp) function alert_between(scene, pairs, p, n_kept) result(alert)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    integer, intent(in) :: p
    integer, intent(in) :: n_kept !! values of a contact that is kept; 0 where none is

    alert = pairs%alert(pairs%see(p))
    if (n_kept > 0) alert = alert + kept_length(scene, pairs%contactor(1, p), pairs%contactor(2, p))
  end function alert_between

  !> Length of the path of a polygon or polyhedron so far [m].
  pure real(wp) function path_of(contactors, c) result(path)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: c

    if (contactors%kind(c) == kind_polygon) then
      path = contactors%polygon_path(contactors%row(c))
    else
      path = contactors%space%polyhedron_path(contactors%row(c))
    end if
  end function path_of

  !> Narrow phase of one pair in the plane.
  subroutine find_in_plane(scene, pairs, history, p, alert, path, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(inout) :: history
    integer, intent(in) :: p
    real(wp), intent(in) :: alert !! gap from which nothing is found [m]
    real(wp), intent(in) :: path !! path lengths of two polygons, added [m]
    type(contacts_t), intent(inout) :: contacts
    type(touch_t) :: touch
    real(wp) :: shift(2), offset(3)

    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), contactors => scene%contactors)
      offset = offset_of(scene, pairs, p)
      shift = offset(:2)
      if (contactors%kind(c) == kind_polygon .and. contactors%kind(a) == kind_polygon) then
        call touch_pair(contactors, c, a, shift, alert, touch, scene%period, history%face(1, p), history%clearance(p))
        history%clearance(p) = history%clearance(p) + path
      else if (contactors%kind(c) == kind_polygon) then
        call touch_pair(contactors, c, a, shift, alert, touch, scene%period, history%face(1, p))
      else
        call touch_pair(contactors, c, a, shift, alert, touch, scene%period)
      end if
      if (scene%shrink > 0) then
        if (all(scene%contactors%kind([c, a]) == kind_polygon)) &
          call shrink_face(touch%n, touch%normal, touch%point, touch%gap, scene%shrink)
      end if
    end associate
    if (touch%n > 0) call add_contacts(scene, pairs, history, p, law_of(scene, pairs, p), touch%n, touch%normal, touch%point, &
                                       touch%gap, touch%feature, contacts)
  end subroutine find_in_plane

  !> Narrow phase of one pair in space.
  subroutine find_in_space(scene, pairs, history, p, alert, path, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(inout) :: history
    integer, intent(in) :: p
    real(wp), intent(in) :: alert !! gap from which nothing is found [m]
    real(wp), intent(in) :: path !! path lengths of two polyhedra, added [m]
    type(contacts_t), intent(inout) :: contacts
    type(touch_space_t) :: touch
    real(wp) :: offset(3), place(3)

    offset = offset_of(scene, pairs, p)
    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), contactors => scene%contactors)
      if (contactors%kind(c) == kind_sphere .and. contactors%kind(a) == kind_sphere) then
        ! One by one: of a number that is not known the compiler makes a loop, which waits for what has just been stored.
        place(1) = contactors%centre(1, a) + offset(1)
        place(2) = contactors%centre(2, a) + offset(2)
        place(3) = contactors%centre(3, a) + offset(3)
        call touch_sphere_sphere(contactors%centre(:, c), contactors%reach(c), place, contactors%reach(a), alert, touch)
      else if (contactors%kind(c) == kind_polyhedron .and. contactors%kind(a) == kind_polyhedron) then
        call touch_space_pair(contactors, c, a, offset, alert, [scene%period, scene%period_y], touch, history%face(:, p), &
                              history%clearance(p))
        history%clearance(p) = history%clearance(p) + path
        if (scene%shrink > 0) call shrink_face(touch%n, touch%normal, touch%point, touch%gap, scene%shrink)
      else
        call touch_space_pair(contactors, c, a, offset, alert, [scene%period, scene%period_y], touch)
      end if
    end associate
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

  !> Are the circles or spheres about two shapes farther apart than the alert distance? A square decides.
  pure logical function are_apart(scene, pairs, p, n_kept) result(apart)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    integer, intent(in) :: p
    integer, intent(in) :: n_kept !! values of a contact that is kept; 0 where none is
    real(wp) :: offset(3), x, y, z, limit

    apart = .false.
    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), contactors => scene%contactors)
      if (is_bounding(contactors%kind(a))) return
      offset = offset_of(scene, pairs, p)
      x = contactors%centre(1, c) - contactors%centre(1, a) - offset(1)
      y = contactors%centre(2, c) - contactors%centre(2, a) - offset(2)
      z = 0
      if (scene%dimension == 3) z = contactors%centre(3, c) - contactors%centre(3, a) - offset(3)
      limit = contactors%reach(c) + contactors%reach(a) + alert_between(scene, pairs, p, n_kept)
      apart = x**2 + y**2 + z**2 > limit**2
    end associate
  end function are_apart
end module sg_detect
