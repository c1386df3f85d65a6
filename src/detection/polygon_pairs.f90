!> Narrow phase of polygons that move, in a loop over plain arrays: nearly all pairs where many grains flow.
!!
!! Contacts are those of the general way, which asks scene, list and history for each pair (sg_touch_run). Pairs whose contacts may
!! be kept go that way, and those whose points have changed their names.
module sg_polygon_pairs
  use sg_add_contacts, only: keep_pair
  use sg_contactors, only: kind_polygon
  use sg_contacts, only: contacts_t
  use sg_follow_pairs, only: have_plain_past
  use sg_history, only: history_t
  use sg_kept_contacts, only: n_kept_in_plane
  use sg_kinds, only: wp, i1, i4
  use sg_neighbour_list, only: neighbours_t
  use sg_pair_alert, only: alert_of_pair
  use sg_path_bound, only: is_clear
  use sg_plain_past, only: find_named, find_past, put_names, recall_impulse
  use sg_scene, only: scene_t
  use sg_touch, only: touch_t
  use sg_touch_polygon_polygon, only: touch_polygon_polygon
  implicit none
  private
  public :: are_plain_polygons, touch_polygons

  !> Pairs of a run whose contacts are kept, at most
  integer, parameter :: most_slow = 64

contains

  !> Do pairs of polygons go through `touch_polygons`, once the corners of all are placed?
  pure logical function are_plain_polygons(scene, history, contacts)
    type(scene_t), intent(in) :: scene !! scene
    type(history_t), intent(in) :: history !! contacts of the last detection
    type(contacts_t), intent(in) :: contacts !! contacts of the step so far

    are_plain_polygons = have_plain_past(scene, history, contacts) .and. .not. (scene%shrink > 0 .or. history%is_start)
  end function are_plain_polygons

  !> Add the contacts of pairs of polygons, from pair to pair until one comes that goes the general way.
  subroutine touch_polygons(scene, pairs, history, near, law_of, last, contacts, first, p)
    type(scene_t), intent(in) :: scene !! scene, its contactors and all corners placed
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    type(history_t), intent(inout) :: history !! contacts of the last detection; faces and clearances of the pairs are set
    real(wp), intent(in), contiguous :: near(:) !! alert distance of each line of the see tables [m]
    integer, intent(in), contiguous :: law_of(:) !! law of each line
    integer, intent(in) :: last !! last pair of the run
    type(contacts_t), intent(inout) :: contacts !! contacts of the step so far
    integer(i4), intent(inout) :: first(:) !! first contact of each pair
    integer, intent(inout) :: p !! first pair of the run; then the first that goes the general way or has no room for its contacts,
    !! or the one after the last
    integer :: slow(3, most_slow), n_slow, i
    real(wp) :: alert(most_slow)

    n_slow = 0
    associate (shapes => scene%contactors, bodies => scene%bodies)
      call go_on(last, scene%period, scene%kept_motion, pairs, near, law_of, pairs%contactor, pairs%see, pairs%image, &
                 history%face, history%clearance, history%is_matched, history%past, history%first, history%kept, &
                 history%feature, history%impulse, history%status, shapes%kind, shapes%row, shapes%body, shapes%reach, &
                 shapes%centre, shapes%polygon_path, shapes%polygon_first, shapes%polygon_world, shapes%polygon_edge, &
                 bodies%position, bodies%middle, contacts%n_components, size(contacts%gap), contacts%contactor, contacts%body, &
                 contacts%image, contacts%law, contacts%feature, contacts%normal, contacts%point, contacts%gap, &
                 contacts%impulse, contacts%status, contacts%kept, contacts%n, first, p, slow, alert, n_slow)
    end associate
    do i = 1, n_slow
      call keep_pair(scene, pairs, slow(1, i), alert(i), slow(2, i), slow(3, i), contacts)
    end do
  end subroutine touch_polygons

  !> The same on plain arrays. Pairs that are slow enough for their contacts to be kept are listed, with these.
  pure subroutine go_on(last, period, kept_motion, pairs, near, law_of, pair, see, image, face, clearance, is_matched, past, &
                        first_before, kept_before, feature_before, impulse_before, status_before, kind, row, body_of, reach, &
                        centre, path_of, vertex, world, edge, position, middle, n_components, room, contactor, body, image_of, &
                        law, feature, normal, point, gap, impulse, status, kept, n, first, p, slow, slow_alert, n_slow)
    integer, intent(in) :: last, law_of(*), n_components, room
    type(neighbours_t), intent(in) :: pairs
    real(wp), intent(in) :: period, kept_motion, near(*)
    logical, intent(in) :: is_matched
    integer(i4), intent(in) :: pair(2, *), see(*), past(*), first_before(*), feature_before(*)
    integer(i4), intent(in) :: kind(*), row(*), body_of(*), vertex(*)
    integer(i1), intent(in) :: image(*), status_before(*)
    real(wp), intent(in) :: kept_before(n_kept_in_plane, *), impulse_before(n_components, *), reach(*), centre(2, *), path_of(*)
    real(wp), intent(in) :: world(2, *), edge(3, *), position(2, *), middle(3, *)
    integer(i4), intent(inout) :: face(*), contactor(2, *), body(2, *), law(*), feature(*), first(*)
    integer(i1), intent(inout) :: image_of(*), status(*)
    real(wp), intent(inout) :: clearance(*), normal(2, *), point(2, *), gap(*), impulse(n_components, *), kept(n_kept_in_plane, *)
    integer, intent(inout) :: n, p, slow(3, *), n_slow
    real(wp), intent(inout) :: slow_alert(*)
    type(touch_t) :: touch
    real(wp) :: shift(2), x, y, square, length, alert, path
    integer :: before(2), from(2), i
    integer(i4) :: c, a

    shift = 0
    do p = p, last
      c = pair(1, p)
      a = pair(2, p)
      if (kind(c) /= kind_polygon .or. kind(a) /= kind_polygon .or. n + 2 > room .or. n_slow == most_slow) return
      shift(1) = period*real(image(p), wp)
      square = (centre(1, c) - centre(1, a) - shift(1))**2 + (centre(2, c) - centre(2, a))**2
      length = kept_motion*min(reach(c), reach(a))
      alert = near(see(p))
      first(p) = int(n, i4) + 1
      if (square > (reach(c) + reach(a) + length + alert)**2) cycle
      if (pairs%is_reduced .and. pairs%is_by_pair) then
        alert = alert_of_pair(pairs, p)
        if (square > (reach(c) + reach(a) + length + alert)**2) cycle
      end if
      path = path_of(row(c)) + path_of(row(a))
      if (is_clear(clearance(p), path, alert + length)) cycle
      call find_past(p, is_matched, past, first_before, from)
      if (from(1) <= from(2)) then
        if (kept_before(1, from(1)) > 0) return
      end if
      associate (own => vertex(row(c)), other => vertex(row(a)))
        call touch_polygon_polygon(int(vertex(row(c) + 1) - own), world(1, own), edge(1, own), int(vertex(row(a) + 1) - other), &
                                   world(1, other), edge(1, other), 2*max(reach(c), reach(a)), shift, alert + length, face(p), &
                                   touch, clearance(p))
      end associate
      clearance(p) = clearance(p) + path
      if (touch%n == 0) cycle
      do i = 1, touch%n
        before(i) = find_named(touch%feature(i), from, feature_before)
      end do
      if (from(1) <= from(2) .and. any(before(:touch%n) == 0)) return
      do i = 1, touch%n
        n = n + 1
        call put_names(c, a, body_of, contactor(:, n), body(:, n))
        image_of(n) = image(p)
        law(n) = int(law_of(see(p)), i4)
        feature(n) = touch%feature(i)
        normal(:, n) = touch%normal(:, i)
        point(:, n) = touch%point(:, i)
        gap(n) = touch%gap(i)
        kept(:, n) = 0
        call recall_impulse(before(i), n_components, impulse_before, status_before, impulse(:, n), status(n))
      end do
      ! From the position to the middle is half a substep.
      x = (middle(1, body_of(c)) - position(1, body_of(c))) - (middle(1, body_of(a)) - position(1, body_of(a)))
      y = (middle(2, body_of(c)) - position(2, body_of(c))) - (middle(2, body_of(a)) - position(2, body_of(a)))
      if (2*real(pairs%substeps, wp)*sqrt(x**2 + y**2) > length) cycle
      n_slow = n_slow + 1
      slow(:, n_slow) = [p, n - touch%n + 1, n]
      slow_alert(n_slow) = alert
    end do
  end subroutine go_on
end module sg_polygon_pairs
