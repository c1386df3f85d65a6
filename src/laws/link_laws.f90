!> Local laws of links: rods, wires and bonds between two points (doc/theory/links.md).
!!
!! A link has a length L along its normal n, which points from antagonist to candidate; of wires the contact has the normal
!! turned round, so that their tension is a positive impulse and a slack wire an open contact. All springs and dashpots are
!! implicit: they take the length at the end of the step, L + h u_n.
module sg_link_laws
  use sg_kinds, only: wp, i1
  use sg_laws, only: law_bond, law_linear, law_rigid_wire, law_rod, law_t, law_wire, local_law_t, status_broken
  implicit none
  private
  public :: link_law, link_energy, pulls_only, holds_across, tears, is_torn

contains

  !> What the law of a link asks in one step.
  pure function link_law(law, length, rest, bond, state, time_step, status) result(local)
    type(law_t), intent(in) :: law !! law of the link
    real(wp), intent(in) :: length !! at the detection configuration [m]
    real(wp), intent(in) :: rest !! length at rest [m]
    real(wp), intent(in) :: bond(2) !! cross section [m2] and mass [kg] of a bond
    real(wp), intent(in) :: state(3) !! of a bond: first length, displacement along both tangents at the beginning of the step [m]
    real(wp), intent(in) :: time_step !! time step h [s]
    integer(i1), intent(in) :: status !! what the link did in the last step
    type(local_law_t) :: local
    real(wp) :: stiffness, stretch

    local%is_active = status /= status_broken
    select case (law%kind)
    case (law_rod, law_wire)
      ! Force k (L + h u - l)/l0 + eta u/l0, with l the length without force.
      stiffness = (law%axial_stiffness*time_step + law%axial_damping)/rest
      stretch = law%axial_stiffness/rest*(length - (1 + law%prestrain)*rest)/stiffness
      local%compliance(1) = 1/(stiffness*time_step)
      local%bias(1) = stretch
      local%is_linear = law%kind == law_rod
      local%is_along_normal = local%is_linear
      if (law%kind == law_wire) local%bias(1) = -stretch
    case (law_rigid_wire)
      local%bias(1) = (rest - length)/time_step
    case (law_bond)
      local%is_linear = .true.
      call bond_law(law, length, rest, bond, state, time_step, local)
    case (law_linear)
      local%is_linear = .true.
      local%is_along_normal = law%is_along_normal
      local%compliance = law%epsilon
    end select
  end function link_law

  !> A bond: spring and dashpot along the normal and along the tangents.
  pure subroutine bond_law(law, length, rest, bond, state, time_step, local)
    type(law_t), intent(in) :: law
    real(wp), intent(in) :: length, rest, bond(2), state(3), time_step
    type(local_law_t), intent(inout) :: local
    real(wp) :: stiffness(2), damping(2), both(2)

    stiffness = stiffness_of_bond(law, rest, bond)
    damping = damping_of_bond(law, rest, bond)
    both = stiffness*time_step + damping
    local%compliance = 1/(both*time_step)
    local%bias = [stiffness(1)*(length - state(1))/both(1), stiffness(2)*state(2:)/both(2)]
  end subroutine bond_law

  !> Normal and tangential stiffness of a bond [N/m]: E A/l0, and as much over 2 (1 + nu).
  pure function stiffness_of_bond(law, rest, bond) result(stiffness)
    type(law_t), intent(in) :: law
    real(wp), intent(in) :: rest, bond(2)
    real(wp) :: stiffness(2)

    stiffness(1) = law%young*bond(1)/rest
    stiffness(2) = stiffness(1)/(2*(1 + law%poisson))
  end function stiffness_of_bond

  !> Normal and tangential viscosity of a bond [N s/m]: critical damping 2 sqrt(m k).
  pure function damping_of_bond(law, rest, bond) result(damping)
    type(law_t), intent(in) :: law
    real(wp), intent(in) :: rest, bond(2)
    real(wp) :: damping(2)

    damping = 2*sqrt(bond(2)*stiffness_of_bond(law, rest, bond))
  end function damping_of_bond

  !> Can the law pull only, so that its contact has the normal turned round?
  pure logical function pulls_only(law)
    type(law_t), intent(in) :: law !! law of a link

    pulls_only = law%kind == law_wire .or. law%kind == law_rigid_wire
  end function pulls_only

  !> Does the law carry impulses across the link too?
  pure logical function holds_across(law)
    type(law_t), intent(in) :: law !! law of a link

    holds_across = law%kind == law_bond .or. (law%kind == law_linear .and. .not. law%is_along_normal)
  end function holds_across

  !> Does a wire break under what it carried in a step?
  pure logical function tears(law, force)
    type(law_t), intent(in) :: law !! law of the link
    real(wp), intent(in) :: force !! its tension [N]

    tears = law%kind == law_wire .and. law%breaking_force > 0 .and. force > law%breaking_force
  end function tears

  !> Are the ends of a bond so far from where they were at first that it is broken?
  pure logical function is_torn(law, length, rest, bond, state)
    type(law_t), intent(in) :: law !! law of the link
    real(wp), intent(in) :: length !! at the detection configuration [m]
    real(wp), intent(in) :: rest !! length at rest [m]
    real(wp), intent(in) :: bond(2) !! cross section [m2] and mass [kg]
    real(wp), intent(in) :: state(:) !! first length, then the displacement across [m]
    real(wp) :: stiffness(2)

    is_torn = .false.
    if (law%kind /= law_bond) return
    stiffness = stiffness_of_bond(law, rest, bond)
    is_torn = stiffness(1)*(length - state(1)) > bond(1)*law%normal_strength .or. &
              stiffness(2)*norm2(state(2:)) > bond(1)*law%tangential_strength
  end function is_torn

  !> Elastic energy of a link that is not broken, along it and across it [J].
  pure function link_energy(law, length, rest, bond, state) result(energy)
    type(law_t), intent(in) :: law !! law of the link
    real(wp), intent(in) :: length !! [m]
    real(wp), intent(in) :: rest !! length at rest [m]
    real(wp), intent(in) :: bond(2) !! cross section [m2] and mass [kg] of a bond
    real(wp), intent(in) :: state(:) !! of a bond: first length, then the displacement across [m]
    real(wp) :: energy(2), stretch, stiffness(2)

    energy = 0
    stretch = length - (1 + law%prestrain)*rest
    select case (law%kind)
    case (law_rod)
      energy(1) = law%axial_stiffness/rest*stretch**2/2
    case (law_wire)
      energy(1) = law%axial_stiffness/rest*max(0.0_wp, stretch)**2/2
    case (law_bond)
      stiffness = stiffness_of_bond(law, rest, bond)
      energy = stiffness*[(length - state(1))**2, sum(state(2:)**2)]/2
    end select
  end function link_energy
end module sg_link_laws
