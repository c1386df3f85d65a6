!> Narrow phase of disks, and of spheres, in a loop over plain arrays: nearly all pairs of many scenes.
!!
!! Contacts are those of the general way, which asks scene, list and history for each pair (sg_touch_run).
module sg_round_pairs
  use sg_contactors, only: kind_disk, kind_sphere
  use sg_contacts, only: contacts_t
  use sg_history, only: history_t
  use sg_kinds, only: wp, i1, i4
  use sg_neighbour_list, only: neighbours_t
  use sg_pair_alert, only: alert_of_pair
  use sg_plain_past, only: find_named, find_past, put_names, recall_impulse
  use sg_scene, only: scene_t
  implicit none
  private
  public :: are_plain_rounds, touch_rounds

contains

  !> Do pairs of disks or spheres go through `touch_rounds`? Not in cells, nor where contacts have more of a past than impulses.
  pure logical function are_plain_rounds(scene, history, contacts)
    type(scene_t), intent(in) :: scene !! scene
    type(history_t), intent(in) :: history !! contacts of the last detection
    type(contacts_t), intent(in) :: contacts !! contacts of the step so far

    are_plain_rounds = scene%contactors%n_rows(merge(kind_disk, kind_sphere, scene%dimension == 2)) > 1 &
                       .and. .not. scene%cell%is_on .and. contacts%n_internal == 0 .and. contacts%n_carried == 0 &
                       .and. history%n_pairs > 0 .and. .not. (history%by_point .or. history%is_start)
  end function are_plain_rounds

  !> Add the contacts of pairs of disks, or of spheres, from pair to pair until another pair comes.
  subroutine touch_rounds(scene, pairs, history, near, law_of, last, contacts, first, p)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    type(history_t), intent(in) :: history !! contacts of the last detection
    real(wp), intent(in), contiguous :: near(:) !! alert distance of each line of the see tables [m]
    integer, intent(in), contiguous :: law_of(:) !! law of each line
    integer, intent(in) :: last !! last pair of the run
    type(contacts_t), intent(inout) :: contacts !! contacts of the step so far
    integer(i4), intent(inout) :: first(:) !! first contact of each pair
    integer, intent(inout) :: p !! first pair of the run; then the first that goes the general way or has no room for its contact,
    !! or the one after the last
    integer :: before

    before = contacts%n
    associate (shapes => scene%contactors)
      if (scene%dimension == 2) then
        call touch_disks(last, scene%period, pairs, near, law_of, pairs%contactor, pairs%see, pairs%image, history%is_matched, &
                         history%past, history%first, history%feature, history%impulse, history%status, shapes%kind, shapes%body, &
                         shapes%reach, shapes%centre, contacts%n_components, size(contacts%gap), contacts%contactor, &
                         contacts%body, contacts%image, contacts%law, contacts%feature, contacts%normal, contacts%point, &
                         contacts%gap, contacts%impulse, contacts%status, contacts%n, first, p)
      else
        call touch_spheres(last, [scene%period, scene%period_y], pairs, near, law_of, pairs%contactor, pairs%see, pairs%image, &
                           pairs%image_y, history%is_matched, history%past, history%first, history%feature, history%impulse, &
                           history%status, shapes%kind, shapes%body, shapes%reach, shapes%centre, contacts%n_components, &
                           size(contacts%gap), contacts%contactor, contacts%body, contacts%image, contacts%image_y, &
                           contacts%law, contacts%feature, contacts%normal, contacts%point, contacts%gap, contacts%impulse, &
                           contacts%status, contacts%n, first, p)
      end if
    end associate
    ! Those of other shapes are kept.
    if (contacts%n_kept > 0) contacts%is_kept(before + 1:contacts%n) = 0_i1
  end subroutine touch_rounds

  !> Disks, on plain arrays; products are fused with sums as in sg_touch_disk_disk.
  pure subroutine touch_disks(last, period, pairs, near, law_of, pair, see, image, is_matched, past, first_before, feature_before, &
                              impulse_before, status_before, kind, body_of, reach, centre, n_components, room, contactor, body, &
                              image_of, law, feature, normal, point, gap, impulse, status, n, first, p)
    integer, intent(in) :: last, law_of(*), n_components, room
    type(neighbours_t), intent(in) :: pairs
    real(wp), intent(in) :: period, near(*), impulse_before(n_components, *), reach(*), centre(2, *)
    logical, intent(in) :: is_matched
    integer(i4), intent(in) :: pair(2, *), see(*), past(*), first_before(*), feature_before(*), kind(*), body_of(*)
    integer(i1), intent(in) :: image(*), status_before(*)
    integer(i4), intent(inout) :: contactor(2, *), body(2, *), law(*), feature(*), first(*)
    integer(i1), intent(inout) :: image_of(*), status(*)
    real(wp), intent(inout) :: normal(2, *), point(2, *), gap(*), impulse(n_components, *)
    integer, intent(inout) :: n, p
    real(wp) :: x, y, square, both, distance, half
    integer(i4) :: c, a
    integer :: before, from(2)
    logical :: is_apart

    do p = p, last
      c = pair(1, p)
      a = pair(2, p)
      if (kind(c) /= kind_disk .or. kind(a) /= kind_disk .or. n >= room) return
      first(p) = int(n, i4) + 1
      x = centre(1, c) - (centre(1, a) + period*real(image(p), wp))
      y = centre(2, c) - centre(2, a)
      square = x**2 + y**2
      both = reach(c) + reach(a)
      call judge(pairs, p, near(see(p)), square, both, distance, is_apart)
      if (is_apart) cycle
      call find_past(p, is_matched, past, first_before, from)
      before = find_named(0_i4, from, feature_before)
      if (from(1) <= from(2) .and. before == 0) return
      if (square > tiny(square)) then
        x = x/distance
        y = y/distance
      else
        x = 1
        y = 0
      end if
      n = n + 1
      normal(1, n) = x
      normal(2, n) = y
      gap(n) = distance - both
      half = 0.5_wp*(distance - both)
      point(1, n) = (centre(1, c) - reach(c)*x) - half*x
      point(2, n) = (centre(2, c) - reach(c)*y) - half*y
      call put_names(c, a, body_of, image(p), law_of(see(p)), contactor(:, n), body(:, n), image_of(n), law(n))
      feature(n) = 0
      call recall_impulse(before, n_components, impulse_before, status_before, impulse(:, n), status(n))
    end do
  end subroutine touch_disks

  !> Spheres, but those whose centres coincide; products are fused with sums as in sg_touch_sphere_sphere.
  pure subroutine touch_spheres(last, period, pairs, near, law_of, pair, see, image, image_y, is_matched, past, first_before, &
                                feature_before, impulse_before, status_before, kind, body_of, reach, centre, n_components, room, &
                                contactor, body, image_of, image_y_of, law, feature, normal, point, gap, impulse, status, n, &
                                first, p)
    integer, intent(in) :: last, law_of(*), n_components, room
    type(neighbours_t), intent(in) :: pairs
    real(wp), intent(in) :: period(2), near(*), impulse_before(n_components, *), reach(*), centre(3, *)
    logical, intent(in) :: is_matched
    integer(i4), intent(in) :: pair(2, *), see(*), past(*), first_before(*), feature_before(*), kind(*), body_of(*)
    integer(i1), intent(in) :: image(*), image_y(*), status_before(*)
    integer(i4), intent(inout) :: contactor(2, *), body(2, *), law(*), feature(*), first(*)
    integer(i1), intent(inout) :: image_of(*), image_y_of(*), status(*)
    real(wp), intent(inout) :: normal(3, *), point(3, *), gap(*), impulse(n_components, *)
    integer, intent(inout) :: n, p
    real(wp) :: x, y, z, square, both, distance, half
    integer(i4) :: c, a
    integer :: before, from(2)
    logical :: is_apart

    do p = p, last
      c = pair(1, p)
      a = pair(2, p)
      if (kind(c) /= kind_sphere .or. kind(a) /= kind_sphere .or. n >= room) return
      first(p) = int(n, i4) + 1
      x = centre(1, c) - (centre(1, a) + period(1)*real(image(p), wp))
      y = centre(2, c) - (centre(2, a) + period(2)*real(image_y(p), wp))
      z = centre(3, c) - centre(3, a)
      square = x**2 + y**2 + z**2
      both = reach(c) + reach(a)
      call judge(pairs, p, near(see(p)), square, both, distance, is_apart)
      if (is_apart) cycle
      call find_past(p, is_matched, past, first_before, from)
      before = find_named(0_i4, from, feature_before)
      if ((from(1) <= from(2) .and. before == 0) .or. .not. square > tiny(square)) return
      x = x/distance
      y = y/distance
      z = z/distance
      n = n + 1
      normal(1, n) = x
      normal(2, n) = y
      normal(3, n) = z
      gap(n) = distance - both
      half = 0.5_wp*(distance - both)
      point(1, n) = (centre(1, c) - reach(c)*x) - half*x
      point(2, n) = (centre(2, c) - reach(c)*y) - half*y
      point(3, n) = (centre(3, c) - reach(c)*z) - half*z
      call put_names(c, a, body_of, image(p), law_of(see(p)), contactor(:, n), body(:, n), image_of(n), law(n))
      image_y_of(n) = image_y(p)
      feature(n) = 0
      call recall_impulse(before, n_components, impulse_before, status_before, impulse(:, n), status(n))
    end do
  end subroutine touch_spheres

  !> Are the two of a pair beyond its alert distance? Squares decide for most.
  pure subroutine judge(pairs, p, near, square, both, distance, is_apart)
    type(neighbours_t), intent(in) :: pairs
    integer, intent(in) :: p
    real(wp), intent(in) :: near !! alert distance of its line [m]
    real(wp), intent(in) :: square !! of the distance of the two centres [m2]
    real(wp), intent(in) :: both !! the two radii, added [m]
    real(wp), intent(out) :: distance !! of the centres, where they are not found apart by its square [m]
    logical, intent(out) :: is_apart
    real(wp) :: alert

    distance = 0
    alert = near
    is_apart = square >= max(0.0_wp, both + alert)**2
    if (is_apart) return
    if (pairs%is_reduced .and. pairs%is_by_pair) then
      alert = alert_of_pair(pairs, p)
      is_apart = square >= max(0.0_wp, both + alert)**2
      if (is_apart) return
    end if
    distance = sqrt(square)
    is_apart = distance - both >= alert
  end subroutine judge
end module sg_round_pairs
