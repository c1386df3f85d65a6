!> The dual method (NLGS-DD): contacts are distributed, shared grains copied, their mass and loads divided among the
!! copies [AlartIcetaDureisseix2012] (doc/theory/decomposition.md).
!!
!! Step 1 sweeps each part with given interface impulses F_Gamma; step 2 updates them by X F_Gamma = sum A M_E^-1 (R_E +
!! R_E^d), X diagonal: all copies of a grain get the mean of their velocities, which with divided masses is the velocity
!! under all impulses. F_Gamma is what this adds to each copy: its part of the mass times `gluing%jump`.
module sg_dual
  use sg_kinds, only: wp
  use sg_mass_splitting, only: mass_splitting_t
  implicit none
  private
  public :: dual_t

  !> The dual method
  type, extends(mass_splitting_t) :: dual_t
  contains
    procedure :: rule => dual_rule
  end type dual_t

contains

  !> Divide masses; nothing need be relaxed, as a part of the mass never lets a sweep overshoot.
  pure subroutine dual_rule(self, is_mean, relaxation)
    class(dual_t), intent(in) :: self
    logical, intent(out) :: is_mean !! yes
    real(wp), intent(out) :: relaxation !! that of all sweeps

    is_mean = .true.
    relaxation = self%options%relaxation
  end subroutine dual_rule
end module sg_dual
