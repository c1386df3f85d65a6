!> Narrow phase of polygons in a loop over plain arrays: nearly all pairs of a scene of polygons.
!!
!! What the general way asks of scene, list and history for each pair (sg_touch_run) is handed over once per run here. Contacts that
!! are kept follow their bodies (sg_kept_contacts), of other pairs that are near the points are measured, once corners are placed.
!! Contacts are those of the general way; pairs go that way whose points have changed their names.
module sg_polygon_pairs
  use sg_add_contacts, only: keep_pair
  use sg_contactors, only: kind_polygon
  use sg_contacts, only: contacts_t
  use sg_history, only: history_t
  use sg_kept_contacts, only: has_moved_in_plane, move_from, n_kept_in_plane, n_pose_in_plane, pose_between, shorter_reach, &
                              way_between
  use sg_kinds, only: wp, i1, i4
  use sg_neighbour_list, only: neighbours_t
  use sg_pair_alert, only: alert_between
  use sg_path_bound, only: is_clear
  use sg_plain_past, only: find_named, find_past, put_names, recall_impulse
  use sg_scene, only: scene_t
  use sg_touch, only: touch_t
  use sg_touch_polygon_polygon, only: touch_polygon_polygon
  implicit none
  private
  public :: are_mostly_kept, are_plain_polygons, most_points, touch_polygons

  !> Contacts of a pair of polygons, and pairs of a run whose contacts are going to be kept, at most
  integer, parameter :: most_points = 2, most_slow = 64

