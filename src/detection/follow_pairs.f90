!> Runs of pairs of polygons that need no narrow phase: those that are apart, and those whose contacts are kept and follow their
!! bodies (sg_kept_contacts).
!!
!! At rest nearly all pairs are of these. What the general way asks of scene, list and history for each pair is handed over once per
!! run here, as plain arrays.
module sg_follow_pairs
  use sg_contactors, only: kind_polygon
  use sg_contacts, only: contacts_t
  use sg_history, only: history_t
  use sg_kept_contacts, only: has_moved_in_plane, move_from, n_kept_in_plane, n_pose_in_plane, pose_between, shorter_reach
  use sg_kinds, only: wp, i1, i4
  use sg_neighbour_list, only: neighbours_t
  use sg_pair_alert, only: alert_of_pair
  use sg_path_bound, only: is_clear
  use sg_plain_past, only: put_names, recall_impulse
  use sg_scene, only: scene_t
  implicit none
  private
  public :: are_followed, follow_pairs, have_plain_past, most_followed

  !> Contacts of a pair of polygons, at most
  integer, parameter :: most_followed = 2

contains

  !> Do pairs of polygons go through `follow_pairs`? Where laws keep values of contacts, in cells, and where many pairs move and
  !! would leave the loop, all go the general way. A checkpoint holds what decides.
  pure logical function are_followed(scene, history, contacts)
    type(scene_t), intent(in) :: scene !! scene
    type(history_t), intent(in) :: history !! contacts of the last detection
    type(contacts_t), intent(in) :: contacts !! contacts of the step so far

    are_followed = have_plain_past(scene, history, contacts)
    if (are_followed) are_followed = are_mostly_kept(history%first(history%n_pairs + 1) - 1, history%kept)
  end function are_followed

  !> Have contacts of polygons no more of a past than impulses and what detection keeps? Not in cells.
  pure logical function have_plain_past(scene, history, contacts)
    type(scene_t), intent(in) :: scene !! scene
    type(history_t), intent(in) :: history !! contacts of the last detection
    type(contacts_t), intent(in) :: contacts !! contacts of the step so far

    have_plain_past = scene%dimension == 2 .and. .not. scene%cell%is_on .and. contacts%n_kept == n_kept_in_plane &
                      .and. contacts%n_internal == 0 .and. contacts%n_carried == 0 .and. allocated(history%kept) &
                      .and. history%n_pairs > 0 .and. .not. history%by_point
    if (have_plain_past) have_plain_past = size(history%kept, 1) == n_kept_in_plane .and. scene%contactors%n_rows(kind_polygon) > 0
  end function have_plain_past

  !> Are at least three of four contacts kept? A sample is asked.
  pure logical function are_mostly_kept(n, kept)
    integer, intent(in) :: n
    real(wp), intent(in) :: kept(:, :)
    integer, parameter :: every = 16

    are_mostly_kept = n > 0 .and. 4*count(kept(1, 1:n:every) > 0) >= 3*((n + every - 1)/every)
  end function are_mostly_kept

  !> Go on from pair to pair while they are apart or their contacts are kept, and add these.
  subroutine follow_pairs(scene, pairs, history, near, longest, law_of, last, contacts, first, p, alert, is_near)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    type(history_t), intent(inout) :: history !! contacts of the last detection
    real(wp), intent(in), contiguous :: near(:) !! alert distance of each line of the see tables [m]
    real(wp), intent(in), contiguous :: longest(:) !! longest one of each line [m]
    integer, intent(in), contiguous :: law_of(:) !! law of each line
    integer, intent(in) :: last !! last pair of the run
    type(contacts_t), intent(inout) :: contacts !! contacts of the step so far
    integer(i4), intent(inout) :: first(:) !! first contact of each pair
    integer, intent(inout) :: p !! first pair of the run; then the first that goes the general way or has no room for its contacts,
    !! or the one after the last
    real(wp), intent(out) :: alert !! alert distance of that pair, where it is near [m]
    logical, intent(out) :: is_near !! is it a pair of polygons that are near, and whose contacts are not kept?

    if (.not. allocated(history%past)) allocate (history%past(0))
    associate (shapes => scene%contactors)
      call go_on(last, scene%period, scene%kept_motion, pairs, near, longest, law_of, pairs%contactor, pairs%see, pairs%image, &
                  history%clearance, history%is_matched, history%past, history%first, history%kept, history%feature, &
                 history%impulse, history%status, shapes%kind, shapes%row, shapes%body, shapes%reach, shapes%centre, &
                 shapes%polygon_turn, shapes%polygon_path, contacts%n_components, size(contacts%gap), contacts%contactor, &
                 contacts%body, contacts%image, contacts%law, contacts%feature, contacts%normal, contacts%point, contacts%gap, &
                 contacts%impulse, contacts%status, contacts%kept, contacts%n, first, p, alert, is_near)
    end associate
  end subroutine follow_pairs

  !> The same on plain arrays.
  pure subroutine go_on(last, period, kept_motion, pairs, near, longest, law_of, pair, see, image, clearance, is_matched, past, &
                        first_before, kept_before, feature_before, impulse_before, status_before, kind, row, body_of, reach, &
                        centre, turn, path, n_components, room, contactor, body, image_of, law, feature, normal, point, gap, &
                        impulse, status, kept, n, first, p, alert, is_near)
    integer, intent(in) :: last, law_of(*), n_components, room
    type(neighbours_t), intent(in) :: pairs
    real(wp), intent(in) :: period, kept_motion, near(*), longest(*), clearance(*)
    logical, intent(in) :: is_matched
    integer(i4), intent(in) :: pair(2, *), see(*), past(*), first_before(*), feature_before(*), kind(*), row(*), body_of(*)
    integer(i1), intent(in) :: image(*), status_before(*)
    real(wp), intent(in) :: kept_before(n_kept_in_plane, *), impulse_before(n_components, *)
    real(wp), intent(in) :: reach(*), centre(2, *), turn(2, *), path(*)
    integer(i4), intent(inout) :: contactor(2, *), body(2, *), law(*), feature(*), first(*)
    integer(i1), intent(inout) :: image_of(*), status(*)
    real(wp), intent(inout) :: normal(2, *), point(2, *), gap(*), impulse(n_components, *), kept(n_kept_in_plane, *)
    integer, intent(inout) :: n, p
    real(wp), intent(out) :: alert
    logical, intent(out) :: is_near
    real(wp) :: offset(2), x, y, square, length, pose(n_pose_in_plane), to, farthest
    integer :: before, k
    integer(i4) :: c, a

    is_near = .false.
    alert = 0
    do while (p <= last)
      c = pair(1, p)
      a = pair(2, p)
      if (kind(c) /= kind_polygon .or. kind(a) /= kind_polygon) return
      offset(1) = period*real(image(p), wp)
      offset(2) = 0
      x = centre(1, c) - centre(1, a) - offset(1)
      y = centre(2, c) - centre(2, a) - offset(2)
      square = x**2 + y**2
      length = kept_motion*min(reach(c), reach(a))
      alert = near(see(p))
      first(p) = int(n, i4) + 1
      if (square > (reach(c) + reach(a) + length + alert)**2) then
        p = p + 1
        cycle
      end if
      if (pairs%is_reduced .and. pairs%is_by_pair) alert = alert_of_pair(pairs, p)
      if (square > (reach(c) + reach(a) + length + alert)**2 .or. &
          is_clear(clearance(p), path(row(c)) + path(row(a)), alert + length)) then
        p = p + 1
        cycle
      end if
      before = p
      if (is_matched) before = past(p)
      is_near = .true.
      if (before == 0) return
      k = first_before(before)
      if (first_before(before + 1) <= k) return
      if (.not. kept_before(1, k) > 0 .or. alert > kept_before(n_kept_in_plane, k)) return
      call pose_between(turn(:, row(c)), turn(:, row(a)), x, y, pose)
      if (has_moved_in_plane(kept_before(:, k), pose, reach(c), length)) return
      is_near = .false.
      if (n + first_before(before + 1) - k > room) return
      to = shorter_reach(kept_before(n_kept_in_plane, k), alert, longest(see(p)))
      farthest = to + length
      do k = first_before(before), first_before(before + 1) - 1
        if (kept_before(n_kept_in_plane - 1, k) > farthest) cycle
        n = n + 1
        call move_from(turn(:, row(a)), centre(:, a), offset, kept_before(:, k), pose, normal(:, n), point(:, n), gap(n))
        call put_names(c, a, body_of, contactor(:, n), body(:, n))
        image_of(n) = image(p)
        law(n) = int(law_of(see(p)), i4)
        feature(n) = feature_before(k)
        call recall_impulse(k, n_components, impulse_before, status_before, impulse(:, n), status(n))
        kept(:, n) = kept_before(:, k)
        kept(n_kept_in_plane, n) = to
      end do
      p = p + 1
    end do
  end subroutine go_on
end module sg_follow_pairs
