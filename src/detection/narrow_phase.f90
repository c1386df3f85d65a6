!> Narrow phase of one pair: points of contact of two shapes where their bodies are, with what is tried first of the pair.
module sg_narrow_phase
  use sg_contactors, only: contactors_t, kind_polygon, kind_polyhedron, kind_sphere
  use sg_follow, only: follows
  use sg_history, only: history_t
  use sg_kinds, only: wp, i4
  use sg_neighbour_list, only: neighbours_t, offset_of
  use sg_path_bound, only: is_clear
  use sg_scene, only: scene_t
  use sg_shrink_face, only: shrink_face
  use sg_touch, only: touch_t
  use sg_touch_pair, only: touch_pair
  use sg_touch_space, only: touch_space_t
  use sg_touch_space_pair, only: touch_space_pair
  use sg_touch_sphere_sphere, only: touch_sphere_sphere
  implicit none
  private
  public :: are_found_apart, path_of_pair, touch_in_plane, touch_in_space

contains

  !> Points of contact of a pair in the plane.
  subroutine touch_in_plane(scene, pairs, history, p, alert, path, touch)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed, corners of polygons too
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    type(history_t), intent(inout) :: history !! the face that is tried first, and the clearance of the pair, are set
    integer, intent(in) :: p !! pair that is no link
    real(wp), intent(in) :: alert !! gap from which nothing is found [m]
    real(wp), intent(in) :: path !! path lengths of two polygons, added [m]
    type(touch_t), intent(inout) :: touch !! points found; none before
    real(wp) :: shift(2), offset(3)

    associate (c => pairs%contactor(1, p), a => pairs%contactor(2, p), contactors => scene%contactors)
      offset = offset_of(scene, pairs, p)
      shift = offset(:2)
      if (contactors%kind(c) == kind_polygon .and. contactors%kind(a) == kind_polygon) then
        call touch_pair(contactors, c, a, shift, alert, touch, scene%period, history%face(1, p), history%clearance(p))
        history%clearance(p) = history%clearance(p) + path
        if (scene%shrink > 0) call shrink_face(touch%n, touch%normal, touch%point, touch%gap, scene%shrink)
      else if (contactors%kind(c) == kind_polygon) then
        call touch_pair(contactors, c, a, shift, alert, touch, scene%period, history%face(1, p))
      else
        call touch_pair(contactors, c, a, shift, alert, touch, scene%period)
      end if
    end associate
  end subroutine touch_in_plane

  !> Points of contact of a pair in space.
  subroutine touch_in_space(scene, pairs, history, p, alert, path, touch)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    type(neighbours_t), intent(in) :: pairs !! list of neighbours
    type(history_t), intent(inout) :: history !! the features that are tried first, and the clearance of the pair, are set
    integer, intent(in) :: p !! pair that is no link
    real(wp), intent(in) :: alert !! gap from which nothing is found [m]
    real(wp), intent(in) :: path !! path lengths of two polyhedra, added [m]
    type(touch_space_t), intent(inout) :: touch !! points found; none before
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
  end subroutine touch_in_space

  !> Paths of two polygons or of two polyhedra so far, added [m]: how much nearer to each other their points may have come since
  !! the start. Nothing for others, which are measured in each step.
  pure real(wp) function path_of_pair(contactors, c, a) result(path)
    type(contactors_t), intent(in) :: contactors !! placed contactors
    integer(i4), intent(in) :: c !! candidate
    integer(i4), intent(in) :: a !! antagonist

    path = 0
    associate (i => contactors%row(c), j => contactors%row(a))
      if (contactors%kind(c) /= contactors%kind(a)) return
      if (contactors%kind(c) == kind_polygon) path = contactors%polygon_path(i) + contactors%polygon_path(j)
      if (contactors%kind(c) == kind_polyhedron) path = contactors%space%polyhedron_path(i) + contactors%space%polyhedron_path(j)
    end associate
  end function path_of_pair

  !> Have two shapes been found so far apart that they are beyond a distance, whatever way they have gone since?
  pure logical function are_found_apart(scene, history, p, c, a, path, distance) result(apart)
    type(scene_t), intent(in) :: scene !! scene, its contactors placed
    type(history_t), intent(in) :: history !! what was found of all pairs
    integer, intent(in) :: p !! pair
    integer(i4), intent(in) :: c !! its candidate
    integer(i4), intent(in) :: a !! its antagonist
    real(wp), intent(in) :: path !! their paths, added [m]
    real(wp), intent(in) :: distance !! [m]

    apart = .false.
    if (scene%cell%is_on .or. scene%contactors%kind(c) /= scene%contactors%kind(a)) return
    if (follows(scene%contactors%kind(c))) apart = is_clear(history%clearance(p), path, distance)
  end function are_found_apart
end module sg_narrow_phase
