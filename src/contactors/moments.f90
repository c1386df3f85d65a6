!> Area, centre and moment of area of shapes and of clusters of them: what mass and inertia are made of.
!!
!! Overlaps within a cluster count twice. A hollow disk bounds space but fills none.
module sg_moments
  use sg_contactors, only: contactors_t, kind_disk, kind_polygon, kind_segment
  use sg_kinds, only: wp, pi
  implicit none
  private
  public :: body_moments, polygon_moments

contains

  !> Area [m2], centre [m] and polar moment of area about that centre [m4] of a body's contactors, in its frame.
  pure subroutine body_moments(contactors, first, last, area, centre, moment)
    type(contactors_t), intent(in) :: contactors !! all contactors
    integer, intent(in) :: first !! first contactor of the body
    integer, intent(in) :: last !! last contactor of the body
    real(wp), intent(out) :: area !! sum of the areas [m2]
    real(wp), intent(out) :: centre(2) !! centre of area [m], the body's origin when the area is zero
    real(wp), intent(out) :: moment !! polar moment of area about the centre [m4]
    integer :: c
    real(wp) :: area_of_one, moment_of_one

    area = 0
    centre = 0
    moment = 0
    do c = first, last
      call contactor_moments(contactors, c, area_of_one, moment_of_one)
      area = area + area_of_one
      centre = centre + area_of_one*contactors%shift(:, c)
    end do
    if (.not. area > 0) return
    centre = centre/area
    do c = first, last
      call contactor_moments(contactors, c, area_of_one, moment_of_one)
      moment = moment + moment_of_one + area_of_one*sum((contactors%shift(:, c) - centre)**2)
    end do
  end subroutine body_moments

  !> Area [m2] of one contactor and its polar moment of area about the contactor's centre [m4].
  pure subroutine contactor_moments(contactors, contactor, area, moment)
    type(contactors_t), intent(in) :: contactors !! all contactors
    integer, intent(in) :: contactor !! the one to measure
    real(wp), intent(out) :: area !! [m2]
    real(wp), intent(out) :: moment !! about the contactor's centre [m4]
    integer :: row
    real(wp) :: centre(2)

    row = contactors%row(contactor)
    area = 0
    moment = 0
    select case (contactors%kind(contactor))
    case (kind_disk)
      area = pi*contactors%disk_radius(row)**2
      moment = area*contactors%disk_radius(row)**2/2
    case (kind_segment)
      call stadium_moments(contactors%segment_size(1, row), contactors%segment_size(2, row), area, moment)
    case (kind_polygon)
      associate (first => contactors%polygon_first(row), last => contactors%polygon_first(row + 1) - 1)
        call polygon_moments(contactors%polygon_vertex(:, first:last), area, centre, moment)
      end associate
      moment = moment + area*sum(centre**2)
    end select
  end subroutine contactor_moments

  !> A rounded segment: a rectangle with a half disk at both ends.
  pure subroutine stadium_moments(a, b, area, moment)
    real(wp), intent(in) :: a, b
    real(wp), intent(out) :: area, moment
    real(wp) :: rectangle, caps

    rectangle = 4*a*b
    caps = pi*b**2
    area = rectangle + caps
    moment = rectangle*(a**2 + b**2)/3 + caps*(b**2/2 + a**2 + 8*a*b/(3*pi))
  end subroutine stadium_moments

  !> Area (negative when clockwise), centre, and polar moment of area about that centre, of any simple polygon.
  pure subroutine polygon_moments(vertices, area, centre, moment)
    real(wp), intent(in) :: vertices(:, :) !! in order around the polygon [m], shape (2, vertices)
    real(wp), intent(out) :: area !! [m2]
    real(wp), intent(out) :: centre(2) !! [m]
    real(wp), intent(out) :: moment !! about the centre [m4]
    real(wp) :: p(2), q(2), cross
    integer :: i, n

    n = size(vertices, 2)
    area = 0
    centre = 0
    moment = 0
    ! About the first vertex rather than the origin: no digits are lost on a polygon far away.
    do i = 2, n - 1
      p = vertices(:, i) - vertices(:, 1)
      q = vertices(:, i + 1) - vertices(:, 1)
      cross = p(1)*q(2) - p(2)*q(1)
      area = area + cross/2
      centre = centre + cross*(p + q)/6
      moment = moment + cross*(dot_product(p, p) + dot_product(p, q) + dot_product(q, q))/12
    end do
    if (.not. abs(area) > 0) return
    centre = centre/area
    moment = moment - area*sum(centre**2)
    centre = centre + vertices(:, 1)
  end subroutine polygon_moments
end module sg_moments
