!> Grains: random sizes, random convex polygons. The same seed gives the same grains.
module sg_generators
  use sg_kinds, only: wp, pi
  use sg_random, only: random_t
  implicit none
  private
  public :: draw_radius, draw_polygon
  public :: size_uniform, size_volume, size_lognormal, size_constant

  !> How radii are spread: evenly by number, evenly by area, lognormal, all the same
  integer, parameter :: size_uniform = 1, size_volume = 2, size_lognormal = 3, size_constant = 4

contains

  !> One radius [m].
  function draw_radius(random, distribution, range, dimension) result(radius)
    type(random_t), intent(inout) :: random !! stream of numbers
    integer, intent(in) :: distribution !! one of `size_*`
    real(wp), intent(in) :: range(2) !! least and largest radius [m]
    integer, intent(in) :: dimension !! of space
    real(wp) :: radius

    radius = range(1)
    if (.not. range(2) > range(1)) return
    select case (distribution)
    case (size_uniform)
      radius = random%uniform(range(1), range(2))
    case (size_volume)
      ! Number density proportional to 1/r**2: every size class covers the same area; in space to 1/r**3: the same volume.
      if (dimension == 3) then
        radius = product(range)/sqrt(range(2)**2 - random%uniform()*(range(2)**2 - range(1)**2))
      else
        radius = range(1)*range(2)/(range(2) - random%uniform()*(range(2) - range(1)))
      end if
    case (size_lognormal)
      do
        radius = sqrt(range(1)*range(2))*exp(random%normal()*log(range(2)/range(1))/4)
        if (radius >= range(1) .and. radius <= range(2)) exit
      end do
    end select
  end function draw_radius

  !> A random convex polygon with its vertices on a circle about the origin, counter-clockwise.
  subroutine draw_polygon(random, n, radius, vertices)
    type(random_t), intent(inout) :: random !! stream of numbers
    integer, intent(in) :: n !! number of vertices
    real(wp), intent(in) :: radius !! of the circle [m]
    real(wp), allocatable, intent(out) :: vertices(:, :) !! [m], shape (2, n)
    real(wp) :: start, angle
    integer :: k

    allocate (vertices(2, n))
    start = random%uniform(0.0_wp, 2*pi)
    do k = 1, n
      ! Neighbours keep at least half of their even distance.
      angle = start + (real(k, wp) + random%uniform(-0.25_wp, 0.25_wp))*2*pi/real(n, wp)
      vertices(:, k) = radius*[cos(angle), sin(angle)]
    end do
  end subroutine draw_polygon
end module sg_generators
