!> Path lengths of contactors: how much nearer two shapes may have come to each other since they were found apart.
!!
!! All points of a polyhedron move by no more than that vertex which moves farthest, those of a polygon by no more than its centre
!! and the chord of its turn at its reach. Along any direction two shapes are nearer after a step by no more than the displacements
!! of both.
module sg_path_bound
  use sg_kinds, only: wp
  implicit none
  private
  public :: longer_path, is_clear

contains

  !> Upper bound of a path length after one more displacement. It is rounded up: small displacements would be lost in a long path.
  pure real(wp) function longer_path(path, square) result(longer)
    real(wp), intent(in) :: path !! path length so far [m]
    real(wp), intent(in) :: square !! square of the largest displacement of a point, or more [m2]

    ! The square of a tiny displacement is rounded away, too.
    longer = (path + (sqrt(square) + sqrt(tiny(square))))*(1 + 4*epsilon(longer))
  end function longer_path

  !> Are two shapes still beyond the alert distance, whatever way each has gone since they were found apart?
  pure logical function is_clear(clearance, path, alert)
    real(wp), intent(in) :: clearance !! least distance when it was found, plus the paths of both at that time [m]
    real(wp), intent(in) :: path !! paths of both now, added [m]
    real(wp), intent(in) :: alert !! alert distance [m]

    is_clear = clearance - path*(1 + 8*epsilon(alert)) >= alert
  end function is_clear
end module sg_path_bound
