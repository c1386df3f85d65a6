!> What the grains of a scene are together: number, mass, area or volume, and mean radius.
!!
!! A grain is a body free in all its components, or held in a plane (`mark_walls`); walls, driven or pressed, are left out.
module sg_grains
  use sg_bodies, only: bodies_t
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, pi
  implicit none
  private
  public :: grains_t, count_grains, grain_sums, grains_of, reduce_grains, n_grain_sums

  !> Numbers of `grain_sums`
  integer, parameter :: n_grain_sums = 4

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

  !> Count and weigh the grains of this rank.
  pure function count_grains(bodies) result(grains)
    type(bodies_t), intent(in) :: bodies !! bodies of the scene
    type(grains_t) :: grains

    grains = grains_of(grain_sums(bodies))
  end function count_grains

  !> Number, mass, area and radii of the grains of this rank, summed.
  pure function grain_sums(bodies) result(sums)
    type(bodies_t), intent(in) :: bodies !! bodies of the scene
    real(wp) :: sums(n_grain_sums)
    integer :: i

    sums = 0
    do i = 1, bodies%n_home
      if (.not. bodies%is_grain(i)) cycle
      sums(1) = sums(1) + 1
      sums(2) = sums(2) + bodies%mass(i)
      sums(3) = sums(3) + bodies%area(i)
      if (bodies%dimension == 2) then
        sums(4) = sums(4) + sqrt(bodies%area(i)/pi)
      else
        sums(4) = sums(4) + (3*bodies%area(i)/(4*pi))**(1/3.0_wp)
      end if
    end do
  end function grain_sums

  !> The grains from sums over them.
  pure function grains_of(sums) result(grains)
    real(wp), intent(in) :: sums(n_grain_sums) !! of `grain_sums`, over all ranks
    type(grains_t) :: grains

    grains%n = nint(sums(1))
    grains%mass = sums(2)
    grains%area = sums(3)
    grains%mean_radius = sums(4)
    if (grains%n > 0) grains%mean_radius = grains%mean_radius/real(grains%n, wp)
  end function grains_of

  !> From the grains of each rank to those of all.
  subroutine reduce_grains(grains, comm)
    type(grains_t), intent(inout) :: grains !! of this rank, then of all
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp) :: sums(n_grain_sums)

    if (comm%size == 1) return
    sums = [real(grains%n, wp), grains%mass, grains%area, grains%mean_radius*real(grains%n, wp)]
    call comm%sum(sums)
    grains = grains_of(sums)
  end subroutine reduce_grains
end module sg_grains
