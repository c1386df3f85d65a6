!> Areas shared by circles, exact to rounding even where circles barely cross.
!!
!! No formula subtracts nearly equal numbers: with penetration d the area of a lens goes like d^(3/2), which the
!! usual arc cosines lose below a relative penetration of 1e-5.
module sg_overlap_disks
  use sg_kinds, only: wp, pi
  implicit none
  private
  public :: overlap_disk_disk, overlap_disk_hollow, segment_area, half_angle_inside

contains

  !> Area shared by two disks [m2].
  pure real(wp) function overlap_disk_disk(centre_c, radius_c, centre_a, radius_a) result(area)
    real(wp), intent(in) :: centre_c(2) !! centre of the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the candidate [m]
    real(wp), intent(in) :: centre_a(2) !! centre of the antagonist [m]
    real(wp), intent(in) :: radius_a !! radius of the antagonist [m]
    real(wp) :: distance

    distance = sqrt((centre_c(1) - centre_a(1))**2 + (centre_c(2) - centre_a(2))**2)
    if (distance >= radius_c + radius_a) then
      area = 0
    else if (distance <= abs(radius_c - radius_a)) then
      area = pi*min(radius_c, radius_a)**2
    else
      area = radius_c**2*segment_inside(radius_c, radius_a, distance) + radius_a**2*segment_inside(radius_a, radius_c, distance)
    end if
  end function overlap_disk_disk

  !> Area between the arc of a circle inside another that crosses it and its chord, over the square of its radius.
  !!
  !! With t the tangent of a quarter of the arc it is 16 times the integral of t^2/(1 + t^2)^3. Of small overlaps, t^2 up to 1e-2,
  !! the series needs nine terms: the tenth is below 1e-17 of the first. Others take the angle.
  pure real(wp) function segment_inside(own, other, distance) result(area)
    real(wp), intent(in) :: own !! radius of the circle [m]
    real(wp), intent(in) :: other !! radius of the other [m]
    real(wp), intent(in) :: distance !! between the centres [m]
    real(wp) :: inside, outside, square
    integer :: k
    !> Terms of the series: (-1)^k (k + 1) (k + 2)/2 t^(2 k + 3)/(2 k + 3)
    real(wp), parameter :: term(0:8) = [(real((1 - 2*mod(k, 2))*(k + 1)*(k + 2), wp)/real(4*k + 6, wp), k=0, 8)]

    inside = max(0.0_wp, (own + other - distance)*(other + distance - own))
    outside = (own + distance - other)*(own + distance + other)
    if (inside > 1e-2_wp*outside) then
      area = segment_area(2*half_angle_inside(own, other, distance))
    else
      square = inside/outside
      area = term(8)
      do k = 7, 0, -1
        area = area*square + term(k)
      end do
      area = 16*square*sqrt(square)*area
    end if
  end function segment_inside

  !> Area of a disk outside the hollow disk that should hold it [m2].
  pure real(wp) function overlap_disk_hollow(centre_c, radius_c, centre_a, radius_a) result(area)
    real(wp), intent(in) :: centre_c(2) !! centre of the disk, the candidate [m]
    real(wp), intent(in) :: radius_c !! radius of the disk [m]
    real(wp), intent(in) :: centre_a(2) !! centre of the hollow disk, the antagonist [m]
    real(wp), intent(in) :: radius_a !! inner radius of the hollow disk [m]
    real(wp) :: distance

    distance = norm2(centre_c - centre_a)
    if (distance + radius_c <= radius_a) then
      area = 0
    else if (distance >= radius_c + radius_a) then
      area = pi*radius_c**2
    else if (distance <= radius_c - radius_a) then
      area = pi*(radius_c - radius_a)*(radius_c + radius_a)
    else
      ! A crescent: the disk's segment outside the common chord less the hollow disk's.
      area = radius_c**2*segment_area(2*half_angle_outside(radius_c, radius_a, distance)) &
             - radius_a**2*segment_area(2*half_angle_inside(radius_a, radius_c, distance))
    end if
  end function overlap_disk_hollow

  !> Half the angle under which a circle sees its arc inside another that crosses it [rad].
  pure real(wp) function half_angle_inside(own, other, distance) result(angle)
    real(wp), intent(in) :: own !! radius of the circle [m]
    real(wp), intent(in) :: other !! radius of the other [m]
    real(wp), intent(in) :: distance !! between the centres [m]

    angle = 2*atan2(sqrt(max(0.0_wp, (own + other - distance)*(other + distance - own))), &
                    sqrt(max(0.0_wp, (own + distance - other)*(own + distance + other))))
  end function half_angle_inside

  !> Half the angle under which a circle sees its arc outside another that crosses it [rad].
  pure real(wp) function half_angle_outside(own, other, distance) result(angle)
    real(wp), intent(in) :: own !! radius of the circle [m]
    real(wp), intent(in) :: other !! radius of the other [m]
    real(wp), intent(in) :: distance !! between the centres [m]

    angle = 2*atan2(sqrt(max(0.0_wp, (own + distance - other)*(own + distance + other))), &
                    sqrt(max(0.0_wp, (own + other - distance)*(other + distance - own))))
  end function half_angle_outside

  !> Area between an arc of the unit circle and its chord, (angle - sin(angle))/2, by its series for small angles.
  pure real(wp) function segment_area(angle)
    real(wp), intent(in) :: angle !! of the arc, 0 to 2 pi [rad]
    real(wp) :: term, before
    integer :: k

    if (angle > 1) then
      segment_area = 0.5_wp*(angle - sin(angle))
    else
      ! At most nine terms: the tenth is below 1e-18 of the first.
      term = angle**3/12
      segment_area = term
      do k = 4, 20, 2
        term = -term*angle**2/real(k*(k + 1), wp)
        before = segment_area
        segment_area = segment_area + term
        ! All terms to come are smaller: they would change nothing either.
        if (.not. abs(segment_area - before) > 0) exit
      end do
    end if
  end function segment_area
end module sg_overlap_disks
