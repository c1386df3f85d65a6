!> Contact of a sphere with a plane (PLANx): a box, thin along its third axis.
module sg_touch_sphere_plane
  use sg_kinds, only: wp, i4
  use sg_touch_space, only: touch_space_t, add_space_point
  implicit none
  private
  public :: touch_sphere_plane, normal_from_box

contains

  !> Contact of a sphere with the face, edge or corner of the box that is nearest to its centre.
  !!
  !! Above a face the normal is exactly an axis of the box. A centre within the box leaves by the nearer of the two
  !! large faces, by the one of the third axis' positive side when it is in the middle.
  pure subroutine touch_sphere_plane(centre_c, radius_c, centre_a, frame, half, alert, touch, rim)
    real(wp), intent(in) :: centre_c(3) !! centre of the sphere, the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the sphere [m]
    real(wp), intent(in) :: centre_a(3) !! centre of the box, the antagonist [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: axes of the box in the world
    real(wp), intent(in) :: half(3) !! half lengths along these axes [m]
    real(wp), intent(in) :: alert !! gap from which nothing is reported [m]
    type(touch_space_t), intent(out) :: touch !! at most one point
    real(wp), intent(in), optional :: rim !! distance from the box that is touched as if it were its surface [m], zero unless given
    real(wp) :: between(3), local(3), normal(3), distance, around
    integer :: i

    around = 0
    if (present(rim)) around = rim
    between = centre_c - centre_a
    do i = 3, 1, -1
      local(i) = frame(1, i)*between(1) + frame(2, i)*between(2) + frame(3, i)*between(3)
      if (abs(local(i)) - (half(i) + (around + radius_c)) >= alert) return
    end do
    call normal_from_box(local, frame, half, normal, distance)
    call add_space_point(touch, centre_c - radius_c*normal, normal, (distance - around) - radius_c, alert, 0_i4)
  end subroutine touch_sphere_plane

  !> Way from a box to a point: its direction and its length, negative within the box.
  pure subroutine normal_from_box(local, frame, half, normal, distance)
    real(wp), intent(in) :: local(3) !! the point in the box's own frame [m]
    real(wp), intent(in) :: frame(3, 3) !! columns: axes of the box in the world
    real(wp), intent(in) :: half(3) !! half lengths along these axes [m]
    real(wp), intent(out) :: normal(3) !! unit vector from the box to the point, in the world
    real(wp), intent(out) :: distance !! [m]
    real(wp) :: excess(3), largest
    integer :: face

    excess = max(0.0_wp, abs(local) - half)
    if (count(excess > 0) > 1) then
      ! By the largest first, so that no square underflows.
      largest = maxval(excess)
      excess = excess/largest
      distance = sqrt(sum(excess**2))
      excess = sign(excess/distance, local)
      distance = largest*distance
      normal = frame(:, 1)*excess(1) + frame(:, 2)*excess(2) + frame(:, 3)*excess(3)
    else
      face = 3
      if (any(excess > 0)) face = maxloc(excess, 1)
      distance = abs(local(face)) - half(face)
      normal = frame(:, face)
      if (local(face) < 0) normal = -normal
    end if
  end subroutine normal_from_box
end module sg_touch_sphere_plane
