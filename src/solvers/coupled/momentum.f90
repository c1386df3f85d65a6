!> Exchange of momentum (after [BreitkopfJean1999]): contacts are distributed, shared grains keep their whole mass in
!! every part, and the changes of their momentum are added up (doc/theory/decomposition.md).
!!
!! Simultaneous changes of one grain by several subdomains overshoot: without relaxation the rounds can diverge where grains
!! are shared by three or more subdomains. The contacts of shared grains therefore take only a share of each change.
module sg_momentum
  use sg_kinds, only: wp
  use sg_mass_splitting, only: mass_splitting_t
  implicit none
  private
  public :: momentum_t

  !> The method that exchanges momentum
  type, extends(mass_splitting_t) :: momentum_t
  contains
    procedure :: rule => momentum_rule
  end type momentum_t

contains

  !> Keep masses whole, add up the changes, and relax.
  pure subroutine momentum_rule(self, is_mean, relaxation)
    class(momentum_t), intent(in) :: self
    logical, intent(out) :: is_mean !! no
    real(wp), intent(out) :: relaxation !! that of all sweeps times the share of the deck

    is_mean = .false.
    relaxation = self%options%relaxation*self%partition%relaxation
  end subroutine momentum_rule
end module sg_momentum
