!> Detection: from the configuration of a step to its contacts, with the impulses of the last step as a guess.
module sg_detect
  use sg_contactors, only: contactors_t, kind_polygon, kind_polyhedron, kind_sphere, place_contactors
  use sg_contacts, only: contacts_t, drop_contacts, grow_contacts
  use sg_follow, only: follows
  use sg_hand_over, only: hand_over
  use sg_history, only: carried_of, exchange_kept, history_t, keep_contacts, keep_faces, keep_pairs, match_pairs, &
                        past_contacts, past_pair, recall, unwrap_images
  use sg_internal_values, only: first_internal, keeps_gap, n_internal_of, not_recorded
  use sg_kept_contacts, only: has_moved_in_plane, has_moved_in_space, keep_in_plane, keep_in_space, move_in_plane, move_in_space, &
                              n_pose_in_plane, n_pose_in_space, pose_in_plane, pose_in_space
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: is_cohesive_zone, law_bond, law_mohr, status_bonded, status_broken, status_new
  use sg_link_laws, only: holds_across, is_torn, pulls_only
  use sg_neighbours, only: build_neighbours, fitting_skin, neighbours_are_stale, neighbours_t
  use sg_rotations, only: no_rotation
  use sg_scene, only: scene_t
  use sg_shape_kinds, only: is_bounding
  use sg_shrink_face, only: shrink_face
  use sg_timers, only: wall_now
  use sg_touch, only: touch_t
  use sg_touch_link, only: touch_link
  use sg_touch_pair, only: touch_pair
  use sg_touch_space, only: most_points, touch_space_t
  use sg_touch_space_pair, only: touch_space_pair
  use sg_touch_sphere_sphere, only: touch_sphere_sphere
  use sg_path_bound, only: is_clear
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
      call build_neighbours(pairs, scene, scene%bodies%middle, skin)
      call match_pairs(history, scene, pairs)
    else if (history%is_loaded) then
      call unwrap_images(history, scene)
      call match_pairs(history, scene, pairs)
    end if
    call place_contactors(scene%contactors, scene%bodies%middle)
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
    if (scene%dimension == 2) then
      do p = 1, pairs%n_near
        if (ends_early(pairs, contacts, p)) exit
        first(p) = int(contacts%n, i4) + 1
        call touch_in_plane(scene, pairs, history, p, contacts)
      end do
    else
      do p = 1, pairs%n_near
        if (ends_early(pairs, contacts, p)) exit
        first(p) = int(contacts%n, i4) + 1
        call touch_in_space(scene, pairs, history, p, contacts)
      end do
    end if
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

  !> Narrow phase of one pair in the plane.
  subroutine touch_in_plane(scene, pairs, history, p, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(inout) :: history
    integer, intent(in) :: p
    type(contacts_t), intent(inout) :: contacts
    type(touch_t) :: touch
    real(wp) :: path, alert, pose(n_pose_in_plane)
    logical :: keeps

    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), offset => scene%period*real(pairs%image(p), wp), &
               contactors => scene%contactors)
      keeps = contacts%n_kept > 0 .and. follows(contactors%kind(c))
      alert = scene%sees(pairs%see(p))%alert
      if (keeps) alert = alert + kept_length(scene, c, a)
      if (circles_are_apart(scene, c, a, pairs%image(p), alert)) return
      if (contactors%kind(c) == kind_polygon .and. contactors%kind(a) == kind_polygon) then
        path = contactors%polygon_path(contactors%row(c)) + contactors%polygon_path(contactors%row(a))
        if (is_clear(history%clearance(p), path, alert)) return
      end if
      if (keeps) then
        pose = pose_in_plane(contactors, c, a, offset)
        if (is_kept(scene, history, p, c, a, pose, contacts%n_kept)) then
          call add_kept(scene, pairs, history, p, pose, contacts)
          return
        end if
      end if
      if (contactors%kind(c) == kind_polygon .and. contactors%kind(a) == kind_polygon) then
        call touch_pair(contactors, c, a, offset, alert, touch, scene%period, history%face(1, p), history%clearance(p))
        history%clearance(p) = history%clearance(p) + path
      else if (contactors%kind(c) == kind_polygon) then
        call touch_pair(contactors, c, a, offset, alert, touch, scene%period, history%face(1, p))
      else
        call touch_pair(contactors, c, a, offset, alert, touch, scene%period)
      end if
      if (scene%shrink > 0) then
        if (all(scene%contactors%kind([c, a]) == kind_polygon)) &
          call shrink_face(touch%n, touch%normal, touch%point, touch%gap, scene%shrink)
      end if
    end associate
    if (touch%n == 0) return
    call add_contacts(scene, pairs, history, p, law_of(scene, pairs, p), touch%n, touch%normal, touch%point, touch%gap, &
                      touch%feature, contacts)
    if (keeps) call keep_pair(scene, pairs, p, pose, touch%n, contacts)
  end subroutine touch_in_plane

  !> Narrow phase of one pair in space.
  subroutine touch_in_space(scene, pairs, history, p, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(inout) :: history
    integer, intent(in) :: p
    type(contacts_t), intent(inout) :: contacts
    type(touch_space_t) :: touch
    real(wp) :: offset(3), path, alert, pose(n_pose_in_space)
    logical :: keeps

    ! Most pairs end right below: a function for these numbers costs a twentieth of the detection of spheres.
    offset = [scene%period*real(pairs%image(p), wp), scene%period_y*real(pairs%image_y(p), wp), 0.0_wp]
    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), contactors => scene%contactors)
      keeps = contacts%n_kept > 0 .and. follows(contactors%kind(c))
      alert = scene%sees(pairs%see(p))%alert
      if (keeps) alert = alert + kept_length(scene, c, a)
      if (spheres_are_apart(contactors, c, a, offset, alert)) return
      if (contactors%kind(c) == kind_polyhedron .and. contactors%kind(a) == kind_polyhedron) then
        path = contactors%space%polyhedron_path(contactors%row(c)) + contactors%space%polyhedron_path(contactors%row(a))
        if (is_clear(history%clearance(p), path, alert)) return
      end if
      if (keeps) then
        pose = pose_in_space(contactors, turn_of(scene, c), turn_of(scene, a), c, a, offset)
        if (is_kept(scene, history, p, c, a, pose, contacts%n_kept)) then
          call add_kept(scene, pairs, history, p, pose, contacts)
          return
        end if
      end if
      if (contactors%kind(c) == kind_sphere .and. contactors%kind(a) == kind_sphere) then
        call touch_sphere_sphere(contactors%centre(:, c), contactors%reach(c), contactors%centre(:, a) + offset, &
                                 contactors%reach(a), alert, touch)
      else if (contactors%kind(c) == kind_polyhedron .and. contactors%kind(a) == kind_polyhedron) then
        call touch_space_pair(contactors, c, a, offset, alert, [scene%period, scene%period_y], touch, history%face(:, p), &
                              history%clearance(p))
        history%clearance(p) = history%clearance(p) + path
        if (scene%shrink > 0) call shrink_face(touch%n, touch%normal, touch%point, touch%gap, scene%shrink)
      else
        call touch_space_pair(contactors, c, a, offset, alert, [scene%period, scene%period_y], touch)
      end if
    end associate
    if (touch%n == 0) return
    call add_contacts(scene, pairs, history, p, law_of(scene, pairs, p), touch%n, touch%normal, touch%point, touch%gap, &
                      touch%feature, contacts)
    if (keeps) call keep_pair(scene, pairs, p, pose, touch%n, contacts)
  end subroutine touch_in_space

  !> Motion of two shapes against each other up to which their contacts are kept [m].
  pure real(wp) function kept_length(scene, c, a)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: c, a

    kept_length = scene%kept_motion*min(scene%contactors%reach(c), scene%contactors%reach(a))
  end function kept_length

  !> Orientation of the body that carries a contactor of space.
  pure function turn_of(scene, c) result(turn)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: c
    real(wp) :: turn(4)

    turn = no_rotation
    if (size(scene%bodies%middle, 1) == 7) turn = scene%bodies%middle(4:7, scene%contactors%body(c))
  end function turn_of

  !> Has a pair contacts, and has it hardly moved since they were found?
  pure logical function is_kept(scene, history, p, c, a, pose, n_kept)
    type(scene_t), intent(in) :: scene
    type(history_t), intent(in) :: history
    integer, intent(in) :: p, n_kept
    integer(i4), intent(in) :: c, a
    real(wp), intent(in) :: pose(:)
    integer :: ends(2)

    is_kept = .false.
    if (.not. allocated(history%kept) .or. history%by_point) return
    ends = past_contacts(history, p)
    if (ends(2) < ends(1) .or. size(history%kept, 1) /= n_kept) return
    associate (kept => history%kept(:, ends(1)))
      if (.not. kept(1) > 0) return
      if (scene%dimension == 2) then
        is_kept = .not. has_moved_in_plane(kept, pose, scene%contactors%reach(c), kept_length(scene, c, a))
      else
        is_kept = .not. has_moved_in_space(kept, pose, scene%contactors%reach(c), kept_length(scene, c, a))
      end if
    end associate
  end function is_kept

  !> Add the contacts that a pair had in the last detection, where its shapes are now.
  subroutine add_kept(scene, pairs, history, p, pose, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(in) :: history
    integer, intent(in) :: p
    real(wp), intent(in) :: pose(:)
    type(contacts_t), intent(inout) :: contacts
    real(wp) :: offset(3), normal(scene%dimension), point(scene%dimension), gap
    integer :: past, ends(2)

    ends = past_contacts(history, p)
    if (contacts%n + ends(2) - ends(1) + 1 > size(contacts%gap)) then
      call grow_contacts(contacts, contacts%n + ends(2) - ends(1) + 1)
      if (contacts%is_cut) return
    end if
    offset = offset_of(scene, pairs, p)
    associate (a => pairs%contactor(2, p))
      do past = ends(1), ends(2)
        if (scene%dimension == 2) then
          call move_in_plane(scene%contactors, a, offset(1), history%kept(:, past), pose, normal, point, gap)
        else
          call move_in_space(scene%contactors, a, offset, turn_of(scene, a), history%kept(:, past), pose, normal, point, gap)
        end if
        call add_contact(scene, pairs, history, p, past, law_of(scene, pairs, p), normal, point, gap, history%feature(past), &
                         contacts)
        contacts%kept(:, contacts%n) = history%kept(:, past)
      end do
    end associate
  end subroutine add_kept

  !> Keep the contacts of a pair that have just been found: the last ones.
  subroutine keep_pair(scene, pairs, p, pose, n, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    integer, intent(in) :: p, n
    real(wp), intent(in) :: pose(:)
    type(contacts_t), intent(inout) :: contacts
    real(wp) :: offset(3)
    integer :: k

    if (contacts%is_cut) return
    offset = offset_of(scene, pairs, p)
    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p))
      do k = contacts%n - n + 1, contacts%n
        if (scene%dimension == 2) then
          call keep_in_plane(scene%contactors, c, a, offset(1), pose, contacts%normal(:, k), contacts%point(:, k), &
                             contacts%gap(k), contacts%kept(:, k))
        else
          call keep_in_space(scene%contactors, c, a, offset, turn_of(scene, a), pose, contacts%normal(:, k), &
                             contacts%point(:, k), contacts%gap(k), contacts%kept(:, k))
        end if
      end do
    end associate
  end subroutine keep_pair

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

  !> Are the circles about two shapes farther apart than the alert distance? Most neighbours' are; a square decides.
  pure logical function circles_are_apart(scene, c, a, image, alert) result(apart)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: c, a
    integer(i1), intent(in) :: image
    real(wp), intent(in) :: alert
    real(wp) :: x, y, limit

    apart = .false.
    associate (contactors => scene%contactors)
      if (is_bounding(contactors%kind(a))) return
      x = contactors%centre(1, c) - contactors%centre(1, a) - scene%period*real(image, wp)
      y = contactors%centre(2, c) - contactors%centre(2, a)
      limit = contactors%reach(c) + contactors%reach(a) + alert
      apart = x**2 + y**2 > limit**2
    end associate
  end function circles_are_apart

  !> Are the spheres about two shapes farther apart than the alert distance? Most neighbours' are; a square decides.
  pure logical function spheres_are_apart(contactors, c, a, offset, alert) result(apart)
    type(contactors_t), intent(in) :: contactors
    integer(i4), intent(in) :: c
    integer(i4), intent(in) :: a
    real(wp), intent(in) :: offset(3)
    real(wp), intent(in) :: alert
    real(wp) :: between(3), limit

    apart = .false.
    if (is_bounding(contactors%kind(a))) return
    between = contactors%centre(:, c) - contactors%centre(:, a) - offset
    limit = contactors%reach(c) + contactors%reach(a) + alert
    apart = between(1)**2 + between(2)**2 + between(3)**2 > limit**2
  end function spheres_are_apart

  !> Shift of the antagonist of a pair [m].
  pure function offset_of(scene, pairs, p) result(offset)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    integer, intent(in) :: p
    real(wp) :: offset(3)

    offset = [scene%period*real(pairs%image(p), wp), 0.0_wp, 0.0_wp]
    if (scene%dimension == 3) offset(2) = scene%period_y*real(pairs%image_y(p), wp)
  end function offset_of

  !> Law of a pair that is no link.
  pure integer(i4) function law_of(scene, pairs, p)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    integer, intent(in) :: p

    law_of = int(scene%sees(pairs%see(p))%law, i4)
  end function law_of

  !> Add the points of contact of a pair, each with what its past carries.
  subroutine add_contacts(scene, pairs, history, p, law, n, normal, point, gap, feature, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(in) :: history
    integer, intent(in) :: p
    integer(i4), intent(in) :: law
    integer, intent(in) :: n !! points
    real(wp), intent(in) :: normal(scene%dimension, n), point(scene%dimension, n), gap(n)
    integer(i4), intent(in) :: feature(n)
    type(contacts_t), intent(inout) :: contacts
    integer :: i, past(most_points)

    if (contacts%n + n > size(contacts%gap)) then
      call grow_contacts(contacts, contacts%n + n)
      if (contacts%is_cut) return
    end if
    do i = 1, n
      past(i) = recall(history, p, feature(i), point(:, i))
    end do
    if (any(past(:n) == 0)) call take_over(scene, pairs, history, p, point, past(:n))
    do i = 1, n
      call add_contact(scene, pairs, history, p, past(i), law, normal(:, i), point(:, i), gap(i), feature(i), contacts)
    end do
  end subroutine add_contacts

  !> Let points whose features have no past take over the remaining history of the pair.
  pure subroutine take_over(scene, pairs, history, p, point, past)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(in) :: history
    integer, intent(in) :: p
    real(wp), intent(in) :: point(:, :)
    integer, intent(inout) :: past(:)
    real(wp) :: offset(3)
    integer :: before, first, last

    before = past_pair(history, p)
    if (before == 0 .or. history%by_point) return
    first = history%first(before)
    last = history%first(before + 1) - 1
    if (last < first) return
    offset = offset_of(scene, pairs, p)
    call hand_over(scene%contactors, pairs%contactor(1, p), pairs%contactor(2, p), offset(:scene%dimension), &
                   history%feature(first:last), point, first, past)
  end subroutine take_over

  !> Add one point of contact, with the impulse of its past.
  subroutine add_contact(scene, pairs, history, p, past, law, normal, point, gap, feature, contacts)
    type(scene_t), intent(in) :: scene
    type(neighbours_t), intent(in) :: pairs
    type(history_t), intent(in) :: history
    integer, intent(in) :: p, past
    integer(i4), intent(in) :: law
    real(wp), intent(in) :: normal(scene%dimension), point(scene%dimension), gap
    integer(i4), intent(in) :: feature
    type(contacts_t), intent(inout) :: contacts
    integer :: k

    k = contacts%n + 1
    contacts%n = k
    contacts%contactor(1, k) = pairs%contactor(1, p)
    contacts%contactor(2, k) = pairs%contactor(2, p)
    contacts%body(1, k) = scene%contactors%body(pairs%contactor(1, p))
    contacts%body(2, k) = scene%contactors%body(pairs%contactor(2, p))
    contacts%image(k) = pairs%image(p)
    if (scene%dimension == 3) contacts%image_y(k) = pairs%image_y(p)
    contacts%law(k) = law
    contacts%feature(k) = feature
    ! Component by component: of a number that is not known the compiler calls a procedure to copy them.
    contacts%normal(1:2, k) = normal(1:2)
    contacts%point(1:2, k) = point(1:2)
    if (scene%dimension == 3) then
      contacts%normal(3, k) = normal(3)
      contacts%point(3, k) = point(3)
    end if
    contacts%gap(k) = gap
    if (past > 0) then
      contacts%impulse(:, k) = history%impulse(:, past)
      contacts%status(k) = history%status(past)
    else
      contacts%impulse(:, k) = 0
      contacts%status(k) = status_new
    end if
    if (history%is_start) contacts%status(k) = status_at_start(scene, contacts%law(k), contacts%status(k))
    if (contacts%n_internal > 0) call recall_internal(scene, history, past, k, contacts)
    if (contacts%n_carried > 0) contacts%carried(:, k) = carried_of(history, past, contacts%n_carried)
    if (contacts%n_kept > 0) contacts%kept(:, k) = 0
  end subroutine add_contact

  !> Internal values of a contact from its past. A contact whose values no file holds takes those that its law gives to contacts
  !! that are there from the start: in the very first step, or, where a gap is what it keeps, in the first step that has contacts.
  !! Later ones begin at zero.
  subroutine recall_internal(scene, history, past, k, contacts)
    type(scene_t), intent(in) :: scene
    type(history_t), intent(in) :: history
    integer, intent(in) :: past, k
    type(contacts_t), intent(inout) :: contacts
    logical :: is_first

    contacts%internal(:, k) = 0
    if (past > 0) contacts%internal(:, k) = history%internal(:, past)
    is_first = past == 0 .and. merge(history%is_untouched, history%is_start, keeps_gap(scene%laws(contacts%law(k))))
    if (past > 0) is_first = .not. contacts%internal(1, k) > not_recorded
    if (is_first) contacts%internal(:, k) = first_internal(scene%laws(contacts%law(k)), contacts%gap(k), scene%dimension, &
                                                           contacts%n_internal)
  end subroutine recall_internal

  !> What a contact of the very first step is taken to have done before: Mohr-Coulomb contacts and cohesive zones start bonded.
  pure integer(i1) function status_at_start(scene, law, status)
    type(scene_t), intent(in) :: scene
    integer(i4), intent(in) :: law
    integer(i1), intent(in) :: status

    status_at_start = status
    if (status /= status_new) return
    if (scene%laws(law)%kind == law_mohr .or. is_cohesive_zone(scene%laws(law))) status_at_start = status_bonded
  end function status_at_start
end module sg_detect
