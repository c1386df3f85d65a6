!> Cohesive zones: bonds of contacts that were there in the first step, weakened by damage (doc/theory/cohesive_zones.md).
!!
!! A bond of surface S pulls back with S f(beta) c per opening and per slip, beta its integrity: 1 whole, 0 broken. Five laws
!! differ in how beta falls with opening and slip.
module sg_cohesive_zones
  use sg_internal_values, only: bond_integrity, bond_slip
  use sg_kinds, only: wp, i1
  use sg_laws, only: law_abp, law_expo, law_mac, law_mal, law_t, law_th, local_law_t, status_slide
  implicit none
  private
  public :: zone_law, slip_across, integrity_after, stiffness_share, zone_fault

  !> Integrity below which a bond is broken
  real(wp), parameter :: least_integrity = 1e-12_wp

contains

  !> The local problem of a contact under a cohesive law, at the integrity that its internal values hold.
  pure function zone_law(law, gap, time_step, status, surface, internal) result(local)
    type(law_t), intent(in) :: law !! law of the contact
    real(wp), intent(in) :: gap !! at the detection configuration [m]
    real(wp), intent(in) :: time_step !! time step [s]
    integer(i1), intent(in) :: status !! what the contact did in the last step
    real(wp), intent(in) :: surface !! of the contact [m2; m in the plane]
    real(wp), intent(in) :: internal(:) !! internal values of the contact
    type(local_law_t) :: local
    integer :: n

    local%bias(1) = max(0.0_wp, gap/time_step)
    local%friction = merge(law%dynamic_friction, law%static_friction, status == status_slide)*(1 - internal(bond_integrity))
    if (.not. internal(bond_integrity) > 0) return
    local%stiffness = time_step**2*surface*stiffness_share(law, internal(bond_integrity))*law%zone_stiffness
    n = min(3, size(internal) - bond_slip + 1)
    local%slip(:n) = internal(bond_slip:bond_slip + n - 1)/time_step
  end function zone_law

  !> A slip laid into the plane across a normal that has turned since: its size stays [m].
  pure function slip_across(slip, normal) result(turned)
    real(wp), intent(in) :: slip(3) !! vector [m, m/s]
    real(wp), intent(in) :: normal(3) !! unit normal of now
    real(wp) :: turned(3)

    turned = slip - dot_product(slip, normal)*normal
    if (norm2(turned) > 0) turned = turned*(norm2(slip)/norm2(turned))
  end function slip_across

  !> Share f of the stiffness of a whole bond.
  pure real(wp) function stiffness_share(law, integrity) result(share)
    type(law_t), intent(in) :: law !! law of the bond
    real(wp), intent(in) :: integrity !! of the bond

    share = integrity
    if (law%kind == law_mac) share = integrity**2
  end function stiffness_share

  !> Integrity of a bond after a step that ends with this opening and slip; it never grows.
  pure real(wp) function integrity_after(law, opening, slip, before, time_step) result(integrity)
    type(law_t), intent(in) :: law !! law of the bond
    real(wp), intent(in) :: opening !! of the two sides along the normal [m]
    real(wp), intent(in) :: slip !! size of the displacement along the tangents [m]
    real(wp), intent(in) :: before !! integrity at the beginning of the step
    real(wp), intent(in) :: time_step !! time step [s]
    real(wp) :: jump, share(2)

    integrity = before
    share = [max(0.0_wp, opening), abs(slip)]
    jump = norm2(share)
    if (.not. (before > 0 .and. jump > 0)) return
    ! Squares of the direction of the jump.
    share = (share/jump)**2
    select case (law%kind)
    case (law_mac)
      integrity = adhesion(law, jump**2*dot_product(law%zone_stiffness, share), before, time_step)
    case (law_mal)
      integrity = parabolic(law, jump, share)
    case (law_th)
      integrity = trapezoidal(law, jump, share)
    case (law_abp)
      integrity = bilinear(law, jump, share)
    case (law_expo)
      integrity = exponential(law, jump, share)
    end select
    integrity = min(before, integrity)
    if (.not. integrity > least_integrity) integrity = 0
  end function integrity_after

  !> Length on an ellipse with given half axes, in the direction of a jump.
  pure real(wp) function mixed(axes, share)
    real(wp), intent(in) :: axes(2) !! along the normal and along tangents [m]
    real(wp), intent(in) :: share(2) !! squares of the direction

    mixed = axes(1)*axes(2)/sqrt(dot_product(axes([2, 1])**2, share))
  end function mixed

  !> Monerie, Acary and Cangemi: b d(beta)/dt = w - beta Y where that is negative, Y = c_n u_n^2 + c_t u_t^2, by an implicit step.
  pure real(wp) function adhesion(law, release, before, time_step) result(integrity)
    type(law_t), intent(in) :: law
    real(wp), intent(in) :: release !! Y [J/m2]
    real(wp), intent(in) :: before, time_step

    integrity = before
    if (law%zone_energy(1) > before*release) return
    integrity = (time_step*law%zone_energy(1) + law%zone_viscosity*before)/(law%zone_viscosity + time_step*release)
  end function adhesion

  !> Stress that falls along a parabola.
  pure real(wp) function parabolic(law, jump, share) result(integrity)
    type(law_t), intent(in) :: law
    real(wp), intent(in) :: jump, share(2)
    real(wp) :: first, last, weighted

    first = mixed(strength(law)/law%zone_stiffness, share)
    integrity = 1
    if (jump < first) return
    weighted = dot_product(law%zone_energy([2, 1])*law%zone_stiffness, share)
    last = 1.5_wp*(product(law%zone_energy) - 0.5_wp*first**2*weighted)/(first*weighted)
    integrity = 0
    if (jump < first + last) integrity = first/jump*(1 - ((jump - first)/last)**2)
  end function parabolic

  !> Stress that stays and then falls along a line.
  pure real(wp) function trapezoidal(law, jump, share) result(integrity)
    type(law_t), intent(in) :: law
    real(wp), intent(in) :: jump, share(2)
    real(wp) :: first, plateau, last, weighted

    first = mixed(strength(law)/law%zone_stiffness, share)
    plateau = mixed(law%zone_plateau, share)
    weighted = dot_product(law%zone_energy([2, 1])*law%zone_stiffness, share)
    last = (2*product(law%zone_energy) - first*(plateau - first)*weighted)/(first*weighted)
    integrity = 1
    if (jump > first) integrity = first/jump
    if (jump > plateau) integrity = first/jump*(last - jump)/(last - plateau)
    if (jump >= last) integrity = 0
  end function trapezoidal

  !> Stress that falls along two lines: `zone_share` of the energy is gone where they meet.
  pure real(wp) function bilinear(law, jump, share) result(integrity)
    type(law_t), intent(in) :: law
    real(wp), intent(in) :: jump, share(2)
    real(wp) :: first(2), knee(2), whole, here, at_knee, last, stiffness, stress(2)

    first = strength(law)/law%zone_stiffness
    knee = knees(law)
    whole = mixed(first, share)
    at_knee = product(knee)*sqrt(dot_product(first([2, 1])**2, share))/dot_product(first([2, 1])*knee([2, 1]), share)
    last = product(knee)*product(law%zone_opening)/(at_knee*dot_product(knee([2, 1])*law%zone_opening([2, 1]), share))
    stiffness = sqrt(dot_product(law%zone_stiffness**2, share))
    stress(1) = stiffness*whole
    stress(2) = stress(1)*at_knee/(whole + law%zone_share*last/(1 - law%zone_share))
    if (jump <= whole) then
      integrity = 1
      return
    else if (jump <= at_knee) then
      here = stress(1) + (stress(2) - stress(1))*(jump - whole)/(at_knee - whole)
    else
      here = max(0.0_wp, stress(2)*(last - jump)/(last - at_knee))
    end if
    integrity = here/(jump*stiffness)
  end function bilinear

  !> Strengths, normal and tangential [Pa].
  pure function strength(law)
    type(law_t), intent(in) :: law
    real(wp) :: strength(2)

    strength = [law%normal_strength, law%tangential_strength]
  end function strength

  !> Opening and slip at which the two lines of the bilinear law meet in the pure modes [m].
  pure function knees(law)
    type(law_t), intent(in) :: law
    real(wp) :: knees(2), stress(2)

    stress = 2*law%zone_energy*(1 - law%zone_share)/law%zone_opening
    knees = (2*law%zone_energy*law%zone_share + stress*strength(law)/law%zone_stiffness)/strength(law)
  end function knees

  !> Stress that falls exponentially, cut off at a share of its peak.
  pure real(wp) function exponential(law, jump, share) result(integrity)
    type(law_t), intent(in) :: law
    real(wp), intent(in) :: jump, share(2)
    real(wp) :: first(2), whole, energy, stiffness, decay

    first = strength(law)/law%zone_stiffness
    whole = mixed(first, share)
    integrity = 1
    if (jump <= whole) return
    energy = dot_product(first([2, 1])**2*law%zone_energy, share)/dot_product(first([2, 1])**2, share)
    stiffness = sqrt(dot_product(law%zone_stiffness**2, share))
    decay = stiffness*whole/(energy - 0.5_wp*stiffness*whole**2)
    integrity = 0
    if (jump <= whole - log(law%zone_residual)/decay) integrity = whole/jump*exp(decay*(whole - jump))
  end function exponential

  !> Why the numbers of a cohesive law do not fit each other; empty when they do.
  pure function zone_fault(law) result(fault)
    type(law_t), intent(in) :: law !! law to look at
    character(len=:), allocatable :: fault
    real(wp) :: first(2)

    fault = ''
    if (law%kind == law_mac) return
    first = strength(law)/law%zone_stiffness
    if (any(law%zone_energy <= 0.5_wp*strength(law)*first)) then
      fault = 'the energies must exceed half of strength squared over stiffness, what a bond stores at its strength'
    else if (law%kind == law_th) then
      if (any(law%zone_plateau < first) .or. any(law%zone_energy <= strength(law)*(law%zone_plateau - 0.5_wp*first))) &
        fault = 'the plateaus must end after strength over stiffness, and leave energy for the fall'
    else if (law%kind == law_abp) then
      if (any(knees(law) < first) .or. any(knees(law) >= law%zone_opening)) &
        fault = 'the openings and the share of energy put the meeting point of the two lines out of order'
    end if
  end function zone_fault
end module sg_cohesive_zones
