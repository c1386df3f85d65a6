!> Narrow phase of a run of pairs: their contacts, pair by pair.
!!
!! Several threads may each take a run of one list, with contacts of their own (sg_touch_pieces). What a pair changes belongs to it
!! alone: what is tried first of it and its clearance; corners of a polygon are placed before, or by the thread that first needs
!! them.
module sg_touch_run
  use sg_add_contacts, only: add_contacts, add_kept, is_slow, keep_pair, kept_length, law_of
  use sg_contactors, only: kind_polygon
  use sg_contacts, only: contacts_t, grow_contacts
  use sg_follow, only: follows
  use sg_history, only: history_t
  use sg_kinds, only: wp, i4
  use sg_narrow_phase, only: are_found_apart, path_of_pair, touch_in_plane, touch_in_space
  use sg_neighbour_list, only: neighbours_t, offset_of
  use sg_pair_alert, only: alert_of_pair
  use sg_placed_corners, only: place_corners_once
  use sg_polygon_pairs, only: are_mostly_kept, are_plain_polygons, most_points, touch_polygons
  use sg_round_pairs, only: are_plain_rounds, touch_rounds
  use sg_scene, only: scene_t
  use sg_shape_kinds, only: is_bounding
  use sg_timers, only: wall_now
  use sg_touch, only: touch_t
  use sg_touch_space, only: touch_space_t
  implicit none
  private
  public :: begin_runs, ends_early, runs_t, touch_run

  !> Pairs from one look at the time to the next
  integer, parameter :: pairs_per_look = 1024

  !> What all pairs of a detection share
  type :: runs_t
    !> Do pairs of polygons go through `touch_polygons`, and those of disks or spheres through `touch_rounds`?
    logical :: has_polygons = .false., has_rounds = .false.
    !> Are pairs of polygons measured there? Not where their corners wait, nor where points are moved afterwards
    logical :: measures = .false.
    !> Of each line of the see tables: alert distance and longest one [m], and law
    real(wp), allocatable :: near(:), longest(:)
    integer, allocatable :: law(:)
  end type runs_t

contains

  !> What all pairs share.
  subroutine begin_runs(scene, pairs, history, contacts, corners_wait, runs)
    type(scene_t), intent(in) :: scene !! scene with its see tables
    type(neighbours_t), intent(in) :: pairs !! list of neighbours, its alert distances set
    type(history_t), intent(in) :: history !! contacts of the last detection
    type(contacts_t), intent(in) :: contacts !! contacts of the step so far: none
    logical, intent(in) :: corners_wait !! do corners of polygons wait until a pair needs them?
    type(runs_t), intent(out) :: runs !! what they share

    runs%measures = .not. (corners_wait .or. scene%shrink > 0 .or. history%is_start)
    runs%has_polygons = are_plain_polygons(scene, history, contacts)
    ! To leave the loop for most pairs costs more than it saves.
    if (runs%has_polygons .and. .not. runs%measures) runs%has_polygons = are_mostly_kept(history)
    runs%has_rounds = are_plain_rounds(scene, history, contacts)
    ! Allocated before: an assignment would compute with the bounds of what is not there.
    associate (n => size(scene%sees))
      allocate (runs%near(n), runs%longest(n), runs%law(n))
    end associate
    runs%near(:) = pairs%alert
    if (pairs%is_reduced .and. .not. pairs%is_by_pair) runs%near(:) = min(runs%near, pairs%least)
    runs%longest(:) = scene%sees%alert
    runs%law(:) = scene%sees%law
  end subroutine begin_runs

  !> Add the contacts of a run of pairs to those found so far.
  subroutine touch_run(scene, pairs, history, runs, begin, end, contacts, first, is_late)
    type(scene_t), intent(inout) :: scene !! scene, its contactors placed; corners of polygons where they are needed
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    type(history_t), intent(inout) :: history !! contacts of the last detection; what is tried first of the pairs is set
    type(runs_t), intent(in) :: runs !! what all pairs share
    integer, intent(in) :: begin !! first pair of the run
    integer, intent(in) :: end !! its last pair
    type(contacts_t), intent(inout) :: contacts !! contacts found so far
    integer(i4), intent(inout), contiguous :: first(:) !! first contact of each pair of the list
    logical, intent(out) :: is_late !! has the time run out?
    real(wp) :: alert
    logical :: is_apart, is_near
    integer :: p, next, last

    is_late = .false.
    next = begin
    do while (next <= end)
      if (ends_early(pairs, contacts, next, is_late)) exit
      last = end
      is_near = .false.
      if (runs%has_polygons .or. runs%has_rounds) then
        last = min(end, (next/pairs_per_look + 1)*pairs_per_look - 1)
        call grow_contacts(contacts, contacts%n + most_points)
        if (contacts%is_cut) exit
        if (runs%has_rounds) call touch_rounds(scene, pairs, history, runs%near, runs%law, last, contacts, first, next)
        if (runs%has_polygons .and. next <= last) &
          call touch_polygons(scene, pairs, history, runs%near, runs%longest, runs%law, runs%measures, last, contacts, first, &
                              next, alert, is_near)
        if (next > last .or. contacts%n + most_points > size(contacts%gap)) cycle
        last = next
      end if
      do p = next, last
        if (ends_early(pairs, contacts, p, is_late)) exit
        first(p) = int(contacts%n, i4) + 1
        ! Most pairs end here.
        is_apart = .false.
        if (.not. is_near) call look_at_spheres(scene, pairs, p, contacts%n_kept, alert, is_apart)
        if (.not. is_apart) call touch_near(scene, pairs, history, p, alert, is_near, contacts)
      end do
      next = last + 1
    end do
  end subroutine touch_run

  !> Is there no memory for more contacts, or no time for more pairs?
  logical function ends_early(pairs, contacts, p, is_late)
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    type(contacts_t), intent(in) :: contacts !! contacts found so far
    integer, intent(in) :: p !! pair
    logical, intent(inout) :: is_late !! is there no time?

    if (pairs%deadline > 0 .and. modulo(p, pairs_per_look) == 0) is_late = wall_now() > pairs%deadline
    ends_early = contacts%is_cut .or. is_late
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
        if (contactors%kind(c) == kind_polygon) call place_corners_once(contactors, c)
        if (contactors%kind(a) == kind_polygon) call place_corners_once(contactors, a)
        call find_in_plane(scene, pairs, history, p, alert, path, contacts)
      else
        call find_in_space(scene, pairs, history, p, alert, path, contacts)
      end if
      if (.not. keeps .or. contacts%n == n) return
      if (is_slow(scene, c, a, pairs%substeps)) call keep_pair(scene, pairs, history, p, near, n + 1, contacts%n, contacts)
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
end module sg_touch_run
