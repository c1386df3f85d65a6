!> Contact of two convex polyhedra.
!!
!! One axis for the pair: along the shortest way between the two where they are apart, along the shortest way apart
!! where they overlap. The points are the corners of what the two facing faces share, seen along the axis.
!!
!! The face or the two edges that gave the axis of the last step are tried first: mostly they are proven to give it again, or to
!! hold the shapes apart. Else the search finds what it finds without them, so that no point depends on what is kept.
module sg_touch_polyhedron_polyhedron
  use sg_clip_faces, only: add_shared_points
  use sg_kept_axis, only: feature_of, prove_axis
  use sg_kinds, only: wp, i4
  use sg_polyhedra_apart, only: walk_apart
  use sg_polyhedra_overlap, only: try_edges, try_faces
  use sg_polyhedron, only: polyhedron_t
  use sg_separation, only: axis_t, rounding_of
  use sg_touch_space, only: touch_space_t
  implicit none
  private
  public :: touch_polyhedron_polyhedron

  !> A separation greater than the alert distance by so many roundings is so however it is measured
  real(wp), parameter :: sure = 4

contains

  !> Points of contact of two convex polyhedra.
  pure subroutine touch_polyhedron_polyhedron(c, a, offset, alert, touch, kept, clearance)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates (its periodic image) [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_space_t), intent(out) :: touch !! up to four points
    integer(i4), intent(inout), optional :: kept(2) !! features to try first (`feature_of`), on return those of the axis; the points
    !! do not depend on them
    real(wp), intent(out), optional :: clearance !! the shapes are as far apart at least, however that is measured [m]
    type(axis_t) :: axis
    real(wp) :: way(3), start(3), size2, rounding
    logical :: is_proven

    if (present(clearance)) clearance = -huge(clearance)
    way = c%centre - a%centre - offset
    size2 = dot_product(way, way)
    if (size2 >= (c%reach + a%reach + max(alert, 0.0_wp))**2) return
    rounding = rounding_of(c, a, offset)
    is_proven = .false.
    if (present(kept)) then
      call prove_axis(c, a, offset, rounding, kept, axis, is_proven)
      if (axis%separation >= alert + sure*rounding) then
        if (present(clearance)) clearance = axis%separation - sure*rounding
        return
      end if
    end if
    if (.not. is_proven) then
      start = [1.0_wp, 0.0_wp, 0.0_wp]
      if (size2 > tiny(size2)) start = way/sqrt(size2)
      call touching_axis(c, a, offset, alert, rounding, start, axis)
      if (present(clearance)) clearance = axis%separation - sure*rounding
    end if
    ! Places that are not numbers have no axis.
    if (axis%separation >= alert .or. axis%vertex_c == 0) return
    if (present(kept)) kept = feature_of(axis)
    call add_shared_points(c, a, offset, alert, rounding, axis, touch)
  end subroutine touch_polyhedron_polyhedron

  !> The axis of greatest separation of two polyhedra, or one along which they are apart by `alert` or more.
  pure subroutine touching_axis(c, a, offset, alert, rounding, start, axis)
    type(polyhedron_t), intent(in) :: c !! candidate, in the world
    type(polyhedron_t), intent(in) :: a !! antagonist, in the world
    real(wp), intent(in) :: offset(3) !! added to the antagonist's coordinates [m]
    real(wp), intent(in) :: alert !! separation from which the search may stop [m]
    real(wp), intent(in) :: rounding !! separations that differ by less are as good [m]
    real(wp), intent(in) :: start(3) !! unit vector to start with
    type(axis_t), intent(out) :: axis !! the axis
    real(wp) :: distance

    call walk_apart(c, a, offset, alert, rounding, start, axis, distance)
    if (axis%separation >= alert .or. axis%vertex_c == 0) return
    call try_faces(c, a, offset, rounding, axis)
    if (axis%separation >= alert) return
    if (distance <= 0 .or. max(axis%face_a, axis%face_c) == 0) call try_edges(c, a, offset, distance, rounding, axis)
  end subroutine touching_axis
end module sg_touch_polyhedron_polyhedron
