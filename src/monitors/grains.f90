!> What the grains of a scene are together: number, mass, area or volume, and mean radius.
!!
!! A grain is a body free in all its components; walls, driven or pressed, are left out.
module sg_grains
  use sg_bodies, only: bodies_t
  use sg_kinds, only: wp, pi
  implicit none
  private
  public :: grains_t, count_grains

  !> Sums over the grains
  type :: grains_t
    !> Number of grains
    integer :: n = 0
    !> Mass [kg] and area [m2], in space volume [m3], of all grains
    real(wp) :: mass = 0, area = 0
    !> Mean over the grains of the radius of the disk of the same area, in space of the sphere of the same volume [m]
    real(wp) :: mean_radius = 0
  end type grains_t

contains

  !> Count and weigh the grains.
  pure function count_grains(bodies) result(grains)
    type(bodies_t), intent(in) :: bodies !! bodies of the scene
    type(grains_t) :: grains
    integer :: i

    do i = 1, bodies%n
      if (.not. bodies%is_grain(i)) cycle
      grains%n = grains%n + 1
      grains%mass = grains%mass + bodies%mass(i)
      grains%area = grains%area + bodies%area(i)
      if (bodies%dimension == 2) then
        grains%mean_radius = grains%mean_radius + sqrt(bodies%area(i)/pi)
      else
        grains%mean_radius = grains%mean_radius + (3*bodies%area(i)/(4*pi))**(1/3.0_wp)
      end if
    end do
    if (grains%n > 0) grains%mean_radius = grains%mean_radius/real(grains%n, wp)
  end function count_grains
end module sg_grains
