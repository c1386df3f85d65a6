!> What laws keep of a contact from step to step: how many values, their places, and those of a contact that is there from the
!! start (doc/theory/laws.md).
module sg_internal_values
  use sg_kinds, only: wp
  use sg_laws, only: is_cohesive_zone, law_bond, law_elastic_g0, law_gap_g0, law_iqs_g0, law_t
  implicit none
  private
  public :: most_internal, not_recorded, n_internal_of, keeps_gap, first_internal
  public :: bond_surface, bond_opening, bond_integrity, bond_onset, bond_slip, never

  !> Values that a contact keeps at most: those of a law, and a moment in space
  integer, parameter :: most_internal = 10
  !> Places of the values of a cohesive zone: surface [m2; m in the plane], opening [m], integrity (1 whole, 0 broken), time at
  !! which it first fell [s], slip [m]; the slip is the last of them, in space a vector of three components in the world's axes
  integer, parameter :: bond_surface = 1, bond_opening = 2, bond_integrity = 3, bond_onset = 4, bond_slip = 5
  !> Time of what has not happened [s]
  real(wp), parameter :: never = -99
  !> First value of a contact of which a file holds no internal values
  real(wp), parameter :: not_recorded = -huge(1.0_wp)

contains

  !> Number of internal values of a law.
  !!
  !! - laws whose gap counts from that of the first detection: that gap [m]
  !! - bonds between points: length at the first detection, then the displacement across the bond since then [m], along the
  !!   tangent or in the world's axes
  !! - cohesive zones: see `bond_surface` and the next ones
  pure integer function n_internal_of(law, dimension) result(n)
    type(law_t), intent(in) :: law !! law to look at
    integer, intent(in) :: dimension !! of space

    n = 0
    if (keeps_gap(law)) n = 1
    if (law%kind == law_bond) n = merge(2, 4, dimension == 2)
    if (is_cohesive_zone(law)) n = bond_slip - 1 + merge(1, 3, dimension == 2)
  end function n_internal_of

  !> Does a law keep the gap of the first detection?
  pure logical function keeps_gap(law)
    type(law_t), intent(in) :: law !! law to look at

    keeps_gap = any(law%kind == [law_iqs_g0, law_gap_g0, law_elastic_g0])
  end function keeps_gap

  !> Internal values of a contact that is there from the start. Signs of reference gaps are those of LMGC90, which differ
  !! between plane and space.
  pure function first_internal(law, gap, dimension, n) result(values)
    type(law_t), intent(in) :: law !! law of the contact
    real(wp), intent(in) :: gap !! at the detection configuration [m]
    integer, intent(in) :: dimension !! of space
    integer, intent(in) :: n !! values kept of each contact of the scene
    real(wp) :: values(n)

    values = 0
    if (is_cohesive_zone(law)) values([bond_integrity, bond_onset]) = [1.0_wp, never]
    select case (law%kind)
    case (law_iqs_g0)
      values(1) = max(0.0_wp, gap)
    case (law_gap_g0)
      values(1) = merge(gap, max(0.0_wp, gap), dimension == 2)
    case (law_elastic_g0)
      values(1) = merge(max(0.0_wp, gap), gap, dimension == 2)
    case (law_bond)
      values(1) = gap
    end select
  end function first_internal
end module sg_internal_values
