!> What the grains of a scene are together: number, mass, area or volume, and mean radius.
!!
!! A grain is a body free in all its components, or held in a plane (`mark_walls`); walls, driven or pressed, are left out.
module sg_grains
  use sg_bodies, only: bodies_t
  use sg_comm, only: comm_t
  use sg_kinds, only: wp, pi
  use sg_tally, only: pass_sums, tally_t
  implicit none
  private
  public :: grains_t, count_grains, sum_grains, grains_of

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

  !> Count and weigh the grains that ranks share, or that one rank holds
  interface count_grains
    module procedure count_shared_grains, count_own_grains
  end interface count_grains

contains

  !> Count and weigh the grains of all ranks. Collective.
  subroutine count_shared_grains(bodies, grains, comm)
    type(bodies_t), intent(in) :: bodies !! bodies of this rank
    type(grains_t), intent(out) :: grains !! their grains
    type(comm_t), intent(inout) :: comm !! the ranks
    type(tally_t) :: tally

    tally%pass = pass_sums
    call sum_grains(bodies, tally)
    call tally%reduce(comm)
    grains = grains_of(tally)
  end subroutine count_shared_grains

  !> Count and weigh the grains of one rank.
  subroutine count_own_grains(bodies, grains)
    type(bodies_t), intent(in) :: bodies !! bodies of this rank
    type(grains_t), intent(out) :: grains !! their grains
    type(comm_t) :: alone

    call count_shared_grains(bodies, grains, alone)
  end subroutine count_own_grains

  !> Sums over the grains, for indicators that are means over them.
  pure subroutine sum_grains(bodies, tally)
    type(bodies_t), intent(in) :: bodies !! bodies of this rank
    type(tally_t), intent(inout) :: tally !! tally of the measure

    if (tally%pass == pass_sums) call tally%sums%put('grains', grain_sums(bodies))
  end subroutine sum_grains

  !> Number, mass, area and radii of the grains of this rank, summed.
  pure function grain_sums(bodies) result(sums)
    type(bodies_t), intent(in) :: bodies
    real(wp) :: sums(n_grain_sums)
    integer :: i

    sums = 0
    do i = 1, bodies%n_own
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

  !> Grains of all ranks from their sums.
  pure function grains_of(tally) result(grains)
    type(tally_t), intent(in) :: tally !! tally of the measure, summed
    type(grains_t) :: grains
    real(wp) :: sums(n_grain_sums)

    sums = tally%sums%get('grains', n_grain_sums)
    grains%n = nint(sums(1))
    grains%mass = sums(2)
    grains%area = sums(3)
    grains%mean_radius = sums(4)
    if (grains%n > 0) grains%mean_radius = grains%mean_radius/real(grains%n, wp)
  end function grains_of
end module sg_grains
