!> Proof that the face kept of two convex polygons is the face of greatest separation still, without a search.
!!
!! Let the lowest vertex over the face stand at the height s, r or more from the ends of the face. It and the points of the face
!! bound the separation along a unit vector at an angle w from the normal by s cos w - r sin w. A vertex of the same polygon, H
!! behind the face and T off along it, gives (s + H) cos w + T sin w. Where r >= 3 |s| and r H >= 4 |s| (r + T), no vector reaches s
!! (doc/theory/detection_in_space.md, "The axis kept").
module sg_kept_face
  use sg_kinds, only: wp
  implicit none
  private
  public :: prove_face, stands_off

contains

  !> Prove a face to be the one that a search finds, which prefers faces that come early to others that are as good.
  pure subroutine prove_face(n_r, reference, edges, edge, way, height, slack, inside, is_best)
    integer, intent(in) :: n_r !! vertices of the polygon that has the face
    real(wp), intent(in) :: reference(2, n_r) !! its vertices [m]
    real(wp), intent(in) :: edges(3, n_r) !! normals and lengths of its edges [m]
    integer, intent(in) :: edge !! the face
    real(wp), intent(in) :: way(2) !! from its start to the other polygon's lowest vertex over it [m]
    real(wp), intent(in) :: height !! of that vertex [m]
    real(wp), intent(in) :: slack !! heights that differ by less are as good [m]
    real(wp), intent(out) :: inside !! distance of that vertex from the ends of the face, seen along its normal [m]
    logical, intent(out) :: is_best !! is it the best of its polygon, and as good as any of the other at least?
    real(wp) :: normal(2), start(2), place, depth, back, off
    integer :: i, k

    normal = edges(1:2, edge)
    start = reference(:, edge)
    place = normal(1)*way(2) - normal(2)*way(1)
    inside = min(place, edges(3, edge) - place)
    depth = max(-height, 0.0_wp) + 16*slack
    is_best = inside >= 3*depth
    if (is_best) is_best = stands_off(normal, edges(:, merge(n_r, edge - 1, edge == 1)), inside, slack)
    if (is_best) is_best = stands_off(normal, edges(:, merge(1, edge + 1, edge == n_r)), inside, slack)
    if (.not. is_best) return
    ! Vertices that are far behind the face are opposite to it.
    do k = 0, n_r - 1
      i = edge + (n_r + 1)/2 + k
      if (i > n_r) i = i - n_r
      if (i > n_r) i = i - n_r
      back = normal(1)*(start(1) - reference(1, i)) + normal(2)*(start(2) - reference(2, i))
      off = abs(normal(1)*(reference(2, i) - start(2)) - normal(2)*(reference(1, i) - start(1)) - place)
      if (inside*back >= 4*depth*(inside + off)) return
    end do
    is_best = .false.
  end subroutine prove_face

  !> Is the separation along the normal of an edge less than the best by more than all that is as good?
  pure logical function stands_off(normal, edge, inside, slack)
    real(wp), intent(in) :: normal(2) !! of the best face
    real(wp), intent(in) :: edge(3) !! normal and length of the edge [m]
    real(wp), intent(in) :: inside !! distance of the lowest vertex from the ends of the best face [m]
    real(wp), intent(in) :: slack !! [m]

    stands_off = edge(3) > tiny(slack)
    if (stands_off .and. normal(1)*edge(1) + normal(2)*edge(2) > 0) &
      stands_off = abs(normal(1)*edge(2) - normal(2)*edge(1))*inside > 4*slack
  end function stands_off
end module sg_kept_face