contains

  !> Do pairs of polygons go through `touch_polygons`? Their contacts have no more of a past than impulses and what detection keeps.
  !! Not in cells.
  pure logical function are_plain_polygons(scene, history, contacts) result(are_plain)
    type(scene_t), intent(in) :: scene !! scene
    type(history_t), intent(in) :: history !! contacts of the last detection
    type(contacts_t), intent(in) :: contacts !! contacts of the step so far

    are_plain = scene%dimension == 2 .and. .not. scene%cell%is_on .and. contacts%n_kept == n_kept_in_plane &
                .and. contacts%n_internal == 0 .and. contacts%n_carried == 0 .and. allocated(history%kept) &
                .and. history%n_pairs > 0 .and. .not. history%by_point
    if (are_plain) are_plain = size(history%kept, 1) == n_kept_in_plane .and. scene%contactors%n_rows(kind_polygon) > 0
  end function are_plain_polygons

  !> Are at least three of four contacts of the last detection kept? A sample is asked.
  pure logical function are_mostly_kept(history)
    type(history_t), intent(in) :: history !! contacts of the last detection, which may be kept
    integer, parameter :: every = 16
    integer :: n

    n = history%first(history%n_pairs + 1) - 1
    are_mostly_kept = n > 0 .and. 4*count(history%is_kept(1:n:every) > 0_i1) >= 3*((n + every - 1)/every)
  end function are_mostly_kept

  !> Add the contacts of pairs of polygons, from pair to pair until one comes that goes the general way.
  subroutine touch_polygons(scene, pairs, history, near, longest, law_of, measures, last, contacts, first, p, alert, is_near)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    type(history_t), intent(inout) :: history !! contacts of the last detection; faces and clearances of the pairs are set
    real(wp), intent(in), contiguous :: near(:) !! alert distance of each line of the see tables [m]
    real(wp), intent(in), contiguous :: longest(:) !! longest one of each line [m]
    integer, intent(in), contiguous :: law_of(:) !! law of each line
    logical, intent(in) :: measures !! are pairs measured whose contacts are not kept? Else they go the general way
    integer, intent(in) :: last !! last pair of the run
    type(contacts_t), intent(inout) :: contacts !! contacts of the step so far
    integer(i4), intent(inout) :: first(:) !! first contact of each pair
    integer, intent(inout) :: p !! first pair of the run; then the first that goes the general way or has no room for its contacts,
    !! or the one after the last
    real(wp), intent(out) :: alert !! alert distance of that pair, where it is near [m]
    logical, intent(out) :: is_near !! is it a pair of polygons that are near, and whose contacts are not kept?
    integer :: slow(3, most_slow), n_slow, i
    real(wp) :: slow_alert(most_slow)

    n_slow = 0
    alert = 0
    is_near = .false.
    associate (shapes => scene%contactors, bodies => scene%bodies)
      call go_on(last, scene%period, scene%kept_motion, pairs, near, longest, law_of, measures, pairs%contactor, pairs%see, &
                 pairs%image, history%face, history%clearance, history%is_matched, history%past, history%first, &
                 history%is_kept, history%kept, history%feature, history%impulse, history%status, shapes%kind, shapes%row, &
                 shapes%body, shapes%reach, shapes%centre, shapes%polygon_turn, shapes%polygon_path, shapes%polygon_first, &
                 shapes%polygon_world, shapes%polygon_edge, bodies%position, bodies%middle, contacts%n_components, &
                 size(contacts%gap), contacts%contactor, contacts%body, contacts%image, contacts%law, contacts%feature, &
                 contacts%normal, contacts%point, contacts%gap, contacts%impulse, contacts%status, contacts%is_kept, &
                 contacts%kept, contacts%n, first, p, alert, is_near, slow, slow_alert, n_slow)
    end associate
    do i = 1, n_slow
      call keep_pair(scene, pairs, history, slow(1, i), slow_alert(i), slow(2, i), slow(3, i), contacts)
    end do
  end subroutine touch_polygons

  !> The same on plain arrays. Pairs that are slow enough for their contacts to be kept are listed, with these.
  pure subroutine go_on(last, period, kept_motion, pairs, near, longest, law_of, measures, pair, see, image, face, clearance, &
                        is_matched, past, first_before, is_kept_before, kept_before, feature_before, impulse_before, &
                        status_before, kind, row, body_of, reach, centre, turn, path_of, vertex, world, edge, position, middle, &
                        n_components, room, contactor, body, image_of, law, feature, normal, point, gap, impulse, status, &
                        is_kept_now, kept, n, first, p, alert, is_near, slow, slow_alert, n_slow)
    type(neighbours_t), intent(in) :: pairs
    logical, intent(in) :: measures, is_matched
    integer, intent(in) :: last, law_of(*), n_components, room
    integer(i4), intent(in) :: pair(2, *), see(*), past(*), first_before(*), feature_before(*), kind(*), row(*), body_of(*), &
                               vertex(*)
    integer(i1), intent(in) :: image(*), status_before(*), is_kept_before(*)
    real(wp), intent(in) :: period, kept_motion, near(*), longest(*), kept_before(n_kept_in_plane, *), path_of(*), position(2, *)
    real(wp), intent(in) :: impulse_before(n_components, *), reach(*), centre(2, *), turn(2, *), world(2, *), edge(3, *), &
                            middle(3, *)
    integer(i4), intent(inout) :: face(*), contactor(2, *), body(2, *), law(*), feature(*), first(*)
    integer(i1), intent(inout) :: image_of(*), status(*), is_kept_now(*)
    real(wp), intent(inout) :: clearance(*), normal(2, *), point(2, *), gap(*), impulse(n_components, *), kept(n_kept_in_plane, *)
    integer, intent(inout) :: n, p, slow(3, *), n_slow
    real(wp), intent(inout) :: alert, slow_alert(*)
    logical, intent(inout) :: is_near
    type(touch_t) :: touch
    real(wp) :: shift(2), x, y, square, length, path, to
    integer :: before(most_points), from(2), i
    integer(i4) :: c, a
    logical :: is_kept

    shift = 0
    do p = p, last
      is_near = .false.
      c = pair(1, p)
      a = pair(2, p)
      if (kind(c) /= kind_polygon .or. kind(a) /= kind_polygon .or. n + most_points > room .or. n_slow == most_slow) return
      shift(1) = period*real(image(p), wp)
      x = centre(1, c) - centre(1, a) - shift(1)
      y = centre(2, c) - centre(2, a)
      square = x**2 + y**2
      length = kept_motion*min(reach(c), reach(a))
      alert = near(see(p))
      first(p) = int(n, i4) + 1
      if (square > (reach(c) + reach(a) + length + alert)**2) cycle
      if (pairs%is_reduced .and. pairs%is_by_pair) then
        alert = alert_between(c, a, 3, pairs%motion, pairs%least(see(p)), alert)
        if (square > (reach(c) + reach(a) + length + alert)**2) cycle
      end if
      path = path_of(row(c)) + path_of(row(a))
      if (is_clear(clearance(p), path, alert + length)) cycle
      call find_past(p, is_matched, past, first_before, from)
      call follow(from, is_kept_before, kept_before, feature_before, alert, longest(see(p)), length, reach(c), turn(1, row(c)), &
                  turn(1, row(a)), x, y, centre(1, a), shift, touch, before, to, is_kept)
      if (.not. is_kept) then
        is_near = .true.
        if (.not. measures) return
        associate (own => vertex(row(c)), other => vertex(row(a)))
          call touch_polygon_polygon(int(vertex(row(c) + 1) - own), world(1, own), edge(1, own), int(vertex(row(a) + 1) - other), &
                                     world(1, other), edge(1, other), 2*max(reach(c), reach(a)), shift, alert + length, face(p), &
                                     touch, clearance(p))
        end associate
        clearance(p) = clearance(p) + path
        do i = 1, touch%n
          before(i) = find_named(touch%feature(i), from, feature_before)
        end do
        if (from(1) <= from(2) .and. any(before(:touch%n) == 0)) return
      end if
      do i = 1, touch%n
        n = n + 1
        call put_names(c, a, body_of, image(p), law_of(see(p)), contactor(:, n), body(:, n), image_of(n), law(n))
        feature(n) = touch%feature(i)
        normal(:, n) = touch%normal(:, i)
        point(:, n) = touch%point(:, i)
        gap(n) = touch%gap(i)
        is_kept_now(n) = merge(1_i1, 0_i1, is_kept)
        if (is_kept) kept(:, n) = [kept_before(:n_kept_in_plane - 1, before(i)), to]
        call recall_impulse(before(i), n_components, impulse_before, status_before, impulse(:, n), status(n))
      end do
      if (is_kept .or. touch%n == 0 .or. way_between(2, 3, position, middle, body_of(c), body_of(a), pairs%substeps) > length) cycle
      n_slow = n_slow + 1
      slow(:, n_slow) = [p, n - touch%n + 1, n]
      slow_alert(n_slow) = alert
    end do
  end subroutine go_on

  !> Points of a pair that were kept, where its shapes are now; if they are kept as far as is looked, and it has hardly moved since.
  pure subroutine follow(from, is_kept_before, kept_before, feature_before, alert, longest, length, reach, own, other, x, y, &
                         centre, shift, touch, before, to, is_kept)
    integer, intent(in) :: from(2) !! contacts of the past of the pair (`find_past`)
    integer(i1), intent(in) :: is_kept_before(*) !! is something kept of contacts of the past?
    real(wp), intent(in) :: kept_before(n_kept_in_plane, *) !! what is kept of them
    integer(i4), intent(in) :: feature_before(*) !! their features
    real(wp), intent(in) :: alert, longest, length !! alert distance, longest one, and motion of kept contacts [m]
    real(wp), intent(in) :: reach, own(2), other(2) !! reach of the candidate [m]; cosine and sine of its turn and the antagonist's
    real(wp), intent(in) :: x, y !! way from the antagonist to the candidate [m]
    real(wp), intent(in) :: centre(2), shift(2) !! centre and shift of the antagonist [m]
    type(touch_t), intent(inout) :: touch !! the points, where they are kept
    integer, intent(inout) :: before(most_points) !! contact of the past of each
    real(wp), intent(out) :: to !! alert distance up to which they stay [m]
    logical, intent(out) :: is_kept
    real(wp) :: pose(n_pose_in_plane)
    integer :: k

    to = 0
    is_kept = .false.
    k = from(1)
    if (from(2) < k) return
    if (is_kept_before(k) == 0_i1) return
    if (alert > kept_before(n_kept_in_plane, k)) return
    call pose_between(own, other, x, y, pose)
    is_kept = .not. has_moved_in_plane(kept_before(:, k), pose, reach, length)
    if (.not. is_kept) return
    to = shorter_reach(kept_before(n_kept_in_plane, k), alert, longest)
    touch%n = 0
    do k = from(1), from(2)
      if (kept_before(n_kept_in_plane - 1, k) > to + length) cycle
      touch%n = touch%n + 1
      before(touch%n) = k
      touch%feature(touch%n) = feature_before(k)
      call move_from(other, centre, shift, kept_before(:, k), pose, touch%normal(:, touch%n), touch%point(:, touch%n), &
                     touch%gap(touch%n))
    end do
  end subroutine follow
end module sg_polygon_pairs
