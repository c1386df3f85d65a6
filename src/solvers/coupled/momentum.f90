!> Exchange of momentum (after [BreitkopfJean1999]): contacts are distributed, shared grains keep their whole mass in
!! every part, and the changes of their momentum are added up (doc/theory/decomposition.md).
!!
!! Simultaneous changes of one grain by several subdomains overshoot: without relaxation the rounds can diverge where grains
!! are shared by three or more subdomains. The contacts of shared grains therefore take only a share of each change.
module sg_momentum
  use sg_kinds, only: wp
  use sg_mass_splitting, only: mass_splitting_t
  use sg_options, only: option_t, option_visitor_t
  implicit none
  private
  public :: momentum_t

  !> The method that exchanges momentum
  type, extends(mass_splitting_t) :: momentum_t
    !> Share of each new impulse that contacts of shared grains take
    real(wp) :: share_taken = 0.8_wp
  contains
    procedure :: visit_options => momentum_visit_options
    procedure :: rule => momentum_rule
  end type momentum_t

contains

  !> Options of the exchange of momentum.
  subroutine momentum_visit_options(self, visitor)
    class(momentum_t), intent(inout) :: self
    class(option_visitor_t), intent(inout) :: visitor !! key table, or values of a deck

    call visitor%option(option_t('relaxation', 'Share of each new impulse that contacts of shared grains take.', above=0.0_wp, &
                                 most=1.0_wp, former='partition.relaxation'), self%share_taken)
  end subroutine momentum_visit_options

  !> Keep masses whole, add up the changes, and relax.
  pure subroutine momentum_rule(self, is_mean, relaxation)
    class(momentum_t), intent(in) :: self
    logical, intent(out) :: is_mean !! no
    real(wp), intent(out) :: relaxation !! that of all sweeps times the share of the deck

    is_mean = .false.
    relaxation = self%options%relaxation*self%share_taken
  end subroutine momentum_rule
end module sg_momentum
